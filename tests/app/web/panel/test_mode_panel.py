"""What the pendant shows of a snapshot and its events, and what its controls do."""

import math
from collections.abc import Callable

import pytest

from app.web.server import Served
from app.web.widgets.svg import Colour
from pendant.all_settings import Settings, apply, safety_checksum
from pendant.events.event import Kind
from pendant.freedrive.periods import Remaining
from pendant.inputs import Button, Command
from pendant.program.steps import ProgramState
from pendant.tick.limit_engine import Monitored
from pendant.tick.modes import Law, Mode, Phase, Safety
from pendant.walls.containment import WallState
from tests.app.web.fake_loop import FakeLoop
from tests.app.web.raw_client import RawClient, until

Join = Callable[[], RawClient]


@pytest.mark.parametrize(
    ("mode", "safety", "phase", "periods", "words", "colour"),
    [
        (Mode.TEACH, Safety.NORMAL, Phase.OFF, (), ("TEACH", "Ready", "Normal"), Colour.GREEN),
        (Mode.NORMAL, Safety.REDUCED, Phase.OFF, (), ("NORMAL", "Holding still", "Reduced"), Colour.GREEN),
        (Mode.TEACH, Safety.NORMAL, Phase.ACTIVATION, (Remaining("activation", 200, 500),), ("Keep holding", "0.4"), Colour.BLUE),
        (Mode.TEACH, Safety.NORMAL, Phase.FEEDBACK, (Remaining("feedback", 100, 250),), ("Let go and wait", "0.2"), Colour.BLUE),
        (Mode.TEACH, Safety.NORMAL, Phase.CONFIRM, (Remaining("confirmation", 500, 1500),), ("Confirm now", "1.0"), Colour.AMBER),
        (
            Mode.TEACH,
            Safety.NORMAL,
            Phase.LET_GO,
            (Remaining("let go", 500, 1000),),
            ("Let go of the arm", "Let go within"),
            Colour.AMBER,
        ),
        (Mode.TEACH, Safety.NORMAL, Phase.SEQUENCE, (Remaining("sequence", 500, 500),), ("Hands off", "Checking"), Colour.BLUE),
        (Mode.FREE_DRIVE, Safety.NORMAL, Phase.HELD, (), ("FREE-DRIVE",), Colour.BLUE),
        (
            Mode.FREE_DRIVE,
            Safety.NORMAL,
            Phase.PERIOD,
            (Remaining("free-drive", 500, 1500),),
            ("1.0", "Move it within"),
            Colour.BLUE,
        ),
        (Mode.FREE_DRIVE, Safety.NORMAL, Phase.PERIOD, (Remaining("free-drive", 499, 1500),), ("About to end",), Colour.AMBER),
        (Mode.FREE_DRIVE, Safety.NORMAL, Phase.RESTART, (Remaining("restart", 10, 1500),), ("About to end",), Colour.AMBER),
        (
            Mode.TEACH,
            Safety.NORMAL,
            Phase.OFF,
            (Remaining("cool-down", 10, 1000),),
            ("Ready", "Free-drive again in"),
            Colour.GREEN,
        ),
        (Mode.STOP, Safety.EMERGENCY_STOP, Phase.OFF, (), ("EMERGENCY STOP", "Stopped", "Emergency stop"), Colour.RED),
        (Mode.STOP, Safety.PROTECTIVE_STOP, Phase.OFF, (Remaining("cool-down", 10, 1000),), ("PROTECTIVE STOP",), Colour.RED),
        (Mode.STOP, Safety.NORMAL, Phase.OFF, (), ("<b>STOP</b>",), Colour.RED),
    ],
)
def test_the_light_and_the_rings_say_what_holds(
    loop: FakeLoop,
    still: Served,
    mode: Mode,
    safety: Safety,
    phase: Phase,
    periods: tuple[Remaining, ...],
    words: tuple[str, ...],
    colour: Colour,
) -> None:
    loop.mode, loop.safety, loop.phase, loop.periods = mode, safety, phase, periods
    still.docks.show(loop.latest())
    shown = still.panel.light.shown + still.panel.rings.shown
    for word in words:
        assert word in shown
    assert f"--c:{colour.value}" in still.panel.light.shown
    assert mode is not Mode.STOP or "Ready" not in shown


def test_an_arm_that_is_jogged_is_not_told_as_ready(loop: FakeLoop, still: Served) -> None:
    for loop.law, word in ((Law.FOLLOW, "The arm moves"), (Law.HOLD, "Ready")):
        still.docks.show(loop.latest())
        assert f"<span>{word}</span>" in still.panel.light.shown


def test_every_mode_and_safety_mode_has_words(loop: FakeLoop, still: Served) -> None:
    for loop.mode in Mode:
        for loop.safety in Safety:
            still.docks.show(loop.latest())
            stopped = loop.safety > Safety.REDUCED
            assert ("STOP" if stopped else loop.mode.replace("_", "-")) in still.panel.light.shown


def test_what_does_not_change_is_not_sent(loop: FakeLoop, still: Served) -> None:
    still.docks.show(loop.latest())
    assert not still.docks.show(loop.latest())
    loop.note(Kind.RESET)
    assert still.docks.show(loop.latest())
    assert not still.docks.show(loop.latest())


