"""Whether anybody at the network can slow the robot down: ticks a second while it is attacked, against ticks before and after.

The attackers have a process of their own, but the machine's processors are shared with them.
"""

import contextlib
import math
import multiprocessing
import socket
import statistics
import threading
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
from pendant.inputs import Button
from pendant.tick.modes import Mode
from sim.plant.touch import Pull

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
        more = {"slider": slider, "seconds": seconds + 2.0 * SETTLE, "back": there}
        attacker = process.Process(target=attack, args=(kind, served.url), kwargs=more)
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


def hostile_files() -> list[bytes]:
    """Files for the page in which every value fits its type, or nearly: what no arm could carry, too much, too deep, not text."""
    tool = {"name": "x", "mass": 1.0, "com": [0.0, 0.0, 0.1], "tcp": [0.0, 0.0, 0.1]}
    point = {"name": "P1", "q": [0.0] * 6, "position": [0.3, 0.0, 0.4], "quaternion": [1.0, 0.0, 0.0, 0.0]}
    odd: list[object] = [
        {"tools": [{**tool, key: value}]} for key in ("length", "radius", "mass") for value in (1e9, 1e300, 1.7e308)
    ]
    odd += [{"tools": [{**tool, "inertia": [value] * 3 + [0.0] * 3}]} for value in (1e300, 1e3, 1e-30)]
    odd += [{"tools": [{**tool, "mass": 1e-9, "inertia": [1e3] * 3 + [0.0] * 3}]}, {"tools": [tool] * 51}]
    odd += [{"waypoints": [{**point, "q": [value] * 6}]} for value in (1e300, 1e9)]
    odd += [{"waypoints": [{**point, "quaternion": [0.0] * 4}]}, {"waypoints": [{**point, "position": [1e300] * 3}]}]
    return [msgspec.json.encode(each) for each in odd] + [b"\xff" * 1000, b"[" * 5000, b"- 1\n" * 15_000, b"a: &a [*a]"]


def uploads(report: Report, loop: "Loop", served: "Served") -> None:
    """Two hundred hostile files, while a hand leads the arm on a circle: each is answered, and no tick is lost."""
    files, desk = hostile_files(), loop.desk
    x, y, z = (float(value) for value in loop.latest().truth_links[-1][:3])
    desk.hold(Button.FREE_DRIVE)
    guided = threading.Event()

    def lead() -> None:
        begun = time.monotonic()
        while not guided.is_set():
            desk.hold(Button.FREE_DRIVE)
            at = time.monotonic() - begun - 3.0
            if at > 0.0:
                turn = 2.0 * math.pi * at / 5.0
                place = (x, y + 0.06 * math.sin(turn), z + 0.06 * (1.0 - math.cos(turn)))
                desk.touch("hand", Pull("flange", (0.0, 0.0, 0.0), place, 50.0))
            time.sleep(0.02)

    hand = threading.Thread(target=lead)
    hand.start()
    time.sleep(5.0)
    free = loop.latest().decision.mode is Mode.FREE_DRIVE
    dropped, answered = loop.dropped, 0
    editor, teach = served.docks.tools.editor, served.docks.teach
    with join(served.url) as client:
        while not served.server.get_clients():
            time.sleep(0.005)
        for number in range(200):
            name, content = f"file-{number}.yaml", files[number % len(files)]
            where, said = (teach.load, teach.filed) if number % 2 else (editor.load, editor.message)
            if not number % 2:  # disabled while the arm is free: handed over as if it were not
                served.server.get_event_loop().call_soon_threadsafe(editor.read, name, content)
            else:
                start = {"source_component_uuid": where._impl.uuid, "transfer_uuid": f"t{number}"}
                whole = {"filename": name, "mime_type": "text/yaml", "part_count": 1, "size_bytes": len(content)}
                client.send(msgspec.msgpack.encode({"type": "FileTransferStartUpload", **start, **whole}))
                client.send(msgspec.msgpack.encode({"type": "FileTransferPart", **start, "part_index": 0, "content": content}))
            end = time.monotonic() + 5.0
            while name not in said.shown and time.monotonic() < end:
                time.sleep(0.005)
            answered += name in said.shown
    free = free and loop.latest().decision.mode is Mode.FREE_DRIVE
    dropped = loop.dropped - dropped
    guided.set()
    hand.join()
    desk.let_go("hand")
    desk.release(Button.FREE_DRIVE)
    report.row("uploads: the arm is guided all the time", float(free), at_least=1.0)
    report.share("uploads: answered on the page", answered, 200, at_least=1.0)
    report.row("uploads: time lost by stalls", dropped, "s", at_most=0.0)


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
        uploads(report, loop, served)
        suffer(report, loop, served, 20.0 if report.options.full else 3.0)
    finally:
        served.close()
        loop.stop()


if __name__ == "__main__":
    main("hostile", measure)
