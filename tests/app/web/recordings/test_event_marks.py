"""Events along a time line."""

from app.log.events_file import line_of
from app.web.panel.state_words import SEVERITY_COLOURS
from app.web.recordings.event_marks import NOWHERE, PLACES, EventMarks, moment
from app.web.server import Served
from pendant.event_table import TABLE
from pendant.events.event import Event, Kind


def test_each_part_of_the_line_has_one_mark_of_its_gravest_event(still: Served) -> None:
    gui, jumps = still.server.gui, list[float]()
    marks = EventMarks(gui, gui.add_slider("Time", 0.0, 10.0, 0.01, 0.0), jumps.append)
    assert (marks.shown, marks.choice.visible, marks.choice.options) == ("", False, (NOWHERE,))
    events = [line_of(Event(Kind.RESET, tick, {})) for tick in range(0, 5000, 5)]
    events[501:501] = [grave := line_of(Event(Kind.EMERGENCY_STOP, 2501, {"mode": "TEACH"}))]
    marks.show(events, 10.0)
    assert marks.shown.count("data-pd-pick") == PLACES
    assert marks.shown.count(f"--c:{SEVERITY_COLOURS[TABLE[Kind.EMERGENCY_STOP].severity].value}") == 1
    assert moment(grave) in marks.shown
    assert moment(grave) in marks.choice.options
    marks.show((), 0.0)
    assert (marks.shown, marks.choice.visible) == ("", False)
