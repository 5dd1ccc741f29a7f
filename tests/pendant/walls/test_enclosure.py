"""Walls at work (VW-1 to VW-10): distances in all frames, consequences, and a mass in a hand or under a wrong payload."""

import math
from collections.abc import Callable
from pathlib import Path

import msgspec
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from pendant.tick.modes import TICK
from pendant.tick.pose import HERE, ORIGIN, Pose, Quaternion, Vector, rotation
from pendant.walls.barrier import WRONG_WAY, Around, Barrier, Consequence, Reading, Stage, WatchedPart
from pendant.walls.definitions import AnyBorder, Area, Dependence, Measure, Policy, Start, Wall, problem
from pendant.walls.enclosure import Enclosure, worst
from pendant.walls.settings import Reaction
from pendant.walls.shapes import Box, HalfSpace, Shape, Sphere
from tests.pendant.tick.test_pose import matrix, quaternions, vectors

BALL = Sphere(radius=0.1)
FLOOR = HalfSpace(normal=(0.0, 0.0, -1.0))
PAYLOAD = (0.0, 0.0, -20.0)


def around(
    p: Vector = ORIGIN,
    v: Vector = ORIGIN,
    user: Vector = ORIGIN,
    payload: Vector = ORIGIN,
    references: dict[str, Pose] | None = None,
    **measures: float,
) -> Around:
    known = {Measure(name): value for name, value in measures.items()}
    return Around({"flange": WatchedPart(p, v)}, {"base": HERE, **(references or {})}, user, payload, known)


def entered(*borders: AnyBorder) -> Enclosure:
    enclosure = Enclosure(borders)
    enclosure.enter()
    return enclosure


def test_nothing_holds_before_and_after() -> None:
    enclosure = Enclosure((Wall(name="a", shape=BALL),))
    assert enclosure.step(around()) == ()
    enclosure.enter()
    assert enclosure.places() == (None,)
    assert len(enclosure.step(around())) == 1
    enclosure.leave()
    assert enclosure.step(around()) == ()


def test_activation_shapes_are_anchored_when_they_should_be() -> None:
    early = Wall(name="early", shape=BALL, anchored_at=Start.ACTIVATION)
    late = Wall(name="late", shape=BALL)
    area = Area(name="area", shape=FLOOR, position=(0.0, 0.0, -1.0))
    enclosure = Enclosure((late, early, area))
    enclosure.begin(Start.ACTIVATION)
    (first,) = enclosure.step(around((0.0, 0.0, 0.0)))
    assert (first.border.name, first.distance) == ("early", pytest.approx(-0.03))
    enclosure.begin(Start.SEQUENCE)
    readings = {r.border.name: r.distance for r in enclosure.step(around((0.01, 0.0, 0.0)))}
    assert readings == {"early": pytest.approx(-0.02), "late": pytest.approx(-0.03), "area": pytest.approx(-1.0)}
    # the next attempt begins afresh
    enclosure.begin(Start.ACTIVATION)
    assert [r.border.name for r in enclosure.step(around())] == ["early"]
    enclosure.enter()
    assert [r.border.name for r in enclosure.step(around())] == ["late", "early", "area"]


def test_exceeding_in_activation_refuses_and_no_force_hides_it() -> None:
    for reaction in Reaction:
        barrier = Barrier(Wall(name="a", shape=BALL, reaction=reaction), Stage.ACTIVATION)
        assert barrier.step(around()).consequence is Consequence.NONE
        near = barrier.step(around((0.0, 0.0, -0.029), (0.0, 0.0, -0.1), (0.0, 0.0, -20.0)))
        assert (near.consequence, near.force, near.exceeded) == (Consequence.NONE, ORIGIN, False)
        out = barrier.step(around((0.0, 0.0, -0.031), (0.0, 0.0, -0.1), (0.0, 0.0, -20.0)))
        assert (out.consequence, out.force, out.exceeded) == (Consequence.REFUSE, ORIGIN, True)


