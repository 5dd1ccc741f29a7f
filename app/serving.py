"""Serves a prepared simulation until the user stops it."""

import signal
import threading
import webbrowser
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import typer

from app.files.checked import BadInput
from app.files.library import mesh_path
from app.log.playback import Player
from app.log.reader import read
from app.log.scan import repair
from app.runs.runner import simulate
from app.runs.warm_up import warm_up
from app.session.prepare import Prepared
from app.web.access.listening import access_through, free_port
from app.web.access.site import Site
from app.web.replay import Replay
from app.web.server import Served
from app.web.server import serve as serve_web
from sim.run.loop import Loop

PATIENCE = 4.0
"""A start that takes longer is explained [s]: it is the first one after an installation."""

COMPILING = "Compiling what runs in every tick. This first start takes half a minute, later ones a second or two."


@contextmanager
def serve_until_interrupted(
    prepared: Prepared, *, host: str, port: int | None, usual: int, open_browser: bool, record: Path | None
) -> Iterator[Site]:
    """Serve; the body runs once the page is up; then wait for Ctrl-C or a polite end of the process.

    Args:
        prepared: what to simulate.
        host: address to listen on.
        port: to listen on, 0 for any free one; None: `usual` when it is free, else any.
        usual: the port that a user's bookmark knows.
        open_browser: open the page too.
        record: record from the start, into this folder.

    Raises:
        BadInput: the address cannot be used.
    """
    ended = threading.Event()
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, lambda *_: ended.set())
    notice = threading.Timer(PATIENCE, lambda: typer.echo(COMPILING))
    notice.start()
    try:
        warm_up()
    finally:
        notice.cancel()
    loop = Loop(lambda: simulate(prepared))
    loop.start()
    try:
        served = _serve(loop, prepared, host=host, port=port, usual=usual, open_browser=open_browser, record=record)
        try:
            yield served
            ended.wait()
        finally:
            served.close()
    finally:
        loop.stop()


@contextmanager
def replay_until_interrupted(path: Path, *, host: str, port: int | None, usual: int, open_browser: bool) -> Iterator[Site]:
    """Show a recording, as `serve_until_interrupted` serves a simulation; a log without its end is repaired first.

    Raises:
        BadInput: the log cannot be read or repaired, or the address cannot be used.
    """
    repair(path)
    player = Player(read(path))
    ended = threading.Event()
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, lambda *_: ended.set())
    access = access_through(host)
    names = ("foot", *player.log.arm.chain.joints)
    meshes = {part: mesh_path(player.log.arm.name, part).read_bytes() for part in names}
    shown = Replay(player, meshes, access, free_port(access.host, port, usual))
    try:
        if open_browser:
            webbrowser.open(shown.link)
        yield shown
        ended.wait()
    finally:
        shown.close()


def _serve(
    loop: Loop, prepared: Prepared, *, host: str, port: int | None, usual: int, open_browser: bool, record: Path | None
) -> Served:
    if port is not None:
        return serve_web(loop, prepared.arm, prepared.scenario, host=host, port=port, open_browser=open_browser, record=record)
    try:
        return serve_web(loop, prepared.arm, prepared.scenario, host=host, port=usual, open_browser=open_browser, record=record)
    except BadInput as taken:
        if taken.field != "--port":
            raise
        return serve_web(loop, prepared.arm, prepared.scenario, host=host, port=0, open_browser=open_browser, record=record)
