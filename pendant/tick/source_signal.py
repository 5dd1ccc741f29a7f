"""Input of a contact detector: the force on a contact part and the part's acceleration, from one source (CD-2)."""

from typing import NamedTuple

import msgspec
import numpy as np
from numpy.typing import NDArray


class Signal(NamedTuple):
    """One tick of one source. All in the same axes, those of the part; at the carried load's centre, or at the contact point.

    Signs as docs/reference/conventions.md says of `w_sensor`: what the arm exerts on what it carries or touches. Force and
    acceleration both contain gravity, so that in free motion they stay parallel: force = mass·acceleration
    (docs/explanation/contact.md).
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
    mass: float = 0.0  # configured mass that the force accelerates [kg]
    effective_mass: float = 1.4  # of the arm behind the contact part, at this posture [kg]
    saturated: float = 0.0  # not 0: the force is at the end of its sensor's range, and may be larger
    lever: float = 0.0  # by which the angular acceleration adds to the acceleration at the load's centre [m]
    sx: float = 0.0  # change, in the tick, of the acceleration by `lever`; known up to 1.5 ticks late [m/s²]
    sy: float = 0.0
    sz: float = 0.0
    driven: float = 0.0  # in deviations of noise: above 0 the arm moves its load, below 0 the load moves the arm


WIDTH = len(Signal._fields)
SATURATED = Signal._fields.index("saturated")


class ContactSignals(msgspec.Struct, frozen=True, gc=False):
    """One tick of all sources. The numbers stay in one array until somebody reads them: to copy six arrays in every tick would
    take as long as to compute them.

    Layout of the array, for n joints with m causes of error each:

    - a row of `Signal` for each source;
    - torques (n,) of contacts behind the sensor [N·m];
    - causes (n, m) of these torques' errors;
    - torque (n,) that friction at rest may hide [N·m];
    - deviation (n,) of the torques' changes for other reasons [N·m];
    - shares (n, m): a torque's error is the sum of its causes times these;
    - misfit (n, m): possible errors of the shares.
    """

    numbers: NDArray[np.float64] = msgspec.field(default_factory=lambda: np.zeros(0))
    valid: tuple[bool, ...] = ()  # of each source
    joints: int = 0  # n; 0: the links are not watched
    elbow: int = 2  # which joint the elbow is
    stands: bool = False  # no joint moves

    @property
    def felt(self) -> NDArray[np.float64]:
        """Torques of contacts behind the sensor, the causes of their errors, and the torques that friction may hide (n + n m +
        n,)."""
        begin = self._begin
        return self.numbers[begin : begin + self._felt]

    @property
    def doubt(self) -> NDArray[np.float64]:
        """Deviation of the torques' changes (n,) [N·m]."""
        begin = self._begin + self._felt
        return self.numbers[begin : begin + self.joints]

    @property
    def known(self) -> NDArray[np.float64]:
        """For each torque and cause: the share of the cause in the torque's error, and the possible error of the share (2, n,
        m)."""
        return self.numbers[self._begin + self._felt + self.joints :].reshape((2, self.joints, -1))

    @property
    def _begin(self) -> int:
        return len(self.valid) * WIDTH

    @property
    def _felt(self) -> int:
        """Size of `felt`. Causes, shares and misfit have equal sizes: a third each of the array without torques, friction and
        deviations."""
        n = self.joints
        return 2 * n + (self.numbers.size - self._begin - 3 * n) // 3

    def saturated(self, source: int) -> bool:
        """A source's force is at the end of its sensor's range."""
        return bool(self.numbers[source * WIDTH + SATURATED])

    def each(self, first: int = 0, last: int | None = None) -> tuple[Signal | None, ...]:
        """The signal of each source from `first` to before `last`, None where it is not valid."""
        part = slice(first, last)
        valid = self.valid[part]
        if not any(valid):
            return (None,) * len(valid)
        rows = self.numbers[: self._begin].reshape((len(self.valid), WIDTH))[part].tolist()
        return tuple(Signal._make(row) if ok else None for row, ok in zip(rows, valid, strict=True))
