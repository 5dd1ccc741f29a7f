"""Floor and background of the picture, by day and by night, and the shadow of the arm on floor and tables."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import viser
from numpy.typing import NDArray

from sim.arm.frames import matrix_from_quaternion

Array = NDArray[np.float64]

FLOOR = "/floor"

SHADE_RADIUS = 0.05
"""Half of the width of a link's shadow [m]."""

SHADE_LIFT, SHADE_STEP = 0.008, 0.0005
"""How high the shadow of the first link lies over the floor, and how much lower each next one does: where two of them overlap,
the floor is darkened once, by the upper one [m]."""

SHADE_MOVED = 0.002
"""Of a link that moved by less the shadow stays where it is [m]."""

LEVEL = 0.999
"""A top is level when the upright part of its normal is at least that."""

CORNERS = 4
"""Of a table, whose edges cut a shadow: each edge adds at most one corner to it."""

CAP = np.linspace(-np.pi / 2.0, np.pi / 2.0, 7)
"""Directions of the rim at the end of a link, from the direction of the link [rad]."""


class Shades(NamedTuple):
    """Colours of floor and background."""

    plane: tuple[int, int, int]
    cells: tuple[int, int, int]
    sections: tuple[int, int, int]
    top: tuple[int, int, int]
    bottom: tuple[int, int, int]


LIGHT = Shades((244, 246, 248), (226, 230, 234), (203, 209, 215), (214, 221, 229), (247, 248, 250))
DARK = Shades((44, 48, 53), (58, 63, 69), (80, 87, 94), (20, 22, 25), (44, 48, 53))


def lay(scene: viser.SceneApi, shades: Shades) -> viser.GridHandle:
    """Floor and background, for all clients or, by their own scene, for one."""
    image = np.linspace(shades.top, shades.bottom, 128).astype(np.uint8)
    scene.set_background_image(np.repeat(image[:, None, :], 2, axis=1), format="png")
    return scene.add_grid(
        FLOOR,
        width=6.0,
        height=6.0,
        cell_size=0.1,
        section_size=0.5,
        cell_color=shades.cells,
        section_color=shades.sections,
        cell_thickness=0.6,
        section_thickness=1.0,
        fade_distance=6.0,
        fade_from="origin",
        plane_color=shades.plane,
        plane_opacity=1.0,
        shadow_opacity=0.0,
    )


class Top(NamedTuple):
    """A level rectangle that a shadow can fall on."""

    centre: Array  # (3,) in W [m]
    axes: Array  # (2, 2) rows: the directions of its sides in the plane x, y of W
    half: Array  # (2,) half of its sides [m]


def top_of(size: Array, pose: Array) -> Top | None:
    """The top of a box of that size (3,) [m] at a pose (7,) in W; None: it is not level."""
    R = matrix_from_quaternion(pose[3:])
    if R[2, 2] < LEVEL:
        return None
    return Top(pose[:3] + R[:, 2] * size[2] / 2.0, R[:2, :2].T, size[:2] / 2.0)


