"""What a browser may do to the app: the one filter in front of viser.

viser 1.1.1 takes from every client any attribute of any control, presses of disabled buttons, values beyond the range, requests
to open a public tunnel, uploads, and connections of any web page, and tells the other clients before a callback sees it. Here
every connection is a `Gate`, whose `recv` hands on only what `Guard.admit` allows; the door checks Host and Origin before there
is a connection at all. Whatever is refused is dropped and counted.
"""

import asyncio
import functools
import math
import threading
import time
from collections import Counter
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from http import HTTPStatus
from typing import Any

import viser
import viser._messages
import websockets.asyncio.server
from websockets.asyncio.server import ServerConnection
from websockets.datastructures import Headers
from websockets.exceptions import ConnectionClosed
from websockets.http11 import Request, Response

from app.web.messages import Admitted, Camera, Drag, Hold, Part, Update, Upload, decode, encode
from app.web.operator import Operator
from app.web.page import dress

VISER_VERSION = "1.1.1"
"""The only version whose inside this file knows."""

MAX_BYTES = 64 * 1024
"""Largest message from a client."""

MAX_FILE = 48 * 1024
"""Largest file from a client: it comes in one message."""

MAX_CLIENTS = 16
MAX_RATE = 200
"""Messages a second from one client; beyond it, the connection is read no faster."""

MAX_TEXT = 200
"""Longest text that a control takes."""

LARGEST = 1e6
"""Largest number in any message: the far plane of a camera and the pixels of a window are within it."""

LOOPBACK = ("localhost", "127.0.0.1", "[::1]")

PULSE = 0.2
"""Time between two pings of a client, to notice a stalled network (FD-23) [s]."""

_installing = threading.Lock()


class Guard:
    """Decides on every message of every client. Lives on viser's event loop, once installed."""

    def __init__(self, operator: Operator, clock: Callable[[], float] = time.monotonic) -> None:
        self.operator = operator
        self.refused: Counter[str] = Counter()
        self._clock = clock
        self._server: viser.ViserServer | None = None
        self._handles: frozenset[str] = frozenset()
        self._anyone: set[str] = set()
        self._gates: set[Gate] = set()  # connections, from the door until they are lost
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
                "create_connection": functools.partial(Gate, self),
                "process_request": functools.partial(self._door, options["process_request"]),
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

    def for_anyone(self, control: Any) -> None:
        """Let every client use `control`, not the operator alone."""
        self._anyone.add(control._impl.uuid)

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
        return None

    def _reason_against(self, client: int, message: Admitted) -> str | None:
        if not _bounded(message):
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
        else:
            uuid = message.source_component_uuid if isinstance(message, Upload | Part) else message.uuid
            control = self._control(client, uuid)
            if control is None:
                return "unknown control"
            reason = _reason_against_use(control, message)
            if reason is not None or uuid in self._anyone:
                return reason
        return None if self.operator.claim(client, self._clock()) else "not the operator"

    def _control(self, client: int, uuid: str) -> Any:
        assert self._server is not None
        own = self._server._connected_clients[client].gui
        return self._server.gui._gui_input_handle_from_uuid.get(uuid) or own._gui_input_handle_from_uuid.get(uuid)

    def _show_truth(self, client: int, uuid: str) -> None:
        """Set the page of a refused client back to the value that holds."""
        if self._server is None or client not in self._server._connected_clients:
            return
        control = self._control(client, uuid)
        if control is not None and not control._impl.is_button:
            truth = viser._messages.GuiUpdateMessage(uuid, {"value": control.value})
            self._server._connected_clients[client]._websock_connection.queue_message(truth)

    def _door(self, pages: Callable[..., Response | None], connection: "Gate", request: Request) -> Response | None:
        """Before any connection: only our own page, on this machine, and not too many."""
        upgrade = request.headers.get_all("Upgrade")
        host = _sole(request.headers, "Host")
        origins = request.headers.get_all("Origin")
        if host is None or (host.rpartition(":")[0] not in LOOPBACK and host not in LOOPBACK):
            return self._turn_away(HTTPStatus.FORBIDDEN, "foreign host")
        if origins and origins not in ([f"http://{host}"], [f"https://{host}"]):
            return self._turn_away(HTTPStatus.FORBIDDEN, "foreign origin")
        if upgrade and self._server is None:
            return self._turn_away(HTTPStatus.SERVICE_UNAVAILABLE, "not ready")
        if upgrade and len(self._gates) >= MAX_CLIENTS:
            return self._turn_away(HTTPStatus.SERVICE_UNAVAILABLE, f"at most {MAX_CLIENTS} clients")
        response = pages(connection, request)
        if response is not None:
            return dress(response, host)
        self._gates.add(connection)
        return None

    def _turn_away(self, status: HTTPStatus, reason: str) -> Response:
        self.refused[reason] += 1
        body = f"refused: {reason}\n".encode()
        headers = Headers({"Content-Type": "text/plain; charset=utf-8", "Content-Length": str(len(body))})
        return Response(status.value, status.phrase, headers, body)

    def client_of(self, gate: "Gate") -> int | None:
        """The number that viser gave to the connection."""
        if self._server is None:
            return None
        live = self._server._websock_server._live_connections
        return next((client for client, connection in live.items() if connection is gate), None)

    def stalled(self, gate: "Gate") -> None:
        """The network of a client gives no answer: what it holds counts as released (FD-23)."""
        client = self.client_of(gate)
        if client is not None:
            self._stalled(client)


