"""The arm measures its payload by itself: turns, settles, measures, goes back; and what ends it."""

import math

import numpy as np
import pytest
from msgspec.structs import replace

from pendant.all_settings import Settings, apply
from pendant.decision import Decision
from pendant.equipment.load import Load
from pendant.equipment.tools import Equipment
from pendant.equipping import SETTLING, SLOW, TRIES
from pendant.events.event import Event, Kind
from pendant.inputs import NOTHING, Button, Command, Inputs
from pendant.program.jog_move import JogMove
from pendant.program.steps import JointMove, Program, Wait
from pendant.safety.robot_limits import SpeedLimits
from pendant.supervisor import Supervisor
from pendant.tick.modes import Law, Mode
from pendant.tick.motion_status import MotionStatus
from pendant.tick.pose import Pose
from pendant.tooling.arm_shape import ArmShape
from pendant.tooling.turn_watch import JOLTED, SLOW_ELBOW, SLOW_JOINT, SLOW_TOOL, STRUCK
from pendant.tooling.wrist_postures import SWING, WANTED
from pendant.walls.definitions import Area
from pendant.walls.shapes import HalfSpace, Sphere
from tests.pendant.telling import whole
from tests.pendant.tooling.wrists import HOME, NAMES, placed, wrist_arm

MASS, CENTRE = 2.0, (0.02, 0.0, 0.07)
RUN, CLEAR = Inputs(commands=(Command.WIZARD_RUN,)), Inputs(commands=(Command.WIZARD_CLEAR,))
TRAVEL = 40
"""Ticks that a turn takes."""


class Cell:
    """A supervisor and an arm that goes straight to where it is told, in `TRAVEL` ticks."""

    def __init__(self, shape: ArmShape | None = None, walls: tuple[Area, ...] = (), **settings: float | bool) -> None:
        names = {"tools.measure": 0.1, "tools.ramp": 0.1} | {k.replace("__", "."): v for k, v in settings.items()}
        self.shape = wrist_arm() if shape is None else shape
        self.supervisor = Supervisor(
            apply(Settings(), names), len(self.shape.names), joints=NAMES, borders=walls, shape=self.shape, equipment=Equipment()
        )
        self.q = np.array(HOME)
        self.goal: tuple[int, np.ndarray, int] | None = None
        self.done = 0
        self.push = np.zeros(3)
        self.changes: dict[str, object] = {}
        self.tick = 0
        self.events: list[Event] = []
        self.moves: list[JointMove] = []
        self.last: Decision
        self.run(200)

    def step(self, inputs: Inputs = NOTHING) -> Decision:
        self.tick += 1
        value = placed(self.shape, self.q, mass=MASS, centre=CENTRE, offset=(1.0, -2.0, 1.5))
        value.tick = self.tick
        value.F_user[:3] += self.push
        value.w_sensor[:3] -= value.R_BF.T @ self.push
        value.qd[:] = 0.1 if self.goal is not None else 0.0
        status = MotionStatus(self.done)
        for name, change in self.changes.items():
            if name == "refused":
                status = status._replace(refused=str(change))
            else:
                setattr(value, name, change)
        self.last = self.supervisor.step(value, inputs, status)
        self.events += whole(self.last.events, self.tick)
        move = self.last.move
        if self.last.law is Law.FOLLOW and isinstance(move, JointMove) and move.id != self.done:
            if self.goal is None or self.goal[0] != move.id:
                self.goal = (move.id, self.q, 0)
                self.moves.append(move)
            ident, begin, age = self.goal
            self.q = begin + (age + 1) / TRAVEL * (np.array(move.q) - begin)
            self.goal = (ident, begin, age + 1)
            if age + 1 == TRAVEL:
                self.done, self.goal = move.id, None
        elif self.last.law is not Law.FOLLOW:
            self.goal = None
        return self.last

    def run(self, count: int, inputs: Inputs = NOTHING) -> None:
        for _ in range(count):
            self.step(inputs)

    def until(self, *kinds: Kind, most: int = 6000) -> Event:
        for _ in range(most):
            known = len(self.events)
            self.step()
            found = next((event for event in self.events[known:] if event.kind in kinds), None)
            if found is not None:
                return found
        raise AssertionError(f"never {kinds}: {self.kinds()}")

    def turning(self) -> None:
        """It has begun, and turns the wrist for the first time."""
        self.step(RUN)
        while not self.moves:
            self.step()

    def kinds(self) -> list[Kind]:
        return [event.kind for event in self.events]


STOPPED = (Kind.WIZARD_STOPPED, Kind.WIZARD_FINISHED)


