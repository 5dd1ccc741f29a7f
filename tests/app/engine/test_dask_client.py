from typing import Any

import pytest

from app.engine import dask_client
from app.engine.dask_client import check, compare, connect, cores
from app.engine.source import identity
from app.files.bad_input import BadInput


class Workers:
    """A client whose workers answer what they are given."""

    def __init__(self, *answers: Any) -> None:
        self._answers = answers
        self.closed = False

    def run(self, work: Any, on_error: str) -> dict[str, Any]:
        assert (work, on_error) == (identity, "return")
        return {f"tcp://{k}": answer for k, answer in enumerate(self._answers)}

    def close(self) -> None:
        self.closed = True


def test_workers_that_run_the_same_are_taken() -> None:
    check(Workers(identity(), identity()))


@pytest.mark.parametrize("name", ["source", "pendant", "mujoco"])
def test_a_worker_that_runs_something_else_is_refused_in_a_line(name: str) -> None:
    with pytest.raises(BadInput) as refused:
        check(Workers(identity(), {**identity(), name: "0.0.1"}))
    said = str(refused.value)
    assert said.startswith(f"worker tcp://1: {name} = '0.0.1': this process has {identity()[name]}")
    assert "\n" not in said


def test_a_worker_without_the_product_is_refused_in_a_line() -> None:
    client = Workers(ModuleNotFoundError("No module named 'app'"))
    with pytest.raises(BadInput, match="worker tcp://0: cannot import this version of pendant"):
        check(client)
    assert client.closed


def test_what_is_missing_is_told() -> None:
    with pytest.raises(BadInput, match="source"):
        compare({name: value for name, value in identity().items() if name != "source"}, "w")


@pytest.mark.parametrize("address", ["tcp://127.0.0.1:1", "nowhere", "tcp://127.0.0.1:port"])
def test_a_scheduler_that_is_not_there_is_one_line(address: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(dask_client, "ANSWER", 1.0)  # a refused connection is tried again until then
    with pytest.raises(BadInput, match="--scheduler") as refused:
        connect(2, address)
    assert "\n" not in str(refused.value)


def test_there_are_cores() -> None:
    assert cores() >= 1