class Gate(ServerConnection):
    """A connection that hands on only what the guard admits."""

    def __init__(self, guard: Guard, *args: Any, **options: Any) -> None:
        super().__init__(*args, **options)
        self._guard = guard
        self._pulse: asyncio.Task[None] | None = None
        self._second = 0
        self._count = 0

    async def recv(self, decode: bool | None = None) -> Any:
        """The next admitted message."""
        if self._pulse is None:
            self._pulse = asyncio.create_task(self._watch())
        client = self._guard.client_of(self)
        while True:
            raw = await super().recv(decode)
            await self._slow_down()
            admitted = None if client is None else self._guard.admit(client, raw)
            if admitted is not None:
                return admitted

    def connection_lost(self, exc: Exception | None) -> None:
        """Forget the connection."""
        super().connection_lost(exc)
        self._guard._gates.discard(self)
        if self._pulse is not None:
            self._pulse.cancel()

    async def _slow_down(self) -> None:
        """Read no more than MAX_RATE messages in a second; the rest waits in the sender's network."""
        now = time.monotonic()
        if int(now) != self._second:
            self._second, self._count = int(now), 0
        self._count += 1
        if self._count > MAX_RATE:
            self._guard.refused["too fast"] += 1
            await asyncio.sleep(1.0 - now % 1.0)

    async def _watch(self) -> None:
        """Ping the client as long as it is there; browsers answer without their page."""
        try:
            while True:
                await asyncio.sleep(PULSE)
                answered = await self.ping()
                done, _ = await asyncio.wait([asyncio.ensure_future(answered)], timeout=self._guard.silence)
                if not done:
                    self._guard.stalled(self)
                    await answered
        except ConnectionClosed:
            return


def _bounded(value: Any) -> bool:
    """Whether every number in a decoded message is finite, and small enough to be squared without harm."""
    if isinstance(value, int | float):
        return math.isfinite(value) and abs(value) <= LARGEST
    if isinstance(value, dict):
        return all(_bounded(v) for v in value.values())
    if isinstance(value, tuple):
        return all(_bounded(v) for v in value)
    return all(_bounded(getattr(value, name)) for name in getattr(value, "__struct_fields__", ()))


def _reason_against_use(control: Any, message: Update | Hold | Upload | Part) -> str | None:
    """Why the control cannot be used like that by anybody, or None."""
    if control.disabled or not control.visible:
        return "disabled control"
    if isinstance(message, Upload | Part):
        if not isinstance(control, viser.GuiUploadButtonHandle):
            return "not an upload button"
        return None if _small(message) else "not a small file"
    if isinstance(message, Hold):
        holdable = isinstance(control, viser.GuiButtonHandle) and message.frequency in control._hold_callback_freqs
        return None if holdable else "not a hold button"
    if set(message.updates) != {"value"}:
        return "attribute other than value"
    return None if _fits(control, message.updates["value"]) else "value not allowed"


def _small(message: Upload | Part) -> bool:
    """Whether a file, or its content, comes in one piece that is small enough."""
    if isinstance(message, Part):
        return message.part_index == 0 and len(message.content) <= MAX_FILE
    texts = (message.filename, message.transfer_uuid, message.mime_type)
    return message.part_count == 1 and 0 < message.size_bytes <= MAX_FILE and max(map(len, texts)) <= MAX_TEXT


def _fits(control: Any, value: Any) -> bool:
    """Whether `value` has the type and range of the control. Kinds of control that are not named here take nothing."""
    if isinstance(control, viser.GuiButtonHandle):
        return value is True
    if isinstance(control, viser.GuiCheckboxHandle):
        return isinstance(value, bool)
    if isinstance(control, viser.GuiSliderHandle):
        return type(value) in (int, float) and control.min <= value <= control.max
    if isinstance(control, viser.GuiNumberHandle):
        return type(value) in (int, float) and _between(control.min, value, control.max)
    if isinstance(control, viser.GuiDropdownHandle | viser.GuiButtonGroupHandle):
        return isinstance(value, str) and value in control.options
    if isinstance(control, viser.GuiTextHandle):
        return isinstance(value, str) and len(value) <= MAX_TEXT
    return False


def _between(low: float | None, value: float, high: float | None) -> bool:
    """Whether `value` is in a range whose ends may be open."""
    return (low is None or low <= value) and (high is None or value <= high)


def _sole(headers: Headers, name: str) -> str | None:
    values = headers.get_all(name)
    return values[0] if len(values) == 1 else None
