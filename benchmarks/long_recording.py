"""Recordings that are long: an hour with everything, and a day that is thinned and in files; read, summarised, replayed.

Each is one recorded minute again and again, with other ticks. What is measured runs in a process of its own, for its memory.
"""

import json
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from app.files.checked import convert
from app.log.foxglove import NANOSECONDS
from app.log.layout import CODES, STATE, TRUTH, record, width
from app.log_reading.log_file import LogFile, open_log_file
from app.mcap_file.container import Container
from app.mcap_file.topic_messages import Messages
from app.runs.runner import record as record_session
from app.session.prepare import prepare
from app.session.session_file import Session
from benchmarks.common import Report, main
from pendant.tick.modes import TICK_RATE

MINUTE = 60 * TICK_RATE
MEMORY = 500.0
"""That reading, summarising and replaying may take [MB]."""

START = 5.0
"""Until a replay shows its first picture [s]."""

SIZES = (6, 60)  # [min] of the whole one
DAY = (60, 24 * 60)  # [min] of the thinned one
THINNED = {"state": 50, "truth": 250, "pictures": 400}  # ticks from one message to the next
FILE = 60  # [min] of the thinned one

GUIDED = {
    "title": "a minute",
    "duration": 60.0,
    "world": "table",
    "timeline": [
        {"at": 0.5, "do": "press", "control": "free_drive"},
        *({"at": 3.0 + 2.0 * k, "do": "push", "for": 1.5, "force": [0.0, (-1) ** k * 25.0, 5.0]} for k in range(28)),
    ],
}

READ = """
import json, resource, sys, time
from pathlib import Path
import numpy as np
path, what = Path(sys.argv[1]), sys.argv[2]
begun = time.perf_counter()
if what == "read":
    from app.api import read
    log = read(path)
    opened = time.perf_counter() - begun
    largest = float(np.abs(log.state["F_user"][:, :3]).max())
    part = read(path, log.last_tick / 1000.0, log.last_tick / 1000.0 + 60.0)
    assert len(part.state["q"]) == len(part), "a part by time"
elif what == "summary":
    from app.log_reading.reader import read
    from app.report.files import write_report
    opened = 0.0
    write_report(read(path), Path(sys.argv[3]))
else:
    import urllib.request
    from app.serving import replay_until_interrupted
    import os, signal
    with replay_until_interrupted(path, host="127.0.0.1", port=0, usual=0, open_browser=False) as site:
        with urllib.request.urlopen(site.url) as page:
            assert page.status == 200
        while "Time" not in site.facts.shown:
            time.sleep(0.01)
        opened = time.perf_counter() - begun
        for share in np.linspace(0.0, 1.0, 40):
            site.player.jump(share * site.player.end)
            until = time.monotonic() + 2.0
            wanted = f"{site.player.time:.2f} of"
            while wanted not in site.facts.shown and time.monotonic() < until:
                time.sleep(0.005)
            assert wanted in site.facts.shown, wanted
        os.kill(os.getpid(), signal.SIGTERM)
took = time.perf_counter() - begun
print(json.dumps({"opened": opened, "took": took, "memory": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024}))
"""


def minute(folder: Path, seed: int) -> Path:
    """A recorded minute, in which a hand leads the arm."""
    session = convert({**GUIDED, "seed": seed}, Session, "s.yaml")
    record_session(session, prepare(session, "s.yaml"), folder)
    return folder / "log.mcap"


