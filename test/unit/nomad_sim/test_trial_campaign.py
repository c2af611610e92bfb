# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Campaigns in drawn worlds as they are called: taking up again, files, replays, refusals."""

import csv
import json
import shlex
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from fuzzy_map_building.grid import GridGeometry
from fuzzy_map_building.map_server import export_map_server
from nomad_sim import trial_campaign
from nomad_sim.campaign import main
from nomad_sim.trials import Trial, TrialResult, run_trial

#: Two missions that are over within seconds.
QUICK = ["--generated", "2", "--kind", "clutter", "--set", "motion.perception_cap=2"]


@pytest.fixture
def calls(monkeypatch: pytest.MonkeyPatch) -> list[int]:
    """Seeds of the trials that are run."""
    seeds: list[int] = []

    def counted(trial: Trial) -> TrialResult:
        seeds.append(trial.seed)
        return run_trial(trial)

    monkeypatch.setattr(trial_campaign, "run_trial", counted)
    return seeds


def timeless(values: dict[str, Any]) -> dict[str, Any]:
    return {k: v for k, v in values.items() if k not in ("wall_time", "replay")}


def missions(folder: Path) -> list[dict[str, Any]]:
    found: list[dict[str, Any]] = json.loads((folder / "campaign.json").read_text())["missions"]
    return [timeless(m) for m in found]


def test_a_campaign_is_taken_up_where_it_ended(
    tmp_path: Path, calls: list[int], capsys: pytest.CaptureFixture[str]
) -> None:
    whole, parts = tmp_path / "whole", tmp_path / "parts"
    three = ["--generated", "3", *QUICK[2:], "--jobs", "1"]
    assert main([*three, "--output", str(whole)]) == 1  # the cap does not let them arrive
    assert calls == [1, 2, 3]
    main([*QUICK, "--jobs", "1", "--output", str(parts)])
    file = parts / "trials.jsonl"
    lines = file.read_bytes().splitlines(keepends=True)
    # Killed in the middle of the second line.
    file.write_bytes(b"".join(lines[:2]) + lines[2][:40])
    calls.clear()
    main([*three, "--output", str(parts)])
    assert calls == [2, 3]
    assert missions(parts) == missions(whole)
    main([*three, "--output", str(parts)])
    assert calls == [2, 3]
    assert capsys.readouterr().out.count("reached: goals that can be") == 4


@pytest.mark.parametrize(
    ("there", "arguments", "reason"),
    [
        (
            "trials.jsonl",
            ["--world", "lab", "--seeds", "1"],
            "holds results of --generated or --floor-plan",
        ),
        ("campaign.json", QUICK, "holds a campaign.json without trials.jsonl, as of --world or"),
    ],
)
def test_results_of_two_kinds_are_not_mixed(
    there: str,
    arguments: list[str],
    reason: str,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
) -> None:
    (tmp_path / there).write_text("{}")
    assert main([*arguments, "--jobs", "1", "--output", str(tmp_path)]) == 2
    assert reason in capsys.readouterr().err
    assert [(file.name, file.read_text()) for file in tmp_path.iterdir()] == [(there, "{}")]


def test_jobs_change_nothing(tmp_path: Path) -> None:
    for jobs in ("1", "2"):
        main([*QUICK, "--jobs", jobs, "--output", str(tmp_path / jobs)])
    assert missions(tmp_path / "1") == missions(tmp_path / "2")


