"""Areas as the page makes and moves them."""

import dataclasses
import math

import numpy as np
import pytest
from msgspec.structs import replace

from app.web.walls.made_walls import (
    AHEAD,
    FARTHEST,
    SHAPES,
    SIZES,
    about,
    at_tool,
    fixed,
    frame_of,
    inwards,
    made,
    moved,
    sized,
    sizes,
    tool_pose,
)
from pendant.tick.pose import Pose, from_rpy, quaternion, rotation, seen_from, turned
from pendant.walls.barrier import Place, placed
from pendant.walls.definitions import Area, Wall
from pendant.walls.shapes import Cone, HalfSpace, Sphere
from tests.app.web.fake_loop import FakeLoop

TOOL = Pose((0.4, -0.2, 0.3), from_rpy(math.pi, 0.2, 0.7))
CART = Pose((1.0, 0.5, -0.2), from_rpy(0.1, -0.4, 2.0))


def far_out(area: Area, point: tuple[float, float, float]) -> float:
    """How far a point of B is beyond an area whose reference is B [m]."""
    place = placed(area, area.position, 1.0, Pose())
    x, y, z = seen_from(place.pose, point)
    distance = area.shape.field()(x, y, z)[0]
    return -distance if area.keep_out else distance


def test_a_plane_lies_ahead_of_the_tool_which_is_on_its_allowed_side() -> None:
    plane = made("Plane", frozenset(), TOOL)
    assert far_out(plane, TOOL.p) == pytest.approx(-AHEAD)
    ahead = turned(TOOL.R, (0.0, 0.0, AHEAD + 0.03))
    assert far_out(plane, (TOOL.p[0] + ahead[0], TOOL.p[1] + ahead[1], TOOL.p[2] + ahead[2])) == pytest.approx(0.03)
    assert inwards(plane) == (0.0, 0.0, -1.0)
    assert inwards(replace(plane, keep_out=True)) == (0.0, 0.0, 1.0)


@pytest.mark.parametrize("shape", ["Sphere", "Box", "Cylinder"])
def test_another_shape_lies_round_the_tool_and_upright(shape: str) -> None:
    area = made(shape, frozenset(), TOOL)
    assert far_out(area, TOOL.p) == pytest.approx(-0.2)
    assert area.orientation == (1.0, 0.0, 0.0, 0.0)
    assert area.part == "tcp"


def test_a_new_one_has_a_name_of_its_own() -> None:
    assert made("Box", frozenset({"box 1", "box 3"}), TOOL).name == "box 2"


@pytest.mark.parametrize("shape", list(SHAPES))
def test_its_sizes_are_changed_and_read_back(shape: str) -> None:
    values = tuple(150.0 + 10.0 * k for k in range(len(SIZES.get(type(SHAPES[shape]), ()))))
    assert sizes(sized(SHAPES[shape], values)) == pytest.approx(values)


def test_a_shape_of_a_file_that_cannot_be_made_here_keeps_its_sizes() -> None:
    cone = Cone(radius=0.1, height=0.2)
    assert sizes(cone) == ()
    assert sized(cone, ()) is cone


def test_moved_in_the_picture_it_lies_there_whatever_its_reference_is() -> None:
    for reference, frame in (("base", Pose()), ("cart", CART)):
        area = Area(
            name="a", shape=Sphere(radius=0.1), reference=reference, position=(0.1, 0.2, 0.3), orientation=(0.6, 0.0, 0.8, 0.0)
        )
        place = placed(area, area.position, 1.0, frame)
        wanted = Pose((0.3, -0.1, 0.5), from_rpy(0.3, 0.2, 0.1))
        turn = quaternion(wanted.R)
        there = moved(area, place, wanted.p, (2.0 * turn[0], 2.0 * turn[1], 2.0 * turn[2], 2.0 * turn[3]))
        seen = placed(there, there.position, 1.0, frame)
        np.testing.assert_allclose(seen.pose.p, wanted.p, atol=1e-12)
        np.testing.assert_allclose(seen.pose.R, wanted.R, atol=1e-12)
        back = moved(there, seen, place.pose.p, quaternion(place.pose.R))
        np.testing.assert_allclose(back.position, area.position, atol=1e-12)
        assert rotation(back.orientation) == pytest.approx(rotation(area.orientation))


