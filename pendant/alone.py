"""Motion in free-drive that nobody causes (FD-19)."""

from pendant.estimate import Estimate
from pendant.events import Values
from pendant.hand import CARRIED, Hand
from pendant.link_push import LinkPush
from pendant.modes import TICK
from pendant.pose import ORIGIN, Vector, norm
from pendant.settings import Unexplained, ticks

AWAY = 0.01
"""Without the flange sensor an arm at rest that nobody touches goes no farther on its own [m]: a payload that friction held has
broken away, and in 0.3 s it is as fast as a hand."""


class Alone:
    """Counts for how long, and how far, the arm moves and nobody moves it."""

    __slots__ = ("_allowed", "_at_rest", "_began", "_link", "_on", "_ticks")

    def __init__(self, on: Unexplained, torques: tuple[float, ...], rated: tuple[float, ...]) -> None:
        """
        Args:
            on: settings.
            torques: tau_ext at entry [N·m].
            rated: torque of each joint [N·m].
        """
        self._on, self._allowed = on, ticks(on.time)
        self._ticks = 0  # in a row in which the arm moved and nobody moved it
        self._at_rest = True  # before these; nobody let it go while it moved
        self._began: Vector = ORIGIN  # where the flange was then, in B [m]
        self._link = LinkPush(torques, rated)

    @property
    def memory(self) -> tuple[object, ...]:
        """All of its state, to compare."""
        return (self._ticks, self._at_rest, self._began, self._link.memory)

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
        if motion < self._on.speed:
            self._ticks, self._at_rest = 0, True
            return None
        link = self._link
        px, py, pz = estimate.p_BF.tolist()
        if self._ticks == 0:
            link.begin()
            self._began = (px, py, pz)
        self._ticks += 1
        link.step(estimate)
        x, y, z = self._began
        away = self._at_rest and not use_wrench and norm((px - x, py - y, pz - z)) > AWAY
        if self._ticks <= self._allowed and not away:
            return None
        if use_wrench and norm(hand.change) < CARRIED and link.told(estimate):
            self._ticks = 0
            return None
        return {"value": motion, "limit": self._on.speed, "time": self._ticks * TICK}
