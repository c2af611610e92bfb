# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Campaigns in drawn worlds as they are called: taking up again, files, replays, refusals."""

import csv
import fcntl
import json
import math
import os
import shlex
import sys
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from fuzzy_map_building.grid import GridGeometry
from fuzzy_map_building.map_server import export_map_server
from fuzzy_map_building.params import DEFAULT_PRESET
from nomad_sim import trial_campaign
from nomad_sim.campaign import main
from nomad_sim.trial_file import TrialFile
from nomad_sim.trials import Rules, Trial, TrialResult, run_trial

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
        ("trials.jsonl", ["--world", "lab", "--seeds", "1"], "--generated or --floor-plan"),
        ("campaign.json", QUICK, "--world or --reference"),
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
    assert f"holds results of {reason}" in capsys.readouterr().err
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


@pytest.fixture(scope="module")
def result() -> TrialResult:
    return run_trial(Trial("clutter", 1, Rules(DEFAULT_PRESET, motion={"perception_cap": 1})))


def test_results_come_back_as_they_were(tmp_path: Path, result: TrialResult) -> None:
    with TrialFile(tmp_path / "t", {"a": 1}) as file:
        file.add(result)
    with TrialFile(tmp_path / "t", {"a": 1}) as file:
        assert file.results == {("clutter", 1): result}


def test_another_configuration_is_refused(tmp_path: Path, result: TrialResult) -> None:
    with TrialFile(tmp_path / "t", {"rules": {"preset": "a"}}) as file:
        file.add(result)
    before = (tmp_path / "t").read_bytes()
    with pytest.raises(ValueError, match=r'rules\.preset: "a" there, "b" here'):
        TrialFile(tmp_path / "t", {"rules": {"preset": "b"}})
    assert (tmp_path / "t").read_bytes() == before


@pytest.mark.parametrize(
    "line",
    [
        *("[]", "{}", "nonsense", '{"kind": "maze"}', '{"mission": 3}', '{"mission": {}}'),
        "null",
        "[" * 100_000,
        '{"kind": ' * 3000,
    ],
)
def test_a_file_that_holds_something_else_is_refused(
    line: str, tmp_path: Path, result: TrialResult
) -> None:
    with TrialFile(tmp_path / "t", {}) as file:
        file.add(result)
    with (tmp_path / "t").open("a") as raw:
        raw.write(line + "\n")
    before = (tmp_path / "t").read_bytes()
    with pytest.raises(ValueError, match=r"line 3 cannot be taken: .*; remove it"):
        TrialFile(tmp_path / "t", {})
    assert (tmp_path / "t").read_bytes() == before


def test_a_damaged_line_is_named_and_its_mission_run_again(
    tmp_path: Path, result: TrialResult
) -> None:
    path = tmp_path / "t"
    with TrialFile(path, {}) as file:
        for seed in range(1, 6):
            file.add(replace(result, mission=replace(result.mission, seed=seed)))
    lines = path.read_bytes().splitlines(keepends=True)
    # Cut off and joined with the next one, and lost to zeros by a power failure.
    cut = lines[2][:50] + lines[3]
    zeros = b"\0" * 400 + b"\n"
    path.write_bytes(b"".join([*lines[:2], cut, lines[4], zeros]))
    with pytest.raises(ValueError, match=r"t: line 3 cannot .*: Expecting .* \(1 more are dam"):
        TrialFile(path, {})
    path.write_bytes(b"".join([*lines[:2], lines[4], zeros]))
    with pytest.raises(ValueError, match=r"t: line 4 cannot be taken: .*[^)]; rem"):
        TrialFile(path, {})
    # What follows the last line's end was not written to its end: it needs no hand.
    path.write_bytes(b"".join([*lines[:2], lines[4], zeros[:-1]]))
    with TrialFile(path, {}) as file:
        assert [seed for _, seed in file.results] == [1, 4]
    assert path.read_bytes() == b"".join([*lines[:2], lines[4]])


