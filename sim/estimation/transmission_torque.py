"""Transmission torque module: the torque through each gear, estimated in three ways and fused (AF-3)."""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from pendant.tick.modes import TICK
from sim.arm.arm_file import Arm
from sim.arm.joint_constants import ripple_torque
from sim.compiled.kernel import kernel
from sim.compiled.record import record

Array = NDArray[np.float64]

WAYS = ("dynamics", "deflection", "motor")
"""From q and the rigid model; from theta and q; from theta, motor torque and friction estimate."""

DYNAMICS, DEFLECTION, MOTOR = range(3)

MODEL_FLOOR = 0.004  # least error of the model, relative to the torque limit: centres of mass, output friction
ACCELERATION_FLOOR = 0.1  # deviation of the output's acceleration at rest [rad/s²]
ACCELERATION_SHARE = 0.15  # deviation / largest acceleration lately: links swing faster than the filter
LATELY = math.exp(-TICK / 0.3)
STIFFNESS_WALK = 2e-3  # random walk of the learned stiffness error [1/sqrt(s)]
OFFSET_WALK = 0.05  # of the deflection's offset, relative to the ripple's torque [1/sqrt(s)]
RIPPLE_LEFT = 0.25  # share of the ripple that a learned offset leaves
CORRELATED = 100.0  # ticks over which the deflection's errors are correlated
CONTACT = 2.5  # deviations between two ways that count as a contact
CONTACT_FLOOR = 0.012  # least difference that counts as a contact, relative to the torque limit
SLOWLY = TICK / 0.3  # share a tick: a difference that lasts over 0.3 s is the deflection's error
REMEMBERED = 1500  # ticks of motion for the mean of two ways' difference; it is not used earlier
SETTLE_TICKS = 100  # after a contact, until its end is believed


def stiffness_range(accuracy: float) -> tuple[float, float]:
    """Least and largest relative error of the believed stiffness, if it is known up to the share `accuracy`."""
    return 1.0 / (1.0 + accuracy) - 1.0, 1.0 / (1.0 - accuracy) - 1.0


class Rubbing(NamedTuple):
    """Friction and its uncertainty in a tick, and the motors' acceleration."""

    deviation: Array  # of the friction estimate (n,) [N·m]
    stiction: Array  # torque that a standing joint may hold in addition (n,) [N·m], 0 if it moves
    total: Array  # friction as estimated (n,) [N·m]
    acceleration: Array  # of the motors (n,) [rad/s²]


