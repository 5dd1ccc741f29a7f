"""The app open to a network: the printed link lets in, and nothing else does."""

import http.client
from collections.abc import Iterator

import pytest
from websockets.exceptions import InvalidStatus

from app.web.server import Served, serve
from sim.arm.scenario import Scenario
from tests.app.web.fake_loop import ARM, FakeLoop
from tests.app.web.raw_client import RawClient, until


@pytest.fixture
def network(loop: FakeLoop) -> Iterator[Served]:
    """The web app of `loop`, listening everywhere."""
    app = serve(loop, ARM, Scenario(), host="0.0.0.0")
    yield app
    app.close()


def here(network: Served) -> str:
    """Host and port by which these tests reach it: whatever else this machine has is not theirs."""
    return f"127.0.0.1:{network.server.get_port()}"


def get(network: Served, path: str, **headers: str) -> http.client.HTTPResponse:
    connection = http.client.HTTPConnection(here(network), timeout=5)
    connection.request("GET", path, headers=headers)
    return connection.getresponse()


def cookie(network: Served) -> str:
    """What a browser keeps that has opened the link."""
    answer = get(network, "/" + network.link.rpartition("/")[2])
    assert (answer.status, answer.getheader("Location")) == (303, "/")
    return (answer.getheader("Set-Cookie") or "").partition(";")[0]


def test_who_has_opened_the_link_gets_the_page_and_has_control(network: Served) -> None:
    kept = cookie(network)
    page = get(network, "/", Cookie=kept)
    assert (page.status, page.getheader("X-Content-Type-Options")) == (200, "nosniff")
    client = RawClient(f"http://{here(network)}", origin=f"http://{here(network)}", cookie=kept)
    until(lambda: len(network.server.get_clients()) == 1, "the client is connected")
    client.set(network.lab.force._impl.uuid, value=80.0)
    until(lambda: network.hand.cap == 80.0, "the cap of the hand")
    client.close()
    assert network.guard.refused.total() == 0


@pytest.mark.parametrize(("brought", "reason"), [(None, "no token"), ("x", "wrong token"), ("", "wrong token")])
def test_nobody_else_gets_page_or_connection(network: Served, brought: str | None, reason: str) -> None:
    kept = None if brought is None else f"pendant-{network.server.get_port()}={brought}"
    for path in ("/", "/index.html"):
        answer = get(network, path, **({} if kept is None else {"Cookie": kept}))
        assert (answer.status, answer.read()[:9]) == (401, b"refused: ")
    with pytest.raises(InvalidStatus) as turned_away:
        RawClient(f"http://{here(network)}", cookie=kept)
    assert turned_away.value.response.status_code == 401
    assert network.guard.refused == {reason: 3}
    assert network.server.get_clients() == {}


def test_the_cookie_in_another_page_opens_nothing(network: Served) -> None:
    with pytest.raises(InvalidStatus) as turned_away:
        RawClient(f"http://{here(network)}", origin="https://evil.example", cookie=cookie(network))
    assert turned_away.value.response.status_code == 403
    assert get(network, "/", Host="evil.example", Cookie=cookie(network)).status == 403
    assert network.guard.refused == {"foreign origin": 1, "foreign host": 1}


def test_the_link_holds_the_token_and_the_address_does_not(network: Served) -> None:
    assert network.access.token is not None
    assert network.link == f"{network.url}/?token={network.access.token}"
    assert "token" not in network.url
