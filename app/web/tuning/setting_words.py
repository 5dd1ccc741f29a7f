"""Settings in the words of the field: titles of sections, names of rows, what a row says of itself."""

from collections.abc import Sequence

from pendant.all_settings import describe, find
from pendant.events.event import Event, Kind
from pendant.settings.schema import SettingError, SettingRow, Value

CHANGED = "● "
"""Stands before the name of a setting that is not as shipped."""

TITLES = {
    "signals": "Signals that start free-drive",
    "activation": "Activation of free-drive",
    "handshake": "Confirmation",
    "let_go": "Letting go before the check",
    "sequence": "Check before free-drive",
    "free_drive": "Free-drive",
    "hold": "Silence of a held button",
    "button": "Free-drive button",
    "enabling": "Enabling device",
    "robot_limits": "Robot limits",
    "following": "Following error",
    "collision": "Collisions",
    "limits.activation": "Limits of the check",
    "limits.maintain": "Limits that show a guiding hand",
    "limits.operation": "Limits during free-drive",
    "limits.deactivation": "Limits that end free-drive",
    "unexplained": "Unintended motion, dropped payload",
    "soft": "Resistance before a limit",
    "axes": "Locked axes",
    "joints": "Locked joints",
    "joint_limits": "Ends of the joints' ranges",
    "walls": "Virtual walls and areas",
    "haptics": "Haptic feedback",
    "static": "Standstill",
    "tools": "Tool and payload",
    "joint_control": "Joint control",
    "contact": "Contact detection",
    "program": "Programs",
}

SAFETY = {
    "free_drive.period": "Free-drive, no motion",
    "free_drive.restart_period": "Free-drive, standstill",
    "limits.operation.tcp_speed.max": "Tool speed, guided",
    "limits.operation.elbow_speed.max": "Elbow speed, guided",
    "limits.operation.joint_speed.max": "Joint speed, guided",
    "limits.operation.user_force.max": "Hand force, at most",
    "robot_limits.reduced.tool_speed": "Tool speed, reduced mode",
    "limits.activation.payload_force.max": "Payload error, at most",
    "walls.on": "Virtual walls and areas",
    "joint_limits.on": "Stop at joint ranges",
    "button.hold_to_run": "Hold-to-run free-drive",
    "enabling.on": "Enabling device",
}
"""The values of a robot's safety screen, with the names that they have there."""


def section_of(row: SettingRow) -> str:
    """The section that a setting is shown in."""
    return ".".join(row.name.split(".")[: 2 if row.name.startswith("limits.") else 1])


def title_of(section: str) -> str:
    """The section in plain words."""
    return TITLES.get(section, section.replace("_", " ").replace(".", ", ").capitalize())


SECTIONS = tuple(dict.fromkeys(section_of(row) for row in describe()))


def name_of(row: SettingRow) -> str:
    """A setting's name within its section, without unit."""
    name = row.name.removeprefix(section_of(row) + ".").replace("_", " ").removesuffix(".max").replace(".", ", ")
    return name[:1].upper() + name[1:]


def label(row: SettingRow, value: Value, name: str = "") -> str:
    """What stands beside its control."""
    return f"{CHANGED if value != row.default else ''}{name or name_of(row)}{f' [{row.unit}]' if row.unit else ''}"


def told(value: Value, unit: str = "") -> str:
    """A value in words."""
    if isinstance(value, bool):
        return "on" if value else "off"
    return f"{value:g} {unit}".rstrip() if isinstance(value, int | float) else str(value)


def about(row: SettingRow, value: Value) -> str:
    """What a setting is, what it may be, and how it ships."""
    text = row.text[:1].upper() + row.text[1:]
    shipped = f"As shipped: {told(row.default, row.unit)}."
    if row.low is None or row.high is None:
        return f"{text}. {shipped}"
    end = " This is the largest value." if value == row.high else " This is the smallest value." if value == row.low else ""
    return f"{text}. {row.low:g} to {row.high:g} {row.unit}".rstrip() + f". {shipped}{end if value != row.default else ''}"


def found(words: str, rows: list[SettingRow]) -> list[SettingRow]:
    """The rows that have every one of the words in their name, section, text or requirement."""
    wanted = words.casefold().split()

    def text(row: SettingRow) -> str:
        plain = row.name.replace("_", " ").replace(".", " ")
        return f"{row.name} {plain} {title_of(section_of(row))} {SAFETY.get(row.name, '')} {row.text} {row.id}".casefold()

    return [row for row in rows if all(word in text(row) for word in wanted)]


def setting_change(event: Event, joints: Sequence[str]) -> str:
    """Name and value, in words, of a setting that was changed, or was not; `joints` has the names of the arm's."""
    name, refused = str(event.values["name"]), event.kind is Kind.SETTING_REFUSED
    value = event.values["value" if refused else "new"]
    try:
        row = find(name)
    except SettingError:
        return f"{name}: {value} refused"
    section, own = section_of(row), row.name.rpartition(".")[2]
    if row.name == "program.speed" and isinstance(value, float):
        text = f"Speed {100.0 * value:.0f} %"
    elif section in ("joints", "axes") and own.lstrip("jr") in (*"xyz", *map(str, range(1, 13))):
        if section == "joints":
            number = int(own[1:])
            what = joints[number - 1].replace("_", " ").capitalize() if number <= len(joints) else f"Joint {number}"
        else:
            what = f"{'Turning about' if own[0] == 'r' else 'Moving along'} {own[-1]}"
        text = f"{what}: {'free' if value else 'locked'}"
    else:
        own = "" if own == "on" else f", {name_of(row).lower()}"  # the switch of a section is that section
        text = f"{SAFETY.get(row.name) or title_of(section) + own}: {told(value, row.unit)}"
    return f"{text} refused" if refused else text
