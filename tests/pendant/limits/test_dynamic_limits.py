"""Limits that fall (FD-12b): each rule alone, at and around its boundary, in free-drive and in the activation sequence."""

import math
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from pendant.all_settings import Settings, apply
from pendant.events.event import Kind
from pendant.guided.endings import Ending, EndingWatch
from pendant.guided.user_force import UserForce
from pendant.limits.dynamic_limits import CREEPING, WHOLE, DynamicLimits, Shares, in_activation, in_operation
from pendant.limits.parameters import ZEROS
from pendant.tick.estimate import Estimate
from pendant.tick.state import state_of
from tests.pendant.estimates import MOVES, SENSOR, estimate
from tests.pendant.freedrive.test_state_machine import HOLD, Bench

STILL = estimate()
JOINTS = ("base", "shoulder", "elbow", "wrist_1", "wrist_2", "wrist_3")
NONE = {"soft.payload": False, "soft.drift": False}


def settings(**changes: float | bool) -> Settings:
    return apply(Settings(), NONE | {name.replace("__", "."): value for name, value in changes.items()})


def shares(now: Estimate = STILL, force: float = 0.0, torque: float = 0.0, **changes: float | bool) -> Shares:
    return DynamicLimits(in_operation(settings(**changes)), now).step(now, force, torque)


def test_with_every_rule_off_nothing_is_lowered() -> None:
    busy = estimate(acceleration=9.0, speed=1.0, load_mass=5.0)
    assert shares(busy, 90.0, 9.0) is WHOLE
    limits = DynamicLimits(in_activation(Settings()), busy)
    assert limits.step(busy, 90.0, 9.0) is WHOLE
    assert not limits.pushed


@pytest.mark.parametrize("rule", ["acceleration", "payload", "drift", "pushed", "vertical"])
def test_each_rule_has_its_switch_in_each_stage(rule: str) -> None:
    """A rule that is on in one stage is not on in the other, and no other rule is on with it."""
    there = in_operation(settings(**{f"soft__{rule}": True}))
    assert there != in_operation(settings())
    assert there._replace(drift_speed=0.0) == in_activation(settings(**{f"sequence__dynamic__{rule}": True}))._replace(
        drift_speed=0.0
    )
    assert in_activation(settings(**{f"soft__{rule}": True})) == in_activation(settings())
    assert in_operation(settings(**{f"sequence__dynamic__{rule}": True})) == in_operation(settings())


@pytest.mark.parametrize("size", [0.0, 0.5, 1.0, 4.0, 40.0])
@pytest.mark.parametrize("direction", [0, 1, 2])
def test_acceleration_lowers_way_and_time_alone(size: float, direction: int) -> None:
    """(i), however gravity lies: the arm hangs from a wall, and the accelerometer feels what holds it up as well."""
    now = estimate()
    now.g_B = np.array([9.81, 0.0, 0.0])
    now.a_felt = size * np.eye(3)[direction]
    found = shares(now, soft__acceleration=True, soft__acceleration_share=0.5)
    assert found.way == pytest.approx(1.0 / (1.0 + 0.5 * size))
    assert found[1:6] == (1.0,) * 5


def test_without_an_accelerometer_acceleration_lowers_nothing() -> None:
    assert shares(estimate(acceleration=9.0, acceleration_valid=False), soft__acceleration=True).way == 1.0


def test_the_load_lowers_speeds_and_accelerations() -> None:
    """(iii)."""
    found = shares(estimate(load_mass=4.0), soft__payload=True, soft__payload_share=0.25)
    assert found[:6] == (1.0, 0.5, 0.5, 0.5, 0.5, 1.0)


@pytest.mark.parametrize(("force", "linear"), [(0.05, 0.25), (0.0, 1.0)])
@pytest.mark.parametrize(("torque", "angular"), [(0.5, 0.5), (0.0, 1.0)])
def test_force_lowers_linear_limits_and_torque_angular_ones(force: float, linear: float, torque: float, angular: float) -> None:
    """(iv): both, each alone, or none."""
    on = {"soft__pushed": True, "soft__force_share": force, "soft__torque_share": torque}
    assert shares(STILL, 60.0, 2.0, **on)[:6] == (1.0, linear, angular, linear, angular, 1.0)
    assert DynamicLimits(in_operation(settings(**on)), STILL).pushed is (force + torque > 0.0)


