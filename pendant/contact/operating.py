"""The thresholds of contact detection follow what the robot does: sensitivity by operating parameters (CD-11)."""

import math
from typing import NamedTuple

from msgspec.structs import replace

from pendant.contact.settings import ContactUse

FINENESS = 0.01
"""Steps of the factor: each other value needs new thresholds."""


class Operation(NamedTuple):
    """What the robot does in one tick."""

    acceleration: float = 0.0  # commanded, of the tool centre point [m/s²]
    force: float = 0.0  # that a program pushes with [N]
    torque: float = 0.0  # largest transmission torque of a joint [N·m]
    current: float = 0.0  # of the motor nearest to its largest, as a share of that
    running: bool = False  # mode RUN


class OperatingSensitivity:
    """Gives the settings of a tick; the same object as long as nothing changes."""

    __slots__ = ("_factor", "_given", "_of")
    NOT_STATE = ("_given",)  # it is made of the other two

    def __init__(self) -> None:
        self._of, self._factor = ContactUse(), 1.0
        self._given = self._of

    def step(self, use: ContactUse, now: Operation) -> ContactUse:
        """The settings with their sensitivity divided by the factor on all thresholds."""
        factor = (
            (1.0 + use.commanded_share * now.acceleration)
            * (1.0 + use.target_share * now.force)
            * (1.0 + use.torque_share * now.torque)
            * (1.0 + use.current_share * now.current)
        )
        if now.running:
            factor *= use.program_factor
        factor = max(FINENESS * math.floor(factor / FINENESS + 0.5), 1.0)
        if use is not self._of or factor != self._factor:
            self._of, self._factor = use, factor
            self._given = use if factor == 1.0 else replace(use, sensitivity=use.sensitivity / factor)
        return self._given


def follows(use: ContactUse) -> bool:
    """Any threshold follows what the robot does."""
    return (
        use.commanded_share > 0.0
        or use.target_share > 0.0
        or use.torque_share > 0.0
        or use.current_share > 0.0
        or use.program_factor > 1.0
    )
