"""force_mode: the arm pushes with a wrench along the chosen axes, gives way there, and moves along the others."""

import numpy as np
import pytest

from benchmarks.contacts.recording import contact_force
from pendant.tick.modes import Mode
from sim.arm.scenario import AnyObject, BoxObject, Scenario
from sim.plant.changes import SensorFault
from tests.app.robot_interface.robot_bench import RobotBench
from tests.app.urscript.script_bench import ScriptBench
from tests.sim.arms import PROBE

DOWN = "force_mode(p[0,0,0,0,0,0], [0,0,1,0,0,0], [0,0,-15,0,0,0], 2, [0.05,0.05,0.03,0.2,0.2,0.2])"


def bench(*, block: bool) -> ScriptBench:
    """Some millimetres above a block, or above nothing."""
    world: list[AnyObject] = (
        [BoxObject(name="block", position=[-0.6282, -0.1335, 0.1], size=[0.4, 0.4, 0.2], stiffness=1e4)] if block else []
    )
    return ScriptBench(RobotBench(scenario=Scenario(seed=4, tool=PROBE, world=world, mismatch="nominal")))


def offered(arm: ScriptBench, text: str) -> None:
    arm.runner.offer("def prog():\n" + text + "\nend\n")


def place(arm: ScriptBench) -> np.ndarray:
    return arm.robot.simulation.estimate.tcp[:3].copy()


def test_what_is_met_feels_the_force() -> None:
    arm = bench(block=True)
    offered(arm, f" zero_ftsensor()\n sleep(1.5)\n {DOWN}\n sleep(20)")
    arm.robot.step(7000)
    forces = []
    for _ in range(20):
        arm.robot.step(10)
        forces.append(contact_force(arm.robot.simulation))
    assert np.mean(forces) == pytest.approx(15.0, abs=1.5)
    assert arm.runner.trouble is None


def test_in_free_space_it_goes_no_faster_than_its_limit_and_ends_with_the_mode() -> None:
    arm = bench(block=False)
    offered(arm, f" {DOWN}\n sleep(3)\n end_force_mode()\n sleep(2)")
    begin, fastest = place(arm), 0.0
    for _ in range(1500):
        arm.robot.step()
        fastest = max(fastest, abs(arm.robot.simulation.estimate.tcp[5]))
    way = place(arm) - begin
    arm.robot.step(600)
    end = place(arm)
    arm.robot.step(300)
    assert way[2] < -0.03
    assert np.abs(way[:2]).max() < 2e-3
    assert fastest < 0.04
    assert np.abs(place(arm) - end).max() < 1e-3


def test_it_moves_along_the_other_axes_as_it_should_while_it_pushes() -> None:
    arm = bench(block=True)
    offered(
        arm,
        f" zero_ftsensor()\n sleep(1.5)\n {DOWN}\n sleep(6)\n p = get_actual_tcp_pose()\n"
        " movel(pose_add(p, p[0.05,0,0.05,0,0,0]), a=0.3, v=0.03)\n sleep(2)\n",
    )
    arm.robot.step(3700)
    begin, forces = place(arm), []
    for _ in range(1900):
        arm.robot.step()
        forces.append(contact_force(arm.robot.simulation))
    way = place(arm) - begin
    assert way[0] == pytest.approx(0.05, abs=2e-3)
    assert abs(way[1]) < 2e-3
    assert abs(way[2]) < 2e-3  # the force decides; the motion's own 50 mm up does not count
    assert min(forces) > 10.0
    assert max(forces) < 20.0


def test_without_a_wrench_the_arm_gives_way_to_a_hand() -> None:
    arm = bench(block=False)
    offered(arm, " force_mode(p[0,0,0,0,0,0], [0,1,0,0,0,0], [0,0,0,0,0,0], 2, [0.05,0.2,0.05,0.2,0.2,0.2])\n sleep(20)")
    arm.robot.step(200)
    begin = place(arm)
    arm.robot.pull((0.0, 20.0, 0.0), 1000)
    way = place(arm) - begin
    assert way[1] > 0.03
    assert np.abs(way[[0, 2]]).max() < 5e-3


def test_the_frame_turns_so_that_its_y_points_to_its_origin() -> None:
    """The origin is above the tool: pushed along y, it goes up."""
    arm = bench(block=False)
    x, y, z = place(arm)
    offered(
        arm,
        f" force_mode(p[{x},{y},{z + 0.5},1.2,0.3,0.1], [0,1,0,0,0,0], [0,10,0,0,0,0], 1, [0.1,0.05,0.1,0.2,0.2,0.2])\n sleep(2)",
    )
    begin = place(arm)
    arm.robot.step(1200)
    way = place(arm) - begin
    assert way[2] > 0.03
    assert np.abs(way[:2]).max() < 5e-3


