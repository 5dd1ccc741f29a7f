"""A client that speaks viser's protocol by hand, so that it can also misbehave."""

import time
from collections.abc import Callable
from typing import Any

import msgspec
import zstandard
from websockets import Origin
from websockets.sync.client import ClientConnection, connect

from benchmarks.viewer import CAMERA, VERSION


def until(true: Callable[[], bool], what: str, seconds: float = 20.0) -> None:
    """Wait for something to become true."""
    end = time.monotonic() + seconds
    while not true():
        assert time.monotonic() < end, f"waited {seconds} s in vain: {what}"
        time.sleep(0.005)


class RawClient:
    """One connection."""

    def __init__(self, url: str, origin: str | None = None, camera: bool = True, cookie: str | None = None) -> None:
        named = None if origin is None else Origin(origin)
        address = url.replace("http", "ws", 1)
        more = None if cookie is None else {"Cookie": cookie}
        self.socket: ClientConnection = connect(
            address,
            subprotocols=[VERSION],
            origin=named,
            max_size=None,
            proxy=None,
            additional_headers=more,
            close_timeout=1.0,  # a client that has not read everything would wait for its goodbye in vain
        )
        if camera:
            self.send(**CAMERA)

    def send(self, **message: Any) -> None:
        """Send a message of these fields."""
        self.socket.send(msgspec.msgpack.encode(message))

    def set(self, uuid: str, **updates: Any) -> None:
        """Send an update of a control's attributes."""
        self.send(type="GuiUpdateMessage", uuid=uuid, updates=updates)

    def hold(self, uuid: str, frequency: float = 30.0) -> None:
        """Say once that a button is held."""
        self.send(type="GuiButtonHoldMessage", uuid=uuid, frequency=frequency)

    def drag(self, phase: str, /, to: tuple[float, float, float] = (0.5, 0.0, 0.5), **changes: Any) -> None:
        """Drag a node from the origin."""
        message: dict[str, Any] = {
            "type": "SceneNodeDragMessage",
            "phase": phase,
            "name": "/arm/wrist_3",
            "instance_index": None,
            "start_position": [0.0, 0.0, 0.0],
            "start_screen_pos": [0.5, 0.5],
            "end_position": list(to),
            "end_screen_pos": [0.6, 0.5],
            "button": "left",
            "modifier": None,
            "owner": "",
        }
        self.send(**(message | changes))

    def messages_until(self, last: Callable[[dict[str, Any]], bool], seconds: float = 20.0) -> list[dict[str, Any]]:
        """All messages received up to the one for which `last` holds."""
        got: list[dict[str, Any]] = []
        end = time.monotonic() + seconds
        while True:
            raw = self.socket.recv(timeout=max(0.0, end - time.monotonic()))
            assert isinstance(raw, bytes)
            packed = int.from_bytes(raw[8:16], "little")
            batch = msgspec.msgpack.decode(zstandard.ZstdDecompressor().decompress(raw[16 : 16 + packed]))
            for message in batch["messages"]:
                got.append(message)
                if last(message):
                    return got

    def close(self) -> None:
        """Close the connection."""
        self.socket.close()
