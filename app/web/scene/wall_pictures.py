"""Virtual walls and allowed areas in the picture: surface, name, distance and force, coloured by state (VW-6, VW-7, VW-9)."""

import math

import numpy as np
import viser
from numpy.typing import NDArray

from app.web.scene.surfaces import plane, surface
from pendant.tick.pose import ORIGIN, Pose, Quaternion, Vector, dot, product, quaternion, turned
from pendant.walls.barrier import Place
from pendant.walls.containment import TETHER, WallState
from pendant.walls.definitions import AnyBorder, Wall
from pendant.walls.shapes import HalfSpace
from sim.arm.frames import matrix_from_quaternion
from sim.exchange.snapshot import Snapshot

Array = NDArray[np.float64]

ROOT = "/walls"
"""Name of the node that all of them lie in; its axes are B."""

WALL_SIDE = 0.6
AREA_SIDE = 2.0
"""Sides of the squares that stand for the plane of a wall and of an area [m]."""

STEP = 1e-4
"""Turns smaller than this are not sent [of a quaternion]."""

OPACITY = 0.16
CALM = 0.06
GLOWING = 0.4
"""Opacity of a surface that resists, of one that does not, and of the nearest one where the arm is at it."""

GLOW = 0.2
"""From this distance on the nearest wall glows [m]."""

LEAST_FORCE = 0.5
"""A smaller force is not shown [N]."""

METRES_PER_NEWTON = 0.004
SHORTEST = 0.05
LONGEST = 0.3
"""Length of the arrow of a force [m]."""

GREY = (134, 142, 150)  # does not hold now
GREEN = (47, 158, 68)
AMBER = (230, 119, 0)
RED = (201, 42, 42)


class WallPictures:
    """All of them. `show` runs in the painter."""

    def __init__(self, server: viser.ViserServer) -> None:
        self._server = server
        self._root = server.scene.add_frame(ROOT, show_axes=False)
        self._base = ""
        self._drawn: dict[str, DrawnWall] = {}
        self._made = 0

    @property
    def texts(self) -> list[viser.LabelHandle]:
        """What is written at them, in W."""
        return [drawn.label for drawn in self._drawn.values()]

    def show(self, snapshot: Snapshot) -> bool:
        """Draw those of a snapshot; True if anything changed."""
        changed = False
        base = np.round(snapshot.truth_links[0], 5)
        if (seen := base.tobytes().hex()) != self._base:
            self._base, changed = seen, True
            self._root.position, self._root.wxyz = base[:3], base[3:]
            while self._drawn:  # their texts are in W
                self._drawn.popitem()[1].remove()
        states = {state.name: state for state in snapshot.decision.walls}
        names = [border.name for border, _ in snapshot.places]
        for name in [name for name in self._drawn if name not in names]:
            self._drawn.pop(name).remove()
            changed = True
        for border, place in snapshot.places:
            drawn = self._drawn.get(border.name)
            if drawn is None or not drawn.draws(border):
                if drawn is not None:
                    drawn.remove()
                self._made += 1
                drawn = self._drawn[border.name] = DrawnWall(self._server.scene, f"{ROOT}/{self._made}", border, base)
            changed |= drawn.show(place, states.get(border.name))
        nearest = max((state for state in states.values() if state.name != TETHER), key=lambda s: s.distance, default=None)
        for name, drawn in self._drawn.items():
            changed |= drawn.glow(nearest is not None and name == nearest.name)
        return changed


