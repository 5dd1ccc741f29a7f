"""A hand on a link, beyond what the joints may err by (FD-19), against numpy."""

from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from pendant.all_settings import Settings
from pendant.events.event import Kind
from pendant.sensor.hand_model import KEEPS, LASTS
from pendant.tick.modes import TICK, Mode
from sim.arm.scenario import Scenario
from sim.estimation.link_hand import BEFORE, ENTRY, LATELY, LONG, SETTLED, LinkHand
from sim.estimation.momentum_observer import READY, MomentumObserver
from sim.estimation.torque_errors import CAUSES, FOLLOW, OWN, ZERO
from sim.estimation.transmission_torque import CONTACT
from sim.flange.flange_forces import DAMPING
from sim.motion.references import STANDING
from sim.plant.touch import Push
from sim.simulation import Simulation
from tests.sim.arms import UR5E
from tests.sim.bench import CENTRE
from tests.sim.bench import Bench as Device

Array = NDArray[np.float64]
N = UR5E.n
LINK_MASS, MOTOR_CONSTANT = UR5E.accuracy.link_mass, UR5E.accuracy.motor_constant
DOUBT = 0.5  # [N·m]
NO_BIAS = (0.0,) * ZERO
ALL = np.ones(N, dtype=np.bool_)
POSTURE = np.array([0.3, -1.2, 1.5, -0.8, -1.2, 0.7])
LEAST = CONTACT * DOUBT
"""A torque that is felt where nothing but the rest of the model is unsure [N·m]."""


FOLLOWED = 10 * LONG
"""Ticks after which what was felt before is what is felt now, all but a little."""


class Joints:
    """What the joints feel is set by hand; nothing of it is an error until a test says so."""

    def __init__(self) -> None:
        dynamics = Simulation(UR5E, Scenario(mismatch="nominal"), Settings()).dynamics
        dynamics.recursion.run(POSTURE, np.stack([POSTURE, np.zeros(N), np.zeros(N)]), np.zeros(3))
        self.jacobian = dynamics.recursion.jacobian.copy()
        momentum = MomentumObserver(UR5E, dynamics)
        self.count: Any = momentum.record[0]
        self.count["count"], momentum.doubt[:] = READY, DOUBT
        self.errors = momentum.errors.record[0]
        self.errors["covariance"], self.errors["walk"] = 0.0, 0.0
        self.felt, self.shares, self.covariance = self.errors["felt"], self.errors["shares"], self.errors["covariance"]
        self.hand = LinkHand(UR5E, dynamics.recursion, momentum)
        self.moves = np.zeros(N)
        self.bias = NO_BIAS
        self.by_deflection = ALL

    def tick(self, count: int = 1) -> Array:
        for _ in range(count):
            self.hand.update(self.bias, self.moves, self.by_deflection)
        return self.hand.torque.copy()

    def begun(self) -> "Joints":
        """Free-drive began."""
        self.tick()
        return self

    def moving(self) -> "Joints":
        self.moves = np.full(N, 2.0 * STANDING)
        return self


def at(joint: int, k: int) -> int:
    """Where the constant of cause k of a joint is."""
    return ZERO + OWN * joint if k == 0 else k - 1 if k <= ZERO else ZERO + OWN * joint + k - ZERO


@pytest.mark.parametrize("joint", range(N))
@pytest.mark.parametrize("way", [1.0, -1.0])
@pytest.mark.parametrize(("share", "felt"), [(0.99, False), (1.01, True)])
def test_a_change_is_a_hands_beyond_what_the_model_leaves(share: float, felt: bool, way: float, joint: int) -> None:
    joints = Joints()
    joints.felt[:, 0] = 3.0  # at entry, which is no hand's
    assert not joints.begun().tick().any()
    joints.felt[joint, 0] += way * share * LEAST
    torque = joints.tick()
    assert torque == pytest.approx(way * share * LEAST * np.eye(N)[joint] * felt)
    assert joints.hand.certain == pytest.approx(torque), "a change against what was felt lately counts as a whole"
    J = joints.jacobian[:3]
    force = np.linalg.solve(J @ J.T + DAMPING**2 * np.eye(3), J @ torque)
    assert joints.hand.force == pytest.approx(force)
    assert joints.hand.force.any() == felt


