"""The calibration error: within its bounds for every seed, and really there."""

import dataclasses

import msgspec
import numpy as np
import pytest

from pendant.all_settings import Settings
from sim.arm.arm_file import Arm
from sim.arm.chain import chain
from sim.arm.scenario import Scenario
from sim.sensing import calibration
from sim.sensing.calibration import Calibration
from sim.simulation import Simulation
from tests.sim.arms import UR5E, arms

SEEDS = range(300)


def draws(arm: Arm = UR5E) -> list[Calibration]:
    return [calibration.draw(arm, np.random.default_rng(seed)) for seed in SEEDS]


def spread(values: list[np.ndarray], bound: float, centre: float = 0.0) -> None:
    """Within `bound`, and over many seeds close to it on both sides, channel by channel."""
    error = np.array(values) - centre
    assert np.abs(error).max() <= bound
    assert (error.max(axis=0) > 0.9 * bound).all()
    assert (error.min(axis=0) < -0.9 * bound).all()


@pytest.mark.parametrize("arm", arms(), ids=lambda arm: arm.name)
def test_each_error_fills_its_bound(arm: Arm) -> None:
    """Bounds of the honest mismatch: motor constant 3 %, stiffness 20 %, rotor 10 %, mass 2 %, centres 3 mm, both zeros."""
    drawn = draws(arm)
    spread([d.motor_constant for d in drawn], 0.03, 1.0)
    spread([d.stiffness for d in drawn], 0.20, 1.0)
    spread([d.rotor_inertia for d in drawn], 0.10, 1.0)
    spread([d.link_mass for d in drawn], 0.02, 1.0)
    spread([d.link_centre for d in drawn], 0.003)
    spread([d.wrench_offset[:3] for d in drawn], 4.0)
    spread([d.wrench_offset[3:] for d in drawn], 0.3)
    assert arm.sensors.force_torque is not None
    drift = arm.sensors.force_torque.drift
    assert drift is not None
    spread([d.wrench_warm[:3] for d in drawn], drift.force)
    spread([d.wrench_warm[3:] for d in drawn], drift.torque)
    spread([np.diag(d.wrench_gain) for d in drawn], 0.01, 1.0)


def test_errors_are_so_many_times_as_large_as_stated() -> None:
    once, half_more = (calibration.draw(UR5E, np.random.default_rng(3), times) for times in (1.0, 1.5))
    for name in ("motor_constant", "stiffness", "rotor_inertia", "link_mass"):
        assert getattr(half_more, name) - 1.0 == pytest.approx(1.5 * (getattr(once, name) - 1.0))
    for name in ("link_centre", "ripple", "wrench_offset", "wrench_warm"):
        assert getattr(half_more, name) == pytest.approx(1.5 * getattr(once, name))
    assert half_more.wrench_gain - np.eye(6) == pytest.approx(1.5 * (once.wrench_gain - np.eye(6)))
    assert half_more.ripple_phase == pytest.approx(once.ripple_phase)


def test_an_arm_has_the_errors_that_its_file_states() -> None:
    """Each bound is moved by itself; what is not bounded by it stays as it was."""
    whole = msgspec.structs.replace(UR5E, accuracy=msgspec.structs.replace(UR5E.accuracy, stiffness=0.1))
    usual, stiffer = (calibration.draw(arm, np.random.default_rng(3)) for arm in (UR5E, whole))
    assert stiffer.stiffness - 1.0 == pytest.approx(0.5 * (usual.stiffness - 1.0))
    assert stiffer.motor_constant == pytest.approx(usual.motor_constant)


