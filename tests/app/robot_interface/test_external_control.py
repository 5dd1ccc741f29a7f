"""External Control: a computer that speaks as the UR client library does, and its program in a served robot.

Each test is done with a short program of ours, and with the library's own, unchanged, where the environment variable
PENDANT_EXTERNAL_CONTROL names a copy of `external_control.urscript`: no registry of Python packages has it.
"""

import os
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
import pytest
from rtde_receive import RTDEReceiveInterface

from app.robot_interface.controller.robot_words import VERSION
from app.served_robot import ServedRobot
from tests.app.robot_interface.external_control_client import (
    CANCEL,
    CANCELED,
    DONE,
    START,
    STREAM_END,
    STREAM_START,
    ZEROS,
    ControlMode,
    ExternalControlClient,
    OneShot,
    PointKind,
)

OURS = Path(__file__).parent / "external_control.script"
GENUINE = "PENDANT_EXTERNAL_CONTROL"

HOME = [0.0, -1.2, 1.5, -1.87, -1.57, 0.0]
AT_HOME = 0.01
"""Largest distance of a joint at which the arm is at home [rad]."""

ASIDE = [0.06, *HOME[1:]]
QUICK = [2.0, 5.0, 0.0, 0.0, 0.0, 0.0]
PROBE = {"name": "probe", "mass": 0.3, "com": [0.0, 0.0, 0.05], "tcp": [0.0, 0.0, 0.12], "length": 0.12, "radius": 0.02}
BLOCK = {"kind": "box", "name": "block", "position": [-0.6282, -0.1335, 0.113], "size": [0.4, 0.4, 0.2], "stiffness": 1e4}
"""Ten millimetres below the probe."""


class Cell:
    """A robot, what RTDE shows of it, and who controls it."""

    def __init__(self, robot: ServedRobot, seen: RTDEReceiveInterface, control: ExternalControlClient) -> None:
        self.robot, self.seen, self.control = robot, seen, control

    @property
    def q(self) -> np.ndarray:
        return np.array(self.seen.getActualQ())

    @property
    def height(self) -> float:
        return self.seen.getActualTCPPose()[2]

    @property
    def fastest(self) -> float:
        return float(np.abs(self.seen.getTargetQd()).max())

    def at(self, q: list[float] | np.ndarray, within: float = 2e-3) -> None:
        """It comes to these joint angles, and stands."""
        until(lambda: self.fastest < 1e-3 and bool(np.abs(self.q - q).max() < within))

    def still(self) -> np.ndarray:
        """Joint angles when the reference stands."""
        self.control.do(ControlMode.IDLE)
        until(lambda: self.fastest < 1e-3)
        return self.q

    def home(self) -> None:
        """The way back, as a trajectory."""
        self.control.once(ControlMode.FORWARD, START, 1)
        self.control.point(PointKind.MOVEJ, HOME, ZEROS, QUICK)
        assert self.control.result() == DONE
        self.at(HOME)


def until(true: Callable[[], bool], patience: float = 15.0) -> None:
    """Wait for it: a busy machine is late."""
    end = time.monotonic() + patience
    while not true():
        assert time.monotonic() < end
        time.sleep(0.01)


@pytest.fixture(scope="module")
def served(tmp_path_factory: pytest.TempPathFactory) -> Iterator[ServedRobot]:
    setup = {"mismatch": "nominal", "posture": HOME, "tool": PROBE, "world": [BLOCK]}
    robot = ServedRobot(tmp_path_factory.mktemp("robot"), setup)
    robot.start()
    robot.remote(True)
    yield robot
    robot.stop()


@pytest.fixture(scope="module")
def seen(served: ServedRobot) -> Iterator[RTDEReceiveInterface]:
    client = RTDEReceiveInterface(served.host, 500.0)
    yield client
    client.disconnect()


