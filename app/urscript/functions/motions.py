"""Functions that move the arm (URScript manual, module motion)."""

from collections.abc import Generator, Iterator
from contextlib import contextmanager
from typing import NamedTuple

from app.urscript.calculation.pose_algebra import quaternion, transformed
from app.urscript.functions.sensing_values import Kinematics
from app.urscript.language.trouble import Misuse
from app.urscript.machine.signature import (
    Builtin,
    Taken,
    any_value,
    boolean,
    builtin,
    integer,
    number,
    numbers,
    optional,
    pose,
    text,
    within,
)
from app.urscript.machine.values import PoseValue, StructValue, Value, kind
from app.urscript.robot.robot_side import ArmSide, RobotSide
from pendant.motion.script_requests import (
    GAIN,
    LOOKAHEAD,
    DirectTorque,
    GentleStop,
    ScriptedArc,
    ScriptedJoints,
    ScriptedLine,
    ScriptedMove,
    ScriptedProcess,
    ServoJoints,
    ServoTool,
    SpeedJoints,
    SpeedTool,
)
from pendant.tick.modes import TICK_RATE
from pendant.tick.pose import Quaternion, Vector

Doing = Generator[None, None, Value]

MOST = 1e6
POSITIVE = within(number, 1e-6, MOST)
ZERO_UP = within(number, 0.0, MOST)

VISCOUS_SCALE, COULOMB_SCALE = (0.9, 0.9, 0.8, 0.9, 0.9, 0.9), (0.8, 0.8, 0.7, 0.8, 0.8, 0.8)
"""Friction scales of direct_torque, if a program gives none (URScript manual)."""


def target(value: Value) -> tuple[float, ...] | PoseValue:
    """Check that a value is joint angles or a pose. Raises Misuse: it is not."""
    if type(value) is PoseValue:
        return pose(value)
    if type(value) is tuple:
        return numbers(6)(value)
    raise Misuse(f"expected joint angles or a pose, this is {kind(value)}")


class Placed(NamedTuple):
    """A pose as the arm takes it."""

    position: Vector
    quaternion: Quaternion


def placed(x: PoseValue) -> Placed:
    """The pose of a script, as the arm takes it."""
    return Placed((x[0], x[1], x[2]), quaternion(tuple(x[3:])))


@contextmanager
def controlling(arm: ArmSide) -> Iterator[None]:
    """A thread of the program moves the arm. Raises Misuse: another thread moves it (URScript manual, Threads)."""
    arm.take()
    try:
        yield
    finally:
        arm.give()


