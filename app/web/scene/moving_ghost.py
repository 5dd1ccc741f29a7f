"""A ghost of the arm that moves: its limbs are made once, and then only placed."""

from collections.abc import Sequence
from itertools import pairwise

import numpy as np
import trimesh
import viser

from app.web.scene.ghost import RADIUS, Colour
from sim.arm.arm_file import Arm
from sim.arm.frames import joint_frames, quaternion_from_matrix
from sim.exchange.snapshot import Snapshot

SHORTEST = 1e-3
"""Of a limb [m]."""


class MovingGhost:
    """Limbs from joint to joint, half transparent. `name` is that of its node in the picture."""

    def __init__(self, server: viser.ViserServer, arm: Arm, name: str, colour: Colour) -> None:
        self._arm, self.colour = arm, colour
        self._root = server.scene.add_frame(name, show_axes=False, visible=False)
        self._limbs: list[tuple[int, viser.MeshHandle]] = []  # the joint frame that each moves with
        frames = joint_frames(arm, np.zeros(arm.n))
        for k, (frame, following) in enumerate(pairwise(frames)):
            end = frame[:3, :3].T @ (following[:3, 3] - frame[:3, 3])  # which never changes behind joint k
            if np.linalg.norm(end) > SHORTEST:
                shape = trimesh.creation.cylinder(RADIUS, segment=np.array([np.zeros(3), end]), sections=12)
                points, faces = shape.vertices.astype(np.float32), shape.faces
                node = server.scene.add_mesh_simple(
                    f"{name}/{k}", points, faces, color=colour, opacity=0.4, cast_shadow=False, receive_shadow=False
                )
                self._limbs.append((k, node))
        self._q: tuple[float, ...] | None = None

    @property
    def posture(self) -> tuple[float, ...] | None:
        """The posture shown [rad]."""
        return self._q

    def show(self, q: Sequence[float] | None, snapshot: Snapshot) -> bool:
        """Show the arm in posture `q` [rad], or nothing; True if anything changed."""
        wanted = None if q is None else tuple(q)
        if wanted == self._q:
            return False
        self._q = wanted
        self._root.visible = wanted is not None
        if wanted is not None:
            base = snapshot.truth_links[0]
            self._root.position, self._root.wxyz = base[:3], base[3:]
            frames = joint_frames(self._arm, np.array(wanted))
            for k, node in self._limbs:
                node.position, node.wxyz = frames[k][:3, 3], quaternion_from_matrix(frames[k][:3, :3])
        return True
