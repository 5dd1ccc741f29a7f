"""Functions that move the arm (URScript manual, module motion)."""

import math
from collections.abc import Callable, Generator, Iterator
from typing import Any

from app.urscript.functions.motion_asks import (
    CircleServoAsk,
    ForceAsk,
    ForceEndAsk,
    FreeDriveAsk,
    FreeDriveEndAsk,
    MoveAsk,
    ServoAsk,
    SpeedAsk,
    StopAsk,
)
from app.urscript.functions.robot_side import RobotSide
from app.urscript.functions.sensing_values import Kinematics
from app.urscript.language.trouble import Misuse
from app.urscript.machine.signature import (
    Builtin,
    Taken,
    any_value,
    boolean,
    builtin,
    integer,
    items,
    number,
    numbers,
    pose,
    within,
)
from app.urscript.machine.values import PoseValue, Value, kind
from pendant.tick.modes import TICK_RATE

Doing = Generator[None, None, Value]

MOST = 1e6
POSITIVE = within(number, 1e-6, MOST)
ZERO_UP = within(number, 0.0, MOST)
LIMITS = (0.1, 0.1, 0.1, 0.17, 0.34, 0.17)
HELD = 1e-3
"""A speed below it is none."""


def target(value: Value) -> tuple[float, ...] | PoseValue:
    """Joint angles, or a pose."""
    if type(value) is PoseValue:
        return pose(value)
    if type(value) is tuple:
        return numbers(6)(value)
    raise Misuse(f"expected joint angles or a pose, this is {kind(value)}")


def of_moves(robot: RobotSide) -> Iterator[Builtin]:
    """movej, movel, movep, movec and the stops."""
    arm = Kinematics(robot)

    def until_done(ask: Any) -> Doing:
        number_ = robot.arm.ask(ask)
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
        return until_done(MoveAsk("j", joints(q), a, v, t, r))

    def movel(*given: Value) -> Doing:
        x, a, v, t, r = given
        return until_done(MoveAsk("l", cartesian(x), a, v, t, r))

    def movep(x: Value, a: float, v: float, r: float) -> Doing:
        return until_done(MoveAsk("p", cartesian(x), a, v, 0.0, r))

    def movec(*given: Value) -> Doing:
        via, to, a, v, r, mode = given
        return until_done(MoveAsk("c", cartesian(to), a, v, 0.0, r, cartesian(via), mode == 1))

    a, v, t, r = (
        lambda default: Taken("a", POSITIVE, default),
        lambda default: Taken("v", POSITIVE, default),
        Taken("t", ZERO_UP, 0.0),
        Taken("r", ZERO_UP, 0.0),
    )
    q, x = Taken("q", target), Taken("pose", target)
    yield builtin("movej", movej, q, a(1.4), v(1.05), t, r, takes_time=True)
    yield builtin("movel", movel, x, a(1.2), v(0.25), t, r, takes_time=True)
    yield builtin("movep", movep, x, a(1.2), v(0.25), r, takes_time=True)
    mode = Taken("mode", within(integer, 0, 1), 0)
    yield builtin("movec", movec, Taken("pose_via", target), Taken("pose_to", target), a(1.2), v(0.25), r, mode, takes_time=True)
    share = within(number, 1e-3, 1.0)
    top = robot.simulation.arm.limits

    def optimovej(q_: Value, a_: float, v_: float, r_: float) -> Doing:
        return movej(q_, a_ * min(top.acceleration), v_ * min(top.speed), 0.0, r_)

    def optimovel(x_: Value, a_: float, v_: float, r_: float) -> Doing:
        return movel(x_, a_ * 2.5, v_ * 1.0, 0.0, r_)

    yield builtin("optimovej", optimovej, q, Taken("a", share, 0.3), Taken("v", share, 0.3), r, takes_time=True)
    yield builtin("optimovel", optimovel, x, Taken("a", share, 0.3), Taken("v", share, 0.3), r, takes_time=True)
    for name in ("stopj", "stopl"):
        yield builtin(
            name, _stopping(until_done, name[-1]), Taken("a", POSITIVE), Taken("aRot", any_value, None), takes_time=True
        )


