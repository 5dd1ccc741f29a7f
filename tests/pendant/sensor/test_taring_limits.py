"""The sensor's zero at the limits of what pulls, trembles, is due, and can be its own; on a wall, and with a load."""

import math

import numpy as np
import pytest
from msgspec.structs import replace

from pendant.events.event import Event
from pendant.limits.validity import WINDOW, WrenchMean
from pendant.sensor.sensor_errors import FALSE_ALARM, LEVER
from pendant.sensor.sensor_spec import SensorSpec
from pendant.sensor.taring import DUE, LEAST_PULL, LEAST_TWIST, OVER, TREMBLE, WINDOWS, Taring
from pendant.settings.schema import Limit
from pendant.tick.estimate import GRAVITY
from pendant.tick.modes import TICK
from tests.pendant.estimates import estimate
from tests.pendant.sensor.test_taring import ACROSS, LIMITS, NOISE, READY, SPEC, TWIST, Bench, ready

PERFECT = SensorSpec(drift_force=0.0, drift_torque=0.0, noise_force=0.0, noise_torque=0.0, noise_acceleration=0.0, gain=0.0)
"""No noise and no drift: every limit is the number that it is called by."""


def exactly(*wrench: float) -> WrenchMean:
    """The mean of one tick, which nothing rounds."""
    mean = WrenchMean()
    mean.step(estimate(force=list(wrench[:3]), torque=list(wrench[3:]) or [0.0] * 3))
    return mean


def test_a_sensor_without_noise_can_be_zeroed() -> None:
    """What does not tremble at all trembles by no more than nothing."""
    assert Bench(PERFECT).run(READY).why_not() == ""


@pytest.mark.parametrize("axis", range(6))
@pytest.mark.parametrize(("more", "pulls"), [(0.0, False), (1e-9, True)])
def test_what_differs_by_just_so_much_is_no_hands(axis: int, more: float, pulls: bool) -> None:
    bench = Bench(PERFECT).run(READY)
    wrench = [(LEAST_PULL if axis < 3 else LEAST_TWIST) + more if k == axis else 0.0 for k in range(6)]
    assert ("let go of it" in bench.taring.why_not(bench.value(), exactly(*wrench))) is pulls


@pytest.mark.parametrize("mass", [0.5, 2.0, 5.0])
@pytest.mark.parametrize("off", [-0.005, 0.005])
def test_a_load_makes_more_noise_in_the_torque_too(mass: float, off: float) -> None:
    """The accelerometer's noise weighs it, on a lever of 0.2 m."""
    noise = math.hypot(SPEC.noise_torque, LEVER * SPEC.noise_acceleration * mass) / math.sqrt(WINDOW)
    size = LEAST_TWIST + FALSE_ALARM * noise + SPEC.drift_torque * WINDOW * TICK + off
    bench = Bench()
    bench.load = mass
    bench.run(READY)
    assert ("let go of it" in bench.pulled(0.0, 0.0, 0.0, 0.0, size)) is (off > 0.0)


@pytest.mark.parametrize("axis", range(3))
def test_a_torque_that_trembles_is_no_force(axis: int) -> None:
    """It would be twice as much as a force may, in newtons."""
    bench, size = ready(), 0.9 * TWIST
    assert size * math.sqrt(WINDOWS / (3.0 * (WINDOWS - 1))) > 1.9 * TREMBLE * NOISE
    for k in range(WINDOWS):
        bench.feel(*[size * (-1) ** k if each == 3 + axis else 0.0 for each in range(6)]).run(WINDOW)
    assert bench.why_not() == ""


def test_after_the_arm_moved_it_takes_as_long_as_in_the_beginning() -> None:
    bench = ready().run(1, stands=False).run(WINDOWS * WINDOW - 1)
    assert "must stand untouched" in bench.why_not()
    assert bench.run(1).why_not() == ""


