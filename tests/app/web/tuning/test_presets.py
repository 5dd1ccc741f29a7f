"""The shipped presets: their files, and what they change."""

import json
from pathlib import Path

import msgspec
import pytest

import assets
from app.web.tuning.presets import ORDER, Preset, changes, presets
from pendant.all_settings import Settings, apply, value_of

SCHEMA = Path(assets.__file__).parent / "presets" / "preset.schema.json"


def test_the_four_presets_are_there_and_what_ships_comes_first() -> None:
    assert list(presets()) == ["As shipped", "Cautious", "Classroom", "Research"]
    assert len(ORDER) == 4
    assert presets()["As shipped"].whole == Settings()


@pytest.mark.parametrize("title", list(presets()))
def test_each_value_is_allowed_and_says_something(title: str) -> None:
    preset = presets()[title]
    listed = changes(Settings(), preset)
    assert apply(Settings(), {change.row.name: change.new for change in listed}) == preset.whole
    redundant = set(preset.settings) - {change.row.name for change in listed}
    assert redundant == set()


def test_the_cautious_preset_is_nowhere_faster_or_stronger() -> None:
    cautious = presets()["Cautious"].whole
    for name in ("tcp_speed", "elbow_speed", "joint_speed", "user_force"):
        assert value_of(cautious, f"limits.operation.{name}.max") < value_of(Settings(), f"limits.operation.{name}.max")


def test_what_protects_stays_on_in_every_preset() -> None:
    for preset in presets().values():
        for name in (
            "walls.on",
            "joint_limits.on",
            "sequence.on",
            "unexplained.motion",
            "unexplained.payload",
            "robot_limits.on",
        ):
            assert value_of(preset.whole, name) is True, (preset.title, name)


def test_the_schema_for_editors_is_fresh() -> None:
    assert json.loads(SCHEMA.read_text(encoding="utf-8")) == msgspec.json.schema(Preset)
