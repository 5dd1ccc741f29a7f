"""What a contact detector is fed with: the force on a contact part and its acceleration, from one source (CD-2)."""

from typing import NamedTuple

import msgspec
import numpy as np
from numpy.typing import NDArray


class Signal(NamedTuple):
    """One tick of one source. All in the same axes, those of the part; at the carried load's centre, or at the contact point.

    Signs as docs/reference/conventions.md says of `w_sensor`: what the arm exerts on what it carries or touches. Force and
    acceleration both contain gravity, so that in free motion they stay parallel: force = mass·acceleration
    (docs/guide/contact.md).
    """

    fx: float  # force [N]
    fy: float
    fz: float
    ax: float  # specific force [m/s²]
    ay: float
    az: float
    gx: float = 0.0  # gravity [m/s²]
    gy: float = 0.0
    gz: float = 0.0
    mass: float = 0.0  # configured, of what the force accelerates [kg]
    effective_mass: float = 1.4  # of the arm behind the contact part, at this posture [kg]
    saturated: float = 0.0  # not 0: the force is at the end of its sensor's range, which says nothing of its size
    lever: float = 0.0  # over which a measured angular acceleration moves the acceleration to the load's centre [m]
    sx: float = 0.0  # change within the tick of what that turning adds, known up to a tick and a half late [m/s²]
    sy: float = 0.0
    sz: float = 0.0
    driven: float = 0.0  # in deviations of noise: above 0 the arm moves its load, below 0 the load moves the arm


class ContactSignals(msgspec.Struct, frozen=True, gc=False):
    """One tick of all sources. While nobody looks at them they stay the rows of numbers that they come as."""

    rows: NDArray[np.float64] = msgspec.field(default_factory=lambda: np.zeros((0, len(Signal._fields))))  # fields of `Signal`
    valid: tuple[bool, ...] = ()  # of each source
    behind: NDArray[np.float64] = msgspec.field(default_factory=lambda: np.zeros(0))  # (n,) torques of contacts behind the sensor
    doubt: NDArray[np.float64] = msgspec.field(default_factory=lambda: np.zeros(0))  # (n,) deviation of their changes [N·m]
    causes: NDArray[np.float64] = msgspec.field(default_factory=lambda: np.zeros((0, 0)))  # (n, m) of what `behind` is wrong by
    shares: NDArray[np.float64] = msgspec.field(default_factory=lambda: np.zeros((0, 0)))  # (n, m) of them that it holds
    misfit: NDArray[np.float64] = msgspec.field(default_factory=lambda: np.zeros((0, 0)))  # (n, m) how wrong these shares may be
    elbow: int = 2  # which joint the elbow is

    def each(self) -> tuple[Signal | None, ...]:
        """The signal of each source, None where it is not valid."""
        return tuple(Signal._make(row) if valid else None for row, valid in zip(self.rows.tolist(), self.valid, strict=True))
