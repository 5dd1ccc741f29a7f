"""Tool and payload: changed as one, refused while the arm moves, led over, and measured by the wizard."""

import math

import msgspec
import numpy as np
import pytest

from pendant.all_settings import Settings, apply
from pendant.decision import Decision
from pendant.equipment.load import NOTHING, Load
from pendant.equipment.tools import BARE, Equipment, Tool
from pendant.event_table import render
from pendant.events.event import Event, Kind
from pendant.inputs import NOTHING as IDLE
from pendant.inputs import Button, Command, Inputs
from pendant.limits.validity import WINDOW
from pendant.program.steps import Program, Wait, script_program
from pendant.supervisor import Supervisor
from pendant.tick.estimate import Estimate
from pendant.tick.modes import Law, Mode, Phase
from pendant.tick.pose import UNTURNED
from pendant.tick.state import state_of
from pendant.tooling.settings import ToolUse
from pendant.tooling.tool_in_use import Fitting, Tooling
from tests.pendant.estimates import estimate
from tests.pendant.telling import whole
from tests.pendant.tooling.test_payload_wizard import WRIST, standing

GRIPPER = Tool(name="gripper", mass=0.9, com=[0.0, 0.0, 0.06], tcp=[0.0, 0.01, 0.16])
ANVIL = Tool(name="anvil", mass=6.0, com=[0.0, 0.0, 0.06], tcp=[0.0, 0.0, 0.1])
PLATE = Load(mass=0.13, com=[0.0, 0.0, 0.0])
START = Load(mass=1.0)
EQUIPMENT = Equipment((BARE, GRIPPER, ANVIL), BARE, START, 5.0, PLATE)
USE = ToolUse(ramp=0.02, measure=0.1)  # 10 ticks, 50 ticks
RAMP = 10
Table = tuple[Tool, ...]
SIX = "six numbers: ixx iyy izz ixy ixz iyz"
HOOK = Tool(name="hook", mass=0.3, com=[0.0, 0.0, 0.02], tcp=[0.0, 0.0, 0.08])


class Bench:
    """The module alone."""

    def __init__(self) -> None:
        self.tooling = Tooling(EQUIPMENT)
        self.mode, self.phase, self.still, self.use = Mode.TEACH, Phase.OFF, True, USE
        self.value = estimate()

    def step(self, *commands: Command, tool: str = "", load: Load | None = None, tools: Table = ()) -> list[Event]:
        inputs = Inputs(commands=commands, tool=tool, load=load, tools=tools)
        events = self.tooling.step(self.value, inputs, self.use, mode=self.mode, phase=self.phase, still=self.still)
        return whole(events, self.value.tick)

    def run(self, count: int) -> list[Event]:
        return [event for _ in range(count) for event in self.step()]

    def measure(self, mass: float) -> list[Event]:
        """Four postures of an arm with this mass beyond plate and tool."""
        tool = self.tooling.fitting.tool
        events: list[Event] = []
        for R in WRIST:
            self.value = standing(R, 0.13 + tool.mass + mass, (0.0, 0.0, 0.05))
            events += self.step(Command.WIZARD_MEASURE) + self.run(50)
        return events


def test_it_starts_with_what_the_robot_was_set_up_with() -> None:
    bench = Bench()
    assert bench.tooling.fitting == Fitting(0, BARE, START, 1.0, 1.0)
    before = bench.tooling.fitting
    assert bench.run(3) == []
    assert bench.tooling.fitting is before
    assert not bench.tooling.changing


def test_a_tool_is_one_change_of_its_point_and_its_load() -> None:
    bench = Bench()
    (event,) = bench.step(tool="gripper")
    assert (event.kind, event.values["name"], event.values["old"]) == (Kind.TOOL_CHANGED, "gripper", "flange")
    assert [event.values[name] for name in ("x", "y", "z", "mass")] == [0.0, 10.0, 160.0, 0.9]
    assert bench.tooling.fitting == Fitting(1, GRIPPER, NOTHING, 0.0, 1.0), "what the last tool held goes with it"


