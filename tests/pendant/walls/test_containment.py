"""Walls in the running robot: the tether and others, from the activation period to leaving (VW-2, VW-6, VW-8, VW-9, FD-24)."""

import math
from typing import Any

import msgspec
import numpy as np
import pytest

from pendant.all_settings import Settings, apply
from pendant.decision import Decision
from pendant.events.event import Event, Kind
from pendant.inputs import NOTHING, Button, Command, Inputs
from pendant.settings.bounds import MOST_WALLS
from pendant.supervisor import Supervisor
from pendant.tick.estimate import GRAVITY, Estimate
from pendant.tick.modes import Law, Mode, Phase
from pendant.tick.pose import HERE, Pose, from_rpy, turned
from pendant.tick.state import state_of
from pendant.walls.barrier import Place
from pendant.walls.containment import NOBODY, Containment, WallState, _measures, facts, tether
from pendant.walls.definitions import AnyBorder, Area, Dependence, Measure, Policy, Start, Wall, problem
from pendant.walls.settings import Reaction, WallSettings
from pendant.walls.shapes import Box, HalfSpace, Sphere
from tests.pendant.estimates import estimate
from tests.pendant.telling import whole

HOLD = Inputs(held=frozenset({Button.FREE_DRIVE}))
LET_GO = Inputs(released=frozenset({Button.FREE_DRIVE}))
FLOOR = Area(name="floor", shape=HalfSpace(normal=(0.0, 0.0, -1.0)), position=(0.0, 0.0, -0.1))
LOOSE = {"limits.activation.flange_displacement.on": False, "unexplained.motion": False}
"""An arm that a test puts elsewhere is not moved by anybody."""


def out(distance: float, way: str, place: tuple[float, float, float]) -> dict[str, Any]:
    """What an event says of a flange at a place beyond the tether, which lies round the origin."""
    size = math.hypot(*place)
    back = [-value / size if size else 0.0 for value in place]
    vectors = zip(("x", "y", "z", "px", "py", "pz"), (*back, *place), strict=True)
    of = {"wall": "tether", "part": "flange", "distance": pytest.approx(distance), "way": way}
    return of | {name: pytest.approx(value, abs=1e-9) for name, value in vectors}


class Bench:
    """A supervisor with borders, stepped by hand."""

    def __init__(self, *borders: AnyBorder, frames: dict[str, Pose] | None = None, **changes: float | bool) -> None:
        names = {name.replace("__", "."): value for name, value in changes.items()} | LOOSE
        self.supervisor = Supervisor(apply(Settings(), names), 6, borders=borders, frames=frames)
        self.tick = -1
        self.events: list[Event] = []

    def step(self, inputs: Inputs = NOTHING, value: Estimate | None = None) -> Decision:
        self.tick += 1
        value = value or estimate()
        value.tick = self.tick
        decision = self.supervisor.step(value, inputs)
        self.events += whole(decision.events, self.tick)
        return decision

    def run(self, count: int, inputs: Inputs = NOTHING, value: Estimate | None = None) -> Decision:
        for _ in range(count - 1):
            self.step(inputs, value)
        return self.step(inputs, value)

    def trying(self, value: Estimate | None = None) -> "Bench":
        """In the sequence."""
        self.run(60, NOTHING, value)
        assert self.run(501, HOLD, value).phase is Phase.SEQUENCE
        return self

    def entered(self, value: Estimate | None = None) -> "Bench":
        self.trying(value)
        assert self.run(501, LET_GO, value).mode is Mode.FREE_DRIVE
        return self

    def kinds(self) -> list[Kind]:
        return [event.kind for event in self.events]


def at(x: float, y: float = 0.0, z: float = 0.0, **values: Any) -> Estimate:
    return estimate(position=[x, y, z], **values)


