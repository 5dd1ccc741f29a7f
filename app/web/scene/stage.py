"""Floor and background of the picture, by day and by night."""

from typing import NamedTuple

import numpy as np
import viser

FLOOR = "/floor"


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
