# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""One mission twice, without noise: four nodes in lockstep, and everything in one process."""

from __future__ import annotations

import json
import os
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from nav_msgs.msg import OccupancyGrid

from fuzzy_map_building.occupancy import risk_to_int8
from fuzzy_map_building.params import PAPER_PRESET
from fuzzy_map_building.ros import names, qos
from nomad_sim.headless import HeadlessMission
from ros.harness import NodeProcess, Probe

#: Longest run of the nodes on a busy machine, with the first start that compiles [s].
LONG = 280.0
#: In percent: a risk half way between two may be rounded up in one map and down in the other.
GREY_LEVEL = 1
#: Of a coordinate [m, rad]. Mostly the two agree to the summary's six decimals; where a busy
#: machine delays one command by a tick the robot takes another way to the same stop (0.3 mm seen).
PLACE = 1e-3
#: Of the cells: so many may be rounded the other way.
ROUNDED = 0.2


@pytest.mark.timeout(LONG + 20.0)
def test_the_nodes_do_what_one_process_does(
    probe: Probe, start_node: Callable[..., NodeProcess], tmp_path: Path
) -> None:
    params = tmp_path / "quiet.yaml"
    # However busy the machine is, each tick waits for its command.
    quiet = {"noise": False, "lockstep_timeout": 60.0}
    params.write_text(json.dumps({"nomad_sim": {"ros__parameters": quiet}}))
    maps = probe.subscribe(OccupancyGrid, names.MOTION_MAP, qos.LATCHED)
    arguments = ["--world", "lab", "--domain", os.environ["ROS_DOMAIN_ID"]]
    arguments += ["--params-file", str(params), "--output", str(tmp_path / "out"), "--rate", "0"]
    # What the sonars that guard the default's motion hear on the way hangs on the moments in which
    # they fire, and the nodes take some ticks more between one movement and the next.
    arguments += ["--preset", PAPER_PRESET]
    # One after the other: without compiled kernels each takes a processor for itself, and nodes
    # that do not get one miss the poses that a simulator tells as fast as it can.
    log = HeadlessMission("lab", preset=PAPER_PRESET, simulator={"noise": False}).run()
    demo = start_node("demo", arguments=arguments)
    assert demo.wait(LONG) == 0, demo.output()

    summary: dict[str, Any] = json.loads((tmp_path / "out" / "summary.json").read_text())
    assert summary["verdict"] == log.outcome.name.lower() == "reached"
    assert summary["perceptions"] == log.perceptions
    for there, here in zip(summary["log"], log.entries, strict=True):
        assert there["stopped_by"] == here.stop.name.lower()
        place = (there["x"], there["y"], there["theta"])
        assert place == pytest.approx((here.pose.x, here.pose.y, here.pose.theta), abs=PLACE)
        assert there["distance_remaining_m"] == pytest.approx(here.distance_remaining, abs=PLACE)

    received = maps.last
    grid = np.reshape(received.data, (received.info.height, received.info.width)).astype(int)
    difference = np.abs(grid - risk_to_int8(log.motion_risk))
    assert difference.max() <= GREY_LEVEL
    assert np.count_nonzero(difference) < ROUNDED * grid.size
    assert len(np.unique(grid)) > 10  # it is a map
