"""One attempt to start free-drive, from the signal to the moment in which the arm may be freed (FD-7, FD-8, FD-8a)."""

from enum import StrEnum

from pendant.all_settings import Settings
from pendant.context import Surroundings
from pendant.events.event import Event, Kind, Values
from pendant.settings.schema import ticks
from pendant.signals.settings import ConfirmedBy, ConfirmedWhen
from pendant.signals.sources import BUTTON, POSTURE, PRESSES, SERIES, Presence
from pendant.tick.modes import TICK, Phase

GAP = ticks(1.0)
"""Where presences are summed, a longer gap cancels (FD-7)."""

ABSENT = ticks(0.2)
"""A signal counts as a new one after an absence of so many ticks (FD-7, FD-8)."""

CONFIRMING: dict[ConfirmedBy, frozenset[str]] = {
    ConfirmedBy.BUTTON: frozenset({BUTTON.source, PRESSES.source}),
    ConfirmedBy.PUSH: frozenset({"push"}),
    ConfirmedBy.TWIST: frozenset({"twist"}),
    ConfirmedBy.JOINTS: frozenset({"push felt by joints"}),
    ConfirmedBy.PATTERN: frozenset({"pushes in a row"}),
    ConfirmedBy.TURN: frozenset({"turned joint"}),
    ConfirmedBy.POSTURE: frozenset({POSTURE.source, SERIES.source}),
}
"""Sources that can confirm, by what is chosen: the pendant and FD-5 (c) to (g)."""

ALL_CONFIRMING = frozenset[str]().union(*CONFIRMING.values())


class Outcome(StrEnum):
    """What a tick of an attempt comes to."""

    GOES_ON = "goes on"
    CONFIRM = "confirm"  # the activation period has ended, and a confirmation is asked for
    LET_GO = "let go"  # the hand that gave the signal must leave the arm
    READY = "ready"  # the arm may be freed
    CANCELLED = "cancelled"  # the signal ended too early
    UNCONFIRMED = "unconfirmed"
    STILL_HELD = "still held"  # the hand did not leave the arm


