"""The bank of hypotheses at the flange: likelihoods against the whole Gaussian, and what it thinks of plain cases."""

import math

import numpy as np
import pinocchio as pin
import pytest
from numpy.typing import NDArray

from app.files.library import load_arm
from pendant.sensor.hand_model import GRIP_LEVER, KNOWN, LARGEST, RISE, RISES, SUSPECTED, TREMOR
from pendant.tick.estimate import GRAVITY
from pendant.tick.modes import TICK
from sim.arm.chain import Body, chain
from sim.flange import wrench_hypotheses as bank
from sim.flange.external_wrench import KEPT, NO_ODDS, ExternalWrench
from sim.flange.flange_forces import FlangeForces
from sim.flange.wrench_hypotheses import BEFORE, FREED, LATE, LN_OFTEN, LN_RARE, LONGEST, LOST, MORE, SHORTEST, STRAY
from sim.rigid_body.dynamics import Dynamics

Array = NDArray[np.float64]
UR5E = load_arm("ur5e")
PAYLOAD = Body(2.0, np.array([0.01, -0.02, 0.05]), np.eye(3) * 0.002)
TOOL = Body(0.5, np.array([0.0, 0.0, 0.03]), np.eye(3) * 0.0005)
UP = np.array([0.0, 0.0, GRAVITY])
NO_BIAS = (0.0,) * 6
NOT_MOVED = np.zeros(3)
OFFSET = math.hypot(0.3, 0.15 / math.sqrt(50.0))  # of the bias, beside what it is taken for [N]: walk, and the mean of a window
FREE_MASS = sum(UR5E.masses.mass[2:]) + TOOL.mass + PAYLOAD.mass  # [kg] forearm, wrists and load
GAIN = 0.01 + 2.0 * 0.01 / 5.0  # of the sensor: its gain, and what two channels of five talk into another
WEIGHT = PAYLOAD.mass * GRAVITY
NEEDS = np.concatenate([PAYLOAD.mass * UP, np.cross(PAYLOAD.com, PAYLOAD.mass * UP)])


class Arm:
    """An arm whose flange feels what a test wants."""

    def __init__(self, seed: int = 0, payload: Body = PAYLOAD) -> None:
        rigid, self.load = chain(UR5E), TOOL + payload
        self.forces = FlangeForces(Dynamics(rigid, rigid.links, self.load, mounting=[0.0] * 3, elbow=UR5E.chain.elbow))
        self.wrench = ExternalWrench(UR5E, self.forces)
        self.wrench.set_load(self.load, payload)
        self.told = self.wrench.record[0]
        self.rng = np.random.default_rng(seed)
        self.gyro, self.unsure = np.zeros(3), 0.0
        self.forces.model[0]["R"] = np.eye(3)
        self.odds: list[float] = []
        self.stepped: list[float] = []

    def tick(
        self,
        x: Array,
        specific: Array = UP,
        bias: tuple[float, ...] | None = NO_BIAS,
        *,
        felt: Array = NOT_MOVED,
        turn: Array = NOT_MOVED,
        accelerometer: bool = True,
    ) -> float:
        """The wrench `x` that is missing at the flange while it feels a `specific` force and is moved as `felt`."""
        own, load = self.forces.record[0], self.load
        noise = self.rng.normal(size=6) * [0.15, 0.15, 0.15, 0.006, 0.006, 0.006]
        shaking = 0.1 * load.mass * self.rng.normal(size=3)  # of the accelerometer that weighs the load
        noise += np.concatenate([shaking, np.cross(load.com, shaking)])
        self.gyro = self.gyro + turn * TICK
        own["missing"], own["specific"] = x + noise, specific + shaking / load.mass
        own["gyro"], own["turn"] = self.gyro, turn
        own["a_felt"] = felt + 0.1 * self.rng.normal(size=3)
        self.whose = self.wrench.update(bias, self.unsure, accelerations=accelerometer)
        self.odds.append(float(self.told["lost"]))
        self.stepped.append(float(self.told["stepped"]))
        return self.odds[-1]

    def course(self, xs: list[Array], *, moves: bool = False) -> float:
        """After a quiet time; the best odds meanwhile. What changes `moves` the flange, or nothing does."""
        for _ in range(30):
            self.tick(xs[0])
        return max(self.tick(x, felt=(x - xs[0])[:3] / FREE_MASS * moves) for x in xs)


