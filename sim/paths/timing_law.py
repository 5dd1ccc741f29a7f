"""Time law along a way: from where a motion is, to rest at the end of its way, within speed, acceleration and jerk."""

import math
from collections.abc import Callable
from typing import NamedTuple

HALVINGS = 200
"""Of a bracket of speeds; a double has no more between 0 and itself that matter."""

HAIR = 1e-9
"""By which share a way may be too short to stop on it: a motion on its way to rest is as long as that, within rounding."""


ROUNDING = 1e-12
"""Share of a way that is not gone on with at the highest speed: where that is next to nothing, it would take seconds."""


class MoveRefused(ValueError):
    """A move cannot be done; the text says why, with value and limit."""


class TooShort(MoveRefused):
    """A moving start is too fast for the way that is left."""


class PathState(NamedTuple):
    """Of a motion along its way."""

    s: float  # way [m], or share of it
    v: float  # speed
    a: float  # acceleration


REST = PathState(0.0, 0.0, 0.0)


class Limits(NamedTuple):
    """Of speed, acceleration and jerk along a way, each more than 0."""

    speed: float
    acceleration: float
    jerk: float

    def slower(self, share: float) -> "Limits":
        """Those of the same motion with a `share` of its speed everywhere: it takes 1 / share of the time."""
        return Limits(share * self.speed, share**2 * self.acceleration, share**3 * self.jerk)


class Jerked(NamedTuple):
    """A while of constant jerk, and the state at an instant, which need not be in it."""

    until: float  # [s]
    instant: float  # [s]
    at: PathState
    jerk: float


class TimingLaw:
    """The way along a path over time (double S): to a highest speed, on at that speed, and to rest, each as quickly as it may.

    All follows from the highest speed. From rest a change of speed by V takes the time V/a + a/j, or 2 sqrt(V/j) where V is
    below a²/j, and covers V/2 times that; so the highest speed is the root of a square, or of a cube. From a moving start, the
    way is a continuous function of the highest speed, which is halved down to its root: it has one wherever the motion can stop
    at its end. What is left of the way then is gone at the highest speed. So there is a law for every way.

    Source: Biagiotti and Melchiorri, Trajectory Planning for Automatic Machines and Robots (2008), 3.4.

    Attributes:
        duration: from begin to rest [s].
        length: where it ends.
        level: where it has come to its highest speed, or down to it.
    """

    __slots__ = ("_whiles", "duration", "length", "level")

    def __init__(self, length: float, limits: Limits, begin: PathState = REST) -> None:
        """`length`: where it ends, on the same scale as the begin.

        Raises:
            MoveRefused: a number is none, or a limit is not more than 0.
            TooShort: the motion cannot stop at its end from its begin.
        """
        way = length - begin.s
        if not (math.isfinite(length + sum(begin) + sum(limits)) and min(limits) > 0.0 and way >= 0.0):
            raise MoveRefused(f"no motion by {way:g} with speed {limits.speed:g} and acceleration {limits.acceleration:g}")
        self.length = length
        if begin.v == 0.0 and begin.a == 0.0:
            highest = _from_rest(way, limits)
        else:
            highest = _from_motion(way, limits, begin)
        rise = _change(begin.v, begin.a, highest, limits)
        fall = _change(0.0, 0.0, highest, limits)
        risen = _way(begin.v, begin.a, rise)
        left, self.level = way - risen - _way(0.0, 0.0, fall), begin.s + risen
        even = left / highest if left > ROUNDING * way else 0.0
        self.duration = sum(time for time, _ in rise) + even + sum(time for time, _ in fall)
        whiles, now, state = [], 0.0, begin
        for time, jerk in (*rise, (even, 0.0)):
            whiles.append(Jerked(now + time, now, state, jerk))
            now, state = now + time, _after(state, time, jerk)
        # The way to rest is that of the same change of speed backwards, and is told from its end: it ends there exactly.
        falling, back, state = [], 0.0, PathState(length, 0.0, 0.0)
        for time, jerk in fall:
            falling.append(Jerked(self.duration - back, self.duration - back, state, jerk))
            back, state = back + time, _after(state, -time, jerk)
        self._whiles = (*whiles, *reversed(falling))

    def glances(self, apart: float, most: int) -> list[float]:
        """Times, `apart` at most [s], but no more than `most` while its jerk is the same."""
        times, begin = [0.0], 0.0
        for until, *_ in self._whiles:
            count = min(math.ceil((until - begin) / apart), most)
            times += [begin + k / count * (until - begin) for k in range(1, count + 1)]
            begin = until
        return times

    def at(self, time: float) -> PathState:
        """Where it is `time` after its begin [s]; after its end, there."""
        if time >= self.duration:
            return PathState(self.length, 0.0, 0.0)
        for until, instant, (s, v, a), jerk in self._whiles:
            if time < until:
                # As `_after`, which costs half as much again: this is done in every tick.
                t = time - instant
                return PathState(s + t * (v + t * (0.5 * a + t * jerk / 6.0)), v + t * (a + 0.5 * t * jerk), a + t * jerk)
        return PathState(self.length, 0.0, 0.0)