def test_it_measures_a_payload_that_nobody_entered_and_goes_back() -> None:
    cell = Cell()
    cell.step(RUN)
    assert cell.events[-1].kind is Kind.WIZARD_STARTED
    assert cell.last.wizard.doing == "waits for the arm to stand"
    event = cell.until(*STOPPED)
    assert (event.kind, event.values) == (Kind.WIZARD_FINISHED, {"postures": WANTED})
    assert cell.kinds().count(Kind.POSTURE_MEASURED) == WANTED
    np.testing.assert_allclose(cell.q, HOME, atol=1e-9)
    assert len(cell.moves) == WANTED  # one to each further posture, and one back
    assert all(move.id < 0 for move in cell.moves)
    assert len({move.id for move in cell.moves}) == WANTED
    for move in cell.moves:
        np.testing.assert_allclose(move.q[:3], HOME[:3], atol=1e-12)
        assert np.abs(np.subtract(move.q, HOME)).max() <= SWING + 1e-9
    finding = cell.last.wizard.finding
    assert finding is not None
    assert finding.mass == pytest.approx(MASS, abs=1e-6)
    assert finding.centre == pytest.approx(CENTRE, abs=1e-6)
    assert finding.force_offset == pytest.approx((1.0, -2.0, 1.5), abs=1e-6)
    assert (cell.last.wizard.doing, cell.last.mode) == ("", Mode.TEACH)
    cell.run(50)
    assert cell.last.law is Law.HOLD
    cell.step(Inputs(commands=(Command.WIZARD_APPLY,)))
    cell.run(60)
    assert cell.supervisor.fitting.load == Load(mass=2.0, com=[0.02, 0.0, 0.07])


def test_it_brakes_after_each_turn_and_settles_before_it_measures() -> None:
    cell = Cell()
    cell.turning()
    while cell.last.law is Law.FOLLOW:
        cell.step()
    assert cell.last.law is Law.BRAKE
    assert cell.last.wizard.doing == "waits for the arm to stand"
    since = 0
    while cell.last.wizard.doing != "measures":
        cell.step()
        since += cell.supervisor._robot.static
    assert since == SETTLING
    assert cell.last.law is Law.HOLD


REDUCED = SpeedLimits(0.75, 0.75, (6.4832,) * 6, 10.0, 0.3, 0.3)


def test_it_is_slow_and_slower_in_reduced() -> None:
    cell = Cell()
    cell.turning()
    usual = cell.supervisor.settings.robot_limits.normal
    tool, elbow, joint = SLOW
    slow = {"tcp": tool, "elbow": elbow, "joints": (joint,) * 6}
    others = (usual.momentum, usual.stopping_time, usual.stopping_distance)
    assert cell.last.speed_limits == SpeedLimits(**slow)._replace(
        momentum=others[0], stopping_time=others[1], stopping_distance=others[2]
    )
    cell.step(Inputs(commands=(Command.REDUCED_ON,)))
    assert cell.last.speed_limits == REDUCED._replace(**slow)
    cell.step(CLEAR)
    assert cell.last.speed_limits == REDUCED
    cell.step(Inputs(commands=(Command.REDUCED_OFF,)))
    assert cell.last.speed_limits is not None
    assert cell.last.speed_limits.tcp == usual.tool_speed


@pytest.mark.parametrize(
    ("inputs", "changes", "reason"),
    [
        (CLEAR, {}, "as asked"),
        (Inputs(commands=(Command.EMERGENCY_STOP,)), {}, "reset first"),
        (Inputs(commands=(Command.REMOTE,)), {}, "switch to NORMAL or TEACH first"),
        (Inputs(jog=JogMove(frame="joint", axis=0, sign=1)), {}, "the arm is jogged"),
        (NOTHING, {"joints_valid": False}, "check joint encoders and motor currents"),
        (NOTHING, {"wrench_valid": False}, "the flange force sensor is not valid"),
        (NOTHING, {"refused": "beyond its range"}, "beyond its range"),
        (NOTHING, {"v_tcp": SLOW_TOOL + 0.01}, "faster than the wizard may move the arm"),
        (NOTHING, {"v_elbow": SLOW_ELBOW + 0.01}, "faster than the wizard may move the arm"),
        (NOTHING, {"qd": np.full(6, -SLOW_JOINT - 0.01)}, "faster than the wizard may move the arm"),
        (NOTHING, {"v_tcp": math.nan}, "reset first"),
    ],
)
def test_what_ends_a_turn_and_the_arm_brakes(inputs: Inputs, changes: dict[str, object], reason: str) -> None:
    cell = Cell()
    cell.turning()
    cell.run(5)
    assert cell.last.law is Law.FOLLOW
    cell.changes = changes
    cell.step(inputs)
    assert cell.events[-1].values.get("reason") == reason
    assert cell.kinds().count(Kind.WIZARD_STOPPED) == 1
    assert cell.last.law is Law.BRAKE
    assert (cell.last.move, cell.last.wizard.doing) == (None, "")
    assert not cell.supervisor._tooling.busy