def test_a_mission_that_is_there_twice_is_refused(tmp_path: Path, result: TrialResult) -> None:
    path = tmp_path / "t"
    with TrialFile(path, {}) as file:
        for kind, seed in (("clutter", 1), ("clutter", 2), ("maze", 1)):
            file.add(replace(result, kind=kind, mission=replace(result.mission, seed=seed)))
    lines = path.read_bytes().splitlines(keepends=True)
    path.write_bytes(b"".join([*lines, lines[2]]))
    with pytest.raises(
        ValueError, match=r"t: line 5 .*: mission clutter 2 is in line 3 already; remove it"
    ):
        TrialFile(path, {})
    assert path.read_bytes() == b"".join([*lines, lines[2]])


@pytest.mark.parametrize("what", ["pipe", "folder", "device"])
def test_what_is_no_file_is_refused_at_once(what: str, tmp_path: Path) -> None:
    path = tmp_path / "t"
    if what == "pipe":
        os.mkfifo(path)
    elif what == "folder":
        path.mkdir()
    else:
        path.symlink_to("/dev/zero")
    with pytest.raises(ValueError, match=r"t is a folder, a device or a pipe; remove it or use"):
        TrialFile(path, {})


@pytest.mark.parametrize("first", ["nonsense", "\0" * 40, "[" * 100_000])
def test_a_file_without_its_first_line_is_refused(first: str, tmp_path: Path) -> None:
    (tmp_path / "t").write_text(first + "\n")
    with pytest.raises(ValueError, match="t holds no trials; use another --output"):
        TrialFile(tmp_path / "t", {})
    (tmp_path / "t").write_text("null\n")
    with pytest.raises(ValueError, match=r"another configuration \(its first line: null there"):
        TrialFile(tmp_path / "t", {})


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("kind", None),
        ("beam", "12"),
        ("beam", [12.0]),
        ("door", {}),
        ("people", True),
        ("people", 10**400),
        ("shortest", 0.0),
        ("shortest", math.nan),
        ("truth", "perhaps"),
        ("mission.seed", []),
        ("mission.outcome", "WON"),
        ("mission.truthful", 1),
        ("mission.path_length", None),
        ("mission.min_clearance", "0"),
        ("kind", "ofice"),
        ("material", "soft"),
        ("beam", -1.0),
        ("glass", "perhaps"),
        ("people", -1),
        ("way_clearance", math.nan),
        ("shortest", math.inf),
        ("mission.seed", -1),
        ("mission.start_x", math.inf),
        ("mission.perceptions", -1),
        ("mission.path_length", -0.5),
        ("mission.path_length", math.nan),
        ("mission.path_length", 1e300),
        ("mission.min_clearance", -5.0),
        ("mission.min_clearance", math.nan),
        ("mission.contacts", -1),
        ("mission.duration", -1.0),
        ("mission.wall_time", math.inf),
    ],
)
def test_a_value_that_no_trial_has_is_refused(
    name: str, value: object, result: TrialResult
) -> None:
    values = asdict(result)
    assert TrialResult.from_json(json.loads(json.dumps(values))) == result
    group, _, inner = name.partition(".")
    if inner:
        values[group][inner] = value
    else:
        values[name] = value
    with pytest.raises(ValueError, match=name.rpartition(".")[2]):
        TrialResult.from_json(json.loads(json.dumps(values)))


