"""A push that the joints feel, with or without a flange sensor (FD-5e): the change of their external torques."""

from collections.abc import Sequence

from pendant.sensor.hand_model import HALF, RARELY
from pendant.signals.contact_free_baseline import Untouched
from pendant.signals.push_signal import STAYS
from pendant.signals.settings import JointPush


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
        needed = max(use.threshold, RARELY * self._torques.noise)
        asked = self._torques.step(torques)[use.first - 1 : use.last]
        most = max(map(abs, asked), default=0.0)
        self.touched = most > HALF * needed  # a released arm swings for 0.4 s
        self.present = most > (STAYS * needed if self.present else needed)
        return self.present
