"""What people hand over: numbers that no body has, files that are too large, arms that are none, files of other people."""

import time
import tracemalloc
from collections.abc import Callable
from pathlib import Path
from random import Random
from typing import Any

import msgspec
import pytest

from app.files.bad_input import shown
from app.files.checked import BadInput, convert, load
from app.files.library import ASSETS, load_arm, load_tool
from app.log_reading.reader import read
from app.runs.runner import record, simulate, try_out
from app.session.prepare import prepare
from app.session.session_file import Session, Setup, opened
from pendant.events.event import Kind
from sim.arm.arm_file import Arm
from sim.plant.true_arm import Plant
from tools.fuzz.recordings import rewrite
from tools.fuzz.targets import targets

UR5E = load(ASSETS / "robots" / "ur5e.yaml", dict[str, Any])
GRIPPER = load(ASSETS / "tools" / "gripper.yaml", dict[str, Any])


def refused(act: Callable[[], object]) -> str:
    with pytest.raises(BadInput) as caught:
        act()
    line = str(caught.value)
    assert line.isprintable()
    return line


def setup(**fields: Any) -> Setup:
    return convert(fields, Setup, "cell.yaml")


@pytest.mark.parametrize(
    ("field", "value", "where"),
    [
        ("radius", 1e9, "tool.radius = 1000000000.0"),
        ("length", 1e300, "tool.length = 1e+300"),
        ("length", 1.7e308, "tool.length = 1.7e+308"),
        ("length", 1e15, "tool.length"),
        ("mass", 1e6, "tool.mass"),
        ("inertia", [1e300] * 3 + [0.0] * 3, "tool.inertia[0] = 1e+300"),
    ],
)
def test_a_tool_that_is_no_tool_is_refused(field: str, value: object, where: str) -> None:
    assert where in refused(lambda: setup(tool={**GRIPPER, field: value}))


@pytest.mark.parametrize(
    ("mass", "inertia"),
    [
        (1e-9, [1000.0, 1000.0, 1000.0, 0.0, 0.0, 0.0]),
        (1.0, [1.1, 1.1, 1.1, 0.0, 0.0, 0.0]),
        (1.0, [1e-12, 1e-12, 1e-12, 0.0, 0.0, 0.0]),
    ],
)
def test_an_inertia_goes_with_its_mass(mass: float, inertia: list[float]) -> None:
    line = refused(lambda: prepare(setup(tool={**GRIPPER, "mass": mass, "inertia": inertia}), "cell.yaml"))
    assert "tool.inertia" in line
    assert f"for {mass:g} kg" in line


def arm(**groups: dict[str, Any] | Any) -> Arm:
    raw = msgspec.json.decode(msgspec.json.encode(UR5E))
    for name, fields in groups.items():
        raw[name] = {**raw[name], **fields} if isinstance(fields, dict) else fields
    return convert(raw, Arm, "arm.yaml")


@pytest.mark.parametrize(
    ("groups", "where"),
    [
        ({"limits": {"speed": [1e-9] * 6}}, "limits.speed[0]"),
        ({"limits": {"speed": [1e300] * 6}}, "limits.speed[0]"),
        ({"reach": 0.0}, "reach"),
        ({"payload": 1e15}, "payload"),
        ({"chain": {"joints": ["one"]}}, "chain.joints"),
        ({"chain": {"a": [1e15] * 6}}, "chain.a[0]"),
        ({"masses": {"mass": [1e-300] * 6}}, "masses.mass[0]"),
        ({"name": "../../etc"}, "name"),
        ({"name": "a\0b"}, "name"),
    ],
)
def test_an_arm_that_is_no_arm_is_refused(groups: dict[str, Any], where: str) -> None:
    assert f"arm.yaml: {where}" in refused(lambda: arm(**groups))


@pytest.mark.parametrize(
    ("thing", "where"),
    [
        ({"kind": "box", "size": [1e-300, 1.0, 1.0]}, "world[0].size[0]"),
        ({"kind": "box", "size": [1e300, 1.0, 1.0]}, "world[0].size[0]"),
        ({"kind": "box", "size": [1.0, 1.0, 1.0], "stiffness": 1e300}, "world[0].stiffness"),
        ({"kind": "moving", "size": [1.0, 1.0, 1.0], "amplitude": [2.0, 0.0, 0.0], "period": 0.01}, "world[0].amplitude"),
    ],
)
def test_a_thing_that_is_none_is_refused(thing: dict[str, Any], where: str) -> None:
    world = [{"name": "thing", "position": [2.0, 0.0, 0.0], **thing}]
    assert where in refused(lambda: prepare(setup(world=world), "cell.yaml"))


