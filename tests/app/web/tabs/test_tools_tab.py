"""Tools, payload and wizard on the page."""

from collections.abc import Callable

import pytest

from app.files.library import load_tool
from app.web.server import Served
from pendant.equipment.payload_fit import FittedPayload
from pendant.inputs import Command
from pendant.program.steps import ProgramState
from pendant.tick.modes import Mode, Phase
from pendant.tooling.payload_wizard import Progress
from pendant.tooling.tool_in_use import Fitting
from sim.arm.scenario import Load, Scenario
from tests.app.web.fake_loop import FakeLoop
from tests.app.web.raw_client import RawClient, until

Join = Callable[[], RawClient]
GRIPPER, SPHERE = load_tool("gripper"), load_tool("sphere")
FOUND = FittedPayload(1.987, 0.012, (0.02, 0.0, 0.061), 0.0004, 0.05, 0.002, (1.0, -2.0, 3.0), (0.1, 0.2, 0.3), 4)


def equip(loop: FakeLoop) -> None:
    loop.scenario = Scenario(tool=GRIPPER, tools=[SPHERE])
    loop.fitting = Fitting(1, GRIPPER, Load(mass=1.5, com=[0.0, 0.01, 0.05]), 1.0, 1.5)


def test_the_table_is_offered_and_what_is_in_use_is_shown(served: Served, join: Join, loop: FakeLoop) -> None:
    client, tab = join(), served.docks.tools
    equip(loop)
    until(lambda: tab.tool.options == ("gripper", "sphere"), "the table")
    said = ("gripper, 0.925 kg", "0, 0, 163 mm", "1.50 kg", "2.42 kg")
    until(lambda: all(text in tab.now.shown for text in said), "in use")
    until(lambda: tab.about.shown == "", "nothing to add")
    assert (tab.tool.value, tab.mass.value, [way.value for way in tab.centre]) == ("gripper", 1.5, [0.0, 10.0, 50.0])
    client.set(tab.tool._impl.uuid, value="sphere")
    until(lambda: "0, 0, 100 mm" in tab.about.shown, "what the table says of it")
    assert "gripper" in tab.now.shown, "chosen is not in use"
    client.set(tab.use._impl.uuid, value=True)
    until(lambda: loop.advance() is None and loop.wishes[-1].inputs.tool == "sphere", "the wish")


def test_a_payload_is_entered_with_its_centre(served: Served, join: Join, loop: FakeLoop) -> None:
    client, tab = join(), served.docks.tools
    client.set(tab.mass._impl.uuid, value=2.5)
    client.set(tab.centre[2]._impl.uuid, value=80.0)
    client.set(tab.enter._impl.uuid, value=True)
    wanted = Load(mass=2.5, com=[0.0, 0.0, 0.08])
    until(lambda: loop.advance() is None and loop.wishes[-1].inputs.load == wanted, "the wish")


@pytest.mark.parametrize(
    ("mode", "phase"), [(Mode.FREE_DRIVE, Phase.PERIOD), (Mode.RUN, Phase.OFF), (Mode.TEACH, Phase.SEQUENCE)]
)
def test_it_is_locked_as_the_limits_are(served: Served, join: Join, loop: FakeLoop, mode: Mode, phase: Phase) -> None:
    client, tab = join(), served.docks.tools
    equip(loop)
    loop.wizard = Progress(4, 0.0, FOUND)
    until(lambda: not tab.apply.disabled, "ready")
    loop.mode, loop.phase = mode, phase
    until(lambda: tab.use.disabled and tab.enter.disabled and tab.apply.disabled, "locked")
    until(lambda: "locked" in tab.now.shown, "said")
    assert tab.measure.disabled is (phase is not Phase.OFF)
    client.set(tab.use._impl.uuid, value=True)
    until(lambda: served.guard.refused["disabled control"] == 1, "refused")


def test_a_watcher_changes_nothing(served: Served, join: Join, loop: FakeLoop) -> None:
    operator, watcher = join(), join()
    operator.set(served.docks.tools.mass._impl.uuid, value=1.0)
    until(lambda: served.guard.operator.holder is not None, "somebody has control")
    watcher.set(served.docks.tools.use._impl.uuid, value=True)
    until(lambda: served.guard.refused["not the operator"] == 1, "refused")
    loop.advance()
    assert all(wish.inputs.tool == "" for wish in loop.wishes)


