"""Programs, scripts and jogging before a border, by the whole simulation: they stop inside, say why, and the way back is free."""

from collections.abc import Callable

import numpy as np
import pytest

from pendant.all_settings import apply
from pendant.events.event import Event, Kind
from pendant.inputs import NOTHING, Command, Inputs
from pendant.motion.script_requests import (
    DirectTorque,
    ForceMode,
    GentleStop,
    Scripted,
    ScriptedLine,
    ServoJoints,
    SpeedJoints,
    SpeedTool,
)
from pendant.program.jog_move import Jogged, JogMove, MoveThere
from pendant.program.steps import ApplyForce, JointMove, LinearMove, Program, script_program
from pendant.tick.modes import TICK, TICK_RATE, Mode
from pendant.walls.definitions import Area
from pendant.walls.shapes import HalfSpace, Sphere
from sim.arm.frames import quaternion_from_matrix
from sim.arm.scenario import Scenario
from sim.exchange.desk import Wishes
from tests.sim.bench import IDLE, LONG, Bench

FLOOR = 0.25
HEIGHT = 0.343
"""Of the flange over the foot at the begin [m]."""

OPEN = 0.05
"""A part is inside by so much where nothing is said of it [m]."""


def floor(height: float = FLOOR, part: str = "tcp") -> Area:
    return Area(name="floor", part=part, shape=HalfSpace(normal=(0.0, 0.0, -1.0)), position=(0.0, 0.0, height))


class Course(Bench):
    """An arm among areas, and how low its flange came."""

    def __init__(self, *areas: Area, settings: dict[str, bool | float] | None = None, mismatch: str = "on") -> None:
        scenario = Scenario(seed=3, walls=list(areas), mismatch="on" if mismatch == "on" else "nominal")
        super().__init__(scenario, apply(LONG, settings or {}))
        self.heights: list[float] = []
        self.run(0.4)

    def step(self, inputs: Inputs = NOTHING) -> None:
        self.tick(Wishes(inputs, (), ()))
        self.heights.append(float(self.flange[2]))

    def kinds(self) -> list[Kind]:
        return [event.kind for event in self.events]

    def last(self, kind: Kind) -> Event:
        return next(event for event in reversed(self.events) if event.kind is kind)

    def play(self, *steps: JointMove | LinearMove | ApplyForce, seconds: float = 5.0) -> "Course":
        """A program, to its end."""
        self.do(program=Program(steps=steps))
        self.do(Command.START_PROGRAM)
        for _ in range(round(seconds * TICK_RATE)):
            self.step()
            if self.mode is Mode.TEACH and self.events[-1].kind in (Kind.PROGRAM_FAILED, Kind.PROGRAM_FINISHED):
                break
        return self.rest()

    def script(self, wanted: Callable[[int], Scripted], seconds: float = 3.0) -> "Course":
        """What a script wants, tick by tick, until its program ends."""
        self.do(program=script_program("script"))
        self.do(Command.START_PROGRAM)
        for k in range(round(seconds * TICK_RATE)):
            self.step(Inputs(script=wanted(k)))
            if self.mode is Mode.TEACH:
                break
        return self.rest()

    def jog(self, move: Jogged, seconds: float = 3.0) -> "Course":
        """A button that is held."""
        for _ in range(round(seconds * TICK_RATE)):
            self.step(Inputs(jog=move))
        self.step(Inputs(jog_released=True))
        return self.rest()

    def rest(self) -> "Course":
        for _ in range(150):
            self.step()
        return self

    @property
    def place(self) -> tuple[np.ndarray, tuple[float, float, float, float]]:
        """Of the tool now."""
        p, R, _ = self.simulation.dynamics.places(self.plant.q)
        w, x, y, z = quaternion_from_matrix(R).tolist()
        return p, (w, x, y, z)

    def line(
        self, x: float = 0.0, y: float = 0.0, z: float = 0.0, *, speed: float = 0.1, acceleration: float = 0.5
    ) -> LinearMove:
        p, quaternion = self.place
        x, y, z = np.add(p, [x, y, z]).tolist()
        return LinearMove(position=(x, y, z), quaternion=quaternion, speed=speed, acceleration=acceleration)


