"""Whose force it is: the odds that the payload changed, or that the sensor stepped, against a hand that changed (FD-19).

The hypotheses are those of `wrench_hypotheses`, `wrench_hand` and `wrench_steps`. Each explains one and the same window: the last
`LONGEST` ticks and the one before them; what was earlier is given. When in it the change came is not known: the likelihoods of
all onsets are summed, each as likely as another. So what is compared are probabilities of the same data, and the odds are honest.
"""

import math
from typing import NamedTuple

import numpy as np

from pendant.limits.validity import WINDOW
from pendant.tick.modes import TICK
from sim.arm.arm_file import Arm
from sim.arm.chain import Body
from sim.compiled.kernel import kernel
from sim.compiled.record import record
from sim.flange.flange_forces import FlangeForces, about_flange, needed, turn_both
from sim.flange.step_answer import StepAnswer, answer
from sim.flange.wrench_hand import ahead, hand
from sim.flange.wrench_hypotheses import (
    BEFORE,
    FREED,
    LATE,
    LINE,
    LN_RARE,
    LONGEST,
    LOST,
    MORE,
    SHORTEST,
    STRAY,
    Seen,
    anything,
    nobody,
    noise,
    payload,
    spread,
)
from sim.flange.wrench_steps import both, jumps, quiet, recent, sudden, unanswered
from sim.sensing.sensor_drift import sensor_spec

LN_ONSETS = math.log(LONGEST + 1.0)

KEPT = LONGEST + BEFORE + 1
"""Ticks: the longest change, the one in which it came, and those before."""


class Odds(NamedTuple):
    """Of a tick: logs of odds against all else [nats], minus infinity where nothing is suspected."""

    lost: float  # that the payload changed
    share: float  # of the payload that is gone then
    stepped: float  # that the sensor stepped
    step: float  # size of that step [N]


NO_ODDS = Odds(-math.inf, 0.0, -math.inf, 0.0)


