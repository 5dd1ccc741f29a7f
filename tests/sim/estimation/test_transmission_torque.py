"""Transmission torque: the fusion by uncertainties, what is learned of the deflection, what counts as a contact."""

import numpy as np
import pytest

from pendant.tick.modes import TICK
from sim.estimation.transmission_torque import DEFLECTION, SETTLE_TICKS, Rubbing, TransmissionTorque, fuse
from tests.sim.arms import UR5E

N = UR5E.n
CALM = np.zeros(N)
ALL = np.ones((3, N), dtype=bool)
INERTIA = np.array([2.0, 2.0, 1.0, 0.1, 0.1, 0.02])


def only(*ways: int) -> np.ndarray:
    """These ways, of every joint."""
    use = np.zeros((3, N), dtype=bool)
    use[list(ways)] = True
    return use


class Gears:
    """The module, fed with the three raw torques."""

    def __init__(self) -> None:
        self.module = TransmissionTorque(UR5E, INERTIA)

    def tick(
        self,
        dynamics: np.ndarray | float,
        deflection: np.ndarray | float,
        motor: np.ndarray | float,
        friction_deviation: float = 0.0,
        acceleration: float = 0.0,
        moving: bool = False,
        use: np.ndarray = ALL,
        friction: float = 0.0,
    ) -> TransmissionTorque:
        for row, value in zip(self.module.ways, (dynamics, deflection, motor), strict=True):
            row[:] = value
        rubbing = Rubbing(np.full(N, friction_deviation), CALM, np.full(N, friction), np.full(N, acceleration))
        fuse(self.module.record, rubbing, use, moving)
        return self.module


def test_fused_torque_leans_on_what_is_certain() -> None:
    gears = Gears()
    module = gears.tick(1.0, 1.1, 9.0, friction_deviation=50.0)
    assert (module.fused < 1.2).all(), "a motor side of which nothing is known does not count"
    assert (module.deviation <= module.deviations.min(axis=0)).all()


def test_the_fusion_weighs_by_inverse_variances() -> None:
    module = Gears().tick(10.0, 11.0, 12.0, friction_deviation=0.5)
    weights = module.deviations**-2.0
    np.testing.assert_allclose(module.fused, (weights * module.ways).sum(axis=0) / weights.sum(axis=0))
    np.testing.assert_allclose(module.deviation, weights.sum(axis=0) ** -0.5)


def test_each_way_alone_is_all_there_is() -> None:
    for way, value in enumerate((1.0, 2.0, 3.0)):
        np.testing.assert_allclose(Gears().tick(1.0, 2.0, 3.0, use=only(way)).fused, value)


def test_the_joints_whose_motor_tells_the_external_torque_have_its_deviation() -> None:
    use = ALL.copy()
    use[1, 2] = False
    module = Gears().tick(5.0, 3.0, 4.0, friction_deviation=0.5, use=use)
    assert module.by_motor[2] == module.deviations[2, 2] > 0.5
    assert (np.delete(module.by_motor, 2) == 0.0).all()


def test_without_any_way_the_last_torque_stands() -> None:
    gears = Gears()
    last = gears.tick(4.0, 4.0, 4.0).fused.copy()
    np.testing.assert_array_equal(gears.tick(9.0, 9.0, 9.0, use=only()).fused, last)


def test_ways_may_differ_from_joint_to_joint() -> None:
    use = ALL.copy()
    use[1, 2] = False
    use[0, 4] = use[2, 4] = False
    module = Gears().tick(1.0, 2.0, 3.0, use=use)
    assert module.fused[4] == 2.0
    assert module.fused[2] == np.average([1.0, 3.0], weights=module.deviations[[0, 2], 2] ** -2.0)


def test_the_rigid_model_counts_less_while_the_arm_shakes() -> None:
    gears = Gears()
    still = gears.tick(1.0, 2.0, 2.0).deviations[0].copy()
    shaken = gears.tick(1.0, 2.0, 2.0, acceleration=10.0).deviations[0].copy()
    assert (shaken > 1.2 * still)[:4].all()
    for _ in range(1500):
        gears.tick(1.0, 2.0, 2.0)
    np.testing.assert_allclose(gears.module.deviations[0], still, rtol=0.02)


def test_the_external_torque_is_what_the_model_does_not_explain() -> None:
    np.testing.assert_allclose(Gears().tick(5.0, 3.0, 4.0).external, 2.0)
    np.testing.assert_allclose(Gears().tick(5.0, 3.0, 4.0, use=only(0, 2)).external, 1.0)
    for use in (only(0), only(1, 2)):
        assert (Gears().tick(5.0, 3.0, 4.0, use=use).external == 0.0).all()


def gear(module: TransmissionTorque, load: float = 0.0) -> np.ndarray:
    """Standard deviation of what the deflection is believed to bear under this load, as was learned of it (n,) [N·m]."""
    P, ripple, floor = (module.record[0][name] for name in ("covariance", "ripple", "floor"))
    known = load * load * P[:, 0, 0] + 2.0 * load * P[:, 0, 1] + P[:, 1, 1]
    return np.sqrt(known + (0.25 * ripple) ** 2 + (0.3 * floor) ** 2)


