"""The engine with real workers: one cluster for all of these, started once."""

import os
import signal
from collections.abc import Iterator
from concurrent.futures import CancelledError
from pathlib import Path
from typing import Any

import pytest

from app.engine import dask_client
from app.engine.source import identity
from app.engine.spreading import Away, _Spreading, guarded, spread
from app.files.bad_input import BadInput


@pytest.fixture(scope="module", autouse=True)
def workers_that_may_die_once() -> Iterator[None]:
    """Dask gives work up when a second worker died of it: each takes seconds to come again. A cluster of these tests alone."""

    def end() -> None:
        for workers in list(dask_client._embedded):
            dask_client.end_embedded(workers)

    end()
    with pytest.MonkeyPatch.context() as patch:
        patch.setitem(dask_client.CONFIG, "distributed.scheduler.allowed-failures", 1)
        yield
    end()


def squared(number: int) -> tuple[int, int]:
    return number * number, os.getpid()


def refusing(number: int) -> int:
    if number == 3:
        raise BadInput("here", "number", number, "another")
    return number


def dying(path: str) -> str:
    """Ends its process the first time; later it answers. "always" ends it each time."""
    if path == "always" or not Path(path).exists():
        if path != "always":
            Path(path).write_text("")
        os.kill(os.getpid(), signal.SIGKILL)
    return "done"


def test_one_worker_is_this_process_and_reads_no_further_than_it_must() -> None:
    read: list[int] = []

    def numbers() -> Iterator[int]:
        for k in range(5):
            read.append(k)
            yield k

    results = spread(squared, numbers(), workers=1)
    assert next(results) == (0, (0, os.getpid()))
    assert read == [0, 1]
    assert [place for place, _ in results] == [1, 2, 3, 4]


def test_one_item_is_not_worth_a_process() -> None:
    assert list(spread(squared, [7])) == [(0, (49, os.getpid()))]
    assert list(spread(squared, [])) == []


def test_every_item_is_done_once_by_processes_that_stay() -> None:
    found = dict(spread(squared, range(40), workers=2))
    assert [found[k][0] for k in range(40)] == [k * k for k in range(40)]
    workers = {pid for _, pid in found.values()}
    assert os.getpid() not in workers
    assert len(workers) == 2
    assert {pid for _, (_, pid) in spread(squared, range(20), workers=2)} <= workers


def test_what_the_work_refuses_is_raised_here() -> None:
    with pytest.raises(BadInput, match="here: number = 3: another"):
        list(spread(refusing, range(10), workers=2))


def test_work_whose_worker_died_is_done_again(tmp_path: Path) -> None:
    paths = [str(tmp_path / "a"), str(tmp_path / "b")]
    assert [result for _, result in spread(dying, paths, workers=2)] == ["done", "done"]


def test_work_that_ends_each_worker_is_given_up_and_what_was_beside_it_is_done(tmp_path: Path) -> None:
    (tmp_path / "there").write_text("")
    items = ["always", *[str(tmp_path / "there")] * 3]
    found = dict(spread(dying, items, workers=2, lost=lambda item: f"gave up {item}"))
    assert found == {0: "gave up always", 1: "done", 2: "done", 3: "done"}


def test_a_worker_that_came_later_and_runs_another_source_does_nothing() -> None:
    done: list[int] = []
    with pytest.raises(BadInput, match=r"a worker: source = .*: expected c0ffee"):
        guarded({**identity(), "source": "c0ffee"}, done.append, 1)
    assert done == []


class Answering:
    """A future that raises when it is asked for its result."""

    def __init__(self, status: str, error: Exception) -> None:
        self.status, self._error = status, error

    def result(self, timeout: float) -> object:
        raise self._error


@pytest.mark.parametrize("error", [TimeoutError(), CancelledError(), OSError("connection lost")])
def test_a_result_that_does_not_come_is_no_error_of_the_work(error: Exception) -> None:
    spreading = _Spreading.__new__(_Spreading)
    with pytest.raises(Away):
        spreading._result(Answering("finished", error), 1, None, 1)
    with pytest.raises(type(error)):
        spreading._result(Answering("error", error), 1, None, 1)  # the work raised it


def test_a_result_that_is_late_is_waited_for(monkeypatch: pytest.MonkeyPatch) -> None:
    late, ask = set[object](), _Spreading._result

    def first_late(self: _Spreading, future: object, *more: Any) -> object:
        if future not in late:
            late.add(future)
            raise Away
        return ask(self, future, *more)

    monkeypatch.setattr(_Spreading, "_result", first_late)
    found = list(spread(squared, range(12), workers=2))
    assert sorted((place, value) for place, (value, _) in found) == [(k, k * k) for k in range(12)]
    assert len(late) == 12


def test_a_cluster_whose_processes_ended_for_good_is_replaced() -> None:
    """As Dask lets go of those that do not start again in time; without another cluster the work would wait for ever."""
    list(spread(squared, [1, 2], workers=2))
    cluster = dask_client._embedded[2]
    for name in list(cluster.workers):
        cluster.sync(cluster.workers.pop(name).close)
    assert dask_client.crippled(2)
    found = dict(spread(squared, range(8), workers=2))
    assert [found[k][0] for k in range(8)] == [k * k for k in range(8)]
    assert dask_client._embedded[2] is not cluster
    assert not dask_client.crippled(2)