@given(quaternions, vectors, quaternions, vectors, vectors, st.floats(0.3, 2.0))
@settings(max_examples=150, deadline=None)
def test_distance_and_direction_in_any_frame(
    turn: Quaternion, place: Vector, q: Quaternion, position: Vector, point: Vector, factor: float
) -> None:
    unit: Quaternion = tuple((np.array(q) / np.linalg.norm(q)).tolist())
    shape = Box(size=(0.4, 0.6, 0.8))
    size = Dependence(measure=Measure.REACH, low=0.0, high=1.0, at_low=factor, at_high=factor)
    frame = Pose(place, rotation(turn))
    for keep_out in (False, True):
        area = Area(name="a", shape=shape, reference="cart", position=position, orientation=unit, keep_out=keep_out, size=size)
        enclosure = entered(area)
        (reading,) = enclosure.step(around(point, references={"cart": frame}, reach=0.5))
        R, Q = matrix(turn), matrix(q)
        local = Q.T @ (R.T @ (np.array(point) - place) - position) / factor
        distance, *gradient = shape.field()(*local.tolist())
        sign = -1.0 if keep_out else 1.0
        assert reading.distance == pytest.approx(sign * factor * distance, abs=1e-9)
        assert reading.outward == pytest.approx(tuple(sign * R @ Q @ gradient), abs=1e-6)
        (drawn,) = enclosure.places()
        assert drawn is not None
        assert drawn.factor == pytest.approx(factor)
        assert np.allclose(drawn.pose.p, R @ position + place, atol=1e-9)
        assert np.allclose(np.reshape(drawn.pose.R, (3, 3)), R @ Q, atol=1e-9)


def test_the_offset_of_a_wall_grows_with_it() -> None:
    wall = Wall(name="a", shape=BALL, offset=(0.0, 0.0, 0.05), activation_size=0.5)
    (reading,) = entered(wall).step(around((1.0, 2.0, 3.0)))
    assert (reading.distance, reading.outward) == (pytest.approx(-0.05), (0.0, 0.0, -1.0))
    enclosure = Enclosure((wall,))
    enclosure.begin(Start.SEQUENCE)
    (reading,) = enclosure.step(around((1.0, 2.0, 3.0)))
    assert reading.distance == pytest.approx(-0.025)
    (place,) = enclosure.places()
    assert place is not None
    assert place.pose.p == pytest.approx((1.0, 2.0, 3.025))


def test_a_wall_is_drawn_where_its_offset_has_put_it() -> None:
    """VW-2: with half of its size, half of its offset."""
    enclosure = Enclosure((Wall(name="a", shape=BALL, offset=(0.02, -0.03, 0.05), activation_size=0.5),))
    enclosure.begin(Start.SEQUENCE)
    enclosure.step(around((1.0, 2.0, 3.0)))
    (place,) = enclosure.places()
    assert place is not None
    assert place.pose.p == pytest.approx((1.01, 1.985, 3.025))


def test_the_size_follows_the_posture() -> None:
    size = Dependence(measure=Measure.REACH, low=0.2, high=0.8, at_low=1.0, at_high=0.5)
    enclosure = entered(Wall(name="a", shape=BALL, size=size))
    for reach, radius in ((0.2, 0.1), (0.5, 0.075), (0.8, 0.05)):
        assert enclosure.step(around(reach=reach))[0].distance == pytest.approx(-radius)


def test_a_wall_moves_with_its_reference() -> None:
    enclosure = entered(Wall(name="a", shape=BALL, reference="cart", policy=Policy.FIXED))
    for k in range(5):
        p = (0.0, 0.05 * k, 0.0)
        (reading,) = enclosure.step(around(p, references={"cart": Pose(p)}))
        assert reading.distance == pytest.approx(-0.1)


