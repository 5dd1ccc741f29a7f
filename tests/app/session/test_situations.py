"""The situations of figures 3h, 3i, 4h and 4i tell two frictions apart: with them swapped, none is met (CD-17)."""

import msgspec
import pytest

from app.api import run, session
from sim.arm.scenario import TwoFrictions

NAMES = [f"contact-{figure}{letter}-{way}" for figure in "34" for letter in "hi" for way in ("falling", "rising")]


@pytest.mark.parametrize("name", NAMES)
def test_swapped_frictions_are_another_situation(name: str) -> None:
    whole = session(name)
    (plate,) = whole.world
    assert isinstance(plate, TwoFrictions)
    swapped = msgspec.structs.replace(plate, friction=plate.friction_beyond, friction_beyond=plate.friction)
    assert run(whole).passed
    unmet = [
        verdict.expected for verdict in run(session(whole, world=[msgspec.to_builtins(swapped)])).verdicts if not verdict.passed
    ]
    assert any("contact_resistance" in what for what in unmet)
