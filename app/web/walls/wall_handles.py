"""Handles in the picture, with which one area is moved and turned; its outline goes along at once."""

import numpy as np
import viser
from numpy.typing import NDArray

from app.web.access.guard import Guard
from app.web.scene.gizmo import Gizmo, Moved
from app.web.scene.surfaces import plane, surface
from app.web.scene.wall_pictures import AREA_SIDE, ROOT
from app.web.walls.made_walls import inwards
from pendant.tick.pose import quaternion
from pendant.walls.barrier import Place
from pendant.walls.definitions import Area
from pendant.walls.shapes import HalfSpace, Sphere

Array = NDArray[np.float64]

NAME = f"{ROOT}/handles"
SCALE = 0.22
ARROW = 0.2
"""Length of the handles, and of the arrow to the allowed side of a plane [m]."""

BLUE = (25, 113, 194)

PLANE_SIDE = AREA_SIDE / 2
"""Side of the square that is drawn of a plane [m]."""


class WallHandles(Gizmo):
    """The handles of the chosen area; `show` runs in the painter.

    Args:
        server: of the page.
        guard: lets the handles that are shown be moved, by who has control.
        moved: told at the end of each move, of the pose in B of the shape's origin [m] and wxyz.
    """

    def __init__(self, server: viser.ViserServer, guard: Guard, moved: Moved) -> None:
        super().__init__(server, guard, NAME, moved)
        self._area: Area | None = None

    def show(self, area: Area | None, place: Place | None) -> bool:
        """Have the handles at an area that lies at `place`, or none; True if anything changed."""
        if area is None or place is None:
            self._area = None
            return self.put_away()
        changed = self._gizmo is None or not self._draws(area)
        if changed:
            self.put_away()
            self._draw(area, place.factor)
        self._area = area
        return self.bring((place.pose.p, quaternion(place.pose.R))) or changed

    def _draws(self, area: Area) -> bool:
        last = self._area
        return last is not None and (last.name, last.shape, last.keep_out) == (area.name, area.shape, area.keep_out)

    def _draw(self, area: Area, factor: float) -> None:
        scene = self._server.scene
        self.make(SCALE, turns=not isinstance(area.shape, Sphere))
        outline = _outline(area, factor)
        scene.add_line_segments(f"{NAME}/outline", outline.astype(np.float32), BLUE, thickness=2.0, thickness_units="screen")
        if isinstance(area.shape, HalfSpace):
            on = _on_plane(area.shape, factor)
            ends = np.array([[on, on + ARROW * np.array(inwards(area))]], dtype=np.float32)
            scene.add_arrows(f"{NAME}/side", ends, BLUE, shaft_radius=0.006, head_radius=0.018, head_length=0.045)
            scene.add_label(f"{NAME}/allowed", "allowed side", position=ends[0, 1], anchor="bottom-center")


def _outline(area: Area, factor: float) -> Array:
    """Its lines in the shape's axes (s, 2, 3) [m]; of a plane, a square round the point nearest to the shape's origin."""
    shape = area.shape
    lines = surface(shape, PLANE_SIDE).outline
    if isinstance(shape, HalfSpace):
        return lines @ plane(shape.normal).T + _on_plane(shape, factor)
    return factor * lines


def _on_plane(shape: HalfSpace, factor: float) -> Array:
    """The point of the plane that is nearest to the shape's origin, in its axes (3,) [m]."""
    return factor * shape.distance * np.array(shape.normal) / np.linalg.norm(shape.normal)
