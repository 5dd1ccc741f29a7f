"""What the pendant shows, over all states that there are: no two texts contradict each other, and none the state."""

from itertools import product

import msgspec
import pytest

from app.web.panel.panel_message import Remembered
from app.web.panel.shown_state import ShownState, shown
from app.web.widgets.svg import Colour
from pendant.all_settings import Settings
from pendant.decision import Decision
from pendant.program.steps import ProgramState
from pendant.tick.modes import Law, Mode, Phase, Safety
from pendant.tooling.payload_wizard import Progress
from tests.app.fakes import decision

MOVING = (Law.FOLLOW, Law.BRAKE)
STANDING_WORDS = ("Ready", "Holding still", "Stopped", "Remote control")


def states() -> list[Decision]:
    """All of them, also those that the robot never has."""
    every = product(Mode, Safety, Phase, Law, ProgramState, (True, False), ("", "turns to posture 2"))
    return [
        msgspec.structs.replace(
            decision(mode),
            safety=safety,
            phase=phase,
            law=law,
            program=program,
            static=static,
            wizard=Progress(doing=doing),
        )
        for mode, safety, phase, law, program, static, doing in every
    ]


def see(state: Decision, *, paused: bool = False, steps: int = 3) -> ShownState:
    return shown(state, Settings(), Remembered(), paused=paused, steps=steps)


def test_no_state_is_shown_with_texts_that_contradict_it() -> None:
    for state in states():
        seen = see(state)
        stopped = state.mode is Mode.STOP or state.safety > Safety.REDUCED
        moving = state.law in MOVING or not state.static or state.wizard.doing != ""
        if not stopped and moving:
            assert seen.word not in STANDING_WORDS, state
            assert seen.text.headline not in ("The arm can be guided by hand", "The arm holds its place"), state
        if stopped:
            assert seen.colour is seen.text.colour is Colour.RED, state
            assert seen.word == ("Stopped" if state.static else "Stopping"), state
            assert "STOP" in seen.name, state
            assert seen.safety not in ("Normal", "Reduced"), state
            assert (seen.runs, seen.frees, seen.jogs) == (False, False, False), state
        else:
            assert "STOP" not in seen.name, state
            assert seen.colour is not Colour.RED, state
        assert seen.resets is (state.mode is Mode.STOP), state


def test_a_button_can_be_pressed_where_it_does_something() -> None:
    for state in states():
        seen, stopped = see(state), state.mode is Mode.STOP or state.safety > Safety.REDUCED
        if seen.runs:
            held = state.mode is Mode.RUN and state.program is ProgramState.PAUSED
            assert held or (state.mode in (Mode.TEACH, Mode.NORMAL) and state.phase is Phase.OFF), state
        if seen.pauses:
            assert (state.mode, state.program) == (Mode.RUN, ProgramState.RUNNING), state
        assert seen.stops is (state.mode is Mode.RUN or state.wizard.doing != ""), state
        if state.mode is Mode.FREE_DRIVE and not stopped:
            assert seen.frees, state
            assert seen.leaves, state


def test_without_a_step_there_is_nothing_to_run() -> None:
    state = decision(Mode.TEACH)
    assert see(state).runs
    assert not see(state, steps=0).runs
    assert not see(decision(Mode.REMOTE)).runs


def test_a_clock_that_stands_is_told_in_every_state_but_a_stop() -> None:
    for state in states():
        seen = see(state, paused=True)
        assert seen.word == "Clock paused"
        if state.mode is not Mode.STOP and state.safety <= Safety.REDUCED:
            assert seen.text.headline == "The simulation is paused"


@pytest.mark.parametrize("state", [decision(Mode.TEACH), decision(Mode.RUN)])
def test_where_nothing_is_simulated_nothing_can_be_pressed(state: Decision) -> None:
    seen = shown(state, Settings(), Remembered(), failure="out of range", steps=3)
    assert (seen.name, seen.colour) == ("FAULT", Colour.RED)
    assert seen[5:] == (False,) * len(seen[5:])
    assert "out of range" in seen.text.text
