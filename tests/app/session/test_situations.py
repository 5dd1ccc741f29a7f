"""The situations of figures 3h, 3i, 4h and 4i tell two frictions apart: with them swapped, none is met (CD-17)."""

import msgspec
import pytest

from app.api import run, session
from app.session.session_file import find
from sim.arm.scenario import TwoFrictions
from tests.passed import left_out_where_passed

NAMES = [f"contact-{figure}{letter}-{way}" for figure in "34" for letter in "hi" for way in ("falling", "rising")]


@pytest.mark.parametrize("name", NAMES)
def test_swapped_frictions_are_another_situation(name: str) -> None:
    with left_out_where_passed(f"{name}.swapped", (__name__,), find(name).read_text()):
        whole = session(name)
        (plate,) = whole.world
        assert isinstance(plate, TwoFrictions)
        swapped = msgspec.structs.replace(plate, friction=plate.friction_beyond, friction_beyond=plate.friction)
        assert run(whole).passed
        outcome = run(session(whole, world=[msgspec.to_builtins(swapped)]))
        assert any("contact_resistance" in verdict.expected for verdict in outcome.verdicts if not verdict.passed)
