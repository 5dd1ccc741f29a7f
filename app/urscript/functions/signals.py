"""Functions of registers, inputs and outputs (URScript manual, module interfaces)."""

from collections.abc import Callable, Iterator

from app.robot_interface.controller.field_record import FieldRecord
from app.robot_interface.controller.status_fields import set_outputs
from app.urscript.functions.robot_side import RobotSide
from app.urscript.language.trouble import Misuse
from app.urscript.machine.signature import Builtin, Taken, boolean, builtin, integer, number, within
from app.urscript.machine.values import Value

REGISTERS = 48
WORDS = 32
FLAGS = 32

PLACE = Taken("address", integer)


def of_registers(record: FieldRecord) -> Iterator[Builtin]:
    """General purpose registers, which RTDE shows to clients."""
    for way in ("input", "output"):
        whole = [record.field(f"{way}_int_register_{k}") for k in range(REGISTERS)]
        real = [record.field(f"{way}_double_register_{k}") for k in range(REGISTERS)]
        yield builtin(f"read_{way}_integer_register", _reader([each.item for each in whole]), PLACE)
        yield builtin(f"read_{way}_float_register", _reader([each.item for each in real]), PLACE)
        yield builtin(f"read_{way}_boolean_register", _bit_reader(record, way), PLACE)
    yield builtin("write_output_integer_register", _writer(record, "int"), PLACE, Taken("value", integer))
    yield builtin("write_output_float_register", _writer(record, "double"), PLACE, Taken("value", number))
    yield builtin("write_output_boolean_register", _bit_writer(record), PLACE, Taken("value", boolean))


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


def _word(way: str, address: int) -> str:
    if not 0 <= address < 128:
        raise Misuse(f"address {address} is out of range, allowed: 0 to 127")
    return f"{way}_bit_registers0_to_31" if address < WORDS else f"{way}_bit_registers32_to_63"


def _bit_reader(record: FieldRecord, way: str) -> Callable[[int], bool]:
    def read(address: int) -> bool:
        word = _word(way, address)
        if address >= 2 * WORDS:
            return bool(record.get(f"{way}_bit_register_{address}"))
        return bool(int(record.field(word).item()) >> address % WORDS & 1)

    return read


def _bit_writer(record: FieldRecord) -> Callable[[int, bool], None]:
    def write(address: int, value: bool) -> None:
        word = _word("output", address)
        if address >= 2 * WORDS:
            record.put(f"output_bit_register_{address}", value)
            return
        bit = 1 << address % WORDS
        before = int(record.field(word).item())
        record.put(word, before | bit if value else before & ~bit)

    return write


def of_inputs_and_outputs(robot: RobotSide) -> Iterator[Builtin]:
    """Digital and analog inputs and outputs, flags."""
    record = robot.record
    flags = [False] * FLAGS
    rows = {"standard": (0, 8), "configurable": (8, 8), "tool": (16, 2)}
    for name, (first, count) in rows.items():
        n = Taken("n", within(integer, 0, count - 1))
        yield builtin(f"get_{name}_digital_in", _digital(record, "input", first), n)
        yield builtin(f"get_{name}_digital_out", _digital(record, "output", first), n)
        yield builtin(f"set_{name}_digital_out", _switch(record, first), n, Taken("b", boolean))
    n = Taken("n", within(integer, 0, 17))
    yield builtin("get_digital_in", _digital(record, "input", 0), n)
    yield builtin("get_digital_out", _digital(record, "output", 0), n)
    yield builtin("set_digital_out", _switch(record, 0), n, Taken("b", boolean))
    n, f = Taken("n", within(integer, 0, 1)), Taken("f", within(number, 0.0, 1.0))
    for name in ("get_standard_analog_in", "get_analog_in"):
        yield builtin(name, lambda k: record.get(f"standard_analog_input{k}"), n)
    yield builtin("get_tool_analog_in", lambda k: record.get(f"tool_analog_input{k}"), n)
    for name in ("get_standard_analog_out", "get_analog_out"):
        yield builtin(name, lambda k: record.get(f"standard_analog_output{k}"), n)
    for name in ("set_standard_analog_out", "set_analog_out"):
        yield builtin(name, lambda k, value: record.put(f"standard_analog_output{k}", value), n, f)
    domain = Taken("domain", within(integer, 0, 1))
    for name in ("set_standard_analog_input_domain", "set_tool_analog_input_domain", "set_analog_outputdomain"):
        yield builtin(name, _nothing, Taken("port", within(integer, 0, 3)), domain)
    for name in ("set_standard_analog_input_range", "set_analog_inputrange"):
        yield builtin(name, _nothing, Taken("port", within(integer, 0, 3)), Taken("range", within(integer, 0, 4)))

    def voltage(value: float) -> None:
        if value not in (0.0, 12.0, 24.0):
            raise Misuse(f"voltage {value:g}: allowed are 0, 12 and 24")
        record.put("tool_output_voltage", value)

    yield builtin("set_tool_voltage", voltage, Taken("voltage", number))
    yield builtin("get_tool_current", lambda: record.get("tool_output_current"))
    flag = Taken("n", within(integer, 0, FLAGS - 1))
    yield builtin("get_flag", lambda k: flags[k], flag)
    yield builtin("set_flag", lambda k, b: flags.__setitem__(k, b), flag, Taken("b", boolean))
    for name in ("get_euromap_input", "get_euromap_output"):
        yield builtin(name, lambda k: False, Taken("port_number", within(integer, 0, 31)))


def _nothing(*_: Value) -> None:
    """What is set is the same for every simulated signal."""


def _digital(record: FieldRecord, way: str, first: int) -> Callable[[int], bool]:
    place = record.field(f"actual_digital_{way}_bits")
    return lambda n: bool(int(place.item()) >> (first + n) & 1)


def _switch(record: FieldRecord, first: int) -> Callable[[int, bool], None]:
    def switch(n: int, on: bool) -> None:
        bit = 1 << (first + n)
        set_outputs(record, bit, bit if on else 0)

    return switch
