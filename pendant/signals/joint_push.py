"""A push that the joints feel, with or without a flange sensor (FD-5e): the change of their external torques."""

from collections.abc import Sequence

from pendant.signals.contact_free_baseline import Untouched
from pendant.signals.settings import JointPush

NOISES = 3.0
"""The threshold is at least so many times the noise that was measured while nobody pushed."""

STAYS = 0.75
"""A push that is present stays so down to this share of its threshold."""

OFF = 1.0 / 3.0
"""Below this share of its threshold, in all joints that are asked, no hand is felt. A released arm swings for 0.4 s."""


class JointPushSignal:
    """Whether a joint that is asked feels a push.

    Attributes:
        present: it is a push.
        touched: it may be less than one, and is a hand all the same.
    """

    __slots__ = ("_torques", "present", "touched")

    def __init__(self, n: int) -> None:
        """`n` joints."""
        self._torques = Untouched((1.0,) * n, 2.0, 0.03)
        self.present = self.touched = False

    def restart(self) -> None:
        """Learn the untouched state afresh."""
        self._torques.restart()
        self.present = self.touched = False

    def step(self, torques: Sequence[float], use: JointPush) -> bool:
        """One tick of the external torques, base to flange [N·m]."""
        needed = max(use.threshold, NOISES * self._torques.noise)
        asked = self._torques.step(torques)[use.first - 1 : use.last]
        most = max(map(abs, asked), default=0.0)
        self.touched = most > OFF * needed
        self.present = most > (STAYS * needed if self.present else needed)
        return self.present
