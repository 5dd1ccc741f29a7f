"""Who gets in, request by request."""

from collections import Counter
from typing import Any

import pytest
from websockets.datastructures import Headers
from websockets.http11 import Request, Response

from app.web.access.door import MAX_CLIENTS, Door
from app.web.access.listening import HERE, LOOPBACK, Access

TOKEN = "correct-horse-battery-staple-32-chars"
NETWORK = Access("0.0.0.0", TOKEN, frozenset({*LOOPBACK, "robot.local"}))
PROTOCOL = "viser-v1.1.1"
COOKIE = f"pendant-8080={TOKEN}"


class Connection:
    """As much of a connection as the door looks at."""

    def __init__(self, *local_address: Any) -> None:
        self.local_address = local_address


CONNECTION: Any = Connection("192.168.1.20", 8080)


class Caller:
    """Calls at one door; the file server behind it serves `page` to whatever does not upgrade."""

    def __init__(self, access: Access) -> None:
        self.refused: Counter[str] = Counter()
        self.door = Door(access, PROTOCOL, self.refused)
        self.door.ready = True

    def ask(self, path: str = "/", connection: Any = CONNECTION, **headers: str) -> Response | None:
        lines = Headers({"Host": "192.168.1.20:8080"} if "Host" not in headers else {})
        for name, value in headers.items():
            lines[name.replace("_", "-")] = value
        return self.door.answer(pages, connection, Request(path, lines))

    def join(self, connection: Any = CONNECTION, **headers: str) -> Response | None:
        return self.ask("/", connection=connection, Upgrade="websocket", Sec_WebSocket_Protocol=PROTOCOL, **headers)

    def turned_away(self, answer: Response | None, status: int, reason: str) -> str:
        """See that it was for that reason alone, and that nothing got in; what was said."""
        assert answer is not None
        assert (answer.status_code, dict(self.refused), self.door.inside) == (status, {reason: 1}, set())
        assert "Set-Cookie" not in answer.headers
        return bytes(answer.body).decode()


def pages(_: Any, request: Request) -> Response | None:
    if "Upgrade" in request.headers:
        return None
    return Response(200, "OK", Headers({"Content-Type": "text/html"}), b"page")


@pytest.fixture
def here() -> Caller:
    """The door of this machine alone."""
    return Caller(HERE)


@pytest.fixture
def network() -> Caller:
    """The door to a network."""
    return Caller(NETWORK)


def body(answer: Response | None) -> bytes:
    assert answer is not None
    return bytes(answer.body)


def test_the_link_becomes_a_cookie_with_which_the_page_and_its_connection_come_in(network: Caller) -> None:
    answer = network.ask(f"/?token={TOKEN}")
    assert answer is not None
    assert (answer.status_code, answer.headers["Location"]) == (303, "/")
    given, *attributes = answer.headers["Set-Cookie"].split("; ")
    assert given == COOKIE
    assert sorted(attributes) == ["HttpOnly", "Path=/", "SameSite=Lax"]
    assert (answer.headers["Cache-Control"], answer.headers["Referrer-Policy"]) == ("no-store", "no-referrer")
    assert body(network.ask(Cookie=f"other=1; {given}")) == b"page"
    assert network.join(Cookie=given) is None
    assert network.door.inside == {CONNECTION}
    assert network.refused.total() == 0


@pytest.mark.parametrize(
    "path", ["/", "/index.html", "/assets/index.js", "/?websocket=ws://evil.example", "/?token=", "//[x", "?", "*"]
)
def test_without_a_token_there_is_no_page_and_no_file(network: Caller, path: str) -> None:
    said = network.turned_away(network.ask(path), 401, "no token")
    assert said == "refused: no token: open the link that pendant has printed in its terminal\n"


def test_without_a_token_there_is_no_connection(network: Caller) -> None:
    network.turned_away(network.join(), 401, "no token")


@pytest.mark.parametrize("token", ["x", TOKEN[:-1], TOKEN + "x", TOKEN.upper(), "%C3%A9", "%00", "\udce9"])
def test_a_wrong_token_opens_nothing(network: Caller, token: str) -> None:
    said = network.turned_away(network.ask(f"/?token={token}"), 401, "wrong token")
    assert TOKEN not in said


@pytest.mark.parametrize(
    ("cookie", "reason"),
    [
        ("pendant-8080=x", "wrong token"),
        (f"pendant-8080={TOKEN}x", "wrong token"),
        (f"pendant-8081={TOKEN}", "no token"),  # of another app on this machine
        (f"token={TOKEN}", "no token"),
        ("pendant-8080=", "wrong token"),
        (";;=,", "no token"),
    ],
)
def test_a_wrong_cookie_opens_nothing(network: Caller, cookie: str, reason: str) -> None:
    network.turned_away(network.join(Cookie=cookie), 401, reason)


def test_the_token_in_the_query_opens_no_connection_by_itself(network: Caller) -> None:
    answer = network.ask(f"/?token={TOKEN}", Upgrade="websocket", Sec_WebSocket_Protocol=PROTOCOL)
    assert answer is not None
    assert answer.status_code == 303
    assert network.door.inside == set()


def test_a_cookie_does_not_make_up_for_a_foreign_origin(network: Caller) -> None:
    network.turned_away(network.join(Cookie=COOKIE, Origin="http://evil.example"), 403, "foreign origin")


