"""The teach tab."""

from collections.abc import Callable
from typing import Any, get_args

import msgspec
import numpy as np
import pytest

from app.files.taught_program import Do, Lesson, TaughtStep
from app.web.access.takes import MAX_FILE
from app.web.scene.ghost import limbs
from app.web.server import Served
from app.web.tabs.step_editor import KINDS, STAY
from pendant.inputs import Command
from pendant.program.steps import JointMove, ProgramState
from pendant.tick.modes import Mode
from sim.arm.frames import joint_frames
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
    until(lambda: "Move to P2" in teach.steps.list.shown, "listed")
    client.set(served.panel.bar.run._impl.uuid, value=True)
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
        teach.edits.to(
            teach.lesson.with_steps(
                [TaughtStep(do="joint", to="P2"), TaughtStep(do="joint", to="P2"), TaughtStep(do="joint", to="P1")]
            )
        )
        teach._refresh()
    texts = [step.text for step in teach.lesson.plan]
    teach.begin()
    loop.program = ProgramState.RUNNING
    for number in (1, 2, 3):
        loop.step = number
        teach.show(loop.latest())
        items = teach.steps.list.shown.split('<div role="radio"')[1:]
        assert [number for number, item in enumerate(items, 1) if "pd-now" in item] == [number]
        assert f"{texts[number - 1]} <em>running</em>" in items[number - 1]
    teach.edits.to(teach.lesson.with_steps([TaughtStep(do="joint", to="P3")]))
    teach._refresh()
    teach.show(loop.latest())
    assert "pd-now" not in teach.steps.list.shown  # the plan is another one by now
    teach.edit.value = "Go to"
    teach._edit()
    loop.step = 1
    teach.show(loop.latest())
    assert "pd-now" not in teach.steps.list.shown  # it goes to a waypoint, and does no step of the plan


def test_a_single_step_is_marked_as_what_it_is(served: Served, join: Join, loop: FakeLoop) -> None:
    client, teach = join(), served.docks.teach
    register(served, client, 2)
    for text in ("P1", "P2", "P1"):
        loop.program, loop.step = ProgramState.STOPPED, 0
        until(lambda: "pd-now" not in teach.steps.list.shown and not teach.step.disabled, "nothing runs")
        client.set(teach.step._impl.uuid, value=True)
        until(lambda text=text: [step.to for step in teach._running] == [text], "handed over")
        loop.program, loop.step = ProgramState.RUNNING, 1
        until(lambda text=text: f". Move to {text} <em>" in teach.steps.list.shown, text)


def test_the_ghost_stands_at_the_chosen_waypoint(served: Served, join: Join, loop: FakeLoop) -> None:
    client = join()
    register(served, client, 1)
    assert served.docks.teach.ghost.posture is None  # the arm is there
    loop.q = HOME + 0.1
    until(lambda: served.docks.teach.ghost.posture is not None, "shown")
    assert served.docks.teach.ghost.posture == pytest.approx(tuple(HOME))
    assert served.docks.teach.ghost.text == "P1"
    tool = joint_frames(ARM, HOME)[-1][:3, 3]
    until(lambda: np.allclose(served.docks.teach.ghost.place, tool, atol=1e-5), "named at its tool")
    client.set(served.docks.teach.order._impl.uuid, value="✕")
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
    client.set(teach.order._impl.uuid, value="✕")
    until(lambda: len(teach.lesson.waypoints) == 1, "deleted")
    upload(client, teach.load._impl.uuid, content)
    until(lambda: len(teach.lesson.waypoints) == 2, "loaded")
    upload(client, teach.load._impl.uuid, b"waypoints: <b>no</b>")
    until(lambda: "File refused" in teach.filed.shown, "refused")
    assert "<b>no" not in teach.filed.shown
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


def press(client: RawClient, group: Any, value: str) -> None:
    client.set(group._impl.uuid, value=value)


def texts(teach: Any) -> list[str]:
    return [step.text for step in teach.lesson.plan]


