"""Plots and the contact log."""

import csv
import io
from collections.abc import Callable

import numpy as np
import pytest

from app.report.pull_colours import PULL_COLOURS
from app.web.server import Served
from app.web.tabs.contact_log import FADE, NOT_STOPPED, OFF
from app.web.tabs.plots import KEPT, View
from pendant.all_settings import apply
from pendant.events.event import Kind
from pendant.guided.pull import HandFelt, PullCauses
from tests.app.web.fake_loop import FakeLoop
from tests.app.web.raw_client import RawClient, until

Join = Callable[[], RawClient]
TOUCH = {
    "part": "tool",
    "source": "flange",
    "rule": "instant",
    "force": 12.0,
    "fx": 1.0,
    "fy": 0.0,
    "fz": -11.9,
    "acceleration": 2.0,
    "ax": 0.0,
    "ay": 1.2,
    "az": 1.6,
    "ratio": 3.0,
    "steps": 4,
    "speed": 120.0,
    "x": 0.5,
    "y": 0.1,
    "z": 0.2,
    "posture": "0.0000 -1.2000 1.5000 -1.8700 -1.5700 0.1000",
    "action": "stop",
}

HIT = {
    "part": "forearm",
    "force": 180.0,
    "speed": 250.0,
    "x": 0.5,
    "y": -0.1,
    "z": 0.2,
    "posture": TOUCH["posture"],
}


def test_a_sample_is_taken_twenty_times_a_second_and_memory_is_fixed(loop: FakeLoop, still: Served) -> None:
    plots = still.docks.plots
    force = plots.history.force
    for _ in range(KEPT + 100):
        loop.advance(0.05)
        plots.show(loop.latest())
        assert not plots.show(loop.latest())
    assert plots.history.force is force
    assert force.shape == (3, KEPT)
    assert np.isfinite(force).all()


def test_a_new_start_begins_empty(loop: FakeLoop, still: Served) -> None:
    loop.advance(1.0)
    still.docks.plots.show(loop.latest())
    loop.tick = 1
    still.docks.plots.show(loop.latest())
    assert np.isnan(still.docks.plots.history.rate).sum() == KEPT - 1


def test_a_moment_that_is_looked_at_stays_in_the_picture(loop: FakeLoop, still: Served) -> None:
    plots = still.docks.plots
    for _ in range(300):
        loop.advance(0.05)
        plots.show(loop.latest())
    plots.look_at(loop.tick - 2500)
    before = plots.upper.shown
    assert "stroke-dasharray" in before  # its mark
    for _ in range(20):
        loop.advance(0.05)
        plots.show(loop.latest())
    assert plots.upper.shown == before
    plots.look_at(None)
    assert "stroke-dasharray" not in plots.upper.shown


def test_a_row_of_the_log_shows_the_arm_as_it_was_then(loop: FakeLoop, still: Served) -> None:
    """As long as the plots keep it; a new start has no moments."""
    docks, q = still.docks, loop.latest().estimate.q.tolist()
    for _ in range(20):
        loop.advance(0.05)
        docks.plots.show(loop.latest())
    for tick, posture in (
        (loop.tick - 250, q),
        (loop.tick + 50, None),
        (loop.tick - 60 * 500, None),
        (loop.tick, q),
        (None, None),
    ):
        docks.journal.look_at(tick)
        assert docks.moment.posture == (None if posture is None else pytest.approx(tuple(posture)))
        assert docks.moment.text == ("" if posture is None or tick is None else f"At {tick / 500:.2f} s")
    docks.journal.look_at(loop.tick)
    loop.tick = 8
    docks.plots.show(loop.latest())
    docks.show(loop.latest())
    assert docks.moment.posture is None


@pytest.mark.parametrize("view", list(View))
def test_every_view_is_drawn(served: Served, join: Join, loop: FakeLoop, view: View) -> None:
    client = join()
    plots = served.docks.plots
    client.set(plots.view._impl.uuid, value=list(View)[-1].value)
    until(lambda: "Rate" in plots.upper.shown, "the last view")
    client.set(plots.view._impl.uuid, value=view.value)
    until(lambda: plots.view.value == view.value and "<svg" in plots.upper.shown, "drawn")
    until(lambda: plots.joint.visible == (view in (View.FRICTION, View.TORQUE)), "the joint's choice")


def test_the_mark_of_the_newest_contact_fades_and_goes_with_a_new_start(loop: FakeLoop, still: Served) -> None:
    contacts = still.docks.contacts
    for restart in (False, True):
        loop.tick = 1000
        loop.note(Kind.CONTACT_GAINED, **TOUCH)
        still.docks.show(loop.latest())
        assert (contacts.ball.visible, contacts.ball.opacity) == (True, 1.0)
        loop.tick += FADE // 2
        still.docks.show(loop.latest())
        assert contacts.ball.opacity == pytest.approx(0.5)
        loop.tick = 5 if restart else loop.tick + FADE
        still.docks.show(loop.latest())
        assert not any(node.visible for node in (contacts.ball, contacts.force, contacts.acceleration, contacts.label))


