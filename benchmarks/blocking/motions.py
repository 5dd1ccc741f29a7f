"""What a blocked arm was told to do: a motion by jog, program or script, and what can stop it."""

from typing import Any, Literal, NamedTuple

import numpy as np

from pendant.program.jog_move import JogMove
from pendant.program.steps import JointMove, LinearMove, Program
from sim.arm.frames import quaternion_from_matrix
from sim.simulation import Simulation

Array = np.ndarray

Moves = Literal["jog joint", "jog line", "program joint", "program line", "movej", "movel", "servoj", "speedj", "speedl", "force"]
Obstacle = Literal["table", "post", "own link", "hand"]
Stop = Literal[
    "protective",
    "safeguard",
    "emergency",
    "power off",
    "pendant stop",
    "pause",
    "dashboard stop",
    "end",
    "release",
    "lost",
    "fault",
]


class Case(NamedTuple):
    """One blocked motion and its stop."""

    arm: str
    moves: Moves
    obstacle: Obstacle
    stop: Stop
    pressed: float  # [s]
    speed: float  # of the tool [m/s]
    stiffness: float  # [N/m]
    share: float  # of the rated torque, that a hand takes
    seed: int


def stops(moves: Moves) -> list[Stop]:
    """The stops that can end a kind of motion."""
    always: list[Stop] = ["protective", "safeguard", "emergency", "power off", "fault"]
    if moves.startswith("jog"):
        return [*always, "release"]
    if moves.startswith("program"):
        return [*always, "pendant stop", "pause", "end"]
    return [*always, "dashboard stop", "lost", "end"]


class Wanted:
    """The motion of a case.

    Args:
        case: what is wanted.
        probe: an arm of the same kind, whose model is asked.
        q: joint angles at the begin (n,) [rad].
        qd: joint speeds of the motion (n,) [rad/s].
        direction: of the tool (3,) in B.
        near: from the tool to what it meets, at most [m].
    """

    def __init__(self, case: Case, probe: Simulation, *, q: Array, qd: Array, direction: Array, near: float) -> None:
        self.case, self.probe, self.q, self.qd, self.direction, self.near = case, probe, q, qd, direction, near

    def _goal(self, reach: float) -> Array:
        """Joint angles (n,) so far on along the joints' way [m]."""
        return self.q + self.qd * (reach / self.case.speed)

    def reach(self) -> float:
        """How far the motion would go [m]; one that is to end by itself ends while it presses."""
        if self.case.obstacle == "own link":
            return 0.5 * self.probe.arm.reach
        if self.case.stop == "end":
            return self.near + 0.023 + min(self.case.speed * self.case.pressed, 0.012)
        return 0.3

    def script(self) -> str:
        """The motion as a client sends it."""
        case, reach = self.case, self.reach()
        goal = "[" + ", ".join(f"{value:.6f}" for value in self._goal(reach)) + "]"
        p, R, _ = self.probe.dynamics.places(self.q)
        x, y, z = p + R @ self.probe.tcp + reach * self.direction
        fastest = float(np.abs(self.qd).max())
        line = f"p = get_target_tcp_pose()\n  p[0] = {x:.6f}\n  p[1] = {y:.6f}\n  p[2] = {z:.6f}\n"
        twist = ", ".join(f"{value:.6f}" for value in case.speed * self.direction)
        speeds = ", ".join(f"{value:.6f}" for value in self.qd)
        lasts = reach / case.speed if case.stop == "end" else 60.0
        body = {
            "movej": f"movej({goal}, a=2, v={fastest:.5f})",
            "movel": line + f"  movel(p, a=1, v={case.speed:.5f})",
            "servoj": self._servo(lasts, speeds),
            "speedj": f"speedj([{speeds}], 2, {lasts:.3f})",
            "speedl": f"speedl([{twist}, 0, 0, 0], 1, {lasts:.3f})",
            "force": self._force_mode(lasts),
        }[case.moves]
        return f"def blocked():\n  {body}\nend\n"

    def _servo(self, lasts: float, speeds: str) -> str:
        return "\n".join(
            (
                "q = get_target_joint_positions()",
                "  i = 0",
                f"  while i < {round(lasts / 0.008)}:",
                "    j = 0",
                "    while j < 6:",
                f"      q[j] = q[j] + [{speeds}][j] * 0.008",
                "      j = j + 1",
                "    end",
                "    servoj(q, t=0.008, lookahead_time=0.1, gain=300)",
                "    i = i + 1",
                "  end",
                "  stopj(2)",
            )
        )

    def _force_mode(self, lasts: float) -> str:
        size = 10.0 + 60.0 * self.case.share
        x, y, z = size * self.direction
        limit = f"[{self.case.speed:.4f}, {self.case.speed:.4f}, {self.case.speed:.4f}, 0.1, 0.1, 0.1]"
        wrench = f"[{x:.3f}, {y:.3f}, {z:.3f}, 0, 0, 0]"
        mode = f"force_mode(p[0,0,0,0,0,0], [1,1,1,0,0,0], {wrench}, 2, {limit})"
        return f"{mode}\n  sleep({min(lasts, 30.0):.3f})\n  end_force_mode()"

    def program(self) -> Program:
        reach = self.reach()
        if self.case.moves == "program joint":
            share = float(np.max(np.abs(self.qd) / np.array(self.probe.arm.limits.speed)))
            step: Any = JointMove(q=tuple(self._goal(reach).tolist()), speed=min(max(share, 0.001), 1.0))
        else:
            p, R, _ = self.probe.dynamics.places(self.q)
            to = p + R @ self.probe.tcp + reach * self.direction
            step = LinearMove(position=tuple(to.tolist()), quaternion=tuple(quaternion_from_matrix(R)), speed=self.case.speed)
        return Program(name="blocked", steps=(step,))

    def jog(self) -> JogMove:
        if self.case.moves == "jog joint":
            axis = int(np.argmax(np.abs(self.qd)))
            return JogMove(frame="joint", axis=axis, sign=1 if self.qd[axis] > 0 else -1)
        axis = int(np.argmax(np.abs(self.direction)))
        return JogMove(frame="base", axis=axis, sign=1 if self.direction[axis] > 0 else -1)
