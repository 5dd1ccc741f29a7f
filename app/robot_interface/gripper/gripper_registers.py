"""What the port of a Robotiq gripper answers: registers that are set and read, a line at a time (GR-3).

`SET POS 255 SPE 128 FOR 50` sets registers, all or none, and is answered with `ack`; `GET POS` with `POS 255` and a line end.
What is no such line is answered with `?`. The registers are those of the gripper (Robotiq 2F-85 instruction manual, "Control
overview"); a `GET` needs no line end, since the maker's own programs send none.
"""

import re
import threading
from typing import Protocol

from sim.gripping.finger_drive import GripperState
from sim.plant.changes import DriveGripper

NUMBER = 63352
"""Of the port."""

FULL = 255
"""Largest value of a register: closed, fastest, strongest."""

ACK = b"ack"
UNKNOWN = b"?\n"
"""Answer to what is no line of the protocol."""

WRITTEN = {"ACT": 1, "GTO": 1, "ATR": 1, "ARD": 1, "MOD": 255, "POS": FULL, "SPE": FULL, "FOR": FULL, "SID": 9}
"""Registers that can be set, and the largest value of each."""

AT_START = {"ACT": 0, "GTO": 0, "ATR": 0, "ARD": 0, "MOD": 0, "POS": 0, "SPE": FULL, "FOR": FULL, "SID": 9}
"""What the same are before anybody has set them."""

CONSTANTS = {"LBP": 0, "LRD": 0, "LBL": 0, "LGN": 0, "MSC": 0, "COU": 0, "NCY": 0, "DST": 0, "PCO": 0}
"""Registers that a simulated gripper has no use for: lamps, motor current, counters."""

TEXTS = {"SNU": "S-0", "FWV": "GC3-0", "VER": "1.0"}
"""Serial number, firmware and version."""

SLAVES = b"[9]".ljust(17)
"""Answer to `GET SID`: the grippers that are connected. Programs read 17 bytes of it."""

NOT_ACTIVATED, RELEASED = 0x07, 0x0F
"""Faults: it is asked to move before it is activated; it has been released automatically (instruction manual, "Fault status")."""

BARE_GET = re.compile(r"\s*GET\s+[A-Z]{3}")
LATE = 2  # ticks after which the state shows what an order did
LONGEST = 1024
"""Of a line [bytes]."""


class GripperPort(Protocol):
    """The gripper of a robot, as its port drives it."""

    @property
    def gripper(self) -> GripperState | None:
        """As it was after the last tick; None: there is none."""
        ...

    def drive(self, change: DriveGripper) -> None:
        """Have it do something in the next tick."""
        ...

    @property
    def ticks(self) -> int:
        """Done so far."""
        ...


