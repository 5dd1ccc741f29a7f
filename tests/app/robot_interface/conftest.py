"""A served robot of a module, and ur-rtde's clients of it, unmodified."""

from collections.abc import Iterator

import pytest
from rtde_control import RTDEControlInterface
from rtde_receive import RTDEReceiveInterface

from app.testing import ServedRobot
from tests.app.robot_interface.waiting import HOME


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
def arm(controlled: ServedRobot) -> Iterator[RTDEControlInterface]:
    client = RTDEControlInterface(controlled.host, 500.0)
    yield client
    client.stopScript()
    client.disconnect()