def test_a_contact_is_listed_marked_and_exported(loop: FakeLoop, still: Served) -> None:
    loop.tick = 1000
    loop.note(Kind.CONTACT_GAINED, **TOUCH)
    loop.tick = 1100
    loop.note(Kind.CONTACT_LOST, **(TOUCH | {"force": 9.0}))
    still.docks.show(loop.latest())
    still.docks.plots.show(loop.latest())
    contacts = still.docks.contacts
    shown = contacts.table.shown
    assert shown.index("lost") < shown.index("gained")
    for cell in ("tool", "500 100 200", "120", "12 −z", "8"):
        assert f"<td>{cell}</td>" in shown
    assert still.docks.plots.upper.shown.count("0v") == 2
    assert contacts.force.visible
    assert contacts.label.text == "2: lost, 9 N, 2.0 m/s²"
    contacts.choice.value = "contact 1"
    still.docks.show(loop.latest())
    assert contacts.label.text == "1: gained, 12 N, 2.0 m/s²"
    assert contacts.ghost.posture == (0.0, -1.2, 1.5, -1.87, -1.57, 0.1)
    contacts.choice.value = "newest"
    still.docks.show(loop.latest())
    assert contacts.ghost.posture is None
    rows = list(csv.DictReader(io.StringIO(contacts.file().decode())))
    assert [(row["t"], row["kind"], row["delay_ms"]) for row in rows] == [
        ("2.0", "contact_gained", "8"),
        ("2.2", "contact_lost", "8"),
    ]


def test_what_pulls_is_drawn_as_shares_and_told_in_words(loop: FakeLoop, still: Served) -> None:
    """FD-19: by the page's figures and the plot; a gap while the arm is not free."""
    docks, plots = still.docks, still.docks.plots
    plots.view.value = View.PULL.value
    for pull, told in (
        (None, "not in free-drive"),
        (PullCauses(HandFelt.NOBODY), "No hand"),
        (PullCauses(HandFelt.FLANGE, -1.0, 1.0, -9.0), "A hand"),
        (PullCauses(HandFelt.FLANGE, 3.5, 1.0, -9.0), "The payload fell: 97 %"),
        (None, "last: The payload fell: 97 %"),
    ):
        loop.pull = pull
        loop.advance(0.05)
        docks.show(loop.latest())
        plots.show(loop.latest())
        assert f"<em>{told}</em>" in plots.upper.shown
        assert ("Detected at the arm" in docks.panel.numbers.shown) is (pull is not None)
        assert pull is None or told in docks.panel.numbers.shown
    assert [colour in plots.upper.shown.split("<div>")[0] for colour in PULL_COLOURS] == [True, True, False, True, True]
    shares = plots.history.pull[:, -4:-1]
    assert shares.sum(axis=0) == pytest.approx(1.0)
    assert shares[3].tolist() == pytest.approx([0.0, 0.2689, 0.9707], abs=1e-4)
    assert np.isnan(plots.history.pull[:, -1]).all()


def test_a_hit_is_listed_beside_the_changes_in_contact_and_marked_when_it_is_chosen(loop: FakeLoop, still: Served) -> None:
    """Its own mark stands at the arm while it is stopped; of what held an arm the log tells where that is known."""
    contacts = still.docks.contacts
    loop.tick = 1000
    hit = HIT | {"joint": "elbow", "limit": 50.0}
    loop.note(Kind.COLLISION, **hit)
    loop.note(Kind.PATH_LEFT, **(HIT | {"part": "", "joint": "base", "value": 1.0, "limit": 0.8, "distance": 3.0}))
    still.docks.show(loop.latest())
    assert contacts.table.shown.count("<tr") == 2
    for cell in ("collision", "forearm", "500 −100 200", "250", "180", "–"):
        assert f"<td>{cell}</td>" in contacts.table.shown
    assert not contacts.ball.visible
    contacts.choice.value = "contact 1"
    still.docks.show(loop.latest())
    assert (contacts.ball.visible, contacts.force.visible, contacts.label.text) == (True, False, "1: collision, 180 N")
    row = next(csv.DictReader(io.StringIO(contacts.file().decode())))
    assert (row["kind"], row["part"], row["speed"], row["delay_ms"], row["rule"]) == ("collision", "forearm", "250.0", "", "")


def test_the_log_says_what_is_not_looked_for_and_has_its_switch(loop: FakeLoop, still: Served) -> None:
    contacts = still.docks.contacts
    still.docks.show(loop.latest())
    assert OFF in contacts.note.shown
    assert NOT_STOPPED not in contacts.note.shown
    assert not contacts.detects.value
    loop.settings = apply(loop.settings, {"contact.on": True, "collision.on": False})
    still.docks.show(loop.latest())
    assert OFF not in contacts.note.shown
    assert NOT_STOPPED in contacts.note.shown
    assert contacts.detects.value


def test_the_switch_of_the_log_switches_the_detection(served: Served, join: Join, loop: FakeLoop) -> None:
    client = join()
    client.set(served.docks.contacts.detects._impl.uuid, value=True)
    until(lambda: loop.desk.take().inputs.settings.get("contact.on") is True, "asked for")
