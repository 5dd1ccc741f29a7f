"""The arrow of one touch: straight along a force, round its axis for a torque; its label says how large it is."""

import math

import numpy as np
import viser
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]

METRES_PER_NEWTON = 0.004
METRES_PER_NEWTON_METRE = 0.02
"""Length of a force's arrow; radius of a torque's."""

SHORTEST = 0.06
LONGEST = 0.4
"""Length of the arrow of a force [m]."""

SMALLEST, LARGEST = 0.09, 0.14
"""Radius of the arrow of a torque [m]: it goes round the link that is turned."""

TURN = 1.5 * math.pi
PIECES = 24
"""So far an arrow goes round [rad], in so many straight pieces."""

FORCE_COLOUR = (25, 113, 194)
TORQUE_COLOUR = (156, 54, 181)


class TouchArrow:
    """Place `number` for a touch. `show` runs in the painter."""

    def __init__(self, scene: viser.SceneApi, number: int) -> None:
        nothing = np.zeros((1, 2, 3), dtype=np.float32)
        self.arrow = scene.add_arrows(
            f"/touch/{number}/arrow",
            nothing,
            FORCE_COLOUR,
            shaft_radius=0.006,
            head_radius=0.016,
            head_length=0.04,
            visible=False,
        )
        self.arc = scene.add_line_segments(
            f"/touch/{number}/arc", nothing, TORQUE_COLOUR, thickness=5.0, thickness_units="screen", visible=False
        )
        self.label = scene.add_label(f"/touch/{number}/label", "", visible=False, anchor="bottom-center")
        self._shown: tuple[float, ...] = ()

    def show(self, touch: tuple[ArrayLike, ArrayLike, ArrayLike] | None) -> bool:
        """Show point [m], force [N] and torque [N·m] of a touch in W, or none; True if anything changed."""
        shown = () if touch is None else tuple(np.round(np.concatenate(touch), 3).tolist())
        if shown == self._shown:
            return False
        self._shown = shown
        self.arrow.visible = self.label.visible = bool(shown)
        if not shown:
            self.arc.visible = False
            return True
        point, force, torque = (np.array(shown[k : k + 3]) for k in (0, 3, 6))
        self.arc.visible = turning = float(np.linalg.norm(force)) < 1e-9
        amount = float(np.linalg.norm(torque if turning else force))
        if turning:
            ends = arc(point, torque)
            self.arc.points, self.arrow.points = ends[:-1].astype(np.float32), ends[-1:].astype(np.float32)
        else:
            tip = point + (force / amount * min(max(amount * METRES_PER_NEWTON, SHORTEST), LONGEST) if amount > 0.0 else 0.0)
            ends = np.array([[point, tip]])
            self.arrow.points = ends.astype(np.float32)
        self.arrow.colors = np.array(TORQUE_COLOUR if turning else FORCE_COLOUR, dtype=np.uint8)
        self.label.position = ends[-1, 1]
        self.label.text = f"{amount:.1f} N·m" if turning else f"{amount:.0f} N"
        return True


def arc(point: Array, torque: Array) -> Array:
    """Straight pieces (p, 2, 3) round the axis of a torque through a point, in its sense by the right hand [m]."""
    size = float(np.linalg.norm(torque))
    axis = torque / size if size > 0.0 else np.array([0.0, 0.0, 1.0])
    across = np.cross(axis, np.eye(3)[int(np.argmin(np.abs(axis)))])
    across = across / np.linalg.norm(across)
    radius = min(max(size * METRES_PER_NEWTON_METRE, SMALLEST), LARGEST)
    angles = np.arange(PIECES + 1, dtype=np.float64)[:, None] * (TURN / PIECES)
    round_it = np.cos(angles) * across + np.sin(angles) * np.cross(axis, across)
    points = np.asarray(point + radius * round_it, dtype=np.float64)
    return np.stack([points[:-1], points[1:]], axis=1)
