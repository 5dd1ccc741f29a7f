"""Handles in the picture, with which one area is moved and turned; its outline goes along at once."""

from collections.abc import Callable

import numpy as np
import viser
from numpy.typing import NDArray

from app.web.access.guard import Guard
from app.web.scene.surfaces import plane, surface
from app.web.scene.wall_pictures import AREA_SIDE, ROOT
from app.web.walls.made_walls import inwards
from pendant.tick.pose import Quaternion, Vector, quaternion
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

Moved = Callable[[Vector, Quaternion], None]


class WallHandles:
    """One pair of handles. Lives on viser's event loop; `show` runs in the painter, which is there, too.

    Args:
        server: of the page.
        guard: lets the handles that are shown be moved, by who has control.
        moved: told at the end of each move, of the pose in B of the shape's origin [m] and wxyz.
    """

    def __init__(self, server: viser.ViserServer, guard: Guard, moved: Moved) -> None:
        self._server, self._guard, self._moved = server, guard, moved
        self._gizmo: viser.TransformControlsHandle | None = None
        self._area: Area | None = None
        self._pose: tuple[Vector, Quaternion] | None = None  # that the handles were last given
        self.mover: int | None = None  # the client that moves them now

    def show(self, area: Area | None, place: Place | None) -> bool:
        """Have the handles at an area that lies at `place`, or none; True if anything changed."""
        if area is None or place is None:
            return self._put_away()
        pose = (place.pose.p, quaternion(place.pose.R))
        changed = False
        if self._gizmo is None or not self._draws(area):
            self._put_away()
            self._make(area, place.factor)
            changed = True
        self._area = area
        if self.mover is None and pose != self._pose and self._gizmo is not None:
            self._pose, changed = pose, True
            self._gizmo.position, self._gizmo.wxyz = np.array(pose[0]), np.array(pose[1])
        return changed

    def let_go(self, client: int) -> None:
        """What `client` moves goes back to where it was."""
        if self.mover == client:
            self.mover = self._pose = None

    def _draws(self, area: Area) -> bool:
        last = self._area
        return last is not None and (last.name, last.shape, last.keep_out) == (area.name, area.shape, area.keep_out)

    def _put_away(self) -> bool:
        if self._gizmo is None:
            return False
        self._guard.fix(NAME)
        self._gizmo.remove()
        self._gizmo = self._area = self._pose = self.mover = None
        return True

    def _make(self, area: Area, factor: float) -> None:
        scene, ball = self._server.scene, isinstance(area.shape, Sphere)
        gizmo = scene.add_transform_controls(NAME, scale=SCALE, line_width=4.0, disable_rotations=ball, depth_test=False)
        outline = _outline(area, factor)
        scene.add_line_segments(f"{NAME}/outline", outline.astype(np.float32), BLUE, thickness=2.0, thickness_units="screen")
        if isinstance(area.shape, HalfSpace):
            on = _on_plane(area.shape, factor)
            ends = np.array([[on, on + ARROW * np.array(inwards(area))]], dtype=np.float32)
            scene.add_arrows(f"{NAME}/side", ends, BLUE, shaft_radius=0.006, head_radius=0.018, head_length=0.045)
            scene.add_label(f"{NAME}/allowed", "allowed side", position=ends[0, 1], anchor="bottom-center")
        gizmo.on_update(self._see)
        self._gizmo = gizmo
        self._guard.let_move(NAME)

    async def _see(self, event: viser.TransformControlsEvent) -> None:
        client = event.client_id
        if event.phase == "start" and self.mover is None:
            self.mover = client
        if event.phase != "end" or client != self.mover:
            return
        self.mover = None
        if client not in self._server.get_clients():  # it has gone, and viser says for it that it let go
            self._pose = None
            return
        x, y, z = event.target.position.tolist()
        w, i, j, k = event.target.wxyz.tolist()
        self._pose = None  # if it is refused, they go back
        if w * w + i * i + j * j + k * k > 0.5:
            self._moved((x, y, z), (w, i, j, k))


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
