"""Motor controller: currents against the data file, limits of current, torque and speed."""

import msgspec
import numpy as np

from sim.control.motor_controller import OVERSPEED, MotorController
from tests.sim.arms import UR5E
from tests.sim.laws import EXACT, N

PER_AMPERE = np.array(UR5E.motors.torque_constant) * np.array(UR5E.motors.gear)
SPEED = np.array(UR5E.limits.speed)
REST = np.zeros(N)
USEFUL = np.array(UR5E.limits.torque) + np.array([row[-1] for row in UR5E.frictions.torque])


def test_small_torques_pass_as_they_are() -> None:
    module = MotorController(UR5E, EXACT)
    wanted = np.array([10.0, -20.0, 5.0, -3.0, 2.0, 1.0])
    np.testing.assert_allclose(module.current(wanted, REST) * PER_AMPERE, wanted)
    np.testing.assert_allclose(module.command, wanted)
    assert (module.excess == 0.0).all()


def test_the_torque_limit_leaves_room_for_friction() -> None:
    module = MotorController(UR5E, EXACT)
    sign = np.array([1.0, -1.0, 1.0, -1.0, 1.0, -1.0])
    np.testing.assert_allclose(module.current(1000.0 * sign, REST) * PER_AMPERE, USEFUL * sign)
    np.testing.assert_allclose(module.excess, (1000.0 - USEFUL) * sign)


def test_a_smaller_current_limit_comes_first() -> None:
    small = [1.0, 1.5, 2.0, 0.5, 0.5, 0.5]
    module = MotorController(msgspec.structs.replace(UR5E, motors=msgspec.structs.replace(UR5E.motors, current=small)), EXACT)
    np.testing.assert_allclose(module.current(np.full(N, 1000.0), REST), small)
    np.testing.assert_allclose(module.command, PER_AMPERE * small)


def test_a_motor_that_is_too_fast_is_driven_no_further_but_braked() -> None:
    module = MotorController(UR5E, EXACT)
    full = np.full(N, 1000.0)
    np.testing.assert_allclose(module.current(full, SPEED) * PER_AMPERE, USEFUL)
    half = module.current(full, SPEED * (1.0 + 0.5 * OVERSPEED)) * PER_AMPERE
    np.testing.assert_allclose(half, 0.5 * USEFUL)
    beyond = SPEED * (1.0 + 2.0 * OVERSPEED)
    assert (module.current(full, beyond) == 0.0).all()
    np.testing.assert_allclose(module.current(-full, beyond) * PER_AMPERE, -USEFUL)
    assert (module.current(-full, -beyond) == 0.0).all()
    np.testing.assert_allclose(module.current(full, -beyond) * PER_AMPERE, USEFUL)
