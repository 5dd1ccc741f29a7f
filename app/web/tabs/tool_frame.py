"""The tool frame in the picture: where the tool centre point of the chosen tool is, with handles that move and turn it."""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
import viser

from app.web.access.guard import Guard
from app.web.scene.gizmo import Gizmo
from pendant.equipment.tools import Tool
from pendant.tick.pose import Quaternion, Vector
from sim.arm.frames import matrix_from_quaternion, quaternion_from_matrix, rotation_from_rpy, rpy_from_matrix
from sim.exchange.snapshot import Snapshot

FLANGE = "/tool frame"
"""Name of the node that the frame lies in; its axes are F."""

LENGTH, RADIUS = 0.08, 0.003
"""Of the axes of the frame [m]."""

SCALE = 0.16
"""Length of its handles [m]."""

STEP = 1e-5
"""Changes smaller than this are not sent [m, and 1 for quaternions]."""


class ToolPlace(NamedTuple):
    """Where a tool centre point is on the flange."""

    tcp: list[float]  # p_FT [m]
    rpy: list[float]  # of T in F [rad]


class ToolFrame:
    """The frame, a label, and its handles. Lives on viser's event loop; `show` runs in the painter, which is there, too.

    Args:
        server: of the page.
        guard: lets the handles be moved by who has control.
        moved: told where the tool centre point was brought to.
    """

    def __init__(self, server: viser.ViserServer, guard: Guard, moved: Callable[[ToolPlace], None]) -> None:
        scene = server.scene
        self._moved = moved
        self._flange = scene.add_frame(FLANGE, show_axes=False, visible=False)
        self._axes = scene.add_frame(f"{FLANGE}/axes", axes_length=LENGTH, axes_radius=RADIUS)
        self._label = scene.add_label(f"{FLANGE}/axes/name", "", anchor="top-center")
        self._at = np.zeros(7)  # where the flange was last
        self._tool: Tool | None = None
        self.handles = Gizmo(server, guard, f"{FLANGE}/handles", self._see)

    def show(self, tool: Tool | None, snapshot: Snapshot, *, fixed: bool) -> bool:
        """Show the frame of a tool, or none; handles only where it is not `fixed`. True if anything changed."""
        changed = self._flange.visible is (tool is None)
        if changed:
            self._flange.visible = tool is not None
        if tool is None:
            return self.handles.put_away() or changed
        at = snapshot.truth_links[-1]
        if float(np.max(np.abs(at - self._at))) > STEP:
            self._at, changed = at.copy(), True
            self._flange.position, self._flange.wxyz = at[:3], at[3:]
        x, y, z = tool.tcp
        w, i, j, k = quaternion_from_matrix(rotation_from_rpy(tool.rpy)).tolist()
        if tool is not self._tool:
            self._tool, changed = tool, True
            self._axes.position, self._axes.wxyz = np.array(tool.tcp), np.array([w, i, j, k])
            self._label.text = f"TCP of {tool.name}"
        if fixed:
            return self.handles.put_away() or changed
        if self.handles.away:
            self.handles.make(SCALE)
        return self.handles.bring(((x, y, z), (w, i, j, k))) or changed

    def _see(self, p: Vector, turn: Quaternion) -> None:
        rpy = rpy_from_matrix(matrix_from_quaternion(turn))
        self._moved(ToolPlace([round(way, 4) + 0.0 for way in p], [round(angle, 4) + 0.0 for angle in rpy]))  # no -0
