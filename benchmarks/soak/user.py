"""A random user of the page: sees what a browser sees, uses whatever is there, and sometimes leaves and comes back.

It knows viser's messages, and nothing of the app but the names of a few controls.
"""

import random
import time
from collections import Counter
from typing import Any

import msgspec
import zstandard
from websockets.exceptions import ConnectionClosed
from websockets.sync.client import ClientConnection, connect

from benchmarks.viewer import CAMERA, VERSION

SPARED = ("Clock", "Speed", "Record", "Mounting", "Tilt [°]")
"""Not set at random: the clock is paused for a moment only, disks stay free, and the arm stands on the floor."""

FREE_DRIVE = ("Hold for free-drive", "Press to confirm")  # one button: what it is called depends on what is asked for

PACE = 0.7  # mean time between two things that the operator does [s]
STAY = 60.0  # mean time for which a client stays [s]
ARRIVE = 2.0  # until it has seen what there is [s]
HOLD_RATE = 20.0  # of the messages of a held button and of a drag, as a browser sends them [Hz]
SPAN = 0.25  # how far the cursor is dragged, at most [m]


class User:
    """One client.

    Args:
        url: of the page.
        seed: of all that it does.
        idle: it only looks.
    """

    def __init__(self, url: str, seed: int, idle: bool = False) -> None:
        self.done: Counter[str] = Counter()
        self.stayed = False  # to the end that was asked for
        self._url = url.replace("http", "ws", 1)
        self._random = random.Random(seed)
        self._idle = idle
        self._unpack = zstandard.ZstdDecompressor()
        self._things: dict[str, dict[str, Any]] = {}  # controls, keys and nodes, as they are shown
        self._socket: ClientConnection

    def run(self, end: float) -> None:
        """Use the page until `end`, of `time.monotonic`."""
        while time.monotonic() < end:
            self._come()
            try:
                self._stay(min(end, time.monotonic() + self._random.expovariate(1.0 / STAY)))
                self._socket.close()
            except ConnectionClosed:
                self.done["thrown out"] += 1
        self.stayed = True

    def _come(self) -> None:
        self.done["come"] += 1
        self._things.clear()
        self._socket = connect(self._url, subprotocols=[VERSION], max_size=None, proxy=None)
        self._send(CAMERA)
        self._look(ARRIVE)

    def _stay(self, end: float) -> None:
        acts = (self._set, self._push, self._hold, self._press, self._pause)
        while time.monotonic() < end:
            self._look(self._random.expovariate(1.0 / PACE))
            if not self._idle:
                act = self._random.choices(acts, (10, 4, 2, 1, 1))[0]
                act()
                self.done[act.__name__.strip("_")] += 1

    def _look(self, seconds: float) -> None:
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

    def _see(self, message: dict[str, Any]) -> None:
        name = message.get("uuid") or message.get("name")
        if name is None:
            return
        if message["type"].startswith("Remove"):
            self._things.pop(name, None)
            return
        kind = message["type"]
        thing = self._things.setdefault(name, {"kind": kind})
        thing.update(message.get("props", {}), **message.get("updates", {}))
        if kind == "SetPositionMessage":
            thing["position"] = message["position"]
        elif kind == "SetSceneNodeDragBindingsMessage":
            thing["drag"] = bool(message["bindings"])

    def _set(self) -> None:
        """Use any control that can be used."""
        names = [n for n, t in self._things.items() if usable(t) and t.get("label") not in (*SPARED, "EMERGENCY STOP")]
        if names:
            self._use(self._random.choice(names))

    def _press(self) -> None:
        """Stop the arm, and reset it."""
        for label in ("EMERGENCY STOP", "Reset"):
            self._use(self._called(label))
            self._look(1.5)

    def _pause(self) -> None:
        """Stop the clock for a moment."""
        clock = self._called("Clock")
        for value in ("Pause", "Step", "Run"):
            self._send({"type": "GuiUpdateMessage", "uuid": clock, "updates": {"value": value}})
            self._look(0.3)

    def _hold(self) -> None:
        """Hold the free-drive button, mostly for long enough."""
        button = self._called(*FREE_DRIVE)
        for _ in range(round(HOLD_RATE * self._random.uniform(0.1, 3.5))):
            self._send({"type": "GuiButtonHoldMessage", "uuid": button, "frequency": 30.0})
            self._look(1.0 / HOLD_RATE)
        self._use(button)

    def _push(self) -> None:
        """Drag a link."""
        parts = [name for name, thing in self._things.items() if thing.get("drag") and "position" in thing]
        if not parts:
            return
        name = self._random.choice(parts)
        start = [float(x) for x in self._things[name]["position"]]
        way = [self._random.uniform(-SPAN, SPAN) for _ in range(3)]
        modifier = self._random.choice((None, None, None, "shift"))
        steps = round(HOLD_RATE * self._random.uniform(0.1, 2.5))
        for step in range(steps + 1):
            here = [x + d * step / max(steps, 1) for x, d in zip(start, way, strict=True)]
            self._drag("update" if step else "start", name, modifier, start, here)
            self._look(1.0 / HOLD_RATE)
        if self._random.random() < 0.9:  # else the end is lost
            self._drag("end", name, modifier, start, start)

    def _drag(self, phase: str, name: str, modifier: str | None, start: list[float], here: list[float]) -> None:
        message = {"type": "SceneNodeDragMessage", "phase": phase, "name": name, "instance_index": None, "owner": ""}
        message |= {"start_position": start, "start_screen_pos": [0.5, 0.5], "button": "left", "modifier": modifier}
        self._send(message | {"end_position": here, "end_screen_pos": [0.6, 0.5]})

    def _called(self, *labels: str) -> str:
        return next(name for name, thing in self._things.items() if thing.get("label") in labels)

    def _use(self, name: str) -> None:
        thing = self._things[name]
        if thing["kind"] == "RegisterCommandMessage":
            self._send({"type": "CommandTriggerMessage", "uuid": name})
        else:
            self._send({"type": "GuiUpdateMessage", "uuid": name, "updates": {"value": self._value(thing)}})

    def _value(self, thing: dict[str, Any]) -> Any:
        """Any value that the control offers."""
        kind = thing["kind"]
        if kind == "GuiCheckboxMessage":
            return self._random.random() < 0.5
        if kind in ("GuiSliderMessage", "GuiNumberMessage"):
            return self._random.uniform(thing["min"], thing["max"])
        if kind in ("GuiDropdownMessage", "GuiButtonGroupMessage"):
            return self._random.choice(thing["options"])
        return self._random.choice(("<b>A</b>", "Über", "P1", "", "x" * 41)) if kind == "GuiTextMessage" else True

    def _send(self, message: dict[str, Any]) -> None:
        self._socket.send(msgspec.msgpack.encode(message))


def usable(thing: dict[str, Any]) -> bool:
    """Whether it is a control or a key that takes something."""
    kinds = ("Button", "Checkbox", "Slider", "Number", "Dropdown", "ButtonGroup", "Text")
    known = thing["kind"] == "RegisterCommandMessage" or thing["kind"] in [f"Gui{kind}Message" for kind in kinds]
    return known and thing.get("visible", True) and not thing.get("disabled", False)