def test_a_payload_is_led_over_evenly_and_to_the_tick() -> None:
    bench = Bench()
    events = bench.step(load=Load(mass=3.0))
    seen = [bench.tooling.fitting]
    for _ in range(RAMP):
        assert not events
        events = bench.step()
        seen.append(bench.tooling.fitting)
    assert [now.share for now in seen] == pytest.approx([k / RAMP for k in range(RAMP + 1)])
    assert [now.mass for now in seen] == pytest.approx([1.0 + 2.0 * k / RAMP for k in range(RAMP + 1)])
    assert {(now.number, now.tool.name) for now in seen} == {(1, "flange")}
    (event,) = events
    assert (event.kind, event.values) == (
        Kind.PAYLOAD_CHANGED,
        {"mass": 3.0, "x": 0.0, "y": 0.0, "z": 50.0, "tool": "flange", "total": 3.0},
    )
    assert seen[-1].mass == 3.0
    small = Event(event.kind, 0, {**event.values, "x": -0.3})
    assert render(small) == ("Payload 3.00 kg", "Centre 0, 0, 50 mm; with tool flange 3.00 kg."), "no minus before a nought"


def test_it_ends_at_the_payload_itself_not_near_it() -> None:
    bench = Bench()
    bench.step(load=Load(mass=0.1))
    bench.run(RAMP)
    assert bench.tooling.fitting.mass == 0.1


def test_a_tool_as_heavy_as_allowed_is_taken_and_its_point_told() -> None:
    bench, heavy = Bench(), Tool(name="heavy", mass=5.0, com=[0.0, 0.0, 0.06], tcp=[0.03, -0.02, 0.1])
    bench.tooling = Tooling(EQUIPMENT._replace(tools=(BARE, heavy)))
    (event,) = bench.step(tool="heavy")
    assert [event.values[name] for name in ("x", "y", "z")] == [30.0, -20.0, 100.0]
    (event,) = bench.step(tool="light")
    assert event.values == {"what": "tool light", "reason": "there is flange, heavy"}


def test_a_changed_tool_may_weigh_all_that_the_payload_leaves() -> None:
    bench = Bench()
    bench.step(tool="gripper")
    bench.step(load=Load(mass=4.1))
    moved = msgspec.structs.replace(GRIPPER, tcp=[0.0, 0.0, 0.2])
    (event,) = bench.step(tools=(BARE, moved, ANVIL))
    assert event.kind is Kind.TOOLS_CHANGED


def test_it_changes_until_the_means_of_the_estimates_hold_the_new_load_alone() -> None:
    bench = Bench()
    bench.step(load=Load(mass=3.0))
    for _ in range(RAMP + WINDOW):
        assert bench.tooling.changing
        bench.step()
    assert not bench.tooling.changing


def test_without_a_ramp_it_changes_at_once() -> None:
    bench = Bench()
    bench.use = ToolUse(ramp=0.0)
    (event,) = bench.step(load=Load(mass=3.0))
    assert (event.kind, bench.tooling.fitting) == (Kind.PAYLOAD_CHANGED, Fitting(1, BARE, Load(mass=3.0), 1.0, 3.0))
    assert bench.tooling.changing


@pytest.mark.parametrize(("time", "share"), [(0.0, 1.0), (0.1, 0.2), (None, 1.0)])
def test_whoever_says_how_long_a_change_takes_is_obeyed(time: float | None, share: float) -> None:
    """The settings' ramp has 10 ticks."""
    bench = Bench()
    bench.tooling.step(
        bench.value, Inputs(load=Load(mass=3.0), load_time=time), bench.use, mode=Mode.TEACH, phase=Phase.OFF, still=True
    )
    bench.run(10)
    assert bench.tooling.fitting.share == pytest.approx(share)