@pytest.fixture(params=["ours", "genuine"])
def cell(request: pytest.FixtureRequest, served: ServedRobot, seen: RTDEReceiveInterface) -> Iterator[Cell]:
    path = OURS if request.param == "ours" else os.environ.get(GENUINE)
    if path is None:
        pytest.skip(f"{GENUINE} names no copy of external_control.urscript")
    with ExternalControlClient() as control:
        control.upload((served.host, served.ports["primary"]), Path(path).read_text(encoding="utf-8"), VERSION[:3])
        control.do(ControlMode.IDLE)
        cell = Cell(served, seen, control)
        if np.abs(cell.q - HOME).max() > AT_HOME:
            cell.home()
        yield cell


def test_servo_targets_and_poses_are_followed(cell: Cell) -> None:
    goal = cell.still()
    for _ in range(100):
        goal[0] += 0.001
        cell.control.do(ControlMode.SERVO, goal)
        time.sleep(0.004)
    cell.at(goal)
    pose = np.array(cell.seen.getTargetTCPPose())
    for _ in range(100):
        pose[2] += 0.0002
        cell.control.do(ControlMode.POSE, pose)
        time.sleep(0.004)
    until(lambda: bool(np.abs(np.array(cell.seen.getActualTCPPose()) - pose).max() < 2e-3))
    cell.still()
    cell.home()


def test_speeds_of_joints_and_tool(cell: Cell) -> None:
    begin = cell.still()
    cell.control.do(ControlMode.SPEED, [0.2, *ZEROS[1:]])
    until(lambda: cell.q[0] > begin[0] + 0.05)
    assert cell.fastest == pytest.approx(0.2, abs=1e-3)
    begin, height = cell.still(), cell.height
    cell.control.do(ControlMode.TOOL_SPEED, [0.0, 0.0, 0.1, 0.0, 0.0, 0.0])
    until(lambda: cell.height > height + 0.02)
    assert abs(cell.still()[0] - begin[0]) < 2e-3
    cell.home()


def test_a_trajectory_of_joint_angles_and_a_line(cell: Cell) -> None:
    pose = cell.seen.getTargetTCPPose()
    cell.control.once(ControlMode.FORWARD, START, 3)
    cell.control.point(PointKind.MOVEJ, ASIDE, ZEROS, QUICK, blend=0.02)
    cell.control.point(PointKind.MOVEJ, HOME, ZEROS, QUICK)
    up = [*pose[:2], pose[2] + 0.03, *pose[3:]]
    cell.control.point(PointKind.MOVEL, up, ZEROS, [0.25, 2.5, 0.0, 0.0, 0.0, 0.0])
    assert cell.control.result() == DONE
    cell.still()
    np.testing.assert_allclose(cell.seen.getActualTCPPose()[:3], up[:3], atol=2e-3)
    cell.home()


@pytest.mark.parametrize("degree", [3, 5])
def test_splines_go_through_their_points(cell: Cell, degree: int) -> None:
    way = (np.array(ASIDE) - HOME) / 2.0
    cell.control.once(ControlMode.FORWARD, START, 3)
    for speed, place in ((way / 0.3, HOME + way), (way * 0.0, ASIDE), (way * 0.0, ASIDE)):  # the last one is a rest
        blocks = [list(place), list(speed), list(ZEROS)]
        cell.control.point(PointKind.SPLINE, *blocks[: 2 if degree == 3 else 3], seconds=0.3)
    assert cell.control.result() == DONE
    cell.at(ASIDE, within=4e-3)
    cell.home()


def test_a_trajectory_whose_length_is_told_at_its_end(cell: Cell) -> None:
    cell.control.once(ControlMode.FORWARD, STREAM_START)
    for share in np.linspace(0.1, 1.0, 10):
        place = HOME + (np.array(ASIDE) - HOME) * share
        speed = (np.array(ASIDE) - HOME) * 2.0 * (share < 1.0)
        cell.control.point(PointKind.SPLINE, list(place), list(speed), seconds=0.05)
    cell.control.once(ControlMode.FORWARD, STREAM_END, 10)
    assert cell.control.result() == DONE
    cell.at(ASIDE, within=4e-3)
    cell.home()


