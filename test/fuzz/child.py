# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""The process in which a target runs: each case within its limits, findings to files."""

from __future__ import annotations

import atexit
import contextlib
import hashlib
import importlib.util
import json
import mmap
import os
import re
import resource
import signal
import struct
import sys
import time
import traceback
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

from fuzz.generate import inputs, smaller
from fuzz.surface import Surface, Target
from fuzz.surfaces import surface_named

__all__ = ["SLOT", "finding_file", "run_child"]

#: Size of the file by which a process tells its case: number, length, input.
SLOT = 1 << 20
#: Most time of the processor [s] and memory [MB] that one case may take; the first ones compile.
TIME_LIMIT, FIRST_LIMIT = 5.0, 120.0
MEMORY_LIMIT = 300.0
#: Memory that a process may take on top of what it began with [bytes].
SPACE = 4 << 30
#: A limit of the fuzzer's own [s] that no case comes to; 0 would be one.
FOREVER = 1_000_000
#: Most inputs that are tried to make one that fails smaller, and longest time for it [s].
MOST_TRIES, SHRINK_TIME = 3000, 20.0
#: Most findings of one kind that are kept, and of all kinds.
MOST_FINDINGS = 30
#: Packages whose branches guide the fuzzer.
OURS = ("fuzzy_map_building", "fuzzy_navigation", "nomad_sim")
GUIDING = (*OURS, "zipfile")


class SlowCase(BaseException):
    """A case took too long; no handler of exceptions of the code under test catches it."""


class HungryCase(Exception):
    """A case took too much memory."""


def finding_file(folder: Path, kind: str, data: bytes) -> Path:
    """Write an input that fails to a file and return its name."""
    file = folder / f"{kind}_{hashlib.sha256(data).hexdigest()[:10]}.bin"
    file.write_bytes(data)
    return file


def _peak() -> float:
    """Return the most memory that this process has had so far [MB]."""
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024.0


def _resident() -> float:
    """Return the memory that this process has now [MB]."""
    pages = int(Path("/proc/self/statm").read_text().split()[1])
    return pages * resource.getpagesize() / 2.0**20


def _key(error: BaseException) -> str:
    """Return what tells one finding from another: the error and where it came from."""
    frames = traceback.extract_tb(error.__traceback__)
    place = frames[-1]
    return f"{type(error).__name__}_{Path(place.filename).stem}_{place.lineno}"


class Guard:
    """Runs cases, one after the other, and keeps what they show."""

    def __init__(self, target: Target, folder: Path, slot: Path) -> None:
        self._target = target
        self._folder = folder
        with slot.open("r+b") as file:
            self._slot = mmap.mmap(file.fileno(), SLOT)
        self.cases = 0
        self.findings: dict[str, str] = {}
        self.limit = FIRST_LIMIT

    def __call__(self, data: bytes) -> None:
        """Run one case."""
        self.cases += 1
        data = bytes(data[: SLOT - 16])
        self._slot[8 : 16 + len(data)] = struct.pack("<Q", len(data)) + data
        self._slot[:8] = struct.pack("<Q", self.cases)
        error = self._failure(data)
        if error is None or len(self.findings) >= MOST_FINDINGS:
            return
        key = _key(error)
        if key in self.findings:
            return
        self.findings[key] = ""
        small = self._shrunk(data, key)
        file = finding_file(self._folder, re.sub(r"\W", "_", key), small)
        again = self._failure(small) or error
        text = "".join(traceback.format_exception(again))
        self.findings[key] = f"{key}: {file} ({len(small)} bytes)\n{text[-3000:]}"
        print(self.findings[key], flush=True)

    def _failure(self, data: bytes) -> BaseException | None:
        before = _peak()
        signal.setitimer(signal.ITIMER_PROF, self.limit)
        try:
            self._target(data)
        except (Exception, SlowCase, SystemExit) as error:
            return error
        finally:
            signal.setitimer(signal.ITIMER_PROF, 0.0)
        try:
            if _peak() - before > MEMORY_LIMIT:
                raise HungryCase(f"took {_peak() - before:.0f} MB")
        except HungryCase as error:
            return error
        return None

    def _shrunk(self, data: bytes, key: str) -> bytes:
        """Return a smaller input with the same finding."""
        if key.startswith(("SlowCase", "HungryCase")):
            return data
        end, tries, found = time.monotonic() + SHRINK_TIME, 0, True
        while found:
            found = False
            for candidate in smaller(data):
                tries += 1
                if tries > MOST_TRIES or time.monotonic() > end:
                    return data
                error = self._failure(candidate)
                if error is not None and _key(error) == key:
                    data, found = candidate, True
                    break
        return data


