# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""The campaign as it is called: results, files, replays, exit codes, refusals."""

import contextlib
import csv
import ctypes
import json
import os
import shlex
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import pytest

from fuzzy_map_building.params import DEFAULT_PRESET, PAPER_PRESET
from nomad_sim import campaign
from nomad_sim.campaign import main
from nomad_sim.missions import MissionResult, MissionSpec, run_spec
from nomad_sim.world_io import load_world

SEEDS = ["--seeds", "3", "--first-seed", "5"]


def run_json(capsys: pytest.CaptureFixture[str], *arguments: str) -> tuple[int, Any]:
    code = main([*arguments, "--json"])
    return code, json.loads(capsys.readouterr().out)


def timeless(mission: dict[str, Any]) -> dict[str, Any]:
    """What does not depend on how fast the machine is, or on where it was called from."""
    return {k: v for k, v in mission.items() if k not in ("wall_time", "replay")}


def test_jobs_change_nothing_but_the_time(small: Path, capsys: pytest.CaptureFixture[str]) -> None:
    runs = [run_json(capsys, "--world", str(small), *SEEDS, "--jobs", jobs) for jobs in "112"]
    missions = [[timeless(m) for m in run[1]["batches"][0]["missions"]] for run in runs]
    assert [run[0] for run in runs] == [0, 0, 0]
    assert missions[0] == missions[1] == missions[2]
    assert [m["seed"] for m in missions[0]] == [5, 6, 7]
    assert len({m["start_x"] for m in missions[0]}) == 3
    assert {m["outcome"] for m in missions[0]} == {"REACHED"}


