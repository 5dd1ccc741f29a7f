"""Spreads work over the workers of a Dask cluster: each piece once, results as they come, even if workers die."""

import math
import time
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import CancelledError
from itertools import chain, islice
from typing import Any, TypeVar

from app.engine.dask_client import ANSWER, PATIENCE, compare, connect, cores, crippled, dashboard, end_embedded
from app.engine.source import identity
from app.files.bad_input import ABSENT, BadInput
from app.files.extras import there

T = TypeVar("T")
R = TypeVar("R")

AHEAD = 3
"""Pieces given to each worker: one in work, and some that wait there, so that the worker never waits for the next piece."""

LOOK = 3.0
"""Time between two checks of the processes of this machine [s]."""

PAUSE = 0.005
"""Time between two looks for results [s]. A result that is still on its worker is lost if the worker dies."""

LIVES = 1
"""How often a piece is given out again, with nothing else running, after all workers that tried it died."""


class Lost(Exception):
    """A piece of work whose workers died each time."""


class Away(Exception):
    """A result that is late, or was lost because its worker or scheduler died before the result was fetched."""


def spread(
    work: Callable[[T], R],
    items: Iterable[T],
    *,
    workers: int | None = None,
    scheduler: str | None = None,
    lost: Callable[[T], R] | None = None,
    told: Callable[[str], None] = lambda line: None,
) -> Iterator[tuple[int, R]]:
    """Do `work` on all items; gives the place of each item with its result, in the order in which they end.

    This process itself does the work if there is a single item, if `workers` is 1, or if Dask is not installed. `items` may be a
    generator: it is read as far as needed.

    Args:
        work: a function that a worker can import, or a function of the main module.
        items: items to work on.
        workers: number of processes of this machine; None: one for each core.
        scheduler: address of a Dask scheduler that is used in place of processes of this machine.
        lost: gives the result of an item whose workers died each time; None: such an item is an error.
        told: is given lines for the user: what happens on the way, and where the dashboard is.

    Raises:
        BadInput: a worker runs another source; a scheduler does not come back; or `work` raises it.
    """
    items = iter(items)
    first = list(islice(items, 2))
    if scheduler is None and (len(first) < 2 or workers == 1 or not there("distributed")):
        for place, item in enumerate(chain(first, items)):
            yield place, work(item)
        return
    spreading = _Spreading(work, workers or cores(), scheduler, told)
    try:
        yield from spreading.run(enumerate(chain(first, items)), lost)
    finally:
        spreading.close()


def guarded(ours: dict[str, str], work: Callable[[T], R], item: T) -> R:
    """On a worker: do `work` if the worker runs the sender's source. A worker that joined later was not checked before."""
    try:
        compare(ours, "the study")
    except BadInput as error:
        raise BadInput("a worker", error.field, identity().get(error.field, ABSENT), f"expected {error.value}") from None
    return work(item)


class _Spreading:
    def __init__(self, work: Callable[[Any], Any], workers: int, scheduler: str | None, told: Callable[[str], None]) -> None:
        self._work, self._workers, self._scheduler, self._told = work, workers, scheduler, told
        self._client = connect(workers, scheduler)
        self._ours = identity()
        self._count, self._counted_at = workers, -math.inf
        self._looked_at = time.monotonic()
        self._said_dashboard()

    def run(self, items: Iterator[tuple[int, T]], lost: Callable[[T], R] | None) -> Iterator[tuple[int, R]]:
        under_way: dict[int, T] = {}
        lives: dict[int, int] = {}
        suspects: list[int] = []  # places of pieces whose workers died
        self._begin(under_way)
        while True:
            self._fill(items, under_way)
            if not under_way:
                return
            if not self._places:
                self._give(suspects[0], under_way[suspects.pop(0)])
            future = self._next()
            place = -1 if future is None else self._places.pop(future)
            if future is None or future.status in ("cancelled", "lost"):  # with the scheduler
                self._reconnect()
                self._begin({place: item for place, item in under_way.items() if place not in suspects})
                continue
            try:
                result = self._result(future, under_way[place], lost, lives.setdefault(place, LIVES))
            except Away:
                # Dask does the piece again, or calls its future cancelled or lost.
                self._places[future] = place
                self._ready.add(future)
                time.sleep(PAUSE)
                continue
            except Lost:
                # This piece, or another on the same worker, kills workers. It is tried again when nothing else is under way.
                lives[place] -= 1
                suspects.append(place)
                continue
            del under_way[place]
            lives.pop(place)
            yield place, result

    def _next(self) -> Any:
        """The next future that has ended; None: processes of this machine ended for good."""
        while True:
            if self._scheduler is None and time.monotonic() > self._looked_at + LOOK:
                self._looked_at = time.monotonic()
                if crippled(self._workers):
                    return None
            if self._ready.has_ready():
                return next(self._ready)
            time.sleep(PAUSE)

    def _begin(self, under_way: dict[int, Any]) -> None:
        from distributed import as_completed

        self._places: dict[Any, int] = {}
        self._ready = as_completed(loop=self._client.loop)
        for place, item in under_way.items():
            self._give(place, item)

    def _give(self, place: int, item: object) -> None:
        future = self._client.submit(guarded, self._ours, self._work, item, pure=False)
        self._places[future] = place
        self._ready.add(future)

    def _fill(self, items: Iterator[tuple[int, Any]], under_way: dict[int, Any]) -> None:
        room = AHEAD * self._threads() - len(under_way)
        for place, item in islice(items, max(0, room)):
            under_way[place] = item
            self._give(place, item)

    def _result(self, future: Any, item: T, lost: Callable[[T], R] | None, lives: int) -> R:
        from distributed import KilledWorker

        try:
            return future.result(timeout=ANSWER)  # the result is small; meanwhile nobody watches the processes
        except KilledWorker:
            if lives > 0:
                raise Lost from None
            if lost is None:
                raise BadInput("workers", "", ABSENT, "died each time that they did a piece of the work") from None
            return lost(item)
        except (TimeoutError, CancelledError, OSError):
            if future.status == "error":  # raised by the work itself
                raise
            raise Away from None

    def _threads(self) -> int:
        if self._scheduler is None:
            return self._workers
        now = time.monotonic()
        if now > self._counted_at + 5.0:
            self._counted_at = now
            self._count = max(1, sum(self._client.nthreads().values()))
        return self._count

    def _reconnect(self) -> None:
        """A scheduler that went may come again, at its address, with new workers."""
        if self._scheduler is None:
            self._client.close(timeout=2)
            end_embedded(self._workers)
            self._client = connect(self._workers, None)
            return
        self._told(f"The scheduler {self._scheduler} is gone; waiting for it.")
        self._client.close(timeout=2)
        until = time.monotonic() + PATIENCE
        while True:
            try:
                self._client = connect(self._workers, self._scheduler)
                break
            except BadInput as error:
                if time.monotonic() > until or error.where != "--scheduler":
                    raise
                time.sleep(1.0)
        self._told("It is there again; what was under way begins anew.")

    def _said_dashboard(self) -> None:
        link = dashboard(self._client)
        if link is not None:
            self._told(f"Dask's dashboard: {link}")

    def close(self) -> None:
        self._client.close()