def pushed(force: tuple[float, float, float]) -> Array:
    """The wrench of a force."""
    return np.array([*force, 0.0, 0.0, 0.0])


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
    assert arm.course(falls(), moves=True) > KNOWN
    first = next(k for k, odds in enumerate(arm.odds[30:]) if odds > KNOWN)
    assert first <= 8, "ticks: 20 ms with the sensor's delay"


@pytest.mark.parametrize("seed", range(5))
def test_it_is_known_beside_a_hand_that_stays(seed: int) -> None:
    assert Arm(seed).course(falls(hand=np.array([8.0, -5.0, 3.0, 0.3, 0.2, 0.0])), moves=True) > KNOWN


@pytest.mark.parametrize("seed", range(5))
def test_it_is_known_when_the_hand_goes_with_it(seed: int) -> None:
    assert Arm(seed).course([np.array([12.0, 0.0, 0.0, 0.0, 0.5, 0.0]), *steady(NEEDS)], moves=True) > KNOWN


@pytest.mark.parametrize("shakes", [0.0, 2.0])
@pytest.mark.parametrize("seed", range(5))
def test_a_payload_that_falls_out_of_a_hand_that_goes_with_it_is_known_by_how_it_swings(seed: int, shakes: float) -> None:
    """The hand carried the whole weight: at rest nothing changes. A hand that carried it on would have to swing as it does."""
    arm = Arm(seed)
    for _ in range(30):
        arm.tick(NEEDS)
    for swing in (1.0, -1.0) * 6:
        specific = UP + shakes * swing * np.array([0.0, 0.0, 1.0])
        gone = PAYLOAD.mass * np.concatenate([specific, np.cross(PAYLOAD.com, specific)])
        arm.tick(gone, specific, felt=specific - UP)
    assert (max(arm.odds) > KNOWN) == (shakes > 0.0)


@pytest.mark.parametrize("seed", range(5))
def test_a_hand_that_lets_go_of_an_arm_whose_bias_is_unsure_is_a_hand(seed: int) -> None:
    """It pulled with 5 N, and 2 N are left, of the sensor's drift: with a bias that is sure a payload may have come."""
    left = pushed((0.0, 0.0, 2.0))
    odds = []
    for unsure in (0.0, 1.3):
        arm = Arm(seed)
        arm.unsure = unsure
        odds.append(arm.course([pushed((0.0, 0.0, 5.0)), *steady(left)]))
        assert arm.told["offset"] == pytest.approx(math.hypot(OFFSET, unsure))
    assert odds[1] < odds[0] - 3.0


@pytest.mark.parametrize("ticks", [5, 10, 25])
@pytest.mark.parametrize("seed", range(5))
def test_a_hand_that_comes_to_carry_the_payload_is_a_hand(seed: int, ticks: int) -> None:
    assert Arm(seed).course(rising(NEEDS, ticks)) < 0.6 * KNOWN


@pytest.mark.parametrize("seed", range(5))
def test_a_hand_that_carries_more_than_a_light_payload_and_shakes_it_is_a_hand(seed: int) -> None:
    """Its force swings as the payload's would, at 20 Hz and by some tenths of a newton a tick: slowly, for a hand."""
    light = Body(0.2, np.array([0.02, 0.02, 0.08]), np.eye(3) * 0.0002)
    arm = Arm(seed, light)
    arm.unsure = 1.13
    for k in range(100):
        shakes = 1.5 * np.array([math.sin(0.26 * k), math.cos(0.26 * k), 0.5 * math.sin(0.26 * k)])
        force = 2.1 * light.mass * UP + 0.25 * shakes
        arm.tick(np.concatenate([force, np.cross(light.com, force)]), UP + shakes, felt=shakes)
    assert max(arm.odds) < 0.65 * KNOWN