@pytest.mark.parametrize(("k", "deviation"), [(0, 0.1), (2, 1.5), (5, 0.2), (8, 0.7)])
@pytest.mark.parametrize(("share", "felt"), [(0.99, False), (1.01, True)])
def test_what_is_known_of_a_cause_is_no_hand_and_its_uncertainty_grows_with_the_change(
    share: float, felt: bool, k: int, deviation: float
) -> None:
    """The cause changes by 7 from 5, and is known to come with a share of 0.3."""
    joints = Joints().moving()
    joints.shares[2, k], joints.covariance[at(2, k), at(2, k)] = 0.3, deviation**2
    joints.felt[2, 1 + k] = 5.0
    joints.begun()
    joints.felt[2, 1 + k] += 7.0
    masses = LINK_MASS * 7.0 if k == 0 else 0.0
    beyond = CONTACT * np.sqrt(DOUBT**2 + (7.0 * deviation) ** 2 + masses**2)
    joints.felt[2, 0] = 0.3 * 7.0 + share * beyond
    assert joints.tick()[2] == pytest.approx(share * beyond * felt)


@pytest.mark.parametrize(("share", "felt"), [(0.99, False), (1.01, True)])
def test_a_joint_without_its_deflection_is_as_sure_as_its_motor(share: float, felt: bool) -> None:
    joints = Joints().moving()
    joints.by_deflection = np.zeros(N, dtype=np.bool_)
    joints.begun()
    joints.felt[1, 1] = 40.0  # it bears so much more
    beyond = CONTACT * np.sqrt(DOUBT**2 + (LINK_MASS * 40.0) ** 2 + (MOTOR_CONSTANT * 40.0) ** 2)
    joints.felt[1, 0] = share * beyond
    assert joints.tick().any() == felt


@pytest.mark.parametrize("k", range(ZERO))
def test_what_the_sensor_has_drifted_by_is_no_hand(k: int) -> None:
    """A zero that is greater by 2 makes a torque of 2 by its lever, and the bias of the user's force less by 2."""
    joints = Joints().moving()
    joints.bias = tuple(1.0 * (i == k) for i in range(ZERO))
    joints.felt[:, 2 + k] = 0.8
    joints.begun()
    joints.felt[:, 0] += 2.0 * 0.8
    assert joints.tick().any()
    joints.hand.forget()
    joints.felt[:, 0] = 0.0
    joints.begun()
    joints.felt[:, 0] += 2.0 * 0.8
    joints.bias = tuple(-1.0 * (i == k) for i in range(ZERO))
    assert not joints.tick().any()


@pytest.mark.parametrize(("seconds", "felt"), [(1.0, True), (20.0, False)])
def test_the_longer_since_entry_the_less_is_known_of_the_zero(seconds: float, felt: bool) -> None:
    """Its variance grows by 0.1 N²/s, up to that of what it may be at first: 1.41 N after 20 s."""
    joints = Joints().moving()
    joints.errors["walk"][:ZERO] = 0.1 * TICK
    joints.felt[:, 2] = 1.0  # lever of one of its forces [m]
    joints.begun()
    joints.felt[3, 0] = 1.5 * LEAST
    joints.hand._own["ticks"] = round(seconds / TICK)
    assert joints.tick().any() == felt
    joints.errors["most"][:ZERO] = 0.1
    assert joints.tick().any()


def test_far_from_entry_a_hand_is_told_by_what_was_felt_lately() -> None:
    """The stiffness is known to a tenth, and 60 N·m more are borne: 15 N·m may be errors. A hand comes at once with 4."""
    joints = Joints()
    joints.covariance[at(1, 0), at(1, 0)] = 0.1**2
    joints.begun()
    joints.felt[1, :2] = 6.0, 60.0
    assert not joints.tick(FOLLOWED).any()
    joints.moving()
    joints.felt[1, 0] += 4.0
    assert joints.tick()[1] == pytest.approx(4.0, rel=0.01)
    joints.felt[1, 0] = 26.0
    assert joints.tick()[1] == pytest.approx(20.0, rel=0.01)


