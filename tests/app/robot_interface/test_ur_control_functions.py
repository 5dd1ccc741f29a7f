"""Every other function of ur-rtde's RTDEControlInterface, unmodified, as docs/reference/clients-control.md has them."""

import time
from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np
from rtde_control import Path as WayPath
from rtde_control import PathEntry, RTDEControlInterface
from rtde_receive import RTDEReceiveInterface

from app.served_robot import ServedRobot
from tests.app.robot_interface.waiting import HOME, settled, until

STILL = [0.0] * 6
FRAME = Path(__file__).parents[3] / "docs" / "reference" / "clients-control.md"


def told(ask: Callable[[], Sequence[float]], wanted: Sequence[float], atol: float = 1e-3) -> None:
    """The client reads the answer to what it asked before, if that is quicker: ask again."""
    until(lambda: np.allclose(ask(), wanted, atol=atol))


def home(arm: RTDEControlInterface, seen: RTDEReceiveInterface) -> None:
    assert arm.moveJ(HOME, 1.05, 1.4)
    settled(seen)


def again(arm: RTDEControlInterface) -> None:
    """The program has ended, and is sent again."""
    until(lambda: not arm.isProgramRunning())
    assert arm.reuploadScript()
    until(arm.isProgramRunning)


def test_what_it_knows(arm: RTDEControlInterface, seen: RTDEReceiveInterface) -> None:
    home(arm, seen)
    pose = seen.getActualTCPPose()
    assert arm.isConnected()
    assert arm.isProgramRunning()
    assert arm.isSteady()
    until(lambda: arm.getStepTime() == 0.002)
    told(arm.getActualToolFlangePose, pose)
    told(arm.getTargetJointAccelerations, STILL)
    told(arm.getTCPOffset, STILL)
    told(arm.getTargetWaypoint, pose)
    told(arm.getJointTorques, STILL, atol=3.0)
    told(lambda: arm.getActualJointPositionsHistory(5), HOME)
    assert arm.getRobotStatus() & 3 == 3  # power is on, a program runs
    assert arm.getAsyncOperationProgress() < 0
    assert not arm.getAsyncOperationProgressEx().isAsyncOperationRunning()


def test_kinematics(arm: RTDEControlInterface, seen: RTDEReceiveInterface) -> None:
    short, long = (arm.getForwardKinematics(HOME, [0.0, 0.0, z, 0.0, 0.0, 0.0]) for z in (0.001, 0.101))
    assert np.allclose(long, arm.poseTrans(short, [0.0, 0.0, 0.1, 0.0, 0.0, 0.0]), atol=1e-6)
    pose = arm.getForwardKinematics()
    assert np.allclose(pose, seen.getActualTCPPose(), atol=1e-3)
    assert np.allclose(arm.getInverseKinematics(pose), HOME, atol=1e-4)
    assert np.allclose(arm.getInverseKinematics(pose, HOME), HOME, atol=1e-4)
    assert arm.getInverseKinematicsHasSolution(pose)
    assert not arm.getInverseKinematicsHasSolution([9.0, 9.0, 9.0, 0.0, 0.0, 0.0])
    assert arm.isPoseWithinSafetyLimits(pose)
    assert arm.isJointsWithinSafetyLimits(HOME)
    assert not arm.isJointsWithinSafetyLimits([7.0, *HOME[1:]])


def test_dynamics(arm: RTDEControlInterface) -> None:
    def mass(rotors: bool) -> np.ndarray:
        return np.array(arm.getMassMatrix(HOME, rotors)).reshape(6, 6)

    until(lambda: bool(np.all(np.linalg.eigvalsh(mass(False)) > 0.0)))
    matrix = mass(False)
    assert np.allclose(matrix, matrix.T, atol=1e-9)
    until(lambda: bool(np.all(np.diag(mass(True)) >= np.diag(mass(False)) - 1e-6)))
    until(lambda: abs(np.linalg.norm(np.array(arm.getJacobian(HOME, STILL)).reshape(6, 6)[:, 3:], axis=1).max() - 1.0) < 1e-3)
    until(lambda: bool(np.abs(arm.getJacobianTimeDerivative(HOME, [0.1] * 6, STILL)).max() > 1e-3))
    told(lambda: arm.getCoriolisAndCentrifugalTorques(HOME, STILL), STILL)


