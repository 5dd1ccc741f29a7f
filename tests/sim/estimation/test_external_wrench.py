"""The bank of hypotheses at the flange: likelihoods against the whole Gaussian, and what it thinks of plain cases."""

import math

import numpy as np
import pytest
from numpy.typing import NDArray

from app.files.library import load_arm
from pendant.guided.endings import KNOWN, ONSETS
from pendant.tick.estimate import GRAVITY
from sim.arm.chain import Body, chain
from sim.estimation import wrench_hypotheses as bank
from sim.estimation.external_wrench import KEPT, LONGEST, SHORTEST, ExternalWrench
from sim.estimation.flange_forces import FlangeForces
from sim.estimation.wrench_hypotheses import BEFORE, FREED, LATE, LEVER, LOST, MORE
from sim.rigid_body.dynamics import Dynamics

Array = NDArray[np.float64]
UR5E = load_arm("ur5e")
PAYLOAD = Body(2.0, np.array([0.01, -0.02, 0.05]), np.eye(3) * 0.002)
TOOL = Body(0.5, np.array([0.0, 0.0, 0.03]), np.eye(3) * 0.0005)
UP = np.array([0.0, 0.0, GRAVITY])
NO_BIAS = (0.0,) * 6
WEIGHT = PAYLOAD.mass * GRAVITY
NEEDS = np.concatenate([PAYLOAD.mass * UP, np.cross(PAYLOAD.com, PAYLOAD.mass * UP)])


class Arm:
    """An arm whose flange feels what a test wants."""

    def __init__(self, seed: int = 0) -> None:
        rigid = chain(UR5E)
        self.forces = FlangeForces(Dynamics(rigid, rigid.links, TOOL + PAYLOAD, mounting=[0.0] * 3, elbow=UR5E.chain.elbow))
        self.wrench = ExternalWrench(UR5E, self.forces)
        self.wrench.set_load(TOOL + PAYLOAD, PAYLOAD)
        self.rng = np.random.default_rng(seed)
        self.odds: list[float] = []

    def tick(self, x: Array, specific: Array = UP, bias: tuple[float, ...] | None = NO_BIAS) -> float:
        """The wrench `x` that is missing at the flange while it feels a `specific` force."""
        own, load = self.forces.record[0], TOOL + PAYLOAD
        noise = self.rng.normal(size=6) * [0.15, 0.15, 0.15, 0.006, 0.006, 0.006]
        shaking = 0.1 * load.mass * self.rng.normal(size=3)  # of the accelerometer that weighs the load
        noise += np.concatenate([shaking, np.cross(load.com, shaking)])
        own["missing"], own["specific"], own["gyro"], own["turn"] = x + noise, specific + shaking / load.mass, 0.0, 0.0
        self.wrench.update(bias)
        self.odds.append(self.wrench.lost)
        return self.wrench.lost

    def course(self, xs: list[Array]) -> float:
        """After a quiet time; the best odds meanwhile."""
        for _ in range(30):
            self.tick(xs[0])
        return max(self.tick(x) for x in xs)


def steady(x: Array, ticks: int = 20) -> list[Array]:
    return [x] * ticks


def rising(x: Array, ticks: int) -> list[Array]:
    """A hand whose force comes within so many ticks, and stays."""
    return [np.zeros(6), *(x * (k + 1) / ticks for k in range(ticks)), *steady(x)]


def falls(share: float = 1.0, hand: Array | None = None) -> list[Array]:
    held = np.zeros(6) if hand is None else hand
    return [held, *steady(held + share * NEEDS)]


@pytest.mark.parametrize("seed", range(5))
def test_a_payload_that_falls_is_known(seed: int) -> None:
    arm = Arm(seed)
    assert arm.course(falls()) > KNOWN
    first = next(k for k, odds in enumerate(arm.odds[30:]) if odds > KNOWN)
    assert first <= 8, "ticks: 20 ms with the sensor's delay"


@pytest.mark.parametrize("seed", range(5))
def test_it_is_known_beside_a_hand_that_stays(seed: int) -> None:
    assert Arm(seed).course(falls(hand=np.array([8.0, -5.0, 3.0, 0.3, 0.2, 0.0]))) > KNOWN


@pytest.mark.parametrize("seed", range(5))
def test_it_is_known_when_the_hand_goes_with_it(seed: int) -> None:
    assert Arm(seed).course([np.array([12.0, 0.0, 0.0, 0.0, 0.5, 0.0]), *steady(NEEDS)]) > KNOWN


