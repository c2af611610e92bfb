# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""A signal while a program is still importing what it needs ends it cleanly as well."""

from __future__ import annotations

import signal
import subprocess
import sys
import time
from importlib.metadata import entry_points
from pathlib import Path

import pytest

STUDIES = Path(__file__).resolve().parents[1] / "studies"
NODES = {
    "fuzzy_map_building": "mapper",
    "fuzzy_navigation": "planner",
    "nomad_sim": "sim",
}
#: Programs that are no nodes, with the exit codes of SIGINT and SIGTERM.
TOOLS = {
    "fuzzy_navigation": ("bringup", 0, 0),
    "nomad_sim": ("demo", 130, 130),
    "nomad_sim.ros": ("campaign", 130, 143),
}
# The signals are taken over before anything slow is imported: the word comes right after that.
SCRIPT = """
import importlib, sys
from fuzzy_map_building.ros import entry
take_over = entry.importlib.import_module
def told(name):
    print("begun", flush=True)
    return take_over(name)
entry.importlib = type("Importer", (), {"import_module": staticmethod(told)})
package = sys.argv[1].removesuffix(".ros")
executable = getattr(importlib.import_module(package + ".ros.entry"), sys.argv[2])
del sys.argv[1:]
sys.exit(executable())
"""


# The signal comes in the middle of the first slow import of a study, however fast the machine.
STUDY = """
import runpy, signal, sys
class Interrupting:
    def find_spec(self, name, path=None, target=None):
        if name in ("numpy", "matplotlib", "scipy"):
            print("importing")
            signal.raise_signal(int(sys.argv.pop()))
sys.meta_path.insert(0, Interrupting())
sys.path.insert(0, sys.argv[1])
runpy.run_path(sys.argv[1] + "/" + sys.argv[2], run_name="__main__")
"""


