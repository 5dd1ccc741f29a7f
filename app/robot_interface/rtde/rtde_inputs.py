"""RTDE's inputs: who owns which, what a package of them does to the robot, and the keep-alive of free-drive."""

import math
import struct
import threading
from collections.abc import Sequence

from app.robot_interface.controller.cabinet import Cabinet
from app.robot_interface.controller.callers import Ask
from app.robot_interface.controller.field_record import VOLTS
from app.robot_interface.controller.rtde_fields import INPUTS, OUTPUTS
from app.robot_interface.controller.status_fields import set_analog_output, set_outputs
from app.robot_interface.rtde.rtde_messages import Malformed
from pendant.settings.schema import ticks

FREE_DRIVE = "input_bit_register_127"
"""The register that asks for free-drive, as a UR's input action "Freedrive" on a general purpose register does."""

KEEP_ALIVE = ticks(0.5)
"""Free-drive ends when its register is not written for so long: a UR's rtde_set_watchdog at 2 Hz with the action "stop"."""

STRUCTS = {
    "BOOL": "B",
    "UINT8": "B",
    "UINT32": "I",
    "UINT64": "Q",
    "INT32": "i",
    "DOUBLE": "d",
    "VECTOR6D": "6d",
}

OUTPUT_WORDS = {"standard_digital_output": (0, 8), "configurable_digital_output": (8, 8), "tool_digital_output": (16, 2)}
"""Outputs that a mask guards: their first bit among all digital outputs, and how many they are."""


class Recipe:
    """Inputs that one connection sends together."""

    def __init__(self, names: Sequence[str]) -> None:
        self.names = tuple(names)
        self._struct = struct.Struct(">" + "".join(STRUCTS[INPUTS[name]] for name in names))
        self._counts = [6 if INPUTS[name] == "VECTOR6D" else 1 for name in names]

    def values(self, payload: bytes) -> dict[str, float | tuple[float, ...]]:
        """What a package says, by name.

        A package that is shorter or longer than its recipe is read as far as both go: clients send such.

        Raises:
            Malformed: a number is not finite.
        """
        size = self._struct.size
        numbers = iter(self._struct.unpack(payload[:size].ljust(size, b"\0")))
        found: dict[str, float | tuple[float, ...]] = {}
        left = len(payload)
        for name, count in zip(self.names, self._counts, strict=True):
            value = tuple(next(numbers) for _ in range(count))
            if not all(map(math.isfinite, value)):
                raise Malformed(f"{name} = {value}: expected finite numbers")
            left -= struct.calcsize(">" + STRUCTS[INPUTS[name]])
            if left < 0:
                break
            found[name] = value if count > 1 else value[0]
        return found


class RtdeInputs:
    """All inputs of the one robot. Every method may be called from any thread."""

    def __init__(self, cabinet: Cabinet) -> None:
        self._cabinet = cabinet
        self._lock = threading.Lock()
        self._owners: dict[str, int] = {}  # number of the connection, by name

    def claim(self, names: Sequence[str], owner: int) -> list[str]:
        """Types of inputs for a recipe of `owner`, or NOT_FOUND, IN_USE; without any of these two it owns them from now on."""
        with self._lock:
            kinds = [
                "NOT_FOUND" if name not in INPUTS else "IN_USE" if self._owners.get(name, owner) != owner else INPUTS[name]
                for name in names
            ]
            if not {"NOT_FOUND", "IN_USE"} & set(kinds):
                self._owners.update(dict.fromkeys(names, owner))
            return kinds

    def release(self, owner: int) -> None:
        """A connection is over: what it owned is free, and nobody asks for free-drive there any more."""
        with self._lock:
            if self._owners.get(FREE_DRIVE) == owner:
                self._cabinet.free_drive_until = 0
            self._owners = {name: who for name, who in self._owners.items() if who != owner}

    def write(self, values: dict[str, float | tuple[float, ...]]) -> None:
        """Take the inputs of one package."""
        put, writes = self._cabinet.record.put, self._cabinet.writes
        for name, value in values.items():
            writes[name] = writes.get(name, 0) + 1
            if name in OUTPUTS:
                put(name, value if OUTPUTS[name] != "BOOL" else bool(value))
        for name, (first, count) in OUTPUT_WORDS.items():
            mask = int(_one(values, f"{name}_mask")) & ((1 << count) - 1)
            if mask:
                set_outputs(self._cabinet.record, mask << first, int(_one(values, name)) << first)
        mask, kinds = int(_one(values, "standard_analog_output_mask")), "standard_analog_output_type"
        volts = int(_one(values, kinds)) if kinds in values else VOLTS
        for i in (0, 1):
            if mask >> i & 1:
                share = _one(values, f"standard_analog_output_{i}")
                set_analog_output(self._cabinet.record, i, share, volts=bool(volts >> i & 1))
        if _one(values, "speed_slider_mask"):
            share = min(max(_one(values, "speed_slider_fraction"), 0.0), 1.0)
            self._cabinet.ask(Ask(settings={"program.speed": share}))
        if FREE_DRIVE in values:
            self._cabinet.free_drive_until = self._cabinet.ticks + KEEP_ALIVE if values[FREE_DRIVE] else 0


def _one(values: dict[str, float | tuple[float, ...]], name: str) -> float:
    """A single number of a package, 0 where it is not in it."""
    value = values.get(name, 0)
    return 0.0 if isinstance(value, tuple) else value