@pytest.mark.parametrize("seed", range(5))
def test_a_hand_that_lets_go_is_no_payload(seed: int) -> None:
    assert Arm(seed).course([-NEEDS, *steady(np.zeros(6))]) < 0.6 * KNOWN, "although the wrench changes by the payload's"


@pytest.mark.parametrize("force", [(WEIGHT, 0.0, 0.0), (0.0, -WEIGHT, 0.0), (0.0, 0.8 * WEIGHT, 0.6 * WEIGHT)])
def test_a_step_that_is_no_payloads_is_none(force: tuple[float, float, float]) -> None:
    assert Arm().course([np.zeros(6), *steady(pushed(force))]) < 0.6 * KNOWN


def test_an_arm_that_stands_cannot_tell_a_carried_payload_from_one_that_is_gone() -> None:
    """What the bank cannot know: the hand went in the moment in which the payload fell that it carried."""
    assert Arm().course(steady(NEEDS, 60)) < KNOWN


def test_the_share_that_fell_is_told() -> None:
    arm, shares = Arm(), []
    for x in [np.zeros(6)] * 30 + [NEEDS] * 8:
        if arm.tick(x, felt=x[:3] / FREE_MASS) > KNOWN:
            shares.append(float(arm.told["share"]))
    assert shares[-1] == pytest.approx(1.0, abs=0.05)
    assert arm.whose[:2] == (arm.odds[-1], shares[-1]), "nothing is to be followed yet"


def test_a_payload_that_comes_on_top_is_another() -> None:
    """FD-19: the load weighs half as much again."""
    arm = Arm()
    assert arm.course([np.zeros(6), *steady(-0.5 * NEEDS)], moves=True) > KNOWN


def test_nothing_is_said_before_there_is_enough_to_compare() -> None:
    arm = Arm()
    for tick in range(KEPT - 1):
        assert (arm.tick(NEEDS if tick < KEPT - 4 else np.zeros(6)), arm.stepped[-1]) == (-math.inf, -math.inf)
    assert math.isfinite(arm.tick(np.zeros(6)))
    assert math.isfinite(arm.stepped[-1])
    assert (arm.tick(NEEDS, bias=None), arm.stepped[-1]) == (-math.inf, -math.inf)
    assert arm.whose == NO_ODDS
    assert (arm.tick(NEEDS), arm.stepped[-1]) == (-math.inf, -math.inf), "it begins afresh"


def test_without_a_payload_nothing_can_be_lost() -> None:
    arm = Arm()
    arm.wrench.set_load(TOOL, Body(0.0, np.zeros(3), np.zeros((3, 3))))
    assert arm.course(falls(), moves=True) == -math.inf


STEPS = [(12.0, 0.0, 0.0), (0.0, -12.0, 0.0), (4.0, 8.0, 8.0)]


@pytest.mark.parametrize("force", STEPS)
@pytest.mark.parametrize("held", [0.0, 15.0])
def test_a_step_that_moves_nothing_is_the_sensors(force: tuple[float, float, float], held: float) -> None:
    """FD-19: also beside a hand, and in three ticks with the one in which it comes."""
    arm, hand = Arm(), np.array([0.0, 0.0, held, 0.0, 0.0, 0.0])
    lost = arm.course([hand, *steady(hand + pushed(force))])
    first = next(k for k, odds in enumerate(arm.stepped[30:]) if odds >= SUSPECTED)
    assert first <= SHORTEST + 1
    assert arm.whose.step == pytest.approx(math.hypot(*force), rel=0.1)
    assert lost < SUSPECTED
    assert max(arm.stepped[:31]) < 1.0


