"""Whether the joints feel what a suspected step of the flange sensor tells (FD-19).

A step of the sensor is first known by its onset (`sim.flange.wrench_steps`), from 20 ms that may not be enough: one of 5 N may
seem a hand's, where a heavy load makes noise. So the joints are asked unless a hand is as sure as a step has to be. They answer
later: first the arm swings on its springs. From then on they feel a force at the flange, and not a step of its sensor; they are
heard for as long as that took, and averaged, for the arm swings on. With the sensor's wrench w, the flange's Jacobian J and the
external torques tau_ext of the joints, the torques

    d = J' w - tau_ext

are as they were before if a force came, and are off by t = J' s if the sensor stepped by s. Either way each joint's d is known
as well as it was steady before, and the gears as well as their stiffness. The odds of the onset are multiplied by

    exp(-|d - d0 - t|² / 2) / exp(-|d - d0|² / 2),    |x|² = sum of (x_i / sigma_i)²,

but what neither explains is no evidence.
"""

import math

import numpy as np

from pendant.guided.user_force import JOINTS_SWING
from pendant.sensor.hand_model import KNOWN, SUSPECTED
from pendant.settings.schema import ticks
from pendant.tick.modes import TICK
from sim.compiled.kernel import kernel
from sim.compiled.record import record
from sim.flange.wrench_hypotheses import LONGEST

ANSWER = ticks(JOINTS_SWING)
"""Ticks after which the joints have answered: the arm has swung on its springs."""

LATELY = TICK / JOINTS_SWING
"""Weight of a tick in what d was lately, and in how steady."""

BRIEF = 0.2 * ANSWER
"""Ticks over which d is averaged until the joints have answered; then over all of the answer, for the arm still swings."""

KEPT = LONGEST + 2
"""Ticks for which it is known what was lately: the onset of a step is so old at most."""

NEITHER = math.exp(-KNOWN)


class StepAnswer:
    """What is kept of a suspected step, for n joints; `answer` is one tick of it, in free-drive alone."""

    def __init__(self, n: int, stiffness: float) -> None:
        """`stiffness` is what the gears' stiffness may be wrong by, relative to it."""
        self.record = record(
            stiffness=(),
            lately=(n,),  # mean of d
            unrest=(n,),  # and its variance
            now=(n,),  # mean of d in the last ticks
            means=(KEPT, n),  # what was lately, in the last ticks
            variances=(KEPT, n),
            before=(n,),  # ahead of the step
            variance=(n,),
            step=(n,),  # t
            next="i8",
            count="i8",
            since="i8",  # ticks since the onset; 0: no step is looked at
            onset=(),  # odds by it
            odds=(),  # log of those that the sensor stepped [nats]: of the onset, then with what the joints say of it
            size=(),  # of the step [N]
        )
        self._own = self.record[0]
        self._own["stiffness"] = stiffness
        self.forget()

    def forget(self) -> None:
        """Nothing is suspected: free-drive is off, or the sensor was out."""
        own = self._own
        own["count"], own["since"], own["odds"] = 0, 0, -math.inf


@kernel
def answer(answers, known, wrenches) -> None:
    """One tick, after the odds of it.

    Args:
        answers: `StepAnswer.record`.
        known: `FlangeForces.record` and that of the rigid model, of the same tick.
        wrenches: `ExternalWrench.record`.
    """
    forces, model = known
    own, felt, wrench = answers[0], forces[0], wrenches[0]
    here, first = own.next, own.count == 0
    for i in range(own.lately.size):
        if first:
            own.lately[i] = own.now[i] = felt.apart[i]
            own.unrest[i] = 0.0
        off = felt.apart[i] - own.lately[i]
        own.lately[i] += LATELY * off
        own.unrest[i] += LATELY * (off * off - own.unrest[i])
        own.now[i] += max(1.0 / (BRIEF + max(own.since - ANSWER, 0)), LATELY) * (felt.apart[i] - own.now[i])
        own.means[here, i], own.variances[here, i] = own.lately[i], own.unrest[i]
    own.next, own.count = (here + 1) % KEPT, min(own.count + 1, KEPT)
    if own.since:
        own.since += 1
    if wrench.stepped >= -KNOWN and own.since <= LONGEST and (own.since == 0 or wrench.stepped > own.onset):
        _begin(own, wrench, model[0], (here - wrench.age) % KEPT)
    own.odds = wrench.stepped
    if own.since:
        own.odds = own.onset + (_answered(own) if own.since > ANSWER else 0.0)
        if own.since > 2 * ANSWER and own.odds < -SUSPECTED:
            own.since = 0


@kernel
def _begin(own, wrench, rigid, before) -> None:
    """A step may have come; `before` is the place of the tick before it."""
    own.onset, own.since, own.size = wrench.stepped, wrench.age, wrench.step
    for i in range(own.step.size):
        own.step[i] = 0.0
        for k in range(6):
            own.step[i] += rigid.jacobian[k, i] * wrench.jump[k]
        own.before[i], own.variance[i] = own.means[before, i], own.variances[before, i]


@kernel
def _answered(own):
    """Log of how much likelier what the joints feel is if the sensor stepped, than if a force came."""
    stepped = force = 0.0
    for i in range(own.step.size):
        off, step = own.now[i] - own.before[i], own.step[i]
        variance = own.variance[i] + (own.stiffness * step) ** 2
        force += off * off / variance
        stepped += (off - step) ** 2 / variance
    return np.log((np.exp(-0.5 * stepped) + NEITHER) / (np.exp(-0.5 * force) + NEITHER))
