"""When a wall is anchored again (VW-3 to VW-5)."""

from typing import NamedTuple

import numpy as np
import pytest

from pendant.tick.pose import Vector
from pendant.walls.anchors import MOVED, RESIDUAL, Anchor, Stay
from pendant.walls.definitions import Policy, Wall
from pendant.walls.shapes import Sphere

N = 100  # ticks of every period
PUSH = (0.0, 0.0, 8.0)
DOWN = (0.0, 0.0, -20.0)
NONE = (0.0, 0.0, 0.0)


class Tick(NamedTuple):
    z: float = 0.0  # height of the part
    user: Vector = NONE
    payload: Vector = NONE
    in_band: bool = False
    exceeded: bool = False
    outward: Vector = (0.0, 0.0, -1.0)


def run(policy: Policy, ticks: list[Tick], literal: bool = False, safety: int = N, redefine: int = N) -> tuple[Anchor, list[int]]:
    """The anchor after the ticks, and the ticks, from 1, in which it moved."""
    anchor = Anchor(Wall(name="w", shape=Sphere(radius=0.2), policy=policy, literal=literal, step=0.02), (0.0, 0.0, 0.0), N)
    moved, before = [], 0.0
    for k, tick in enumerate(ticks, 1):
        way = (0.0, 0.0, tick.z - before)
        stay = Stay((1.0, 0.0, tick.z), tick.outward, tick.in_band, tick.exceeded, way, tick.user, tick.payload, safety, redefine)
        if anchor.step(stay):
            moved.append(k)
        before = tick.z
    return anchor, moved


def path(end: float, ticks: int, start: float = 0.0, **values: object) -> list[Tick]:
    return [Tick(z=start + (end - start) * k / ticks, **values) for k in range(1, ticks + 1)]  # type: ignore[arg-type]


def test_fixed_stays() -> None:
    anchor, moved = run(Policy.FIXED, path(0.1, 5 * N, user=PUSH), literal=True)
    assert moved == []
    assert anchor.local == (0.0, 0.0, 0.0)


def test_stepwise_moves_at_the_end_of_each_period_to_where_the_part_is() -> None:
    anchor, moved = run(Policy.STEPWISE, path(0.3, 3 * N, user=PUSH))
    assert moved == [N, 2 * N, 3 * N]
    assert anchor.local == (1.0, 0.0, pytest.approx(0.3))