class DrawnWall:
    """One wall or area: surface, outline, the way that is left with a label at its end, the force on the part."""

    def __init__(self, scene: viser.SceneApi, name: str, border: AnyBorder, base: Array) -> None:
        self._border = border
        self._foot, self._upright = base[:3], matrix_from_quaternion(base[3:])
        shape = surface(border.shape, WALL_SIDE if isinstance(border, Wall) else AREA_SIDE)
        self.surface = scene.add_mesh_simple(
            f"{name} surface",
            shape.vertices.astype(np.float32),
            shape.faces.astype(np.uint32),
            color=GREY,
            opacity=CALM,
            side="double",
            cast_shadow=False,
            receive_shadow=False,
        )
        self.outline = scene.add_line_segments(
            f"{name} outline", shape.outline.astype(np.float32), GREY, thickness=1.2, thickness_units="screen"
        )
        nothing = np.zeros((1, 2, 3), dtype=np.float32)
        self.way = scene.add_line_segments(f"{name} way", nothing, GREY, thickness=1.5, thickness_units="screen", visible=False)
        self.label = scene.add_label(f"/texts{name}", border.name, visible=False, anchor="top-center")
        self.force = scene.add_arrows(
            f"{name} force", nothing, AMBER, shaft_radius=0.005, head_radius=0.014, head_length=0.035, visible=False
        )
        self._nodes = (self.surface, self.outline, self.way, self.label, self.force)
        self._place: Place | None = None
        self._state: WallState | None = None
        self._centre: Vector = ORIGIN
        self._turn: Quaternion = (1.0, 0.0, 0.0, 0.0)
        self._scale = 1.0
        self._told: tuple[object, ...] = ()
        self._colour = GREY
        self._opacity = CALM
        self._pushes: tuple[float, ...] = ()

    def draws(self, border: AnyBorder) -> bool:
        """Whether this is what `border` looks like."""
        return border is self._border or (
            type(border) is type(self._border) and (border.shape, border.on) == (self._border.shape, self._border.on)
        )

    def remove(self) -> None:
        """Take it out of the picture."""
        for node in self._nodes:
            node.remove()

    def show(self, place: Place, state: WallState | None) -> bool:
        """Bring it to a place in B, with what is known of the part, if it holds; True if anything changed."""
        if place == self._place and state == self._state:
            return False
        changed, self._state = False, state
        if place != self._place:
            self._place = place
            changed = self._move(*self._pose(place))
        colour = colour_of(state)
        if colour != self._colour:
            changed, self._colour = True, colour
            self.surface.color = colour
            self.outline.colors = np.array(colour, dtype=np.uint8)
            self.way.colors = np.array(colour, dtype=np.uint8)
        # The tether goes along with the hand and is near all the time: it is in the picture once it resists.
        seen = self._border.name != TETHER or (state is not None and state.near > 0.0)
        if seen != self.surface.visible:
            changed = self.surface.visible = self.outline.visible = seen
        return any([changed, self._tell(state if seen else None, seen), self._push(state)])

    def glow(self, nearest: bool) -> bool:
        """Let the nearest wall glow the more, the nearer it is; True if anything changed."""
        opacity = CALM if self._colour in (GREY, GREEN) else OPACITY
        if nearest and self._state is not None:
            closeness = min(max(1.0 + self._state.distance / GLOW, 0.0), 1.0)
            opacity = max(opacity, CALM + (GLOWING - CALM) * closeness)
        opacity = round(opacity / 0.04) * 0.04  # steps that are seen, and few messages
        if self._opacity == opacity:
            return False
        self._opacity = self.surface.opacity = opacity
        return True

    def _move(self, pose: Pose, scale: float) -> bool:
        """Bring the surface to a pose and a size; True if that is elsewhere than it was."""
        x, y, z = pose.p
        centre, turn, scale = (round(x, 4), round(y, 4), round(z, 4)), quaternion(pose.R), round(scale, 4)
        if max(abs(old - new) for old, new in zip(self._turn, turn, strict=True)) < STEP:
            turn = self._turn
        if (centre, turn, scale) == (self._centre, self._turn, self._scale):
            return False
        for node in (self.surface, self.outline):  # what is set is sent: what stays is not set
            if centre != self._centre:
                node.position = centre
            if turn != self._turn:
                node.wxyz = turn
            if scale != self._scale:
                node.scale = scale
        self._centre, self._turn, self._scale = centre, turn, scale
        return True

    def _pose(self, place: Place) -> tuple[Pose, float]:
        """Pose and scale of the surface: of a plane, where it comes nearest to the wall's centre, or of an area to the base."""
        shape = self._border.shape
        if not isinstance(shape, HalfSpace):
            return place.pose, place.factor
        size = math.hypot(*shape.normal)
        x, y, z = turned(place.pose.R, shape.normal)
        normal = (x / size, y / size, z / size)
        a, b, c, d, e, f, g, h, i = plane(shape.normal).ravel().tolist()
        turn = product(place.pose.R, (a, b, c, d, e, f, g, h, i))
        start = place.pose.p if isinstance(self._border, Wall) else ORIGIN
        px, py, pz = place.pose.p
        sx, sy, sz = start
        away = dot(normal, (px - sx, py - sy, pz - sz)) + place.factor * shape.distance
        return Pose((sx + away * normal[0], sy + away * normal[1], sz + away * normal[2]), turn), 1.0

    def _tell(self, state: WallState | None, seen: bool) -> bool:
        """Show the label, and the way that is left to the wall."""
        told: tuple[object, ...] = ()
        if state is None and seen:
            told = (self._border.name if self._border.on else f"{self._border.name} (off)", *self._centre)
        elif state is not None:
            told = (text_of(state), *(round(value, 3) for value in (*state.p, *_nearest(state))))
        if told == self._told:
            return False
        self._told = told
        self.label.visible = bool(told)
        self.way.visible = state is not None and bool(told)
        if not told:
            return True
        if self.label.text != told[0]:
            self.label.text = str(told[0])
        self.label.position = self._foot + self._upright @ np.array(self._centre if state is None else _nearest(state))
        if state is not None:
            self.way.points = np.array([[state.p, _nearest(state)]], dtype=np.float32)
        return True

    def _push(self, state: WallState | None) -> bool:
        """Show the force on the part."""
        pushes: tuple[float, ...] = ()
        if state is not None and math.hypot(*state.force) >= LEAST_FORCE:
            pushes = (*(round(value, 3) for value in state.p), *(round(value, 1) for value in state.force))
        if pushes == self._pushes:
            return False
        self._pushes = pushes
        self.force.visible = bool(pushes)
        if pushes:
            tail, force = np.array(pushes[:3]), np.array(pushes[3:])
            size = float(np.linalg.norm(force))
            tip = tail + force / size * min(max(size * METRES_PER_NEWTON, SHORTEST), LONGEST)
            self.force.points = np.array([[tail, tip]], dtype=np.float32)
        return True


def colour_of(state: WallState | None) -> tuple[int, int, int]:
    """Grey while it does not hold, then green, amber from where it resists on, red beyond it."""
    if state is None:
        return GREY
    return RED if state.exceeded else AMBER if state.near > 0.0 else GREEN


def text_of(state: WallState) -> str:
    """Name, distance, and the force that it resists with, in words that tell the state without its colour."""
    millimetres = 1000.0 * abs(state.distance)
    where = f"{millimetres:.0f} mm {'beyond' if state.exceeded else 'left'}" if millimetres >= 0.5 else "at it"
    text = f"{state.name}: {where}"
    force = math.hypot(*state.force)
    return f"{text}, resists {force:.0f} N" if force >= LEAST_FORCE else text


def _nearest(state: WallState) -> Vector:
    """The point of the wall that is nearest to the part."""
    x, y, z = state.p
    ox, oy, oz = state.outward
    return x - state.distance * ox, y - state.distance * oy, z - state.distance * oz
