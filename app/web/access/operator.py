"""One operator at a time; everybody else watches (docs/guide/network.md)."""

from dataclasses import dataclass

SILENCE = 10.0
"""After this long without an act of the operator, whoever acts next takes over [s]."""


@dataclass(slots=True)
class Operator:
    """Who has control. Clients are numbers; times are seconds of one rising clock, given by the caller."""

    holder: int | None = None
    _last_act: float = 0.0
    _engaged: bool = False

    def claim(self, client: int, now: float) -> bool:
        """An act of `client`: True if it may act. It takes control if nobody has it, or if the holder has fallen silent."""
        if client != self.holder and not self.free(now):
            return False
        if client != self.holder:
            self.holder = client
            self._engaged = False
        self._last_act = now
        return True

    def engage(self, client: int, engaged: bool, now: float) -> None:
        """Say that `client` holds the arm (a hand that keeps still is no silence), or has let it go."""
        if client == self.holder:
            self._engaged = engaged
            self._last_act = now

    def leave(self, client: int) -> bool:
        """`client` gives control back, or its connection closed; True if it had it."""
        if client != self.holder:
            return False
        self.holder = None
        self._engaged = False
        return True

    def free_in(self, now: float) -> float | None:
        """Time until somebody else could take control [s]; None while the holder holds the arm."""
        if self.holder is None:
            return 0.0
        return None if self._engaged else max(0.0, SILENCE - (now - self._last_act))

    def free(self, now: float) -> bool:
        """Whether somebody else could take control now."""
        return self.holder is None or (not self._engaged and now - self._last_act >= SILENCE)
