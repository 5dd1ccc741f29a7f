"""Bad input is one clear line: where, field, value, what is allowed."""

from pathlib import Path
from typing import Annotated, Literal

import msgspec
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from msgspec import Meta

from app.files.checked import BadInput, convert, load, parse


class Cat(msgspec.Struct, tag="cat", tag_field="kind", forbid_unknown_fields=True):
    lives: Annotated[int, Meta(ge=1, le=9)]


class Dog(msgspec.Struct, tag="dog", tag_field="kind", forbid_unknown_fields=True):
    tail: Annotated[float, Meta(gt=0)] = 0.3
    name: Annotated[str, Meta(min_length=2)] = "Rex"


class House(msgspec.Struct, forbid_unknown_fields=True, kw_only=True):
    floors: int = 1
    area: Annotated[float, Meta(gt=0, lt=1000)] = 50.0
    lit: bool = False
    place: Literal["floor", "wall"] | Annotated[list[float], Meta(min_length=3, max_length=3)] = "floor"
    pets: list[Cat | Dog] = []
    rooms: dict[str, Annotated[float, Meta(ge=2)]] = {}
    switches: dict[str, Literal["on", "off"]] = {}
    pair: tuple[float, int] | None = None


def complaint(text: str) -> str:
    with pytest.raises(BadInput) as caught:
        parse(text, House, "house.yaml")
    return str(caught.value)


def test_good_input_becomes_a_value() -> None:
    house = parse(
        "floors: 2\narea: 1e2\nplace: [1, 2, 3]\npets: [{kind: cat, lives: 9}, {kind: dog}]\nswitches: {a: off, b: on}",
        House,
        "h",
    )
    assert house == House(floors=2, area=100.0, place=[1, 2, 3], pets=[Cat(9), Dog()], switches={"a": "off", "b": "on"})


@pytest.mark.parametrize(
    ("text", "rest"),
    [
        ("floors: x", "floors = x: expected a whole number"),
        ("floors: '2'", "floors = '2': expected a whole number"),
        ("floors: 1.5", "floors = 1.5: expected a whole number"),
        ("floors: true", "floors = true: expected a whole number"),
        ("floors: null", "floors = null: expected a whole number"),
        ("floors: 010x", "floors = '010x': expected a whole number"),
        ("floors: 2026-01-01", "floors = '2026-01-01': expected a whole number"),
        ("floors: 99999999999999999999", "floors = 99999999999999999999: expected a number below 2^63"),
        ("area: -1", "area = -1: expected a number > 0 and < 1000"),
        ("area: 1000", "area = 1000: expected a number > 0 and < 1000"),
        ("area: .nan", "area = nan: expected a finite number"),
        ("area: -.inf", "area = -inf: expected a finite number"),
        ("area: 1e999", "area = inf: expected a finite number"),
        ("place: [1, .inf, 2]", "place[1] = inf: expected a finite number"),
        ("lit: yes", "lit = yes: expected true or false"),
        ("lit: 1", "lit = 1: expected true or false"),
        ("place: roof", "place = roof: expected one of floor, wall or a list of 3, each a number"),
        ("place: [1, 2]", "place = [1, 2]: expected one of floor, wall or a list of 3, each a number"),
        ("place: [1, 2, x]", "place[2] = x: expected a number"),
        ("pair: [1]", "pair = [1]: expected a list of 2: a number, a whole number or null"),
        ("pair: [1, 2.5]", "pair[1] = 2.5: expected a whole number"),
        ("pets: cat", "pets = cat: expected a list, each a mapping with kind one of cat, dog"),
        ("pets: [cat]", "pets[0] = cat: expected a mapping with kind one of cat, dog"),
        ("pets: [{kind: cow}]", "pets[0].kind = cow: expected one of cat, dog"),
        ("pets: [{kind: [1]}]", "pets[0].kind = [1]: expected one of cat, dog"),
        ("pets: [{lives: 3}]", "pets[0].kind: missing, expected one of cat, dog"),
        ("pets: [{kind: cat}]", "pets[0].lives: missing, expected a whole number >= 1 and <= 9"),
        ("pets: [{kind: dog}, {kind: cat, lives: 10}]", "pets[1].lives = 10: expected a whole number >= 1 and <= 9"),
        ("pets: [{kind: dog, name: R}]", "pets[0].name = R: expected a text of at least 2 characters"),
        ("pets: [{kind: dog, tale: 1}]", "pets[0].tale: unknown field, did you mean tail? expected one of kind, name, tail"),
        (
            "flors: 1",
            "flors: unknown field, did you mean floors? expected one of area, floors, lit, pair, pets, place, rooms, switches",
        ),
        ("rooms: {bath: 3, hall: 1}", "rooms.hall = 1: expected a number >= 2"),
        ("rooms: [1]", "rooms = [1]: expected a mapping to a number >= 2"),
        ("switches: {FD-9: of}", "switches.FD-9 = of: expected one of on, off"),
        ("floors: 1\nfloors: 2", "line 2: floors: expected each key once, it stands on line 1 too"),
        ("rooms:\n  a: 3\n  b: 3\n  a: 4", "line 4: a: expected each key once, it stands on line 2 too"),
        ("1: 2", "line 1: '1': expected a text as key"),
        ("? [1]\n: 2", "line 1: a list or mapping: expected a text as key"),
        ("<<: {floors: 2}", "line 1: <<: expected a text as key"),
        ("a: &a [1]\nb: *a", "line 1: a: expected no anchors and aliases"),
        ("floors: !!int x", "line 1: tag:yaml.org,2002:int: expected no tags"),
        (
            "floors: !!python/object/apply:os.getcwd []",
            "line 1: tag:yaml.org,2002:python/object/apply:os.getcwd: expected no tags",
        ),
        ("x: " + "[" * 5000, "line 1: here: expected at most 40 levels of nesting"),
        ("floors: 1" + "0" * 5000, f"line 1: '{'1' + '0' * 75}...: expected a number of at most 30 digits"),
        ("\n\nfloors: [1", "line 3: expected YAML (did not find expected ',' or ']')"),
        ("a: 1\n---\na: 1", "line 2: expected YAML (but found another document)"),
    ],
)
def test_bad_input_is_one_line(text: str, rest: str) -> None:
    assert complaint(text) == f"house.yaml: {rest}"