def test_without_spread_each_starts_as_the_world_says(
    small: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    _, document = run_json(
        capsys, "--world", str(small), *SEEDS, "--start-spread", "0", "--jobs", "1"
    )
    starts = {
        (m["start_x"], m["start_y"], m["start_heading"])
        for m in document["batches"][0]["missions"]
    }
    assert starts == {(0.7, 0.7, 0.0)}


def test_files_hold_every_mission_and_the_command_that_repeats_it(
    small: Path,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    folder = tmp_path / "new" / "results"
    options = ["--set", "simulator.sonar.beam_half_angle=12deg", "--critical-angle", "glass=9"]
    assert main(["--world", str(small), *SEEDS, *options, "--output", str(folder)]) == 0
    table = capsys.readouterr().out
    assert "reached 3 of 3" in table
    document = json.loads((folder / "campaign.json").read_text())
    (batch,) = document["batches"]
    assert batch["summary"]["reached"] == 3
    assert batch["settings"]["simulator"] == {"sonar.beam_half_angle": pytest.approx(0.2094395)}
    assert batch["settings"]["critical_angles"]["glass"] == pytest.approx(0.1570796)
    with (folder / "missions.csv").open(newline="") as file:
        rows = list(csv.DictReader(file))
    assert [row["seed"] for row in rows] == ["5", "6", "7"]
    assert {row["name"] for row in rows} == {"small"}

    words = shlex.split(rows[1]["replay"])
    assert words[:4] == ["ros2", "run", "nomad_sim", "campaign"]
    monkeypatch.chdir(tmp_path)
    assert main(words[4:]) == 0
    told = capsys.readouterr().out
    mission = json.loads((tmp_path / "seed_6" / "mission.json").read_text())
    assert timeless(mission["mission"]) == timeless(batch["missions"][1])
    assert mission["settings"] == batch["settings"]
    assert len(mission["perceptions"]) == batch["missions"][1]["perceptions"]
    assert told.count("perception ") == len(mission["perceptions"])
    assert (tmp_path / "seed_6" / "mission.png").read_bytes().startswith(b"\x89PNG")
    assert not list((tmp_path / "seed_6").glob("perception_*.png"))


def test_a_replay_can_be_drawn_at_every_perception(
    small: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    code, document = run_json(
        capsys, "--world", str(small), "--replay", "6", "--output", str(tmp_path / "out"),
        "--figures", "every",
    )  # fmt: skip
    assert code == 0
    figures = sorted(file.name for file in (tmp_path / "out").glob("*.png"))
    count = document["mission"]["perceptions"]
    assert figures == ["mission.png"] + [f"perception_{k:03d}.png" for k in range(1, count + 1)]


def test_a_replay_without_a_folder_only_tells(
    small: Path,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.chdir(tmp_path)
    before = sorted(tmp_path.iterdir())
    assert main(["--world", str(small), "--replay", "6"]) == 0
    assert "REACHED" in capsys.readouterr().out
    assert sorted(tmp_path.iterdir()) == before


def test_parameters_reach_the_mission(small: Path, capsys: pytest.CaptureFixture[str]) -> None:
    code, document = run_json(
        capsys, "--world", str(small), "--seeds", "1", "--set", "motion.perception_cap=1"
    )
    (mission,) = document["batches"][0]["missions"]
    assert code == 1
    assert (mission["outcome"], mission["perceptions"]) == ("UNREACHABLE", 1)
    assert mission["truthful"] is False


def test_a_verdict_that_is_not_true_is_a_failure(
    misjudged: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    arguments = ["--world", str(misjudged)]
    assert main([*arguments, "--seeds", "1"]) == 1
    assert "true verdicts 0 of 1" in capsys.readouterr().out
    assert main([*arguments, "--replay", "1"]) == 1


def test_a_contact_is_a_failure(small: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def touching(spec: MissionSpec) -> MissionResult:
        return replace(run_spec(spec), contacts=int(spec.seed == 6))

    monkeypatch.setattr(campaign, "run_spec", touching)
    arguments = ["--world", str(small), "--jobs", "1"]
    assert main([*arguments, "--seeds", "1", "--first-seed", "5"]) == 0
    assert main([*arguments, "--seeds", "2", "--first-seed", "5"]) == 1


@pytest.mark.parametrize(
    ("reached", "contacts", "code"), [(17, 0, 0), (16, 0, 1), (20, 1, 1), (20, 0, 0)]
)
def test_a_reference_row_is_held_to_the_share_of_the_method(
    reached: int,
    contacts: int,
    code: int,
    small: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    log = run_spec(MissionSpec(load_world(small), 1, PAPER_PRESET))

    def pretended(spec: MissionSpec) -> MissionResult:
        there = spec.seed <= reached
        outcome = "REACHED" if there else "LIVELOCK"
        touches = contacts if spec.seed == 1 else 0
        return replace(
            log, seed=spec.seed, outcome=outcome, truthful=there, contacts=touches, message="so"
        )

    monkeypatch.setattr(campaign, "run_spec", pretended)
    paper = ["--preset", PAPER_PRESET]
    assert main(["--reference", "--row", "gaps_0.75", "--jobs", "1", *paper]) == code
    lines = capsys.readouterr().out.splitlines()
    assert "17 of 20" in lines[1]
    assert f"{reached} of 20" in lines[1]
    flaws = [int(line.split(":")[0].split()[1]) for line in lines[2::2]]
    assert flaws == [1] * bool(contacts) + list(range(reached + 1, 21))
    for seed, told, again in zip(flaws, lines[2::2], lines[3::2], strict=True):
        assert told.endswith(", so")
        assert f"--row gaps_0.75 --preset {PAPER_PRESET}" in again
        assert f"--replay {seed} --output seed_{seed}" in again


@pytest.mark.parametrize(
    ("preset", "reached"), [(DEFAULT_PRESET, [20, 20]), (PAPER_PRESET, [20, 5])]
)
def test_a_reference_row_runs_in_its_own_world(
    preset: str, reached: list[int], capsys: pytest.CaptureFixture[str]
) -> None:
    code, document = run_json(
        capsys, "--reference", "--row", "clutter", "--row", "slalom_0.70", "--seeds", "1",
        "--set", "motion.perception_cap=1", "--preset", preset,
    )  # fmt: skip
    assert code == 1
    assert [batch["name"] for batch in document["batches"]] == ["clutter", "slalom_0.70"]
    assert [batch["method"]["reached"] for batch in document["batches"]] == reached
    replay = document["batches"][0]["missions"][0]["replay"]
    assert "--reference --row clutter" in replay


def test_a_fresh_first_seed_is_said(small: Path, capsys: pytest.CaptureFixture[str]) -> None:
    firsts = []
    for _ in range(2):
        assert main(["--world", str(small), "--seeds", "1", "--fresh"]) == 0
        told = capsys.readouterr().out
        firsts.append(told.splitlines()[0].split("seeds ")[1].split()[0])
        assert told.splitlines()[3].split()[0] == firsts[-1]
    assert firsts[0] != firsts[1]


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ("", "either --world, --reference"),
        ("--world lab --reference", "either --world, --reference"),
        ("--wrld lab", "unknown argument '--wrld'; did you mean '--world'?"),
        ("--world lab --sedes=3", "unknown argument '--sedes'; did you mean '--seeds'?"),
        ("--world lab more", "unknown argument 'more'"),
        ("--world labb", "unknown world 'labb'; did you mean 'lab'?"),
        ("--world no/such.yaml", "cannot read world"),
        ("--world lab --preset orolo1998", "did you mean 'oriolo1998'?"),
        ("--world lab --set mapper.evidence.kempty=1", "did you mean 'evidence.k_empty'?"),
        ("--world lab --set mappr.evidence.k_empty=1", "did you mean 'mapper'?"),
        ("--world lab --set planner.epsilon=much", "'epsilon' must be a number"),
        ("--world lab --set motion.clearance.rule=strickt", "did you mean 'strict'?"),
        ("--world lab --set simulator.seed=3", "--first-seed"),
        ("--world lab --critical-angle glas=3", "did you mean 'glass'?"),
        ("--world lab --critical-angle glass=0", "must be above 0 and at most 90 deg"),
        ("--world lab --seeds many", "must be a whole number, got 'many'"),
        ("--world lab --seeds 0", "--seeds must be from 1 to"),
        ("--world lab --first-seed -1", "a seed must be from 0 to"),
        ("--world lab --first-seed 1 --fresh", "either --first-seed or --fresh"),
        ("--world lab --jobs 0", "--jobs must be at least 1"),
        ("--world lab --start-spread nan", "must be a finite number, got 'nan'"),
        ("--world lab --start-spread -1", "--start-spread must be from 0"),
        ("--world lab --row clutter", "--row chooses among"),
        ("--reference --row cluter", "unknown row 'cluter'; did you mean 'clutter'?"),
        ("--reference --replay 3", "needs one --row"),
        ("--world lab --replay 3 --fresh", "--replay names its seed"),
        ("--world lab --replay -3", "a seed must be from 0 to"),
        ("--world lab --figures every", "--figures draws what --replay runs"),
        ("--world lab --replay 3 --figures all --output out", "invalid choice: 'all'"),
        ("--world lab --output /dev/null", "--output /dev/null is no folder: a file"),
        ("--world lab --output /dev/null/a", "cannot make this folder: Not a directory"),
        ("--world lab --output=", "--output '' names no folder"),
        ("--world lab --output /proc", "--output /proc: cannot write there: "),
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
    assert told.err.startswith("campaign: ")
    assert told.err.count("\n") == 1
    assert message in told.err


def test_a_folder_that_cannot_be_written_is_told(
    small: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    with pytest.raises(SystemExit, match="2"):
        main(["--world", str(small), "--seeds", "1", "--output", f"{small}/below"])
    assert capsys.readouterr().err.splitlines()[-1].startswith("campaign: ")


def children_of(pid: int) -> list[int]:
    """Processes whose parent it is, from /proc."""
    found = []
    for entry in Path("/proc").glob("[0-9]*/stat"):
        with contextlib.suppress(OSError):
            fields = entry.read_text().rpartition(")")[2].split()
            if int(fields[1]) == pid and fields[0] != "Z":
                found.append(int(entry.parent.name))
    return found


def alive(pid: int) -> bool:
    try:
        return "\nState:\tZ" not in Path(f"/proc/{pid}/status").read_text()
    except OSError:
        return False


def wait_until(condition: Any, timeout: float = 60.0) -> bool:
    end = time.monotonic() + timeout
    while not condition():
        if time.monotonic() > end:
            return False
        time.sleep(0.05)
    return True


@contextlib.contextmanager
def many_missions(world: Path, progress: Path) -> Iterator[subprocess.Popen[str]]:
    """A campaign in a process group of its own that is not over soon."""
    options = ["--world", str(world), "--seeds", "5000", "--jobs", "2"]
    with progress.open("w") as file:
        process = subprocess.Popen(
            [sys.executable, "-m", "nomad_sim.campaign", *options],
            stdout=subprocess.DEVNULL,
            stderr=file,
            text=True,
            start_new_session=True,
        )
    try:
        yield process
    finally:
        with contextlib.suppress(ProcessLookupError):
            os.killpg(process.pid, signal.SIGKILL)
        process.wait()


@dataclass
class Running:
    """A campaign that has begun to give results."""

    process: subprocess.Popen[str]
    workers: list[int]
    progress: Path


@pytest.fixture
def running(small: Path, tmp_path: Path) -> Iterator[Running]:
    progress = tmp_path / "progress"
    with many_missions(small, progress) as process:
        begun = wait_until(lambda: "of 1]" in progress.read_text() or process.poll() is not None)
        assert begun, progress.read_text()
        workers = children_of(process.pid)
        assert len(workers) >= 2, progress.read_text()
        yield Running(process, workers, progress)


@pytest.mark.parametrize(
    ("number", "code", "whole_group"), [(signal.SIGINT, 130, True), (signal.SIGTERM, 143, False)]
)
def test_a_signal_leaves_no_process_behind(
    running: Running, number: signal.Signals, code: int, whole_group: bool
) -> None:
    if whole_group:  # as the terminal does on Ctrl-C
        os.killpg(running.process.pid, number)
    else:
        running.process.send_signal(number)
    assert running.process.wait(10.0) == code
    assert wait_until(lambda: not any(alive(pid) for pid in running.workers), 5.0)
    assert "Traceback" not in running.progress.read_text()


def test_ctrl_c_while_the_workers_start_is_as_clean(small: Path, tmp_path: Path) -> None:
    progress = tmp_path / "progress"
    with many_missions(small, progress) as process:
        # Two children: what cleans up after multiprocessing, and the first worker.
        assert wait_until(lambda: len(children_of(process.pid)) >= 2)
        children = children_of(process.pid)
        os.killpg(process.pid, signal.SIGINT)
        assert process.wait(10.0) == 130
        assert wait_until(lambda: not any(alive(pid) for pid in children), 5.0)
    assert "Traceback" not in progress.read_text()


@pytest.mark.parametrize(("number", "code"), [(signal.SIGINT, 130), (signal.SIGTERM, 143)])
def test_a_signal_that_meets_a_callback_of_compiled_code_is_not_lost(
    number: signal.Signals, code: int, small: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def interrupted(_spec: MissionSpec) -> MissionResult:
        # No exception comes out of it.
        ctypes.CFUNCTYPE(None)(lambda: signal.raise_signal(number))()
        time.sleep(20.0)
        raise AssertionError("the campaign went on")

    monkeypatch.setattr(campaign, "run_spec", interrupted)
    arguments = ["--world", str(small), "--seeds", "1", "--jobs", "1"]
    if number == signal.SIGINT:
        assert main(arguments) == code
    else:
        with pytest.raises(SystemExit, match=str(code)):
            main(arguments)


def test_workers_end_when_the_campaign_is_no_more(running: Running) -> None:
    running.process.kill()
    assert wait_until(lambda: not any(alive(pid) for pid in running.workers), 20.0)
    assert "Traceback" not in running.progress.read_text()
