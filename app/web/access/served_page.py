"""The one page that viser serves: its security headers and its name."""

import functools
import gzip

from websockets.datastructures import Headers
from websockets.http11 import Response

TITLE = "pendant"


def dress(response: Response, host: str) -> Response:
    """`response` of viser's file server with our headers, and our title in the page.

    The policy lets the page connect to its own server only: viser's client would follow ?websocket=ws://elsewhere and show
    whatever that server says, as if it were ours.
    """
    body = bytes(response.body or b"")
    if response.headers.get("Content-Type", "").startswith("text/html"):
        body = _named(body, response.headers.get("Content-Encoding") == "gzip")
    headers = Headers([(name, value) for name, value in response.headers.raw_items() if name != "Content-Length"])
    headers["Content-Length"] = str(len(body))
    headers["Content-Security-Policy"] = (
        "default-src 'self' 'unsafe-inline' 'unsafe-eval' data: blob:; "
        f"connect-src 'self' ws://{host} wss://{host} data: blob:; "
        "frame-ancestors 'none'; object-src 'none'; base-uri 'none'; form-action 'none'"
    )
    headers["X-Content-Type-Options"] = "nosniff"
    headers["Referrer-Policy"] = "no-referrer"
    headers["Cache-Control"] = "no-cache"
    return Response(response.status_code, response.reason_phrase, headers, body)


@functools.lru_cache(maxsize=4)
def _named(body: bytes, packed: bool) -> bytes:
    page = gzip.decompress(body) if packed else body
    page = page.replace(b"<title>Viser</title>", f"<title>{TITLE}</title>".encode(), 1)
    page = page.replace(b'content="Viser client"', b'content="A teach pendant and its arm, simulated"', 1)
    return gzip.compress(page, mtime=0) if packed else page
