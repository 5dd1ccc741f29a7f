"""Walls as settings: defaults, ranges, and what does not fit together."""

import math

import msgspec
import pytest
from hypothesis import given
from hypothesis import strategies as st

from pendant.walls.definitions import AnyBorder, Area, Dependence, Measure, Policy, Start, Wall, in_shape, problem
from pendant.walls.settings import Reaction
from pendant.walls.shapes import Box, HalfSpace, Sphere

BALL = {"kind": "sphere", "radius": 0.1}


def read(**fields: object) -> AnyBorder:
    return msgspec.convert({"kind": "wall", "name": "tether", "shape": BALL} | fields, type=AnyBorder)


def test_the_defaults() -> None:
    wall = read()
    assert isinstance(wall, Wall)
    assert msgspec.to_builtins(wall) == {
        "kind": "wall",
        "name": "tether",
        "part": "flange",
        "shape": BALL,
        "reference": "base",
        "orientation": (1.0, 0.0, 0.0, 0.0),
        "size": None,
        "band": 0.02,
        "stiffness": 4000.0,
        "damping": 200.0,
        "force": 150.0,
        "push": 0.0,
        "push_back": 8.0,
        "reaction": "leave",
        "on": True,
        "offset": (0.0, 0.0, 0.0),
        "policy": "stepwise",
        "literal": False,
        "safety_period": 1.0,
        "safety_dependence": None,
        "redefine_period": None,
        "averaging_period": 2.0,
        "step": 0.02,
        "activation_size": 0.3,
        "operation_size": 1.0,
        "anchored_at": "sequence",
    }
    area = read(kind="area")
    assert isinstance(area, Area)
    assert (area.position, area.keep_out, area.reaction) == ((0.0, 0.0, 0.0), False, Reaction.LEAVE)


RANGES = [
    ("band", 0.0, 0.5),
    ("stiffness", 0.0, 20000.0),
    ("damping", 0.0, 1000.0),
    ("force", 1.0, 500.0),
    ("push", 0.0, 100.0),
    ("push_back", 1.0, 50.0),
    ("safety_period", 0.1, 10.0),
    ("redefine_period", 0.1, 10.0),
    ("averaging_period", 0.02, 10.0),
    ("step", 0.002, 0.5),
    ("activation_size", 0.05, 10.0),
    ("operation_size", 0.05, 10.0),
]


@pytest.mark.parametrize(("name", "low", "high"), RANGES)
def test_ranges(name: str, low: float, high: float) -> None:
    # so wide a ball, and so weak a spring, that nothing else speaks against the ends of the range
    wide = {"shape": {"kind": "sphere", "radius": 10.0}, "stiffness": 0.0, "damping": 100.0}
    for value in (low, high):
        wall = read(**wide | {name: value})
        assert getattr(wall, name) == value
    for value in (low - 1e-6, high + 1e-6, math.nan, math.inf):
        with pytest.raises(msgspec.ValidationError, match=rf"\$\.{name}"):
            read(**wide | {name: value})


@pytest.mark.parametrize(
    ("fields", "message"),
    [
        ({"orientation": (1.0, 1.0, 0.0, 0.0)}, "orientation: its length is 1.414, allowed: 1 (wxyz)"),
        ({"orientation": (math.nan, 0.0, 0.0, 0.0)}, "orientation: its length is nan, allowed: 1 (wxyz)"),
        ({"reference": "flange"}, "reference: 'flange' is the part itself, allowed: another frame"),
        ({"damping": 10.0}, "damping: 10 is too little, allowed: 0.004 s of the stiffness or more"),
        ({"offset": (0.0, 0.0, 0.12)}, "offset: the part would start 20 mm outside the shape, allowed: inside"),
        ({"offset": (0.0, 0.0, 0.09)}, "band: 0.02 m reaches to the part itself, allowed: less than 0.01 m"),
        ({"band": 0.1}, "band: 0.1 m reaches to the part itself, allowed: less than 0.1 m"),
        ({"operation_size": 0.1}, "band: 0.02 m reaches to the part itself, allowed: less than 0.01 m"),
        (
            {"size": {"measure": "reach", "low": 0.1, "high": 0.2, "at_low": 0.1}},
            "band: 0.02 m reaches to the part itself, allowed: less than 0.01 m",
        ),
        (
            {"size": {"measure": "reach", "low": 0.2, "high": 0.2}},
            "low: 0.2 is not allowed; allowed: less than high, 0.2, both finite",
        ),
        ({"size": {"measure": "reach", "low": -math.inf, "high": 0.2}}, "low: -inf is not allowed"),
        ({"size": {"measure": "reach", "low": math.nan, "high": 0.2}}, "low: nan is not allowed"),
        ({"size": {"measure": "reach", "low": -1.5e308, "high": 1.5e308}}, "low: -1.5e+308 is not allowed"),  # no span
        ({"policy": "sometimes"}, "Invalid enum value 'sometimes' - at `$.policy`"),
        ({"keep_out": True}, "Object contains unknown field `keep_out`"),
        ({"name": ""}, "Expected `str` of length >= 1 - at `$.name`"),
    ],
)
def test_what_does_not_fit_together_is_refused_by_name(fields: dict[str, object], message: str) -> None:
    with pytest.raises(msgspec.ValidationError) as error:
        read(**fields)
    assert message in str(error.value)