def test_drift_lowers_speeds_alone() -> None:
    """(ii)."""
    limits = DynamicLimits(in_operation(settings(soft__drift=True, soft__drift_time=0.2, soft__drift_share=0.4)), STILL)
    for _ in range(2):
        assert limits.step(STILL)[:6] == (1.0,) * 6
        for _ in range(100):
            assert limits.step(estimate(speed=0.1))[:6] == (1.0,) * 6
        assert limits.step(estimate(speed=0.1))[:6] == (1.0, 0.4, 0.4, 1.0, 1.0, 1.0)


@pytest.mark.parametrize("seed", range(10))
@pytest.mark.parametrize(("degrees", "falls"), [(44.9, True), (45.1, False)])
def test_the_cone_in_which_motion_is_drift_lies_round_where_it_began(seed: int, degrees: float, falls: bool) -> None:
    """(ii): 5 ticks straight on, 6 a little under or over 45° off."""
    first, aside = np.linalg.qr(np.random.default_rng(seed).normal(size=(3, 3)))[0][:, :2].T
    angle = math.radians(degrees)
    limits = DynamicLimits(in_operation(settings(soft__drift=True))._replace(drift_ticks=10), STILL)
    for way in [first] * 5 + [math.cos(angle) * first + math.sin(angle) * aside] * 6:
        limits.step(estimate(speed=(0.3 * way).tolist()))
    assert (limits.shares.speed < 1.0) is falls


@pytest.mark.parametrize(("payload", "left"), [(True, 0.5), (False, 1.0)])
def test_along_gravity_is_along_the_bases_gravity_with_another_rule_and_without(payload: bool, left: float) -> None:
    """(iii) and (v), on a tilted base."""
    up, now = np.array([2.0, -3.0, 6.0]) / 7.0, estimate(load_mass=2.0)
    now.g_B = -9.81 * up
    found = shares(now, soft__payload=payload, soft__payload_share=0.5, soft__vertical=True, soft__vertical_share=0.25)
    assert found == (1.0, left, left, left, left, 0.25, pytest.approx(tuple(up)), True)
    assert found.along(*up) == pytest.approx(0.25)


def test_a_hand_that_is_not_told_lowers_nothing_and_what_stays_is_the_same_object() -> None:
    limits = DynamicLimits(in_operation(settings(soft__pushed=True)), STILL)
    assert limits.step(STILL)[:6] == (1.0,) * 6
    assert limits.step(STILL, 20.0, 2.0) is limits.step(STILL, 20.0, 2.0)


@pytest.mark.parametrize(("speed", "falls"), [(0.99 * CREEPING, False), (CREEPING, True), (1.01 * CREEPING, True)])
def test_in_the_sequence_a_creeping_arm_drifts(speed: float, falls: bool) -> None:
    limits = DynamicLimits(in_activation(settings(sequence__dynamic__drift=True, soft__drift_time=0.2)), STILL)
    for _ in range(102):
        limits.step(estimate(speed=speed))
    assert (limits.shares.speed < 1.0) is falls


def test_acceleration_shortens_the_time_after_which_motion_is_drift() -> None:
    on = {"soft__drift": True, "soft__drift_time": 0.2, "soft__acceleration": True, "soft__acceleration_share": 0.5}
    limits = DynamicLimits(in_operation(settings(**on)), STILL)
    now = estimate(speed=0.1, acceleration=2.0)
    found = [limits.step(now).speed for _ in range(60)]
    assert found == [1.0] * 50 + [0.5] * 10


@given(st.lists(st.floats(-1.0, 1.0), min_size=6, max_size=6), st.floats(0.1, 0.99))
def test_the_limits_of_all_directions_are_an_ellipsoid_about_gravity(values: list[float], least: float) -> None:
    """(v): a vector at its limit, stretched along gravity by 1 / least, has length 1."""
    g, v = np.array(values[:3]), np.array(values[3:])
    if min(np.linalg.norm(g), np.linalg.norm(v)) < 1e-3:
        return
    up = -g / np.linalg.norm(g)
    end = v / np.linalg.norm(v) * Shares(vertical=least, up=tuple(up)).along(*v)
    stretched = end + (end @ up) * (1.0 / least - 1.0) * up
    assert np.linalg.norm(stretched) == pytest.approx(1.0)


