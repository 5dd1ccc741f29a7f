"""Whole sessions against what they did when somebody last looked: every event that changes a mode, and when.

After a change that is meant, `python -m tests.golden` writes the file anew; look at its difference.
"""

import json
import tempfile
from collections.abc import Sequence
from itertools import zip_longest
from pathlib import Path

from app.engine.spreading import spread
from app.files.checked import load
from app.runs.runner import run, simulate
from app.session.prepare import prepare
from app.session.session_file import Session, bundled, find
from pendant.event_table import TABLE
from pendant.events.event import Event
from pendant.events.event_row import Effect
from pendant.tick.modes import TICK

FILE = Path(__file__).parent / "golden.json"
GRACE = 0.05
"""Another processor rounds otherwise, and an arm that swings is static some ticks sooner or later [s]."""

Deed = tuple[float, str]
"""Time [s] and kind of an event."""


def deeds(events: Sequence[Event]) -> list[Deed]:
    """What changes a mode."""
    return [(round(event.tick * TICK, 3), event.kind.value) for event in events if TABLE[event.kind].effect is not Effect.INFO]


def known() -> dict[str, list[Deed]]:
    """What every bundled session did."""
    return {name: [(t, kind) for t, kind in each] for name, each in json.loads(FILE.read_text(encoding="utf-8")).items()}


def differences(wanted: Sequence[Deed], done: Sequence[Deed]) -> list[str]:
    """Where two sessions went different ways, in words; empty where they did not."""
    found: list[str] = []
    for then, now in zip_longest(wanted, done):
        if then is None or now is None:
            found.append(f"never before: {now}" if then is None else f"missing: {then}")
        elif then[1] != now[1] or abs(then[0] - now[0]) > GRACE + 1e-9:
            found.append(f"{then} is now {now}")
    return found


def _done(name: str) -> tuple[str, list[Deed]]:
    session = load(find(name), Session)
    prepared = prepare(session, name)
    with tempfile.TemporaryDirectory() as folder:
        return name, deeds(run(session, prepared, simulate(prepared), Path(folder)).events)


def write() -> None:
    """Run every bundled session and keep what it did."""
    everything = dict(done for _, done in spread(_done, sorted(bundled("sessions")), workers=2))
    lines = [f"{json.dumps(name)}: {json.dumps(everything[name])}" for name in sorted(everything)]
    FILE.write_text("{\n" + ",\n".join(lines) + "\n}\n", encoding="utf-8")


if __name__ == "__main__":
    write()
