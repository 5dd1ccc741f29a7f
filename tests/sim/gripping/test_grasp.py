"""Where a line meets a part, when two fingers hold, when a cup closes: geometry by hand."""

import math

import numpy as np
import pytest

from sim.arm.scenario import FreeBox, FreeCylinder
from sim.gripping.grasp import GAP, SQUEEZE, Chord, chord, firm, seals

BOX = FreeBox(name="box", position=[0.0, 0.0, 0.0], size=[0.06, 0.04, 0.1], mass=1.0)
CAN = FreeCylinder(name="can", position=[0.0, 0.0, 0.0], radius=0.03, height=0.08, mass=1.0)
X, Z = np.array([1.0, 0.0, 0.0]), np.array([0.0, 0.0, 1.0])


def line(part: FreeBox | FreeCylinder, point: tuple[float, float, float], along: np.ndarray) -> Chord:
    found = chord(part, np.array(point), along)
    assert found is not None
    return found


def test_a_box_is_as_wide_as_its_side() -> None:
    found = line(BOX, (0.01, 0.0, 0.0), X)
    assert (found.begin, found.end) == pytest.approx((-0.04, 0.02))
    assert found.begin_cosine == found.end_cosine == 1.0


def test_a_line_that_passes_by_meets_nothing() -> None:
    assert chord(BOX, np.array([0.0, 0.021, 0.0]), X) is None
    assert chord(CAN, np.array([0.0, 0.031, 0.0]), X) is None
    assert chord(CAN, np.array([0.0, 0.0, 0.041]), X) is None
    assert chord(CAN, np.array([0.031, 0.0, 0.0]), Z) is None


def test_a_cylinder_beside_its_middle_is_narrower_and_slanted() -> None:
    found = line(CAN, (0.0, 0.018, 0.0), X)
    assert found.end - found.begin == pytest.approx(2.0 * math.sqrt(0.03**2 - 0.018**2))
    assert found.end_cosine == pytest.approx(math.sqrt(0.03**2 - 0.018**2) / 0.03)
    assert line(CAN, (0.01, 0.0, 0.0), Z).end == pytest.approx(0.04)


@pytest.mark.parametrize(("degrees", "holds"), [(25.0, True), (28.0, False)])
def test_fingers_hold_within_the_friction_cone(degrees: float, holds: bool) -> None:
    """A friction of 0.5 holds up to atan 0.5 = 26.6 degrees."""
    turn = math.radians(degrees)
    found = line(BOX, (0.0, 0.0, 0.0), np.array([math.cos(turn), math.sin(turn), 0.0]))
    assert firm(found, 0.5) is (holds and found.begin_cosine == found.end_cosine)


def test_a_cup_closes_on_a_face_and_not_on_an_edge() -> None:
    down = np.diag([1.0, -1.0, -1.0])
    assert seals(BOX, np.array([0.0, 0.0, 0.05]), down, 0.018)
    assert not seals(BOX, np.array([0.0, 0.0, 0.05]), down, 0.022), "wider than the face"
    assert not seals(BOX, np.array([0.02, 0.0, 0.05]), down, 0.015), "over its edge"
    assert seals(BOX, np.array([0.0, 0.0, 0.05 + 0.95 * GAP]), down, 0.018)
    assert not seals(BOX, np.array([0.0, 0.0, 0.05 + 1.05 * GAP]), down, 0.018)
    assert seals(BOX, np.array([0.0, 0.0, 0.05 - 0.95 * SQUEEZE]), down, 0.018)
    assert not seals(BOX, np.array([0.0, 0.0, 0.05 - 1.05 * SQUEEZE]), down, 0.018)