@pytest.mark.parametrize("force", STEPS)
def test_a_step_that_moves_the_flange_is_a_hands(force: tuple[float, float, float]) -> None:
    """However sudden it is."""
    arm, push = Arm(), pushed(force)
    for _ in range(30):
        arm.tick(np.zeros(6))
    for _ in range(20):
        arm.tick(push, felt=push[:3] / FREE_MASS)
    assert max(arm.stepped) < 1.0


def test_without_an_accelerometer_a_step_is_a_hands() -> None:
    arm = Arm()
    for x in [np.zeros(6)] * 30 + steady(pushed(STEPS[0])):
        arm.tick(x, accelerometer=False)
    assert max(arm.stepped) < 1.0


@pytest.mark.parametrize("ticks", [5, 10, 25])
@pytest.mark.parametrize("seed", range(5))
def test_a_hand_that_comes_is_no_step_although_the_flange_rests(seed: int, ticks: int) -> None:
    arm = Arm(seed)
    arm.course(rising(np.array([0.0, 20.0, 10.0, 0.0, 0.0, 0.0]), ticks))
    assert max(arm.stepped) < SUSPECTED


@pytest.mark.parametrize("seed", range(5))
def test_a_hand_that_lets_go_at_once_is_no_step(seed: int) -> None:
    """What moves the flange then is the springs of the joints."""
    arm, push = Arm(seed), np.array([0.0, 20.0, 10.0, 0.0, 0.0, 0.0])
    for _ in range(30):
        arm.tick(push)
    for _ in range(20):
        arm.tick(np.zeros(6), felt=-push[:3] / FREE_MASS)
    assert max(arm.stepped) < 1.0


@pytest.mark.parametrize("seed", range(5))
def test_a_payload_that_falls_is_no_step(seed: int) -> None:
    arm = Arm(seed)
    arm.course(falls(), moves=True)
    assert max(arm.stepped) < SUSPECTED


def test_a_bias_that_is_followed_is_no_step() -> None:
    """What the sensor tells stays; what of it is bias is known better now (pendant.guided.sensor_bias)."""
    arm, drifted = Arm(), np.array([0.0, 6.0, 0.0, 0.0, 0.0, 0.0])
    for _ in range(30):
        arm.tick(drifted)
    for _ in range(20):
        arm.tick(drifted, bias=(0.0, 6.0, 0.0, 0.0, 0.0, 0.0))
    assert max(*arm.stepped, *arm.odds) < -3.0


def turned_by(vector: Array) -> Array:
    """Rotation about a vector by its length [rad]."""
    return np.asarray(pin.exp3(vector))


def dense(x: Array, mean: Array | float, covariance: Array) -> float:
    """Log density of a Gaussian without its constant of 2 pi."""
    off = x - mean
    return float(-0.5 * off @ np.linalg.solve(covariance, off) - 0.5 * np.linalg.slogdet(covariance)[1])


