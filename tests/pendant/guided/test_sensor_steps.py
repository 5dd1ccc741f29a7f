"""Steps of the flange sensor are found, hands are not (FD-19)."""

import math

import numpy as np
import pytest

from pendant.guided.sensor_steps import (
    ANSWER,
    JUMP,
    LATER,
    LEAST,
    LEAST_MOVED,
    MOVED,
    NOISE,
    NOISE_OF_LOAD,
    QUIET,
    SOON,
    STRAY,
    Steps,
)
from pendant.guided.user_force import UserForce
from pendant.tick.pose import Vector
from tests.pendant.estimates import estimate

FIRST = 3
"""Ticks before a step: two are what it begins from, and in one it may come."""


def touch(force: Vector, spread: float = 0.0) -> UserForce:
    """What the flange feels in one tick, and how much it fluctuates [N]: a hand after its step."""
    hand = UserForce(estimate(), (0.0,) * 6)
    hand.change = force
    hand._spread = spread * spread
    return hand


def seen(steps: Steps, forces: list[Vector], felt: list[float] | None = None, mass: float = 0.0) -> list[Vector]:
    """What is taken off, for these forces; from the tick after the step on the joints feel `felt`."""
    joints = [[0.0] * 3] * (FIRST + 1) + [felt or [0.0] * 3] * (len(forces) - FIRST - 1)
    found = [
        steps.step(estimate(felt=by_joints, load_mass=mass), touch(force))
        for force, by_joints in zip(forces, joints, strict=True)
    ]
    return [step for step in found if step is not None]


def stepping(size: float, count: int = 20, before: float = 0.0) -> list[Vector]:
    return [(0.0, 0.0, before)] * FIRST + [(0.0, 0.0, before + size)] * count


def against(steps: list[Vector], share: float) -> list[float]:
    return [share * (now - then) for now, then in zip(steps[-1], steps[0], strict=True)]


@pytest.mark.parametrize(("size", "before"), [(JUMP, 0.0), (5.0, 0.0), (-20.0, 0.0), (60.0, 0.0), (20.0, QUIET)])
@pytest.mark.parametrize("share", [-0.5, 0.0, 0.999 * ANSWER])
def test_a_step_that_the_joints_do_not_feel_is_the_sensors(size: float, before: float, share: float) -> None:
    forces = stepping(size, LATER + 1, before)
    assert seen(Steps(), forces, against(forces, share)) == [(0.0, 0.0, pytest.approx(size))]


@pytest.mark.parametrize("share", [1.001 * ANSWER, 0.5, 1.0])
def test_a_step_that_the_joints_feel_is_a_hands(share: float) -> None:
    forces = stepping(20.0)
    assert seen(Steps(), forces, against(forces, share)) == []


@pytest.mark.parametrize(("ticks", "told"), [(2, True), (3, False)])
def test_of_what_the_joints_feel_the_mean_counts(ticks: int, told: bool) -> None:
    """In two of six ticks 0.8 of the step are less than 0.3 in the mean, in three more."""
    steps, found = Steps(), []
    for tick, force in enumerate(stepping(5.0, LATER + 1, 0.0)):
        felt = 0.8 * 5.0 if FIRST + LATER + 1 - ticks <= tick else 0.0
        found.append(steps.step(estimate(felt=[0.0, 0.0, felt]), touch(force)))
    assert (found[-1] is not None) is told


@pytest.mark.parametrize("axis", range(3))
@pytest.mark.parametrize(("stray", "told"), [(-9.3, True), (-9.4, False)])
def test_of_what_the_joints_felt_before_a_smoothed_value_counts(stray: float, told: bool, axis: int) -> None:
    """The last tick before has a fifth of the weight, less what the step's first takes of it; what they always feel has none."""
    steps, found = Steps(), []
    before = [4.0] * 40 + [4.0 + stray]
    for tick, size in enumerate([0.0] * 41 + [5.0] * (LATER + 1)):
        felt, force = [0.0] * 3, [0.0] * 3
        felt[axis], force[axis] = before[tick] if tick < 41 else 4.0, size
        found.append(steps.step(estimate(felt=felt), touch((force[0], force[1], force[2]))))
    assert (found[-1] is not None) is told


@pytest.mark.parametrize("size", [5.0, 9.0, 0.999 * LEAST_MOVED, LEAST_MOVED, -30.0])
@pytest.mark.parametrize("joint", range(6))
@pytest.mark.parametrize("speed", [0.999 * MOVED, MOVED, 1.001 * MOVED, -1.001 * MOVED])
def test_while_a_hand_moves_the_arm_only_large_ones_are_told(size: float, joint: int, speed: float) -> None:
    """A hand that guides shoves at once from hardly any force; how fast the help then moves the arm does not matter."""
    steps, found = Steps(), []
    for tick, force in enumerate(stepping(size, LATER + 1)):
        moving = [speed * (k == joint) * (tick <= FIRST) for k in range(6)]
        found.append(steps.step(estimate(felt=0.0, qd=moving), touch(force)))
    assert (found[-1] is not None) is (abs(size) >= (LEAST_MOVED if abs(speed) > MOVED else LEAST))


