"""The work that is done on the free arm: by it a hand on a link is known, which the flange sensor does not feel (FD-19).

The control law takes at most a share of its friction off a moving arm. The rest is paid by whoever leads it: a hand does

    W = integral of (tau_ext - tau_ext at entry) . qd dt  >=  LEFT * integral of friction . qd dt,

and an arm that nobody leads pays for that rest with its speed. Half of that rest is asked for: the gears' unknown stiffness hides
some of the torque. Both powers weigh each joint by its own speed: a joint that stands says nothing. The torques come from the
deflection of the gears, so that an error of the friction estimate alone pays nothing. A hand at the flange does the work
F . v + tau . w there, which its sensor tells better than the joints do.
"""

from pendant.sensor.odds import HALF
from pendant.tick.estimate import Estimate
from pendant.tick.modes import TICK
from pendant.tick.pose import ORIGIN, Vector, dot

LEFT = 0.15
"""Share of its friction that the control law leaves to whoever leads the arm; `sim.control.free_drive_law` takes the rest off."""


class Work:
    """What was paid of the friction that is left, over one stretch of motion.

    Attributes:
        unpaid: of it, by now [J]; work in advance does not count, for a hand that has gone pays for nothing.
    """

    __slots__ = ("_at_flange", "_before", "_by_joints", "_energy", "_rubbed", "_slower", "_ticks", "unpaid")

    def __init__(self, before: tuple[float, ...]) -> None:
        """
        Args:
            before: tau_ext (n,) at entry, which is no hand [N·m].
        """
        self._before = before
        self._clear(0.0)

    def begin(self, estimate: Estimate) -> None:
        """A stretch begins."""
        self._clear(estimate.energy)

    def _clear(self, energy: float) -> None:
        self._ticks = 0
        self._energy = energy  # kinetic, in the beginning [J]
        self._slower = 0.0  # of it that is gone [J]
        self._by_joints = (0.0, 0.0)  # work that they feel, and what it leaves unpaid [J]
        self._at_flange = (0.0, 0.0)  # the same of what its sensor feels
        self._rubbed = 0.0  # what is asked for of the friction [J]
        self.unpaid = 0.0

    def step(self, estimate: Estimate, force: Vector = ORIGIN, torque: Vector = ORIGIN, *, counts: bool = True) -> None:
        """One tick of motion, with this wrench of a hand at the flange, axes of B [N, N·m].

        What the joints feel pays only where it `counts`: else it may be their own error.
        """
        done = rubbed = 0.0
        felt = zip(estimate.qd.tolist(), estimate.tau_ext.tolist(), self._before, estimate.friction.tolist(), strict=True)
        for speed, now, before, friction in felt:
            done += (now - before) * speed
            rubbed += friction * speed
        done *= TICK * counts
        rubbed *= HALF * LEFT * TICK
        self._ticks += 1
        self._slower = self._energy - estimate.energy
        self._rubbed += rubbed
        x, y, z, a, b, c = estimate.v_F.tolist()
        self._by_joints = joints = _pay(self._by_joints, rubbed, done)
        self._at_flange = flange = _pay(self._at_flange, rubbed, TICK * (dot(force, (x, y, z)) + dot(torque, (a, b, c))))
        self.unpaid = min(joints[1], flange[1])

    @property
    def settled(self) -> bool:
        """Nothing is owed, and it is known what the motion costs."""
        return self._rubbed > 0.0 and self.unpaid == 0.0

    @property
    def paid(self) -> bool:
        """Over the whole stretch somebody paid for it."""
        return self._rubbed > 0.0 and max(self._by_joints[0], self._at_flange[0]) >= self._rubbed

    def lasts(self, ticks: int) -> bool:
        """As much is unpaid, and not by the arm's speed either, as the friction of so many ticks of this motion costs."""
        owed = self.unpaid - max(self._slower, 0.0)
        return self._ticks > ticks and not owed * self._ticks < self._rubbed * ticks  # what is not a number lasts


def _pay(account: tuple[float, float], rubbed: float, done: float) -> tuple[float, float]:
    """Work done and left unpaid [J], after a tick that costs and is paid so much."""
    total, unpaid = account
    return total + done, max(unpaid + rubbed - done, 0.0)
