"""An arm that does not follow its reference is stopped, in every mode that holds or moves it (RL-1)."""

import math

import pytest

from pendant.event_table import render
from pendant.events.event import Event, Kind, Values
from pendant.inputs import Inputs
from pendant.safety.following import left_path
from pendant.safety.settings import FollowingSettings
from pendant.tick.estimate import ON_PATH, Estimate, FollowingError
from pendant.tick.modes import Law, Mode, Safety
from tests.pendant.estimates import estimate
from tests.pendant.freedrive.test_state_machine import Bench

JOINTS = ("base", "shoulder", "elbow", "wrist_1", "wrist_2", "wrist_3")
USE = FollowingSettings()
HELD: Values = {"part": "forearm", "force": 40.0, "speed": 120.0, "x": 0.4, "y": 0.0, "z": 0.3, "posture": "0.0"}


def left(lags: Estimate, use: FollowingSettings = USE) -> Event | None:
    """The event of an arm whose forearm something holds."""
    return left_path(lags, use, JOINTS, lambda: HELD)


def lagging(share: float = 0.0, tool: float = 0.0) -> Estimate:
    """An arm whose elbow has this share of the largest error, and whose tool is so far away [m]."""
    held = estimate()
    held.following = FollowingError(2, 0.02 * share, 0.02, share, tool)
    return held


@pytest.mark.parametrize(
    ("share", "tool", "beyond"),
    [
        (0.0, 0.0, False),
        (0.999 * USE.joint, 0.0, False),
        (USE.joint, USE.tool, False),
        (1.001 * USE.joint, 0.0, True),
        (0.0, 0.999 * USE.tool, False),
        (0.0, 1.001 * USE.tool, True),
        (math.nan, 0.0, True),
        (0.0, math.nan, True),
    ],
)
def test_it_has_left_its_path_beyond_either_limit(share: float, tool: float, beyond: bool) -> None:
    assert (left(lagging(share, tool)) is not None) is beyond
    assert left(lagging(share, tool), FollowingSettings(on=False)) is None


def test_the_event_names_joint_and_errors_and_what_holds_the_arm() -> None:
    event = left(lagging(1.5, 0.012))
    assert event is not None
    assert event.kind is Kind.PATH_LEFT
    assert event.values == {
        "joint": "elbow",
        "value": pytest.approx(math.degrees(0.03)),
        "limit": pytest.approx(math.degrees(0.02 * USE.joint)),
        "distance": pytest.approx(12.0),
        **HELD,
    }
    assert "Forearm: 40 N" in render(event)[1]
    assert "orearm" not in render(Event(Kind.PATH_LEFT, 0, {**event.values, "part": ""}))[1]


def test_a_held_arm_is_stopped_once() -> None:
    bench = Bench()
    bench.run(60)
    bench.step(Inputs(), lagging(1.1))
    assert [event.kind for event in bench.last.events] == [Kind.PATH_LEFT]
    assert (bench.last.mode, bench.last.safety, bench.last.law) == (Mode.STOP, Safety.PROTECTIVE_STOP, Law.BRAKE)
    bench.step(Inputs(), lagging(1.1))
    assert bench.last.events == ()


def test_an_arm_without_a_reference_is_not_judged() -> None:
    assert left(estimate()) is None
    assert estimate().following == ON_PATH