def test_the_tether_has_the_sizes_of_the_settings() -> None:
    wall = tether(
        WallSettings(operation_radius=0.05, activation_radius=0.01, band=0.2, push_back=6.0, averaging=0.1, safety_period=2.0)
    )
    assert wall.shape == Sphere(radius=0.05)
    assert wall.activation_size == pytest.approx(0.2)
    assert (wall.band, wall.push_back, wall.averaging_period, wall.safety_period) == (pytest.approx(0.04), 6.0, 0.1, 2.0)
    assert wall.policy is Policy.AVERAGE
    assert tether(WallSettings(operation_radius=1.0, activation_radius=0.001)).activation_size == 0.05
    for reaction in Reaction:
        assert tether(WallSettings(tether_reaction=reaction)).reaction is reaction
    assert problem((tether(WallSettings()),), frozenset({"flange"}), frozenset({"base"})) is None


def test_beyond_the_activation_shape_entry_is_refused_with_the_way_back() -> None:
    bench = Bench().trying()
    assert bench.step(LET_GO, at(0.0049)).phase is Phase.SEQUENCE
    decision = bench.step(NOTHING, at(0.0, 0.0, -0.0062))
    assert (decision.mode, decision.phase, decision.law) == (Mode.TEACH, Phase.OFF, Law.HOLD)
    assert bench.events[-1] == Event(Kind.REFUSED_WALL, bench.tick, out(1.2, "+z", (0.0, 0.0, -0.0062)))
    assert decision.walls == ()


def test_a_limit_comes_before_a_wall_and_a_protective_stop_says_the_wall() -> None:
    bench = Bench().trying()
    bench.step(LET_GO, at(0.02, speed=0.5))
    assert Kind.REFUSED_WALL not in bench.kinds()
    assert bench.kinds()[-1] is Kind.REFUSED_LIMIT
    bench = Bench(sequence__beyond_limit="protective_stop").trying()
    assert bench.step(LET_GO, at(0.01)).mode is Mode.STOP
    assert bench.events[-1].values == {
        "parameter": "wall tether", "part": "flange", "value": pytest.approx(0.005), "limit": 0.0, "unit": "m",
    }  # fmt: skip


def test_no_wall_resists_in_the_sequence() -> None:
    bench = Bench().trying()
    (wall,) = bench.step(LET_GO, at(0.004, speed=0.01)).walls
    assert (wall.name, wall.part, wall.p, wall.force) == ("tether", "flange", (0.004, 0.0, 0.0), (0.0, 0.0, 0.0))
    assert wall.distance == pytest.approx(-0.001)


def test_a_shape_anchored_with_the_activation_period_refuses_in_it() -> None:
    """VW-6, the option."""
    early = Wall(name="early", shape=Sphere(radius=0.05), activation_size=0.1, anchored_at=Start.ACTIVATION)
    bench = Bench(early)
    bench.run(60)
    bench.run(100, HOLD)
    assert bench.step(HOLD, at(0.006)).phase is Phase.OFF
    assert bench.events[-1].kind is Kind.REFUSED_WALL
    assert bench.events[-1].values["wall"] == "early"


def test_letting_go_early_forgets_the_walls() -> None:
    early = Wall(name="early", shape=Sphere(radius=0.05), activation_size=0.1, anchored_at=Start.ACTIVATION)
    bench = Bench(early)
    bench.run(60)
    bench.run(100, HOLD)
    bench.step(LET_GO)
    bench.run(110)
    assert bench.run(100, HOLD, at(1.0)).phase is Phase.ACTIVATION


def test_invalid_joints_in_the_activation_period_are_left_to_its_end() -> None:
    bench = Bench(Wall(name="early", shape=Sphere(radius=0.05), anchored_at=Start.ACTIVATION))
    bench.run(60)
    bench.run(10, HOLD)
    assert bench.step(HOLD, estimate(joints_valid=False)).phase is Phase.ACTIVATION


