"""Zones before the joint limits: where they lie, that they only resist, that nothing kicks (FD-4)."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from pendant.limits.joint_zones import JointZones
from pendant.limits.settings import JointLimits
from pendant.supervisor import Supervisor
from pendant.tick.modes import TICK
from pendant.tick.state import state_of
from tests.pendant.estimates import estimate
from tests.pendant.freedrive.test_state_machine import Bench

RATED, RANGE = (100.0, 20.0), ((-3.0, 3.0), (-2.0, 2.0))
SETTINGS = JointLimits()  # damping zone from 2.85 rad, stiff zone from 2.95 rad, 25 and 5 N·m·s/rad, 2000 and 400 N·m/rad


def zones(settings: JointLimits = SETTINGS) -> JointZones:
    module = JointZones(RATED, RANGE)
    module.enter(settings)
    return module


def at(module: JointZones, *motion: tuple[float, float]) -> tuple[float, ...]:
    """The torque at these angles [rad] and speeds [rad/s]."""
    angles, speeds = zip(*motion, strict=True)
    module.step(estimate(n=len(motion), theta=list(angles), theta_d=list(speeds)))
    return module.torque


def test_away_from_the_limits_nothing_is_resisted() -> None:
    assert at(zones(), (2.849, 3.0), (-1.849, -3.0)) == ()
    wide = JointLimits(damping_zone=0.25, stiff_zone=0.25)
    assert at(zones(wide), (2.5, 3.0), (-1.5, -3.0)) == (), "where the zones begin"


@pytest.mark.parametrize(
    ("angle", "speed", "torque"),
    [
        (2.86, 1.0, -2.5),  # a tenth of the damping
        (2.90, 2.0, -25.0),
        (-2.90, -2.0, 25.0),
        (2.90, -2.0, 0.0),
        (2.95, 1.0, -25.0),
    ],
)
def test_in_the_damping_zone_outward_motion_is_damped(angle: float, speed: float, torque: float) -> None:
    assert at(zones(), (angle, speed), (0.0, 1.0)) == pytest.approx((torque, 0.0))


def test_in_the_stiff_zone_a_spring_holds_and_the_way_back_is_eased() -> None:
    module = zones()
    at(module, (2.94, 0.0), (0.0, 0.0))
    assert module.pushing is False
    assert at(module, (2.96, 0.0), (0.0, 0.0)) == pytest.approx((-20.0, 0.0))
    assert module.pushing is True
    assert at(module, (2.96, 1.0), (0.0, 0.0)) == pytest.approx((-45.0, 0.0))
    assert at(module, (2.96, -0.4), (0.0, 0.0)) == pytest.approx((-10.0, 0.0))
    assert at(module, (2.96, -2.0), (0.0, 0.0)) == pytest.approx((0.0, 0.0)), "it never pulls outward"
    assert at(module, (3.2, 1.0), (0.0, 0.0)) == (-100.0, 0.0), "not more than the rated torque"


def test_started_inside_there_is_no_kick_and_the_way_out_is_free() -> None:
    module = zones()
    assert at(module, (2.98, 0.0), (-1.99, 0.0)) == (0.0, 0.0)
    assert not module.pushing, "no spring is bent"
    assert at(module, (2.99, 0.0), (-1.99, 0.0)) == pytest.approx((-20.0, 0.0))
    assert at(module, (2.97, -0.5), (-1.99, 0.0)) == pytest.approx((0.0, 0.0))
    assert at(module, (2.98, 0.0), (-1.99, 0.0)) == pytest.approx((-20.0, 0.0)), "it may not go back to where it started"
    assert at(module, (0.0, 0.0), (-1.99, 0.0)) == (0.0, 0.0)
    at(module, (0.0, 0.0), (0.0, 0.0))
    assert module.torque == ()
    assert module.pushing is False
    at(module, (2.94, 0.0), (0.0, 0.0))
    assert at(module, (2.98, 0.0), (0.0, 0.0)) == pytest.approx((-60.0, 0.0)), "come in again, it meets the whole zone"


def test_switched_off_left_or_without_limits_nothing_is_resisted() -> None:
    for module in (JointZones(RATED, RANGE), zones(JointLimits(on=False))):
        assert at(module, (2.99, 1.0), (0.0, 0.0)) == ()
        assert module.pushing is False
    module = zones()
    at(module, (2.94, 0.0), (0.0, 0.0))
    at(module, (2.99, 1.0), (0.0, 0.0))
    entered = state_of(module)
    module.leave()
    assert not module.pushing
    assert state_of(module) != entered
    assert at(module, (2.99, 1.0), (0.0, 0.0)) == ()
    endless = JointZones(RATED, ((-math.inf, math.inf),) * 2)
    endless.enter(SETTINGS)
    assert at(endless, (1e6, 1.0), (-1e6, 1.0)) == ()


ways = st.lists(st.tuples(st.floats(2.7, 3.05), st.integers(2, 60)), min_size=1, max_size=12)


@given(ways, st.floats(2.7, 3.0), st.sampled_from([1.0, -1.0]))
def test_it_never_injects_energy(targets: list[tuple[float, int]], start: float, side: float) -> None:
    """Whatever a hand does in it, the zone has never given more than it has taken."""
    module = zones()
    angle, work, most = start, 0.0, 0.0
    for target, ticks in targets:
        speed = (target - angle) / (ticks * TICK)
        for _ in range(ticks):
            before = at(module, (side * angle, side * speed), (0.0, 0.0))
            angle += speed * TICK
            after = at(module, (side * angle, side * speed), (0.0, 0.0))
            torques = [moment[0] if moment else 0.0 for moment in (before, after)]
            work += side * 0.5 * sum(torques) * speed * TICK
            most = max(most, work)
    assert most <= 1e-3 + 0.5 * 2000.0 * (0.3 * TICK) ** 2


@given(st.floats(-3.2, 3.2), st.floats(-4.0, 4.0))
def test_it_is_never_a_push_outwards_and_never_beyond_the_rated_torque(angle: float, speed: float) -> None:
    torque = at(zones(), (angle, speed), (0.0, 0.0)) or (0.0, 0.0)
    assert abs(torque[0]) <= 100.0
    assert torque[0] * angle <= 0.0


def test_the_supervisor_holds_each_joint_back_by_its_own_torque_before_its_own_range_ends() -> None:
    bench = Bench(activation__period=0.0)
    bench.supervisor = Supervisor(bench.supervisor.settings, 2, rated=RATED, ranges=RANGE)
    at_rest = estimate(n=2)
    bench.entered(at_rest)
    assert bench.last.zones == ()
    assert bench.step(value=estimate(n=2, theta=[2.9, 1.9], theta_d=[2.0, 2.0])).zones == pytest.approx((-25.0, -5.0))


def test_a_joint_that_left_its_zone_while_another_stays_enters_it_as_for_the_first_time() -> None:
    """Joint 0 stays in its stiff zone; joint 1 starts in its own, leaves all zones, and is held where the stiff zone begins."""
    module = zones()
    assert at(module, (2.96, 0.0), (1.98, 0.0)) == (0.0, 0.0)
    assert at(module, (2.96, 0.0), (1.5, 0.0)) == (0.0, 0.0)
    assert at(module, (2.96, 0.0), (1.9, 0.0)) == (0.0, 0.0)
    assert at(module, (2.96, 0.0), (1.97, 0.0)) == pytest.approx((0.0, -400.0 * 0.02))


def test_each_side_has_its_own_end() -> None:
    """A joint from -3 to -0.1 rad: the same zones as of one within ±1.45 rad, so far from its middle."""
    beside, middle = JointZones((100.0,), ((-3.0, -0.1),)), JointZones((100.0,), ((-1.45, 1.45),))
    for module in (beside, middle):
        module.enter(SETTINGS)
    for angle in (-2.99, -2.8, -1.55, -0.3, -0.11):
        assert at(beside, (angle, 0.5)) == pytest.approx(at(middle, (angle + 1.55, 0.5)))
    assert at(beside, (-0.11, 0.5))[0] < 0.0 <= at(beside, (-2.99, 0.0))[0]