class TransmissionTorque:
    """Transmission torque of n joints [N·m], in three ways, and their fusion by inverse variances.

    Without a contact the rigid model's only errors are those of masses and centres of mass. In
    contact the external torque is added to its error. The deflection contains contacts, but its
    stiffness is known only to a fifth, and the output encoder's ripple enters in full. So the
    stiffness error and an offset are learned from the rigid model without a contact. The motor's
    way has the error of the friction estimate, and the whole stiction while the joint stands. There
    is a contact if the rigid model differs from the deflection (or, without a deflection, from the
    motor's way) by more than both errors allow.

    The model's errors change fast, with accelerations that it sees too late; the deflection's
    errors change slowly, with the angle. So the weight of the deflection depends on how well the
    two have agreed lately (mean over 0.3 s), and on whether the model's error explains their
    difference of now. This may be more or less than its expected weight. The weight of the model
    depends on how small the rest of the difference was (innovation-based adaptive estimation:
    Mehra, 1970). This holds only for the fusion. Agreement at these angles says little about other
    angles, so code that tells a hand from an error does not use it.

    Attributes:
        ways, deviations: each way (3, n), and its standard deviation.
        fused, deviation: their fusion (n,), and its standard deviation; a joint without any way
            keeps its last value.
        external: external torque (n,): model minus deflection, or without a deflection minus the
            motor's way; 0 without both.
        by_motor: deviation of the motor's way (n,) if `external` comes from it; 0 if from the
            deflection.
        stiffer: learned error of the springs' believed stiffness (n,), relative to it.
        offset: learned error of the deflection's torque at rest (n,) [N·m].
    """

    def __init__(self, arm: Arm, inertia: Array) -> None:
        """`inertia` (n,): inertia that a joint usually has to move [kg·m²]."""
        n = arm.n
        limit = np.array(arm.limits.torque)
        ripple = ripple_torque(arm)
        self.record = record(
            motor_constant=(),  # its largest relative error
            stiffness=(),  # the same
            link_mass=(),  # the same
            softest=(),  # least relative error of the springs' stiffness
            stiffest=(),  # largest
            floor=(n,),  # least deviation of the model [N·m]
            ripple=(n,),  # largest offset of the deflection [N·m]
            least=(n,),  # least difference that may be a contact [N·m]
            inertia=(n,),
            swing=(),  # the largest acceleration lately [rad/s²]
            stiffer=(n,),
            offset=(n,),
            covariance=(n, 2, 2),
            walk=(n, 2),
            differ=(n,),  # smoothed difference of model and deflection [N·m]
            slow_square=(n,),  # mean square of this difference
            fast_square=(n,),  # mean square of the rest of the difference
            compared=(n,),  # ticks over which these means were taken
            ways=(3, n),
            deviations=(3, n),
            fused=(n,),
            deviation=(n,),
            external=(n,),
            by_motor=(n,),
            model=(n,),  # standard deviation of the rigid model without a contact
            quiet="i8",  # ticks since some joint felt a contact, at most `SETTLE_TICKS`
            free="i8",  # the same of a contact that not even a wrong friction explains
        )
        own = self._own = self.record[0]
        for name in ("motor_constant", "stiffness", "link_mass"):
            own[name] = getattr(arm.accuracy, name)
        own["softest"], own["stiffest"] = stiffness_range(arm.accuracy.stiffness)
        own["floor"], own["ripple"], own["least"], own["inertia"] = MODEL_FLOOR * limit, ripple, CONTACT_FLOOR * limit, inertia
        own["walk"] = np.column_stack([np.full(n, STIFFNESS_WALK), OFFSET_WALK * ripple]) ** 2 * TICK
        self.stiffer, self.offset, self.ways, self.deviations = (own[k] for k in ("stiffer", "offset", "ways", "deviations"))
        self.fused, self.deviation, self.external = own["fused"], own["deviation"], own["external"]
        self.by_motor = own["by_motor"]
        own["quiet"] = own["free"] = SETTLE_TICKS
        self._quiet = self.record["quiet"]
        self.forget()

    def forget(self) -> None:
        """Learn anew: the rigid model has another load, and the learned errors may have been the model's."""
        own = self._own
        for column in ("stiffer", "offset", "covariance", "differ", "slow_square", "fast_square", "compared"):
            own[column] = 0.0
        own["covariance"][:, 0, 0] = own["stiffness"] ** 2 / 3.0  # of a uniform error
        own["covariance"][:, 1, 1] = own["ripple"] ** 2

    @property
    def contact(self) -> bool:
        """Some joint feels a contact, or felt one lately."""
        return self._quiet.item() < SETTLE_TICKS


@kernel
def fuse(transmission, rubbing, use, learns) -> None:
    """One tick, on the raw values that the caller has put into `ways`: compare, then fuse.

    These values are: torque of the rigid model plus friction of the output side; the believed
    stiffness times the deflection; tau_m - J theta_dd - friction of the input side.

    Args:
        transmission: `TransmissionTorque.record`.
        rubbing: that friction and its uncertainty, as `Rubbing`.
        use: which of `WAYS` may be used, for each joint (3, n).
        learns: planned motion moves some joint. At rest nothing is learned, because a wrong payload
            would look like a soft spring.
    """
    rubbing = Rubbing(*rubbing)
    own = transmission[0]
    learns = learns and own.quiet == SETTLE_TICKS
    touched, pressed = _compare(own, rubbing, use)
    if learns and not touched:
        _correct_spring(own, use)
    own.quiet = 0 if touched else min(own.quiet + 1, SETTLE_TICKS)
    own.free = 0 if pressed else min(own.free + 1, SETTLE_TICKS)
    _fuse(own, use, own.quiet < SETTLE_TICKS)


