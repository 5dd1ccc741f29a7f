"""Other threads hand work to the loop, and learn what became of it, whatever the loop does."""

import threading
import time
from collections.abc import Callable
from concurrent.futures import CancelledError
from contextlib import suppress

import pytest

from pendant.events.event import Event, Kind
from sim.run.beginnings import Beginnings, Origin
from sim.run.between_ticks import BetweenTicks
from sim.run.loop import Loop
from tests.sim.run.test_loop import Ticker, breaking, running, until

__all__ = ["running"]


def test_work_is_done_on_the_loops_thread_while_it_runs_stands_or_has_broken_down(running: Callable[..., Loop]) -> None:
    loop = running(breaking(400))
    names = [loop.between_ticks(lambda: threading.current_thread().name).result(5.0)]
    loop.paused = True
    names.append(loop.between_ticks(lambda: threading.current_thread().name).result(5.0))
    loop.paused = False
    until(lambda: loop.failure != "")
    names.append(loop.between_ticks(lambda: threading.current_thread().name).result(5.0))
    assert names == ["simulation"] * 3


def test_what_work_raises_goes_to_whoever_asked_and_nowhere_else(running: Callable[..., Loop]) -> None:
    loop = running()
    with pytest.raises(ZeroDivisionError):
        loop.between_ticks(lambda: 1 // 0).result(5.0)
    before = loop.simulation.plant.tick
    until(lambda: loop.simulation.plant.tick > before + 5)
    assert loop.failure == ""


def test_nobody_waits_for_a_loop_that_has_ended(running: Callable[..., Loop]) -> None:
    loop = running()
    loop.stop()
    for future in (loop.between_ticks(lambda: None), loop.begin(Ticker), loop.reset()):
        with pytest.raises(CancelledError):
            future.result(5.0)
    waiting = BetweenTicks()
    asked = waiting.ask(lambda: 1)
    waiting.close()
    assert asked.cancelled()
    beginnings = Beginnings()
    begun = beginnings.ask(Origin(Ticker))
    beginnings.close()
    assert begun.cancelled()


def test_work_that_is_taken_back_is_not_done() -> None:
    waiting, done = BetweenTicks(), list[int]()
    assert waiting.ask(lambda: done.append(1)).cancel()
    waiting.ask(lambda: done.append(2))
    waiting.do()
    assert (done, waiting.waiting) == ([2], False)


def test_an_event_that_no_tick_decides_is_logged_and_told(running: Callable[..., Loop]) -> None:
    loop, told = running(), list[Event]()
    loop.log.listen(told.append)
    loop.tell(Kind.PART_BROKEN, {"part": "x", "reason": "y"})
    until(lambda: bool(told))
    assert told == loop.events(0)
    assert told[0].tick > 0
    loop.log.forget(told.append)
    loop.tell(Kind.PART_BROKEN, {"part": "x", "reason": "z"})
    until(lambda: len(loop.events(0)) == 2)
    assert len(told) == 1


def test_whoever_asks_for_a_beginning_learns_how_it_went(running: Callable[..., Loop]) -> None:
    def refuse() -> Ticker:
        raise ValueError("mass matrix is not positive")

    loop = running()
    first = loop.simulation
    loop.begin(Ticker).result(5.0)
    assert loop.simulation is not first
    with pytest.raises(ValueError, match="not positive"):
        loop.begin(refuse).result(5.0)
    until(lambda: loop.failure != "")
    loop.reset().result(5.0)
    assert loop.failure == ""


def test_the_newest_wish_counts_and_none_is_lost(running: Callable[..., Loop]) -> None:
    """A start that was asked for while the loop took the one before was forgotten, and who waited for it waited for ever."""
    loop = running()
    asked = [loop.begin(Ticker) for _ in range(50)]
    deadline = time.monotonic() + 10.0
    while not all(each.done() for each in asked):
        assert time.monotonic() < deadline
        time.sleep(0.001)
    assert not asked[-1].cancelled()
    assert all(each.cancelled() or each.exception() is None for each in asked)


def test_many_threads_that_begin_at_once_all_get_an_answer(running: Callable[..., Loop]) -> None:
    loop, over = running(), list[bool]()

    def ask() -> None:
        for _ in range(20):
            begun = loop.begin(Ticker)
            with suppress(CancelledError):
                begun.result(10.0)
            over.append(begun.done())

    threads = [threading.Thread(target=ask) for _ in range(4)]
    for each in threads:
        each.start()
    for each in threads:
        each.join(20.0)
    assert over == [True] * 80


def test_a_start_that_is_taken_back_does_not_begin(running: Callable[..., Loop]) -> None:
    beginnings = Beginnings()
    assert beginnings.ask(Origin(Ticker)).cancel()
    assert not beginnings.begin(lambda origin: pytest.fail("it begins"))
