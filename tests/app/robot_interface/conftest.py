"""A served robot of a module, and ur-rtde's clients of it, unmodified."""

from collections.abc import Iterator
from contextlib import suppress
from time import sleep

import pytest
from rtde_control import RTDEControlInterface
from rtde_receive import RTDEReceiveInterface

from app.served_robot import ServedRobot
from tests.app.robot_interface.waiting import HOME, until


@pytest.fixture(scope="module")
def controlled(tmp_path_factory: pytest.TempPathFactory) -> Iterator[ServedRobot]:
    served = ServedRobot(tmp_path_factory.mktemp("robot"), {"mismatch": "nominal", "posture": HOME})
    served.start()
    served.remote(True)
    yield served
    served.stop()


@pytest.fixture(scope="module")
def seen(controlled: ServedRobot) -> Iterator[RTDEReceiveInterface]:
    client = RTDEReceiveInterface(controlled.host, 500.0)
    yield client
    client.disconnect()


@pytest.fixture(scope="module")
def client(controlled: ServedRobot) -> Iterator[RTDEControlInterface]:
    interface = RTDEControlInterface(controlled.host, 500.0)
    yield interface
    interface.stopScript()
    interface.disconnect()


@pytest.fixture
def arm(client: RTDEControlInterface, controlled: ServedRobot) -> RTDEControlInterface:
    """The client with its program running: a test that ended the program, or that saw it end, ends no other test."""
    if not client.isProgramRunning():
        with suppress(AssertionError):  # a program that was sent may be about to begin
            until(client.isProgramRunning, 1.0)
    if not client.isProgramRunning():
        until(lambda: _out_of_stop(controlled))
        assert client.reuploadScript(), controlled.events()[-3:]
        until(client.isProgramRunning)
    return client


def _out_of_stop(robot: ServedRobot) -> bool:
    """A reset counts once the arm has stood for 0.1 s."""
    if robot.state()["mode"] != "STOP":
        return True
    robot.press("reset")
    sleep(0.2)
    return False
