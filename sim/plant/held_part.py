"""A part that a gripper holds: while it does, the part is one with the payload, and its own body goes along
without weight (GR-2).

Its shape on the payload (`carried/<name>`, sim.plant.objects) is what then touches the world; its own body touches nothing.
"""

import math
from collections.abc import Callable, Sequence

import mujoco
import numpy as np
from numpy.typing import NDArray

from sim.arm.frames import inertia_numbers, quaternion_from_matrix
from sim.arm.scenario import AnyObject, AnyPart, Load
from sim.compiled.kernel import kernel
from sim.gripping.grip_strength import HeldBody
from sim.plant.attached_payload import Payload
from sim.plant.objects import NOWHERE, parts_of, set_contact_stiffness

Array = NDArray[np.float64]

SLID = 1e-3
"""Way in the grip after which the payload's centre is set anew [m]."""


class HeldParts:
    """Takes a free part over to the payload, and gives it back.

    Args:
        model, data: MuJoCo's.
        world: all objects.
        payload: that grows by what is held.
        flange: MuJoCo's number of the body F.
    """

    def __init__(
        self, model: mujoco.MjModel, data: mujoco.MjData, world: Sequence[AnyObject], payload: Payload, *, flange: int
    ) -> None:
        self._model, self._data, self._payload, self._flange = model, data, payload, flange
        self.parts = parts_of(world)
        self.held: AnyPart | None = None
        self.body = HeldBody(0.0, (0.0, 0.0, 0.0), (0.0, 0.0, 0.0, 0.0, 0.0, 0.0))
        self._pose = np.zeros(7)  # of the held part in F
        self._at, self._dof, self._geom = 0, 0, -1
        self._world = world
        self._nowhere = [model.geom(name).id for name in NOWHERE] if self.parts else []
        self._geoms = np.array([model.pair_geom1, model.pair_geom2])  # (2, pairs) as they are while in use
        self._frames = (data.xmat, data.geom_xpos)
        names = [model.pair(k).name for k in range(model.npair)]
        free = {part.name: f"object/{part.name}" for part in self.parts}
        pairs = [{model.geom(int(g)).name for g in (model.pair_geom1[k], model.pair_geom2[k])} for k in range(model.npair)]
        self._lying = {name: [k for k, both in enumerate(pairs) if free[name] in both] for name in free}
        self._carried = {name: [k for k, both in enumerate(pairs) if f"carried/{name}" in both] for name in free}
        self._fingers = {name: [k for k in lying if names[k].startswith("shape/finger")] for name, lying in self._lying.items()}
        self._lying = {name: [k for k in lying if k not in self._fingers[name]] for name, lying in self._lying.items()}
        for name in free:
            self._switch(self._carried[name], False)

    def pose(self, part: AnyPart) -> tuple[Array, Array]:
        """Where a part lies: position (3,) [m] and rotation (3, 3) in W."""
        body = self._model.body(f"object/{part.name}").id
        return self._data.xpos[body].copy(), self._data.xmat[body].reshape(3, 3).copy()

    def shift(self, part: AnyPart, way: Array) -> None:
        """Push a part aside by a way (3,) in W [m], as a finger does that is stronger than all friction."""
        at = self._model.jnt_qposadr[self._model.joint(f"free/{part.name}").id]
        self._data.qpos[at : at + 3] += way

    def let_pass(self, part: AnyPart, passes: bool) -> None:
        """Have the fingers pass by a part that is between them, or touch it."""
        self._switch(self._fingers[part.name], not passes)
        set_contact_stiffness(self._model, self._world)

    def take(self, part: AnyPart, aside: Array) -> None:
        """Make a part one with the payload, `aside` (3,) in W of where it is [m]."""
        model, data = self._model, self._data
        p, R = self.pose(part)
        p += aside
        p_F, R_F = data.xpos[self._flange], data.xmat[self._flange].reshape(3, 3)
        com, turn = R_F.T @ (p - p_F), R_F.T @ R
        self._pose[:3], self._pose[3:] = com, quaternion_from_matrix(turn)
        body = model.body(f"object/{part.name}").id
        own = np.empty(9)
        mujoco.mju_quat2Mat(own, model.body_iquat[body])
        axes = turn @ own.reshape(3, 3)
        six = inertia_numbers(axes @ np.diag(model.body_inertia[body]) @ axes.T)
        x, y, z = com.tolist()
        joint = model.joint(f"free/{part.name}").id
        self._at, self._dof = int(model.jnt_qposadr[joint]), int(model.jnt_dofadr[joint])
        geom = self._geom = model.geom(f"carried/{part.name}").id
        model.geom_pos[geom], model.geom_quat[geom] = self._pose[:3], self._pose[3:]
        self._switch(self._lying[part.name], False)
        self._switch(self._carried[part.name], True)
        self.held = part
        self._weigh(HeldBody(part.mass, (x, y, z), (six[0], six[1], six[2], six[3], six[4], six[5])))
        self.follow()

    def give(self, velocity: Callable[[Array], Array]) -> None:
        """Let the held part go, with the velocity of the flange.

        Args:
            velocity: tells the flange's velocity (3,) in W [m/s] at a point (3,) in W [m].
        """
        part = self.held
        assert part is not None
        self.follow()
        data = self._data
        data.qvel[self._dof : self._dof + 3] = velocity(data.qpos[self._at : self._at + 3])
        spin = np.empty(6)
        mujoco.mj_objectVelocity(self._model, data, mujoco.mjtObj.mjOBJ_BODY, self._flange, spin, 0)
        R = np.empty(9)
        mujoco.mju_quat2Mat(R, data.qpos[self._at + 3 : self._at + 7])
        data.qvel[self._dof + 3 : self._dof + 6] = R.reshape(3, 3).T @ spin[:3]
        self._switch(self._carried[part.name], False)
        self._switch(self._lying[part.name], True)
        self.held, self._geom = None, -1
        self._payload.grip(None)

    def follow(self) -> None:
        """Put the held part's own body where the flange has it, at rest: once a tick."""
        data = self._data
        _follow((data.xpos, data.xquat, self._flange), self._pose, (data.qpos, data.qvel), (self._at, self._dof))

    def held_pose(self) -> tuple[Array, Array]:
        """Where the held part is: position (3,) [m] and rotation (3, 3) in W."""
        R = np.empty(9)
        mujoco.mju_quat2Mat(R, self._data.qpos[self._at + 3 : self._at + 7])
        return self._data.qpos[self._at : self._at + 3].copy(), R.reshape(3, 3)

    def slide(self, along: Array, share: float) -> None:
        """Move the held part in the grip, out of what it touches.

        Args:
            along: direction (3,) in F.
            share: of the depth to which it is in what it touches.
        """
        contacts = self._data.contact
        depth = -float(contacts.dist[(contacts.geom == self._geom).any(axis=1)].min())
        self._pose[:3] += max(depth, 0.0) * share * along
        self._model.geom_pos[self._geom] = self._pose[:3]
        x, y, z = self._pose[:3].tolist()
        if math.dist((x, y, z), self.body.com) > SLID:
            self._weigh(self.body._replace(com=(x, y, z)))

    def place(self, poses: Array, row: int) -> None:
        """Write where the held part is into a row of poses (m, 7) in W."""
        poses[row] = self._data.qpos[self._at : self._at + 7]

    def touched(self) -> Array:
        """What touches the held part elsewhere: force [N] and torque about its centre [N·m], in F (6,)."""
        data, found = self._data, np.zeros(6)
        if data.ncon == 0:
            return found
        contacts = data.contact
        geoms = contacts.geom
        forces = np.zeros((len(geoms), 6))
        for k, pair in enumerate(geoms.tolist()):
            if self._geom in pair:
                mujoco.mj_contactForce(self._model, data, k, forces[k])
        _sum((forces, geoms, contacts.frame, contacts.pos), self._frames, (self._geom, self._flange), found)
        return found

    def _weigh(self, body: HeldBody) -> None:
        """Make the held part's weight that of the payload."""
        self.body = body
        self._payload.grip(Load(mass=body.mass, com=list(body.com), inertia=list(body.inertia)))

    def _switch(self, pairs: Sequence[int], on: bool) -> None:
        """Have pairs of shapes touch, or be two that never meet."""
        model = self._model
        for k in pairs:
            model.pair_geom1[k], model.pair_geom2[k] = self._geoms[:, k] if on else self._nowhere


