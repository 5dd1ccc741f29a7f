"""The one rule for all that leaves a script: which hosts it may call."""

import ipaddress

from app.urscript.language.trouble import Misuse

SHOWN = 50
"""Characters of a host in an error."""


class AllowedHosts:
    """This machine, and whoever sent the script. Names are not looked up: a look-up would ask others, and would wait.

    Args:
        senders: addresses other than this machine's that may be called.
    """

    def __init__(self, senders: frozenset[str] = frozenset()) -> None:
        self._senders = senders

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
        if not found.is_loopback and address not in self._senders:
            raise Misuse(f"address: {address} is not allowed: only this machine, and whoever sent the script")
        return address
