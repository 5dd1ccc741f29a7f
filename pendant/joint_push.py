"""A push that the joints feel, with or without a flange sensor (FD-5e): the change of their external torques."""

from collections.abc import Sequence

from pendant.signal_settings import JointPush
from pendant.untouched import Untouched

NOISES = 3.0
"""The threshold is at least so many times the noise that was measured while nobody pushed."""

STAYS = 0.75
"""A push that is present stays so down to this share of its threshold."""


class JointPushSignal:
    """Whether a joint that is asked feels a push."""

    __slots__ = ("_torques", "present")

    def __init__(self, n: int) -> None:
        """`n` joints."""
        self._torques = Untouched((1.0,) * n, 2.0, 0.03)
        self.present = False

    @property
    def memory(self) -> tuple[object, ...]:
        """All of its state, to compare."""
        return (self._torques.memory, self.present)

    def restart(self) -> None:
        """Learn the untouched state afresh."""
        self._torques.restart()
        self.present = False

    def step(self, torques: Sequence[float], use: JointPush) -> bool:
        """One tick of the external torques, base to flange [N·m]."""
        needed = max(use.threshold, NOISES * self._torques.noise)
        if self.present:
            needed *= STAYS
        asked = self._torques.step(torques)[int(use.first) - 1 : int(use.last)]
        self.present = any(abs(change) > needed for change in asked)
        return self.present
