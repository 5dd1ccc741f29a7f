"""Floor and background of the picture, by day and by night, and the shadow of the arm on the floor."""

from typing import NamedTuple

import numpy as np
import viser
from numpy.typing import NDArray

Array = NDArray[np.float64]

FLOOR = "/floor"

SHADE_RADIUS = 0.05
"""Half of the width of a link's shadow [m]."""

SHADE_LIFT, SHADE_STEP = 0.008, 0.0005
"""How high the shadow of the first link lies over the floor, and how much lower each next one does: where two of them overlap,
the floor is darkened once, by the upper one [m]."""

SHADE_MOVED = 0.002
"""Of a link that moved by less the shadow stays where it is [m]."""

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


class Shadow:
    """The arm's shadow, as if lit from straight above: a rounded strip from joint to joint, all in one mesh.

    True shadows of the lamps draw the scene once more for each lamp, which takes too long where there is no graphics card.
    """

    def __init__(self, scene: viser.SceneApi) -> None:
        self._scene = scene
        self._shown = np.zeros((0, 3))
        self._mesh: viser.MeshHandle | None = None

    def show(self, joints: Array, level: float) -> bool:
        """Show it of an arm with its joints there, (k, 3) in W [m], on a floor so high [m]; True if anything changed."""
        if len(joints) == len(self._shown) and float(np.max(np.abs(joints - self._shown))) < SHADE_MOVED:
            return False
        vertices = strips(joints, level).astype(np.float32)
        if self._mesh is None or len(joints) != len(self._shown):
            rim, links = 2 * len(CAP), len(joints) - 1
            fan = np.array([(0, k, k + 1) for k in range(1, rim - 1)])
            faces = np.concatenate([fan + rim * link for link in range(links)])
            self._mesh = self._scene.add_mesh_simple(
                "/shadow", vertices, faces, color=(0, 0, 0), opacity=0.22, side="double", cast_shadow=False, receive_shadow=False
            )
        else:
            self._mesh.vertices = vertices
        self._shown = joints.copy()
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