def test_other_motions(arm: RTDEControlInterface, seen: RTDEReceiveInterface) -> None:
    home(arm, seen)
    pose = seen.getTargetTCPPose()
    up = [*pose[:2], pose[2] + 0.03, *pose[3:]]
    assert arm.moveJ_IK(up)
    settled(seen)
    assert np.allclose(seen.getActualTCPPose()[:3], up[:3], atol=2e-3)
    assert arm.moveL_FK(HOME)
    assert np.allclose(settled(seen), HOME, atol=2e-3)
    path = WayPath()
    path.addEntry(PathEntry(PathEntry.MoveJ, PathEntry.PositionJoints, [*HOME[:5], 0.2, 1.0, 1.4, 0.01]))
    path.addEntry(PathEntry(PathEntry.MoveL, PathEntry.PositionTcpPose, [*pose, 0.25, 1.0, 0.0]))
    assert arm.movePath(path, False)
    assert np.allclose(settled(seen), HOME, atol=3e-3)


def test_a_motion_that_is_not_waited_for_tells_how_far_it_is(arm: RTDEControlInterface, seen: RTDEReceiveInterface) -> None:
    assert arm.moveJ([[*HOME[:5], 0.4, 1.0, 1.4, 0.0], [*HOME, 1.0, 1.4, 0.0]], True)
    until(lambda: arm.getAsyncOperationProgressEx().isAsyncOperationRunning())
    until(lambda: arm.getAsyncOperationProgress() == 1)
    until(lambda: not arm.getAsyncOperationProgressEx().isAsyncOperationRunning())
    assert np.allclose(settled(seen), HOME, atol=3e-3)


def test_streams_of_poses(arm: RTDEControlInterface, seen: RTDEReceiveInterface) -> None:
    pose = seen.getTargetTCPPose()
    for k in range(100):
        begun = arm.initPeriod()
        assert arm.servoL([*pose[:2], pose[2] + 0.0002 * k, *pose[3:]], 0.5, 0.5, 0.002, 0.1, 300.0)
        arm.waitPeriod(begun)
    assert arm.servoStop(10.0)
    settled(seen)
    assert 0.005 < seen.getActualTCPPose()[2] - pose[2] < 0.021
    home(arm, seen)


def test_torques_turn_a_joint_until_there_are_no_more(arm: RTDEControlInterface, seen: RTDEReceiveInterface) -> None:
    """2 N·m are some more than the last joint's friction, of which the client lets nothing be made up for: it turns slowly."""
    home(arm, seen)
    before = seen.getActualQ()
    assert arm.directTorque([0.0, 0.0, 0.0, 0.0, 0.0, 2.0])
    until(lambda: seen.getActualQ()[5] - before[5] > 0.05)
    assert np.allclose(seen.getActualQ()[:5], before[:5], atol=5e-3)
    assert arm.directTorque(STILL)
    settled(seen)
    assert arm.isProgramRunning()
    home(arm, seen)


def test_jogging_and_the_stop_of_the_tool(arm: RTDEControlInterface, seen: RTDEReceiveInterface) -> None:
    height = seen.getActualTCPPose()[2]
    assert arm.jogStart([0.0, 0.0, 0.03, 0.0, 0.0, 0.0])
    until(lambda: seen.getActualTCPPose()[2] - height > 0.01)
    assert arm.jogStop()
    settled(seen)
    assert arm.jogStart([0.0, 0.0, 0.03, 0.0, 0.0, 0.0], RTDEControlInterface.Feature.FEATURE_TOOL)
    until(lambda: seen.getActualTCPPose()[2] - height < 0.005)
    assert arm.jogStop()
    pose = seen.getTargetTCPPose()
    assert arm.moveL([*pose[:2], pose[2] + 0.1, *pose[3:]], 0.05, 0.5, True)
    until(lambda: seen.getActualTCPPose()[2] - pose[2] > 0.01)
    arm.stopL(1.0)
    settled(seen)
    assert seen.getActualTCPPose()[2] - pose[2] < 0.09
    home(arm, seen)