class GripperRegisters:
    """The registers of one gripper, for all of its clients. Every method may be called from any thread."""

    def __init__(self, port: GripperPort) -> None:
        self._port = port
        self._lock = threading.Lock()
        self._set = dict(AT_START)
        self._fault = 0
        self._activating = False
        self._ordered = -LATE  # tick of the last order

    @property
    def there(self) -> bool:
        """There is a gripper."""
        return self._port.gripper is not None

    def begin(self) -> None:
        """The simulation starts over: nothing has been set, and the gripper is not activated."""
        with self._lock:
            self._set, self._fault, self._activating, self._ordered = dict(AT_START), 0, False, -LATE

    def answer(self, line: str) -> bytes:
        """What is said to a line, without its end."""
        words = line.split()
        state = self._port.gripper
        with self._lock:
            if state is not None and len(words) == 2 and words[0] == "GET":
                return self._read(words[1], state)
            if state is not None and len(words) >= 3 and len(words) % 2 == 1 and words[0] == "SET":
                return self._write(words[1:], state)
        return UNKNOWN

    def _read(self, name: str, state: GripperState) -> bytes:
        if name == "SID":
            return SLAVES
        if name in TEXTS:
            return f"{name} {TEXTS[name]}\n".encode()
        value = self._told(state).get(name)
        return UNKNOWN if value is None else f"{name} {value}\n".encode()

    def _told(self, state: GripperState) -> dict[str, int]:
        """All that can be read."""
        own = self._set
        moving = self._moving(state)
        at = place_of(state)
        active = 0 if not own["ACT"] else 1 if self._activating else 3
        found = 0 if moving else 2 if state.held else 3
        return {**CONSTANTS, **own, "POS": at, "PRE": own["POS"], "OBJ": found, "STA": active, "FLT": self._fault}

    def _moving(self, state: GripperState) -> bool:
        """It moves, or is about to. An activation is over where it does neither."""
        moving = state.moving or self._port.ticks < self._ordered + LATE
        if not moving:
            self._activating = False
        return moving

    def _write(self, words: list[str], state: GripperState) -> bytes:
        """Set registers, all or none."""
        wanted: dict[str, int] = {}
        for name, text in zip(words[::2], words[1::2], strict=True):
            most = WRITTEN.get(name)
            if most is None or not re.fullmatch(r"\d{1,3}", text, re.ASCII) or int(text) > most:
                return UNKNOWN
            wanted[name] = int(text)
        self._moving(state)  # an activation that is over, and that nobody has asked about, is over here
        before, own = dict(self._set), self._set
        own.update(wanted)
        if own["ACT"] and not before["ACT"]:  # it opens, to find its ends
            self._fault, self._activating = 0, True
            self._drive(DriveGripper(command="open"))
        elif before["ACT"] and not own["ACT"]:
            self._fault, self._activating = 0, False
            self._drive(DriveGripper(command="stop"))
        if own["ATR"] and not before["ATR"]:
            self._fault = RELEASED
            self._drive(DriveGripper(command="open"))
        elif wanted.keys() & {"POS", "GTO", "SPE", "FOR"}:
            self._go(wanted, before, state)
        return ACK

    def _go(self, wanted: dict[str, int], before: dict[str, int], state: GripperState) -> None:
        """Move to the position that is set, where it may."""
        own = self._set
        if not own["ACT"]:
            if own["GTO"] and wanted.keys() & {"POS", "GTO"}:
                self._fault = NOT_ACTIVATED
        elif self._fault != RELEASED:
            if own["GTO"]:
                self._drive(moving_to(own["POS"], own["SPE"], own["FOR"], state.stroke))
            elif before["GTO"]:
                self._drive(DriveGripper(command="stop"))

    def _drive(self, change: DriveGripper) -> None:
        self._ordered = self._port.ticks
        self._port.drive(change)


def place_of(state: GripperState) -> int:
    """The register of the position: 0 open, 255 closed; of a cup 255 while it draws."""
    if not state.stroke:
        return FULL if state.closing else 0
    return round(FULL * (1.0 - state.opening / state.stroke))


def moving_to(place: int, speed: int, force: int, stroke: float) -> DriveGripper:
    """The order that the registers of position, speed and force give: each from the least to the most that the gripper can."""
    if not stroke:
        return DriveGripper(command="close" if place else "open")
    return DriveGripper(opening=stroke * (1.0 - place / FULL), speed_share=speed / FULL, force_share=force / FULL)


class GripperLines:
    """What one client of a gripper has said, cut into lines.

    Args:
        registers: that answer.
    """

    def __init__(self, registers: GripperRegisters) -> None:
        self._registers, self._left = registers, b""

    def hear(self, data: bytes) -> bytes | None:
        """What is answered to bytes that have come; None: a line is too long."""
        *lines, self._left = (self._left + data).replace(b"\r", b"\n").split(b"\n")
        if len(self._left) > LONGEST or any(len(line) > LONGEST for line in lines):
            return None
        if BARE_GET.fullmatch(left := self._left.decode("ascii", "replace")):
            lines.append(left.encode())
            self._left = b""
        texts = [line.decode("ascii", "replace") for line in lines]
        return b"".join(self._registers.answer(text) for text in texts if text.strip())