def test_the_arm_stops_at_the_wall_and_goes_free_when_pushed_back() -> None:
    bench = Bench().entered()
    decision = bench.step(NOTHING, at(0.028, speed=0.1))
    (wall,) = decision.walls
    assert decision.law is Law.FREE
    assert wall.force == (pytest.approx(-0.6 * 200.0 * 0.1), 0.0, 0.0)
    decision = bench.step(NOTHING, at(0.0305, speed=0.1))
    assert (decision.mode, decision.law) == (Mode.FREE_DRIVE, Law.HOLD)
    assert bench.events[-1] == Event(Kind.WALL_REACHED, bench.tick, out(0.5, "-x", (0.0305, 0.0, 0.0)))
    bench.run(20, NOTHING, at(0.0305))
    assert bench.kinds().count(Kind.WALL_REACHED) == 1
    assert bench.run(60, NOTHING, at(0.0305, force=20.0, felt=20.0)).law is Law.HOLD
    assert bench.run(60, NOTHING, at(0.0305, force=-20.0, felt=-20.0)).law is Law.FREE
    assert bench.run(150, NOTHING, at(0.0305)).law is Law.HOLD  # let go, still outside


def test_the_tether_follows_a_hand_and_no_payload() -> None:
    def walk(force: list[float]) -> Decision:
        bench = Bench().entered()
        bench.run(50, NOTHING, at(0.0, force=force))
        decision = bench.step()
        for k in range(1, 500):
            decision = bench.step(NOTHING, at(0.0, 0.0, -0.0002 * k, force=force))
            if decision.law is not Law.FREE:
                break
        return decision

    assert walk([10.0, 0.0, -15.0]).law is Law.FREE
    assert walk([0.0, 0.0, 0.0]).law is Law.HOLD


@pytest.mark.parametrize(
    ("changes", "kind", "mode"),
    [
        ({"walls__tether_reaction": "leave"}, Kind.LEFT_WALL, Mode.TEACH),
        ({"walls__tether_reaction": "stop"}, Kind.STOPPED_WALL, Mode.STOP),
    ],
)
def test_the_tether_leaves_or_stops_instead(changes: dict[str, bool], kind: Kind, mode: Mode) -> None:
    bench = Bench(**changes).entered()
    decision = bench.step(NOTHING, at(0.0, 0.04))
    assert (decision.mode, decision.phase) == (mode, Phase.OFF)
    assert decision.law is not Law.FREE
    assert bench.events[-1].kind is kind
    assert bench.events[-1].values == out(10.0, "-y", (0.0, 0.04, 0.0))


def test_walls_off_means_none() -> None:
    """FD-24; and the tether alone can be off, which leaves the others."""
    bench = Bench(FLOOR, walls__on=False).trying()
    assert bench.step(LET_GO, at(0.009)).walls == ()
    assert bench.run(500).mode is Mode.FREE_DRIVE
    assert bench.step(NOTHING, at(0.5)).law is Law.FREE
    bench = Bench(FLOOR, walls__tether=False).entered()
    assert [wall.name for wall in bench.step().walls] == ["floor"]
    assert bench.step(NOTHING, at(0.5)).law is Law.FREE
    assert bench.step(NOTHING, at(0.5, 0.0, -0.11)).law is Law.HOLD