def _too_slow(*_: object) -> None:
    raise SlowCase(f"longer than {TIME_LIMIT} s")


def _limit_space() -> None:
    taken = int(Path("/proc/self/statm").read_text().split()[0]) * resource.getpagesize()
    _, hard = resource.getrlimit(resource.RLIMIT_AS)
    resource.setrlimit(resource.RLIMIT_AS, (taken + SPACE, hard))


@contextlib.contextmanager
def _guided(engine: str) -> Iterator[Any]:
    """Instrument what is imported meanwhile, where the fuzzer is guided."""
    if engine != "atheris":
        yield None
        return
    import atheris

    for name in [name for name in sys.modules if name.split(".")[0] in GUIDING]:
        del sys.modules[name]  # imported before by this tool itself
    with atheris.instrument_imports(include=list(GUIDING), exclude=_compiled()):
        yield atheris


def _compiled() -> list[str]:
    """Return the modules with kernels: what the compiler takes has to be as it was written."""
    names = []
    for package in OURS:
        found = importlib.util.find_spec(package)
        assert found is not None
        for folder in found.submodule_search_locations or ():
            for file in Path(folder).rglob("*.py"):
                if "fuzzy_map_building.jit import" in file.read_text(encoding="utf-8"):
                    parts = file.relative_to(folder).with_suffix("").parts
                    names.append(".".join((package, *parts)))
    return names


def run_child(
    name: str, cases: int, seed: int, engine: str, folder: Path, slot: Path, result: Path
) -> int:
    """Run the cases of one target in this process; the result goes to a file."""
    signal.signal(signal.SIGPROF, _too_slow)
    with _guided(engine) as atheris:
        surface = surface_named(name)
    with surface.opened() as target:
        guard = Guard(target, folder, slot)
        for data in surface.seeds():
            guard(data)  # whatever is compiled or imported on the way is not of a case
        guard.limit = TIME_LIMIT
        _limit_space()
        began = _resident()

        def done() -> None:
            coverage = int(os.environ.get("FUZZ_EDGES", "0"))
            told = {
                "coverage": coverage,
                "grown": max(0.0, _resident() - began),
                "findings": list(guard.findings.values()),
                "counts": dict(surface.counts),
            }
            result.write_text(json.dumps(told))

        if atheris is None:
            _seeded(surface, guard, cases, seed)
            done()
            return 0
        atexit.register(done)
        _with_atheris(atheris, surface, guard, cases, seed, folder)
    return 0


def _seeded(surface: Surface, guard: Guard, cases: int, seed: int) -> None:
    for data in inputs(surface.seeds(), surface.tokens, surface.longest, seed):
        if guard.cases >= cases:
            return
        guard(data)


def _with_atheris(
    atheris: Any, surface: Surface, guard: Callable[[bytes], None], cases: int, seed: int, to: Path
) -> None:
    corpus = to / "corpus"
    corpus.mkdir(exist_ok=True)
    for number, data in enumerate(surface.seeds()):
        (corpus / f"seed_{number}").write_bytes(data)
    arguments = [f"-runs={cases}", f"-seed={seed}", f"-max_len={surface.longest}"]
    # Cases are timed by their guard, in time of the processor.
    arguments += [f"-timeout={FOREVER}", "-rss_limit_mb=0", "-print_final_stats=1"]
    arguments += [f"-artifact_prefix={to}/"]
    if surface.tokens:
        words = to / "words"
        words.write_text("".join(f'"{_escaped(token)}"\n' for token in surface.tokens if token))
        arguments.append(f"-dict={words}")
    arguments.append(str(corpus))
    atheris.Setup([sys.argv[0], *arguments], guard, internal_libfuzzer=True)
    atheris.Fuzz()


def _escaped(token: bytes) -> str:
    return "".join(f"\\x{byte:02x}" for byte in token)