def prolonged(source: LogFile, path: Path, minutes: range, *, thinned: dict[str, int], part: int) -> None:
    """Write the minute again and again.

    Args:
        source: the minute.
        path: of the file to write.
        minutes: which of the recording.
        thinned: ticks from one message to the next, of topics that have not all.
        part: of the recording; 0: it is all of it.
    """
    out = Container(path, "benchmark")
    table, n = source.table, source.arm.n
    run = source.run if not part else {**source.run, "recording": "day", "part": str(part)}
    out.note("run", {name: text for name, text in run.items() if name != "planned"})
    out.note("words", table.notes["words"])
    if thinned:
        out.note("rates", {topic: str(ticks) for topic, ticks in thinned.items()})
    for name in ("arm.json", "scenario.json"):
        out.attach(name, "application/json", table.attachment(name))
    channels: dict[str, int] = {}
    for channel in table.channels.values():
        schema = table.schemas[channel.schema_id]
        together = channel.topic if channel.message_encoding == "cdr" else "pictures" if channel.topic in DRAWN else "told"
        channels[channel.topic] = out.channel(
            channel.topic,
            schema.name,
            schema.data.decode(),
            encoding=channel.message_encoding,
            of_schema=schema.encoding,
            together=together,
        )
    kinds = {"/state": record(width(STATE, n), len(CODES)), "/truth": record(width(TRUTH, n), 0)}
    block = TICK_RATE if thinned else TICK_RATE // 4
    told = {topic: _told(source, topic, block) for topic in (*DRAWN, "/events", "/log")}
    packed = {topic: Messages(table, topic, NANOSECONDS) for topic in kinds}
    for number in minutes:
        shift = number * MINUTE
        for begin in range(0, MINUTE, block):
            rows = []
            for topic, kind in kinds.items():
                found = packed[topic].rows(begin, begin + block, kind)
                found = found[(found["tick"] - 1 + shift) % thinned.get(topic[1:], 1) == 0]
                found["tick"] += np.uint64(shift)
                found["log_time"] = found["publish_time"] = found["tick"] * np.uint64(NANOSECONDS)
                found["channel"] = channels[topic]
                rows.append(found)
            for topic, messages in told.items():
                every = thinned.get("pictures", 8) // 8 if topic in DRAWN else 1
                for count, tick, content in messages.get(begin // block, ()):
                    if count % every == 0:
                        out.add(channels[topic], (tick + shift) * NANOSECONDS, content)
            out.flush(rows)
    out.close()


DRAWN = ("/tf", "/scene", "/pendant")


def _told(source: LogFile, topic: str, block: int) -> dict[int, list[tuple[int, int, bytes]]]:
    """Messages by the block of ticks in which they are: count, tick, content."""
    messages = Messages(source.table, topic, NANOSECONDS)
    found: dict[int, list[tuple[int, int, bytes]]] = {}
    for count, (tick, content) in enumerate(zip(messages.times.all().tolist(), messages.contents(0, len(messages)), strict=True)):
        found.setdefault((tick - 1) // block, []).append((count, tick, content))
    return found


def measured(path: Path, what: str, out: Path) -> dict[str, float]:
    """What a process of its own says."""
    done = subprocess.run([sys.executable, "-c", READ, str(path), what, str(out)], capture_output=True, text=True, check=False)
    if done.returncode:
        raise RuntimeError(done.stderr)
    return dict(json.loads(done.stdout.strip().splitlines()[-1]))


def measure(report: Report) -> None:
    """Fill the report."""
    length, day = SIZES[report.options.full], DAY[report.options.full]
    with tempfile.TemporaryDirectory() as place:
        folder = Path(place)
        source = open_log_file(minute(folder / "minute", report.options.seed))
        whole, parts = folder / "whole.mcap", folder / "day"
        prolonged(source, whole, range(length), thinned={}, part=0)
        parts.mkdir()
        for part, begin in enumerate(range(0, day, FILE), 1):
            prolonged(source, parts / f"{part:03d}.mcap", range(begin, begin + FILE), thinned=THINNED, part=part)
        report.row("length of the recording with everything", length, "min")
        report.row("its size", whole.stat().st_size / 1e6, "MB")
        report.row("length of the thinned one, in files", day, "min")
        report.row("its size", sum(each.stat().st_size for each in parts.iterdir()) / 1e6, "MB")
        for name, path in (("everything", whole), ("thinned", parts)):
            for what, told in _rows(path, folder):
                report.row(f"{name}, {what}: memory", told["memory"], "MB", at_most=MEMORY)
                report.row(f"{name}, {what}: took", told["took"], "s")
                if what == "read":
                    report.row(f"{name}, {what}: until it is open", told["opened"], "s", at_most=10.0)
                if what == "replay":
                    report.row(f"{name}, {what}: until it is shown", told["opened"], "s", at_most=START)


def _rows(path: Path, folder: Path) -> Iterator[tuple[str, dict[str, Any]]]:
    for what in ("read", "summary", "replay"):
        yield what, measured(path, what, folder / "report")


if __name__ == "__main__":
    main("long_recording", measure)
