"""The one settings schema: every period and limit with default, range, unit, requirement and a line of text."""

import hashlib
from typing import Annotated, Any, get_args, get_origin, get_type_hints

import msgspec
from msgspec import Meta

from pendant.contact_settings import ContactUse
from pendant.free_drive_settings import Activation, ButtonUse, Enabling, FreeDrive, Hold, ReducedLimits, Sequence
from pendant.haptics import HapticUse
from pendant.limit_settings import Limits, Soft
from pendant.schema import Limit, Row, Section, SettingError, Value, ticks
from pendant.schema import number as _number
from pendant.schema import switch as _switch
from pendant.signal_settings import Handshake, LetGo, Signals

__all__ = [
    "Limit",
    "Row",
    "Section",
    "SettingError",
    "Settings",
    "Value",
    "apply",
    "describe",
    "digest",
    "find",
    "ticks",
    "value_of",
]


class Axes(Section, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """Freedom of the tool in free-drive, axis by axis, and what singularities do to it."""

    on: Annotated[bool, _switch("FD-4", "axes can be locked", locked=False)] = True
    x: Annotated[bool, _switch("FD-4", "the tool is free along x", locked=False)] = True
    y: Annotated[bool, _switch("FD-4", "the tool is free along y", locked=False)] = True
    z: Annotated[bool, _switch("FD-4", "the tool is free along z", locked=False)] = True
    rx: Annotated[bool, _switch("FD-4", "the tool is free about x", locked=False)] = True
    ry: Annotated[bool, _switch("FD-4", "the tool is free about y", locked=False)] = True
    rz: Annotated[bool, _switch("FD-4", "the tool is free about z", locked=False)] = True
    tool: Annotated[bool, _switch("FD-4", "the axes are the tool's when they are locked", locked=False)] = False
    roll: Annotated[float, _number(-3.15, 3.15, "rad", "FD-4", "of the axes in the base, about its x", locked=False)] = 0.0
    pitch: Annotated[float, _number(-3.15, 3.15, "rad", "FD-4", "of the axes in the base, about its y", locked=False)] = 0.0
    yaw: Annotated[float, _number(-3.15, 3.15, "rad", "FD-4", "of the axes in the base, about its z", locked=False)] = 0.0
    resistance: Annotated[bool, _switch("FD-4", "with a lock, motion towards a singularity is resisted")] = True
    near: Annotated[float, _number(0.011, 0.1, "m", "FD-4", "near a singularity: smallest singular value below this")] = 0.04
    too_near: Annotated[float, _number(0.001, 0.01, "m", "FD-4", "too near: with all of the resistance")] = 0.01


class JointLimits(Section, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """Zones before the joint limits in free-drive."""

    on: Annotated[bool, _switch("FD-4", "a joint is resisted before its range ends")] = True
    damping_zone: Annotated[float, _number(0.01, 0.5, "rad", "FD-4", "where it is damped, before the stiff zone")] = 0.1
    stiff_zone: Annotated[float, _number(0.01, 0.3, "rad", "FD-4", "up to the limit, where a spring holds it back")] = 0.05
    damping: Annotated[float, _number(0.05, 0.4, "s/rad", "FD-4", "at the stiff zone, of rated torque at 1 rad/s")] = 0.25


class Static(Section, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """When the arm counts as standing still."""

    speed: Annotated[float, _number(0.001, 0.1, "rad/s", "static", "every joint is slower than this")] = 0.01
    time: Annotated[float, _number(0.02, 2.0, "s", "static", "for this long")] = 0.1


class JointControl(Section, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """Which terms make the motor torque, and which ways lead to the transmission torque."""

    feed_forward: Annotated[bool, _switch("AF-4", "inertia and speed of a motion are fed forward")] = True
    friction: Annotated[bool, _switch("AF-7", "the friction estimate helps motor and hand")] = True
    adaptive: Annotated[bool, _switch("AF-2", "friction is learned while the robot works")] = True
    torque_feedback: Annotated[bool, _switch("AF-5", "the transmission-torque error is corrected")] = True
    theta: Annotated[bool, _switch("AF-5", "the motor angle's error is corrected")] = True
    theta_speed: Annotated[bool, _switch("AF-5", "the motor speed's error is corrected")] = True
    theta_acceleration: Annotated[bool, _switch("AF-5", "the motor acceleration's error is corrected")] = False
    q: Annotated[bool, _switch("AF-5", "the output angle's error is integrated")] = True
    q_speed: Annotated[bool, _switch("AF-5", "the output speed's error is corrected")] = False
    q_acceleration: Annotated[bool, _switch("AF-5", "the output acceleration's error is corrected")] = False
    motor_torque: Annotated[bool, _switch("AF-5", "the motor torque's error is corrected")] = False
    tcp_pose: Annotated[bool, _switch("AF-5", "the tool centre point's error is corrected")] = False
    tcp_speed: Annotated[bool, _switch("AF-5", "the error of its speed is corrected")] = False
    from_dynamics: Annotated[bool, _switch("AF-3", "transmission torque from output angle and model")] = True
    from_deflection: Annotated[bool, _switch("AF-3", "transmission torque from both angles")] = True
    from_motor: Annotated[bool, _switch("AF-3", "transmission torque from the motor angle and torque")] = True


class Walls(Section, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """Virtual walls: those of the session, and the tether, a sphere round the flange that follows the user's hand."""

    on: Annotated[bool, _switch("FD-24", "walls and areas hold")] = True
    anew: Annotated[bool, _switch("VW-3", "walls are anchored anew as their policies say")] = True
    sizes: Annotated[bool, _switch("VW-8", "sizes follow posture or payload, or the smallest holds")] = True
    resistance: Annotated[bool, _switch("VW-7", "walls resist before they are reached")] = True
    tether: Annotated[bool, _switch("VW-4", "a sphere round the flange follows the hand")] = True
    activation_radius: Annotated[float, _number(0.001, 0.1, "m", "VW-6", "of the tether in the activation sequence")] = 0.005
    operation_radius: Annotated[float, _number(0.005, 1.0, "m", "VW-6", "of the tether in free-drive; the arm stops at it")] = (
        0.03
    )
    band: Annotated[float, _number(0.0, 0.5, "m", "VW-7", "before the tether, where it resists")] = 0.005
    averaging: Annotated[float, _number(0.02, 10.0, "s", "VW-4", "the tether lies round the flange's mean place")] = 0.02
    safety_period: Annotated[float, _number(0.1, 10.0, "s", "VW-3", "the tether follows a hand that was felt so long ago")] = 1.0
    push_back: Annotated[float, _number(1.0, 50.0, "N", "VW-5", "smallest force that the tether takes for a hand's")] = 1.0
    leave: Annotated[bool, _switch("VW-6", "beyond the tether, free-drive is left")] = False
    stop: Annotated[bool, _switch("VW-6", "beyond the tether is STOP")] = False


class Unexplained(Section, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """Motion that nobody causes, and payloads that drop or change, are STOP."""

    motion: Annotated[bool, _switch("FD-19", "motion in free-drive that nobody causes is STOP")] = True
    payload: Annotated[bool, _switch("FD-19", "a payload that drops or changes in free-drive is STOP")] = True
    speed: Annotated[float, _number(0.005, 0.25, "m/s", "FD-19", "of the flange, from which on it counts as moving")] = 0.02
    time: Annotated[float, _number(0.02, 2.0, "s", "FD-19", "that it may move alone")] = 0.3
    force: Annotated[float, _number(0.5, 20.0, "N", "FD-19", "a smaller force is nobody's")] = 1.0
    sensor: Annotated[bool, _switch("FD-19", "a flange sensor that drifts or steps drives no arm")] = True


class ToolUse(Section, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """How tool and payload are changed and measured."""

    ramp: Annotated[float, _number(0.0, 10.0, "s", "tools", "time to go over to another payload in", locked=False)] = 1.0
    measure: Annotated[float, _number(0.1, 5.0, "s", "tools", "time to measure a posture for", locked=False)] = 0.5


class Settings(Section, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """All settings. Every field has its default; `Settings()` is what ships."""

    signals: Signals = Signals()
    activation: Activation = Activation()
    handshake: Handshake = Handshake()
    let_go: LetGo = LetGo()
    sequence: Sequence = Sequence()
    free_drive: FreeDrive = FreeDrive()
    hold: Hold = Hold()
    button: ButtonUse = ButtonUse()
    enabling: Enabling = Enabling()
    reduced: ReducedLimits = ReducedLimits()
    limits: Limits = Limits()
    unexplained: Unexplained = Unexplained()
    soft: Soft = Soft()
    axes: Axes = Axes()
    joint_limits: JointLimits = JointLimits()
    walls: Walls = Walls()
    haptics: HapticUse = HapticUse()
    static: Static = Static()
    tools: ToolUse = ToolUse()
    joint_control: JointControl = JointControl()
    contact: ContactUse = ContactUse()


def _rows(section: type[Section], prefix: str) -> list[Row]:
    rows: list[Row] = []
    hints = get_type_hints(section, include_extras=True)
    for field in msgspec.structs.fields(section):
        hint = hints[field.name]
        if hint is float:  # the value of a limit: its range is said where the limit is
            continue
        if get_origin(hint) is not Annotated:
            rows += _rows(hint, f"{prefix}{field.name}.")
            continue
        meta: Meta = get_args(hint)[1]
        extra: dict[str, Any] = meta.extra or {}
        if isinstance(field.default, Limit):
            rows += _limit_rows(prefix + field.name, field.default, meta.description or "", extra)
            continue
        low, high = (None, None) if meta.ge is None else (float(meta.ge), float(meta.le or 0.0))
        text = meta.description or ""
        rows.append(Row(prefix + field.name, field.default, low, high, extra["unit"], extra["id"], text, extra["locked"]))
    return rows


def _limit_rows(name: str, default: Limit, text: str, extra: dict[str, Any]) -> list[Row]:
    """The rows of one limit: its value and what all limits have."""
    first = Row(f"{name}.max", default.max, extra["low"], extra["high"], extra["unit"], extra["id"], text, True)
    rows = [first]
    for row in _rows(type(default), f"{name}."):
        rows.append(row._replace(default=getattr(default, row.name.rpartition(".")[2]), text=f"{text}: {row.text}"))
    return rows


_ROWS = {row.name: row for row in _rows(Settings, "")}


def describe() -> list[Row]:
    """Every setting, in the order of the schema."""
    return list(_ROWS.values())


def find(name: str) -> Row:
    """The row of a dotted name.

    Raises:
        SettingError: there is no such setting.
    """
    row = _ROWS.get(name)
    if row is None:
        raise SettingError(name, None, "one of " + ", ".join(_ROWS))
    return row


def value_of(settings: Settings, name: str) -> Value:
    """The value of a dotted name. Raises SettingError when there is no such setting."""
    find(name)
    value: Any = settings
    for part in name.split("."):
        value = getattr(value, part)
    return value


def _checked(row: Row, value: object) -> Value:
    if row.low is None or row.high is None:
        if not isinstance(value, bool):
            raise SettingError(row.name, value, "true or false")
        return value
    unit = f" {row.unit}" if row.unit else ""
    allowed = f"a number from {row.low:g} to {row.high:g}{unit}"
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        raise SettingError(row.name, value, allowed)
    if not row.low <= value <= row.high:  # NaN is in no range
        raise SettingError(row.name, value, allowed)
    return float(value)


def _replaced(section: Any, path: list[str], value: Value) -> Any:
    new = value if len(path) == 1 else _replaced(getattr(section, path[0]), path[1:], value)
    return msgspec.structs.replace(section, **{path[0]: new})


def apply(settings: Settings, changes: dict[str, Any]) -> Settings:
    """Settings with the changes, given by dotted name; all of them or none.

    Raises:
        SettingError: a name that does not exist, or a value of the wrong type, out of range or not finite.
    """
    for name, value in changes.items():
        settings = _replaced(settings, name.split("."), _checked(find(name), value))
    return settings


def digest(settings: Settings) -> str:
    """Short hash of all values: 8 hexadecimal digits, equal for equal settings."""
    return _hashed(settings, list(_ROWS.values()))


def limits_checksum(settings: Settings) -> str:
    """Short hash of everything that is locked while the arm moves: 8 hexadecimal digits, equal for equal limits."""
    return _hashed(settings, [row for row in _ROWS.values() if row.locked])


def _hashed(settings: Settings, rows: list[Row]) -> str:
    lines = "\n".join(f"{row.name}={value_of(settings, row.name)!r}" for row in rows)
    return hashlib.sha256(lines.encode()).hexdigest()[:8]
