"""What a browser may do to the app: the one filter in front of viser.

viser 1.1.1 takes from every client any attribute of any control, presses of disabled buttons, values beyond the range, requests
to open a public tunnel, uploads, and connections of any web page, and tells the other clients before a callback sees it. Here
every connection is a `MessageGate`, whose `recv` hands on only what `Guard.admit` allows; the `Door` asks for Host, Origin and
token before there is a connection at all. Whatever is refused is dropped and counted.
"""

import functools
import threading
import time
from collections import Counter
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

import viser
import viser._messages
import websockets.asyncio.server

from app.web.access.door import Door
from app.web.access.listening import Access
from app.web.access.message_gate import MAX_BYTES, MessageGate
from app.web.access.messages import (
    Admitted,
    Camera,
    CommandTrigger,
    Drag,
    Handles,
    HandlesLetGo,
    Update,
    Upload,
    UploadPart,
    decode,
    encode,
)
from app.web.access.operator import Operator
from app.web.access.takes import bounded, reason_against

VISER_VERSION = "1.1.1"
"""The only version whose inside this file knows."""

_installing = threading.Lock()


class Guard:
    """Decides on every message of every client. Lives on viser's event loop, once installed.

    Args:
        operator: who has control.
        access: who may come at all.
        clock: by which the operator's silence is measured [s].
    """

    def __init__(self, operator: Operator, access: Access, clock: Callable[[], float] = time.monotonic) -> None:
        self.operator = operator
        self.access = access
        self.refused: Counter[str] = Counter()
        self.door = Door(access, f"viser-v{VISER_VERSION}", self.refused)
        self._clock = clock
        self._server: viser.ViserServer | None = None
        self._handles: frozenset[str] = frozenset()
        self._anyone: set[str] = set()
        self._movable: set[str] = set()  # names of handles in the picture
        self._stalled: Callable[[int], None] = lambda client: None
        self.silence = 0.5

    @contextmanager
    def installed(self) -> Iterator[None]:
        """Within it, a `ViserServer` that starts is guarded."""
        if viser.__version__ != VISER_VERSION:
            raise RuntimeError(f"viser {viser.__version__} is installed; the guard of the web app knows {VISER_VERSION} only")
        original = websockets.asyncio.server.serve

        def serve(handler: Any, host: str, port: int, **options: Any) -> Any:
            options |= {
                "max_size": MAX_BYTES,
                "create_connection": functools.partial(MessageGate, self),
                "process_request": functools.partial(self.door.answer, options["process_request"]),
            }
            return original(handler, host, port, **options)

        with _installing:
            websockets.asyncio.server.serve = serve
            try:
                yield
            finally:
                websockets.asyncio.server.serve = original

    def open(self, server: viser.ViserServer, draggable: frozenset[str], stalled: Callable[[int], None]) -> None:
        """Let clients in. `draggable` names the scene nodes that may be dragged; `stalled` is told of a client that has fallen
        silent on the network while it holds the arm."""
        self._handles = draggable
        self._stalled = stalled
        self._server = server
        self.door.ready = True

    def for_anyone(self, control: Any) -> None:
        """Let every client use `control`, not the operator alone."""
        self._anyone.add(control._impl.uuid)

    def forget(self) -> None:
        """The page is cleared: what was for anyone, and handles, are no more."""
        self._anyone.clear()
        self._movable.clear()

    def for_nobody(self, control: Any) -> None:
        """Forget a control that was for anyone: it is no more."""
        self._anyone.discard(control._impl.uuid)

    def let_move(self, name: str) -> None:
        """Let the handles of this name be moved, by the operator."""
        self._movable.add(name)

    def fix(self, name: str) -> None:
        """Let them be moved by nobody: they are no more."""
        self._movable.discard(name)

    def now(self) -> float:
        """The clock by which the operator's silence is measured [s]."""
        return self._clock()

    def admit(self, client: int, raw: str | bytes) -> bytes | None:
        """What to hand on to viser, or None if `client` may not send that."""
        message = decode(raw) if isinstance(raw, bytes) else None
        reason = "not understood" if message is None else self._reason_against(client, message)
        if message is not None and reason is None:
            return encode(message)
        self.refused[reason or "not understood"] += 1
        if isinstance(message, Update):
            self._show_truth(client, message.uuid)
        elif isinstance(message, Handles):
            self._show_place(client, message.name)
        return None

    def _reason_against(self, client: int, message: Admitted) -> str | None:
        if not bounded(message):
            return "number out of bounds"
        if isinstance(message, Camera):
            return None
        if self._server is None or client not in self._server._connected_clients:
            return "not connected"
        if isinstance(message, Drag):
            if message.name not in self._handles or message.owner != "":
                return "not draggable"
            if message.phase == "end":
                return None
        elif isinstance(message, Handles):
            if message.name not in self._movable or message.owner != "":
                return "not movable"
            if isinstance(message, HandlesLetGo):
                return None
        else:
            uuid = message.source_component_uuid if isinstance(message, Upload | UploadPart) else message.uuid
            control = self._command(uuid) if isinstance(message, CommandTrigger) else self._control(client, uuid)
            if control is None:
                return "unknown control"
            reason = reason_against(control, message)
            if reason is not None or uuid in self._anyone:
                return reason
        return None if self.operator.claim(client, self._clock()) else "not the operator"

    def _control(self, client: int, uuid: str) -> Any:
        assert self._server is not None
        own = self._server._connected_clients[client].gui
        return self._server.gui._gui_input_handle_from_uuid.get(uuid) or own._gui_input_handle_from_uuid.get(uuid)

    def _command(self, uuid: str) -> Any:
        assert self._server is not None
        return self._server.gui._command_handle_from_uuid.get(uuid)

    def _show_truth(self, client: int, uuid: str) -> None:
        """Set the page of a refused client back to the value that holds."""
        if self._server is None or client not in self._server._connected_clients:
            return
        control = self._control(client, uuid)
        if control is not None and not control._impl.is_button:
            truth = viser._messages.GuiUpdateMessage(uuid, {"value": control.value})
            self._server._connected_clients[client]._websock_connection.queue_message(truth)

    def _show_place(self, client: int, name: str) -> None:
        """Set the handles on the page of a refused client back to where they are."""
        if self._server is None or client not in self._server._connected_clients:
            return
        node = self._server.scene._handle_from_node_name.get(name)
        if node is None:
            return
        w, i, j, k = node.wxyz.tolist()
        x, y, z = node.position.tolist()
        connection = self._server._connected_clients[client]._websock_connection
        connection.queue_message(viser._messages.SetOrientationMessage(name, (w, i, j, k)))
        connection.queue_message(viser._messages.SetPositionMessage(name, (x, y, z)))

    def refuse(self, reason: str) -> None:
        """Count a refusal."""
        self.refused[reason] += 1

    def client_of(self, gate: MessageGate) -> int | None:
        """The number that viser gave to the connection."""
        if self._server is None:
            return None
        live = self._server._websock_server._live_connections
        return next((client for client, connection in live.items() if connection is gate), None)

    def stalled(self, gate: MessageGate) -> None:
        """The network of a client gives no answer: what it holds counts as released (FD-23)."""
        client = self.client_of(gate)
        if client is not None:
            self._stalled(client)

    def lost(self, gate: MessageGate) -> None:
        """A connection is no more: its place is free."""
        self.door.inside.discard(gate)
