# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""What nodes call before they begin leaves nothing to compile in a mission."""

import subprocess
import sys

import pytest

from fuzzy_map_building.jit import compiled

# In a process of its own: in this one other tests have compiled what they called.
MISSION = """
import sys
from fuzzy_map_building import mapper, sonar_guard
from fuzzy_navigation import any_angle, clearance_layer, follower, search
from nomad_sim.headless import HeadlessMission

missions = [HeadlessMission("corridor", seed=3, preset=p) for p in ("consistent", "oriolo1998")]
for kernels in (mapper, sonar_guard, any_angle, clearance_layer, follower, search):
    kernels.warm_up()

def signatures():
    modules = [m for n, m in sys.modules.items() if n.startswith(("fuzzy_map_", "fuzzy_nav"))]
    kernels = {id(k): k for m in modules for k in vars(m).values() if hasattr(k, "signatures")}
    return {k.__name__: len(k.signatures) for k in kernels.values()}

before = signatures()
assert len(before) > 20
for mission in missions:
    mission.run(time_limit=40.0)
print({name: count for name, count in signatures().items() if count > before.get(name, 0)})
"""


@pytest.mark.skipif(not compiled(), reason="loops are compiled with numba only")
def test_no_mission_compiles_anything_after_warm_up() -> None:
    command = [sys.executable, "-c", MISSION]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert (done.returncode, done.stdout.strip()) == (0, "{}"), done.stderr
