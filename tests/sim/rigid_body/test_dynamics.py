"""The controller's model against the physics: built from the same file, they must agree on the nominal arm."""

import mujoco
import numpy as np
import pytest

from sim.arm.arm_file import Arm
from sim.arm.chain import Body, chain, load_body, plate_body, tool_body
from sim.arm.frames import inertia_matrix, joint_frames
from sim.arm.scenario import Load, Scenario
from sim.plant.true_arm import Plant
from sim.rigid_body.dynamics import Dynamics
from tests.sim.arms import PROBE, TWO_KG, UR5E, arms

MOUNTING = [0.4, -1.1, 2.0]


def both(arm: Arm, loaded: bool) -> tuple[Plant, Dynamics]:
    scenario = Scenario(mounting=MOUNTING, tool=PROBE if loaded else None, payload_true=TWO_KG if loaded else Load(mass=0.0))
    rigid = chain(arm)
    load = plate_body(arm) + tool_body(scenario.tool) + load_body(scenario.payload_true)
    return Plant(arm, scenario), Dynamics(rigid, rigid.links, load, mounting=scenario.mounting, elbow=arm.chain.elbow)


@pytest.mark.parametrize("loaded", [False, True], ids=["bare", "loaded"])
@pytest.mark.parametrize("arm", arms(), ids=lambda arm: arm.name)
def test_mass_matrix_and_bias_agree(arm: Arm, loaded: bool) -> None:
    plant, dynamics = both(arm, loaded)
    model, data = plant.model, plant.data
    dofs = np.array([model.joint(f"q/{name}").dofadr[0] for name in arm.chain.joints])
    at = np.array([model.joint(f"q/{name}").qposadr[0] for name in arm.chain.joints])
    rng = np.random.default_rng(5)
    for _ in range(10):
        data.qpos[:] = 0.0
        data.qvel[:] = 0.0
        data.qpos[at] = q = rng.uniform(-3.0, 3.0, arm.n)
        data.qvel[dofs] = qd = rng.uniform(-2.0, 2.0, arm.n)
        mujoco.mj_forward(model, data)
        mass = np.zeros((model.nv, model.nv))
        mujoco.mj_fullM(model, data, mass)
        assert np.abs(dynamics.mass(q) - mass[np.ix_(dofs, dofs)]).max() < 1e-9
        assert np.abs(dynamics.inverse(q, qd, np.zeros(arm.n)) - data.qfrc_bias[dofs]).max() < 1e-9
        data.qvel[:] = 0.0
        mujoco.mj_forward(model, data)
        assert np.abs(dynamics.gravity(q) - data.qfrc_bias[dofs]).max() < 1e-9


@pytest.mark.parametrize("arm", arms(), ids=lambda arm: arm.name)
def test_flange_pose_and_jacobian(arm: Arm) -> None:
    _, dynamics = both(arm, loaded=False)
    q = np.random.default_rng(2).uniform(-2.0, 2.0, arm.n)
    p, R, jacobian = (x.copy() for x in dynamics.update(q))
    frames = joint_frames(arm, q)
    assert np.allclose(p, frames[-1][:3, 3], atol=1e-12)
    assert np.allclose(R, frames[-1][:3, :3], atol=1e-12)
    for i in range(arm.n):
        step = np.zeros(arm.n)
        step[i] = 1e-6
        ahead, behind = (joint_frames(arm, q + sign * step)[-1] for sign in (1.0, -1.0))
        assert np.allclose(jacobian[:3, i], (ahead[:3, 3] - behind[:3, 3]) / 2e-6, atol=1e-8)
        spin = (ahead[:3, :3] - behind[:3, :3]) / 2e-6 @ R.T
        assert np.allclose(jacobian[3:, i], [spin[2, 1], spin[0, 2], spin[1, 0]], atol=1e-8)


def test_specific_force_at_rest_points_up_with_g() -> None:
    _, dynamics = both(UR5E, loaded=True)
    q = np.array([0.3, -1.0, 1.2, -0.5, 0.7, 0.1])
    force, turn = dynamics.specific_force(q, np.zeros(6), np.zeros(6))
    assert np.linalg.norm(force) == pytest.approx(9.81)
    assert np.allclose(turn, 0.0)


def test_two_bodies_make_one() -> None:
    """Two points on a rod of length 2 about their middle: m1 m2/(m1+m2) d² across, 0 along."""
    zero = np.zeros((3, 3))
    pair = Body(1.0, np.array([1.0, 0.0, 0.0]), zero) + Body(3.0, np.array([-1.0, 0.0, 0.0]), zero)
    assert pair.mass == 4.0
    assert np.allclose(pair.com, [-0.5, 0.0, 0.0])
    assert np.allclose(pair.inertia, np.diag([0.0, 3.0, 3.0]))
    nothing = Body(0.0, np.zeros(3), zero)
    assert (nothing + nothing).mass == 0.0


def test_a_load_without_inertia_is_a_sphere_of_water() -> None:
    body = load_body(Load(mass=4.0 / 3.0 * np.pi))  # litres of a 0.1 m sphere
    assert np.allclose(body.inertia, np.eye(3) * 0.4 * body.mass * 0.01)
    given = load_body(Load(mass=1.0, inertia=[1.0, 2.0, 3.0, 0.1, 0.2, 0.3]))
    assert np.allclose(given.inertia, inertia_matrix([1.0, 2.0, 3.0, 0.1, 0.2, 0.3]))
