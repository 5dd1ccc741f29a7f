"""The tool frame in the picture, and what its handles do to the table."""

from collections.abc import Callable

from msgspec.structs import replace

from app.files.library import load_tool
from app.web.server import Served
from pendant.tick.modes import Mode
from pendant.tooling.tool_in_use import Fitting
from sim.arm.frames import quaternion_from_matrix, rotation_from_rpy
from sim.arm.scenario import Load, Scenario
from tests.app.web.fake_loop import FakeLoop
from tests.app.web.raw_client import RawClient, until
from tests.app.web.tabs.test_tool_editor import wish

Join = Callable[[], RawClient]
GRIPPER = load_tool("gripper")


def test_the_frame_is_shown_moved_and_brought_back(served: Served, loop: FakeLoop, join: Join) -> None:
    loop.scenario = Scenario(tool=GRIPPER)
    loop.fitting = Fitting(1, GRIPPER, Load(mass=0.0), 1.0, 0.0)
    client, tab = join(), served.docks.tools
    until(lambda: tab.tool.value == "gripper", "chosen")
    assert tab.frame.handles.away
    client.set(tab.framed._impl.uuid, value=True)
    until(lambda: tab.frame._flange.visible and tab.frame.handles.away, "axes alone")
    client.set(tab.handled._impl.uuid, value=True)
    until(lambda: not tab.frame.handles.away, "handles")
    turn = quaternion_from_matrix(rotation_from_rpy((0.0, 0.5, 0.0))).tolist()
    tab.frame.handles._moved((0.0, 0.02, 0.25), (turn[0], turn[1], turn[2], turn[3]))
    moved = replace(GRIPPER, tcp=[0.0, 0.02, 0.25], rpy=[0.0, 0.5, 0.0])
    until(lambda: not tab.editor.no.disabled and tab.editor.no.visible, "it asks: the tool is in use")
    assert not loop.desk.take().inputs.tools
    client.set(tab.editor.no._impl.uuid, value=True)
    until(lambda: not tab.editor.asking and not tab.frame.handles.away, "left as it is")
    tab.frame.handles._moved((0.0, 0.02, 0.25), (turn[0], turn[1], turn[2], turn[3]))
    until(lambda: tab.editor.yes.visible, "it asks again")
    client.set(tab.editor.yes._impl.uuid, value=True)
    until(lambda: not tab.editor.asking, "sure")
    assert wish(loop)[0] == moved
    until(lambda: not tab.editor.undo.disabled, "it can be undone")
    loop.scenario = Scenario(tool=moved)
    client.set(tab.editor.undo._impl.uuid, value=True)
    until(lambda: loop.advance() is None and loop.wishes[-1].inputs.tools[:1] == (GRIPPER,), "as it was")
    loop.mode = Mode.RUN
    until(lambda: loop.advance() is None and tab.frame.handles.away, "nobody moves it while the arm runs")
    client.set(tab.framed._impl.uuid, value=False)
    until(lambda: not tab.framed.value, "not shown")
