"""How far a jogged arm has gone, in words."""

from typing import Any

import numpy as np
import pytest

from pendant.program.jog_move import JogMove, JogPlace, MoveStraight, MoveThere, unfit
from tests.pendant.estimates import estimate


def turned(angle: float) -> np.ndarray:
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])


@pytest.mark.parametrize(
    ("frame", "axis", "length", "said"),
    [
        ("joint", 1, np.radians(50.0), "10 of 50°"),
        ("joint", 1, 0.0, "10°"),
        ("joint", 0, 0.0, "0°"),
        ("tool", 2, 0.05, "5 of 50 mm"),
        ("base", 0, 0.0, "5 mm"),
        ("base", 5, np.radians(50.0), "20 of 50°"),
        ("tool", 3, 0.0, "20°"),
    ],
)
def test_the_way_is_told_in_the_unit_of_the_motion(frame: Any, axis: int, length: float, said: str) -> None:
    start, now = estimate(), estimate().copy()
    now.q[1] -= np.radians(10.0)
    now.tcp[:3] += (0.003, 0.0, -0.004)
    now.R_BF = start.R_BF @ turned(np.radians(20.0))
    assert JogMove(frame=frame, axis=axis, sign=1, length=length).moved(JogPlace.of(start), JogPlace.of(now)) == said


def test_of_a_move_to_a_posture_the_joint_with_the_longest_way_is_told() -> None:
    start, now = estimate(), estimate().copy()
    q = start.q.copy()
    q[0] += np.radians(5.0)
    q[3] -= np.radians(40.0)
    now.q[0] += np.radians(5.0)
    now.q[3] -= np.radians(10.0)
    move = MoveThere(q=tuple(q.tolist()), name="home")
    assert move.what == "to home"
    assert move.moved(JogPlace.of(start), JogPlace.of(now)) == "10 of 40°"
    here = MoveThere(q=tuple(start.q.tolist()))
    assert here.moved(JogPlace.of(start), JogPlace.of(start)) == "0°"


def test_a_posture_has_an_angle_for_each_joint() -> None:
    assert unfit(MoveThere(q=(0.0,) * 6), 6) is None
    assert unfit(MoveThere(q=(0.0,) * 5), 6) == "5 joint angles, allowed: 6"


def test_of_a_straight_move_the_way_of_the_tool_is_told_or_its_turn_on_the_spot() -> None:
    start, now = estimate(), estimate().copy()
    x, y, z = start.tcp[:3].tolist()
    now.tcp[:3] += (0.003, 0.0, -0.004)
    now.R_BF = start.R_BF @ turned(np.radians(20.0))
    move = MoveStraight(position=(x + 0.03, y, z - 0.04), quaternion=(1.0, 0.0, 0.0, 0.0))
    assert move.what == "straight to the pose"
    assert move.moved(JogPlace.of(start), JogPlace.of(now)) == "5 of 50 mm"
    spot = MoveStraight(position=(x, y, z), quaternion=(1.0, 0.0, 0.0, 0.0))
    assert spot.moved(JogPlace.of(start), JogPlace.of(now)) == "20°"
    assert unfit(move, 6) is None