def of_moves(robot: RobotSide) -> Iterator[Builtin]:
    """movej, movel, movep, movec and the stops."""
    arm = Kinematics(robot)

    def until_done(move: ScriptedMove) -> Doing:
        with controlling(robot.arm):
            number_ = robot.arm.ask(move)
            try:
                while not robot.arm.done(number_):
                    yield
            finally:
                robot.arm.drop(number_)

    def joints(where: tuple[float, ...] | PoseValue) -> tuple[float, ...]:
        if type(where) is not PoseValue:
            return where
        found = arm.inverse(where, tuple(robot.record.get("target_q")), None)  # pyright: ignore[reportArgumentType]
        if found is None:
            raise Misuse("no joint angles reach this pose")
        return found

    def cartesian(where: tuple[float, ...] | PoseValue) -> PoseValue:
        return where if type(where) is PoseValue else arm.forward(where, None)

    def movej(*given: Value) -> Doing:
        q, a, v, t, r = given
        return until_done(ScriptedJoints(q=joints(q), acceleration=a, speed=v, time=t, blend=r))

    def movel(*given: Value) -> Doing:
        x, a, v, t, r = given
        position, turned = placed(cartesian(x))
        return until_done(ScriptedLine(position=position, quaternion=turned, acceleration=a, speed=v, time=t, blend=r))

    def movep(x: Value, a: float, v: float, r: float) -> Doing:
        position, turned = placed(cartesian(x))
        return until_done(ScriptedProcess(position=position, quaternion=turned, acceleration=a, speed=v, blend=r))

    def movec(*given: Value) -> Doing:
        via, to, a, v, r, mode = given
        position, turned = placed(cartesian(to))
        on_the_way = placed(cartesian(via)).position
        return until_done(
            ScriptedArc(position=position, quaternion=turned, via=on_the_way, acceleration=a, speed=v, blend=r, fixed=mode == 1)
        )

    a, v, t, r = (
        lambda default: Taken("a", POSITIVE, default),
        lambda default: Taken("v", POSITIVE, default),
        Taken("t", ZERO_UP, 0.0),
        Taken("r", ZERO_UP, 0.0),
    )
    q, x = Taken("q", target), Taken("pose", target)
    yield builtin("movej", movej, q, a(1.4), v(1.05), t, r, physical=True)
    yield builtin("movel", movel, x, a(1.2), v(0.25), t, r, physical=True)
    yield builtin("movep", movep, x, a(1.2), v(0.25), r, physical=True)
    mode = Taken("mode", within(integer, 0, 1), 0)
    yield builtin("movec", movec, Taken("pose_via", target), Taken("pose_to", target), a(1.2), v(0.25), r, mode, physical=True)
    share = within(number, 1e-3, 1.0)
    goal = Taken("goal", lambda value: target(_goal(robot, value)))
    top = robot.simulation.arm.limits

    def optimovej(q_: Value, a_: float, v_: float, r_: float) -> Doing:
        return movej(q_, a_ * min(top.acceleration), v_ * min(top.speed), 0.0, r_)

    def optimovel(x_: Value, a_: float, v_: float, r_: float) -> Doing:
        return movel(x_, a_ * 2.5, v_ * 1.0, 0.0, r_)

    yield builtin("optimovej", optimovej, goal, Taken("a", share, 0.3), Taken("v", share, 0.3), r, physical=True)
    yield builtin("optimovel", optimovel, goal, Taken("a", share, 0.3), Taken("v", share, 0.3), r, physical=True)

    def stop_tool(a_: float, _: Value) -> Doing:
        return until_done(GentleStop(of="tool", deceleration=a_))

    yield builtin("stopj", lambda a_: until_done(GentleStop(deceleration=a_)), Taken("a", POSITIVE), physical=True)
    yield builtin("stopl", stop_tool, Taken("a", POSITIVE), Taken("aRot", any_value, None), physical=True)


def _goal(robot: RobotSide, value: Value) -> Value:
    """Goal of an optimove, as a pose in the base: from a frame of the world model, or from a pose in such a frame."""
    world = robot.memory.world
    if type(value) is str:
        return world.at(value)
    if type(value) is StructValue and {"pose", "frame"} <= value.members.keys():
        return transformed(world.at(text(value.members["frame"])), pose(value.members["pose"]))
    return value


def for_ticks(arm: ArmSide, move: ScriptedMove, count: int) -> Doing:
    """Ask for a motion and wait for `count` ticks, even if the motion ends earlier or later."""
    with controlling(arm):
        arm.ask(move)
        for _ in range(count):
            yield


