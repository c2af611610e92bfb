# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Many missions without ROS, one for each seed, in parallel processes: how often, how well.

``ros2 run nomad_sim campaign --world lab --seeds 20 --jobs 2``
``ros2 run nomad_sim campaign --generated 1000 --jobs 2 --output results``
"""

from __future__ import annotations

import signal
import sys
import textwrap
import threading
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from types import FrameType
from typing import NoReturn

from tqdm import tqdm

from nomad_sim.campaign_files import (
    BatchResults,
    campaign_document,
    mission_document,
    refuse_other_kind,
    to_json,
    write_campaign,
)
from nomad_sim.campaign_options import PROGRAM, Batch, Options, parse_options
from nomad_sim.campaign_table import (
    ROW_HEADER,
    result_lines,
    row_line,
    summarise,
    summary_lines,
)
from nomad_sim.headless import HeadlessMission
from nomad_sim.missions import MissionResult, run_spec
from nomad_sim.output_folder import write_result
from nomad_sim.reference import MISSIONS
from nomad_sim.trial_campaign import run_trials
from nomad_sim.workers import run_in_parallel

__all__ = ["main", "run_batch"]

_INTERRUPTED = 128 + signal.SIGINT
#: What signals are raised as, and after how long one that was lost is sent again [s].
_SIGNALS: dict[type[BaseException], signal.Signals] = {
    SystemExit: signal.SIGTERM,
    KeyboardInterrupt: signal.SIGINT,
}
_AGAIN = 0.1
#: Characters in a line above a figure.
_TITLE_WIDTH = 70


def run_batch(batch: Batch, jobs: int) -> BatchResults:
    """Run all missions of a batch, with progress on standard error.

    Parameters
    ----------
    batch : Batch
        The missions.
    jobs : int
        Most processes at a time.

    Raises
    ------
    ValueError
        If one of the missions cannot be.
    """
    results: dict[int, MissionResult] = {}
    with tqdm(total=len(batch.specs), desc=batch.name, unit="mission", file=sys.stderr) as bar:
        for index, result in run_in_parallel(run_spec, batch.specs, jobs):
            results[index] = result
            bar.set_postfix(
                reached=f"{sum(r.reached for r in results.values())} of {len(results)}"
            )
            bar.update()
    ordered = tuple(results[index] for index in sorted(results))
    return BatchResults(batch, ordered, summarise(ordered))


def _good_enough(done: BatchResults) -> bool:
    if done.batch.method is None:
        return all(result.flawless for result in done.results)
    summary = done.summary
    at_least = summary.reached * MISSIONS >= done.batch.method * summary.missions
    return at_least and summary.contacts == 0


def _run(options: Options) -> int:
    """Run batch after batch; show and write what is there after each.

    What could not be written after one is tried again after the next.
    """
    if options.output is not None:
        refuse_other_kind(options.output, drawn=options.trials is not None)
    if options.trials is not None:
        return run_trials(
            options.trials, options.jobs, options.cluster, options.output, options.as_json
        )
    done: list[BatchResults] = []
    unwritten: OSError | None = None
    table = not options.as_json
    reference = options.batches[0].method is not None
    if table and reference:
        print(ROW_HEADER)
    for batch in options.batches:
        seeds = batch.specs
        if table and not reference:
            print(f"{batch.name}: {batch.description}; seeds {seeds[0].seed} to {seeds[-1].seed}")
        one = run_batch(batch, options.jobs)
        done.append(one)
        if table:
            _show(one)
        if options.output is not None:
            try:
                write_campaign(options.output, done)
                unwritten = None
            except OSError as error:
                unwritten = error
    if options.as_json:
        print(to_json(campaign_document(done)), end="", flush=True)
    if unwritten is not None:
        raise unwritten
    return 0 if all(_good_enough(one) for one in done) else 1


def _show(one: BatchResults) -> None:
    """Print a batch as a table, and how to run again what went wrong."""
    if one.batch.method is not None:
        print(row_line(one.batch.name, one.batch.method, MISSIONS, one.summary))
    else:
        print("\n".join([*result_lines(one.results), *summary_lines(one.summary)]))
    for result in one.results:
        if not result.flawless:
            print(f"    seed {result.seed}: {result.outcome}, {result.message}")
            print(f"    {one.batch.replay_command(result.seed)}")
    sys.stdout.flush()


def _replay(options: Options) -> int:
    """Run one mission and tell it perception by perception."""
    # Here, since nothing else needs the pictures' library.
    from nomad_sim.mission_report import draw_moments, entry_line, moment_of
    from nomad_sim.render import save_figure

    (batch,) = options.batches
    (spec,) = batch.specs
    mission = spec.mission()
    title = f"{batch.name}, seed {spec.seed}"
    if not options.as_json:
        print(f"{batch.name}: {batch.description}; seed {spec.seed}", flush=True)
    unwritten: list[OSError] = []

    def draw(now: HeadlessMission, heading: str, name: str) -> None:
        if options.output is None or unwritten:
            return
        try:
            save_figure(draw_moments([moment_of(now)], heading), options.output / name)
        except OSError as error:
            unwritten.append(error)  # told at the end, when there is a verdict

    def show(now: HeadlessMission) -> None:
        entry = now.mission.log[-1]
        if not options.as_json:
            print(entry_line(entry), flush=True)
        if options.every_figure:
            draw(now, title, f"perception_{entry.perception:03d}.png")

    log = mission.run(show)
    result = MissionResult.of(log)
    document = to_json(mission_document(batch, result, log.entries))
    if options.as_json:
        print(document, end="", flush=True)
    else:
        print("\n".join([*result_lines([result]), result.message]), flush=True)
    if options.output is not None:
        write_result(options.output / "mission.json", document)
    draw(mission, textwrap.fill(f"{title}: {log.message}", _TITLE_WIDTH), "mission.png")
    if unwritten:
        raise unwritten[0]
    return 0 if result.flawless else 1


@contextmanager
def _stopped_by_signals() -> Iterator[None]:
    """Leave on SIGTERM as on Ctrl-C, with everything cleaned up."""
    if threading.current_thread() is not threading.main_thread():
        yield
        return

    def leave(number: int, _frame: FrameType | None) -> NoReturn:
        raise SystemExit(128 + number)

    def lost(report: sys.UnraisableHookArgs) -> None:
        # A signal that meets a callback of the compiler cannot end anything: once more.
        number = _SIGNALS.get(report.exc_type)
        if number is None:
            hook(report)
            return
        again = threading.Timer(_AGAIN, signal.pthread_kill, (threading.get_ident(), number))
        again.daemon = True
        again.start()

    handlers = {signal.SIGTERM: leave, signal.SIGINT: signal.default_int_handler}
    before, hook = {number: signal.getsignal(number) for number in handlers}, sys.unraisablehook
    sys.unraisablehook = lost
    try:
        for number, handler in handlers.items():
            signal.signal(number, handler)
        yield
    finally:
        for number, previous in before.items():
            signal.signal(number, previous)
        sys.unraisablehook = hook


def main(arguments: Sequence[str] | None = None) -> int:
    """Run a campaign; see ``campaign --help``.

    Parameters
    ----------
    arguments : sequence of str, optional
        By default those of the process.

    Returns
    -------
    int
        Exit code.
    """
    try:
        with _stopped_by_signals():
            options = parse_options(arguments)
            return _replay(options) if options.replay else _run(options)
    except KeyboardInterrupt:
        print(f"{PROGRAM}: interrupted", file=sys.stderr)
        return _INTERRUPTED
    except (ValueError, OSError) as error:
        print(f"{PROGRAM}: {error}", file=sys.stderr)
        return 2


if __name__ == "__main__":
    sys.exit(main())
