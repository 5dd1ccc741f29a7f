"""Jogging, as the supervisor tells it: one press, why it begins, and what ends it (test_sweep.py has every situation)."""

import math

import pytest

from pendant.equipment.load import Load
from pendant.events.event import Kind
from pendant.inputs import NOTHING, Button, Command, Inputs
from pendant.program.jog_move import LONGEST, Jogged, JogMove, MoveStraight, MoveThere
from pendant.signals.enabling_device import Grip
from pendant.tick.estimate import Estimate
from pendant.tick.modes import Law
from pendant.tick.motion_status import MotionStatus
from tests.pendant.estimates import estimate
from tests.pendant.freedrive.test_state_machine import Bench

JOINT = JogMove(frame="joint", axis=0, sign=1)
HOME = MoveThere(q=(0.1,) * 6, name="home")
STRAIGHT = MoveStraight(position=(0.1, 0.2, 0.3), quaternion=(1.0, 0.0, 0.0, 0.0))
ALL: tuple[Jogged, ...] = (JOINT, HOME, STRAIGHT)


def held(move: Jogged, button: Button | None = None) -> Inputs:
    return Inputs(jog=move, held=frozenset({button} if button else ()))


def rested(**changes: float | bool) -> Bench:
    bench = Bench(**changes)
    bench.run(60)
    return bench


@pytest.mark.parametrize("move", ALL)
def test_what_is_jogged_is_followed_and_told_with_its_way(move: Jogged) -> None:
    bench = rested()
    decision = bench.step(held(move))
    assert decision.law is Law.FOLLOW
    assert type(decision.move) is type(move)
    assert [event.values for event in decision.events] == [{"what": move.what}]
    (ended,) = bench.step(Inputs(jog_released=True)).events
    assert ended.kind is Kind.JOG_ENDED
    assert ended.values["reason"] == "let go"
    assert bench.last.move is None


@pytest.mark.parametrize("move", ALL)
@pytest.mark.parametrize("other", ALL)
def test_another_button_takes_the_place_of_the_one_that_is_held(move: Jogged, other: Jogged) -> None:
    """Also after that has ended; the same one has to be let go first. A silent button is as one that is let go."""
    bench = rested()
    bench.run(3, held(move))
    bench.events.clear()
    bench.step(held(other))
    told = [(event.kind, event.values.get("reason")) for event in bench.events]
    another = [(Kind.JOG_ENDED, "another button"), (Kind.JOG_STARTED, None)]
    assert told == ([] if move is other else another)
    bench.step(held(other), status=MotionStatus(refused="beyond its range"))
    assert bench.events[-1].values["reason"] == "beyond its range"
    bench.events.clear()
    bench.run(20, held(other))
    assert bench.events == []
    bench.step(held(move))
    assert [event.kind for event in bench.events] == ([] if move is other else [Kind.JOG_STARTED])
    bench.run(251)
    assert [event.values["reason"] for event in bench.events[1:]] == ([] if move is other else ["no word from the button"])
    bench.run(60)
    assert bench.step(held(move)).law is Law.FOLLOW


@pytest.mark.parametrize("move", ALL)
def test_only_the_middle_of_the_enabling_device_lets_it_begin_and_go_on(move: Jogged) -> None:
    bench = rested(enabling__on=True)
    wait = "hold it in its middle position"
    (refused,) = bench.step(held(move)).events
    assert refused.values == {"what": move.what, "reason": f"enabling device {Grip.RELEASED}: {wait}"}
    bench.step(Inputs(jog_released=True, held=frozenset({Button.ENABLING})))
    assert bench.step(held(move, Button.ENABLING)).law is Law.FOLLOW
    bench.step(held(move, Button.ENABLING_FULL))
    (ended,) = (event for event in bench.last.events if event.kind is Kind.JOG_ENDED)
    assert ended.values["reason"] == f"enabling device {Grip.PRESSED}: {wait}"


