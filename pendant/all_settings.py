"""The one settings schema: every period and limit with default, range, unit, requirement and a line of text."""

import hashlib
from collections.abc import Iterable
from enum import Enum
from operator import attrgetter
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
    SequenceSettings,
)
from pendant.guided.settings import Unexplained
from pendant.haptics import HapticUse
from pendant.limits.settings import AxisSettings, JointLimits, JointSettings, LimitSettings, Soft, Static
from pendant.program.settings import ProgramUse
from pendant.safety.settings import CollisionSettings, FollowingSettings, RobotLimitSettings
from pendant.settings.renamed import RENAMED
from pendant.settings.schema import Limit, Section, SettingError, SettingRow, Value
from pendant.settings.schema import choice as _choice
from pendant.settings.schema import switch as _switch
from pendant.signals.settings import Handshake, LetGo, SignalSettings
from pendant.tick.words import Word
from pendant.tooling.settings import ToolUse
from pendant.walls.settings import WallSettings


class FedBackTorque(Word):
    """Which transmission torque the torque feedback takes for the actual one: the fusion, or one way (AF-3, AF-5)."""

    FUSED = "fused"
    DYNAMICS = "dynamics"  # output side: from output angle and rigid model
    DEFLECTION = "deflection"  # from the two angles
    MOTOR = "motor"  # motor side: from motor angle and motor torque


class FrictionFrom(Word):
    """What is taken off the motor torque, beside the rotor's inertia, to obtain the friction (AF-2)."""

    DYNAMICS = "dynamics"  # the rigid model's torque: exact, and wrong by whatever touches the arm
    DEFLECTION = "deflection"  # the torque that bends the gear, from the two angles: in contact, too