def test_parts_and_references_are_where_the_estimate_says() -> None:
    """VW-2: a wall round the elbow that moves with the flange's frame, areas for the tcp in the world and at an object."""
    quarter = (0.0, -1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0)
    seen = at(0.1, tcp=[0.1, 0.2, 0.3, 0.0, 0.0, 0.0], elbow=[0.4, 0.0, 0.5, 0.0, 0.0, 0.0])
    borders = (
        Wall(name="elbow", part="elbow", reference="flange", shape=Box(size=(0.2, 0.2, 0.2)), activation_size=1.0),
        Area(name="world", part="tcp", reference="world", shape=HalfSpace(normal=(1.0, 0.0, 0.0)), position=(0.35, 0.0, 0.0)),
        Area(name="cart", part="tcp", reference="cart", shape=Sphere(radius=0.1)),
        Wall(name="tip", part="flange", reference="tcp", shape=Sphere(radius=0.1), activation_size=1.0),
    )
    frames = {"world": Pose((0.0, 0.0, 0.0), quarter), "cart": Pose((0.1, 0.2, 0.25))}
    containment = Containment(borders, frames)
    containment.begin(Start.ACTIVATION, WallSettings(tether=False))
    containment.begin(Start.SEQUENCE, WallSettings(tether=False))
    assert containment.step(seen, *NOBODY) is None
    found = {state.name: state for state in containment.states()}
    assert found["elbow"].distance == pytest.approx(-0.1)
    assert found["world"].distance == pytest.approx(0.2 - 0.35)  # x of the world is y of the base here
    assert found["world"].outward == pytest.approx((0.0, 1.0, 0.0))
    assert found["cart"].distance == pytest.approx(-0.05)
    assert found["cart"].p == (0.1, 0.2, 0.3)
    places = {border.name: place for border, place in containment.places()}
    assert quarter == places["world"].pose.R
    turned = at(0.1, tcp=[0.1, 0.2, 0.3, 0.0, 0.0, 0.0], elbow=[0.4, 0.0, 0.5, 0.0, 0.0, 0.0])
    turned.R_BF = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
    containment.step(turned, *NOBODY)
    # the box has turned about the flange with the frame that it lies in, and left the elbow behind: at (0.1, 0.3, 0.5) now
    found = {state.name: state for state in containment.states()}
    assert found["elbow"].distance == pytest.approx(math.hypot(0.3 - 0.1, 0.3 - 0.1))


def test_a_tool_that_is_turned_in_the_flange_turns_what_lies_in_its_frame() -> None:
    """VW-2: x of T is y of F."""
    area = Area(name="blade", part="elbow", reference="tcp", shape=HalfSpace(normal=(1.0, 0.0, 0.0)))
    containment = Containment((area,), {})
    containment.R_FT = from_rpy(0.0, 0.0, math.pi / 2.0)
    seen = at(0.1, tcp=[0.1, 0.2, 0.3, 0.0, 0.0, 0.0], elbow=[0.4, 0.05, 0.5, 0.0, 0.0, 0.0])
    containment.begin(Start.ACTIVATION, WallSettings(tether=False))
    containment.begin(Start.SEQUENCE, WallSettings(tether=False))
    containment.step(seen, *NOBODY)
    (state,) = containment.states()
    assert state.distance == pytest.approx(0.05 - 0.2)
    assert state.outward == pytest.approx((0.0, 1.0, 0.0))


@pytest.mark.parametrize(
    ("measure", "seen", "factor"),
    [
        (Measure.REACH, at(0.3, 0.0, 0.4), 0.5),
        (Measure.HEIGHT, at(0.0, 0.0, 0.25), 0.75),
        (Measure.PAYLOAD, at(0.0, load_mass=0.5), 0.5),
        (Measure.MANIPULABILITY, at(0.0), 0.5),  # not measured: the smallest
    ],
)
def test_a_size_follows_posture_and_payload(measure: Measure, seen: Estimate, factor: float) -> None:
    """VW-8."""
    wall = Wall(
        name="w", shape=Sphere(radius=0.2), activation_size=1.0,
        size=Dependence(measure=measure, low=0.0, high=0.5, at_low=1.0, at_high=0.5),
    )  # fmt: skip
    containment = Containment((wall,), {})
    containment.begin(Start.SEQUENCE, WallSettings(tether=False))
    containment.step(seen, *NOBODY)
    (state,) = containment.states()
    assert state.distance == pytest.approx(-0.2 * factor)


@pytest.mark.parametrize(("reach", "at_low", "at_high"), [(0.0, 1.0, 0.5), (0.5, 0.5, 1.0)])
def test_without_sizes_the_smallest_holds(reach: float, at_low: float, at_high: float) -> None:
    """VW-8; a constant wall keeps its size."""
    size = Dependence(measure=Measure.REACH, low=0.0, high=0.5, at_low=at_low, at_high=at_high)
    borders = (
        Wall(name="w", shape=Sphere(radius=0.2), activation_size=1.0, size=size),
        Wall(name="c", shape=Sphere(radius=0.2), activation_size=1.0),
    )
    for sizes, distance in ((True, -0.2), (False, -0.1)):
        containment = Containment(borders, {})
        containment.begin(Start.SEQUENCE, WallSettings(tether=False, sizes=sizes))
        containment.step(at(reach), *NOBODY)
        assert [state.distance for state in containment.states()] == pytest.approx([distance, -0.2])


