"""The page of reactions: it is the event table, it leaves nothing out, and what it says of the mode is what the robot does."""

import pytest

from pendant.event_table import TABLE
from pendant.events.event import Event
from pendant.events.event_row import LEAVING, Effect, Severity
from pendant.program.steps import HandGuide, ProgramState, Wait
from pendant.tick.modes import Law, Mode, Safety
from tests.pendant.robot.test_robot_mode import ENTERED, robot
from tools import reactions

ROWS = {name.strip("`"): cells for part in reactions.PARTS for name, *cells in reactions.rows(part)}


def test_it_has_each_event_that_stops_refuses_ends_or_warns_once() -> None:
    wanted = {kind for kind, row in TABLE.items() if row.effect in LEAVING or row.effect is Effect.NO_ENTRY}
    wanted |= {kind for kind, row in TABLE.items() if row.severity in (Severity.WARNING, Severity.STOP) or "REFUSED" in kind.name}
    text = reactions.page()
    assert {kind: text.count(f"\n| `{kind}` |") for kind in wanted} == dict.fromkeys(wanted, 1)
    assert not {"entered", "manipulation", "program_finished"} & set(ROWS)


def test_each_row_says_what_happens_and_how_it_clears_in_whole_sentences() -> None:
    unfinished = [name for name, cells in ROWS.items() if not all(cell.endswith(".") and cell[0].isalpha() for cell in cells[1:])]
    assert unfinished == []
    assert [name for name, cells in ROWS.items() if any("{" in cell or "  " in cell or "|" in cell for cell in cells)] == []


def test_every_stop_clears_by_a_reset() -> None:
    stops = [kind for kind, row in TABLE.items() if row.severity is Severity.STOP]
    assert [kind for kind in stops if "reset" not in ROWS[kind][2].lower()] == []


@pytest.mark.parametrize("standing", [False, True])
def test_what_it_says_of_a_stop_is_what_the_robot_does(standing: bool) -> None:
    """FD-1, IEC 60204-1."""
    for kind in [kind for kind, row in TABLE.items() if row.severity is Severity.STOP]:
        arm, said = robot(Wait(duration=9.0)), ROWS[kind][1]
        arm.static = standing
        arm.follow(Event(kind, 7), [])
        told = "The safety mode stays." if arm.safety is Safety.NORMAL else f"Safety mode `{arm.safety.name}`."
        assert (arm.mode, arm.sequencer.state, told in said) == (Mode.STOP, ProgramState.STOPPED, True), kind
        off = "off at once" in said or (standing and "off when it stands" in said)
        assert (arm.law() is Law.OFF) is off, kind


def test_what_it_says_of_a_program_that_asked_for_hand_guiding_is_what_it_does() -> None:
    """CD-15."""
    for kind in [kind for kind, row in TABLE.items() if row.effect is Effect.LEAVE]:
        arm, said = robot(HandGuide()), ROWS[kind][1]
        arm.follow(ENTERED, [])
        arm.follow(Event(kind, 7), [])
        assert arm.mode is Mode.RUN
        assert (arm.sequencer.state is ProgramState.RUNNING) is ("goes on" in said), kind
        assert (arm.sequencer.state is ProgramState.PAUSED) is ("pauses" in said), kind


def test_a_refusal_leaves_mode_and_program() -> None:
    for kind in [kind for kind, row in TABLE.items() if row.effect is Effect.NO_ENTRY]:
        arm = robot(Wait(duration=9.0))
        arm.follow(Event(kind, 7), [])
        assert (arm.mode, arm.safety, arm.sequencer.state) == (Mode.RUN, Safety.NORMAL, ProgramState.RUNNING), kind
