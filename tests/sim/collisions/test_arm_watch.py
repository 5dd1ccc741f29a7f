"""How far the arm is from its reference: by joint and at the tool (RL-1)."""

import math

import numpy as np
import pytest

from app.files.library import load_arm
from pendant.all_settings import Settings
from pendant.inputs import NOTHING
from pendant.tick.estimate import ON_PATH
from sim.arm.scenario import Scenario
from sim.collisions.arm_watch import ArmSeen, ArmWatch
from sim.exchange.desk import Wishes
from sim.paths.tool_point import ToolPoint
from sim.simulation import Simulation

UR5E = load_arm("ur5e")
LIMIT = np.array([0.020, 0.021, 0.022, 0.023, 0.024, 0.025])  # [rad]


def found(wanted: np.ndarray | None, device: Simulation) -> ArmSeen:
    """What is watched of a standing arm whose reference is at these angles (n,), or that has none."""
    estimator, meter = device.estimator, device.controller.references.meter
    watch = ArmWatch(device.dynamics, estimator.momentum, UR5E, meter=meter, following=LIMIT)
    return watch.read(device.sensors.read(device.plant, device.current), device.estimate, wanted, free=False)


@pytest.fixture
def device() -> Simulation:
    """An arm that has held its posture for a tick."""
    arm = Simulation(UR5E, Scenario(seed=5, world=()), Settings())
    arm.tick(Wishes(NOTHING, (), ()))
    return arm


@pytest.mark.parametrize(("joint", "error"), [(0, 0.005), (2, -0.02), (5, 0.03)])
def test_the_following_error_is_that_of_the_joint_with_the_largest_share_and_of_the_tool(
    device: Simulation, joint: int, error: float
) -> None:
    q = device.estimate.q
    wanted = q.copy()
    wanted[joint] += error
    wanted[1] += 1e-4
    following = found(wanted, device).following
    assert following.joint == joint
    assert following.angle == pytest.approx(abs(error))
    assert following.limit == LIMIT[joint]
    assert following.share == pytest.approx(abs(error) / LIMIT[joint])
    tool = ToolPoint(device.dynamics, device.tcp)
    apart = tool.pose(wanted)[0] - tool.pose(q)[0]
    assert following.tool == pytest.approx(float(np.linalg.norm(apart)), rel=0.02)


def test_without_a_reference_there_is_no_error(device: Simulation) -> None:
    assert found(None, device).following is ON_PATH


def test_an_angle_that_is_no_number_is_too_far_from_the_reference(device: Simulation) -> None:
    wanted = device.estimate.q.copy()
    wanted[3] = math.nan
    assert not found(wanted, device).following.share <= 1.0