def one(at: int, **values: object) -> list[Tick]:
    """Two periods at rest, but for one tick."""
    return [Tick(**values) if k == at else Tick() for k in range(1, 2 * N + 1)]  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("ticks", "literal", "expected"),
    [
        (one(3), False, []),
        (one(3), True, [N, 2 * N]),
        (one(3, user=PUSH), False, [N]),
        (one(N, user=PUSH), False, [N]),
        (one(N + 1, user=PUSH), False, [2 * N]),
        (one(3, user=(0.0, 0.0, 7.99)), False, []),
        (one(3, user=(-6.0, 6.0, 0.0)), False, [N]),
        # exceeded in the period; in the second one, the whole safety period before its end is clear
        ([*one(3, exceeded=True, user=PUSH)[:N], *[Tick(user=PUSH)] * N], False, [2 * N]),
        ([*one(3, exceeded=True)[:N], *[Tick()] * N], True, [2 * N]),
        ([Tick(user=PUSH, in_band=k >= N - 1) for k in range(N)], False, []),
        ([Tick(user=PUSH, in_band=k < N - 1) for k in range(N)], False, [N]),
        ([Tick(in_band=True)] * N, True, [N]),
        # a load that falls, one that is lifted, one lifted too little, none to speak of
        (path(-0.1, N, payload=DOWN), False, []),
        (path(-0.1, N, payload=DOWN), True, [N]),
        (path(1.01 * MOVED, N, payload=DOWN), False, [N]),
        (path(0.99 * MOVED, N, payload=DOWN), False, []),
        ([Tick(z=MOVED, payload=(0.0, 0.0, -4.0))] * N, False, [N]),  # to the limit itself, in one tick
        (path(0.1, N, payload=(0.0, 0.0, -0.99 * RESIDUAL)), False, []),
        (path(0.1, N, payload=(0.0, 0.0, -1.01 * RESIDUAL)), False, [N]),
        # up and down again: where it began
        ([*path(0.1, N // 2, payload=DOWN), *path(0.0, N // 2, 0.1, payload=DOWN)], False, []),
        # lifted in two periods together, in none enough
        (path(1.8 * MOVED, 2 * N, payload=DOWN), False, []),
    ],
)
def test_stepwise_needs_somebody(ticks: list[Tick], literal: bool, expected: list[int]) -> None:
    assert run(Policy.STEPWISE, ticks, literal)[1] == expected


def test_stepwise_with_a_shorter_redefine_period_still_waits_for_a_clear_safety_period() -> None:
    ticks = [Tick(user=PUSH, exceeded=k == 5) for k in range(1, 201)]
    assert run(Policy.STEPWISE, ticks, safety=100, redefine=40)[1] == [120, 160, 200]
    assert run(Policy.STEPWISE, [Tick(user=PUSH)] * 200, safety=100, redefine=40)[1] == [120, 160, 200]
    assert run(Policy.STEPWISE, [Tick(user=PUSH)] * 200, safety=40, redefine=100)[1] == [100, 200]
    assert run(Policy.STEPWISE, [Tick(user=PUSH)] * 200, safety=100, redefine=99)[1] == [198]


@pytest.mark.parametrize("axis", range(3))
@pytest.mark.parametrize("way", [1.0, -1.0])
@pytest.mark.parametrize(
    ("force", "moved", "payload", "anew"),
    [(8.0, 0.001, 0.0, True), (8.0, -0.001, 0.0, False), (0.0, 0.006, -20.0, True), (0.0, -0.006, -20.0, False),
     (0.0, 0.006, -RESIDUAL, True)],
)  # fmt: skip
def test_somebody_drives_along_the_force_or_against_the_residual_in_every_axis(
    axis: int, way: float, force: float, moved: float, payload: float, anew: bool
) -> None:
    anchor = Anchor(Wall(name="w", shape=Sphere(radius=0.2), policy=Policy.STEPWISE), NONE, N)

    def along(size: float) -> Vector:
        x, y, z = (way * size if k == axis else 0.0 for k in range(3))
        return x, y, z

    assert anchor.step(Stay(NONE, (0.0, 0.0, -1.0), False, False, along(moved), along(force), along(payload), 1, 1)) is anew


@pytest.mark.parametrize("led", [True, False])
@pytest.mark.parametrize(("policy", "out"), [(Policy.STEPWISE, 0.001), (Policy.AVERAGE, 0.001), (Policy.USER, -0.03)])
def test_who_pays_for_the_motion_drives_the_part_though_no_force_is_felt(policy: Policy, out: float, led: bool) -> None:
    """The way that the user policy counts leads away from the wall."""
    anchor = Anchor(Wall(name="w", shape=Sphere(radius=0.2), policy=policy, step=0.02), NONE, 1)
    stay = Stay(NONE, (0.0, 0.0, -1.0), False, False, (0.0, 0.0, -out), NONE, NONE, 1, 1, led)
    assert anchor.step(stay) is led


def test_average_follows_the_mean_of_the_last_period() -> None:
    anchor, moved = run(Policy.AVERAGE, path(0.3, 3 * N, user=PUSH))
    assert moved == list(range(1, 3 * N + 1))
    assert anchor.local == (pytest.approx(1.0), 0.0, pytest.approx(sum(0.001 * k for k in range(201, 301)) / N))
    anchor, _ = run(Policy.AVERAGE, path(0.05, N // 2, user=PUSH))
    assert anchor.local[2] == pytest.approx(sum(0.001 * k for k in range(1, 51)) / 50)


def test_the_mean_is_of_the_last_period_in_every_axis() -> None:
    places = np.random.default_rng(1).normal(0.0, 0.1, (20, 3))
    anchor = Anchor(Wall(name="w", shape=Sphere(radius=0.2), policy=Policy.AVERAGE), NONE, 7)
    for end, (x, y, z) in enumerate(places.tolist(), 1):
        assert anchor.step(Stay((x, y, z), (0.0, 0.0, -1.0), False, False, NONE, PUSH, NONE, N, N))
        assert anchor.local == pytest.approx(places[max(end - 7, 0) : end].mean(axis=0))


def test_average_needs_somebody_in_the_last_period() -> None:
    assert run(Policy.AVERAGE, one(3))[1] == []
    assert run(Policy.AVERAGE, one(3), literal=True)[1] == list(range(1, 2 * N + 1))
    assert run(Policy.AVERAGE, one(3, user=PUSH))[1] == list(range(3, N + 3))
    assert run(Policy.AVERAGE, [Tick(user=PUSH, in_band=k != 7) for k in range(N)])[1] == [8]
    assert run(Policy.AVERAGE, path(-0.1, 3 * N, payload=DOWN))[1] == []
    # so far itself, in one tick
    assert run(Policy.AVERAGE, [Tick(z=MOVED, payload=(0.0, 0.0, -4.0))] * 2 * N)[1] == list(range(1, N + 1))
    # after the first 5 mm the rest of the lift, and until the way up has left the period
    assert run(Policy.AVERAGE, [*path(0.11, N, payload=DOWN), *[Tick(z=0.11, payload=DOWN)] * N])[1] == list(range(5, 2 * N - 4))


def test_average_keeps_following_a_hand_for_the_safety_period() -> None:
    assert run(Policy.AVERAGE, one(3, user=PUSH), safety=40)[1] == list(range(3, 43))


@pytest.mark.parametrize("policy", [Policy.STEPWISE, Policy.AVERAGE])
def test_a_force_against_the_motion_is_no_hand_that_moves_the_part(policy: Policy) -> None:
    """A wrong payload that gathers speed looks like that: its inertia is a force against the motion."""
    assert run(policy, path(-0.3, 3 * N, user=PUSH))[1] == []
    assert run(policy, [Tick(user=PUSH)] * 3 * N)[1] != []


def test_average_waits_for_a_period_without_exceeding() -> None:
    ticks = [Tick(user=PUSH, exceeded=k == 10) for k in range(1, 2 * N + 1)]
    assert run(Policy.AVERAGE, ticks)[1] == [*range(1, 10), *range(N + 10, 2 * N + 1)]


def test_user_moves_once_pushed_away_from_the_wall_by_the_step() -> None:
    anchor, moved = run(Policy.USER, path(0.0473, 43, user=PUSH))
    assert moved == [19, 38]
    assert anchor.local == (1.0, 0.0, pytest.approx(0.0418))
    assert run(Policy.USER, [Tick(z=0.02, user=PUSH)])[1] == [1], "the step itself is enough"


@pytest.mark.parametrize(
    "ticks",
    [
        path(0.1, N),  # nobody
        path(0.1, N, payload=DOWN),
        path(0.1, N, user=(0.0, 0.0, 7.9)),  # too weak
        path(0.1, N, user=(9.0, 0.0, 0.0)),  # pushed along it
        path(0.1, N, user=(0.0, 0.0, -30.0)),  # pushed to the wall, whatever moved it
        path(-0.1, N, user=PUSH),  # towards the wall
        path(0.1, N, user=PUSH, outward=(0.0, 0.0, 1.0)),
        path(0.1, N, user=PUSH, outward=(1.0, 0.0, 0.0)),  # along it
        path(0.1, N, user=PUSH, exceeded=True),
        [*path(0.019, 19, user=PUSH), *path(0.0, 19, 0.019), *path(0.019, 19, user=PUSH)],  # back between
        [*path(0.019, 19, user=PUSH), Tick(z=0.019, exceeded=True), *path(0.038, 19, 0.019, user=PUSH)],  # and out
    ],
)
def test_user_moves_at_nothing_else(ticks: list[Tick]) -> None:
    assert run(Policy.USER, ticks, literal=True)[1] == []


def test_user_ways_add_up_over_pauses() -> None:
    ticks = [*path(0.0132, 12, user=PUSH), *[Tick(z=0.0132)] * N, *path(0.0264, 12, 0.0132, user=PUSH)]
    assert run(Policy.USER, ticks)[1] == [N + 19]