@pytest.mark.parametrize("ticks", [5, 10, 25])
@pytest.mark.parametrize("seed", range(5))
def test_a_hand_that_comes_to_carry_the_payload_is_a_hand(seed: int, ticks: int) -> None:
    assert Arm(seed).course(rising(NEEDS, ticks)) < 0.6 * KNOWN


@pytest.mark.parametrize("seed", range(5))
def test_a_hand_that_lets_go_is_no_payload(seed: int) -> None:
    assert Arm(seed).course([-NEEDS, *steady(np.zeros(6))]) < 0.6 * KNOWN, "although the wrench changes by the payload's"


@pytest.mark.parametrize("force", [(WEIGHT, 0.0, 0.0), (0.0, -WEIGHT, 0.0), (0.0, 0.8 * WEIGHT, 0.6 * WEIGHT)])
def test_a_step_that_is_no_payloads_is_none(force: tuple[float, float, float]) -> None:
    assert Arm().course([np.zeros(6), *steady(np.array([*force, 0.0, 0.0, 0.0]))]) < 0.6 * KNOWN


def test_an_arm_that_stands_cannot_tell_a_carried_payload_from_one_that_is_gone() -> None:
    """What the bank cannot know: the hand went in the moment in which the payload fell that it carried."""
    assert Arm().course(steady(NEEDS, 60)) < KNOWN


def test_the_share_that_fell_is_told() -> None:
    arm, shares = Arm(), []
    for x in [np.zeros(6)] * 30 + [NEEDS] * 8:
        if arm.tick(x) > KNOWN:
            shares.append(arm.wrench.share)
    assert shares[-1] == pytest.approx(1.0, abs=0.05)


def test_a_payload_that_comes_on_top_is_another() -> None:
    """FD-19: the load weighs half as much again."""
    arm = Arm()
    assert arm.course([np.zeros(6), *steady(-0.5 * NEEDS)]) > KNOWN


def test_nothing_is_said_before_there_is_enough_to_compare() -> None:
    arm = Arm()
    for _ in range(KEPT - 1):
        assert arm.tick(NEEDS) == -math.inf
    assert arm.tick(NEEDS) >= 0.0
    assert arm.tick(NEEDS, bias=None) == -math.inf
    assert arm.tick(NEEDS) == -math.inf, "it begins afresh"


def test_so_many_onsets_are_compared_as_the_decision_reckons_with() -> None:
    assert LONGEST - SHORTEST + 1 == ONSETS


def test_without_a_payload_nothing_can_be_lost() -> None:
    arm = Arm()
    arm.wrench.set_load(TOOL, Body(0.0, np.zeros(3), np.zeros((3, 3))))
    assert arm.course(falls()) == -math.inf


def dense(x: Array, mean: Array | float, covariance: Array) -> float:
    """Log density of a Gaussian without its constant of 2 pi."""
    off = x - mean
    return float(-0.5 * off @ np.linalg.solve(covariance, off) - 0.5 * np.linalg.slogdet(covariance)[1])


@pytest.mark.parametrize("seed", range(6))
def test_the_likelihoods_are_those_of_the_whole_gaussians(seed: int) -> None:
    """The closed forms against the covariance of all ticks of a change, written out; payloads come and go as the arm shakes."""
    arm, rng = Arm(seed), np.random.default_rng(seed)
    share = (1.0, 0.9, -0.5)[seed % 3]
    for tick in range(KEPT + 5):
        lift = rng.normal(size=3)
        needs = PAYLOAD.mass * np.concatenate([UP + lift, np.cross(PAYLOAD.com, UP + lift)])
        arm.tick(share * needs if tick > KEPT - 3 else 0.1 * rng.normal(size=6), UP + lift)
    assert arm.wrench.lost > 3.0
    own = arm.wrench.record[0]
    here = (int(own["next"]) - 1) % KEPT
    x, p = (np.stack([own[name][(here - k) % KEPT] for k in reversed(range(KEPT))]) for name in ("x", "p"))
    best = max(of_change(x, p, length) for length in range(SHORTEST, LONGEST + 1))
    assert arm.wrench.lost == pytest.approx(best, rel=1e-9)


