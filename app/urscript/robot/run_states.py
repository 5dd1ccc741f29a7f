"""What programs have set up of the robot's signals, and what stays so when they are over: run states and input actions."""

from enum import Enum

from app.robot_interface.controller.cabinet import Cabinet
from app.robot_interface.controller.status_fields import in_volts, read_bit, set_analog_output, set_outputs, write_bit
from app.urscript.outside.modbus_units import ModbusUnits
from pendant.settings.schema import ticks

LOW_STOPPED, HIGH_STOPPED, HIGH_RUNNING = 1, 2, 3
"""Choices of a run state: low or high while no program runs; high while one runs, and low while none does. A register that is low
is 0, one that is high is 1."""

KEPT = ticks(0.1)
"""An input's wish for free-drive lasts so long after it was seen: some ticks more than one."""


class OutputKind(Enum):
    """Of an output whose state follows the program's."""

    DIGITAL = "digital"
    ANALOG = "analog"
    REGISTER = "register"
    MODBUS = "modbus"


class InstalledSignals:
    """Of one robot; a program sets it up, and it stays until another program, or a start over.

    Args:
        cabinet: the robot.
        units: its Modbus signals.
    """

    def __init__(self, cabinet: Cabinet, units: ModbusUnits) -> None:
        self._cabinet, self._units = cabinet, units
        self._states: dict[tuple[OutputKind, int | str], int] = {}
        self._inputs: frozenset[tuple[OutputKind, int | str]] = frozenset()  # that ask for free-drive

    def choose(self, kind: OutputKind, number: int | str, state: int) -> None:
        """Set how an output follows the program's state, by number or name; it does so at once."""
        self._states[kind, number] = state
        if state == HIGH_RUNNING:
            self._put(kind, number, on=True)

    def free_drive_by(self, kind: OutputKind, number: int | str, *, on: bool) -> None:
        """Whether an input asks for free-drive while it is high."""
        chosen = frozenset({(kind, number)})
        self._inputs = self._inputs | chosen if on else self._inputs - chosen

    def no_free_drive(self) -> None:
        """No input asks for free-drive."""
        self._inputs = frozenset()

    def begin(self) -> None:
        """A program begins."""
        self._follow(HIGH_RUNNING, on=True)

    def end(self) -> None:
        """No program runs any more."""
        self._follow(LOW_STOPPED, on=False)
        self._follow(HIGH_STOPPED, on=True)
        self._follow(HIGH_RUNNING, on=False)

    def step(self) -> None:
        """One tick: inputs that ask for free-drive are looked at."""
        if self._inputs and any(self._high(kind, number) for kind, number in self._inputs):
            self._cabinet.free_drive_by_input = self._cabinet.ticks + KEPT

    def _follow(self, choice: int, *, on: bool) -> None:
        for (kind, number), state in self._states.items():
            if state == choice:
                self._put(kind, number, on=on)

    def _put(self, kind: OutputKind, number: int | str, *, on: bool) -> None:
        record = self._cabinet.record
        if isinstance(number, str):
            if number in self._units:
                self._units.write(number, [int(on)] * self._units.signal(number).taken, lasting=True)
        elif kind is OutputKind.DIGITAL:
            set_outputs(record, 1 << number, on << number)
        elif kind is OutputKind.ANALOG:
            set_analog_output(record, number, float(on), volts=in_volts(record, number))
        else:
            write_bit(record, number, on)

    def _high(self, kind: OutputKind, number: int | str) -> bool:
        record = self._cabinet.record
        if isinstance(number, str):
            return number in self._units and self._units.signal(number).valid and any(self._units.signal(number).values)
        if kind is OutputKind.REGISTER:
            return read_bit(record, "input", number)
        return bool(int(record.field("actual_digital_input_bits").item()) >> number & 1)
