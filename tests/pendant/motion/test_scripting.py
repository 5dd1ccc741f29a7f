"""What a running script wants is done motion by motion, for as long as it says so in every tick (FD-23)."""

import math
import re
from typing import Any

import pytest
from msgspec.structs import replace

from pendant.events.event import Event, Kind
from pendant.inputs import NOTHING, Command, Inputs
from pendant.motion.script_requests import (
    DirectTorque,
    ForceMode,
    GentleStop,
    Guided,
    Scripted,
    ScriptedJoints,
    ScriptedMove,
    ServoJoints,
    SpeedJoints,
    SpeedTool,
)
from pendant.program.steps import ProgramState, RunScript, script_program
from pendant.tick.modes import Law, Mode
from pendant.tick.motion_status import MotionStatus
from pendant.tick.pose import UNTURNED
from tests.pendant.estimates import estimate
from tests.pendant.freedrive.test_state_machine import Bench

WORD = Scripted()
SILENCE = 100
"""Ticks of `hold.silence`."""


def joints(number: int, angle: float = 0.1) -> ScriptedJoints:
    return ScriptedJoints(id=number, q=(angle,) * 6, acceleration=1.0, speed=1.0)


def running(**changes: float | bool) -> Bench:
    """A script's program runs, and has asked for nothing."""
    bench = Bench(activation__period=0.0, **changes)
    bench.run(60)
    bench.step(Inputs(program=script_program("mine"), commands=(Command.START_PROGRAM,), script=WORD))
    assert (bench.last.mode, bench.last.program) == (Mode.RUN, ProgramState.RUNNING)
    return bench


def said(bench: Bench, move: ScriptedMove | None = None, done: int = 0, **more: Any) -> None:
    """A tick in which the script says this, and the law has finished move `done`."""
    bench.step(Inputs(script=Scripted(move=move, **more)), status=MotionStatus(done))


PUSHING = ForceMode(
    free=(False, False, True, False, False, False),
    wrench=(0.0, 0.0, -10.0, 0.0, 0.0, 0.0),
    limits=(0.1,) * 6,
    origin=(0.0, 0.0, 0.0),
    R_BU=UNTURNED,
)


def test_it_pushes_for_as_long_as_it_says_so_and_runs() -> None:
    bench = running()
    assert bench.last.force is None
    said(bench, force=PUSHING)
    assert bench.last.force is PUSHING
    bench.step(Inputs(script=Scripted(force=PUSHING), commands=(Command.PAUSE_PROGRAM,)))
    assert bench.last.force is None
    bench.run(60)
    bench.step(Inputs(script=WORD, commands=(Command.RESUME_PROGRAM,)))
    assert bench.last.force is None
    said(bench, force=PUSHING)
    said(bench)
    assert bench.last.force is None


def test_silence_ends_the_push_with_the_program() -> None:
    bench = running(hold__silence=SILENCE * 0.002)
    said(bench, force=PUSHING)
    for tick in range(SILENCE + 1):
        assert bench.last.force is PUSHING, tick
        bench.step(NOTHING)
    assert (bench.last.force, bench.last.mode) == (None, Mode.TEACH)


@pytest.mark.parametrize(
    ("changes", "told"),
    [
        ({"wrench": (0.0, 0.0, math.nan, 0.0, 0.0, 0.0)}, "nan is not a finite number"),
        ({"limits": (0.1, 0.1, 0.1, 0.1, -1e-9, 0.1)}, "limits: -1e-09 for ry, allowed: 0 or more"),
        ({"wrench": (0.0, 0.0, 90.1, 0.0, 0.0, 0.0)}, "wrench: a force of 90.1, allowed: 90 at most"),
        ({"wrench": (0.0, 0.0, 0.0, 10.1, 0.0, 0.0), "free": (True,) * 6}, "wrench: a torque of 10.1, allowed: 10 at most"),
    ],
)
def test_a_push_that_cannot_be_says_so(changes: dict[str, Any], told: str) -> None:
    with pytest.raises(ValueError, match=re.escape(told)):
        replace(PUSHING, **changes)