def of_change(x: Array, p: Array, length: int) -> float:
    """The best odds of a payload that changed so many ticks ago; the arm does not turn."""
    start = KEPT - length
    after, needs, earlier = x[start:], p[start:], x[start - 1 - BEFORE : start - 1]
    x0 = earlier.mean(axis=0)
    slopes = (earlier[2:].sum(axis=0) - earlier[:2].sum(axis=0)) / BEFORE
    eye, ones, rise = np.eye(length), np.ones((length, length)), np.arange(1, length + 1) + 0.5
    hands = dict.fromkeys(("rising", "steady", "nobody"), 0.0)
    anything = credit = 0.0
    jumps: list[float] = []
    parts: dict[int, list[Array]] = {kind: [] for kind in (LOST, FREED, MORE)}
    covariances: dict[int, list[Array]] = {kind: [] for kind in (LOST, FREED, MORE)}
    for k in range(6):
        axis = k // 3
        lever = 1.0 if axis == 0 else LEVER
        slope = float(np.sum(slopes[3 * axis : 3 * axis + 3] ** 2))
        moments = [body.mass * float(np.linalg.norm(body.com)) ** axis for body in (TOOL + PAYLOAD, TOOL)]
        loaded, empty = ((0.15 if axis == 0 else 0.006) ** 2 + (0.1 * moment) ** 2 for moment in moments)
        credit += 0.5 * length * math.log(loaded / empty)
        jumps.append((bank.TOUCH * lever) ** 2 + 9.0 * slope + loaded / BEFORE)
        rises = (0.5 * bank.HAND / bank.RISE * lever) ** 2 * np.outer(rise, rise)
        touched = loaded * eye + jumps[k] * ones
        hands["rising"] += dense(after[:, k], x0[k], touched + rises)
        hands["steady"] += dense(after[:, k], x0[k], touched)
        hands["nobody"] += dense(after[:, k], 0.0, loaded * eye + (bank.OFFSET * lever) ** 2 * ones)
        anything += dense(after[:, k], 0.0, (0.5 * bank.HAND * lever) ** 2 * eye)
        for kind in (LOST, FREED, MORE):
            offset = (bank.GAIN * WEIGHT * lever) ** 2 + ((bank.CENTRE * WEIGHT) ** 2 if axis else 0.0)
            offset += (bank.OFFSET * lever) ** 2 if kind == FREED else 4.0 * slope + loaded / BEFORE
            parts[kind].append(after[:, k] - (0.0 if kind == FREED else x0[k]))
            covariances[kind].append(empty * eye + offset * ones)
    # An arm that does not turn has nothing late: each hand counts twice.
    other = float(np.logaddexp.reduce([*hands.values(), *hands.values(), anything]))
    best = 0.0
    known = (bank.SURE / PAYLOAD.mass) ** 2
    for kind, mean, variance in ((LOST, 1.0, known), (FREED, 1.0, known), (MORE, -0.5, 0.25)):
        whole = np.zeros((6 * length, 6 * length))
        for k, part in enumerate(covariances[kind]):
            whole[k * length : (k + 1) * length, k * length : (k + 1) * length] = part
        basis, data = needs.T.ravel(), np.concatenate(parts[kind])
        flat = np.linalg.solve(whole, np.stack([basis, data], axis=1))
        share = mean + basis @ (flat[:, 1] - mean * flat[:, 0]) / (1.0 / variance + basis @ flat[:, 0])
        whole += variance * np.outer(basis, basis)
        off = data - mean * basis
        square = max(float(off @ np.linalg.solve(whole, off)), 6.0 * length)  # better than noise says nothing
        likelihood = -0.5 * square - 0.5 * float(np.linalg.slogdet(whole)[1]) - credit
        way = share * needs.mean(axis=0) - (x0 if kind == FREED else 0.0)
        carried = 0.5 * float(np.sum(way * way / np.array(jumps)))
        if (share > 0.0) != (kind == MORE):
            best = max(best, -float(np.logaddexp(other - likelihood, -carried)))
    return best


def test_a_turn_that_comes_late_is_no_payload() -> None:
    """FD-19: what the filter misses of a swinging load looks like any force; only while nothing swings it is noise alone."""
    own = Arm().wrench.record[0]
    own["fastest"] = 40.0
    late = bank.noise(own, own["whole"], 0, LATE) - bank.noise(own, own["whole"], 0, 0.0)
    assert late == pytest.approx(0.5 * (40.0 * 2.5 * np.linalg.norm((TOOL + PAYLOAD).com)) ** 2)