class ExternalWrench:
    """The bank of hypotheses: what is asked of the flange sensor in free-drive."""

    def __init__(self, arm: Arm, forces: FlangeForces) -> None:
        """
        Args:
            arm: the noise of its flange sensor, accelerometer and gyro.
            forces: run in the same tick before.
        """
        self.record = record(
            noise=(2,),  # of the sensor in a tick [N, N·m]
            walk=(),  # standard deviation of what the bias is off by itself [N]
            offset=(),  # and in this tick [N]
            gain=(),  # error of the sensor in share of what it measures, at most
            shaking=(),  # of the accelerometer [m/s²]
            turning=(),  # of the angular acceleration that the load is taken to need [rad/s²]
            jitter=(),  # variance of the gyro's difference, each axis [rad²/s⁴]
            mass=(),  # of the payload [kg]
            com=(3,),
            inertia=(3, 3),  # about the flange
            whole=(3,),  # moments of the load about the flange, largest axis [kg, kg·m, kg·m²]
            rest=(3,),  # the same of what stays when the payload is gone
            moves=(),  # what a force at the flange moves at once [kg]
            x=(KEPT, 6),  # with the sensor's bias
            p=(KEPT, 7),  # and its force along the line to its centre
            R=(KEPT, 3, 3),  # attitude of the flange
            line=(3,),  # that line's direction, in F
            before=(KEPT, 6),  # mean of x ahead of each tick
            steep=(KEPT, 2),  # square of its rise there, a tick
            ahead=(KEPT,),  # log likelihood of each tick if a hand goes on
            felt=(KEPT, 3),  # acceleration of the flange beyond gravity [m/s²], not a number where that is not valid
            gyro=(3,),  # its last value [rad/s]
            turn=(KEPT,),  # size of the angular acceleration before its filter, as far as it is no noise [rad/s²]
            fastest=(),  # of these the largest
            spread=(2,),  # log of the variances of x, with nothing that comes late and with it
            sums=(12, 7),
            next="i8",
            count="i8",
            lost=(),  # log of the odds that the payload changed, against all else [nats]; minus infinity: nothing is compared
            share=(),  # of the payload that is gone then
            stepped=(),  # log of the odds that the sensor stepped, against all else [nats]; the same
            step=(),  # size of the step [N]
            jump=(6,),  # the same as a wrench, axes of B
            age="i8",  # ticks since it
        )
        own = self._own = self.record[0]
        self._known = forces.record, forces.model
        self._answer, self._begun = StepAnswer(arm.n, arm.accuracy.stiffness), False
        gyro, told = arm.sensors.gyro, sensor_spec(arm)
        self._beyond = sum(arm.masses.mass[arm.chain.elbow :])  # the elbow: what springs there do not hold back
        own["noise"] = told.noise_force, told.noise_torque
        # It is the mean of a window, and the sensor's zero has wandered since.
        own["walk"] = math.hypot(told.walk_force, told.noise_force / math.sqrt(WINDOW))
        own["gain"] = told.gain
        own["shaking"] = told.noise_acceleration
        own["jitter"] = 2.0 * ((0.0 if gyro is None else gyro.noise) / TICK) ** 2
        own["turning"] = math.sqrt(own["jitter"] * forces.passed)
        own["lost"] = own["stepped"] = -math.inf

    def set_load(self, load: Body, payload: Body) -> None:
        """Take `load` (in F) as everything beyond the flange, of which the `payload` may get lost."""
        own, rest = self._own, load - payload
        lever = float(np.linalg.norm(payload.com))
        own["line"] = payload.com / lever if lever > 0.0 else 0.0
        own["mass"], own["com"], own["inertia"] = payload.mass, payload.com, about_flange(payload)
        for moments, body in (("whole", load), ("rest", rest)):
            mass = max(body.mass, 0.0)
            own[moments] = mass, mass * np.linalg.norm(body.com), np.linalg.norm(about_flange(body), 2)
        own["moves"] = load.mass + self._beyond
        self.forget()

    def update(self, bias: tuple[float, ...] | None, unsure: float = 0.0, *, accelerations: bool) -> Odds:
        """One tick.

        Args:
            bias: of the sensor (6,), axes of F [N, N·m]; None: it is not used, and what was before counts no more.
            unsure: standard deviation of each axis of the bias [N], beside its walk.
            accelerations: the flange's accelerometer is valid.
        """
        if bias is None:
            if self._begun:
                self._begun = False
                self.forget()
                self._answer.forget()
            return NO_ODDS
        self._begun = True
        return Odds(*_update((self.record, self._answer.record), self._known, (bias, unsure), accelerations))

    def forget(self) -> None:
        """Nothing is compared with what was before: free-drive is off, or the sensor was out."""
        own = self._own
        own["count"], own["lost"], own["stepped"], own["share"] = 0, -math.inf, -math.inf, 0.0


@kernel
def _update(records, known, bias, accelerations) -> tuple[float, float, float, float]:
    """One kernel: to call two takes as long as all that they do."""
    bank, step = records
    _compare(bank, known, bias, accelerations)
    answer(step, known, bank)
    return bank[0].lost, bank[0].share, step[0].odds, step[0].size


@kernel
def _compare(wrenches, known, bias, accelerations) -> None:
    forces, model = known
    wrench, doubt = bias
    own, felt = wrenches[0], forces[0]
    here = own.next
    own.R[here] = model[0].R
    p = own.p[here]
    needed((own.mass, own.com, own.inertia), (felt.specific, felt.gyro, felt.turn), p)
    p[LINE] = own.line[0] * p[0] + own.line[1] * p[1] + own.line[2] * p[2]
    for k in range(6):
        own.x[here, k] = felt.missing[k]
    turned = 0.0
    for k in range(3):
        own.felt[here, k] = felt.a_felt[k] if accelerations else np.nan
        turned += ((felt.gyro[k] - own.gyro[k]) / TICK) ** 2
        own.gyro[k] = felt.gyro[k]
    own.turn[here] = np.sqrt(max(turned - STRAY * own.jitter, 0.0)) if own.count else 0.0
    own.fastest = own.turn.max()
    own.spread[0], own.spread[1] = spread(own, 0.0), spread(own, LATE)
    for axis in range(2):
        unsure = noise(own, own.whole, axis, 0.0)
        own.steep[here, axis] = recent(own.x, (here, 3 * axis), unsure, own.before[here])
    own.ahead[here] = ahead(own, own.x[here], own.before[here], own.steep[here])
    own.next = (here + 1) % KEPT
    own.count = min(own.count + 1, KEPT)
    own.lost = own.stepped = -np.inf
    own.share = 0.0
    if own.count == KEPT and jumps(own, here):
        own.offset = math.hypot(own.walk, doubt)
        _weigh(own, here, wrench)