@pytest.mark.parametrize(("ticks", "told"), [(0, False), (1, False), (2, True), (3, True)])
def test_in_the_first_ticks_there_is_nothing_that_a_step_could_begin_from(ticks: int, told: bool) -> None:
    """A hand may have come in the tick of entry; it counts from the mean before."""
    forces = [(0.0, 0.0, 0.0)] * ticks + [(0.0, 0.0, 20.0)] * (LATER + 1)
    assert bool(seen(Steps(), forces)) is told


def test_it_is_judged_in_its_tick() -> None:
    forces = stepping(20.0, LATER)
    assert seen(Steps(), forces, against(forces, -0.5)) == []
    forces = stepping(20.0, LATER + 1)
    assert len(seen(Steps(), forces, against(forces, -0.5))) == 1


@pytest.mark.parametrize(("before", "size"), [(0.0, 0.99 * JUMP), (1.01 * QUIET, 20.0), (20.0, -20.0)])
def test_small_ones_and_those_of_a_hand_that_is_there_are_none(before: float, size: float) -> None:
    steps = Steps()
    assert seen(steps, [(0.0, 0.0, 0.01 * k * before) for k in range(101)]) == []
    forces = stepping(size, before=before)
    assert seen(steps, forces, against(forces, -0.5)) == []


def test_a_knock_and_a_hand_that_comes_are_none() -> None:
    quiet: list[Vector] = [(0.0, 0.0, 0.0)] * FIRST
    knock = [(0.0, 0.0, 20.0 * math.sin(math.pi * k / 10)) for k in range(11)]
    assert seen(Steps(), quiet + knock, [0.0, 0.0, -10.0]) == []
    grab = [(0.0, 0.0, 2.0 * k) for k in range(11)] + [(0.0, 0.0, 20.0)] * 20
    assert seen(Steps(), quiet + grab, [0.0, 0.0, -10.0]) == []


def test_its_size_is_the_mean_of_what_was_seen() -> None:
    stray = 0.9 * STRAY * 10.0
    forces = [(0.0, 0.0, 0.0)] * FIRST + [(0.0, 0.0, 10.0)] * 2 + [(0.0, 0.0, 10.0 + stray), (0.0, 0.0, 10.0 - stray)] * 3
    found = seen(Steps(), forces, [0.0, 0.0, -5.0])
    assert len(found) == 1
    assert found[0][2] == pytest.approx(10.0, abs=stray / LATER + 1e-9)


def test_after_a_step_the_next_one_is_found() -> None:
    steps = Steps()
    forces = stepping(10.0, LATER + 1)
    assert len(seen(steps, forces, [0.0, 0.0, -5.0])) == 1
    assert len(seen(steps, forces, [0.0, 0.0, -5.0])) == 1


@pytest.mark.parametrize("how", [{"acceleration": 2.0}, {"acceleration_valid": False}])
def test_a_step_that_shakes_the_flange_or_that_nobody_can_tell_from_one_that_does_is_a_hands(how: dict[str, float]) -> None:
    steps = Steps()
    forces = stepping(20.0)
    found = [
        steps.step(estimate(felt=[0.0, 0.0, -10.0 * (k > FIRST)], **(how if k > FIRST else {})), touch(force))  # type: ignore[arg-type]
        for k, force in enumerate(forces)
    ]
    assert found == [None] * len(forces)


@pytest.mark.parametrize(("quiet", "told"), [(SOON - 1, True), (SOON - 2, False)])
def test_help_that_comes_soon_shakes_the_flange_later_than_a_hand_does(quiet: int, told: bool) -> None:
    """A step of 20 N moves a light wrist within four ticks, as the help that it calls for does."""
    steps = Steps()
    found = [
        steps.step(estimate(felt=[0.0, 0.0, -10.0 * (k > FIRST)], acceleration=2.0 * (k > FIRST + quiet)), touch(force))
        for k, force in enumerate(stepping(20.0))
    ]
    assert any(step is not None for step in found) is told


