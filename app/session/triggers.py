"""When something of a session is due: at a time, or some time after what the robot did ("mode FREE_DRIVE", "event ...")."""

from dataclasses import dataclass, field
from typing import Annotated

import msgspec
from msgspec import Meta

from pendant.decision import Decision
from pendant.events.event import Kind
from pendant.settings.bounds import Time
from pendant.tick.modes import Mode, Phase, Safety

WORDS: dict[str, tuple[str, ...]] = {
    "mode": tuple(mode.value for mode in Mode),
    "phase": tuple(phase.value for phase in Phase),
    "safety": tuple(safety.name for safety in Safety),
    "event": tuple(kind.value for kind in Kind),
}
"""What may follow `after:`, and the names that each of them knows."""


NEVER = 2**62
"""A tick that does not come."""


class After(msgspec.Struct, frozen=True, kw_only=True):
    """Base of what may be due relative to what the robot did.

    `after` is "mode X", "phase X", "safety X" or "event KIND": the `nth` time that the robot comes into that mode (the one
    at the start counts as its first), or that an event of that kind happens. None: the start of the session.
    """

    after: str | None = None
    nth: Annotated[int, Meta(ge=1)] = 1

    def __post_init__(self) -> None:
        """Check the words of `after`."""
        if self.after is not None:
            parse(self.after)
        elif self.nth != 1:
            raise ValueError("nth counts what `after` names, and there is no `after`")


class When(After, frozen=True, kw_only=True):
    """Base of a time-line entry: either `at` a time, or `delay` after something."""

    at: Time | None = None  # since the start of the session [s]
    delay: Time = 0.0  # [s]

    def __post_init__(self) -> None:
        """Check that there is one time."""
        super().__post_init__()
        if (self.at is None) == (self.after is None):
            raise ValueError('needs either `at: SECONDS` or `after: "mode X"` with an optional `delay`, and not both')
        if self.at is not None and self.delay:
            raise ValueError("delay belongs to `after`; with `at` add it to the time")


def parse(text: str) -> tuple[str, str]:
    """Split "mode FREE_DRIVE" into its word and its name.

    Raises ValueError: unknown word or name.
    """
    word, _, name = text.partition(" ")
    if word not in WORDS:
        raise ValueError(f'after: "{text}" must be one of {", ".join(WORDS)}, then a name, such as "mode FREE_DRIVE"')
    if name not in WORDS[word]:
        raise ValueError(f'after: "{name}" is no {word}; known: {", ".join(WORDS[word])}')
    return word, name


@dataclass(slots=True)
class Trigger:
    """Watches for the `nth` time of `after`; with None it has happened at tick 0, the start."""

    after: str | None
    nth: int = 1
    happened: int | None = None  # the tick in which it did
    _word: str = field(init=False, default="")
    _name: str = field(init=False, default="")
    _left: int = field(init=False)
    _was: str | None = field(init=False, default=None)

    def __post_init__(self) -> None:
        """Start to watch."""
        self._left = self.nth
        if self.after is None:
            self.happened = 0
        else:
            self._word, self._name = parse(self.after)

    def see(self, tick: int, decision: Decision) -> None:
        """Take in the decision of `tick`; call it for every tick in order."""
        if self.happened is not None:
            return
        word, name = self._word, self._name
        if word == "event":
            for event in decision.events:
                self._left -= event.kind.value == name
        else:
            now = decision.safety.name if word == "safety" else getattr(decision, word).value
            self._left -= now == name and self._was != name
            self._was = now
        if self._left <= 0:
            self.happened = tick
