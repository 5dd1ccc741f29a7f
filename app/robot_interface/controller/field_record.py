"""All of RTDE's output fields of one tick, big-endian in one piece of memory, so that a recipe is a choice of its bytes."""

import threading
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from app.robot_interface.controller.rtde_fields import CONSTANTS, FORMATS, OUTPUTS, SIZES

Array = NDArray[np.float64]

BEGIN = 100.0
"""What the controller's clock shows at the start [s]: clients take one of less than 40 s for a robot that still boots."""

VOLTS = 0b1111
"""Of `analog_io_types`: inputs 0 and 1, outputs 0 and 1 are volts; a bit that is 0 means amperes."""


class FieldRecord:
    """A value for each output field.

    One thread writes a field: the network's the inputs that a client may set, the loop's all else. Outputs are the exception, for
    both switch them: whoever reads, changes and writes one holds `lock` (docs/explanation/threads.md).
    """

    def __init__(self) -> None:
        self.lock = threading.Lock()
        self._at: dict[str, int] = {}
        size = 0
        for name, kind in OUTPUTS.items():
            self._at[name] = size
            size += SIZES[kind]
        self._bytes = np.zeros(size, dtype=np.uint8)
        self._fields = {
            name: np.ndarray((), FORMATS[kind], self._bytes.data, self._at[name])
            if FORMATS[kind][0] not in "36"
            else np.ndarray(int(FORMATS[kind][0]), FORMATS[kind][1:], self._bytes.data, self._at[name])
            for name, kind in OUTPUTS.items()
        }
        for name, value in CONSTANTS.items():
            self.put(name, value)
        self.put("timestamp", BEGIN)
        self.put("analog_io_types", VOLTS)

    def put(self, name: str, value: float | Sequence[float] | Array) -> None:
        """Set an output field; KeyError: there is none of this name."""
        self._fields[name][...] = value

    def get(self, name: str) -> float | list[float]:
        """The value of an output field, a vector as a list."""
        return self._fields[name].tolist()

    def field(self, name: str) -> Array:
        """The place of an output field itself: it shows what is put there later, and can be written.

        KeyError: there is none of this name.
        """
        return self._fields[name]

    def where(self, names: Sequence[str]) -> NDArray[np.int64]:
        """Places of the bytes of some fields, in this order: what `taken` wants."""
        spans = [np.arange(self._at[name], self._at[name] + SIZES[OUTPUTS[name]]) for name in names]
        return np.concatenate(spans) if spans else np.zeros(0, dtype=np.int64)

    def taken(self, places: NDArray[np.int64]) -> bytes:
        """The bytes at `places`, in their order."""
        return self._bytes[places].tobytes()
