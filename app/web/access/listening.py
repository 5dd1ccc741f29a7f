"""Where the app listens, and what it asks of those who come: nothing on this machine alone, a token on a network."""

import ipaddress
import secrets
import socket
from dataclasses import dataclass, field

from app.files.bad_input import BadInput

LOOPBACK = ("localhost", "127.0.0.1", "[::1]")
ANYWHERE = ("0.0.0.0", "::")
NOWHERE_IN_PARTICULAR = ("192.0.2.1", 9)  # an address set aside for examples (RFC 5737)
TOKEN_BYTES = 24


@dataclass(frozen=True, slots=True)
class Access:
    """Where to listen, and for whom.

    Args:
        host: address to listen on, as a socket takes it.
        token: what a browser has to bring; None on this machine alone.
        names: what the browser may call this machine, beside the very address that it has reached.
    """

    host: str = "127.0.0.1"
    token: str | None = field(default=None, repr=False)
    names: frozenset[str] = frozenset(LOOPBACK)

    def address(self, port: int) -> str:
        """Where the page is, for another program on this machine or, when listening everywhere, in the network."""
        host = reachable() if self.host in ANYWHERE else self.host
        return f"http://[{host}]:{port}" if ":" in host else f"http://{host}:{port}"

    def link(self, port: int) -> str:
        """The address with the token, if one is needed: it lets in whoever has it."""
        return self.address(port) if self.token is None else f"{self.address(port)}/?token={self.token}"


HERE = Access()
"""On this machine alone."""


def access_through(host: str) -> Access:
    """What `--host` asks for.

    Raises:
        BadInput: not an address of this machine.
    """
    bare = host.removeprefix("[").removesuffix("]")
    if host in LOOPBACK or _is_loopback(bare):
        return Access(bare)
    try:
        family, kind, protocol, _, where = socket.getaddrinfo(bare, 0, type=socket.SOCK_STREAM, flags=socket.AI_PASSIVE)[0]
        with socket.socket(family, kind, protocol) as probe:
            probe.bind(where)
    except (OSError, UnicodeError):
        allowed = f"an address of this machine: {', '.join(LOOPBACK)}, or one in its network, 0.0.0.0 for all of them"
        raise BadInput("serve", "--host", host, allowed) from None
    own = socket.gethostname().lower()
    names = {*LOOPBACK, own, own.partition(".")[0], f"{own.partition('.')[0]}.local", bare.lower()}
    return Access(bare, secrets.token_urlsafe(TOKEN_BYTES), frozenset(names))


def reachable() -> str:
    """This machine's address in its network, as far as it has one; else its name."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        try:
            probe.connect(NOWHERE_IN_PARTICULAR)  # asks for the way there; nothing is sent
        except OSError:
            return socket.gethostname()
        return str(probe.getsockname()[0])


def _is_loopback(host: str) -> bool:
    try:
        return ipaddress.ip_address(host).is_loopback
    except ValueError:
        return False


def free_port(host: str, port: int | None, usual: int) -> int:
    """`port`; or without one `usual` if it is free, else 0 for any. Raises BadInput: `port` is taken."""
    try:
        must_be_free(host, usual if port is None else port)
    except BadInput:
        if port is not None:
            raise
        return 0
    return usual if port is None else port


def must_be_free(host: str, port: int) -> None:
    """Raise BadInput when `port` is taken: viser would quietly take another."""
    with socket.socket(socket.AF_INET6 if ":" in host else socket.AF_INET) as probe:
        probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            probe.bind((host, port))
        except OSError:
            raise BadInput("serve", "--port", port, "a port that is free") from None