def stopped_at_the_floor(course: Course, height: float = FLOOR) -> None:
    """It came to rest at the border, never 5 mm beyond it, and the events say so."""
    assert min(course.heights) > height - 0.005
    assert course.heights[-1] == pytest.approx(height, abs=0.006)
    assert np.ptp(course.heights[-50:]) < 1e-3
    at_wall = course.last(Kind.MOTION_AT_WALL).values
    assert (at_wall["wall"], at_wall["part"], at_wall["way"]) == ("floor", "tcp", "+z")
    assert at_wall["pz"] == pytest.approx(height, abs=0.006)


@pytest.mark.parametrize(("speed", "acceleration"), [(0.05, 0.5), (0.3, 1.2), (1.0, 5.0)])
def test_a_line_of_a_program_stops_at_the_border_on_its_way(speed: float, acceleration: float) -> None:
    course = Course(floor())
    begin, _ = course.place
    course.play(course.line(0.05, 0.1, -0.25, speed=speed, acceleration=acceleration))
    stopped_at_the_floor(course)
    failed = course.last(Kind.PROGRAM_FAILED).values
    assert failed["reason"] == "tcp at the border of floor; back is +z of the base"
    assert course.kinds().index(Kind.MOTION_AT_WALL) == course.kinds().index(Kind.PROGRAM_FAILED) - 1
    end, _ = course.place
    along = np.array([0.05, 0.1, -0.25]) / np.linalg.norm([0.05, 0.1, -0.25])
    assert np.linalg.norm(np.cross(end - begin, along)) < 2e-3


def test_a_joint_move_at_full_speed_stops_at_the_border() -> None:
    course = Course(floor())
    q = np.add(course.plant.q, [0.3, 0.8, 0.0, 0.0, 0.0, 0.0])
    stopped_at_the_floor(course.play(JointMove(q=tuple(q.tolist()), speed=1.0, acceleration=1.0)))


def test_the_elbow_is_kept_as_well_as_the_tool() -> None:
    height = 0.5
    course = Course(floor(height, part="elbow"))
    q = np.add(course.plant.q, [0.0, 0.6, 0.0, -0.6, 0.0, 0.0])
    course.play(JointMove(q=tuple(q.tolist()), speed=1.0, acceleration=1.0))
    elbow = course.plant.poses()[1 + course.simulation.arm.chain.elbow, 2]
    assert elbow == pytest.approx(height, abs=0.005)
    assert course.last(Kind.MOTION_AT_WALL).values["part"] == "elbow"


def test_a_motion_that_stays_inside_is_the_same_as_without() -> None:
    walls, free = Course(floor()), Course()
    for course in (walls, free):
        course.play(course.line(0.1, 0.2, -0.04, speed=0.5, acceleration=3.0))
    assert walls.heights == free.heights
    assert walls.kinds() == free.kinds()


def test_walls_that_are_off_stop_nothing() -> None:
    for course in (Course(floor(), settings={"walls.on": False}), Course()):
        course.play(course.line(z=-0.2, speed=0.5))
        assert Kind.PROGRAM_FINISHED in course.kinds()


@pytest.mark.parametrize(
    "move",
    [
        JogMove(frame="base", axis=2, sign=-1),
        JogMove(frame="tool", axis=2, sign=1),
        JogMove(frame="joint", axis=1, sign=1),
        MoveThere(q=(0.0, -0.7, 1.5, -1.87, -1.57, 0.0), name="home"),
    ],
)
def test_jogging_ends_at_the_border_with_that_reason(move: Jogged) -> None:
    course = Course(floor()).jog(move)
    stopped_at_the_floor(course)
    assert course.last(Kind.JOG_ENDED).values["reason"] == "tcp at the border of floor; back is +z of the base"
    assert course.kinds().count(Kind.JOG_STARTED) == 1


def test_at_the_border_along_and_back_are_free_and_out_is_not() -> None:
    """VW-10."""
    course = Course(floor()).jog(JogMove(frame="base", axis=2, sign=-1))
    for axis in range(3):
        begin, _ = course.place
        course.jog(JogMove(frame="base", axis=axis, sign=1, length=0.03))
        end, _ = course.place
        assert course.last(Kind.JOG_ENDED).values["reason"] == "done"
        assert abs(end[axis] - begin[axis]) == pytest.approx(0.03, abs=1e-3)
    course.jog(JogMove(frame="base", axis=2, sign=-1))
    for _ in range(8):  # it does not creep out either
        course.jog(JogMove(frame="base", axis=2, sign=-1), 0.3)
    stopped_at_the_floor(course)
    assert course.heights[-1] > FLOOR - 0.002