@pytest.mark.parametrize(("speed", "follows"), [(0.99 * STANDING, True), (1.01 * STANDING, False), (-1.01 * STANDING, False)])
def test_who_presses_on_an_arm_at_rest_within_its_errors_is_forgotten_lately(speed: float, follows: bool) -> None:
    joints = Joints()
    joints.covariance[at(1, 0), at(1, 0)] = 0.1**2
    joints.begun()
    joints.moves[4] = speed
    joints.felt[1, :2] = 6.0, 60.0
    joints.hand._own["felt"][LATELY:, 1, :2] = 2.0, 60.0
    assert joints.tick()[1] == pytest.approx(4.0)
    assert joints.hand._own["felt"][LATELY, 1, 0] == pytest.approx(2.0 + 4.0 * FOLLOW * follows)
    assert joints.hand._own["felt"][ENTRY, 1, 0] == 0.0


def test_a_hand_that_rested_on_the_arm_seems_to_pull_the_other_way_to_nobody() -> None:
    """It pressed for a second within the errors since entry, was followed, and goes at once; the arm moves then."""
    joints = Joints()
    joints.covariance[at(1, 0), at(1, 0)] = 0.1**2
    joints.begun()
    joints.felt[1, :2] = 6.0, 60.0
    joints.tick(FOLLOWED)
    joints.felt[1, 0] = 6.0 + 2.0 * LEAST
    joints.tick(round(1.0 / TICK))
    assert joints.hand._own["felt"][LATELY, 1, 0] == pytest.approx(6.0 + 2.0 * LEAST, rel=0.05)
    joints.moving()
    joints.felt[1, 0] = 6.0
    joints.hand._own["lasts"] = 0
    assert not joints.tick().any()
    assert not joints.hand.force.any()
    assert not joints.hand.certain.any()
    joints.felt[1, 0] = 6.0 + 5.0 * LEAST
    assert joints.tick()[1] == pytest.approx(3.0 * LEAST, rel=0.05), "who leads it is known, by what is more than before"
    assert joints.hand.certain[1] == pytest.approx(3.0 * LEAST, rel=0.05)


@pytest.mark.parametrize("way", [1.0, -1.0])
@pytest.mark.parametrize("held", [0.0, 0.4, 1.0])
def test_the_longer_a_joint_may_have_been_held_the_less_of_a_change_is_certain(held: float, way: float) -> None:
    """A hand that held on in its pauses has gone, and seems to push the other way. Errors explain most of it."""
    joints = Joints().begun()
    before = joints.hand._own["felt"]
    before[LATELY, 1, 0], before[BEFORE, 1, 0] = way * 1.2 * LEAST, way * 1.1 * LEAST
    joints.hand._own["held"][1] = held
    torque = joints.tick()
    assert torque == pytest.approx(-way * 1.2 * LEAST * np.eye(N)[1]), "it is felt as a whole"
    assert joints.hand.certain[1] == pytest.approx(-way * (1.2 - held * (1.2 - 0.1)) * LEAST)


@pytest.mark.parametrize("away", [True, False])
def test_for_how_long_a_joint_may_have_been_held_follows_as_what_was_felt_before_does(away: bool) -> None:
    """Who is felt against entry is not followed, so that no more of a hand is in it."""
    joints = Joints().moving().begun()
    joints.hand._own["lasts"][2] = 2 * LONG
    joints.felt[0, 0] = 1.5 * LEAST * away
    joints.tick(LONG)
    assert joints.hand._own["held"] == pytest.approx((1.0 - np.exp(-1.0)) * np.eye(N)[2] * (not away), rel=1e-3)
    joints.felt[0, 0] = 0.0
    joints.hand._own["lasts"], joints.hand._own["held"] = 0, 0.5
    joints.tick(LONG)
    assert joints.hand._own["held"] == pytest.approx(0.5 * np.exp(-1.0), rel=1e-3)
    joints.hand.forget()
    assert not joints.hand._own["held"].any()