@pytest.mark.parametrize("gravity", [(GRAVITY, 0.0, 0.0), (0.0, -GRAVITY, 0.0), (0.0, 0.0, -GRAVITY)])
@pytest.mark.parametrize(("off", "pulls"), [(-0.02, False), (0.02, True)])
def test_however_the_arm_is_mounted_a_turned_load_may_weigh_something_else(
    gravity: tuple[float, ...], off: float, pulls: bool
) -> None:
    """5 kg turned by 90 degrees: the weight changes by the root of two times itself, of which the gain may be wrong by 1.4 %."""
    taring, mass = Taring(SPEC), 5.0
    noise = math.hypot(SPEC.noise_force, SPEC.noise_acceleration * mass) / math.sqrt(WINDOW)
    wrong = SPEC.gain * math.sqrt(2.0) * mass * GRAVITY
    size = LEAST_PULL + FALSE_ALARM * noise + wrong
    tick, why_not = 0, ""
    for R, force in ((np.eye(3), 0.0), (ACROSS, size + off)):
        mean = exactly(0.0, 0.0, force)
        for _ in range(READY):
            tick += 1
            value = estimate(tick, load_mass=mass)
            value.R_BF, value.g_B = R, np.array(gravity)
            taring.step(value, mean, True, LIMITS)
        why_not = taring.why_not(value, mean)
    assert SPEC.drift_force * READY * TICK < 0.02, "as far as the reference follows it meanwhile"
    assert ("let go of it" in why_not) is pulls


def test_while_a_hand_pulls_nothing_becomes_due_although_the_reference_follows_it() -> None:
    """0.66 of the limit are felt untouched, and a minute's drift towards the hand would be more than two thirds."""
    most = 4.0
    limits = replace(LIMITS, payload_force=Limit(max=most))
    bench = Bench(limits=limits).feel(0.0, 0.0, 0.66 * most).run(READY)
    assert 0.66 * most + SPEC.drift_force * 60.0 > DUE * most
    bench.feel(0.0, 0.0, 0.66 * most + 5.0).wait(60.0).run(READY)
    assert "let go of it" in bench.why_not()
    assert bench.events == []
    assert bench.taring.due is False
    bench.feel(0.0, 0.0, 0.66 * most + SPEC.drift_force * 60.0).run(READY)
    assert bench.taring.due is True, "when it has let go"


@pytest.mark.parametrize("axis", range(3))
@pytest.mark.parametrize("way", [1.0, -1.0])
@pytest.mark.parametrize(("more", "can"), [(0.0, True), (1e-9, False)])
def test_a_zero_can_be_off_by_just_so_much(axis: int, way: float, more: float, can: bool) -> None:
    for first, most in ((0, SPEC.offset_force), (3, SPEC.offset_torque)):
        wrench = tuple([way * (most + more) if k == first + axis else 0.0 for k in range(6)])
        assert Taring(SPEC).explains(estimate(), wrench) is can


def test_zeroing_is_due_beyond_two_thirds_of_a_limit_and_not_below_a_half() -> None:
    """2 N of 3 N and 1.5 N of 3 N, which nothing rounds; each is felt for a window, a while after the one before."""
    limits = replace(LIMITS, payload_force=Limit(max=3.0))
    assert (DUE, OVER) == (2.0 / 3.0, 1.5 / 3.0)
    taring, tick, told = Taring(SPEC), 0, list[Event]()

    def due(force: float) -> bool:
        nonlocal tick
        tick += round(300.0 / TICK)
        for _ in range(WINDOW):
            tick += 1
            told.extend(taring.step(estimate(tick), exactly(0.0, 0.0, force), True, limits))
        return taring.due

    assert [due(force) for force in (2.0, 2.001, 1.501, 1.5, 1.499)] == [False, True, True, True, False]
    assert len(told) == 1


def test_after_zeroing_it_is_due_no_more() -> None:
    bench = Bench().feel(0.0, 0.0, 4.4).run(READY)
    assert bench.taring.due is True
    bench.zero()
    assert bench.taring.due is False