def end_of(
    script: str, arguments: list[str], delay: float, number: signal.Signals
) -> tuple[int, str]:
    """Return exit code and errors of a program that gets a signal [s] after it has begun."""
    process = subprocess.Popen(
        [sys.executable, "-c", script, *arguments],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    assert process.stdout is not None
    assert process.stdout.readline() == "begun\n"
    time.sleep(delay)
    process.send_signal(number)
    _, errors = process.communicate(timeout=30.0)
    return process.returncode, errors


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
@pytest.mark.parametrize("package", NODES)
@pytest.mark.parametrize("delay", [0.0, 0.3, 0.8])
def test_a_signal_during_the_imports(package: str, number: signal.Signals, delay: float) -> None:
    code, errors = end_of(SCRIPT, [package, NODES[package]], delay, number)
    assert code == 0, errors
    assert "Traceback" not in errors  # a node that is up says so there


@pytest.mark.parametrize("package", TOOLS)
@pytest.mark.parametrize("delay", [0.0, 0.5])
def test_a_signal_to_a_tool_that_has_not_begun(package: str, delay: float) -> None:
    tool, interrupted, terminated = TOOLS[package]
    for number, code in ((signal.SIGINT, interrupted), (signal.SIGTERM, terminated)):
        assert end_of(SCRIPT, [package, tool], delay, number) == (code, "")


def test_every_executable_begins_where_signals_are_minded() -> None:
    packages = {name.partition(".")[0] for name in NODES}
    begins = {
        e.name: e.value
        for e in entry_points(group="console_scripts")
        if e.value.partition(".")[0] in packages
    }
    assert begins.keys() >= {"mapper", "planner", "motion", "bringup", "sim", "demo", "campaign"}
    for name, place in begins.items():
        assert place == f"{place.partition('.')[0]}.ros.entry:{name}"


@pytest.mark.parametrize("study", ["figure8.py", "faults.py"])
@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_signal_to_a_study_that_has_not_begun(study: str, number: signal.Signals) -> None:
    command = [sys.executable, "-c", STUDY, str(STUDIES), study, str(int(number))]
    end = subprocess.run(command, capture_output=True, text=True, timeout=60.0)
    assert (end.returncode, end.stdout, end.stderr) == (128 + number, "importing\n", "")


def test_every_study_minds_signals_first() -> None:
    for file in STUDIES.glob("*.py"):
        text = file.read_text()
        if "__main__" in text:
            assert text.index("import quiet_end") < text.index("# isort: split"), file.name


#: A program whose report is more than any buffer holds, and which then writes its results.
REPORTER = """
import sys
from pathlib import Path
def main():
    for _ in range(20000):
        print("a line of the report")
    sys.stdout.flush()
    Path(sys.argv[1]).write_text("results")
    code = int(sys.argv[2])
    if len(sys.argv) > 3:
        sys.exit(code)
    return code
"""
BEGIN = (
    "import sys; from fuzzy_map_building.ros.entry import start; sys.exit(start('reporter', {}))"
)


@pytest.mark.parametrize("left", [[], ["by an exception"]])
@pytest.mark.parametrize(
    ("output", "code", "ended", "told"),
    [
        ("kept", 0, 0, ""),
        ("kept", 1, 1, ""),
        ("full", 0, 2, "-c: cannot write to standard output: No space left on device\n"),
        ("full", 1, 1, "-c: cannot write to standard output: No space left on device\n"),
        ("unheard", 0, 141, ""),
        ("unheard", 3, 3, ""),
        ("closed", 0, 0, ""),
    ],
)
def test_a_program_whose_output_fails_does_its_work_to_the_end(
    output: str, code: int, ended: int, told: str, left: list[str], tmp_path: Path
) -> None:
    (tmp_path / "reporter.py").write_text(REPORTER)
    results, kept = tmp_path / "results", tmp_path / "kept"
    command = [sys.executable, "-c", BEGIN.format(None), str(results), str(code), *left]
    redirected = {
        "kept": f'"$@" > {kept}',
        "full": '"$@" > /dev/full',
        # The reader is gone before the program begins.
        "unheard": 'mkfifo pipe; exec 3<> pipe 4> pipe 3<&-; "$@" >&4 4>&-',
        "closed": '"$@" >&-',
    }[output]
    done = subprocess.run(
        ["sh", "-c", redirected, "sh", *command],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        timeout=60.0,
    )
    assert (done.returncode, done.stdout, done.stderr) == (ended, "", told)
    assert results.read_text() == "results"
    if output == "kept":
        assert kept.read_text() == "a line of the report\n" * 20000


@pytest.mark.parametrize("code", [0, 1])
def test_what_serves_until_it_is_stopped_does_not_fail_for_want_of_a_reader(
    code: int, tmp_path: Path
) -> None:
    (tmp_path / "reporter.py").write_text(REPORTER)
    with open("/dev/full", "w") as full:
        done = subprocess.run(
            [sys.executable, "-c", BEGIN.format(0), str(tmp_path / "results"), str(code)],
            cwd=tmp_path,
            stdout=full,
            stderr=full,
            timeout=60.0,
        )
    assert done.returncode == code
    assert (tmp_path / "results").read_text() == "results"


@pytest.mark.parametrize("errors", ["2> /dev/full", "2>&-"])
def test_progress_that_nobody_can_see_stops_nothing(errors: str, tmp_path: Path) -> None:
    (tmp_path / "reporter.py").write_text(
        "import sys\n"
        "def main():\n"
        "    for _ in range(3):\n"
        "        print('progress', file=sys.stderr, flush=True)\n"
        "    print('results')\n"
        "    return 0\n"
    )
    done = subprocess.run(
        ["sh", "-c", f'"$@" {errors}', "sh", sys.executable, "-c", BEGIN.format(None)],
        cwd=tmp_path,
        stdout=subprocess.PIPE,
        text=True,
        timeout=60.0,
    )
    assert (done.returncode, done.stdout) == (0, "results\n")