def test_a_push_may_be_as_strong_as_it_can_and_what_is_not_free_does_not_count() -> None:
    strong, still = (999.0, 0.0, 90.0, 10.0, 0.0, 0.0), (0.0, 0.0, 90.0, 0.0, 0.0, 10.0)
    assert replace(PUSHING, wrench=strong).wrench == strong
    assert replace(PUSHING, wrench=still, free=(True,) * 6, limits=(0.0,) * 6).limits == (0.0,) * 6


def test_until_it_asks_for_something_the_arm_stands() -> None:
    bench = running()
    said(bench)
    assert isinstance(bench.last.move, RunScript)
    assert (bench.last.law, bench.last.script_done) == (Law.FOLLOW, 0)


def test_each_motion_is_told_as_done_once_the_law_has_finished_it() -> None:
    bench = running()
    said(bench, joints(1))
    first = bench.last.move
    assert isinstance(first, ScriptedJoints)
    assert first.q == (0.1,) * 6
    said(bench, joints(1))
    assert (bench.last.move, bench.last.script_done) == (first, 0)
    said(bench, joints(1), done=first.id)
    assert bench.last.script_done == 1
    said(bench, joints(2, 0.2), done=first.id)
    second = bench.last.move
    assert isinstance(second, ScriptedJoints)
    assert (second.q, second.id > first.id, bench.last.script_done) == ((0.2,) * 6, True, 1)


def test_a_motion_takes_the_place_of_one_that_is_not_done() -> None:
    bench = running()
    said(bench, joints(1))
    said(bench, SpeedJoints(id=2, qd=(0.1,) * 6, acceleration=1.0))
    assert isinstance(bench.last.move, SpeedJoints)
    assert bench.last.script_done == 0


@pytest.mark.parametrize("number", [1, 2])
def test_a_number_that_is_not_new_is_no_new_motion(number: int) -> None:
    bench = running()
    said(bench, joints(2))
    first = bench.last.move
    said(bench, joints(number, 0.3))
    assert bench.last.move == first


def test_a_script_that_falls_silent_is_ended_and_the_arm_braked() -> None:
    bench = running(hold__silence=SILENCE * 0.002)
    said(bench, joints(1))
    bench.events.clear()
    bench.run(SILENCE)
    assert (bench.last.program, bench.events) == (ProgramState.RUNNING, [])
    bench.step(NOTHING, estimate(qd=0.3))
    values = {"name": "mine", "step": 1, "reason": "no word from the script"}
    assert bench.events == [Event(Kind.PROGRAM_FAILED, bench.tick, values)]
    assert (bench.last.mode, bench.last.law, bench.last.move) == (Mode.TEACH, Law.BRAKE, None)


def test_a_word_in_between_begins_the_silence_anew() -> None:
    bench = running(hold__silence=SILENCE * 0.002)
    for _ in range(5):
        bench.run(SILENCE)
        said(bench)
    assert bench.last.program is ProgramState.RUNNING


def test_a_script_that_is_over_ends_its_program() -> None:
    bench = running()
    said(bench, joints(1))
    bench.events.clear()
    bench.step(Inputs(script=Scripted(move=joints(1), over=True)), estimate(qd=0.3))
    assert bench.events == [Event(Kind.PROGRAM_FINISHED, bench.tick, {"name": "mine"})]
    assert (bench.last.mode, bench.last.law) == (Mode.TEACH, Law.BRAKE)


def test_a_stop_leaves_nothing_of_what_the_script_wanted() -> None:
    bench = running()
    said(bench, joints(1), feeling=True)
    bench.step(Inputs(script=Scripted(move=joints(1)), commands=(Command.EMERGENCY_STOP,)))
    assert (bench.last.mode, bench.last.move) == (Mode.STOP, None)
    said(bench, joints(2))
    assert (bench.last.mode, bench.last.move) == (Mode.STOP, None)


def test_what_it_wanted_is_begun_again_after_a_pause() -> None:
    bench = running()
    said(bench, joints(1))
    first = bench.last.move
    assert first is not None
    bench.step(Inputs(script=Scripted(move=joints(1)), commands=(Command.PAUSE_PROGRAM,)))
    assert bench.last.move is None
    bench.run(60)
    bench.step(Inputs(script=Scripted(move=joints(1)), commands=(Command.RESUME_PROGRAM,)))
    said(bench, joints(1))
    again = bench.last.move
    assert isinstance(again, ScriptedJoints)
    assert again.id > first.id


