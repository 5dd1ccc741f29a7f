"""Functions of Modbus signals (URScript manual, module interfaces)."""

import re
from collections.abc import Callable, Generator, Iterator, Sequence

from app.urscript.language.trouble import Misuse
from app.urscript.machine.signature import Builtin, Taken, any_value, boolean, builtin, integer, items, number, text, within
from app.urscript.machine.values import Value
from app.urscript.outside.hosts import AllowedHosts
from app.urscript.outside.modbus_client import (
    FASTEST,
    PORT,
    UNREACHABLE,
    CustomRequest,
    ModbusSignal,
    SignalKind,
    UnitPlace,
    send_custom,
)
from app.urscript.outside.modbus_units import ModbusUnits
from pendant.tick.modes import TICK_RATE

LONGEST_NAME = 20
MOST_REGISTERS = 123
"""Of a signal (URScript manual, modbus_add_rw_signal)."""

RECONNECTING = 10.0
"""modbus_reset_connection() waits so long for signals without errors [s]; a robot waits without end."""

DEVICE, WORD = within(integer, 0, 255), within(integer, 0, 65535)


def of_modbus(units: ModbusUnits, hosts: AllowedHosts) -> Iterator[Builtin]:
    """All but those that follow the program's state."""

    def place(ip: str) -> UnitPlace:
        """Where a unit is; the port may be left out."""
        host, _, port = ip.rpartition(":") if ip.count(":") == 1 else (ip, "", "")
        if port and not (re.fullmatch(r"\d{1,5}", port, re.ASCII) and 0 < int(port) < 1 << 16):
            raise Misuse(f"IP: {ip[:50]!r}; expected ADDRESS or ADDRESS:PORT")
        address = hosts.reached(host)
        return UnitPlace(address or host, int(port or PORT), address is not None)

    def add(*given: Value) -> None:
        ip, device, address, kind, name, _, count = given
        units.add(place(ip), ModbusSignal(name, SignalKind(kind), device, address, count))

    def add_both(*given: Value) -> None:
        ip, device, read_at, read_count, write_at, write_count, name, _ = given
        signal = ModbusSignal(name, SignalKind.REGISTER_OUTPUT, device, read_at, read_count)
        signal.written_at, signal.written_count = write_at, write_count
        units.add(place(ip), signal)

    def status(name: str, _: Value) -> Value:
        signal, found = units.signal(name), units.read(name)
        values = tuple(map(bool, found)) if signal.kind.digital else found
        return values[0] if signal.count == 1 else values

    def put(kind: SignalKind, check: Callable[[Value], Value]) -> Callable[[str, Value, Value], None]:
        def write(name: str, value: Value, _: Value) -> None:
            signal = units.signal(name)
            if signal.kind is not kind:
                raise Misuse(f"signal_name: {name} is no {'digital' if kind.digital else 'register'} output")
            found: Sequence[Value] = value if type(value) is tuple else (value,)
            if len(found) != signal.taken:
                raise Misuse(f"{len(found)} values, the signal has {signal.taken}")
            words = [int(check(each)) & 0xFFFF for each in found]
            if hosts.reached(units.place(name).address) is not None:
                units.write(name, words)

        return write

    def custom(ip: str, device: int, function: int, data: Value) -> None:
        request = CustomRequest(function, bytes(map(DEVICE, data)), device)
        unit = place(ip)
        if unit.allowed:
            send_custom(unit.address, unit.port, request)

    def frequency(name: str, wanted: float) -> None:
        if hosts.reached(units.place(name).address) is not None:
            units.signal(name).frequency = wanted
            units.refresh(name)

    def watchdog(name: str, seconds: float) -> None:
        units.signal(name).watchdog = seconds

    def error(name: str, source: int) -> int:
        signal = units.signal(name)
        connection = 0 if signal.connected else UNREACHABLE
        return {0: connection or signal.device_error, 1: signal.device_error, 2: connection}[source]

    def reset(ip: str, blocking: bool) -> Generator[None, None, None]:
        found = units.units_at(place(ip))
        if not found:
            raise Misuse(f"connection_id: there is no signal at {ip[:50]}")
        for unit in found:
            unit.reset()
        left = round(RECONNECTING * TICK_RATE) if blocking else 0
        while left and not all(signal.valid for unit in found for signal in unit.signals):
            left -= 1
            yield
            if left == 0:
                raise Misuse(f"the signals at {ip[:50]} have errors for {RECONNECTING:g} s")

    ip, device, address = Taken("IP", text), Taken("slave_number", DEVICE), Taken("signal_address", WORD)
    name, inside = Taken("signal_name", _name), Taken("is_secondary_program", any_value, False)
    sequential = Taken("sequential_mode", boolean, False)
    count = within(integer, 1, MOST_REGISTERS)
    kind = Taken("signal_type", within(integer, 0, 3))
    yield builtin("modbus_add_signal", add, ip, device, address, kind, name, sequential, Taken("register_count", count, 1))
    yield builtin(
        "modbus_add_rw_signal",
        add_both,
        ip,
        device,
        Taken("read_address", WORD),
        Taken("read_register_count", count),
        Taken("write_address", WORD),
        Taken("write_register_count", count),
        name,
        sequential,
    )
    yield builtin("modbus_delete_signal", units.delete, name)
    yield builtin("modbus_get_signal_status", status, name, inside)
    register, digital = Taken("register_value", any_value), Taken("digital_value", any_value)
    word = within(integer, -(1 << 15), (1 << 16) - 1)
    yield builtin("modbus_set_output_register", put(SignalKind.REGISTER_OUTPUT, word), name, register, inside)
    yield builtin("modbus_set_output_signal", put(SignalKind.DIGITAL_OUTPUT, boolean), name, digital, inside)
    function = Taken("function_code", within(integer, 1, 127))
    yield builtin("modbus_send_custom_command", custom, ip, device, function, Taken("data", items))
    often = Taken("update_frequency", within(number, -1.0, FASTEST))
    yield builtin("modbus_set_signal_update_frequency", frequency, name, often)
    yield builtin("modbus_set_signal_watchdog", watchdog, name, Taken("new_timeout_in_sec", within(number, 0.0, 300.0)))
    yield builtin("modbus_get_error", error, name, Taken("error_source", within(integer, 0, 2), 0))
    yield builtin("modbus_get_time_since_signal_invalid", lambda name: units.invalid_for(units.signal(name)), name)
    yield builtin(
        "modbus_reset_connection", reset, Taken("connection_id", text), Taken("is_blocking", boolean, True), takes_time=True
    )


def _name(value: Value) -> str:
    found = text(value)
    if not 0 < len(found) <= LONGEST_NAME:
        raise Misuse(f"{found[:30]!r} has {len(found)} characters, allowed: 1 to {LONGEST_NAME}")
    return found