@pytest.mark.parametrize("k", range(ZERO))
def test_what_is_followed_of_the_sensors_bias_is_so_before_as_well(k: int) -> None:
    joints = Joints().begun()
    joints.bias = tuple(2.0 * (i == k) for i in range(ZERO))
    joints.tick(LONG)
    assert joints.hand._own["bias"][BEFORE, k] == pytest.approx(2.0 * (1.0 - np.exp(-1.0)), rel=1e-3)


def test_of_who_is_felt_a_joint_counts_that_feels_it_for_sure() -> None:
    """Another one may feel an error as large as its errors are."""
    joints = Joints().moving().begun()
    joints.felt[0, 0], joints.felt[1, 0], joints.felt[2, 0] = 1.01 * LEAST, 0.99 * LEAST, -1.01 * LEAST
    assert joints.tick() == pytest.approx([1.01 * LEAST, 0.0, -1.01 * LEAST, 0.0, 0.0, 0.0])
    assert joints.hand.certain == pytest.approx([1.01 * LEAST, 0.0, -1.01 * LEAST, 0.0, 0.0, 0.0])
    joints.felt[:3, 0] = 0.5 * LEAST
    assert joints.tick() == pytest.approx([0.5 * LEAST, 0.0, 0.5 * LEAST, 0.0, 0.0, 0.0])
    assert not joints.hand.certain.any()


def test_who_is_felt_against_entry_is_never_forgotten() -> None:
    joints = Joints().begun()
    joints.felt[0, 0] = 1.5 * LEAST
    assert joints.tick(5000)[0] == pytest.approx(1.5 * LEAST)
    assert joints.hand._own["felt"][LATELY, 0, 0] == 0.0


def test_lately_follows_what_nobody_is_felt_in() -> None:
    joints = Joints().moving().begun()
    joints.felt[0, 0] = 0.5 * LEAST
    joints.tick()
    assert joints.hand._own["felt"][LATELY, 0, 0] == pytest.approx(0.5 * LEAST * FOLLOW)
    assert joints.hand._own["ticks"].tolist() == [2, 0, 2]


def test_who_was_felt_may_be_there_still() -> None:
    """A hand that turns round: what is felt meanwhile is its torque, but no force is told of it."""
    joints = Joints().moving().begun()
    joints.felt[0, 0] = 2.0 * LEAST
    joints.tick()
    joints.felt[0, 0] = 0.5 * LEAST
    for _ in range(LASTS - 1):
        assert joints.tick()[0] == pytest.approx(0.5 * LEAST)
        assert not joints.hand.force.any()
        assert not joints.hand.certain.any()
    assert not joints.tick().any()
    assert LASTS * TICK == KEEPS


@pytest.mark.parametrize("way", [1.0, -1.0])
@pytest.mark.parametrize(("share", "felt"), [(0.99, False), (1.2, True)])
def test_of_a_change_since_entry_a_force_is_what_is_beyond_the_errors(share: float, felt: bool, way: float) -> None:
    """What is no more than they may be stays so for as long as the arm is there, and would lead it. Its work counts whole."""
    joints = Joints()
    joints.covariance[at(1, 0), at(1, 0)] = 0.1**2
    joints.begun()
    errors = CONTACT * np.sqrt(DOUBT**2 + (0.1 * 60.0) ** 2 + (LINK_MASS * 60.0) ** 2)
    joints.felt[1, :2] = joints.hand._own["felt"][LATELY, 1, :2] = joints.hand._own["felt"][BEFORE, 1, :2] = (
        way * share * errors,
        60.0,
    )
    assert joints.tick()[1] == pytest.approx(way * share * errors * felt)
    J = joints.jacobian[:3]
    beyond = way * (share - 1.0) * errors * felt * np.eye(N)[1]
    assert joints.hand.certain == pytest.approx(beyond)
    assert joints.hand.force == pytest.approx(np.linalg.solve(J @ J.T + DAMPING**2 * np.eye(3), J @ beyond))


