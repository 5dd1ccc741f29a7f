"""One wall or area alone: what a tick of it says, in every axis and on the border itself (VW-1 to VW-10)."""

import msgspec
import pytest

from pendant.tick.pose import ORIGIN, Pose, Quaternion, Vector
from pendant.walls.barrier import Barrier, Consequence, Reading, Stage
from pendant.walls.definitions import Area, Policy, Wall
from pendant.walls.settings import Reaction
from pendant.walls.shapes import Box, HalfSpace, Sphere
from tests.pendant.walls.test_enclosure import around

BALL = Sphere(radius=0.1)
FLOOR = HalfSpace(normal=(0.0, 0.0, -1.0))
AXES: tuple[Vector, ...] = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
QUARTER: Quaternion = (0.5**0.5, 0.0, 0.0, 0.5**0.5)
"""About z: x of the shape is y of the base."""


def scaled(axis: Vector, size: float) -> Vector:
    x, y, z = axis
    return size * x, size * y, size * z


def anew(wall: Wall, stage: Stage, count: int, user: Vector = ORIGIN, payload: Vector = ORIGIN) -> list[int]:
    """The ticks, from 1, in which a wall round a part at rest is anchored again."""
    barrier, seen = Barrier(wall, stage), around((1.0, 2.0, 3.0), user=user, payload=payload)
    return [tick for tick in range(1, count + 1) if barrier.step(seen).anchored]


@pytest.mark.parametrize("stage", Stage)
@pytest.mark.parametrize("reaction", Reaction)
def test_a_part_on_the_border_is_not_beyond_it(stage: Stage, reaction: Reaction) -> None:
    """VW-6."""
    area = Area(name="a", shape=FLOOR, reaction=reaction)
    on = Barrier(area, stage).step(around())
    assert on == Reading(area, 0.0, (0.0, 0.0, -1.0), 1.0, False, Consequence.NONE, ORIGIN, False, ORIGIN)


@pytest.mark.parametrize("axis", AXES)
def test_the_band_resists_motion_towards_the_border_in_every_axis(axis: Vector) -> None:
    """VW-7: in the middle of the band with half of the damping, 0.5 * 200 N·s/m * 0.1 m/s."""
    area = Area(name="a", shape=HalfSpace(normal=axis), band=0.02)
    for speed, force in ((0.1, -10.0), (-0.1, 0.0)):
        reading = Barrier(area, Stage.OPERATION).step(around(scaled(axis, -0.01), scaled(axis, speed)))
        assert reading.force == pytest.approx(scaled(axis, force))


@pytest.mark.parametrize(
    ("orientation", "distance", "outward"),
    [((1.0, 0.0, 0.0, 0.0), -0.07, (0.0, 1.0, 0.0)), (QUARTER, -0.05, (1.0, 0.0, 0.0))],
)
def test_a_shape_that_is_turned_is_turned_with_the_way_out_of_it(
    orientation: Quaternion, distance: float, outward: Vector
) -> None:
    """VW-2: 0.2 m along x and 0.1 m along y, and the other way round."""
    area = Area(name="a", shape=Box(size=(0.4, 0.2, 2.0)), orientation=orientation)
    reading = Barrier(area, Stage.OPERATION).step(around((0.05, 0.03, 0.0)))
    assert reading.distance == pytest.approx(distance)
    assert reading.outward == pytest.approx(outward)


@pytest.mark.parametrize("axis", AXES)
def test_a_wall_lies_where_offset_and_size_put_it_in_every_axis(axis: Vector) -> None:
    """VW-2: twice its size, twice its offset; its border is 0.2 m from its centre, which is 0.04 m from the part."""
    wall = Wall(name="w", shape=BALL, offset=scaled(axis, 0.02), operation_size=2.0)
    barrier = Barrier(wall, Stage.OPERATION)
    start = barrier.step(around((1.0, 2.0, 3.0)))
    assert (start.distance, start.outward) == (pytest.approx(-0.16), pytest.approx(scaled(axis, -1.0)))
    x, y, z = scaled(axis, 0.16)
    later = barrier.step(around((1.0 + x, 2.0 + y, 3.0 + z)))
    assert (later.distance, later.outward) == (pytest.approx(-0.08), pytest.approx(axis))


@pytest.mark.parametrize("axis", AXES)
def test_a_part_at_rest_under_a_wrong_payload_has_not_moved(axis: Vector) -> None:
    """VW-3, wherever it is."""
    wall = Wall(name="w", shape=BALL, policy=Policy.STEPWISE, safety_period=0.1)
    for size in (20.0, -20.0):
        assert anew(wall, Stage.OPERATION, 120, payload=scaled(axis, size)) == []
    assert anew(wall, Stage.OPERATION, 120, user=scaled(axis, 8.0)) == [50, 100]


def test_the_activation_shape_stays_where_it_was_anchored() -> None:
    """VW-6: even one that is anchored again by the letter, whoever moves the part."""
    for policy in (Policy.STEPWISE, Policy.AVERAGE):
        wall = Wall(name="w", shape=BALL, policy=policy, literal=True, safety_period=0.1)
        assert anew(wall, Stage.ACTIVATION, 60, user=(8.0, 0.0, 0.0)) == []
        assert anew(wall, Stage.OPERATION, 60, user=(8.0, 0.0, 0.0)) != []