def test_an_arm_that_begins_beyond_is_not_trapped() -> None:
    """VW-10."""
    above = FLOOR + 0.2
    course = Course(floor(above))
    course.play(course.line(z=-0.05))
    assert "108 mm beyond floor" in str(course.last(Kind.PROGRAM_FAILED).values["reason"])
    assert min(course.heights) > HEIGHT - 0.005
    course.jog(JogMove(frame="base", axis=2, sign=1), 1.5)
    assert course.heights[-1] > above + 0.05
    course.heights.clear()
    stopped_at_the_floor(course.jog(JogMove(frame="base", axis=2, sign=-1), 4.0), above)


def test_an_area_that_moves_with_the_tool_stops_an_arm_that_folds() -> None:
    """VW-2: the elbow stays out of a ball round the tool."""
    ball = Area(name="ball", part="elbow", reference="tcp", shape=Sphere(radius=0.45), keep_out=True)
    course = Course(ball)
    course.jog(JogMove(frame="joint", axis=3, sign=1), 4.0)
    assert course.last(Kind.JOG_ENDED).values["reason"] != "let go"
    assert course.last(Kind.MOTION_AT_WALL).values["wall"] == "ball"
    p, _, elbow = course.simulation.dynamics.places(course.plant.q)
    assert np.linalg.norm(p - elbow) == pytest.approx(0.45, abs=0.005)


def test_a_wall_that_is_made_while_it_is_jogged_stops_it() -> None:
    course, move = Course(), JogMove(frame="base", axis=2, sign=-1)
    for _ in range(round(0.3 * TICK_RATE)):
        course.step(Inputs(jog=move))
    course.step(Inputs(jog=move, borders=(floor(FLOOR),)))
    stopped_at_the_floor(course.jog(move))


def test_what_is_just_beyond_by_a_hand_can_be_gone_to_by_a_program() -> None:
    """A posture that was taught where a hand was stopped."""
    course = Course(floor())
    depth = FLOOR - HEIGHT - 0.0004
    course.play(course.line(z=depth))
    assert Kind.PROGRAM_FINISHED in course.kinds()


def servoed(begin: np.ndarray, joint: int, rate: float) -> Callable[[int], Scripted]:
    def wanted(k: int) -> Scripted:
        q = begin.copy()
        q[joint] += rate * k * TICK
        return Scripted(move=ServoJoints(id=k + 1, q=tuple(q.tolist()), time=0.002))

    return wanted


@pytest.mark.parametrize(
    "move",
    [
        SpeedTool(id=1, speed=(0.0, 0.0, -0.5), turning=(0.0, 0.0, 0.0), acceleration=2.0, turning_acceleration=2.0),
        SpeedJoints(id=1, qd=(0.3, 0.8, 0.0, 0.0, 0.0, 0.0), acceleration=4.0),
    ],
)
def test_a_speed_command_of_a_script_is_slowed_down_and_stopped(move: SpeedTool | SpeedJoints) -> None:
    course = Course(floor()).script(lambda _: Scripted(move=move))
    stopped_at_the_floor(course)
    assert Kind.PROGRAM_FAILED in course.kinds()


def test_a_servo_command_is_slowed_down_and_stopped() -> None:
    course = Course(floor())
    stopped_at_the_floor(course.script(servoed(course.plant.q.copy(), 1, 0.7)))


def test_a_servo_command_that_turns_back_in_time_goes_on() -> None:
    course = Course(floor())
    begin = course.plant.q.copy()

    def wanted(k: int) -> Scripted:
        q = begin.copy()
        q[1] += 0.06 * (1.0 - np.cos(2.0 * np.pi * k * TICK))  # 12 cm · 0.62 m down, and back
        return Scripted(move=ServoJoints(id=k + 1, q=tuple(q.tolist()), time=0.002))

    course.script(wanted, 2.0)
    assert Kind.MOTION_AT_WALL not in course.kinds()
    assert min(course.heights) == pytest.approx(HEIGHT - 0.075, abs=0.01)


