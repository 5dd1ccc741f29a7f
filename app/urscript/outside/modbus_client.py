"""Modbus signals of a unit that the robot supervises: a thread for each unit reads and writes them, and no tick waits for one.

The client is pymodbus. A program looks at what was read last, and hands over what is to be written.
"""

import contextlib
import logging
import struct
import threading
import time
from dataclasses import dataclass
from enum import IntEnum
from typing import NamedTuple

from pymodbus.client import ModbusTcpClient
from pymodbus.exceptions import ModbusException
from pymodbus.pdu import ModbusPDU

PORT = 502
"""Of a unit whose address names no other."""

PATIENCE = 1.0
"""Time that a unit has for a connection, and for each answer [s]."""

AGAIN = 0.2
"""Between two attempts to connect [s]."""

FREQUENCY = 10.0
"""With which a signal is read, unless a program says otherwise [1/s]."""

FASTEST = 125.0
"""With which it can be read (URScript manual, modbus_set_signal_update_frequency) [1/s]."""

WATCHDOG = 2.0
"""Time for which a signal may be out of order [s]; who reads it after that ends the program (URScript manual,
modbus_get_signal_status and modbus_set_signal_watchdog)."""

UNREACHABLE = 100
"""What modbus_get_error() tells of a unit that does not answer. From 1 to 6 are the exceptions of the protocol."""

WRONG = (ModbusException, OSError, ValueError, IndexError, TypeError, struct.error)
"""What an answer may lead to that is none."""

logging.getLogger("pymodbus").addHandler(logging.NullHandler())  # errors are told by the signals


class SignalKind(IntEnum):
    """Of a signal, by its number in the language."""

    DIGITAL_INPUT = 0
    DIGITAL_OUTPUT = 1
    REGISTER_INPUT = 2
    REGISTER_OUTPUT = 3

    @property
    def digital(self) -> bool:
        """It is bits."""
        return self <= SignalKind.DIGITAL_OUTPUT

    @property
    def output(self) -> bool:
        """It can be written."""
        return self in (SignalKind.DIGITAL_OUTPUT, SignalKind.REGISTER_OUTPUT)


@dataclass(slots=True)
class ModbusSignal:
    """Some bits or registers of a unit in a row."""

    name: str
    kind: SignalKind
    device: int  # number of the device behind the address
    address: int
    count: int = 1
    written_at: int = -1  # address of what is written in the same request as is read (function 23); -1: none
    written_count: int = 0
    frequency: float = FREQUENCY  # 0 or less: once [1/s]
    watchdog: float = WATCHDOG  # [s]
    values: tuple[int, ...] = ()  # read last
    wanted: tuple[int, ...] | None = None  # to be written
    lasting: bool = False  # what is wanted stays so until the unit is there: the program's state
    device_error: int = 0  # exception of the protocol
    connected: bool = False  # the last request was answered
    due: float = 0.0  # when it is read next [s]
    seen: float = 0.0  # the robot's clock when it was in order last [s]
    told: bool = False  # to people: that it has been out of order for longer than it may be

    @property
    def taken(self) -> int:
        """How many values it takes when it is written."""
        return self.written_count or self.count

    @property
    def valid(self) -> bool:
        """It was read, and written, without an error."""
        return self.connected and self.device_error == 0

    def fail(self) -> None:
        """A request was not answered: what a program wanted written is not written later."""
        self.connected = False
        if not self.lasting:
            self.wanted = None


class CustomRequest(ModbusPDU):
    """A request that a program has put together itself."""

    def __init__(self, function: int, data: bytes, device: int) -> None:
        super().__init__(dev_id=device)
        self.function_code, self._data = function, data

    def encode(self) -> bytes:
        """Its bytes after the function code."""
        return self._data


class UnitPlace(NamedTuple):
    """Where a unit is."""

    address: str  # as the program wrote it, where it may not be called
    port: int
    allowed: bool  # it may be called


class AbsentUnit:
    """A unit that may not be called: nothing is sent, and its signals stay out of order."""

    def __init__(self, place: UnitPlace) -> None:
        self.place = place
        self.signals: tuple[ModbusSignal, ...] = ()

    def _nothing(self) -> None:
        """There is nobody to talk to."""

    start = hurry = reset = end = _nothing


