"""The page and its headers, as the server sends them."""

import http.client

import pytest

from app.files.bad_input import BadInput
from app.web.server import Served, serve
from sim.arm.scenario import Scenario
from tests.app.web.fake_loop import ARM, FakeLoop


def get(served: Served, path: str, **headers: str) -> http.client.HTTPResponse:
    connection = http.client.HTTPConnection(served.url.removeprefix("http://"), timeout=5)
    connection.request("GET", path, headers=headers)
    return connection.getresponse()


@pytest.mark.parametrize("encoding", ["identity", "gzip"])
def test_the_page_is_ours_and_talks_to_its_own_server_only(served: Served, encoding: str) -> None:
    answer = get(served, "/?websocket=ws://evil.example", **{"Accept-Encoding": encoding})
    assert answer.status == 200
    assert answer.getheader("X-Content-Type-Options") == "nosniff"
    policy = dict(part.strip().split(" ", 1) for part in (answer.getheader("Content-Security-Policy") or "").split(";"))
    here = served.url.removeprefix("http://")
    assert policy["connect-src"].split() == ["'self'", f"ws://{here}", f"wss://{here}", "data:", "blob:"]
    assert policy["frame-ancestors"] == "'none'"
    body = answer.read()
    assert len(body) == int(answer.getheader("Content-Length") or 0)
    if encoding == "identity":
        assert b"<title>pendant</title>" in body
        assert b"<title>Viser</title>" not in body
        assert body.index(b'id="pd-opening"') < body.index(b"<script data-p=")  # a picture of the arm, before the client is read


@pytest.mark.parametrize("path", ["/../guard.py", "/%2e%2e/%2e%2e/__init__.py", "/nothing"])
def test_nothing_else_is_served(served: Served, path: str) -> None:
    assert get(served, path).status == 404


def test_a_foreign_host_gets_no_page(served: Served) -> None:
    answer = get(served, "/", Host="evil.example")
    assert (answer.status, answer.read()) == (403, b"refused: foreign host\n")


@pytest.mark.parametrize("host", ["203.0.113.7", "example.invalid"])
def test_an_address_of_another_machine_is_refused_in_one_line(loop: FakeLoop, host: str) -> None:
    with pytest.raises(BadInput) as refused:
        serve(loop, ARM, Scenario(), host=host)
    assert str(refused.value).startswith("serve: --host = ")
    assert "\n" not in str(refused.value)


def test_a_taken_port_is_refused_and_no_other_taken(served: Served, loop: FakeLoop) -> None:
    port = served.server.get_port()
    with pytest.raises(BadInput, match=f"--port = {port}"):
        serve(loop, ARM, Scenario(), port=port)
