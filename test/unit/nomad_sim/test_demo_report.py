# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""What the demonstration leaves of a run."""

import json
import math
from pathlib import Path

import numpy as np
import pytest

from fuzzy_map_building.grid import GridGeometry
from fuzzy_map_building.types import Pose2
from fuzzy_navigation.mission_types import LogEntry, Outcome, Stop
from nomad_sim.mission_report import Moment
from nomad_sim.ros import demo, demo_report
from nomad_sim.ros.demo_options import DemoOptions, parse_options
from nomad_sim.ros.demo_report import clear_output, figure_moments, summarise, write_figures
from nomad_sim.ros.mission_record import MapSnapshot, MissionRecord, Verdict

GEOMETRY = GridGeometry(76, 63, 0.1)


@pytest.fixture
def options(tmp_path: Path) -> DemoOptions:
    return parse_options(["--world", "lab_person", "--output", str(tmp_path)])


def record_of(count: int) -> MissionRecord:
    """Return a run with a perception every 10 s, each map grey by its number."""
    record = MissionRecord(simulator={"contacts": "0", "least_clearance": "0.1234"})
    for k in range(count + 1):
        values = np.full(GEOMETRY.shape, k, np.int8)
        # The mapper's clock was a little ahead of the motion's.
        record.motion_maps.append(MapSnapshot(10.0 * k + 0.05, GEOMETRY, values))
        record.planning_maps.append(MapSnapshot(10.0 * k + 0.05, GEOMETRY, values + np.int8(50)))
        record.way.append((10.0 * k, 1.0 + 0.1 * k, 5.0))
    for k in range(1, count + 1):
        pose = Pose2(1.0 + 0.1 * k, 5.0, 0.0)
        stop = Stop.NONE if k == 1 else Stop.UNEXPLORED
        record.log.append(LogEntry(k, 10.0 * k, pose, stop, 0.6, 4.0))
        record.plans.append((10.0 * k + 0.05, np.array([[0.0, 0.0], [float(k), 1.0]])))
    record.way.append((10.0 * count + 5.0, 5.3, 5.4))
    record.time, record.pose = 10.0 * count + 5.0, Pose2(5.3, 5.4, 0.3)
    record.verdict = Verdict(Outcome.REACHED, "there", count, 12.5, math.inf, 99.0)
    return record


@pytest.mark.parametrize(
    ("count", "moments"),
    [(0, []), (2, [2]), (4, [4]), (5, [4, 5]), (9, [4, 5, 9]), (22, [4, 5, 13, 22])],
)
def test_the_moments_are_the_papers_and_the_last(count: int, moments: list[int]) -> None:
    assert figure_moments(count) == moments


def test_each_figure_shows_what_was_known_then(
    options: DemoOptions, monkeypatch: pytest.MonkeyPatch
) -> None:
    drawn: list[list[Moment]] = []
    monkeypatch.setattr(demo_report, "draw_moments", lambda moments, *_: drawn.append(moments))
    monkeypatch.setattr(demo_report, "save_figure", lambda *_: None)
    names = write_figures(record_of(18), options)
    assert names == [f"perception_{k:02d}.png" for k in (4, 5, 13, 18)] + ["maps.png"]
    overview = drawn.pop()
    assert [moment.perceptions for moment in overview] == [4, 5, 13, 18]
    for (moment,), k in zip(drawn, (4, 5, 13, 18), strict=True):
        assert (moment.motion_risk == k / 100.0).all()
        assert (moment.planning_risk == (50 + k) / 100.0).all()
        scene = moment.scene
        assert len(scene.perceptions) == k
        last = k == 18
        assert scene.travelled[-1].tolist() == ([5.3, 5.4] if last else [1.0 + 0.1 * k, 5.0])
        assert len(scene.plan) == (0 if last else 2)
        assert last or scene.plan[1, 0] == k
        # The person is there until 16 perceptions have been taken.
        assert len(scene.circles) == (1 if k <= 16 else 0)


def test_a_run_without_a_perception_leaves_no_figure(options: DemoOptions) -> None:
    assert write_figures(MissionRecord(), options) == []
    assert not list(options.output.glob("*.png"))


def test_the_summary_is_json_that_anything_can_read(options: DemoOptions) -> None:
    record = record_of(5)
    record.parameters["fuzzy_motion"] = {"beta": 0.9, "frames": ("a", "b"), "on": True}
    assert summarise(record, options, "", {"mission": 12.0}, ["a.png"])
    text = (options.output / "summary.json").read_text()
    summary = json.loads(text, parse_constant=pytest.fail)
    assert summary["success"] is True
    assert summary["perceptions"] == len(summary["log"]) == 5
    assert summary["least_true_clearance_m"] == 0.1234
    assert summary["least_measured_clearance_m"] is None  # nothing was near: no number in JSON
    assert summary["parameters"]["fuzzy_motion"] == {"beta": 0.9, "frames": ["a", "b"], "on": True}
    assert summary["wall_durations_s"] == {"mission": 12.0}


@pytest.mark.parametrize("fault", ["contact", "verdict", "none"])
def test_success_needs_the_true_verdict_and_no_contact(options: DemoOptions, fault: str) -> None:
    record = record_of(5)
    if fault == "contact":
        record.simulator = {"contacts": "1", "least_clearance": "0.0"}
    elif fault == "verdict":
        record.verdict = Verdict(Outcome.UNREACHABLE, "no way", 5, 12.5, 0.1, 99.0)
    else:
        record.verdict = None
    assert not summarise(record, options, "no verdict", {}, [])


def test_results_of_an_earlier_run_are_removed_and_nothing_else(tmp_path: Path) -> None:
    for name in ("perception_07.png", "maps.png", "summary.json", "notes.txt", "mine.png"):
        (tmp_path / name).touch()
    clear_output(tmp_path)
    assert {file.name for file in tmp_path.iterdir()} == {"notes.txt", "mine.png"}


@pytest.mark.parametrize("file", ["maps.png", "summary.json"])
def test_a_verdict_is_told_before_it_is_written(
    file: str,
    options: DemoOptions,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    def pretended(*_: object) -> tuple[MissionRecord, str, dict[str, float]]:
        (options.output / file).mkdir()
        return record_of(2), "", {"mission": 1.0}

    monkeypatch.setattr(demo, "_run", pretended)
    assert demo.main(["--world", "lab_person", "--output", str(options.output)]) == 2
    told = capsys.readouterr()
    assert "REACHED (true: reached): there" in told.out
    assert "figures and summary" not in told.out
    assert told.err.startswith(
        f"demo: cannot write '{options.output}/{file}': it is a folder, a device or a pipe; "
    )
    assert told.err.count("\n") == 1
    if file != "summary.json":
        summary = json.loads((options.output / "summary.json").read_text())
        assert (summary["success"], summary["figures"]) == (True, [])
