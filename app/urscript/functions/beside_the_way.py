"""Functions for paths with an offset, for conveyors and their encoders (URScript manual, module motion)."""

import math
from collections.abc import Callable, Generator, Iterator
from functools import partial

import numpy as np

from app.urscript.calculation.pose_algebra import quaternion, turned
from app.urscript.functions.motions import POSITIVE, controlling
from app.urscript.language.trouble import Misuse
from app.urscript.machine.signature import Builtin, Taken, boolean, builtin, integer, number, pose, within
from app.urscript.machine.values import PoseValue, Value
from app.urscript.robot.encoders import RANGES, Decoder, Encoder
from app.urscript.robot.path_offsets import CircularConveyor, LinearConveyor, OffsetFrame
from app.urscript.robot.robot_side import RobotSide
from pendant.program.steps import GentleStop
from sim.arm.frames import cross, rotation_vector

Doing = Generator[None, None, Value]

SLOWING = 20.0
"""Deceleration if a program gives none [rad/s²] (URScript manual)."""

STANDING = 1e-3
"""Below this speed the tool's motion has no usable direction [m/s]."""


def of_path_offsets(robot: RobotSide) -> Iterator[Builtin]:
    """path_offset_*, and pose and speed of the motion without its offset."""
    offsets = robot.arm.offsets

    def along() -> tuple[PoseValue, tuple[float, ...]]:
        """Pose and speed of the tool along the motion, without the offset."""
        simulation = robot.simulation
        own = simulation.controller.references.own
        q, qd = (simulation.estimate.q, simulation.estimate.qd * 0.0) if own is None else (own.q, own.qd)
        p, R, v, w = simulation.dynamics.flange_motion(q, qd)
        lever = R @ simulation.tcp
        place = PoseValue((*(p + lever).tolist(), *rotation_vector(R @ simulation.R_FT).tolist()))
        return place, (*(v + cross(w, lever)).tolist(), *w.tolist())

    def now(frame: int) -> PoseValue:
        place, speed = along()
        return offsets.now(OffsetFrame(frame), place, _way_frame(place, speed[:3]))

    frame = Taken("type", within(integer, 1, 4))
    yield builtin("path_offset_enable", _taking_a_tick(offsets.enable), physical=True)
    yield builtin("path_offset_disable", _leaving(robot), Taken("a", POSITIVE, SLOWING), physical=True)
    yield builtin("path_offset_set", lambda offset, kind: offsets.aim(offset, OffsetFrame(kind)), Taken("offset", pose), frame)
    yield builtin("path_offset_get", now, frame)
    yield builtin("path_offset_set_alpha_filter", offsets.soften, Taken("alpha", within(number, 1e-6, 1.0)))
    most = within(number, 0.0, 10.0)
    yield builtin("path_offset_set_max_offset", offsets.limit, Taken("transLimit", most), Taken("rotLimit", most))
    yield builtin("get_target_tcp_pose_along_path", lambda: along()[0])
    yield builtin("get_target_tcp_speed_along_path", lambda: along()[1])


def of_conveyors(robot: RobotSide) -> Iterator[Builtin]:
    """track_conveyor_*."""

    def encoder_of(index: int) -> Encoder:
        encoder = robot.memory.encoders[index]
        if not encoder.ready:
            raise Misuse(f"encoder {index} is not set up: encoder_enable_pulse_decode() or encoder_enable_set_tick_count() first")
        return encoder

    def linear(direction: PoseValue, ticks: float, index: int) -> None:
        robot.arm.offsets.follow(LinearConveyor(encoder_of(index), direction[:3], ticks))

    def circular(*given: Value) -> None:
        centre, ticks, turns, index = given
        robot.arm.offsets.follow(CircularConveyor(encoder_of(index), centre, ticks, turns))

    index = Taken("encoder_index", within(integer, 0, 1), 0)
    ticks = within(number, 1e-3, 1e9)
    yield builtin(
        "track_conveyor_linear",
        _taking_a_tick(linear),
        Taken("direction", pose),
        Taken("ticks_per_meter", ticks),
        index,
        physical=True,
    )
    yield builtin(
        "track_conveyor_circular",
        _taking_a_tick(circular),
        Taken("center", pose),
        Taken("ticks_per_revolution", ticks),
        Taken("rotate_tool", boolean, False),
        index,
        physical=True,
    )
    yield builtin("stop_conveyor_tracking", _leaving(robot), Taken("a", POSITIVE, SLOWING), physical=True)


