"""Who is connected, and what was said."""

import socket

import pytest

from app.robot_interface.transport.outbox import Outbox
from app.robot_interface.transport.peers import KEPT, LONGEST, Peers, line


def test_who_comes_and_goes_is_listed_in_order_and_noted() -> None:
    peers = Peers()
    box = Outbox(socket.socket())
    first, second = peers.join("RTDE", "a:1", box), peers.join("dashboard", "b:2", box)
    assert [peer.number for peer in peers.all()] == [1, 2]
    assert (peers.count("RTDE"), peers.count("dashboard"), peers.count("primary")) == (1, 1, 0)
    peers.leave(first, "it left")
    peers.leave(first, "again")
    assert peers.all() == [second]
    assert [(said.interface, said.peer, said.text) for said in peers.said()] == [
        ("RTDE", 1, "connected from a:1"),
        ("dashboard", 2, "connected from b:2"),
        ("RTDE", 1, "disconnected: it left"),
    ]


def test_messages_are_told_once_and_old_ones_are_forgotten() -> None:
    peers = Peers()
    for i in range(KEPT + 5):
        peers.note("RTDE", 0, f"message {i}")
    said = peers.said()
    assert len(said) == KEPT
    assert (said[0].text, said[-1].number) == ("message 5", KEPT + 5)
    assert peers.said(said[-2].number) == said[-1:]
    assert peers.said(said[-1].number) == []


@pytest.mark.parametrize(
    ("text", "shown"),
    [("a\r\nb\tc", "a b c"), ("\x1b[31mred", "?[31mred"), ("x" * LONGEST, "x" * LONGEST), ("x" * 300, "x" * 197 + "...")],
)
def test_what_anybody_says_is_shown_as_one_short_printable_line(text: str, shown: str) -> None:
    assert line(text) == shown
    assert len(line(text)) <= LONGEST
