from pathlib import Path
from typing import Any

import msgspec
import numpy as np
import pytest

from app.files.checked import BadInput, convert, load, parse
from app.session.prepare import MOUNTINGS, prepare
from app.session.session_file import FIRST_START, Session, Setup, bundled, find, folder
from benchmarks.hold import ARMS
from sim.arm.scenario import table
from sim.plant.true_arm import Plant
from tests.items import each_of

LEAST: dict[str, Any] = {"title": "least", "duration": 2.0}


def made(**fields: Any) -> Session:
    return convert({**LEAST, **fields}, Session, "s.yaml")


def refusal(**fields: Any) -> str:
    with pytest.raises(BadInput) as caught:
        prepare(made(**fields), "s.yaml")
    return str(caught.value)


def test_the_least_session_is_the_default_arm_at_home() -> None:
    prepared = prepare(made(), "s.yaml")
    assert prepared.arm.name == "ur5e"
    assert prepared.scenario.mounting == [0.0, 0.0, 0.0]
    assert (prepared.scenario.posture, prepared.scenario.seed, prepared.scenario.mismatch) == (None, 0, "on")


def test_a_files_tools_come_first_and_win_over_those_shipped() -> None:
    mine = {"name": "sphere", "mass": 0.7, "com": [0, 0, 0], "tcp": [0, 0, 0.2], "rpy": [0, 0, 1.57]}
    nail = {"name": "nail", "mass": 0.1, "com": [0, 0, 0], "tcp": [0, 0, 0.1]}
    scenario = prepare(made(tools=[mine, nail]), "s.yaml").scenario
    assert [(tool.name, tool.mass) for tool in table(scenario)] == [
        ("flange", 0.0),
        ("sphere", 0.7),
        ("nail", 0.1),
        ("gripper", 0.925),
        ("two-finger", 0.925),
        ("vacuum-cup", 0.35),
    ]


def test_a_whole_header_reaches_the_scenario() -> None:
    prepared = prepare(
        made(
            robot="ur10e",
            mounting="ceiling",
            posture=[0.1] * 6,
            tool="gripper",
            payload_true={"mass": 2.0},
            payload_configured={"mass": 1.0, "com": [0.0, 0.0, 0.1]},
            settings={"free_drive.period": 5},
            seed=7,
            mismatch="nominal",
            world="table",
            program={"steps": [{"kind": "wait", "duration": 1.0}]},
        ),
        "s.yaml",
    )
    scenario = prepared.scenario
    assert (prepared.arm.name, scenario.mounting, scenario.posture) == ("ur10e", MOUNTINGS["ceiling"], [0.1] * 6)
    assert (scenario.payload_true.mass, scenario.payload_configured.com, scenario.seed) == (2.0, [0.0, 0.0, 0.1], 7)
    assert scenario.tool is not None
    assert scenario.tool.name == "gripper"
    assert [thing.name for thing in scenario.world] == ["floor", "table"]
    assert [tool.name for tool in table(scenario)] == ["gripper", "flange", "sphere", "two-finger", "vacuum-cup"]
    assert prepared.settings.free_drive.period == 5.0
    assert prepared.program is not None


