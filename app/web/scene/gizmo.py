"""Handles in the picture, with which one thing is moved and turned by who has control."""

from collections.abc import Callable

import numpy as np
import viser

from app.web.access.guard import Guard
from pendant.tick.pose import Quaternion, Vector

Moved = Callable[[Vector, Quaternion], None]


class Gizmo:
    """One set of handles, or none. Lives on viser's event loop; `bring` and `put_away` run in the painter, which is there, too.

    Args:
        server: of the page.
        guard: lets the handles be moved while they are shown, by who has control.
        name: of their node.
        moved: told at the end of each move, of position [m] and orientation wxyz in the axes of the node above.

    Attributes:
        mover: the client that moves them now; None: nobody does.
    """

    def __init__(self, server: viser.ViserServer, guard: Guard, name: str, moved: Moved) -> None:
        self._server, self._guard, self._name, self._moved = server, guard, name, moved
        self._gizmo: viser.TransformControlsHandle | None = None
        self._pose: tuple[Vector, Quaternion] | None = None  # that the handles were last given
        self.mover: int | None = None

    @property
    def away(self) -> bool:
        """Whether they are not in the picture."""
        return self._gizmo is None

    def make(self, scale: float, *, turns: bool = True) -> None:
        """Have them in the picture, so long [m]; without `turns` they only move."""
        self._gizmo = self._server.scene.add_transform_controls(
            self._name, scale=scale, line_width=4.0, disable_rotations=not turns, depth_test=False
        )
        self._gizmo.on_update(self._see)
        self._guard.let_move(self._name)

    def bring(self, pose: tuple[Vector, Quaternion]) -> bool:
        """Have them at a pose, unless somebody moves them; True if that was elsewhere."""
        if self._gizmo is None or self.mover is not None or pose == self._pose:
            return False
        self._pose = pose
        self._gizmo.position, self._gizmo.wxyz = np.array(pose[0]), np.array(pose[1])
        return True

    def put_away(self) -> bool:
        """Take them out of the picture; True if they were there."""
        if self._gizmo is None:
            return False
        self._guard.fix(self._name)
        self._gizmo.remove()
        self._gizmo = self._pose = self.mover = None
        return True

    def let_go(self, client: int) -> None:
        """What `client` moves goes back to where it was."""
        if self.mover == client:
            self.mover = self._pose = None

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
