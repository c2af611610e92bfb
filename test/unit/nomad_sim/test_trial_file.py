# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""The file of trials: taken up as it was written, or refused and left as it is."""

import fcntl
import json
import math
import os
from dataclasses import asdict, replace
from pathlib import Path

import pytest

from fuzzy_map_building.params import DEFAULT_PRESET
from nomad_sim.trial_file import TrialFile
from nomad_sim.trials import Rules, Trial, TrialResult, run_trial


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


def test_a_result_is_one_flat_row(result: TrialResult) -> None:
    drawn = asdict(result)
    mission = drawn.pop("mission")
    assert result.row() == {**drawn, **mission, "path_ratio": result.path_ratio}
