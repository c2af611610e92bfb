# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""A small mission through all nodes with a mapper that maps while the robot moves."""

from __future__ import annotations

import json
import math
import os
import re
from collections.abc import Callable
from pathlib import Path

import numpy as np
from geometry_msgs.msg import PoseStamped
from nav_msgs.msg import OccupancyGrid
from nav_msgs.msg import Path as PathMessage
from std_msgs.msg import Float64

from fuzzy_map_building.ros import names, qos
from fuzzy_map_building.ros.clock import seconds_from_stamp
from ros.harness import NodeProcess, Probe
from ros.stack import speeds

ROOM = """
name: room
area: {origin: [0.0, 0.0], size: [4.0, 2.4]}
start: {position: [0.75, 1.25], heading_deg: 0.0}
goal: {position: [3.25, 1.25]}
expected: reached
walls:
  - material: painted_wall
    closed: true
    points: [[-0.05, -0.05], [4.05, -0.05], [4.05, 2.45], [-0.05, 2.45]]
"""
#: Long enough for the first start on a machine, which compiles.
LONG = 110.0


def test_maps_are_made_and_paths_planned_while_the_robot_drives(
    probe: Probe, start_node: Callable[..., NodeProcess], tmp_path: Path
) -> None:
    room = tmp_path / "room.yaml"
    room.write_text(ROOM)
    poses = probe.subscribe(PoseStamped, names.POSE, qos.RELIABLE)
    maps = probe.subscribe(OccupancyGrid, names.MOTION_MAP, qos.LATCHED)
    plans = probe.subscribe(PathMessage, names.PLAN, qos.LATCHED)
    angles = probe.subscribe(Float64, names.TURRET_COMMAND, qos.RELIABLE)
    arguments = ["--world", str(room), "--domain", os.environ["ROS_DOMAIN_ID"], "--concurrent"]
    demo = start_node("demo", arguments=[*arguments, "--output", str(tmp_path / "out")])
    assert demo.wait(LONG) == 0, demo.output()

    summary = json.loads((tmp_path / "out" / "summary.json").read_text())
    assert summary["concurrent"] is True
    assert (summary["verdict"], summary["contacts"]) == ("reached", 0)
    # The 2.2 m are no more than two of the pieces of way that count as perceptions.
    assert summary["perceptions"] <= 4
    assert any(entry["on_the_way"] for entry in summary["log"])
    for entry in summary["log"]:
        told = rf"perception +{entry['perception']} at .* m: on the way, "
        assert bool(re.search(told, demo.output())) == entry["on_the_way"]
        assert not entry["on_the_way"] or entry["stopped_by"] == "none"
    time, speed = np.array(speeds(poses.messages)).T
    driven = {
        stamp
        for stamp in (seconds_from_stamp(m.header.stamp) for m in list(maps.messages))
        if np.interp(stamp, time, speed) > 0.1
    }
    assert len(driven) >= 3
    # A path carries the stamp of the map that it rests on.
    planned = {seconds_from_stamp(message.header.stamp) for message in list(plans.messages)}
    assert len(planned & driven) >= 2
    turned = {round(math.degrees(message.data), 3) for message in list(angles.messages)}
    assert turned == {0.0, 7.5, 15.0}