@pytest.mark.parametrize(("damping", "least", "most"), [(0.0, 0.019, 0.021), (0.025, 0.004, 0.008), (1.0, 0.0, 1e-6)])
def test_without_damping_the_tool_goes_on_and_with_all_of_it_it_stops_at_once(damping: float, least: float, most: float) -> None:
    """Pushed to 20 mm/s with no damping. A tenth of a second without a force: it keeps that; or loses (1 - 0.025)**50 of it."""
    arm = bench(block=False)
    mode = "force_mode(p[0,0,0,0,0,0], [0,0,1,0,0,0], [0,0,{}], 2, [0.05,0.05,0.02,0.2,0.2,0.2])"
    offered(
        arm,
        f" zero_ftsensor()\n sleep(1.5)\n force_mode_set_damping(0)\n {mode.format('-40,0,0,0')}\n sleep(0.5)\n"
        f" force_mode_set_damping({damping})\n force_mode_set_gain_scaling(0)\n {mode.format('0,0,0,0')}\n sleep(1)",
    )
    arm.robot.step(1050)
    speed = -float(arm.robot.cabinet.record.field("target_TCP_speed")[2])
    assert least <= speed <= most
    arm.robot.step(300)
    assert -float(arm.robot.cabinet.record.field("target_TCP_speed")[2]) == pytest.approx(
        0.02 if damping == 0.0 else 0.0, abs=1e-3
    )


@pytest.mark.parametrize("damping", [0.01, 0.025, 0.2])
def test_a_damped_arm_settles_on_what_is_hard(damping: float) -> None:
    arm = bench(block=True)
    offered(arm, f" zero_ftsensor()\n sleep(1.5)\n force_mode_set_damping({damping})\n {DOWN}\n sleep(20)")
    arm.robot.step(8000)
    forces = []
    for _ in range(20):
        arm.robot.step(10)
        forces.append(contact_force(arm.robot.simulation))
    assert np.mean(forces) == pytest.approx(15.0, abs=1.5)
    assert np.ptp(forces) < 3.0
    assert arm.runner.trouble is None


@pytest.mark.parametrize(("type_", "least", "most"), [(2, 0.049, 0.051), (3, 0.0, 0.01)])
def test_the_frame_turns_with_the_tools_way(type_: int, least: float, most: float) -> None:
    """Its x is free. Turned to where the tool goes, that is the way of the motion, which does not count any more."""
    arm = bench(block=False)
    offered(
        arm,
        f" force_mode(p[0,0,0,0,0,0], [1,0,0,0,0,0], [0,0,0,0,0,0], {type_}, [0.05,0.1,0.1,0.2,0.2,0.2])\n"
        " p = get_actual_tcp_pose()\n movel(pose_add(p, p[0,0.05,0,0,0,0]), a=0.5, v=0.05)\n sleep(2)",
    )
    begin = place(arm)
    arm.robot.step(1200)
    assert least <= (place(arm) - begin)[1] <= most


@pytest.mark.parametrize(
    ("mode", "told"),
    [
        ("[0,0,2,0,0,0], [0,0,-10,0,0,0], 2, [0.1,0.1,0.1,0.1,0.1,0.1]", "selection_vector: expected six of 0 and 1"),
        ("[0,0,1,0,0,0], [0,0,-91,0,0,0], 2, [0.1,0.1,0.1,0.1,0.1,0.1]", "a force of 91, allowed: 90 at most"),
        ("[0,0,0,0,1,0], [0,0,0,0,11,0], 2, [0.1,0.1,0.1,0.1,0.1,0.1]", "a torque of 11, allowed: 10 at most"),
        ("[0,0,1,0,0,0], [0,0,-10,0,0,0], 2, [0.1,0.1,-0.1,0.1,0.1,0.1]", "limits: -0.1 for z, allowed: 0 or more"),
    ],
)
def test_what_cannot_be_is_told(mode: str, told: str) -> None:
    _, trouble = bench(block=False).run(f"def prog():\n force_mode(p[0,0,0,0,0,0], {mode})\n sleep(1)\nend\n")
    assert told in trouble


def test_a_tool_that_is_pushed_off_its_way_ends_the_script() -> None:
    arm = bench(block=False)
    offered(arm, " force_mode(p[0,0,0,0,0,0], [0,0,1,0,0,0], [0,0,0,0,0,0], 2, [0.1,0.0005,0.1,0.2,0.2,0.2])\n sleep(20)")
    arm.robot.step(200)
    arm.robot.pull((0.0, 80.0, 0.0), 300)
    assert "mm from its way in y, allowed 0.5" in str(arm.runner.trouble)


def test_without_the_force_sensor_it_ends() -> None:
    arm = bench(block=False)
    offered(arm, f" {DOWN}\n sleep(20)")
    arm.robot.step(200)
    arm.robot.change(SensorFault(sensor="force_torque", outage=True))
    arm.robot.step(100)
    assert "force mode: needs the flange force sensor" in str(arm.runner.trouble)
    assert arm.robot.step().mode is not Mode.RUN
