"""Who gets in: looked at before there is a connection, for pages as for the connections of pages.

A page of somebody else must not drive the arm of whoever visits it (foreign Origin), nor by a name that it makes point to this
machine (foreign Host). On a network a token is needed as well. viser's client opens its connection without the page's query,
so that the link's token becomes a cookie.
"""

import hmac
import ipaddress
import re
from collections import Counter
from collections.abc import Callable
from http import HTTPStatus
from urllib.parse import parse_qs

from websockets.asyncio.server import ServerConnection
from websockets.datastructures import Headers
from websockets.http11 import Request, Response

from app.web.access.listening import Access
from app.web.access.served_page import dress

MAX_CLIENTS = 16
ENTRY = "/entry"
"""Asked by a page that has lost its connection: may it come in again? The answer is empty."""

AGAIN = "5"
"""When a page that found no place asks again [s]."""

Pages = Callable[[ServerConnection, Request], Response | None]
_HOST = re.compile(r"(?P<name>\[[0-9a-f:.]+\]|[^\s:;,\[\]]+)(:[0-9]{1,5})?", re.IGNORECASE)


class Door:
    """Answers every request, or lets it through.

    Args:
        access: for whom.
        protocol: subprotocol that a connection has to speak.
        refused: counts those turned away, by reason.
    """

    def __init__(self, access: Access, protocol: str, refused: Counter[str]) -> None:
        self.inside: set[ServerConnection] = set()  # from here until they are lost
        self.ready = False
        self._access = access
        self._protocol = protocol
        self._refused = refused

    def answer(self, pages: Pages, connection: ServerConnection, request: Request) -> Response | None:
        """The page or a refusal; None lets a connection begin. `pages` is viser's file server."""
        upgrade = request.headers.get_all("Upgrade")
        host = self._host(connection, request.headers)
        if host is None:
            return self._turn_away(HTTPStatus.FORBIDDEN, "foreign host")
        origins = request.headers.get_all("Origin")
        if origins and origins not in ([f"http://{host}"], [f"https://{host}"]):
            return self._turn_away(HTTPStatus.FORBIDDEN, "foreign origin")
        if self._access.token is not None:
            answer = self._ask_for_token(self._access.token, connection, request)
            if answer is not None:
                return answer
        asks = _path(request) == ENTRY
        if (upgrade or asks) and not self.ready:
            return self._turn_away(HTTPStatus.SERVICE_UNAVAILABLE, "not ready")
        if len(self.inside) >= MAX_CLIENTS and (upgrade or asks or _path(request) == "/"):
            return self._turn_away(HTTPStatus.SERVICE_UNAVAILABLE, f"at most {MAX_CLIENTS} clients", AGAIN)
        if asks and not upgrade:
            headers = Headers({"Content-Length": "0", "Cache-Control": "no-store", "X-Content-Type-Options": "nosniff"})
            return Response(HTTPStatus.OK.value, HTTPStatus.OK.phrase, headers, b"")
        if upgrade and self._protocol not in _listed(request.headers, "Sec-WebSocket-Protocol"):
            return self._turn_away(HTTPStatus.BAD_REQUEST, "another version: load the page again")
        response = pages(connection, request)
        if response is not None:
            return dress(response, host)
        self.inside.add(connection)
        return None

    def _host(self, connection: ServerConnection, headers: Headers) -> str | None:
        """What the browser calls us, if that is ours."""
        named = headers.get_all("Host")
        match = _HOST.fullmatch(named[0]) if len(named) == 1 else None
        if match is None:
            return None
        name = match["name"].lower()
        return named[0] if name in self._access.names or _is_here(name, connection) else None

    def _ask_for_token(self, token: str, connection: ServerConnection, request: Request) -> Response | None:
        """A refusal, or the way from the link with the token to the page; None if the cookie has the token."""
        cookie = f"pendant-{connection.local_address[1]}"  # a browser does not keep the cookies of two ports apart
        shown = parse_qs(request.path.partition("?")[2]).get("token", [])[-1:]
        if shown and _same(shown[0], token):
            headers = Headers({"Location": "/", "Content-Length": "0"})
            headers["Cache-Control"] = "no-store"
            headers["Referrer-Policy"] = "no-referrer"
            # Lax: a link in a mail leads to the page, and connections of other pages still do not bring the cookie.
            headers["Set-Cookie"] = f"{cookie}={token}; Path=/; HttpOnly; SameSite=Lax"
            return Response(HTTPStatus.SEE_OTHER.value, HTTPStatus.SEE_OTHER.phrase, headers, b"")
        brought = _cookie(request.headers, cookie)
        if brought is not None and _same(brought, token):
            return None
        reason = "no token" if brought is None and not shown else "wrong token"
        return self._turn_away(HTTPStatus.UNAUTHORIZED, f"{reason}: open the link that pendant has printed in its terminal")

    def _turn_away(self, status: HTTPStatus, reason: str, again: str | None = None) -> Response:
        self._refused[reason.partition(":")[0]] += 1
        body = f"refused: {reason}\n".encode()
        headers = Headers({"Content-Type": "text/plain; charset=utf-8", "Content-Length": str(len(body))})
        headers["X-Content-Type-Options"] = "nosniff"
        headers["Cache-Control"] = "no-store"
        if again is not None:
            headers["Refresh"] = again
        return Response(status.value, status.phrase, headers, body)


def _same(shown: str, token: str) -> bool:
    return hmac.compare_digest(shown.encode(errors="surrogateescape"), token.encode())


def _path(request: Request) -> str:
    return request.path.partition("?")[0]


def _listed(headers: Headers, name: str) -> list[str]:
    """The values of a header that may be given in several lines, each with several values."""
    return [value.strip() for line in headers.get_all(name) for value in line.split(",")]


def _cookie(headers: Headers, name: str) -> str | None:
    """The value of the cookie of that name."""
    for line in headers.get_all("Cookie"):
        for pair in line.split(";"):
            key, _, value = pair.strip().partition("=")
            if key == name:
                return value
    return None


def _is_here(name: str, connection: ServerConnection) -> bool:
    """Whether `name` is the address by which the connection has come: no other page can make a name look like that."""
    try:
        return ipaddress.ip_address(name.strip("[]")) == ipaddress.ip_address(connection.local_address[0].partition("%")[0])
    except ValueError:
        return False
