"""RTDEControlInterface of ur-rtde, unmodified: it uploads a program of its own, which moves the arm of a served robot."""

import numpy as np
from rtde_control import RTDEControlInterface
from rtde_receive import RTDEReceiveInterface

from app.served_robot import ServedRobot
from tests.app.robot_interface.waiting import ASIDE, HOME, at, settled, until


def test_joint_motions(arm: RTDEControlInterface, seen: RTDEReceiveInterface) -> None:
    assert arm.moveJ(ASIDE, 1.05, 1.4)
    np.testing.assert_allclose(settled(seen), ASIDE, atol=2e-3)
    assert arm.moveJ(HOME, 1.05, 1.4)
    np.testing.assert_allclose(settled(seen), HOME, atol=2e-3)


def test_a_path_of_joint_angles_with_a_blend(arm: RTDEControlInterface, seen: RTDEReceiveInterface) -> None:
    assert arm.moveJ([[*ASIDE, 1.0, 1.4, 0.02], [*HOME, 1.0, 1.4, 0.0]])
    np.testing.assert_allclose(settled(seen), HOME, atol=2e-3)


def test_lines(arm: RTDEControlInterface, seen: RTDEReceiveInterface) -> None:
    pose = seen.getTargetTCPPose()
    up = [*pose[:2], pose[2] + 0.05, *pose[3:]]
    assert arm.moveL(up, 0.25, 1.2)
    settled(seen)
    np.testing.assert_allclose(seen.getActualTCPPose()[:3], up[:3], atol=2e-3)
    assert arm.moveL(pose, 0.25, 1.2)


def test_a_motion_that_nobody_waits_for_is_stopped(arm: RTDEControlInterface, seen: RTDEReceiveInterface) -> None:
    assert arm.moveJ([1.0, *HOME[1:]], 0.5, 1.4, True)
    until(lambda: at(seen)[0] > 0.02)
    arm.stopJ(2.0)
    assert 0.01 < settled(seen)[0] < 0.9
    assert arm.moveJ(HOME, 1.05, 1.4)


def test_servo_commands(arm: RTDEControlInterface, seen: RTDEReceiveInterface) -> None:
    begin = settled(seen)
    goal = begin.copy()
    for _ in range(250):
        goal[0] += 0.0004
        start = arm.initPeriod()
        assert arm.servoJ(goal.tolist(), 0.5, 0.5, 0.002, 0.1, 300)
        arm.waitPeriod(start)
    arm.servoStop()
    moved = settled(seen)[0] - begin[0]
    assert 0.05 < moved < 0.101
    assert arm.moveJ(HOME, 1.05, 1.4)


def test_speeds_of_joints_and_tool(arm: RTDEControlInterface, seen: RTDEReceiveInterface) -> None:
    begin = settled(seen)
    assert arm.speedJ([0.1, 0.0, 0.0, 0.0, 0.0, 0.0], 0.5, 0.5)
    until(lambda: abs(seen.getActualQd()[0] - 0.1) < 0.03 and at(seen)[0] > begin[0] + 0.01)
    arm.speedStop()
    settled(seen)
    height = seen.getActualTCPPose()[2]
    assert arm.speedL([0.0, 0.0, 0.05, 0.0, 0.0, 0.0], 0.25, 0.5)
    until(lambda: seen.getActualTCPPose()[2] - height > 0.01)
    arm.speedStop()
    settled(seen)
    assert seen.getActualTCPPose()[2] - height < 0.06
    assert arm.moveJ(HOME, 1.05, 1.4)
    settled(seen)


def test_free_drive_goes_through_the_activation(arm: RTDEControlInterface, controlled: ServedRobot) -> None:
    assert arm.freedriveMode()
    controlled.wait_until(10.0, mode="FREE_DRIVE")
    assert arm.endFreedriveMode()
    controlled.wait_until(5.0, mode="RUN")
