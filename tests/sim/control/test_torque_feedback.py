"""Torque feedback: a share of the error, through a filter."""

import math

import numpy as np

from sim.control.feedback import MOTOR_SIDE_BANDWIDTH, SUPPORT, TorqueFeedback
from sim.control.feedback import TORQUE_BANDWIDTH as BANDWIDTH
from tests.sim.laws import N

MEASURED, DESIRED = np.linspace(-20.0, 30.0, N), np.linspace(5.0, -5.0, N)


def test_a_lasting_error_is_taken_over_by_its_share() -> None:
    module = TorqueFeedback(N)
    torque = np.zeros(N)
    for _ in range(50):
        torque[:] = 1.0
        module.add(MEASURED, DESIRED, torque)
    np.testing.assert_allclose(torque, 1.0 + SUPPORT * (MEASURED - DESIRED), rtol=1e-9)


def test_a_new_error_comes_in_over_its_time_constant() -> None:
    module = TorqueFeedback(N)
    torque = np.zeros(N)
    module.add(MEASURED, DESIRED, torque)
    first = 1.0 - math.exp(-2.0 * math.pi * BANDWIDTH * 0.002)
    np.testing.assert_allclose(torque, SUPPORT * first * (MEASURED - DESIRED))


def test_begun_with_an_error_it_knows_it_at_once() -> None:
    module = TorqueFeedback(N)
    module.start(MEASURED, DESIRED)
    torque = np.zeros(N)
    module.add(MEASURED, DESIRED, torque)
    np.testing.assert_allclose(torque, SUPPORT * (MEASURED - DESIRED))


def test_torque_known_from_the_motors_is_fed_back_as_fast_as_the_position_loop() -> None:
    module = TorqueFeedback(N)
    module.take_from_motors([1])
    torque = np.zeros(N)
    module.add(MEASURED, DESIRED, torque)
    rates = np.full(N, 1.0 - math.exp(-2.0 * math.pi * BANDWIDTH * 0.002))
    rates[1] = 1.0 - math.exp(-2.0 * math.pi * MOTOR_SIDE_BANDWIDTH * 0.002)
    np.testing.assert_allclose(torque, SUPPORT * rates * (MEASURED - DESIRED))
    module.take_from_motors([])
    assert rates[1] < rates[0]
    second = np.zeros(N)
    TorqueFeedback(N).add(MEASURED, DESIRED, second)
    assert second[1] != torque[1]
