"""A step that pushes: what is met feels the force, whatever it is; where nothing is met, it ends (CD-15)."""

import numpy as np
import pytest

from benchmarks.contacts.recording import contact_force
from pendant.events.event import Kind
from pendant.inputs import Command
from pendant.program.reaction import Until
from pendant.program.steps import ApplyForce, LinearMove, Program
from pendant.tick.modes import Mode
from sim.arm.frames import quaternion_from_matrix
from sim.arm.scenario import BoxObject, Load, Scenario
from sim.motion.force_move import ForceTrajectory
from sim.motion.moves import MoveRefused
from sim.paths.tool_point import ToolPoint
from sim.plant.changes import SensorFault
from tests.sim.arms import PROBE, UR5E
from tests.sim.bench import Bench
from tests.sim.motion.test_moves import RANGE, TCP, model

DOWN = (0.0, 0.0, -15.0)


def bench(stiffness: float | None) -> Bench:
    """Above a block, or above nothing; the configured payload is wrong by 200 g."""
    block = BoxObject(name="block", position=[-0.6282, -0.1335, -0.03], size=[0.2, 0.2, 0.2], stiffness=stiffness or 1e4)
    world = [] if stiffness is None else [block]
    load = Load(mass=1.0, com=[0.0, 0.0, 0.05])
    scenario = Scenario(seed=4, tool=PROBE, payload_true=Load(mass=1.2, com=load.com), payload_configured=load, world=world)
    return Bench(scenario)


def ended(bench: Bench, *steps: LinearMove | ApplyForce, seconds: float) -> None:
    bench.run(0.3)
    bench.do(program=Program(steps=steps))
    bench.do(Command.START_PROGRAM)
    for _ in range(round(10 * seconds)):
        bench.run(0.1)
        if bench.mode is not Mode.RUN:
            return


def touch(bench: Bench) -> LinearMove:
    """Straight down until it touches."""
    bench.run(0.1)
    x, y, z = bench.simulation.estimate.tcp[:3].tolist()
    R = bench.simulation.estimate.R_BF
    w, i, j, k = quaternion_from_matrix(R).tolist()
    return LinearMove(position=(x, y, z - 0.2), quaternion=(w, i, j, k), speed=0.1, until=Until(change="gained"))


@pytest.mark.parametrize("stiffness", [3e3, 2e5])
def test_what_is_met_feels_the_force(stiffness: float) -> None:
    """Within the tolerance of 2 N and what the sensor adds, whatever the arm pressed with before."""
    arm = bench(stiffness)
    ended(arm, touch(arm), ApplyForce(force=DOWN, duration=0.3), seconds=8.0)
    assert arm.events[-1].kind is Kind.PROGRAM_FINISHED
    assert contact_force(arm.simulation) == pytest.approx(15.0, abs=3.0)


def test_where_nothing_resists_it_ends_and_says_so() -> None:
    arm = bench(None)
    speeds = []
    arm.run(0.3)
    arm.do(program=Program(steps=(ApplyForce(force=DOWN, distance=0.01, speed=0.02),)))
    arm.do(Command.START_PROGRAM)
    for _ in range(400):
        arm.run(0.01)
        speeds.append(arm.simulation.estimate.v_tcp)
        if arm.mode is not Mode.RUN:
            break
    (failed,) = [event for event in arm.events if event.kind is Kind.PROGRAM_FAILED]
    assert "N after 10 mm" in str(failed.values["reason"])
    assert max(speeds) < 0.04


def test_it_ends_when_the_force_sensor_fails() -> None:
    arm = bench(None)
    arm.run(0.3)
    arm.do(program=Program(steps=(ApplyForce(force=DOWN),)))
    arm.do(Command.START_PROGRAM)
    arm.run(0.1)
    arm.change(SensorFault(sensor="force_torque", outage=True))
    arm.run(0.1)
    (failed,) = [event for event in arm.events if event.kind is Kind.PROGRAM_FAILED]
    assert failed.values["reason"] == "force: needs the flange force sensor"


def test_from_a_singular_posture_it_is_refused() -> None:
    with pytest.raises(MoveRefused, match="force: singular here"):
        ForceTrajectory(np.zeros(6), ApplyForce(force=DOWN), ToolPoint(model(), TCP), position=RANGE)


def test_a_joint_at_its_limit_ends_it() -> None:
    q = np.array(UR5E.chain.home)
    motion = ForceTrajectory(q, ApplyForce(force=DOWN), ToolPoint(model(), TCP), position=np.outer([-1.0, 1.0], np.abs(q) - 0.01))
    motion.step()
    assert "joint" in motion.problem