class Attempt:
    """Activation period, then feedback and confirmation where they are asked for, then hands off."""

    __slots__ = (
        "_absent",
        "_by_hand",
        "_fresh",
        "_gap",
        "_off",
        "_run",
        "_settings",
        "_untouched",
        "_whole",
        "left",
        "phase",
        "source",
        "total",
    )

    def __init__(self, signal: Presence, settings: Settings) -> None:
        """It begins in the first tick of `signal`; `settings` stay as they are to its end."""
        self._settings = settings
        self.source = signal.source
        self._by_hand = signal.by_hand
        self._whole = signal.whole
        self._gap = 0  # ticks without the signal
        self._absent = 0  # ticks without a signal
        self._off = 0  # and without a hand that is felt
        self._fresh = False  # a signal of now began after the feedback
        self._untouched = False  # and a hand that gives it was off the arm before
        self._run = 0  # ticks of the confirmation
        self.phase = Phase.ACTIVATION
        self.left = self.total = ticks(settings.activation.period)

    @property
    def confirmed(self) -> bool:
        """It is ready with the handshake only (FD-8)."""
        return self._settings.handshake.on

    @property
    def asks_within(self) -> bool:
        """The robot asks in the activation sequence."""
        return self._settings.handshake.on and self._settings.handshake.when is ConfirmedWhen.WITHIN

    @property
    def present(self) -> float:
        """How long the signal has been present [s]."""
        return (self.total - self.left + 1) * TICK

    def first(self) -> Outcome:
        """The tick in which it begins."""
        return self._activated() if self.left == 0 else Outcome.GOES_ON

    def step(self, signal: Presence, touched: bool, hand_off: bool) -> Outcome:
        """A later tick.

        Args:
            signal: of now.
            touched: a hand is felt on the arm, be it less than a signal.
            hand_off: none has been felt for as long as it takes, and the arm stands.
        """
        self._absent = 0 if signal.source else self._absent + 1
        self._off = 0 if signal.source or touched else self._off + 1
        if self.phase is Phase.ACTIVATION:
            return self._count(signal)
        if self.phase is Phase.DELAY:
            self.left -= 1
            return self._feed_back() if self.left == 0 else Outcome.GOES_ON
        if self.phase is Phase.FEEDBACK:
            self.left -= 1
            return self._ask() if self.left == 0 else Outcome.GOES_ON
        if self.phase is Phase.CONFIRM:
            return self._confirm(signal)
        self.left -= 1
        if hand_off:
            return Outcome.READY
        return Outcome.STILL_HELD if self.left == 0 else Outcome.GOES_ON

    def _count(self, signal: Presence) -> Outcome:
        if not (signal.source or self._whole):
            self._gap += 1
            summing = self._settings.activation.sum_presences and self._gap <= GAP
            return Outcome.GOES_ON if summing else Outcome.CANCELLED
        self._gap = 0
        self._by_hand = self._by_hand or signal.by_hand
        self._whole = self._whole or signal.whole
        self.left -= 1
        return self._activated() if self.left == 0 else Outcome.GOES_ON

    def _activated(self) -> Outcome:
        """The activation period has ended."""
        if not self._settings.handshake.on or self.asks_within:
            return self._hands_off()
        return self.ask()

    def ask(self) -> Outcome:
        """Begin the handshake: the robot asks after its delay."""
        self.phase = Phase.DELAY
        self.left = self.total = ticks(self._settings.handshake.delay)
        return self._feed_back() if self.left == 0 else Outcome.GOES_ON

    def _feed_back(self) -> Outcome:
        """The robot asks."""
        self.phase = Phase.FEEDBACK
        self.left = self.total = ticks(self._settings.handshake.feedback)
        if self.left == 0:
            self._ask()
        return Outcome.CONFIRM

    def _ask(self) -> Outcome:
        """The feedback has ended: from now on a confirmation counts, if it begins now."""
        self.phase = Phase.CONFIRM
        self.left = self.total = ticks(self._settings.handshake.window)
        self._fresh, self._untouched = self._absent >= ABSENT, self._off >= ABSENT
        return Outcome.GOES_ON

    def _confirm(self, signal: Presence) -> Outcome:
        self.left = max(self.left - 1, 0)
        self._fresh = self._fresh or self._absent >= ABSENT
        # A pull that only weakens for a while, as a cable's does, has not left the arm: it is the first one, still held.
        self._untouched = self._untouched or self._off >= ABSENT
        if (self._untouched if signal.by_hand else self._fresh) and self._confirms(signal.source):
            self._run += 1
            if signal.whole or self._run > ticks(self._settings.handshake.hold):
                self._by_hand = signal.by_hand
                return self._hands_off()
            return Outcome.GOES_ON
        if self._run > 0:  # too short: the next one must be new, too
            self._run, self._fresh, self._untouched = 0, False, False
        return Outcome.UNCONFIRMED if self.left == 0 else Outcome.GOES_ON

    def _confirms(self, source: str) -> bool:
        by = self._settings.handshake.by
        return source in CONFIRMING.get(by, ALL_CONFIRMING) and not (by is ConfirmedBy.OTHER and source == self.source)

    def _hands_off(self) -> Outcome:
        """The signal is complete: a hand that gave it must leave the arm first."""
        if not (self._by_hand and self._settings.let_go.on):
            return Outcome.READY
        self.phase = Phase.LET_GO
        self.left = self.total = ticks(self._settings.let_go.within)
        return Outcome.LET_GO


def reserved(signal: Presence, settings: Settings) -> bool:
    """A source that is chosen to confirm does not ask for free-drive (FD-8)."""
    use = settings.handshake
    return use.on and signal.source in CONFIRMING.get(use.by, ())


def started(attempt: Attempt, tick: int) -> Event:
    """The event of its first tick."""
    values: Values = {"period": attempt.total * TICK}
    if attempt.source == BUTTON.source:
        return Event(Kind.ACTIVATION_STARTED, tick, values)
    return Event(Kind.SIGNAL_SEEN, tick, {"source": attempt.source, **values})


def asked(outcome: Outcome, attempt: Attempt, around: Surroundings, settings: Settings) -> Event:
    """A confirmation or hands off is asked for, or was asked for and did not come."""
    tick, handshake, off = around.estimate.tick, settings.handshake, settings.let_go
    if outcome is Outcome.CONFIRM:
        values: Values = {"source": attempt.source, "feedback": handshake.feedback, "window": handshake.window}
        return Event(Kind.CONFIRM_ASKED, tick, values)
    if outcome is Outcome.UNCONFIRMED:
        return Event(Kind.REFUSED_UNCONFIRMED, tick, {"source": attempt.source, "limit": handshake.window})
    values = {"force": around.felt, "limit": off.force, "within": off.within}
    return Event(Kind.LET_GO_ASKED if outcome is Outcome.LET_GO else Kind.REFUSED_STILL_HELD, tick, values)
