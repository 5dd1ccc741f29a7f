"""The web app as a whole: the page of a running loop."""

import asyncio
import functools
import math
import time
import webbrowser
from collections.abc import Mapping
from pathlib import Path
from typing import NamedTuple

import viser

from app.files.checked import BadInput
from app.kept_setup import Cell, Keeper
from app.log.live import LiveRecording
from app.robot_interface.interfaces import RobotInterfaces
from app.urscript.running.script_runner import ScriptRunner
from app.web.access.control import Control
from app.web.access.listening import Access, access_through, must_be_free
from app.web.access.site import Site
from app.web.arm_change import ArmChange, meshes_of
from app.web.docks import Docks
from app.web.keys import Keys
from app.web.panel.preferences import Preferences
from app.web.running import Running
from app.web.scene.arm_picture import TOOL, Scene, frames_of
from app.web.scene.virtual_hand import VirtualHand
from app.web.widgets import svg
from app.web.widgets.html import Html
from app.web.widgets.svg import Colour
from sim.arm.arm_file import Arm
from sim.arm.scenario import Scenario

TOLD = 12.0
"""What became of the network is seen for so long after another arm was chosen [s]."""

FRAMES_A_PANEL = 4
"""The pendant is brought up to date with every so many pictures."""


class Surround(NamedTuple):
    """What stands around the arm on the page."""

    recording: LiveRecording
    interfaces: RobotInterfaces | None = None
    scripts: ScriptRunner | None = None
    keeper: Keeper | None = None
    arms: ArmChange | None = None


class Served(Site):
    """A running web app."""

    def __init__(
        self,
        loop: Running,
        arm: Arm,
        scenario: Scenario,
        *,
        meshes: Mapping[str, bytes],
        access: Access,
        port: int,
        around: Surround,
    ) -> None:
        super().__init__(access, port, loop.troubles, brand_color=(25, 113, 194))
        self._loop = loop
        self._shown = -1  # tick of the last picture
        self._frame = 0
        self._changing = self._still_page = False  # another arm is made ready; it runs, and is not shown yet
        self._cells: dict[str, Cell] = {}  # of arms that were here before
        self.recording, self._around = around.recording, around
        self._furnish(arm, scenario, meshes, around)
        self.server.on_client_connect(self._welcome)
        self.server.on_client_disconnect(self._farewell)
        self.start_drawing()

    def _furnish(self, arm: Arm, scenario: Scenario, meshes: Mapping[str, bytes], around: Surround) -> None:
        """Make all that the page shows of one arm."""
        loop = self._loop
        self._arm, self._around = arm, around
        self.beat = Html(self.server.gui, svg.beat(0))
        self.scene = Scene(self.server, arm, scenario, meshes=meshes, first=loop.latest())
        self.hand = VirtualHand(loop.desk, loop.latest, frames_of(arm))
        self.docks = Docks(
            self.server,
            self.guard,
            loop,
            hand=self.hand,
            arm=arm,
            recording=around.recording,
            interfaces=around.interfaces,
            scripts=around.scripts,
            keeper=around.keeper,
        )
        self.panel, self.lab, self.docks.texts = self.docks.panel, self.docks.lab, lambda: self.scene.texts
        self.control = Control(self.server, self.guard, self._let_go)
        self.preferences = Preferences(self.guard, self.docks.settings_dock, self._paint_page)
        self.keys = Keys(self.server, self.guard, loop, docks=self.docks, preferences=self.preferences)
        for part, node in self.scene.draggable.items():
            self._make_draggable(part, node)
        self.scene.on_tool = functools.partial(self._make_draggable, "tool")
        if around.arms is not None:
            self.lab.setup.offer_arms(around.arms.names, self._change_arm)
        draggable = frozenset({TOOL, *(node.name for node in self.scene.draggable.values())})
        self.guard.open(self.server, draggable, self._let_go)

    async def _change_arm(self, name: str) -> None:
        """Go over to another arm: the loop first, then the page, for every client at once."""
        arms = self._around.arms
        if arms is None or self._changing:
            return
        self._changing = True
        try:
            await self._go_over(arms, name)
        except BadInput as refusal:
            self.lab.setup.message.show(svg.note("Refused", str(refusal), Colour.AMBER))
        finally:
            self._shown, self._still_page, self._changing = -1, False, False

    async def _go_over(self, arms: ArmChange, name: str) -> None:
        self.lab.setup.message.show(svg.note("Another arm", f"The {name} is made ready.", Colour.BLUE))
        ready = await asyncio.to_thread(arms.ready, name, self._cells.get(name))
        for client in self.server.get_clients():
            self._let_go(client)
        self.docks.keep(now=math.inf)
        self._cells[self._arm.name] = self.docks.work.mine()
        self._still_page = True
        brought = await asyncio.to_thread(arms.bring, ready)
        prepared = ready.prepared
        dark = self.preferences.dark
        self._clear()
        around = self._around._replace(interfaces=brought.interfaces, scripts=brought.scripts, keeper=ready.keeper)
        self._furnish(prepared.arm, prepared.scenario, ready.meshes, around)
        self.docks.skip()
        if ready.cell is not None:
            self.docks.work.begin_with(ready.cell)
        for number, client in self.server.get_clients().items():
            await self._welcome(client)
            if number in dark:
                self.preferences.flip_dark(number)
        headline = f"Now the {prepared.arm.title}"
        self.lab.setup.message.show(svg.note(headline, brought.said, Colour.GREEN))
        for client in self.server.get_clients().values():
            client.add_notification(headline, brought.said or "It begins at its start.", auto_close_seconds=TOLD)

    def _clear(self) -> None:
        """Take everything off the page, of all clients."""
        self.control.close()
        for client in self.server.get_clients().values():
            client.gui.reset()
        self.server.gui.reset()
        self.server.scene.reset()
        self.guard.forget()

    def close(self) -> None:
        """Stop serving: a recording is ended, connections are closed, what they held is released."""
        self.attempt("the end of the recording", self.recording.close)
        self.attempt("the end of the page", lambda: self.server.get_event_loop().call_soon_threadsafe(self.control.close))
        super().close()
        self.attempt("what is kept for the next start", lambda: self.docks.keep(now=math.inf))
        self.attempt("the export of demonstrations", self.docks.recording.close)

    def draw(self) -> bool:
        """Show what is new of the loop; there is always a next picture."""
        if self._still_page:
            return True
        snapshot, draw = self._loop.latest(), self.docks.parts.draw
        if snapshot.tick != self._shown:
            self._shown = snapshot.tick
            draw("the picture of the arm", lambda: self.scene.show(snapshot))
            draw("the tab Plots", lambda: self.docks.plots.show(snapshot), self.docks.plots_dock)
        if self._frame % FRAMES_A_PANEL == 0:
            self.docks.show(snapshot)
            draw("who has control", self.control.show)
            draw("sounds", lambda: self.preferences.show(snapshot.decision))
            draw("the heartbeat", lambda: self.beat.show(svg.beat(int(time.monotonic()))))
        self._frame += 1
        return True

    def _paint_page(self, client: viser.ClientHandle, dark: bool) -> None:
        self.set_theme(client.gui, dark)
        self.scene.set_theme(client.scene, dark)

    async def _welcome(self, client: viser.ClientHandle) -> None:
        self.attempt("who has control", lambda: self.control.welcome(client))
        self.attempt("the preferences of a client", lambda: self.preferences.welcome(client))

    async def _farewell(self, client: viser.ClientHandle) -> None:
        number = client.client_id
        for forget in (
            self.control.farewell,
            self.panel.holds.forget,
            self.docks.jog.forget,
            self.preferences.farewell,
            self.keys.forget,
        ):
            self.attempt("a client that leaves", functools.partial(forget, number))

    def _let_go(self, client: int) -> None:
        """All that a client holds, whatever of it fails."""
        for let_go in (
            self.hand.let_go,
            self.panel.let_go,
            self.docks.jog.let_go,
            self.docks.walls.let_go,
            self.docks.tools.frame.handles.let_go,
        ):
            self.attempt("what a client lets go", functools.partial(let_go, client))
        self.guard.operator.engage(client, False, self.guard.now())

    def _make_draggable(self, part: str, node: viser.GlbHandle) -> None:
        async def dragged(event: viser.SceneNodeDragEvent) -> None:
            client = event.client_id
            if event.phase == "end":
                self.hand.let_go(client)
            elif event.phase == "start":
                self.hand.grab(client, part, event.start_position, turning=event.modifier is not None)
            if event.phase != "end":
                eye = event.client.camera.position
                self.hand.move(client, event.start_position, event.end_position, (float(eye[0]), float(eye[1]), float(eye[2])))
            self.guard.operator.engage(client, self.hand.holds(client), self.guard.now())

        node.on_drag("left")(dragged)
        node.on_drag("left", modifier="shift")(dragged)
        node.on_drag("left", modifier="cmd/ctrl")(dragged)


