"""A chain of transforms against two other readers of the same numbers: written as URDF, read by MuJoCo and by Pinocchio."""

import math
from typing import Any

import msgspec
import mujoco
import numpy as np
import pinocchio as pin
import pytest

from app.files.library import load_arm
from sim.arm.arm_file import Arm, LinkOrigin
from sim.arm.chain import chain, plate_body
from sim.arm.frames import joint_frames, rpy_from_matrix
from sim.arm.scenario import Load, Scenario
from sim.plant.true_arm import Plant
from sim.rigid_body.dynamics import Dynamics

POSTURES, SAME = 1000, 1e-9
IIWA7 = load_arm("iiwa7")


def scattered(seed: int) -> Arm:
    """Seven joints that sit anywhere, turn about any axis, and are given by angles or by a quaternion of any length."""
    rng = np.random.default_rng(seed)
    raw: Any = msgspec.to_builtins(IIWA7)
    for k, origin in enumerate([*raw["chain"]["origins"], raw["chain"]["flange"]]):
        origin["xyz"] = rng.uniform(-0.2, 0.2, 3).tolist()
        if k % 2:
            origin["rpy"] = rng.uniform(-3.0, 3.0, 3).tolist()
        else:
            origin["quaternion"] = rng.uniform(-2.0, 2.0, 4).tolist()
        if k < 7:
            origin["axis"] = [[0.0, 0.0, -1.0], [0.0, 0.0, 3.0]][k] if k < 2 else rng.uniform(-1.0, 1.0, 3).tolist()
    raw["masses"]["com"] = rng.uniform(-0.1, 0.1, (7, 3)).tolist()
    return msgspec.convert(raw, Arm)


def urdf(arm: Arm) -> str:
    """The chain as a URDF, with the same frames."""

    def text(values: Any) -> str:
        return " ".join(f"{value:.17g}" for value in values)

    def joint(name: str, kind: str, links: tuple[str, str], origin: LinkOrigin) -> str:
        R = np.eye(3)
        if origin.quaternion is not None:
            w, x, y, z = np.array(origin.quaternion) / math.hypot(*origin.quaternion)
            R = pin.Quaternion(w, x, y, z).matrix()
        rpy = rpy_from_matrix(R) if origin.rpy is None else origin.rpy
        axis = f'<axis xyz="{text(np.array(origin.axis or [0, 0, 1]) / math.hypot(*(origin.axis or [1])))}"/>'
        return (
            f'<joint name="{name}" type="{kind}"><origin xyz="{text(origin.xyz)}" rpy="{text(rpy)}"/><parent link="{links[0]}"/>'
            f'<child link="{links[1]}"/>{axis}<limit lower="-9" upper="9" effort="1" velocity="1"/></joint>'
        )

    parts, before = ['<link name="foot"/>'], "foot"
    for k, name in enumerate(arm.chain.joints):
        xx, yy, zz, xy, xz, yz = arm.inertias.tensor[k]
        moments = f'ixx="{xx!r}" iyy="{yy!r}" izz="{zz!r}" ixy="{xy!r}" ixz="{xz!r}" iyz="{yz!r}"'
        centre, mass = text(arm.masses.com[k]), arm.masses.mass[k]
        parts.append(
            f'<link name="{name}"><inertial><origin xyz="{centre}"/><mass value="{mass!r}"/>'
            f"<inertia {moments}/></inertial></link>"
        )
        parts.append(joint(f"q/{name}", "revolute", (before, name), arm.chain.origins[k]))
        before = name
    assert arm.chain.flange is not None
    parts += ['<link name="flange"/>', joint("at/flange", "fixed", (before, "flange"), arm.chain.flange)]
    return f'<robot name="arm"><mujoco><compiler fusestatic="false" balanceinertia="false"/></mujoco>{"".join(parts)}</robot>'


def far(found: np.ndarray, expected: np.ndarray) -> float:
    """The largest difference, relative to the largest number."""
    return float(np.abs(found - expected).max() / np.abs(expected).max())


@pytest.mark.parametrize("arm", [IIWA7, scattered(1), scattered(2)], ids=["iiwa7", "scattered 1", "scattered 2"])
def test_the_model_is_what_two_parsers_read(arm: Arm) -> None:
    rigid = chain(arm)
    ours = Dynamics(rigid, rigid.links, plate_body(arm), mounting=[0.0, 0.0, 0.0], elbow=arm.chain.elbow)
    model = mujoco.MjModel.from_xml_string(urdf(arm))
    data, mass = mujoco.MjData(model), np.zeros((arm.n, arm.n))
    other = pin.buildModelFromXML(urdf(arm))
    work, frame = other.createData(), other.getFrameId("flange")
    assert model.nv == other.nv == arm.n
    ours.model.gravity = other.gravity  # its standard gravity is not ours
    model.opt.gravity[:] = other.gravity.linear
    rng, worst = np.random.default_rng(7), 0.0
    for _ in range(POSTURES):
        q = rng.uniform(-3.1, 3.1, arm.n)
        data.qpos[:] = q
        mujoco.mj_forward(model, data)
        mujoco.mj_fullM(model, data, mass)
        pin.forwardKinematics(other, work, q)
        place = pin.updateFramePlacement(other, work, frame)
        p, R = (x.copy() for x in ours.update(q)[:2])
        flange = joint_frames(arm, q)[-1]
        mass_theirs = pin.crba(other, work, q).copy()
        mass_theirs = np.triu(mass_theirs) + np.triu(mass_theirs, 1).T
        worst = max(
            worst,
            far(ours.mass(q), mass_theirs),
            far(ours.mass(q), mass),
            far(ours.gravity(q), pin.computeGeneralizedGravity(other, work, q)),
            far(ours.gravity(q), data.qfrc_bias),
            far(p, place.translation),
            far(p, data.body("flange").xpos),
            far(R, place.rotation),
            far(R, data.body("flange").xmat.reshape(3, 3)),
            far(flange[:3, 3], p),
            far(flange[:3, :3], R),
        )
    assert worst < SAME


@pytest.mark.parametrize("arm", [IIWA7, scattered(3)], ids=["iiwa7", "scattered 3"])
def test_the_plant_is_the_same_arm(arm: Arm) -> None:
    """The physics and the controller's model agree, without a flange sensor."""
    plant, rigid = Plant(arm, Scenario(payload_true=Load(mass=0.0))), chain(arm)
    dynamics = Dynamics(rigid, rigid.links, plate_body(arm), mounting=[0.0, 0.0, 0.0], elbow=arm.chain.elbow)
    model, data = plant.model, plant.data
    dofs = np.array([model.joint(f"q/{name}").dofadr[0] for name in arm.chain.joints])
    at = np.array([model.joint(f"q/{name}").qposadr[0] for name in arm.chain.joints])
    rng = np.random.default_rng(5)
    for _ in range(20):
        data.qpos[at] = q = rng.uniform(-3.0, 3.0, arm.n)
        data.qvel[dofs] = qd = rng.uniform(-2.0, 2.0, arm.n)
        mujoco.mj_forward(model, data)
        mass = np.zeros((model.nv, model.nv))
        mujoco.mj_fullM(model, data, mass)
        assert far(dynamics.mass(q), mass[np.ix_(dofs, dofs)]) < SAME
        assert far(dynamics.inverse(q, qd, np.zeros(arm.n)), data.qfrc_bias[dofs]) < SAME
