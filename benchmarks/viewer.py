"""A client of the web app for the real-time bench, in a process of its own: reads the whole stream, and may drag the arm.

Takes one line of JSON, the fields of `Task`, on its standard input, and gives the fields of `Seen` on its standard output.
Times are of `time.perf_counter`, which on one machine all processes share.
"""

import json
import math
import sys
import time
from collections.abc import Callable
from dataclasses import asdict, dataclass, field
from typing import Any, Literal

import msgspec
import zstandard
from websockets import Subprotocol
from websockets.sync.client import ClientConnection, connect

VERSION = Subprotocol("viser-v1.1.1")
HOLD_RATE = 20.0  # of the messages of a held button, and of a drag, as a browser sends them [Hz]
SLIDER_RATE = 10.0  # of a slider that is being moved [Hz]
ENTRY = 2.6  # until the held button and the activation sequence have brought free-drive [s]
RADIUS, ROUND = 0.06, 5.0  # of the circle on which the cursor leads the arm [m], [s]
CAMERA = {
    "type": "ViewerCameraMessage",
    "wxyz": [1.0, 0.0, 0.0, 0.0],
    "position": [2.0, 0.0, 1.0],
    "fov": 0.7,
    "near": 0.01,
    "far": 1000.0,
    "image_height": 800,
    "image_width": 1280,
    "look_at": [0.0, 0.0, 0.0],
    "up_direction": [0.0, 0.0, 1.0],
}


@dataclass(frozen=True, slots=True)
class Task:
    """What a viewer does."""

    url: str
    role: Literal["operator", "meddler", "reader"]  # drags and moves a slider, moves one in vain, or only reads
    start: float  # when to connect
    act: float  # when to begin to act
    rest: float  # when to end acting
    stop: float  # when to close
    node: str  # what is dragged, and whose positions are noted
    point: tuple[float, float, float]  # where it is grabbed, in W [m]
    button: str  # id of the free-drive button
    slider: str  # id of a slider that takes 45 to 55


@dataclass(slots=True)
class Seen:
    """What a viewer received."""

    received: list[tuple[float, int]] = field(default_factory=list)  # of each batch: time, bytes
    positions: list[tuple[float, list[float]]] = field(default_factory=list)  # of the node: when sent, by the app's stamp; [m]
    sent: int = 0  # drag messages
    picture: dict[str, dict[str, Any]] = field(default_factory=dict)  # all nodes and controls as they are at the end


class Viewer:
    """One connection."""

    def __init__(self, task: Task) -> None:
        self._task = task
        self.seen = Seen()
        self._socket: ClientConnection = connect(task.url, subprotocols=[VERSION], max_size=None, proxy=None)
        self._unpack = zstandard.ZstdDecompressor()

    def run(self) -> None:
        """Read and act until it is time to stop."""
        self._send(CAMERA)
        acts = [[self._task.act, 1.0 / rate, act] for rate, act in self._acts()]
        while (now := time.perf_counter()) < self._task.stop:
            due = self._task.stop
            for entry in acts:
                if entry[0] <= now < self._task.rest:
                    entry[2](now - self._task.act)
                    entry[0] += entry[1]
                due = min(due, max(entry[0], now))
            self._read(due)
        self._socket.close()

    def _acts(self) -> list[tuple[float, Callable[[float], None]]]:
        if self._task.role == "operator":
            return [(HOLD_RATE, self._hold), (HOLD_RATE, self._drag), (SLIDER_RATE, self._slide)]
        return [(SLIDER_RATE, self._slide)] if self._task.role == "meddler" else []

    def _read(self, due: float) -> None:
        try:
            raw = self._socket.recv(timeout=max(0.0, min(due, self._task.stop) - time.perf_counter()))
        except TimeoutError:
            return
        assert isinstance(raw, bytes)
        self.seen.received.append((time.perf_counter(), len(raw)))
        packed = int.from_bytes(raw[8:16], "little")
        batch = msgspec.msgpack.decode(self._unpack.decompress(raw[16 : 16 + packed]))
        for message in batch["messages"]:
            self._paint(message)
            if message["type"] == "SetPositionMessage" and message["name"] == self._task.node:
                self.seen.positions.append((batch["timestampSec"], [round(x, 5) for x in message["position"]]))

    def _paint(self, message: dict[str, Any]) -> None:
        """Keep the last word on each property of each node and control, as a page does."""
        name = message.get("name") or message.get("uuid")
        if name is None:
            return
        if message["type"].startswith("Remove"):
            self.seen.picture.pop(name, None)
            return
        thing = self.seen.picture.setdefault(name, {})
        for key, value in message.items():
            if key in ("props", "updates"):
                thing.update(value)
            elif key not in ("type", "name", "uuid"):
                thing[key] = value

    def _send(self, message: dict[str, Any]) -> None:
        self._socket.send(msgspec.msgpack.encode(message))

    def _hold(self, _: float) -> None:
        self._send({"type": "GuiButtonHoldMessage", "uuid": self._task.button, "frequency": 30.0})

    def _slide(self, elapsed: float) -> None:
        value = 50.0 + 5.0 * (round(elapsed * SLIDER_RATE) % 3 - 1)
        self._send({"type": "GuiUpdateMessage", "uuid": self._task.slider, "updates": {"value": value}})

    def _drag(self, elapsed: float) -> None:
        if elapsed < ENTRY:
            return
        x, y, z = self._task.point
        turn = 2.0 * math.pi * (elapsed - ENTRY) / ROUND
        message: dict[str, Any] = {
            "type": "SceneNodeDragMessage",
            "phase": "update" if self.seen.sent else "start",
            "name": self._task.node,
            "instance_index": None,
            "start_position": [x, y, z],
            "start_screen_pos": [0.5, 0.5],
            "end_position": [x, y + RADIUS * math.sin(turn), z + RADIUS * (1.0 - math.cos(turn))],
            "end_screen_pos": [0.6, 0.5],
            "button": "left",
            "modifier": None,
            "owner": "",
        }
        self._send(message)
        self.seen.sent += 1


def watch(task: Task) -> Seen:
    """Wait, connect, and see to the end."""
    time.sleep(max(0.0, task.start - time.perf_counter()))
    viewer = Viewer(task)
    viewer.run()
    return viewer.seen


if __name__ == "__main__":
    json.dump(asdict(watch(Task(**json.loads(sys.stdin.readline())))), sys.stdout, default=repr)