@pytest.mark.parametrize(
    ("fields", "says"),
    [
        ({"robot": "ur6"}, "s.yaml: robot = ur6: expected one of"),
        ({"posture": [0.0] * 5}, "s.yaml: posture = [0.0, 0.0, 0.0, 0.0, 0.0]: 6 joint angles, base to wrist_3"),
        ({"posture": [0.0, 9.0, 0.0, 0.0, 0.0, 0.0]}, "posture[1] = 9.0: -6.28319 .. 6.28319 rad (shoulder of ur5e)"),
        ({"settings": {"free_drive.periode": 1}}, "settings.free_drive.periode"),
        ({"settings": {"free_drive.period": 99}}, "settings.free_drive.period = 99.0: a number from 0.5 to 30 s"),
        ({"features": {"FD-4": "off"}}, "features.FD-4: has no switch; these have: "),
        ({"features": {"FD-99": "off"}}, "features = FD-99: the id of a requirement"),
        ({"features": {"XX-1": "on"}}, "features = XX-1: the id of a requirement"),
        (
            {"timeline": [{"at": 0.5, "do": "jog", "for": 0.2, "move": {"kind": "jog", "frame": "joint", "axis": 6, "sign": 1}}]},
            "s.yaml: timeline[0].move: axis 6, allowed: 0 .. 5",
        ),
        ({"world": "kitchen"}, "world = kitchen: a list of objects, or one of table, workshop"),
        (
            {"world": [{"kind": "box", "name": "a", "position": [0, 0, 0], "size": [1, 0, 1]}]},
            "world[0].size[1] = 0: expected a number >= 0.001 and <= 20",
        ),
        (
            {"world": [{"kind": "plane", "name": "a", "position": [0, 0, 0]}] * 2},
            "world[1].name = a: each object needs a name of its own",
        ),
        ({"payload_true": {"mass": 50.1}}, "payload_true.mass = 50.1: 0 .. 50 kg for the ur5e"),
        ({"payload_configured": {"mass": 1, "com": [0, 0, 2]}}, "payload_configured.com[2] = 2.0: -1 .. 1 m"),
        (
            {"timeline": [{"at": 0, "do": "change", "change": {"kind": "attach_payload", "load": {"mass": 99}}}]},
            "timeline[0].change.load.mass = 99.0: 0 .. 50 kg",
        ),
        (
            {"tools": [{"name": "a", "mass": 60, "com": [0, 0, 0], "tcp": [0, 0, 0]}]},
            "s.yaml: tools[0].mass = 60.0: 0 .. 50 kg for the ur5e",
        ),
        (
            {"tools": [{"name": "a", "mass": 1, "com": [0, 0, 0], "tcp": [0, 0, 0]}] * 2},
            "s.yaml: tools[1].name = a: each tool needs a name of its own",
        ),
        (
            {"tools": [{"name": "a", "mass": 1, "com": [0, 0, 0], "tcp": [0, 9, 0]}]},
            "s.yaml: tools[0].tcp[1] = 9.0: -1 .. 1 m",
        ),
        (
            {"tool": {"name": "a", "mass": 1, "com": [0, 0, 0], "tcp": [0, 0, 0], "rpy": [0, 0, 8]}},
            "s.yaml: tool.rpy[2] = 8.0: -7 .. 7 rad",
        ),
        (
            {"timeline": [{"at": 0, "do": "select_tool", "tool": "hammer"}]},
            "s.yaml: timeline[0].tool = hammer: one of flange, gripper, sphere, two-finger, vacuum-cup",
        ),
        (
            {"timeline": [{"at": 0, "do": "payload", "load": {"mass": 51}}]},
            "s.yaml: timeline[0].load.mass = 51.0: 0 .. 50 kg for the ur5e",
        ),
        ({"payload_true": {"mass": 1, "inertia": [1, 2]}}, "payload_true.inertia = [1, 2]: expected a list of 6"),
        ({"payload_true": {"mass": 1, "inertia": [1, 1, 3, 0, 0, 0]}}, "payload_true.inertia"),
        ({"program": {"steps": [{"kind": "joint", "q": [0.0]}]}}, "s.yaml: program"),
        ({"timeline": [{"at": 2.0, "do": "tap", "control": "reset"}]}, "timeline[0].at = 2.0: below the duration, 2 s"),
        (
            {"timeline": [{"at": 0, "do": "bump", "for": 0.1, "part": "knee", "force": [1, 0, 0]}]},
            "timeline[0].part = knee: one of foot, base,",
        ),
        (
            {"timeline": [{"at": 0, "do": "program", "command": "start"}]},
            "timeline[0].do = program: needs a `program:` in the header",
        ),
        ({"timeline": [{"at": 0, "do": "settings", "set": {"a.b": 1}}]}, "timeline[0].set.a.b"),
        (
            {"timeline": [{"at": 0, "do": "change", "change": {"kind": "friction", "joint": "knee", "factor": 2}}]},
            "timeline[0].change.joint = knee: one of base,",
        ),
        (
            {"timeline": [{"at": 0, "do": "change", "change": {"kind": "move_object", "name": "pad", "position": [0, 0, 0]}}]},
            "timeline[0].change.name = pad: there is none in this session",
        ),
        (
            {"timeline": [{"at": 0, "do": "change", "change": {"kind": "sensor", "sensor": "gyro", "channel": 3}}]},
            "timeline[0].change.channel = 3: 0 .. 2 for gyro",
        ),
        ({"timeline": [{"at": 0, "do": "gripper", "command": "close"}]}, "timeline[0].do = gripper: needs a tool with a gripper"),
        (
            {"tool": "vacuum-cup", "timeline": [{"at": 0, "do": "gripper", "command": "close", "force": 50}]},
            "timeline[0].force = 50.0: force is of fingers; a cup draws, or does not",
        ),
        (
            {"tool": "vacuum-cup", "timeline": [{"at": 0, "do": "change", "change": {"kind": "gripper", "speed_share": 0}}]},
            "timeline[0].change.speed_share = 0.0: speed_share is of fingers",
        ),
        (
            {"expectations": [{"expect": "state", "mode": "TEACH", "at": 3}]},
            "expectations[0].at = 3.0: at most the duration, 2 s",
        ),
        ({"expectations": [{"expect": "displacement", "part": "knee", "max": 1}]}, "expectations[0].part = knee"),
        ({"expectations": [{"expect": "value", "of": "joint_angle", "joint": "knee", "max": 1}]}, "expectations[0].joint = knee"),
    ],
)
def test_what_does_not_fit_is_refused_by_field(fields: dict[str, Any], says: str) -> None:
    assert says in refusal(**fields)


