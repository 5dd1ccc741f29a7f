"""Resistance of walls (VW-7, VW-10): bounds, energy, and a hand that pushes in and comes out."""

import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from pendant.limits.resistance import LimitGuard, closeness, resisting
from pendant.tick.modes import TICK

distances = st.floats(-0.1, 0.1)
speeds = st.floats(-1.0, 1.0)
bands = st.floats(0.0, 0.1)
dampings = st.floats(0.0, 1000.0)


@pytest.mark.parametrize(
    ("distance", "band", "expected"),
    [(-0.03, 0.02, 0.0), (-0.02, 0.02, 0.0), (-0.015, 0.02, 0.25), (-0.01, 0.02, 0.5), (0.0, 0.02, 1.0), (0.5, 0.02, 1.0),
     (-1e-9, 0.0, 0.0), (0.0, 0.0, 1.0)],
)  # fmt: skip
def test_closeness(distance: float, band: float, expected: float) -> None:
    assert closeness(distance, band) == pytest.approx(expected)


@given(st.floats(0.0, 1.0), speeds, dampings)
def test_it_only_resists_and_never_more_than_damping(near: float, speed: float, damping: float) -> None:
    size = resisting(near, speed, damping)
    assert 0.0 <= size <= damping * max(speed, 0.0)
    if speed <= 0.0:
        assert size == 0.0


@given(st.floats(0.0, 0.99), st.floats(0.001, 1.0), st.floats(1.0, 1000.0))
def test_it_grows_towards_the_wall(near: float, speed: float, damping: float) -> None:
    assert resisting(near + 0.01, speed, damping) > resisting(near, speed, damping)


def test_it_is_whole_at_the_wall_and_half_half_way() -> None:
    assert resisting(1.0, 0.1, 200.0) == pytest.approx(20.0)
    assert resisting(0.5, 0.1, 200.0) == pytest.approx(10.0)


@given(st.lists(distances, min_size=1, max_size=50))
def test_a_part_is_held_at_the_innermost_place_since_it_went_out(path: list[float]) -> None:
    guard = LimitGuard(path[0])
    innermost = max(path[0], 0.0)
    for distance in path:
        innermost = min(innermost, max(distance, 0.0))
        assert guard.step(distance, 0.0) == distance - innermost


def test_a_wall_that_moves_over_a_part_lets_it_be() -> None:
    guard = LimitGuard(-0.01)
    assert guard.step(-0.005, 0.005) == -0.005
    assert guard.step(0.02, 0.025) == 0.0  # 0.02 of these count
    assert guard.step(0.03, 0.004) == pytest.approx(0.006)  # the part moved the rest by itself
    assert not guard.started_outside


def test_a_wall_that_moves_away_from_under_a_part_gives_it_no_room() -> None:
    guard = LimitGuard(-0.01)
    assert guard.step(0.02, 0.0) == 0.02
    assert guard.step(0.015, -0.005) == 0.015


def test_starting_outside_ends_inside() -> None:
    guard = LimitGuard(0.05)
    assert guard.started_outside
    guard.step(0.01, 0.0)
    assert guard.started_outside
    guard.step(0.0, 0.0)
    assert not guard.started_outside


@given(st.floats(-0.02, 0.02), speeds)
def test_beyond_the_border_it_never_pulls_outwards_and_the_way_back_is_free(beyond: float, speed: float) -> None:
    size = LimitGuard(0.0).resisting(beyond, speed, 4000.0, 200.0)
    assert size >= 0.0
    if speed <= 0.0 and beyond <= 0.0:
        assert size == 0.0


def test_the_guard_is_a_spring_with_a_damper() -> None:
    guard = LimitGuard(0.0)
    assert guard.resisting(0.01, 0.0, 4000.0, 200.0) == pytest.approx(40.0)
    assert guard.resisting(0.01, -0.1, 4000.0, 200.0) == pytest.approx(20.0)
    assert guard.resisting(0.01, -1.0, 4000.0, 200.0) == 0.0
    assert guard.resisting(0.01, 0.1, 4000.0, 200.0) == pytest.approx(60.0)
    assert guard.resisting(-0.01, 0.1, 4000.0, 200.0) == pytest.approx(20.0)


@given(
    st.floats(2.0, 10.0), st.floats(100.0, 3000.0), st.floats(5.0, 60.0), st.floats(0.05, 0.5), st.floats(0.005, 0.05),
    st.sampled_from([(4000.0, 200.0), (1000.0, 20.0), (20000.0, 400.0)]),
)  # fmt: skip
@settings(max_examples=60, deadline=None)
def test_a_hand_that_pushes_in_and_comes_out_gets_no_energy(
    mass: float, grip: float, damper: float, depth: float, band: float, guard_gains: tuple[float, float]
) -> None:
    """A mass as light as an arm gets, in a springy hand that moves 50 mm beyond a wall and back; the force comes a tick late."""
    stiffness, damping = guard_gains
    mass *= max(damping / 200.0, 1.0)  # a light part rings under a damper that is heavy for it, two ticks late
    guard = LimitGuard(-depth)
    x, v, work, force, step = -depth, 0.0, 0.0, 0.0, TICK / 5
    ticks = 1500
    for k in range(ticks):
        hand = -depth + (depth + 0.05) * 0.5 * (1.0 - math.cos(2.0 * math.pi * k / ticks))
        beyond = guard.step(x, 0.0)
        near = closeness(x, band)
        new = guard.resisting(beyond, v, stiffness, damping) if x > 0.0 else resisting(near, v, damping)
        # held for a tick, a tick late
        for _ in range(5):
            pull = grip * (hand - x) - damper * v
            v += step * (pull - force) / mass
            x += step * v
            work -= step * force * v
        force = min(new, 150.0)
    assert work <= 0.0


@given(st.floats(2.0, 10.0), st.floats(5.0, 60.0), st.floats(0.005, 0.05))
@settings(max_examples=30, deadline=None)
def test_a_part_that_is_pushed_comes_to_rest_where_the_spring_holds_the_push(mass: float, push: float, band: float) -> None:
    """Without any friction, from 0.3 m/s; the force comes a tick late."""
    guard = LimitGuard(-0.05)
    x, v, force, step, outermost = -0.05, 0.3, 0.0, TICK / 5, 0.0
    for _ in range(2000):
        beyond = guard.step(x, 0.0)
        new = guard.resisting(beyond, v, 4000.0, 200.0) if x > 0.0 else resisting(closeness(x, band), v, 200.0)
        for _ in range(5):
            v += step * (push - force) / mass
            x += step * v
        force = min(new, 150.0)
        outermost = max(outermost, x)
    assert x == pytest.approx(push / 4000.0, abs=1e-4)
    assert v == pytest.approx(0.0, abs=1e-3)
    assert outermost < push / 4000.0 + 0.025


@pytest.mark.parametrize(("distance", "outside"), [(-0.01, False), (0.0, False), (0.01, True)])
def test_who_started_outside_did_so_until_he_has_been_at_the_wall(distance: float, outside: bool) -> None:
    guard = LimitGuard(distance)
    assert guard.started_outside is outside
    guard.step(0.001, 0.0)
    assert guard.started_outside is outside
    guard.step(0.0, 0.0)
    assert guard.started_outside is False
