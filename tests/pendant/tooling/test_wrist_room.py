"""Room for the wrist on a way: ranges, the arm itself, the plane of its base, walls."""

import numpy as np
import pytest

from pendant.equipment.tools import BARE, Tool
from pendant.tick.pose import HERE, Pose
from pendant.tooling.settings import ToolUse
from pendant.tooling.wrist_room import TOOL, WristRoom
from pendant.walls.barrier import Place
from pendant.walls.definitions import Area
from pendant.walls.shapes import HalfSpace, Sphere
from tests.pendant.tooling.wrists import HOME, RODS, wrist_arm

USE = ToolUse()
BEGIN = np.array(HOME)


def way(**turned: float) -> np.ndarray:
    """From home to a posture in which some joints have other angles."""
    end = np.array(HOME)
    for name, angle in turned.items():
        end[int(name[1:])] = angle
    return HOME + np.linspace(0.0, 1.0, 20)[:, None] * (end - HOME)


def test_a_wrist_in_the_open_has_room() -> None:
    room = WristRoom(wrist_arm(), BEGIN, BARE, USE)
    assert room.obstacle(way(q3=-1.3, q4=-0.8, q5=1.0)) is None
    assert room.obstacle(way()) is None


def test_the_end_of_a_range_is_kept_away_from() -> None:
    room = WristRoom(wrist_arm(ranges=2.0), BEGIN, BARE, USE)
    assert room.obstacle(way(q5=2.0 - USE.clearance - 1e-3)) is None
    found = room.obstacle(way(q5=2.0 - USE.clearance + 1e-3))
    assert found is not None
    assert found.what == "the end of the range of wrist_3"
    assert found.gap == pytest.approx(USE.clearance - 1e-3)


def test_a_joint_that_is_near_its_end_may_stay_so_but_not_go_further() -> None:
    room = WristRoom(wrist_arm(ranges=1.88), BEGIN, BARE, USE)  # wrist_1 is at -1.87
    assert room.obstacle(way(q3=-1.8)) is None
    assert room.obstacle(way(q3=-1.87, q4=-1.0)) is None
    found = room.obstacle(way(q3=-1.875))
    assert found is not None
    assert found.what == "the end of the range of wrist_1"


def test_the_tool_does_not_come_near_the_forearm() -> None:
    """Turned up about wrist 1, a long tool meets the forearm; on the way, not at its end."""
    shape, tool = wrist_arm(), Tool(name="lance", mass=0.5, com=[0.0, 0.0, 0.1], tcp=[0.0, 0.0, 0.3])
    room = WristRoom(shape, BEGIN, tool, USE)
    found = room.obstacle(way(q3=HOME[3] + 2.4))
    assert found is not None
    assert found.what in (f"{TOOL} to elbow", f"{TOOL} to shoulder")
    assert found.gap < USE.clearance
    assert WristRoom(shape, BEGIN, tool, ToolUse(room=0.02, clearance=0.005)).obstacle(way(q3=HOME[3] - 0.5)) is None


def test_what_the_arm_has_no_hull_of_is_not_met() -> None:
    tool = Tool(name="lance", mass=0.5, com=[0.0, 0.0, 0.1], tcp=[0.0, 0.0, 0.3])
    room = WristRoom(wrist_arm(rods=RODS[3:]), BEGIN, tool, USE)
    found = room.obstacle(way(q3=HOME[3] + 2.4))
    assert found is None or "elbow" not in found.what


def test_it_stays_above_the_plane_of_its_base() -> None:
    low = np.array(HOME)
    low[1], low[2] = -0.55, 1.0  # the wrist close above the table
    shape = wrist_arm()
    height = float(shape.places(low[None])[0][0, -1, 2])
    assert height > 0.0
    turned = low + np.linspace(0.0, 1.0, 20)[:, None] * [0.0, 0.0, 0.0, 1.2, 0.0, 0.0]
    lance = Tool(name="lance", mass=0.5, com=[0.0, 0.0, 0.1], tcp=[0.0, 0.0, max(height, 0.2)])
    found = WristRoom(shape, low, lance, USE).obstacle(turned)
    assert found is not None
    assert found.what == f"{TOOL} to the plane of the base"


@pytest.mark.parametrize(("keep_out", "far"), [(True, 0.2), (False, 0.02)])
def test_a_wall_is_kept_away_from(keep_out: bool, far: float) -> None:
    """A ball round a point beside the tool, to stay out of; or one round the tool, to stay in."""
    shape = wrist_arm()
    begin, end = (shape.places(way(q4=-0.6)[[k]])[0][0, -1] for k in (0, -1))
    centre = end if keep_out else begin
    area = Area(name="post", part="tcp", shape=Sphere(radius=0.05), keep_out=keep_out)
    room = WristRoom(shape, BEGIN, BARE, USE, borders=((area, Place(Pose(tuple(centre.tolist())), 1.0)),))
    found = room.obstacle(way(q4=-0.6))
    assert found is not None
    assert found.what == "tcp to the wall post"
    assert found.gap < far
    small = way(q4=-1.57 + 0.02)
    assert room.obstacle(small) is None


def test_a_wall_has_the_size_of_its_place() -> None:
    shape = wrist_arm()
    end = shape.places(way(q4=-0.6)[-1:])[0][0, -1]
    area = Area(name="post", part="flange", shape=Sphere(radius=1.0), keep_out=True)
    place = Place(Pose(tuple(end.tolist())), 0.01)
    found = WristRoom(shape, BEGIN, BARE, USE, borders=((area, place),)).obstacle(way(q4=-0.6))
    assert found is not None
    assert found.gap == pytest.approx(-0.01, abs=1e-9)


def test_what_is_near_where_it_begins_may_be_as_near_again() -> None:
    """Back to the first posture, in which it is nearer to a wall than the clearance."""
    shape = wrist_arm()
    p = shape.places(BEGIN[None])[0][0, -1]
    desk = Area(name="desk", part="flange", shape=HalfSpace(normal=(0.0, 0.0, 1.0), distance=float(p[2]) - 0.01), keep_out=True)
    walls = ((desk, Place(HERE, 1.0)),)
    back = way(q3=-2.4, q4=-2.0)[::-1]
    heights = shape.places(back)[0][:, -1, 2]
    assert heights[0] > float(p[2]) - 0.01 + USE.clearance
    assert WristRoom(shape, BEGIN, BARE, USE, borders=walls).obstacle(back) is None
    assert WristRoom(shape, back[0], BARE, USE, borders=walls).obstacle(back) is not None


def test_the_elbow_stands_still_and_may_stay_where_it_is() -> None:
    area = Area(name="desk", part="elbow", shape=HalfSpace(normal=(0.0, 0.0, 1.0), distance=5.0), keep_out=True)
    assert WristRoom(wrist_arm(), BEGIN, BARE, USE, borders=((area, Place(HERE, 1.0)),)).obstacle(way(q4=-0.6)) is None
