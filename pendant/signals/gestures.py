"""Signals told by their course in time: pushes in a row, a force step, a tap, a joint turned by hand (FD-5f to FD-5i)."""

from pendant.settings.schema import ticks
from pendant.signals.settings import ForceStep, PushPattern, TapSettings, Turn


class PatternSignal:
    """Push, release, push: each push and each gap within limits. Whole when the last push has ended."""

    __slots__ = ("_length", "_present", "_pushes")

    def __init__(self) -> None:
        self._pushes = 0  # good ones in a row
        self._length = 0  # ticks since the last change
        self._present = False

    def step(self, present: bool, use: PushPattern) -> bool:
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
