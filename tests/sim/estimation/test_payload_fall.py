"""Whether the payload fell, as the joints alone tell it (FD-19)."""

import math
from types import SimpleNamespace
from typing import cast

import numpy as np
import pytest
from msgspec.structs import replace
from numpy.typing import NDArray

from pendant.events.event import Kind
from pendant.sensor.hand_model import RARELY
from pendant.tick.estimate import JointsFeel
from pendant.tick.modes import TICK, Mode
from sim.arm.chain import Body, chain
from sim.arm.joint_constants import ripple_torque
from sim.arm.scenario import Load, Scenario
from sim.estimation.momentum_observer import BANDWIDTH, MomentumObserver, follow
from sim.estimation.payload_fall import JointTorques, PayloadFall
from sim.estimation.sudden_change import MEAN, SEEN
from sim.estimation.transmission_torque import TransmissionTorque
from sim.exchange.desk import Wishes
from sim.flange.external_wrench import ExternalWrench
from sim.flange.flange_forces import FlangeForces
from sim.flange.wrench_hypotheses import LONGEST
from sim.plant.changes import DropPayload, SensorFault
from sim.plant.touch import Pull, Push
from sim.rigid_body.dynamics import Dynamics
from tests.sim.arms import UR5E
from tests.sim.bench import CENTRE, LONG, NOTHING, Bench

Array = NDArray[np.float64]
N = UR5E.n
PAYLOAD = Body(3.0, np.array([0.01, -0.02, 0.08]), np.eye(3) * 0.004)
BENT = np.array([0.3, -1.2, 1.5, -0.8, -1.2, 0.7])
STILL = np.zeros((3, N))
MOTION = np.array([[0.0] * N, [0.1, -0.3, 0.2, 0.5, -0.4, 0.2], [0.5, 1.0, -0.8, 0.4, 0.3, -0.2]])
STIFFNESS = UR5E.accuracy.stiffness
RIPPLE = ripple_torque(UR5E)
SETTLED = 100
"""Ticks after which the mean of the last ticks is that of one."""
LATE = 2.0 / (2.0 * np.pi * BANDWIDTH) + 0.5 * TICK
"""Of the torques, and of what a payload needs [s]: two filters, and the speed is that between two ticks."""

SENSORLESS = replace(UR5E, sensors=replace(UR5E.sensors, force_torque=None, accelerometer=None, gyro=None))


class Joints:
    """An arm in one motion, of constant acceleration, whose joints feel what a test wants."""

    def __init__(self, payload: Body = PAYLOAD, motion: Array = STILL) -> None:
        self.payload, self.motion, self.t = payload, motion, 0.0
        self.model, self.by_motor, self.ready = np.full(N, 20.0), np.zeros(N), True
        self.arm, self.bare = (self.carrying(load) for load in (payload, Body(0.0, np.zeros(3), np.zeros((3, 3)))))
        self.lost = self.needed(0.0)
        wrench = ExternalWrench(UR5E, FlangeForces(self.arm))
        wrench.set_load(payload, payload)
        self.felt = JointTorques(
            cast(MomentumObserver, SimpleNamespace()),
            cast(TransmissionTorque, SimpleNamespace(by_motor=self.by_motor)),
            np.zeros(N),
        )
        self.fall = PayloadFall(UR5E, self.arm.recursion, self.felt, wrench)

    @staticmethod
    def carrying(load: Body) -> Dynamics:
        rigid = chain(UR5E)
        return Dynamics(rigid, rigid.links, load, mounting=[0.0] * 3, elbow=UR5E.chain.elbow)

    def at(self, t: float) -> Array:
        """The joint angles then."""
        return BENT + self.motion[1] * t + 0.5 * self.motion[2] * t**2

    def needed(self, t: float) -> Array:
        """What the payload alone takes of each joint then [N·m], by the rigid model with it and without."""
        now = np.stack([0.0 * BENT, self.motion[1] + self.motion[2] * t, self.motion[2]])
        for each in (self.bare, self.arm):  # the last one stays as it is in this tick
            each.recursion.run(self.at(t), now, np.zeros(3))
        return self.arm.recursion.torque - self.bare.recursion.torque

    def tick(self, external: Array, *, free: bool = True, sensed: bool = False) -> bool:
        self.t += TICK
        self.needed(self.t)
        momentum, transmission, deflection = self.felt
        momentum.residual, momentum.__dict__["ready"] = external, self.ready
        deflection[:] = self.model - external
        transmission.ways = np.stack([self.model, deflection, deflection])
        fell, self.feels = self.fall.update(self.at(self.t), free=free, sensed=sensed)
        return fell

    def course(self, external: Array, before: Array | float = 0.0, ticks: int = SETTLED) -> list[bool]:
        """The joints feel `before`, and then `external` beyond it."""
        for _ in range(5):
            assert not self.tick(np.zeros(N) + before)
        return [self.tick(external + before) for _ in range(ticks)]


