"""The work that is done on the free arm: by it a hand on a link is known, which the flange sensor does not feel (FD-19).

The control law takes at most a share of its friction off a moving arm. The rest is paid by whoever leads it: a hand does

    W = integral of (tau_ext - tau_ext at entry) . qd dt  >=  LEFT * integral of friction . qd dt + change of kinetic energy,

and an arm that nobody leads pays for that rest with its speed. Half of that rest is asked for: the gears' unknown stiffness hides
some of the torque. Both powers weigh each joint by its own speed: a joint that stands
says nothing. The torques come from the gears' deflection, so that an error of the friction estimate alone pays nothing.
"""

from pendant.estimate import Estimate
from pendant.modes import TICK

LEFT = 0.15
"""Share of its friction that the control law leaves to whoever leads the arm; `sim.free_drive_law` takes the rest off."""

ASKED = 0.5
"""Share of that rest which somebody must pay (bench `guided`, `payload`)."""


class Work:
    """What was paid of the friction that is left, over one stretch of motion.

    Attributes:
        unpaid: what is owed by now [J]; work in advance does not count, for a hand that has gone pays for nothing.
    """

    __slots__ = ("_before", "_done", "_energy", "_owed", "_rubbed", "_ticks", "unpaid")

    def __init__(self, before: tuple[float, ...]) -> None:
        """
        Args:
            before: tau_ext (n,) at entry, which is no hand [N·m].
        """
        self._before = before
        self._energy = 0.0  # kinetic, in the last tick [J]
        self._clear()

    @property
    def memory(self) -> tuple[object, ...]:
        """All of its state, to compare."""
        return tuple([getattr(self, name) for name in self.__slots__])

    def begin(self, estimate: Estimate) -> None:
        """A stretch begins."""
        self._energy = estimate.energy
        self._clear()

    def _clear(self) -> None:
        self._ticks = 0
        self._done = 0.0  # by somebody [J]
        self._owed = 0.0  # what the law left of the friction, and what made it faster [J]
        self._rubbed = 0.0  # the former alone [J]
        self.unpaid = 0.0

    def step(self, estimate: Estimate) -> None:
        """One tick of motion."""
        done = owed = 0.0
        felt = zip(estimate.qd.tolist(), estimate.tau_ext.tolist(), self._before, estimate.friction.tolist(), strict=True)
        for speed, now, before, friction in felt:
            done += (now - before) * speed
            owed += friction * speed
        done *= TICK
        rubbed = ASKED * LEFT * TICK * owed
        owed = rubbed + estimate.energy - self._energy
        self._energy = estimate.energy
        self._ticks += 1
        self._done += done
        self._owed += owed
        self._rubbed += rubbed
        self.unpaid = max(self.unpaid + owed - done, 0.0)

    @property
    def settled(self) -> bool:
        """Nothing is owed, and it is known what the motion costs."""
        return self._rubbed > 0.0 and self.unpaid == 0.0

    @property
    def paid(self) -> bool:
        """Over the whole stretch somebody paid for it."""
        return self._rubbed > 0.0 and self._done >= self._owed

    def lasts(self, ticks: int) -> bool:
        """As much is unpaid as the friction of so many ticks of this motion costs."""
        return self._ticks > ticks and not self.unpaid * self._ticks < self._rubbed * ticks  # what is not a number lasts