def test_what_is_moved_too_far_stays_in_what_a_file_may_say() -> None:
    area = Area(name="a", shape=Sphere(radius=0.1))
    assert moved(area, None, (99.0, -99.0, 0.0), (1.0, 0.0, 0.0, 0.0)).position == (FARTHEST / 1e3, -FARTHEST / 1e3, 0.0)


def test_brought_to_the_tool_a_plane_turns_with_it_and_a_ball_does_not() -> None:
    plane = at_tool(Area(name="a", shape=HalfSpace(normal=(0.0, 0.0, 1.0))), None, TOOL)
    assert rotation(plane.orientation) == pytest.approx(TOOL.R)
    there = Place(Pose((9.0, 0.0, 0.0), from_rpy(0.0, 0.0, 1.0)), 1.0)
    ball = at_tool(Area(name="b", shape=Sphere(radius=0.1)), there, TOOL)
    assert (ball.position, rotation(ball.orientation)) == (TOOL.p, pytest.approx(there.pose.R))


def test_the_pose_of_a_tool_is_the_flange_s_and_the_tool_s() -> None:
    R_BF, R_FT = np.array(TOOL.R).reshape(3, 3), np.array(from_rpy(0.0, 0.5, 0.0)).reshape(3, 3)
    pose = tool_pose(np.array(TOOL.p), R_BF, (0.0, 0.0, 0.1), R_FT)
    np.testing.assert_allclose(pose.p, np.array(TOOL.p) + 0.1 * R_BF[:, 2])
    np.testing.assert_allclose(np.array(pose.R).reshape(3, 3), R_BF @ R_FT)


def test_the_list_says_what_each_is() -> None:
    area = Area(name="a", part="tcp", shape=Sphere(radius=0.1))
    assert about(area) == "Tool: stay inside"
    assert about(replace(area, keep_out=True, part="elbow")) == "Elbow: keep out"
    assert about(replace(area, on=False)) == "off"
    assert about(Wall(name="w", shape=Sphere(radius=0.1))) == "Flange: round it"


@pytest.mark.parametrize("frame", [Pose(), CART, TOOL])
def test_fixed_to_something_else_it_stays_where_it_lies_and_moves_with_that(frame: Pose) -> None:
    area = replace(made("Box", frozenset(), TOOL), orientation=quaternion(from_rpy(0.3, -0.2, 0.9)))
    lies = placed(area, area.position, 1.0, Pose())
    with_it = fixed(area, None, "cart", frame)
    again = placed(with_it, with_it.position, 1.0, frame)
    assert (with_it.reference, again.pose.p) == ("cart", pytest.approx(lies.pose.p))
    assert pytest.approx(lies.pose.R) == again.pose.R
    back = fixed(with_it, again, "base", Pose())
    assert back.position == pytest.approx(area.position)
    pushed = placed(with_it, with_it.position, 1.0, frame._replace(p=tuple(value + 0.1 for value in frame.p)))  # type: ignore[arg-type]
    assert pushed.pose.p == pytest.approx([value + 0.1 for value in lies.pose.p])


def test_a_frame_is_where_the_snapshot_says(loop: FakeLoop) -> None:
    """The base stands turned about z by 90 degrees, one metre along x of the world; the cart a metre further along y."""
    half = math.sqrt(0.5)
    shown = loop.latest()
    links = shown.truth_links.copy()
    links[0] = [1.0, 0.0, 0.0, half, 0.0, 0.0, half]
    snapshot = dataclasses.replace(shown, truth_links=links, truth_objects=np.array([[1.0, 1.0, 0.0, half, 0.0, 0.0, half]]))
    cart = frame_of("cart", snapshot, ("cart",))
    assert cart.p == pytest.approx((1.0, 0.0, 0.0))
    assert pytest.approx(np.eye(3).ravel().tolist()) == cart.R
    assert frame_of("base", snapshot, ()) == Pose()
    assert frame_of("flange", snapshot, ()).p == pytest.approx(snapshot.estimate.p_BF.tolist())
    assert frame_of("tcp", snapshot, ()).p == pytest.approx(snapshot.estimate.p_BF.tolist()), "no tool is fitted"
