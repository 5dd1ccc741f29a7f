"""What follows a contact: where the arm goes (CD-15)."""

import math

import pytest

from pendant.contact.contact_change import ArmPose, Change, Contact
from pendant.program.reaction import Until, goal
from pendant.tick.pose import UNTURNED, from_rpy, quaternion, rotation

BEGUN = ArmPose((0.0,) * 6, (0.0, 0.0, 0.5), UNTURNED)
THERE = ArmPose((0.1,) * 6, (0.0, 0.0, 0.3), UNTURNED)
NOW = ArmPose((0.11,) * 6, (0.0, 0.0, 0.29), UNTURNED)


def contact(change: Change = Change.GAINED, part: str = "tool", pose: ArmPose = THERE) -> Contact:
    return Contact(100, change, "difference", part, "sensor", (0.0, 0.0, -5.0), (0.0, 0.0, 3.0), -1.5, 2, pose)


@pytest.mark.parametrize(
    ("until", "change", "part", "meets"),
    [
        (Until(), Change.LOST, "tool", True),
        (Until(change="gained"), Change.GAINED, "tool", True),
        (Until(change="gained"), Change.CLAMPING, "tool", True),
        (Until(change="gained"), Change.LOST, "tool", False),
        (Until(change="clamping"), Change.GAINED, "tool", False),
        (Until(change="lost"), Change.LOST, "elbow", True),
        (Until(part="tool"), Change.GAINED, "elbow", False),
    ],
)
def test_what_a_move_waits_for(until: Until, change: Change, part: str, meets: bool) -> None:
    assert until.meets(contact(change, part)) is meets


def test_stop_goes_nowhere() -> None:
    assert goal(Until(then="stop"), contact(), begun=BEGUN, now=NOW) is None


def test_back_to_the_contact_pose_and_back_to_the_begin() -> None:
    for then, pose in (("contact_pose", THERE), ("reverse", BEGUN)):
        there = goal(Until(then=then), contact(), begun=BEGUN, now=NOW)
        assert there is not None
        assert (there.q, there.position) == (pose.q, None)


def test_retract_goes_back_along_the_way_it_came_from_the_contact_pose() -> None:
    there = goal(Until(then="retract", distance=0.05), contact(), begun=BEGUN, now=NOW)
    assert there is not None
    assert there.position == pytest.approx((0.0, 0.0, 0.35))
    assert there.quaternion == pytest.approx((1.0, 0.0, 0.0, 0.0))


def test_retract_of_a_tool_that_has_not_moved_stays() -> None:
    there = goal(Until(then="retract"), contact(pose=BEGUN), begun=BEGUN, now=NOW)
    assert there is not None
    assert there.position == BEGUN.p_BT


def test_turn_about_the_tool_where_the_arm_stands() -> None:
    there = goal(Until(then="turn", angle=0.4), contact(), begun=BEGUN, now=NOW)
    assert there is not None
    assert there.position == NOW.p_BT
    assert there.quaternion == pytest.approx((math.cos(0.2), 0.0, 0.0, math.sin(0.2)))


def test_reactions_keep_and_turn_the_tool_where_it_is_turned_in_the_flange() -> None:
    """A tool pitched by a quarter: its z axis is x of the flange."""
    R_FT = from_rpy(0.0, math.pi / 2.0, 0.0)
    back = goal(Until(then="retract"), contact(), begun=BEGUN, now=NOW, R_FT=R_FT)
    assert back is not None
    assert rotation(back.quaternion) == pytest.approx(R_FT, abs=1e-12)
    there = goal(Until(then="turn", angle=0.4), contact(), begun=BEGUN, now=NOW, R_FT=R_FT)
    assert there is not None
    # About its own z, which is x of the base here: x of the tool, which pointed down, swings towards y.
    R = rotation(there.quaternion)
    assert (R[2], R[5], R[8]) == pytest.approx((1.0, 0.0, 0.0), abs=1e-12)
    assert (R[0], R[3], R[6]) == pytest.approx((0.0, math.sin(0.4), -math.cos(0.4)), abs=1e-12)


@pytest.mark.parametrize(
    "wxyz", [(1.0, 0.0, 0.0, 0.0), (0.5, 0.5, -0.5, 0.5), (0.1, 0.9, 0.3, -0.3), (0.05, -0.2, 0.97, 0.1), (0.01, 0.3, -0.1, 0.95)]
)
def test_a_rotation_back_into_its_quaternion(wxyz: tuple[float, float, float, float]) -> None:
    size = math.hypot(*wxyz)
    back = quaternion(rotation(wxyz))
    same = sum(a * b for a, b in zip(back, wxyz, strict=True)) / size
    assert abs(same) == pytest.approx(1.0, abs=1e-12)
    assert math.hypot(*back) == pytest.approx(1.0)


def test_after_a_contact_straight_to_a_place() -> None:
    """CD-15: the tool stays turned as it is."""
    there = goal(Until(then="position", position=(0.1, 0.2, 0.4)), contact(), begun=BEGUN, now=NOW)
    assert there is not None
    assert (there.q, there.position) == ((), (0.1, 0.2, 0.4))
    assert there.quaternion == pytest.approx((1.0, 0.0, 0.0, 0.0))


@pytest.mark.parametrize(
    ("values", "says"),
    [
        ({"then": "position"}, "position: it goes with"),
        ({"position": (0.1, 0.2, 0.3)}, "position: it goes with"),
        ({"within": 0.1, "time": 0.1}, "one of them says how the arm stops"),
    ],
)
def test_what_does_not_go_together_is_refused(values: dict[str, object], says: str) -> None:
    with pytest.raises(ValueError, match=says):
        Until(**values)  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("until", "speed", "time"),
    [
        (Until(within=0.05), 0.2, 0.5),  # half a cosine: the way is half of speed times time
        (Until(within=0.05), 0.1, 1.0),
        (Until(time=0.4), 0.2, 0.4),
        (Until(time=0.4), 0.0, 0.4),
        (Until(), 0.2, 0.0),
        (Until(within=0.05), 0.0, 0.0),
    ],
)
def test_a_gentle_stop_brakes_as_its_way_or_its_time_asks_for(until: Until, speed: float, time: float) -> None:
    """CD-15: the peak of half a cosine's deceleration is pi/2 of its mean."""
    expected = math.inf if time == 0.0 else 0.5 * math.pi * speed / time
    assert until.deceleration(speed) == pytest.approx(expected)
