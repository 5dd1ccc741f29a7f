"""The state of the untouched arm some time ago, which the activation sequence may compare with (FD-9)."""

from collections import deque

from pendant.limits.parameters import EntryValues, reference
from pendant.limits.validity import WrenchMean
from pendant.settings.schema import ticks
from pendant.tick.estimate import Estimate

EVERY = ticks(0.05)
"""Between two states that are kept."""

OLDEST = ticks(15.0) + EVERY
"""What is older is compared with no more."""


class Stored:
    """Keeps states of an arm that nobody tries to free, as long as they are of the same load and sensors."""

    __slots__ = ("_states", "_wrench")

    def __init__(self) -> None:
        self._states: deque[tuple[int, EntryValues]] = deque(maxlen=OLDEST // EVERY + 1)
        self._wrench = False  # the flange sensor was valid in all of them

    def due(self, tick: int) -> bool:
        """The last state that was kept is old enough to keep another one."""
        return not self._states or tick - self._states[-1][0] >= EVERY

    def keep(self, estimate: Estimate, wrench_ok: bool, mean: WrenchMean) -> None:
        """One state with valid joints; `mean` of F_user, axes of B. One that lost or gained the flange sensor starts again."""
        if wrench_ok is not self._wrench:
            self._states.clear()
            self._wrench = wrench_ok
        self._states.append((estimate.tick, reference(estimate, mean.mean())))

    def forget(self) -> None:
        """What was kept is of another load or posture, or a sensor was out."""
        self._states.clear()

    def of(self, tick: int, age: int, wrench_ok: bool) -> EntryValues | None:
        """The youngest state that is at least `age` ticks old in `tick`; None without one, and where the sensors differ."""
        if wrench_ok is not self._wrench:
            return None
        return next((state for kept, state in reversed(self._states) if age <= tick - kept <= OLDEST), None)