def filtered(rise: int) -> list[float]:
    """Tick by tick, what the observer and the filter behind it make of a change from 0 to 1 in so many ticks."""
    first, second, found = np.zeros(1), np.zeros(1), []
    for tick in range(SETTLED):
        follow(first, second, min((tick + 1) / rise, 1.0), 0)
        found.append(float(second[0]))
    return found


def test_what_the_payload_needs_at_rest_is_its_fall() -> None:
    joints = Joints()
    told = [joints.tick(share * joints.lost) for share in [0.0] * SEEN + filtered(1)]
    assert told[-1]
    late = [joints.tick(0.0 * joints.lost) for _ in range(2 * SEEN)]
    assert not late[-1]
    assert filtered(1)[told.index(True) - SEEN] < 1.0 - STIFFNESS, "known by how it comes, before it is there"


def test_where_the_noise_hides_how_it_comes_it_is_told_by_what_it_is() -> None:
    joints, rng = Joints(), np.random.default_rng(1)
    told = [
        joints.tick(share * joints.lost + 0.06 * rng.normal() * joints.lost)
        for share in [0.0] * SEEN + [0.2, 0.6] + [1.0] * SETTLED
    ]
    assert LONGEST - MEAN + 4 <= told.index(True) - SEEN < SEEN


@pytest.mark.parametrize("most", [1.0, 1.1])
@pytest.mark.parametrize("rise", [15, 20, 25, 40])
def test_what_comes_as_a_hand_brings_it_about_is_no_fall(rise: int, most: float) -> None:
    joints = Joints()
    assert not any(joints.tick(most * share * joints.lost) for share in [0.0] * SEEN + filtered(rise))
    assert joints.feels is JointsFeel.FALL, "it may be one, and nothing helps it"


def test_a_hand_that_bore_most_of_the_weight_before_is_no_fall_if_it_bears_all() -> None:
    joints = Joints()
    shares = [*(0.6 * share for share in filtered(40)), *(0.6 + 0.4 * share for share in filtered(1))]
    assert not any(joints.tick(share * joints.lost) for share in shares)


def test_what_it_needs_in_its_motion_is_known_as_late_as_the_torques() -> None:
    joints = Joints(motion=MOTION * np.array([[1.0], [1.0], [8.0]]))
    told = [joints.tick(joints.needed(joints.t - LATE) if k > 5 else np.zeros(N)) for k in range(60)]
    assert told[-1]
    memory = joints.fall._own
    by_momentum = joints.arm.recursion.jacobian.T @ memory["needed"][1]
    wanted = joints.needed(joints.t - LATE)
    assert np.abs(by_momentum - wanted).max() < 0.01 * np.abs(wanted).max()
    joints.motion = STILL
    assert np.abs(joints.needed(0.0) - wanted).max() > 0.1 * np.abs(wanted).max(), "that is not its weight alone"


@pytest.mark.parametrize(("known", "feels"), [(True, JointsFeel.NOTHING), (False, JointsFeel.HAND)])
def test_what_it_takes_to_accelerate_a_payload_that_was_told_wrong_is_no_hand(known: bool, feels: JointsFeel) -> None:
    """The joints knew of it at entry, by its weight."""
    falls = STILL + np.array([[0.0], [0.0], [1.0]]) * np.array([1.0, 8.0, -6.0, 3.0, 2.0, 1.0])
    told, untold = (Body(mass, PAYLOAD.com, np.zeros((3, 3))) for mass in (1.0, 2.0))
    joints, more = Joints(told, falls), Joints(untold, falls)
    weight = Joints(untold).lost
    before = weight if known else 0.0 * weight
    joints.tick(before)
    for _ in range(40):
        swings = more.needed(joints.t - LATE) - weight
        joints.tick(before + swings)
    assert (np.abs(swings) > 1.2 * RIPPLE).any()
    assert joints.feels is feels