def test_the_wizard_says_what_to_do_and_what_it_found(served: Served, join: Join, loop: FakeLoop) -> None:
    client, tab = join(), served.docks.tools
    until(lambda: "turns its wrist by itself" in tab.progress.shown, "nothing yet")
    assert tab.apply.disabled
    assert tab.clear.disabled
    client.set(tab.measure._impl.uuid, value=True)
    until(lambda: loop.advance() is None and Command.WIZARD_MEASURE in loop.wishes[-1].inputs.commands, "measured")
    loop.wizard = Progress(1, 0.4)
    until(lambda: "Measuring, 40 %" in tab.progress.shown and tab.measure.disabled and tab.clear.disabled, "measuring")
    loop.wizard = Progress(2)
    until(lambda: "2 of at least 4 postures" in tab.progress.shown and not tab.measure.disabled, "go on")
    loop.wizard = Progress(4, 0.0, None, "the postures differ too little")
    until(lambda: "the postures differ too little." in tab.progress.shown, "why not")
    loop.wizard = Progress(4, 0.0, FOUND)
    until(lambda: "1.99 ± 0.01 kg" in tab.progress.shown and "20, 0, 61 mm, each ± 0.4 mm" in tab.progress.shown, "found")
    client.set(tab.apply._impl.uuid, value=True)
    until(lambda: loop.advance() is None and Command.WIZARD_APPLY in loop.wishes[-1].inputs.commands, "applied")
    client.set(tab.clear._impl.uuid, value=True)
    until(lambda: loop.advance() is None and Command.WIZARD_CLEAR in loop.wishes[-1].inputs.commands, "cleared")


def test_the_arm_measures_by_itself_on_one_button(served: Served, join: Join, loop: FakeLoop) -> None:
    client, tab = join(), served.docks.tools
    equip(loop)
    until(lambda: not tab.run.disabled and not tab.stop.visible, "ready")
    client.set(tab.run._impl.uuid, value=True)
    until(lambda: loop.advance() is None and Command.WIZARD_RUN in loop.wishes[-1].inputs.commands, "asked")
    loop.wizard = Progress(2, 0.0, doing="turns the wrist")
    until(lambda: tab.stop.visible and tab.run.disabled and tab.use.disabled and tab.enter.disabled, "it turns")
    until(lambda: "It turns the wrist. Hands off the arm." in tab.progress.shown, "said")
    assert "2 of 6 postures measured" in tab.progress.shown
    client.set(tab.stop._impl.uuid, value=True)
    until(lambda: loop.advance() is None and Command.WIZARD_CLEAR in loop.wishes[-1].inputs.commands, "stopped")
    loop.wizard = Progress(6, 0.0, FOUND, doing="turns the wrist back")
    until(lambda: "back" in tab.progress.shown and tab.apply.disabled, "not to be taken yet")
    loop.wizard = Progress(6, 0.0, FOUND)
    until(lambda: not tab.apply.disabled and not tab.stop.visible and not tab.run.disabled, "done")


def test_a_change_shows_how_far_it_is(served: Served, join: Join, loop: FakeLoop) -> None:
    join()
    equip(loop)
    loop.fitting = Fitting(2, GRIPPER, Load(mass=3.0), 0.25, 0.75)
    until(lambda: "changing, 25 %" in served.docks.tools.now.shown and "0.75 kg" in served.docks.tools.now.shown, "on its way")


def test_the_force_sensor_is_zeroed_with_a_button(served: Served, join: Join, loop: FakeLoop) -> None:
    client, tab = join(), served.docks.tools
    until(lambda: "0.0 N and 0.00 N·m are subtracted. No need to zero now." in tab.zeroed.shown, "not yet")
    client.set(tab.zero._impl.uuid, value=True)
    until(lambda: loop.advance() is None and loop.wishes[-1].inputs.commands == (Command.ZERO_SENSOR,), "the wish")
    loop.zero = (0.0, -3.0, 4.0, 0.03, 0.0, 0.04)
    until(lambda: "5.0 N and 0.05 N·m are subtracted. No need to zero now." in tab.zeroed.shown, "subtracted")
    loop.zero_due = True
    until(lambda: "Zero the force sensor now" in tab.zeroed.shown and "Nothing may touch the arm." in tab.zeroed.shown, "due")


@pytest.mark.parametrize(
    ("phase", "wizard", "program"),
    [
        (Phase.PERIOD, Progress(), ProgramState.NONE),
        (Phase.SEQUENCE, Progress(), ProgramState.STOPPED),
        (Phase.OFF, Progress(1, 0.5), ProgramState.PAUSED),
        (Phase.OFF, Progress(), ProgramState.RUNNING),
    ],
)
def test_it_cannot_be_zeroed_while_the_arm_is_free_or_moved_or_measured_on(
    served: Served, join: Join, loop: FakeLoop, phase: Phase, wizard: Progress, program: ProgramState
) -> None:
    join()
    tab = served.docks.tools
    loop.program = ProgramState.PAUSED
    until(lambda: not tab.zero.disabled, "ready")
    loop.phase, loop.wizard, loop.program = phase, wizard, program
    until(lambda: tab.zero.disabled, "locked")
