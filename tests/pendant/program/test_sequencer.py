"""The sequencer of a program: what a stop leaves of it (CD-15)."""

import pytest

from pendant.contact.contact_change import ArmPose
from pendant.program.sequencer import PATIENCE, Sequencer
from pendant.program.steps import ApplyForce, ContactMove, JointMove, LinearMove, Program, ProgramState, Wait, ZeroSensor
from pendant.tick.pose import UNTURNED

STEPS = (Wait(duration=0.01), JointMove(q=(0.0,) * 6))


def test_a_stop_without_a_program_leaves_none() -> None:
    """A stop of the arm stops the sequencer, whether a program is loaded or not (FD-1)."""
    sequencer = Sequencer()
    sequencer.stop()
    assert (sequencer.state, sequencer.program, sequencer.move) == (ProgramState.NONE, None, None)


@pytest.mark.parametrize("ticks", range(7))
def test_a_stop_keeps_the_program_and_begins_it_anew(ticks: int) -> None:
    sequencer = Sequencer()
    sequencer.load(Program(steps=STEPS))
    sequencer.start()
    for _ in range(ticks):
        assert not sequencer.step(0)
    sequencer.stop()
    assert (sequencer.state, sequencer.index, sequencer.move) == (ProgramState.STOPPED, 0, None)
    sequencer.start()
    assert [isinstance(sequencer.move, Wait) for _ in range(6) if not sequencer.step(0)] == [True] * 4 + [False] * 2


def zeroing() -> Sequencer:
    sequencer = Sequencer()
    sequencer.load(Program(steps=(ZeroSensor(), Wait(duration=0.01), ApplyForce(force=(0.0, 0.0, -10.0)))))
    sequencer.start((1.0, 2.0, 3.0))
    return sequencer


def test_a_step_that_zeroes_the_sensor_lasts_until_it_is_zeroed_or_patience_ends() -> None:
    sequencer = zeroing()
    assert [sequencer.step(0) or sequencer.impatient() for _ in range(PATIENCE)] == [False] * (PATIENCE - 1) + [True]
    assert isinstance(sequencer.move, ZeroSensor)


@pytest.mark.parametrize("waited", [0, 1, PATIENCE - 1])
def test_what_is_left_of_its_patience_makes_no_wait_longer(waited: int) -> None:
    sequencer = zeroing()
    for _ in range(waited):
        sequencer.impatient()
    assert not sequencer.zeroed()
    assert [isinstance(sequencer.move, Wait) for _ in range(6) if not sequencer.step(0)] == [True] * 4 + [False] * 2


def test_a_force_counts_from_what_was_felt_before_as_the_new_zero_has_it() -> None:
    sequencer = zeroing()
    sequencer.shift((0.5, 1.0, 3.5))
    sequencer.zeroed()
    for _ in range(5):
        sequencer.step(0)
    assert isinstance(sequencer.move, ApplyForce)
    assert sequencer.move.untouched == pytest.approx((0.5, 1.0, -0.5))


def test_without_a_program_it_is_at_the_beginning_and_knows_the_tool_as_the_flange() -> None:
    sequencer = Sequencer()
    assert (sequencer.state, sequencer.index, sequencer.guided) == (ProgramState.NONE, 0, False)
    assert (sequencer.guiding, sequencer.braked) == (False, False)
    assert sequencer.R_FT == UNTURNED


def test_the_sensor_may_be_zeroed_before_any_program_begins() -> None:
    """Once started it counts from what is felt then."""
    sequencer = Sequencer()
    sequencer.shift((1.0, -2.0, 3.0))
    sequencer.load(Program(steps=(ApplyForce(force=(0.0, 0.0, -10.0)),)))
    sequencer.start((0.5, 0.0, 0.0))
    assert isinstance(sequencer.move, ApplyForce)
    assert sequencer.move.untouched == (0.5, 0.0, 0.0)


def test_until_it_is_known_where_the_arm_is_a_move_until_contact_has_no_line() -> None:
    sequencer = Sequencer()
    sequencer.load(Program(steps=(ContactMove(),)))
    sequencer.start()
    step = sequencer.move
    assert not sequencer.step(0)
    assert sequencer.move is step
    assert not sequencer.step(0, lambda: ArmPose((0.0,) * 6, (0.1, 0.2, 0.3), UNTURNED))
    assert isinstance(sequencer.move, LinearMove)
    assert sequencer.move.position == pytest.approx((0.1, 0.2, 0.1))