def test_while_the_observer_begins_nothing_is_felt() -> None:
    joints = Joints()
    joints.ready = False
    assert not any(joints.course(joints.lost))
    assert joints.feels is JointsFeel.NOTHING
    joints.ready = True
    assert [joints.tick(joints.lost) for _ in range(SETTLED)].index(True) >= LONGEST - MEAN


def test_what_was_felt_at_entry_is_no_fall() -> None:
    joints = Joints()
    assert joints.course(joints.lost, before=2.0 * joints.lost)[-1]
    joints = Joints()
    assert not any(joints.course(0.0 * joints.lost, before=joints.lost))


@pytest.mark.parametrize(
    ("share", "fell"),
    [(1.0 / (1.0 + 0.99 * STIFFNESS), True), (1.0 / (1.0 + 1.01 * STIFFNESS), False), (1.24, True), (1.26, False), (-1.0, False)],
)
def test_the_change_is_told_as_well_as_the_gears_stiffness_is_known(share: float, fell: bool) -> None:
    """|x - 1| < STIFFNESS x, from 1 / 1.2 to 1 / 0.8 of the payload; on its way there a push may be within for some ticks."""
    joints = Joints()
    assert joints.course(share * joints.lost)[-1] is fell


@pytest.mark.parametrize("joint", range(N))
def test_a_push_on_one_link_is_no_fall(joint: int) -> None:
    joints = Joints()
    assert not any(joints.course(40.0 * np.eye(N)[joint]))


@pytest.mark.parametrize("joint", range(N))
@pytest.mark.parametrize(("share", "feels"), [(0.99, JointsFeel.NOTHING), (1.01, JointsFeel.HAND), (-1.01, JointsFeel.HAND)])
def test_within_the_ripple_of_each_encoder_it_is_nobody_and_beyond_it_of_one_a_hand(
    joint: int, share: float, feels: JointsFeel
) -> None:
    joints = Joints(Body(0.0, np.zeros(3), np.zeros((3, 3))))
    joints.course(share * np.diag(RIPPLE)[joint])
    assert joints.feels is feels


@pytest.mark.parametrize("way", [1.0, -1.0])
@pytest.mark.parametrize(("share", "feels"), [(0.99, JointsFeel.NOTHING), (1.01, JointsFeel.HAND)])
def test_of_what_a_gear_bears_more_or_less_than_at_entry_its_stiffness_hides_a_share(
    share: float, feels: JointsFeel, way: float
) -> None:
    joints = Joints(Body(0.0, np.zeros(3), np.zeros((3, 3))))
    joints.tick(np.zeros(N))
    joints.model = joints.model + way * 10.0
    joints.course(share * (RIPPLE + 10.0 * STIFFNESS))
    assert joints.feels is feels


@pytest.mark.parametrize("joint", range(N))
@pytest.mark.parametrize(("share", "feels"), [(0.99, JointsFeel.NOTHING), (1.01, JointsFeel.HAND)])
def test_a_joint_whose_motor_tells_its_torque_is_believed_as_far_as_that_is(joint: int, share: float, feels: JointsFeel) -> None:
    joints = Joints(Body(0.0, np.zeros(3), np.zeros((3, 3))))
    joints.by_motor[joint] = 4.0
    joints.course(share * RARELY * joints.by_motor)
    assert joints.feels is feels


@pytest.mark.parametrize("way", [1.0, -1.0])
@pytest.mark.parametrize(("share", "feels"), [(0.99, JointsFeel.FALL), (1.01, JointsFeel.HAND)])
@pytest.mark.parametrize("joint", [1, 2])
def test_what_a_fallen_payload_explains_to_within_that_may_be_its_fall(
    joint: int, share: float, feels: JointsFeel, way: float
) -> None:
    joints = Joints()
    off = way * share * (RIPPLE + STIFFNESS * np.abs(joints.lost)) * np.eye(N)[joint]
    joints.course(joints.lost + off)
    assert joints.feels is feels
    for _ in range(SETTLED):
        joints.tick(np.zeros(N))
    assert joints.feels is JointsFeel.NOTHING


