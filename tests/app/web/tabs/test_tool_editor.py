"""The table of tools, edited on the page."""

from collections.abc import Callable
from typing import Any

import msgspec
import pytest
import yaml

from app.files.library import load_tool
from app.session.prepare import prepare
from app.session.session_file import Setup
from app.web.server import Served
from app.web.tabs.tool_editor import ToolEditor
from pendant.equipment.tools import Tool
from pendant.tick.modes import Mode
from pendant.tooling.tool_in_use import Fitting
from sim.arm.scenario import Load, Scenario
from tests.app.web.fake_loop import FakeLoop
from tests.app.web.raw_client import RawClient, until
from tests.app.web.tabs.test_teach_tab import upload

Join = Callable[[], RawClient]
GRIPPER, SPHERE = load_tool("gripper"), load_tool("sphere")
TURNED = msgspec.structs.replace(SPHERE, name="turned", rpy=[0.1, 0.2, 0.3], inertia=[1e-3, 2e-3, 2.5e-3, 1e-5, 0.0, 0.0])


@pytest.fixture
def editor(served: Served, loop: FakeLoop) -> ToolEditor:
    """The editor, with the gripper in use and chosen."""
    loop.scenario = Scenario(tool=GRIPPER, tools=[SPHERE, TURNED])
    loop.fitting = Fitting(1, GRIPPER, Load(mass=0.0), 1.0, 0.0)
    editor = served.docks.tools.editor
    until(lambda: "gripper, 0.925 kg" in served.docks.tools.now.shown, "in use")
    until(lambda: editor.name.value == "gripper", "the form")
    return editor


def wish(loop: FakeLoop) -> tuple[Tool, ...]:
    """The table that was asked for."""
    until(lambda: loop.advance() is None and loop.wishes[-1].inputs.tools != (), "the wish")
    return loop.wishes[-1].inputs.tools


def enter(client: RawClient, control: Any, value: Any) -> None:
    client.set(control._impl.uuid, value=value)
    until(lambda: control.value == value, "entered")


def test_the_form_says_what_the_table_does_of_the_tool_chosen(served: Served, join: Join, editor: ToolEditor) -> None:
    client = join()
    assert (editor.mass.value, editor.com.value, editor.tcp.value) == (0.925, (0.0, 0.0, 58.0), (0.0, 0.0, 163.0))
    assert (editor.known.value, editor.moments.visible) == (False, False)
    enter(client, served.docks.tools.tool, "turned")
    until(lambda: editor.products.visible, "another tool")
    assert editor.rpy.value == pytest.approx((5.73, 11.46, 17.19))
    assert (editor.moments.value, editor.products.value) == ((10.0, 20.0, 25.0), (0.1, 0.0, 0.0))
    assert editor.entered() == TURNED, "what was not touched is as it was"


def test_a_tool_is_added_and_chosen_then(served: Served, join: Join, loop: FakeLoop, editor: ToolEditor) -> None:
    client = join()
    enter(client, editor.name, " hook ")
    enter(client, editor.tcp, (1.0, 0.0, 250.0))
    client.set(editor.change._impl.uuid, value="Save as new")
    hook = msgspec.structs.replace(GRIPPER, name="hook", tcp=[0.001, 0.0, 0.25])
    assert wish(loop) == (GRIPPER, SPHERE, TURNED, hook)
    assert served.docks.tools.tool.value == "gripper", "nobody took it yet"
    loop.table = (GRIPPER, SPHERE, TURNED, hook)
    until(lambda: served.docks.tools.tool.value == "hook", "chosen")
    assert served.docks.tools.tool.options == ("gripper", "sphere", "turned", "hook")