def test_payload_and_tool(arm: RTDEControlInterface, seen: RTDEReceiveInterface) -> None:
    assert arm.setPayload(0.5, [0.0, 0.0, 0.05])
    until(lambda: abs(seen.getPayload() - 0.5) < 1e-6)
    assert arm.setTargetPayload(0.0, [0.0, 0.0, 0.0], STILL)
    until(lambda: seen.getPayload() == 0.0)
    assert arm.setTcp([0.0, 0.0, 0.1, 0.0, 0.0, 0.0])
    until(lambda: np.allclose(arm.getTCPOffset(), [0.0, 0.0, 0.1, 0.0, 0.0, 0.0]))
    assert arm.setTcp(STILL)
    until(lambda: np.allclose(arm.getTCPOffset(), STILL))
    assert arm.zeroFtSensor()
    assert arm.setGravity([0.0, 0.0, 9.82])


def test_gravity_of_another_mounting_ends_the_program_and_it_is_sent_again(arm: RTDEControlInterface) -> None:
    assert arm.ftRtdeInputEnable(False)
    assert arm.enableExternalFtSensor(False)
    assert not arm.setGravity([0.0, 9.82, 0.0])
    again(arm)


def test_teaching_by_hand(arm: RTDEControlInterface, controlled: ServedRobot) -> None:
    assert arm.teachMode()
    controlled.wait_until(10.0, mode="FREE_DRIVE")
    assert arm.endTeachMode()
    controlled.wait_until(5.0, mode="RUN")
    assert arm.freedriveMode([0, 0, 1, 0, 0, 0], STILL)
    controlled.wait_until(10.0, mode="FREE_DRIVE")
    assert arm.getFreedriveStatus() == 0
    assert arm.endFreedriveMode()
    controlled.wait_until(5.0, mode="RUN")


def test_pushing_with_a_force(arm: RTDEControlInterface, seen: RTDEReceiveInterface) -> None:
    """As in its example: down with 10 N where nothing is, then up with as much."""
    settled(seen)
    height = seen.getActualTCPPose()[2]
    assert arm.forceModeSetDamping(0.1)
    assert arm.forceModeSetGainScaling(1.5)
    for force, reached in ((-10.0, lambda: seen.getActualTCPPose()[2] < height - 0.01), (10.0, lambda: at_height(seen) > height)):
        assert arm.forceMode(STILL, [0, 0, 1, 0, 0, 0], [0.0, 0.0, force, 0.0, 0.0, 0.0], 2, [0.1] * 6)
        until(reached)
    assert arm.forceModeStop()
    home(arm, seen)


def at_height(seen: RTDEReceiveInterface) -> float:
    return seen.getActualTCPPose()[2]


def test_contact(arm: RTDEControlInterface, seen: RTDEReceiveInterface, controlled: ServedRobot) -> None:
    assert arm.toolContact(STILL) == 0
    assert arm.startContactDetection()
    assert not arm.readContactDetection()
    assert not arm.stopContactDetection()
    controlled.do({"do": "push", "at": 1.0, "for": 8.0, "part": "flange", "force": [0.0, 0.0, 40.0]})
    assert arm.moveUntilContact([0.0, 0.0, -0.02, 0.0, 0.0, 0.0])
    settled(seen)
    home(arm, seen)


def test_a_watchdog_ends_the_program_of_a_client_that_is_silent(arm: RTDEControlInterface) -> None:
    assert arm.setWatchdog(1.0)  # a busy machine is late by some tenths of a second
    for _ in range(20):
        assert arm.kickWatchdog()
        time.sleep(0.02)
    assert arm.isProgramRunning()
    again(arm)


def test_programs_of_ones_own(arm: RTDEControlInterface, seen: RTDEReceiveInterface, tmp_path: Path) -> None:
    aside = [0.1, *HOME[1:]]
    assert arm.sendCustomScriptFunction("aside", f"  movej({aside})\n")
    assert np.allclose(settled(seen), aside, atol=2e-3)
    mine = f"def mine():\n  movej({HOME})\n  write_output_integer_register(0, 2)\nend\n"
    assert arm.sendCustomScript(mine)
    assert np.allclose(settled(seen), HOME, atol=2e-3)
    (tmp_path / "mine.script").write_text(mine)
    assert arm.sendCustomScriptFile(str(tmp_path / "mine.script"))


def test_a_protective_stop(arm: RTDEControlInterface, seen: RTDEReceiveInterface) -> None:
    arm.triggerProtectiveStop()
    until(seen.isProtectiveStopped)


def test_every_function_is_in_the_table() -> None:
    page = FRAME.read_text(encoding="utf-8")
    functions = [name for name in dir(RTDEControlInterface) if name[0].islower()]
    assert [name for name in functions if f"`{name}`" not in page] == []