@pytest.mark.parametrize(("anew", "law"), [(True, Law.FREE), (False, Law.HOLD)])
def test_without_new_anchors_a_hand_reaches_the_tether(anew: bool, law: Law) -> None:
    """VW-3 to VW-5."""
    bench = Bench(walls__new_anchors=anew).entered()
    bench.run(50, NOTHING, at(0.0, force=10.0))
    decision = bench.step()
    for k in range(1, 200):
        decision = bench.step(NOTHING, at(0.0002 * k, force=10.0))
        if decision.law is not Law.FREE:
            break
    assert decision.law is law


@pytest.mark.parametrize("anew", [True, False])
def test_without_new_anchors_every_wall_is_a_fixed_one(anew: bool) -> None:
    """VW-3 to VW-5; an area is one anyhow."""
    containment = Containment((Wall(name="w", shape=Sphere(radius=0.2), policy=Policy.USER), FLOOR), {})
    containment.enter(WallSettings(new_anchors=anew))
    containment.step(at(0.0), *NOBODY)
    policies = [border.policy for border, _ in containment.places() if isinstance(border, Wall)]
    assert policies == ([Policy.AVERAGE, Policy.USER] if anew else [Policy.FIXED, Policy.FIXED])


@pytest.mark.parametrize(("load", "ticks"), [(0.0, 50), (0.5, 75), (1.0, 100)])
def test_a_safety_period_alone_follows_the_payload(load: float, ticks: int) -> None:
    """VW-3: 0.1 s, or twice as long with 1 kg."""
    dependence = Dependence(measure=Measure.PAYLOAD, low=0.0, high=1.0, at_low=1.0, at_high=2.0)
    wall = Wall(name="w", shape=Sphere(radius=0.2), literal=True, safety_period=0.1, safety_dependence=dependence)
    containment = Containment((wall,), {})
    containment.enter(WallSettings(tether=False))
    containment.step(at(0.0, load_mass=load), *NOBODY)
    distances = []
    for _ in range(101):
        containment.step(at(0.1, load_mass=load), *NOBODY)
        distances += [state.distance for state in containment.states()]
    assert distances == pytest.approx([-0.1] * (ticks - 1) + [-0.2] * (102 - ticks)), "from the tick after it is anchored again"


@pytest.mark.parametrize(("z", "near", "exceeded", "force"), [(0.0, 0.0, False, 0.0), (-0.12, 1.0, True, 80.0)])
def test_of_every_border_is_told_what_the_law_needs(z: float, near: float, exceeded: bool, force: float) -> None:
    """VW-7, VW-10."""
    containment = Containment((FLOOR,), {})
    containment.enter(WallSettings(tether=False))
    containment.step(at(0.0), *NOBODY)
    containment.step(at(0.1, 0.2, z), *NOBODY)
    (state,) = containment.states()
    distance, forces = pytest.approx(-0.1 - z), pytest.approx((0.0, 0.0, force))
    assert state == WallState("floor", "flange", (0.1, 0.2, z), distance, (0.0, 0.0, -1.0), near, exceeded, forces)


@pytest.mark.parametrize(("resistance", "near"), [(True, 0.5), (False, 0.0)])
def test_without_resistance_walls_and_areas_have_no_band(resistance: bool, near: float) -> None:
    """VW-7."""
    bench = Bench(FLOOR, walls__tether=False, walls__resistance=resistance).entered()
    (state,) = bench.step(NOTHING, at(0.0, 0.0, -0.09)).walls
    assert state.near == pytest.approx(near)


def test_what_cannot_be_told_is_refused_and_not_drawn() -> None:
    containment = Containment((Area(name="gone", reference="nowhere", shape=Sphere(radius=1.0)),), {})
    containment.begin(Start.SEQUENCE, WallSettings(tether=False))
    reading = containment.step(estimate(), *NOBODY)
    assert reading is not None
    assert facts(reading) == out(0.0, "unknown", (0.0, 0.0, 0.0)) | {"wall": "gone"}
    assert containment.states() == ()
    assert containment.places() == ()