def test_a_trajectory_is_canceled_on_its_way(cell: Cell) -> None:
    cell.control.once(ControlMode.FORWARD, START, 2)
    for q in (1.0, 0.0):
        cell.control.point(PointKind.MOVEJ, [q, *HOME[1:]], ZEROS, [0.5, 1.4, 0.0, 0.0, 0.0, 0.0])
    until(lambda: cell.q[0] > 0.05)
    cell.control.once(ControlMode.FORWARD, CANCEL)
    assert cell.control.result() == CANCELED
    until(lambda: cell.fastest < 1e-3)
    assert 0.05 < cell.q[0] < 0.9
    cell.home()


def test_free_drive_goes_through_the_activation_although_it_is_asked_for_again_and_again(cell: Cell) -> None:
    cell.control.do(ControlMode.FREE_DRIVE, [1e-6, *ZEROS[1:]])
    assert cell.robot.wait_until(15.0, mode="FREE_DRIVE")["mode"] == "FREE_DRIVE"
    cell.control.do(ControlMode.IDLE)
    assert cell.robot.wait_until(15.0, mode="RUN")["mode"] == "RUN"


def test_commands_of_the_moment(cell: Cell) -> None:
    cell.still()
    cell.control.command(OneShot.TOOL_VOLTAGE, 24.0)
    until(lambda: cell.robot.field("tool_output_voltage") == 24)
    for tip in (0.13, 0.12):
        cell.control.command(OneShot.TCP, 0.0, 0.0, tip, 0.0, 0.0, 0.0)
        until(lambda tip=tip: cell.robot.field("tcp_offset")[2] == tip)
    for mass in (0.35, 0.3):
        cell.control.command(OneShot.PAYLOAD, mass, 0.0, 0.0, 0.05)
        until(lambda mass=mass: cell.seen.getPayload() == pytest.approx(mass, abs=1e-6))


def test_a_contact_ends_the_motion_and_leads_back_to_where_it_was(cell: Cell) -> None:
    begin = cell.height
    cell.control.command(OneShot.TOOL_CONTACT)
    cell.control.do(ControlMode.TOOL_SPEED, [0.0, 0.0, -0.01, 0.0, 0.0, 0.0])
    assert cell.control.contact() == DONE
    until(lambda: cell.fastest < 1e-3)
    assert -0.015 < cell.height - begin < -0.005
    cell.control.command(OneShot.END_TOOL_CONTACT)
    cell.control.do(ControlMode.TOOL_SPEED, [0.0, 0.0, 0.05, 0.0, 0.0, 0.0])  # said until the program has heard the command
    until(lambda: cell.height > begin)
    cell.still()
    cell.home()
    cell.control.command(OneShot.TOOL_CONTACT)
    cell.control.command(OneShot.END_TOOL_CONTACT)
    assert cell.control.contact() == CANCELED


def test_it_pushes_on_what_it_meets(cell: Cell) -> None:
    before = len(cell.robot.events())
    cell.control.command(OneShot.ZERO_SENSOR)
    until(lambda: any(event["kind"] == "sensor_zeroed" for event in cell.robot.events()[before:]))
    frame, free, wrench = ZEROS, (0.0, 0.0, 1.0, 0.0, 0.0, 0.0), (0.0, 0.0, -15.0, 0.0, 0.0, 0.0)
    cell.control.command(OneShot.FORCE_MODE, *frame, *free, *wrench, 2.0, 0.05, 0.05, 0.03, 0.2, 0.2, 0.2, 0.025, 1.0)
    until(lambda: 13.0 < cell.seen.getActualTCPForce()[2] < 17.0)
    cell.control.command(OneShot.END_FORCE_MODE)
    cell.home()


def test_without_a_word_in_time_the_arm_stops_and_the_program_ends(cell: Cell) -> None:
    cell.control.do(ControlMode.SPEED, [0.1, *ZEROS[1:]], alive=0.5)
    until(lambda: cell.q[0] > 0.02)
    cell.control.fall_silent()
    assert cell.control.left()
    cell.robot.wait_until(15.0, runtime_state="STOPPED")
    until(lambda: cell.fastest < 1e-3)
