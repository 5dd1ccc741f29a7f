"""A loop without physics: joints that circle on command, phases that can be set, and the calls of sim.loop.Loop."""

import math
from types import SimpleNamespace
from typing import Any

import numpy as np
import trimesh
from numpy.typing import NDArray

from pendant.decision import Decision, Remaining
from pendant.estimate import Estimate
from pendant.events import Event, Kind
from pendant.modes import TICK_RATE, Law, Mode, Phase, Safety
from sim.desk import Desk
from sim.snapshot import Snapshot

JOINTS = ("base", "shoulder", "elbow", "wrist_1", "wrist_2", "wrist_3")
A = (0.0, -0.425, -0.3922, 0.0, 0.0, 0.0)
D = (0.1625, 0.0, 0.0, 0.1333, 0.0997, 0.0996)
ALPHA = (math.pi / 2, 0.0, 0.0, math.pi / 2, -math.pi / 2, 0.0)
HOME = np.array([0.0, -1.9, 1.9, -1.57, -1.57, 0.0])


def pose(matrix: NDArray[np.float64]) -> NDArray[np.float64]:
    """(7,) position and quaternion wxyz of a homogeneous matrix."""
    r = matrix[:3, :3]
    w = math.sqrt(max(0.0, 1.0 + r[0, 0] + r[1, 1] + r[2, 2])) / 2
    x = math.copysign(math.sqrt(max(0.0, 1.0 + r[0, 0] - r[1, 1] - r[2, 2])) / 2, r[2, 1] - r[1, 2])
    y = math.copysign(math.sqrt(max(0.0, 1.0 - r[0, 0] + r[1, 1] - r[2, 2])) / 2, r[0, 2] - r[2, 0])
    z = math.copysign(math.sqrt(max(0.0, 1.0 - r[0, 0] - r[1, 1] + r[2, 2])) / 2, r[1, 0] - r[0, 1])
    return np.array([*matrix[:3, 3], w, x, y, z])


def links(q: NDArray[np.float64]) -> NDArray[np.float64]:
    """(8, 7) base, the six joint frames, the flange."""
    here = np.eye(4)
    poses = [pose(here)]
    for i in range(6):
        c, s = math.cos(q[i]), math.sin(q[i])
        here = here @ np.array([[c, -s, 0, 0], [s, c, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1.0]])
        poses.append(pose(here))
        ca, sa = math.cos(ALPHA[i]), math.sin(ALPHA[i])
        here = here @ np.array([[1, 0, 0, A[i]], [0, ca, -sa, 0], [0, sa, ca, D[i]], [0, 0, 0, 1.0]])
    poses.append(pose(here))
    return np.array(poses)


def estimate(q: NDArray[np.float64]) -> Estimate:
    """An estimate at rest."""
    zero = np.zeros(6)
    return Estimate(
        0, True, True, True, q, zero, zero, q, zero, zero, zero, zero, zero, zero, np.zeros(3), np.zeros(3), np.eye(3), zero, 0.0, 0.0, 0
    )


class FakeLoop:
    """Same calls as sim.loop.Loop; `advance` instead of a thread."""

    def __init__(self) -> None:
        self.desk = Desk()
        self.speed = 1.0
        self.paused = False
        self.actual_rate = 1.0
        self.seed = 7
        self.tick = 0
        self.mode = Mode.TEACH
        self.safety = Safety.NORMAL
        self.phase = Phase.OFF
        self.periods: tuple[Remaining, ...] = ()
        self.q = HOME.copy()
        self.touches: tuple[Any, ...] = ()
        self.log: list[Event] = []
        self.wishes: list[Any] = []
        self.resets = 0
        self.steps = 0

    def advance(self, seconds: float = 0.002) -> None:
        """Let simulated time pass and read the desk once."""
        self.tick += max(1, round(seconds * TICK_RATE))
        self.wishes.append(self.desk.take())

    def note(self, kind: Kind, **values: float | int | str | bool) -> None:
        """Log an event."""
        self.log.append(Event(kind, self.tick, dict(values)))

    def latest(self) -> Snapshot:
        """The newest snapshot."""
        decision = Decision(self.mode, self.safety, self.phase, Law.HOLD, None, 1.0, (0.0,) * 6, self.periods, ())
        seen = estimate(self.q)
        return Snapshot(self.tick, decision, seen, links(self.q), np.zeros((0, 7)), None, 0.0, 0.0, self.touches)

    def events(self, since: int) -> list[Event]:
        """Events from index `since` on."""
        return self.log[since:]

    def start(self) -> None:
        """Nothing runs."""

    def stop(self) -> None:
        """Nothing runs."""

    def step_once(self) -> None:
        """Count the steps asked for."""
        self.steps += 1

    def reset(self) -> None:
        """Count the resets asked for."""
        self.resets += 1


ARM = SimpleNamespace(name="ur5e", title="UR5e", payload=5.0, reach=0.85, n=6, chain=SimpleNamespace(joints=list(JOINTS)))


def meshes() -> dict[str, bytes]:
    """A tube along the link's axis for every part, as GLB."""
    ends = {"foot": (0, 0, 0.1), "base": (0, 0, 0.15), "shoulder": (A[1], 0, 0), "elbow": (A[2], 0, 0)}
    files = {}
    for part in ("foot", *JOINTS):
        end = np.array(ends.get(part, (0, 0, 0.1)), dtype=float)
        shape = trimesh.creation.cylinder(0.05, segment=np.array([np.zeros(3), end]), sections=16)
        files[part] = bytes(shape.export(file_type="glb"))
    return files
