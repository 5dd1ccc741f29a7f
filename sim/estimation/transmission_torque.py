"""Transmission torque module: what passes through each gear, told three ways and fused (AF-3)."""

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

MODEL_FLOOR = 0.004  # what the rigid model misses at least, relative to the torque limit: centres of mass, output friction
ACCELERATION_FLOOR = 0.1  # deviation of the output's acceleration at rest [rad/s²]
ACCELERATION_SHARE = 0.15  # and of the largest acceleration lately: links swing on their springs faster than the filter sees
LATELY = math.exp(-TICK / 0.3)
STIFFNESS_WALK = 2e-3  # random walk of the learned stiffness error [1/sqrt(s)]
OFFSET_WALK = 0.05  # of the deflection's offset, relative to the ripple's torque [1/sqrt(s)]
RIPPLE_LEFT = 0.25  # share of the ripple that a learned offset leaves
CORRELATED = 100.0  # ticks over which the deflection's error stays alike
CONTACT = 2.5  # deviations between two ways that count as a contact
CONTACT_FLOOR = 0.012  # and the least such difference, relative to the torque limit
SLOWLY = TICK / 0.3  # where two ways differ for longer than this [s], it is the deflection's error
REMEMBERED = 1500  # ticks of motion over which it is remembered how much they differed; before so many it does not count
SETTLE_TICKS = 100  # after a contact, before its end is believed


def stiffness_range(accuracy: float) -> tuple[float, float]:
    """Relative error of the stiffness that is believed, least and most, where it is known to the share `accuracy`."""
    return 1.0 / (1.0 + accuracy) - 1.0, 1.0 / (1.0 - accuracy) - 1.0


class Rubbing(NamedTuple):
    """What friction leaves uncertain in a tick, and how the motors accelerate."""

    deviation: Array  # of the friction estimate (n,) [N·m]
    stiction: Array  # what a standing joint may hold as well (n,) [N·m], 0 for one that moves
    total: Array  # friction as estimated (n,) [N·m]
    acceleration: Array  # of the motors (n,) [rad/s²]


class TransmissionTorque:
    """Transmission torque of n joints [N·m], three ways, and their fusion by inverse variances.

    The rigid model is right up to masses and centres while nothing is touched, and wrong by the external torque in contact.
    The deflection feels contacts, but its stiffness is known to a fifth and the output encoder's ripple counts in full: the
    stiffness error and an offset are learned from the rigid model while nothing is touched. The motor's way is uncertain by
    the friction estimate, and by the whole stiction while the joint stands. A contact is where the rigid model differs from
    the deflection, or without it from the motor's way, by more than both allow.

    The model's errors change fast, with accelerations that it does not see in time; the deflection's slowly, with the angle.
    So the deflection is trusted as far as the two have agreed lately, in the mean over a third of a second, more or less than was
    believed of it, and as far as the model explains how much they differ now; the model as far as the rest of their difference
    was small (innovation-based adaptive estimation: Mehra, 1970). That is for the fusion alone: agreement at the angles of now
    says little of the next ones, and what tells a hand from an error must not count on it.

    Attributes:
        ways, deviations: each way (3, n), and its standard deviation.
        fused, deviation: their fusion (n,), and its standard deviation; a joint without any way keeps its last value.
        external: model minus the deflection, or without it minus the motor's way (n,): the external torque; 0 without both.
        by_motor: standard deviation of the motor's way (n,) where `external` is told by that, 0 where the deflection tells it.
        stiffer: learned error of the springs' believed stiffness (n,), relative to it.
        offset: learned error of what the deflection is believed to bear at rest (n,) [N·m].
    """

    def __init__(self, arm: Arm, inertia: Array) -> None:
        """`inertia` (n,) is what a joint usually has to move [kg·m²]."""
        n = arm.n
        limit = np.array(arm.limits.torque)
        ripple = ripple_torque(arm)
        self.record = record(
            motor_constant=(),  # what it may be wrong by, relative to it
            stiffness=(),  # the same
            link_mass=(),  # the same
            softest=(),  # springs, against what is believed, at least
            stiffest=(),
            floor=(n,),  # of the model's deviation [N·m]
            ripple=(n,),  # of the deflection's offset [N·m]
            least=(n,),  # difference that may be a contact [N·m]
            inertia=(n,),
            swing=(),  # the largest acceleration lately [rad/s²]
            stiffer=(n,),
            offset=(n,),
            covariance=(n, 2, 2),
            walk=(n, 2),
            differ=(n,),  # model from deflection, slowly [N·m]
            slow_square=(n,),  # mean square of that
            fast_square=(n,),  # and of the rest
            compared=(n,),  # ticks over which they were compared
            ways=(3, n),
            deviations=(3, n),
            fused=(n,),
            deviation=(n,),
            external=(n,),
            by_motor=(n,),
            model=(n,),  # standard deviation of the rigid model where nothing is touched
            quiet="i8",  # ticks since some joint felt a contact, at most `SETTLE_TICKS`
            free="i8",  # ticks since one felt more than friction may be wrong by, too
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
        """Begin to learn anew: the rigid model has another load, and what was learned from it may have been its error."""
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

    These are: torque of the rigid model and of the output side's friction; stiffness as believed times the deflection;
    tau_m - J theta_dd - friction of the input side.

    Args:
        transmission: `TransmissionTorque.record`.
        rubbing: what that friction leaves uncertain, as `Rubbing`.
        use: which of `WAYS` may be used, of which joint (3, n).
        learns: planned motion moves some joint; at rest nothing is learned, for a wrong payload would pass for a soft spring.
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
        Whether something is touched, and whether it is where friction may be twice what is believed, or none: by the motor's way
        friction that is missing looks like what stands in the way, and were it not learned, it would stay so.
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
    """Learn stiffness error and offset of the deflection from the model, where nothing touches."""
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
        # What nothing bends tells nothing of its stiffness: it may drift, but never beyond what was believed at first.
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
        # The offset was learned together with a stiffness that cannot be: it goes with the bound.
        offset = own.offset[i] + g1 * error / spread + (own.stiffer[i] - stiffer) * P[0, 1] / P[0, 0]
        own.offset[i] = min(max(offset, -ripple), ripple)


@kernel
def weighed(own, use, i, first) -> tuple[float, float]:
    """Of joint i, over the ways from `first` on: the sum of their weights, inverse variances, and of the torques so weighed."""
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
            # Without an output angle, though, the model's acceleration is made of this torque.
            variance = min(variance, (own.link_mass * ways[0, i]) ** 2 + own.floor[i] ** 2 + own.fast_square[i])
        deviations[0, i] = np.sqrt(variance + outside**2)
        weight, total = weighed(own, use, i, 0)
        if weight > 0.0:
            fused[i] = total / weight
            deviation[i] = np.sqrt(1.0 / weight)
