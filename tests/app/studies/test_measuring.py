"""Measures of whole small runs, against what the same runs' events and expectations say."""

from typing import Any

import pytest

from app.files.checked import convert
from app.runs.runner import run, simulate
from app.session.prepare import prepare
from app.session.session_file import Session
from app.studies.measuring import Total
from app.studies.one_run import measured
from app.studies.study_measures import AnyMeasure

PRESSED: dict[str, Any] = {
    "title": "t",
    "duration": 1.4,
    "settings": {"activation.period": 0.2, "sequence.period": 0.3},
    "timeline": [
        {"at": 0.1, "do": "tap", "control": "free_drive", "for": 0.9},
        {"after": "mode FREE_DRIVE", "delay": 0.1, "do": "push", "for": 0.2, "force": [0.0, 12.0, 0.0]},
    ],
}


def session(**fields: Any) -> Session:
    return convert({**PRESSED, **fields}, Session, "s")


def values(what: Session, *measures: dict[str, Any]) -> tuple[Any, ...]:
    made = [convert({"name": f"m{k}", **each}, AnyMeasure, "m") for k, each in enumerate(measures)]  # type: ignore[arg-type]
    return measured(what, made)


@pytest.mark.parametrize(
    ("statistic", "value"), [("largest", 3.0), ("smallest", -1.0), ("mean", 1.0), ("rms", (14 / 4) ** 0.5), ("last", 0.0)]
)
def test_statistics(statistic: Any, value: float) -> None:
    total = Total(statistic)
    assert total.value() is None
    for each in (2.0, 3.0, -1.0, 0.0):
        total.add(each)
    assert total.value() == pytest.approx(value)


def test_measures_are_those_of_the_run() -> None:
    what = session()
    prepared = prepare(what, "s")
    outcome = run(what, prepared, simulate(prepared), None)
    entered = next(time for time, mode in outcome.modes if mode == "FREE_DRIVE")
    happened, count, time, since, never, length, absent = values(
        what,
        {"measure": "happens", "kinds": ["entered"]},
        {"measure": "count", "kinds": ["*"]},
        {"measure": "time", "kinds": ["entered"]},
        {"measure": "time", "kinds": ["manipulation"], "after": "mode FREE_DRIVE"},
        {"measure": "time", "kinds": ["emergency_stop"]},
        {"measure": "period", "period": "activation"},
        {"measure": "period", "period": "activation", "run": 2},
    )
    assert (happened, count) == (True, len(outcome.events))
    assert time == pytest.approx(entered)
    moved = next(event.tick for event in outcome.events if event.kind == "manipulation")
    assert since == pytest.approx(0.002 * moved - entered)
    assert (never, absent) == (None, None)
    assert length == pytest.approx(0.2, abs=0.005)


def test_the_interval_is_kept() -> None:
    before, after = values(
        session(),
        {"measure": "displacement", "to": 0.4},
        {"measure": "displacement", "after": "mode FREE_DRIVE", "statistic": "last", "along": [0.0, 2.0, 0.0]},
    )
    assert 0.0 < before < 0.001
    assert 0.01 < after < 0.3


def test_the_recording_says_what_passed_by() -> None:
    passing, logged, vector, late = values(
        session(),
        {"measure": "value", "of": "tcp_speed", "statistic": "rms"},
        {"measure": "log", "of": "state.v_tcp", "statistic": "rms"},
        {"measure": "log", "of": "truth.touch_force", "index": 1},
        {"measure": "log", "of": "truth.touch_force", "after": "mode FREE_DRIVE", "to": 0.05},
    )
    assert logged == pytest.approx(passing, rel=1e-9)
    assert (vector, late) == (pytest.approx(12.0), 0.0)


def test_the_truth_scores_and_expectations_pass() -> None:
    error, passed = values(
        session(expectations=[{"expect": "state", "mode": "RUN", "at": 0.5}]),
        {"measure": "value", "of": "payload_true"},
        {"measure": "passed"},
    )
    assert (error, passed) == (0.0, False)


def test_a_contact_is_timed_from_its_true_beginning() -> None:
    """A hard block is met at 0.2 m/s: the delay is some ticks, and at most what the travel to a clear force takes."""
    what = {
        "title": "t",
        "tool": "sphere",
        "duration": 2.0,
        "settings": {"contact.on": True},
        "world": [{"kind": "box", "name": "b", "position": [-0.6282, 0.0365, 0.263], "size": [0.1] * 3, "stiffness": 2e5}],
        "program": {
            "name": "p",
            "steps": [
                {
                    "kind": "linear",
                    "position": [-0.6282, 0.1665, 0.243],
                    "quaternion": [0.000563, 0.707107, 0.707107, 0.0],
                    "speed": 0.2,
                    "acceleration": 1.0,
                }
            ],
        },
        "timeline": [
            {"at": 0.3, "do": "program", "command": "start"},
            {"after": "event contact_gained", "do": "tap", "control": "emergency_stop"},
        ],
    }
    delay, force, nothing, none = values(
        convert(what, Session, "s"),
        {"measure": "contact_delay"},
        {"measure": "contact_force"},
        {"measure": "contact_delay", "to": 0.1},
        {"measure": "contact_force", "to": 0.1},
    )
    assert 0.0 < delay < 10.0
    assert 20.0 < force < 500.0
    assert (nothing, none) == (None, 0.0)
