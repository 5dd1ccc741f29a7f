"""Whether every bundled session does bit for bit the same in two checkouts of the project.

    python -m tools.same_sessions BEFORE AFTER [--out FILE]

runs each session that both have in both, and compares all events (tick, kind, numbers; their texts may be others)
and all recorded ticks: every byte of what a controller knew, and of the truth. The exit code is 1 if anything is different.
"""

import argparse
import hashlib
import json
import os
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import NamedTuple

from mcap.reader import make_reader

RECORDED = ("/state", "/truth")
"""Topics whose messages hold the numbers of each tick."""


class SessionRecord(NamedTuple):
    """What a session did."""

    events: tuple[str, ...]  # tick, kind and numbers of each
    ticks: int  # recorded
    digest: str  # of their bytes


def read(folder: Path) -> SessionRecord:
    """What a run has left in its folder."""
    events: list[str] = []
    for line in (folder / "events.jsonl").read_text(encoding="utf-8").splitlines():
        event = json.loads(line)
        events.append(json.dumps([event["tick"], event["kind"], event["values"]]))
    ticks, digest = 0, hashlib.sha256()
    with (folder / "log.mcap").open("rb") as stream:
        for _, _, message in make_reader(stream).iter_messages(topics=RECORDED):
            digest.update(message.data)
            ticks += 1
    return SessionRecord(tuple(events), ticks // len(RECORDED), digest.hexdigest()[:12])


def ran(checkout: Path, sessions: list[str], out: Path) -> None:
    """Run sessions with a checkout's own code, each into its folder in `out`."""
    command = [sys.executable, "-c", "from app.cli import main; main()", "run", *sessions, "--out", str(out)]
    environment = {**os.environ, "PYTHONPATH": str(checkout)}
    # Its exit code is that of the expectations, which are compared as events are.
    subprocess.run(command, cwd=checkout, env=environment, capture_output=True, check=False)


def differences(before: SessionRecord, after: SessionRecord) -> str:
    """What is not the same, in words; empty if all is."""
    for old, new in zip(before.events, after.events, strict=False):
        if old != new:
            return f"{old} is now {new}"
    if len(before.events) != len(after.events):
        return f"{len(before.events)} events are now {len(after.events)}"
    return "" if before == after else "the recorded numbers are others"


def _commit(checkout: Path) -> str:
    command = ["git", "-C", str(checkout), "describe", "--always", "--dirty", "--exclude=*"]
    return subprocess.run(command, capture_output=True, text=True, check=True).stdout.strip()


def main() -> int:
    """Compare, print and write the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("before", type=Path, help="checkout")
    parser.add_argument("after", type=Path, help="checkout")
    parser.add_argument("--out", type=Path, help="CSV file: a row a session")
    values = parser.parse_args()
    old, new = values.before.resolve(), values.after.resolve()
    names = [{path.stem for path in (each / "assets/sessions").glob("*.yaml")} for each in (old, new)]
    shared = sorted(names[0] & names[1])
    lines = [f"session,events,ticks,digest,{_commit(old)} and {_commit(new)}"]
    others = 0
    with tempfile.TemporaryDirectory() as folder:
        for checkout, name in ((old, "before"), (new, "after")):
            ran(checkout, shared, Path(folder) / name)
        for session in shared:
            before, after = (read(Path(folder) / name / session) for name in ("before", "after"))
            found = differences(before, after)
            others += bool(found)
            lines.append(f'{session},{len(before.events)},{before.ticks},{before.digest},"{found or "same"}"')
            sys.stdout.write(f"{session}: {found or 'same'}\n")
    if values.out is not None:
        values.out.write_text("\n".join(lines) + "\n", encoding="utf-8")
    sys.stdout.write(f"{len(shared) - others} of {len(shared)} sessions are bit for bit the same\n")
    return 1 if others else 0


if __name__ == "__main__":
    sys.exit(main())
