"""Programs and their sequencer."""

import math

import msgspec
import pytest
from hypothesis import given
from hypothesis import strategies as st

from pendant.program.sequencer import Sequencer
from pendant.program.steps import (
    LEAST_FORCE,
    MOST_FORCE,
    ApplyForce,
    JointMove,
    LinearMove,
    Move,
    Program,
    ProgramState,
    Wait,
    misfit,
)
from pendant.tick.state import state_of

HOME = (0.0,) * 6
IDENTITY = (1.0, 0.0, 0.0, 0.0)
THREE = Program(
    name="three",
    steps=(JointMove(q=HOME), LinearMove(position=(0.3, 0.1, 0.4), quaternion=IDENTITY), JointMove(q=HOME, speed=1.0)),
)


def convert(step: dict[str, object]) -> Program:
    return msgspec.convert({"steps": [step]}, Program)


def test_a_program_is_read_from_plain_data() -> None:
    plain = {
        "name": "pick",
        "steps": [
            {"kind": "joint", "q": [0, 1, 2, 3, 4, 5], "speed": 0.5},
            {"kind": "linear", "position": [0.1, 0.2, 0.3], "quaternion": [0, 1, 0, 0], "acceleration": 2.0},
            {"kind": "wait", "duration": 1.5},
        ],
    }
    assert msgspec.convert(plain, Program) == Program(
        name="pick",
        steps=(
            JointMove(q=(0, 1, 2, 3, 4, 5), speed=0.5, acceleration=0.25),
            LinearMove(position=(0.1, 0.2, 0.3), quaternion=(0, 1, 0, 0), speed=0.1, acceleration=2.0),
            Wait(duration=1.5),
        ),
    )


@pytest.mark.parametrize(
    "bad",
    [
        {"kind": "circle"},
        {"kind": "joint"},
        {"kind": "joint", "q": [0.0, math.nan]},
        {"kind": "joint", "q": [math.inf]},
        {"kind": "joint", "q": [0.0], "speed": 0.0},
        {"kind": "joint", "q": [0.0], "speed": 1.01},
        {"kind": "joint", "q": [0.0], "acceleration": 0.0},
        {"kind": "joint", "q": [0.0], "acceleration": math.inf},
        {"kind": "joint", "q": [0.0], "duration": 1.0},
        {"kind": "linear", "position": [0.0, 0.0], "quaternion": [1, 0, 0, 0]},
        {"kind": "linear", "position": [0.0, 0.0, math.nan], "quaternion": [1, 0, 0, 0]},
        {"kind": "linear", "position": [0.0, 0.0, 0.0], "quaternion": [1, 0.1, 0, 0]},
        {"kind": "linear", "position": [0.0, 0.0, 0.0], "quaternion": [0, 0, 0, 0]},
        {"kind": "linear", "position": [0.0, 0.0, 0.0], "quaternion": [1, 0, 0, 0], "speed": 0.0},
        {"kind": "linear", "position": [0.0, 0.0, 0.0], "quaternion": [1, 0, 0, 0], "speed": 3.1},
        {"kind": "linear", "position": [0.0, 0.0, 0.0], "quaternion": [1, 0, 0, 0], "acceleration": 50.1},
        {"kind": "wait", "duration": -0.1},
        {"kind": "wait", "duration": 3601.0},
        {"kind": "wait", "duration": math.nan},
        {"kind": "joint", "q": [0.0], "speed": math.nan},
        {"kind": "joint", "q": [0.0], "acceleration": math.nan},
        {"kind": "linear", "position": [0.0, 0.0, 0.0], "quaternion": [1, 0, 0, 0], "speed": math.nan},
    ],
)
def test_a_bad_step_is_refused(bad: dict[str, object]) -> None:
    with pytest.raises(msgspec.ValidationError):
        convert(bad)


@pytest.mark.parametrize(("value", "text"), [(math.nan, "nan"), (math.inf, "inf"), (-math.inf, "-inf")])
def test_a_value_that_is_no_number_is_named(value: float, text: str) -> None:
    with pytest.raises(ValueError, match=f"^{text} is not a finite number$"):
        JointMove(q=(0.0, value, 1.0))


def test_a_program_has_at_least_one_step() -> None:
    with pytest.raises(msgspec.ValidationError):
        msgspec.convert({"steps": []}, Program)
    assert misfit(Program(steps=()), 6) == "the program has no steps"


def test_the_joint_angles_must_fit_the_arm() -> None:
    assert misfit(THREE, 6) is None
    assert misfit(THREE, 7) == "step 1 has 6 joint angles, the arm has 7 joints"
    late = Program(steps=(Wait(duration=1.0), JointMove(q=(0.0,) * 5)))
    assert misfit(late, 6) == "step 2 has 5 joint angles, the arm has 6 joints"