def test_a_turned_shape_takes_its_offset_in_the_axes_of_the_reference() -> None:
    # A plate, flat along x after a quarter turn about y: 3 cm along z still lie inside it, along x they do not.
    plate, quarter = Box(size=(0.2, 0.2, 0.04)), (math.sqrt(0.5), 0.0, math.sqrt(0.5), 0.0)
    Wall(name="a", shape=plate, orientation=quarter, offset=(0.0, 0.0, 0.03), band=0.01)
    with pytest.raises(ValueError, match="10 mm outside"):
        Wall(name="a", shape=plate, orientation=quarter, offset=(0.03, 0.0, 0.0), band=0.01)


@pytest.mark.parametrize(("length", "whole"), [(0.999, False), (0.99901, True), (1.0, True), (1.00099, True), (1.001, False)])
def test_an_orientation_has_the_length_of_one(length: float, whole: bool) -> None:
    turned = {"orientation": [length, 0.0, 0.0, 0.0]}
    if whole:
        assert read(**turned).orientation[0] == length
    else:
        with pytest.raises(msgspec.ValidationError, match=f"orientation: its length is {length:g}, allowed: 1"):
            read(**turned)


def test_a_part_on_the_border_of_its_shape_is_not_inside() -> None:
    with pytest.raises(ValueError, match=r"offset: the part would start -?0 mm outside the shape"):
        Wall(name="a", shape=Sphere(radius=0.5), offset=(0.5, 0.0, 0.0), band=0.0)


def test_the_part_lies_opposite_to_the_offset_in_the_axes_of_the_shape() -> None:
    assert in_shape((1.0, 0.0, 0.0, 0.0), (0.1, -0.2, 0.3)) == (-0.1, 0.2, -0.3)
    half = math.sqrt(0.5)  # a quarter turn about z: the shape's x lies along the reference's y
    assert in_shape((half, 0.0, 0.0, half), (0.1, -0.2, 0.3)) == pytest.approx((0.2, 0.1, -0.3))


def test_a_list_of_walls_comes_back_equal_from_a_file() -> None:
    walls = (
        Wall(name="a", shape=Sphere(radius=0.2), policy=Policy.USER, anchored_at=Start.ACTIVATION),
        Area(name="b", shape=HalfSpace(normal=(0.0, 0.0, -1.0)), reference="world", reaction=Reaction.STOP),
        Wall(name="c", shape=Box(size=(1.0, 1.0, 1.0)), size=Dependence(measure=Measure.REACH, low=0.2, high=0.8, at_low=0.5)),
    )
    assert msgspec.json.decode(msgspec.json.encode(walls), type=tuple[AnyBorder, ...]) == walls


@given(st.floats(-2.0, 2.0))
def test_a_dependence_runs_straight_between_two_values(value: float) -> None:
    rule = Dependence(measure=Measure.HEIGHT, low=0.0, high=1.0, at_low=2.0, at_high=0.5)
    expected = 2.0 if value < 0.0 else 0.5 if value > 1.0 else 2.0 - 1.5 * value
    assert rule.factor({Measure.HEIGHT: value}) == pytest.approx(expected)


def test_a_measure_that_is_not_known_gives_the_smallest_size() -> None:
    for at_low, at_high in ((2.0, 0.5), (0.5, 2.0)):
        rule = Dependence(measure=Measure.HEIGHT, low=0.0, high=1.0, at_low=at_low, at_high=at_high)
        assert rule.factor({}) == 0.5
        assert rule.factor({Measure.HEIGHT: math.nan}) == 0.5


def test_names_must_be_known_and_their_own() -> None:
    parts, references = frozenset({"flange", "tcp"}), frozenset({"base", "world"})
    ball = Sphere(radius=0.1)
    a, b = Wall(name="a", shape=ball), Wall(name="b", shape=ball, reference="world", part="tcp")
    assert problem((a, b), parts, references) is None
    assert problem((a, b, a), parts, references) == "name: 'a' is given twice, allowed: a name of its own for each wall"
    nose = Wall(name="n", shape=ball, part="nose")
    assert problem((nose,), parts, references) == "n.part: 'nose' is unknown, allowed: flange, tcp"
    moon = Wall(name="m", shape=ball, reference="moon")
    assert problem((moon,), parts, references) == "m.reference: 'moon' is unknown, allowed: base, world"


def test_words_of_files() -> None:
    assert list(Reaction) == ["stay", "leave", "stop"]
    assert list(Policy) == ["fixed", "stepwise", "average", "user"]
    assert list(Start) == ["sequence", "activation"]
    assert list(Measure) == ["reach", "height", "manipulability", "payload"]