@pytest.mark.parametrize("bias", [NO_BIAS, (0.4, -0.2, 0.3, 0.01, 0.0, -0.02)])
@pytest.mark.parametrize("seed", range(9))
def test_the_odds_are_those_of_the_whole_gaussians(seed: int, bias: tuple[float, ...]) -> None:
    """The closed forms against the covariance of all ticks; payloads come and go, and sensors step, as the arm shakes."""
    arm, rng = Arm(seed), np.random.default_rng(seed)
    start, attitudes = turned_by(np.array([0.4, -1.1, 0.7])), list[Array]()
    share = (1.0, 0.9, -0.5)[seed % 3]
    turn, step = np.array([4.0, 8.0, -4.0]), np.array([6.0, -18.0, 10.0, 0.0, 0.0, 0.0])
    for tick in range(KEPT + 5):
        lift = rng.normal(size=3)
        needs = PAYLOAD.mass * np.concatenate([UP + lift, np.cross(PAYLOAD.com, UP + lift)])
        after = step if seed >= 6 else share * needs
        x = after if tick > KEPT - 3 else 0.1 * rng.normal(size=6)
        attitudes.append(np.kron(np.eye(2), turned_by(0.03 * rng.normal(size=3)) @ start))
        arm.forces.model[0]["R"] = attitudes[-1][:3, :3]
        arm.tick(x + bias, UP + lift, bias, felt=0.1 * rng.normal(size=3), turn=turn)
    assert max(arm.odds[-1], arm.stepped[-1]) > 3.0
    own = arm.wrench.record[0]
    here = (int(own["next"]) - 1) % KEPT
    x, p, felt = (np.stack([own[name][(here - k) % KEPT] for k in reversed(range(KEPT))]) for name in ("x", "p", "felt"))
    lost, stepped = of_window(x - bias, p, felt, attitudes[-KEPT:])
    assert arm.odds[-1] == pytest.approx(lost, rel=1e-9)
    assert arm.stepped[-1] == pytest.approx(stepped, rel=1e-9)
    told = [1.0 / (1.0 + math.exp(-odds)) for odds in (lost, stepped)]
    assert sum(told) <= 1.0 + 1e-12, "of one whole"


def moments_of(body: Body) -> tuple[float, float, float]:
    """Mass, first and second moments about the flange, in the axis where these are largest [kg, kg·m, kg·m²]."""
    about = body.inertia + body.mass * (body.com @ body.com * np.eye(3) - np.outer(body.com, body.com))
    return body.mass, body.mass * float(np.linalg.norm(body.com)), float(np.linalg.eigvalsh(about)[-1])


LOAD_MOMENTS = [moments_of(body) for body in (TOOL + PAYLOAD, TOOL)]
TURN = math.sqrt(96.0 - STRAY * 2.0 * (0.003 / TICK) ** 2)
"""What of the turn is no noise of the gyro [rad/s²]."""
SMOOTH = 1.0 - math.exp(-2.0 * math.pi * 60.0 * TICK)
TURNING = 0.003 / TICK * SMOOTH * math.sqrt(2.0 / (2.0 - SMOOTH))
"""Deviation of what is left of that noise after its filter [rad/s²]."""


def of_noise(axis: int, body: int, late: float) -> float:
    """Variance of x in a tick with the whole load (`body` 0), or the tool alone (1)."""
    moments = LOAD_MOMENTS[body]
    turns = TURNING**2 + (late * TURN) ** 2
    return (0.15, 0.006)[axis] ** 2 + (0.1 * moments[axis]) ** 2 + turns * moments[axis + 1] ** 2


def rises(values: Array, variance: float) -> float:
    """Square of the rise of three numbers in four ticks (4, 3), beyond that of noise."""
    square = float(np.sum(((values[2:].sum(axis=0) - values[:2].sum(axis=0)) / BEFORE) ** 2))
    return max(square - STRAY * variance / BEFORE, 0.0)


def before(x: Array, tick: int) -> tuple[Array, list[float]]:
    """Mean ahead of a tick (6,), and the square of its rise in force and torque."""
    earlier = x[tick - BEFORE : tick]
    return earlier.mean(axis=0), [rises(earlier[:, 3 * k : 3 * k + 3], of_noise(k, 0, 0.0)) for k in range(2)]


def goes_on(x: Array, tick: int) -> float:
    """Of one tick, if a hand goes on."""
    x0, steep = before(x, tick)
    ways: list[float] = []
    for extra in range(3):
        for late in (0.0, LATE):
            variances = [
                1.25 * of_noise(k, 0, late) + 9.0 * steep[k] * (extra > 0) + (TREMOR * (1.0, GRIP_LEVER)[k]) ** 2 * (extra > 1)
                for k in range(2)
            ]
            ways.append(dense(x[tick], x0, np.diag(np.repeat(variances, 3))) - LN_OFTEN)
    wide = [(0.5 * LARGEST * lever) ** 2 for lever in (1.0, GRIP_LEVER)]
    return float(np.logaddexp.reduce([*ways, dense(x[tick], x0, np.diag(np.repeat(wide, 3))) - LN_RARE]))