def test_a_refusal_shows_its_reason_and_guidance_until_something_else_does(loop: FakeLoop, still: Served) -> None:
    loop.note(Kind.REFUSED_MODE, mode="RUN", allowed="TEACH")
    loop.note(Kind.RESET)
    still.docks.show(loop.latest())
    assert "Free-drive refused: mode is RUN" in still.panel.note.shown
    assert "Allowed in: TEACH." in still.panel.note.shown
    loop.note(Kind.LEFT_PERIOD, limit=3.0)
    still.docks.show(loop.latest())
    assert "nobody moved the arm" in still.panel.note.shown


def test_a_refusal_names_every_parameter_that_prevented_entry(loop: FakeLoop, still: Served) -> None:
    loop.note(Kind.SEQUENCE_STARTED, period=1.0)
    for parameter, value, limit, unit in (("flange speed", 0.031, 0.02, "m/s"), ("joint torque", 7.25, 5.0, "N·m")):
        loop.note(Kind.ENTRY_PREVENTED, parameter=parameter, part="wrist_1", value=value, limit=limit, unit=unit, time=0.1)
    loop.note(Kind.REFUSED_PAYLOAD, mass=1.9, force=18.0, way="down", zero=False, parameter="flange speed")
    loop.note(Kind.OVERRUN, late=80.0, lost=0.08, often="once")
    still.docks.show(loop.latest())
    shown = still.panel.note.shown
    assert "Consistent with +1.9 kg, or a steady 18 N push down" in shown
    assert "<li>wrist_1 flange speed: 0.031 m/s, limit 0.02</li>" in shown
    assert "<li>wrist_1 joint torque: 7.2 N·m, limit 5</li>" in shown
    loop.note(Kind.ACTIVATION_STARTED, period=1.0)
    loop.note(Kind.REFUSED_MODE, mode="RUN", allowed="TEACH")
    still.docks.show(loop.latest())
    assert "<li>" not in still.panel.note.shown


def test_what_is_asked_for_is_told_while_it_is_asked_for(loop: FakeLoop, still: Served) -> None:
    loop.note(Kind.CONFIRM_ASKED, source="button", feedback=0.5, window=3.0)
    loop.phase = Phase.CONFIRM
    still.docks.show(loop.latest())
    assert "Free-drive: confirm" in still.panel.note.shown
    assert "push it or press the button within 3 s" in still.panel.note.shown
    loop.phase = Phase.OFF
    still.docks.show(loop.latest())
    assert "The arm can be guided by hand" in still.panel.note.shown
    loop.note(Kind.ACTIVATION_CANCELLED, value=0.4, limit=1.0)
    still.docks.show(loop.latest())
    assert "Held for 0.40 s. Hold the button for 1.00 s." in still.panel.note.shown


def test_a_stop_that_was_reset_has_nothing_more_to_say(loop: FakeLoop, still: Served) -> None:
    loop.mode = Mode.STOP
    loop.note(Kind.EMERGENCY_STOP, mode="TEACH")
    still.docks.show(loop.latest())
    assert "Make sure that nobody is in danger" in still.panel.note.shown
    loop.mode = Mode.TEACH
    still.docks.show(loop.latest())
    assert "danger" not in still.panel.note.shown


def test_how_free_drive_ended_is_told_until_a_program_runs(loop: FakeLoop, still: Served) -> None:
    loop.note(Kind.DEACTIVATED)
    still.docks.show(loop.latest())
    assert "Free-drive switched off" in still.panel.note.shown
    loop.mode, loop.program = Mode.RUN, ProgramState.PAUSED  # free-drive began in a program, which waits
    still.docks.show(loop.latest())
    assert "Free-drive switched off" in still.panel.note.shown
    loop.program = ProgramState.RUNNING
    still.docks.show(loop.latest())
    assert "The program runs" in still.panel.note.shown


def test_monitored_values_are_shown_against_their_limits_nearest_first(loop: FakeLoop, still: Served) -> None:
    loop.phase = Phase.SEQUENCE
    shares = (0.2, 1.5, 0.9, 0.05, 0.4, 0.3, 0.0)
    loop.monitored = tuple(Monitored(f"value {i}", "flange", 2.0 * share, -math.inf, 2.0, "N") for i, share in enumerate(shares))
    still.docks.show(loop.latest())
    shown = still.panel.numbers.shown
    names = [name for name in (f"value {i}" for i in (1, 2, 4, 5, 0)) if name in shown]
    assert names == sorted(names, key=shown.index)
    assert len(names) == 5
    assert "! 3 / 2 N" in shown
    assert "1.8 / 2 N" in shown
    assert "and 2 more" in shown
    assert not still.panel.leave.disabled


