import msgspec
import pytest

from app.studies import one_run
from app.studies.one_run import Common, Task, died, run_case
from app.studies.plan import Case
from tests.app.studies.study_fakes import plan


def task(number: int) -> Task:
    made = plan()
    return Task(made.case(number), msgspec.json.encode(Common(made.raw, made.study.measures)))


def test_a_run_gives_its_measures() -> None:
    outcome = run_case(task(0))
    assert (outcome.exit, outcome.error) == ("ok", "")
    way, refused = outcome.measures
    assert isinstance(way, float)
    assert 0.0 <= way < 0.01
    assert refused is False
    assert run_case(task(0)) == outcome


def test_bad_input_is_the_rows() -> None:
    bad = task(0)._replace(case=Case(0, "x", 0, (("posture[1]", 99.0),), (99.0,)))
    outcome = run_case(bad)
    assert (outcome.exit, outcome.measures) == ("error", (None, None))
    assert "posture[1]" in outcome.error


def test_a_fault_is_the_rows(monkeypatch: pytest.MonkeyPatch) -> None:
    def broken(*_: object) -> None:
        raise ZeroDivisionError("by\nzero")

    monkeypatch.setattr(one_run, "measured", broken)
    outcome = run_case(task(0))
    assert (outcome.exit, outcome.error) == ("error", "ZeroDivisionError: by zero")


def test_a_worker_that_dies_each_time_is_the_rows() -> None:
    outcome = died(task(3))
    assert (outcome.case.number, outcome.exit, outcome.measures) == (3, "error", (None, None))