def test_a_wrong_stiffness_is_learned_while_moving_and_not_at_rest() -> None:
    """15 % too soft a spring, under loads to and fro."""
    errors = []
    for moving in (True, False):
        gears = Gears()
        for k in range(10000):
            load = 0.3 * np.array(UR5E.limits.torque) * np.sin(0.004 * k)
            gears.tick(load, load / 1.15, load, moving=moving)
        module = gears.tick(10.0, 10.0 / 1.15, 10.0, moving=moving)
        errors.append(np.abs(module.ways[1] - 10.0).max())
    assert errors[0] < 0.3
    assert errors[1] > 1.0


def test_the_deflection_is_trusted_as_far_as_it_has_slowly_agreed_with_the_model() -> None:
    """The model's errors are fast, 0.8 % of the rated torque at 10 Hz; a slow one in the deflection counts against that."""
    rated = np.array(UR5E.limits.torque)
    deviations = {}
    for slow in (0.0, 0.003):
        gears = Gears()
        for k in range(10000):
            fast = 0.008 * rated * np.sin(2.0 * np.pi * 10.0 * TICK * k)
            wrong = slow * rated * np.sin(2.0 * np.pi * 0.3 * TICK * k)
            gears.tick(fast, wrong, 0.0, friction_deviation=9.0, acceleration=20.0, moving=True)
        deviations[slow] = gears.module.deviations[1] / rated
    first = Gears().tick(0.0, 0.0, 0.0).deviations[1] / rated
    assert (deviations[0.0] < 0.5 * first).all()
    assert (deviations[0.0] > 0.001).all(), "its noise stays"
    assert (deviations[0.003] > 1.5 * deviations[0.0]).all()
    assert (deviations[0.003] <= first * 1.01).all(), "a small one is no reason to believe less than at first"


def test_a_deflection_that_slowly_differs_by_more_than_was_believed_counts_less_and_for_the_fusion_alone() -> None:
    """1.5 % of the rated torque at 0.3 Hz, as the output encoder's ripple behind a stiff spring makes it: no contact."""
    rated = np.array(UR5E.limits.torque)
    gears, calm = Gears(), Gears()
    module, errors = gears.module, np.zeros((4, N))
    for k in range(10000):
        wrong = 0.015 * rated * np.sin(2.0 * np.pi * 0.3 * TICK * k)
        calm.tick(0.0, 0.0, 0.0, friction_deviation=9.0, moving=True)
        gears.tick(0.0, wrong, 0.0, friction_deviation=9.0, moving=True)
        assert not module.contact
        if k >= 5000:
            errors += np.stack([*module.ways, module.fused]) ** 2 / rated**2
    assert (module.deviations[1] > 1.3 * gear(module)).all()
    assert (errors[3] < 0.15 * errors[1]).all(), "the model is right, and the fusion next to it"
    np.testing.assert_allclose(gear(module), gear(calm.module), rtol=0.01)


def test_what_they_differ_by_now_counts_at_once_as_far_as_the_model_does_not_explain_it() -> None:
    """The slow mean takes a third of a second, what is remembered of it 3 s."""
    rated = np.array(UR5E.limits.torque)
    gears = Gears()
    for _ in range(2000):
        gears.tick(0.0, 0.0, 0.0, friction_deviation=9.0, moving=True)
    agreed = gears.module.deviations[1] / rated
    for _ in range(200):
        gears.tick(0.0, 0.015 * rated, 0.0, friction_deviation=9.0, moving=True)
    assert not gears.module.contact
    slow = 0.015 * (1.0 - np.exp(-200 * TICK / 0.3))
    assert (agreed < 0.3 * slow).all()
    assert (gears.module.deviations[1] / rated > 0.65 * slow).all(), "of which the model's own 0.4 % explain some"


def test_springs_as_stiff_as_they_may_be_are_learned_as_such_and_not_as_an_offset() -> None:
    """Springs believed at 0.8 of what they are, under a load to one side that swings: 25 % are to be learned, not 20 %."""
    gears, rated = Gears(), np.array(UR5E.limits.torque)
    module = gears.module
    for k in range(10000):
        load = rated * (-0.3 + 0.1 * np.sin(0.004 * k))
        gears.tick(load, 0.8 * load, load, moving=True)
    assert not module.contact
    np.testing.assert_allclose(module.stiffer, 0.25, atol=0.01)
    assert (np.abs(module.offset) < 0.002 * rated).all()
    assert (np.abs(module.external) < 0.002 * rated).all()