def _stopping(until_done: Callable[[Any], Doing], kind_: str) -> Callable[..., Doing]:
    return lambda a, turning: until_done(StopAsk(kind_, a))


def of_streams(robot: RobotSide) -> Iterator[Builtin]:
    """servoj, servoc, speedj, speedl: commands that are given again and again."""

    def for_time(ask: Any, seconds: float) -> Doing:
        robot.arm.ask(ask)
        for _ in range(max(round(min(seconds, MOST) * TICK_RATE), 1)):
            yield

    def servoj(*given: Value) -> Doing:
        q, _, _, t, lookahead, gain = given
        return for_time(ServoAsk(q, t, lookahead, gain), t)

    def servoc(x: Value, a: float, v: float, r: float) -> Doing:
        return for_time(CircleServoAsk(x, a, v, r), 0.0)

    def until_reached(ask: SpeedAsk) -> Doing:
        """Without a time, until the speed is there."""
        if ask.time > 0.0:
            yield from for_time(ask, ask.time)
            return
        number_ = robot.arm.ask(ask)
        field = "actual_qd" if ask.kind == "j" else "actual_TCP_speed"
        for _ in range(5 * TICK_RATE):
            now = robot.record.get(field)
            if robot.arm.done(number_) or math.dist(now, ask.speed) < HELD * 20:  # pyright: ignore[reportArgumentType]
                return
            yield

    def speedj(qd: Value, a: float, t: float) -> Doing:
        return until_reached(SpeedAsk("j", qd, a, t))

    def speedl(xd: Value, a: float, t: float, turning: Value) -> Doing:
        return until_reached(SpeedAsk("l", xd, a, t, a if turning is None else number(turning)))

    q = Taken("q", numbers(6))
    yield builtin(
        "servoj",
        servoj,
        q,
        Taken("a", ZERO_UP, 0.0),
        Taken("v", ZERO_UP, 0.0),
        Taken("t", ZERO_UP, 0.002),
        Taken("lookahead_time", within(number, 0.03, 0.2), 0.1),
        Taken("gain", within(number, 100.0, 2000.0), 300.0),
        takes_time=True,
    )
    a, t = Taken("a", POSITIVE), Taken("t", ZERO_UP, 0.0)
    blend = Taken("r", ZERO_UP, 0.0)
    yield builtin(
        "servoc", servoc, Taken("pose", target), Taken("a", POSITIVE, 1.2), Taken("v", POSITIVE, 0.25), blend, takes_time=True
    )
    yield builtin("speedj", speedj, Taken("qd", numbers(6)), a, t, takes_time=True)
    yield builtin("speedl", speedl, Taken("xd", numbers(6)), a, t, Taken("aRot", any_value, None), takes_time=True)


def of_force(robot: RobotSide) -> Iterator[Builtin]:
    """force_mode and tool_contact."""
    damping, scaling = [0.025], [1.0]

    def force_mode(*given: Value) -> None:
        frame, selection, wrench, type_, limits = given
        if any(each not in (0, 1) for each in selection):
            raise Misuse("selection_vector: expected six of 0 and 1")
        chosen = tuple(bool(each) for each in selection)
        robot.arm.ask(ForceAsk(frame, chosen, wrench, type_, limits, damping[0], scaling[0]))

    yield builtin(
        "force_mode",
        force_mode,
        Taken("task_frame", pose),
        Taken("selection_vector", numbers(6)),
        Taken("wrench", numbers(6)),
        Taken("type", within(integer, 1, 3)),
        Taken("limits", numbers(6)),
    )
    yield builtin("end_force_mode", lambda: _asked(robot, ForceEndAsk()))
    yield builtin("force_mode_set_damping", lambda d: damping.__setitem__(0, d), Taken("damping", within(number, 0.0, 1.0)))
    yield builtin("force_mode_set_gain_scaling", lambda s: scaling.__setitem__(0, s), Taken("scaling", within(number, 0.0, 2.0)))
    yield builtin("tool_contact", lambda d: robot.arm.steps_back(tuple(d)), Taken("direction", numbers(6), (0.0,) * 6))