def test_a_gentle_stop_is_as_hard_as_it_must_be() -> None:
    """Of a script, at 0.5 m/s and 0.5 m/s²: it would come to rest 0.25 m further on."""
    move = SpeedTool(id=1, speed=(0.0, 0.0, -0.4), turning=(0.0, 0.0, 0.0), acceleration=4.0, turning_acceleration=2.0)
    stop = GentleStop(id=2, of="tool", deceleration=0.5)
    course = Course(floor()).script(lambda k: Scripted(move=move if k < 60 else stop), 2.0)
    assert FLOOR - 0.005 < min(course.heights) < FLOOR + 0.03
    free = Course().script(lambda k: Scripted(move=move if k < 60 else stop), 2.0)
    assert min(free.heights) < FLOOR - 0.05


def test_torques_that_a_script_commands_are_taken_off_while_it_can_still_stop() -> None:
    torque = DirectTorque(id=1, torque=(0.0, 12.0, 0.0, 0.0, 0.0, 0.0), viscous=(0.9,) * 6, coulomb=(0.8,) * 6)
    course = Course(floor()).script(lambda k: Scripted(move=DirectTorque(**{**_fields(torque), "id": k + 1})))
    assert min(course.heights) > FLOOR - 0.005
    assert course.last(Kind.MOTION_AT_WALL).values["wall"] == "floor"


def _fields(move: DirectTorque) -> dict[str, object]:
    return {name: getattr(move, name) for name in ("torque", "viscous", "coulomb")}


def down(speed: float) -> ForceMode:
    """The arm gives way downwards, to a force that nothing answers."""
    free = (False, False, True, False, False, False)
    limits = (0.5, 0.5, speed, 1.0, 1.0, 1.0)
    return ForceMode(
        free=free,
        wrench=(0.0, 0.0, -20.0, 0.0, 0.0, 0.0),
        limits=limits,
        origin=(0.0, 0.0, 0.0),
        R_BU=(1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0),
    )


def test_a_force_that_leads_the_arm_out_is_stopped() -> None:
    course = Course(floor())
    p, quaternion = course.place
    x, y, z = p.tolist()
    move = ScriptedLine(id=1, position=(x, y, z), quaternion=quaternion)
    stopped_at_the_floor(course.script(lambda _: Scripted(move=move, force=down(0.1)), 4.0))


def test_along_an_axis_that_gives_way_the_motion_itself_may_lead_out() -> None:
    """There the force decides where the tool is."""
    course = Course(floor())
    p, quaternion = course.place
    x, y, z = np.add(p, [0.0, 0.0, -0.3]).tolist()
    move = ScriptedLine(id=1, position=(x, y, z), quaternion=quaternion, speed=0.5)
    course.script(lambda _: Scripted(move=move, force=down(0.001)), 2.0)
    assert Kind.MOTION_AT_WALL not in course.kinds()
    assert min(course.heights) > HEIGHT - 0.02


def test_a_step_that_pushes_with_a_force_is_stopped() -> None:
    course = Course(floor(HEIGHT - 0.03))
    course.play(ApplyForce(force=(0.0, 0.0, -15.0), speed=0.1, distance=0.2))
    assert min(course.heights) > HEIGHT - 0.035
    assert course.last(Kind.MOTION_AT_WALL).values["wall"] == "floor"


def test_reduced_that_comes_while_it_brakes_changes_nothing_of_where_it_stops() -> None:
    course = Course(floor())
    course.do(program=Program(steps=(course.line(z=-0.25, speed=0.5, acceleration=3.0),)))
    course.do(Command.START_PROGRAM)
    while course.flange[2] > FLOOR + 0.01:
        course.step()
    course.step(Inputs(commands=(Command.REDUCED_ON,)))
    for _ in range(600):
        course.step()
    stopped_at_the_floor(course)


def test_a_program_that_is_paused_at_a_wall_and_goes_on_is_stopped_there_again() -> None:
    course = Course(floor())
    course.do(program=Program(steps=(course.line(z=-0.25, speed=0.2),)))
    course.do(Command.START_PROGRAM)
    while course.flange[2] > FLOOR + 0.03:
        course.step()
    course.step(Inputs(commands=(Command.PAUSE_PROGRAM,)))
    course.run(0.5)
    course.step(Inputs(commands=(Command.RESUME_PROGRAM,)))
    for _ in range(900):
        course.step()
    stopped_at_the_floor(course)


def test_without_a_motion_nothing_is_told() -> None:
    """A hand pushes the held arm over a border."""
    course = Course(floor(HEIGHT - 0.001))
    course.run(0.5)
    assert course.tick(IDLE).events == ()
    assert Kind.MOTION_AT_WALL not in course.kinds()
