"""Validity, standing still, and the mean wrench."""

import math

import numpy as np
import pytest

from pendant.limits.validity import WINDOW, Stillness, WrenchMean, in_flange, joints_ok, wrench_ok
from tests.pendant.estimates import estimate

USED = ["q", "qd", "theta", "theta_d", "tau_J", "tau_ext", "v_F"]


@pytest.mark.parametrize("bad", [math.nan, math.inf, -math.inf])
@pytest.mark.parametrize("name", USED)
def test_joint_values_must_be_valid_and_finite(name: str, bad: float) -> None:
    """FD-12."""
    value = estimate().copy()
    assert joints_ok(value)
    array = getattr(value, name)
    for index in range(len(array)):
        array[:] = 0.0
        array[index] = bad
        assert not joints_ok(value)
    array[:] = -3.0
    assert joints_ok(value)
    value.joints_valid = False
    assert not joints_ok(value)


def test_infinities_do_not_cancel() -> None:
    value = estimate().copy()
    value.q[0], value.q[1] = math.inf, -math.inf
    assert not joints_ok(value)


@pytest.mark.parametrize("bad", [math.nan, math.inf, -math.inf])
def test_the_wrench_must_be_valid_and_finite(bad: float) -> None:
    value = estimate(force=[1.0, -2.0, 3.0])
    assert wrench_ok(value)
    assert not wrench_ok(estimate(wrench_valid=False))
    for index in range(6):
        value.F_user[:] = 0.0
        value.F_user[index] = bad
        assert not wrench_ok(value)


@pytest.mark.parametrize("speed", [0.0, 0.0099, math.nextafter(0.01, 0.0), -math.nextafter(0.01, 0.0)])
def test_slower_than_the_limit_counts_as_still(speed: float) -> None:
    still = Stillness()
    for count in range(1, 200):
        still.step(estimate(qd=speed), 0.01)
        assert still.count == count


@pytest.mark.parametrize("speed", [0.01, -0.01, 0.0101, 3.0, math.nan, math.inf, -math.inf])
@pytest.mark.parametrize("joint", [0, 3, 5])
def test_one_joint_at_the_limit_or_unknown_begins_the_count_again(joint: int, speed: float) -> None:
    still = Stillness()
    for _ in range(70):
        still.step(estimate(), 0.01)
    moving = estimate().copy()
    moving.qd[joint] = speed
    still.step(moving, 0.01)
    assert still.count == 0
    expected = (joint, abs(speed)) if math.isfinite(speed) else (0, 0.0)
    assert (still.joint, still.speed) == expected
    still.step(estimate(), 0.01)
    assert still.count == 1
    assert (still.joint, still.speed) == expected


def test_the_limit_is_each_joints_own() -> None:
    """Together they may be as fast as they like."""
    still, creeping = Stillness(), estimate().copy()
    creeping.qd[:] = 0.009
    for count in range(1, 5):
        still.step(creeping, 0.01)
        assert still.count == count


def test_what_is_not_valid_is_not_still() -> None:
    still = Stillness()
    still.step(estimate(), 0.01)
    still.step(estimate(joints_valid=False), 0.01)
    assert still.count == 0


@pytest.mark.parametrize("count", [1, 2, WINDOW - 1, WINDOW, WINDOW + 1, 2 * WINDOW, 2 * WINDOW + 7])
def test_the_mean_is_over_the_last_window(count: int) -> None:
    assert WINDOW == 50
    rng = np.random.default_rng(count)
    wrenches = rng.normal(0.0, 5.0, (count, 6))
    mean = WrenchMean()
    for wrench in wrenches:
        value = estimate().copy()
        value.F_user[:] = wrench
        assert mean.step(value)
    np.testing.assert_allclose(mean.mean(), wrenches[-50:].mean(axis=0), rtol=1e-12, atol=1e-12)


def test_the_mean_begins_afresh_after_an_outage() -> None:
    mean = WrenchMean()
    assert mean.mean() == (0.0,) * 6
    for _ in range(20):
        mean.step(estimate(force=100.0))
    assert not mean.step(estimate(wrench_valid=False))
    assert mean.mean() == (0.0,) * 6
    mean.step(estimate(force=2.0))
    mean.step(estimate(force=4.0))
    assert mean.mean() == (3.0, 0.0, 0.0, 0.0, 0.0, 0.0)


@pytest.mark.parametrize("ticks", [1, WINDOW - 1, WINDOW, WINDOW + 7])
def test_a_mean_is_shifted_with_all_that_is_in_it(ticks: int) -> None:
    """As if the sensor had been zeroed before."""
    gone, before, after = (1.0, -2.0, 3.0, 0.1, -0.2, 0.3), WrenchMean(), WrenchMean()
    for tick in range(ticks):
        value = estimate(force=[0.1 * tick, 2.0, 3.0], torque=[0.4, 0.0, -0.01 * tick])
        before.step(value)
        value.F_user = value.F_user - gone
        after.step(value)
    before.shift(gone)
    assert before.count == after.count
    assert before.mean() == pytest.approx(after.mean(), abs=1e-12)
    for mean in (before, after):
        mean.step(estimate(force=[5.0, 0.0, 0.0]))
    assert before.mean() == pytest.approx(after.mean(), abs=1e-12)


def test_a_wrench_in_axes_of_the_flange() -> None:
    value = estimate()
    value.R_BF = np.array([[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])  # its z axis is x of B
    assert in_flange(value, (1.0, 2.0, 3.0, 0.1, 0.2, 0.3)) == pytest.approx((2.0, 3.0, 1.0, 0.2, 0.3, 0.1))