@pytest.mark.parametrize("mass", [0.0, 5.0])
@pytest.mark.parametrize(("share", "told"), [(0.99, True), (1.0, True), (1.01, False)])
@pytest.mark.parametrize("strays", [1, 2, 3])
@pytest.mark.parametrize("axis", range(3))
def test_the_sensors_noise_does_not_hide_a_small_step(strays: int, share: float, told: bool, axis: int, mass: float) -> None:
    """A stray tick counts by half, two in a row count whole; the acceleration's noise is a force of what the load weighs."""
    stray = share * (STRAY * 5.0 + NOISE + NOISE_OF_LOAD * mass) * (2.0 if strays == 1 else 1.0)
    turned = [[0.0] * axis + [value] + [0.0] * (2 - axis) for value in (0.0, 5.0)]
    beside = [value + stray * (k == (axis + 1) % 3) for k, value in enumerate(turned[1])]
    forces = [(x, y, z) for x, y, z in (turned[0],) * FIRST + (turned[1],) * 2 + (beside,) * strays + (turned[1],) * 6]
    assert bool(seen(Steps(), forces, [-0.4 * value for value in turned[1]], mass)) is told


@pytest.mark.parametrize(("earlier", "told"), [(0.99, False), (1.01, True)])
def test_it_begins_from_the_mean_of_two_ticks(earlier: float, told: bool) -> None:
    """The noise in one alone hides small steps: 3.5 N from there on are one, and at most 2.5 N are quiet."""
    forces: list[Vector] = [(0.0, 0.0, z) for z in (-1.0, 1.0 - 2.0 * (earlier - 1.0) * JUMP, 0.0, *[JUMP] * (LATER + 1))]
    assert bool(seen(Steps(), forces, [0.0, 0.0, -2.0])) is told
    forces = [(0.0, 0.0, z) for z in (2.0 * QUIET / earlier - 1.0, 1.0, QUIET, *[20.0] * (LATER + 1))]
    assert bool(seen(Steps(), forces, [0.0, 0.0, -5.0])) is told


@pytest.mark.parametrize(("last", "told"), [(3.01, True), (3.0, True), (2.99, False)])
def test_a_step_that_fades_is_noise_upon_a_hands_first_touch(last: float, told: bool) -> None:
    """Its mean over six ticks is LEAST with a last one of 3 N."""
    forces: list[Vector] = [(0.0, 0.0, z) for z in (0.0, 0.0, 0.0, JUMP, JUMP, 3.4, 3.3, 3.3, 3.3, last)]
    assert sum([JUMP, 3.4, 3.3, 3.3, 3.3, 3.0]) == pytest.approx(LATER * LEAST)
    assert bool(seen(Steps(), forces, [0.0, 0.0, -2.0])) is told


def test_a_step_in_space_is_taken_off_as_the_mean_of_what_was_felt() -> None:
    rng = np.random.default_rng(1)
    step = np.array([6.0, -8.0, 4.0])
    felt = [(x, y, z) for x, y, z in (step + rng.uniform(-0.5, 0.5, (LATER + 1, 3))).tolist()]
    forces: list[Vector] = [(0.0, 0.0, 0.0)] * FIRST + felt
    assert seen(Steps(), forces, (-0.5 * step).tolist()) == [pytest.approx(np.mean(felt[1 : LATER + 1], axis=0))]


@pytest.mark.parametrize(
    ("acceleration", "when", "found"), [(1.51, 1, False), (1.51, SOON - 1, False), (1.51, SOON, True), (1.5, 1, True)]
)
def test_an_arm_that_is_shaken_just_then_was_knocked(acceleration: float, when: int, found: bool) -> None:
    """Beyond 1.5 m/s² within the first ticks, `when` after the step, even in one of them."""
    steps, forces = Steps(), stepping(20.0)
    joints = against(forces, -0.5)
    said = []
    for tick, force in enumerate(forces):
        shaken = acceleration if tick == FIRST + when else 0.0
        said.append(steps.step(estimate(felt=joints if tick > FIRST else 0.0, acceleration=shaken), touch(force)))
    assert any(step is not None for step in said) is found


@pytest.mark.parametrize(("spread", "told"), [(1.66, True), (1.67, False)])
def test_a_step_within_what_the_force_fluctuates_is_none(spread: float, told: bool) -> None:
    """Three times 1.67 N, as a load of 5 kg swings, hide 5 N."""
    steps = Steps()
    found = [steps.step(estimate(), touch(force, spread)) for force in stepping(5.0, LATER + 1)]
    assert (found[-1] is not None) is told


@pytest.mark.parametrize("axis", range(3))
@pytest.mark.parametrize(("less", "told"), [(0.0, False), (1e-9, True)])
def test_exactly_the_share_that_is_a_hands_is_a_hands(axis: int, less: float, told: bool) -> None:
    """All six ticks' worth comes in one; with 4 N, a power of two, nothing is rounded."""
    steps, found = Steps(), []
    for tick, force in enumerate(stepping(4.0, LATER + 1)):
        felt, along = [0.0] * 3, [0.0] * 3
        felt[axis] = (ANSWER * LATER * 4.0 - less) * (tick == FIRST + 3)
        along[axis] = force[2]
        found.append(steps.step(estimate(felt=felt), touch((along[0], along[1], along[2]))))
    assert (found[-1] is not None) is told
