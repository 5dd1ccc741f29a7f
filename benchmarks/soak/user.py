"""A random user of the page: uses whatever is there, and sometimes leaves and comes back."""

import random
import time
from collections import Counter
from typing import Any

from websockets.exceptions import ConnectionClosed

from benchmarks.soak.client import FREE_DRIVE, HOLD_RATE, Client, usable
from benchmarks.soak.first_use import FirstUses

SPARED = ("Clock", "Speed", "Record", "Mounting", "Tilt [°]")
"""Not set at random: the clock is paused for a moment only, disks stay free, and the arm stands on the floor."""

PACE = 0.7  # mean time between two things that the operator does [s]
STAY = 60.0  # mean time for which a client stays [s]
ARRIVE = 2.0  # until it has seen what there is [s]
SPAN = 0.25  # how far the cursor is dragged, at most [m]


class User:
    """One client.

    Args:
        url: of the page.
        seed: of all that it does.
        idle: it only looks.
        first_uses: of the page: whoever is their operator does each as it is due, and nobody does anything else meanwhile.
        operator: it does them.
    """

    def __init__(
        self, url: str, seed: int, *, idle: bool = False, first_uses: FirstUses | None = None, operator: bool = False
    ) -> None:
        self.done: Counter[str] = Counter()
        self.stayed = False  # to the end that was asked for
        self._client = Client(url)
        self._random = random.Random(seed)
        self._idle = idle
        self._uses, self._operator = first_uses or FirstUses(), operator

    def run(self, end: float) -> None:
        """Use the page until `end`, of `time.monotonic`."""
        while time.monotonic() < end:
            self._come()
            try:
                self._stay(min(end, time.monotonic() + self._random.expovariate(1.0 / STAY)))
                self._client.go()
            except ConnectionClosed:
                self.done["thrown out"] += 1
        self.stayed = True

    def _come(self) -> None:
        self.done["come"] += 1
        self._client.come()
        self._client.look(ARRIVE)

    def _stay(self, end: float) -> None:
        acts = (self._set, self._push, self._hold, self._press, self._pause)
        while time.monotonic() < end:
            self._client.look(self._random.expovariate(1.0 / PACE))
            if self._operator and self._uses.due(time.monotonic()):
                self._uses.do(self._client, self._random)
            elif self._uses.hush.is_set():
                self._rest()
            elif not self._idle:
                act = self._random.choices(acts, (10, 4, 2, 1, 1))[0]
                act()
                self.done[act.__name__.strip("_")] += 1

    def _rest(self) -> None:
        """Somebody else wants to use the arm: let go of everything, and look on."""
        release = self._client.called("Release")
        if self._client.things[release].get("visible", True):
            self._client.set(release, True)

    def _set(self) -> None:
        """Use any control that can be used."""
        names = [n for n, t in self._client.things.items() if usable(t) and t.get("label") not in (*SPARED, "EMERGENCY STOP")]
        if names:
            self._use(self._random.choice(names))

    def _press(self) -> None:
        """Stop the arm, and reset it."""
        for label in ("EMERGENCY STOP", "Reset"):
            self._use(self._client.called(label))
            self._client.look(1.5)

    def _pause(self) -> None:
        """Stop the clock for a moment."""
        clock = self._client.called("Clock")
        for value in ("Freeze", "Step", "Go on"):
            self._client.set(clock, value)
            self._client.look(0.3)

    def _hold(self) -> None:
        """Hold the free-drive button, mostly for long enough."""
        for _ in range(round(HOLD_RATE * self._random.uniform(0.1, 3.5))):
            self._client.hold()
        self._use(self._client.called(*FREE_DRIVE))

    def _push(self) -> None:
        """Drag a link."""
        parts = [name for name, thing in self._client.things.items() if thing.get("drag") and "position" in thing]
        if not parts:
            return
        name = self._random.choice(parts)
        start = [float(x) for x in self._client.things[name]["position"]]
        way = [self._random.uniform(-SPAN, SPAN) for _ in range(3)]
        modifier = self._random.choice((None, None, None, "shift"))
        steps = round(HOLD_RATE * self._random.uniform(0.1, 2.5))
        for step in range(steps + 1):
            here = [x + d * step / max(steps, 1) for x, d in zip(start, way, strict=True)]
            self._client.drag("update" if step else "start", name, modifier=modifier, start=start, here=here)
            self._client.look(1.0 / HOLD_RATE)
        if self._random.random() < 0.9:  # else the end is lost
            self._client.drag("end", name, modifier=modifier, start=start, here=start)

    def _use(self, name: str) -> None:
        thing = self._client.things[name]
        if thing["kind"] == "RegisterCommandMessage":
            self._client.send({"type": "CommandTriggerMessage", "uuid": name})
        else:
            self._client.set(name, self._value(thing))

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
