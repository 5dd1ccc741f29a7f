"""Random motions: what is asked for, from where, and at what speed."""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from app.files.library import robots
from benchmarks.motion.drawn import KINDS, STARTS, Drawn, arm_of, tool_pose
from pendant.motion.script_requests import (
    GentleStop,
    ScriptedArc,
    ScriptedJoints,
    ScriptedLine,
    ScriptedProcess,
    ServoJoints,
    ServoTool,
    SpeedJoints,
    SpeedTool,
)
from pendant.program.jog_move import JogMove, MoveStraight, MoveThere
from pendant.program.steps import JointMove, LinearMove, Move
from pendant.safety.robot_limits import SpeedLimits
from pendant.tick.modes import TICK
from sim.arm.arm_file import Arm
from sim.arm.frames import quaternion_from_matrix, rotation_by

Array = NDArray[np.float64]

RAMP = 0.1  # a planned motion reaches its acceleration in this time [s]
ULPS = 4  # that an exact length is off by, at most

SHARES = (0.4, 0.25, 0.1, 0.1, 0.15)  # of `STARTS`


class Pace(NamedTuple):
    """Of a motion [m/s, m/s²], or of its joint with the longest way."""

    speed: float
    acceleration: float
    length: float


class Draw:
    """What is drawn for one case.

    Args:
        seed: of the bench.
        number: of the case.
    """

    def __init__(self, seed: int, number: int) -> None:
        self._rng = np.random.default_rng([seed, number, 60])

    def case(self) -> Drawn:
        """All of it."""
        rng = self._rng
        name, kind = str(rng.choice(list(robots()))), str(rng.choice(KINDS))
        start = str(rng.choice(STARTS, p=SHARES))
        arm = arm_of(name)
        q, tcp = self._posture(arm, start), rng.uniform(-0.2, 0.2, 3) * (rng.random() < 0.7)
        R_FT = rotation_by(rng.normal(size=3)) if rng.random() < 0.5 else np.eye(3)
        first, after = None, 0
        if start == "moving" or kind == "stop":
            first, after = self._before(arm, q), int(rng.integers(1, 400))
        share = float(rng.uniform(0.05, 1.0)) if rng.random() < 0.1 else 1.0
        limits = SpeedLimits(0.25, 0.25, (1.0,) * arm.n) if rng.random() < 0.1 else None
        return Drawn(
            name, kind, start, q, tcp, R_FT, first, after, self._moves(arm, kind, q, (tcp, R_FT)), share, limits, rng.random()
        )

    def _posture(self, arm: Arm, start: str) -> Array:
        rng, home, most = self._rng, np.array(arm.chain.home), np.array(arm.limits.ends)
        if start in ("home", "moving"):
            return home + rng.uniform(-0.6, 0.6, arm.n)
        q = rng.uniform(np.maximum(most[:, 0], -math.pi), np.minimum(most[:, 1], math.pi))
        near = float(rng.choice([0.0, 1e-9, 10.0 ** rng.uniform(-9.0, -2.0)]))
        if start == "joint limit":
            ends = rng.random(arm.n) < 0.3
            ends[rng.integers(arm.n)] = True
            side = rng.choice([-1.0, 1.0], arm.n)
            q[ends] = (np.where(side > 0.0, most[:, 1], most[:, 0]) - side * near)[ends]
        elif start == "singular":  # elbow stretched, wrist aligned
            q[int(rng.choice([2, 4]))] = near * float(rng.choice([-1.0, 1.0]))
        return q

    def _pace(self, fastest: float = 10.0, hardest: float = 100.0, longest: float = 1.0) -> Pace:
        """Speed and acceleration, and a length; that is exact for these, or any."""
        rng = self._rng
        nice_v, nice_a = (0.05, 0.1, 0.25, 0.5, 1.0, 1.05, 3.0), (0.1, 0.25, 0.5, 1.0, 1.2, 1.4, 2.5, 5.0, 10.0)
        v = float(rng.choice(nice_v)) if rng.random() < 0.4 else 10.0 ** float(rng.uniform(-3.0, 1.0))
        a = float(rng.choice(nice_a)) if rng.random() < 0.4 else 10.0 ** float(rng.uniform(-2.0, 2.0))
        v, a = min(v, fastest), min(a, hardest)
        k = int(rng.integers(1, 200))
        exact = (
            0.0,
            2.0 * a * RAMP**2,
            v * RAMP,
            v * v / a + v * RAMP,
            v * v / a,
            k * v * TICK,
            k * a * TICK**2,
            k * a * RAMP**2,
        )
        if rng.random() < 0.5:
            length = float(rng.choice(exact))
            length += int(rng.integers(-ULPS, ULPS + 1)) * math.ulp(length) if length > 0.0 else 0.0
        else:
            length = 10.0 ** float(rng.uniform(-9.0, math.log10(longest)))
        return Pace(v, a, min(length, longest))

    def _direction(self, n: int) -> Array:
        rng = self._rng
        if rng.random() < 0.4:
            return np.eye(n)[rng.integers(n)] * rng.choice([-1.0, 1.0])
        way = rng.normal(size=n)
        return way / np.linalg.norm(way)

    def _goal(self, arm: Arm, q: Array, length: float) -> tuple[float, ...]:
        """Joint angles, the farthest of them so far; some at the end of a range."""
        way = self._direction(arm.n)
        goal = q + length * way / np.abs(way).max()
        if self._rng.random() < 0.1:
            joint = int(self._rng.integers(arm.n))
            goal[joint] = arm.limits.ends[joint][1 if goal[joint] >= 0.0 else 0]
        return tuple(goal.tolist())

    def _pose(self, p: Array, R: Array, length: float) -> tuple[Array, Array, float]:
        """A pose so far from another; some merely turn, some go and turn. Returns the turn, too [rad]."""
        rng = self._rng
        how = rng.random()
        turn = (
            0.0 if how < 0.5 else min(length / 0.3, 3.0) if how < 0.7 else float(rng.choice([0.3, math.pi, 3.0])) * rng.random()
        )
        way = 0.0 if 0.5 <= how < 0.7 else length
        return p + way * self._direction(3), R @ rotation_by(turn * self._direction(3)), turn

    def _before(self, arm: Arm, q: Array) -> Move:
        """A motion that the next one comes from."""
        rng = self._rng
        if rng.random() < 0.3:
            qd = rng.uniform(-1.0, 1.0, arm.n)
            return SpeedJoints(id=1, qd=tuple(qd.tolist()), acceleration=float(rng.uniform(0.5, 5.0)))
        goal = tuple((q + rng.uniform(-1.0, 1.0, arm.n)).tolist())
        return ScriptedJoints(id=1, q=goal, acceleration=float(rng.uniform(0.3, 20.0)), speed=float(rng.uniform(0.2, 4.0)))

    def _moves(self, arm: Arm, kind: str, q: Array, tool: tuple[Array, Array]) -> tuple[Move, ...]:
        rng = self._rng
        if kind == "stop":
            return (GentleStop(id=2, of=rng.choice(["joints", "tool"]), deceleration=10.0 ** float(rng.uniform(-1.0, 2.0))),)
        if kind in ("blend", "movep blends"):
            return self._chain(arm, kind, q, tool)
        if kind == "jog a joint" or (kind == "jog the tool"):
            pace = self._pace()
            frame = "joint" if kind == "jog a joint" else str(rng.choice(["base", "tool"]))
            length = 0.0 if rng.random() < 0.3 else pace.length
            axis, sign = int(rng.integers(arm.n if frame == "joint" else 6)), int(rng.choice([-1, 1]))
            return (JogMove(id=2, frame=frame, axis=axis, sign=sign, length=length),)  # type: ignore[arg-type]
        return (self._one(arm, kind, q, tool, number=2, blend=0.0),)

    def _chain(self, arm: Arm, kind: str, q: Array, tool: tuple[Array, Array]) -> tuple[Move, ...]:
        """Two or three motions that go over into one another."""
        rng, moves = self._rng, []
        for number in range(2, 4 + int(rng.integers(2))):
            one = "movep" if kind == "movep blends" else str(rng.choice(["movej", "movel", "movec", "movep"]))
            moves.append(self._one(arm, one, q, tool, number=number, blend=10.0 ** float(rng.uniform(-4.0, -0.7))))
        return tuple(moves)

    def _one(self, arm: Arm, kind: str, q: Array, tool: tuple[Array, Array], *, number: int, blend: float) -> Move:
        rng = self._rng
        if kind in ("program joint step", "to a posture (Home)", "wizard's turn"):
            pace = self._pace(longest=6.0)
            goal = self._goal(arm, q, pace.length)
            if kind == "wizard's turn":
                goal = (*q[:-1].tolist(), goal[-1])
            if kind == "to a posture (Home)":
                return MoveThere(id=number, q=goal)
            speed, acceleration = (float(np.clip(x, 0.001, 1.0)) for x in (pace.speed, pace.acceleration))
            return JointMove(id=number, q=goal, speed=speed, acceleration=acceleration)
        if kind.startswith("movej") or kind == "servoj":
            pace = self._pace(longest=6.0)
            goal = self._goal(arm, q, pace.length)
            if kind == "servoj":
                ahead, gain = float(rng.uniform(0.03, 0.2)), float(rng.uniform(100.0, 2000.0))
                return ServoJoints(id=number, q=goal, time=60.0, lookahead=ahead, gain=gain)
            time = self._time(pace) if kind == "movej in a time" else 0.0
            return ScriptedJoints(id=number, q=goal, acceleration=pace.acceleration, speed=pace.speed, time=time, blend=blend)
        if kind == "speedj":
            pace = self._pace()
            qd = tuple((pace.speed * self._direction(arm.n)).tolist())
            return SpeedJoints(id=number, qd=qd, acceleration=pace.acceleration, time=float(rng.uniform(0.01, 1.0)))
        if kind == "speedl":
            pace = self._pace()
            v, w = pace.speed * self._direction(3) * (rng.random() < 0.8), pace.speed * self._direction(3) * (rng.random() < 0.4)
            a, time = pace.acceleration, float(rng.uniform(0.01, 1.0))
            speed, turning = (tuple(x.tolist()) for x in (v, w))
            return SpeedTool(id=number, speed=speed, turning=turning, acceleration=a, turning_acceleration=a, time=time)
        return self._line(arm, kind, q, tool, number=number, blend=blend)

    def _line(self, arm: Arm, kind: str, q: Array, tool: tuple[Array, Array], *, number: int, blend: float) -> Move:
        tcp, R_FT = tool
        pace = self._pace()
        p, R = tool_pose(arm, q, tcp)
        end, R_end, turn = self._pose(p, R @ R_FT, pace.length)
        common = {
            "id": number,
            "position": tuple(end.tolist()),
            "quaternion": tuple(quaternion_from_matrix(R_end).tolist()),
            "speed": pace.speed,
            "acceleration": pace.acceleration,
        }
        if kind == "program linear step":
            return LinearMove(**common)
        if kind == "straight to a pose":
            return MoveStraight(**common)
        if kind == "servoc":
            return ServoTool(**common)
        common["blend"] = blend
        if kind == "movep":
            return ScriptedProcess(**common)
        if kind == "movec":
            aside = np.cross(end - p, self._direction(3))
            bow = float(self._rng.uniform(-1.5, 1.5)) * aside
            via = tuple((p + float(self._rng.uniform(0.1, 0.9)) * (end - p) + bow).tolist())
            return ScriptedArc(**common, via=via, fixed=bool(self._rng.random() < 0.3))
        longer = pace._replace(length=max(pace.length, 0.3 * turn))
        return ScriptedLine(**common, time=self._time(longer) if kind == "movel in a time" else 0.0)

    def _time(self, pace: Pace) -> float:
        """That a motion takes, too short for one in five."""
        least = pace.length / pace.speed + pace.speed / pace.acceleration
        return max(min(least, 15.0) * float(self._rng.uniform(0.5, 3.0)), TICK)