def serve(
    loop: Running,
    arm: Arm,
    scenario: Scenario,
    *,
    host: str = "127.0.0.1",
    port: int = 0,
    open_browser: bool = False,
    record: Path | None = None,
    recording: LiveRecording | None = None,
    interfaces: RobotInterfaces | None = None,
    scripts: ScriptRunner | None = None,
    keeper: Keeper | None = None,
    cell: Cell | None = None,
    arms: ArmChange | None = None,
) -> Served:
    """Serve the web app of a running loop.

    Args:
        host: an address of this machine; one in a network demands a token, which is in the `link`.
        port: 0 for any free one.
        record: record from the start, into this folder; None: when it is switched on.
        recording: the switch of recordings; None for one of its own, into `record` or the working folder.
        interfaces: the robot on the network, for the page to show; None where there is none.
        scripts: runs programs in URScript; None: the page has no tab for them.
        keeper: keeps set-up, settings and what is taught for the next start; None: nobody does.
        cell: what was kept, from which the loop has begun; None: nothing.
        arms: lets the page go over to another arm; None: it cannot.

    Raises:
        BadInput: the host is no address of this machine, the port is taken, or `record` cannot be written.
    """
    access = access_through(host)
    must_be_free(access.host, port)
    meshes = meshes_of(arm)
    recording = recording or LiveRecording(loop, record or Path())
    if record is not None:
        recording.start().result()
    served = Served(
        loop,
        arm,
        scenario,
        meshes=meshes,
        access=access,
        port=port,
        around=Surround(recording, interfaces, scripts, keeper, arms),
    )
    if cell is not None:
        served.docks.work.begin_with(cell)
    if open_browser:
        webbrowser.open(served.link)
    return served