@pytest.mark.parametrize(("share", "feels"), [(0.99, JointsFeel.HAND), (1.01, JointsFeel.FALL)])
def test_a_payload_that_no_joint_would_miss_explains_nothing(share: float, feels: JointsFeel) -> None:
    whole = Joints().lost
    mass = share * PAYLOAD.mass / float(np.max(np.abs(whole) / RIPPLE))
    joints = Joints(Body(mass, PAYLOAD.com, np.zeros((3, 3))))
    felt = np.where(np.abs(joints.lost) == np.max(np.abs(joints.lost)), joints.lost + 0.5 * np.sign(joints.lost) * RIPPLE, 0.0)
    joints.course(felt)
    assert joints.feels is feels


def test_outside_free_drive_and_while_the_flange_sensor_tells_nothing_is_felt() -> None:
    joints = Joints()
    for sensed in (True, False):
        joints.tick(np.zeros(N), sensed=sensed)
        for _ in range(SETTLED):
            joints.tick(40.0 * np.ones(N), sensed=sensed)
        assert joints.feels is (JointsFeel.NOTHING if sensed else JointsFeel.HAND)
    joints.tick(40.0 * np.ones(N), free=False)
    assert joints.feels is JointsFeel.NOTHING


def test_a_payload_lighter_than_the_ripple_of_the_encoders_says_nothing() -> None:
    light = Joints(Body(0.2, PAYLOAD.com, np.zeros((3, 3))))
    assert np.linalg.norm(light.lost) < 3.0
    assert not any(light.course(light.lost))


def test_without_a_payload_nothing_falls() -> None:
    joints = Joints(Body(0.0, np.zeros(3), np.zeros((3, 3))))
    assert not any(joints.course(Joints().lost))


def test_while_the_flange_sensor_tells_the_joints_do_not() -> None:
    joints = Joints()
    joints.tick(np.zeros(N), sensed=True)
    assert not any(joints.tick(joints.lost, sensed=True) for _ in range(SETTLED))


@pytest.mark.parametrize(("joint", "share"), [(1, 1.2), (2, -1.5), (5, 3.0)])
def test_the_torques_of_a_hand_are_the_change_since_entry(joint: int, share: float) -> None:
    joints, before = Joints(), np.linspace(-3.0, 2.0, N)
    joints.tick(before)
    assert not joints.fall.torque.any()
    change = share * RIPPLE * np.eye(N)[joint]
    for _ in range(MEAN):
        joints.tick(before + change)
    assert joints.feels is JointsFeel.HAND
    assert joints.fall.torque == pytest.approx(change)
    wrong = RIPPLE + STIFFNESS * abs(joints.model - joints.fall._own["entry"])
    assert joints.fall.certain == pytest.approx(np.sign(share) * (abs(change) - wrong) * np.eye(N)[joint])
    for _ in range(MEAN):
        joints.tick(before)
    assert joints.feels is JointsFeel.NOTHING
    assert not joints.fall.torque.any()
    assert not joints.fall.certain.any()


@pytest.mark.parametrize("how", ["left", "not ready"])
def test_a_hand_makes_no_torques_any_more_when_nothing_is_asked(how: str) -> None:
    joints = Joints()
    joints.tick(np.zeros(N))
    for _ in range(MEAN):
        joints.tick(3.0 * RIPPLE)
    assert joints.fall.torque.any()
    joints.ready = how == "left"
    joints.tick(3.0 * RIPPLE, free=how != "left")
    assert not joints.fall.torque.any()
    assert not joints.fall.certain.any()


def test_each_free_drive_has_a_beginning_of_its_own() -> None:
    joints = Joints()
    assert joints.course(joints.lost)[-1]
    assert not joints.tick(joints.lost, free=False)
    assert not any(joints.tick(joints.lost) for _ in range(SETTLED))


def arm(payload: float, *, sensor: bool, outage: bool = True) -> Bench:
    """A free arm, with all mismatch, whose flange sensor is not there or out, unless it has no outage."""
    load = Load(mass=payload, com=[0.0, 0.0, 0.05])
    scenario = Scenario(payload_true=load, payload_configured=load, seed=7)
    bench = Bench(scenario, LONG, UR5E if sensor else SENSORLESS)
    if sensor and outage:
        bench.change(SensorFault(sensor="force_torque", outage=True))
    bench.run(1.0)
    bench.enter()
    return bench