@pytest.mark.parametrize(("text", "value"), [("- 1", "[1]"), ("", "null"), ("just words", "just words")])
def test_the_whole_must_be_a_mapping(text: str, value: str) -> None:
    fields = "floors, area, lit, place, pets, rooms, switches, pair"
    assert complaint(text) == f"house.yaml: {value}: expected a mapping of {fields}"


def test_control_characters_are_refused_and_never_shown() -> None:
    assert complaint("floors: \x1b[31m").isprintable()
    assert complaint('"\\e[31m": 1').startswith(r"house.yaml: \x1b[31m: unknown field")
    assert complaint('floors: "\\e[31m"') == r"house.yaml: floors = \x1b[31m: expected a whole number"


def test_a_long_value_is_cut_short() -> None:
    assert complaint("floors: " + "x" * 500) == f"house.yaml: floors = {'x' * 77}...: expected a whole number"


def test_the_parts_of_a_complaint_can_be_read() -> None:
    with pytest.raises(BadInput) as caught:
        parse("area: -1", House, "house.yaml")
    error = caught.value
    assert (error.where, error.field, error.value, error.allowed) == (
        "house.yaml",
        "area",
        -1,
        "expected a number > 0 and < 1000",
    )


def test_files(tmp_path: Path) -> None:
    path = tmp_path / "house.yaml"
    path.write_text("\ufefffloors: 3", "utf-8")
    assert load(path, House).floors == 3
    path.write_bytes(b"area: 5\nfloors: \xff")
    with pytest.raises(BadInput, match=r"house.yaml: line 2 = \\xff: expected text in UTF-8"):
        load(path, House)
    path.write_text("#" * 2_000_001, "utf-8")
    with pytest.raises(BadInput, match="at most 2000000 bytes"):
        load(path, House)
    with pytest.raises(BadInput, match="expected an existing file"):
        load(tmp_path / "none.yaml", House)
    with pytest.raises(BadInput, match="is a folder; expected a regular file"):
        load(tmp_path, House)


def test_raw_values_are_checked_too() -> None:
    assert convert({"floors": 2}, House, "message") == House(floors=2)
    assert convert([1, 2], list[float], "message") == [1.0, 2.0]
    for raw in (
        {"area": float("nan")},
        {1: 2},
        {"place": (1.0, float("inf"), 2.0)},
        {"floors": 2**70},
        [],
        None,
        {"floors": object()},
    ):
        with pytest.raises(BadInput):
            convert(raw, House, "message")
    deep: list[object] = []
    for _ in range(10_000):
        deep = [deep]
    with pytest.raises(BadInput, match="40 levels"):
        convert({"pets": deep}, House, "message")


scalars = (
    st.none() | st.booleans() | st.integers() | st.floats() | st.text(max_size=6) | st.sampled_from(["cat", "dog", "on", "wall"])
)
names = st.sampled_from(["floors", "area", "lit", "place", "pets", "rooms", "switches", "pair", "kind", "lives", "tail", "nix"])
trees = st.recursive(scalars, lambda inner: st.lists(inner, max_size=3) | st.dictionaries(names, inner, max_size=4), max_leaves=8)


slow_to_start = settings(deadline=None, suppress_health_check=[HealthCheck.too_slow])  # the first text needs tables of Unicode


@slow_to_start
@given(st.dictionaries(names, trees, max_size=3))
def test_whatever_comes_is_a_value_or_one_line(raw: dict[str, object]) -> None:
    try:
        outcome: House | str = convert(raw, House, "message")
    except BadInput as error:
        outcome = str(error)
    assert isinstance(outcome, House) or (outcome.startswith("message: ") and outcome.isprintable())


@slow_to_start
@given(st.text(max_size=60))
def test_whatever_text_is_a_value_or_one_line(text: str) -> None:
    try:
        outcome: House | str = parse(text, House, "message")
    except BadInput as error:
        outcome = str(error)
    assert isinstance(outcome, House) or (outcome.startswith("message: ") and outcome.isprintable())
