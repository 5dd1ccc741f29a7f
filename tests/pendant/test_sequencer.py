"""The sequencer of a program: what a stop leaves of it (CD-15)."""

import pytest

from pendant.program import JointMove, Program, ProgramState, Wait
from pendant.sequencer import Sequencer

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
