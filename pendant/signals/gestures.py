"""Signals known by their course in time: pushes or presses in a row, a force step, a tap, turned joints (FD-5f to FD-5i)."""

from collections.abc import Sequence

from pendant.settings.schema import ticks
from pendant.signals.settings import ForceStep, PostureSignalUse, PressPattern, PushPattern, TapSettings, Turn


class PatternSignal:
    """Push, release, push: each push and each gap within limits. Whole when the last push has ended."""

    __slots__ = ("_length", "_present", "_pushes")

    def __init__(self) -> None:
        self._pushes = 0  # good ones in a row
        self._length = 0  # ticks since the last change
        self._present = False

    def step(self, present: bool, use: PushPattern | PressPattern) -> bool:
        """One tick of the push that it is made of. True in the tick in which it is whole."""
        longest = ticks(use.longest)
        if present is self._present:
            self._length = min(self._length, longest) + 1
            return False
        good = ticks(use.shortest) <= self._length <= longest
        self._present, self._length = present, 1
        if present:
            if not good:
                self._pushes = 0
            return False
        self._pushes = self._pushes + 1 if good else 0
        if self._pushes < int(use.count):
            return False
        self._pushes = 0
        return True


LONG_AGO = ticks(1000.0)
"""More ticks than a force may rise for: it was not looked at before."""


class StepSignal:
    """The force rises within a short time, and the arm was at rest for a while before."""

    __slots__ = ("_rising", "present")

    QUIET = 3.0  # a smaller change is none [N]

    def __init__(self) -> None:
        self.present = False
        self._rising = LONG_AGO  # ticks since the force was quiet

    def step(self, force: float, quiet: int, use: ForceStep) -> bool:
        """One tick.

        Args:
            force: size of its change from the untouched state [N].
            quiet: ticks for which nothing else could have changed it.
            use: settings.
        """
        self._rising = 0 if force < self.QUIET else self._rising + 1
        if self.present:
            self.present = force > 0.75 * use.threshold
        else:
            self.present = force > use.threshold and self._rising <= ticks(use.rise) and quiet >= ticks(use.quiet)
        return self.present


class TapSignal:
    """A short acceleration, whole when it has been gone for as long as it may last."""

    __slots__ = ("_length", "_quiet")

    def __init__(self) -> None:
        self._length = 0  # ticks since it began, 0: nothing
        self._quiet = 0  # ticks without

    def step(self, acceleration: float, use: TapSettings) -> bool:
        """One tick; `acceleration` beyond gravity [m/s²]. True in the tick in which it is whole."""
        longest = ticks(use.longest)
        if acceleration > use.threshold:
            self._length = min(self._length + self._quiet, longest) + 1
            self._quiet = 0
            return False
        if self._length == 0:
            return False
        self._quiet += 1
        if self._quiet < longest:
            return False
        whole = self._length <= longest
        self._length = self._quiet = 0
        return whole


class TurnSignal:
    """A joint turned away from where it is held."""

    __slots__ = ("_held", "_joint", "present")

    def __init__(self) -> None:
        self._held: float | None = None  # its angle [rad]
        self._joint = 0.0  # which one it is
        self.present = False

    def step(self, angle: float, holding: bool, use: Turn) -> bool:
        """One tick; `angle` of the joint [rad]."""
        if not holding or self._held is None or use.joint != self._joint:
            self._held, self._joint = angle, use.joint
        self.present = abs(angle - self._held) > use.angle
        return self.present


AT_REST = 0.5
"""A joint is back where it is less than this share of its angle away."""


class PostureSignal:
    """Joints turned by hand against their hold: at once, or one after the other.

    Attributes:
        touched: a joint that is asked is turned.
    """

    __slots__ = ("_age", "_done", "_held", "_ready", "touched")

    def __init__(self) -> None:
        self._held: tuple[float, ...] = ()  # angles in which the arm is held [rad]
        self._done = 0  # joints of the series that have been turned
        self._age = 0  # ticks since the last of them was
        self._ready = False  # every joint has been back since the last series
        self.touched = False

    def step(self, angles: Sequence[float], holding: bool, use: PostureSignalUse) -> bool:
        """One tick; `angles` of all joints [rad]. True while a posture is held, or in the tick that ends a series.

        An arm that has not all of the joints never gives it.
        """
        if not holding or not self._held:
            self._held, self._done, self._ready = tuple(angles), 0, False
        asked = use.asked
        if any(joint >= len(angles) for joint, _ in asked):
            return False
        shares = [_share(angles[joint] - self._held[joint], angle) for joint, angle in asked]
        self.touched = any(share > 1.0 for share in shares)
        if use.together:
            return all(share > 1.0 for share in shares)
        if all(share < AT_REST for share in shares):
            self._ready = True
        self._age += 1
        if self._done > 0 and self._age > ticks(use.within):
            self._done, self._ready = 0, False
        if any(share > 1.0 for share in shares[self._done + 1 :]):  # out of its turn
            self._done, self._ready = 0, False
        if not self._ready or shares[self._done] <= 1.0:
            return False
        self._done, self._age = self._done + 1, 0
        if self._done < len(asked):
            return False
        self._done, self._ready = 0, False
        return True


def _share(turned: float, angle: float) -> float:
    """How far a joint is turned [rad], as a share of the angle that it is asked for, to its side; of 0 rad: not at all."""
    return turned / angle if angle != 0.0 else 0.0
