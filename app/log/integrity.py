"""Whether a recording is whole: what of it is missing, in words, and what it cannot do without."""

from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from app.log.layout import WORDS
from pendant.tick.modes import TICK, TICK_RATE
from sim.arm.arm_file import Arm
from sim.arm.scenario import Scenario
from sim.run.loop import SNAPSHOT_TICKS

ENOUGH = 0.98
"""Share of the pictures that are always there: each start over in a recording may cost one."""

MENDED = "mended"
"""Name of the note that a repair leaves in a file."""


class Contents(NamedTuple):
    """What was read."""

    state: NDArray[np.int64]  # ticks of /state
    truth: NDArray[np.int64]  # and of /truth
    codes: Mapping[str, NDArray[Any]]
    pictures: Sequence[int]  # ticks of /pendant
    frames: Sequence[Mapping[str, Any]]  # of /tf, by name


def refusal(found: Contents, arm: Arm, scenario: Scenario) -> str:
    """Why it can be shown by nobody, in a clause, or ""."""
    for name, ticks in (("/state", found.state), ("/truth", found.truth)):
        if len(ticks) and (ticks[0] < 1 or not bool(np.all(np.diff(ticks) > 0))):
            return f"the ticks of {name} do not rise"
    for name, words in WORDS.items():
        if len(found.codes[name]) and int(found.codes[name].max()) >= len(words):
            return f"/state has a {name} that does not exist"
    if any(b <= a for a, b in zip(found.pictures, found.pictures[1:], strict=False)):
        return "the ticks of /pendant do not rise"
    needed = {"foot", *arm.chain.joints, "flange", *(f"object {thing.name}" for thing in scenario.world)}
    for frames in found.frames:
        if not needed <= frames.keys():
            return f"/tf lacks {', '.join(sorted(needed - frames.keys()))}"
    return ""


def missing(found: Contents, lost: int, mended: str, planned: str) -> str:
    """What is missing of a recording, in words, or "".

    Args:
        found: what was read.
        lost: bytes at its end that are no whole chunk; -1: the end is there.
        mended: bytes that a repair left out; "" where nothing was repaired.
        planned: how long the session was to last [s]; "" where nobody knows.
    """
    said: list[str] = []
    end = float(found.state[-1]) * TICK if len(found.state) else 0.0
    if lost >= 0:
        said.append(f"it is cut after {end:.2f} s, where {lost} bytes of an unfinished chunk follow")
    if mended:
        said.append(f"it was cut and mended: {mended} bytes of an unfinished chunk were left out after {end:.2f} s")
    if planned and end < float(planned) - TICK:
        said.append(f"{end:.2f} s of {float(planned):g} s are there")
    for name, ticks in (("state", found.state), ("truth", found.truth)):
        expected = int(found.state[-1]) if len(found.state) else 0
        gone = expected - len(np.intersect1d(ticks, found.state))
        if gone:
            said.append(f"{gone} of {expected} ticks of /{name} ({gone / TICK_RATE:.2f} s) are not")
    drawn = len(found.state) // SNAPSHOT_TICKS
    for name, count in (("pendant", len(found.pictures)), ("tf", len(found.frames))):
        if count < ENOUGH * drawn - 1:
            said.append(f"{drawn - count} of {drawn} pictures of /{name} are not")
    return "; ".join(said)