def of_window(x: Array, p: Array, felt: Array, attitudes: list[Array]) -> tuple[float, float]:
    """Log odds that the payload changed within the last ticks, and that the sensor stepped."""
    ahead = {tick: goes_on(x, tick) for tick in range(BEFORE, KEPT)}
    quiet = -3.0 - 1.5 * sum(math.log(of_noise(axis, 0, 0.0)) for axis in range(2))
    # No change, one in the newest tick, and one in the tick before it, which may be anything.
    early = [sum(ahead[tick] for tick in range(BEFORE, KEPT - n)) + quiet for n in (1, 2)]
    wide = np.repeat([(0.5 * LARGEST) ** 2, (0.5 * LARGEST * GRIP_LEVER) ** 2], 3)
    early[1] += dense(attitudes[-1] @ x[-1], 0.0, np.diag(wide))
    other, lost, stepped = [sum(ahead.values()) + math.log(LONGEST + 1.0), *early], [-math.inf], [-math.inf]
    for length in range(SHORTEST, LONGEST + 1):
        start = KEPT - length
        known = sum(ahead[tick] for tick in range(BEFORE, start - 1)) + quiet
        hands, payloads, (step, answer) = of_change(x, p, felt, attitudes, length)
        other += [known + one for one in hands] + [known + step - LN_RARE] + [known + one - way for one, way in payloads]
        lost += [known + one for one, _ in payloads]
        stepped.append(known + step + answer)
    hand, gone, sensor = (float(np.logaddexp.reduce(some)) for some in (other, lost, stepped))
    return gone - float(np.logaddexp(hand, sensor)), sensor - float(np.logaddexp(hand, gone))


Payloads = list[tuple[float, float]]


