"""The one page that viser serves: its security headers, its name, and what assets/page adds to it."""

import base64
import functools
import gzip

from websockets.datastructures import Headers
from websockets.http11 import Response

from app.files.library import ASSETS

TITLE = "pendant"
THEIRS = b"<title>Viser</title>"
"""In its place stands what we add: before the client's script, so that it is seen while that is still being read."""


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
    page = page.replace(b'content="Viser client"', b'content="A teach pendant and its arm, simulated"', 1)
    page = page.replace(THEIRS, _added(), 1)
    return gzip.compress(page, mtime=0) if packed else page


@functools.cache
def _added() -> bytes:
    """Style, script, and the picture that is shown until the client draws."""
    style, script = ((ASSETS / "page" / name).read_text(encoding="utf-8") for name in ("page.css", "page.js"))
    picture = base64.b64encode((ASSETS / "page" / "arm.webp").read_bytes()).decode()
    opening = (
        '<div id="pd-opening" role="status"><i></i><figure>'
        f'<img alt="A collaborative robot arm" src="data:image/webp;base64,{picture}" />'
        "<figcaption>The simulation is opening</figcaption></figure><i></i></div>"
    )
    return f"<title>{TITLE}</title><style>{style}</style><script>{script}</script>{opening}".encode()