@pytest.mark.parametrize(
    ("spoilt", "reaction", "expected"),
    [
        ("part", Reaction.STAY, Consequence.LEAVE),
        ("reference", Reaction.LEAVE, Consequence.LEAVE),
        ("reference", Reaction.STOP, Consequence.STOP),
        ("position", Reaction.STAY, Consequence.LEAVE),
        ("speed", Reaction.STOP, Consequence.STOP),
        ("pose", Reaction.STAY, Consequence.LEAVE),
    ],
)
def test_what_is_not_known_never_passes(spoilt: str, reaction: Reaction, expected: Consequence) -> None:
    good = around()
    bad = {
        "part": msgspec.structs.replace(good, parts={}),
        "reference": msgspec.structs.replace(good, references={}),
        "position": around((math.nan, 0.0, 0.0)),
        "speed": around(v=(0.0, math.inf, 0.0)),
        "pose": around(references={"base": Pose((0.0, 0.0, math.nan))}),
    }[spoilt]
    wall = Wall(name="a", shape=BALL, reaction=reaction)
    for stage, consequence in ((Stage.ACTIVATION, Consequence.REFUSE), (Stage.OPERATION, expected)):
        for first in (good, bad):
            barrier = Barrier(wall, stage)
            barrier.step(first)
            reading = barrier.step(bad)
            assert (reading.consequence, reading.exceeded, reading.force) == (consequence, True, ORIGIN)
            assert math.isinf(reading.distance)
            assert (reading.near, reading.anchored) == (1.0, False)
            assert barrier.step(good).consequence is Consequence.NONE


@pytest.mark.parametrize(("reaction", "expected"), [(Reaction.LEAVE, Consequence.LEAVE), (Reaction.STOP, Consequence.STOP)])
def test_leaving_when_exceeded(reaction: Reaction, expected: Consequence) -> None:
    barrier = Barrier(Wall(name="a", shape=BALL, reaction=reaction), Stage.OPERATION)
    barrier.step(around())
    assert barrier.step(around((0.0999, 0.0, 0.0))).consequence is Consequence.NONE
    assert barrier.step(around((0.1001, 0.0, 0.0))).consequence is expected


def test_a_caught_part_stays_until_pushed_back_and_again_when_let_go() -> None:
    barrier = Barrier(Wall(name="a", shape=BALL, reaction=Reaction.STAY), Stage.OPERATION)
    out = (0.11, 0.0, 0.0)
    barrier.step(around())
    forces = [0.0, 30.0, -7.9, -8.0, -5.0, -4.1, -4.0, -3.9, -7.9, -8.1]
    hold, none = Consequence.HOLD, Consequence.NONE
    expected = [hold, hold, hold, none, none, none, none, hold, hold, none]
    assert [barrier.step(around(out, user=(force, 50.0, 0.0))).consequence for force in forces] == expected
    assert barrier.step(around((0.09, 0.0, 0.0))).consequence is none
    # coming out again while pushed back is no reason to hold
    assert barrier.step(around(out, user=(-5.0, 0.0, 0.0))).consequence is none


@pytest.mark.parametrize("inside", [0.01, 0.5])
def test_a_part_that_starts_outside_is_neither_trapped_nor_kicked(inside: float) -> None:
    for reaction in Reaction:
        barrier = Barrier(Area(name="a", shape=FLOOR, reaction=reaction), Stage.OPERATION)
        for z in (-0.1, -0.1, -0.08, -0.08):  # at rest, and on its way back
            reading = barrier.step(around((0.0, 0.0, z), (0.0, 0.0, 0.1)))
            assert (reading.exceeded, reading.consequence, reading.force) == (True, Consequence.NONE, ORIGIN)
        # further out: resisted, then caught
        reading = barrier.step(around((0.0, 0.0, -0.08 - 0.9 * WRONG_WAY)))
        assert reading.consequence is Consequence.NONE
        assert reading.force == pytest.approx((0.0, 0.0, 4000.0 * 0.9 * WRONG_WAY))
        reading = barrier.step(around((0.0, 0.0, -0.08 - 1.1 * WRONG_WAY)))
        assert reading.consequence is {"stay": Consequence.HOLD, "leave": Consequence.LEAVE, "stop": Consequence.STOP}[reaction]
        # in, and out again: now as any other
        assert barrier.step(around((0.0, 0.0, inside))).consequence is Consequence.NONE
        assert barrier.step(around((0.0, 0.0, -0.001))).consequence is not Consequence.NONE