def test_an_arm_does_not_begin_inside_an_object() -> None:
    prepared = prepare(setup(world=[{"kind": "plane", "name": "roof", "position": [0.0, 0.0, 20.0]}]), "cell.yaml")
    line = refused(lambda: simulate(prepared))
    assert line.startswith("cell.yaml: cannot be simulated (the arm begins ")
    assert "inside 'roof'" in line


def test_what_passes_its_bounds_and_cannot_stand_is_said_in_a_line() -> None:
    """Each number is possible: stiff gears between light links, which swing faster than the physics computes."""
    stiff = arm(transmissions={"stiffness": [9e8] * 6})
    prepared = prepare(setup(), "cell.yaml")._replace(arm=stiff, where="arm.yaml")
    assert refused(lambda: try_out(prepared)).startswith("arm.yaml: while it runs: cannot be simulated (the physics diverged")


@pytest.mark.parametrize(
    ("step", "where"),
    [
        ({"kind": "linear", "position": [0.0, 0.0, 0.0], "quaternion": [1.0, 0.0, 0.0, 0.0], "speed": 1e-300}, "speed"),
        (
            {"kind": "linear", "position": [0.0, 0.0, 0.0], "quaternion": [1.0, 0.0, 0.0, 0.0], "acceleration": 1e-300},
            "acceleration",
        ),
        ({"kind": "joint", "q": [0.0] * 6, "speed": 5e-324}, "speed"),
        ({"kind": "joint", "q": [1e300] * 6}, "q[0]"),
        ({"kind": "force", "force": [0.0, 0.0, -10.0], "speed": 1e-300}, "speed"),
    ],
)
def test_a_program_that_would_never_end_is_refused(step: dict[str, Any], where: str) -> None:
    raw = {"title": "t", "duration": 1.0, "program": {"steps": [step]}}
    assert f"program.steps[0].{where} = " in refused(lambda: convert(raw, Session, "s.yaml"))


