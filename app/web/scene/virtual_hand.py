"""The virtual hand: a drag of a link in the picture becomes a touch on the desk, and its end lets go at once."""

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from sim.exchange.desk import Desk
from sim.exchange.snapshot import Snapshot
from sim.plant.touch import ZERO, Pull, Push, Triple

FORCE = (5.0, 50.0, 150.0)
"""Least, default and largest cap of the hand's force [N]."""

LEVER = 0.1
"""Torque cap of the turning hand for its force cap [m]."""

REACH = 0.25
"""Cursor displacement at which the turning hand's torque is at its cap [m]."""


@dataclass(slots=True)
class Grasp:
    """Where a client holds the arm."""

    part: str
    point: Triple  # in the part's frame [m]
    turning: bool


class VirtualHand:
    """The hands of all clients; the guard lets only the operator's through. Used on viser's event loop."""

    def __init__(self, desk: Desk, latest: Callable[[], Snapshot], frames: dict[str, int]) -> None:
        """`frames` gives for each part its row in `Snapshot.truth_links`."""
        self.cap = FORCE[1]
        self._desk = desk
        self._latest = latest
        self._frames = frames
        self._grips: dict[int, Grasp] = {}

    def grab(self, client: int, part: str, point_W: Triple, turning: bool) -> None:
        """`client` takes hold of `part` at a point given in W [m]; to turn it, or to pull it."""
        self.let_go(client)
        pose = self._latest().truth_links[self._frames[part]]
        self._grips[client] = Grasp(part, _into(pose, point_W), turning)

    def move(self, client: int, start_W: Triple, target_W: Triple, eye_W: Triple) -> None:
        """The cursor is at `target_W`, on the plane through the grabbed point `start_W` that faces the eye [m].

        A client that holds nothing moves nothing: after a stalled connection it has to grab again.
        """
        grip = self._grips.get(client)
        if grip is None:
            return
        if grip.turning:
            touch = Push(grip.part, grip.point, ZERO, _turn(start_W, target_W, eye_W, self.cap * LEVER))
        else:
            touch = Pull(grip.part, grip.point, target_W, self.cap)
        self._desk.touch(_name(client), touch)

    def let_go(self, client: int) -> bool:
        """`client` holds nothing any more; True if it held something."""
        self._desk.let_go(_name(client))
        return self._grips.pop(client, None) is not None

    def holds(self, client: int) -> bool:
        """Whether `client` holds the arm."""
        return client in self._grips


def _name(client: int) -> str:
    return f"hand:{client}"


def _into(pose: np.ndarray, point_W: Triple) -> Triple:
    """A point of W in the frame with the (7,) pose."""
    w, axis = pose[3], -pose[4:]
    d = np.asarray(point_W) - pose[:3]
    turned = d + 2.0 * np.cross(axis, np.cross(axis, d) + w * d)
    return float(turned[0]), float(turned[1]), float(turned[2])


def _turn(start: Triple, target: Triple, eye: Triple, cap: float) -> Triple:
    """Torque in W that rolls the near side of the link along the cursor's way, as a ball under the hand [N·m]."""
    way = np.asarray(target) - np.asarray(start)
    sight = np.asarray(eye) - np.asarray(start)
    distance = float(np.linalg.norm(sight))
    length = float(np.linalg.norm(way))
    if distance < 1e-6 or length < 1e-6 or not math.isfinite(distance * length):
        return ZERO
    torque = np.cross(sight / distance, way / length) * cap * min(1.0, length / REACH)
    return float(torque[0]), float(torque[1]), float(torque[2])
