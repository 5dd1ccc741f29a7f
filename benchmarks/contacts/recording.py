"""One recorded run: what the detectors are fed with, and the truth beside it."""

from dataclasses import dataclass, field

import mujoco
import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from pendant.contact.contact_change import Contact
from pendant.tick.estimate import Estimate
from pendant.tick.source_signal import Signal
from sim.estimation.transmission_torque import DEFLECTION
from sim.simulation import Simulation

Array = NDArray[np.float64]
TICK = 0.002


@dataclass(slots=True)
class Recording:
    """Rows of one run, a tick each. A decision made in a row acts from `time` of that row on."""

    time: list[float] = field(default_factory=list)  # at which the decision of the row is made [s]
    signals: list[tuple[Signal | None, ...]] = field(default_factory=list)
    momentum: list[Array] = field(default_factory=list)  # (12,) p, then tau + C^T qd - g
    q: list[list[float]] = field(default_factory=list)
    tip: list[tuple[float, float, float]] = field(default_factory=list)  # p_BT as estimated
    force: list[float] = field(default_factory=list)  # true contact force at the row's end [N]
    acceleration: list[list[float]] = field(default_factory=list)  # true, of the tool side [m/s²]
    contacts: list[tuple[float, Contact]] = field(default_factory=list)  # of the pendant's own detectors
    speed: list[float] = field(default_factory=list)
    onset: float = np.inf  # true [s]
    touched_by: str = ""

    def add(self, simulation: Simulation, contacts: tuple[Contact, ...]) -> None:
        """Take the tick that `simulation` has just done."""
        estimate = simulation._estimate
        assert isinstance(estimate, Estimate)
        time = (simulation.plant.tick - 1) * TICK
        self.time.append(time)
        self.signals.append(estimate.signals.each())
        self.momentum.append(momentum(simulation, estimate))
        self.q.append(estimate.q.tolist())
        x, y, z = estimate.tcp.tolist()[:3]
        self.tip.append((x, y, z))
        self.speed.append(estimate.v_tcp)
        self.force.append(contact_force(simulation))
        self.acceleration.append(simulation.plant.flange[12:15].tolist())
        self.contacts += [(time, contact) for contact in contacts]


def momentum(simulation: Simulation, estimate: Estimate) -> Array:
    """Generalized momentum of the links and what drives it but for the outside, (12,), by the controller's model."""
    model, data, q, qd = simulation.dynamics.model, simulation.dynamics.data, estimate.q, estimate.qd
    M, C = pin.crba(model, data, q), pin.computeCoriolisMatrix(model, data, q, qd)
    drive = estimate.tau_ways[DEFLECTION] + C.T @ qd - pin.computeGeneralizedGravity(model, data, q)
    return np.concatenate([M @ qd, drive])


def contact_force(simulation: Simulation) -> float:
    """True normal force of all contacts [N]."""
    plant, wrench, total = simulation.plant, np.zeros(6), 0.0
    for i in range(plant.data.ncon):
        mujoco.mj_contactForce(plant.model, plant.data, i, wrench)
        total += float(wrench[0])
    return total


def touching(simulation: Simulation) -> str:
    """Name of the arm's shape that touches something, or nothing."""
    plant = simulation.plant
    for i in range(plant.data.ncon):
        contact = plant.data.contact[i]
        for geom in (contact.geom1, contact.geom2):
            name = plant.model.geom(int(geom)).name
            if name.startswith("shape/"):
                return name
    return ""
