"""What free-drive must know of the rest of the robot in one tick."""

import math

import msgspec

from pendant.limits.residual import PayloadError
from pendant.limits.validity import Stillness, WrenchMean
from pendant.sensor.hand_model import RARELY
from pendant.sensor.taring import Taring
from pendant.signals.enabling_device import Grip, enables
from pendant.tick.estimate import Estimate
from pendant.tick.modes import Mode
from pendant.tick.motion_status import NO_MOTION, MotionStatus


class Surroundings(msgspec.Struct, frozen=True, gc=False):
    """The estimate, and what is kept of those before; mode, hand and devices."""

    estimate: Estimate
    mode: Mode
    wrench_ok: bool  # pendant.limits.validity.wrench_ok
    still: Stillness
    mean: WrenchMean  # of F_user
    grip: Grip | None = None  # of the enabling device, None where none is needed
    hand_off: bool = True  # no hand has been felt for as long as it takes (FD-8a)
    touched: bool = False  # one is felt in this tick, be it less than a signal (FD-8)
    felt: float = 0.0  # change of the force at the flange from the untouched state [N]
    changing: float | None = None  # the configured payload by now, while it is being changed [kg]
    guided: bool = False  # a step of a program asks for free-drive (CD-15)
    shaken: bool = False  # haptic feedback moves the arm: not what a hand does (FD-19)
    payload: float = 0.0  # configured, without the tool [kg]
    taring: Taring | None = None  # of the flange sensor; None: nothing is known of its zero
    status: MotionStatus = NO_MOTION  # of the control law's last tick

    @property
    def maybe_zero(self) -> bool:
        """The sensor's zero alone may be what is felt at the flange (FD-11)."""
        return self.taring is not None and self.taring.explains(self.estimate, self.mean.mean())

    @property
    def payload_error(self) -> PayloadError | None:
        """Of the payload, as other postures tell it; None where nothing is known but the force of now.

        Without a valid flange sensor the joints tell it.
        """
        if not self.wrench_ok:
            mass, deviation = self.estimate.missing_mass
            return PayloadError(mass, RARELY * deviation) if math.isfinite(mass + deviation) else None
        if self.taring is None:
            return None
        return self.taring.payload_error(self.estimate, self.mean.mean())

    @property
    def enabled(self) -> bool:
        """No enabling device forbids motion."""
        return self.grip is None or enables(self.grip)