def test_steps_are_inserted_changed_moved_deleted_and_all_of_it_undone(served: Served, join: Join) -> None:
    client, teach = join(), served.docks.teach
    steps = teach.steps
    register(served, client, 2)
    assert texts(teach) == ["Move to P1", "Move to P2"]
    client.set(steps.kind._impl.uuid, value="Wait")
    until(lambda: steps.fields["seconds"].visible, "its field is there")
    assert not steps.fields["way"].visible
    client.set(steps.fields["seconds"]._impl.uuid, value=2.0)
    client.set(steps.choice._impl.uuid, value="1. Move to P1")
    until(lambda: steps.kind.value == "Move to" and not steps.fields["seconds"].visible, "the fields are the chosen step's")
    client.set(steps.kind._impl.uuid, value="Wait")
    until(lambda: steps.fields["seconds"].visible, "its field is there again")
    client.set(steps.fields["seconds"]._impl.uuid, value=2.0)
    client.set(steps.when._impl.uuid, value="input 3 is high")
    press(client, steps.insert, "After")
    until(lambda: texts(teach) == ["Move to P1", "Wait 2 s if input 3 is high", "Move to P2"], "inserted after")
    assert steps.chosen == 1
    press(client, steps.order, "\u2191")
    until(lambda: texts(teach)[0].startswith("Wait"), "moved up")
    client.set(steps.kind._impl.uuid, value="Output on")
    until(lambda: steps.fields["number"].visible, "which")
    client.set(steps.fields["number"]._impl.uuid, value="5")
    client.set(steps.when._impl.uuid, value="always")
    press(client, steps.insert, "Before")
    until(lambda: texts(teach)[0] == "Output 5 on", "inserted before")
    client.set(steps.kind._impl.uuid, value="Move until contact")
    until(lambda: steps.fields["way"].visible, "where to")
    client.set(steps.fields["way"]._impl.uuid, value="Tool +Z")
    client.set(steps.fields["then"]._impl.uuid, value="Retreat")
    until(lambda: steps.fields["back"].visible, "how far")
    press(client, steps.insert, "Replace")
    until(lambda: texts(teach)[0] == "Until contact, tool +Z, 500 mm, retreat 50 mm", "changed")
    client.set(steps.kind._impl.uuid, value="Tell the user")
    until(lambda: steps.fields["says"].visible, "what")
    client.set(steps.fields["says"]._impl.uuid, value="Turn the part")
    press(client, steps.insert, "Replace")
    until(lambda: texts(teach)[0] == "Tell “Turn the part”", "changed again")
    press(client, steps.order, "\u2715")
    until(lambda: texts(teach)[0].startswith("Wait"), "deleted")
    press(client, steps.history, "Clear")
    until(lambda: texts(teach) == [], "empty, and stays so")
    for count in (3, 4, 4, 4, 3):
        press(client, steps.history, "Undo")
        until(lambda count=count: len(texts(teach)) == count, f"{count} steps")
    press(client, steps.history, "Redo")
    until(lambda: len(texts(teach)) == 4, "again")


def test_a_loop_is_switched_on_and_off_and_the_count_is_kept(served: Served, join: Join) -> None:
    client, teach = join(), served.docks.teach
    steps = teach.steps
    client.set(steps.repeat._impl.uuid, value=3)
    until(lambda: teach.lesson.repeat == 3, "three times")
    client.set(steps.loop._impl.uuid, value=True)
    until(lambda: teach.lesson.repeat == 0 and steps.repeat.disabled, "it loops")
    client.set(steps.loop._impl.uuid, value=False)
    until(lambda: teach.lesson.repeat == 3 and not steps.repeat.disabled, "three times again")


def test_a_program_that_repeats_is_handed_over_and_one_that_takes_no_time_is_not(loop: FakeLoop, still: Served) -> None:
    teach = still.docks.teach
    teach.mark()
    teach.edits.to(msgspec.structs.replace(teach.lesson, repeat=0))
    teach.begin()
    loop.advance()
    assert loop.wishes[-1].inputs.program.repeat == 0
    teach.edits.to(teach.lesson.with_steps([TaughtStep(do="output on")]))
    teach.begin()
    assert "needs a step that takes time" in teach.message.shown


def test_a_waypoint_is_taught_again_where_the_arm_is(loop: FakeLoop, still: Served) -> None:
    teach = still.docks.teach
    teach.mark()
    loop.q = HOME + 0.2
    teach.edit.value = "Re-teach"
    teach._edit()
    assert teach.lesson.find("P1").q == pytest.approx((HOME + 0.2).tolist(), abs=1e-6)
    loop.mode, loop.q = Mode.RUN, HOME + 0.4
    teach._edit()
    assert teach.lesson.find("P1").q == pytest.approx((HOME + 0.2).tolist(), abs=1e-6)


def test_every_kind_of_step_can_be_chosen() -> None:
    assert set(KINDS.values()) | {"touch"} == set(get_args(Do))


def test_the_chosen_step_is_moved_to_the_place_that_a_drag_asks_for(served: Served, join: Join) -> None:
    client, teach = join(), served.docks.teach
    register(served, client, 4)
    for chosen, place, order in ((0, 3, "P2 P3 P1 P4"), (3, 1, "P4 P2 P3 P1"), (1, 2, "P4 P2 P3 P1")):
        client.set(teach.steps.choice._impl.uuid, value=teach.steps.choice.options[chosen])
        until(lambda chosen=chosen: teach.steps.chosen == chosen, "chosen")
        client.set(teach.steps.place._impl.uuid, value=f"to place {place}")
        until(lambda order=order: " ".join(str(step.to) for step in teach.lesson.plan) == order, order)
        until(lambda place=place: teach.steps.choice.value.startswith(f"{place}. "), "still chosen")
        assert teach.steps.place.value == STAY
