"""The teach tab."""

from collections.abc import Callable
from typing import Any

import pytest

from app.files.taught_program import Lesson, TaughtStep
from app.web.access.takes import MAX_FILE
from app.web.scene.ghost import limbs
from app.web.server import Served
from pendant.inputs import Command
from pendant.program.steps import JointMove, ProgramState
from pendant.tick.modes import Mode
from tests.app.web.fake_loop import ARM, HOME, FakeLoop
from tests.app.web.raw_client import RawClient, until

Join = Callable[[], RawClient]


def register(served: Served, client: RawClient, count: int) -> None:
    for number in range(1, count + 1):
        client.set(served.docks.teach.register._impl.uuid, value=True)
        until(lambda number=number: len(served.docks.teach.lesson.waypoints) == number, "registered")


def upload(client: RawClient, uuid: str, content: bytes, **changes: Any) -> None:
    start = {"transfer_uuid": "t", "filename": "f.yaml", "mime_type": "text/yaml", "part_count": 1, "size_bytes": len(content)}
    client.send(**({"type": "FileTransferStartUpload", "source_component_uuid": uuid} | start | changes))
    client.send(type="FileTransferPart", source_component_uuid=uuid, transfer_uuid="t", part_index=0, content=content)


def test_waypoints_are_registered_and_run_as_a_program(served: Served, join: Join, loop: FakeLoop) -> None:
    client = join()
    teach = served.docks.teach
    register(served, client, 2)
    assert teach.choice.options == ("P1", "P2")
    until(lambda: "Move to P2" in teach.list.shown, "listed")
    client.set(teach.run._impl.uuid, value="Run")
    until(lambda: loop.advance() is None and loop.wishes[-1].inputs.program is not None, "handed over")
    inputs = loop.wishes[-1].inputs
    assert [step.q for step in inputs.program.steps if isinstance(step, JointMove)] == [pytest.approx(HOME)] * 2
    until(lambda: any(Command.START_PROGRAM in w.inputs.commands for w in loop.wishes) or loop.advance() is not None, "started")


@pytest.mark.parametrize("own", [False, True])
def test_the_step_that_runs_is_marked(loop: FakeLoop, still: Served, own: bool) -> None:
    teach = still.docks.teach
    for _ in range(3):
        teach.mark()
    if own:
        teach.lesson = teach.lesson.with_steps(
            [TaughtStep(do="joint", to="P2"), TaughtStep(do="joint", to="P2"), TaughtStep(do="joint", to="P1")]
        )
    texts = [step.text for step in teach.lesson.plan]
    teach.run.value = "Run"
    teach._run()
    loop.program = ProgramState.RUNNING
    for number in (1, 2, 3):
        loop.step = number
        teach.show(loop.latest())
        items = teach.list.shown.split("<li")[1:]
        assert [number for number, item in enumerate(items, 1) if "pd-now" in item] == [number]
        assert f"{texts[number - 1]} <em>running</em>" in items[number - 1]
    teach.lesson = teach.lesson.with_steps([TaughtStep(do="joint", to="P3")])
    teach.show(loop.latest())
    assert "pd-now" not in teach.list.shown  # the plan is another one by now
    teach.edit.value = "Go to"
    teach._edit()
    loop.step = 1
    teach.show(loop.latest())
    assert "pd-now" not in teach.list.shown  # it goes to a waypoint, and does no step of the plan


def test_a_single_step_is_marked_as_what_it_is(served: Served, join: Join, loop: FakeLoop) -> None:
    client, teach = join(), served.docks.teach
    register(served, client, 2)
    for text in ("P1", "P2", "P1"):
        loop.program, loop.step = ProgramState.STOPPED, 0
        until(lambda: "pd-now" not in teach.list.shown, "nothing runs")
        client.set(teach.run._impl.uuid, value="Step")
        until(lambda text=text: [step.to for step in teach._running] == [text], "handed over")
        loop.program, loop.step = ProgramState.RUNNING, 1
        until(lambda text=text: f'class="pd-now">Move to {text} ' in teach.list.shown, text)


def test_the_ghost_stands_at_the_chosen_waypoint(served: Served, join: Join, loop: FakeLoop) -> None:
    client = join()
    register(served, client, 1)
    assert served.docks.teach.ghost.posture is None  # the arm is there
    loop.q = HOME + 0.1
    until(lambda: served.docks.teach.ghost.posture is not None, "shown")
    assert served.docks.teach.ghost.posture == pytest.approx(tuple(HOME))
    assert served.docks.teach.ghost.text == "P1"
    client.set(served.docks.teach.edit._impl.uuid, value="✕")
    until(lambda: served.docks.teach.ghost.posture is None, "gone")


def test_the_ghost_reaches_from_the_foot_to_the_flange() -> None:
    shape = limbs(ARM, HOME.tolist())
    low, high = shape.bounds
    assert low[2] <= 0.01
    assert high[2] > 0.5


def test_a_path_is_recorded_while_the_arm_is_guided(served: Served, join: Join, loop: FakeLoop) -> None:
    client = join()
    teach = served.docks.teach
    client.set(teach.record._impl.uuid, value=True)
    until(lambda: teach.record.value, "on")
    loop.mode = Mode.FREE_DRIVE
    until(lambda: len(teach.lesson.waypoints) == 1, "the start")
    loop.q = loop.q + 0.1
    loop.advance()
    until(lambda: len(teach.lesson.waypoints) == 2, "the next")


def test_what_was_taught_is_saved_and_loaded(served: Served, join: Join) -> None:
    client = join()
    teach = served.docks.teach
    register(served, client, 2)
    content = teach.file()
    client.set(teach.edit._impl.uuid, value="✕")
    until(lambda: len(teach.lesson.waypoints) == 1, "deleted")
    upload(client, teach.load._impl.uuid, content)
    until(lambda: len(teach.lesson.waypoints) == 2, "loaded")
    upload(client, teach.load._impl.uuid, b"waypoints: <b>no</b>")
    until(lambda: "File refused" in teach.message.shown, "refused")
    assert "<b>no" not in teach.message.shown
    assert len(teach.lesson.waypoints) == 2


@pytest.mark.parametrize("changes", [{"size_bytes": MAX_FILE + 1}, {"part_count": 2}, {"part_count": 0}])
def test_a_large_file_is_refused_at_the_door(served: Served, join: Join, changes: dict[str, int]) -> None:
    client = join()
    teach = served.docks.teach
    upload(client, teach.load._impl.uuid, b"waypoints: []", **changes)
    until(lambda: served.guard.refused["not a small file"] == 1, "refused")
    upload(client, teach.save._impl.uuid, b"waypoints: []")
    until(lambda: served.guard.refused["not an upload button"] == 2, "refused")
    assert teach.lesson == Lesson()


def test_a_watcher_uploads_nothing(served: Served, join: Join) -> None:
    operator, watcher = join(), join()
    register(served, operator, 1)
    upload(watcher, served.docks.teach.load._impl.uuid, b"waypoints: []")
    until(lambda: served.guard.refused["not the operator"] == 2, "refused")
    assert len(served.docks.teach.lesson.waypoints) == 1