@pytest.mark.parametrize(
    ("truth", "shortest", "outcome", "truthful", "words"),
    [
        ("unreachable", None, "REACHED", True, "truthful must be false where .* unreachable"),
        ("unreachable", None, "UNREACHABLE", False, "truthful must be true where"),
        ("reachable", 3.0, "LIVELOCK", True, "truthful must be false .* outcome LIVELOCK"),
        ("reachable", 3.0, "REACHED", False, "truthful must be true where"),
        ("marginal", 3.0, "UNREACHABLE", True, "truthful must be false where"),
        ("reachable", None, "REACHED", True, "shortest cannot be None where"),
        ("unreachable", 3.0, "UNREACHABLE", True, "shortest cannot be 3.0 where"),
        ("unreachable", None, "UNREACHABLE", True, ""),
        ("reachable", 3.0, "REACHED", True, ""),
        ("marginal", None, "FAILED", False, ""),
        ("marginal", 3.0, "REACHED", True, ""),
    ],
)
def test_values_that_contradict_each_other_are_refused(
    truth: str,
    shortest: float | None,
    outcome: str,
    truthful: bool,
    words: str,
    result: TrialResult,
) -> None:
    mission = replace(result.mission, outcome=outcome, truthful=truthful)
    values = asdict(replace(result, truth=truth, shortest=shortest, mission=mission))
    if words:
        with pytest.raises(ValueError, match=words):
            TrialResult.from_json(values)
    else:
        assert asdict(TrialResult.from_json(values)) == values


@pytest.mark.parametrize(
    ("before", "after", "words"),
    [
        (b'"contacts": 0', b'"contacts": ' + b"9" * 5000, "a whole number of 5000 digits"),
        (b'"contacts": 0', b'"contacts": 0, "contacts": 1', "'contacts' is there twice"),
        (b'"message": "', rb'"message": "\ud800', "message must be a printable text"),
        (b'"message": "', rb'"message": "\u001b[2J', "message must be a printable text"),
        (b'"kind"', b'"\xff"', "'utf-8' codec can't decode"),
    ],
)
def test_a_line_that_means_no_one_thing_is_refused(
    before: bytes, after: bytes, words: str, tmp_path: Path, result: TrialResult
) -> None:
    path = tmp_path / "t"
    with TrialFile(path, {}) as file:
        file.add(result)
    good = path.read_bytes()
    assert before in good
    path.write_bytes(good.replace(before, after))
    with pytest.raises(ValueError, match=rf"t: line 2 cannot be taken: .*{words}.*; remove it"):
        TrialFile(path, {})


@pytest.mark.parametrize(
    ("first", "words"),
    [
        ('{"format": true}', "format: true there, 1 here"),
        ('{"format": 1.0}', r"format: 1\.0 there, 1 here"),
        ('\ufeff{"format": 1}', "holds no trials"),
    ],
)
def test_a_first_line_that_only_counts_as_the_same_is_refused(
    first: str, words: str, tmp_path: Path
) -> None:
    (tmp_path / "t").write_text(first + "\n", encoding="utf-8")
    with pytest.raises(ValueError, match=words):
        TrialFile(tmp_path / "t", {})


def test_a_file_of_something_else_is_left_as_it_is(tmp_path: Path) -> None:
    file = tmp_path / "t"
    file.write_text("a note without end")
    with pytest.raises(ValueError, match="holds no trials"):
        TrialFile(file, {})
    assert file.read_text() == "a note without end"
    # The first line, and the power fails in the middle of it.
    file.write_text('{"format": 1')
    with TrialFile(file, {"a": 1}) as begun:
        assert begun.results == {}
    assert json.loads(file.read_text()) == {"format": 1, "a": 1}


def test_two_campaigns_do_not_write_to_one_file(tmp_path: Path) -> None:
    with (tmp_path / "t").open("a") as other:
        fcntl.flock(other, fcntl.LOCK_EX)
        with pytest.raises(ValueError, match="written to by another campaign"):
            TrialFile(tmp_path / "t", {})
    with TrialFile(tmp_path / "t", {}) as file:
        assert file.results == {}


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


def test_a_result_is_one_flat_row(result: TrialResult) -> None:
    drawn = asdict(result)
    mission = drawn.pop("mission")
    assert result.row() == {**drawn, **mission, "path_ratio": result.path_ratio}
