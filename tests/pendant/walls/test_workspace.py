"""The workspace: which areas bind the arm's own motions, how far off they are, how far out a motion may lead (VW-9, VW-10).

And the areas beyond which the safety mode is REDUCED (RL-7).
"""

import math

import numpy as np
import pytest
from msgspec.structs import replace

from pendant.all_settings import Settings, apply
from pendant.events.event import Event, Kind
from pendant.inputs import NOTHING, Command, Inputs
from pendant.supervisor import Supervisor
from pendant.tick.estimate import Estimate
from pendant.tick.modes import Safety
from pendant.tick.pose import HERE, Pose, from_rpy
from pendant.walls.containment import Containment
from pendant.walls.definitions import Area, Dependence, Measure, Wall
from pendant.walls.shapes import Box, HalfSpace, Sphere
from pendant.walls.workspace import SIDEWAYS, TOLERANCE, ArmPoints, OutwardLimits, Workspace, told, way
from tests.pendant.estimates import estimate

FLOOR = Area(name="floor", part="tcp", shape=HalfSpace(normal=(0.0, 0.0, -1.0)), position=(0.0, 0.0, -0.1))
POST = Area(name="post", part="elbow", shape=Sphere(radius=0.2), position=(1.0, 0.0, 0.0), keep_out=True)
SETTINGS = Settings()


def points(
    flange: tuple[float, float, float] = (0.0, 0.0, 0.0),
    tcp: tuple[float, float, float] = (0.0, 0.0, 0.0),
    elbow: tuple[float, float, float] = (0.0, 0.0, 0.0),
    load: float = 0.0,
) -> ArmPoints:
    return ArmPoints(Pose(flange), Pose(tcp), elbow, (0.0, 0.0, -9.81), load)


def space(*areas: Area, **frames: Pose) -> Workspace:
    return Workspace(areas, {"base": HERE, **frames})


def test_each_area_watches_its_own_part() -> None:
    seen = space(FLOOR, POST).distances(points(tcp=(5.0, 5.0, -0.07), elbow=(0.5, 0.0, 0.0)))
    assert seen == pytest.approx([-0.03, -0.3])
    near = space(FLOOR, POST).nearby(1, points(elbow=(1.0, 0.0, 0.19)))
    assert (near.border, near.p) == (POST, (1.0, 0.0, 0.19))
    assert near.distance == pytest.approx(0.01)
    assert near.outward == pytest.approx((0.0, 0.0, -1.0))


def test_an_area_lies_in_a_frame_that_stands_still_or_moves_with_the_tool() -> None:
    cart = Pose((0.0, 0.0, 1.0), from_rpy(math.pi, 0.0, 0.0))
    upside_down = Area(name="roof", part="tcp", reference="cart", shape=FLOOR.shape)
    assert space(upside_down, cart=cart).distances(points(tcp=(0.0, 0.0, 0.8))) == pytest.approx([-0.2])
    round_the_tool = Area(name="round", part="elbow", reference="tcp", shape=Sphere(radius=0.3), keep_out=True)
    round_the_flange = Area(name="round", part="elbow", reference="flange", shape=Sphere(radius=0.3), keep_out=True)
    arm = points(flange=(1.0, 0.0, 0.0), tcp=(1.0, 0.0, 0.2), elbow=(0.5, 0.0, 0.2))
    assert space(round_the_tool, round_the_flange).distances(arm) == pytest.approx([-0.2, 0.3 - math.hypot(0.5, 0.2)])


def test_a_frame_that_turns_turns_the_way_out() -> None:
    side = Area(name="side", part="elbow", reference="tcp", shape=HalfSpace(normal=(1.0, 0.0, 0.0)))
    arm = ArmPoints(HERE, Pose((0.0, 0.0, 0.0), from_rpy(0.0, 0.0, math.pi / 2)), (0.0, 0.2, 0.0), (0.0, 0.0, -9.81), 0.0)
    near = space(side).nearby(0, arm)
    assert near.distance == pytest.approx(0.2)
    assert near.outward == pytest.approx((0.0, 1.0, 0.0))


@pytest.mark.parametrize(
    ("measure", "low", "half", "high"),
    [
        (Measure.REACH, points(flange=(0.3, 0.0, 0.0)), points(flange=(0.0, -0.4, 0.0)), points(flange=(0.0, 0.0, 0.5))),
        (Measure.HEIGHT, points(flange=(9.0, 0.0, 0.3)), points(flange=(9.0, 0.0, 0.4)), points(flange=(0.0, 0.0, 0.6))),
        (Measure.PAYLOAD, points(load=0.2), points(load=0.4), points(load=3.0)),
        (Measure.MANIPULABILITY, points(), points(), points()),
    ],
)
def test_a_size_follows_its_measure(measure: Measure, low: ArmPoints, half: ArmPoints, high: ArmPoints) -> None:
    """VW-8; what is not measured has its smallest size."""
    size = Dependence(measure=measure, low=0.3, high=0.5, at_low=1.0, at_high=2.0)
    ball = Area(name="ball", part="tcp", shape=Sphere(radius=0.1), size=size)
    radii = [-space(ball).distances(each)[0] for each in (low, half, high)]
    assert radii == pytest.approx([0.1] * 3 if measure is Measure.MANIPULABILITY else [0.1, 0.15, 0.2])


