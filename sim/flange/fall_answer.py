"""Whether what followed a suspected change of the payload goes on as it would (FD-19).

A change of the payload is first known by its onset (`sim.flange.external_wrench`), from 20 ms that may not be enough: a guided
hand that lets go with it hides the fall of a light one. Later, too, a payload that is gone is missed evenly. With x, p and the
share s as there, axes of B, the means of

    y = x - s p    if the payload changed, or of    y = x    if a hand did,

over `LONGEST` ticks are as they were after the onset, within the noise R of two such means, or within a hand's tremor, too:

    payload    (1 - e) N(0, R) + e N(0, R + H),        hand    N(0, R + T) / 2 + N(0, R + H) / 2,

with a hand's tremor T and what its wrench can be, H; e says how often a hand comes within that time. The odds of the onset are
multiplied by the ratio of these, again and again, until one of them is sure enough.
"""

import math

import numpy as np

from pendant.sensor.hand_model import LARGEST, TREMOR
from pendant.sensor.odds import HALF, KNOWN, SUSPECTED
from sim.compiled.kernel import kernel
from sim.compiled.record import record
from sim.flange.external_wrench import in_base
from sim.flange.wrench_hypotheses import LATE, LONGEST, RARE, lever_of, noise
from sim.flange.wrench_steps import both

LN_HALF = math.log(HALF)
LN_COMES, LN_STAYS = math.log(LONGEST * RARE), math.log(1.0 - LONGEST * RARE)


class FallAnswer:
    """What is kept of a suspected change of the payload; `follow` is one tick of it, in free-drive alone."""

    def __init__(self) -> None:
        self.record = record(
            after=(2, 6),  # mean of y after the onset, if the payload changed, and if a hand did [N, N·m]
            sums=(2, 6),  # of y since the last time that it was compared
            since="i8",  # ticks that these are of
            follows="i8",  # 1: a change is followed
            followed=(),  # its odds
            gone=(),  # its share
            odds=(),  # log of those that it changed [nats]: of the onset, or with what followed
            share=(),  # of the payload that is gone then
        )
        self._own = self.record[0]
        self.forget()

    def forget(self) -> None:
        """Nothing is suspected: free-drive is off, or the sensor was out."""
        self._own["follows"], self._own["odds"], self._own["share"] = 0, -math.inf, 0.0


@kernel
def follow(answers, wrenches, bias) -> None:
    """One tick, after `compare`.

    Args:
        answers: `FallAnswer.record`.
        wrenches: `ExternalWrench.record`.
        bias: of the sensor (6,), axes of F [N, N·m].
    """
    own, wrench = answers[0], wrenches[0]
    kept = wrench.x.shape[0]
    here = (wrench.next - 1) % kept
    if own.follows:
        _add(own, wrench, here, bias)
        own.since += 1
        if own.since == LONGEST:
            own.followed += _goes_on(own, wrench)
            own.sums[:] = 0.0
            own.since = 0
            if own.followed < 0.0:
                own.follows = 0
    elif SUSPECTED <= wrench.lost < KNOWN and wrench.lost_age == LONGEST:
        # In the next tick the onset is out of sight.
        own.follows, own.since, own.followed, own.gone = 1, 0, wrench.lost, wrench.share
        own.sums[:] = 0.0
        for age in range(LONGEST):
            _add(own, wrench, (here - age) % kept, bias)
        own.after[:] = own.sums / LONGEST
        own.sums[:] = 0.0
    own.odds, own.share = wrench.lost, wrench.share
    if own.follows and own.followed > wrench.lost:
        own.odds, own.share = own.followed, own.gone


@kernel
def _add(own, wrench, place, bias) -> None:
    """One tick's y, both ways."""
    x, p = np.empty(6), np.empty(7)
    in_base(wrench, place, bias, (x, p))
    for k in range(6):
        own.sums[0, k] += x[k] - own.gone * p[k]
        own.sums[1, k] += x[k]


@kernel
def _goes_on(own, wrench):
    """Log of how much likelier the last mean is if the payload changed, than if a hand did."""
    payload = hand = comes = goes = 0.0
    for axis in range(2):
        lever = lever_of(axis)
        R = 2.0 * noise(wrench, wrench.whole, axis, LATE) / LONGEST
        tremor, anything = R + (TREMOR * lever) ** 2, R + (0.5 * LARGEST * lever) ** 2
        fallen = held = 0.0
        for k in range(3 * axis, 3 * axis + 3):
            fallen += (own.sums[0, k] / LONGEST - own.after[0, k]) ** 2
            held += (own.sums[1, k] / LONGEST - own.after[1, k]) ** 2
        payload -= 0.5 * fallen / R + 1.5 * np.log(R)
        hand -= 0.5 * held / tremor + 1.5 * np.log(tremor)
        comes -= 0.5 * fallen / anything + 1.5 * np.log(anything)
        goes -= 0.5 * held / anything + 1.5 * np.log(anything)
    return both(payload + LN_STAYS, comes + LN_COMES) - both(hand, goes) - LN_HALF