def test_a_session_that_breaks_down_ends_in_a_line_and_its_recording_says_why(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    session = convert({"title": "t", "duration": 0.4}, Session, "s.yaml")
    prepared = prepare(session, "s.yaml")
    advance = Plant.advance

    def diverge(self: Plant, *arguments: Any, **more: Any) -> None:
        if self.tick == 100:
            raise FloatingPointError("the physics diverged after 0.200 s")
        advance(self, *arguments, **more)

    monkeypatch.setattr(Plant, "advance", diverge)
    assert "while it runs: cannot be simulated (the physics diverged" in refused(lambda: record(session, prepared, tmp_path))
    log = read(tmp_path / "log.mcap")
    assert log.events[-1].kind == Kind.BROKEN_DOWN
    assert log.whole
    assert log.missing == "0.20 s of 0.4 s are there"


@pytest.mark.parametrize("name", ["a\0.yaml", "\0", "x/\0/y.yaml"])
def test_a_nul_in_a_name_is_refused(name: str) -> None:
    for find in (load_arm, load_tool):
        refused(lambda find=find: find(name))


@pytest.mark.parametrize(
    "text",
    [
        "title: t\nduration: 1\ntimeline:\n" + "  - 1\n" * 300_000,
        "title: t\nduration: 1\ntimeline:\n" + "  - {at: 0.0, do: tap, control: reset}\n" * 20_000,
        "title: t\nduration: 1\nworld:\n" + "  - {kind: plane, name: a, position: [0, 0, 0]}\n" * 20_000,
        "title: t\nduration: 1\nwatch: " + "x" * 3_000_000,
    ],
    ids=["numbers", "actions", "objects", "bytes"],
)
def test_a_file_with_too_much_in_it_is_refused_soon(text: str, tmp_path: Path) -> None:
    path = tmp_path / "much.yaml"
    path.write_text(text)
    tracemalloc.start()
    begun = time.process_time()
    assert "expected at most" in refused(lambda: opened(path, Session))
    took, (_, peak) = time.process_time() - begun, tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert peak < 100e6
    assert took < 20.0, "with memory traced; a second without"


def test_the_most_that_a_file_may_say_is_read(tmp_path: Path) -> None:
    path = tmp_path / "much.yaml"
    path.write_text("title: t\nduration: 1\ntimeline:\n" + "  - {at: 0.0, do: tap, control: reset}\n" * 2000)
    assert len(opened(path, Session).timeline) == 2000
    path.write_text("title: t\nduration: 1\ntimeline:\n" + "  - {at: 0.0, do: tap, control: reset}\n" * 2001)
    assert "expected a list of 0 to 2000" in refused(lambda: opened(path, Session))


@pytest.mark.parametrize("content", ["root:x:0:0:root:/root:/bin/sh\n", "secret\n", "key: [1, 2\n", "- a\n- b\n"])
def test_nothing_of_another_kind_of_file_is_quoted(content: str, tmp_path: Path) -> None:
    path = tmp_path / "theirs.yaml"
    path.write_text(content)
    for kind in (load_tool, load_arm):
        line = refused(lambda kind=kind: kind(path))
        assert "is another kind of file" in line
        assert not any(word in line for word in ("root", "secret", "key", "/bin"))


def test_files_that_a_session_names_stay_in_its_folder(tmp_path: Path) -> None:
    cell, outside = tmp_path / "cell", tmp_path / "outside.yaml"
    (cell / "tools").mkdir(parents=True)
    for place in (outside, cell / "tools" / "mine.yaml"):
        place.write_bytes((ASSETS / "tools" / "gripper.yaml").read_bytes())
    (cell / "link.yaml").symlink_to(outside)
    path = cell / "cell.yaml"
    for name in ("../outside.yaml", str(outside), "link.yaml"):
        path.write_text(f"robot: ur5e\ntool: {name}\n")
        assert f"cell.yaml: tool = {shown(name)}: a file in the folder of this one" in refused(lambda: opened(path, Setup))
        assert prepare(opened(path, Setup, anywhere=True), "cell.yaml").scenario.tool is not None
    for name in ("tools/mine.yaml", "./tools/mine.yaml", "gripper"):
        path.write_text(f"robot: ur5e\ntool: {name}\n")
        assert prepare(opened(path, Setup), "cell.yaml").scenario.tool is not None


def test_five_hundred_damaged_recordings_open_with_what_is_missing_or_are_refused(tmp_path: Path) -> None:
    target = next(each for each in targets() if each.name == "recording")
    whole, chance, path = target.seeds[0], Random(500), tmp_path / "log.mcap"
    path.write_bytes(whole)
    assert (read(path).missing, read(path).whole) == ("", True)
    opened_ones = told = 0
    damaged: list[str] = []
    for k in range(500):
        if k % 2:
            path.write_bytes(whole[: chance.randrange(len(whole))])
        else:
            at = chance.randrange(len(whole))
            path.write_bytes(whole[:at] + bytes([whole[at] ^ (1 + chance.randrange(255))]) + whole[at + 1 :])
        try:
            log = read(path)
        except BadInput:
            continue
        opened_ones += 1
        told += bool(log.missing)
        assert bool(log.missing) or len(log.ticks) == 500, "something is missing, and nobody says so"
        try:
            target.run(path)
        except BadInput as error:  # what is in a chunk is read when it is asked for
            damaged.append(str(error))
    assert all("is damaged" in line for line in damaged)
    assert len(damaged) < opened_ones / 2
    assert opened_ones > 50
    assert told > 50


def test_contents_that_do_not_fit_their_schema_are_refused_or_missed(tmp_path: Path) -> None:
    whole = targets()[8].seeds[0]
    path = tmp_path / "log.mcap"

    def after(*changes: tuple[str, int, Any]) -> str:
        path.write_bytes(rewrite(whole, changes))
        log = read(path)
        len(log.pictures[:])
        return log.missing

    assert after() == ""
    for topic in range(6):
        assert "it has no /" in refused(lambda topic=topic: after(("drop", topic, None)))
        assert "it has no /" in refused(lambda topic=topic: after(("rename", topic, None)))
        assert "not " in refused(lambda topic=topic: after(("type", topic, None)))
    assert after(("shorten", 6 * 100, None)) == "0.20 s of 1 s are there"
    assert "of 500 ticks of /truth" in after(("shorten", 1 + 6 * 100, None))
    assert "pictures of /pendant are not" in after(("shorten", 2 + 6 * 10, None))
    assert "/pendant: Expected" in refused(lambda: after(("value", 2, None)))