def test_tables_hold_what_was_drawn_and_the_command_that_repeats_it(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    options = ["--generated", "1", "--first-seed", "2", "--jobs", "1"]
    assert (
        main([*options, "--output", str(tmp_path / "out"), "--set", "planner.epsilon=0.19"]) == 0
    )
    with (tmp_path / "out" / "missions.csv").open(newline="") as file:
        (row,) = csv.DictReader(file)
    with (tmp_path / "out" / "report.csv").open(newline="") as file:
        tallies = list(csv.DictReader(file))
    assert (row["kind"], row["seed"], row["flawless"]) == ("clutter", "2", "True")
    assert tallies[0]["group"] == "all"
    assert float(row["path_ratio"]) == float(row["path_length"]) / float(row["shortest"])
    capsys.readouterr()

    words = shlex.split(row["replay"])
    assert words[:4] == ["ros2", "run", "nomad_sim", "campaign"]
    monkeypatch.chdir(tmp_path)
    assert main(words[4:]) == 0
    assert capsys.readouterr().out.startswith("clutter_2: drawn: clutter; seed 2\n")
    folder = tmp_path / "clutter_2"
    document = json.loads((folder / "mission.json").read_text())
    (whole,) = missions(tmp_path / "out")
    replayed = timeless(document["mission"])
    assert {name: whole[name] for name in replayed} == replayed
    assert (folder / "mission.png").read_bytes().startswith(b"\x89PNG")


def test_a_mission_that_went_wrong_is_told_with_its_command(
    capsys: pytest.CaptureFixture[str],
) -> None:
    assert main([*QUICK, "--jobs", "1"]) == 1
    told = capsys.readouterr().out.splitlines()
    commands = [line.strip() for line in told if line.strip().startswith("ros2 run")]
    assert len(commands) == 2
    assert "--kind clutter --replay 1 --output clutter_1" in commands[0]
    assert "--set motion.perception_cap=2" in commands[0]


def plan_file(folder: Path) -> str:
    geometry = GridGeometry(60, 50, 0.1)
    occupancy = np.zeros(geometry.shape, dtype=np.int8)
    occupancy[20:25, 20:25] = 100
    export_map_server(folder / "hall.yaml", occupancy, geometry)
    return str(folder / "hall.yaml")


def test_a_floor_plan_gives_missions(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    plan = ["--floor-plan", plan_file(tmp_path)]
    quick = ["--set", "motion.perception_cap=1", "--jobs", "1"]
    main([*plan, "--missions", "2", *quick, "--output", str(tmp_path / "out")])
    found = missions(tmp_path / "out")
    assert [(m["kind"], m["seed"], m["truth"]) for m in found] == [
        ("floor_plan", seed, "reachable") for seed in (1, 2)
    ]
    assert all(m["shortest"] >= 3.9 for m in found)
    capsys.readouterr()
    main([*plan, "--replay", "2", "--set", "motion.perception_cap=1", "--json"])
    replayed = timeless(json.loads(capsys.readouterr().out)["mission"])
    assert replayed == {name: found[1][name] for name in replayed}
    # The same file with another content is another plan.
    export_map_server(
        tmp_path / "hall.yaml", np.zeros((50, 61), dtype=np.int8), GridGeometry(61, 50, 0.1)
    )
    assert main([*plan, "--missions", "2", *quick, "--output", str(tmp_path / "out")]) == 2
    assert "origin.floor_plan" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ("--generated 0", "--generated must be from 1"),
        ("--generated many", "must be a whole number, got 'many'"),
        ("--generated 2 --world lab", "either --world, --reference, --generated or --floor-plan"),
        ("--generated 2 --floor-plan a.yaml", "either --generated or --floor-plan"),
        ("--generated 2 --kind ofice", "did you mean 'office'"),
        ("--world lab --kind office", "--kind chooses among"),
        ("--generated 2 --seeds 3", "--seeds goes with --world"),
        ("--generated 2 --missions 3", "--missions says how many with --floor-plan"),
        ("--generated 2 --start-spread 0.1", "without --start-spread"),
        ("--generated 2 --set motion.perception_capp=3", "did you mean 'perception_cap'"),
        ("--generated 2 --dask here --jobs 2", "either --jobs on this machine or --dask"),
        ("--world lab --dask here", "--dask runs many missions"),
        ("--generated --replay 3 --dask here", "--dask runs many missions"),
        ("--generated 2 --set simulator.robot.radius=0.2", "without --set simulator.robot.radius"),
        ("--generated 2 --set motion.goal_tolerance=0.2", "and motion.goal_tolerance"),
        ("--floor-plan no/such.yaml", "cannot read floor plan"),
    ],
)
def test_what_cannot_be_is_refused_in_one_line(
    arguments: str, message: str, capsys: pytest.CaptureFixture[str]
) -> None:
    with pytest.raises(SystemExit) as raised:
        main(arguments.split())
    told = capsys.readouterr()
    assert raised.value.code == 2
    assert told.out == ""
    assert told.err.count("\n") == 1
    assert message in told.err


def test_without_dask_it_is_said_what_is_missing(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setitem(sys.modules, "distributed", None)
    assert main(["--generated", "2", "--dask", "tcp://127.0.0.1:1"]) == 2
    assert "pip install distributed" in capsys.readouterr().err
