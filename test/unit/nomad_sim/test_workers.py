# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Worker processes: results, errors, and that none is left.

The functions are ones that a new interpreter finds without this file.
"""

import math
import multiprocessing
import os
import time
from concurrent.futures import ThreadPoolExecutor

import pytest

from nomad_sim.workers import run_in_parallel


@pytest.fixture(autouse=True)
def nothing_left():  # type: ignore[no-untyped-def]
    yield
    assert multiprocessing.active_children() == []


@pytest.mark.parametrize("jobs", [1, 2, 5])
def test_every_item_is_answered_once(jobs: int) -> None:
    numbers = [9.0, 16.0, 25.0]
    done = dict(run_in_parallel(math.sqrt, numbers, jobs))
    assert done == {0: 3.0, 1: 4.0, 2: 5.0}


def test_nothing_to_do_is_done_at_once() -> None:
    assert list(run_in_parallel(math.sqrt, [], 4)) == []


def test_the_first_that_is_done_comes_first() -> None:
    order = [index for index, _ in run_in_parallel(time.sleep, [2.0, 0.0], 2)]
    assert order == [1, 0]


@pytest.mark.parametrize("jobs", [1, 2])
def test_an_error_comes_back_as_what_it_was(jobs: int) -> None:
    with pytest.raises(ValueError, match=r"math domain|nonnegative"):
        list(run_in_parallel(math.sqrt, [-1.0, -1.0], jobs))


def test_a_worker_that_dies_is_told() -> None:
    with pytest.raises(ChildProcessError, match="exit code 7"):
        list(run_in_parallel(os._exit, [7, 7], 2))


def test_leaving_early_ends_the_workers() -> None:
    began = time.monotonic()
    answers = run_in_parallel(time.sleep, [0.0, 60.0], 2)
    assert next(answers) == (0, None)
    answers.close()  # type: ignore[attr-defined]
    assert multiprocessing.active_children() == []
    assert time.monotonic() - began < 30.0


def test_a_worker_computes_with_one_thread_and_we_as_before(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setenv("OMP_NUM_THREADS", "3")
    monkeypatch.delenv("MKL_NUM_THREADS", raising=False)
    names = ["OMP_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS"]
    assert dict(run_in_parallel(os.getenv, names, 2)) == {0: "1", 1: "1", 2: "1"}
    assert os.environ["OMP_NUM_THREADS"] == "3"
    assert "MKL_NUM_THREADS" not in os.environ


def test_a_thread_may_ask_for_workers_as_well() -> None:
    """Signals can be held in the main thread alone."""
    with ThreadPoolExecutor(1) as executor:
        done = executor.submit(lambda: dict(run_in_parallel(math.sqrt, [9.0, 16.0], 2)))
        assert done.result(60.0) == {0: 3.0, 1: 4.0}


def test_there_is_at_least_one_job() -> None:
    with pytest.raises(ValueError, match="at least one job"):
        list(run_in_parallel(math.sqrt, [1.0], 0))
