# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Compilation with and without numba, and where its cache may and may not be written."""

import os
import subprocess
import sys

import pytest

from fuzzy_map_building.jit import compiled, njit

KERNEL = """
import numpy as np
from fuzzy_map_building.jit import compiled, elementwise, njit, remark

@njit
def total(count):
    out = 0
    for k in range(count):
        out += k
    return out

@elementwise
def odd(number):
    return np.rint(number / 2.0) * 2.0 != number

print(compiled(), total(10), odd(np.array([1.0, 2.0, 4.0])).sum(), *remark().split()[:3])
"""


PLAIN = ["False", "45", "1", "kernels", "run", "as"]
ANEW = ["True", "45", "1", "kernels", "are", "compiled"]


def run(folder, environment, prepare=""):
    """Run the kernel from a module in `folder`; return its output."""
    (folder / "module.py").write_text(KERNEL)
    env = {k: v for k, v in os.environ.items() if not k.startswith("NUMBA_")}
    env["PYTHONPATH"] = os.pathsep.join([str(folder), *sys.path])
    done = subprocess.run(
        [sys.executable, "-W", "error", "-c", f"import sys; {prepare}\nimport module"],
        env={**env, **environment},
        capture_output=True,
        text=True,
        timeout=120,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    assert done.stderr == ""
    return done.stdout.split()


@pytest.fixture
def read_only(tmp_path):
    """A folder beside whose sources no cache can be made, and no home to make one in.

    Permissions do not stop the root user; a file in the cache folder's place does.
    """
    (tmp_path / "__pycache__").write_text("")
    return tmp_path, {"HOME": "/dev/null", "XDG_CACHE_HOME": "/dev/null/cache"}


def test_without_numba_a_kernel_is_its_source(tmp_path):
    assert run(tmp_path, {}, "sys.modules['numba'] = None") == PLAIN
    assert run(tmp_path, {"NUMBA_DISABLE_JIT": "1"}) == PLAIN


@pytest.mark.skipif(not compiled(), reason="numba is not installed")
def test_a_read_only_installation_without_a_home_compiles(read_only):
    folder, environment = read_only
    assert run(folder, environment) == ANEW


@pytest.mark.skipif(not compiled(), reason="numba is not installed")
def test_a_cache_folder_that_cannot_be_used_does_not_stop_anything(read_only):
    folder, environment = read_only
    assert run(folder, {**environment, "NUMBA_CACHE_DIR": "/dev/null/x"}) == ANEW


@pytest.mark.skipif(not compiled(), reason="numba is not installed")
def test_compiled_code_is_kept(tmp_path, read_only):
    folder, environment = read_only
    cache = tmp_path / "cache"
    assert run(folder, {**environment, "NUMBA_CACHE_DIR": str(cache)}) == ["True", "45", "1"]
    assert list(cache.rglob("*.nbi"))


def test_decorating_keeps_name_and_documentation():
    @njit
    def kernel(value):
        """Double it."""
        return 2 * value

    assert kernel.__name__ == "kernel"
    assert kernel.__doc__ == "Double it."
    assert kernel(4) == 8


@pytest.mark.skipif(not compiled(), reason="numba is not installed")
def test_a_kernel_is_compiled_anew_when_one_that_it_calls_changed_in_another_file(tmp_path):
    source = "from fuzzy_map_building.jit import njit\n\n\n@njit\ndef {}\n"
    helper, caller = tmp_path / "helper.py", tmp_path / "caller.py"
    caller.write_text("from helper import one\n" + source.format("two():\n    return 2 * one()"))

    def two(value):
        helper.write_text(source.format(f"one():\n    return {value}"))
        env = {**os.environ, "PYTHONPATH": os.pathsep.join([str(tmp_path), *sys.path])}
        done = subprocess.run(
            [sys.executable, "-c", "import caller; print(caller.two())"],
            env={k: v for k, v in env.items() if not k.startswith("NUMBA_")},
            capture_output=True,
            text=True,
            timeout=120,
            check=True,
        )
        return int(done.stdout)

    assert two(1) == 2
    assert two(100) == 200
