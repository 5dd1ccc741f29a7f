"""A page is drawn where viser talks to its clients, and nowhere else."""

import logging
import threading
from collections.abc import Callable

import pytest

from app.web.access.listening import HERE
from app.web.access.site import Site
from app.web.server import Served
from pendant.inputs import Command
from tests.app.web.fake_loop import FakeLoop
from tests.app.web.raw_client import RawClient, until


class Sketch(Site):
    """A page that notes who draws it, `most` times; then drawing fails, or ends."""

    def __init__(self, most: int, failure: Exception | None = None) -> None:
        super().__init__(HERE, 0)
        self.painters: list[int | None] = []
        self._most, self._failure = most, failure
        self.start_drawing()

    def draw(self) -> bool:
        self.painters.append(threading.current_thread().ident)
        if len(self.painters) < self._most:
            return True
        if self._failure is not None:
            raise self._failure
        return False


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


def test_a_failure_is_told_at_once_and_again_at_the_end(caplog: pytest.LogCaptureFixture) -> None:
    with caplog.at_level(logging.ERROR):
        site = Sketch(2, ValueError("no such colour"))
        until(lambda: "the page is no longer drawn" in caplog.text, "it is told")
    assert "no such colour" in caplog.text
    with pytest.raises(ValueError, match="no such colour"):
        site.close()


def test_a_page_that_is_not_drawn_still_listens(served: Served, loop: FakeLoop, join: Callable[[], RawClient]) -> None:
    served.stop_drawing()
    client = join()
    client.set(served.panel.stop._impl.uuid, value=True)
    until(lambda: loop.advance() is None and Command.EMERGENCY_STOP in loop.wishes[-1].inputs.commands, "the stop")
