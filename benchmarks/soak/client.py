"""A client of the page: sees what a browser sees, and uses the controls and drags the parts that it sees.

It knows viser's messages, and nothing of the app but the names of a few controls.
"""

import time
from typing import Any

import msgspec
import zstandard
from websockets.sync.client import ClientConnection, connect

from app.web.panel.mode_panel import CONFIRM, HOLD, LEAVE
from benchmarks.viewer import CAMERA, VERSION

FREE_DRIVE = (HOLD, CONFIRM, LEAVE)  # one button: what it is called depends on the mode

BUILT = 30.0  # within which a page is there [s]

HOLD_RATE = 20.0  # of the messages of a held button and of a drag, as a browser sends them [Hz]


class Client:
    """One connection, and what came through it.

    Attributes:
        things: controls, keys and nodes by their names, as they are shown.
    """

    def __init__(self, url: str) -> None:
        self.things: dict[str, dict[str, Any]] = {}
        self._url = url.replace("http", "ws", 1)
        self._unpack = zstandard.ZstdDecompressor()
        self._socket: ClientConnection

    def come(self) -> None:
        """Open the page, and wait until its free-drive button is there: nobody uses what is not seen yet."""
        self.things.clear()
        self._socket = connect(self._url, subprotocols=[VERSION], max_size=None, proxy=None)
        self.send(CAMERA)
        end = time.monotonic() + BUILT
        while not self._seen(FREE_DRIVE):
            if time.monotonic() > end:
                raise TimeoutError(f"the page has none of {FREE_DRIVE} after {BUILT:g} s")
            self.look(0.1)

    def go(self) -> None:
        """Close the page."""
        self._socket.close()

    def look(self, seconds: float) -> None:
        """Read what comes, for so long."""
        end = time.monotonic() + seconds
        while (left := end - time.monotonic()) > 0.0:
            try:
                raw = self._socket.recv(timeout=left)
            except TimeoutError:
                return
            assert isinstance(raw, bytes)
            packed = int.from_bytes(raw[8:16], "little")
            for message in msgspec.msgpack.decode(self._unpack.decompress(raw[16 : 16 + packed]))["messages"]:
                self._see(message)

    def send(self, message: dict[str, Any]) -> None:
        """Send one message of viser's."""
        self._socket.send(msgspec.msgpack.encode(message))

    def set(self, name: str, value: Any) -> None:
        """Give the control `name` a value; a button is pressed by True."""
        self.send({"type": "GuiUpdateMessage", "uuid": name, "updates": {"value": value}})

    def called(self, *labels: str) -> str:
        """The name of the control with one of these labels.

        Raises:
            LookupError: there is none, or more than one.
        """
        names = self._seen(labels)
        if len(names) != 1:
            raise LookupError(f"{len(names)} controls of the page are called {' or '.join(labels)}")
        return names[0]

    def offering(self, option: str) -> str:
        """The name of the control that offers `option`.

        Raises:
            StopIteration: there is none.
        """
        return next(name for name, thing in self.things.items() if option in (thing.get("options") or ()))

    def hold(self) -> None:
        """Say that the free-drive button is held, and look for as long as that is good."""
        self.send({"type": "GuiButtonHoldMessage", "uuid": self.called(*FREE_DRIVE), "frequency": 30.0})
        self.look(1.0 / HOLD_RATE)

    def drag(self, phase: str, name: str, *, modifier: str | None, start: list[float], here: list[float]) -> None:
        """Drag the part `name`, which was grabbed at `start`, to `here`, both in W [m]."""
        message = {"type": "SceneNodeDragMessage", "phase": phase, "name": name, "instance_index": None, "owner": ""}
        message |= {"start_position": start, "start_screen_pos": [0.5, 0.5], "button": "left", "modifier": modifier}
        self.send(message | {"end_position": here, "end_screen_pos": [0.6, 0.5]})

    def _seen(self, labels: tuple[str, ...]) -> list[str]:
        return [name for name, thing in self.things.items() if thing.get("label") in labels]

    def _see(self, message: dict[str, Any]) -> None:
        name = message.get("uuid") or message.get("name")
        if name is None:
            return
        if "Remove" in message["type"]:  # of a node, or of a control
            self.things.pop(name, None)
            return
        kind = message["type"]
        thing = self.things.setdefault(name, {"kind": kind})
        thing.update(message.get("props", {}), **message.get("updates", {}))
        if kind == "SetPositionMessage":
            thing["position"] = message["position"]
        elif kind == "SetSceneNodeDragBindingsMessage":
            thing["drag"] = bool(message["bindings"])


def usable(thing: dict[str, Any]) -> bool:
    """Whether it is a control or a key that takes something."""
    kinds = ("Button", "Checkbox", "Slider", "Number", "Dropdown", "ButtonGroup", "Text")
    known = thing["kind"] == "RegisterCommandMessage" or thing["kind"] in [f"Gui{kind}Message" for kind in kinds]
    return known and thing.get("visible", True) and not thing.get("disabled", False)