@kernel
def _compare(own, rubbing, use):
    """Correct the deflection, and find what the rigid model does not explain.

    Returns:
        Whether something is touched; and whether this holds even if friction were twice the
        estimate, or none. In the motor's way missing friction looks like an obstacle: if it were
        not learned, it would stay so.
    """
    friction_deviation, stiction, total, acceleration = rubbing
    ways, deviations, external = own.ways, own.deviations, own.external
    n = external.size
    swing = own.swing * LATELY
    for i in range(n):
        swing = max(swing, abs(acceleration[i]))
    own.swing = swing
    shaking = ACCELERATION_FLOOR + ACCELERATION_SHARE * swing
    touched, pressed = False, False
    for i in range(n):
        floor, ripple = own.floor[i], own.ripple[i]
        P, x, dynamics = own.covariance[i], ways[1, i], ways[0, i]
        ways[1, i] += x * own.stiffer[i] + own.offset[i]
        rigid = (own.link_mass * dynamics) ** 2 + floor**2
        own.model[i] = np.sqrt(rigid + (shaking * own.inertia[i]) ** 2)
        known = max(x * x * P[0, 0] + 2.0 * x * P[0, 1] + P[1, 1], 0.0)
        gear, noise = known + (RIPPLE_LEFT * ripple) ** 2, (0.3 * floor) ** 2
        if use[0, i] and own.compared[i] == REMEMBERED:
            gear = max(own.slow_square[i], own.differ[i] ** 2 - rigid)
        deviations[1, i] = np.sqrt(gear + noise)
        rubs = friction_deviation[i] ** 2 + stiction[i] ** 2
        deviations[2, i] = np.sqrt((own.motor_constant * ways[2, i]) ** 2 + rubs + floor**2)
        other = 1 if use[1, i] else 2
        external[i], own.by_motor[i] = 0.0, 0.0 if other == 1 else deviations[2, i]
        if not use[0, i] or not (use[1, i] or use[2, i]):
            continue
        external[i] = dynamics - ways[other, i]
        allowed = known + (0.5 * ripple) ** 2 if other == 1 else deviations[2, i] ** 2
        size, bound = abs(external[i]), max(CONTACT * np.sqrt(allowed + own.model[i] ** 2), own.least[i])
        touched = touched or size > bound
        pressed = pressed or size - (0.0 if other == 1 else abs(total[i])) > bound
    return touched, pressed


@kernel
def _correct_spring(own, use) -> None:
    """Learn stiffness error and offset of the deflection from the model, without a contact."""
    for i in range(own.external.size):
        if not (use[0, i] and use[1, i]):
            continue
        P, ripple, walk = own.covariance[i], own.ripple[i], own.walk[i]
        x = (own.ways[1, i] - own.offset[i]) / (1.0 + own.stiffer[i])
        error = own.external[i]
        compared = min(own.compared[i] + 1.0, REMEMBERED)
        own.compared[i] = compared
        own.differ[i] += SLOWLY * (error - own.differ[i])
        differ = own.differ[i]
        own.slow_square[i] += (differ**2 - own.slow_square[i]) / compared
        own.fast_square[i] += ((error - differ) ** 2 - own.fast_square[i]) / compared
        # An unbent spring tells nothing of its stiffness: its uncertainty grows, at most to the
        # first one.
        P[0, 0] = min(P[0, 0] + walk[0], own.stiffness**2 / 3.0)
        P[1, 1] = min(P[1, 1] + walk[1], ripple**2)
        g0, g1 = P[0, 0] * x + P[0, 1], P[0, 1] * x + P[1, 1]
        spread = g0 * x + g1 + (0.5 * ripple) ** 2 * CORRELATED
        P[0, 0] -= g0 * g0 / spread
        P[1, 1] -= g1 * g1 / spread
        P[0, 1] -= g0 * g1 / spread
        P[1, 0] = P[0, 1]
        stiffer = own.stiffer[i] + g0 * error / spread
        own.stiffer[i] = min(max(stiffer, own.softest), own.stiffest)
        # If the stiffness was clipped to its bound, the offset learned with it is corrected
        # likewise.
        offset = own.offset[i] + g1 * error / spread + (own.stiffer[i] - stiffer) * P[0, 1] / P[0, 0]
        own.offset[i] = min(max(offset, -ripple), ripple)


@kernel
def weighed(own, use, i, first) -> tuple[float, float]:
    """Sum of the weights (inverse variances) of joint i's ways from `first` on, and of the weighted torques."""
    weight, total = 0.0, 0.0
    for k in range(first, use.shape[0]):
        if use[k, i]:
            w = 1.0 / own.deviations[k, i] ** 2
            weight += w
            total += w * own.ways[k, i]
    return weight, total


@kernel
def _fuse(own, use, contact) -> None:
    ways, deviations, fused, deviation = own.ways, own.deviations, own.fused, own.deviation
    for i in range(fused.size):
        outside = own.external[i] if contact else 0.0
        variance = own.model[i] ** 2
        if use[1, i] and own.compared[i] == REMEMBERED:
            # Only with a measured output angle: else the model's acceleration comes from this
            # torque.
            variance = min(variance, (own.link_mass * ways[0, i]) ** 2 + own.floor[i] ** 2 + own.fast_square[i])
        deviations[0, i] = np.sqrt(variance + outside**2)
        weight, total = weighed(own, use, i, 0)
        if weight > 0.0:
            fused[i] = total / weight
            deviation[i] = np.sqrt(1.0 / weight)
