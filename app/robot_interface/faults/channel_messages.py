"""How the control channel reads a request and answers it: JSON both ways, and errors in one line."""

from http import HTTPStatus
from typing import TypeVar

import msgspec
from starlette.requests import Request
from starlette.responses import Response

from app.files.bad_input import ABSENT, BadInput
from app.files.checked import convert

WHERE = "control channel"

MOST_BYTES = 1 << 20
"""Of a request."""

T = TypeVar("T")


def answer(value: object, status: HTTPStatus = HTTPStatus.OK) -> Response:
    """A value as an answer."""
    headers = {"Cache-Control": "no-store", "X-Content-Type-Options": "nosniff"}
    return Response(msgspec.json.encode(value), status, headers, media_type="application/json")


def refusal(status: HTTPStatus, why: str) -> Response:
    """What cannot be done."""
    return answer({"error": why}, status)


def whole(request: Request, name: str) -> int:
    """A number of the request's address, 0 without it. Raises BadInput: it is no whole number."""
    text = request.query_params.get(name, "0")
    if not (text.isascii() and text.isdigit() and len(text) < 10):
        raise BadInput(WHERE, name, text, "a whole number, 0 or more")
    return int(text)


async def body(request: Request, kind: type[T]) -> T:
    """The request's body as `kind`. Raises BadInput: it is too long, no JSON, or does not fit."""
    data = bytearray()
    async for part in request.stream():
        data += part
        if len(data) > MOST_BYTES:
            raise BadInput(WHERE, "", ABSENT, f"a request of more than {MOST_BYTES} bytes")
    try:
        raw = msgspec.json.decode(bytes(data) or b"{}")
    except (msgspec.DecodeError, RecursionError, UnicodeDecodeError) as error:
        raise BadInput(WHERE, "", ABSENT, f"expected JSON ({error})") from None
    return convert(raw, kind, WHERE)
