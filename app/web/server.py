"""The web app as a whole: the page of a running loop."""

import functools
import socket
import webbrowser
from collections.abc import Mapping

import viser

from app.bad_input import BadInput
from app.library import mesh_path
from app.web.control import Control
from app.web.docks import Docks
from app.web.guard import LOOPBACK
from app.web.hand import Hand
from app.web.running import Running
from app.web.scene import TOOL, Scene, frames_of
from app.web.site import Site
from sim.arm import Arm
from sim.scenario import Scenario

FRAMES_A_PANEL = 4
"""The pendant is brought up to date with every so many pictures."""


class Served(Site):
    """A running web app."""

    def __init__(self, loop: Running, arm: Arm, scenario: Scenario, meshes: Mapping[str, bytes], host: str, port: int) -> None:
        super().__init__(host, port, brand_color=(25, 113, 194))
        self._loop = loop
        self._shown = -1  # tick of the last picture
        self._frame = 0
        self.scene = Scene(self.server, arm, scenario, meshes, loop.latest())
        self.hand = Hand(loop.desk, loop.latest, frames_of(arm))
        self.docks = Docks(self.server, self.guard, loop, self.hand, arm)
        self.panel, self.lab = self.docks.panel, self.docks.lab
        self.control = Control(self.server, self.guard, self._let_go)
        for part, node in self.scene.draggable.items():
            self._make_draggable(part, node)
        self.server.on_client_connect(self._welcome)
        self.server.on_client_disconnect(self._farewell)
        self.scene.on_tool = functools.partial(self._make_draggable, "tool")
        draggable = frozenset({TOOL, *(node.name for node in self.scene.draggable.values())})
        self.guard.open(self.server, draggable, self._let_go)
        self.start_drawing()

    def close(self) -> None:
        """Stop serving; connections are closed, and what they held is released."""
        self.server.get_event_loop().call_soon_threadsafe(self.control.close)
        super().close()

    def draw(self) -> bool:
        """Show what is new of the loop; False once it has failed."""
        try:
            snapshot = self._loop.latest()
        except RuntimeError as failure:
            self.panel.fail(str(failure))
            return False
        if snapshot.tick != self._shown:
            self.scene.show(snapshot)
            self._shown = snapshot.tick
            self.docks.plots.show(snapshot)
        if self._frame % FRAMES_A_PANEL == 0:
            self.docks.show(snapshot)
            self.control.show()
        self._frame += 1
        return True

    async def _welcome(self, client: viser.ClientHandle) -> None:
        self.control.welcome(client)

    async def _farewell(self, client: viser.ClientHandle) -> None:
        self.control.farewell(client.client_id)

    def _let_go(self, client: int) -> None:
        self.hand.let_go(client)
        self.panel.let_go(client)
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
    loop: Running, arm: Arm, scenario: Scenario, host: str = "127.0.0.1", port: int = 0, open_browser: bool = False
) -> Served:
    """Serve the web app of a running loop.

    Args:
        host: an address of this machine alone.
        port: 0 for any free one.

    Raises:
        BadInput: the host is on a network, or the port is taken.
    """
    host = served_host(host)
    must_be_free(host, port)
    meshes = {part: mesh_path(arm.name, part).read_bytes() for part in ("foot", *arm.chain.joints)}
    served = Served(loop, arm, scenario, meshes, host, port)
    if open_browser:
        webbrowser.open(served.url)
    return served


def served_host(host: str) -> str:
    """The address to listen on, for `--host`. Raises BadInput: it is not of this machine alone."""
    if host not in LOOPBACK:
        raise BadInput("serve", "--host", host, f"one of {', '.join(LOOPBACK)}: opening it to a network is not available yet")
    return "::1" if host == "[::1]" else host


def free_port(host: str, port: int | None, usual: int) -> int:
    """`port`; or without one `usual` if it is free, else 0 for any. Raises BadInput: `port` is taken."""
    try:
        must_be_free(host, usual if port is None else port)
    except BadInput:
        if port is not None:
            raise
        return 0
    return usual if port is None else port


def must_be_free(host: str, port: int) -> None:
    """Raise BadInput when `port` is taken: viser would quietly take another."""
    with socket.socket(socket.AF_INET6 if ":" in host else socket.AF_INET) as probe:
        probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            probe.bind((host, port))
        except OSError:
            raise BadInput("serve", "--port", port, "a port that is free") from None
