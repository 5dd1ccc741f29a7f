"""Sending never waits, and whoever does not read is dropped."""

import socket
from collections.abc import Iterator

import pytest

from app.robot_interface.transport import outbox as module
from app.robot_interface.transport.outbox import MOST, Outbox

Pair = tuple[socket.socket, socket.socket]


@pytest.fixture
def pair() -> Iterator[Pair]:
    ours, theirs = socket.socketpair()
    ours.setsockopt(socket.SOL_SOCKET, socket.SO_SNDBUF, 4096)
    theirs.setblocking(False)
    yield ours, theirs
    ours.close()
    theirs.close()


def read(theirs: socket.socket) -> bytes:
    data = b""
    while True:
        try:
            part = theirs.recv(1 << 16)
        except BlockingIOError:
            return data
        if not part:
            return data
        data += part


def test_what_is_sent_arrives_in_order_however_slowly_it_is_read(pair: Pair) -> None:
    box = Outbox(pair[0])
    wanted = b"".join(bytes([i % 251]) * 1000 for i in range(200))
    for i in range(200):
        box.send(wanted[i * 1000 : (i + 1) * 1000])
    got = b""
    while box.full:
        got += read(pair[1])
        box.flush()
    got += read(pair[1])
    assert got == wanted
    assert box.sent == len(wanted)
    assert not box.dead


def test_a_late_reader_misses_packages_and_never_gets_half_of_one(pair: Pair) -> None:
    box = Outbox(pair[0])
    taken = [box.offer(bytes([i]) * 1000) for i in range(100)]
    assert taken[0]
    assert not all(taken)
    assert box.skipped == taken.count(False)
    got = b""
    while box.full:
        got += read(pair[1])
        box.flush()
    got += read(pair[1])
    assert [got[i : i + 1000] for i in range(0, len(got), 1000)] == [bytes([i]) * 1000 for i in range(100) if taken[i]]
    assert box.offer(b"new")


def test_who_lets_too_much_wait_is_given_up(pair: Pair) -> None:
    box = Outbox(pair[0])
    for _ in range(MOST // 100_000 + 2):
        assert not box.dead or box.dead == "it does not read"
        box.send(bytes(100_000))
    assert box.dead == "it does not read"
    assert len(box._waiting) <= MOST
    assert not box.offer(b"more")


def test_with_patience_who_only_sends_is_kept_and_memory_is_bounded(pair: Pair, monkeypatch: pytest.MonkeyPatch) -> None:
    now = 100.0
    monkeypatch.setattr(module.time, "monotonic", lambda: now)
    box = Outbox(pair[0])
    box.patient = True
    for _ in range(3 * MOST // 100_000):
        now += module.PATIENCE
        box.send(bytes(100_000))
        box.flush()
    assert not box.dead
    assert len(box._waiting) <= MOST
    assert box.skipped > 10


def test_who_does_not_read_for_long_is_given_up(pair: Pair, monkeypatch: pytest.MonkeyPatch) -> None:
    now = 100.0
    monkeypatch.setattr(module.time, "monotonic", lambda: now)
    box = Outbox(pair[0])
    while box.offer(bytes(1000)):
        pass
    now += module.PATIENCE
    box.flush()
    assert not box.dead
    now += 0.001
    box.flush()
    assert box.dead == "it does not read"


def test_a_reader_that_gets_on_is_not_given_up(pair: Pair, monkeypatch: pytest.MonkeyPatch) -> None:
    now = 100.0
    monkeypatch.setattr(module.time, "monotonic", lambda: now)
    box = Outbox(pair[0])
    box.send(bytes(100_000))
    for _ in range(5):
        now += module.PATIENCE * 0.9
        assert read(pair[1])
        box.flush()
        assert not box.dead


def test_a_broken_connection_is_no_exception(pair: Pair) -> None:
    box = Outbox(pair[0])
    pair[1].close()
    box.send(b"x")
    box.send(b"x")
    box.offer(b"x")
    box.flush()
    assert box.dead == "the connection is broken"
