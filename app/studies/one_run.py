"""One run of a study, in a worker: its session is made, run and measured, and whatever goes wrong is part of its row."""

import functools
import math
import tempfile
import threading
from pathlib import Path
from typing import Any, NamedTuple

import msgspec
import numpy as np

from app.files.bad_input import BadInput
from app.log.layout import WORDS
from app.log.recorder import Recorder
from app.log_reading.reader import Log, read
from app.runs.runner import RunOutcome, run, simulate
from app.session.prepare import prepare
from app.session.session_file import Session
from app.session.triggers import Trigger
from app.studies.measuring import Number, Taker, Total, taker
from app.studies.plan import Case, session_of
from app.studies.study_measures import AnyMeasure, OfLog, Passed
from pendant.decision import Decision
from pendant.settings.schema import ticks
from pendant.tick.modes import TICK

ONE_AT_A_TIME = threading.Lock()
"""A session holds the interpreter's lock: a worker with several threads runs one after the other, all with its core's pace."""


class Task(NamedTuple):
    """A run, and what it needs."""

    case: Case
    common: bytes  # of all runs of the study: base session and measures, as JSON


class CaseOutcome(NamedTuple):
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


def run_case(task: Task) -> CaseOutcome:
    """Run, measure, and never raise: an error is the row's."""
    common = _common(task.common)
    nothing = (None,) * len(common.measures)
    try:
        with ONE_AT_A_TIME:
            session = session_of(common.session, task.case.values, task.case.seed, "session")
            return CaseOutcome(task.case, measured(session, common.measures), "ok")
    except BadInput as error:
        return CaseOutcome(task.case, nothing, "error", str(error))
    except Exception as error:  # noqa: BLE001 a fault in one run must not end the others; its row tells it
        return CaseOutcome(task.case, nothing, "error", " ".join(f"{type(error).__name__}: {error}".split()))


def died(task: Task) -> CaseOutcome:
    """What stands for a run whose worker died each time that it was tried."""
    count = len(_common(task.common).measures)
    return CaseOutcome(task.case, (None,) * count, "error", "its worker died each time that it ran")


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


def of_log(measure: OfLog, log: Log) -> float | None:
    """A statistic of a recorded array."""
    trigger = Trigger(measure.after, measure.nth)
    start = 0 if measure.after is None else _moment(trigger, log)
    if start is None:
        return None
    kind, _, name = measure.of.partition(".")
    values: np.ndarray[Any, Any] = (log.state if kind == "state" else log.truth)[name]
    if values.ndim > 1:
        if measure.index is None:
            values = np.linalg.norm(values, axis=1)
        elif measure.index < values.shape[1]:
            values = values[:, measure.index]
        else:
            return None
    begin, end = start + ticks(measure.begin), math.inf if measure.end is None else start + ticks(measure.end)
    total = Total(measure.statistic)
    for value in values[(log.ticks >= begin) & (log.ticks <= end)].tolist():
        if math.isfinite(value):
            total.add(value)
    return total.value()


def _moment(trigger: Trigger, log: Log) -> int | None:
    """The tick of what `after` names, from a recording's codes and events."""
    word, _, name = str(trigger.after).partition(" ")
    if word == "event":
        found = [round(event.t / TICK) for event in log.events if event.kind == name]
    else:
        now = np.array(log.state[word]) == WORDS[word].index(name)
        found = log.ticks[now & ~np.concatenate([[False], now[:-1]])].tolist()
    return int(found[trigger.nth - 1]) if len(found) >= trigger.nth else None
