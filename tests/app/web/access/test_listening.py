"""Where `--host` leads, and what it asks of those who come."""

import socket

import pytest

from app.files.bad_input import BadInput
from app.web.access.listening import LOOPBACK, Access, access_through, reachable


@pytest.mark.parametrize(
    ("host", "bare"),
    [("127.0.0.1", "127.0.0.1"), ("localhost", "localhost"), ("[::1]", "::1"), ("::1", "::1"), ("127.0.0.5", "127.0.0.5")],
)
def test_this_machine_alone_needs_no_token(host: str, bare: str) -> None:
    access = access_through(host)
    assert (access.host, access.token, access.names) == (bare, None, frozenset(LOOPBACK))


def test_a_network_needs_a_token_that_is_new_each_time() -> None:
    first, second = access_through("0.0.0.0"), access_through("0.0.0.0")
    assert first.token is not None
    assert len(first.token) >= 32
    assert first.token != second.token
    assert first.token not in repr(first)
    assert socket.gethostname().lower() in first.names


@pytest.mark.parametrize("host", ["example.invalid", "203.0.113.7", "0.0.0.0.0", "", "a b", "é" * 70, "1::2::3"])
def test_what_is_no_address_of_this_machine_is_refused_in_one_line(host: str) -> None:
    with pytest.raises(BadInput) as refused:
        access_through(host)
    assert str(refused.value).startswith("serve: --host = ")
    assert "\n" not in str(refused.value)


def test_the_link_has_the_token_and_the_address_has_not() -> None:
    assert Access().link(8080) == Access().address(8080) == "http://127.0.0.1:8080"
    assert Access("::1").address(1) == "http://[::1]:1"
    assert Access("10.0.0.7", "secret").link(9000) == "http://10.0.0.7:9000/?token=secret"
    assert Access("10.0.0.7", "secret").address(9000) == "http://10.0.0.7:9000"


def test_listening_everywhere_the_link_names_an_address_that_others_can_reach() -> None:
    host = Access("0.0.0.0", "secret").link(9000).removeprefix("http://").partition(":")[0]
    assert host == reachable()
    assert host != "0.0.0.0"
