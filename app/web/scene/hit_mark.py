"""A mark in the picture where the arm hit something, with force and speed: what the controller knows, not the truth."""

from collections.abc import Mapping

import numpy as np
import viser
from numpy.typing import NDArray

from pendant.events.event import Event, Values, posture_of
from sim.arm.arm_file import Arm
from sim.arm.frames import joint_frames, matrix_from_quaternion
from sim.exchange.snapshot import Snapshot

Array = NDArray[np.float64]

RED = (201, 42, 42)

RADII: Mapping[str, float] = {
    "tool": 0.045,
    "wrist": 0.075,
    "wrist or tool": 0.075,
    "elbow or forearm": 0.18,
    "forearm or wrist": 0.18,
}
"""Of the mark, so that it stands out of the part [m]."""

LINK_RADIUS = 0.1
"""The same of the links up to the forearm [m]."""

ABOVE = 0.05
"""Of the label over the mark [m]."""


class HitMark:
    """A red ball about the part that met something, where that part was."""

    def __init__(self, server: viser.ViserServer, arm: Arm) -> None:
        self._arm = arm
        self._shown: Event | None = None
        self.ball = server.scene.add_icosphere(
            "/hit/ball", radius=1.0, color=RED, opacity=0.45, visible=False, cast_shadow=False, receive_shadow=False
        )
        self.label = server.scene.add_label("/hit/label", "", visible=False, anchor="bottom-center")

    def show(self, event: Event | None, snapshot: Snapshot) -> bool:
        """Show where an event of `pendant.safety.rows.MET` happened, or nothing; True if anything changed."""
        if event == self._shown:
            return False
        self._shown = event
        self.ball.visible = self.label.visible = event is not None
        if event is not None:
            values, base = event.values, snapshot.truth_links[0]
            part, radius = str(values["part"]), RADII.get(str(values["part"]), LINK_RADIUS)
            place = base[:3] + matrix_from_quaternion(base[3:]) @ where(self._arm, values)
            self.ball.position, self.ball.scale = place, radius
            self.label.position = place + np.array([0.0, 0.0, radius + ABOVE])
            self.label.text = f"{part.capitalize()}: {float(values['force']):.0f} N at {float(values['speed']):.0f} mm/s"
        return True


def where(arm: Arm, values: Values) -> Array:
    """Where the part was that met something, (3,) in B [m]: the tool centre point, the middle of the link, or between two."""
    if values["part"] == "tool":
        return np.array([float(values[axis]) for axis in "xyz"])
    origins, elbow = joint_frames(arm, np.array(posture_of(values)))[:, :3, 3], arm.chain.elbow
    wrist: Array = origins[elbow + 1 :].mean(axis=0)
    places = {"elbow": origins[elbow], "forearm": (origins[elbow] + origins[elbow + 1]) / 2.0}
    told = [places.get(part, wrist) for part in str(values["part"]).split(" or ")]
    return np.array(told).mean(axis=0)
