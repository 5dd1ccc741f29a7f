"""Serves a prepared simulation until the user stops it."""

import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager

from app.checked import BadInput
from app.prepare import Prepared
from app.runner import simulate
from app.web.server import Served
from app.web.server import serve as serve_web
from sim.loop import Loop


@contextmanager
def serve_until_interrupted(prepared: Prepared, host: str, port: int | None, usual: int, open_browser: bool) -> Iterator[str]:
    """Serve; the body runs once the page is up and gets its address; then wait for Ctrl-C or a polite end of the process.

    Args:
        prepared: what to simulate.
        host: address to listen on.
        port: to listen on, 0 for any free one; None: `usual` when it is free, else any.
        usual: the port that a user's bookmark knows.
        open_browser: open the page too.

    Raises:
        BadInput: the address cannot be used.
    """
    ended = threading.Event()
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, lambda *_: ended.set())
    loop = Loop(lambda: simulate(prepared))
    loop.start()
    try:
        served = _serve(loop, prepared, host, port, usual, open_browser)
        try:
            yield served.url
            ended.wait()
        finally:
            served.close()
    finally:
        loop.stop()


def _serve(loop: Loop, prepared: Prepared, host: str, port: int | None, usual: int, open_browser: bool) -> Served:
    if port is not None:
        return serve_web(loop, prepared.arm, prepared.scenario, host, port, open_browser)
    try:
        return serve_web(loop, prepared.arm, prepared.scenario, host, usual, open_browser)
    except BadInput as taken:
        if taken.field != "--port":
            raise
        return serve_web(loop, prepared.arm, prepared.scenario, host, 0, open_browser)
