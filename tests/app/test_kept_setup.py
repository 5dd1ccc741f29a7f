"""Set-ups as files, and what is kept over a restart."""

from dataclasses import replace as replaced
from pathlib import Path
from typing import Any

import pytest
from msgspec.structs import replace

from app.arm_import.import_files import written
from app.arm_import.importing import imported
from app.commands.command_options import as_kept, set_up
from app.files.checked import BadInput, parse
from app.files.library import load_arm, load_tool, own_arms
from app.files.taught_program import Lesson, TaughtStep
from app.kept_setup import OFTEN, Cell, CellNow, Keeper, any_cell, cell_of, handed_in, keeper_for, setup_of, text_of, usual_folder
from app.session.prepare import prepare
from app.session.session_file import FIRST_START, Session, Setup, bundled, find, opened
from pendant.all_settings import Settings, apply
from pendant.walls.definitions import Area
from pendant.walls.shapes import Box
from sim.arm.scenario import Load, table
from tests.app.arm_import.arms_of_the_test import MJCF, laid_out
from tests.items import each_of

ARM = load_arm("ur5e")
PREPARED = prepare(Setup(world="table", tool="gripper", mounting="wall", seed=4), "test")
SCENARIO = PREPARED.scenario
TABLE = tuple(table(SCENARIO))
SETTINGS = apply(Settings(), {"free_drive.period": 7.0, "contact.on": True})
WALL = Area(name="box 1", shape=Box(size=(0.4, 0.4, 0.4)), on=False)
LESSON = Lesson(steps=[TaughtStep(do="wait", seconds=2.0)], repeat=0)


def now(taught: Lesson | None = None, **changes: Any) -> CellNow:
    """A cell as it is now."""
    scenario = changes.get("scenario", SCENARIO)
    cell = CellNow(
        arm=ARM,
        scenario=scenario,
        settings=Settings(),
        walls=(),
        tools=TABLE,
        payload_true=scenario.payload_true,
        payload_configured=scenario.payload_configured,
        in_use=table(scenario)[0].name,
        taught=taught or Lesson(),
        script="",
        lines={},
    )
    return cell._replace(**changes)


def test_a_set_up_comes_back_from_its_file_as_it_was() -> None:
    setup = setup_of(ARM, SCENARIO, SETTINGS, walls=tuple(SCENARIO.walls), tools=TABLE)
    assert setup.settings == {"free_drive.period": 7.0, "contact.on": True}
    again = handed_in("setup.yaml", text_of(setup).encode(), ARM)
    assert (again.scenario, again.settings) == (PREPARED.scenario, SETTINGS)


def test_the_frames_of_tools_come_back_as_they_were_edited_and_what_is_on_the_arm_as_it_is() -> None:
    first, second, *rest = TABLE
    edited = (replace(first, tcp=[0.01, 0.0, 0.2], rpy=[0.0, 0.5, 0.0], mass=9.0), replace(second, mass=1.5), *rest)
    again = handed_in("setup.yaml", text_of(setup_of(ARM, SCENARIO, SETTINGS, walls=(), tools=edited)).encode(), ARM).scenario
    assert again.tool == replace(first, tcp=[0.01, 0.0, 0.2], rpy=[0.0, 0.5, 0.0])
    assert replace(second, mass=1.5) in again.tools
    bare = prepare(Setup(), "test").scenario
    frame = replace(table(bare)[0], tcp=[0.0, 0.0, 0.1])
    kept = setup_of(ARM, bare, SETTINGS, walls=(), tools=(frame, *table(bare)[1:]))
    assert table(prepare(kept, "test").scenario)[0] == frame


@each_of(bundled("sessions"))
def test_every_bundled_session_has_a_set_up_that_comes_back(name: str) -> None:
    prepared = prepare(opened(find(name), Session), name)
    if not prepared.arm.name.startswith("ur5e"):
        return
    scenario = prepared.scenario
    setup = setup_of(prepared.arm, scenario, prepared.settings, walls=tuple(scenario.walls), tools=tuple(table(scenario)))
    again = prepare(parse(text_of(setup), Setup, name), name)
    assert (again.scenario, again.settings) == (prepared.scenario, prepared.settings)