def test_a_change_in_the_middle_of_another_goes_on_from_there() -> None:
    bench = Bench()
    bench.step(load=Load(mass=3.0))
    bench.run(RAMP // 2)
    assert bench.tooling.fitting.mass == pytest.approx(2.0)
    bench.step(load=Load(mass=0.0))
    assert bench.tooling.fitting == Fitting(2, BARE, Load(mass=0.0), 0.0, pytest.approx(2.0))
    bench.run(RAMP // 2)
    assert bench.tooling.fitting.mass == pytest.approx(1.0)


def test_tool_and_payload_in_one_tick_end_with_that_payload_in_that_tool() -> None:
    bench = Bench()
    assert [event.kind for event in bench.step(tool="gripper", load=Load(mass=2.0))] == [Kind.TOOL_CHANGED]
    assert bench.tooling.fitting == Fitting(2, GRIPPER, Load(mass=2.0), 0.0, 1.0), "from what was held before both"
    (event,) = bench.run(RAMP)
    assert (event.values["mass"], event.values["total"], event.values["tool"]) == (2.0, 2.9, "gripper")


@pytest.mark.parametrize(
    ("tool", "load", "words"),
    [
        ("hammer", None, "there is flange, gripper, anvil"),
        ("anvil", None, "6.00 kg, at most 5 kg"),
        ("", Load(mass=5.1), "mass 5.1, allowed 0 .. 5 kg with this tool"),
        ("", Load(mass=1.0, com=[0.0, 2.0, 0.0]), "com[1] 2.0, allowed -1 .. 1 m with this tool"),
    ],
)
def test_what_cannot_be_is_refused_and_nothing_changes(tool: str, load: Load | None, words: str) -> None:
    bench = Bench()
    before = state_of(bench.tooling)
    (event,) = bench.step(tool=tool, load=load)
    assert (event.kind, event.values["reason"]) == (Kind.TOOL_REFUSED, words)
    assert state_of(bench.tooling) == before


def test_what_the_tool_weighs_counts_against_the_payload() -> None:
    bench = Bench()
    bench.step(tool="gripper")
    bench.run(RAMP)
    (event,) = bench.step(load=Load(mass=4.2))
    assert event.values == {"what": "payload 4.20 kg", "reason": "mass 4.2, allowed 0 .. 4.1 kg with this tool"}
    assert bench.step(load=Load(mass=4.1)) == []


@pytest.mark.parametrize(
    ("mode", "phase", "words"),
    [
        (Mode.RUN, Phase.OFF, "stop the program first"),
        (Mode.FREE_DRIVE, Phase.PERIOD, "leave free-drive first"),
        (Mode.TEACH, Phase.ACTIVATION, "free-drive is being tried"),
        (Mode.TEACH, Phase.SEQUENCE, "free-drive is being tried"),
        (Mode.RUN, Phase.SEQUENCE, "stop the program first"),
    ],
)
def test_nothing_changes_while_the_arm_moves_or_is_tried(mode: Mode, phase: Phase, words: str) -> None:
    bench = Bench()
    bench.measure(2.0)
    before = bench.tooling.fitting
    bench.mode, bench.phase = mode, phase
    asked = (bench.step(tool="gripper"), bench.step(load=Load(mass=2.0)), bench.step(tools=(BARE, HOOK)))
    for events in (*asked, bench.step(Command.WIZARD_APPLY)):
        assert [(event.kind, event.values["reason"]) for event in events] == [(Kind.TOOL_REFUSED, words)]
    assert bench.tooling.fitting is before
    assert bench.tooling.tools == EQUIPMENT.tools
    assert bench.tooling.wizard.progress.finding is not None


@pytest.mark.parametrize("mode", [Mode.NORMAL, Mode.TEACH, Mode.REMOTE, Mode.STOP])
def test_in_every_other_mode_it_may_change(mode: Mode) -> None:
    bench = Bench()
    bench.mode = mode
    assert [event.kind for event in bench.step(tool="gripper")] == [Kind.TOOL_CHANGED]


def test_a_table_is_taken_as_a_whole_and_what_it_has_can_be_used() -> None:
    bench = Bench()
    before = bench.tooling.fitting
    (event,) = bench.step(tools=(BARE, HOOK))
    assert (event.kind, event.values) == (Kind.TOOLS_CHANGED, {"change": "1 added, 2 deleted", "count": 2})
    assert bench.tooling.tools == (BARE, HOOK)
    assert bench.tooling.fitting is before
    assert [event.kind for event in bench.step(tool="hook")] == [Kind.TOOL_CHANGED]
    assert bench.tooling.fitting.tool is HOOK
    assert bench.step(tools=(BARE, HOOK)) == [], "as it is"
    (event,) = bench.step(tool="gripper")
    assert event.values["reason"] == "there is flange, hook"


def test_the_tool_in_use_changes_as_one_and_keeps_what_it_holds() -> None:
    bench = Bench()
    bench.step(tool="gripper")
    bench.step(load=Load(mass=2.0))
    bench.run(RAMP + WINDOW)
    bench.measure(2.0)
    longer = msgspec.structs.replace(GRIPPER, mass=1.1, tcp=[0.0, 0.0, 0.3])
    (event,) = bench.step(tools=(BARE, longer, ANVIL))
    assert (event.kind, event.values["change"]) == (Kind.TOOLS_CHANGED, "gripper changed")
    assert bench.tooling.fitting == Fitting(3, longer, Load(mass=2.0), 0.0, 2.0)
    assert bench.tooling.changing
    assert bench.tooling.wizard.progress.postures == 0, "it measured beyond another tool"
    (event,) = bench.run(RAMP)
    assert (event.kind, event.values["total"]) == (Kind.PAYLOAD_CHANGED, 3.1)


@pytest.mark.parametrize(
    ("tools", "words"),
    [
        ((GRIPPER, ANVIL), "flange is in use, and keeps its name"),
        ((BARE, GRIPPER, msgspec.structs.replace(HOOK, mass=5.1)), "hook: mass 5.1, allowed: 0 .. 5 kg"),
        ((BARE, msgspec.structs.replace(HOOK, name="")), "no name: name , allowed: 1 to 40 characters"),
        ((BARE, GRIPPER, GRIPPER), "gripper: name gripper, allowed: each tool needs a name of its own"),
        ((BARE, msgspec.structs.replace(HOOK, inertia=[1.0])), "hook: inertia [1.0], allowed: " + SIX),
        ((msgspec.structs.replace(BARE, mass=4.5),), "flange: mass 4.5, allowed: 0 .. 4 kg with this payload"),
    ],
)
def test_a_table_that_cannot_be_is_refused_whole(tools: Table, words: str) -> None:
    bench = Bench()
    before = state_of(bench.tooling)
    (event,) = bench.step(tools=tools)
    assert (event.kind, event.values) == (Kind.TOOL_REFUSED, {"what": "table of tools", "reason": words})
    assert state_of(bench.tooling) == before


def test_a_tool_that_was_too_heavy_before_stays_in_the_table() -> None:
    bench = Bench()
    assert [event.kind for event in bench.step(tools=(BARE, ANVIL, HOOK))] == [Kind.TOOLS_CHANGED]


def test_the_wizard_finds_what_is_beyond_plate_and_tool_and_applies_it() -> None:
    bench = Bench()
    bench.step(tool="gripper")
    bench.run(RAMP + WINDOW)
    # The readings have the tool's own centre, too: 0.9 kg more at 0.05 m than the table says at 0.06 m.
    events = bench.measure(2.0)
    assert [event.kind for event in events] == [Kind.POSTURE_MEASURED] * 4 + [Kind.PAYLOAD_FOUND]
    assert events[-1].values["mass"] == pytest.approx(2.0)
    assert bench.step(Command.WIZARD_APPLY) == []
    assert bench.tooling.wizard.progress.postures == 0
    (event,) = bench.run(RAMP)
    assert (event.kind, event.values["mass"], event.values["total"]) == (Kind.PAYLOAD_CHANGED, 2.0, 2.9)
    centre = (0.05 * (2.0 + 0.9 + 0.13) - 0.9 * 0.06) / 2.0
    assert event.values["z"] == pytest.approx(1000.0 * centre, abs=0.1)


def test_what_was_not_found_cannot_be_applied() -> None:
    bench = Bench()
    (event,) = bench.step(Command.WIZARD_APPLY)
    assert event.values == {"what": "payload of the wizard", "reason": "there is none yet"}


def test_what_was_found_and_is_too_heavy_is_refused_and_kept() -> None:
    bench = Bench()
    bench.measure(7.0)
    (event,) = bench.step(Command.WIZARD_APPLY)
    assert event.kind is Kind.TOOL_REFUSED
    assert bench.tooling.wizard.progress.postures == 4


def test_clearing_wins_and_another_tool_clears() -> None:
    bench = Bench()
    bench.measure(2.0)
    assert bench.step(Command.WIZARD_CLEAR, Command.WIZARD_MEASURE, Command.WIZARD_APPLY) == []
    assert bench.tooling.wizard.progress.postures == 0
    bench.measure(2.0)
    bench.step(tool="gripper")
    assert bench.tooling.wizard.progress.postures == 0


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"still": False}, "the arm moves"),
        ({"phase": Phase.ACTIVATION}, "free-drive is on"),
        ({"value": estimate(wrench_valid=False)}, "the flange force sensor is not valid"),
        ({"value": estimate(force=math.nan)}, "the flange force sensor is not valid"),
    ],
)
def test_a_posture_is_measured_only_where_the_sensor_tells_the_load(changes: dict[str, object], words: str) -> None:
    for begun in (False, True):
        bench = Bench()
        if begun:
            bench.step(Command.WIZARD_MEASURE)
        for name, value in changes.items():
            setattr(bench, name, value)
        (event,) = bench.step(*() if begun else (Command.WIZARD_MEASURE,))
        assert (event.kind, event.values["reason"]) == (Kind.POSTURE_REFUSED, words)
        assert not bench.tooling.wizard.left