class JointControl(Section, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """Which terms make the motor torque, and which ways lead to the transmission torque."""

    BASIC = ("friction", "adaptive")

    feed_forward: Annotated[bool, _switch("AF-4", "torques for inertia and speed of a planned motion are added")] = True
    friction: Annotated[bool, _switch("AF-7", "the friction estimate compensates friction of motion and hand guiding")] = True
    adaptive: Annotated[bool, _switch("AF-2", "friction is learned while the robot works")] = True
    friction_from: Annotated[FrictionFrom, _choice("AF-2", "what is taken off the motor torque to obtain the friction")] = (
        FrictionFrom.DYNAMICS
    )
    torque_feedback: Annotated[bool, _switch("AF-5", "the error of the transmission torque is fed back")] = True
    fed_back: Annotated[FedBackTorque, _choice("AF-5", "the transmission torque that is fed back; without it the fused one")] = (
        FedBackTorque.DEFLECTION
    )
    theta: Annotated[bool, _switch("AF-5", "the error of the motor angle is fed back")] = True
    theta_speed: Annotated[bool, _switch("AF-5", "the error of the motor speed is fed back")] = True
    theta_acceleration: Annotated[bool, _switch("AF-5", "the error of the motor acceleration is fed back")] = False
    q: Annotated[bool, _switch("AF-5", "the error of the output angle is integrated")] = True
    q_speed: Annotated[bool, _switch("AF-5", "the error of the output speed is fed back")] = False
    q_acceleration: Annotated[bool, _switch("AF-5", "the error of the output acceleration is fed back")] = False
    motor_torque: Annotated[bool, _switch("AF-5", "the error of the motor torque is fed back")] = False
    tcp_pose: Annotated[bool, _switch("AF-5", "the error of the tool centre point's pose is fed back")] = False
    tcp_speed: Annotated[bool, _switch("AF-5", "the error of the tool centre point's speed is fed back")] = False
    from_dynamics: Annotated[bool, _switch("AF-3", "transmission torque is estimated from output angle and rigid model")] = True
    from_deflection: Annotated[bool, _switch("AF-3", "transmission torque is estimated from the two angles")] = True
    from_motor: Annotated[bool, _switch("AF-3", "transmission torque is estimated from motor angle and motor torque")] = True


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
    robot_limits: RobotLimitSettings = RobotLimitSettings()
    following: FollowingSettings = FollowingSettings()
    collision: CollisionSettings = CollisionSettings()
    limits: LimitSettings = LimitSettings()
    unexplained: Unexplained = Unexplained()
    soft: Soft = Soft()
    axes: AxisSettings = AxisSettings()
    joints: JointSettings = JointSettings()
    joint_limits: JointLimits = JointLimits()
    walls: WallSettings = WallSettings()
    haptics: HapticUse = HapticUse()
    static: Static = Static()
    tools: ToolUse = ToolUse()
    joint_control: JointControl = JointControl()
    contact: ContactUse = ContactUse()
    program: ProgramUse = ProgramUse()


def _rows(shipped: Section, prefix: str) -> list[SettingRow]:
    """The rows of a section as it ships."""
    rows: list[SettingRow] = []
    hints = get_type_hints(type(shipped), include_extras=True)
    for name in shipped.__struct_fields__:
        hint, default = hints[name], getattr(shipped, name)
        if hint is float:  # the value of a limit: its range is said where the limit is
            continue
        if get_origin(hint) is not Annotated:
            rows += _rows(default, f"{prefix}{name}.")
            continue
        meta: Meta = get_args(hint)[1]
        extra: dict[str, Any] = meta.extra or {}
        basic, text = name in shipped.BASIC, meta.description or ""
        if isinstance(default, Limit):
            limit, *others = _limit_rows(prefix + name, default, text, extra)
            rows += [limit._replace(basic=basic), *others]
            continue
        low, high = (None, None) if meta.ge is None else (float(meta.ge), float(meta.le or 0.0))
        marks = {key: extra[key] for key in ("unit", "id", "locked")}
        rows.append(SettingRow(prefix + name, default, low, high, text=text, basic=basic, **marks))
    return rows


def _limit_rows(name: str, default: Limit, text: str, extra: dict[str, Any]) -> list[SettingRow]:
    """The rows of one limit: its value and what all limits have."""
    first = SettingRow(f"{name}.max", default.max, text=text, locked=True, basic=False, **extra)
    return [first, *[row._replace(text=f"{text}: {row.text}") for row in _rows(default, f"{name}.")]]


_ROWS = {row.name: row for row in _rows(Settings(), "")}


def describe() -> list[SettingRow]:
    """Every setting, in the order of the schema."""
    return list(_ROWS.values())


def find(name: str) -> SettingRow:
    """The row of a dotted name.

    Raises:
        SettingError: there is no such setting, or none of this name any more; then the error says the name of now.
    """
    row = _ROWS.get(name)
    if row is not None:
        return row
    if name in RENAMED:
        now = _ROWS[RENAMED[name]]
        raise SettingError(name, None, f"is called {now.name} now; allowed there: {_allowed(now)}")
    section = name.split(".", maxsplit=1)[0]
    names = [row for row in _ROWS if row.startswith(section + ".")]
    if names:
        raise SettingError(name, None, "no such setting; there are " + ", ".join(names))
    raise SettingError(name, None, "no such section; there are " + ", ".join(dict.fromkeys(row.split(".")[0] for row in _ROWS)))


def value_of(settings: Settings, name: str) -> Value:
    """The value of a dotted name. Raises SettingError when there is no such setting."""
    find(name)
    value: Any = settings
    for part in name.split("."):
        value = getattr(value, part)
    return value.value if isinstance(value, Enum) else value


def _allowed(row: SettingRow) -> str:
    if row.choices:
        return "one of " + ", ".join(row.choices)
    if row.is_switch:
        return "true or false"
    unit = f" {row.unit}" if row.unit else ""
    return f"a {'whole ' if row.is_count else ''}number from {row.low:g} to {row.high:g}{unit}"


def _checked(row: SettingRow, value: object) -> Value:
    """The value as the setting holds it: a float, an int, a bool, or a member of the enumeration."""
    if row.choices and isinstance(value, str) and value in row.choices:
        return type(row.default)(value)
    if row.is_switch and isinstance(value, bool):
        return value
    if row.low is not None and row.high is not None and isinstance(value, (int, float)) and not isinstance(value, bool):
        inside = row.low <= value <= row.high  # NaN is in no range
        if inside and not row.is_count:
            return float(value)
        if inside and value == int(value):
            return int(value)
    raise SettingError(row.name, value, _allowed(row))


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
    return _hashed(settings, _EVERY)


PERIODS = frozenset({"free_drive.period", "free_drive.restart_period"})
"""What a safety screen shows though it is not locked."""


def concerns_safety(row: SettingRow) -> bool:
    """Whether a setting is in the safety checksum: it is locked while the arm moves, or a safety screen shows it."""
    return row.locked or row.name in PERIODS


def safety_checksum(settings: Settings) -> str:
    """Short hash of everything that concerns safety: 8 hexadecimal digits, equal for equal values."""
    return _hashed(settings, _SAFETY)


class _Named:
    """The values of some rows, all at once: whatever takes settings hashes hundreds of them."""

    def __init__(self, rows: Iterable[SettingRow]) -> None:
        names = [row.name for row in rows]
        self.values = attrgetter(*names)
        self.lines = "\n".join(f"{name}={{!r}}" for name in names)


_EVERY, _SAFETY = _Named(_ROWS.values()), _Named(row for row in _ROWS.values() if concerns_safety(row))


def _hashed(settings: Settings, named: _Named) -> str:
    values = [value.value if isinstance(value, Enum) else value for value in named.values(settings)]
    return hashlib.sha256(named.lines.format(*values).encode()).hexdigest()[:8]