def begun(*distances: float) -> OutwardLimits:
    limits = OutwardLimits(len(distances))
    limits.begin(list(distances))
    return limits


def test_a_motion_that_begins_inside_may_go_to_the_border_and_a_hair_beyond() -> None:
    limits = begun(-0.3, -0.001)
    assert limits.place == [0.0, 0.0]
    assert limits.bound == [SIDEWAYS, SIDEWAYS]
    assert limits.beyond([-0.1, TOLERANCE]) is None
    assert limits.beyond([0.0011, 0.0]) == 0
    assert limits.beyond([0.0011, 0.002]) == 1
    assert limits.beyond([math.nan, 0.0]) == 0


def test_one_that_begins_outside_may_come_back_and_not_go_out_again() -> None:
    """VW-10."""
    limits = begun(0.08)
    assert limits.place == [0.08]
    assert limits.bound == pytest.approx([0.08 + SIDEWAYS])
    assert limits.beyond([0.0809]) is None
    assert limits.beyond([0.0811]) == 0
    limits.step([0.05])
    assert limits.bound == pytest.approx([0.05 + TOLERANCE])
    assert limits.beyond([0.06]) == 0
    limits.step([0.055])
    assert limits.place == [0.05]
    limits.step([-0.2])
    assert (limits.place, limits.bound) == ([0.0], [TOLERANCE])
    limits.step([-0.1])
    assert limits.place == [0.0]


def test_motions_one_after_the_other_creep_no_further_out() -> None:
    limits = begun(0.0)
    for _ in range(20):
        limits.begin(limits.bound)
        assert limits.place == [0.0]
    assert limits.bound == [TOLERANCE]


def test_an_arm_that_somebody_else_has_brought_out_is_not_held_where_it_was() -> None:
    limits = begun(-0.1)
    limits.begin([0.03])
    assert limits.place == [0.03]
    limits.begin([0.02])
    assert limits.place == [0.02]


def test_a_look_ahead_changes_nothing() -> None:
    limits = begun(0.08)
    ahead = limits.copy()
    ahead.step([0.01])
    assert (limits.place, limits.bound) == ([0.08], pytest.approx([0.08 + SIDEWAYS]))
    assert ahead.place == [0.01]


def test_what_is_told_says_part_area_and_the_way_back() -> None:
    near = space(FLOOR).nearby(0, points(tcp=(0.3126, -0.1, -0.1004)))
    assert told(near) == "tcp at the border of floor; back is +z of the base"
    near = space(FLOOR).nearby(0, points(tcp=(0.0, 0.0, -0.15)))
    assert told(near) == "tcp 50 mm beyond floor; back is +z of the base"
    assert way((0.6, -0.6, 0.3)) == "-x +y"


def bound(*borders: Area | Wall, **changes: bool) -> Workspace | None:
    settings = apply(SETTINGS, {name.replace("__", "."): value for name, value in changes.items()})
    return Containment(borders, {}).workspace(settings.walls)


def test_areas_that_are_on_bind_and_nothing_else() -> None:
    """A wall round a part is anchored by free-drive and taken along by a hand (VW-3 to VW-6)."""
    wall = Wall(name="wall", shape=Sphere(radius=0.1))
    off = Area(name="off", shape=Sphere(radius=0.1), on=False)
    made = bound(FLOOR, wall, off, POST)
    assert made is not None
    assert [area.name for area in made.areas] == ["floor", "post"]
    assert bound(wall, off) is None
    assert bound() is None
    assert bound(FLOOR, walls__on=False) is None


def test_sizes_that_are_switched_off_have_their_smallest() -> None:
    size = Dependence(measure=Measure.PAYLOAD, low=0.0, high=1.0, at_low=0.5, at_high=2.0)
    made = bound(Area(name="ball", part="tcp", shape=Sphere(radius=0.1), size=size), walls__sizes=False)
    assert made is not None
    assert made.distances(points(load=1.0)) == pytest.approx([-0.05])