def test_free_drive_can_be_entered_outside_an_area_but_not_while_going_further_out() -> None:
    barrier = Barrier(Area(name="a", shape=FLOOR), Stage.ACTIVATION)
    for z in (-0.1, -0.104, -0.09):
        assert barrier.step(around((0.0, 0.0, z))).consequence is Consequence.NONE
    assert barrier.step(around((0.0, 0.0, -0.096))).consequence is Consequence.REFUSE
    for z in (-WRONG_WAY, -2.0 * WRONG_WAY):
        assert barrier.step(around((0.0, 0.0, z))).consequence is Consequence.NONE
    assert barrier.step(around((0.0, 0.0, -2.001 * WRONG_WAY))).consequence is Consequence.REFUSE


def test_a_volume_that_moves_over_a_part_at_rest_does_not_push_it() -> None:
    area = Area(name="a", shape=BALL, reference="cart", keep_out=True, reaction=Reaction.LEAVE)
    barrier, consequences = Barrier(area, Stage.OPERATION), []
    for k in range(400):
        x = 0.2 - 0.001 * k
        reading = barrier.step(around(references={"cart": Pose((x, 0.0, 0.0))}))
        assert reading.distance == pytest.approx(0.1 - abs(x))
        assert reading.force == pytest.approx(ORIGIN, abs=1e-9)
        consequences.append(reading.consequence)
    assert consequences[0] is Consequence.NONE
    assert consequences[150] is Consequence.LEAVE


@given(st.floats(-0.12, 0.12), st.floats(-0.12, 0.12), vectors, vectors)
def test_forces_are_bounded_and_never_pull_outwards(x: float, y: float, v: Vector, user: Vector) -> None:
    wall = Wall(name="a", shape=BALL, force=40.0, policy=Policy.FIXED)
    barrier = Barrier(wall, Stage.OPERATION)
    barrier.step(around())
    push: Vector = (50.0 * user[0], 50.0 * user[1], 50.0 * user[2])
    reading = barrier.step(around((x, y, 0.0), v, push))
    size = -float(np.dot(reading.force, reading.outward))
    assert 0.0 <= size <= 40.0 + 1e-9
    assert np.allclose(reading.force, -size * np.array(reading.outward))
    if reading.distance <= 0.0:
        towards = max(float(np.dot(push, reading.outward)), 0.0)
        speed = max(float(np.dot(v, reading.outward)), 0.0)
        assert size <= towards + wall.damping * speed + 1e-9
        assert float(np.dot(reading.force, v)) <= 0.0


def test_the_gravest_counts_and_among_equals_the_one_furthest_out() -> None:
    walls = [Wall(name=str(r), shape=Sphere(radius=r), reaction=a, band=0.01) for r, a in
             ((0.03, Reaction.STAY), (0.08, Reaction.LEAVE), (0.07, Reaction.LEAVE), (0.2, Reaction.STOP))]  # fmt: skip
    enclosure = entered(*walls)
    assert worst(enclosure.step(around())) is None
    for x, name in ((0.05, "0.03"), (0.075, "0.07"), (0.09, "0.07"), (0.21, "0.2")):
        found = worst(enclosure.step(around((x, 0.0, 0.0))))
        assert found is not None
        assert found.border.name == name
    found = worst(entered(*[Area(name=name, reference="gone", shape=BALL) for name in "ab"]).step(around()))
    assert found is not None
    assert found.border.name == "a", "of two that cannot be told"


# A mass of 3 kg under the walls, a steady force of a wrong payload and a hand; stiction as an arm has it.

Hand = Callable[[int, float], float]  # tick and height -> force up [N]


