"""Named presets of settings, from files of assets/presets; what taking one changes."""

import functools
from typing import Annotated, NamedTuple

import msgspec
import yaml
from msgspec import Meta

from app.files.checked import load, parse
from app.session.session_file import bundled, folder
from app.session.timeline_checks import applied
from pendant.all_settings import Settings, apply, describe, value_of
from pendant.settings.schema import SettingRow, Value

ORDER = ("as-shipped", "cautious", "classroom", "research")
"""The shipped presets from what everybody has to what few need; others follow by name."""


class Preset(msgspec.Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """The file of a preset. What it does not name is as shipped."""

    title: Annotated[str, Meta(min_length=1, max_length=30, description="its name on the page")]
    text: Annotated[str, Meta(min_length=1, max_length=400, description="whom it is for, in one or two sentences")]
    settings: Annotated[dict[str, bool | int | float | str], Meta(description="values by dotted name")] = {}

    @property
    def whole(self) -> Settings:
        """All settings as the preset has them. Raises SettingError: a name or a value that is not allowed."""
        return apply(Settings(), self.settings)


class PresetChange(NamedTuple):
    """What taking a preset does to one setting."""

    row: SettingRow
    old: Value
    new: Value


@functools.cache
def presets() -> dict[str, Preset]:
    """The shipped presets by title, in their order."""
    names = sorted(bundled("presets"), key=lambda name: (ORDER.index(name) if name in ORDER else len(ORDER), name))
    found = [load(folder("presets") / f"{name}.yaml", Preset) for name in names]
    return {preset.title: preset for preset in found}


def as_file(settings: Settings) -> bytes:
    """Settings as the file of a preset."""
    changed = {row.name: value_of(settings, row.name) for row in describe() if value_of(settings, row.name) != row.default}
    preset = Preset(title="Saved", text="Settings that were saved on the page.", settings=changed)
    return yaml.safe_dump(msgspec.to_builtins(preset), sort_keys=False, allow_unicode=True).encode()


def from_file(name: str, content: bytes) -> Preset:
    """The preset in a file that a page hands in.

    Raises:
        BadInput: it is none, or a name or a value in it is not allowed.
    """
    preset = parse(content.decode("utf-8", "replace"), Preset, name)
    applied(Settings(), preset.settings, name, "settings")
    return preset


def changes(now: Settings, preset: Preset) -> list[PresetChange]:
    """What is different in the preset, in the order of the schema."""
    wanted = preset.whole
    rows = ((row, value_of(now, row.name), value_of(wanted, row.name)) for row in describe())
    return [PresetChange(row, old, new) for row, old, new in rows if old != new]
