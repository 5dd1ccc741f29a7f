"""A quick size of the fuzzers, and that they find what they are for; `make fuzz` goes on for an hour."""

from pathlib import Path
from random import Random
from typing import Any

import msgspec
import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.files.checked import BadInput, load
from app.files.library import ASSETS
from sim.arm.arm_file import Arm
from sim.arm.scenario import ToolModel
from tools.fuzz.cases import Found, by_bytes, damaged, run, structured
from tools.fuzz.targets import Target, recording, targets
from tools.fuzz.values import places, values

TARGETS = targets()
CASES = {"session": 20, "arm": 20, "configuration": 20, "recording": 20}
"""Of those that cost more than a millisecond; of the others 60."""


@pytest.mark.parametrize("target", TARGETS, ids=lambda target: target.name)
def test_what_fits_the_types_is_taken_or_refused_in_a_line(target: Target, tmp_path: Path) -> None:
    told = structured(target, 7, CASES.get(target.name, 60), tmp_path)
    assert told["cases"] >= 1
    assert told["accepted"] > 0, "whatever is drawn is refused: nothing behind the checks is tried"


@pytest.mark.parametrize("target", TARGETS, ids=lambda target: target.name)
def test_damaged_bytes_are_taken_or_refused_in_a_line(target: Target, tmp_path: Path) -> None:
    assert by_bytes(target, 7, CASES.get(target.name, 60), tmp_path)["cases"] == CASES.get(target.name, 60)


def target_of(behaviour: object) -> Target:
    def act(path: Path) -> None:
        if isinstance(behaviour, Exception):
            raise behaviour
        assert callable(behaviour)
        behaviour()

    return Target("x", ".yaml", act, st.just(b""), [b"abc"])


def test_a_traceback_and_a_refusal_of_two_lines_are_found(tmp_path: Path) -> None:
    with pytest.raises(Found, match="ZeroDivisionError"):
        run(target_of(ZeroDivisionError("x")), b"", tmp_path)

    class TwoLines(BadInput):
        def __str__(self) -> str:
            return "a\nb"

    with pytest.raises(Found, match="not one line"):
        run(target_of(TwoLines("", "", "", "")), b"", tmp_path)
    assert run(target_of(BadInput("f", "a", 1, "2")), b"", tmp_path) is False
    assert run(target_of(lambda: None), b"", tmp_path) is True


def test_what_takes_too_long_is_found(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("tools.fuzz.cases.SLOWEST", 0.01)
    with pytest.raises(Found, match="of processor time"):
        run(target_of(lambda: sum(range(10_000_000))), b"", tmp_path)


def test_every_place_of_an_arm_can_be_filled_anew() -> None:
    found = {path for path, _ in places(load(ASSETS / "robots" / "ur5e.yaml", dict[str, Any]), Arm)}
    assert {("reach",), ("limits", "speed", 3), ("shapes", 0, "radius")} <= found
    assert ("sensors", "force_torque", "drift", "warm_up") in found
    assert len(found) > 300


@given(values(ToolModel))
def test_values_fit_their_type(raw: object) -> None:
    tool = msgspec.convert(raw, ToolModel)
    assert 0.0 <= tool.mass <= 1000.0
    assert 0.001 <= tool.radius <= 2.0


def test_damaged_files_differ() -> None:
    whole, chance = recording(), Random(1)
    assert len({damaged(whole, chance) for _ in range(20)}) == 20