def of_encoders(robot: RobotSide) -> Iterator[Builtin]:
    """encoder_*, and the older names of these functions."""
    encoders = robot.memory.encoders

    def decode(index: int, decoder: int, a: int, b: int) -> None:
        if a == b and decoder == Decoder.QUADRATURE:
            raise Misuse(f"A and B: both are input {a}")
        encoders[index].decode(Decoder(decoder), (a, b))

    def tell(index: int, count: int) -> None:
        if not encoders[index].told:
            raise Misuse(f"encoder {index} is not told its count: encoder_enable_set_tick_count() first")
        encoders[index].tell(count)

    def tell_first(count: int, range_: int) -> None:
        if not encoders[0].told:
            encoders[0].be_told(range_)
        encoders[0].tell(count)

    index, pin = Taken("encoder_index", within(integer, 0, 1)), within(integer, 0, 3)
    a, b = Taken("A", pin), Taken("B", pin)
    decoder, range_ = within(integer, 0, len(Decoder) - 1), within(integer, 0, len(RANGES) - 1)
    yield builtin("encoder_enable_pulse_decode", decode, index, Taken("decoder_type", decoder), a, b)
    yield builtin("conveyor_pulse_decode", partial(decode, 0), Taken("type", decoder), a, b)
    yield builtin("encoder_enable_set_tick_count", lambda i, kind: encoders[i].be_told(kind), index, Taken("range_id", range_))
    yield builtin("encoder_set_tick_count", tell, index, Taken("count", integer))
    yield builtin(
        "set_conveyor_tick_count",
        tell_first,
        Taken("tick_count", integer),
        Taken("absolute_encoder_resolution", range_, 0),
    )
    yield builtin("encoder_get_tick_count", lambda i: float(encoders[i].count), index)
    yield builtin("get_conveyor_tick_count", lambda: float(encoders[0].count))
    yield builtin(
        "encoder_unwind_delta_tick_count",
        lambda i, change: encoders[i].unwound(change),
        index,
        Taken("delta_tick_count", number),
    )


def _way_frame(place: PoseValue, v: tuple[float, ...]) -> PoseValue:
    """Place of the tool, with x along its motion and y = x × the tool's z; if the tool stands, x is the tool's x."""
    turn = quaternion(place[3:])
    speed = math.hypot(*v)
    x = np.array(v) / speed if speed > STANDING else np.array(turned(turn, (1.0, 0.0, 0.0)))
    y = cross(x, np.array(turned(turn, (0.0, 0.0, 1.0))))
    size = float(np.linalg.norm(y))
    y = y / size if size > STANDING else np.array(turned(turn, (0.0, 1.0, 0.0)))
    return PoseValue((*place[:3], *rotation_vector(np.column_stack((x, y, cross(x, y)))).tolist()))


def _taking_a_tick(work: Callable[..., None]) -> Callable[..., Doing]:
    """Do `work`, which takes effect with the next tick."""

    def taking(*given: Value) -> Doing:
        work(*given)
        yield

    return taking


def _leaving(robot: RobotSide) -> Callable[..., Doing]:
    """Come to rest; then the motions have no offset any more."""

    def leave(a: float) -> Doing:
        robot.arm.offsets.end()
        with controlling(robot.arm):
            number_ = robot.arm.ask(GentleStop(of="joints", deceleration=a))
            try:
                while not robot.arm.done(number_):
                    yield
            finally:
                robot.arm.drop(number_)

    return leave
