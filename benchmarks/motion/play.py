"""A random motion is asked of the references, as a robot's controller asks them, and looked at in every tick."""

import copy
import math
import re
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from benchmarks.motion.draw import Draw
from benchmarks.motion.drawn import JOGGED, Drawn, arm_of, tool_pose
from benchmarks.motion.robot import decision, model, standing
from benchmarks.motion.said import Begin, Pose, apart, says
from pendant.decision import Decision
from pendant.motion.script_requests import ServoJoints, ServoTool, SpeedJoints, SpeedTool
from pendant.program.jog_move import JogMove
from pendant.program.steps import Move
from pendant.tick.modes import TICK, Law
from sim.motion.blend import Blended
from sim.motion.moves import SHORTEST_STOP, Stop, beyond
from sim.motion.references import References
from sim.paths.curves import LEVER
from sim.sensing.calibration import nominal

Array = NDArray[np.float64]

LONGEST = 20.0  # of a motion that is stepped to its end [s]
POINTS = 200  # of the plan of a longer one that are looked at
OFF, TURNED = 1e-4, math.radians(0.01)  # that a motion may end away from where it says [m], [rad]
NUMBER = re.compile(r"-?\d+(\.\d+)?(e-?\d+)?")
FIRST = 2  # number of the first motion that is looked at
STANDS = 1e-4  # slower a stream has come to rest [rad/s]
SELDOM = 25  # ticks between looks whether it is there
STREAMED = ServoJoints | ServoTool | SpeedJoints | SpeedTool

FAST = 1.001
"""Times its limit, that a joint's speed may be: a path is looked at in places."""

STEEP = 1.1
"""Times its acceleration limit and a tick, that a joint's speed may change in a tick: a path's bends are looked at in places."""

GRAIN = 1e-9
"""Of the rounding in a tick's change of angle [rad]."""


class Outcome(NamedTuple):
    """What came of a motion."""

    number: int
    arm: str
    kind: str
    start: str
    reason: str  # why it was refused, or ended before its end; its numbers are gone
    failure: str  # of what must hold; "" for none
    off: float  # from where it says, at its end [m]
    turned: float  # likewise [rad]
    fast: float  # largest speed of a joint over its limit
    steep: float  # largest change of speed in a tick, over what may be
    gap: float  # largest way in a tick that is not its speed's, over what may be
    ticks: int
    stepped: bool  # to its end; else its plan was looked at


def play(seed: int, number: int, longest: float = LONGEST) -> Outcome:
    """Draw a motion, ask for it, look at it. One that lasts for more than `longest` [s] is not stepped to its end."""
    player = Player(Draw(seed, number).case(), longest)
    try:
        player.run()
    except Exception as error:  # noqa: BLE001 - that there is none is what is measured
        player.failures.append(f"raises {type(error).__name__}: {error}")
    return player.outcome(number)


