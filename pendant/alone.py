"""Motion in free-drive that nobody causes (FD-19)."""

import math

from pendant.estimate import Estimate
from pendant.events import Values
from pendant.hand import CARRIED, Hand
from pendant.link_push import LinkPush
from pendant.modes import TICK
from pendant.parameters import Reference
from pendant.pose import norm
from pendant.settings import Unexplained, ticks

AWAY = 0.015
"""An arm at rest that nobody touches goes no farther on its own [m], however slowly: friction all but holds a wrong payload."""

UNFELT = 0.01
"""Without the flange sensor no farther once it counts as moving [m]: a light hand is not felt then, but an arm that breaks away
from its friction is as fast as a hand in 0.3 s."""

CREEPS = 0.5
"""Of the speed that counts as moving: of a slower arm nothing is said of who turns its joints."""


class Way:
    """From where an arm goes on its own, and what its joints feel meanwhile.

    Attributes:
        link: tells of a hand on a link since then; to be stepped while the arm moves.
    """

    __slots__ = ("_began", "link")

    def __init__(self, since: Reference, rated: tuple[float, ...]) -> None:
        """
        Args:
            since: what held at entry; the way begins there.
            rated: torque of each joint [N·m].
        """
        self._began = since.position
        self.link = LinkPush(since.torques, rated)

    @property
    def memory(self) -> tuple[object, ...]:
        """All of its state, to compare."""
        return (self._began, self.link.memory)

    def begin(self, estimate: Estimate) -> None:
        """It begins anew here."""
        self._began = tuple(estimate.p_BF.tolist())
        self.link.begin()

    def length(self, estimate: Estimate) -> float:
        """From there to where the flange is [m]."""
        return math.dist(self._began, estimate.p_BF.tolist())


class Alone:
    """Counts for how long, and how far, the arm moves and nobody moves it."""

    __slots__ = ("_allowed", "_at_rest", "_on", "_run", "_ticks", "_whole")

    def __init__(self, on: Unexplained, since: Reference, rated: tuple[float, ...]) -> None:
        """
        Args:
            on: settings.
            since: what held at entry.
            rated: torque of each joint [N·m].
        """
        self._on, self._allowed = on, ticks(on.time)
        self._ticks = 0  # in a row in which the arm moved and nobody moved it
        self._run = Way(since, rated)  # of these ticks
        self._at_rest = True  # before; nobody let it go while it moved
        self._whole = Way(since, rated)  # since it has been at rest

    @property
    def memory(self) -> tuple[object, ...]:
        """All of its state, to compare."""
        return (self._ticks, self._run.memory, self._at_rest, self._whole.memory)

    def step(self, estimate: Estimate, hand: Hand, use_wrench: bool, driven: bool) -> Values | None:
        """One tick; its joint values are finite. Returns what is told of a motion that has lasted too long, or None.

        Args:
            estimate: of this tick.
            hand: after its step.
            use_wrench: the flange sensor is used.
            driven: a wall or another device moves the arm, or holds it.
        """
        x, y, z = hand.user
        least = self._on.force
        if driven or x * x + y * y + z * z >= least * least:
            self._ticks, self._at_rest = 0, False
            return None
        vx, vy, vz = estimate.v_F.tolist()[:3]
        motion = norm((vx, vy, vz))
        way = self._beyond(estimate, motion, use_wrench)
        if way is None:
            return None
        if use_wrench and norm(hand.change) < CARRIED and way.link.told(estimate):
            self._ticks, self._at_rest = 0, False
            return None
        return {"distance": 1000.0 * way.length(estimate), "time": self._ticks * TICK, "limit": self._on.speed}

    def _beyond(self, estimate: Estimate, motion: float, use_wrench: bool) -> Way | None:
        """One tick in which nobody is felt at the flange, which has this speed [m/s]. Returns which way is too long."""
        run, whole = self._run, self._whole
        moves = motion >= self._on.speed
        if moves:
            if self._ticks == 0:
                run.begin(estimate)
            self._ticks += 1
            run.link.step(estimate)
        else:
            self._ticks = 0
            if not self._at_rest:
                self._at_rest = True
                whole.begin(estimate)
        if self._ticks > self._allowed:
            return run
        if not self._at_rest:
            return None
        if motion >= CREEPS * self._on.speed:
            whole.link.step(estimate)
        if use_wrench:
            return whole if whole.length(estimate) > AWAY else None
        return run if moves and run.length(estimate) > UNFELT else None
