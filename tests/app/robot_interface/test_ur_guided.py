"""ur-rtde's control interface, unmodified, lets a hand guide the arm: what is checked, ended and ramped is so for it too."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np
from rtde_control import RTDEControlInterface
from rtde_receive import RTDEReceiveInterface

from app.served_robot import ServedRobot
from tests.app.robot_interface.waiting import ASIDE, HOME, settled, until

QUICK = {"activation.period": 0.3, "sequence.period": 0.5, "free_drive.period": 1.0, "walls.tether": False}
COMES = {"shape": "ramp", "rise": 0.04, "fall": 0.04}
"""As a hand comes: a force that is there in one tick may be a step of the sensor, which gets no help."""

BALL = {
    "kind": "wall",
    "name": "ball",
    "shape": {"kind": "sphere", "radius": 0.1},
    "policy": "fixed",
    "band": 0.005,
    "reaction": "stay",
}


@contextmanager
def cell(folder: Path, **setup: object) -> Iterator[tuple[ServedRobot, RTDEControlInterface, RTDEReceiveInterface]]:
    """A robot, and the client's two interfaces of it."""
    robot = ServedRobot(folder, {"mismatch": "nominal", "posture": HOME, "settings": QUICK, **setup})
    robot.start()
    try:
        robot.remote(True)
        seen = RTDEReceiveInterface(robot.host, 500.0)
        arm = RTDEControlInterface(robot.host, 500.0)
        yield robot, arm, seen
        arm.disconnect()
        seen.disconnect()
    finally:
        robot.stop()


def test_a_wrong_payload_is_refused_and_told_and_ends_the_program(tmp_path: Path) -> None:
    with cell(tmp_path, payload_true={"mass": 2.0}) as (robot, arm, _):
        arm.freedriveMode()
        refused = robot.wait_for("refused_payload")
        assert abs(refused["values"]["mass"] - 2.0) < 0.5
        until(lambda: "kg" in robot.state()["refusal"])
        until(lambda: not arm.isProgramRunning())
        assert robot.state()["mode"] != "FREE_DRIVE"
        assert arm.reuploadScript()
        until(arm.isProgramRunning, 15.0)
        assert arm.setPayload(2.0, [0.0, 0.0, 0.0])
        until(lambda: abs(robot.field("payload") - 2.0) < 1e-6)
        assert arm.freedriveMode()
        robot.wait_until(15.0, mode="FREE_DRIVE")


def test_the_hand_lets_go_and_the_period_ends_it(tmp_path: Path) -> None:
    with cell(tmp_path) as (robot, arm, seen):
        assert arm.freedriveMode()
        robot.wait_until(15.0, mode="FREE_DRIVE")
        robot.do({"do": "push", "at": 0.0, "for": 0.5, "part": "flange", "force": [0.0, 8.0, 0.0], "profile": COMES})
        robot.wait_until(15.0, mode="RUN")
        assert any(event["kind"].startswith("left_") for event in robot.events())
        assert np.abs(np.array(seen.getActualQ()) - HOME).max() > 0.005
        assert arm.endFreedriveMode()
        assert arm.moveJ(HOME, 1.05, 1.4)
        np.testing.assert_allclose(settled(seen), HOME, atol=2e-3)


def test_it_is_pushed_against_a_wall(tmp_path: Path) -> None:
    with cell(tmp_path, walls=[BALL]) as (robot, arm, seen):
        begin = np.array(seen.getActualTCPPose()[:3])
        assert arm.freedriveMode()
        robot.wait_until(15.0, mode="FREE_DRIVE")
        robot.do({"do": "hold", "at": 0.0, "for": 1.6, "part": "flange", "carry": [0.0, 0.2, 0.0], "cap": 40.0})
        robot.wait_for("wall_reached")
        farthest = 0.0

        def over() -> bool:
            nonlocal farthest
            farthest = max(farthest, float(np.linalg.norm(np.array(seen.getActualTCPPose()[:3]) - begin)))
            return robot.state()["mode"] == "RUN"

        until(over)
        assert 0.08 < farthest < 0.115


def test_a_payload_in_mid_program_is_ramped(tmp_path: Path) -> None:
    with cell(tmp_path) as (robot, arm, seen):
        assert arm.moveJ(ASIDE, 1.05, 1.4)
        settled(seen)
        robot.change(kind="attach_payload", load={"mass": 1.5, "com": [0.0, 0.0, 0.05]})
        settled(seen)
        before, farthest = np.array(seen.getActualTCPPose()[:3]), 0.0
        assert arm.setTargetPayload(1.5, [0.0, 0.0, 0.05], [0.0] * 6)
        robot.wait_for("payload_changed")
        for _ in range(100):
            farthest = max(farthest, float(np.linalg.norm(np.array(seen.getActualTCPPose()[:3]) - before)))
        assert farthest < 2e-3  # it is ramped: no jump
        assert arm.isProgramRunning()
        assert arm.moveJ(HOME, 1.05, 1.4)
        np.testing.assert_allclose(settled(seen), HOME, atol=3e-3)