@pytest.mark.parametrize(
    ("fields", "says"),
    [
        ({"timeline": [{"do": "tap", "control": "reset"}]}, "needs either `at: SECONDS` or `after:"),
        ({"timeline": [{"at": 1, "after": "mode RUN", "do": "tap", "control": "reset"}]}, "and not both"),
        ({"timeline": [{"at": 1, "delay": 1, "do": "tap", "control": "reset"}]}, "delay belongs to `after`"),
        ({"timeline": [{"at": 1, "nth": 2, "do": "tap", "control": "reset"}]}, "nth counts what `after` names"),
        (
            {"timeline": [{"after": "mode FREEDRIVE", "do": "tap", "control": "reset"}]},
            '"FREEDRIVE" is no mode; known: NORMAL, TEACH',
        ),
        ({"timeline": [{"after": "event nothing", "do": "tap", "control": "reset"}]}, '"nothing" is no event'),
        ({"timeline": [{"at": 1, "do": "press", "control": "emergency_stop"}]}, "acts once, so it is used with `do: tap`"),
        ({"timeline": [{"at": -1, "do": "tap", "control": "reset"}]}, "timeline[0].at = -1"),
        ({"timeline": [{"at": 1, "do": "push", "for": 0, "force": [1, 0, 0]}]}, "timeline[0].for = 0"),
        ({"timeline": [{"at": 1, "do": "push", "for": 1, "force": [2001, 0, 0]}]}, "timeline[0].force[0] = 2001"),
        ({"timeline": [{"at": 1, "do": "twist", "for": 1, "torque": [0, 0, -501]}]}, "timeline[0].torque[2] = -501"),
        ({"expectations": [{"expect": "state", "at": 1}]}, "needs one or more of mode, phase, safety"),
        ({"expectations": [{"expect": "state", "mode": "RUN"}]}, "needs one of `at: SECONDS`"),
        ({"expectations": [{"expect": "value", "of": "tcp_speed"}]}, "needs min, max, or both"),
        ({"expectations": [{"expect": "value", "of": "tcp_speed", "min": 2, "max": 1}]}, "min = 2.0 must not be above max = 1.0"),
        ({"expectations": [{"expect": "value", "of": "joint_speed", "max": 1}]}, "joint goes with joint_angle and joint_speed"),
        ({"expectations": [{"expect": "displacement", "from": 2, "to": 1, "max": 1}]}, "to = 1.0 must come after from = 2.0"),
        ({"expectations": [{"expect": "displacement", "along": [0, 0, 0], "max": 1}]}, "is no direction"),
        ({"expectations": [{"expect": "event", "kind": "nothing"}]}, "expectations[0].kind = nothing"),
        (
            {"expectations": [{"expect": "event", "kind": "entered", "values": {"parameter": "flange speed"}}]},
            "values: entered carries no parameter; it carries from, gain",
        ),
        ({"seed": -1}, "seed = -1"),
        ({"duration": 0}, "duration = 0"),
        ({"mismatch": "off"}, "mismatch = off"),
        ({"mismatch": 3.1}, "mismatch = 3.1"),
        ({"mismatch": 0.0}, "mismatch = 0.0"),
    ],
)
def test_what_the_schema_forbids_is_refused_in_one_line(fields: dict[str, Any], says: str) -> None:
    with pytest.raises(BadInput) as caught:
        made(**fields)
    assert says in str(caught.value)
    assert str(caught.value).startswith("s.yaml: ")
    assert "\n" not in str(caught.value)


