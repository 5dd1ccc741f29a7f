"""Whether what followed a suspected change of the payload goes on as it would (FD-19)."""

import math

import numpy as np
import pytest
from numpy.typing import NDArray

from app.files.library import load_arm
from pendant.sensor.hand_model import GRIP_LEVER, LARGEST, TREMOR
from pendant.sensor.odds import KNOWN, SUSPECTED
from pendant.tick.estimate import GRAVITY
from sim.arm.chain import Body, chain
from sim.flange.external_wrench import KEPT, ExternalWrench
from sim.flange.fall_answer import FallAnswer, follow
from sim.flange.flange_forces import FlangeForces
from sim.flange.wrench_hypotheses import LATE, LONGEST, RARE, noise
from sim.rigid_body.dynamics import Dynamics

Array = NDArray[np.float64]
UR5E = load_arm("ur5e")
PAYLOAD = Body(0.3, np.array([0.0, 0.0, 0.05]), np.eye(3) * 0.0005)
NOISE = np.array([0.15, 0.15, 0.15, 0.006, 0.006, 0.006])
WEIGHT = PAYLOAD.mass * GRAVITY
NEEDS = np.array([0.0, 0.0, WEIGHT, 0.0, 0.0, 0.0])
ZERO = (0.0,) * 6
TURNED = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
"""The flange's x axis is B's y."""


class Change:
    """What a test wants the bank of hypotheses to tell, and what is measured."""

    def __init__(self, seed: int = 0) -> None:
        rigid = chain(UR5E)
        dynamics = Dynamics(rigid, rigid.links, PAYLOAD, mounting=[0.0] * 3, elbow=UR5E.chain.elbow)
        self.wrench = ExternalWrench(UR5E, FlangeForces(dynamics))
        self.wrench.set_load(PAYLOAD, PAYLOAD)
        self.own = self.wrench.record[0]
        self.own["R"] = TURNED
        self.answer = FallAnswer()
        self.told = self.answer.record[0]
        self.rng = np.random.default_rng(seed)

    def tick(self, x: Array, p: Array = NEEDS, *, odds: float = -math.inf, age: int = 0, bias: tuple[float, ...] = ZERO) -> float:
        """The wrench `x` is missing, the payload needs `p`, axes of F; the window tells these odds of a change of this age."""
        own, here = self.own, self.own["next"]
        own["x"][here] = x + NOISE * self.rng.normal(size=6) + bias
        own["p"][here, :6] = p
        own["next"] = (here + 1) % KEPT
        own["lost"], own["lost_age"], own["share"] = odds, age, 1.0 if age else 0.0
        follow(self.answer.record, self.wrench.record, bias)
        return float(self.told["odds"])

    def begin(self, odds: float = 8.0, *, age: int = LONGEST, x: Array = NEEDS) -> float:
        """A change whose last tick in sight is this one."""
        for _ in range(LONGEST - 1):
            assert self.tick(x) == -math.inf
        return self.tick(x, odds=odds, age=age)


@pytest.mark.parametrize("seed", range(5))
def test_a_payload_that_is_gone_stays_gone(seed: int) -> None:
    change = Change(seed)
    assert change.begin(SUSPECTED) == SUSPECTED
    assert change.told["share"] == 1.0
    told = [change.tick(NEEDS) for _ in range(4 * LONGEST)]
    assert told[: LONGEST - 1] == [SUSPECTED] * (LONGEST - 1), "a mean is compared once it is whole"
    assert told[-1] > KNOWN


@pytest.mark.parametrize("seed", range(5))
def test_it_is_missed_as_the_arm_swings(seed: int) -> None:
    """What a payload needs grows with the arm's acceleration; where x does not, it is a hand's."""
    change, hand = Change(seed), Change(seed)
    change.begin()
    hand.begin()
    told = [(change.tick(1.4 * NEEDS, 1.4 * NEEDS), hand.tick(NEEDS, 1.4 * NEEDS)) for _ in range(LONGEST)]
    assert told[-1][0] > 8.0
    assert told[-1][1] == -math.inf


@pytest.mark.parametrize("seed", range(5))
def test_a_hand_is_not_as_even(seed: int) -> None:
    change = Change(seed)
    change.begin(KNOWN - 1.0)
    moved = np.concatenate([TREMOR * np.array([1.0, -1.0, 0.5]), np.zeros(3)])
    told = [change.tick(NEEDS + moved) for _ in range(LONGEST)]
    assert told[-1] == -math.inf, "nothing is followed any more"
    assert change.tick(NEEDS) == -math.inf


