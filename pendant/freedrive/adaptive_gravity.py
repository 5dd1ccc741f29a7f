"""Balancing an arm that is refused free-drive: its gravity torque adapts until it is static, then it is held (FD-10)."""

import math
from typing import NamedTuple

from pendant.context import Surroundings
from pendant.events.event import Event, Kind, Values
from pendant.events.happened import Happened, Transition, becomes
from pendant.limits.residual import mass_error, split, upward
from pendant.limits.settings import Static
from pendant.settings.schema import ticks
from pendant.tick.modes import TICK
from pendant.tick.pose import Vector

SETTLES = 0.3
"""The torque takes so long to adapt, whether the arm moves or not: six time constants of the law [s]."""

LONGEST = 2.0
"""An arm that is not static by then is held all the same [s]."""

FAR = 0.01
"""One whose flange has gone so far is held at once [m], so that it comes to rest within 0.03 m."""


class Balance(NamedTuple):
    """What the control law is to do, in every tick of it."""

    up: Vector  # against gravity, axes of B
    force: bool  # the flange's sensor knows the load; else the joints do


class Compensation:
    """One of it.

    Attributes:
        balance: for the control law; the same object as long as it says the same.
        left: ticks that it may last.
        total: ticks that it may last in all.
    """

    __slots__ = ("_least", "_origin", "_refusal", "balance", "left", "total")

    def __init__(self, refusal: Event, around: Surroundings) -> None:
        """
        Args:
            refusal: what it ends with.
            around: the tick in which a limit was exceeded; its joint values are finite.
        """
        estimate = around.estimate
        self._refusal = refusal
        self._origin = tuple(estimate.p_BF.tolist())
        self.balance = Balance(upward(estimate.g_B.tolist()), around.wrench_ok)
        self.left = self.total = ticks(LONGEST)
        self._least = ticks(LONGEST) - ticks(SETTLES)

    def begun(self, tick: int) -> Event:
        """That it begins."""
        return Event(Kind.COMPENSATING, tick, {"period": self.total * TICK})

    def step(self, around: Surroundings, static: Static) -> Happened:
        """One tick; its joint values are finite. It ends with what came of it and the refusal."""
        self.left -= 1
        if around.wrench_ok is not self.balance.force:
            self.balance = self.balance._replace(force=around.wrench_ok)
        x, y, z = around.estimate.p_BF.tolist()
        x0, y0, z0 = self._origin
        way = math.hypot(x - x0, y - y0, z - z0)
        rests = self.left <= self._least and around.still.count >= ticks(static.time)
        if not rests and way <= FAR and self.left > 0:
            return Happened([])
        tick, refusal = around.estimate.tick, self._refusal
        kind = Kind.COMPENSATED if rests else Kind.NOT_COMPENSATED
        events = [Event(kind, tick, {"moved": 1000.0 * way, "time": (self.total - self.left) * TICK})]
        if rests and around.wrench_ok:
            force = split(around.mean.mean(), self.balance.up).payload_force
            values: Values = {"mass": mass_error(force), "force": abs(force), "way": "up" if force > 0.0 else "down"}
            events.append(Event(Kind.LOAD_FOUND, tick, values))
        return becomes(Transition.REFUSED, Event(refusal.kind, tick, refusal.values), events)