class Drop:
    """What became of the mass: its height and readings tick by tick; it moves up and down only."""

    def __init__(self, border: AnyBorder, payload: float, hand: Hand, ticks: int, friction: float = 5.0) -> None:
        enclosure = entered(border)
        z = v = 0.0
        self.heights: list[float] = []
        self.readings: list[Reading] = []
        force, held = 0.0, False
        for k in range(ticks):
            user = hand(k, z)
            if held:
                v = 0.0  # the posture is kept
            for _ in range(5):
                step = TICK / 5
                pull = user + payload + force
                if held or (v == 0.0 and abs(pull) <= friction):
                    continue
                drive = pull - math.copysign(friction, v if v != 0.0 else pull)
                new = v + step * drive / 3.0
                v = 0.0 if v * new < 0.0 else new
                z += step * v
            where = around((0.0, 0.0, z), (0.0, 0.0, v), (0.0, 0.0, user), (0.0, 0.0, payload))
            (reading,) = enclosure.step(where)
            self.heights.append(z)
            self.readings.append(reading)
            force, held = reading.force[2], reading.consequence is Consequence.HOLD

    @property
    def anchorings(self) -> int:
        return sum(reading.anchored for reading in self.readings)


def nobody(_tick: int, _z: float) -> float:
    return 0.0


def tether(policy: Policy, **values: object) -> Wall:
    return Wall(name="tether", shape=BALL, policy=policy, reaction=Reaction.STAY, **values)  # type: ignore[arg-type]


@pytest.mark.parametrize("policy", Policy)
@pytest.mark.parametrize("payload", [-6.0, -20.0, -50.0])
def test_a_fallen_or_too_heavy_payload_stays_caught(policy: Policy, payload: float) -> None:
    drop = Drop(tether(policy), payload, nobody, 10000)
    assert drop.anchorings == 0
    assert -0.105 < min(drop.heights) < -0.09
    assert abs(drop.heights[-1] - drop.heights[-2000]) < 0.01


@pytest.mark.parametrize("policy", Policy)
def test_a_load_lying_against_the_wall_is_held_by_it_even_without_a_hold(policy: Policy) -> None:
    # pushed back a little, but not enough: the wall's spring alone carries 12 N of a load of 20 N
    drop = Drop(tether(policy), -20.0, lambda tick, z: 8.1 if tick > 1000 else 0.0, 4000, friction=0.0)
    assert drop.readings[-1].consequence is Consequence.NONE
    assert drop.heights[-1] == pytest.approx(-0.1 - 11.9 / 4000.0, abs=1e-4)


def test_by_the_letter_of_the_source_a_slowly_sinking_load_takes_its_wall_along() -> None:
    sinking = {"payload": -5.1, "hand": nobody, "ticks": 3000}
    assert Drop(tether(Policy.STEPWISE), **sinking).anchorings == 0
    literal = Drop(tether(Policy.STEPWISE, literal=True), **sinking)
    assert literal.anchorings >= 1
    assert min(literal.heights) < -0.12
    literal = Drop(tether(Policy.AVERAGE, literal=True), **sinking)
    assert literal.anchorings > 100


class Stepper:
    """A hand that pushes down to the wall, lifts, and pushes down again."""

    def __init__(self, down: float, up: float, lift: float) -> None:
        self.down, self.up, self.lift = down, up, lift
        self.rising = False
        self.low = 0.0
        self.still = 0
        self.last = 0.0

    def __call__(self, tick: int, z: float) -> float:
        self.still = self.still + 1 if abs(z - self.last) < 1e-5 else 0
        self.last = z
        if not self.rising and self.still > 25:
            self.rising, self.low, self.still = True, z, 0
        elif self.rising and z > self.low + self.lift:
            self.rising, self.still = False, 0
        return self.up if self.rising else self.down