@pytest.mark.parametrize(
    ("content", "said"),
    [
        (b"robot: ur10e", "setup.yaml: robot = ur10e: the arm that is served, ur5e"),
        (b"robot: /etc/passwd", "setup.yaml: robot = /etc/passwd"),
        (b"tool: /etc/passwd", "setup.yaml: tool = /etc/passwd: the name of a shipped tool"),
        (b"tool: ../tools/sphere.yaml", "'../tools/sphere.yaml': the name of a shipped tool"),
        (b"settings: {free_drive.period: 1e9}", "setup.yaml: settings"),
        (b"wolrd: []", "did you mean world"),
        (b"{", "setup.yaml"),
        (b"\xff\xfe", "setup.yaml"),
    ],
)
def test_a_file_that_makes_no_sense_is_refused_in_a_line(content: bytes, said: str) -> None:
    with pytest.raises(BadInput) as refused:
        handed_in("setup.yaml", content, ARM)
    assert said in str(refused.value)
    assert "\n" not in str(refused.value)


def test_what_changes_is_written_and_read_again_and_what_does_not_is_not(tmp_path: Path) -> None:
    keeper, scenario, settings, lesson = Keeper(tmp_path / "new", "ur5e"), PREPARED.scenario, Settings(), Lesson()
    keeper.see(now(lesson, scenario=scenario, settings=settings, walls=()), now=0.0)
    keeper.see(now(lesson, scenario=scenario, settings=settings, walls=()), now=10.0)
    assert keeper.read() is None
    keeper.see(now(LESSON, scenario=scenario, settings=settings, walls=()), now=20.0)
    keeper.see(now(LESSON, scenario=scenario, settings=SETTINGS, walls=()), now=20.0 + 0.9 * OFTEN)
    kept = keeper.read()
    assert kept is not None
    assert (kept.taught, kept.setup.settings) == (LESSON, {})
    keeper.see(now(LESSON, scenario=scenario, settings=SETTINGS, walls=()), now=20.0 + OFTEN)
    kept = keeper.read()
    assert kept is not None
    assert prepare(kept.setup, "kept").settings == SETTINGS
    keeper.see(now(LESSON, scenario=scenario, settings=SETTINGS, walls=(WALL,)), now=30.0)
    kept = keeper.read()
    assert kept is not None
    assert prepare(kept.setup, "kept").scenario.walls == [WALL]
    assert [path.name for path in (tmp_path / "new").iterdir()] == ["ur5e.yaml"]


