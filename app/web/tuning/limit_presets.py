"""The robot's limits for people: a row each with value, tolerance and source, and four presets, from assets/limits/."""

import functools
from collections.abc import Iterator
from math import degrees
from typing import NamedTuple

import msgspec

from app.files.checked import load
from app.files.library import ASSETS
from pendant.safety.robot_limits import (
    DISTANCE_TOLERANCE,
    JOINT_SPEED_TOLERANCE,
    MOMENTUM_TOLERANCE,
    POSITION_TOLERANCE,
    POWER_TOLERANCE,
    SPEED_TOLERANCE,
    TIME_TOLERANCE,
)
from pendant.safety.settings import FURTHEST, ModeLimits, RobotLimitSettings
from pendant.settings.schema import Section, Value

AS_SHIPPED = "As shipped"
"""Title of the preset that ships."""

OTHER = "Own values"
"""Told where the limits are those of no preset."""


class LimitPreset(msgspec.Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """The limits of both safety modes, by the names of their settings."""

    title: str
    assumed: bool  # the values are not the maker's; then the source is the rule that they follow
    source: str
    normal: ModeLimits
    reduced: ModeLimits

    @property
    def settings(self) -> dict[str, Value]:
        """Values by the dotted names of the settings."""
        modes = {"normal": self.normal, "reduced": self.reduced}
        return {f"robot_limits.{mode}.{name}": value for mode, held in modes.items() for name, value in _values(held)}


class LimitPresets(msgspec.Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """The file."""

    title: str
    presets: list[LimitPreset]


class LimitRow(NamedTuple):
    """How a limit is told."""

    name: str
    field: str  # of its setting
    unit: str
    factor: float  # of the unit, to the setting's
    tolerance: float | None  # beyond which the arm is stopped, in the setting's unit; None: at the limit itself


ROWS = (
    LimitRow("Tool speed", "tool_speed", "mm/s", 1e3, SPEED_TOLERANCE),
    LimitRow("Elbow speed", "elbow_speed", "mm/s", 1e3, SPEED_TOLERANCE),
    LimitRow("Tool force", "tool_force", "N", 1.0, None),
    LimitRow("Elbow force", "elbow_force", "N", 1.0, None),
    LimitRow("Momentum", "momentum", "kg·m/s", 1.0, MOMENTUM_TOLERANCE),
    LimitRow("Power", "power", "W", 1.0, POWER_TOLERANCE),
    LimitRow("Stopping time", "stopping_time", "ms", 1e3, TIME_TOLERANCE),
    LimitRow("Stopping distance", "stopping_distance", "mm", 1e3, DISTANCE_TOLERANCE),
)
JOINT_SPEEDS = LimitRow("Joint speed", "joint_speeds", "°/s", degrees(1.0), JOINT_SPEED_TOLERANCE)
POSITIONS = LimitRow("Joint positions", "positions", "°", degrees(1.0), POSITION_TOLERANCE)


@functools.cache
def limit_presets() -> dict[str, LimitPreset]:
    """The presets that ship by title, from the most to the least restricted.

    Raises:
        BadInput: the file was edited into something else.
    """
    return {preset.title: preset for preset in load(ASSETS / "limits" / "robot-limits.yaml", LimitPresets).presets}


def preset_of(settings: RobotLimitSettings) -> str:
    """Title of the preset whose values hold, or `OTHER`."""
    for title, preset in limit_presets().items():
        if (settings.normal, settings.reduced) == (preset.normal, preset.reduced):
            return title
    return OTHER


def told_limits(settings: RobotLimitSettings) -> Iterator[tuple[str, str, str, str]]:
    """A row for each limit: name, value in NORMAL, in REDUCED, tolerance."""
    for row in ROWS:
        values = [f"{row.factor * getattr(held, row.field):g} {row.unit}" for held in (settings.normal, settings.reduced)]
        yield row.name, values[0], values[1], _tolerance(row)
    yield JOINT_SPEEDS.name, _joint_speeds(settings.normal), _joint_speeds(settings.reduced), _tolerance(JOINT_SPEEDS)
    yield POSITIONS.name, _positions(settings.normal), _positions(settings.reduced), _tolerance(POSITIONS)


def _values(held: ModeLimits) -> Iterator[tuple[str, Value]]:
    """Dotted names and values of all limits of a safety mode."""
    for name in held.__struct_fields__:
        value = getattr(held, name)
        if isinstance(value, Section):
            yield from ((f"{name}.{each}", getattr(value, each)) for each in value.__struct_fields__)
        else:
            yield name, value


def _tolerance(row: LimitRow) -> str:
    return "" if row.tolerance is None else f"{row.factor * row.tolerance:.4g} {row.unit}"


def _joint_speeds(limits: ModeLimits) -> str:
    """What each joint may have, joint by joint where they differ."""
    held = limits.joint_speeds
    values = [JOINT_SPEEDS.factor * getattr(held, name) for name in held.__struct_fields__]
    if len(set(values)) == 1:
        return f"{values[0]:.4g} {JOINT_SPEEDS.unit}"
    return ", ".join(f"{joint}: {value:.4g}" for joint, value in enumerate(values, 1)) + f" {JOINT_SPEEDS.unit}"


def _positions(limits: ModeLimits) -> str:
    """The joints whose range is limited, by their numbers."""
    held, told = limits.positions, list[str]()
    for joint in range(1, len(held.__struct_fields__) // 2 + 1):
        low, high = getattr(held, f"j{joint}_min"), getattr(held, f"j{joint}_max")
        if (low, high) != (-FURTHEST, FURTHEST):
            told.append(f"{joint}: {degrees(low):.0f} to {degrees(high):.0f}°")
    return ", ".join(told) or "the arm's own"