@pytest.mark.parametrize("sensor", [False, True])
@pytest.mark.parametrize("payload", [2.0, 4.5])
def test_a_payload_that_falls_off_an_arm_that_cannot_feel_its_flange_is_a_stop(payload: float, sensor: bool) -> None:
    bench = arm(payload, sensor=sensor)
    start = bench.plant.data.body("flange").xpos[2]
    bench.change(DropPayload())
    bench.run(0.1)
    assert bench.mode is Mode.STOP
    (told,) = (event for event in bench.events if event.kind is Kind.STOPPED_PAYLOAD)
    assert told.values["mass"] == pytest.approx(-payload)
    bench.run(1.0)
    assert bench.plant.data.body("flange").xpos[2] - start < 0.02, "[m]; it rose by a metre"


@pytest.mark.parametrize("force", [[30.0, 0.0, 0.0], [0.0, 0.0, -30.0], [0.0, 25.0, 15.0], [0.0, 0.0, 90.0]])
def test_a_hand_is_no_fall(force: list[float]) -> None:
    x, y, z = force
    bench = arm(3.0, sensor=False)
    bench.run(0.08, Push("flange", CENTRE, (x, y, z)))
    assert not [event for event in bench.events if event.kind is Kind.STOPPED_PAYLOAD]


@pytest.mark.parametrize("sensor", [False, True])
def test_of_a_flange_sensor_that_is_not_there_nothing_is_asked(sensor: bool) -> None:
    bench = arm(3.0, sensor=sensor)
    bench.change(DropPayload())
    for _ in range(20):
        bench.run(TICK)
        assert (bench.estimate.whose.lost_odds, bench.estimate.whose.step_odds) == (-math.inf, -math.inf)


def test_a_flange_sensor_that_comes_back_in_free_drive_is_not_asked_whose_torques_the_joints_feel() -> None:
    """They are those of all contacts to the end; then they are those behind the sensor again."""
    bench = arm(3.0, sensor=True)
    bench.change(SensorFault(sensor="force_torque"))
    bench.run(0.2, Push("flange", CENTRE, (0.0, 30.0, 0.0)))
    estimator, estimate = bench.simulation.estimator, bench.estimate
    assert estimate.wrench_valid
    assert estimate.whose.joints_feel is JointsFeel.HAND
    np.testing.assert_array_equal(estimate.whose.tau_hand, estimator.fall.torque)
    np.testing.assert_allclose(estimate.whose.tau_hand, estimator.momentum.residual - estimator.fall._own["before"], atol=3.0)
    torques = (estimate.whose.tau_hand, estimate.whose.tau_certain, estimate.friction)
    assert estimate.whose.powers == pytest.approx([torque @ estimate.qd for torque in torques])
    assert all(estimate.whose.powers)
    assert (estimate.whose.F_link == 0.0).all()


@pytest.mark.parametrize("size", [20.0, -20.0])
def test_a_flange_sensor_that_steps_ends_free_drive(size: float) -> None:
    """Nobody touches the arm: it stays where it is."""
    bench = arm(3.0, sensor=True, outage=False)
    bench.run(0.5)
    start = bench.flange.copy()
    bench.change(*(SensorFault(sensor="force_torque", channel=k, offset=size) for k in range(2)))
    bench.run(2.0)
    assert [event.kind for event in bench.events if event.kind is Kind.SENSOR_STEPPED] == [Kind.SENSOR_STEPPED]
    assert bench.mode is Mode.STOP
    assert np.linalg.norm(bench.flange - start) < 0.001


@pytest.mark.parametrize("rise", [0.03, 0.05])
def test_a_hand_that_pushes_upward_as_hard_as_the_payload_weighs_is_no_fall(rise: float) -> None:
    bench, ticks = arm(2.0, sensor=False), round(rise / TICK)
    for tick in range(2 * ticks):
        force = 2.0 * 9.81 * min((tick + 1) / ticks, 1.0)
        bench.tick(Wishes(NOTHING, (Push("flange", (0.0, 0.0, 0.05), (0.0, 0.0, force)),), ()))
    assert not [event for event in bench.events if event.kind is Kind.STOPPED_PAYLOAD]


def test_a_hand_that_leads_is_no_fall() -> None:
    bench = arm(3.0, sensor=False)
    start = bench.plant.data.body("flange").xpos.copy()
    for tick in range(500):
        target = start + 0.1 * tick / 500 * np.array([0.3, 0.9, 0.3])
        bench.tick(Wishes(NOTHING, (Pull("flange", CENTRE, tuple(target.tolist()), 40.0),), ()))
    assert not [event for event in bench.events if event.kind is Kind.STOPPED_PAYLOAD]
