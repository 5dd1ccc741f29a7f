"""Functions that set up the robot and its compliance: payload, tool, sensor, stops, hand guiding, force (URScript manual)."""

from collections.abc import Iterator
from contextlib import suppress
from typing import Literal

from app.urscript.calculation.pose_algebra import quaternion
from app.urscript.functions.motions import ZERO_UP, Doing, placed
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
    text,
    within,
)
from app.urscript.machine.values import PoseValue, Value
from app.urscript.robot.robot_side import RobotSide
from pendant.motion.script_requests import ForceMode, Guided
from pendant.tick.pose import rotation

OF_WISH = 30
"""Cost of a request for hand guiding, in evaluator steps."""


def of_set_up(robot: RobotSide) -> Iterator[Builtin]:
    """Payload, tool centre point, sensor, watchdog, stops."""
    cog = Taken("cog", numbers(3))
    mass = Taken("m", within(number, 0.0, 100.0))
    now = Taken("transition_time", ZERO_UP, 0.0)

    def payload(m: float, c: Value = None, inertia: Value = None, transition: float = 0.0) -> Doing:
        centre = tuple(robot.record.get("payload_cog")) if c is None else c  # pyright: ignore[reportArgumentType]
        return robot.equip("payload", mass=m, cog=centre, inertia=inertia, transition=transition)

    def zeroed(m: float, c: Value = None) -> Doing:
        """Set the payload and zero the displayed force, as a robot does (URScript manual, set_payload)."""
        yield from payload(m, c)
        with suppress(Misuse):  # the payload is set even if the sensor has no valid value
            yield from robot.arm.zero_reading()

    def centre(c: Value) -> Doing:
        return payload(float(robot.record.get("payload")), c)  # pyright: ignore[reportArgumentType]

    yield builtin("set_payload", zeroed, mass, Taken("cog", _centre, None), takes_time=True)
    yield builtin("set_payload_mass", zeroed, mass, takes_time=True)
    yield builtin("set_payload_cog", centre, cog, takes_time=True)
    inertia = Taken("inertia", numbers(6), (0.0,) * 6)
    yield builtin("set_target_payload", payload, mass, cog, inertia, now, takes_time=True)
    name = Taken("tcp_name", any_value, "")
    yield builtin("set_tcp", lambda x, n: robot.equip("tcp", pose=x), Taken("pose", pose), name, takes_time=True)
    yield builtin("zero_ftsensor", robot.arm.zero, takes_time=True)
    yield builtin("protective_stop", lambda: robot.command("protective_stop"))
    yield builtin("set_gravity", lambda d: robot.command("gravity", gravity=d), Taken("d", numbers(3)))
    action = Taken("action", text, "pause")
    yield builtin(
        "rtde_set_watchdog",
        lambda n, f, act: robot.command("watchdog", name=n, frequency=f, action=act),
        Taken("variable_name", text),
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


def of_free_drive(robot: RobotSide) -> Iterator[Builtin]:
    """freedrive_mode and teach_mode."""

    def free(axes: Value, feature: Value) -> None:
        if len(axes) != 6 or any(each not in (0, 1) for each in axes):
            raise Misuse("freeAxes: expected six of 0 and 1")
        chosen = tuple(bool(each) for each in axes)
        if type(feature) is str:
            if feature not in ("base", "tool"):
                raise Misuse(f'feature: {feature!r}; expected "base", "tool" or a pose')
            pose_ = robot.record.get("actual_TCP_pose") if feature == "tool" else (0.0,) * 6
        else:
            pose_ = pose(feature)
        robot.arm.ask(Guided(axes=chosen, R_BU=rotation(quaternion(tuple(pose_[3:])))))  # pyright: ignore[reportIndexIssue]

    axes = Taken("freeAxes", items, (1, 1, 1, 1, 1, 1))
    yield builtin("freedrive_mode", free, axes, Taken("feature", any_value, "base"), cost=OF_WISH)
    for name in ("teach_mode", "freedrive_mode_no_incorrect_payload_check"):  # the payload is checked in both
        yield builtin(name, lambda: _guided(robot))
    yield builtin("end_freedrive_mode", robot.arm.leave)
    yield builtin("end_teach_mode", robot.arm.leave)
    yield builtin("get_freedrive_status", robot.arm.free_drive_status)


def _guided(robot: RobotSide) -> None:
    robot.arm.ask(Guided())


def _centre(value: Value) -> Value:
    return None if value is None else numbers(3)(value)


USUAL_DAMPING = 0.025
"""Damping of force mode if the program sets none: the default of a UR (ROS driver, SetForceMode)."""

TURNS: tuple[Literal["to_origin", "not", "with_motion"], ...] = ("to_origin", "not", "with_motion")
"""How the frame of force_mode turns, by its type 1 to 3."""


def of_force(robot: RobotSide) -> Iterator[Builtin]:
    """force_mode and tool_contact."""
    gain: list[float] = [1.0]
    damping: list[float | None] = [None]  # both are kept until they are set again

    def force_mode(frame: PoseValue, *given: Value) -> None:
        selection, wrench, type_, limits = given
        if any(each not in (0, 1) for each in selection):
            raise Misuse("selection_vector: expected six of 0 and 1")
        position, turned = placed(frame)
        free = tuple(bool(each) for each in selection)
        try:
            force = ForceMode(
                free=free,
                wrench=wrench,
                limits=limits,
                origin=position,
                R_BU=rotation(turned),
                turns=TURNS[type_ - 1],
                gain=gain[0],
                damping=damping[0],
            )
        except ValueError as error:
            raise Misuse(str(error)) from None
        robot.arm.push(force)

    def scale(scaling: float) -> None:
        gain[0] = scaling

    def damp(share: float) -> None:
        damping[0] = share

    yield builtin(
        "force_mode",
        force_mode,
        Taken("task_frame", pose),
        Taken("selection_vector", numbers(6)),
        Taken("wrench", numbers(6)),
        Taken("type", within(integer, 1, 3)),
        Taken("limits", numbers(6)),
    )
    yield builtin("end_force_mode", lambda: robot.arm.push(None))
    yield builtin("force_mode_set_damping", damp, Taken("damping", within(number, 0.0, 1.0)))
    yield builtin("force_mode_get_damping", lambda: USUAL_DAMPING if damping[0] is None else damping[0])
    yield builtin("force_mode_get_gain_scaling", lambda: gain[0])
    yield builtin("force_mode_set_gain_scaling", scale, Taken("scaling", within(number, 0.0, 2.0)))
    yield builtin("tool_contact", lambda d: robot.arm.steps_back(d), Taken("direction", numbers(6), (0.0,) * 6))