def test_a_program_that_waits_may_be_measured_in() -> None:
    bench = Bench()
    bench.mode = Mode.RUN
    assert bench.step(Command.WIZARD_MEASURE) == []
    assert [event.kind for event in bench.run(50)] == [Kind.POSTURE_MEASURED]


def test_what_is_asked_for_in_one_tick_is_all_answered() -> None:
    bench = Bench()
    events = bench.step(Command.WIZARD_APPLY, tool="hook", tools=(BARE, GRIPPER, HOOK))
    assert [event.kind for event in events] == [Kind.TOOLS_CHANGED, Kind.TOOL_CHANGED, Kind.TOOL_REFUSED]


def test_a_refusal_is_told_while_a_posture_is_measured() -> None:
    bench = Bench()
    bench.step(Command.WIZARD_MEASURE)
    (event,) = bench.step(tool="tongs")
    assert event == Event(Kind.TOOL_REFUSED, 0, {"what": "tool tongs", "reason": "there is flange, gripper, anvil"})
    assert [event.kind for event in bench.run(49)] == [Kind.POSTURE_MEASURED]


class Robot:
    """The whole supervisor."""

    def __init__(self, **settings: float | bool) -> None:
        names = {name.replace("__", "."): value for name, value in {"tools__ramp": 0.2, **settings}.items()}
        self.supervisor = Supervisor(apply(Settings(), names), 6, equipment=EQUIPMENT)
        self.events: list[Event] = []
        self.tick = 0
        self.last: Decision
        self.run(100)

    def step(self, inputs: Inputs = IDLE, value: Estimate | None = None) -> Decision:
        self.tick += 1
        now = value or estimate()
        now.tick = self.tick
        self.last = self.supervisor.step(now, inputs)
        self.events += whole(self.last.events, self.tick)
        return self.last

    def run(self, count: int, inputs: Inputs = IDLE, value: Estimate | None = None) -> None:
        for _ in range(count):
            self.step(inputs, value)

    def kinds(self) -> list[Kind]:
        return [event.kind for event in self.events]