def test_it_is_the_same_until_walls_or_settings_change() -> None:
    containment = Containment((FLOOR,), {})
    made = containment.workspace(SETTINGS.walls)
    assert containment.workspace(SETTINGS.walls) is made
    other = apply(SETTINGS, {"walls.band": 0.004})
    assert containment.workspace(other.walls) is not made
    containment.change((POST,), "", 0)
    changed = containment.workspace(SETTINGS.walls)
    assert changed is not None
    assert changed.areas == (POST,)


def stopped_at(place: list[float]) -> Estimate:
    return estimate(tcp=[*place, 0.0, 0.0, 0.0], elbow=[0.0] * 6)


def test_the_event_of_a_stop_names_wall_part_place_and_way_back() -> None:
    containment = Containment((POST, FLOOR), {})
    (event,) = containment.reached(stopped_at([0.2, 0.1, -0.099]), "floor", SETTINGS.walls)
    values = {"wall": "floor", "part": "tcp", "distance": pytest.approx(-1.0), "way": "+z"}
    place = {"x": 0.0, "y": 0.0, "z": 1.0, "px": 0.2, "py": 0.1, "pz": -0.099}
    assert event == Event(Kind.MOTION_AT_WALL, 0, {**values, **place})


def test_a_wall_that_is_gone_in_that_moment_is_not_told() -> None:
    assert Containment((FLOOR,), {}).reached(stopped_at([0.0, 0.0, 0.0]), "post", SETTINGS.walls) == []
    assert Containment((), {}).reached(stopped_at([0.0, 0.0, 0.0]), "floor", SETTINGS.walls) == []


def test_a_tool_that_is_turned_in_the_flange_turns_what_moves_with_it() -> None:
    ahead = Area(name="ahead", part="elbow", reference="tcp", shape=Box(size=(0.2, 0.2, 2.0)), keep_out=True)
    containment = Containment((ahead,), {})
    value = estimate(tcp=[0.0] * 6, elbow=[0.0, 0.5, 0.0, 0.0, 0.0, 0.0])
    (straight,) = containment.reached(value, "ahead", SETTINGS.walls)
    assert straight.values["distance"] == pytest.approx(-400.0)
    containment.R_FT = from_rpy(math.pi / 2, 0.0, 0.0)
    (turned,) = containment.reached(value, "ahead", SETTINGS.walls)
    assert turned.values["distance"] == pytest.approx(100.0)  # in the box, so far from its nearest side


CLOSE = Area(name="close", part="tcp", shape=HalfSpace(normal=(1.0, 0.0, 0.0)), position=(0.5, 0.0, 0.0), triggers_reduced=True)


def at(x: float) -> Estimate:
    """The tool is there along x of B."""
    value = estimate()
    value.tcp = np.array([x, 0.0, 0.0, 0.0, 0.0, 0.0])
    return value


def test_an_area_that_triggers_reduced_holds_nothing_and_tells_when_its_part_is_beyond() -> None:
    walls = Containment((CLOSE, FLOOR), {})
    space = walls.workspace(SETTINGS.walls)
    assert space is not None
    assert [area.name for area in space.areas] == ["floor"]
    places = (0.499, 0.501, 0.499, 0.491, 0.489, 0.499)
    assert [walls.beyond(at(x), SETTINGS.walls) for x in places] == ["", "close", "close", "close", "", ""]
    assert walls.beyond(at(math.nan), SETTINGS.walls) == "close"
    assert walls.beyond(at(0.6), apply(SETTINGS, {"walls.on": False}).walls) == ""
    walls.change((FLOOR,), "", 0)
    assert walls.beyond(at(0.6), SETTINGS.walls) == ""
    walls.change((replace(CLOSE, on=False),), "", 0)
    assert walls.beyond(at(0.6), SETTINGS.walls) == ""


def test_the_robot_is_reduced_beyond_it_and_as_long_as_either_asks_for_it() -> None:
    supervisor = Supervisor(SETTINGS, 6, borders=(CLOSE,))
    modes, told = [], []
    on, off = Inputs(commands=(Command.REDUCED_ON,)), Inputs(commands=(Command.REDUCED_OFF,))
    for tick, (x, inputs) in enumerate(
        [(0.4, NOTHING), (0.6, NOTHING), (0.6, on), (0.4, NOTHING), (0.6, NOTHING), (0.6, off), (0.4, NOTHING)]
    ):
        value = at(x)
        value.tick = tick
        decision = supervisor.step(value, inputs)
        modes.append(decision.safety)
        told += [(event.kind, event.values.get("cause")) for event in decision.events]
    normal, reduced = Safety.NORMAL, Safety.REDUCED
    assert modes == [normal, reduced, reduced, reduced, reduced, reduced, normal]
    assert told == [(Kind.REDUCED_ON, "area close"), (Kind.REDUCED_OFF, None)]