class Shadow:
    """The arm's shadow, as if lit from straight above: a rounded strip from joint to joint, all in one mesh.

    True shadows of the lamps draw the scene once more for each lamp, which takes too long where there is no graphics card.
    """

    def __init__(self, scene: viser.SceneApi) -> None:
        self._scene = scene
        self._shown = np.zeros((0, 3))
        self._tops = 0
        self._mesh: viser.MeshHandle | None = None

    def show(self, joints: Array, level: float, tops: Sequence[Top] = ()) -> bool:
        """Show it of an arm with its joints there, (k, 3) in W [m], on a floor so high [m] and on tables; True if it changed."""
        shown = np.concatenate([joints, *(top.centre[None] for top in tops)])
        known = len(shown) == len(self._shown) and len(tops) == self._tops
        if known and float(np.max(np.abs(shown - self._shown))) < SHADE_MOVED:
            return False
        links, rim, cut = len(joints) - 1, 2 * len(CAP), 2 * len(CAP) + CORNERS
        floor = strips(joints, level).reshape(links, rim, 3)
        on_tables = [strips_on(top, joints) for top in tops]
        for top, on in zip(tops, on_tables, strict=True):  # a table keeps the light from the floor
            met = on[::cut, 2] > top.centre[2]
            floor[met] = floor[met][:, :1]
        vertices = np.concatenate([floor.reshape(-1, 3), *on_tables]).astype(np.float32)
        if self._mesh is None or not known:
            counts = [rim] * links + [cut] * links * len(tops)
            firsts = np.cumsum([0, *counts[:-1]]).tolist()
            faces = np.array([(at, at + k, at + k + 1) for at, n in zip(firsts, counts, strict=True) for k in range(1, n - 1)])
            self._mesh = self._scene.add_mesh_simple(
                "/shadow", vertices, faces, color=(0, 0, 0), opacity=0.22, side="double", cast_shadow=False, receive_shadow=False
            )
        else:
            self._mesh.vertices = vertices
        self._shown, self._tops = shown, len(tops)
        return True


def strips(joints: Array, level: float) -> Array:
    """The rims of the links' shadows one after the other, (14 (k - 1), 3) in W [m]."""
    begins, ends = joints[:-1, :2], joints[1:, :2]
    along = np.arctan2(*(ends - begins).T[::-1])[:, None] + CAP  # (k - 1, 7)
    rim = SHADE_RADIUS * np.stack([np.cos(along), np.sin(along)], axis=-1)
    flat = np.concatenate([ends[:, None] + rim, begins[:, None] - rim], axis=1)
    heights = level + SHADE_LIFT - SHADE_STEP * np.arange(len(ends))
    lifted = np.broadcast_to(heights[:, None, None], (*flat.shape[:2], 1))
    return np.concatenate([flat, lifted], axis=2, dtype=np.float64).reshape(-1, 3)


def strips_on(top: Top, joints: Array) -> Array:
    """What of the links' shadows falls on a table, (18 (k - 1), 3) in W [m]: of a link below it or beside it, one point."""
    rims = strips(joints, top.centre[2]).reshape(len(joints) - 1, -1, 3)
    over = np.maximum(joints[:-1, 2], joints[1:, 2]) > top.centre[2]
    on = np.tile(top.centre - [0.0, 0.0, SHADE_LIFT], (len(rims), rims.shape[1] + CORNERS, 1))
    for link in np.flatnonzero(over):
        inside = (rims[link, :, :2] - top.centre[:2]) @ top.axes.T
        if (inside.min(axis=0) > top.half).any() or (inside.max(axis=0) < -top.half).any():
            continue
        corners: list[tuple[float, ...]] = list(map(tuple, inside.tolist()))
        for axis, bound in enumerate(top.half.tolist()):
            for sign in (1.0, -1.0):
                corners = _cut(corners, axis, sign, bound)
        if corners:
            flat = np.array(corners + corners[-1:] * (on.shape[1] - len(corners)))
            on[link, :, :2] = top.centre[:2] + flat @ top.axes
            on[link, :, 2] = rims[link, 0, 2]
    return on.reshape(-1, 3)


def _cut(corners: list[tuple[float, ...]], axis: int, sign: float, bound: float) -> list[tuple[float, ...]]:
    """The part of a convex polygon in which `sign` times a coordinate is at most `bound` (Sutherland and Hodgman, 1974)."""
    kept: list[tuple[float, ...]] = []
    for before, here in zip([*corners[-1:], *corners[:-1]], corners, strict=True):
        was, now = bound - sign * before[axis], bound - sign * here[axis]
        if (was < 0.0) != (now < 0.0):
            share = was / (was - now)
            kept.append(tuple(b + share * (h - b) for b, h in zip(before, here, strict=True)))
        if now >= 0.0:
            kept.append(here)
    return kept