@pytest.mark.parametrize("payload", [0.0, -20.0])
def test_a_user_walks_the_tool_down_in_steps(payload: float) -> None:
    shape = HalfSpace(normal=(0.0, 0.0, -1.0), distance=0.1)
    floor = Wall(name="tether", shape=shape, policy=Policy.USER, reaction=Reaction.STAY)
    stepper = Stepper(-20.0, 35.0, 0.03)
    drop = Drop(floor, payload, lambda tick, z: stepper(tick, z) if tick < 6000 else 0.0, 9000)
    assert drop.anchorings >= 4
    assert min(drop.heights) < -0.25
    # between two anchorings never more than a size below the anchor
    low, anchor = 0.0, 0.0
    for z, reading in zip(drop.heights, drop.readings, strict=True):
        anchor = z if reading.anchored else anchor
        low = min(low, z - anchor)
    assert -0.11 < low < -0.09
    # and when the hand leaves, it is caught
    assert drop.heights[-1] == pytest.approx(drop.heights[-500], abs=1e-4)


def test_without_lifting_it_goes_no_lower_than_the_wall() -> None:
    shape = HalfSpace(normal=(0.0, 0.0, -1.0), distance=0.1)
    floor = Wall(name="tether", shape=shape, policy=Policy.USER, reaction=Reaction.STAY)
    drop = Drop(floor, 0.0, lambda tick, z: -20.0, 4000)
    assert drop.anchorings == 0
    assert -0.105 < min(drop.heights) < -0.09


def test_a_slow_guide_takes_a_stepwise_and_an_average_wall_along() -> None:
    def guide(tick: int, z: float) -> float:
        return 400.0 * (0.02 * tick * TICK - z)  # a hand that rises at 20 mm/s

    for policy in (Policy.STEPWISE, Policy.AVERAGE):
        drop = Drop(tether(policy), 0.0, guide, 5000, friction=10.0)
        assert drop.heights[-1] > 0.15
        assert drop.anchorings >= 5
        assert not any(reading.exceeded for reading in drop.readings)


def test_a_safety_period_that_depends_on_the_posture() -> None:
    rule = Dependence(measure=Measure.REACH, low=0.2, high=0.8, at_low=1.0, at_high=0.5)
    for redefine, reach, expected in ((None, 0.2, 50), (None, 0.8, 25), (0.2, 0.8, 100)):
        wall = Wall(name="a", shape=BALL, safety_period=0.1, safety_dependence=rule, redefine_period=redefine)
        enclosure = entered(wall)
        anchored = [enclosure.step(around(user=(10.0, 0.0, 0.0), reach=reach))[0].anchored for _ in range(101)]
        assert anchored.index(True) + 1 == expected


@given(st.lists(st.tuples(vectors, vectors, vectors), min_size=2, max_size=30), st.sampled_from(list(Policy)))
@settings(max_examples=100, deadline=None)
def test_any_stream_gives_finite_readings_and_the_same_again(stream: list[tuple[Vector, Vector, Vector]], policy: Policy) -> None:
    shapes: list[Shape] = [BALL, Box(size=(0.2, 0.3, 0.4))]
    walls = [Wall(name=str(k), shape=shape, policy=policy, safety_period=0.1) for k, shape in enumerate(shapes)]  # type: ignore[arg-type]
    runs = []
    for _ in range(2):
        enclosure = entered(*walls)
        runs.append([enclosure.step(around(p, v, user, PAYLOAD)) for p, v, user in stream])
    assert runs[0] == runs[1]
    for readings in runs[0]:
        for reading in readings:
            assert all(map(math.isfinite, (reading.distance, *reading.outward, *reading.force)))
            assert reading.exceeded == (reading.distance > 0.0)


def test_the_walls_of_the_page_are_accepted() -> None:
    page = (Path(__file__).parents[3] / "docs" / "guide" / "walls.md").read_text(encoding="utf-8")
    text = page.split("```json")[1].split("```")[0]
    borders = msgspec.json.decode(text, type=tuple[AnyBorder, ...])
    assert len(borders) == 5
    assert problem(borders, frozenset({"flange"}), frozenset({"base", "world", "cart"})) is None
    references = {"world": Pose((0.0, 0.0, -0.5)), "cart": Pose((2.0, 0.0, 0.5))}
    readings = entered(*borders).step(around((0.4, 0.0, 0.5), references=references, reach=0.8))
    assert [round(reading.distance, 6) for reading in readings] == [-0.1, -0.1, -0.98, -1.3, -0.1]