def test_across_gravity_and_at_rest_a_limit_is_whole_and_along_it_a_share() -> None:
    found = shares(STILL, soft__vertical=True, soft__vertical_share=0.5)
    assert [found.along(*v) for v in ((0.3, -0.4, 0.0), (0.0, 0.0, 0.0))] == [1.0, 1.0]
    assert [found.along(0.0, 0.0, z) for z in (0.3, -2.0)] == [0.5, 0.5]
    assert WHOLE.along(0.0, 0.0, 1.0) == 1.0


def ended(now: Estimate, ticks: int = 1, force: list[float] | None = None, **changes: float | bool) -> Ending | None:
    """What ends a free-drive that began at rest, of a hand that lasts; the limit that says it is the changed one alone."""
    use = settings(soft__hard=True, unexplained__motion=False, unexplained__payload=False, **changes)
    first = estimate()
    operation, hand = (
        EndingWatch(first, use, joints=JOINTS, rated=(100.0,) * 6, held=0.0),
        UserForce(first, ZEROS, SENSOR.offset_force),
    )
    for _ in range(ticks):
        hand.step(now, True, MOVES)
        found = operation.step(now, hand, baseline=ZEROS, driven=False)
        if found is not None:
            assert found.kind in (Kind.LEFT_LIMIT, Kind.STOPPED_LIMIT)
            return found
    return None


MOVING: dict[str, Any] = {
    "tcp_speed": lambda v: estimate(v_tcp=v, tcp=[0.0, 0.0, 0.0, 0.0, 0.0, v]),
    "elbow_speed": lambda v: estimate(v_elbow=v, elbow=[0.0, 0.0, 0.0, 0.0, 0.0, -v]),
    "flange_acceleration": lambda a: estimate(acceleration=[0.0, 0.0, a]),
    "flange_displacement": lambda d: estimate(position=[0.0, 0.0, d]),
    "joint_speed": lambda w: estimate(qd=w),
}
"""Upwards."""
BASE = {"tcp_speed": 1.5, "elbow_speed": 1.5, "flange_acceleration": 40.0, "flange_displacement": 0.5, "joint_speed": 3.0}


@pytest.mark.parametrize(
    ("rule", "lowered"),
    [
        ("soft__vertical", {"tcp_speed", "elbow_speed", "flange_acceleration", "flange_displacement"}),
        ("soft__payload", {"tcp_speed", "elbow_speed", "flange_acceleration", "joint_speed"}),
    ],
)
@pytest.mark.parametrize("name", BASE)
@pytest.mark.parametrize("off", [-1e-3, -1e-9, 1e-9, 1e-3])
def test_operation_limits_lie_where_the_rule_puts_them(rule: str, lowered: set[str], name: str, off: float) -> None:
    """Half of each, at (v) 0.5 and at (iii) 2 kg of 0.5 a kg."""
    limit = BASE[name] * (0.5 if name in lowered else 1.0)
    now = MOVING[name](limit * (1.0 + off))
    now.load_mass = 2.0
    found = ended(now, soft__payload_share=0.5, limits__operation__flange_displacement__on=True, **{rule: True})
    assert (found is not None) is (off > 0.0)
    if found is not None:
        assert found.values["limit"] == pytest.approx(limit)


@pytest.mark.parametrize(("acceleration", "limit"), [(0.0, 0.5), (2.0, 0.25), (6.0, 0.125)])
@pytest.mark.parametrize("off", [-1e-6, 1e-6])
def test_the_more_it_accelerates_the_shorter_the_way(acceleration: float, limit: float, off: float) -> None:
    now = estimate(position=limit * (1.0 + off), acceleration=[0.0, acceleration, 0.0])
    on = {"soft__acceleration": True, "soft__acceleration_share": 0.5}
    assert (ended(now, limits__operation__flange_displacement__on=True, **on) is not None) is (off > 0.0)


@pytest.mark.parametrize(("acceleration", "last"), [(0.0, 50), (2.0, 25), (6.0, 12)])
def test_the_more_it_accelerates_the_shorter_beyond_a_limit(acceleration: float, last: int) -> None:
    """0.1 s, 50 ticks, are allowed at rest; a half, a quarter of it."""
    now = estimate(v_tcp=2.0, acceleration=[0.0, acceleration, 0.0])
    on = {"soft__acceleration": True, "soft__acceleration_share": 0.5, "limits__operation__tcp_speed__time": 0.1}
    assert ended(now, last, **on) is None
    assert ended(now, last + 1, **on) is not None


