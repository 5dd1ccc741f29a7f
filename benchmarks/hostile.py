"""Whether anybody at the network can slow the robot down: ticks a second while it is attacked, against ticks before and after.

The attackers have a process of their own, but the machine's processors are shared with them.
"""

import contextlib
import multiprocessing
import socket
import statistics
import time
from collections.abc import Callable
from multiprocessing.connection import Connection
from typing import TYPE_CHECKING

import msgspec
from websockets import Origin
from websockets.exceptions import ConnectionClosed, InvalidHandshake
from websockets.sync.client import ClientConnection, connect

from benchmarks.common import Report, main
from benchmarks.viewer import CAMERA, VERSION

if TYPE_CHECKING:  # an attacker starts without them
    from app.web.server import Served
    from sim.run.loop import Loop

SETTLE, STRETCH = 1.0, 0.5  # [s]
FEWEST = 0.99  # ticks a second while it is attacked, of those in peace
Attack = Callable[[str, str, float], int]


def join(url: str, **options: object) -> ClientConnection:
    """A connection that has said where its camera is."""
    made = connect(url.replace("http", "ws", 1), subprotocols=[VERSION], max_size=None, proxy=None, **options)  # type: ignore[arg-type]
    made.send(msgspec.msgpack.encode(CAMERA))
    return made


def sliders(url: str, slider: str, end: float) -> int:
    """Eight clients move one slider as fast as they are read; it is only the first one's to move."""
    message = msgspec.msgpack.encode({"type": "GuiUpdateMessage", "uuid": slider, "updates": {"value": 50.0}})
    count = 0
    with contextlib.ExitStack() as stack:
        sockets = [stack.enter_context(join(url)) for _ in range(8)]
        for each in sockets:
            each.socket.setblocking(False)
        while time.monotonic() < end:
            for each in sockets:
                with contextlib.suppress(BlockingIOError, TimeoutError, ConnectionClosed):
                    each.send(message)
                    count += 1
    return count


def oversized(url: str, _: str, end: float) -> int:
    """Messages of a megabyte, each of which ends its connection."""
    count = 0
    while time.monotonic() < end:
        with contextlib.suppress(ConnectionClosed, InvalidHandshake, OSError), join(url) as made:
            made.send(b"\x00" * 1_000_000)
            count += 1
    return count


def strangers(url: str, _: str, end: float) -> int:
    """Connections of another page, one after the other."""
    count = 0
    while time.monotonic() < end:
        with contextlib.suppress(InvalidHandshake, OSError), join(url, origin=Origin("https://evil.example")):
            pass
        count += 1
    return count


def connections(url: str, _: str, end: float) -> int:
    """Two hundred connections at once that say half a request, again and again."""
    host, port = url.removeprefix("http://").split(":")
    count = 0
    while time.monotonic() < end:
        with contextlib.ExitStack() as stack:
            for _number in range(200):
                made = stack.enter_context(socket.create_connection((host, int(port))))
                made.sendall(b"GET / HTTP/1.1\r\nHost: ")
                count += 1
            time.sleep(0.5)
    return count


def pages(url: str, _: str, end: float) -> int:
    """The page, as fast as it comes."""
    host, port = url.removeprefix("http://").split(":")
    count = 0
    while time.monotonic() < end:
        with socket.create_connection((host, int(port))) as made:
            made.sendall(f"GET / HTTP/1.1\r\nHost: {host}:{port}\r\nAccept-Encoding: gzip\r\n\r\n".encode())
            while made.recv(1 << 16):
                pass
            count += 1
    return count


ATTACKS: tuple[Attack, ...] = (sliders, oversized, strangers, connections, pages)


def attack(kind: int, url: str, *, slider: str, seconds: float, back: Connection) -> None:
    """In a process of its own: say when it begins, do it for so long, and tell how often."""
    back.send(kind)
    back.send(ATTACKS[kind](url, slider, time.monotonic() + seconds))


def rate(loop: "Loop", seconds: float) -> float:
    """Ticks a second: the median of short stretches, so that one stall by something else on the machine does not count."""
    rates = []
    for _ in range(round(seconds / STRETCH)):
        first, start = loop.simulation.tick_count, time.monotonic()
        time.sleep(STRETCH)
        rates.append((loop.simulation.tick_count - first) / (time.monotonic() - start))
    return statistics.median(rates)


def suffer(report: Report, loop: "Loop", served: "Served", seconds: float) -> None:
    """Every attack, with peace before and after it."""
    process = multiprocessing.get_context("spawn")
    slider = served.lab.force._impl.uuid
    before = rate(loop, seconds)
    for kind, name in enumerate(ATTACKS):
        here, there = process.Pipe()
        attacker = process.Process(target=attack, args=(kind, served.url, slider, seconds + 2.0 * SETTLE, there))
        attacker.start()
        here.recv()
        time.sleep(SETTLE)
        dropped = loop.dropped
        during = rate(loop, seconds)
        dropped = loop.dropped - dropped
        count = here.recv()
        attacker.join()
        time.sleep(2.0 * SETTLE)
        after = rate(loop, seconds)
        report.row(f"{name.__name__}: rate, of that in peace", during / max(before, after), at_least=FEWEST)
        report.row(f"{name.__name__}: done", count)
        report.row(f"{name.__name__}: time lost by stalls", dropped, "s")
        before = after
    report.row("rate in peace", before, "1/s")
    report.row("clients left", len(served.server.get_clients()), at_most=0)
    report.notes.append(f"refused: {dict(served.guard.refused)}")


def measure(report: Report) -> None:
    """Serve an arm, and let it be attacked."""
    from app.files.library import load_arm
    from app.web.server import serve
    from pendant.all_settings import Settings
    from sim.arm.scenario import Scenario
    from sim.run.loop import Loop
    from sim.simulation import Simulation

    arm = load_arm("ur5e")
    loop = Loop(lambda: Simulation(arm, Scenario(seed=report.options.seed), Settings()))
    loop.start()
    served = serve(loop, arm, loop.scenario)
    try:
        suffer(report, loop, served, 20.0 if report.options.full else 3.0)
    finally:
        served.close()
        loop.stop()


if __name__ == "__main__":
    main("hostile", measure)
