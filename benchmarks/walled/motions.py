"""Motions of programs, scripts and jogging, drawn at random: what people ask of an arm, at every speed that they may ask for."""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from pendant.program.jog_move import Jogged, JogMove, MoveStraight, MoveThere
from pendant.program.steps import ApplyForce, ContactMove, JointMove, LinearMove, Program
from sim.arm.frames import quaternion_from_matrix, rotation_by, rotation_vector
from sim.simulation import Simulation

Array = NDArray[np.float64]

LONGEST = 4.0
"""Of what is looked at of a motion [s]."""

FASTEST_LINE, STRONGEST_LINE = 1.5, 5.0
"""Of the tool that is asked for [m/s, m/s²]."""


class Asked(NamedTuple):
    """One motion, as one of a program, a script's text, or a button that is held for a time."""

    what: str
    program: Program | None = None
    script: str = ""
    jog: Jogged | None = None
    held: float = 0.0  # [s]


class Drawing:
    """Draws motions of an arm from where it stands.

    Args:
        device: the arm.
        rng: what chance says.
    """

    def __init__(self, device: Simulation, rng: np.random.Generator) -> None:
        self._device, self._rng = device, rng
        self._q = device.plant.q.copy()
        p, self._R, _ = device.dynamics.places(self._q)
        self._p = p + self._R @ device.tcp
        self._size = device.arm.reach / 0.85

    def draw(self, what: str) -> Asked:
        """A motion of a kind of `KINDS`."""
        return KINDS[what](self)._replace(what=what)

    def _between(self, low: float, high: float) -> float:
        """Even in its logarithm."""
        return float(np.exp(self._rng.uniform(np.log(low), np.log(high))))

    def _joints(self) -> Array:
        """Angles (n,) up to 1 rad away each."""
        return self._q + self._rng.uniform(-1.0, 1.0, self._q.size)

    def _pose(self, furthest: float = 0.5) -> tuple[Array, Array]:
        """A tool centre point (3,) and an orientation (3, 3) some way off."""
        way = self._rng.normal(size=3)
        way *= self._size * self._rng.uniform(0.1, furthest) / np.linalg.norm(way)
        turn = self._rng.normal(size=3) * 0.2 if self._rng.random() < 0.5 else np.zeros(3)
        return self._p + way, self._R @ rotation_by(turn)

    def _speeds(self) -> tuple[float, float]:
        """Of a line [m/s], [m/s²]."""
        return self._between(0.05, FASTEST_LINE), self._between(0.3, STRONGEST_LINE)

    # programs

    def joint_step(self) -> Asked:
        """To joint angles, at up to full speed."""
        step = JointMove(q=_numbers(self._joints()), speed=self._between(0.1, 1.0), acceleration=self._between(0.1, 1.0))
        return Asked("", Program(steps=(step,)))

    def linear_steps(self) -> Asked:
        """Straight to one or two poses."""
        steps: list[LinearMove] = []
        for _ in range(int(self._rng.integers(1, 3))):
            p, R = self._pose()
            v, a = self._speeds()
            steps.append(LinearMove(position=_triple(p), quaternion=_wxyz(R), speed=v, acceleration=a))
        return Asked("", Program(steps=tuple(steps)))

    def contact_step(self) -> Asked:
        """Along an axis until something is met, which nothing is."""
        along = self._rng.choice(["x", "y", "z", "-x", "-y", "-z"])
        step = ContactMove(frame=self._rng.choice(["base", "tool"]), along=along, distance=0.3, speed=self._between(0.05, 0.25))
        return Asked("", Program(steps=(step,)))

    def force_step(self) -> Asked:
        """Push on what is not there."""
        force = self._rng.normal(size=3)
        force *= 10.0 / np.linalg.norm(force)
        return Asked("", Program(steps=(ApplyForce(force=_triple(force), speed=self._between(0.01, 0.1), distance=0.2),)))

    # scripts

    def movej(self) -> Asked:
        """Two joint moves, the first of which goes over into the second."""
        v, a, blend = self._between(0.2, 3.0), self._between(0.5, 10.0), self._rng.choice([0.0, 0.02, 0.1])
        ends = [f"movej({_list(self._joints())}, a={a}, v={v}, r={r})" for r in (blend, 0.0)]
        return Asked("", script="\n".join(ends))

    def movel(self) -> Asked:
        """Two lines, the first of which goes over into the second."""
        v, a = self._speeds()
        ends = [f"movel({_pose(*self._pose())}, a={a}, v={v}, r={r})" for r in (self._rng.choice([0.0, 0.02, 0.05]), 0.0)]
        return Asked("", script="\n".join(ends))

    def movep(self) -> Asked:
        """Three lines at one speed, which circles join."""
        v, a = self._speeds()
        ends = [f"movep({_pose(*self._pose(0.3))}, a={a}, v={min(v, 1.0)}, r=0.02)" for _ in range(3)]
        return Asked("", script="\n".join(ends))

    def movec(self) -> Asked:
        """A circle."""
        v, a = self._speeds()
        via, end = self._pose(0.3), self._pose(0.4)
        return Asked("", script=f"movec({_pose(*via)}, {_pose(*end)}, a={a}, v={v})")

    def servoj(self) -> Asked:
        """Angles of a smooth way, in every tick."""
        far, seconds = self._joints() - self._q, self._between(0.8, 4.0)
        moved = ", ".join(f"{start} + s*{way}" for start, way in zip(_numbers(self._q), _numbers(far), strict=True))
        count = round(500 * seconds)
        lines = ("k = 0", f"while k < {count}:", f"  x = k/{count}", "  s = x*x*(3 - 2*x)", f"  servoj([{moved}], t=0.002)")
        return Asked("", script="\n".join((*lines, "  k = k + 1", "end", "stopj(2.0)")))

    def servoc(self) -> Asked:
        """A pose that is approached."""
        v, a = self._speeds()
        pose = _pose(*self._pose())
        return Asked("", script=f"k = 0\nwhile k < 1500:\n  servoc({pose}, a={a}, v={min(v, 1.0)})\n  k = k + 1\nend\nstopl(2.0)")

    def speedj(self) -> Asked:
        """Joint speeds."""
        qd = self._rng.uniform(-1.0, 1.0, self._q.size) * self._between(0.1, 2.0)
        return Asked("", script=f"speedj({_list(qd)}, {self._between(0.5, 8.0)}, {self._rng.uniform(0.3, 1.5)})\nstopj(4.0)")

    def speedl(self) -> Asked:
        """A speed of the tool."""
        v = self._rng.normal(size=3)
        v *= self._between(0.05, 1.0) / np.linalg.norm(v)
        w = self._rng.normal(size=3) * 0.1
        way = f"speedl({_list(np.concatenate((v, w)))}, {self._between(0.3, 4.0)}, {self._rng.uniform(0.3, 2.0)})"
        return Asked("", script=f"{way}\nstopl({self._between(0.3, 5.0)})")

    def force_mode(self) -> Asked:
        """The tool gives way along one axis, on which nothing is met, while it moves on the others."""
        axis = int(self._rng.integers(3))
        free = [int(k == axis) for k in range(6)]
        wrench = [float(self._rng.choice([-15.0, 15.0])) * each for each in free]
        limits = [0.1 if k == axis else 0.5 for k in range(3)] + [1.0] * 3
        p, R = self._pose(0.3)
        move = f"movel({_pose(p, R)}, a=0.5, v=0.1)" if self._rng.random() < 0.5 else "sleep(3.0)"
        frame = "p[0, 0, 0, 0, 0, 0]"
        return Asked("", script=f"force_mode({frame}, {free}, {wrench}, 2, {limits})\n{move}\nend_force_mode()")

    def direct_torque(self) -> Asked:
        """A torque on one of the first three joints."""
        torque = [0.0] * self._q.size
        torque[int(self._rng.integers(3))] = float(self._rng.uniform(-0.1, 0.1)) * self._device.arm.limits.torque[0]
        return Asked("", script=f"k = 0\nwhile k < 600:\n  direct_torque({torque})\n  k = k + 1\nend")

    # jogging

    def jog_joint(self) -> Asked:
        """One joint."""
        move = JogMove(frame="joint", axis=int(self._rng.integers(self._q.size)), sign=self._rng.choice([-1, 1]))
        return Asked("", jog=move, held=self._rng.uniform(0.5, 3.0))

    def jog_tool(self) -> Asked:
        """The tool along or about an axis."""
        frame, axis = self._rng.choice(["base", "tool"]), int(self._rng.integers(6))
        return Asked("", jog=JogMove(frame=frame, axis=axis, sign=self._rng.choice([-1, 1])), held=self._rng.uniform(0.5, 3.0))

    def home(self) -> Asked:
        """To angles at manual speed, as Home does."""
        return Asked("", jog=MoveThere(q=_numbers(self._joints()), name="home"), held=LONGEST)

    def straight(self) -> Asked:
        """Straight to a pose at manual speed."""
        p, R = self._pose()
        return Asked("", jog=MoveStraight(position=_triple(p), quaternion=_wxyz(R), speed=0.25), held=LONGEST)