@pytest.mark.parametrize(("redefine", "expected"), [(None, [50, 100]), (0.1, [50, 100]), (0.2, [100]), (0.12, [60, 120])])
def test_a_wall_is_anchored_anew_as_often_as_its_redefine_period_says(redefine: float | None, expected: list[int]) -> None:
    """VW-3."""
    wall = Wall(name="w", shape=BALL, policy=Policy.STEPWISE, safety_period=0.1, redefine_period=redefine)
    assert anew(wall, Stage.OPERATION, 120, user=(8.0, 0.0, 0.0)) == expected


@pytest.mark.parametrize(("tick", "height", "moves"), [(50, 0.05, True), (50, 0.09, False), (20, 0.09, True), (20, 0.101, False)])
def test_a_part_in_the_band_or_lately_outside_takes_no_wall_along(tick: int, height: float, moves: bool) -> None:
    """VW-3: at the end of 50 ticks, of which the part is at another height in one."""
    wall = Wall(name="w", shape=BALL, policy=Policy.STEPWISE, safety_period=0.1)
    barrier = Barrier(wall, Stage.OPERATION)
    readings = [barrier.step(around((0.0, 0.0, height if now == tick else 0.0), user=(8.0, 0.0, 0.0))) for now in range(1, 51)]
    assert readings[-1].anchored is moves
    assert not any(reading.anchored for reading in readings[:-1])


def test_a_volume_at_rest_pushes_out_what_goes_round_in_it() -> None:
    """VW-10: 0.02 m inside of it the spring has 4000 N/m * 0.02 m, wherever the part came in."""
    barrier = Barrier(Area(name="a", shape=BALL, keep_out=True), Stage.OPERATION)
    for place, force in (((0.2, 0.0, 0.0), 0.0), ((0.08, 0.0, 0.0), 80.0)):
        assert barrier.step(around(place)).force == pytest.approx((force, 0.0, 0.0))
    assert barrier.step(around((0.0, 0.08, 0.0))).force == pytest.approx((0.0, 80.0, 0.0))


def test_of_a_volume_and_a_part_that_both_move_only_the_parts_way_is_resisted() -> None:
    """VW-10: the part is 0.01 m out, goes out 0.01 m more, and the volume comes 0.02 m over it."""
    barrier = Barrier(Area(name="a", shape=FLOOR, reference="cart"), Stage.OPERATION)
    for height, cart, distance, force in ((0.1, 0.0, -0.1, 0.0), (-0.01, 0.0, 0.01, 40.0), (-0.02, 0.02, 0.04, 80.0)):
        reading = barrier.step(around((0.0, 0.0, height), references={"cart": Pose((0.0, 0.0, cart))}))
        assert reading.distance == pytest.approx(distance)
        assert reading.force == pytest.approx((0.0, 0.0, force))


@pytest.mark.parametrize("led", [False, True])
def test_who_pays_for_the_motion_takes_a_wall_along_without_any_force_at_the_flange(led: bool) -> None:
    """VW-3: a hand on a link."""
    wall = Wall(name="w", shape=BALL, policy=Policy.STEPWISE, safety_period=0.1)
    barrier, seen = Barrier(wall, Stage.OPERATION), msgspec.structs.replace(around(), led=led)
    assert [tick for tick in range(1, 121) if barrier.step(seen).anchored] == ([50, 100] if led else [])


@pytest.mark.parametrize("axis", AXES)
@pytest.mark.parametrize(
    ("depth", "force"), [(0.021, 0.0), (0.02, 0.0), (0.015, 10.0), (0.01, 20.0), (0.0, 40.0), (-0.005, 60.0), (-0.1, 150.0)]
)
def test_a_wall_that_pushes_pushes_a_part_at_rest_the_harder_the_nearer(axis: Vector, depth: float, force: float) -> None:
    """VW-7: 40 N at the border, none where the band of 20 mm begins; beyond it 4000 N/m more, at most 150 N."""
    area = Area(name="a", shape=HalfSpace(normal=axis), band=0.02, push=40.0)
    barrier = Barrier(area, Stage.OPERATION)
    barrier.step(around(scaled(axis, -0.1)))
    assert barrier.step(around(scaled(axis, -depth))).force == pytest.approx(scaled(axis, -force))
    checked = Barrier(area, Stage.ACTIVATION)
    checked.step(around(scaled(axis, -0.1)))
    assert checked.step(around(scaled(axis, -depth))).force == ORIGIN


def test_a_push_adds_to_the_resistance_and_is_part_of_the_most() -> None:
    """VW-7: half-way 20 N, and 0.5 * 200 N·s/m at 0.1 m/s; at most `force`."""
    for most, force in ((150.0, 30.0), (25.0, 25.0)):
        area = Area(name="a", shape=HalfSpace(normal=(1.0, 0.0, 0.0)), band=0.02, push=40.0, force=most)
        barrier = Barrier(area, Stage.OPERATION)
        barrier.step(around((-0.1, 0.0, 0.0)))
        assert barrier.step(around((-0.01, 0.0, 0.0), (0.1, 0.0, 0.0))).force == pytest.approx((-force, 0.0, 0.0))


def test_a_part_that_begins_outside_is_not_pushed() -> None:
    """VW-10: neither there nor where it has come in."""
    area = Area(name="a", shape=HalfSpace(normal=(1.0, 0.0, 0.0)), band=0.02, push=40.0)
    barrier = Barrier(area, Stage.OPERATION)
    assert barrier.step(around((0.05, 0.0, 0.0))).force == pytest.approx(ORIGIN)
    assert barrier.step(around((0.04, 0.0, 0.0))).force == pytest.approx(ORIGIN)