def test_what_cannot_be_written_is_said_and_not_tried_again(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    keeper = Keeper(tmp_path / "file", "ur5e")
    keeper.see(now(scenario=PREPARED.scenario, settings=SETTINGS, walls=()), now=0.0)
    keeper.see(now(LESSON, scenario=PREPARED.scenario, settings=SETTINGS, walls=()), now=5.0)
    assert "cannot be written" in keeper.problem


def test_the_next_start_begins_with_what_was_kept(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    shipped = prepare(Setup(), "serve")
    before, keeper, cell = as_kept(shipped, tmp_path)
    assert (before, cell) == (shipped, None)
    assert keeper is not None
    keeper.see(now(scenario=shipped.scenario, settings=shipped.settings, walls=()), now=0.0)
    keeper.see(now(LESSON, scenario=replace(shipped.scenario, tool=load_tool("sphere")), settings=SETTINGS), now=5.0)
    after, _, cell = as_kept(shipped, tmp_path)
    assert cell is not None
    assert (cell.taught, after.settings) == (LESSON, SETTINGS)
    assert after.scenario.tool == load_tool("sphere")
    assert f"As kept in {tmp_path}" in capsys.readouterr().out.replace("\n", "")


@pytest.mark.parametrize(
    "text", ["setup: {robot: ur5e}", "[", "setup: {seed: -1}\ntaught: {}", "setup: {robot: gone}\ntaught: {}"]
)
def test_a_kept_file_that_is_damaged_is_told_of_and_left_as_it_is(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], text: str
) -> None:
    (tmp_path / "ur5e.yaml").write_text(text)
    shipped = prepare(Setup(), "serve")
    assert as_kept(shipped, tmp_path) == (shipped, None, None)
    assert capsys.readouterr().out.startswith("Not taken, and nothing is kept: ur5e.yaml")
    assert (tmp_path / "ur5e.yaml").read_text() == text


def test_of_an_arm_from_a_file_nothing_is_kept(tmp_path: Path) -> None:
    assert keeper_for(replace(ARM, name="mine"), tmp_path) is None
    assert keeper_for(ARM, tmp_path) is not None


def test_the_cell_of_an_imported_arm_is_kept_over_a_restart(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("XDG_DATA_HOME", str(tmp_path / "data"))
    file = laid_out(tmp_path / "source", MJCF)
    found = imported(file)
    written(found, file, own_arms())
    begun = prepare(replace(FIRST_START, robot=found.arm.name), "serve")
    _, keeper, cell = as_kept(begun, tmp_path)
    assert cell is None
    assert keeper is not None
    moved = replace(begun.scenario, posture=[0.1, -0.4, 1.0])
    for clock, scenario in ((0.0, begun.scenario), (5.0, moved)):
        keeper.see(now(arm=begun.arm, scenario=scenario, tools=tuple(table(scenario))), now=clock)
    again, keeper, _ = as_kept(begun, tmp_path)
    assert again.scenario.posture == [0.1, -0.4, 1.0]
    assert again.arm == begun.arm
    assert keeper is not None
    other = written(replaced(found, arm=replace(found.arm, payload=1.0)), file, tmp_path / "elsewhere")
    assert keeper_for(load_arm(other), tmp_path) is None, "another arm of that name"
    keeper.path.unlink()
    (own_arms() / found.arm.name / f"{found.arm.name}.yaml").write_text("[")
    assert keeper_for(begun.arm, tmp_path) is None


def test_the_usual_folder_is_where_programs_keep_their_state(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path))
    assert usual_folder() == tmp_path / "pendant"
    monkeypatch.setenv("XDG_STATE_HOME", "relative")
    assert usual_folder() == Path.home() / ".local" / "state" / "pendant"


def test_a_cell_comes_back_from_its_file_with_all_of_its_parts() -> None:
    cell = cell_of(
        now(
            LESSON,
            settings=SETTINGS,
            walls=(WALL,),
            payload_true=Load(mass=2.0),
            payload_configured=Load(mass=1.5, com=[0.0, 0.0, 0.08]),
            in_use="flange",
            script="textmsg(1)",
            lines={"input 0": "part there"},
        )
    )
    empty = cell_of(now())
    again = any_cell("cell.yaml", text_of(cell).encode(), empty)
    assert again == cell
    assert again.setup.payload_configured.mass == 1.5
    assert empty != cell


def test_todays_files_of_parts_leave_the_other_parts_as_they_are() -> None:
    cell = cell_of(now(LESSON, settings=SETTINGS, script="textmsg(1)"))
    taught = any_cell("taught.yaml", text_of(Lesson()).encode(), cell)
    assert taught == replace(cell, taught=Lesson())
    setup = any_cell("setup.yaml", text_of(replace(cell.setup, seed=9)).encode(), cell)
    assert setup == replace(cell, setup=replace(cell.setup, seed=9))
    tools = any_cell("tools.yaml", b"tools: []", cell)
    assert (tools.taught, tools.setup.settings, tools.setup.tools) == (LESSON, cell.setup.settings, [])


@pytest.mark.parametrize(
    ("content", "said"),
    [
        (b"setup: {robot: ur10e}\ntaught: {}\n", "the arm that is served"),
        (b"setup: {tool: mine.yaml}\ntaught: {}\n", "tool"),
        (b"setup: {}\ntaught: {}\nin_use: gone\n", "a tool of the table"),
        (b"setup: {}\ntaught: {}\nlines: {output x: a}\n", "lines"),
        (b"waypoints: [{name: A, q: [0.0], position: [0, 0, 0], quaternion: [1, 0, 0, 0]}]\n", "6 joint angles"),
        (b"[1]", "expected a mapping"),
    ],
)
def test_a_cell_that_makes_no_sense_is_refused_in_a_line(content: bytes, said: str) -> None:
    with pytest.raises(BadInput) as refused:
        any_cell("cell.yaml", content, cell_of(now()))
    assert said in str(refused.value)
    assert "\n" not in str(refused.value)


def test_a_file_of_a_cell_is_a_configuration_too(tmp_path: Path) -> None:
    path = tmp_path / "cell.yaml"
    path.write_text(text_of(Cell(setup=Setup(seed=9), taught=LESSON)))
    assert set_up(None, path, False, "serve", shipped=Setup()).scenario.seed == 9
    path.write_text(text_of(Setup(seed=8)))
    assert set_up(None, path, False, "serve", shipped=Setup()).scenario.seed == 8
