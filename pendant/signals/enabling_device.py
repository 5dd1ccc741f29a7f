"""Three-position enabling device: released and fully pressed both stop, only the middle enables (IEC 60204-1)."""

from enum import StrEnum

from pendant.inputs import Button, Inputs
from pendant.signals.keep_alive import KeepAlive


class Grip(StrEnum):
    """How the enabling device is held."""

    RELEASED = "released"
    MIDDLE = "in the middle"
    PRESSED = "fully pressed"


POSITIONS = frozenset({Button.ENABLING, Button.ENABLING_FULL})


def enables(grip: Grip | None) -> bool:
    """The arm may move, held like this; None: no device is needed."""
    return grip is None or grip is Grip.MIDDLE


class EnablingDevice:
    """Each position is a keep-alive (FD-23); the device falls silent as if it were released.

    On its way back from fully pressed a hand passes the middle: that does not enable, only a release before it does.
    """

    __slots__ = ("_full", "_middle", "_spent")

    def __init__(self) -> None:
        self._middle = KeepAlive()
        self._full = KeepAlive()
        self._spent = False  # was fully pressed, and not released since

    def step(self, inputs: Inputs, silence: int) -> None:
        """One tick; `silence` [ticks] as in KeepAlive."""
        middle, full, held = self._middle, self._full, inputs.held
        if not (middle.held or full.held) and POSITIONS.isdisjoint(held):
            self._spent = False
            return
        released = inputs.released
        middle.step(Button.ENABLING in held, Button.ENABLING in released, silence)
        full.step(Button.ENABLING_FULL in held, Button.ENABLING_FULL in released, silence)
        self._spent = self._full.held or (self._spent and self._middle.held)

    @property
    def grip(self) -> Grip:
        """How it is held; fully pressed wins, and lasts until a release."""
        if self._spent:
            return Grip.PRESSED
        return Grip.MIDDLE if self._middle.held else Grip.RELEASED
