"""How near the arm is to a singularity, in words: ok, near, too near (FD-4)."""

from enum import StrEnum

from pendant.limits.settings import AxisSettings

BACK = 1.2
"""The way back to a better word needs so many times the value, so that it does not flicker."""


class Nearness(StrEnum):
    """To a singularity."""

    OK = "ok"
    NEAR = "near"  # motion further towards it is resisted
    TOO_NEAR = "too near"  # with all of the resistance; locks may give way


class SingularityWatch:
    """Remembers the word.

    Attributes:
        status: of the last tick.
    """

    __slots__ = ("status",)

    def __init__(self) -> None:
        self.status = Nearness.OK

    def step(self, value: float, axes: AxisSettings) -> bool:
        """One tick; returns whether the word is another one now.

        Args:
            value: smallest singular value of the Jacobian [m].
            axes: where the words change.
        """
        before = self.status
        if before is _OK and value >= axes.near:
            return False
        near = axes.near * BACK  # from ok the value is below that in any case
        too_near = axes.too_near * (BACK if before is Nearness.TOO_NEAR else 1.0)
        self.status = Nearness.TOO_NEAR if value < too_near else Nearness.NEAR if value < near else Nearness.OK
        return self.status is not before


_OK = Nearness.OK  # looked up in every tick