def of_free_drive(robot: RobotSide) -> Iterator[Builtin]:
    """freedrive_mode and teach_mode."""

    def free(axes: Value, feature: Value) -> None:
        if len(axes) != 6 or any(each not in (0, 1) for each in axes):
            raise Misuse("freeAxes: expected six of 0 and 1")
        frame = None
        if type(feature) is str:
            if feature not in ("base", "tool"):
                raise Misuse(f'feature: {feature!r}; expected "base", "tool" or a pose')
            if feature == "tool":
                frame = pose(PoseValue(robot.record.get("actual_TCP_pose")))  # pyright: ignore[reportArgumentType]
        else:
            frame = pose(feature)
        robot.arm.ask(FreeDriveAsk(tuple(bool(each) for each in axes), frame))

    axes = Taken("freeAxes", items, (1, 1, 1, 1, 1, 1))
    yield builtin("freedrive_mode", free, axes, Taken("feature", any_value, "base"))
    yield builtin("teach_mode", lambda: _asked(robot, FreeDriveAsk()))
    yield builtin("end_freedrive_mode", lambda: _asked(robot, FreeDriveEndAsk()))
    yield builtin("end_teach_mode", lambda: _asked(robot, FreeDriveEndAsk()))
    yield builtin("get_freedrive_status", robot.arm.free_drive_status)


def _asked(robot: RobotSide, ask: Any) -> None:
    robot.arm.ask(ask)


def of_set_up(robot: RobotSide) -> Iterator[Builtin]:
    """Payload, tool centre point, sensor, watchdog, stops."""
    cog = Taken("cog", numbers(3))
    mass = Taken("m", within(number, 0.0, 100.0))
    now = Taken("transition_time", ZERO_UP, 0.0)

    def payload(m: float, c: Value = None, inertia: Value = None, transition: float = 0.0) -> None:
        centre = tuple(robot.record.get("payload_cog")) if c is None else c  # pyright: ignore[reportArgumentType]
        robot.command("payload", mass=m, cog=centre, inertia=inertia, transition=transition)

    yield builtin("set_payload", payload, mass, Taken("cog", _centre, None))
    yield builtin("set_payload_mass", payload, mass)
    yield builtin("set_payload_cog", lambda c: payload(float(robot.record.get("payload")), c), cog)  # pyright: ignore[reportArgumentType]
    yield builtin("set_target_payload", payload, mass, cog, Taken("inertia", numbers(6), (0.0,) * 6), now)
    name = Taken("tcp_name", any_value, "")
    yield builtin("set_tcp", lambda x, n: robot.command("tcp", pose=x), Taken("pose", pose), name)
    yield builtin("zero_ftsensor", lambda: robot.command("zero"))
    yield builtin("protective_stop", lambda: robot.command("protective_stop"))
    yield builtin("set_gravity", lambda d: robot.command("gravity", gravity=d), Taken("d", numbers(3)))
    action = Taken("action", any_value, "pause")
    yield builtin(
        "rtde_set_watchdog",
        lambda n, f, act: robot.command("watchdog", name=n, frequency=f, action=act),
        Taken("variable_name", any_value),
        Taken("min_frequency", within(number, 0.0, 500.0)),
        action,
    )
    three = numbers(3)
    sensor = (
        Taken("enable", boolean),
        Taken("sensor_mass", ZERO_UP, 0.0),
        Taken("sensor_measuring_offset", three, (0.0,) * 3),
        Taken("sensor_cog", three, (0.0,) * 3),
    )
    for each in ("ft_rtde_input_enable", "enable_external_ft_sensor"):
        yield builtin(each, lambda *given: robot.command("external_sensor", enable=given[0]), *sensor)


def _centre(value: Value) -> Value:
    return None if value is None else numbers(3)(value)
