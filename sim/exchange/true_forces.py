"""The true forces of hands and objects on the arm: on the tool side of the flange sensor, and on its links."""

import mujoco
import numpy as np

from sim.plant.true_arm import Plant

NO_FORCE = (0.0, 0.0)


def true_forces(plant: Plant) -> tuple[float, float]:
    """Size of the force on tool and payload, and of the largest on a link, at the tick's end [N].

    Of each part all forces are added: contacts with objects, friction included, contacts of the arm with itself, and hands.
    """
    if not plant.touched:
        return NO_FORCE
    model, data, flange = plant.model, plant.data, plant.flange_body
    sums = {body: np.zeros(3) for body in plant.link_bodies}
    for part, _, force, _ in plant.hands.touched:
        sums[plant.body_of(part)] += force
    wrench = np.zeros(6)
    for k in range(data.ncon):
        contact = data.contact[k]
        mujoco.mj_contactForce(model, data, k, wrench)
        force = contact.frame.reshape(3, 3).T @ wrench[:3]  # on the second geom, in W
        for geom, sign in ((contact.geom1, -1.0), (contact.geom2, 1.0)):
            body = int(model.geom_bodyid[geom])
            if body == plant.payload_body:  # a held part
                body = flange
            if body in sums:
                sums[body] += sign * force
    sizes = {body: float(np.linalg.norm(force)) for body, force in sums.items()}
    tool = sizes.pop(flange)
    return tool, max(sizes.values())