class ModbusUnit(threading.Thread):
    """A unit at a place, and its signals. Attributes of a signal are set whole, from either side."""

    def __init__(self, place: UnitPlace) -> None:
        super().__init__(name=f"modbus {place.address}", daemon=True)
        self.place = place
        self.signals: tuple[ModbusSignal, ...] = ()
        self._wake, self._over, self._afresh = threading.Event(), False, False

    def hurry(self) -> None:
        """There is something to be done."""
        self._wake.set()

    def reset(self) -> None:
        """Connect anew."""
        for signal in self.signals:
            signal.connected = False
        self._afresh = True
        self._wake.set()

    def end(self) -> None:
        """It is used no more."""
        self._over = True
        self._wake.set()

    def run(self) -> None:
        """Read and write what is due, until it is over."""
        client = ModbusTcpClient(self.place.address, port=self.place.port, timeout=PATIENCE, retries=0)
        try:
            while not self._over:
                self._wake.clear()
                if self._afresh:
                    self._afresh = False
                    client.close()
                self._wake.wait(self._served(client))
        finally:
            client.close()

    def _served(self, client: ModbusTcpClient) -> float:
        """Serve all signals that are due; time until the next one is [s]."""
        with contextlib.suppress(*WRONG):
            if client.connected or client.connect():
                return self._exchanged(client)
        for signal in self.signals:
            signal.fail()
        return AGAIN

    def _exchanged(self, client: ModbusTcpClient) -> float:
        soonest = time.monotonic() + 1.0
        for signal in self.signals:
            if self._over or self._afresh:
                break
            wanted = signal.wanted
            if wanted is not None or time.monotonic() >= signal.due:
                try:
                    self._exchange(client, signal, wanted)
                except WRONG:
                    signal.fail()
                    signal.due = time.monotonic() + AGAIN
                    client.close()  # what still comes would be taken for the next answer
                    return 0.0
                if wanted is not None and signal.wanted is wanted:
                    signal.wanted = None
                once = signal.frequency <= 0.0
                signal.due = float("inf") if once else time.monotonic() + 1.0 / min(signal.frequency, FASTEST)
            soonest = min(soonest, signal.due)
        return max(soonest - time.monotonic(), 1e-4)

    def _exchange(self, client: ModbusTcpClient, signal: ModbusSignal, wanted: tuple[int, ...] | None) -> None:
        """Write what is wanted, then read. Raises one of WRONG: there was no answer."""
        answers = [] if wanted is None or signal.written_at >= 0 else [_written(client, signal, wanted)]
        answers.append(_read(client, signal, wanted))
        signal.device_error = next((answer.exception_code for answer in answers if answer.isError()), 0)
        last = answers[-1]
        if not last.isError():
            found = last.bits if signal.kind.digital else last.registers
            if len(found) < signal.count:
                raise ValueError("an answer that is too short")
            signal.values = tuple(map(int, found[: signal.count]))
        signal.connected = True


def _written(client: ModbusTcpClient, signal: ModbusSignal, wanted: tuple[int, ...]) -> ModbusPDU:
    at, device = signal.address, signal.device
    if signal.kind.digital:
        bits = [bool(value) for value in wanted]
        one = client.write_coil(at, bits[0], device_id=device) if len(bits) == 1 else None
        return client.write_coils(at, bits, device_id=device) if one is None else one
    if len(wanted) == 1:
        return client.write_register(at, wanted[0], device_id=device)
    return client.write_registers(at, list(wanted), device_id=device)


def _read(client: ModbusTcpClient, signal: ModbusSignal, wanted: tuple[int, ...] | None) -> ModbusPDU:
    at, count, device = signal.address, signal.count, signal.device
    if signal.written_at >= 0 and wanted is not None:
        return client.readwrite_registers(
            read_address=at, read_count=count, write_address=signal.written_at, values=list(wanted), device_id=device
        )
    reads = {
        SignalKind.DIGITAL_INPUT: client.read_discrete_inputs,
        SignalKind.DIGITAL_OUTPUT: client.read_coils,
        SignalKind.REGISTER_INPUT: client.read_input_registers,
        SignalKind.REGISTER_OUTPUT: client.read_holding_registers,
    }
    return reads[signal.kind](at, count=count, device_id=device)


def send_custom(address: str, port: int, request: CustomRequest) -> None:
    """Send a request of a program's own on a connection of its own, in a thread; what is answered is not heard."""

    def send() -> None:
        client = ModbusTcpClient(address, port=port, timeout=PATIENCE, retries=0)
        with contextlib.suppress(*WRONG):
            if client.connect():
                client.execute(True, request)
        client.close()

    threading.Thread(target=send, name="modbus custom", daemon=True).start()