def of_change(
    x: Array, p: Array, felt: Array, attitudes: list[Array], length: int
) -> tuple[list[float], Payloads, tuple[float, float]]:
    """Log likelihoods of the ticks since a change.

    Those of hands; those of payloads, each with how much less likely a hand is that carries them; that of any step, with how much
    likelier the accelerations are then.
    """
    start = KEPT - length
    after, needs, lines = (
        np.stack([R @ row for R, row in zip(attitudes[start:], some[start:], strict=True)])
        if some.shape[1] == 6
        else some[start:]
        for some in (x, p[:, :6], p[:, 6:])
    )
    x0, steep = before(x, start - 1)
    x0 = attitudes[start - 1] @ x0  # looked at from the base
    eye, ones, rise = np.eye(length), np.ones((length, length)), np.arange(1, length + 1) + 0.5
    ways = [*RISES, "steady", "nobody"]
    hands = {(way, late): -math.log(len(RISES)) * (way in RISES) for way in ways for late in (0.0, LATE)}
    anything = 0.0
    credit = dict.fromkeys((LOST, FREED, MORE), 0.0)
    steps = np.zeros((6 * length, 6 * length))
    jumps: list[float] = []
    parts: dict[int, list[Array]] = {kind: [] for kind in (LOST, FREED, MORE)}
    covariances: dict[int, list[Array]] = {kind: [] for kind in (LOST, FREED, MORE)}
    for k in range(6):
        axis, lever = k // 3, (1.0, GRIP_LEVER)[k // 3]
        loaded, swings, empty = of_noise(axis, 0, 0.0), of_noise(axis, 0, LATE), of_noise(axis, 1, 0.0)
        jumps.append((TREMOR * lever) ** 2 + 9.0 * steep[axis] + swings / BEFORE)
        wide = (0.5 * LARGEST * lever) ** 2
        for late, variance in ((0.0, loaded), (LATE, swings)):
            touched = variance * eye + jumps[k] * ones
            for share in RISES:
                outer = (share * 0.5 * LARGEST / RISE * lever) ** 2 * np.outer(rise, rise)
                hands[share, late] += dense(after[:, k], x0[k], touched + outer)
            hands["steady", late] += dense(after[:, k], x0[k], touched)
            hands["nobody", late] += dense(after[:, k], 0.0, variance * eye + (OFFSET * lever) ** 2 * ones)
        anything += dense(after[:, k], 0.0, wide * eye)
        steps[k * length : (k + 1) * length, k * length : (k + 1) * length] = swings * eye + wide * ones
        for kind in (LOST, FREED, MORE):
            left = swings if kind == MORE else empty
            credit[kind] += 0.0 if kind == MORE else 0.5 * length * math.log(loaded / left)
            offset = (GAIN * WEIGHT * lever) ** 2 + ((bank.CENTRE_AXIS * WEIGHT) ** 2 if axis else 0.0)
            offset += (OFFSET * lever) ** 2 if kind == FREED else 4.0 * steep[axis] + swings / BEFORE
            parts[kind].append(after[:, k] - (0.0 if kind == FREED else x0[k]))
            covariances[kind].append(left * eye + offset * ones)
    off = (after - x0).T.ravel()
    square = max(float(off @ np.linalg.solve(steps, off)), 6.0 * (length - 1.0))
    step = -0.5 * (square + float(np.linalg.slogdet(steps)[1]))
    payloads: Payloads = []
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
        square = max(float(off @ np.linalg.solve(whole, off)), 6.0 * (length - 1.0))  # better than noise says nothing
        likelihood = -0.5 * square - 0.5 * float(np.linalg.slogdet(whole)[1]) - credit[kind]
        way = (share * needs.mean(axis=0) - (x0 if kind == FREED else 0.0)) ** 2
        swings = share * (np.diff(needs, axis=0) - (needs[-1] - needs[0]) / (length - 1.0))
        line = share * (np.diff(lines, axis=0) - (lines[-1] - lines[0]) / (length - 1.0))  # a turn makes no force along it
        off = [
            2.0 * ((TREMOR * (1.0, GRIP_LEVER)[axis]) ** 2 + of_noise(axis, 0, late))
            for axis, late in ((0, LATE), (1, LATE), (0, 0.0))
        ]
        unlikely = np.sum(way / np.array(jumps)) + np.sum(line**2) * (1.0 / off[2] - 1.0 / off[0])
        unlikely += np.sum(swings[:, :3] ** 2) / off[0] + np.sum(swings[:, 3:] ** 2) / off[1]
        if (share > 0.0) != (kind == MORE):
            payloads.append((likelihood - LN_RARE * (kind == MORE), 0.5 * float(unlikely)))
    size = float(np.linalg.norm((after.mean(axis=0) - x0)[:3]))
    return [*hands.values(), anything], payloads, (step, of_accelerations(felt, start - 1, size))


def of_accelerations(felt: Array, first: int, size: float) -> float:
    """How much likelier those of the first ticks of a step are without a force."""
    earlier = felt[first - BEFORE : first]
    still = 0.1**2 * (1.0 / SHORTEST + 1.0 / BEFORE) + 9.0 * rises(earlier, 0.1**2)
    moved = still + (size / FREE_MASS) ** 2
    mean, rested = felt[first : first + SHORTEST].mean(axis=0), earlier.mean(axis=0)
    return dense(mean, rested, still * np.eye(3)) - dense(mean, rested, moved * np.eye(3))


def test_a_turn_that_comes_late_is_no_payload() -> None:
    """FD-19: what the filter misses of a swinging load looks like any force; only while nothing swings it is noise alone."""
    own = Arm().wrench.record[0]
    own["fastest"] = 40.0
    late = bank.noise(own, own["whole"], 0, LATE) - bank.noise(own, own["whole"], 0, 0.0)
    assert late == pytest.approx(0.5 * (40.0 * 2.5 * np.linalg.norm((TOOL + PAYLOAD).com)) ** 2)