def test_free_drive_that_is_tried_ends_it() -> None:
    cell = Cell()
    cell.step(RUN)
    cell.run(10)
    for _ in range(100):
        cell.step(Inputs(held=frozenset({Button.FREE_DRIVE})))
    assert Kind.WIZARD_STOPPED in cell.kinds()
    stopped = next(event for event in cell.events if event.kind is Kind.WIZARD_STOPPED)
    assert stopped.values == {"reason": "free-drive is being tried"}


def test_an_enabling_device_that_is_let_go_ends_it() -> None:
    cell = Cell(enabling__on=True)
    held = Inputs(held=frozenset({Button.ENABLING}))
    cell.run(5, held)
    cell.step(Inputs(held=held.held, commands=RUN.commands))
    cell.run(20, held)
    cell.step(Inputs(released=held.held))
    assert cell.kinds()[-1] is Kind.WIZARD_STOPPED
    assert "enabling device" in str(cell.events[-1].values["reason"])


@pytest.mark.parametrize(("share", "ends"), [(0.9, False), (1.3, True)])
def test_a_hand_that_strikes_a_turning_arm_ends_it(share: float, ends: bool) -> None:
    cell = Cell()
    cell.turning()
    cell.push = np.array([0.0, share * STRUCK, 0.0])
    while cell.last.law is Law.FOLLOW:
        cell.step()
    assert (Kind.WIZARD_STOPPED in cell.kinds()) is ends
    if ends:
        assert "at most 10 N: hands off the arm" in str(cell.events[-1].values["reason"])


def test_what_meets_a_link_before_the_sensor_ends_it() -> None:
    cell = Cell()
    cell.turning()
    cell.changes = {"tau_ext": np.array([0.0, 0.0, 0.0, 1.1 * JOLTED, 0.0, 0.0])}
    cell.step()
    assert cell.events[-1].kind is Kind.WIZARD_STOPPED
    assert "a joint felt 11 N·m, at most 10 N·m" in str(cell.events[-1].values["reason"])
    assert cell.last.law is Law.BRAKE


def test_a_hand_in_a_measurement_is_waited_for_and_then_told() -> None:
    """Two more tries, then it gives up."""
    cell = Cell()
    cell.step(RUN)
    refused = 0
    for _ in range(1000):
        if cell.last.wizard.doing == "measures" and cell.supervisor._tooling.wizard.left == 25:
            cell.push = np.add(cell.push, [0.0, 0.0, 5.0])
        cell.step()
        refused = cell.kinds().count(Kind.POSTURE_REFUSED)
        if Kind.WIZARD_STOPPED in cell.kinds():
            break
    assert refused == TRIES
    assert "hands off the arm" in str(cell.events[-1].values["reason"])


def test_a_hand_that_lets_go_in_time_only_delays() -> None:
    cell = Cell()
    cell.step(RUN)
    while cell.last.wizard.doing != "measures":
        cell.step()
    cell.run(25)
    cell.push = np.array([0.0, 0.0, 5.0])
    cell.run(60)
    cell.push = np.zeros(3)
    assert cell.until(*STOPPED).kind is Kind.WIZARD_FINISHED
    assert cell.kinds().count(Kind.POSTURE_REFUSED) >= 1


THREE = ArmShape(("a", "b", "c"), [Pose()] * 3, Pose(), rods=(), ranges=((-1.0, 1.0),) * 3, elbow=1)


@pytest.mark.parametrize("shape", [None, THREE])
def test_an_arm_of_unknown_shape_is_not_turned(shape: ArmShape | None) -> None:
    cell = Cell()
    cell.supervisor._equipping._shape = shape
    cell.step(RUN)
    assert cell.kinds() == [Kind.WIZARD_REFUSED]
    assert cell.events[-1].values == {"reason": "nothing is known of the arm's shape"}


def test_it_does_not_begin_where_something_is_against_it() -> None:
    cell = Cell()
    cell.changes = {"wrench_valid": False}
    cell.step(RUN)
    assert cell.events[-1].values == {"reason": "the flange force sensor is not valid"}
    cell = Cell()
    cell.step(Inputs(load=Load(mass=1.0)))
    cell.step(RUN)
    assert cell.events[-1].values == {"reason": "the payload is being changed"}
    cell = Cell()
    cell.changes = {"qd": np.full(6, 0.2)}
    cell.run(2)
    cell.step(RUN)
    assert cell.events[-1].values == {"reason": "the arm moves"}
    assert cell.kinds() == [Kind.WIZARD_REFUSED]


