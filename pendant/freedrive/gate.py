"""The gate before free-drive: when a signal of activation counts as a new one, and the cool-down (FD-7, FD-8, FD-12c)."""

from pendant.freedrive.attempt import ABSENT
from pendant.signals.sources import NONE, Presence


class Gate:
    """The button and the signal of activation in every tick; shut in the cool-down, and until the signal has been absent.

    Attributes:
        held: the button is, as sensed in this tick.
        began: it was pressed in this tick.
        ended: it was let go in this tick.
        signal: of activation, in this tick.
        appeared: it did in this tick.
        left: ticks left of the cool-down.
        total: its length [ticks].
    """

    __slots__ = ("_absent", "_blocked", "_steady", "appeared", "began", "ended", "held", "left", "signal", "total")

    def __init__(self) -> None:
        self.held = self.began = self.ended = False
        self.signal = NONE
        self.appeared = False
        self.left = self.total = 0
        self._blocked = False  # the signal was present at a refusal or a leaving
        self._absent = ABSENT  # ticks without the signal
        self._steady = False  # another tick of the same changes nothing

    @property
    def shut(self) -> bool:
        """No attempt can begin."""
        return self._blocked or self.left > 0

    def sense(self, held: bool, signal: Presence) -> None:
        """One tick: the button, and the signal of activation."""
        if self._steady and held is self.held and signal is self.signal:
            return
        changes = held is not self.held or signal is not self.signal
        self.appeared = bool(signal.source) and not self.signal.source
        self.signal = signal
        self.began = held and not self.held
        self.ended = self.held and not held
        self.held = held
        if self.left > 0:
            self.left -= 1
        self._absent = 0 if held or signal.source else min(self._absent + 1, ABSENT)
        if self._absent == ABSENT:
            self._blocked = False
        elif signal.by_hand and self.left > 0:
            self._blocked = True
        self._steady = not changes and self.left == 0 and (self._absent == 0 or self._absent == ABSENT)

    def close(self, cool_down: int) -> None:
        """Free-drive is left or refused; the cool-down takes so many ticks."""
        self._blocked = self.held or bool(self.signal.source)
        self.left = self.total = cool_down
        self._steady = False
