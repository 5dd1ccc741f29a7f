"""The payload's error as the joints of an arm at rest tell it (FD-9)."""

import math
from dataclasses import replace

import numpy as np
import pytest

from pendant.inputs import Command
from pendant.program.steps import JointMove, Program, ProgramState
from sim.arm.chain import Body, chain
from sim.arm.scenario import Load, Scenario
from sim.estimation.torque_balance import missing_mass
from sim.estimation.transmission_torque import DEFLECTION, DYNAMICS, MOTOR, TransmissionTorque
from sim.flange.external_wrench import ExternalWrench
from sim.flange.flange_forces import FlangeForces
from sim.plant.changes import AttachPayload, SensorFault
from sim.rigid_body.dynamics import Dynamics
from tests.sim.arms import UR5E
from tests.sim.bench import LONG, Bench

N = UR5E.n
Q = np.array([0.3, -1.2, 1.5, -0.8, -1.2, 0.7])
PAYLOAD = Body(1.5, np.array([0.01, -0.02, 0.08]), np.zeros((3, 3)))
ALL = np.ones((3, N), dtype=bool)


class Standing:
    """An arm at rest, some `mass` of whose payload nobody told of [kg]."""

    def __init__(self, mass: float) -> None:
        told, true = self.carrying(PAYLOAD), self.carrying(replace(PAYLOAD, mass=PAYLOAD.mass + mass))
        for arm in (true, told):
            arm.recursion.run(Q, np.zeros((3, N)), np.zeros(3))
        self.lever = (true.recursion.torque - told.recursion.torque) / mass
        self.model, self.wrench = told.recursion.record, ExternalWrench(UR5E, FlangeForces(told))
        self.wrench.set_load(PAYLOAD, PAYLOAD)
        self.gears = TransmissionTorque(UR5E, np.ones(N))
        self.gears.ways[:] = told.recursion.torque
        self.gears.ways[1:] += mass * self.lever
        self.gears.deviations[1], self.gears.deviations[2] = np.linspace(1.0, 2.0, N), 3.0
        self.gears.record[0]["model"] = np.linspace(0.2, 0.7, N)

    @staticmethod
    def carrying(load: Body) -> Dynamics:
        rigid = chain(UR5E)
        return Dynamics(rigid, rigid.links, load, mounting=[0.0] * 3, elbow=UR5E.chain.elbow)

    def told(self, use: np.ndarray = ALL) -> tuple[float, float]:
        return missing_mass(self.gears.record, self.model, self.wrench.record, use)


@pytest.mark.parametrize("mass", [-1.5, 0.2, 3.0])
def test_the_mass_is_what_the_joints_bear_beyond_the_model_and_its_deviation_that_of_least_squares(mass: float) -> None:
    standing = Standing(mass)
    found, deviation = standing.told()
    both = 1.0 / (standing.gears.deviations[1] ** -2.0 + standing.gears.deviations[2] ** -2.0)
    variance = both + standing.gears.record[0]["model"] ** 2
    assert found == pytest.approx(mass)
    assert deviation == pytest.approx(np.sum(standing.lever**2 / variance) ** -0.5)


@pytest.mark.parametrize("way", [DEFLECTION, MOTOR])
def test_a_way_that_is_not_known_tells_nothing(way: int) -> None:
    standing, use = Standing(1.0), ALL.copy()
    use[way] = False
    standing.gears.ways[way] = np.nan
    alone = standing.gears.deviations[MOTOR if way == DEFLECTION else DEFLECTION]
    variance = alone**2 + standing.gears.record[0]["model"] ** 2
    assert standing.told(use) == pytest.approx((1.0, np.sum(standing.lever**2 / variance) ** -0.5))


@pytest.mark.parametrize("lost", [[DYNAMICS], [DEFLECTION, MOTOR]])
def test_a_joint_that_has_nothing_to_compare_tells_nothing(lost: list[int]) -> None:
    standing, use = Standing(1.0), ALL.copy()
    use[lost, 1] = False
    standing.gears.ways[:, 1] += np.array([0.0, 9.0, 9.0])
    assert standing.told(use)[0] == pytest.approx(1.0)
    use[lost] = False
    assert standing.told(use) == (0.0, math.inf)


def carrying(mass: float) -> Load:
    return Load(mass=mass, com=[0.0, 0.0, 0.05])


@pytest.mark.parametrize("more", [-1.0, 0.0, 1.0])
def test_an_arm_whose_gears_have_been_learned_tells_a_changed_payload_to_a_third_of_a_kilogram(more: float) -> None:
    """With all mismatch: stiffness is wrong by up to a fifth. Before a program has moved the arm one kilogram is no certainty."""
    bench = Bench(Scenario(payload_true=carrying(2.0), payload_configured=carrying(2.0), seed=5), LONG)
    bench.change(SensorFault(sensor="force_torque", outage=True))
    bench.run(1.0)
    new = bench.estimate.missing_mass[1]
    assert new > 0.3
    home = bench.estimate.q.copy()
    ends = [home + turn * np.array([0.8, 0.6, -0.7, 0.9, -0.6, 0.5]) for turn in (1.0, -0.7, 0.0)]
    moves = Program(steps=tuple(JointMove(q=tuple(end.tolist())) for end in ends))
    bench.do(program=moves)
    bench.do(Command.START_PROGRAM)
    while bench.tick().program is ProgramState.RUNNING:
        pass
    bench.run(1.0)
    if more:
        bench.change(AttachPayload(load=carrying(2.0 + more)))
        bench.run(1.0)
    mass, deviation = bench.estimate.missing_mass
    assert deviation < 0.5 * new
    assert mass == pytest.approx(more, abs=0.33)
    bench.change(SensorFault(sensor="force_torque"))
    bench.run(0.1)
    assert bench.estimate.missing_mass == (0.0, math.inf), "with the sensor it is not asked"