@pytest.mark.parametrize(("speed", "told"), [(0.1, 6.5), (-0.1, 0.5)])
def test_who_was_felt_a_moment_ago_is_believed_what_says_that_it_leads(speed: float, told: float) -> None:
    """Entry says 6.5 N·m, which may be errors, lately says 0.5."""
    joints = Joints()
    joints.covariance[at(1, 0), at(1, 0)] = 0.1**2
    joints.begun()
    joints.felt[1, :2] = 6.0, 60.0
    joints.tick(FOLLOWED)
    joints.moves[1] = speed
    joints.felt[1, 0] = 10.0
    joints.tick()
    joints.felt[1, 0] = 6.5
    assert joints.tick()[1] == pytest.approx(told, rel=0.05)


@pytest.mark.parametrize("sensed", [True, False])
@pytest.mark.parametrize(("stood", "told"), [(SETTLED - 2, False), (SETTLED - 1, True)])
def test_a_small_change_tells_who_touches_an_arm_that_stands(stood: int, told: bool, sensed: bool) -> None:
    """Against numpy. It is no hand's beyond the errors; of a joint without its deflection it tells nothing."""
    joints = Joints()
    joints.felt[:, 0] = 3.0
    joints.moves[2] = 0.99 * STANDING
    joints.tick(stood)
    change = np.array([0.1, -0.7, 0.4, 0.05, 0.0, 0.02])
    joints.felt[:, 0] += change
    joints.by_deflection = ALL.copy()
    joints.by_deflection[1] = sensed
    assert not joints.tick().any()
    J = joints.jacobian[:3]
    expected = np.linalg.solve(J @ J.T + DAMPING**2 * np.eye(3), J @ (change * joints.by_deflection))
    assert joints.hand.touch == pytest.approx(told * expected)
    joints.tick()
    assert joints.hand.touch == pytest.approx(told * (1.0 - FOLLOW) * expected), "what stays is forgotten"


@pytest.mark.parametrize("how", ["moves", "forget"])
def test_nobody_touches_an_arm_that_moved_a_moment_ago(how: str) -> None:
    joints = Joints()
    joints.tick(SETTLED)
    joints.felt[1, 0] += 1.0
    joints.tick()
    assert joints.hand.touch.any()
    if how == "moves":
        joints.moves[4] = -1.01 * STANDING
        joints.tick()
        joints.moves[4] = 0.0
    else:
        joints.hand.forget()
    assert not joints.hand.touch.any()
    joints.felt[1, 0] += 1.0
    joints.tick(SETTLED - 1)
    assert not joints.hand.touch.any()
    joints.felt[1, 0] += 1.0
    joints.tick()
    assert joints.hand.touch.any()


@pytest.mark.parametrize("way", [1.0, -1.0])
@pytest.mark.parametrize("joint", [0, 1, 4])
@pytest.mark.parametrize(("share", "told"), [(0.99, False), (1.01, True)])
def test_who_touched_a_joint_that_stood_leads_it_for_a_while_when_it_moves(
    share: float, told: bool, joint: int, way: float
) -> None:
    """By a torque that may be an error on a moving arm, so that it pays for the motion and makes no force."""
    joints = Joints()
    joints.tick(SETTLED)
    change = way * share * joints.count["floor"][joint]
    joints.felt[joint, 0] += change
    joints.tick()
    joints.moving()
    assert joints.tick() == pytest.approx(told * change * np.eye(N)[joint], rel=0.05)
    assert not joints.hand.certain.any()
    assert not joints.hand.force.any()
    assert joints.tick(LASTS - 2).any() == told
    assert not joints.tick().any()