def test_a_slightly_short_quaternion_passes() -> None:
    assert convert({"kind": "linear", "position": [0, 0, 0], "quaternion": [0.9991, 0, 0, 0]})
    with pytest.raises(msgspec.ValidationError, match=r"its length is 0\.998, allowed: 1"):
        convert({"kind": "linear", "position": [0, 0, 0], "quaternion": [0.998, 0, 0, 0]})


def started(program: Program) -> Sequencer:
    sequencer = Sequencer()
    assert sequencer.state is ProgramState.NONE
    sequencer.load(program)
    assert sequencer.state is ProgramState.STOPPED
    assert sequencer.move is None
    sequencer.start()
    assert sequencer.state is ProgramState.RUNNING
    return sequencer


def move_of(sequencer: Sequencer) -> Move:
    assert sequencer.move is not None
    return sequencer.move


def test_steps_follow_each_other_when_their_moves_are_done() -> None:
    sequencer = started(THREE)
    for index, step in enumerate(THREE.steps):
        assert sequencer.index == index
        assert move_of(sequencer) == msgspec.structs.replace(step, id=index + 1)
        for not_done in (0, index, index + 2, 99):
            assert not sequencer.step(not_done)
            assert sequencer.index == index
        assert sequencer.step(index + 1) == (index == 2)
    assert sequencer.state is ProgramState.STOPPED
    assert (sequencer.index, sequencer.move, sequencer.program) == (0, None, THREE)


def test_ids_never_come_again() -> None:
    sequencer = started(THREE)
    sequencer.step(1)
    assert move_of(sequencer).id == 2
    sequencer.pause()
    assert (sequencer.state, sequencer.move) == (ProgramState.PAUSED, None)
    assert not sequencer.step(2)
    sequencer.resume()
    assert (sequencer.index, move_of(sequencer).id) == (1, 3)
    sequencer.stop()
    sequencer.start()
    assert (sequencer.index, move_of(sequencer).id) == (0, 4)


@pytest.mark.parametrize(("duration", "count"), [(0.0, 1), (0.002, 1), (0.004, 2), (1.0, 500)])
def test_a_wait_lasts_its_ticks_whatever_the_law_reports(duration: float, count: int) -> None:
    sequencer = started(Program(steps=(Wait(duration=duration), JointMove(q=HOME))))
    for tick in range(1, count + 1):
        assert isinstance(sequencer.move, Wait), tick
        assert not sequencer.step(1)
    assert isinstance(sequencer.move, JointMove)


def test_a_paused_wait_goes_on_where_it_was_and_a_restarted_one_from_its_beginning() -> None:
    sequencer = started(Program(steps=(Wait(duration=0.02),)))
    for _ in range(4):
        assert not sequencer.step(0)
    sequencer.pause()
    sequencer.resume()
    assert [sequencer.step(0) for _ in range(6)] == [False] * 5 + [True]
    sequencer.start()
    sequencer.step(0)
    sequencer.stop()
    sequencer.start()
    assert [sequencer.step(0) for _ in range(10)] == [False] * 9 + [True]


def test_two_waits_each_last_their_own_time() -> None:
    sequencer = started(Program(steps=(Wait(duration=0.006), Wait(duration=0.01))))
    indices = []
    for _ in range(8):
        assert sequencer.state is ProgramState.RUNNING
        indices.append(sequencer.index)
        sequencer.step(0)
    assert sequencer.state is not ProgramState.RUNNING
    assert indices == [0] * 3 + [1] * 5


def test_its_state_tells_histories_apart() -> None:
    one, other = started(THREE), started(THREE)
    assert state_of(one) == state_of(other)
    one.step(1)
    assert state_of(one) != state_of(other)
    other.step(1)
    assert state_of(one) == state_of(other)


@given(done=st.lists(st.integers(0, 5), max_size=60))
def test_the_index_only_grows_and_only_by_one(done: list[int]) -> None:
    sequencer = started(THREE)
    for move_done in done:
        before, move = sequencer.index, sequencer.move
        ended = sequencer.step(move_done)
        if move is None or move_done != move.id:
            assert (sequencer.index, sequencer.move, ended) == (before, move, False)
        else:
            assert (sequencer.index, ended) == ((before + 1, False) if before < 2 else (0, True))


def test_a_force_to_apply_has_its_size_to_the_ends_of_its_range() -> None:
    for size in (LEAST_FORCE, MOST_FORCE):
        assert ApplyForce(force=(0.0, 0.0, -size)).force == (0.0, 0.0, -size)
    for size in (0.999 * LEAST_FORCE, 1.001 * MOST_FORCE):
        with pytest.raises(ValueError, match=r"allowed: 1 \.\. 90 N"):
            ApplyForce(force=(0.0, size, 0.0))
