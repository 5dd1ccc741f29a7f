"""The compiled recursion against Pinocchio, whose numbers it takes, and against differences of poses."""

import numpy as np
import pinocchio as pin
import pytest

from sim.arm.arm_file import Arm
from sim.arm.chain import Body, chain, load_body, plate_body
from sim.arm.frames import joint_frames
from sim.arm.scenario import Load
from sim.rigid_body.dynamics import Dynamics
from tests.sim.arms import TWO_KG, UR5E, arms

MOUNTING = [0.4, -1.1, 2.0]
TCP = np.array([0.02, -0.03, 0.12])


def rigid(arm: Arm, load: Load) -> Dynamics:
    links = chain(arm)
    return Dynamics(links, links.links, plate_body(arm) + load_body(load), mounting=MOUNTING, elbow=arm.chain.elbow)


def any_motion(arm: Arm, seed: int) -> tuple[np.ndarray, np.ndarray]:
    """Posture (n,) and motion (3, n), the first row of which must not count."""
    rng = np.random.default_rng(seed)
    motion = rng.uniform(-3.0, 3.0, (3, arm.n))
    motion[0] = np.nan
    return rng.uniform(-3.0, 3.0, arm.n), motion


@pytest.mark.parametrize("load", [Load(mass=0.0), TWO_KG], ids=["bare", "loaded"])
@pytest.mark.parametrize("arm", arms(), ids=lambda arm: arm.name)
def test_torque_pose_and_jacobian_are_pinocchios(arm: Arm, load: Load) -> None:
    dynamics = rigid(arm, load)
    recursion = dynamics.recursion
    for seed in range(5):
        q, motion = any_motion(arm, seed)
        recursion.run(q, motion, TCP)
        expected = pin.rnea(dynamics.model, dynamics.model.createData(), q, motion[1], motion[2])
        assert np.abs(recursion.torque - expected).max() < 1e-9
        assert np.abs(recursion.at_rest - dynamics.gravity(q)).max() < 1e-9
        p, R, jacobian = dynamics.update(q)
        assert np.abs(recursion.p - p).max() < 1e-12
        assert np.abs(recursion.R - R).max() < 1e-12
        assert np.abs(recursion.jacobian - jacobian).max() < 1e-12


@pytest.mark.parametrize("arm", arms(), ids=lambda arm: arm.name)
def test_the_kinetic_energy_is_pinocchios(arm: Arm) -> None:
    dynamics = rigid(arm, TWO_KG)
    for seed in range(5):
        q, motion = any_motion(arm, seed)
        dynamics.recursion.run(q, motion, TCP)
        expected = pin.computeKineticEnergy(dynamics.model, dynamics.model.createData(), q, motion[1])
        assert dynamics.recursion.energy[0] == pytest.approx(expected, rel=1e-9)


@pytest.mark.parametrize("arm", arms(), ids=lambda arm: arm.name)
def test_speeds_are_differences_of_places(arm: Arm) -> None:
    q, motion = any_motion(arm, 7)
    recursion = rigid(arm, TWO_KG).recursion
    v_tcp, v_elbow = recursion.run(q, motion, TCP)
    ahead, behind = (joint_frames(arm, q + sign * 1e-6 * motion[1]) for sign in (1.0, -1.0))
    tip = [frames[-1] @ [*TCP, 1.0] for frames in (ahead, behind)]
    elbow = [frames[arm.chain.elbow][:3, 3] for frames in (ahead, behind)]
    assert v_tcp == pytest.approx(np.linalg.norm(tip[0] - tip[1]) / 2e-6, rel=1e-6)
    assert v_elbow == pytest.approx(np.linalg.norm(elbow[0] - elbow[1]) / 2e-6, rel=1e-6)
    assert np.allclose(recursion.v_F[:3], (ahead[-1][:3, 3] - behind[-1][:3, 3]) / 2e-6, atol=1e-7)
    assert np.allclose(recursion.v_F[3:], recursion.jacobian[3:] @ motion[1], atol=1e-12)


def test_another_load_counts_at_once() -> None:
    dynamics = rigid(UR5E, TWO_KG)
    q, still = np.array([0.3, -1.0, 1.2, -0.5, 0.7, 0.1]), np.zeros((3, 6))
    dynamics.set_load(Body(3.0, np.array([0.0, 0.1, 0.2]), np.eye(3) * 0.01))
    dynamics.recursion.run(q, still, TCP)
    assert np.abs(dynamics.recursion.torque - dynamics.gravity(q)).max() < 1e-9
