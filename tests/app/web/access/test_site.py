"""A page is drawn where viser talks to its clients, and nowhere else."""

import logging
import threading
from collections.abc import Callable

import pytest

from app.web.access.listening import HERE
from app.web.access.site import Site
from app.web.server import Served
from pendant.events.event import Kind, Values
from pendant.inputs import Command
from pendant.tick.modes import Mode
from sim.run.troubles import Troubles
from tests.app.web.fake_loop import FakeLoop
from tests.app.web.raw_client import RawClient, until


class Sketch(Site):
    """A page that notes who draws it, `most` times; then drawing ends. Each picture fails with `failure`, if there is one."""

    def __init__(self, most: int, failure: Exception | None = None) -> None:
        self.told: list[Values] = []
        super().__init__(HERE, 0, Troubles(lambda kind, values: self.told.append(values)))
        self.painters: list[int | None] = []
        self._most, self._failure = most, failure
        self.start_drawing()

    def draw(self) -> bool:
        self.painters.append(threading.current_thread().ident)
        if self._failure is not None:
            raise self._failure
        return len(self.painters) < self._most


def test_all_pictures_are_drawn_by_the_thread_that_serves() -> None:
    site = Sketch(5)
    until(lambda: len(site.painters) == 5, "five pictures")
    where: list[int | None] = []
    site.server.get_event_loop().call_soon_threadsafe(lambda: where.append(threading.current_thread().ident))
    until(lambda: bool(where), "the event loop has answered")
    site.close()
    assert site.painters == 5 * where
    assert where[0] != threading.current_thread().ident


def test_drawing_ends_when_there_is_nothing_new_any_more() -> None:
    site = Sketch(3)
    until(site._painter.done, "drawing has ended")
    site.close()
    assert len(site.painters) == 3


def test_a_picture_that_fails_is_told_once_and_the_next_one_follows(caplog: pytest.LogCaptureFixture) -> None:
    """One failure ended drawing for good; the end of the page then raised it again, and left the recording unfinished."""
    with caplog.at_level(logging.ERROR):
        site = Sketch(2, ValueError("no such colour"))
        until(lambda: len(site.painters) > 5, "pictures follow")
        assert site.drawing
        assert site.troubles.now() == {"the page": "ValueError: no such colour"}
        site.close()
    assert not site.drawing
    assert caplog.text.count("does not work: the page") == 1
    assert site.told == [{"part": "the page", "reason": "ValueError: no such colour"}]


def test_what_a_control_does_wrong_is_told(served: Served, loop: FakeLoop, join: Callable[[], RawClient]) -> None:
    client = join()

    @served.panel.reset.on_click
    async def _(_: object) -> None:
        raise LookupError("nobody is there")

    loop.mode = Mode.STOP
    until(lambda: not served.panel.reset.disabled, "it can be pressed")
    client.set(served.panel.reset._impl.uuid, value=True)
    until(lambda: "a control of the page" in loop.troubles.now(), "it is told")
    until(lambda: [event.kind for event in loop.events(0)] == [Kind.PART_BROKEN], "it is an event")
    assert "nobody is there" in str(loop.events(0)[0].values["reason"])


def test_a_page_that_is_not_drawn_still_listens(served: Served, loop: FakeLoop, join: Callable[[], RawClient]) -> None:
    served.stop_drawing()
    client = join()
    client.set(served.panel.stop._impl.uuid, value=True)
    until(lambda: loop.advance() is None and Command.EMERGENCY_STOP in loop.wishes[-1].inputs.commands, "the stop")
