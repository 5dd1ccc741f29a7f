"""What the thresholds of contact detection follow (CD-5, CD-11, CD-12)."""

import msgspec
import pytest

from pendant.contact.contact_limits import limits
from pendant.sensor.sensor_spec import SensorSpec
from pendant.tick.modes import Mode
from tests.pendant.contacts import USE

PAIR = 2.0**0.5


def test_the_ratio_follows_payload_and_posture() -> None:
    assert limits(USE, Mode.RUN, mass=2.0, effective_mass=10.0, speed=0.0).ratio == pytest.approx(1.0)  # half of the payload
    assert limits(USE, Mode.RUN, mass=0.0, effective_mass=10.0, speed=0.0).ratio == pytest.approx(0.15)  # half of the least one
    assert limits(USE, Mode.RUN, mass=5.0, effective_mass=1.0, speed=0.0).ratio == pytest.approx(
        0.3
    )  # 0.3 of the arm's effective mass


def test_thresholds_follow_sensitivity_speed_and_mode() -> None:
    base = limits(USE, Mode.RUN, mass=1.0, effective_mass=2.0, speed=0.5)
    sensitive = msgspec.structs.replace(USE, sensitivity=2.0)
    gentle = limits(sensitive, Mode.RUN, mass=1.0, effective_mass=2.0, speed=0.5)
    fast = limits(msgspec.structs.replace(USE, speed_share=1.0), Mode.RUN, mass=1.0, effective_mass=2.0, speed=0.5)
    guided, both = (limits(each, Mode.FREE_DRIVE, mass=1.0, effective_mass=2.0, speed=0.5) for each in (USE, sensitive))
    for other, factor in ((gentle, 0.5), (fast, 1.5), (guided, 3.0), (both, 1.5)):
        assert other.slow_force == pytest.approx(factor * base.slow_force)
        assert other.ratio == pytest.approx(factor * base.ratio)
        assert other.force_sq == pytest.approx(factor**2 * base.force_sq)
        assert other.confidence_sq == pytest.approx(factor**2 * base.confidence_sq)
        assert other.value_force == pytest.approx(factor * base.value_force)
        for name in ("acceleration_sq", "clear_sq", "clear_acceleration_sq", "ratio_acceleration_sq"):
            assert getattr(other, name) == pytest.approx(factor**2 * getattr(base, name)), name
    assert base.noise_force_sq == pytest.approx((3.0 * PAIR * 0.15) ** 2)


def test_noise_is_that_of_the_arms_file_unless_a_setting_says_another() -> None:
    sensor = SensorSpec(noise_force=0.45, noise_acceleration=0.2)
    file, both = (
        limits(use, Mode.RUN, mass=2.0, effective_mass=2.0, speed=0.0, sensor=sensor)
        for use in (USE, msgspec.structs.replace(USE, force_noise=0.3, acceleration_noise=0.05))
    )
    assert (file.force_variance, file.acceleration_variance) == (pytest.approx(0.45**2), pytest.approx(0.2**2))
    assert (both.force_variance, both.acceleration_variance) == (pytest.approx(0.3**2), pytest.approx(0.05**2))
    assert file.noise_force_sq == pytest.approx((3.0 * PAIR * 0.45) ** 2)


def test_a_load_off_the_sensor_makes_its_acceleration_noisy() -> None:
    """The mean of two gyros of 0.003 rad/s, its difference smoothed at 150 Hz: 1.2 rad/s²; a point feels two axes (CD-0)."""
    near, far = (
        limits(USE, Mode.RUN, mass=2.0, effective_mass=2.0, speed=0.0),
        limits(USE, Mode.RUN, mass=2.0, effective_mass=2.0, speed=0.0, lever=0.1),
    )
    assert near.acceleration_variance == pytest.approx(0.1**2)
    assert far.acceleration_variance == pytest.approx(0.1**2 + 2.0 / 3.0 * 0.12**2)
    assert far.noise_acceleration_sq == pytest.approx(18.0 * far.acceleration_variance)
