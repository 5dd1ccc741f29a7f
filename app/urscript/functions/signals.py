"""Functions of registers, inputs and outputs (URScript manual, module interfaces)."""

from collections.abc import Callable, Iterator
from functools import partial

from app.robot_interface.controller.field_record import FieldRecord
from app.robot_interface.controller.rtde_fields import BITS
from app.robot_interface.controller.status_fields import in_volts, read_bit, set_analog_output, set_outputs, write_bit
from app.urscript.language.trouble import Misuse
from app.urscript.machine.signature import Builtin, Taken, boolean, builtin, integer, number, within
from app.urscript.machine.values import Value
from app.urscript.robot.robot_side import RobotSide

REGISTERS = 48

TOOL_AFTER, TOOL_FIRST = 8, 16
"""Where the tool's digital signals begin: at number 8 in the older functions, at bit 16 in RTDE's record."""

PLACE, BIT = Taken("address", integer), Taken("address", within(integer, 0, BITS - 1))


def of_registers(record: FieldRecord) -> Iterator[Builtin]:
    """General purpose registers; clients read them by RTDE."""
    for way in ("input", "output"):
        whole = [record.field(f"{way}_int_register_{k}") for k in range(REGISTERS)]
        real = [record.field(f"{way}_double_register_{k}") for k in range(REGISTERS)]
        yield builtin(f"read_{way}_integer_register", _reader([each.item for each in whole]), PLACE)
        yield builtin(f"read_{way}_float_register", _reader([each.item for each in real]), PLACE)
        yield builtin(f"read_{way}_boolean_register", partial(read_bit, record, way), BIT)
    yield builtin("write_output_integer_register", _writer(record, "int"), PLACE, Taken("value", integer))
    yield builtin("write_output_float_register", _writer(record, "double"), PLACE, Taken("value", number))
    yield builtin("write_output_boolean_register", partial(write_bit, record), BIT, Taken("value", boolean))


def _reader(items: list[Callable[[], Value]]) -> Callable[[int], Value]:
    def read(address: int) -> Value:
        if 0 <= address < REGISTERS:
            return items[address]()
        raise Misuse(f"address {address} is out of range, allowed: 0 to {REGISTERS - 1}")

    return read


def _writer(record: FieldRecord, kind: str) -> Callable[[int, float], None]:
    places = [record.field(f"output_{kind}_register_{k}") for k in range(REGISTERS)]

    def write(address: int, value: float) -> None:
        if not 0 <= address < REGISTERS:
            raise Misuse(f"address {address} is out of range, allowed: 0 to {REGISTERS - 1}")
        if kind == "int" and not -(1 << 31) <= value < 1 << 31:
            raise Misuse(f"value {value} is beyond what an integer register holds")
        places[address][...] = value

    return write


def of_inputs_and_outputs(robot: RobotSide) -> Iterator[Builtin]:
    """Digital and analog inputs and outputs, flags."""
    record = robot.record
    flags = robot.memory.flags
    rows = {"standard": (0, 8), "configurable": (8, 8), "tool": (16, 2)}
    for name, (first, count) in rows.items():
        n = Taken("n", within(integer, 0, count - 1))
        yield builtin(f"get_{name}_digital_in", _digital(record, "input", first), n)
        yield builtin(f"get_{name}_digital_out", _digital(record, "output", first), n)
        yield builtin(f"set_{name}_digital_out", _switch(record, first), n, Taken("b", boolean))
    n = Taken("n", _of_older_controllers)
    yield builtin("get_digital_in", _digital(record, "input", 0), n)
    yield builtin("get_digital_out", _digital(record, "output", 0), n)
    yield builtin("set_digital_out", _switch(record, 0), n, Taken("b", boolean))
    n, f = Taken("n", within(integer, 0, 1)), Taken("f", within(number, 0.0, 1.0))
    yield builtin("get_standard_analog_in", lambda k: record.get(f"standard_analog_input{k}"), n)
    every = Taken("n", within(integer, 0, 3))
    yield builtin("get_analog_in", lambda k: record.get(f"{'standard' if k < 2 else 'tool'}_analog_input{k % 2}"), every)
    yield builtin("get_tool_analog_in", lambda k: record.get(f"tool_analog_input{k}"), n)
    for name in ("get_standard_analog_out", "get_analog_out"):
        yield builtin(name, lambda k: record.get(f"standard_analog_output{k}"), n)
    for name in ("set_standard_analog_out", "set_analog_out"):
        yield builtin(name, lambda k, value: set_analog_output(record, k, value, volts=in_volts(record, k)), n, f)

    def voltage(value: float) -> None:
        if value not in (0.0, 12.0, 24.0):
            raise Misuse(f"voltage {value:g}: allowed are 0, 12 and 24")
        record.put("tool_output_voltage", value)

    yield builtin("set_tool_voltage", voltage, Taken("voltage", number))
    yield builtin("get_tool_current", lambda: record.get("tool_output_current"))
    flag = Taken("n", within(integer, 0, len(flags) - 1))
    yield builtin("get_flag", lambda k: flags[k], flag)
    yield builtin("set_flag", lambda k, b: flags.__setitem__(k, b), flag, Taken("b", boolean))
    for name in ("get_euromap_input", "get_euromap_output"):
        yield builtin(name, lambda k: False, Taken("port_number", within(integer, 0, 31)))


def _of_older_controllers(value: Value) -> int:
    """Bit of a digital signal from its number in controllers before the e-Series: 8 and 9 are signals of the tool."""
    number_ = within(integer, 0, 9)(value)
    return number_ if number_ < TOOL_AFTER else TOOL_FIRST + number_ - TOOL_AFTER


def _digital(record: FieldRecord, way: str, first: int) -> Callable[[int], bool]:
    place = record.field(f"actual_digital_{way}_bits")
    return lambda n: bool(int(place.item()) >> (first + n) & 1)


def _switch(record: FieldRecord, first: int) -> Callable[[int, bool], None]:
    def switch(n: int, on: bool) -> None:
        bit = 1 << (first + n)
        set_outputs(record, bit, bit if on else 0)

    return switch