def test_nothing_of_the_tool_is_changed_while_it_measures() -> None:
    cell = Cell()
    cell.turning()
    cell.step(Inputs(load=Load(mass=1.0)))
    assert cell.events[-1].kind is Kind.TOOL_REFUSED
    assert cell.events[-1].values["reason"] == "the wizard measures the payload: stop it first"
    cell.step(Inputs(commands=(Command.ZERO_SENSOR,)))
    assert cell.events[-1].values == {"reason": "the payload is being measured"}
    cell.step(Inputs(commands=(Command.WIZARD_MEASURE,)))
    assert cell.events[-1].values == {"reason": "the wizard measures by itself"}
    cell.step(Inputs(borders=(tube(0.5),)))
    assert cell.events[-1].values == {"reason": "no change of a wall in the payload wizard's motion"}
    cell.step(RUN)  # it goes on
    assert cell.until(*STOPPED).kind is Kind.WIZARD_FINISHED


def test_a_program_that_starts_between_two_turns_ends_it() -> None:
    cell = Cell()
    cell.step(Inputs(program=Program(steps=(Wait(duration=5.0),))))
    cell.step(RUN)
    cell.run(5)
    cell.step(Inputs(commands=(Command.START_PROGRAM,)))
    assert cell.last.mode is Mode.RUN
    assert cell.events[-1].values == {"reason": "stop the program first"}
    assert cell.last.law is Law.FOLLOW


def tube(radius: float) -> Area:
    """To stay in: a ball round the tool at home, which leaves the flange little room."""
    p = wrist_arm().places(np.array([HOME]))[0][0, -1]
    x, y, z = p.tolist()
    return Area(name="tube", part="flange", shape=Sphere(radius=radius), position=(x, y, z))


def test_without_room_it_says_what_is_too_near() -> None:
    cell = Cell(walls=(tube(0.04),))
    cell.step(RUN)
    event = cell.until(*STOPPED)
    assert event.kind is Kind.WIZARD_STOPPED
    assert str(event.values["reason"]).startswith("room for ")
    assert "flange to the wall tube is too near; move the arm away" in str(event.values["reason"])
    assert cell.kinds().count(Kind.POSTURE_MEASURED) < 4


def test_a_wall_leaves_postures_out_and_is_not_crossed() -> None:
    """A desk under the flange: it finds other postures, and no way leads below it."""
    height = float(wrist_arm().places(np.array([HOME]))[0][0, -1, 2]) - 0.05
    desk = Area(name="desk", part="flange", shape=HalfSpace(normal=(0.0, 0.0, 1.0), distance=height), keep_out=True)
    lowest = [math.inf, math.inf]
    least = height + Settings().tools.clearance
    for k, walls in enumerate(((), (desk,))):
        cell = Cell(walls=walls)
        cell.step(RUN)
        while not set(cell.kinds()) & set(STOPPED):
            cell.step()
            lowest[k] = min(lowest[k], float(cell.shape.places(cell.q[None])[0][0, -1, 2]))
    assert lowest[0] < least - 0.01
    assert lowest[1] >= least - 1e-6


def test_walls_that_are_switched_off_are_no_obstacle() -> None:
    cell = Cell(walls=(tube(0.04),), walls__on=False)
    cell.step(RUN)
    assert cell.until(*STOPPED).kind is Kind.WIZARD_FINISHED


def test_a_wall_that_is_off_is_no_obstacle() -> None:
    cell = Cell(walls=(replace(tube(0.04), on=False),))
    cell.step(RUN)
    assert cell.until(*STOPPED).kind is Kind.WIZARD_FINISHED


def test_four_postures_are_enough_where_there_is_no_room_for_more(monkeypatch: pytest.MonkeyPatch) -> None:
    cell = Cell()
    cell.step(RUN)
    while cell.kinds().count(Kind.POSTURE_MEASURED) < 4:
        cell.step()
    monkeypatch.setattr("pendant.equipping.best_first", lambda *_, **__: np.zeros((0, 6)))
    cell.supervisor._equipping._seen = np.zeros((0, 6))
    cell.supervisor._equipping._next = 0
    event = cell.until(*STOPPED)
    assert (event.kind, event.values["postures"]) == (Kind.WIZARD_FINISHED, 4)


def test_a_way_back_that_is_no_more_is_told() -> None:
    """Somebody has moved the arm while it was measured, to where the way back is blocked."""
    cell = Cell()
    cell.step(RUN)
    while cell.kinds().count(Kind.POSTURE_MEASURED) < WANTED:
        cell.step()
    cell.supervisor._equipping._begin = np.array([*HOME[:5], 6.5])
    event = cell.until(*STOPPED)
    assert event.kind is Kind.WIZARD_STOPPED
    assert event.values["reason"] == "no room on the way back: the end of the range of wrist_3 is too near"
