"""One run of a study, in a worker: its session is made, run and measured, and whatever goes wrong is part of its row."""

import functools
import tempfile
import threading
from pathlib import Path
from typing import Any, NamedTuple

import msgspec

from app.files.bad_input import BadInput
from app.log.reader import Log, read
from app.log.recorder import Recorder
from app.runs.runner import RunOutcome, run, simulate
from app.session.prepare import prepare
from app.session.session_file import Session
from app.studies.measuring import Number, Taker, of_log, taker
from app.studies.plan import Case, session_of
from app.studies.study_measures import AnyMeasure, OfLog, Passed
from pendant.decision import Decision

ONE_AT_A_TIME = threading.Lock()
"""A session holds the interpreter's lock: a worker with several threads runs one after the other, all with its core's pace."""


class Task(NamedTuple):
    """A run, and what it needs."""

    case: Case
    common: bytes  # of all runs of the study: base session and measures, as JSON


class Outcome(NamedTuple):
    """What came of a run."""

    case: Case
    measures: tuple[Number, ...]
    exit: str  # "ok", or "error"
    error: str = ""


class Common(msgspec.Struct, frozen=True):
    """What all runs of a study share."""

    session: dict[str, Any]
    measures: list[AnyMeasure]


@functools.lru_cache(4)
def _common(common: bytes) -> Common:
    return msgspec.json.decode(common, type=Common)


def run_case(task: Task) -> Outcome:
    """Run, measure, and never raise: an error is the row's."""
    common = _common(task.common)
    nothing = (None,) * len(common.measures)
    try:
        with ONE_AT_A_TIME:
            session = session_of(common.session, task.case.values, task.case.seed, "session")
            return Outcome(task.case, measured(session, common.measures), "ok")
    except BadInput as error:
        return Outcome(task.case, nothing, "error", str(error))
    except Exception as error:  # noqa: BLE001 a fault in one run must not end the others; its row tells it
        return Outcome(task.case, nothing, "error", " ".join(f"{type(error).__name__}: {error}".split()))


def died(task: Task) -> Outcome:
    """What stands for a run whose worker died each time that it was tried."""
    count = len(_common(task.common).measures)
    return Outcome(task.case, (None,) * count, "error", "its worker died each time that it ran")


def measured(session: Session, measures: list[AnyMeasure]) -> tuple[Number, ...]:
    """Run a session; its measures, in order.

    Raises:
        BadInput: it cannot be simulated.
    """
    prepared = prepare(session, "session")
    simulation = simulate(prepared)
    takers = [taker(each, simulation) for each in measures]
    active = [each for each in takers if each is not None]

    def see(decision: Decision) -> None:
        tick = simulation.tick_count
        for each in active:
            each.see(tick, decision)

    if not any(isinstance(each, OfLog) for each in measures):
        return _values(measures, run(session, prepared, simulation, None, see=see), takers, None)

    def keep(decision: Decision) -> None:
        see(decision)
        recorder.see(simulation, decision)

    with tempfile.TemporaryDirectory(prefix="pendant-") as folder:
        with Recorder(Path(folder) / "log.mcap", simulation, session.title, planned=session.duration) as recorder:
            outcome = run(session, prepared, simulation, None, see=keep)
        return _values(measures, outcome, takers, read(Path(folder) / "log.mcap"))


def _values(measures: list[AnyMeasure], outcome: RunOutcome, takers: list[Taker | None], log: Log | None) -> tuple[Number, ...]:
    values: list[Number] = []
    for measure, found in zip(measures, takers, strict=True):
        if found is not None:
            values.append(found.value())
        elif isinstance(measure, Passed):
            values.append(outcome.passed)
        else:
            assert isinstance(measure, OfLog)
            assert log is not None
            values.append(of_log(measure, log))
    return tuple(values)