def of_streams(robot: RobotSide) -> Iterator[Builtin]:
    """servoj, servoc, speedj, speedl: streamed commands."""

    arm = Kinematics(robot)

    def for_time(move: ScriptedMove, seconds: float) -> Doing:
        return for_ticks(robot.arm, move, max(round(min(seconds, MOST) * TICK_RATE), 1))

    told: set[str] = set()  # parameters that were limited

    def limited(name: str, value: float, allowed: tuple[float, float]) -> float:
        """A number, limited to its range; the first time that it is limited, a line tells the user."""
        found = min(max(value, allowed[0]), allowed[1])
        if found != value and name not in told:
            told.add(name)
            least, most = allowed
            robot.say(f"servoj(): {name}: {value:g} is out of range, allowed: {least:g} to {most:g}; {found:g} is taken")
        return found

    def servoj(*given: Value) -> Doing:
        q, _, _, t, lookahead, gain = given
        lookahead, gain = limited("lookahead_time", lookahead, LOOKAHEAD), limited("gain", gain, GAIN)
        return for_time(ServoJoints(q=q, time=t, lookahead=lookahead, gain=gain), t)

    def servoc(x: Value, a: float, v: float, r: float) -> Doing:
        position, turned = placed(x if type(x) is PoseValue else arm.forward(x, None))
        return for_time(ServoTool(position=position, quaternion=turned, acceleration=a, speed=v, blend=r), 0.0)

    def until_reached(move: SpeedJoints | SpeedTool) -> Doing:
        """Move for the given time; without a time, until the speed is reached."""
        if move.time > 0.0:
            yield from for_time(move, move.time)
            return
        with controlling(robot.arm):
            number_ = robot.arm.ask(move)
            while not robot.arm.done(number_):
                yield

    def speedj(qd: Value, a: float, t: float) -> Doing:
        return until_reached(SpeedJoints(qd=qd, acceleration=a, time=t))

    def speedl(xd: Value, a: float, t: float, turning: Value) -> Doing:
        about = a if turning is None else ZERO_UP(turning)
        return until_reached(
            SpeedTool(speed=tuple(xd[:3]), turning=tuple(xd[3:]), acceleration=a, turning_acceleration=about, time=t)
        )

    q = Taken("q", numbers(6))
    yield builtin(
        "servoj",
        servoj,
        q,
        Taken("a", ZERO_UP, 0.0),
        Taken("v", ZERO_UP, 0.0),
        Taken("t", ZERO_UP, 0.002),
        Taken("lookahead_time", number, 0.1),
        Taken("gain", number, 300.0),
        physical=True,
    )
    a, t = Taken("a", ZERO_UP), Taken("t", ZERO_UP, 0.0)  # a = 0 keeps the speed; some clients send splines in that way
    blend = Taken("r", ZERO_UP, 0.0)
    yield builtin(
        "servoc", servoc, Taken("pose", target), Taken("a", POSITIVE, 1.2), Taken("v", POSITIVE, 0.25), blend, physical=True
    )
    yield builtin("speedj", speedj, Taken("qd", numbers(6)), a, t, physical=True)
    yield builtin("speedl", speedl, Taken("xd", numbers(6)), a, t, Taken("aRot", any_value, None), physical=True)


def of_torques(robot: RobotSide) -> Iterator[Builtin]:
    """direct_torque (URScript manual 5.25)."""
    told: list[str] = []

    def direct_torque(torque: Value, viscous: Value, coulomb: Value, compensated: Value) -> Doing:
        if type(viscous) is bool:  # friction_comp was the second argument in versions without scales
            viscous, compensated = None, viscous
        if compensated is not None and not told:
            told.append("direct_torque(): friction_comp is deprecated, use viscous_scale and coulomb_scale")
            robot.say(told[0])
        off = compensated is False and viscous is None and coulomb is None
        shares = [
            (0.0,) * 6 if off else usual if given is None else given
            for given, usual in ((viscous, VISCOUS_SCALE), (coulomb, COULOMB_SCALE))
        ]
        try:
            move = DirectTorque(torque=torque, viscous=shares[0], coulomb=shares[1])
        except ValueError as error:
            raise Misuse(str(error)) from None
        return for_ticks(robot.arm, move, 1)

    yield builtin(
        "direct_torque",
        direct_torque,
        Taken("torque", numbers(6)),
        Taken("viscous_scale", optional(lambda value: value if type(value) is bool else numbers(6)(value)), None),
        Taken("coulomb_scale", optional(numbers(6)), None),
        Taken("friction_comp", optional(boolean), None),
        physical=True,
    )
