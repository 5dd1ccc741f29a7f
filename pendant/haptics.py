"""Haptic feedback: small motions of the last joint, which a hand on the tool feels in every posture (HF-1, HF-2, FD-21).

A pattern is a row of bursts, each a few cycles that swell and fade, so that it starts and ends at the same posture, at rest.
While it lasts the centre of the motion wanders out and back: no two cycles of a long one turn at the same places, and the
bearings keep their grease.
"""

import math
from typing import Annotated, NamedTuple

from pendant.events.event import Event, Kind
from pendant.settings.schema import Section, number, switch, ticks
from pendant.tick.modes import TICK, Law, Mode, Phase
from pendant.tick.words import Word

FREQUENCY = 15.0
"""Of the cycles [Hz]: a skin feels it well, and it lies above the arms' lowest modes."""

GAP = ticks(0.04)
"""Between two bursts."""

WANDER = 1.5
"""How far the centre goes out, of the amplitude; so no angle is beyond 1 + WANDER amplitudes."""

SETTLING = ticks(0.1)
"""After a pattern, until what it shook counts as standing again."""

ABOUT_TO_END = ticks(1.0)
"""What is left of a period when its end is felt."""


class Pattern(Word):
    """What can be felt, each by its own rhythm (HF-1)."""

    LEFT = "left"
    ENTERED = "entered"
    CONFIRMATION = "confirmation"
    BORDER = "border"
    ENDING = "ending"
    CONTACT = "contact"


RHYTHMS: dict[Pattern, tuple[int, ...]] = {
    Pattern.LEFT: (6,),
    Pattern.ENTERED: (2, 2),
    Pattern.CONFIRMATION: (2, 3),
    Pattern.BORDER: (4,),
    Pattern.ENDING: (2, 2, 2),
    Pattern.CONTACT: (2,),
}
"""Cycles of each burst."""


