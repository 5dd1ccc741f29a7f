"""Every bundled session that names a switch: with it, all is met; without it, something is not."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from app.files.checked import BadInput, convert
from app.runs.runner import RunOutcome, missed, run, simulate
from app.session.claims import CLAIMS
from app.session.expectation_watch import Verdict
from app.session.expectations import Happens
from app.session.prepare import claiming, prepare, without
from app.session.session_file import Session, find
from tests import golden
from tests.passed import left_out_where_passed

SESSIONS = claiming()
ROOTS = (__name__,)
"""What a run of a session uses: this module, and all that it imports."""


def ran(session: Session, out: Path, enough: Callable[[Verdict], bool] | None = None) -> RunOutcome:
    prepared = prepare(session, "claim")
    return run(session, prepared, simulate(prepared), out, enough=enough)


def made(**fields: Any) -> Session:
    return convert({"title": "t", "duration": 1.0, **fields}, Session, "s.yaml")


@pytest.mark.parametrize("name", SESSIONS)
def test_a_claiming_session_holds(name: str, tmp_path: Path) -> None:
    before = golden.known()[name]
    with left_out_where_passed(f"{name}.on", ROOTS, find(name).read_text(), repr(before)):
        outcome = ran(SESSIONS[name], tmp_path)
        assert outcome.verdicts
        assert [verdict for verdict in outcome.verdicts if not verdict.passed] == []
        assert golden.differences(before, golden.deeds(outcome.events)) == []


@pytest.mark.parametrize("name", SESSIONS)
def test_and_fails_without_its_switch(name: str, tmp_path: Path) -> None:
    with left_out_where_passed(f"{name}.off", ROOTS, find(name).read_text()):
        assert ran(without(SESSIONS[name]), tmp_path, missed).unmet


def test_the_rows_are_those_of_the_sources() -> None:
    count = {group: sum(name.startswith(f"{group} ") and "fig" not in name for name in CLAIMS) for group in "ABC"}
    assert count == {"A": 32, "B": 22, "C": 21}
    assert sum("fig" in name for name in CLAIMS) == 22
    assert [name for name in CLAIMS if name.startswith("B fig 4h")] == ["B fig 4h falling", "B fig 4h rising"]


@pytest.mark.parametrize(
    ("fields", "says"),
    [
        ({"claims": ["A 33"], "switch": "FD-7"}, "s.yaml: claims[0] = A 33: the name of a claim"),
        ({"claims": ["A 3"]}, "s.yaml: switch: missing"),
        ({"switch": "FD-99"}, "s.yaml: switch = FD-99: one of FD-3"),
        ({"switch": "free_drive.period"}, "switch = free_drive.period"),
    ],
)
def test_what_is_no_claim_and_no_switch_is_refused(fields: dict[str, Any], says: str) -> None:
    with pytest.raises(BadInput) as refused:
        prepare(made(**fields), "s.yaml")
    assert says in str(refused.value)


def test_a_switch_is_a_requirement_or_a_setting() -> None:
    asked = made(switch="joint_control.q_speed", settings={"joint_control.q_speed": True, "free_drive.period": 5.0})
    off = prepare(without(asked), "s.yaml").settings
    assert prepare(asked, "s.yaml").settings.joint_control.q_speed
    assert not off.joint_control.q_speed
    assert off.free_drive.period == 5.0
    by_id = made(switch="FD-14", settings={"free_drive.period": 5.0})
    assert prepare(by_id, "s.yaml").settings.free_drive.period == 5.0
    assert prepare(without(by_id), "s.yaml").settings.free_drive.period == 30.0


NARROW = 0.4
"""A range whose half width is a smaller share of its middle has to say where it comes from."""

BRIEF = 0.05
"""So has a window for an event that is shorter [s]."""


@pytest.mark.parametrize("name", SESSIONS)
def test_a_narrow_range_says_where_it_comes_from(name: str) -> None:
    """What one run gave is no bound: arms differ."""
    unsaid = [expectation for expectation in SESSIONS[name].expectations if not expectation.why and _narrow(expectation)]
    assert unsaid == []


def _narrow(expectation: Any) -> bool:
    ranges = [*getattr(expectation, "numbers", {}).values(), expectation]
    bounds = [(getattr(each, "min", None), getattr(each, "max", None)) for each in ranges]
    if any(low is not None and high is not None and 0.0 < high - low < NARROW * abs(high + low) for low, high in bounds):
        return True
    return isinstance(expectation, Happens) and expectation.end is not None and expectation.end - expectation.begin < BRIEF
