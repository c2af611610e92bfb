# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""A campaign's results as files: JSON with everything, CSV with a line for each mission."""

from __future__ import annotations

import json
import math
import platform
from collections.abc import Sequence
from dataclasses import asdict, dataclass, fields
from importlib import metadata
from pathlib import Path
from typing import Any

from fuzzy_navigation.mission_types import LogEntry
from nomad_sim.campaign_options import Batch
from nomad_sim.campaign_table import Summary
from nomad_sim.missions import MissionResult
from nomad_sim.output_folder import write_result, write_table
from nomad_sim.reference import MISSIONS

__all__ = [
    "FORMAT",
    "TRIALS_FILE",
    "BatchResults",
    "campaign_document",
    "mission_document",
    "refuse_other_kind",
    "to_json",
    "versions",
    "write_campaign",
]

#: Layout of the documents; raised when a key changes its meaning.
FORMAT = 1
#: Name of the file to which each result of worlds that are drawn goes at once.
TRIALS_FILE = "trials.jsonl"


@dataclass(frozen=True)
class BatchResults:
    """A batch with what came of its missions.

    Parameters
    ----------
    batch : Batch
        What was to be run.
    results : tuple of MissionResult
        In the order of the seeds.
    summary : Summary
        What they amount to.
    """

    batch: Batch
    results: tuple[MissionResult, ...]
    summary: Summary


def versions() -> dict[str, str]:
    """Return the versions that results may depend on, by name."""
    found = {"python": platform.python_version()}
    for name in ("numpy", "numba"):
        try:
            found[name] = metadata.version(name)
        except metadata.PackageNotFoundError:
            found[name] = "none"
    return found


def _finite(value: Any) -> Any:
    """Replace what JSON has no number for by null."""
    if isinstance(value, dict):
        return {key: _finite(entry) for key, entry in value.items()}
    if isinstance(value, (list, tuple)):
        return [_finite(entry) for entry in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value


def to_json(document: dict[str, Any]) -> str:
    """Return a document as JSON text; numbers that are not finite become null."""
    return json.dumps(_finite(document), indent=2, allow_nan=False) + "\n"


def _settings(batch: Batch) -> dict[str, Any]:
    spec = batch.specs[0]
    return {
        "preset": spec.preset,
        "start_spread": spec.start_spread,
        "mapper": dict(spec.mapper),
        "planner": dict(spec.planner),
        "motion": dict(spec.motion),
        "simulator": dict(spec.simulator),
        "critical_angles": {n: m.critical_angle for n, m in spec.world.materials.items()},
    }


def campaign_document(done: Sequence[BatchResults]) -> dict[str, Any]:
    """Return all results, with what is needed to run each mission again."""
    return {
        "format": FORMAT,
        "versions": versions(),
        "batches": [
            {
                "name": d.batch.name,
                "description": d.batch.description,
                "method": (
                    None
                    if d.batch.method is None
                    else {"reached": d.batch.method, "missions": MISSIONS}
                ),
                "settings": _settings(d.batch),
                "summary": asdict(d.summary),
                "missions": [
                    asdict(r) | {"replay": d.batch.replay_command(r.seed)} for r in d.results
                ],
            }
            for d in done
        ],
    }


def mission_document(
    batch: Batch, result: MissionResult, entries: Sequence[LogEntry]
) -> dict[str, Any]:
    """Return one mission with its perceptions."""
    return {
        "format": FORMAT,
        "versions": versions(),
        "name": batch.name,
        "settings": _settings(batch),
        "mission": asdict(result) | {"replay": batch.replay_command(result.seed)},
        "perceptions": [asdict(entry) | {"stop": entry.stop.name.lower()} for entry in entries],
    }


def refuse_other_kind(folder: Path, drawn: bool) -> None:
    """Refuse a folder with results that those of this campaign would be mixed with.

    Parameters
    ----------
    folder : Path
        Where the results are to go.
    drawn : bool
        Whether they are of worlds or places that are drawn, and not of ``--world`` or
        ``--reference``.

    Raises
    ------
    ValueError
        If results of the other kind are there.
    """
    there = (folder / TRIALS_FILE).exists()
    if drawn and not there and (folder / "campaign.json").exists():
        raise ValueError(
            f"--output {folder} holds a campaign.json without {TRIALS_FILE}, as of --world or "
            "--reference, or of trials that were removed; use another --output"
        )
    if there and not drawn:
        raise ValueError(
            f"--output {folder} holds results of --generated or --floor-plan ({TRIALS_FILE}); "
            "use another --output"
        )


def write_campaign(folder: Path, done: Sequence[BatchResults]) -> list[Path]:
    """Write campaign.json and missions.csv into a folder.

    Returns
    -------
    list of Path
        The files.

    Raises
    ------
    OSError
        If one cannot be written; an older one is then still there.
    """
    document, table = folder / "campaign.json", folder / "missions.csv"
    write_result(document, to_json(campaign_document(done)))
    columns = ["name", *(field.name for field in fields(MissionResult)), "replay"]
    rows = [
        {"name": d.batch.name, **asdict(r), "replay": d.batch.replay_command(r.seed)}
        for d in done
        for r in d.results
    ]
    write_table(table, columns, rows)
    return [document, table]
