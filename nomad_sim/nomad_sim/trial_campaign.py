# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""A campaign of trials: run what is missing, report on all, write tables."""

from __future__ import annotations

import sys
from collections.abc import Iterator, Sequence
from contextlib import ExitStack
from dataclasses import asdict
from pathlib import Path
from typing import Any

from tqdm import tqdm

from nomad_sim.campaign_files import FORMAT, TRIALS_FILE, to_json, versions
from nomad_sim.cluster import run_on_cluster
from nomad_sim.output_folder import write_result, write_table
from nomad_sim.trial_file import TrialFile
from nomad_sim.trial_report import Tally, report, report_lines
from nomad_sim.trials import Trial, TrialBatch, TrialResult, run_trial
from nomad_sim.workers import run_in_parallel

__all__ = ["run_trials"]

#: Most missions that are told one by one.
_TOLD = 20


def run_trials(
    batch: TrialBatch, jobs: int, cluster: str | None, output: Path | None, as_json: bool
) -> int:
    """Run the trials that are not in the output folder yet; print and write the report.

    Parameters
    ----------
    batch : TrialBatch
        The trials.
    jobs : int
        Most processes at a time.
    cluster : str or None
        Address of a Dask scheduler whose workers run them instead.
    output : Path or None
        Folder for results.
    as_json : bool
        Whether standard output gets JSON in place of tables.

    Returns
    -------
    int
        0 if every trial was flawless, else 1.

    Raises
    ------
    ValueError
        If the folder holds trials of another configuration, or one cannot be.
    OSError
        If workers or a cluster are lost, or a result cannot be written.
    """
    results: dict[tuple[str, int], TrialResult] = {}
    with ExitStack() as stack:
        file = None
        if output is not None:
            file = stack.enter_context(TrialFile(output / TRIALS_FILE, batch.configuration))
            results = file.results
        missing = [t for t in batch.trials if (t.kind, t.seed) not in results]
        done = len(batch.trials) - len(missing)
        bar = stack.enter_context(
            tqdm(
                total=len(batch.trials),
                initial=done,
                desc=batch.name,
                unit="mission",
                file=sys.stderr,
            )
        )
        flaws = 0
        try:
            for result in _run(missing, jobs, cluster):
                if file is not None:
                    file.add(result)
                else:
                    results[result.kind, result.mission.seed] = result
                flaws += not result.flawless
                bar.set_postfix(flaws=flaws)
                bar.update()
        except OSError as error:
            raise OSError(f"{error}{_kept(len(results), file)}") from error
    ordered = [results[t.kind, t.seed] for t in batch.trials]
    tallies = report(ordered)
    if as_json:
        print(to_json(_document(batch, ordered, tallies)), end="")
    else:
        print(f"{batch.name}: {batch.description}")
        print("\n".join([*report_lines(tallies), *_flaw_lines(batch, ordered)]))
    sys.stdout.flush()
    if output is not None:  # after the report, which needs no room on a disk
        _write(output, batch, ordered, tallies)
    return 0 if all(result.flawless for result in ordered) else 1


def _kept(count: int, file: TrialFile | None) -> str:
    """Return what is left of a campaign that could not go on, as the end of a sentence."""
    if count == 0:
        return ""
    if file is None:
        return f"; without --output the {count} missions that were over are lost"
    return f"; {file.path} keeps the {count} missions so far, the same command goes on from there"


def _run(trials: Sequence[Trial], jobs: int, cluster: str | None) -> Iterator[TrialResult]:
    if cluster is None:
        runs = run_in_parallel(run_trial, trials, jobs)
    else:
        runs = run_on_cluster(run_trial, trials, cluster)
    return (result for _, result in runs)


def _flaw_lines(batch: TrialBatch, results: Sequence[TrialResult]) -> list[str]:
    """Return the missions that went wrong, each with the command that draws it."""
    lines = []
    flawed = [r for r in results if not r.flawless]
    for r in flawed[:_TOLD]:
        m = r.mission
        lines.append(
            f"{r.kind} {m.seed}: {m.outcome}, {r.truth}, contacts {m.contacts}, {m.message}\n"
            f"    {batch.replay_command(r.kind, m.seed)}"
        )
    if len(flawed) > _TOLD:
        lines.append(f"and {len(flawed) - _TOLD} more; missions.csv in --output has all")
    return lines


def _document(
    batch: TrialBatch, results: Sequence[TrialResult], tallies: Sequence[Tally]
) -> dict[str, Any]:
    return {
        "format": FORMAT,
        "versions": versions(),
        "name": batch.name,
        "description": batch.description,
        "settings": batch.configuration,
        "report": [asdict(t) for t in tallies],
        "missions": [_row(batch, r) for r in results],
    }


def _row(batch: TrialBatch, result: TrialResult) -> dict[str, Any]:
    return {
        **result.row(),
        "flawless": result.flawless,
        "replay": batch.replay_command(result.kind, result.mission.seed),
    }


def _write(
    folder: Path, batch: TrialBatch, results: Sequence[TrialResult], tallies: Sequence[Tally]
) -> None:
    """Write campaign.json, missions.csv and report.csv."""
    text = to_json(_document(batch, results, tallies))
    write_result(folder / "campaign.json", text)
    tables = {
        "missions.csv": [_row(batch, r) for r in results],
        "report.csv": [asdict(t) for t in tallies],
    }
    for name, rows in tables.items():
        write_table(folder / name, list(rows[0]), rows)
