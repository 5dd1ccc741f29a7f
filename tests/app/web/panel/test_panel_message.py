"""What the panel says: one function of the state, and nothing outlives its cause."""

import pytest

from app.web.panel.panel_message import CLOCK_PAUSED, HINTS, MEASURING, PASSING, PROGRAM_PAUSED, Remembered, said
from app.web.server import Served
from pendant.all_settings import Settings, apply
from pendant.events.event import Event, Kind
from pendant.program.steps import ProgramState
from pendant.tick.modes import Mode, Safety
from pendant.tooling.payload_wizard import Progress
from tests.app.fakes import decision
from tests.app.web.fake_loop import FakeLoop
from tests.app.web.tabs.test_plots import TOUCH

LIMIT = {"parameter": "flange acceleration", "part": "flange", "value": 9.0, "limit": 8.0, "unit": "m/s²", "time": 0.1}


def headline(loop: FakeLoop, still: Served) -> str:
    still.docks.show(loop.latest())
    return still.panel.said.headline


def stop_by_limit(loop: FakeLoop) -> None:
    loop.mode, loop.safety = Mode.STOP, Safety.NORMAL
    loop.note(Kind.STOPPED_LIMIT, **LIMIT)


def test_in_stop_the_cause_stays_until_reset(loop: FakeLoop, still: Served) -> None:
    stop_by_limit(loop)
    assert headline(loop, still) == "Stopped: flange acceleration"
    loop.note(Kind.ZERO_DUE, force=3.0, torque=0.1)
    loop.note(Kind.REFUSED_MODE, mode="STOP", allowed="TEACH")
    assert headline(loop, still) == "Stopped: flange acceleration"
    loop.mode = Mode.TEACH
    assert "Stopped" not in headline(loop, still)


def test_a_refused_command_is_told_until_the_mode_is_another(loop: FakeLoop, still: Served) -> None:
    loop.note(Kind.COMMAND_REFUSED, command="start_program", mode="TEACH", reason="the arm still moves")
    assert headline(loop, still) == "Starting the program is not possible in TEACH"
    loop.mode = Mode.NORMAL
    assert headline(loop, still) == HINTS[Mode.NORMAL].headline


def test_a_program_that_starts_ends_what_was_told_of_the_last_one(loop: FakeLoop, still: Served) -> None:
    loop.note(Kind.PROGRAM_FAILED, name="taught", step=2, reason="no contact within 200 mm")
    assert headline(loop, still) == 'Program "taught" stopped at step 2'
    loop.mode, loop.program = Mode.RUN, ProgramState.RUNNING
    loop.note(Kind.PROGRAM_STARTED, name="taught")
    assert headline(loop, still) == HINTS[Mode.RUN].headline


def test_a_graver_stop_is_the_cause_and_a_lesser_one_is_not(loop: FakeLoop, still: Served) -> None:
    stop_by_limit(loop)
    headline(loop, still)
    loop.safety = Safety.EMERGENCY_STOP
    loop.note(Kind.EMERGENCY_STOP, mode="STOP")
    assert "mergency" in headline(loop, still)
    loop.note(Kind.STOPPED_LIMIT, **LIMIT)
    assert "mergency" in headline(loop, still)


def test_a_page_that_comes_late_says_stopped_without_a_cause(loop: FakeLoop, still: Served) -> None:
    loop.mode = Mode.STOP
    assert headline(loop, still) == HINTS[Mode.STOP].headline


@pytest.mark.parametrize("mode", list(Mode))
def test_each_mode_has_a_hint_of_its_own(loop: FakeLoop, still: Served, mode: Mode) -> None:
    loop.mode = mode
    if mode is Mode.RUN:
        loop.program = ProgramState.RUNNING
    assert headline(loop, still) == HINTS[mode].headline


def test_what_is_paused_says_so(loop: FakeLoop, still: Served) -> None:
    loop.mode, loop.program = Mode.RUN, ProgramState.PAUSED
    assert headline(loop, still) == PROGRAM_PAUSED.headline
    assert "Program paused" in still.panel.light.shown
    loop.paused = True
    assert headline(loop, still) == CLOCK_PAUSED.headline
    assert "Clock paused" in still.panel.light.shown


def test_an_arm_that_measures_its_payload_says_so_until_it_stops(loop: FakeLoop, still: Served) -> None:
    loop.note(Kind.ZERO_DUE, force=3.0, torque=0.1)
    loop.wizard = Progress(2, doing="turns the wrist")
    assert headline(loop, still) == MEASURING.headline
    stop_by_limit(loop)
    assert headline(loop, still) == "Stopped: flange acceleration"
    loop.mode, loop.wizard = Mode.TEACH, Progress(2)
    assert headline(loop, still) != MEASURING.headline


