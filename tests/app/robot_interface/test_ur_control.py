"""RTDEControlInterface of ur-rtde, unmodified: it uploads a program of its own, which moves the arm of a served robot."""

import time
from collections.abc import Callable, Iterator

import numpy as np
import pytest
from rtde_control import RTDEControlInterface
from rtde_receive import RTDEReceiveInterface

from app.testing import ServedRobot

HOME = [0.0, -1.2, 1.5, -1.87, -1.57, 0.0]
ASIDE = [0.2, *HOME[1:]]


@pytest.fixture(scope="module")
def robot(tmp_path_factory: pytest.TempPathFactory) -> Iterator[ServedRobot]:
    served = ServedRobot(tmp_path_factory.mktemp("robot"), {"mismatch": "nominal", "posture": HOME})
    served.start()
    served.remote(True)
    yield served
    served.stop()


@pytest.fixture(scope="module")
def seen(robot: ServedRobot) -> Iterator[RTDEReceiveInterface]:
    client = RTDEReceiveInterface(robot.host, 500.0)
    yield client
    client.disconnect()


@pytest.fixture(scope="module")
def arm(robot: ServedRobot) -> Iterator[RTDEControlInterface]:
    client = RTDEControlInterface(robot.host, 500.0)
    yield client
    client.stopScript()
    client.disconnect()


def at(seen: RTDEReceiveInterface) -> np.ndarray:
    return np.array(seen.getActualQ())


def until(true: Callable[[], bool], patience: float = 5.0) -> None:
    """Wait for it: a busy machine is late."""
    end = time.monotonic() + patience
    while not true():
        assert time.monotonic() < end
        time.sleep(0.01)


def settled(seen: RTDEReceiveInterface, patience: float = 5.0) -> np.ndarray:
    """Joint angles when the arm stands."""
    until = time.monotonic() + patience
    while time.monotonic() < until:
        time.sleep(0.05)
        if np.abs(seen.getActualQd()).max() < 2e-3:
            return at(seen)
    raise AssertionError("the arm goes on moving")


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


def test_free_drive_goes_through_the_activation(arm: RTDEControlInterface, robot: ServedRobot) -> None:
    assert arm.freedriveMode()
    robot.wait_until(10.0, mode="FREE_DRIVE")
    assert arm.endFreedriveMode()
    robot.wait_until(5.0, mode="RUN")
