"""Whether the joints feel what a suspected step of the flange sensor tells (FD-19)."""

import math

import numpy as np
import pytest
from numpy.typing import NDArray

from app.files.library import load_arm
from pendant.sensor.hand_model import KNOWN, SUSPECTED
from sim.arm.chain import Body, chain
from sim.flange.external_wrench import ExternalWrench
from sim.flange.flange_forces import FlangeForces
from sim.flange.step_answer import ANSWER, StepAnswer, answer
from sim.rigid_body.dynamics import Dynamics

Array = NDArray[np.float64]
UR5E = load_arm("ur5e")
LOAD = Body(2.0, np.array([0.01, -0.02, 0.05]), np.eye(3) * 0.002)
STEP = np.array([6.0, -8.0, 4.0, 0.0, 0.0, 0.3])
"""Axes of B [N, N·m]."""
TREMOR = 0.02
"""Of the torques, standard deviation [N·m]."""


class Joints:
    """Joints that feel what a test wants, after an onset with the odds that it wants."""

    def __init__(self, onset: float = 6.0, seed: int = 0) -> None:
        rigid = chain(UR5E)
        dynamics = Dynamics(rigid, rigid.links, LOAD, mounting=[0.0] * 3, elbow=UR5E.chain.elbow)
        posture, still = np.array(UR5E.chain.home), np.zeros((3, UR5E.n))
        dynamics.recursion.run(posture, still, np.zeros(3))
        self.forces = FlangeForces(dynamics)
        self.wrench = ExternalWrench(UR5E, self.forces)
        self.answer = StepAnswer(UR5E.n, UR5E.accuracy.stiffness)
        self.own = self.answer.record[0]
        self.onset, self.rng = onset, np.random.default_rng(seed)
        self.torques = dynamics.recursion.jacobian.T @ STEP

    def tick(self, apart: Array, age: int = 0) -> float:
        """`apart` is what the sensor's wrench makes beyond what the joints feel; a step is suspected at this age."""
        own = self.wrench.record[0]
        own["stepped"], own["step"], own["age"], own["jump"] = -math.inf, math.hypot(6.0, -8.0, 4.0), age, STEP
        if age:
            own["stepped"] = self.onset
        self.forces.record[0]["apart"] = apart + TREMOR * self.rng.normal(size=UR5E.n)
        answer(self.answer.record, (self.forces.record, self.forces.model), self.wrench.record)
        return float(self.own["odds"])

    def quiet(self, before: Array, ticks: int = 200) -> None:
        for _ in range(ticks):
            assert self.tick(before) == -math.inf

    def course(self, share: float, ticks: int = 100, after: float | None = None) -> list[float]:
        """The onset is suspected two ticks after it; from then on the torques are off by a share of the step's."""
        before = np.full(UR5E.n, 2.0)  # as a wrong payload makes them
        self.quiet(before)
        told = [self.tick(before + share * self.torques), self.tick(before + share * self.torques, 2)]
        for tick in range(2, ticks):
            now = share if after is None or tick < ANSWER else after
            told.append(self.tick(before + now * self.torques))
        return told


@pytest.mark.parametrize("seed", range(4))
def test_what_the_joints_do_not_feel_is_the_sensors(seed: int) -> None:
    joints = Joints(seed=seed)
    told = joints.course(1.0)
    assert told[1:ANSWER] == [joints.onset] * (ANSWER - 1), "until they have answered the onset alone counts"
    assert told[ANSWER + 1] > KNOWN
    assert joints.own["size"] == pytest.approx(math.hypot(6.0, -8.0, 4.0))


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("share", [0.0, 0.2, -0.2])
def test_what_they_feel_is_a_force(share: float, seed: int) -> None:
    """Within what is known of the gears' stiffness."""
    told = Joints(seed=seed).course(share, 3 * ANSWER)
    answered, over = told[ANSWER + 1 : 2 * ANSWER + 2], told[2 * ANSWER + 2 :]
    assert -math.inf < max(answered) < -SUSPECTED, "they are heard for as long as they took"
    assert over == [-math.inf] * (ANSWER - 2), "then nothing is suspected any more"


@pytest.mark.parametrize("share", [0.0, 1.0])
@pytest.mark.parametrize("turn", [0.0, 0.5, 1.0, 1.5])
def test_an_arm_that_swings_about_its_answer_is_heard_out(share: float, turn: float) -> None:
    """By as much as the step makes, in 50 ms, wherever the swing begins."""
    joints, before = Joints(onset=-4.0), np.full(UR5E.n, 2.0)
    joints.quiet(before)
    told = [
        joints.tick(before + (share + math.sin(math.pi * (tick / 12.5 + turn))) * joints.torques, 2 if tick == 2 else 0)
        for tick in range(1, 2 * ANSWER)
    ]
    assert (told[-1] > SUSPECTED) is (share == 1.0)
    assert (told[-1] < -SUSPECTED) is (share == 0.0)


def test_what_neither_explains_is_no_evidence() -> None:
    joints = Joints()
    told = joints.course(1.0, after=20.0)
    assert told[-1] == pytest.approx(joints.onset, abs=1e-6)


def test_it_goes_on_until_the_joints_decide() -> None:
    """An arm that swings when they should answer."""
    joints = Joints()
    told = joints.course(20.0, ticks=100, after=None)
    assert told[-1] == pytest.approx(joints.onset, abs=1e-6)
    before = np.full(UR5E.n, 2.0)
    assert [joints.tick(before) for _ in range(500)][-1] == -math.inf


@pytest.mark.parametrize(("onset", "suspected"), [(-KNOWN, True), (-KNOWN - 1e-6, False)])
def test_it_begins_unless_a_hand_is_sure(onset: float, suspected: bool) -> None:
    joints = Joints(onset)
    told = joints.course(1.0)
    assert told[1] == onset
    assert (told[2] == onset) is suspected
    assert (told[-1] > onset) is suspected


def test_the_likeliest_onset_of_the_window_counts() -> None:
    joints, before = Joints(), np.zeros(UR5E.n)
    joints.quiet(before)
    for age, odds in ((2, 1.0), (3, 4.0), (4, 2.0)):
        joints.onset = odds
        joints.tick(before + joints.torques, age)
    assert joints.own["odds"] == 4.0


def test_what_is_forgotten_is_suspected_no_more() -> None:
    joints = Joints()
    joints.course(1.0, ticks=10)
    assert joints.own["odds"] > -math.inf
    joints.answer.forget()
    assert joints.own["odds"] == -math.inf
    assert joints.tick(joints.torques) == -math.inf
