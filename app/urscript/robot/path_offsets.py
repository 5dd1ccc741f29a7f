"""Where the arm of a script goes beside its motions: at an offset that the program sets, or with a conveyor."""

import math
from collections.abc import Callable
from enum import IntEnum
from typing import Protocol

from app.urscript.calculation.pose_algebra import inverted, quaternion, transformed, turned
from app.urscript.language.trouble import Misuse
from app.urscript.machine.values import PoseValue
from app.urscript.robot.encoders import Encoder
from pendant.motion.script_requests import PathOffset
from pendant.tick.modes import TICK

MOST_WAY, MOST_TURN = 0.1, 0.52
"""Of an offset along and about an axis, before a program says otherwise [m, rad] (manual, path_offset_set_max_offset)."""

BANDWIDTH = 15.0
"""With which the arm takes a conveyor's speed over: counts come in steps [rad/s]."""

FLAT = math.exp(-BANDWIDTH * TICK)


class OffsetFrame(IntEnum):
    """In which an offset counts."""

    BASE = 1
    TOOL = 2
    WAY = 3
    BASE_INVERTED = 4


NONE = PoseValue((0.0,) * 6)


class Conveyor(Protocol):
    """What the arm follows."""

    def offset(self) -> PathOffset:
        """Of the tick that begins."""
        ...


class Travel:
    """How far a conveyor has come since it is followed, by its encoder; at an even speed without delay.

        x <- x + v T + g (z - x),    v <- v + h/T (z - x),    g = 1 - b², h = (1 - b)², b = exp(-w T)

    Source: a critically damped g-h filter (E. Brookner, Tracking and Kalman Filtering Made Easy).

    Args:
        encoder: of the conveyor.
        around: counts after which it begins again, where that is sooner than its range's end; 0: it is not.
    """

    def __init__(self, encoder: Encoder, around: float = 0.0) -> None:
        self._encoder, self._around, self._last = encoder, around, encoder.count
        self._sum = self._way = self._speed = 0.0

    def step(self) -> float:
        """Ticks since the begin, in the tick that begins."""
        count = self._encoder.count
        change, self._last = self._encoder.unwound(float(count - self._last)), count
        if self._around and abs(change) > 0.5 * self._around:
            change = math.remainder(change, self._around)
        self._sum += change
        ahead = self._way + self._speed * TICK
        missing = self._sum - ahead
        self._way = ahead + (1.0 - FLAT**2) * missing
        self._speed += (1.0 - FLAT) ** 2 / TICK * missing
        return self._way


class LinearConveyor:
    """Goes straight.

    Args:
        encoder: of it.
        direction: in axes of the base, of any length but 0 (3,).
        ticks: of the encoder for a metre.
    """

    def __init__(self, encoder: Encoder, direction: tuple[float, ...], ticks: float) -> None:
        length = math.hypot(*direction)
        if length == 0.0:
            raise Misuse("direction: [0, 0, 0] is no direction")
        x, y, z = direction
        factor = 1.0 / (length * ticks)
        self._travel, self._step = Travel(encoder), (x * factor, y * factor, z * factor)

    def offset(self) -> PathOffset:
        """Of the tick that begins."""
        way, (x, y, z) = self._travel.step(), self._step
        return PathOffset(position=(way * x, way * y, way * z), turn=(0.0, 0.0, 0.0))


class CircularConveyor:
    """Turns about the z axis of a pose.

    Args:
        encoder: of it.
        centre: the pose, in the base.
        ticks: of the encoder for a revolution.
        turns_tool: the tool turns with it.
    """

    def __init__(self, encoder: Encoder, centre: PoseValue, ticks: float, turns_tool: bool) -> None:
        self._travel, self._centre, self._turns = Travel(encoder, around=ticks), centre, turns_tool
        self._step = tuple(2.0 * math.pi / ticks * value for value in turned(quaternion(centre[3:]), (0.0, 0.0, 1.0)))

    def offset(self) -> PathOffset:
        """Of the tick that begins."""
        way = self._travel.step()
        x, y, z = self._step
        turn = (way * x, way * y, way * z)
        moved = turned(quaternion(turn), self._centre[:3])
        cx, cy, cz = (a - b for a, b in zip(self._centre[:3], moved, strict=True))
        return PathOffset(position=(cx, cy, cz), turn=turn, turns_tool=self._turns)


