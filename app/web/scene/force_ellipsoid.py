"""What free-drive takes for the user's force: an arrow at the tool, round its tip the ellipsoid of 95 % (FD-19)."""

import numpy as np
import viser

from sim.arm.frames import matrix_from_quaternion, quaternion_from_matrix
from sim.exchange.snapshot import Snapshot

METRES_PER_NEWTON = 0.015
"""Of the arrow and of the ellipsoid: 2 N, which lead an arm, stand out of a tool."""

LEAST_FORCE = 0.5
"""A smaller force has no arrow and no label [N]."""

COLOUR = (0, 158, 115)
"""The touches' arrows are blue: those are the true forces."""

BELOW = 0.02
"""The label is so far below both [m]: on the tip it would cover them."""

THINNEST = 1e-3
"""Semi-axis of an ellipsoid, at least [m]."""


class ForceEllipsoid:
    """Arrow, label and ellipsoid. `show` runs in the painter."""

    def __init__(self, scene: viser.SceneApi) -> None:
        nothing = np.zeros((1, 2, 3), dtype=np.float32)
        self.arrow = scene.add_arrows(
            "/user/arrow", nothing, COLOUR, shaft_radius=0.004, head_radius=0.01, head_length=0.02, visible=False
        )
        self.ellipsoid = scene.add_icosphere(
            "/user/ellipsoid", radius=1.0, color=COLOUR, opacity=0.3, visible=False, cast_shadow=False, receive_shadow=False
        )
        self.label = scene.add_label("/user/label", "", visible=False, anchor="top-center", font_screen_scale=0.9)
        self._shown: tuple[float, ...] = ()

    def show(self, snapshot: Snapshot) -> bool:
        """Draw those of a snapshot, or nothing; True if anything changed."""
        shown, user = (), snapshot.user
        known = user is not None and user.covariance is not None
        if user is not None:
            face, R_WB = snapshot.truth_links[-1], matrix_from_quaternion(snapshot.truth_links[0, 3:])
            point = face[:3] + matrix_from_quaternion(face[3:]) @ np.array(user.at)
            force = R_WB @ np.array(user.force)
            axes, R_BE = user.ellipsoid() or (np.zeros(3), np.eye(3))
            tip, R_WE, axes = point + METRES_PER_NEWTON * force, R_WB @ R_BE, METRES_PER_NEWTON * axes
            below = min(point[2], tip[2] - float(np.linalg.norm(R_WE[2] * axes))) - BELOW
            values = (point, tip, axes, quaternion_from_matrix(R_WE), [float(np.linalg.norm(force)), known, below])
            shown = tuple(np.round(np.concatenate(values), 3).tolist())
        if shown == self._shown:
            return False
        self._shown = shown
        self.ellipsoid.visible = known
        self.arrow.visible = self.label.visible = bool(shown) and shown[13] >= LEAST_FORCE
        if shown:
            numbers = np.array(shown)
            self.ellipsoid.position, self.ellipsoid.wxyz = numbers[3:6], numbers[9:13]
            x, y, z = np.maximum(numbers[6:9], THINNEST).tolist()
            self.ellipsoid.scale = (x, y, z)
            self.arrow.points = numbers[:6].reshape(1, 2, 3).astype(np.float32)
            self.label.position, self.label.text = (shown[3], shown[4], shown[15]), f"Estimated hand force: {shown[13]:.0f} N"
        return True