HOLD = Inputs(held=frozenset({Button.FREE_DRIVE}))


def test_the_decision_says_what_the_controller_is_to_believe_in() -> None:
    robot = Robot()
    assert robot.last.estimator.fitting == Fitting(0, BARE, START, 1.0, 1.0)
    robot.step(Inputs(tool="gripper"))
    assert robot.last.estimator.fitting is robot.supervisor.fitting
    assert robot.last.estimator.fitting is not None
    assert robot.last.estimator.fitting.tool is GRIPPER
    assert robot.last.law is Law.HOLD


def test_the_frame_of_the_tool_is_told_to_walls_and_programs() -> None:
    robot = Robot()
    bent = msgspec.structs.replace(GRIPPER, rpy=[0.0, 0.0, math.pi / 2.0])
    robot.supervisor = Supervisor(Settings(), 6, equipment=EQUIPMENT._replace(tools=(BARE, bent)))
    for turn in (robot.supervisor._sequencer.R_FT, robot.supervisor.containment.R_FT):
        assert turn == pytest.approx(UNTURNED)
    robot.step(Inputs(tool="gripper"))
    for turn in (robot.supervisor._sequencer.R_FT, robot.supervisor.containment.R_FT):
        assert turn == pytest.approx((0.0, -1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0))


def test_the_table_is_told_and_the_tool_in_use_takes_effect() -> None:
    robot = Robot()
    turned = msgspec.structs.replace(BARE, rpy=[0.0, 0.0, math.pi / 2.0])
    robot.step(Inputs(tools=(turned, HOOK)))
    assert robot.supervisor.tools == (turned, HOOK)
    assert robot.last.estimator.fitting is not None
    assert robot.last.estimator.fitting.tool is turned
    R_FT = robot.supervisor.containment.R_FT
    assert pytest.approx((0.0, -1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0)) == R_FT