@pytest.mark.parametrize("origin", ["http://192.168.1.20:8080", "https://192.168.1.20:8080"])
def test_our_own_origin_is_let_in(network: Caller, origin: str) -> None:
    assert network.join(Cookie=COOKIE, Origin=origin) is None


@pytest.mark.parametrize(
    "origin", ["null", "http://192.168.1.20", "http://192.168.1.20:9", "http://192.168.1.20:8080.evil.example"]
)
def test_a_foreign_origin_is_refused(here: Caller, origin: str) -> None:
    here.turned_away(here.join(Origin=origin), 403, "foreign origin")


@pytest.mark.parametrize("host", ["robot.local", "ROBOT.local:8080", "192.168.1.20", "192.168.1.20:8080", "localhost:1"])
def test_the_names_of_this_machine_are_ours(network: Caller, host: str) -> None:
    assert network.join(Host=host, Cookie=COOKIE) is None


@pytest.mark.parametrize("local", [("fe80::1%eth0", 8080, 0, 2), ("fe80::1", 8080, 0, 0)])
def test_an_address_of_six_is_ours_however_it_is_written(network: Caller, local: tuple[Any, ...]) -> None:
    assert network.join(Connection(*local), Host="[FE80:0::1]:8080", Cookie=COOKIE) is None


@pytest.mark.parametrize(
    "host",
    [
        "",
        "evil.example",
        "192.168.1.21",  # another machine
        "192.168.1.20.evil.example",
        "robot.local.evil.example",
        "localhost:80; script-src *",
        "localhost, evil.example",
        "user@localhost",
        "[localhost]",
        "localhost:",
        "localhost:123456",
    ],
)
@pytest.mark.parametrize("access", [HERE, NETWORK])
def test_a_foreign_host_is_refused(access: Access, host: str) -> None:
    caller = Caller(access)
    caller.turned_away(caller.join(Host=host, Cookie=COOKIE), 403, "foreign host")


@pytest.mark.parametrize("hosts", [[], ["localhost", "localhost"], ["localhost", "evil.example"]])
def test_none_or_two_hosts_are_refused(here: Caller, hosts: list[str]) -> None:
    lines = Headers([("Host", host) for host in hosts])
    here.turned_away(here.door.answer(pages, CONNECTION, Request("/", lines)), 403, "foreign host")


def test_on_this_machine_no_token_is_asked_for(here: Caller) -> None:
    assert body(here.ask(Host="localhost:8080")) == b"page"
    assert body(here.ask("/?token=x", Host="localhost:8080")) == b"page"
    assert here.join(Host="localhost:8080") is None


def test_beyond_sixteen_neither_page_nor_connection_and_the_page_asks_again(here: Caller) -> None:
    for _ in range(MAX_CLIENTS):
        assert here.join(Connection("127.0.0.1", 1), Host="localhost") is None
    assert MAX_CLIENTS == 16
    for answer in (here.join(), here.ask("/")):
        assert answer is not None
        assert (answer.status_code, bytes(answer.body)) == (503, b"refused: at most 16 clients\n")
        assert answer.headers["Refresh"] == "5"
    assert here.refused == {"at most 16 clients": 2}
    assert body(here.ask("/assets/index.js")) == b"page"  # of a page that is still being loaded
    here.door.inside.pop()
    assert body(here.ask("/")) == b"page"
    assert here.join() is None


@pytest.mark.parametrize("spoken", [None, "", "viser-v1.1.0", "viser-v1.1.1x", "chat"])
def test_who_speaks_another_protocol_is_turned_away(here: Caller, spoken: str | None) -> None:
    headers = {"Upgrade": "websocket"} | ({} if spoken is None else {"Sec_WebSocket_Protocol": spoken})
    here.turned_away(here.ask(**headers, Host="localhost"), 400, "another version")


def test_a_list_of_protocols_may_hold_ours(here: Caller) -> None:
    assert here.ask(Upgrade="websocket", Sec_WebSocket_Protocol=f"chat, {PROTOCOL}") is None


def test_before_the_page_is_ready_nobody_connects(here: Caller) -> None:
    here.door.ready = False
    here.turned_away(here.join(), 503, "not ready")
    assert body(here.ask("/")) == b"page"


def test_a_refusal_is_plain_text_that_nobody_keeps(here: Caller) -> None:
    answer = here.ask(Host="<script>alert(1)</script>")
    assert answer is not None
    assert answer.headers["Content-Type"] == "text/plain; charset=utf-8"
    assert (answer.headers["X-Content-Type-Options"], answer.headers["Cache-Control"]) == ("nosniff", "no-store")
    assert b"<" not in bytes(answer.body)


def test_a_page_that_was_parted_asks_whether_it_may_come_in_again(network: Caller, here: Caller) -> None:
    answer = network.ask("/entry", Cookie=COOKIE)
    assert (None if answer is None else (answer.status_code, bytes(answer.body))) == (200, b"")
    network.turned_away(network.ask("/entry"), 401, "no token")
    here.door.ready = False
    here.turned_away(here.ask("/entry", Host="127.0.0.1:8080"), 503, "not ready")


def test_it_waits_while_there_is_no_place(here: Caller) -> None:
    for _ in range(MAX_CLIENTS):
        here.join(Connection("127.0.0.1", 8080), Host="127.0.0.1:8080")
    answer = here.ask("/entry", Host="127.0.0.1:8080")
    assert answer is not None
    assert answer.status_code == 503
