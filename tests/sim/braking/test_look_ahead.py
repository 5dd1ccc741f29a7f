"""A plan that leads out is stopped on its path at the border, within what the joints can; one that does not is left as it is."""

import math
from collections.abc import Callable

import numpy as np
import pytest

from pendant.tick.modes import TICK
from pendant.walls.workspace import TOLERANCE, OutwardLimits
from sim.braking.look_ahead import LookAhead
from sim.braking.stopping_distance import StoppingDistance

SPEED, BRAKING = 1.0, 2.0  # of the only joint [rad/s], [rad/s²] on average
STOPPING = StoppingDistance(lambda q, qd: float(np.abs(qd).max()) / BRAKING, 0.08, 0.01)


class Ramp:
    """A plan of one joint: it gains speed within `gains`, goes on evenly and ends at `end`."""

    def __init__(self, end: float = 2.0, gains: float = 0.3, begun: float = 0.0) -> None:
        self.end, self.gains, self.time, self.done = end, gains, begun, False

    def at(self, time: float) -> float:
        return SPEED * (0.5 * time * time / self.gains if time < self.gains else time - 0.5 * self.gains)

    def step(self, rate: float = 1.0) -> tuple[np.ndarray, np.ndarray]:
        before = min(self.at(self.time), self.end)
        self.time += rate * TICK
        now = min(self.at(self.time), self.end)
        self.done = now >= self.end
        return np.array([now]), np.array([(now - before) / TICK])


def limits(distance: float) -> OutwardLimits:
    made = OutwardLimits(1)
    made.begin([distance])
    return made


def play(
    plan: Ramp, out: Callable[[float], float], rates: Callable[[int], float] = lambda _: 1.0
) -> tuple[list[float], LookAhead]:
    """Angles in each tick until the plan is done or stopped."""
    look = LookAhead(plan, limits(out(plan.at(plan.time))), lambda q: [out(float(q[0]))], STOPPING)
    angles = [plan.at(plan.time)]
    for k in range(20000):
        rate = look.rate(rates(k))
        assert 0.0 <= rate <= rates(k)
        angles.append(float(plan.step(rate)[0][0]))
        if plan.done or look.stopped is not None:
            break
    return angles, look


def test_a_plan_that_stays_inside_is_as_it_was() -> None:
    angles, look = play(Ramp(), lambda q: q - 2.0 - 0.5 * TOLERANCE)
    plan, count = Ramp(), 0
    while not plan.done:
        plan.step()
        count += 1
    assert len(angles) == count + 1
    assert look.stopped is None


@pytest.mark.parametrize("at", [0.02, 0.1, 0.5, 1.5])
@pytest.mark.parametrize("rate", [1.0, 0.3, 0.05])
def test_one_that_leads_out_stands_at_the_border(at: float, rate: float) -> None:
    angles, look = play(Ramp(), lambda q: q - at, lambda _: rate)
    assert look.stopped == 0
    assert at - 2.0 * rate * TICK < angles[-1] == max(angles) <= at + TOLERANCE


@pytest.mark.parametrize("rate", [1.0, 0.5])
def test_it_brakes_no_harder_than_the_joints_can_and_without_a_step(rate: float) -> None:
    angles, _ = play(Ramp(), lambda q: q - 1.5, lambda _: rate)
    qdd = np.diff(np.diff(angles)) / TICK**2
    braking = qdd[qdd < 0.0]
    assert -braking.min() < 1.05 * 0.5 * math.pi * BRAKING  # half a cosine's peak over its mean
    assert np.abs(np.diff(braking)).max() < 0.15 * BRAKING


def test_a_border_within_the_first_ticks_is_not_gone_beyond() -> None:
    angles, look = play(Ramp(), lambda q: q - 1e-5)
    assert look.stopped == 0
    assert max(angles) < TOLERANCE
    angles, look = play(Ramp(), lambda q: q + 0.01)
    assert look.stopped == 0
    assert max(angles) < TOLERANCE


def test_an_arm_that_moved_already_brakes_as_hard_as_it_can() -> None:
    """A plan that goes on from a moving arm may begin too near a border."""
    angles, look = play(Ramp(begun=1.0), lambda q: q - 0.87)
    assert look.stopped == 0
    qdd = np.diff(np.diff(angles)) / TICK**2
    assert -qdd.min() < 1.05 * 0.5 * math.pi * 0.5 * math.pi * BRAKING


def test_a_plan_along_a_border_is_let_go_on() -> None:
    angles, look = play(Ramp(), lambda q: 0.0005 * math.sin(20.0 * q))
    assert look.stopped is None
    assert angles[-1] == 2.0


def test_from_beyond_a_border_it_may_come_back_but_not_go_out_again() -> None:
    """VW-10."""
    angles, look = play(Ramp(), lambda q: 0.3 - q)
    assert look.stopped is None
    assert angles[-1] == 2.0
    angles, look = play(Ramp(), lambda q: 0.1 + abs(q - 0.5))
    assert look.stopped == 0
    assert angles[-1] == pytest.approx(0.5, abs=4e-3)
    angles, look = play(Ramp(), lambda q: 0.1 + q)
    assert look.stopped == 0
    assert angles[-1] < 2.0 * TOLERANCE


def test_what_slows_it_down_more_meanwhile_goes_first_and_it_still_stands_at_the_border() -> None:
    """REDUCED comes while it brakes."""
    begun = next(k for k, angle in enumerate(play(Ramp(), lambda q: q - 1.5)[0]) if angle > 1.4)
    angles, look = play(Ramp(), lambda q: q - 1.5, lambda k: 1.0 if k < begun else max(0.05, 1.0 - 0.008 * (k - begun) - 0.6))
    assert look.stopped == 0
    assert angles[-1] == pytest.approx(1.5, abs=3e-3)


def test_the_look_is_of_a_copy() -> None:
    plan = Ramp()
    LookAhead(plan, limits(-1.0), lambda q: [float(q[0]) - 1.0], STOPPING).rate(1.0)
    assert plan.time == 0.0