def test_a_day_of_motion_without_load_does_not_make_a_joint_deaf_to_contact() -> None:
    """A spring that nothing bends says nothing of its stiffness: when it is bent at last, it is known as well as at first."""
    gears, load = Gears(), 20.0
    fresh = gear(gears.tick(load, load, load), load)
    gears.module.forget()
    gears.module.record["walk"] *= 86400.0 / (2000 * TICK)  # 2,000 ticks wander as far as a day does
    for _ in range(2000):
        gears.tick(0.0, 0.0, 0.0, moving=True)
    assert (np.linalg.eigvalsh(gears.module.record["covariance"][0]) > 0.0).all()
    late = gears.tick(load, load, load)
    assert (gear(late, load) < 1.1 * fresh).all()
    assert gears.tick(load, 2.0 * load, load).contact, "it had been believed to be 0.6 ± 0.6 as stiff"


def test_a_bound_that_the_stiffness_meets_does_not_turn_the_offset_the_wrong_way() -> None:
    """Springs believed at 0.7 of what they are, which none should be: what the bound leaves is to the offset as it stands."""
    gears, rated = Gears(), np.array(UR5E.limits.torque)
    module = gears.module
    for k in range(10000):
        load = rated * (-0.1 + 0.02 * np.sin(0.004 * k))
        gears.tick(load, 0.7 * load, load, moving=True)
        assert (module.offset <= 0.001 * rated).all()
    np.testing.assert_allclose(module.stiffer, 0.25)
    assert (np.abs(module.external) < 0.006 * rated).all(), "of 1.25 % that the bound leaves"


def test_a_heavy_load_may_hide_a_small_external_torque() -> None:
    """Masses are known to 2 %: of 100 N·m that the links weigh, 2 N·m may be nobody's, however well the gear is known."""
    light, heavy = (Gears().tick(load, load, load) for load in (0.0, 100.0))
    more = np.sqrt(heavy.deviations[0] ** 2 - light.deviations[0] ** 2)
    np.testing.assert_allclose(more, 0.02 * 100.0)


def test_the_model_is_trusted_as_far_as_it_has_quickly_agreed_with_the_deflection() -> None:
    """Accelerations that shake the arm count against it only as far as they were seen to make it wrong."""
    deviations = {}
    for wrong in (0.0, 0.01):
        gears = Gears()
        for k in range(5000):
            fast = wrong * np.array(UR5E.limits.torque) * np.sin(2.0 * np.pi * 10.0 * TICK * k)
            gears.tick(fast, 0.0, 0.0, friction_deviation=9.0, acceleration=20.0, moving=True)
        deviations[wrong] = gears.module.deviations[0].copy()
    assert (deviations[0.0] < 0.8 * deviations[0.01])[:5].all(), "a bare wrist has nothing to accelerate"
    alone = gears.tick(0.0, 0.0, 0.0, friction_deviation=9.0, acceleration=20.0, use=only(0, 2)).deviations[0]
    assert (alone[:3] > 1.5 * deviations[0.0][:3]).all(), "without an output angle it is made of this torque itself"


def test_a_sudden_external_torque_is_a_contact_until_it_has_been_gone_for_a_while() -> None:
    gears, load = Gears(), np.full(N, 5.0)
    for _ in range(200):
        gears.tick(load, load, load, moving=True)
    assert not gears.module.contact
    pushed = load + np.array([0.0, 0.0, 15.0, 0.0, 0.0, 0.0])
    gears.tick(load, pushed, load, moving=True)
    assert gears.module.contact
    corrected = gears.module.stiffer.copy(), gears.module.offset.copy()
    for tick in range(120):
        gears.tick(load, load, load, moving=True)
        assert gears.module.contact == (tick < SETTLE_TICKS - 1)
    assert np.abs(np.subtract((gears.module.stiffer, gears.module.offset), corrected)).max() < 0.05


def test_in_contact_the_rigid_model_is_trusted_less() -> None:
    gears = Gears()
    pushed = gears.tick(5.0, 25.0, 25.0)
    assert pushed.contact
    assert np.abs(pushed.fused - 25.0).max() < 0.5


def test_without_the_deflection_a_contact_shows_on_the_motor_side() -> None:
    gears = Gears()
    assert not gears.tick(5.0, 0.0, 6.0, friction_deviation=1.0, use=only(0, 2)).contact
    assert gears.tick(5.0, 0.0, 25.0, friction_deviation=1.0, use=only(0, 2)).contact


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize(("size", "friction", "learned"), [(10.0, 10.0, True), (10.0, 0.0, False), (40.0, 10.0, False)])
def test_what_friction_may_be_wrong_by_keeps_nobody_from_learning_it(
    size: float, friction: float, learned: bool, sign: float
) -> None:
    """By the motor alone friction that is missing looks like a touch: up to all that is believed of it, it is learned from."""
    gears, use = Gears(), ALL.copy()
    use[DEFLECTION] = False
    module = gears.tick(sign * size, 0.0, 0.0, use=use, friction=-sign * friction)
    assert module.contact
    assert (module.record["free"].item() == SETTLE_TICKS) is learned


def test_what_the_deflection_feels_is_no_friction() -> None:
    module = Gears().tick(20.0, 0.0, 0.0, friction=20.0)
    assert module.contact
    assert module.record["free"].item() == 0
