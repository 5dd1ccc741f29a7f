"""What scoring reads of the tick done last, in place: a copy of everything, each tick, would cost more than a recording."""

from collections.abc import Sequence
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from pendant.tick.estimate import Estimate
from pendant.tooling.tool_in_use import Fitting
from sim.control.controller import Controller
from sim.plant.touch import Triple
from sim.plant.true_arm import Plant

Array = NDArray[np.float64]


class Scored(Protocol):
    """What scoring reads of a tick, of a `Glance` or of a `snapshot.Snapshot`, which says shapes, units and frames."""

    @property
    def estimate(self) -> Estimate:
        """What the controller knew."""
        ...

    @property
    def truth_links(self) -> Array:
        """Poses (n + 2, 7) of foot, links and flange."""
        ...

    @property
    def truth_payload_mass(self) -> float:
        """Mass of what is attached [kg]."""
        ...

    @property
    def configured_mass(self) -> float:
        """What the controller believes, beyond the tool [kg]."""
        ...

    @property
    def wanted_q(self) -> Array:
        """Reference (n,) of the tracking laws [rad]; empty in free-drive."""
        ...

    @property
    def truth_q(self) -> Array:
        """Output angles (n,) [rad]."""
        ...

    @property
    def truth_friction(self) -> Array:
        """Friction (n,) of both sides [N·m]."""
        ...

    @property
    def truth_tau_J(self) -> Array:
        """Transmission torque (n,) [N·m]."""
        ...

    @property
    def truth_touched(self) -> bool:
        """A hand or an object touches the arm, or what it carries."""
        ...


class RunningSimulation(Protocol):
    """What a view of a running simulation reads of it."""

    plant: Plant
    controller: Controller

    @property
    def estimate(self) -> Estimate:
        """What the controller knew."""
        ...

    @property
    def fitting(self) -> Fitting:
        """Tool and payload as the controller believes in them."""
        ...


class Glance:
    """`Scored` of a running simulation; what it gives changes with the next tick."""

    def __init__(self, simulation: RunningSimulation) -> None:
        self._simulation = simulation

    @property
    def estimate(self) -> Estimate:
        """See `Scored.estimate`."""
        return self._simulation.estimate

    @property
    def truth_links(self) -> Array:
        """See `Scored.truth_links`."""
        return self._simulation.plant.poses()

    @property
    def truth_payload_mass(self) -> float:
        """See `Scored.truth_payload_mass`."""
        return self._simulation.plant.payload.load.mass

    @property
    def configured_mass(self) -> float:
        """See `Scored.configured_mass`."""
        return self._simulation.fitting.mass

    @property
    def wanted_q(self) -> Array:
        """See `Scored.wanted_q`."""
        return self._simulation.controller.references.wanted()

    @property
    def truth_q(self) -> Array:
        """See `Scored.truth_q`."""
        return self._simulation.plant.q

    @property
    def truth_friction(self) -> Array:
        """See `Scored.truth_friction`."""
        return self._simulation.plant.sliding_friction()

    @property
    def truth_tau_J(self) -> Array:
        """See `Scored.truth_tau_J`."""
        return self._simulation.plant.tau_J

    @property
    def truth_touched(self) -> bool:
        """See `Scored.truth_touched`."""
        return self._simulation.plant.touched


def point_of(seen: Scored, joints: list[str], part: str, point: Sequence[float] = (0.0, 0.0, 0.0)) -> Triple:
    """A point of a part, in W [m].

    Args:
        seen: whose truth is read.
        joints: the arm's joint names, base to flange.
        part: "foot", a joint's link by its joint name, "flange" or "tool"; these two are the tool-side face of the flange sensor.
        point: in the part's frame [m].
    """
    row = -1 if part in ("flange", "tool") else 0 if part == "foot" else 1 + joints.index(part)
    x, y, z, w, i, j, k = seen.truth_links[row].tolist()
    a, b, c = point
    # Rotation by the unit quaternion (w, v): p + 2 w t + 2 v x t with t = v x p; by hand, since it runs every tick.
    tx, ty, tz = j * c - k * b, k * a - i * c, i * b - j * a
    return (
        x + a + 2.0 * (w * tx + j * tz - k * ty),
        y + b + 2.0 * (w * ty + k * tx - i * tz),
        z + c + 2.0 * (w * tz + i * ty - j * tx),
    )
