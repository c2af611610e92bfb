# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""The studies that reproduce the paper: each runs, and what can be relied upon holds."""

from __future__ import annotations

import os
import re
import struct
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from matplotlib.figure import Figure

from fuzzy_map_building.jit import compiled
from studies.mission_study import crosses_opening, length
from studies.study import Options, Study

STUDIES = Path(__file__).resolve().parents[1] / "studies"
VERDICT = re.compile(r"^(holds|does not hold) +([a-z]+): (.+)$", re.MULTILINE)
#: Longest run of a quick study on a busy machine [s]; in plain Python one takes 30 s alone.
LONGEST = 110.0 if compiled() else 300.0

#: Claims that hold whatever the seed. The others are the paper's luck as much as ours: a study
#: tells how each came out, and no test asks for them.
RELIABLE = {
    "ablation": {"complete"},
    "experiment1": {"reached", "perceptions", "time", "direct", "detour", "opening", "accurate"},
    "experiment2": {"reached", "contact", "alternative", "fails", "passes", "erased"},
    "faults": {"contact", "verdict"},
    "figure8": {"perceptions", "walls", "grey", "reflections"},
    "simulation1": {"longer", "riskier", "fewest", "most"},
    "simulation2": {"longest", "start", "fewest", "most"},
}


@pytest.mark.timeout(LONGEST + 10.0)
@pytest.mark.parametrize("name", RELIABLE)
def test_a_study_runs_and_its_reliable_claims_hold(name: str, tmp_path: Path) -> None:
    done = subprocess.run(
        [sys.executable, STUDIES / f"{name}.py", "--quick", "--output", tmp_path],
        capture_output=True,
        text=True,
        timeout=LONGEST,
        env=os.environ | {"PYTHONWARNINGS": "error"},
    )
    assert done.returncode == 0, done.stdout + done.stderr
    verdicts = {claim: verdict for verdict, claim, _ in VERDICT.findall(done.stdout)}
    failed = {claim for claim in RELIABLE[name] if verdicts[claim] != "holds"}
    assert failed == set(), done.stdout

    table = (tmp_path / f"{name}.md").read_text(encoding="utf-8")
    assert "paper" in table
    for claim, verdict in verdicts.items():
        # A line of the study's own table may begin with the same word: that of the claim is last.
        line = [row for row in table.splitlines() if row.startswith(f"| {claim} |")][-1]
        assert ("**does not hold**" in line) == (verdict == "does not hold")
    png = (tmp_path / f"{name}.png").read_bytes()
    assert png.startswith(b"\x89PNG\r\n\x1a\n")
    width, height = struct.unpack(">II", png[16:24])
    assert min(width, height) >= 500
    assert sorted(file.name for file in tmp_path.iterdir()) == [f"{name}.md", f"{name}.png"]


def test_every_study_is_tested() -> None:
    scripts = {file.stem for file in STUDIES.glob("*.py") if "__main__" in file.read_text("utf-8")}
    assert scripts == set(RELIABLE)


def test_a_claim_that_fails_is_told_and_is_no_error(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    study = Study("sample", "A sample", Options(quick=True, seed=0, output=tmp_path, jobs=1))
    study.row("legs", "4", "5")
    study.claim("legs", "it has as many legs", 4 == 5, "5")
    study.claim("eyes", "it has as many eyes", True, "2")
    assert study.finish(Figure()) == 0
    printed = VERDICT.findall(capsys.readouterr().out)
    assert [(verdict, claim) for verdict, claim, _ in printed] == [
        ("does not hold", "legs"),
        ("holds", "eyes"),
    ]
    assert "| legs     | 4     | 5    |" in (tmp_path / "sample.md").read_text("utf-8")
    with pytest.raises(ValueError, match="3 cells"):
        study.row("legs", "4")


def test_a_study_tells_what_it_cannot_write(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    study = Study("sample", "A sample", Options(quick=True, seed=0, output=tmp_path, jobs=1))
    study.claim("eyes", "it has as many eyes", True, "2")
    (tmp_path / "sample.md").mkdir()
    assert study.finish(Figure()) == 2
    told = capsys.readouterr()
    assert VERDICT.findall(told.out) == [("holds", "eyes", "it has as many eyes (2)")]
    assert "written to" not in told.out
    assert told.err.startswith(
        f"sample: cannot write '{tmp_path}/sample.md': it is a folder, a device or a pipe"
    )


@pytest.mark.parametrize(
    ("path", "through"),
    [
        ([(3.0, 2.6), (4.5, 2.7)], True),
        ([(4.5, 2.7), (3.7, 2.3), (3.0, 2.6)], True),
        ([(3.0, 3.0), (4.4, 3.6)], False),  # at x = 3.7 it is at y = 3.3, in the obstacle
        ([(3.0, 2.6), (3.6, 2.6), (3.0, 2.6)], False),
        ([(3.0, 5.0), (4.5, 5.0)], False),
    ],
)
def test_where_a_path_crosses(path: list[tuple[float, float]], through: bool) -> None:
    assert crosses_opening(np.array(path)) is through


def test_length_of_a_path() -> None:
    assert length(np.array([(0.0, 0.0), (3.0, 4.0), (3.0, 5.0)])) == pytest.approx(6.0)


@pytest.mark.parametrize("option", [["--seed", "-1"], ["--jobs", "0"], ["--seed", "x"]])
def test_a_senseless_option_is_refused(option: list[str]) -> None:
    done = subprocess.run(
        [sys.executable, STUDIES / "simulation2.py", *option],
        capture_output=True,
        text=True,
        timeout=60,
    )
    assert done.returncode == 2
    assert option[0] in done.stderr