LASTS = {"payload-by-itself": 42.0, "contact-3-compared": 17.0, "contact-4-compared": 17.0, "contact-directions": 14.0}
"""Sessions that cannot be short [s]: the wrist goes through six postures, there and back, and stands in each; one
rule after the other is held against a push below and one above its limit; a program waits until the arm has stopped swinging."""


@each_of(bundled("sessions"))
def test_every_bundled_session_is_valid_and_can_fail(name: str) -> None:
    session = load(find(name), Session)
    prepare(session, name)
    assert session.duration <= LASTS.get(name, 12.0)
    assert session.expectations


@each_of(bundled("worlds"))
def test_every_bundled_world_is_valid(name: str) -> None:
    assert prepare(convert({"world": name}, Setup, "w.yaml"), "w.yaml").scenario.world


def test_the_three_sessions_are_there() -> None:
    assert {"free-drive", "hold", "program"} <= set(bundled("sessions"))


def test_a_file_goes_before_a_bundled_name(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    assert find("hold") == folder("sessions") / "hold.yaml"
    (tmp_path / "hold").write_text("title: mine\nduration: 1.0\n")
    monkeypatch.chdir(tmp_path)
    assert load(find("hold"), Session).title == "mine"


def test_a_missing_session_names_the_bundled_ones() -> None:
    with pytest.raises(BadInput, match=r"nowhere\.yaml.*bundled sessions: .*free-drive"):
        find("nowhere.yaml")


def test_the_example_of_the_tools_page_is_a_session() -> None:
    page = (Path(__file__).parents[3] / "docs" / "guide" / "tools.md").read_text(encoding="utf-8")
    example = page.split("```yaml\n")[1].split("```")[0]
    session = parse("title: example\nduration: 4.0\n" + example, Session, "tools.md")
    prepared = prepare(session, "tools.md")
    assert [tool.name for tool in table(prepared.scenario)] == [
        "gripper",
        "long gripper",
        "flange",
        "sphere",
        "two-finger",
        "vacuum-cup",
    ]
    assert len(session.timeline) == 2


@pytest.mark.parametrize("robot", ARMS)
def test_the_page_begins_with_an_arm_that_may_touch_itself_and_does_not(robot: str) -> None:
    """CD-2: as shipped, each arm."""
    prepared = prepare(msgspec.structs.replace(FIRST_START, robot=robot), "the page")
    plant = Plant(prepared.arm, prepared.scenario)
    assert sum(plant.model.pair(k).name.startswith("itself ") for k in range(plant.model.npair)) == 9
    plant.advance(np.zeros(prepared.arm.n))
    assert plant.data.ncon == 0