@pytest.mark.parametrize("move", ALL)
def test_not_while_free_drive_is_tried(move: Jogged) -> None:
    bench = rested()
    bench.run(3, Inputs(held=frozenset({Button.FREE_DRIVE})))
    (refused,) = bench.step(held(move, Button.FREE_DRIVE)).events
    assert refused.values == {"what": move.what, "reason": "free-drive is being tried"}


@pytest.mark.parametrize("move", ALL)
def test_not_while_the_payload_is_being_changed(move: Jogged) -> None:
    bench = rested()
    bench.step(Inputs(load=Load(mass=1.0)))
    (refused,) = bench.step(held(move)).events
    assert refused.values == {"what": move.what, "reason": "the payload is being changed"}


@pytest.mark.parametrize(
    ("commands", "value", "reason"),
    [
        ((Command.REMOTE,), estimate(), "switch to NORMAL or TEACH first"),
        ((Command.EMERGENCY_STOP,), estimate(), "reset first"),
        ((), estimate(joints_valid=False), "check joint encoders and motor currents"),
    ],
)
@pytest.mark.parametrize("move", ALL)
def test_what_forbids_it_also_ends_it(move: Jogged, commands: tuple[Command, ...], value: Estimate, reason: str) -> None:
    bench = rested()
    for before in (NOTHING, held(move)):
        bench.run(3, before)
        bench.step(Inputs(jog=move, commands=commands), value)
        (told,) = (event for event in bench.last.events if event.kind in (Kind.JOG_REFUSED, Kind.JOG_ENDED))
        assert told.kind is (Kind.JOG_ENDED if before.jog else Kind.JOG_REFUSED)
        assert told.values["reason"] == reason
        bench = rested()


def test_the_move_that_is_done_has_ended_and_an_older_one_has_not() -> None:
    bench = rested()
    move = bench.step(held(HOME)).move
    assert move is not None
    bench.step(held(HOME), status=MotionStatus(move.id + 1))
    assert bench.last.move is move
    (ended,) = bench.step(held(HOME), status=MotionStatus(move.id)).events
    assert ended.values["reason"] == "done"
    bench.step(held(HOME), status=MotionStatus(move.id))
    assert bench.last.move is None


JUST = 1e-12


@pytest.mark.parametrize("frame", ["joint", "base", "tool"])
@pytest.mark.parametrize("axis", [-2, -1, 0, 1, 4, 5, 6, 7])
def test_an_axis_that_the_arm_has_not_is_refused(frame: str, axis: int) -> None:
    move = JogMove(frame=frame, axis=axis, sign=1) if 0 <= axis < 6 else None  # type: ignore[arg-type]
    asked = move or JogMove(frame=frame, axis=axis, sign=-1)  # type: ignore[arg-type]
    decision = rested().step(held(asked))
    if move:
        assert decision.law is Law.FOLLOW
    else:
        assert decision.events[0].values["reason"] == f"axis {axis}, allowed: 0 .. 5"


@pytest.mark.parametrize(
    ("length", "fits"),
    [
        (0.0, True),
        (JUST, True),
        (LONGEST - JUST, True),
        (LONGEST, True),
        (LONGEST + JUST, False),
        (-JUST, False),
        (math.inf, False),
        (-math.inf, False),
        (math.nan, False),
    ],
)
def test_a_length_is_a_step_of_one_metre_or_radian_at_most(length: float, fits: bool) -> None:
    decision = rested().step(held(JogMove(frame="tool", axis=2, sign=1, length=length)))
    assert (decision.law is Law.FOLLOW) is fits
    assert fits or decision.events[0].values["reason"] == f"length {length:g}, allowed: 0 .. 1"


@pytest.mark.parametrize("count", [0, 1, 5, 6, 7])
def test_a_posture_has_as_many_angles_as_the_arm(count: int) -> None:
    decision = rested().step(held(MoveThere(q=(0.0,) * count)))
    assert (decision.law is Law.FOLLOW) is (count == 6)
    assert count == 6 or decision.events[0].values["reason"] == f"{count} joint angles, allowed: 6"
