"""The one rule for all that leaves a script: which hosts it may call."""

import ipaddress
from collections.abc import Callable

from app.urscript.language.trouble import Misuse

SHOWN = 50
"""Characters of a host in an error."""

MOST_TOLD = 100
"""Hosts of a script of which people are told that it may not call them."""


class AllowedHosts:
    """This machine, and whoever sent the script. Names are not looked up: a look-up would ask others, and would wait.

    Args:
        senders: addresses other than this machine's that may be called.
        tell: takes what people are told.
    """

    def __init__(self, senders: frozenset[str], tell: Callable[[str], None]) -> None:
        self._senders, self._tell = senders, tell
        self._told: set[str] = set()  # hosts

    def address(self, host: str) -> str:
        """The address of a host, which may be called.

        Raises:
            Misuse: it may not, or is no address.
        """
        address = "127.0.0.1" if host == "localhost" else host
        try:
            found = ipaddress.ip_address(address)
        except ValueError:
            raise Misuse(f"address: {host[:SHOWN]!r} is no IP address; names are not looked up") from None
        here = found.is_loopback and "%" not in address  # loopback has no zones
        if not here and address not in self._senders:
            raise Misuse(f"address: {address[:SHOWN]} is not allowed: only this machine, and whoever sent the script")
        return address

    def reached(self, host: str) -> str | None:
        """The address of a host; None: it may not be called, of which people are told once, and counts as not there."""
        try:
            return self.address(host)
        except Misuse as misuse:
            if host not in self._told and len(self._told) < MOST_TOLD:
                self._told.add(host)
                self._tell(f"{misuse}; nothing is sent, and it counts as a host that is not there")
            return None