@kernel
def _follow(frames, pose, state, place) -> None:
    """Write position and orientation of a body that is fixed to the flange."""
    positions, orientations, flange = frames
    qpos, qvel = state
    at, dof = place
    p, q = positions[flange], orientations[flange]
    w, x, y, z = q[0], q[1], q[2], q[3]
    a, b, c = pose[0], pose[1], pose[2]
    tx, ty, tz = y * c - z * b, z * a - x * c, x * b - y * a
    qpos[at] = p[0] + a + 2.0 * (w * tx + y * tz - z * ty)
    qpos[at + 1] = p[1] + b + 2.0 * (w * ty + z * tx - x * tz)
    qpos[at + 2] = p[2] + c + 2.0 * (w * tz + x * ty - y * tx)
    a, b, c, d = pose[3], pose[4], pose[5], pose[6]
    qpos[at + 3] = w * a - x * b - y * c - z * d
    qpos[at + 4] = w * b + x * a + y * d - z * c
    qpos[at + 5] = w * c - x * d + y * a + z * b
    qpos[at + 6] = w * d + x * c - y * b + z * a
    for i in range(6):
        qvel[dof + i] = 0.0


@kernel
def _sum(contacts, places, bodies, out) -> None:
    """Add up the contact forces (m, 6) on a geom in F, with the torque about its middle. They act on the second of two geoms."""
    forces, geoms, frames, points = contacts
    own, flange = bodies
    R, centre = places[0][flange], places[1][own]
    for k in range(geoms.shape[0]):
        if geoms[k, 0] != own and geoms[k, 1] != own:
            continue
        sign = 1.0 if geoms[k, 1] == own else -1.0
        f, t = np.zeros(3), np.zeros(3)
        for i in range(3):
            for j in range(3):
                f[i] += sign * frames[k, 3 * j + i] * forces[k, j]
                t[i] += sign * frames[k, 3 * j + i] * forces[k, 3 + j]
        x, y, z = points[k, 0] - centre[0], points[k, 1] - centre[1], points[k, 2] - centre[2]
        t[0] += y * f[2] - z * f[1]
        t[1] += z * f[0] - x * f[2]
        t[2] += x * f[1] - y * f[0]
        for i in range(3):
            for j in range(3):
                out[i] += R[3 * j + i] * f[j]
                out[3 + i] += R[3 * j + i] * t[j]
