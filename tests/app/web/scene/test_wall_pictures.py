"""Virtual walls and areas in the picture."""

import math

import numpy as np
import pytest

from app.web.scene.wall_pictures import AMBER, GLOWING, GREEN, GREY, RED, DrawnWall
from app.web.server import Served
from pendant.tick.pose import Pose, from_rpy
from pendant.walls.barrier import Place
from pendant.walls.containment import TETHER, WallState
from pendant.walls.definitions import AnyBorder, Area, Policy, Wall
from pendant.walls.shapes import Box, HalfSpace, Sphere
from tests.app.web.fake_loop import FakeLoop

CART = Area(name="cart", shape=Box(size=(0.2, 0.3, 0.4)), position=(0.5, 0.0, 0.2), keep_out=True)
BALL = Wall(name="ball", shape=Sphere(radius=0.1), policy=Policy.FIXED)
AT = Place(Pose((0.5, 0.1, 0.2)), 1.0)


def state(name: str, distance: float = -0.05, near: float = 0.0, force: float = 0.0) -> WallState:
    """Of a part at (0.4, 0, 0.3) with a wall along x."""
    return WallState(name, "flange", (0.4, 0.0, 0.3), distance, (1.0, 0.0, 0.0), near, distance > 0.0, (-force, 0.0, 0.0))


def shown(loop: FakeLoop, still: Served, border: AnyBorder, place: Place = AT, *states: WallState) -> DrawnWall:
    loop.places, loop.states = ((border, place),), states
    still.scene.walls.show(loop.latest())
    return still.scene.walls._drawn[border.name]


def test_an_area_that_does_not_hold_is_grey_and_has_its_name(loop: FakeLoop, still: Served) -> None:
    drawn = shown(loop, still, CART, Place(Pose((0.5, 0.1, 0.2), from_rpy(0.0, 0.0, math.pi / 2)), 0.5))
    assert drawn.surface.color == GREY
    assert drawn.surface.position == pytest.approx((0.5, 0.1, 0.2))
    assert drawn.surface.wxyz == pytest.approx((math.sqrt(0.5), 0.0, 0.0, math.sqrt(0.5)))
    assert drawn.surface.scale == drawn.outline.scale == 0.5
    assert (drawn.label.text, drawn.label.visible, drawn.way.visible) == ("cart", True, False)


@pytest.mark.parametrize(
    ("now", "text", "colour"),
    [
        (state("ball"), "ball: 50 mm left", GREEN),
        (state("ball", -0.01, 0.5), "ball: 10 mm left", AMBER),
        (state("ball", -0.01, 0.5, 12.3), "ball: 10 mm left, resists 12 N", AMBER),
        (state("ball", 0.004, 1.0, 40.0), "ball: 4 mm beyond, resists 40 N", RED),
    ],
)
def test_a_wall_tells_its_distance_and_force_and_has_the_colour_of_its_state(
    loop: FakeLoop, still: Served, now: WallState, text: str, colour: tuple[int, int, int]
) -> None:
    drawn = shown(loop, still, BALL, AT, now)
    assert (drawn.label.text, drawn.surface.color) == (text, colour)
    assert np.asarray(drawn.outline.colors).reshape(-1, 3)[0] == pytest.approx(colour)
    part, wall = np.asarray(drawn.way.points)[0]
    assert part == pytest.approx((0.4, 0.0, 0.3))
    assert wall == pytest.approx((0.4 - now.distance, 0.0, 0.3))
    assert drawn.label.position == pytest.approx(wall)
    assert drawn.force.visible == (now.force[0] != 0.0)
    if drawn.force.visible:
        tail, tip = np.asarray(drawn.force.points)[0]
        assert tail == pytest.approx((0.4, 0.0, 0.3))
        assert tip - tail == pytest.approx((-max(0.004 * -now.force[0], 0.05), 0.0, 0.0))