def test_a_wall_has_no_place_before_its_first_step() -> None:
    """VW-6: joints that are not valid put it off, and pictures ask all the same."""
    early = Wall(name="early", shape=Sphere(radius=0.05), anchored_at=Start.ACTIVATION)
    containment = Containment((early, FLOOR), {})
    containment.begin(Start.ACTIVATION, WallSettings(tether=False))
    assert containment.places() == ()
    containment.step(estimate(), *NOBODY)
    containment.begin(Start.SEQUENCE, WallSettings(tether=False))
    assert [border.name for border, _ in containment.places()] == ["early"]
    containment.step(estimate(), *NOBODY)
    assert [border.name for border, _ in containment.places()] == ["early", "floor"]


def test_what_was_left_holds_no_more() -> None:
    containment = Containment((FLOOR,), {})
    containment.enter(WallSettings())
    assert containment.step(at(0.0), *NOBODY) is None
    assert containment.step(at(0.0, 0.0, -0.2), *NOBODY) is not None
    containment.leave()
    assert containment.step(at(0.0, 0.0, -0.2), *NOBODY) is None
    assert containment.states() == containment.places() == ()


def test_without_any_border_it_does_nothing() -> None:
    containment = Containment((), {"world": HERE})
    before = state_of(containment)
    containment.begin(Start.ACTIVATION, WallSettings(tether=False))
    containment.begin(Start.SEQUENCE, WallSettings(tether=False))
    containment.enter(WallSettings(tether=False))
    assert containment.step(estimate(), *NOBODY) is None
    assert state_of(containment) == before


@pytest.mark.parametrize(
    ("outward", "way"),
    [((0.0, 0.0, -1.0), "+z"), ((0.707, 0.707, 0.0), "-x -y"), ((0.577, -0.577, 0.577), "-x +y -z"), ((0.95, 0.2, 0.24), "-x")],
)  # fmt: skip
def test_the_way_back_is_told_in_axes_of_the_base(outward: tuple[float, float, float], way: str) -> None:
    x, y, z = outward
    position = tuple(0.3 * value for value in outward)
    containment = Containment((Area(name="ball", shape=Sphere(radius=0.2)),), {})
    containment.begin(Start.SEQUENCE, WallSettings(tether=False))
    containment.step(estimate(), *NOBODY)
    reading = containment.step(at(*position), *NOBODY)
    assert reading is not None
    assert facts(reading)["way"] == way
    assert facts(reading)["distance"] == pytest.approx(1000.0 * (0.3 * math.sqrt(x * x + y * y + z * z) - 0.2))


def places(bench: "Bench") -> tuple[tuple[AnyBorder, Place], ...]:
    return bench.supervisor.containment.every_place(bench.supervisor.settings.walls)


def test_pictures_know_where_areas_will_hold_and_where_walls_do() -> None:
    frames = {"world": HERE, "cart": Pose((0.4, 0.1, 0.2), from_rpy(0.0, 0.0, math.pi / 2))}
    size = Dependence(measure=Measure.REACH, low=-1.0, high=1.0, at_low=0.5, at_high=2.0)
    cart = Area(
        name="cart", reference="cart", shape=Box(size=(0.2, 0.2, 0.2)), position=(0.1, 0.0, 0.0), keep_out=True, size=size
    )
    held = Area(name="held", reference="tcp", shape=Sphere(radius=0.5))
    wall = Wall(name="round it", shape=Sphere(radius=0.2), policy=Policy.FIXED)
    bench = Bench(cart, held, wall, frames=frames, walls__tether=False)
    bench.step()
    ((border, place),) = places(bench)  # what lies in a part of the arm, or round it, has no place of its own
    assert border is cart
    assert place.pose.p == pytest.approx((0.4, 0.2, 0.2))  # 0.1 along the cart's x, which is the base's y
    assert turned(place.pose.R, (1.0, 0.0, 0.0)) == pytest.approx((0.0, 1.0, 0.0), abs=1e-12)
    assert place.factor == 0.5
    bench.run(60)
    bench.run(30, HOLD)  # in the activation period it does not hold yet
    assert [border.name for border, _ in places(bench)] == ["cart"]
    bench.entered()
    assert [border.name for border, _ in places(bench)] == ["cart", "held", "round it"]
    assert places(bench)[0][1].factor == pytest.approx(1.25)  # the flange is at the origin


