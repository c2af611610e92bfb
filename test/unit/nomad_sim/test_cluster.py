# Copyright 2026 The fuzzy navigation maintainers
# SPDX-License-Identifier: Apache-2.0
"""Missions on a Dask cluster, and what is told when it is lost: with Dask, and with a stand-in."""

import math
import operator
import sys
import threading
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import pytest

from fuzzy_map_building.params import DEFAULT_PRESET
from nomad_sim import cluster
from nomad_sim.campaign import main
from nomad_sim.cluster import run_on_cluster
from nomad_sim.trials import Rules, Trial, TrialResult, run_trial

ADDRESS = "tcp://10.0.0.1:8786"


class CancelledError(Exception):
    """Dask's, of futures whose scheduler is no more."""


class KilledWorkerError(Exception):
    """Dask's, of work that workers have died of."""


@dataclass
class Future:
    """One call: what comes of it, and how it stands."""

    key: str
    outcome: Any
    status: str

    def result(self) -> Any:
        if self.status != "finished":
            raise self.outcome
        return self.outcome

    def exception(self) -> Any:
        return self.outcome

    def release(self) -> None:
        self.status = "released"


@dataclass
class Cluster:
    """Stands in for the module ``distributed``, its client and the cluster behind it.

    Parameters
    ----------
    work : callable
        What comes of (function, item); an exception is an error, or a cancelled future.
    """

    work: Callable[[Any, Any], Any] = lambda function, item: function(item)
    workers: list[dict[str, int]] = field(default_factory=lambda: [{"w1": 1}])
    imported: Any = math
    CancelledError: type = CancelledError
    KilledWorker: type = KilledWorkerError

    def Client(self, address: str) -> Any:
        assert address == ADDRESS
        return self

    def __enter__(self) -> Any:
        return self

    def __exit__(self, *_: object) -> None:
        return None

    def nthreads(self) -> dict[str, int]:
        """Return the workers of now: the next of the list, the last one for ever."""
        return self.workers.pop(0) if len(self.workers) > 1 else self.workers[0]

    def run(self, function: Callable[[str], Any], module: str, on_error: str) -> dict[str, Any]:
        assert on_error == "return"
        return {"w1": function(module), "w2": self.imported}

    def map(
        self, function: Callable[[Any], Any], items: Sequence[Any], pure: bool
    ) -> list[Future]:
        assert not pure
        futures = []
        for number, item in enumerate(items):
            outcome = self.work(function, item)
            status = "finished"
            if isinstance(outcome, Exception):
                status = "cancelled" if isinstance(outcome, CancelledError) else "error"
            futures.append(Future(f"k{number}", outcome, status))
        return futures

    def as_completed(self, futures: Sequence[Future]) -> Any:
        return Completed(list(futures), self)


@dataclass
class Completed:
    """The futures, of which none is ready before there are workers."""

    futures: list[Future]
    cluster: Cluster

    def is_empty(self) -> bool:
        return not self.futures

    def has_ready(self) -> bool:
        return len(self.cluster.workers) == 1

    def __next__(self) -> Future:
        return self.futures.pop(0)


@pytest.fixture
def dask(monkeypatch: pytest.MonkeyPatch) -> Cluster:
    stand_in = Cluster()
    monkeypatch.setitem(sys.modules, "distributed", stand_in)  # type: ignore[arg-type]
    monkeypatch.setattr(cluster, "_PATIENCE", 0.0)
    monkeypatch.setattr(cluster, "_POLL", 0.0)
    return stand_in


def failing(error: Exception) -> Callable[[Any, Any], Any]:
    """Two calls that go well, and an error for what comes after them."""
    calls: list[Any] = []

    def work(function: Callable[[Any], Any], item: Any) -> Any:
        calls.append(item)
        return function(item) if len(calls) <= 2 else error

    return work


def because(error: Exception, cause: Exception) -> Exception:
    error.__cause__ = cause
    return error


def test_results_come_with_their_place(dask: Cluster) -> None:
    assert list(run_on_cluster(math.sqrt, [9.0, 4.0], ADDRESS)) == [(0, 3.0), (1, 2.0)]