def test_the_hands_force_lowers_the_limit_on_speed_and_its_torque_that_on_joint_speed() -> None:
    """20 N for long enough to be the hand's whole force; 5 N·m at once."""
    on = {"soft__pushed": True, "soft__force_share": 0.05, "soft__torque_share": 0.2}
    pushing = estimate(v_tcp=1.0, force=[20.0, 0.0, 0.0])
    found = ended(pushing, 500, **on)
    assert found is not None
    assert found.values["limit"] < 1.0
    assert ended(pushing, 500) is None
    twisting = estimate(qd=1.6, torque=[0.0, 3.0, 4.0])
    found = ended(twisting, 1, **on)
    assert found is not None
    assert found.values["limit"] == pytest.approx(1.5)
    assert ended(twisting, 1) is None


def test_without_the_flange_sensor_no_torque_lowers_anything() -> None:
    use, now = settings(soft__hard=True, soft__pushed=True, soft__torque_share=2.0), estimate(qd=2.9, torque=9.0)
    operation = EndingWatch(now, use, joints=JOINTS, rated=(100.0,) * 6, held=0.0)
    assert operation.step(now, UserForce(now, ZEROS, SENSOR.offset_force), baseline=None, driven=False) is None
    assert operation.step(now, UserForce(now, ZEROS, SENSOR.offset_force), baseline=ZEROS, driven=False) is not None


def test_what_the_sensor_was_off_before_entry_is_no_torque_of_the_hand() -> None:
    now = estimate(qd=2.9, torque=[3.0, 0.0, 4.0])
    use = settings(soft__hard=True, soft__pushed=True, soft__torque_share=2.0)
    operation = EndingWatch(now, use, joints=JOINTS, rated=(100.0,) * 6, held=0.0)
    assert (
        operation.step(now, UserForce(now, ZEROS, SENSOR.offset_force), baseline=(0.0, 0.0, 0.0, 3.0, 0.0, 4.0), driven=False)
        is None
    )


SEQUENCE: dict[str, tuple[str, float, Any]] = {
    "acceleration": ("flange displacement", 0.001, lambda v: estimate(position=v, acceleration=[0.0, 1.0, 0.0])),
    "payload": ("flange speed", 0.02 / 1.5, lambda v: estimate(speed=v, load_mass=1.0)),
    "pushed": ("flange speed", 0.01, lambda v: estimate(speed=v, force=[3.0, 0.0, 4.0])),
    "vertical": ("flange displacement", 0.0005, lambda v: estimate(position=[0.0, 0.0, v])),
}
"""Rule, the limit that it lowers, to what, and the estimate with a value of it."""
RATES = {"soft__acceleration_share": 1.0, "soft__payload_share": 0.5, "soft__force_share": 0.2, "soft__vertical_share": 0.25}


@pytest.mark.parametrize("rule", SEQUENCE)
@pytest.mark.parametrize("off", [-1e-6, 1e-6])
@pytest.mark.parametrize("on", [True, False])
def test_in_the_sequence_each_rule_lowers_its_limit(rule: str, off: float, on: bool) -> None:
    name, limit, make = SEQUENCE[rule]
    bench = Bench(**{"sequence__on": True, f"sequence__dynamic__{rule}": on, **RATES})
    bench.run(60)
    bench.run(501, HOLD)
    bench.run(100, HOLD, **{"value": make(limit * (1.0 + off))})
    refused = [event for event in bench.events if event.kind is Kind.ENTRY_PREVENTED]
    assert bool(refused) is (on and off > 0.0)
    if refused:
        assert refused[0].values["parameter"] == name
        assert refused[0].values["limit"] == pytest.approx(limit)


def test_its_state_tells_histories_apart() -> None:
    one, other = (DynamicLimits(in_operation(Settings()), STILL) for _ in range(2))
    other.step(STILL)
    assert state_of(one) == state_of(other)
    one.step(estimate(speed=0.1))
    assert state_of(one) != state_of(other)
    assert math.isclose(one.step(STILL).speed, 1.0)