def _after(state: PathState, time: float, jerk: float) -> PathState:
    s, v, a = state
    return PathState(s + time * (v + time * (0.5 * a + time * jerk / 6.0)), v + time * (a + 0.5 * time * jerk), a + time * jerk)


def _from_rest(way: float, limits: Limits) -> float:
    """The highest speed from rest to rest."""
    speed, acceleration, jerk = limits
    full = acceleration**2 / jerk  # the change of speed that just reaches the acceleration
    if way <= 2.0 * full * acceleration / jerk:
        highest = (0.5 * way * math.sqrt(jerk)) ** (2.0 / 3.0)
    else:
        ramp = acceleration / jerk
        # The root of V²/a + V a/j = way, in the form that does not cancel.
        highest = 2.0 * way / (ramp + math.sqrt(ramp**2 + 4.0 * way / acceleration))
    return min(highest, speed)


def _from_motion(way: float, limits: Limits, begin: PathState) -> float:
    """The highest speed from a moving start; where the way is too short for that, the speed that it slows down to first.

    Raises:
        TooShort: the motion cannot stop at its end.
    """

    def gone(highest: float) -> float:
        rise, fall = _change(begin.v, begin.a, highest, limits), _change(0.0, 0.0, highest, limits)
        return _way(begin.v, begin.a, rise) + _way(0.0, 0.0, fall)

    easing = begin.v + 0.5 * begin.a * abs(begin.a) / limits.jerk  # its speed once its acceleration is gone
    if min(begin.v, easing) < -HAIR * limits.speed or gone(0.0) > way + HAIR * way:
        raise TooShort(f"it cannot stop within {way:g} from a speed of {begin.v:g}")
    if gone(limits.speed) <= way:
        return limits.speed
    least = min(easing, limits.speed)
    return _root(gone, way, least, limits.speed) if gone(least) <= way else _root(gone, way, 0.0, least)


def _root(gone: Callable[[float], float], way: float, low: float, high: float) -> float:
    """A speed between both, whose way is `way` or a hair less; at `low` it is not more, at `high` not less."""
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        if middle in (low, high):
            break
        low, high = (middle, high) if gone(middle) <= way else (low, middle)
    return low


def _change(v: float, a: float, to: float, limits: Limits) -> tuple[tuple[float, float], ...]:
    """The quickest change from speed v and acceleration a to the speed `to`: times [s], each with its jerk.

    The acceleration goes to a peak, stays there, and goes to 0. With p the peak without a limit, p² = j |V| + a²/2.
    """
    _, most, jerk = limits
    sign = 1.0 if to - v - 0.5 * a * abs(a) / jerk >= 0.0 else -1.0
    missing, a = sign * (to - v), sign * a
    peak = min(math.sqrt(max(jerk * missing + 0.5 * a * a, 0.0)), most)
    first = peak - a  # an acceleration beyond its limit goes down to it
    covered = 0.5 * (abs(first) * (peak + a) + peak * peak) / jerk
    hold = max(missing - covered, 0.0) / peak if peak == most else 0.0
    return (abs(first) / jerk, sign * math.copysign(jerk, first)), (hold, 0.0), (peak / jerk, -sign * jerk)


def _way(v: float, a: float, change: tuple[tuple[float, float], ...]) -> float:
    state = PathState(0.0, v, a)
    for time, jerk in change:
        state = _after(state, time, jerk)
    return state.s
