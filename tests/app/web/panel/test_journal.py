"""The event log: repeats, filter, dividing line, and the way to the plots."""

from collections.abc import Callable

from app.web.panel.journal import FILTERS, NOW
from app.web.server import Served
from pendant.events.event import Kind
from tests.app.web.fake_loop import FakeLoop
from tests.app.web.raw_client import RawClient, until

Join = Callable[[], RawClient]


def log(loop: FakeLoop, still: Served) -> str:
    still.docks.show(loop.latest())
    return still.docks.journal.table.shown


def test_what_repeats_is_one_row_with_a_count_also_when_it_alternates(loop: FakeLoop, still: Served) -> None:
    for _ in range(7):
        loop.note(Kind.ZERO_DUE, force=3.0, torque=0.1)
        loop.note(Kind.DEACTIVATED)
        loop.tick += 200
    shown = log(loop, still)
    assert shown.count("<tr") == 2
    assert shown.count("7 ×") == 2
    loop.tick += 20_000
    loop.note(Kind.DEACTIVATED)
    assert log(loop, still).count("<tr") == 3


def test_two_settings_are_two_rows(loop: FakeLoop, still: Served) -> None:
    for name in ("free_drive.gain", "free_drive.period"):
        loop.note(Kind.SETTING_CHANGED, name=name, old=1.0, new=2.0)
    assert log(loop, still).count("<tr") == 2


def test_lateness_is_no_row(loop: FakeLoop, still: Served) -> None:
    loop.note(Kind.OVERRUN, late=80.0, lost=0.08, often="once")
    assert "Nothing has happened yet" in log(loop, still)
    loop.actual_rate = 0.4
    still.docks.show(loop.latest())
    assert "Late: 0.4 ×" in still.panel.light.shown


def test_start_over_is_a_dividing_line(loop: FakeLoop, still: Served) -> None:
    loop.tick = 4000
    loop.note(Kind.RESET)
    loop.tick = 10
    loop.note(Kind.RESET)
    shown = log(loop, still)
    assert shown.index("0.02 s") < shown.index("Started over") < shown.index("8.00 s")


def test_the_filter_shows_its_kind_alone(served: Served, join: Join, loop: FakeLoop) -> None:
    client = join()
    journal = served.docks.journal
    loop.note(Kind.SETTING_CHANGED, name="free_drive.gain", old=1.0, new=2.0)
    loop.note(Kind.EMERGENCY_STOP, mode="TEACH")
    until(lambda: journal.table.shown.count("<tr") == 2, "both")
    client.set(journal.filter._impl.uuid, value="Stops and refusals")
    until(lambda: journal.table.shown.count("<tr") == 1 and "Free-drive, gain" not in journal.table.shown, "the stop alone")
    assert len(FILTERS) == 6


def test_what_a_guiding_hand_repeats_is_shown_among_everything_alone(served: Served, join: Join, loop: FakeLoop) -> None:
    client, journal = join(), served.docks.journal
    loop.note(Kind.ENTERED, source="button", compensated="none")
    loop.note(Kind.RESTARTED, period=3.0)
    loop.note(Kind.PERIOD_ANEW, period=3.0)
    until(lambda: journal.table.shown.count("<tr") == 1, "the entry alone")
    client.set(journal.filter._impl.uuid, value="Everything")
    until(lambda: journal.table.shown.count("<tr") == 3, "all of it")


def test_a_silence_that_was_a_plain_release_is_taken_off_the_log_and_the_panel(loop: FakeLoop, still: Served) -> None:
    still.panel.holds.hold(3)
    loop.advance(0.6)
    loop.note(Kind.HOLD_SILENT, value=0.502, limit=0.5)
    assert "Connection slow: button treated as released" in log(loop, still)
    assert still.panel.said.headline == "Connection slow: button treated as released"
    loop.advance(0.2)
    still.panel.holds.lift(3)
    assert "Connection slow: button treated as released" not in log(loop, still)
    assert still.panel.said.headline != "Connection slow: button treated as released"
    assert not still.docks.journal.forget(loop.log.since(0)[-1])


def test_of_two_silences_one_may_have_been_a_plain_release(loop: FakeLoop, still: Served) -> None:
    for again in (False, True):
        still.panel.holds.hold(3)
        loop.advance(0.6)
        loop.note(Kind.HOLD_SILENT, value=0.502, limit=0.5)
        log(loop, still)
        loop.advance(0.1 if again else 3.0)
        still.panel.holds.lift(3)
    shown = log(loop, still)
    assert "Connection slow: button treated as released" in shown
    assert "2 ×" not in shown


def test_a_row_leads_to_its_moment_in_the_plots(served: Served, join: Join, loop: FakeLoop) -> None:
    client = join()
    journal = served.docks.journal
    loop.tick = 1000
    loop.note(Kind.RESET)
    until(lambda: len(journal.moment.options) == 2, "a moment")
    moment = journal.moment.options[1]
    assert f'data-pd-pick="{moment}"' in journal.table.shown
    client.set(journal.moment._impl.uuid, value=moment)
    until(lambda: served.docks.plots._moment == 1000, "looked at")
    client.set(journal.moment._impl.uuid, value=NOW)
    until(lambda: served.docks.plots._moment is None, "followed")