class PathOffsets:
    """Of the program that runs.

    Args:
        ask: has the arm go at an offset until it is asked for another; None: on its way.
        pushes: tells whether the arm pushes while it moves.

    Attributes:
        enabled: the program's offset is added.
        conveyor: that is followed.
    """

    def __init__(self, ask: Callable[[PathOffset | None], None], pushes: Callable[[], bool]) -> None:
        self._ask, self._pushes = ask, pushes
        self.reset()

    def reset(self) -> None:
        """No program runs any more."""
        self.enabled = False
        self.conveyor: Conveyor | None = None
        self._most, self._share = (MOST_WAY, MOST_TURN), 1.0
        self._frame, self._target, self._now = OffsetFrame.BASE, NONE, NONE

    @property
    def used(self) -> bool:
        """The arm goes beside its motions, or will."""
        return self.enabled or self.conveyor is not None

    def enable(self) -> None:
        """Add the program's offset, from none on."""
        if self.conveyor is not None:
            raise Misuse("a conveyor is tracked: stop_conveyor_tracking() first")
        self._check()
        if not self.enabled:
            self.enabled, self._now = True, NONE

    def follow(self, conveyor: Conveyor) -> None:
        """Go with a conveyor."""
        if self.enabled:
            raise Misuse("the path has an offset: path_offset_disable() first")
        self._check()
        self.conveyor = conveyor

    def _check(self) -> None:
        if self._pushes():
            raise Misuse("force_mode() is on: end_force_mode() first")

    def end(self) -> None:
        """Go on the way of the motions."""
        if self.used:
            self._ask(None)
        self.enabled, self.conveyor, self._now = False, None, NONE

    def aim(self, offset: PoseValue, frame: OffsetFrame) -> None:
        """What the offset is to become."""
        if frame is not self._frame:
            self._now = NONE
        self._target, self._frame = offset, frame

    def soften(self, share: float) -> None:
        """Of what is missing of the offset, so much is added in a tick."""
        self._share = share

    def limit(self, way: float, turn: float) -> None:
        """How far the offset may go along and about an axis."""
        self._most = (way, turn)

    def now(self, frame: OffsetFrame, place: PoseValue, way: PoseValue) -> PoseValue:
        """The offset in a frame; `place`: the motion's tool pose, `way`: axes of its way at that place."""
        if frame is self._frame:
            return self._now
        origins = {OffsetFrame.TOOL: place, OffsetFrame.WAY: way}
        moved = inverted(self._now) if self._frame is OffsetFrame.BASE_INVERTED else self._now
        if self._frame in origins:
            origin = origins[self._frame]
            moved = transformed(transformed(origin, moved), inverted(origin))
        if frame in origins:
            origin = origins[frame]
            return transformed(transformed(inverted(origin), moved), origin)
        return inverted(moved) if frame is OffsetFrame.BASE_INVERTED else moved

    def step(self) -> None:
        """One tick in which the script runs."""
        if self.conveyor is not None:
            self._ask(self.conveyor.offset())
        elif self.enabled:
            wanted = [max(-most, min(value, most)) for value, most in zip(self._target, self._limits(), strict=True)]
            self._now = PoseValue(now + self._share * (value - now) for now, value in zip(self._now, wanted, strict=True))
            x, y, z, a, b, c = inverted(self._now) if self._frame is OffsetFrame.BASE_INVERTED else self._now
            frame = "tool" if self._frame is OffsetFrame.TOOL else "way" if self._frame is OffsetFrame.WAY else "base"
            self._ask(PathOffset(frame=frame, position=(x, y, z), turn=(a, b, c)))

    def _limits(self) -> tuple[float, ...]:
        way, turn = self._most
        return (way, way, way, turn, turn, turn)