def test_the_plane_of_a_wall_lies_before_its_anchor_and_that_of_an_area_under_the_base(loop: FakeLoop, still: Served) -> None:
    shape = HalfSpace(normal=(0.0, 0.0, -2.0), distance=0.1)
    place = Place(Pose((0.3, 0.2, 0.5)), 0.5)
    wall = shown(loop, still, Wall(name="down", shape=shape), place)
    assert wall.surface.position == pytest.approx((0.3, 0.2, 0.45))
    assert wall.surface.scale == 1.0
    area = shown(loop, still, Area(name="table", shape=shape), place)
    assert area.surface.position == pytest.approx((0.0, 0.0, 0.45))
    turned = Place(Pose((0.3, 0.2, 0.5), from_rpy(0.0, math.pi / 2, 0.0)), 1.0)  # its normal is then -x
    area = shown(loop, still, Area(name="table", shape=shape), turned)
    assert area.surface.position == pytest.approx((0.2, 0.0, 0.0))


def test_the_tether_is_shown_only_when_it_resists(loop: FakeLoop, still: Served) -> None:
    tether = Wall(name=TETHER, shape=Sphere(radius=0.03), policy=Policy.AVERAGE)
    drawn = shown(loop, still, tether, AT, state(TETHER, -0.03))
    assert not any(node.visible for node in (drawn.surface, drawn.outline, drawn.label, drawn.way))
    assert not still.scene.walls.show(loop.latest())
    shown(loop, still, tether, AT, state(TETHER, -0.003, 0.4))
    assert all(node.visible for node in (drawn.surface, drawn.outline, drawn.label, drawn.way))
    shown(loop, still, tether)
    assert not any(node.visible for node in (drawn.surface, drawn.outline, drawn.label, drawn.way))


def test_nothing_is_sent_while_nothing_changes_and_walls_that_are_gone_are_taken_away(loop: FakeLoop, still: Served) -> None:
    first = shown(loop, still, BALL, AT, state("ball"))
    assert not still.scene.walls.show(loop.latest())
    loop.places = ((BALL, Place(Pose((0.5, 0.1, 0.2 + 1e-6)), 1.0)),)
    assert not still.scene.walls.show(loop.latest())
    loop.places = ((BALL, Place(Pose((0.5, 0.1, 0.201)), 1.0)),)
    assert still.scene.walls.show(loop.latest())
    again = Wall(name="ball", shape=Sphere(radius=0.1), policy=Policy.FIXED, band=0.01)  # looks the same
    assert shown(loop, still, again, AT, state("ball")) is first
    other = shown(loop, still, Wall(name="ball", shape=Sphere(radius=0.2)), AT, state("ball"))
    assert other is not first
    loop.places = loop.states = ()
    assert still.scene.walls.show(loop.latest())
    assert still.scene.walls._drawn == {}
    assert not still.scene.walls.show(loop.latest())
    assert not [name for name in still.server.scene._handle_from_node_name if name.startswith("/walls/")]


def test_they_stand_where_the_base_stands(loop: FakeLoop, still: Served) -> None:
    snapshot = loop.latest()
    snapshot.truth_links[0] = (0.1, 0.2, 0.3, math.sqrt(0.5), math.sqrt(0.5), 0.0, 0.0)
    assert still.scene.walls.show(snapshot)
    assert still.scene.walls._root.position == pytest.approx((0.1, 0.2, 0.3))
    assert still.scene.walls._root.wxyz == pytest.approx((math.sqrt(0.5), math.sqrt(0.5), 0.0, 0.0), abs=1e-5)


def test_the_nearest_wall_glows_the_more_the_nearer_it_is(loop: FakeLoop, still: Served) -> None:
    far = shown(loop, still, BALL, AT, state("ball", -0.5)).surface.opacity
    near = shown(loop, still, BALL, AT, state("ball", -0.1)).surface.opacity
    at = shown(loop, still, BALL, AT, state("ball", 0.0)).surface.opacity
    assert far < near < at <= GLOWING + 0.02
