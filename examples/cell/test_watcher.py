"""What the watcher does when the robot stops. Run: pytest examples/cell, or with pytest-xdist: pytest -n 2 examples/cell"""

from collections.abc import Iterator

import pytest

from examples.cell.watcher import Watcher
from pendant_sim import Robot


@pytest.fixture
def watcher(robot: Robot) -> Iterator[Watcher]:
    """Looks after the robot of the test."""
    watcher = Watcher(robot.host)
    yield watcher
    watcher.close()


def test_an_emergency_stop_is_noticed_and_the_robot_works_again_when_it_is_released(robot: Robot, watcher: Watcher) -> None:
    pressed = robot.press("emergency_stop")
    assert robot.wait_for("emergency_stop")["tick"] == pressed + 1
    assert watcher.wait_stopped(2.0)
    assert not watcher.recover(0.5)
    robot.press("emergency_stop_released")
    assert watcher.recover(5.0)


def test_a_dropped_payload_is_noticed_and_unlocked_after_five_seconds(robot: Robot, watcher: Watcher) -> None:
    robot.begin(payload_true={"mass": 3.0}, payload_configured={"mass": 3.0}, settings={"activation.period": 0.5})
    robot.free_drive(30.0)
    robot.wait_for("entered")
    robot.change(kind="drop_payload")
    assert watcher.wait_stopped(2.0)
    robot.free_drive(0.0)
    assert watcher.recover(10.0)
    stopped, reset = robot.wait_for("stopped_payload"), robot.wait_for("reset")
    assert (reset["tick"] - stopped["tick"]) * 0.002 >= 5.0