@kernel
def _add(own, seen, length, bias) -> None:
    """One tick more has been seen since the change, the earliest of `length`."""
    place = (own.next - length) % KEPT
    turned_x, turned_p = own.sums[10], own.sums[11]
    for k in range(6):
        turned_x[k] = own.x[place, k] - bias[k]
    turn_both(own.R[place], turned_x, turned_x)
    turn_both(own.R[place], own.p[place], turned_p)
    for k in range(6):
        x, p = turned_x[k], turned_p[k]
        seen.x[k] += x
        seen.xx[k] += x * x
        seen.later[k] += (length - 1) * x
        seen.p[k] += p
        seen.pp[k] += p * p
        seen.px[k] += p * x
    turned_p[LINE] = own.p[place, LINE]
    for k in range(LINE + 1):
        p = turned_p[k]
        if length == 1:
            seen.newest[k] = seen.oldest[k] = p
        seen.swing[k] += (p - seen.oldest[k]) ** 2
        seen.oldest[k] = p


@kernel
def _weigh(own, here, bias) -> None:
    """The odds, where all hypotheses explain the same ticks."""
    sums, before = own.sums, own.sums[9]
    sums[:] = 0.0
    seen = Seen(sums[0], sums[1], sums[2], sums[3], sums[4], sums[5], sums[6], sums[7], sums[8])
    earlier, change = 0.0, quiet(own)  # what is between two wrenches is explained as well as noise
    for age in range(LONGEST + 1):
        earlier += own.ahead[(here - age) % KEPT]
    # A hand changed as likely as not.
    other, lost, stepped = earlier + LN_ONSETS, -np.inf, -np.inf
    gone = jumped = -np.inf  # the likeliest of these
    earlier -= own.ahead[here]
    other = both(other, earlier + change)  # it came now: by what, no tick can tell yet
    for length in range(1, LONGEST + 1):
        first = (here - length) % KEPT  # the tick in which it came
        _add(own, seen, length, bias)
        for k in range(6):
            before[k] = own.before[first, k] - bias[k]
        turn_both(own.R[first], before, before)
        earlier -= own.ahead[first]
        if length < SHORTEST:
            other = both(other, earlier + change + anything(seen, length))
            continue
        known, steep = earlier + change, own.steep[first]
        total = anything(seen, length)
        for late in (0.0, LATE):
            rising, steady = hand(own, seen, (length, before, steep), late)
            total = both(both(total, nobody(own, seen, length, late)), both(rising, steady))
        any_step, size = sudden(own, seen, (length, before))
        other = both(both(other, known + total), known + any_step - LN_RARE)
        likelihood = known + any_step + unanswered(own, first, size)
        stepped = both(stepped, likelihood)
        if likelihood > jumped:
            jumped, own.step, own.age = likelihood, size, length
            for k in range(6):
                own.jump[k] = seen.x[k] / length - before[k]
        if own.mass > 0.0:
            for kind in (LOST, FREED, MORE):
                likelihood, carried, share = payload(own, seen, (length, before, steep), kind)
                if (share > 0.0) == (kind == MORE):
                    continue
                likelihood += known - LN_RARE if kind == MORE else known
                lost, other = both(lost, likelihood), both(other, likelihood - carried)
                if likelihood > gone:
                    gone, own.share = likelihood, share
    own.lost = lost - both(other, stepped)
    own.stepped = stepped - both(other, lost)
