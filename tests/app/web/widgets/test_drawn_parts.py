"""A part of the page that fails is told in its place, ends nothing, and is drawn again."""

from collections.abc import Callable, Iterator

import pytest
import viser

from app.web.server import Served
from app.web.widgets.drawn_parts import DrawnParts
from pendant.events.event import Kind, Values
from sim.run import troubles
from sim.run.troubles import Troubles
from tests.app.web.fake_loop import FakeLoop
from tests.app.web.raw_client import RawClient, until


@pytest.fixture
def gui() -> Iterator[viser.GuiApi]:
    server = viser.ViserServer(port=0, verbose=False)
    yield server.gui
    server.stop()


def fail(text: str) -> Callable[[], bool]:
    def failing() -> bool:
        raise RuntimeError(text)

    return failing


def test_a_note_stands_in_its_place_for_as_long_as_it_fails(gui: viser.GuiApi) -> None:
    now, told = [100.0], list[Values]()
    board = Troubles(lambda kind, values: told.append(values), clock=lambda: now[0])
    parts = DrawnParts(gui, board)
    with gui.add_folder("place") as place:
        pass
    assert parts.draw("the tab", fail("deque mutated during iteration"), place)
    (note,) = place._children.values()
    assert "Not up to date: the tab" in note.content  # type: ignore[attr-defined]
    assert "deque mutated during iteration" in note.content  # type: ignore[attr-defined]
    assert not parts.draw("the tab", fail("deque mutated during iteration"), place), "the same is not drawn again"
    assert parts.draw("another", lambda: True)
    assert board.now() == {"the tab": "RuntimeError: deque mutated during iteration"}
    now[0] += troubles.CALM - 0.1
    assert not parts.draw("the tab", lambda: False, place), "it may fail again at once"
    assert board.now()
    now[0] += 0.2
    assert parts.draw("the tab", lambda: False, place)
    assert not place._children
    assert board.now() == {}
    assert told == [{"part": "the tab", "reason": "RuntimeError: deque mutated during iteration"}]


def test_what_fails_on_and_on_is_told_again_after_a_while() -> None:
    now, told = [100.0], list[Values]()
    board = Troubles(lambda kind, values: told.append(values), clock=lambda: now[0])
    for _ in range(3):
        board.failed("the tab", ValueError("x"))
    assert len(told) == 1
    board.failed("the tab", ValueError("y"))
    assert len(told) == 2
    now[0] += troubles.AGAIN
    board.failed("the tab", ValueError("x"))
    assert len(told) == 3
    board.failed("the network", OSError("gone"), for_good=True)
    now[0] += 1e6
    assert board.now() == {"the network": "OSError: gone"}


def test_a_note_that_cannot_be_drawn_is_told_all_the_same(gui: viser.GuiApi, monkeypatch: pytest.MonkeyPatch) -> None:
    board = Troubles(lambda kind, values: None)
    parts = DrawnParts(gui, board)
    monkeypatch.setattr("app.web.widgets.drawn_parts.Html", fail("no html"))
    assert parts.draw("the tab", fail("x"))
    assert set(board.now()) == {"the tab", "the note on the tab"}


@pytest.mark.parametrize(
    ("owner", "part"),
    [
        ("docks.script", "the tab Script"),
        ("docks.journal", "the tab Events"),
        ("docks.teach", "the tab Teach"),
        ("panel", "the pendant"),
        ("scene", "the picture of the arm"),
        ("control", "who has control"),
        ("preferences", "sounds"),
        ("docks.plots", "the tab Plots"),
    ],
)
def test_one_part_takes_nobody_with_it(
    served: Served, loop: FakeLoop, join: Callable[[], RawClient], monkeypatch: pytest.MonkeyPatch, owner: str, part: str
) -> None:
    """The page died for good when one tab met a list that changed while it was gone through."""
    monkeypatch.setattr(troubles, "CALM", 0.3)
    join()
    thing = served
    for name in owner.split("."):
        thing = getattr(thing, name)
    if thing is None:  # no scripts on this page
        served.docks.script = thing = Failing()  # type: ignore[assignment]
        served.docks._script_dock = served.docks._record_dock
    before = served.beat.shown
    monkeypatch.setattr(thing, "show", lambda *_: fail("deque mutated during iteration")())

    def goes_on() -> bool:
        loop.advance(0.02)
        return served.beat.shown != before

    until(lambda: part in loop.troubles.now() or goes_on() is None, "it is told")
    until(goes_on, "the heartbeat of the page")
    assert any(event.kind is Kind.PART_BROKEN and event.values["part"] == part for event in loop.events(0))
    monkeypatch.undo()
    monkeypatch.setattr(troubles, "CALM", 0.3)
    if isinstance(thing, Failing):
        thing.failing = False
    until(lambda: (loop.advance(0.02), part not in loop.troubles.now() and part not in served.docks.parts._notes)[1], "it goes")


class Failing:
    """A tab that fails."""

    failing = True

    def show(self) -> bool:
        """It does."""
        if self.failing:
            raise RuntimeError
        return False
