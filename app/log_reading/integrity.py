"""Whether a recording is whole: what of it is missing, in words."""

from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from app.log_reading.log_file import LogFile
from app.mcap_file.mending import MENDED
from app.mcap_file.runs import Runs
from pendant.tick.modes import TICK, TICK_RATE
from sim.run.loop import SNAPSHOT_TICKS

ENOUGH = 0.98
"""Share of the pictures that are always there: each start over in a recording may cost one."""


def missing(files: Sequence[LogFile]) -> str:
    """What is missing of a recording, in words, or ""."""
    alone = len(files) == 1
    said = [words if alone else f"of {file.path.name} {words}" for file in files if (words := _of_file(file, alone))]
    for before, after in pairwise(files):
        gap = _first(after.state.ticks) - _last(before.state.ticks) - _every(after, "state")
        if gap > 0:
            said.append(f"{gap * TICK:.2f} s between {before.path.name} and {after.path.name} are not")
    return "; ".join(said)


def thinning(file: LogFile) -> str:
    """How a recording was thinned when it was made, in words, or ""."""
    rates = [f"/{topic} {TICK_RATE / int(every):g} times" for topic, every in file.rates.items()]
    return f"as was asked for, a second is in it {', '.join(rates)}" if rates else ""


def _of_file(file: LogFile, alone: bool) -> str:
    state, said = file.state.ticks, list[str]()
    begin = 1 if file.run.get("part", "1") == "1" else _first(state)
    last = _last(state)
    end = last * TICK
    if file.table.lost >= 0:
        said.append(f"it is cut after {end:.2f} s, where {file.table.lost} bytes of an unfinished chunk follow")
    mended = file.table.notes.get(MENDED, {}).get("lost", "")
    if mended:
        said.append(f"it was cut and mended: {mended} bytes of an unfinished chunk were left out after {end:.2f} s")
    planned = file.run.get("planned", "")
    if planned and alone and end < float(planned) - TICK:
        said.append(f"{end:.2f} s of {float(planned):g} s are there")
    for name, ticks in (("state", state), ("truth", file.truth.ticks)):
        every = _every(file, name)
        expected = max(0, (last - begin) // every + 1)
        gone = expected - _within(ticks, last)
        if gone > 0:
            said.append(f"{gone} of {expected} ticks of /{name} ({gone * every / TICK_RATE:.2f} s) are not")
    drawn = max(0, last - begin + 1) // int(file.rates.get("pictures", f"{SNAPSHOT_TICKS}"))
    for name, messages in (("pendant", file.pictures), ("tf", file.frames)):
        if len(messages) < ENOUGH * drawn - 1:
            said.append(f"{drawn - len(messages)} of {drawn} pictures of /{name} are not")
    return "; ".join(said)


def _every(file: LogFile, topic: str) -> int:
    return int(file.rates.get(topic, "1"))


def _within(ticks: Runs, last: int) -> int:
    """How many are not after a tick."""
    return int(ticks.at_or_before(np.array([last]))[0]) + 1


def _first(ticks: Runs) -> int:
    return int(ticks.between(0, 1)[0]) if len(ticks) else 0


def _last(ticks: Runs) -> int:
    return int(ticks.between(len(ticks) - 1, len(ticks))[0]) if len(ticks) else 0
