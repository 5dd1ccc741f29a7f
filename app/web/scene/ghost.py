"""A ghost of the arm in a posture: a waypoint, the way back, where a contact was."""

from collections.abc import Sequence
from itertools import pairwise

import numpy as np
import trimesh
import viser
from numpy.typing import NDArray

from sim.arm.arm_file import Arm
from sim.arm.frames import joint_frames, matrix_from_quaternion
from sim.exchange.snapshot import Snapshot

RADIUS = 0.035  # of its limbs [m]
Colour = tuple[int, int, int]


class Ghost:
    """Limbs from joint to joint, half transparent. `name` is that of its node in the picture."""

    def __init__(self, server: viser.ViserServer, arm: Arm, name: str, colour: Colour) -> None:
        self._server, self._arm = server, arm
        self._name, self.colour = name, colour
        self._q: tuple[float, ...] | None = None
        self.label = server.scene.add_label(f"{name} label", "", visible=False, anchor="top-center", font_screen_scale=0.9)
        self._node: viser.MeshHandle | None = None

    @property
    def posture(self) -> tuple[float, ...] | None:
        """The posture shown [rad]."""
        return self._q

    @property
    def text(self) -> str:
        """What is written at its tool centre point."""
        return self.label.text if self.label.visible else ""

    @property
    def place(self) -> NDArray[np.float64]:
        """Where that is written, (3,) in W [m]."""
        return self.label.position

    def show(self, q: Sequence[float] | None, snapshot: Snapshot, text: str = "") -> bool:
        """Show the arm in posture `q` [rad] with a text at its tool centre point, or nothing; True if anything changed."""
        wanted = None if q is None else tuple(q)
        if wanted is not None and text != self.label.text:
            self.label.text = text
        if wanted == self._q:
            return False
        self._q = wanted
        self.label.visible = wanted is not None and bool(text)
        if self._node is not None:
            self._node.remove()
            self._node = None
        if wanted is not None:
            shape = limbs(self._arm, wanted)
            base = snapshot.truth_links[0]
            vertices = shape.vertices @ matrix_from_quaternion(base[3:]).T + base[:3]
            flange = joint_frames(self._arm, np.array(wanted))[-1]
            self.label.position = matrix_from_quaternion(base[3:]) @ (flange[:3, :3] @ snapshot.p_FT + flange[:3, 3]) + base[:3]
            points, faces = vertices.astype(np.float32), shape.faces
            self._node = self._server.scene.add_mesh_simple(
                self._name, points, faces, color=self.colour, opacity=0.3, cast_shadow=False, receive_shadow=False
            )
        return True


def limbs(arm: Arm, q: Sequence[float]) -> trimesh.Trimesh:
    """Cylinders between the joints' origins, in B."""
    points = [np.zeros(3), *(frame[:3, 3] for frame in joint_frames(arm, np.array(q)))]
    pairs = [pair for pair in pairwise(points) if np.linalg.norm(pair[1] - pair[0]) > 1e-3]
    pieces = [trimesh.creation.cylinder(RADIUS, segment=np.array(pair), sections=12) for pair in pairs]
    whole = trimesh.util.concatenate(pieces)
    assert isinstance(whole, trimesh.Trimesh)
    return whole
