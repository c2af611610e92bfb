# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Results that cannot be written: they are told first, and no file is left half written.

A file that cannot be replaced is one whose name a folder has: that also holds for root.
"""

import contextlib
import json
import resource
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path

import pytest
from matplotlib.figure import Figure

from fuzzy_map_building.params import DEFAULT_PRESET
from nomad_sim import campaign
from nomad_sim.campaign import main
from nomad_sim.missions import MissionResult, MissionSpec, run_spec
from nomad_sim.output_folder import write_result, write_table
from nomad_sim.render import save_figure
from nomad_sim.trial_file import TrialFile
from nomad_sim.trials import Rules, Trial, TrialResult, run_trial
from nomad_sim.world_io import load_world

CAPPED = ["--set", "motion.perception_cap=1", "--jobs", "1"]
FOLDER = "it is a folder, a device or a pipe"
AGAIN = "see to that and run the same command again"


@contextlib.contextmanager
def largest_file(size: int) -> Iterator[None]:
    """Stand in for a full disk: no file grows beyond a size [bytes]."""
    soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (size, hard))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))


@pytest.fixture(scope="module")
def results() -> list[TrialResult]:
    """Two results."""
    one = run_trial(Trial("clutter", 1, Rules(DEFAULT_PRESET, motion={"perception_cap": 1})))
    return [one, replace(one, mission=replace(one.mission, seed=2))]


@pytest.mark.parametrize(
    "write",
    [
        lambda file: write_result(file, "new" * 1000),
        lambda file: write_table(file, ["a"], [{"a": "new"}] * 1000),
        lambda file: save_figure(Figure(), file),
    ],
)
def test_a_file_is_the_old_one_or_the_new_one(
    write: Callable[[Path], None], tmp_path: Path
) -> None:
    file = tmp_path / "result"
    file.write_text("old")
    with (
        largest_file(100),
        pytest.raises(OSError, match=f"cannot write '{file}': File too large; {AGAIN}"),
    ):
        write(file)
    assert [(f.name, f.read_text()) for f in tmp_path.iterdir()] == [("result", "old")]
    write(file)
    assert file.stat().st_size > 100


def test_missions_before_one_that_cannot_be_written_are_kept(
    tmp_path: Path, results: list[TrialResult]
) -> None:
    path = tmp_path / "t"
    first, second = results
    with TrialFile(path, {}) as file:
        file.add(first)
        whole = path.stat().st_size
        with (
            largest_file(whole + 40),
            pytest.raises(OSError, match=f"cannot write {path}: File too large"),
        ):
            file.add(second)
        assert list(file.results) == [("clutter", 1)]
    assert path.stat().st_size == whole + 40  # a part of it, and no more when it is closed
    with TrialFile(path, {}) as file:
        assert file.results == {("clutter", 1): first}
        file.add(second)
    with TrialFile(path, {}) as file:
        assert list(file.results) == [("clutter", 1), ("clutter", 2)]


def test_a_campaign_that_cannot_go_on_says_what_is_kept(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    arguments = ["--generated", "3", "--kind", "clutter", *CAPPED, "--output", str(tmp_path)]
    with largest_file(1500):  # a trial takes about 600 bytes
        assert main(arguments) == 2
    told = capsys.readouterr()
    kept = (tmp_path / "trials.jsonl").read_bytes().count(b"\n") - 1
    assert told.out == ""
    assert told.err.splitlines()[-1] == (
        f"campaign: cannot write {tmp_path}/trials.jsonl: File too large; {tmp_path}/trials.jsonl "
        f"keeps the {kept} missions so far, the same command goes on from there"
    )
    assert main(arguments) == 1
    assert "reached: goals that can be" in capsys.readouterr().out


@pytest.mark.parametrize("what", [["--generated", "1", "--kind", "clutter"], ["--world", "lab"]])
@pytest.mark.parametrize("as_json", [False, True])
def test_a_report_is_told_before_it_is_written(
    what: list[str], as_json: bool, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    seeds = ["--seeds", "1"] if "--world" in what else []
    arguments = [*what, *seeds, *CAPPED, "--output", str(tmp_path), *["--json"] * as_json]
    (tmp_path / "missions.csv").mkdir()
    assert main(arguments) == 2
    told = capsys.readouterr()
    if as_json:
        assert json.loads(told.out)["format"] == 1
    else:
        assert "most that 'perception_cap' allows" in told.out
    assert told.err.splitlines()[-1] == (
        f"campaign: cannot write '{tmp_path}/missions.csv': {FOLDER}; {AGAIN}"
    )
    assert not list(tmp_path.glob(".*"))
    (tmp_path / "missions.csv").rmdir()
    assert main(arguments) == 1


def test_rows_go_on_without_their_files_and_are_written_when_it_goes(
    small: Path,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    log = run_spec(MissionSpec(load_world(small), 1, DEFAULT_PRESET))
    blocked = tmp_path / "campaign.json"
    blocked.mkdir()

    def pretended(spec: MissionSpec) -> MissionResult:
        if spec.world.name == "office":
            blocked.rmdir()
        return replace(log, seed=spec.seed)

    monkeypatch.setattr(campaign, "run_spec", pretended)
    rows = ["--row", "clutter", "--row", "office", "--seeds", "1", "--jobs", "1"]
    assert main(["--reference", *rows, "--output", str(tmp_path)]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert [line.split()[0] for line in lines] == ["row", "clutter", "office"]
    assert len(json.loads(blocked.read_text())["batches"]) == 2


@pytest.mark.parametrize("file", ["mission.json", "mission.png", "perception_001.png"])
def test_a_replay_tells_its_verdict_before_it_writes(
    file: str, small: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    folder = tmp_path / "out"
    (folder / file).mkdir(parents=True)
    arguments = ["--world", str(small), "--replay", "6", "--output", str(folder)]
    assert main([*arguments, "--figures", "every"]) == 2
    told = capsys.readouterr()
    assert "REACHED" in told.out
    assert told.err == f"campaign: cannot write '{folder}/{file}': {FOLDER}; {AGAIN}\n"
    assert (folder / "mission.json").is_file() == (file != "mission.json")