def test_the_wall_that_the_arm_is_nearest_to_is_told(loop: FakeLoop, still: Served) -> None:
    def wall(name: str, distance: float, near: float = 0.0) -> WallState:
        return WallState(name, "elbow", (0.0, 0.0, 0.0), distance, (1.0, 0.0, 0.0), near, distance > 0.0, (0.0, 0.0, 0.0))

    loop.states = (wall("<b>", -0.123), wall("far", -0.5), wall("tether", -0.03))
    still.panel.show(loop.latest(), [])
    assert "<dt>&lt;b&gt;, elbow</dt><dd>123 mm left</dd>" in still.panel.numbers.shown
    assert "tether" not in still.panel.numbers.shown
    loop.states = (wall("tether", -0.003, 0.5), wall("far", 0.012, 1.0))
    still.panel.show(loop.latest(), [])
    assert "<dt>far, elbow</dt><dd>12 mm beyond</dd>" in still.panel.numbers.shown
    loop.states = loop.states[:1]
    still.panel.show(loop.latest(), [])
    assert "<dt>tether, elbow</dt><dd>3 mm left</dd>" in still.panel.numbers.shown


def test_the_safety_checksum_is_shown(loop: FakeLoop, still: Served) -> None:
    still.docks.show(loop.latest())
    assert safety_checksum(Settings()) in still.panel.numbers.shown
    loop.settings = apply(Settings(), {"free_drive.gain": 2.0})
    still.docks.show(loop.latest())
    assert safety_checksum(loop.settings) in still.panel.numbers.shown


def test_the_log_is_newest_first_and_escaped(loop: FakeLoop, still: Served) -> None:
    loop.note(Kind.PROGRAM_STARTED, name="<b>evil</b>")
    loop.tick = 1000
    loop.note(Kind.RESET)
    still.docks.show(loop.latest())
    shown = still.docks.journal.table.shown
    assert shown.index("Reset to TEACH") < shown.index("&lt;b&gt;evil&lt;/b&gt;")
    assert "<b>evil" not in shown
    assert "2.00 s" in shown


def test_leave_and_reset_are_there_when_they_can_do_something(loop: FakeLoop, still: Served) -> None:
    for mode, leave, reset in ((Mode.TEACH, False, False), (Mode.FREE_DRIVE, True, False), (Mode.STOP, False, True)):
        loop.mode = mode
        still.docks.show(loop.latest())
        assert (not still.panel.leave.disabled, not still.panel.reset.disabled) == (leave, reset)
        assert not still.panel.stop.disabled


def test_a_simulation_that_broke_down_is_a_fault_until_it_starts_over(loop: FakeLoop, still: Served) -> None:
    loop.failure = "FloatingPointError: no more"
    still.docks.show(loop.latest())
    assert "FAULT" in still.panel.light.shown
    assert "no more. Press Start over, on the tab Lab." in still.panel.note.shown
    assert still.panel.free_drive.disabled
    assert still.panel.leave.disabled
    assert still.panel.reset.disabled
    loop.failure = ""
    still.docks.show(loop.latest())
    assert "TEACH" in still.panel.light.shown
    assert "no more" not in still.panel.note.shown
    assert not still.panel.free_drive.disabled


def test_the_button_holds_and_its_click_lets_go(served: Served, join: Join, loop: FakeLoop) -> None:
    client = join()
    uuid = served.panel.free_drive._impl.uuid
    client.hold(uuid)
    until(lambda: loop.advance() is None and Button.FREE_DRIVE in loop.wishes[-1].inputs.held, "held")
    client.set(uuid, value=True)
    until(lambda: loop.advance() is None and Button.FREE_DRIVE in loop.wishes[-1].inputs.released, "released")


@pytest.mark.parametrize(
    ("name", "value", "mode", "command"),
    [
        ("stop", True, Mode.TEACH, Command.EMERGENCY_STOP),
        ("reset", True, Mode.STOP, Command.RESET),
        ("leave", True, Mode.FREE_DRIVE, Command.LEAVE_FREE_DRIVE),
        ("mode", "NORMAL", Mode.TEACH, Command.NORMAL),
        ("mode", "TEACH", Mode.NORMAL, Command.TEACH),
    ],
)
def test_a_press_is_a_command(
    served: Served, join: Join, loop: FakeLoop, name: str, value: object, mode: Mode, command: Command
) -> None:
    client = join()
    loop.mode = mode
    control = getattr(served.panel, name)
    until(lambda: not control.disabled, "the control is enabled")
    client.set(control._impl.uuid, value=value)
    until(lambda: loop.advance() is None and loop.wishes[-1].inputs.commands == (command,), "the command")


def test_the_clock_is_paused_stepped_slowed_and_set_back(served: Served, join: Join, loop: FakeLoop) -> None:
    client = join()
    client.set(served.lab.clock._impl.uuid, value="Step")
    until(lambda: loop.paused and loop.steps == 1, "a step")
    client.set(served.lab.clock._impl.uuid, value="Go on")
    until(lambda: not loop.paused, "running")
    client.set(served.lab.clock._impl.uuid, value="Freeze")
    until(lambda: loop.paused, "paused")
    client.set(served.lab.speed._impl.uuid, value=0.3)
    until(lambda: loop.speed == 0.3, "slower")
    client.set(served.lab.restart._impl.uuid, value=True)
    until(lambda: len(loop.begun) == 1, "begun anew, with what was made of it")