KINDS: dict[str, Callable[[Drawing], Asked]] = {
    "program: joint step": Drawing.joint_step,
    "program: linear steps": Drawing.linear_steps,
    "program: step until contact": Drawing.contact_step,
    "program: force step": Drawing.force_step,
    "script: movej": Drawing.movej,
    "script: movel": Drawing.movel,
    "script: movep": Drawing.movep,
    "script: movec": Drawing.movec,
    "script: servoj": Drawing.servoj,
    "script: servoc": Drawing.servoc,
    "script: speedj": Drawing.speedj,
    "script: speedl": Drawing.speedl,
    "script: force mode": Drawing.force_mode,
    "script: direct torque": Drawing.direct_torque,
    "jog: joint": Drawing.jog_joint,
    "jog: tool": Drawing.jog_tool,
    "jog: home": Drawing.home,
    "jog: straight": Drawing.straight,
}


def _numbers(values: Array) -> tuple[float, ...]:
    return tuple(np.round(values, 6).tolist())


def _triple(values: Array) -> tuple[float, float, float]:
    x, y, z = _numbers(values)
    return x, y, z


def _wxyz(R: Array) -> tuple[float, float, float, float]:
    w, x, y, z = quaternion_from_matrix(R).tolist()
    return w, x, y, z


def _list(values: Array) -> str:
    return str(list(_numbers(values)))


def _pose(p: Array, R: Array) -> str:
    return f"p{_list(np.concatenate((p, rotation_vector(R))))}"
