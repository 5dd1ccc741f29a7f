"""Whose force it is: the odds that the payload is gone, or another, against a hand that changed (FD-19).

The hypotheses are those of `sim.estimation.wrench_hypotheses`. They are compared for every number of ticks, from `SHORTEST` to
`LONGEST`, that may have passed since the change. The odds are those of the best onset (generalised likelihood ratio: Willsky and
Jones, IEEE Trans. Autom. Control 21, 108, 1976).
"""

import math

import numpy as np

from pendant.sensor.sensor_spec import SensorSpec
from sim.arm.arm_file import Arm
from sim.arm.chain import Body
from sim.arm.frames import skew
from sim.compiled.kernel import kernel
from sim.compiled.record import record
from sim.estimation.flange_forces import FlangeForces, needed
from sim.estimation.wrench_hypotheses import BEFORE, FREED, LATE, LOST, MORE, Seen, anything, hand, jump, nobody, payload

SHORTEST, LONGEST = 2, 10
"""Ticks since the change that are looked at: 20 ms at most, in which a dropped payload has to be known (bench `drop`)."""

KEPT = LONGEST + BEFORE + 1
"""Ticks: the longest change, the one in which it came, and those before."""


class ExternalWrench:
    """The bank of hypotheses, one tick at a time, in free-drive alone.

    Attributes:
        lost: log of the odds that the payload changed, against that a hand did [nats]: 0 at least; minus infinity without a
            payload, and before there is enough to compare.
        share: of the payload that is gone then.
    """

    def __init__(self, arm: Arm, forces: FlangeForces) -> None:
        """
        Args:
            arm: its flange sensor's and accelerometer's noise.
            forces: run in the same tick before.
        """
        self._forces = forces
        self.record = record(
            noise=(2,),  # of the sensor in a tick [N, N·m]
            shaking=(),  # of the accelerometer [m/s²]
            mass=(),  # of the payload [kg]
            com=(3,),
            inertia=(3, 3),  # about the flange
            whole=(3,),  # moments of the load about the flange [kg, kg·m, kg·m²]
            rest=(3,),  # the same of what stays when the payload is gone
            x=(KEPT, 6),
            p=(KEPT, 6),
            turn=(KEPT,),  # size of the angular acceleration [rad/s²]
            fastest=(),  # of these the largest
            next="i8",
            count="i8",
            lost=(),
            share=(),
        )
        own = self._own = self.record[0]
        force_torque, accelerometer = arm.sensors.force_torque, arm.sensors.accelerometer
        self._sensed = force_torque is not None
        self._watches = False  # there is a sensor, and a payload to lose
        if force_torque is not None:
            own["noise"] = force_torque.force.noise, force_torque.torque.noise
        own["shaking"] = SensorSpec().noise_acceleration if accelerometer is None else accelerometer.noise
        own["lost"] = -math.inf

    @property
    def lost(self) -> float:
        """As the class says."""
        return float(self._own["lost"])

    @property
    def share(self) -> float:
        """As the class says."""
        return float(self._own["share"])

    def set_load(self, load: Body, payload: Body) -> None:
        """Take `load` (in F) as everything beyond the flange, of which the `payload` may get lost."""
        own, rest = self._own, load - payload
        turned = skew(payload.com)
        own["mass"], own["com"], own["inertia"] = payload.mass, payload.com, payload.inertia - payload.mass * turned @ turned
        for moments, body in (("whole", load), ("rest", rest)):
            own[moments] = max(body.mass, 0.0) * np.linalg.norm(body.com) ** np.arange(3.0)
        self._watches = self._sensed and payload.mass > 0.0
        self.forget()

    def forget(self) -> None:
        """Nothing is compared with what was before: free-drive is off, or the sensor was out."""
        if self._own["count"]:
            self._own["count"], self._own["lost"], self._own["share"] = 0, -math.inf, 0.0

    def update(self, bias: tuple[float, ...] | None) -> None:
        """One tick.

        Args:
            bias: of the sensor (6,), axes of F [N, N·m]; None: it is not used.
        """
        if bias is None or not self._watches:
            self.forget()
        else:
            _update(self.record, self._forces.record, bias)


@kernel
def _update(wrenches, forces, bias) -> None:
    own, felt = wrenches[0], forces[0]
    here = own.next
    needed((own.mass, own.com, own.inertia), (felt.specific, felt.gyro, felt.turn), own.p[here])
    for k in range(6):
        own.x[here, k] = felt.missing[k]
    a, b, c = felt.turn[0], felt.turn[1], felt.turn[2]
    own.turn[here] = np.sqrt(a * a + b * b + c * c)
    own.fastest = own.turn.max()
    own.next = (here + 1) % KEPT
    own.count = min(own.count + 1, KEPT)
    own.lost, own.share = -np.inf, 0.0
    if own.count == KEPT:
        _weigh(own, here, bias)


@kernel
def _weigh(own, here, bias) -> None:
    """The odds of the best onset; what is less likely than not counts as even."""
    own.lost = 0.0
    seen = Seen(np.zeros(6), np.zeros(6), np.zeros(6), np.zeros(6), np.zeros(6), np.zeros(6))
    for length in range(1, LONGEST + 1):
        place = (here - length + 1) % KEPT
        for k in range(6):
            x, p = own.x[place, k] - bias[k], own.p[place, k]
            seen.x[k] += x
            seen.xx[k] += x * x
            seen.later[k] += (length - 1) * x
            seen.p[k] += p
            seen.pp[k] += p * p
            seen.px[k] += p * x
        if length >= SHORTEST:
            _compare(own, seen, (length, (here - length - 1) % KEPT), bias)


@kernel
def _compare(own, seen, change, bias) -> None:
    """The odds of a change so many ticks ago, if they are better than those so far; `change` has the place of the tick before."""
    length, last = change
    before, steep = np.zeros(6), np.zeros(2)
    for k in range(6):
        for earlier in range(BEFORE):
            before[k] += own.x[(last - earlier) % KEPT, k] / BEFORE
        before[k] -= bias[k]
        half = own.x[last, k] + own.x[(last - 1) % KEPT, k] - own.x[(last - 2) % KEPT, k] - own.x[(last - 3) % KEPT, k]
        steep[k // 3] += (half / BEFORE) ** 2
    moved = 0.0
    for k in range(6):
        moved += 0.5 * (seen.x[k] / length - before[k]) ** 2 / jump(own, steep, k // 3)
    if moved < 0.5:  # a hand changes by as much within a tick: no odds can be more than about even
        return
    rest, other = anything(seen, length), np.nan
    for kind in (LOST, FREED, MORE):
        likelihood, carried, share = payload(own, seen, (length, before, steep), kind)
        # Odds are fewer than both of these; mostly that is enough to know.
        if likelihood - rest <= own.lost or carried <= own.lost or (share > 0.0) == (kind == MORE):
            continue
        if np.isnan(other):
            other = _other(own, seen, (length, before, steep), rest)
        first = likelihood - other
        odds = min(first, carried) - np.log1p(np.exp(-abs(first - carried)))
        if odds > own.lost:
            own.lost, own.share = odds, share


@kernel
def _other(own, seen, change, rest):
    """Log likelihood of all that is no payload, with `rest` that of what nothing explains."""
    total = rest
    for late in (0.0, LATE):
        rising, steady = hand(own, seen, change, late)
        free = nobody(own, seen, change[0], late)
        best = max(rising, steady, free, total)
        total = best + np.log(np.exp(rising - best) + np.exp(steady - best) + np.exp(free - best) + np.exp(total - best))
    return total
