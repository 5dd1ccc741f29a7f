"""The robot's limits as people see them: a row for every limit on the page and in the docs, and four presets (RL-4)."""

from itertools import pairwise
from pathlib import Path

import msgspec
import pytest

from app.web.tuning.limit_presets import AS_SHIPPED, JOINT_SPEEDS, OTHER, POSITIONS, ROWS, limit_presets, preset_of, told_limits
from pendant.all_settings import Settings, apply, value_of

GUIDE = (Path(__file__).parents[4] / "docs" / "guide" / "stops.md").read_text(encoding="utf-8")


def test_every_limit_has_a_row_on_the_page_and_in_the_docs() -> None:
    shipped = Settings().robot_limits
    fields = [field.name for field in msgspec.structs.fields(shipped.normal)]
    assert fields == [field.name for field in msgspec.structs.fields(shipped.reduced)]
    assert sorted(fields) == sorted([*[row.field for row in ROWS], JOINT_SPEEDS.field, POSITIONS.field])
    page = list(told_limits(Settings().robot_limits))
    assert [row[0] for row in page] == [*[row.name for row in ROWS], JOINT_SPEEDS.name, POSITIONS.name]
    for name, normal, reduced, tolerance in page:
        (line,) = [line for line in GUIDE.splitlines() if line.startswith(f"| {name.lower()} |")]
        cells = [cell.strip() for cell in line.split("|")]
        assert cells[3:6] == [normal, reduced, tolerance or "none"], name


def test_four_presets_from_most_to_least_restricted_of_which_the_third_ships() -> None:
    presets = list(limit_presets().values())
    assert [preset.title for preset in presets] == ["Most restricted", "Restricted", AS_SHIPPED, "Least restricted"]
    assert apply(Settings(), presets[2].settings) == Settings()
    for tighter, wider in pairwise(presets):
        assert all(tighter.settings[name] <= value for name, value in wider.settings.items())  # type: ignore[operator]
    for preset in presets:
        assert all(getattr(preset.reduced, row.field) <= getattr(preset.normal, row.field) for row in ROWS)
        assert len(preset.source) > 20


@pytest.mark.parametrize("title", list(limit_presets()))
def test_a_preset_that_was_taken_is_known_by_its_name(title: str) -> None:
    settings = apply(Settings(), limit_presets()[title].settings)
    assert preset_of(settings.robot_limits) == title
    assert value_of(settings, "robot_limits.normal.tool_speed") == limit_presets()[title].normal.tool_speed
    for other in ({"robot_limits.normal.power": 77.0}, {"robot_limits.reduced.positions.j1_max": 0.5}):
        assert preset_of(apply(settings, other).robot_limits) == OTHER


def test_joint_speeds_are_told_joint_by_joint_where_they_differ() -> None:
    settings = apply(Settings(), {"robot_limits.reduced.joint_speeds.j2": 0.5})
    told = {name: values for name, *values in told_limits(settings.robot_limits)}
    others = ", ".join(f"{k}: 371.5" for k in range(3, 7))
    assert told[JOINT_SPEEDS.name] == ["371.5 °/s", f"1: 371.5, 2: 28.65, {others} °/s", "1.15 °/s"]


def test_the_joints_whose_positions_are_limited_are_named() -> None:
    settings = apply(Settings(), {"robot_limits.reduced.positions.j2_max": 1.0})
    assert list(told_limits(settings.robot_limits))[-1] == (POSITIONS.name, "the arm's own", "2: -363 to 57°", "5 °")
