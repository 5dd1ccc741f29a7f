"""The user's cell: whatever is done, saving and loading give back what was there, and a scenario takes nothing away."""

import random
from collections.abc import Callable
from concurrent.futures import Future
from pathlib import Path
from typing import Any

import pytest
from msgspec.structs import replace

import app.web.cell.work_cell as module
from app.files.library import load_tool
from app.files.taught_program import Lesson, TaughtStep
from app.kept_setup import Cell, Keeper, any_cell, check_cell
from app.robot_interface.controller.callers import at_once
from app.session.prepare import Prepared, prepare
from app.session.session_file import Setup
from app.web.cell.work_cell import WorkCell
from pendant.all_settings import Settings, apply
from pendant.tick.modes import Law, Mode
from pendant.tooling.tool_in_use import Fitting
from pendant.walls.definitions import Area
from pendant.walls.shapes import Box, Sphere
from sim.arm.scenario import Load, table
from sim.plant.changes import AttachPayload
from tests.app.web.fake_loop import FakeLoop

SCENARIOS = [
    Setup(world="table", payload_true=Load(mass=3.0), settings={"free_drive.period": 4.0}, seed=5),
    Setup(tool="gripper"),
]


class Obedient(FakeLoop):
    """Does what the desk asks for, as the robot does where nothing is locked."""

    def __init__(self, prepared: Prepared) -> None:
        super().__init__()
        self.start(prepared)

    def start(self, prepared: Prepared | None = None) -> None:
        if prepared is None:
            return
        scenario = self.scenario = prepared.scenario
        self.settings, self.table, self.borders = prepared.settings, (), None
        self.true = scenario.payload_true
        self.fitting = Fitting(0, table(scenario)[0], scenario.payload_configured)

    @property
    def payload_true(self) -> Load:
        return self.true

    def begin(self, make: Any, write: Any = None) -> "Future[None]":
        self.begun.append((make, write))
        self.start(make())
        self.desk.clear()
        return at_once(lambda: None)

    def obey(self) -> None:
        """One tick."""
        self.advance()
        inputs, changes = self.wishes[-1].inputs, self.wishes[-1].changes
        self.settings = apply(self.settings, dict(inputs.settings))
        fitting = self.fitting
        assert fitting is not None
        if inputs.tools:
            self.table = inputs.tools
            fitting = fitting._replace(tool=next((t for t in self.tools if t.name == fitting.tool.name), self.tools[0]))
        if inputs.tool:
            fitting = fitting._replace(tool=next(tool for tool in self.tools if tool.name == inputs.tool))
        if inputs.load is not None:
            fitting = fitting._replace(load=inputs.load)
        if inputs.borders is not None:
            self.borders = inputs.borders
        self.fitting = fitting
        for change in changes:
            if isinstance(change, AttachPayload):
                self.true = change.load


class Desktop:
    """What is on the page alone."""

    def __init__(self) -> None:
        self.lesson, self.text = Lesson(), ""

    def taught(self) -> Lesson:
        return self.lesson

    def script(self) -> str:
        return self.text

    def show(self, taught: Lesson, script: str) -> None:
        self.lesson, self.text = taught, script


class Stage:
    """A cell that is worked on, without a page; its clock passes a second with each action."""

    def __init__(self, folder: Path) -> None:
        self.folder, self.time = folder, 0.0
        self.cells: dict[str, Cell] = {}
        self.open("ur5e")

    def open(self, arm: str) -> None:
        """As a server that starts with this arm, or a page that goes over to it."""
        keeper = Keeper(self.folder, arm)
        kept = keeper.read()
        self.prepared = prepare(Setup(robot=arm), "test") if kept is None else check_cell(kept, "test")
        self.loop, self.desktop = Obedient(self.prepared), Desktop()
        self.work = WorkCell(self.loop, self.prepared.arm, self.desktop, keeper, clock=lambda: self.time)
        if kept is not None:
            self.work.begin_with(kept)
        self.settle()

    def settle(self) -> None:
        for _ in range(3):
            self.time += 1.0
            self.loop.obey()
            self.work.see()

    def play(self, number: int = 0) -> None:
        """A scenario of the laboratory, as its tab begins it."""
        self.work.lend()
        prepared = prepare(replace(SCENARIOS[number % len(SCENARIOS)], robot=self.prepared.arm.name), "scenario")
        self.loop.begin(lambda: prepared)  # type: ignore[arg-type, return-value]
        self.settle()


