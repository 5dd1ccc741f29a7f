"""Clients of the robot's network interfaces for the network bench, each in a process of its own: readers and attackers.

Times are of `time.perf_counter`, which on one machine all processes share.
"""

import contextlib
import random
import select
import socket
import struct
import time
from multiprocessing.connection import Connection

HOST, OFFSET = "127.0.0.1", 1000
RATE = 500  # ticks a second
RECIPE = (
    "control_step,timestamp,target_q,target_qd,actual_q,actual_qd,actual_current,actual_TCP_pose,actual_TCP_speed,actual_TCP_force,"
    "robot_mode,safety_mode,robot_status_bits,safety_status_bits,joint_temperatures,ft_raw_wrench,payload,runtime_state"
)


def packed(kind: str, payload: bytes = b"") -> bytes:
    """A package of RTDE."""
    return struct.pack(">HB", len(payload) + 3, ord(kind)) + payload


def opened(port: int = 30004) -> socket.socket:
    """A connection to one of the robot's ports."""
    made = socket.create_connection((HOST, port + OFFSET), timeout=10.0)
    made.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
    return made


def streaming() -> socket.socket:
    """A connection to RTDE that has asked for all frames."""
    made = opened()
    asked = (("V", b"\0\2"), ("O", struct.pack(">d", float(RATE)) + RECIPE.encode()), ("S", b""))
    for kind, payload in asked:
        made.sendall(packed(kind, payload))
        head = made.recv(3, socket.MSG_WAITALL)
        made.recv(struct.unpack_from(">H", head)[0] - 3, socket.MSG_WAITALL)
    return made


def read(count: int, seconds: float, back: Connection) -> None:
    """In a process of its own: read `count` streams for so long; gives times and steps of every frame of each."""
    sockets = [streaming() for _ in range(count)]
    data: dict[socket.socket, bytearray] = {each: bytearray() for each in sockets}
    seen: dict[socket.socket, list[tuple[float, int]]] = {each: [] for each in sockets}
    back.send("ready")
    end = time.perf_counter() + seconds
    while (now := time.perf_counter()) < end:
        for each in select.select(sockets, [], [], end - now)[0]:
            data[each] += each.recv(1 << 16)
            at, buffer = time.perf_counter(), data[each]
            while len(buffer) >= 3 and len(buffer) >= (size := struct.unpack_from(">H", buffer)[0]):
                if buffer[2] == ord("U"):
                    seen[each].append((at, struct.unpack_from(">Q", buffer, 4)[0]))
                del buffer[:size]
    back.send([seen[each] for each in sockets])


def damaged(draw: random.Random) -> tuple[int, bytes]:
    """A port, and something that nobody should send to it."""
    kinds = "VvMUOISP" + chr(draw.randrange(256))
    body = draw.randbytes(draw.choice((0, 1, 2, 7, 30, 300)))
    whole = packed(draw.choice(kinds), body)
    text = RECIPE.encode()
    names = packed(draw.choice("OI"), draw.randbytes(draw.choice((0, 8))) + text[: draw.randrange(len(text))])
    numbers = packed("U", bytes([draw.randrange(4)]) + struct.pack(">d", draw.choice((float("nan"), float("inf"), 1e308, -1.0))))
    line = draw.choice((b"load ../../etc/passwd", b"play \xff", b"set payload nan", b"popup " + body, b"power", b"")) + b"\n"
    script = draw.choice((b"def f():\n", b"end\n", b"movej([" + body.hex().encode() + b"])\n", b"set robotmode run now\n"))
    return draw.choice(
        (
            (30004, whole),
            (30004, whole[: draw.randrange(len(whole) + 1)]),
            (30004, struct.pack(">HB", draw.randrange(65536), draw.randrange(256))),
            (30004, names),
            (30004, packed("I", b"input_double_register_24") + numbers),
            (29999, line),
            (29999, body),
            (30001, script),
            (30003, body),
            (30090, b"POST /actions HTTP/1.1\r\nHost: x\r\nContent-Length: " + str(len(body)).encode() + b"\r\n\r\n" + body),
        )
    )


def send_damaged(count: int, seed: int, back: Connection) -> None:
    """In a process of its own: so many damaged packets, on connections that the robot may end."""
    draw, lines = random.Random(seed), dict[int, socket.socket]()
    back.send("ready")
    sent = 0
    while sent < count:
        port, data = damaged(draw)
        try:
            if port not in lines:
                lines[port] = opened(port)
                lines[port].setblocking(False)
            lines[port].send(data)
            sent += 1
            while lines[port].recv(1 << 16):
                pass
            lines.pop(port).close()
        except BlockingIOError:
            continue
        except OSError:
            if port in lines:
                lines.pop(port).close()
    back.send(sent)


def never_reads(seconds: float, back: Connection) -> None:
    """Connections that ask for all frames and read none."""
    held = [streaming() for _ in range(4)]
    back.send("ready")
    time.sleep(seconds)
    back.send(len(held))


def dies(seconds: float, back: Connection) -> None:
    """Connections that ask for all frames and are gone."""
    back.send("ready")
    count, end = 0, time.perf_counter() + seconds
    while time.perf_counter() < end:
        made = streaming()
        made.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0))  # as when a cable is pulled out
        made.close()
        count += 1
    back.send(count)


def floods(seconds: float, back: Connection) -> None:
    """Packages and lines as fast as they are taken, on every port."""
    lines = {port: opened(port) for port in (30004, 29999, 30001, 30003)}
    texts = {30004: packed("v") * 1000, 29999: b"robotmode\n" * 400, 30001: b"# nothing\n" * 400, 30003: b"# nothing\n" * 400}
    back.send("ready")
    count, end = 0, time.perf_counter() + seconds
    for each in lines.values():
        each.setblocking(False)
    while time.perf_counter() < end:
        for port, each in lines.items():
            with contextlib.suppress(BlockingIOError, OSError):
                count += each.send(texts[port])
            with contextlib.suppress(BlockingIOError, OSError):
                each.recv(1 << 20)
        time.sleep(0.0005)
    back.send(count)
