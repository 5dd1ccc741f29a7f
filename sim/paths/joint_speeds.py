"""Joint speeds from one tick to the next, compiled: within speed and acceleration, and so that all can stop in their range."""

import math

from pendant.tick.modes import TICK
from sim.compiled.kernel import kernel

BRAKING_SHARE = 0.5
"""Of a joint's acceleration, with which the end of its range is kept off."""

SLOWEST = 1e-9
"""A joint that is slower stands [rad/s]."""


@kernel
def shares(q, qd, limits):
    """The share of joint speeds from which all, slowing down together, stop in their range; and that which is not too fast.

    With r the greatest rate at which all can slow down, a joint that goes at v stops after v / 2r; in its last ticks it goes half
    of what is left.

    Args:
        q: angles (n,) [rad].
        qd: speeds (n,) [rad/s].
        limits: speed and acceleration (n,), smallest and largest angle (2, n).
    """
    speed, acceleration, position = limits
    time, rate, fast = math.inf, math.inf, math.inf
    for i in range(q.size):
        size = abs(qd[i])
        if size > SLOWEST:
            left = position[1, i] - q[i] if qd[i] > 0.0 else q[i] - position[0, i]
            time = min(time, left / size)
            rate = min(rate, acceleration[i] / size)
            fast = min(fast, speed[i] / size)
    if time == math.inf:
        return math.inf, math.inf
    time = max(time, 0.0)
    return min(math.sqrt(2.0 * BRAKING_SHARE * rate * time), 0.5 * time / TICK), fast


@kernel
def tick_later(q, before, aim, limits) -> None:
    """Joint speeds a tick later, from those before towards `aim`, all in the same proportion; `aim` becomes them.

    Where that leads one joint out of its range, for another asks for most, all slow down together as hard as they can.
    """
    acceleration = limits[1]
    most, hardest = 0.0, math.inf
    for i in range(q.size):
        most = max(most, abs(aim[i] - before[i]) / (acceleration[i] * TICK))
        hardest = min(hardest, acceleration[i] * TICK / max(abs(before[i]), SLOWEST))
    if most <= 1.0:
        return
    for i in range(q.size):
        aim[i] = before[i] + (aim[i] - before[i]) / most
    if shares(q, aim, limits)[0] < 1.0:
        for i in range(q.size):
            aim[i] = max(1.0 - hardest, 0.0) * before[i]