def test_start_over_takes_every_message_away(loop: FakeLoop, still: Served) -> None:
    loop.tick = 5000
    loop.note(Kind.REFUSED_MODE, mode="RUN", allowed="TEACH")
    assert "refused" in headline(loop, still)
    loop.tick = 3
    assert headline(loop, still) == HINTS[Mode.TEACH].headline


def test_what_ended_free_drive_is_over_when_the_next_one_begins(loop: FakeLoop, still: Served) -> None:
    loop.note(Kind.LEFT_PERIOD, limit=3.0)
    assert "nobody moved" in headline(loop, still)
    loop.mode = Mode.FREE_DRIVE
    assert headline(loop, still) == HINTS[Mode.FREE_DRIVE].headline
    loop.mode = Mode.TEACH
    assert headline(loop, still) == HINTS[Mode.TEACH].headline


def test_what_changes_no_mode_is_told_for_a_while(loop: FakeLoop, still: Served) -> None:
    loop.note(Kind.ZERO_DUE, force=3.0, torque=0.1)
    assert headline(loop, still) == "Zero the force sensor"
    loop.tick += PASSING + 1
    assert headline(loop, still) == HINTS[Mode.TEACH].headline


FORCE = {"force": 17.4, "mass": -1.77, "zero": False}


def test_a_force_that_stays_is_told_until_payload_or_zero_is_another(loop: FakeLoop, still: Served) -> None:
    for mend in (Kind.PAYLOAD_CHANGED, Kind.SENSOR_ZEROED):
        loop.note(Kind.RESIDUAL_STAYED, **FORCE)
        loop.tick += 2 * PASSING
        assert headline(loop, still).startswith("Free-drive refused: payload looks wrong (")
        assert "differ by -1.8 kg from the configured one" in still.panel.said.text
        loop.note(mend, tool="none", mass=0.0, total=0.0, x=0.0, y=0.0, z=0.0, force=0.0, torque=0.0, old=0.0, new=0.0)
        assert "payload looks wrong" not in headline(loop, still)


def test_a_contact_hides_no_reason_why_free_drive_did_not_begin(loop: FakeLoop, still: Served) -> None:
    loop.note(Kind.ACTIVATION_CANCELLED, value=0.9, limit=1.0)
    loop.note(Kind.CONTACT_LOST, **TOUCH)
    assert headline(loop, still) == "Free-drive not started: let go too early"
    loop.tick += PASSING + 1
    headline(loop, still)
    loop.note(Kind.CONTACT_LOST, **TOUCH)
    assert "Contact lost" in headline(loop, still)


def test_a_busy_machine_hides_nothing(loop: FakeLoop, still: Served) -> None:
    loop.note(Kind.LEFT_PERIOD, limit=3.0)
    loop.note(Kind.OVERRUN, late=80.0, lost=0.08, often="once")
    assert "nobody moved" in headline(loop, still)


def test_how_to_guide_the_arm_names_the_time_that_is_set(loop: FakeLoop, still: Served) -> None:
    assert headline(loop, still) == HINTS[Mode.TEACH].headline
    assert still.panel.said.text == "Hold the button for 1 s, let go, then drag the arm."
    loop.settings = apply(Settings(), {"activation.period": 0.6, "button.hold_to_run": True})
    loop.safety = Safety.REDUCED
    headline(loop, still)
    wanted = "Reduced mode: lower speeds. Hold the button for 0.6 s, and keep it held while you drag the arm."
    assert still.panel.said.text == wanted


def test_a_cause_is_kept_where_the_page_takes_in_the_state_before_it_first() -> None:
    remembered = Remembered()
    remembered.take(Event(Kind.STOPPED_LIMIT, 10, LIMIT))
    remembered.see(decision(Mode.TEACH), 9)
    remembered.see(decision(Mode.STOP), 10)
    assert said(remembered, decision(Mode.STOP), Settings()).headline == "Stopped: flange acceleration"
    remembered.see(decision(Mode.TEACH), 11)
    assert said(remembered, decision(Mode.TEACH), Settings()).headline == HINTS[Mode.TEACH].headline
    remembered.see(decision(Mode.STOP), 12)
    assert said(remembered, decision(Mode.STOP), Settings()).headline == HINTS[Mode.STOP].headline
