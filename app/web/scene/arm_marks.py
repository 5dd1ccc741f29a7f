"""Marks on the arm: a light in the mode's colour, and why free-drive was refused or ended, at the part that it is about."""

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import trimesh
import viser

from sim.arm.arm_file import Arm
from sim.arm.frames import matrix_from_quaternion
from sim.exchange.snapshot import Snapshot

RADIUS, THICK = 0.075, 0.008
"""Of the ring round a joint [m]."""

LIGHT_RADIUS, LIGHT_THICK = 0.042, 0.005
"""Of the light at the last link [m]."""

MARKS = 4
"""Parts marked at once."""

METRES_PER_NEWTON = 0.006
SHORTEST, LONGEST = 0.08, 0.35
"""Length of the arrow of the force that stays [m]."""

LEAST_FORCE = 1.0
"""A smaller force is not shown as one that stays [N]."""

RED = (201, 42, 42)
Colour = tuple[int, int, int]


class PartMark(NamedTuple):
    """A part and what is wrong there."""

    part: str  # a joint, or anything else for the flange
    text: str


class ArmMarks:
    """All of them; nodes below the links, so that they move along without a message. `show` runs in the painter."""

    def __init__(self, server: viser.ViserServer, arm: Arm) -> None:
        self._scene = server.scene
        self._joints = tuple(arm.chain.joints)
        self._light: viser.MeshHandle | None = None
        self._colour: Colour | None = None
        self._marks: tuple[PartMark, ...] = ()
        self._nodes: list[viser.SceneNodeHandle] = []
        self._told: tuple[object, ...] = ()
        nothing = np.zeros((1, 2, 3), dtype=np.float32)
        self.force = self._scene.add_arrows(
            "/marks/force", nothing, RED, shaft_radius=0.007, head_radius=0.018, head_length=0.045, visible=False
        )
        self.label = self._scene.add_label("/marks/force label", "", visible=False, anchor="bottom-center")

    @property
    def marked(self) -> tuple[PartMark, ...]:
        """The parts that are marked."""
        return self._marks

    def light(self, colour: Colour) -> bool:
        """Light the last link's ring in a colour; True if that is another."""
        if colour == self._colour:
            return False
        self._colour = colour
        if self._light is not None:
            self._light.remove()
        ring = _ring(LIGHT_RADIUS, LIGHT_THICK)
        self._light = self._scene.add_mesh_simple(
            f"/arm/{self._joints[-1]}/light", ring.vertices.astype(np.float32), ring.faces, color=colour, cast_shadow=False
        )
        return True

    def mark(self, marks: Sequence[PartMark]) -> bool:
        """Mark these parts; True if they are others."""
        wanted = tuple(marks[:MARKS])
        if wanted == self._marks:
            return False
        self._marks = wanted
        for node in self._nodes:
            node.remove()
        self._nodes = []
        ring = _ring(RADIUS, THICK)
        for number, mark in enumerate(wanted):
            link = mark.part if mark.part in self._joints else self._joints[-1]
            name = f"/arm/{link}/mark {number}"
            points = ring.vertices.astype(np.float32)
            self._nodes.append(self._scene.add_mesh_simple(name, points, ring.faces, color=RED, opacity=0.85, cast_shadow=False))
            self._nodes.append(self._scene.add_label(f"{name} text", mark.text, anchor="bottom-left", font_screen_scale=0.9))
        return True

    def stays(self, snapshot: Snapshot | None) -> bool:
        """Show the force that the arm still feels, or None for no force; True if anything changed."""
        told: tuple[object, ...] = ()
        if snapshot is not None:
            face = snapshot.truth_links[-1]
            force = matrix_from_quaternion(snapshot.truth_links[0, 3:]) @ snapshot.estimate.F_user[:3]  # from axes of B
            size = float(np.linalg.norm(force))
            if size >= LEAST_FORCE:
                tip = face[:3] + force / size * min(max(size * METRES_PER_NEWTON, SHORTEST), LONGEST)
                told = (*np.round(face[:3], 2).tolist(), *np.round(tip, 2).tolist(), f"Still {size:.0f} N")
        if told == self._told:
            return False
        self._told = told
        self.force.visible = self.label.visible = bool(told)
        if told:
            ends = np.array(told[:6], dtype=np.float32).reshape(1, 2, 3)
            self.force.points, self.label.position, self.label.text = ends, ends[0, 1], str(told[6])
        return True


def _ring(radius: float, thick: float) -> trimesh.Trimesh:
    """A ring about the z axis."""
    return trimesh.creation.torus(radius, thick, major_sections=32, minor_sections=8)


def ball_radius(mass: float) -> float:
    """Radius of the ball of water that has this mass [m]."""
    return round((max(mass, 0.05) * 3.0 / (4.0 * math.pi * 1000.0)) ** (1.0 / 3.0), 4)
