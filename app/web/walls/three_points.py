"""A plane through three points that the tool was brought to."""

import math
from collections.abc import Callable

import numpy as np
import viser
from numpy.typing import NDArray

from app.web.scene.wall_pictures import ROOT
from app.web.widgets import svg
from app.web.widgets.html import Html
from app.web.widgets.svg import Colour
from pendant.tick.pose import Pose, Quaternion, Vector
from sim.arm.frames import quaternion_from_matrix

Array = NDArray[np.float64]

WANTED = 3
LOWEST = 0.05
"""The least height of the triangle of the points: an error of 1 mm in one of them then tilts the plane by about 1° at most [m]"""

SQUARE = 0.1
"""A tool that is turned away from the plane by less does not tell its sides apart [sine of the angle]."""

BALL = 0.012
"""Radius of the mark of a point [m]."""

BLUE = (25, 113, 194)


class ThreePoints:
    """A folder of the walls' tab. Lives on viser's event loop.

    Args:
        server: of the page.
        tool: tells the pose of the tool centre point in B.
        made: told of the plane: origin in B [m], and the orientation whose z axis points out of the allowed side, wxyz.
    """

    def __init__(self, server: viser.ViserServer, tool: Callable[[], Pose], made: Callable[[Vector, Quaternion], None]) -> None:
        self._scene, self._tool, self._made = server.scene, tool, made
        self._points: list[Pose] = []
        self._balls: list[viser.IcosphereHandle] = []
        with server.gui.add_folder("Plane through three points", expand_by_default=False):
            self.take = server.gui.add_button("Take this point", color="gray", hint="Where the tool centre point is now")
            self.again = server.gui.add_button("Forget the points", color="gray", disabled=True)
            self.said = Html(server.gui)
        self._tell()

        @self.take.on_click
        async def _(_: viser.GuiEvent) -> None:
            self._take()

        @self.again.on_click
        async def _(_: viser.GuiEvent) -> None:
            self._forget()
            self._tell()

    def _take(self) -> None:
        at = self._tool()
        self._points.append(at)
        name = f"{ROOT}/point {len(self._points)}"
        self._balls.append(self._scene.add_icosphere(name, radius=BALL, color=BLUE, position=at.p, cast_shadow=False))
        if len(self._points) < WANTED:
            self._tell()
            return
        found = plane_through(self._points)
        self._forget()
        if found is None:
            text = f"They lie nearly in one line: bring the tool at least {1000.0 * LOWEST:.0f} mm away from it."
            self.said.show(svg.note("No plane", text, Colour.AMBER))
            return
        self._tell()
        self._made(*found)

    def _forget(self) -> None:
        for ball in self._balls:
            ball.remove()
        self._points, self._balls = [], []
        self.again.disabled = True

    def _tell(self) -> None:
        count = len(self._points)
        self.again.disabled = count == 0
        told = f"{count} of {WANTED} points taken. " if count else ""
        self.said.show(svg.fine_print(f"{told}Bring the tool to a point of the plane, then take it. The tool's side is allowed."))


def plane_through(points: list[Pose]) -> tuple[Vector, Quaternion] | None:
    """The plane through the places of three tools: its origin in B [m], and axes whose z points out of the allowed side, wxyz.

    The tools come from the allowed side, along their z axes; of tools that lie along the plane it is the side of the base.

    Returns:
        None where the points lie nearly in one line.
    """
    p = np.array([point.p for point in points])
    a, b = p[1] - p[0], p[2] - p[0]
    normal = np.cross(a, b)
    longest = max(float(np.linalg.norm(side)) for side in (a, b, b - a))
    size = float(np.linalg.norm(normal))
    if longest == 0.0 or size / longest < LOWEST:
        return None
    normal = normal / size
    ahead = float(normal @ np.mean([point.R[2::3] for point in points], axis=0))
    outwards = ahead if abs(ahead) >= SQUARE else float(normal @ p[0])
    normal = math.copysign(1.0, outwards) * normal
    x = a / np.linalg.norm(a)
    turn = quaternion_from_matrix(np.column_stack([x, np.cross(normal, x), normal]))
    middle = p.mean(axis=0)
    w, i, j, k = turn.tolist()
    return (float(middle[0]), float(middle[1]), float(middle[2])), (w, i, j, k)