@pytest.mark.parametrize("arm", arms(), ids=lambda arm: arm.name)
def test_cross_talk_is_one_percent_of_the_ranges_at_most(arm: Arm) -> None:
    sensor = arm.sensors.force_torque
    assert sensor is not None
    full = np.array([sensor.force.range] * 3 + [sensor.torque.range] * 3)
    worst = 0.0
    for drawn in draws(arm):
        cross = drawn.wrench_gain - np.diag(np.diag(drawn.wrench_gain))
        assert np.diag(cross).tolist() == [0.0] * 6
        # All other channels at full range at once.
        leak = (np.abs(cross) @ full) / full
        worst = max(worst, float(leak.max()))
    assert 0.005 < worst <= 0.01


def test_ripple_stays_within_a_tenth_of_a_milliradian_over_the_turn() -> None:
    turn = np.linspace(0.0, 2.0 * np.pi, 720)
    worst = []
    for drawn in draws():
        first = drawn.ripple[:, :1] * np.sin(turn + drawn.ripple_phase[:, :1])
        second = drawn.ripple[:, 1:] * np.sin(2.0 * turn + drawn.ripple_phase[:, 1:])
        worst.append(np.abs(first + second).max(axis=1))
    assert np.max(worst) <= 1e-4
    assert np.max(worst) > 0.95e-4
    assert np.min(worst) > 0.5e-4


def test_nominal_is_no_error_at_all() -> None:
    errors = calibration.nominal(UR5E)
    for name in ("motor_constant", "stiffness", "rotor_inertia", "link_mass"):
        assert (getattr(errors, name) == 1.0).all()
    for name in ("link_centre", "ripple", "wrench_offset", "wrench_warm"):
        assert not getattr(errors, name).any()
    assert (errors.wrench_gain == np.eye(6)).all()
    for believed, true in zip(calibration.believed(chain(UR5E), errors), chain(UR5E).links, strict=True):
        assert believed.mass == true.mass
        assert (believed.com == true.com).all()


def test_believed_links_differ_by_the_drawn_errors() -> None:
    rigid, errors = chain(UR5E), calibration.draw(UR5E, np.random.default_rng(1))
    for i, (believed, true) in enumerate(zip(calibration.believed(rigid, errors), rigid.links, strict=True)):
        assert believed.mass / true.mass == pytest.approx(errors.link_mass[i])
        assert np.allclose(believed.com - true.com, errors.link_centre[i])
        assert np.allclose(believed.inertia, true.inertia * errors.link_mass[i])


def test_a_seed_always_draws_the_same_and_another_seed_another() -> None:
    first, again, other = (dataclasses.astuple(calibration.draw(UR5E, np.random.default_rng(seed))) for seed in (7, 7, 8))
    assert all(np.array_equal(a, b) for a, b in zip(first, again, strict=True))
    assert all((a != b).any() for a, b in zip(first, other, strict=True))


def test_an_arm_file_without_drift_draws_the_same_of_all_else() -> None:
    assert UR5E.sensors.force_torque is not None
    stays = msgspec.structs.replace(UR5E.sensors.force_torque, drift=None)
    arm = msgspec.structs.replace(UR5E, sensors=msgspec.structs.replace(UR5E.sensors, force_torque=stays))
    errors, same = (calibration.draw(each, np.random.default_rng(5)) for each in (UR5E, arm))
    assert not same.wrench_warm.any()
    for field in dataclasses.fields(errors):
        if field.name != "wrench_warm":
            assert np.array_equal(getattr(errors, field.name), getattr(same, field.name)), field.name


def test_the_mismatch_is_on_by_default_and_can_be_switched_off() -> None:
    """The controller's gravity model against the true arm's gravity torque."""
    for scenario, same in ((Scenario(), False), (Scenario(mismatch="nominal"), True)):
        simulation = Simulation(UR5E, scenario, Settings())
        plant = simulation.plant
        dofs = [plant.model.joint(f"q/{name}").dofadr[0] for name in UR5E.chain.joints]
        error = float(np.abs(simulation.dynamics.gravity(plant.q) - plant.data.qfrc_bias[dofs]).max())
        assert (error < 1e-3) is same
        if not same:
            assert error < 3.0, "N·m; 2 % of mass and 3 mm of centre are no more"
