"""Motion in free-drive that nobody causes (FD-19)."""

import math

from pendant.estimate import Estimate
from pendant.events import Values
from pendant.hand import CARRIED, Hand
from pendant.modes import TICK
from pendant.parameters import Reference
from pendant.pose import Vector, norm
from pendant.settings import Unexplained, ticks
from pendant.work import Work

AWAY = 0.015
"""An arm at rest that nobody touches goes no farther on its own [m], however slowly: friction all but holds a wrong payload."""

UNFELT = 0.01
"""Without the flange sensor no farther once it counts as moving [m]: a light hand is not felt then, but an arm that breaks away
from its friction is as fast as a hand in 0.3 s."""


class Way:
    """From where an arm goes on its own, and the work that is done on it meanwhile.

    Attributes:
        work: since then; to be stepped while the arm moves.
    """

    __slots__ = ("_began", "work")

    def __init__(self, since: Reference) -> None:
        """
        Args:
            since: what held at entry; the way begins there.
        """
        self._began = since.position
        self.work = Work(since.torques)

    @property
    def memory(self) -> tuple[object, ...]:
        """All of its state, to compare."""
        return (self._began, self.work.memory)

    def begin(self, estimate: Estimate) -> None:
        """It begins here."""
        self._began = tuple(estimate.p_BF.tolist())
        self.work.begin(estimate)

    def length(self, estimate: Estimate) -> float:
        """From there to where the flange is [m]."""
        return math.dist(self._began, estimate.p_BF.tolist())


class Alone:
    """Counts for how long, and how far, the arm moves and nobody moves it.

    Attributes:
        led: by a hand on a link, which pays for the motion.
        doubtful: half of that time has gone by: nothing helps the motion on, so that who leads it pushes, and else it ends.

    A stretch of motion without a hand at the flange begins afresh whenever all of it was paid for by a hand on a link
    (`pendant.work`).
    """

    __slots__ = ("_allowed", "_at_rest", "_on", "_stretch", "_ticks", "_whole", "doubtful", "led")

    def __init__(self, on: Unexplained, since: Reference) -> None:
        """
        Args:
            on: settings.
            since: what held at entry.
        """
        self._on, self._allowed = on, ticks(on.time)
        self._ticks = 0  # of the stretch
        self._stretch = Way(since)
        self._at_rest = True  # before; nobody let it go while it moved
        self._whole = Way(since)  # since it has been at rest
        self.led = self.doubtful = False

    @property
    def memory(self) -> tuple[object, ...]:
        """All of its state, to compare."""
        return (self._ticks, self._stretch.memory, self._at_rest, self._whole.memory, self.doubtful, self.led)

    def step(self, estimate: Estimate, hand: Hand, use_wrench: bool, driven: bool, slack: float = 0.0) -> Values | None:
        """One tick; its joint values are finite. Returns what is told of a motion that has lasted too long, or None.

        Args:
            estimate: of this tick.
            hand: after its step.
            use_wrench: the flange sensor is used.
            driven: a wall or another device moves the arm, or holds it.
            slack: what of a force at the flange may be the sensor's drift [N].
        """
        x, y, z = hand.user
        least = self._on.force + slack
        if driven or x * x + y * y + z * z >= least * least:
            self._ticks, self._at_rest = 0, False
            self.led = self.doubtful = False
            return None
        vx, vy, vz = estimate.v_F.tolist()[:3]
        # Work on a link counts while the flange sensor rules out that it is the weight of what hangs there.
        x, y, z = hand.usual
        usual = norm((x, y, z))
        by_link = use_wrench and usual < CARRIED + slack
        share = max(1.0 - slack / usual, 0.0) if by_link and usual > 0.0 else 0.0
        force = (share * x, share * y, share * z)
        way = self._beyond(estimate, force, norm((vx, vy, vz)), use_wrench, by_link)
        if way is None:
            return None
        return {"distance": 1000.0 * way.length(estimate), "time": self._ticks * TICK, "limit": self._on.speed}

    def _beyond(self, estimate: Estimate, force: Vector, speed: float, use_wrench: bool, by_link: bool) -> Way | None:
        """One tick in which no more than this force [N] is felt at the flange, which has this speed [m/s].

        Returns which way is too long.
        """
        stretch, whole = self._stretch, self._whole
        moves = speed >= self._on.speed
        if moves:
            if self._ticks == 0:
                stretch.begin(estimate)
            self._ticks += 1
            stretch.work.step(estimate, force)
        else:
            self._ticks = 0
            if not self._at_rest:
                self._at_rest = True
                whole.begin(estimate)
        if self._at_rest:
            whole.work.step(estimate, force)
            too_far = whole.length(estimate) > AWAY if use_wrench else moves and stretch.length(estimate) > UNFELT
            if too_far and not (by_link and whole.work.paid):
                return whole if use_wrench else stretch
            self._at_rest = not too_far
        self.led = moves and by_link and stretch.work.settled
        if self.led or not moves:
            self._ticks, self.doubtful = 0, False
            return None
        self.doubtful = self.doubtful or (by_link and stretch.work.lasts(self._allowed // 2))
        lasted = stretch.work.lasts(self._allowed) if by_link else self._ticks > self._allowed
        return stretch if lasted else None
