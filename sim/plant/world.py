"""The objects of the world as time goes on: what moves, what gives way, what is slippery where. Everything here is truth."""

import math
from collections.abc import Sequence

import mujoco
import numpy as np
from numpy.typing import NDArray

from sim.arm.scenario import AnyObject, FreeBox, FreeCylinder, Moving, SnapFit, TwoFrictions
from sim.plant.objects import SNAP_SLIP

Array = NDArray[np.float64]


INSIDE = 0.005
"""An arm that begins farther inside an object is thrown away by it [m]."""


class World:
    """What objects need once a tick.

    Attributes:
        bodies: MuJoCo's number of each object (m,).

    Args:
        model, data: MuJoCo's.
        items: the objects, m of them.
        tick: length of a control tick [s].
    """

    def __init__(self, model: mujoco.MjModel, data: mujoco.MjData, items: Sequence[AnyObject], tick: float) -> None:
        self._model, self._data, self._items, self._tick = model, data, items, tick
        self.bodies: NDArray[np.int_] = np.array([model.body(f"object/{item.name}").id for item in items], dtype=int)
        self._tip = model.geom("shape/tool").id if items else -1
        self._pairs = [[model.pair(f"shape/tool {item.name}").id] for item in items]

    def advance(self) -> None:
        """Drive moving objects, let snap-fits go, choose the friction under the tool: before the steps of a tick."""
        model, data, time = self._model, self._data, self._data.time
        for k, item in enumerate(self._items):
            body = self.bodies[k]
            if isinstance(item, Moving):
                rate = 2.0 * math.pi / item.period
                middle = time + 0.5 * self._tick
                amplitude = data.xmat[body].reshape(3, 3).T @ item.amplitude
                dofs = slice(model.body_dofadr[body], model.body_dofadr[body] + 3)
                at = slice(model.jnt_qposadr[model.body_jntadr[body]], None)
                data.qpos[at][:3] = amplitude * math.sin(rate * time)
                data.qvel[dofs] = amplitude * rate * math.cos(rate * middle)
            elif isinstance(item, SnapFit):
                given = data.qpos[model.jnt_qposadr[model.body_jntadr[body]]] > SNAP_SLIP
                model.dof_frictionloss[int(model.body_dofadr[body])] = item.force * (item.rest if given else 1.0)
            elif isinstance(item, TwoFrictions):
                R = data.xmat[body].reshape(3, 3)
                tip = data.geom_xpos[self._tip] - data.xpos[body]
                friction = item.friction_beyond if float(R[:, 0] @ tip) > 0.0 else item.friction
                model.pair_friction[self._pairs[k], :2] = friction

    def overlap(self) -> str:
        """Which object the arm is inside of, how deep, in a clause, or ""; what it only touches does not count."""
        names = [f"object/{item.name}" for item in self._items]
        for contact in self._data.contact:
            if contact.dist < -INSIDE:
                geoms = {self._model.geom(int(geom)).name for geom in contact.geom}
                found = [repr(item.name) for item, name in zip(self._items, names, strict=True) if name in geoms] or ["itself"]
                who = "the arm begins" if len(found) == 1 else f"{found.pop()} begins"
                return f"{who} {-1000.0 * contact.dist:.0f} mm inside {found[0]}"
        return ""

    def place(self, name: str, position: Sequence[float]) -> None:
        """Put the object `name` at `position` (3,) in W [m].

        Raises:
            KeyError: there is no such object.
        """
        model = self._model
        item = next((item for item in self._items if item.name == name), None)
        if isinstance(item, FreeBox | FreeCylinder):
            joint = model.joint(f"free/{name}").id
            at, dof = model.jnt_qposadr[joint], model.jnt_dofadr[joint]
            self._data.qpos[at : at + 3] = position
            self._data.qvel[dof : dof + 6] = 0.0
            return
        model.body_pos[model.body(f"object/{name}").id] = position
