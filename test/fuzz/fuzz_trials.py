# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""The results of a campaign on disk: taken up again, or refused and left as they were."""

from __future__ import annotations

import contextlib
import json
from collections.abc import Iterator, Sequence
from dataclasses import asdict

from fuzz.draw import Draw, spoilt
from fuzz.surface import Surface, Target, check_words, scratch_folder
from nomad_sim.missions import MissionResult
from nomad_sim.trial_file import FORMAT, TrialFile
from nomad_sim.trial_report import report, report_lines
from nomad_sim.trials import TrialResult

__all__ = ["SURFACES"]

CONFIGURATION = {"origin": {"recipe": 1}, "rules": {"preset": "oriolo1998", "mapper": {}}}
HEADER = {"format": FORMAT, **CONFIGURATION}
RESULT = TrialResult(
    kind="office",
    material="rough",
    beam=12.5,
    door=0.8,
    glass="none",
    people=0,
    truth="reachable",
    way_clearance=0.12,
    shortest=7.5,
    mission=MissionResult(
        seed=1,
        start_x=1.0,
        start_y=2.0,
        start_heading=0.1,
        outcome="REACHED",
        truthful=True,
        perceptions=11,
        path_length=8.0,
        min_clearance=0.1,
        contacts=0,
        duration=60.0,
        wall_time=1.0,
        message="at the goal",
    ),
)


def _content(data: bytes) -> bytes:
    """The first byte says whether the others are the file, or how to spoil a good one."""
    if data[:1] < b"\x60":
        return data[1:]
    draw = Draw(data[1:])
    header = spoilt(draw, HEADER) if draw.one_in(6) else HEADER
    lines = [json.dumps(header)]
    for k in range(draw.below(4)):
        good = asdict(RESULT)
        good["mission"]["seed"] = k
        lines.append(json.dumps(spoilt(draw, good) if draw.byte() % 2 else good))
    return "\n".join(lines).encode("utf-8", "replace") + b"\n" * (draw.byte() % 4 > 0)


@contextlib.contextmanager
def _opened() -> Iterator[Target]:
    with scratch_folder() as folder:
        path = folder / "trials.jsonl"

        def target(data: bytes) -> None:
            content = _content(data)
            path.write_bytes(content)
            try:
                file = TrialFile(path, CONFIGURATION)
            except ValueError as error:
                check_words(error)
                assert path.read_bytes() == content, "what is refused is not to be touched"
                return
            with file:
                kept = path.read_bytes()
                assert content.startswith(kept) or not content.endswith(b"\n")
                if ("office", 1) not in file.results:
                    file.add(RESULT)
                results = list(file.results.values())
            tallies = report(results)
            assert report_lines(tallies)
            assert sum(t.missions for t in tallies if t.group in ("all", "marginal")) == len(
                results
            )
            with TrialFile(path, CONFIGURATION) as again:
                assert list(map(repr, again.results.values())) == list(map(repr, results))

        yield target


def _seeds() -> Sequence[bytes]:
    header, good = json.dumps(HEADER).encode() + b"\n", json.dumps(asdict(RESULT)).encode() + b"\n"
    return [
        b"\0" + header + good,
        b"\0" + header,
        b"\0" + header + good[:50],
        b"\0something else",
        b"\0" + header + b"[" * 2000 + b"\n",
        b"\0" + header + good.replace(b"7.5", b"0.0"),
        b"\0" + header + good.replace(b"7.5", b"NaN"),
        b"\0" + header + good.replace(b"11", b"1" + b"0" * 400),
        b"\xff",
        b"\xff" + bytes(range(256)),
    ]


SURFACES = (
    Surface(
        "trials",
        _opened,
        _seeds,
        (
            *(b"\n", b"{", b"}", b"[", b"]", b'"', b": ", b"null", b"NaN", b"-Infinity", b"1e999"),
            *(b'"mission"', b'"seed"', b'"shortest"', b'"truth"', b'"unreachable"', b"\0"),
        ),
    ),
)