def test_areas_that_are_switched_off_have_no_place() -> None:
    bench = Bench(FLOOR, walls__on=False)
    bench.step()
    assert places(bench) == ()


def test_sizes_follow_reach_and_height_along_gravity() -> None:
    """VW-8: distance of the flange from the base's origin, and its height above it, also on a tilted base."""
    value = estimate(position=[0.3, -0.4, 1.2], load_mass=1.5)
    value.g_B = GRAVITY * np.array([0.0, -0.6, -0.8])
    measures = {Measure.REACH: 1.3, Measure.HEIGHT: -0.24 + 0.96, Measure.PAYLOAD: 1.5}
    assert _measures(value) == pytest.approx(measures)


NEAR = msgspec.structs.replace(FLOOR, name="near", position=(0.0, 0.0, -0.05))
ODD = [
    ((FLOOR, FLOOR), "'floor' is given twice"),
    ((msgspec.structs.replace(FLOOR, name="tether"),), "'tether' is the name"),
    ((msgspec.structs.replace(FLOOR, part="nose"),), "floor.part: 'nose' is unknown"),
    ((msgspec.structs.replace(FLOOR, reference="moon"),), "floor.reference: 'moon' is unknown"),
    (tuple(msgspec.structs.replace(FLOOR, name=f"{k}") for k in range(MOST_WALLS + 1)), "41 are too many"),
]


def test_another_list_of_walls_holds_from_the_next_free_drive_on() -> None:
    bench = Bench(FLOOR)
    bench.step(Inputs(borders=(FLOOR,)))  # nothing new
    assert bench.kinds() == []
    bench.step(Inputs(borders=(FLOOR, NEAR)))
    assert bench.events[-1].values == {"change": "near added", "count": 2}
    bench.entered()
    assert [wall.name for wall in bench.step().walls] == ["tether", "floor", "near"]
    bench.step(Inputs(commands=(Command.LEAVE_FREE_DRIVE,)))
    bench.step(Inputs(borders=()))
    assert bench.events[-1].values == {"change": "2 deleted", "count": 0}


@pytest.mark.parametrize(("borders", "why"), ODD)
def test_a_list_that_does_not_fit_is_refused_whole(borders: tuple[AnyBorder, ...], why: str) -> None:
    bench = Bench(FLOOR)
    bench.step(Inputs(borders=borders))
    assert bench.kinds() == [Kind.WALLS_REFUSED]
    assert why in str(bench.events[-1].values["reason"])
    assert bench.supervisor.containment.borders == (FLOOR,)


def test_no_wall_changes_while_the_arm_is_free_or_about_to_be() -> None:
    bench = Bench(FLOOR)
    bench.trying()
    bench.step(Inputs(borders=()))
    assert bench.events[-1].values == {"reason": "no change of a wall in the activation of free-drive"}
    bench.run(501, LET_GO)
    bench.step(Inputs(borders=(NEAR,)))
    assert bench.events[-1].values == {"reason": "no change of a wall in FREE_DRIVE"}
    assert bench.supervisor.containment.borders == (FLOOR,)


def test_a_wall_that_is_off_is_remembered_and_does_not_hold() -> None:
    off = msgspec.structs.replace(FLOOR, on=False)
    bench = Bench(off)
    bench.entered()
    assert [wall.name for wall in bench.step().walls] == ["tether"]
    assert bench.step(NOTHING, at(0.0, 0.0, -0.02)).mode is Mode.FREE_DRIVE
    assert (off, off.position) in [(border, place.pose.p) for border, place in places(bench)]
