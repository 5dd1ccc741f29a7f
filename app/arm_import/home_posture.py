"""A posture to begin with in which nothing touches: the file's own, or one that is searched."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sim.arm.arm_file import Arm
from sim.arm.frames import hulls, joint_frames

Array = NDArray[np.float64]

DRAWN = 2000
"""Postures of the search."""

WITHIN = 2.6
"""Of its zero that a joint of the search is, at most [rad]."""

GAP = 0.005
"""Between shapes of the arm, at least [m]."""

ALWAYS = 0.9
"""Pairs of shapes that touch in this share of all postures are made so: they are not looked at."""

LENGTH = 0.2
"""A turn counts as the way of a point so far off [m], as in sim.control.singularity."""

REGULAR = 0.06
"""Smallest singular value of a posture that is kept, over the reach; half of what benches ask of one."""

ALONG = np.linspace(0.0, 1.0, 6)
"""Places on a capsule's segment at which distances are taken."""


class Home(NamedTuple):
    """A posture (n,) [rad], and where it comes from."""

    q: list[float]
    told: str


class Closeness:
    """Which shapes of an arm touch each other, or the floor that the arm stands on."""

    def __init__(self, arm: Arm) -> None:
        self._arm, self._rods = arm, hulls(arm)
        link = np.array([rod.link for rod in self._rods], dtype=int)
        self._radius = np.array([rod.radius for rod in self._rods])
        pairs = [(i, j) for i in range(len(link)) for j in range(i) if abs(link[i] - link[j]) > 1]
        self._pairs = np.array(pairs, dtype=int).reshape(-1, 2)
        self._above = np.flatnonzero(link > 0)

    def points(self, frames: Array) -> Array:
        """Places on each shape's segment (shapes, 6, 3) in the base."""
        found = np.empty((len(self._rods), len(ALONG), 3))
        for k, rod in enumerate(self._rods):
            line = np.array(rod.start) + ALONG[:, None] * (np.array(rod.end) - rod.start)
            found[k] = line if rod.link < 0 else line @ frames[rod.link, :3, :3].T + frames[rod.link, :3, 3]
        return found

    def touching(self, places: Array) -> NDArray[np.bool_]:
        """Which of the pairs touch (pairs,)."""
        i, j = self._pairs.T
        apart = np.linalg.norm(places[i, :, None, :] - places[j, None, :, :], axis=3).min(axis=(1, 2))
        return apart < self._radius[i] + self._radius[j] + GAP

    def leave_out(self, which: NDArray[np.bool_]) -> None:
        """Look at those pairs no more."""
        self._pairs = self._pairs[~which]

    def on_floor(self, places: Array) -> bool:
        """Whether a link beyond the first is below the foot's plane."""
        low = places[self._above, :, 2] - self._radius[self._above, None]
        return bool(low.size and low.min() < 0.0)


def home_posture(arm: Arm, own: list[float] | None) -> Home | None:
    """A posture without collisions and away from singularities; None: none of those drawn is.

    The file's own, if it is such a one. Else, of `DRAWN` postures, the one with the largest smallest singular value; a
    flange that looks to the floor counts up to twice.
    """
    close, rng = Closeness(arm), np.random.default_rng(0)
    low, high = np.array(arm.limits.ends).T
    low, high = np.maximum(low, np.minimum(-WITHIN, high - 0.1)), np.minimum(high, np.maximum(WITHIN, low + 0.1))
    drawn = rng.uniform(low, high, (DRAWN, arm.n))
    looked = np.array([close.touching(close.points(joint_frames(arm, q))) for q in drawn[:200]])
    close.leave_out(looked.mean(axis=0) > ALWAYS)
    if own is not None and all(a <= q <= b for q, (a, b) in zip(own, arm.limits.ends, strict=True)):
        q = np.array(own)
        if score(arm, q, close) > 0.0:
            return Home([float(each) for each in own], "of the file's keyframe, which touches nothing")
    scores = [score(arm, q, close) for q in drawn]
    best = int(np.argmax(scores))
    if scores[best] <= 0.0:
        return None
    told = f"searched: of {DRAWN} postures without collisions the farthest from singularities, the flange towards the floor"
    return Home(np.round(drawn[best], 3).tolist(), told)


def score(arm: Arm, q: Array, close: Closeness) -> float:
    """How good a posture is to begin with: 0 where something touches or the arm is near a singularity."""
    frames = joint_frames(arm, q)
    smallest = smallest_singular(frames) / arm.reach
    if smallest < REGULAR or frames[-1, 2, 3] < 0.1 * arm.reach:
        return 0.0
    places = close.points(frames)
    if close.on_floor(places) or close.touching(places).any():
        return 0.0
    return smallest * (2.0 - (1.0 + float(frames[-1, 2, 2])) / 2.0)


def smallest_singular(frames: Array) -> float:
    """Of the flange's Jacobian, turns as ways [m]; frames (n + 1, 4, 4) of joints and flange in the base."""
    z = frames[:-1, :3, 2]
    arms = frames[-1, :3, 3] - frames[:-1, :3, 3]
    jacobian = np.vstack([np.cross(z, arms).T, LENGTH * z.T])
    return float(np.linalg.svd(jacobian, compute_uv=False).min())
