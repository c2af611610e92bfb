# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Fuzzing: any bytes to all that takes something from outside.

    .ci/in_environment python3 test/fuzz/run.py --all --cases 10000
    .ci/in_environment python3 test/fuzz/run.py --target world --cases 1000000 --seed 7
    .ci/in_environment python3 test/fuzz/run.py --replay build/fuzz/world/ValueError_0123abcd.bin

With `atheris` (``pip install -r test/fuzz/requirements.txt``) inputs are looked for that reach
code not reached before; without it they are mutated from seeds. Each target runs in a process
of its own; one that dies or hangs is a finding, too, and is started again for the rest.
"""

from __future__ import annotations

import argparse
import importlib.util
import json
import mmap
import os
import struct
import subprocess
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from fuzz.child import SLOT, finding_file, run_child
from fuzz.surfaces import surface_named, surface_names

#: A case that takes more of the processor than this [s] kills its process, for what holds up the
#: process itself; so does one that has waited so long [s] without using it.
MOST_WORK, LONGEST_WAIT = 180.0, 60.0
#: Most restarts of a target's process.
MOST_STARTS = 20


@dataclass
class Report:
    """What came of one target."""

    target: str
    engine: str
    cases: int = 0
    seconds: float = 0.0
    coverage: int = 0
    grown: float = 0.0
    findings: list[str] = field(default_factory=list)
    counts: Counter[str] = field(default_factory=Counter)

    def line(self) -> str:
        """Return it in one line."""
        rate = self.cases / self.seconds if self.seconds else 0.0
        covered = f", {self.coverage} edges" if self.coverage else ""
        return (
            f"{self.target:18} {self.cases:9} cases, {rate:7.0f}/s{covered}, memory grew by "
            f"{self.grown:.0f} MB, {len(self.findings)} findings ({self.engine})"
        )


class Slot:
    """Where a process says which case it is at, so that its last one outlives it."""

    def __init__(self, path: Path) -> None:
        path.write_bytes(bytes(SLOT))
        self.path = path
        with path.open("r+b") as file:
            self._memory = mmap.mmap(file.fileno(), SLOT)

    def read(self) -> tuple[int, bytes]:
        """Return the number of the case, and its input."""
        count, length = struct.unpack_from("<QQ", self._memory)
        return count, bytes(self._memory[16 : 16 + length])


def fuzz(target: str, cases: int, seed: int, engine: str, output: Path) -> Report:
    """Run one target in processes of its own until all cases are done."""
    report = Report(target, engine)
    folder = output / target
    folder.mkdir(parents=True, exist_ok=True)
    began = time.monotonic()
    with tempfile.TemporaryDirectory() as scratch:
        log = Path(scratch) / "log"
        for start in range(MOST_STARTS):
            left = cases - report.cases
            if left <= 0:
                break
            slot = Slot(Path(scratch) / f"slot_{start}")
            result = Path(scratch) / f"result_{start}.json"
            command = [sys.executable, __file__, "--child", target, "--cases", str(left)]
            command += ["--seed", str(seed + start), "--engine", engine, "--output", str(folder)]
            command += ["--slot", str(slot.path), "--result", str(result)]
            why = _watch(command, slot, log)
            count, data = slot.read()
            report.cases += count
            if why and count == 0:  # it did not come as far as a case
                report.findings.append(f"{why}\n{_end_of(log)}")
                break
            if result.exists():
                _add(report, json.loads(result.read_text()))
            if why:
                name = str(finding_file(folder, why, data))
                report.findings.append(f"{why}: {name}\n{_end_of(log)}")
    report.seconds = time.monotonic() - began
    return report


def _watch(command: Sequence[str], slot: Slot, log: Path) -> str:
    """Return why a process ended, empty if well."""
    with log.open("w") as output:
        process = subprocess.Popen(command, stdout=output, stderr=subprocess.STDOUT)
        last, since, before = -1, time.monotonic(), 0.0
        while process.poll() is None:
            time.sleep(0.2)
            count, _ = slot.read()
            now, worked = time.monotonic(), _processor_time(process.pid)
            if count != last:
                last, since, before = count, now, worked
            idle = now - since > LONGEST_WAIT and worked - before < 0.01 * LONGEST_WAIT
            if count and (idle or worked - before > MOST_WORK):
                process.kill()
                process.wait()
                return "hang"
    return "" if process.returncode == 0 else f"died_{process.returncode}".replace("-", "signal_")


def _end_of(log: Path) -> str:
    return log.read_text(errors="replace")[-3000:]


def _processor_time(process: int) -> float:
    """Return how much of the processor a process has used [s]; on a busy machine little."""
    try:
        fields = Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()
    except OSError:  # it has just ended
        return 0.0
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def _add(report: Report, result: dict[str, Any]) -> None:
    report.coverage = max(report.coverage, result["coverage"])
    report.grown += result["grown"]
    report.findings += result["findings"]
    report.counts.update(result["counts"])


def replay(file: Path, target: str) -> None:
    """Run one input, whose target is the name of its folder if none is given."""
    with surface_named(target or file.resolve().parent.name).opened() as run:
        run(file.read_bytes())
    print(f"{file}: no finding")


def main() -> int:
    """Return 1 if anything was found."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--target", action="append", choices=surface_names(), default=[])
    parser.add_argument("--all", action="store_true", help="every target, one after the other")
    parser.add_argument("--cases", type=int, default=10_000, help="of each target")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--engine", choices=["auto", "atheris", "seeded"], default="auto")
    parser.add_argument("--output", type=Path, default=Path("build/fuzz"))
    parser.add_argument("--replay", type=Path, help="run this input again, with its traceback")
    for hidden in ("--child", "--slot", "--result"):
        parser.add_argument(hidden, help=argparse.SUPPRESS)
    options = parser.parse_args()
    engine = options.engine
    if engine == "auto":
        engine = "atheris" if importlib.util.find_spec("atheris") else "seeded"
    if options.child:
        return run_child(
            options.child,
            options.cases,
            options.seed,
            engine,
            options.output,
            Path(options.slot),
            Path(options.result),
        )
    if options.replay:
        replay(options.replay, "".join(options.target[:1]))
        return 0
    reports = []
    for target in surface_names() if options.all else options.target:
        report = fuzz(target, options.cases, options.seed, engine, options.output)
        print(report.line(), flush=True)
        for finding in report.findings:
            print(finding, flush=True)
        reports.append(report)
        (options.output / f"{target}.json").write_text(json.dumps(vars(report), indent=1))
    if not reports:
        parser.error("name a --target, or --all")
    return int(any(report.findings for report in reports))


if __name__ == "__main__":
    sys.exit(main())
