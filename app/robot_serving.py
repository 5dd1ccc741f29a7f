"""Serves a robot on the network until the user stops it: for `pendant robot`, and for `pendant serve --interfaces`."""

import logging
import os
import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import NamedTuple

from app.ending import ending
from app.log.live import LiveRecording
from app.log.recording_plan import ALL, RecordingPlan
from app.robot_interface.interfaces import RobotInterfaces
from app.runs.runner import simulate
from app.runs.warm_up import warm_up
from app.session.session_file import SHIPPED_ALONE, AllowedFiles
from app.session.timeline_checks import Prepared
from app.web.access.listening import access_through
from sim.arm.arm_file import Arm
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
    files: AllowedFiles = SHIPPED_ALONE  # that a set-up of the control channel may name


def get_ready(arm: Arm) -> None:
    """Make ready what is compiled for an arm, and say so where that takes a while."""
    notice = threading.Timer(PATIENCE, lambda: sys.stdout.write(f"{COMPILING}\n"))
    notice.start()
    try:
        warm_up(arm)
    finally:
        notice.cancel()


def open_interfaces(
    loop: Loop, prepared: Prepared, network: Network, recording: LiveRecording, *, token: str | None = None
) -> RobotInterfaces:
    """Open the network interfaces of a loop that has not been started yet.

    Args:
        loop: that runs, or will.
        prepared: what it simulates.
        network: where they are to be.
        recording: the switch of recordings.
        token: of the control channel; None: that of the environment, or a new one.

    Raises:
        BadInput: the address cannot be used, a port is taken, or the arm cannot be told by these protocols.
    """
    interfaces = RobotInterfaces(
        loop,
        prepared.arm,
        host=access_through(network.host).host,
        offset=network.offset,
        programs=network.programs,
        token=token or os.environ.get(TOKEN),
        recording=recording,
        files=network.files,
    )
    interfaces.start()
    return interfaces


@contextmanager
def robot_until_interrupted(
    prepared: Prepared, network: Network, record: Path | None, plan: RecordingPlan = ALL
) -> Iterator[RobotInterfaces]:
    """Serve a robot without a page; the body runs once it answers; then wait for Ctrl-C or SIGTERM, which end all in seconds.

    Args:
        prepared: what to simulate.
        network: where its interfaces are to be.
        record: record from the start, into this folder.
        plan: how often what is recorded, and how long a file of it is.

    Raises:
        BadInput: an address cannot be used, or `record` not be written.
    """
    loop = Loop(lambda: simulate(prepared))
    with ending() as end:
        recording = LiveRecording(loop, record or Path(), plan)
        end.see_to(recording.close)
        interfaces = open_interfaces(loop, prepared, network, recording)
        try:
            loop.start()
            if record is not None:
                recording.start().result()
            yield interfaces
            end.asked.wait()
        finally:
            end_in_turn(lambda: recording.close(FINISHED), interfaces.close, lambda: loop.stop(STOOD))


FINISHED = 1.5
"""Time that files have to be finished [s]."""

STOOD = 0.5
"""Time in which the loop must have ended its tick [s]."""


def end_in_turn(*steps: Callable[[], object]) -> None:
    """End one thing after the other; what fails is logged, and keeps nothing else from its end."""
    for step in steps:
        try:
            step()
        except Exception:
            logging.getLogger(__name__).exception("something did not end as it should")
