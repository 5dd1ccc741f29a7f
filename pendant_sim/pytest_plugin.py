"""A robot for tests: pytest finds the fixture `robot` where pendant-sim is installed.

def test_the_cell_stops(robot):
    my_cell = MyCell(robot.host)
    robot.press("emergency_stop")
    robot.wait_for("emergency_stop")
    assert my_cell.stopped

Until a test asks for it, nothing of the product is imported.
"""

from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

if TYPE_CHECKING:
    from pendant_sim import Robot


@pytest.fixture
def robot(tmp_path: Path, request: pytest.FixtureRequest) -> "Iterator[Robot]":
    """A robot of one test. `@pytest.mark.parametrize("robot", [{"payload_true": ...}], indirect=True)` gives it a set-up."""
    from pendant_sim import Robot

    with Robot(tmp_path, getattr(request, "param", None)) as served:
        yield served