class Player:
    """The references of one arm, and what they were."""

    def __init__(self, drawn: Drawn, longest: float) -> None:
        self.drawn, self.arm, self._longest = drawn, arm_of(drawn.arm), longest
        limits = self.arm.limits
        self.speed, self.most, self.position = np.array(limits.speed), np.array(limits.acceleration), np.array(limits.ends).T
        self.references = References(
            self.arm, nominal(self.arm), model(drawn.arm), tcp=drawn.tcp.astype(float), R_FT=drawn.R_FT.copy()
        )
        self.seen = standing(drawn.q)
        self.rows: list[tuple[Array, Array]] = []
        self.stops: list[Stop | None] = []  # that leads, and brakes with what torque there is
        self.failures: list[str] = []
        self.reason = ""
        self.said: Pose | None = None
        self.stepped = True

    def run(self) -> None:
        """From the begin to the end of what was drawn."""
        drawn = self.drawn
        self.tick(self._decision(Law.HOLD, None))
        if drawn.first is not None:
            decision = self._decision(Law.FOLLOW, drawn.first)
            for _ in range(drawn.after):
                self.tick(decision)
                if self.references.refusal:
                    break
            if drawn.kind in JOGGED:
                self.rest()
        for k, move in enumerate(drawn.moves):
            if not self.follow(move, last=k == len(drawn.moves) - 1):
                break
        if self.reason or drawn.kind.startswith("jog") or drawn.kind.startswith("speed"):
            self.rest()

    def follow(self, move: Move, last: bool) -> bool:
        """A motion until it is done; False: it has ended for another reason."""
        references, decision = self.references, self._decision(Law.FOLLOW, move)
        leaves = self.said if move.id > FIRST and references.move_done == move.id - 1 else None
        begin = Begin(len(self.rows), self.rows[-1][0], leaves or self._tool())
        for k in range(round(self._held(move) / TICK)):
            self.tick(decision)
            if k == 0:
                motion = references.motion
                if isinstance(motion, Blended) and isinstance(motion.first, Stop):
                    begin = begin._replace(pose=tool_pose(self.arm, motion.first.goal, self.drawn.tcp))
                self.said = says(move, self.drawn, begin)
            if references.refusal:
                self.reason, self.said = references.refusal, None
                return False
            if k == 0 and self._long():
                return False
            if self._arrived(move, k) if isinstance(move, STREAMED) else self._done(move, last):
                return True
        if self.said is not None or isinstance(move, STREAMED):
            self.stepped = False
            self._check(self._takes_long(move, begin), "does not end")
            self.said = None
        return False

    def tick(self, decision: Decision) -> None:
        """One reference."""
        q, qd, _ = self.references.step(self.seen, decision)
        self.seen.q[:], self.seen.qd[:] = q, qd
        motion = self.references.motion
        self.rows.append((q, qd))
        leads = motion.first if isinstance(motion, Blended) else motion
        self.stops.append(leads if isinstance(leads, Stop) else None)

    def rest(self) -> None:
        """The arm brakes until it stands."""
        decision = self._decision(Law.BRAKE, None)
        for _ in range(2500):
            self.tick(decision)
            if not self.rows[-1][1].any():
                return
        self.failures.append("does not come to rest")

    def outcome(self, number: int) -> Outcome:
        """What is measured of the rows, against what may be."""
        drawn = self.drawn
        off = turned = fast = steep = gap = 0.0
        if len(self.rows) > 1:
            q, qd = (np.array(values) for values in zip(*self.rows, strict=True))
            if not (np.isfinite(q).all() and np.isfinite(qd).all()):
                self.failures.append("is not finite")
            else:
                fast, steep, gap = self._continuity(q, qd)
                self._check(fast <= FAST, "joint speed")
                self._check(steep <= STEEP, "step in speed")
                self._check(gap <= STEEP, "step in position")
                self._check(bool((beyond(q, self.position) <= GRAIN).all()), "range")
            if self.said is not None and not self.failures:
                off, turned = apart(self._tool(), self.said)
                self._check(off <= OFF and turned <= TURNED, "ends elsewhere")
        reason, failure = re.sub(NUMBER, "#", self.reason), "; ".join(self.failures)
        measured = (off, turned, fast, steep, gap, len(self.rows), self.stepped)
        return Outcome(number, drawn.arm, drawn.kind, drawn.start, reason, failure, *measured)

    def _continuity(self, q: Array, qd: Array) -> tuple[float, float, float]:
        """Speed, change of speed and way of a tick that is not its speed's, over what may be.

        The speed changes by the acceleration times a tick at most; a stop, half a cosine, brakes by pi/2 of its mean. Within a
        tick the speed lies between that at its begin and that at its end, or beyond them by what half a tick makes of it.
        """
        change, way = np.diff(qd, axis=0), np.diff(q, axis=0) - 0.5 * TICK * (qd[1:] + qd[:-1])
        most = np.broadcast_to(self.most, change.shape).copy()
        begin = np.zeros(q.shape[1])
        for k, (before, stop) in enumerate(pairwise(self.stops)):
            if stop is not None:
                begin = begin if stop is before else np.abs(qd[k])
                most[k] = 0.5 * math.pi * np.maximum(self.most, begin / SHORTEST_STOP)
        return (
            float((np.abs(qd) / self.speed).max()),
            float((np.abs(change) / (most * TICK)).max()),
            float((np.abs(way) / (0.5 * TICK**2 * most + GRAIN)).max()),
        )

    def _decision(self, law: Law, move: Move | None) -> Decision:
        return decision(law, move, self.drawn)

    def _check(self, holds: bool, what: str) -> None:
        if not holds:
            self.failures.append(what)

    def _tool(self) -> tuple[Array, Array]:
        return tool_pose(self.arm, self.rows[-1][0], self.drawn.tcp)

    def _held(self, move: Move) -> float:
        """For how long a motion is asked for, at most [s]; a button is held for any time."""
        if isinstance(move, JogMove) and move.length == 0.0:
            return min(0.2 + 3.0 * self.drawn.held, self._longest)
        return self._longest + 2.0 * TICK

    def _takes_long(self, move: Move, begin: Begin) -> bool:
        """Whether a motion without a plan, or one that is slowed down, may take longer than it was asked for."""
        drawn = self.drawn
        slowed = drawn.share < 1.0 or drawn.limits is not None
        if self._longest < LONGEST or isinstance(move, ServoJoints):
            return self._longest < LONGEST or slowed
        if isinstance(move, ServoTool) and self.said is not None:
            places = [tool_pose(self.arm, q, drawn.tcp) for q, _ in self.rows[begin.row :: 500]]
            off, turned = (max(values) for values in zip(*(apart(place, self.said) for place in places), strict=True))
            way, fastest = max(off, LEVER * turned), drawn.share * min(move.speed, 0.1 if drawn.limits else math.inf)
            return way / fastest + 3.0 * math.sqrt(way / move.acceleration) > 0.5 * LONGEST
        return not isinstance(move, STREAMED) and (slowed or drawn.kind in JOGGED)

    def _done(self, move: Move, last: bool) -> bool:
        """A planned motion is done: where another follows, it has come to where that may begin."""
        return self.references.move_done == move.id and not (last and bool(self.rows[-1][1].any()))

    def _arrived(self, move: Move, tick: int) -> bool:
        """A stream has come to rest, and where it should."""
        standing = float(np.abs(self.rows[-1][1]).max()) < STANDS
        if isinstance(move, SpeedJoints | SpeedTool):
            return tick * TICK > move.time and standing
        if not standing or tick % SELDOM or self.said is None:
            return False
        off, turned = apart(self._tool(), self.said)
        return off <= 0.5 * OFF and turned <= 0.5 * TURNED

    def _long(self) -> bool:
        """Whether the motion is too long to be stepped; then its plan is looked at."""
        motion = copy.copy(self.references.motion)
        remaining: float = getattr(motion, "remaining", 0.0)
        if isinstance(motion, Stop) or remaining <= self._longest:
            return False
        assert motion is not None
        assert self.said is not None
        self.stepped = False
        stride = remaining / TICK / POINTS
        before = self.rows[-1][0]
        for _ in range(POINTS + 2):
            q = motion.step(stride).q  # type: ignore[attr-defined]
            self._check(bool((np.abs(q - before) <= FAST * self.speed * stride * TICK + GRAIN).all()), "joint speed of the plan")
            self._check(bool((beyond(q, self.position) <= GRAIN).all()), "range of the plan")
            before = q
        off, turned = apart(tool_pose(self.arm, before, self.drawn.tcp), self.said)
        self._check(motion.done and off <= OFF and turned <= TURNED, "plan ends elsewhere")
        self.said = None
        return True