def test_a_tool_is_changed_as_one(join: Join, loop: FakeLoop, editor: ToolEditor) -> None:
    client = join()
    enter(client, editor.mass, 1.25)
    enter(client, editor.com, (0.0, 5.0, 60.0))
    enter(client, editor.known, True)
    enter(client, editor.moments, (12.0, 12.0, 9.0))
    enter(client, editor.products, (0.0, 0.5, 0.0))
    client.set(editor.change._impl.uuid, value="Change this")
    until(lambda: editor.yes.visible, "it asks: the tool is in use")
    client.set(editor.yes._impl.uuid, value=True)
    inertia = [1.2e-3, 1.2e-3, 9e-4, 0.0, 5e-5, 0.0]
    changed, *rest = wish(loop)
    assert rest == [SPHERE, TURNED]
    assert changed.inertia == pytest.approx(inertia)
    assert msgspec.structs.replace(changed, inertia=None) == msgspec.structs.replace(GRIPPER, mass=1.25, com=[0.0, 0.005, 0.06])


def test_a_tool_is_deleted(served: Served, join: Join, loop: FakeLoop, editor: ToolEditor) -> None:
    client = join()
    enter(client, served.docks.tools.tool, "sphere")
    until(lambda: editor.name.value == "sphere", "the form")
    client.set(editor.change._impl.uuid, value="✕")
    assert wish(loop) == (GRIPPER, TURNED)
    loop.table = (GRIPPER, TURNED)
    until(lambda: served.docks.tools.tool.value == "gripper", "another one is chosen")
    until(lambda: editor.name.value == "gripper", "the form")


def test_it_is_locked_as_the_limits_are(served: Served, join: Join, loop: FakeLoop, editor: ToolEditor) -> None:
    client = join()
    loop.mode = Mode.FREE_DRIVE
    until(lambda: editor.load.disabled and not editor.change.visible, "locked")
    client.set(editor.change._impl.uuid, value="✕")
    until(lambda: served.guard.refused["disabled control"] == 1, "refused")


def test_a_watcher_edits_nothing(served: Served, join: Join, loop: FakeLoop, editor: ToolEditor) -> None:
    operator, watcher = join(), join()
    operator.set(editor.mass._impl.uuid, value=1.0)
    until(lambda: served.guard.operator.holder is not None, "somebody has control")
    watcher.set(editor.change._impl.uuid, value="✕")
    until(lambda: served.guard.refused["not the operator"] == 1, "refused")
    loop.advance()
    assert all(wish.inputs.tools == () for wish in loop.wishes)


def test_the_table_is_saved_as_a_file_that_serve_takes_and_loaded_again(join: Join, loop: FakeLoop, editor: ToolEditor) -> None:
    content = editor.file()
    prepared = prepare(msgspec.convert(yaml.safe_load(content), Setup), "tools.yaml")
    assert prepared.scenario.tools[:3] == [GRIPPER, SPHERE, TURNED]
    longer = content.replace(b"0.163", b"0.2")
    loop.table = (SPHERE, GRIPPER)
    client = join()
    upload(client, editor.load._impl.uuid, longer)
    until(lambda: editor.yes.visible, "it asks: the tool in use would be another")
    client.set(editor.yes._impl.uuid, value=True)
    mine = msgspec.structs.replace(GRIPPER, tcp=[0.0, 0.0, 0.2], length=0.2)
    assert wish(loop) == (SPHERE, mine, TURNED), "the file's win; the rest stays"
    until(lambda: "3 tools" in editor.message.shown, "said")


@pytest.mark.parametrize(
    ("content", "said"),
    [
        (b"tools: [{name: a}]", "mass"),
        (b"tools: [{name: a, mass: 90.0, com: [0, 0, 0], tcp: [0, 0, 0]}]", "tools[0].mass"),
        (b"tools: [{name: a, mass: 1.0, com: [0, 0, 0], tcp: [0, 0, 3]}]", "-1 .. 1 m"),
        (b"- 1", "tools.yaml"),
    ],
)
def test_a_bad_file_is_refused_in_a_line(join: Join, loop: FakeLoop, editor: ToolEditor, content: bytes, said: str) -> None:
    editor.read("tools.yaml", content)
    assert "File refused" in editor.message.shown
    assert said in editor.message.shown
    loop.advance()
    assert loop.wishes[-1].inputs.tools == ()


def test_what_was_edited_goes_with_the_next_set_up(served: Served, loop: FakeLoop, editor: ToolEditor) -> None:
    loop.table = (GRIPPER, TURNED)
    assert served.lab.setup.chosen().tools == [GRIPPER, TURNED]
