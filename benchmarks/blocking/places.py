"""Where the tool of the true arm is, and what is put in its way."""

import numpy as np

from sim.arm.frames import rpy_from_matrix
from sim.arm.scenario import BoxObject
from sim.simulation import Simulation

Array = np.ndarray


def tip(device: Simulation) -> Array:
    """True tool centre point (3,) in W [m]."""
    plant = device.plant
    body = plant.model.body("flange").id
    return plant.data.xpos[body] + plant.data.xmat[body].reshape(3, 3) @ device.tcp


def box_across(name: str, surface: Array, x: Array, size: tuple[float, float, float], *, stiffness: float) -> BoxObject:
    """A box across a way.

    Args:
        name: of the box.
        surface: where the way meets it (3,) [m].
        x: direction of the way (3,).
        size: along the way, then across it [m].
        stiffness: [N/m].
    """
    y = np.cross(x, [0.0, 0.0, 1.0] if abs(x[2]) < 0.9 else [1.0, 0.0, 0.0])
    y /= np.linalg.norm(y)
    rpy = rpy_from_matrix(np.column_stack([x, y, np.cross(x, y)]))
    centre = surface + x * 0.5 * size[0]
    return BoxObject(name=name, position=centre.tolist(), rpy=list(rpy), size=list(size), stiffness=stiffness)
