"""Output encoders that are too coarse to tell a speed: the motor's tells it, and a joint that stands is seen to stand."""

import math

import numpy as np
import pytest
from msgspec.structs import replace

from app.files.library import load_arm, robots
from pendant.all_settings import Settings
from pendant.inputs import NOTHING
from pendant.tick.modes import TICK
from sim.arm.arm_file import Arm
from sim.arm.scenario import Scenario
from sim.estimation.joint_tracking import SPEED_NOISE, TORQUE_BANDWIDTH, angle_noise, deflection_rate, noise_gains, tracking_gains
from sim.exchange.desk import Wishes
from sim.simulation import Simulation

COARSE = 4096  # counts a turn
IDLE = Wishes(NOTHING, (), ())


def coarse(counts: int = COARSE) -> Arm:
    """A UR5e whose output encoders have so many counts."""
    arm = load_arm("ur5e")
    return replace(arm, sensors=replace(arm.sensors, encoders=replace(arm.sensors.encoders, output_counts=counts)))


@pytest.mark.parametrize("bandwidth", [20.0, 100.0])
def test_the_gains_of_noise_are_those_of_the_filter(bandwidth: float) -> None:
    alpha, beta, gamma = tracking_gains(bandwidth)
    x = v = a = 0.0
    angles, speeds = [], []
    for measured in [1.0, *[0.0] * 1000]:  # squares of the answer to one tick add up to the variance for white noise
        x, v = x + TICK * v + 0.5 * TICK * TICK * a, v + TICK * a
        error = measured - x
        x, v, a = x + alpha * error, v + beta * error, a + gamma * error
        angles.append(x)
        speeds.append(v)
    assert noise_gains(bandwidth) == pytest.approx((np.linalg.norm(angles), np.linalg.norm(speeds)), rel=1e-9)


def test_shipped_arms_tell_speeds_by_their_output_encoders() -> None:
    assert [deflection_rate(load_arm(name).sensors.encoders) for name in robots()] == [0.0] * len(robots())
    assert 0.2 < deflection_rate(coarse().sensors.encoders) < 20.0


def test_a_joint_that_stands_is_as_slow_as_was_meant() -> None:
    arm = coarse()
    device, speeds, apart = Simulation(arm, Scenario(seed=3), Settings()), [], []
    for tick in range(3000):
        device.tick(IDLE)
        if tick >= 1000:
            speeds.append(device.estimate.qd.copy())
            apart.append(device.estimate.q - device.plant.q)
    assert np.std(speeds, axis=0).max() < 1.3 * SPEED_NOISE
    by_itself = angle_noise(arm.sensors.encoders) * noise_gains(TORQUE_BANDWIDTH)[1]
    assert by_itself > 10.0 * SPEED_NOISE, "the encoder alone would tell such speeds of a joint that stands"
    ripple = arm.sensors.encoders.ripple
    assert np.abs(apart).max() < ripple + math.tau / COARSE, "and the angle is still that of the output"
