"""The true payload: attached to the flange, dropped, falling. Everything here is truth."""

from collections.abc import Callable

import mujoco
import numpy as np
from numpy.typing import NDArray

from sim.arm.chain import load_body
from sim.arm.frames import inertia_numbers, quaternion_from_matrix
from sim.arm.scenario import AnyObject, Load
from sim.plant.objects import set_contact_stiffness

Array = NDArray[np.float64]

GRAVITY = 9.81  # [m/s²]
RADIUS = 0.05  # height of a payload's centre when it lies on the floor [m]


class Payload:
    """What hangs on the flange: a load, and a part that a gripper holds. Once dropped, the load is a picture.

    Attributes:
        load: mass, centre and inertia of both now.
        falling: it has been dropped, and nothing was attached since.

    Args:
        model, data: MuJoCo's.
        load: to start with.
        world: objects, whose contact stiffness depends on the masses.
    """

    def __init__(self, model: mujoco.MjModel, data: mujoco.MjData, load: Load, world: list[AnyObject]) -> None:
        self.load = self._own = load
        self._gripped: Load | None = None
        self._model, self._data, self._world = model, data, world
        self._scratch = mujoco.MjData(model)
        self._body = model.body("payload").id
        self._fallen: Array | None = None  # pose (7,) in W
        self._speed = np.zeros(3)  # of the fall, in W [m/s]

    @property
    def own(self) -> Load:
        """The load that is attached, without what a gripper holds; once it is dropped, none."""
        return self._own

    @property
    def falling(self) -> bool:
        """It has been dropped, and nothing was attached since."""
        return self._fallen is not None

    def attach(self, load: Load) -> None:
        """Make `load` the true payload from now on; what was attached before is gone, and what a gripper holds stays."""
        self._own, self._fallen = load, None
        self._become()

    def grip(self, part: Load | None) -> None:
        """Add a part that a gripper holds, in F; None: it holds none any more."""
        self._gripped = part
        self._become()

    def _become(self) -> None:
        body = load_body(self._own)
        self.load = self._own
        if self._gripped is not None:
            body += load_body(self._gripped)
            self.load = Load(mass=body.mass, com=body.com.tolist(), inertia=inertia_numbers(body.inertia))
        values, axes = np.linalg.eigh(body.inertia)
        if np.linalg.det(axes) < 0:
            axes[:, 0] *= -1.0
        model = self._model
        model.body_mass[self._body] = body.mass
        model.body_ipos[self._body] = body.com
        model.body_inertia[self._body] = values
        model.body_iquat[self._body] = quaternion_from_matrix(axes)
        mujoco.mj_setConst(model, self._scratch)
        set_contact_stiffness(model, self._world)

    def drop(self, velocity: Callable[[Array], Array]) -> None:
        """Let it fall.

        Args:
            velocity: tells the flange's velocity (3,) in W [m/s] at a point (3,) in W [m]: it leaves with that.
        """
        if self._own.mass == 0.0:
            return
        position, orientation = self._centre(), self._data.xquat[self._body].copy()
        self._speed = velocity(position)
        self.attach(Load(mass=0.0))
        self._fallen = np.concatenate([position, orientation])

    def fall(self, time: float) -> None:
        """Go on falling for `time` [s], down to the floor."""
        assert self._fallen is not None
        if self._fallen[2] > RADIUS:
            self._speed[2] -= GRAVITY * time
            self._fallen[:3] += self._speed * time
            self._fallen[2] = max(self._fallen[2], RADIUS)

    def pose(self) -> Array | None:
        """Pose (7,) in W of the load's centre, attached or fallen: position [m], quaternion wxyz; None without one."""
        if self._fallen is not None:
            return self._fallen.copy()
        if self._own.mass == 0.0:
            return None
        return np.concatenate([self._centre(), self._data.xquat[self._body]])

    def _centre(self) -> Array:
        """Centre of the load itself (3,) in W [m]."""
        data, body = self._data, self._body
        if self._gripped is None:
            return data.xipos[body].copy()
        return data.xpos[body] + data.xmat[body].reshape(3, 3) @ self._own.com