def test_after_a_hand_has_guided_for_a_script_the_script_asks_for_what_comes_next() -> None:
    """Free-drive ends, the arm comes to rest, and the script may ask again."""
    bench = running(free_drive__allowed_from__run=True)
    guided = Guided(id=1, axes=(True, True, False, False, False, False))
    for _ in range(2000):
        said(bench, guided)
        if bench.last.mode is Mode.FREE_DRIVE:
            break
    bench.step(Inputs(script=Scripted(move=guided), commands=(Command.LEAVE_FREE_DRIVE,)))
    assert bench.last.mode is Mode.RUN
    for _ in range(60):
        said(bench, guided)
    assert isinstance(bench.last.move, RunScript)
    assert bench.last.script_done == 1
    said(bench, joints(2))
    assert isinstance(bench.last.move, ScriptedJoints)


def test_an_arm_that_a_script_has_guided_leaves_free_drive_before_it_moves() -> None:
    bench = running(free_drive__allowed_from__run=True)
    said(bench, Guided(id=1, axes=(True, True, False, False, False, False)))
    for _ in range(2000):
        said(bench, Guided(id=1, axes=(True, True, False, False, False, False)))
        if bench.last.mode is Mode.FREE_DRIVE:
            break
    assert bench.last.mode is Mode.FREE_DRIVE
    assert bench.last.locks is not None
    assert bench.last.locks.locked == (False, False, True, True, True, True)
    said(bench, joints(2))
    assert bench.last.mode is Mode.FREE_DRIVE
    said(bench, joints(2), over=True)
    assert bench.last.mode is not Mode.FREE_DRIVE


@pytest.mark.parametrize("value", [math.nan, math.inf])
def test_what_is_not_finite_is_refused(value: float) -> None:
    for make in (
        lambda: ScriptedJoints(q=(value,) * 6, acceleration=1.0, speed=1.0),
        lambda: ServoJoints(q=(value,) * 6, time=0.002),
        lambda: SpeedJoints(qd=(value,) * 6, acceleration=1.0),
        lambda: DirectTorque(torque=(value,) * 6, viscous=(0.0,) * 6, coulomb=(0.0,) * 6),
        lambda: SpeedTool(speed=(value, 0.0, 0.0), turning=(0.0,) * 3, acceleration=1.0, turning_acceleration=1.0),
    ):
        with pytest.raises(ValueError, match="is not a finite number"):
            make()


@pytest.mark.parametrize(
    ("name", "value", "allowed"),
    [
        *[("lookahead", 0.0299, False), ("lookahead", 0.03, True), ("lookahead", 0.2, True), ("lookahead", 0.201, False)],
        *[("gain", 99.9, False), ("gain", 100.0, True), ("gain", 2000.0, True), ("gain", 2000.1, False)],
    ],
)
def test_servo_commands_keep_to_the_ranges_of_the_manual(name: str, value: float, allowed: bool) -> None:
    if allowed:
        assert getattr(ServoJoints(q=(0.0,) * 6, time=0.002, **{name: value}), name) == value
    else:
        with pytest.raises(ValueError, match=rf"{name}: .*, allowed: "):
            ServoJoints(q=(0.0,) * 6, time=0.002, **{name: value})


@pytest.mark.parametrize(
    ("viscous", "coulomb", "told"),
    [(0.0, 1.0, ""), (1.0, 0.0, ""), (1.01, 0.5, "viscous_scale: 1.01"), (0.5, -0.01, "coulomb_scale: -0.01")],
)
def test_torques_keep_to_the_ranges_of_the_manual(viscous: float, coulomb: float, told: str) -> None:
    def made() -> DirectTorque:
        return DirectTorque(torque=(1.0,) * 6, viscous=(0.5,) * 5 + (viscous,), coulomb=(0.5,) * 5 + (coulomb,))

    if told:
        with pytest.raises(ValueError, match=f"{told}, allowed: 0 .. 1"):
            made()
    else:
        assert (made().viscous[5], made().coulomb[5]) == (viscous, coulomb)


def test_a_stop_of_a_script_is_as_hard_as_the_arm_can_unless_it_says_so() -> None:
    assert GentleStop().deceleration == math.inf