def test_the_ratio_is_that_of_the_densities() -> None:
    change = Change(3)
    change.begin()
    before = float(change.told["odds"])
    x = NEEDS + np.array([0.1, -0.2, 0.15, 0.01, 0.0, -0.005])
    p = NEEDS + np.array([0.05, -0.1, 0.1, 0.005, 0.0, 0.0])
    places = [(change.own["next"] - 1 - age) % KEPT for age in range(LONGEST)]
    first = [(change.own["x"][k].copy(), change.own["p"][k, :6].copy()) for k in places]
    change.tick(x, p)
    for _ in range(LONGEST - 1):
        change.tick(x, p)
    places = [(change.own["next"] - 1 - age) % KEPT for age in range(LONGEST)]
    then = [(change.own["x"][k], change.own["p"][k, :6]) for k in places]
    means = [np.mean([one - share * other for one, other in some], axis=0) for share in (1.0, 0.0) for some in (first, then)]
    fallen, held = means[1] - means[0], means[3] - means[2]
    lever = np.array([1.0] * 3 + [GRIP_LEVER] * 3)
    R = np.array([2.0 * noise(change.own, change.own["whole"], axis, LATE) / LONGEST for axis in (0, 0, 0, 1, 1, 1)])
    V, H = R + (TREMOR * lever) ** 2, R + (0.5 * LARGEST * lever) ** 2

    def density(d: Array, variance: Array) -> float:
        return float(np.prod(np.exp(-0.5 * d * d / variance) / np.sqrt(2.0 * math.pi * variance)))

    comes = LONGEST * RARE
    payload = (1.0 - comes) * density(fallen, R) + comes * density(fallen, H)
    hand = 0.5 * density(held, V) + 0.5 * density(held, H)
    assert change.told["odds"] - before == pytest.approx(math.log(payload / hand), rel=1e-6)


def test_a_hand_that_comes_after_it_says_little() -> None:
    change = Change()
    change.begin(12.0)
    told = [change.tick(NEEDS + np.array([15.0, 0.0, 0.0, 0.0, 1.5, 0.0])) for _ in range(LONGEST)]
    assert told[-1] == pytest.approx(12.0 + math.log(2.0 * LONGEST * RARE), abs=0.2)


@pytest.mark.parametrize(
    ("odds", "age", "follows"),
    [
        (SUSPECTED, LONGEST, True),
        (math.nextafter(SUSPECTED, 0.0), LONGEST, False),
        (math.nextafter(KNOWN, 0.0), LONGEST, True),
        (KNOWN, LONGEST, False),
        (8.0, LONGEST - 1, False),
    ],
)
def test_a_suspected_change_is_followed_once_it_leaves_the_window(odds: float, age: int, follows: bool) -> None:
    change = Change()
    assert change.begin(odds, age=age) == odds
    assert (change.tick(NEEDS) == odds) is follows


def test_what_the_window_tells_meanwhile_counts_if_it_is_surer() -> None:
    change = Change()
    change.begin()
    assert change.tick(NEEDS, odds=9.0, age=3) == 9.0
    assert change.tick(NEEDS, odds=7.0, age=4) == 8.0


def test_the_bias_and_its_turn_are_no_change() -> None:
    """A bias is what nobody pulls; a wrench that stays in B while the flange turns is the same."""
    change, bias = Change(1), (3.0, -2.0, 1.0, 0.1, 0.2, 0.3)
    force = np.array([2.0, 0.0, WEIGHT, 0.0, 0.0, 0.0])  # axes of B
    lie = TURNED.T @ force[:3]
    for k in range(LONGEST):
        last = k == LONGEST - 1
        change.tick(np.array([*lie, 0.0, 0.0, 0.0]), odds=8.0 if last else -math.inf, age=LONGEST if last else 0, bias=bias)
    change.own["R"][:] = np.eye(3)
    # What was before stands in the answer already, turned.
    for _ in range(LONGEST):
        change.tick(force, bias=bias)
    assert change.told["odds"] > 8.0


def test_what_is_forgotten_is_followed_no_more() -> None:
    change = Change()
    change.begin()
    change.answer.forget()
    assert (change.told["odds"], change.told["share"]) == (-math.inf, 0.0)
    assert change.tick(NEEDS) == -math.inf
