"""Functions that set up an installation (URScript manual, modules interfaces and ioconfiguration).

Pendants write calls of these functions at the beginning of every program that they save.
"""

from collections.abc import Callable, Iterator

from app.robot_interface.controller.field_record import FieldRecord
from app.urscript.language.trouble import Misuse
from app.urscript.machine.signature import Builtin, Taken, boolean, builtin, integer, items, number, text, within
from app.urscript.machine.values import Value
from app.urscript.robot.robot_side import RobotSide
from app.urscript.robot.run_states import OutputKind

BAUD_RATES = (9600, 19200, 38400, 57600, 115200, 1_000_000, 2_000_000, 5_000_000)
"""Rates of the tool's serial line [bit/s] (URScript manual, set_tool_communication)."""

OUTPUTS = {
    "standard_digital": (OutputKind.DIGITAL, 0, 8),
    "configurable_digital": (OutputKind.DIGITAL, 8, 8),
    "tool_digital": (OutputKind.DIGITAL, 16, 2),
    "gp_boolean": (OutputKind.REGISTER, 0, 128),
    "standard_analog": (OutputKind.ANALOG, 0, 2),
}
"""Outputs behind each name in a run state: their kind, the number of the first, and how many."""

INPUTS = {"standard_digital": (0, 8), "configurable_digital": (8, 8), "tool_digital": (16, 2), "gp_boolean": (0, 128)}

ACTIONS = ("default", "freedrive")
"""Actions of an input (URScript manual)."""


def of_installation(robot: RobotSide) -> Iterator[Builtin]:
    """All of them."""
    yield from _of_signals(robot.record)
    yield from _of_run_states(robot)
    yield from _of_input_actions(robot)
    transition = Taken("type", within(integer, 0, 1))
    yield builtin("set_safety_mode_transition_hardness", lambda type_: None, transition)  # this robot's is always hard


def _of_signals(record: FieldRecord) -> Iterator[Builtin]:
    """The tool's connector, and the units of the analog signals."""
    domain = Taken("domain", within(integer, 0, 1))
    for name in ("set_standard_analog_input_domain", "set_tool_analog_input_domain", "set_analog_outputdomain"):
        yield builtin(name, _domain(record, name), Taken("port", within(integer, 0, 3)), domain)
    for name in ("set_standard_analog_input_range", "set_analog_inputrange"):
        yield builtin(
            name, lambda port, range_: None, Taken("port", within(integer, 0, 3)), Taken("range", within(integer, 0, 4))
        )

    def communicate(*given: Value) -> None:
        if given[1] not in BAUD_RATES:
            raise Misuse(f"baud_rate: {given[1]}, allowed: {', '.join(map(str, BAUD_RATES))}")

    yield builtin(
        "set_tool_communication",
        communicate,
        Taken("enabled", boolean),
        Taken("baud_rate", integer),
        Taken("parity", within(integer, 0, 2)),
        Taken("stop_bits", within(integer, 1, 2)),
        Taken("rx_idle_chars", within(number, 1.0, 40.0)),
        Taken("tx_idle_chars", within(number, 0.0, 40.0)),
    )
    mode = Taken("mode", within(integer, 0, 1))
    yield builtin("set_tool_output_mode", lambda value: record.put("tool_output_mode", value), mode)
    pin, mode = Taken("n", within(integer, 0, 1)), Taken("mode", within(integer, 0, 3))
    yield builtin("set_tool_digital_output_mode", lambda n, value: record.put(f"tool_digital_output{n}_mode", value), pin, mode)


def _domain(record: FieldRecord, name: str) -> Callable[[int, int], None]:
    """Whether a signal is in amperes (0) or volts (1), as RTDE tells it."""
    first = {"set_standard_analog_input_domain": 0, "set_analog_outputdomain": 2}.get(name)
    field = "tool_analog_input_types" if first is None else "analog_io_types"

    def set_(port: int, domain: int) -> None:
        if port > 1:
            return  # the tool's ports of older controllers
        bit, before = 1 << (port + (first or 0)), int(record.field(field).item())
        record.put(field, before | bit if domain else before & ~bit)

    return set_


def _of_run_states(robot: RobotSide) -> Iterator[Builtin]:
    """Values of outputs while a program runs, and while no program runs."""
    state = Taken("state", within(integer, 0, 3))
    for name, (kind, first, count) in OUTPUTS.items():
        output = Taken("outputId", within(integer, 0, count - 1))
        yield builtin(f"set_runstate_{name}_output_to_value", _run_state(robot, kind, first), output, state)

    def outputs(states: tuple[Value, ...]) -> None:
        if states:
            raise Misuse("outputs: only an empty list is known; use set_runstate_standard_digital_output_to_value()")

    yield builtin("set_runstate_outputs", outputs, Taken("outputs", items, ()))


def _run_state(robot: RobotSide, kind: OutputKind, first: int) -> Callable[[int, int], None]:
    return lambda number_, state: robot.memory.installed.choose(kind, first + number_, state)


def _of_input_actions(robot: RobotSide) -> Iterator[Builtin]:
    """Inputs that ask for free-drive while they are high."""

    def act(name: str, first: int) -> Callable[[int, str], None]:
        def set_(port: int, action: str) -> None:
            if action not in ACTIONS:
                raise Misuse(f'action: {action!r}; expected "default" or "freedrive"')
            kind = OutputKind.REGISTER if name == "gp_boolean" else OutputKind.DIGITAL
            robot.memory.installed.free_drive_by(kind, first + port, on=action == "freedrive")

        return set_

    for name, (first, count) in INPUTS.items():
        port = Taken("port", within(integer, 0, count - 1))
        yield builtin(f"set_{name}_input_action", act(name, first), port, Taken("action", text))
    yield builtin("set_input_actions_to_default", robot.memory.installed.no_free_drive)

    def by_signal(name: str, action: str) -> None:
        if action not in ACTIONS:
            raise Misuse(f'action: {action!r}; expected "default" or "freedrive"')
        if not robot.memory.units.signal(name).kind.digital:
            raise Misuse(f"signal_name: {name} is no digital signal")
        robot.memory.installed.free_drive_by(OutputKind.MODBUS, name, on=action == "freedrive")

    def follow(name: str, state: int) -> None:
        if not robot.memory.units.signal(name).kind.output:
            raise Misuse(f"signal_name: {name} is no output")
        if robot.hosts.reached(robot.memory.units.place(name).address) is not None:
            robot.memory.installed.choose(OutputKind.MODBUS, name, state)

    signal = Taken("signal_name", text)
    yield builtin("modbus_set_digital_input_action", by_signal, signal, Taken("action", text))
    yield builtin("modbus_set_runstate_dependent_choice", follow, signal, Taken("runstate_choice", within(integer, 0, 3)))