@pytest.fixture
def stage(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Stage:
    monkeypatch.setattr(module, "simulate", lambda prepared: prepared)
    return Stage(tmp_path)


def changes(stage: Stage, draw: random.Random) -> list[Callable[[], object]]:
    """What a user may change of the cell."""
    loop, desk = stage.loop, stage.loop.desk
    size = draw.choice([0.2, 0.3, 0.4])
    walls = [Area(name=f"area {draw.randrange(3)}", shape=draw.choice([Sphere(radius=size), Box(size=(size, size, size))]))]
    tool = replace(load_tool("sphere"), name=draw.choice(["mine", "other"]), mass=round(draw.uniform(0.1, 2.0), 3))
    tables = tuple({each.name: each for each in (*loop.tools, tool)}.values())
    load = Load(mass=round(draw.uniform(0.0, 3.0), 2), com=[0.0, 0.0, round(draw.uniform(0.0, 0.1), 3)])
    steps = [TaughtStep(do="wait", seconds=draw.choice([1.0, 2.0])), TaughtStep(do="output on", number=draw.randrange(8))]
    return [
        lambda: desk.set({"free_drive.period": round(draw.uniform(1.0, 9.0), 2)}),
        lambda: desk.set({"contact.on": draw.random() < 0.5}),
        lambda: desk.fence(tuple(walls)),
        lambda: desk.fence(()),
        lambda: desk.tabulate(tables),
        lambda: desk.tabulate(tuple(each for each in loop.tools if each.name != "sphere") or loop.tools),
        lambda: desk.choose(draw.choice(loop.tools).name),
        lambda: desk.configure(load),
        lambda: desk.change(AttachPayload(load=load)),
        lambda: setattr(stage.desktop, "lesson", Lesson(steps=steps)),
        lambda: setattr(stage.desktop, "text", draw.choice(["", "textmsg(1)\n", 'x = "ä"'])),
        lambda: setattr(stage.work, "lines", {f"output {draw.randrange(8)}": "lamp"}),
        lambda: loop.begin(lambda: prepare(replace(stage.work.mine().setup, mounting="ceiling"), "set-up")),
    ]


@pytest.mark.parametrize("seed", range(4))
def test_2000_actions_never_lose_the_cell(stage: Stage, seed: int) -> None:
    """500 for each seed: changes, files, scenarios, other arms, undo, redo, start over, restarts of the server."""
    draw, folder = random.Random(67 + seed), stage.folder
    for _ in range(500):
        work, before = stage.work, stage.work.mine()
        kind = draw.choice(["change"] * 6 + ["load", "scenario", "back", "adopt", "undo", "redo", "over", "restart", "arm"])
        if kind == "change":
            draw.choice(changes(stage, draw))()
        elif kind == "load":
            assert work.try_file("cell.yaml", work.file()) == ""
            stage.settle()
            assert (stage.work.mine(), stage.work.lent) == (before, None)
        elif kind == "scenario":
            stage.play(draw.randrange(2))
            assert stage.work.mine() == before
        elif kind == "back":
            work.give_back()
            stage.settle()
            assert stage.work.mine() == before
        elif kind == "adopt":
            work.adopt()
        elif kind in ("undo", "redo") and work.lent is None:
            again = kind == "redo"
            could = work.redoes if again else work.undoes
            work.undo(again)
            stage.settle()
            if could:
                stage.work.undo(not again)
                stage.settle()
            assert stage.work.mine() == before
        elif kind == "over":
            work.start_over()
            stage.settle()
            assert stage.work.mine() == before
        elif kind == "restart":
            work.see(now=float("inf"))
            stage.open(stage.prepared.arm.name)
            assert stage.work.mine() == before
        elif kind == "arm":
            name = stage.prepared.arm.name
            work.see(now=float("inf"))
            stage.open("ur10e" if name == "ur5e" else "ur5e")
            stage.open(name)
            assert stage.work.mine() == before
        stage.settle()
        cell = stage.work.mine()
        assert any_cell("cell.yaml", stage.work.file(), cell) == cell, kind
        kept = Keeper(folder, stage.prepared.arm.name).read()
        assert kept is None or stage.work.lent is not None or kept == cell, kind


def test_a_scenario_changes_nothing_that_is_kept_and_the_cell_comes_back(stage: Stage) -> None:
    stage.loop.desk.set({"free_drive.period": 7.0})
    stage.loop.desk.configure(Load(mass=2.0))
    stage.settle()
    before = stage.work.mine()
    stage.play()
    stage.loop.desk.fence((Area(name="of the scenario", shape=Sphere(radius=0.2)),))
    stage.settle()
    assert (stage.work.mine(), Keeper(stage.folder, "ur5e").read()) == (before, before)
    stage.work.give_back()
    stage.settle()
    assert stage.work.mine() == before
    assert (stage.loop.settings.free_drive.period, stage.loop.walls) == (7.0, ())


def test_a_scenario_is_kept_where_that_is_asked_for_and_can_be_undone(stage: Stage) -> None:
    before = stage.work.mine()
    stage.play()
    stage.work.adopt()
    stage.settle()
    assert stage.work.mine().setup.payload_true == Load(mass=3.0)
    assert stage.work.asks() == "The arm goes to its start for this"
    stage.work.undo()
    stage.settle()
    assert stage.work.mine() == before


def test_an_undo_goes_back_step_by_step_and_forth_again(stage: Stage) -> None:
    found = [stage.work.mine()]
    for act in (
        lambda: stage.loop.desk.set({"free_drive.period": 7.0}),
        lambda: stage.loop.desk.configure(Load(mass=1.0)),
        lambda: setattr(stage.desktop, "lesson", Lesson(steps=[TaughtStep(do="wait")])),
    ):
        act()
        stage.settle()
        found.append(stage.work.mine())
    for cell in reversed(found[:-1]):
        assert stage.work.asks() == ""
        stage.work.undo()
        stage.settle()
        assert stage.work.mine() == cell
    assert not stage.work.undoes
    for cell in found[1:]:
        stage.work.undo(again=True)
        stage.settle()
        assert stage.work.mine() == cell
    assert stage.loop.begun == [], "nothing of it needed another beginning"


def test_an_undo_that_would_stop_a_running_arm_asks(stage: Stage) -> None:
    stage.loop.desk.set({"free_drive.period": 7.0})
    stage.settle()
    stage.loop.mode, stage.loop.law = Mode.RUN, Law.FOLLOW
    assert stage.work.asks() == "This stops the arm and begins again"
    stage.work.undo()
    assert len(stage.loop.begun) == 1
    assert stage.loop.settings == Settings()


def test_a_file_that_is_no_cell_changes_nothing(stage: Stage) -> None:
    before = stage.work.mine()
    for content in (b"[", b"setup: {robot: ur10e}", b"\xff\xfe", b"setup: {}\ntaught: 3"):
        assert stage.work.try_file("cell.yaml", content)
        stage.settle()
        assert stage.work.mine() == before
    assert stage.loop.begun == []
