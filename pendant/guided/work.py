"""The work that is done on the free arm: by it a hand on a link is known, which the flange sensor does not feel (FD-19).

The control law takes at most a share of its friction off a moving arm. The rest is paid by whoever leads it: a hand does

    W = integral of (tau_hand . qd + F . v + tau . w) dt  >=  LEFT * integral of friction . qd dt,

with the torques that the joints feel of a hand on a link and the wrench that the flange sensor feels of one at the flange, each
only as far as it is more than an error may be. Without the sensor the joints tell both. What may be the sensor's drift the
joints feel as a hand that does the opposite: it is subtracted, but not from what they feel for certain, in which it is counted.
An arm that nobody leads pays for that rest with its speed. Half of that rest is asked for: what may be an error hides some of a
hand. Each joint is weighed by its own speed: one that stands says nothing. The torques come from the deflection of the gears,
so that an error of the friction estimate alone pays nothing.
"""

from pendant.sensor.odds import HALF
from pendant.tick.estimate import Estimate
from pendant.tick.modes import TICK
from pendant.tick.pose import ORIGIN, Vector

LEFT = 0.15
"""Share of its friction that the control law leaves to whoever leads the arm; `sim.control.free_drive_law` takes the rest off."""

Forces = tuple[Vector, Vector]
"""A force and a torque at the flange, axes of B [N, N·m]."""

NO_WRENCH: Forces = (ORIGIN, ORIGIN)

Shares = tuple[float, float]
"""Of a force and of a torque."""

ALL_SURE: Shares = (1.0, 1.0)


class Work:
    """What was paid of the friction that is left, over one stretch of motion.

    Attributes:
        unpaid: of it, by now [J]; work in advance does not count, for a hand that has gone pays for nothing.
    """

    __slots__ = ("_done", "_energy", "_owed", "_rubbed", "_slower", "_ticks", "unpaid")

    def __init__(self) -> None:
        self._clear(0.0)

    def begin(self, estimate: Estimate) -> None:
        """A stretch begins."""
        self._clear(estimate.energy)

    def _clear(self, energy: float) -> None:
        self._ticks = 0
        self._energy = energy  # kinetic, in the beginning [J]
        self._slower = 0.0  # of it that is gone [J]
        self._done = 0.0  # by a hand [J]
        self._owed = 0.0  # of what it should have done, and what it did against the motion [J]
        self._rubbed = 0.0  # what is asked for of the friction [J]
        self.unpaid = 0.0

    def step(self, estimate: Estimate, wrench: Forces = NO_WRENCH, sure: Shares = ALL_SURE, *, counts: bool = True) -> None:
        """One tick of motion.

        What the joints feel pays only where it `counts`: beside a flange sensor that is not used it may be the sensor's error.

        Args:
            estimate: of this tick.
            wrench: what the flange sensor feels of a hand, axes of B [N, N·m].
            sure: what of its force and of its torque is one; the rest may be the sensor's drift.
            counts: what the joints feel does.
        """
        x, y, z, a, b, c = estimate.v_F.tolist()
        (fx, fy, fz), (tx, ty, tz) = wrench
        pushed, turned = fx * x + fy * y + fz * z, tx * a + ty * b + tz * c  # without calls: in every tick, up to twice
        at_flange = sure[0] * pushed + sure[1] * turned
        done, certain, rubbed = estimate.powers
        if done > 0.0:
            done = max(done + min(pushed + turned - at_flange, 0.0), min(certain, done), 0.0)
        done = (done * counts + at_flange) * TICK
        rubbed *= HALF * LEFT * TICK
        self._ticks += 1
        self._slower = self._energy - estimate.energy
        self._done += done
        self._rubbed += rubbed
        self._owed = max(self._owed + rubbed - done, 0.0)
        self.unpaid = min(self._owed, self._rubbed)

    @property
    def settled(self) -> bool:
        """Nothing is owed, and it is known what the motion costs."""
        return self._rubbed > 0.0 and self.unpaid == 0.0

    @property
    def paid(self) -> bool:
        """Over the whole stretch somebody paid for it."""
        return self._rubbed > 0.0 and self._done >= self._rubbed

    def lasts(self, ticks: int) -> bool:
        """As much is unpaid, and not by the arm's speed either, as the friction of so many ticks of this motion costs."""
        owed = self.unpaid - max(self._slower, 0.0)
        return self._ticks > ticks and not owed * self._ticks < self._rubbed * ticks  # what is not a number lasts
