"""Serves a robot on the network until the user stops it: for `pendant robot`, and for `pendant serve --interfaces`."""

import os
import signal
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import NamedTuple

from app.log.live import LiveRecording, must_be_writable
from app.robot_interface.interfaces import RobotInterfaces
from app.runs.runner import simulate
from app.runs.warm_up import warm_up
from app.session.timeline_checks import Prepared
from app.web.access.listening import access_through
from sim.run.loop import Loop

PATIENCE = 4.0
"""A start that takes longer is explained [s]: it is the first one after an installation."""

COMPILING = "Compiling what runs in every tick. This first start takes half a minute, later ones a second or two."

TOKEN = "PENDANT_TOKEN"
"""Environment variable with the token of the control channel; without it there is a new one at each start."""


class Network(NamedTuple):
    """Where the robot's network interfaces are to be."""

    host: str = "127.0.0.1"
    offset: int = 0  # added to all ports
    programs: Path | None = None  # folder of programs that clients can load


def until_stopped() -> threading.Event:
    """Make ready what is compiled. Returns what is set when the user stops the program, politely or by Ctrl-C."""
    ended = threading.Event()
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, lambda *_: ended.set())
    notice = threading.Timer(PATIENCE, lambda: sys.stdout.write(f"{COMPILING}\n"))
    notice.start()
    try:
        warm_up()
    finally:
        notice.cancel()
    return ended


def open_interfaces(loop: Loop, prepared: Prepared, network: Network, recording: LiveRecording) -> RobotInterfaces:
    """Open the network interfaces of a loop that has not been started yet.

    Raises:
        BadInput: the address cannot be used, a port is taken, or the arm cannot be told by these protocols.
    """
    interfaces = RobotInterfaces(
        loop,
        prepared.arm,
        host=access_through(network.host).host,
        offset=network.offset,
        programs=network.programs,
        token=os.environ.get(TOKEN),
        recording=recording,
    )
    interfaces.start()
    return interfaces


@contextmanager
def robot_until_interrupted(
    prepared: Prepared, network: Network, record: Path | None, ended: threading.Event
) -> Iterator[RobotInterfaces]:
    """Serve a robot without a page; the body runs once it answers; then wait until it is ended.

    Args:
        prepared: what to simulate.
        network: where its interfaces are to be.
        record: record from the start, into this folder.
        ended: set when it is to end, as `until_stopped` gives it.

    Raises:
        BadInput: an address cannot be used, or `record` not be written.
    """
    if record is not None:
        must_be_writable(record)
    loop = Loop(lambda: simulate(prepared))
    recording = LiveRecording(loop, record or Path())
    interfaces = open_interfaces(loop, prepared, network, recording)
    try:
        loop.start()
        if record is not None:
            recording.start()
        yield interfaces
        ended.wait()
    finally:
        interfaces.close()
        recording.close()
        loop.stop()
