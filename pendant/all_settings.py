"""The one settings schema: every period and limit with default, range, unit, requirement and a line of text."""

import hashlib
from typing import Annotated, Any, get_args, get_origin, get_type_hints

import msgspec
from msgspec import Meta

from pendant.contact.settings import ContactUse
from pendant.freedrive.settings import (
    ActivationSettings,
    ButtonUse,
    Enabling,
    FreeDriveSettings,
    HoldSettings,
    ReducedLimits,
    SequenceSettings,
)
from pendant.guided.settings import Unexplained
from pendant.haptics import HapticUse
from pendant.limits.settings import AxisSettings, JointLimits, LimitSettings, Soft, Static
from pendant.settings.schema import Limit, Section, SettingError, SettingRow, Value
from pendant.settings.schema import switch as _switch
from pendant.signals.settings import Handshake, LetGo, SignalSettings
from pendant.tooling.settings import ToolUse
from pendant.walls.settings import WallSettings


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


class Settings(Section, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """All settings. Every field has its default; `Settings()` is what ships."""

    signals: SignalSettings = SignalSettings()
    activation: ActivationSettings = ActivationSettings()
    handshake: Handshake = Handshake()
    let_go: LetGo = LetGo()
    sequence: SequenceSettings = SequenceSettings()
    free_drive: FreeDriveSettings = FreeDriveSettings()
    hold: HoldSettings = HoldSettings()
    button: ButtonUse = ButtonUse()
    enabling: Enabling = Enabling()
    reduced: ReducedLimits = ReducedLimits()
    limits: LimitSettings = LimitSettings()
    unexplained: Unexplained = Unexplained()
    soft: Soft = Soft()
    axes: AxisSettings = AxisSettings()
    joint_limits: JointLimits = JointLimits()
    walls: WallSettings = WallSettings()
    haptics: HapticUse = HapticUse()
    static: Static = Static()
    tools: ToolUse = ToolUse()
    joint_control: JointControl = JointControl()
    contact: ContactUse = ContactUse()


def _rows(section: type[Section], prefix: str) -> list[SettingRow]:
    rows: list[SettingRow] = []
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
        rows.append(SettingRow(prefix + field.name, field.default, low, high, extra["unit"], extra["id"], text, extra["locked"]))
    return rows


def _limit_rows(name: str, default: Limit, text: str, extra: dict[str, Any]) -> list[SettingRow]:
    """The rows of one limit: its value and what all limits have."""
    first = SettingRow(f"{name}.max", default.max, extra["low"], extra["high"], extra["unit"], extra["id"], text, True)
    rows = [first]
    for row in _rows(type(default), f"{name}."):
        rows.append(row._replace(default=getattr(default, row.name.rpartition(".")[2]), text=f"{text}: {row.text}"))
    return rows


_ROWS = {row.name: row for row in _rows(Settings, "")}


def describe() -> list[SettingRow]:
    """Every setting, in the order of the schema."""
    return list(_ROWS.values())


def find(name: str) -> SettingRow:
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


def _checked(row: SettingRow, value: object) -> Value:
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


def _hashed(settings: Settings, rows: list[SettingRow]) -> str:
    lines = "\n".join(f"{row.name}={value_of(settings, row.name)!r}" for row in rows)
    return hashlib.sha256(lines.encode()).hexdigest()[:8]
