"""Soft limits on speed: what they are, and when they fall (FD-12b)."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from pendant.all_settings import Settings, apply
from pendant.events.event import Kind
from pendant.guided.endings import Ending, EndingWatch
from pendant.guided.user_force import UserForce
from pendant.limits.dynamic_limits import WHOLE
from pendant.limits.parameters import ZEROS
from pendant.limits.soft_limits import SoftLimits, hard
from pendant.tick.state import state_of
from tests.pendant.estimates import SENSOR, estimate

STILL = estimate()


def soft(**changes: float | bool) -> SoftLimits:
    return SoftLimits(apply(Settings(), {name.replace("__", "."): value for name, value in changes.items()}), STILL)


def limits(module: SoftLimits) -> tuple[float, float, float]:
    assert module.damping is not None
    return module.damping[:3]


def test_they_lie_at_the_operation_limits() -> None:
    module = soft()
    module.step(STILL)
    assert limits(module) == (1.5, 1.5, 3.0)
    assert module.damping is not None
    assert module.damping[3:] == (0.5, 120.0, 0.7)
    assert module.shares is WHOLE


def test_switched_off_nothing_is_resisted() -> None:
    module = soft(soft__on=False)
    module.step(STILL)
    assert module.damping is None


def test_a_limit_that_is_off_is_infinite() -> None:
    every = {f"limits.operation.{name}.on": False for name in ("tcp_speed", "elbow_speed", "joint_speed")}
    assert hard(apply(Settings(), every).limits.operation) == (math.inf, math.inf, math.inf)


def test_they_fall_with_the_configured_payload() -> None:
    module = soft(soft__payload_share=0.25)
    module.step(estimate(load_mass=4.0))
    assert limits(module) == (0.75, 0.75, 1.5)
    without = soft(soft__payload=False)
    without.step(estimate(load_mass=4.0))
    assert limits(without) == (1.5, 1.5, 3.0)


def test_they_fall_after_the_drift_time_and_rise_when_it_stands() -> None:
    module = soft(soft__drift_time=0.2, soft__drift_share=0.4)
    for _ in range(100):
        module.step(estimate(speed=0.1))
        assert limits(module)[0] == 1.5
    module.step(estimate(speed=0.1))
    assert limits(module) == pytest.approx((0.6, 0.6, 1.2))
    module.step(estimate(speed=0.019))
    assert limits(module)[0] == 1.5
    module.step(estimate(speed=0.1))
    assert limits(module)[0] == 1.5


@pytest.mark.parametrize(("degrees", "falls"), [(44.0, True), (46.0, False)])
def test_a_direction_is_about_the_same_up_to_45_degrees_from_where_it_began(degrees: float, falls: bool) -> None:
    module = soft(soft__drift_time=0.2)
    angle = math.radians(degrees)
    for _ in range(60):
        module.step(estimate(speed=[0.2, 0.0, 0.0]))
    for _ in range(60):
        module.step(estimate(speed=[0.2 * math.cos(angle), 0.2 * math.sin(angle), 0.0]))
    assert (limits(module)[0] < 1.5) is falls


def test_without_the_guard_it_may_go_on() -> None:
    module = soft(soft__drift_time=0.2, soft__drift=False)
    for _ in range(500):
        module.step(estimate(speed=0.1))
    assert limits(module)[0] == 1.5


ORIGIN = [0.4, -0.3, 0.2]


@pytest.mark.parametrize("way", [(1, 0, 0), (0, 1, 0), (0, 0, 1), (-1, 0, 0), (0, -1, 0), (0, 0, -1)])
@pytest.mark.parametrize("vertical", [False, True])
def test_on_the_way_out_they_fall_to_the_end_of_the_way_and_the_way_back_is_free(
    way: tuple[int, int, int], vertical: bool
) -> None:
    """FD-12b: 0.5 m from entry, half of them across gravity along it where the rule says so; from half of the way on."""
    changes = {"limits.operation.flange_displacement.on": True, "soft.vertical": vertical}
    module = SoftLimits(apply(Settings(), changes), estimate(position=ORIGIN))
    whole = 0.25 if vertical and way[2] else 0.5
    speed = 0.5 * 1.5 if vertical else 1.5  # of the elbow, which is taken to move along gravity
    for gone, left in ((0.4, 1.0), (0.75, 0.5), (0.9, 0.2), (0.99, 0.1), (2.0, 0.1)):
        place = [start + gone * whole * axis for start, axis in zip(ORIGIN, way, strict=True)]
        out, across = [0.1 * axis for axis in way], [0.1 * axis for axis in (way[2], way[0], way[1])]
        for motion, share in ((out, left), ([-value for value in out], 1.0), (across, 1.0)):
            now = estimate(position=place, speed=motion).copy()
            now.elbow[3:] = (0.0, 0.0, -0.2)
            module.step(now)
            assert limits(module)[1:] == pytest.approx((share * speed, share * 3.0))


@given(st.lists(st.tuples(st.floats(-1.0, 1.0), st.floats(-1.0, 1.0)), max_size=60), st.floats(0.0, 10.0))
def test_they_never_rise_above_the_hard_ones_nor_fall_below_what_is_set(ways: list[tuple[float, float]], mass: float) -> None:
    module = soft(soft__drift_time=0.2)
    for x, y in ways:
        for _ in range(4):
            module.step(estimate(speed=[x, y, 0.0], load_mass=mass))
            assert 0.5 * 1.5 / (1.0 + 0.05 * mass) <= limits(module)[0] * (1.0 + 1e-12)
            assert limits(module)[0] <= 1.5


def ended(speed: float, **changes: float | bool) -> Ending | None:
    settings = apply(Settings(), {name.replace("__", "."): value for name, value in changes.items()})
    now = estimate(load_mass=4.0, v_tcp=speed)
    operation = EndingWatch(now, settings, joints=tuple("abcdef"), rated=(100.0,) * 6, held=0.0)
    assert operation.damping is None
    found = operation.step(now, UserForce(now, ZEROS, SENSOR.offset_force), baseline=ZEROS, driven=False)
    assert operation.damping is not None
    return found


def test_hard_limits_fall_too_when_asked_for() -> None:
    assert ended(1.3) is None
    ending = ended(1.3, soft__hard=True)
    assert ending is not None
    assert ending.kind is Kind.LEFT_LIMIT
    assert ending.values["limit"] == pytest.approx(1.5 / 1.2)


def test_its_state_tells_histories_apart() -> None:
    one, other = soft(), soft()
    one.step(STILL)
    other.step(estimate(speed=0.2))
    assert state_of(one) != state_of(other)


def test_up_and_down_tool_and_elbow_have_lower_limits() -> None:
    """FD-12b (v): the tool goes up, the elbow sideways; turning joints have no direction."""
    module = soft(soft__vertical=True, soft__vertical_share=0.4)
    module.step(estimate(tcp=[0.0] * 5 + [0.3], elbow=[0.0, 0.0, 0.0, 0.2, 0.0, 0.0]))
    assert limits(module) == pytest.approx((0.6, 1.5, 3.0))


def test_they_fall_with_the_hands_force_and_torque() -> None:
    """FD-12b (iv)."""
    module = soft(soft__pushed=True, soft__force_share=0.05, soft__torque_share=0.5)
    module.step(STILL, 20.0, 2.0)
    assert limits(module) == pytest.approx((0.75, 0.75, 1.5))
    module.step(STILL, 0.0, 6.0)
    assert limits(module) == pytest.approx((1.5, 1.5, 0.75))


@pytest.mark.parametrize(("way", "share"), [(0.1, 1.0), (0.25, 1.0), (0.375, 0.5), (0.475, 0.1), (0.6, 0.1)])
def test_far_out_they_fall_but_not_on_the_way_back(way: float, share: float) -> None:
    """FD-12b (i): of a way of 0.5 m the first half is free; never less than a tenth is left."""
    module = soft(limits__operation__flange_displacement__on=True)
    module.step(estimate(position=way, speed=0.01))
    assert limits(module) == pytest.approx((1.5 * share, 1.5 * share, 3.0 * share))
    module.step(estimate(position=way, speed=-0.01))
    assert limits(module)[0] == 1.5


@pytest.mark.parametrize("seed", range(10))
@pytest.mark.parametrize(("gone", "rest"), [(0.4, 1.0), (0.75, 0.5), (0.99, 0.1)])
def test_load_way_and_direction_lower_them_together(seed: int, gone: float, rest: float) -> None:
    """FD-12b: half of each with 4 kg, the rest of the way, and 0.4 along gravity, of a tilted base."""
    rng = np.random.default_rng(seed)
    start, up, way, tcp, elbow = rng.normal(size=(5, 3))
    up, way = up / np.linalg.norm(up), way / np.linalg.norm(way)

    def along(v: np.ndarray) -> float:
        return float(1.0 / np.sqrt(1.0 + (v @ up) ** 2 / (v @ v) * (1.0 / 0.4**2 - 1.0)))

    first = estimate(position=start.tolist())
    first.g_B = -9.81 * up
    rules = {"vertical": True, "vertical_share": 0.4, "payload_share": 0.25}
    changes = {"limits.operation.flange_displacement.on": True} | {f"soft.{name}": value for name, value in rules.items()}
    module = SoftLimits(apply(Settings(), changes), first)
    now = estimate(position=(start + gone * 0.5 * along(way) * way).tolist(), speed=(0.1 * way).tolist(), load_mass=4.0)
    for tool, link in ((tcp, elbow), (elbow, tcp)):
        now.tcp, now.elbow = np.append(start, tool), np.append(start, link)
        module.step(now)
        expected = (0.5 * rest * 1.5 * along(tool), 0.5 * rest * 1.5 * along(link), 0.5 * rest * 3.0)
        assert limits(module) == pytest.approx(expected)
    before = module.damping
    module.step(now)
    assert module.damping is before


def test_a_way_without_a_limit_has_no_end_and_directions_count_all_the_same() -> None:
    module = soft(soft__vertical=True, soft__vertical_share=0.4)
    for tcp, elbow in (([0.2, 0.0, 0.0], [0.0, 0.0, 0.1]), ([0.0, 0.0, 0.1], [0.2, 0.0, 0.0])):
        module.step(estimate(position=9.0, speed=0.01, tcp=[0.0, 0.0, 0.0, *tcp], elbow=[0.0, 0.0, 0.0, *elbow]))
        assert limits(module) == pytest.approx((0.6 if tcp[2] else 1.5, 0.6 if elbow[2] else 1.5, 3.0))


def test_a_hand_that_is_not_told_lowers_nothing() -> None:
    module = soft(soft__pushed=True)
    module.step(STILL)
    assert limits(module) == (1.5, 1.5, 3.0)


def test_the_more_it_accelerates_the_shorter_the_free_way() -> None:
    module = soft(limits__operation__flange_displacement__on=True, soft__acceleration=True, soft__acceleration_share=0.5)
    module.step(estimate(position=0.1875, speed=0.01))
    assert limits(module)[0] == 1.5
    module.step(estimate(position=0.1875, speed=0.01, acceleration=[0.0, 2.0, 0.0]))
    assert limits(module)[0] == pytest.approx(0.75)


def test_as_long_as_nothing_changes_it_is_the_same_object() -> None:
    module = soft()
    module.step(STILL)
    first = module.damping
    module.step(estimate(acceleration=3.0, load_mass=0.0))
    assert module.damping is first
