"""Functions of the controller itself: RTDE's fields, registers of the Modbus server, settings of planned motions."""

from collections.abc import Iterator
from functools import partial

from app.robot_interface.controller.rtde_fields import OUTPUTS
from app.urscript.language.trouble import Misuse
from app.urscript.machine.signature import (
    Builtin,
    Taken,
    any_value,
    boolean,
    builtin,
    integer,
    items,
    number,
    numbers,
    text,
    vector,
    within,
)
from app.urscript.machine.values import Value
from app.urscript.robot.robot_side import RobotSide

REGISTER_BITS = 16
INPUT_REGISTER, OUTPUT_REGISTER = 0, 1
GENERAL = range(128, 256)
"""Registers of the robot's own Modbus server: digital inputs, digital outputs, general use (UR, Modbus server)."""


def of_controller(robot: RobotSide) -> Iterator[Builtin]:
    """All of them."""
    yield from _of_record(robot)
    yield from _of_ports(robot)
    yield from _of_motion_settings(robot.memory.kept)


def _of_record(robot: RobotSide) -> Iterator[Builtin]:
    """Output fields of RTDE, by name."""
    get = robot.record.get

    def field(key: str) -> Value:
        if key not in OUTPUTS:
            raise Misuse(f"key: {key[:50]!r} is no output of RTDE")
        value = get(key)
        if OUTPUTS[key] == "BOOL":
            return bool(value)
        return tuple(value) if isinstance(value, list) else value

    yield builtin("get_rtde_value", field, Taken("key", text))
    yield builtin("get_actual_joint_accelerations", lambda: vector(tuple(get("actual_qdd"))))  # pyright: ignore[reportArgumentType]
    yield builtin("get_tool_temp", lambda: get("tool_temperature"))


def _of_ports(robot: RobotSide) -> Iterator[Builtin]:
    """Registers of the robot's Modbus server. There is no such server here: only programs share the registers."""
    ports, get = robot.memory.ports, robot.record.get

    def read(address: int) -> int:
        if address == INPUT_REGISTER:
            return int(get("actual_digital_input_bits")) & 0xFFFF  # pyright: ignore[reportArgumentType]
        if address == OUTPUT_REGISTER:
            return int(get("actual_digital_output_bits")) & 0xFFFF  # pyright: ignore[reportArgumentType]
        if address not in GENERAL:
            raise Misuse(f"address {address}: this robot keeps 0, 1 and {GENERAL.start} to {GENERAL.stop - 1} alone")
        return ports.get(address, 0)

    def write(address: int, value: int) -> None:
        if address not in GENERAL:
            raise Misuse(f"address {address} cannot be written, allowed: {GENERAL.start} to {GENERAL.stop - 1}")
        ports[address] = value & 0xFFFF

    def signed(address: int) -> int:
        value = read(address)
        return value - (1 << REGISTER_BITS) if value >= 1 << (REGISTER_BITS - 1) else value

    def write_bit(address: int, on: bool) -> None:
        register, bit = address // REGISTER_BITS, 1 << address % REGISTER_BITS
        write(register, read(register) | bit if on else read(register) & ~bit)

    place = Taken("address", within(integer, 0, 65535))
    yield builtin("read_port_register", signed, place)
    yield builtin("read_port_bit", lambda address: bool(read(address // REGISTER_BITS) >> address % REGISTER_BITS & 1), place)
    yield builtin("write_port_register", write, place, Taken("value", within(integer, -(1 << 15), (1 << 16) - 1)))
    yield builtin("write_port_bit", write_bit, place, Taken("value", boolean))


def _of_motion_settings(kept: dict[str, float]) -> Iterator[Builtin]:
    """Settings that are kept and can be read, but change no motion of this robot."""

    def base(acceleration: tuple[float, ...]) -> None:
        if any(acceleration):
            raise Misuse("a: the simulated arm stands on ground that does not move, expected [0, 0, 0]")

    version, share = within(integer, 1, 2), within(number, 0.01, 1.0)
    for name, allowed in (("motion_version", Taken("version", version)), ("jerk_gain_scaling", Taken("gain", share))):
        yield builtin(f"{name}_set", partial(kept.__setitem__, name), allowed)
        yield builtin(f"{name}_get", lambda key=name: int(kept[key]) if key == "motion_version" else kept[key])
    yield builtin("set_base_acceleration", base, Taken("a", numbers(3)))
    yield builtin("get_base_acceleration", lambda: (0.0, 0.0, 0.0))
    for name in ("high_holding_torque_enable", "high_holding_torque_disable", "tool_wrench_limit_disable"):
        yield builtin(name, _nothing)
    for name in ("set_baselight_off", "set_baselight_iec"):
        yield builtin(name, _nothing)
    colour = within(integer, 0, 255)
    yield builtin("set_baselight_solid", _nothing, Taken("r", colour), Taken("g", colour), Taken("b", colour))
    yield builtin(
        "position_deviation_warning", _nothing, Taken("enabled", boolean), Taken("threshold", within(number, 0, 1), 0.8)
    )
    yield builtin("varmsg", _nothing, Taken("name", text), Taken("value", any_value))
    yield builtin("pause_on_error_code", _nothing, Taken("code", integer), Taken("argument", integer, None))
    yield builtin("reset_revolution_counter", _nothing, Taken("qNear", items, (0.0,) * 6))


def _nothing(*_: Value) -> None:
    """A setting without effect on a simulated robot."""