def test_an_idle_tick_after_a_change_gives_the_same_decision_again() -> None:
    robot = Robot()
    robot.step(Inputs(load=Load(mass=2.0)))
    robot.run(400)
    before = robot.last
    assert robot.step() == before


def test_free_drive_is_refused_while_the_payload_is_led_over() -> None:
    robot = Robot(activation__period=0.1)
    robot.step(Inputs(load=Load(mass=3.0)))
    robot.run(51, HOLD)
    (event,) = robot.last.events
    assert (event.kind, event.values) == (Kind.REFUSED_CHANGING, {"mass": pytest.approx(1.0 + 2.0 * 50 / 100)})
    assert robot.last.mode is Mode.TEACH


def test_a_program_waits_for_the_payload() -> None:
    robot = Robot()
    robot.step(Inputs(program=Program(steps=(Wait(duration=1.0),))))
    robot.step(Inputs(load=Load(mass=2.0)))
    robot.step(Inputs(commands=(Command.START_PROGRAM,)))
    assert robot.events[-1].values["reason"] == "the payload is being changed"
    robot.run(100 + WINDOW)
    robot.step(Inputs(commands=(Command.START_PROGRAM,)))
    assert robot.last.mode is Mode.RUN
    robot.step(Inputs(tool="gripper"))
    assert robot.events[-1].kind is Kind.TOOL_REFUSED


def test_a_script_does_not_wait_for_the_payload() -> None:
    """It changes it while it moves, as well."""
    robot = Robot()
    robot.step(Inputs(load=Load(mass=2.0)))
    robot.step(Inputs(program=script_program("script"), commands=(Command.START_PROGRAM,)))
    assert robot.last.mode is Mode.RUN


def test_a_change_of_the_payload_is_nobodys_push() -> None:
    """The user's force jumps by 20 N as the configured payload does; without the change it is told as a push."""
    pushed = estimate(force=[0.0, 0.0, 20.0])
    for changed in (False, True):
        robot = Robot(signals__push__on=True, signals__push__reported=True, signals__push__angle=90.0, tools__ramp=0.0)
        robot.run(200)
        if changed:
            robot.step(Inputs(load=Load(mass=3.0)), pushed)
        robot.run(700, IDLE, pushed)
        assert (Kind.PUSHED in robot.kinds()) is not changed
        assert (Kind.SIGNAL_SEEN in robot.kinds()) is not changed


def test_after_a_change_nobody_says_that_a_refusal_was_a_push() -> None:
    heavy = estimate(force=[0.0, 0.0, -20.0], needed=[0.0, 0.0, 10.0])
    for changed in (False, True):
        robot = Robot(tools__ramp=0.0)
        robot.run(200, IDLE, heavy)
        robot.run(520, HOLD, heavy)
        assert Kind.REFUSED_PAYLOAD in robot.kinds()
        if changed:
            robot.step(Inputs(load=Load(mass=3.0)))
        robot.run(1500)
        assert (Kind.RESIDUAL_GONE in robot.kinds()) is not changed


def test_states_with_other_payloads_are_not_equal() -> None:
    one, other = Robot(), Robot()
    assert one.supervisor.state == other.supervisor.state
    other.step(Inputs(load=Load(mass=2.0)))
    one.step()
    assert one.supervisor.state != other.supervisor.state
    assert np.isfinite(other.supervisor.fitting.mass)