class HapticUse(Section, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """Feedback that is felt: which patterns, and how far they turn the last joint."""

    BASIC = ("on", "amplitude")

    on: Annotated[bool, switch("HF-1", "haptic feedback: patterns of small motions of the last joint", locked=False)] = False
    amplitude: Annotated[
        float, number(0.001, 0.008, "rad", "HF-2", text="amplitude of a cycle; its centre wanders 1.5 times as far")
    ] = 0.004
    left: Annotated[bool, switch("HF-1", "pattern when free-drive has ended", locked=False)] = True
    entered: Annotated[bool, switch("HF-1", "pattern when free-drive was entered", locked=False)] = True
    confirmation: Annotated[bool, switch("HF-1", "pattern when a confirmation is asked for", locked=False)] = True
    border: Annotated[bool, switch("HF-1", "pattern when a wall or another border comes close", locked=False)] = True
    ending: Annotated[bool, switch("HF-1", "pattern 1 s before a period of free-drive ends", locked=False)] = True
    contact: Annotated[bool, switch("HF-1", "pattern when a change in contact was detected", locked=False)] = True


class Shake(NamedTuple):
    """The last joint's offset from where it was when the pattern began, in one tick."""

    pattern: Pattern
    angle: float  # [rad]
    speed: float  # [rad/s]
    acceleration: float  # [rad/s²]


CONTACTS = frozenset({Kind.CONTACT_GAINED, Kind.CONTACT_LOST, Kind.CONTACT_RESISTANCE, Kind.CONTACT_CLAMPING})


class Moment(NamedTuple):
    """What a tick brings that may be felt."""

    mode: Mode
    law: Law
    phase: Phase
    events: list[Event]
    near: bool  # a wall resists or holds
    left: int  # of the period that ends free-drive [ticks], or -1
    feedback: int  # time for which a confirmation is asked before it counts [ticks]


def offset(pattern: Pattern, tick: float) -> float:
    """The last joint's offset, in amplitudes, `tick` ticks after the pattern began; 0 before it and after it."""
    whole = length(pattern)
    if not 0.0 <= tick <= whole:
        return 0.0
    value = WANDER * math.sin(math.pi * tick / whole) ** 2
    begin = 0.0
    for cycles in RHYTHMS[pattern]:
        end = begin + cycles * CYCLE
        if begin < tick < end:
            swell = math.sin(math.pi * (tick - begin) / (end - begin)) ** 2
            return value + swell * math.sin(2.0 * math.pi * (tick - begin) / CYCLE)
        begin = end + GAP
    return value


def length(pattern: Pattern) -> int:
    """Ticks of a pattern."""
    rhythm = RHYTHMS[pattern]
    return math.ceil(sum(rhythm) * CYCLE) + GAP * (len(rhythm) - 1)


CYCLE = 1.0 / (FREQUENCY * TICK)
"""Ticks of a cycle."""


class Haptics:
    """Plays one pattern at a time.

    Attributes:
        shake: of this tick, None when nothing is felt.
        busy: the arm shakes, or has just done so: its motion is no hand's.
    """

    __slots__ = ("_beyond", "_freed", "_mode", "_rest", "_tick", "busy", "shake")

    def __init__(self) -> None:
        self.shake: Shake | None = None
        self.busy = False
        self._tick = 0  # of the pattern
        self._rest = 0  # ticks until the arm counts as standing
        self._freed = False  # the law of the tick before followed the hand
        self._beyond = False  # a wall was near in the tick before
        self._mode = Mode.TEACH  # in the tick before

    def step(self, moment: Moment, use: HapticUse) -> None:
        """One tick, while patterns are on or the last one settles."""
        freed = moment.law is Law.FREE
        calm = moment.law in (Law.HOLD, Law.BRAKE) and moment.mode is not Mode.STOP
        may = use.on and (calm or (freed and moment.phase is not Phase.SEQUENCE))
        began = self._begun(moment, use) if may else None
        self._beyond, self._mode = moment.near, moment.mode
        playing = self.shake
        # Another law keeps the posture that it finds, or stands for a stop: half a degree less is no way to come back.
        if playing is not None and not (may and freed is self._freed):
            playing = None
        self._freed = freed
        if playing is None and began is not None:
            self._tick = 0
            self.shake = self._at(began, use.amplitude)
        elif playing is not None and self._tick < length(playing.pattern):
            self._tick += 1
            self.shake = self._at(playing.pattern, use.amplitude)
        else:
            self.shake = None
        self._rest = SETTLING if self.shake is not None else max(self._rest - 1, 0)
        self.busy = self._rest > 0

    def _begun(self, moment: Moment, use: HapticUse) -> Pattern | None:
        """What begins to be felt in this tick; of several things the first of the list."""
        if self._mode is Mode.FREE_DRIVE and moment.mode is not Mode.FREE_DRIVE:
            return Pattern.LEFT if use.left else None
        kinds = {event.kind for event in moment.events}
        happens = (
            (Pattern.ENTERED, use.entered and Kind.ENTERED in kinds),
            # What asks must be over, and the arm at rest, when the answer counts.
            (
                Pattern.CONFIRMATION,
                use.confirmation and Kind.CONFIRM_ASKED in kinds and moment.feedback >= length(Pattern.CONFIRMATION) + SETTLING,
            ),
            (Pattern.BORDER, use.border and moment.near and not self._beyond),
            (Pattern.ENDING, use.ending and moment.left == ABOUT_TO_END),
            (Pattern.CONTACT, use.contact and not CONTACTS.isdisjoint(kinds)),
        )
        return next((pattern for pattern, now in happens if now), None)

    def _at(self, pattern: Pattern, amplitude: float) -> Shake:
        before, now, after = (amplitude * offset(pattern, self._tick + k) for k in (-1, 0, 1))
        return Shake(pattern, now, (after - before) / (2.0 * TICK), (after - 2.0 * now + before) / TICK**2)
