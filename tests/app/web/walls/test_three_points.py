"""A plane through three points that the tool was brought to: where it lies, and which side is allowed."""

import math
from collections.abc import Callable

import numpy as np
import pytest

from app.web.server import Served
from app.web.walls.made_walls import made, moved
from app.web.walls.three_points import LOWEST, plane_through
from pendant.tick.pose import Pose, Rotation, from_rpy, seen_from
from pendant.walls.barrier import placed
from pendant.walls.definitions import AnyBorder, Area
from tests.app.web.fake_loop import FakeLoop
from tests.app.web.raw_client import RawClient, until
from tests.app.web.walls.test_walls_tab import wished

Join = Callable[[], RawClient]
DOWN = from_rpy(math.pi, 0.0, 0.4)
LEVEL = ((0.4, 0.0, 0.1), (0.6, 0.1, 0.1), (0.4, 0.3, 0.1))


def beyond(points: list[Pose], probe: tuple[float, float, float]) -> float:
    """How far a point of B is beyond the plane through these points [m]."""
    found = plane_through(points)
    assert found is not None
    area = moved(made("Plane", frozenset(), Pose()), None, *found)
    place = placed(area, area.position, 1.0, Pose())
    return area.shape.field()(*seen_from(place.pose, probe))[0]


def tools(R: Rotation, points: tuple[tuple[float, float, float], ...] = LEVEL) -> list[Pose]:
    return [Pose(point, R) for point in points]


@pytest.mark.parametrize("order", [(0, 1, 2), (2, 1, 0), (1, 0, 2)])
def test_the_side_that_the_tool_comes_from_is_allowed_in_whatever_order_the_points_are_taken(order: tuple[int, ...]) -> None:
    points = [tools(DOWN)[k] for k in order]
    for x, y in ((0.0, 0.0), (0.5, 0.2)):
        assert beyond(points, (x, y, 0.3)) == pytest.approx(-0.2)
        assert beyond(points, (x, y, 0.07)) == pytest.approx(0.03)
    assert beyond([Pose(p, from_rpy(0.0, 0.0, 0.4)) for p in LEVEL], (0.0, 0.0, 0.3)) == pytest.approx(0.2), "from below"


def test_a_sloping_plane_goes_through_its_points() -> None:
    R = np.array(from_rpy(0.3, -0.5, 0.2)).reshape(3, 3)
    taken = [tuple(float(way) for way in R @ np.array(point)) for point in LEVEL]
    for x, y, z in taken:
        assert beyond([Pose((a, b, c), DOWN) for a, b, c in taken], (x, y, z)) == pytest.approx(0.0, abs=1e-12)


def test_of_a_tool_that_lies_along_the_plane_the_base_is_on_the_allowed_side() -> None:
    upright = ((0.7, 0.0, 0.1), (0.7, 0.2, 0.1), (0.7, 0.1, 0.5))
    assert beyond(tools(DOWN, upright), (0.0, 0.0, 0.0)) == pytest.approx(-0.7)


def test_points_in_a_line_make_no_plane() -> None:
    assert plane_through(tools(DOWN, ((0.4, 0.0, 0.1), (0.5, 0.0, 0.1), (0.6, 0.9 * LOWEST / 2, 0.1)))) is None
    assert plane_through(tools(DOWN, (LEVEL[0],) * 3)) is None
    assert plane_through(tools(DOWN, ((0.4, 0.0, 0.1), (0.6, 0.0, 0.1), (0.5, 1.1 * LOWEST, 0.1)))) is not None


def test_three_points_make_a_wall_on_the_page(served: Served, join: Join, loop: FakeLoop) -> None:
    client, tab = join(), served.docks.walls
    poses = iter(tools(DOWN))
    tab.points._tool = lambda: next(poses)
    for count in (1, 2):
        client.set(tab.points.take._impl.uuid, value=True)
        until(lambda count=count: f"{count} of 3" in tab.points.said.shown, "taken")
    client.set(tab.points.take._impl.uuid, value=True)

    def level(walls: tuple[AnyBorder, ...]) -> bool:
        (wall,) = walls
        return isinstance(wall, Area) and wall.name == "plane 1" and wall.position == pytest.approx((1.4 / 3, 0.4 / 3, 0.1))

    wished(loop, level, "the plane")
    until(lambda: tab.choice.value == "plane 1" and tab.points.again.disabled, "chosen, and no points are left")


def test_points_are_forgotten_and_a_line_is_refused_in_words(served: Served, join: Join, loop: FakeLoop) -> None:
    client, points = join(), served.docks.walls.points
    points._tool = lambda: Pose(LEVEL[0], DOWN)
    client.set(points.take._impl.uuid, value=True)
    until(lambda: not points.again.disabled, "one")
    client.set(points.again._impl.uuid, value=True)
    until(lambda: points.again.disabled and points._balls == [], "forgotten")
    for count in (1, 2):
        client.set(points.take._impl.uuid, value=True)
        until(lambda count=count: len(points._points) == count, "taken")
    client.set(points.take._impl.uuid, value=True)
    until(lambda: "nearly in one line" in points.said.shown, "refused")
    assert loop.wishes == [] or loop.wishes[-1].inputs.borders is None
