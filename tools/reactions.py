"""Writes out/docs/reactions.md from the event table: condition, reaction, how it clears.

Run: `python -m tools.reactions`.
"""

import re
from pathlib import Path
from typing import NamedTuple

from pendant.event_table import TABLE
from pendant.events.event import Kind
from pendant.events.event_row import LEAVING, Clears, Effect, EventRow, Severity
from pendant.robot.robot_mode import DONE_GUIDING
from pendant.robot.stopping import LONGEST
from pendant.tick.modes import TICK

PAGE = Path(__file__).parent.parent / "out" / "docs" / "reactions.md"

HEAD = """# Reactions: condition, reaction, how it clears

Written by `python -m tools.reactions` from the event table (`pendant/event_table.py`): every event that stops the arm, refuses or
ends free-drive, refuses another wish, ends a motion, or warns. The first column is the name of the event in logs and sessions. A
word in *italics* is a value of the event. What limits and periods are is in the settings;
[free-drive](../../docs/guide/free-drive.md) and [stops](../../docs/guide/stops.md) say how a condition is found.

Where several conditions hold in one tick, the gravest reaction counts. A stop stands above the end of free-drive. In STOP
the safety mode can only become graver: `SAFEGUARD_STOP`, `PROTECTIVE_STOP`, `EMERGENCY_STOP`. Of two stops the one with the
lower category counts.
"""

CATEGORIES = {
    0: "The drives are switched off at once, and the brakes hold.",
    1: f"The arm brakes; the drives are switched off when it stands, after {LONGEST * TICK:.0f} s at the latest.",
    2: "The arm brakes and is held; the drives stay on.",
}
"""What each stop category does (IEC 60204-1)."""

SAFETY = {
    Effect.LEAVE_TO_STOP: "The safety mode stays.",
    Effect.SAFEGUARD_STOP: "Safety mode `SAFEGUARD_STOP`.",
    Effect.PROTECTIVE_STOP: "Safety mode `PROTECTIVE_STOP`.",
    Effect.EMERGENCY_STOP: "Safety mode `EMERGENCY_STOP`.",
}
"""Effects that end in STOP, the gravest last, and the safety mode that follows."""


class Part(NamedTuple):
    """A part of the page."""

    title: str
    text: str
    effects: frozenset[Effect]


PARTS = (
    Part(
        "Stops",
        "The mode is STOP, and a program is given up. Free-drive ends, and its cool-down begins. The message stays\n"
        "until a reset. A reset leads to TEACH. It is refused while the arm moves, the safeguard is open, the button\n"
        "is held, or a joint sensor is not valid.",
        frozenset(SAFETY),
    ),
    Part(
        "Free-drive is refused",
        "The mode stays. Where the check had begun, the arm brakes and is held again, and a program that ran is\n"
        "paused. The cool-down begins. To its end the message stays, and nothing asks for free-drive.",
        frozenset({Effect.NO_ENTRY}),
    ),
    Part(
        "Free-drive ends",
        "The mode is that from which free-drive was entered. The arm brakes and is held. A program stays paused; one\n"
        "that asked for hand guiding goes on or pauses, as the row says. The cool-down begins, unless free-drive was\n"
        "switched off by a command or an input. The message stays to the end of the cool-down.",
        frozenset({Effect.LEAVE}),
    ),
    Part(
        "Warnings, and wishes that are refused",
        "The mode stays, unless the row says something else. The message goes with the next one, with another mode,\n"
        "or after some seconds.",
        frozenset({Effect.INFO}),
    ),
)

ALREADY = "All stays as it was."
"""Reaction of what warns or refuses, where its row names none."""

DEFAULTS = {
    Clears.RESET: "Reset.",
    Clears.COOL_DOWN: "Ask again after the cool-down.",
    Clears.NEXT: "Mend what the reason names, then ask again.",
}
"""How a condition clears where neither its row nor its guidance says it."""


def belongs(row: EventRow) -> bool:
    """Whether an event stops, refuses, ends or warns."""
    return row.effect in LEAVING | {Effect.NO_ENTRY} or row.severity >= Severity.WARNING or bool(row.reaction)


def worded(text: str) -> str:
    """A text of the table with the names of its values instead of them."""
    return re.sub(r"\{(\w+)[^}]*\}", lambda found: f"*{found[1].replace('_', ' ')}*", text)


def sentences(row: EventRow) -> tuple[list[str], list[str]]:
    """Sentences of the guidance: those that tell what was measured, which have values in them, and those that tell what to do."""
    parts = re.split(r"(?<=\.)\s+", row.guidance) if row.guidance else []
    if row.way_out:
        return parts, [row.way_out]
    return [part for part in parts if "{" in part], [part for part in parts if "{" not in part]


def condition(row: EventRow) -> str:
    """What the event says of its cause."""
    told, _ = sentences(row)
    return worded(f"{row.headline}. {' '.join(told)}").strip()


def reaction(kind: Kind, row: EventRow) -> str:
    """What follows from the event."""
    if row.effect in SAFETY:
        return f"{SAFETY[row.effect]} Stop category {row.category}: {CATEGORIES[row.category]} {row.reaction}".strip()
    if row.effect is Effect.NO_ENTRY:
        return f"Free-drive is refused. {row.reaction}".strip()
    if row.effect is Effect.LEAVE:
        guided = "goes on" if kind in DONE_GUIDING else "pauses"
        return f"Free-drive ends. A program that asked for hand guiding {guided}. {row.reaction}".strip()
    return row.reaction or ALREADY


def clearing(row: EventRow) -> str:
    """How the condition goes away."""
    _, wanted = sentences(row)
    text = " ".join(wanted) or DEFAULTS[row.clears]
    return text if row.clears is not Clears.RESET or "reset" in text.lower() else f"{text} Then reset."


def rows(part: Part) -> list[tuple[str, str, str, str]]:
    """The rows of a part: name, condition, reaction, how it clears. Stops begin with the gravest."""
    found = [(kind, row) for kind, row in TABLE.items() if row.effect in part.effects and belongs(row)]
    grave = list(SAFETY)
    found.sort(key=lambda each: (-grave.index(each[1].effect), each[1].category) if each[1].effect in SAFETY else (0, 0))
    return [(f"`{kind}`", condition(row), reaction(kind, row), clearing(row)) for kind, row in found]


def page() -> str:
    """The page as it should be."""
    lines = [HEAD]
    for part in PARTS:
        lines += [f"## {part.title}", "", part.text, "", "| event | condition | reaction | how it clears |", "|---|---|---|---|"]
        lines += [f"| {' | '.join(cells)} |" for cells in rows(part)]
        lines.append("")
    return "\n".join(lines)


if __name__ == "__main__":
    PAGE.parent.mkdir(parents=True, exist_ok=True)
    PAGE.write_text(page(), encoding="utf-8")
