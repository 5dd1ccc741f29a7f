"""The tool centre point of an arm: where it is, how it goes, and which joint angles follow a way of it."""

from bisect import bisect_right
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sim.compiled.kernel import kernel
from sim.compiled.record import Record
from sim.paths.tool_kinematics import aligned, factored, inverted, look, tool_record
from sim.paths.way_following import SPATIAL, add_unseen, follow
from sim.rigid_body.dynamics import Dynamics

Array = NDArray[np.float64]

FOUND = 1e-9
"""Joint angles of a pose are found within this; before, it is out of reach [rad]."""


class Followed(NamedTuple):
    """Joint angles (n,) on a way of the tool, and how they go on along it."""

    q: Array  # [rad]
    rate: Array  # dq/ds [rad/m]
    bend: Array  # d²q/ds² [rad/m²]
    reached: bool = True  # the tool is at the place
    singular: bool = False  # it cannot go everywhere from there

    @classmethod
    def at(cls, q: Array) -> "Followed":
        """Joint angles from which any place is looked for."""
        return cls(q, np.zeros_like(q), np.zeros_like(q))


class WalkedWay:
    """Places of a way, in their order, with the joint angles that were found at each of them from the one before.

    Args:
        places: how far along the way [m], and joint angles.
    """

    def __init__(self, places: list[tuple[float, Followed]]) -> None:
        self._places, self._s = places, [s for s, _ in places]

    def before(self, s: float) -> tuple[float, Followed]:
        """The last place that is at most `s` along the way [m]."""
        return self._places[max(bisect_right(self._s, s) - 1, 0)]


class ToolPoint:
    """Kinematics of the tool centre point.

    Attributes:
        tcp: tool centre point in F (3,) [m].

    Args:
        dynamics: the rigid model.
        tcp: tool centre point in F (3,) [m]; another tool changes it in place.
    """

    def __init__(self, dynamics: Dynamics, tcp: Array) -> None:
        self._dynamics = dynamics
        self._models = (dynamics.recursion.record, tool_record(dynamics.model.nv))
        own = self._models[1][0]
        self.tcp, self._used = tcp, own["tcp"]
        self._p, self._R, self._jacobian = own["p"], own["R"], own["jacobian"]

    def kept(self) -> "ToolPoint":
        """Kinematics of the tool as it is now, whatever takes its place."""
        return ToolPoint(self._dynamics, self.tcp.copy())

    def pose(self, q: Array) -> tuple[Array, Array]:
        """Tool centre point (3,) [m] and orientation of the flange (3, 3) at q (n,), in B."""
        self._used[:] = self.tcp
        look(self._models, q)
        return self._p.copy(), self._R.copy()

    def twist(self, q: Array, qd: Array) -> tuple[Array, Array]:
        """Speed of the tool centre point (3,) and about it (3,) at q with joint speeds qd (n,), in B [m/s, rad/s]."""
        self._used[:] = self.tcp
        look(self._models, q)
        twist = self._jacobian @ qd
        return twist[:3], twist[3:]

    def speeds(self, q: Array, v: Array, w: Array) -> Array:
        """Joint speeds (n,) at q for a speed of the tool centre point (3,) and about it (3,), in B."""
        qd = np.empty_like(q)
        self._used[:] = self.tcp
        _speeds(self._models, q, (v, w), qd)
        return qd

    def torque(self, q: Array, force: Array) -> Array:
        """Of the joints (n,) at q for a force on the outside at the tool centre point (3,) in B [N]."""
        self._used[:] = self.tcp
        look(self._models, q)
        return self._jacobian[:3].T @ force

    def singular(self, q: Array) -> bool:
        """Whether the tool cannot go everywhere from q: the smallest singular value of its Jacobian is below `SINGULAR`."""
        self._used[:] = self.tcp
        return bool(_singular(self._models, q))

    def follow(self, piece: Record, s: float, before: Followed, step: float = 0.0) -> Followed:
        """Joint angles with the tool at a place of a piece, those next to where they are expected.

        Args:
            piece: as of `sim.paths.way_following.piece_record`.
            s: the place on it [m].
            before: joint angles at a place `step` before that.
            step: [m].
        """
        found = np.empty((3, before.q.size))
        self._used[:] = self.tcp
        off, singular = follow(self._models, (piece, s), (step, before.q, before.rate, before.bend), found)
        return Followed(found[0], found[1], found[2], off < FOUND, singular)

    def go_on(self, piece: Record, at: float, before: Followed, step: float, *, s: float, walk: WalkedWay) -> Followed:
        """Joint angles with the tool at the next place of a piece that was walked along before.

        With more than six joints the tool's pose leaves one free, and the joint angles of a place depend on those before it. The
        angles of the walk count then, so that they follow from the place alone.

        Args:
            piece: as of `follow`.
            at: the place on it [m].
            before: joint angles at the place that the tool comes from.
            step: from there [m].
            s: the place on the whole way [m].
            walk: along the whole way.
        """
        if self._jacobian.shape[1] <= SPATIAL:
            return self.follow(piece, at, before, step)
        behind, before = walk.before(s)
        joints = self.follow(piece, at, before, s - behind)
        _add_unseen(self._models, before.rate + (s - behind) * before.bend, joints.rate)
        return joints


@kernel
def _speeds(models, q, wanted, qd) -> None:
    look(models, q)
    own = models[1][0]
    v, w = wanted
    for k in range(3):
        own.twist[k], own.twist[3 + k] = v[k], w[k]
    factored(own)
    inverted(own, qd)


@kernel
def _add_unseen(models, free, rate) -> None:
    add_unseen(models[1][0], free, rate)


@kernel
def _singular(models, q):
    look(models, q)
    return aligned(models[1][0].jacobian)
