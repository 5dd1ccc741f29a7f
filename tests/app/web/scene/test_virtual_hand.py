import math

import numpy as np
import pytest

from app.web.scene.arm_picture import frames_of
from app.web.scene.virtual_hand import FORCE, LEVER, REACH, VirtualHand
from sim.arm.frames import joint_frames
from sim.plant.touch import Pull, Push
from tests.app.web.fake_loop import ARM, FakeLoop

EYE = (2.0, 0.0, 0.5)


@pytest.fixture
def loop() -> FakeLoop:
    return FakeLoop()


@pytest.fixture
def hand(loop: FakeLoop) -> VirtualHand:
    return VirtualHand(loop.desk, loop.latest, frames_of(ARM))


@pytest.mark.parametrize(("part", "row"), [("base", 0), ("elbow", 2), ("wrist_3", 5)])
def test_the_grabbed_point_stays_where_it_was_on_its_part(loop: FakeLoop, hand: VirtualHand, part: str, row: int) -> None:
    frame = joint_frames(ARM, loop.q)[row]
    in_part = np.array([0.03, -0.02, 0.05, 1.0])
    start = frame @ in_part
    hand.grab(0, part, (start[0], start[1], start[2]), turning=False)
    hand.move(0, (start[0], start[1], start[2]), (0.1, 0.2, 0.3), EYE)
    (touch,) = loop.desk.take().touches
    assert isinstance(touch, Pull)
    assert (touch.part, touch.target, touch.cap) == (part, (0.1, 0.2, 0.3), 50.0)
    assert touch.point == pytest.approx(in_part[:3], abs=1e-9)


def test_a_turning_hand_rolls_the_near_side_along_the_cursors_way(loop: FakeLoop, hand: VirtualHand) -> None:
    hand.grab(0, "wrist_3", (0.0, 0.0, 0.5), turning=True)
    hand.move(0, (0.0, 0.0, 0.5), (0.0, REACH / 2, 0.5), EYE)
    (touch,) = loop.desk.take().touches
    assert isinstance(touch, Push)
    assert touch.force == (0.0, 0.0, 0.0)
    # The eye is on +x and the cursor goes to +y: the side near the eye goes to +y if it turns about +z.
    assert touch.torque == pytest.approx((0.0, 0.0, FORCE[1] * LEVER / 2))


def test_the_torque_has_a_cap(loop: FakeLoop, hand: VirtualHand) -> None:
    hand.grab(0, "wrist_3", (0.0, 0.0, 0.5), turning=True)
    hand.move(0, (0.0, 0.0, 0.5), (0.0, 9.0, 3.0), EYE)
    (touch,) = loop.desk.take().touches
    assert isinstance(touch, Push)
    assert math.hypot(*touch.torque) == pytest.approx(FORCE[1] * LEVER)


def test_a_cursor_on_the_grabbed_point_turns_nothing(loop: FakeLoop, hand: VirtualHand) -> None:
    hand.grab(0, "wrist_3", (0.0, 0.0, 0.5), turning=True)
    hand.move(0, (0.0, 0.0, 0.5), (0.0, 0.0, 0.5), EYE)
    (touch,) = loop.desk.take().touches
    assert isinstance(touch, Push)
    assert touch.torque == (0.0, 0.0, 0.0)


def test_who_lets_go_moves_nothing_until_it_grabs_again(loop: FakeLoop, hand: VirtualHand) -> None:
    hand.grab(0, "elbow", (0.0, 0.0, 0.5), turning=False)
    hand.move(0, (0.0, 0.0, 0.5), (0.1, 0.2, 0.3), EYE)
    assert hand.holds(0)
    assert hand.let_go(0)
    assert not hand.let_go(0)
    hand.move(0, (0.0, 0.0, 0.5), (0.1, 0.2, 0.4), EYE)
    assert loop.desk.take().touches == ()
    assert not hand.holds(0)


def test_a_touch_is_its_clients_own(loop: FakeLoop, hand: VirtualHand) -> None:
    hand.grab(0, "elbow", (0.0, 0.0, 0.5), turning=False)
    hand.move(0, (0.0, 0.0, 0.5), (0.1, 0.2, 0.3), EYE)
    assert not hand.let_go(1)
    assert len(loop.desk.take().touches) == 1