@pytest.mark.parametrize("touched", [True, False])
def test_who_leads_a_link_gently_and_has_not_moved_it_yet_keeps_free_drive(touched: bool) -> None:
    """3 N at the forearm that come and go within a second, with all mismatch: the arm stands. Alone it is held after 3 s."""
    bench = Device(Scenario(seed=3), Settings())
    bench.run(1.0)
    bench.enter()
    begun = bench.plant.data.body("flange").xpos.copy()
    for k in range(16):
        bench.run(0.5, *([Push("wrist_1", CENTRE, (0.0, 0.0, 3.0 * (k % 2)))] if touched else []))
    assert (bench.mode is Mode.FREE_DRIVE) is touched
    assert np.linalg.norm(bench.plant.data.body("flange").xpos - begun) < 0.002


@pytest.mark.parametrize("how", ["forget", "not ready"])
def test_afterwards_all_begins_again(how: str) -> None:
    joints = Joints().begun()
    joints.felt[0, 0] = 2.0 * LEAST
    assert joints.tick().any()
    if how == "forget":
        joints.hand.forget()
    else:
        joints.count["count"] = READY - 1
        joints.tick()
        joints.count["count"] = READY
    assert not joints.hand.torque.any()
    assert not joints.hand.certain.any()
    assert not joints.hand.force.any()
    assert not joints.tick().any(), "what is felt now is what was felt at entry"


@pytest.mark.parametrize("seed", range(5))
def test_it_is_told_alike_whatever_the_joints_feel(seed: int) -> None:
    """Against numpy, with all causes and what is known of them drawn."""
    rng = np.random.default_rng(seed)
    joints = Joints().moving()
    root = rng.normal(size=joints.covariance.shape) * 0.02
    joints.covariance[:] = root @ root.T
    joints.shares[:] = rng.normal(size=joints.shares.shape) * 0.1
    joints.felt[:] = rng.normal(size=joints.felt.shape)
    joints.bias = tuple(rng.normal(size=ZERO).tolist())
    before, bias = joints.felt.copy(), np.array(joints.bias)
    joints.begun()
    joints.felt[:] += rng.normal(size=joints.felt.shape)
    joints.felt[:, 0] *= 4.0
    joints.bias = tuple((bias + 0.2 * rng.normal(size=ZERO)).tolist())
    change = joints.felt - before
    expected = np.zeros(N)
    for i in range(N):
        where = [at(i, k) for k in range(CAUSES)]
        left = change[i, 0] - joints.shares[i] @ change[i, 1:] + (np.array(joints.bias) - bias) @ joints.felt[i, 2 : 2 + ZERO]
        wrong = change[i, 1:] @ joints.covariance[np.ix_(where, where)] @ change[i, 1:]
        wrong += DOUBT**2 + (LINK_MASS * change[i, 1]) ** 2
        expected[i] = left * (abs(left) > CONTACT * np.sqrt(wrong))
    assert expected.any()
    assert joints.tick() == pytest.approx(expected)
    assert joints.hand.certain == pytest.approx(expected)


@pytest.mark.parametrize("felt", [True, False])
def test_a_hand_leads_the_arm_by_a_link_because_the_joints_feel_it(felt: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    """15 N at the forearm, with all mismatch; with what the joints feel taken away the same hand is stopped."""
    if not felt:
        monkeypatch.setattr(LinkHand, "update", lambda self, bias, qd, by_deflection: self.forget())
    bench = Device(Scenario(seed=3))
    bench.run(1.0)
    bench.enter()
    before = bench.plant.data.body("flange").xpos.copy()
    bench.run(1.2, Push("wrist_1", CENTRE, (0.0, 15.0, 0.0)))
    assert (bench.mode is Mode.FREE_DRIVE) is felt
    assert (np.linalg.norm(bench.plant.data.body("flange").xpos - before) > 0.2) == felt
    told = bench.simulation.estimate
    assert told.whose.tau_hand.any() == felt
    assert told.whose.tau_certain.any() == felt
    if felt:  # what is told in free-drive only
        torques = (told.whose.tau_hand, told.whose.tau_certain, told.friction)
        assert told.whose.powers == pytest.approx([torque @ told.qd for torque in torques])
        assert all(told.whose.powers)
    assert [event.kind for event in bench.events if event.kind is Kind.STOPPED_MOTION] == [Kind.STOPPED_MOTION] * (not felt)