@pytest.mark.parametrize(
    ("error", "raised", "told"),
    [
        (CancelledError("gone"), ConnectionError, f"the Dask scheduler at {ADDRESS} is lost"),
        (KilledWorkerError(), ChildProcessError, f"Dask workers of {ADDRESS} died"),
        (
            because(RuntimeError("graph"), ModuleNotFoundError("No module named 'some'")),
            ValueError,
            f"the Dask scheduler {ADDRESS} lacks a package: No module named 'some'",
        ),
        (RuntimeError("its own"), RuntimeError, "its own"),
        (FileNotFoundError("its own file"), FileNotFoundError, "its own file"),
    ],
)
def test_what_was_lost_is_told_and_what_was_done_is_not(
    error: Exception, raised: type[Exception], told: str, dask: Cluster
) -> None:
    dask.work = failing(error)
    answers = run_on_cluster(math.sqrt, [9.0, 4.0, 1.0], ADDRESS)
    assert [next(answers), next(answers)] == [(0, 3.0), (1, 2.0)]
    with pytest.raises(raised, match=told):
        next(answers)


def test_a_worker_without_the_package_is_given_no_work(dask: Cluster) -> None:
    def never(*_: object) -> Any:
        raise AssertionError("it would end the worker")

    dask.work = never
    dask.imported = ModuleNotFoundError("No module named 'nomad_sim'")
    with pytest.raises(ValueError, match="worker w2 lacks a package: No module named 'nomad_sim'"):
        list(run_on_cluster(math.sqrt, [9.0], ADDRESS))


def test_a_cluster_without_workers_is_waited_for(
    dask: Cluster, capsys: pytest.CaptureFixture[str]
) -> None:
    # None at first, then one, which goes; another one comes in its place, and goes as well.
    one: dict[str, int] = {"w1": 1}
    dask.workers = [{}, {}, {}, one, {}, {}, one, {}, one]
    assert dict(run_on_cluster(math.sqrt, [9.0], ADDRESS)) == {0: 3.0}
    told = capsys.readouterr().err.splitlines()
    left = f"campaign: no workers left at {ADDRESS}, their logs tell why; waiting"
    assert told == [f"campaign: no workers yet at {ADDRESS}; waiting", left, left]


def test_a_campaign_without_its_scheduler_says_what_is_kept(
    dask: Cluster, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    rules = Rules(DEFAULT_PRESET, motion={"perception_cap": 1})
    done = run_trial(Trial("clutter", 1, rules))

    def same(function: object, trial: Trial) -> TrialResult:
        mission = replace(done.mission, seed=trial.seed)
        return replace(done, mission=mission)

    results = failing(CancelledError("gone"))
    dask.work = lambda function, trial: results(lambda item: same(function, item), trial)
    command = ["--generated", "4", "--kind", "clutter", "--dask", ADDRESS]
    command += ["--set", "motion.perception_cap=1"]
    assert main([*command, "--output", str(tmp_path)]) == 2
    told = capsys.readouterr()
    file = tmp_path / "trials.jsonl"
    assert told.out == ""
    assert told.err.splitlines()[-1] == (
        f"campaign: the Dask scheduler at {ADDRESS} is lost; {file} keeps the 2 missions so far, "
        "the same command goes on from there"
    )
    assert file.read_bytes().count(b"\n") == 3

    dask.work = same
    assert main([*command, "--output", str(tmp_path)]) == 1  # the cap does not let them arrive
    assert file.read_bytes().count(b"\n") == 5

    dask.work = failing(CancelledError("gone"))
    assert main(command) == 2
    assert "without --output the 2 missions" in capsys.readouterr().err


def test_dask_itself_gives_each_result_its_place() -> None:
    distributed = pytest.importorskip("distributed")
    before = threading.active_count()
    with distributed.LocalCluster(
        n_workers=1, threads_per_worker=2, processes=False, dashboard_address=None
    ) as local:
        found = dict(run_on_cluster(operator.neg, [5, 5, 7], local.scheduler_address))
        with pytest.raises(ValueError, match=r"math domain|nonnegative"):
            list(run_on_cluster(math.sqrt, [-1.0], local.scheduler_address))
    assert found == {0: -5, 1: -5, 2: -7}
    assert threading.active_count() <= before + 20
