"""Guided demonstrations in a recording: each way that a hand led the arm, as rows at an even rate."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from app.files.bad_input import BadInput
from app.log.layout import WORDS
from app.log_reading.reader import Log
from pendant.tick.modes import TICK_RATE, Mode, Phase

LEAST = TICK_RATE // 2
"""A way of fewer ticks is a nudge and no demonstration: 0.5 s."""

_FREE = WORDS["mode"].index(Mode.FREE_DRIVE.value)
_GUIDED, _HELD = (WORDS["phase"].index(phase.value) for phase in (Phase.GUIDED, Phase.HELD))


@dataclass(frozen=True, slots=True)
class Demonstration:
    """One way, k rows for n joints. All of it is what the controller knew; the truth of the recording is left out."""

    recording: str  # name of its file
    rows: NDArray[np.intp]  # (k,) rows of the recording's arrays
    ticks: NDArray[np.int64]  # (k,) of the recording
    angles: NDArray[np.float32]  # (k, n) [rad]
    speeds: NDArray[np.float32]  # (k, n) [rad/s]
    wrench: NDArray[np.float32]  # (k, 6) the user's on the flange, axes of B [N, N·m]
    position: NDArray[np.float32]  # (k, 3) of the flange in B [m]
    path: NDArray[np.float32]  # (k, n) where the hand had led the joints by the next row [rad]
    events: list[str]  # (k) kinds of the events since the row before, with a space between; "" for none


def demonstrations(log: Log, rate: int) -> list[Demonstration]:
    """The guided ways of a recording, in the order of time.

    A way begins with the first tick in which somebody moves the freed arm, and ends with the last one before free-drive is left,
    whether the button is held or not; pauses in between belong to it.

    Args:
        log: the recording.
        rate: rows a second; it divides the rate of the ticks.

    Raises:
        BadInput: it does not.
    """
    if rate < 1 or TICK_RATE % rate:
        possible = [each for each in range(1, TICK_RATE + 1) if TICK_RATE % each == 0]
        raise BadInput("export", "rate", rate, f"rows a second that divide {TICK_RATE}: {', '.join(map(str, possible))}")
    step = TICK_RATE // rate
    found = []
    for begin, end in _ways(log):
        rows = np.arange(begin, end, step)
        if end - begin < LEAST or rows.size < 3:
            continue
        found.append(_taken(log, rows))
    return found


def _ways(log: Log) -> list[tuple[int, int]]:
    """First row of each way, and the row after its last."""
    free = log.state["mode"] == _FREE
    guided = free & ((log.state["phase"] == _GUIDED) | ((log.state["phase"] == _HELD) & _moving(log)))
    # A stay ends where the mode does, and where ticks are missing.
    borders = np.flatnonzero((np.diff(free.astype(np.int8)) != 0) | (np.diff(log.ticks) != 1)) + 1
    stays = zip([0, *borders.tolist()], [*borders.tolist(), free.size], strict=True)
    ways = []
    for begin, end in stays:
        moved = begin + np.flatnonzero(guided[begin:end])
        if moved.size:
            ways.append((int(moved[0]), int(moved[-1]) + 1))
    return ways


def _moving(log: Log) -> NDArray[np.bool_]:
    """Where the arm is faster than what counts as moving it by hand (FD-13): while the button is held, no phase says so."""
    settings = log.settings[0][1]
    flange, joint = (float(settings[f"limits.maintain.{name}.max"]) for name in ("flange_speed", "joint_speed"))
    fast = np.linalg.norm(log.state["v_F"][:, :3], axis=1) > flange
    return fast | (np.abs(log.state["qd"]).max(axis=1) > joint)


def _taken(log: Log, rows: NDArray[np.intp]) -> Demonstration:
    """The last row has no next one, and so no path: it is where the one before leads to."""
    here, state = rows[:-1], log.state
    ticks = log.ticks[here]
    kinds: list[list[str]] = [[] for _ in here]
    for event in log.events:
        # The row by which it had happened; what happened before the way, or after it, is no label of it.
        at = int(np.searchsorted(ticks, event.tick))
        if at < len(kinds) and event.tick > ticks[0] - (ticks[1] - ticks[0]):
            kinds[at].append(event.kind)
    return Demonstration(
        log.path.name,
        here,
        ticks,
        state["q"][here].astype(np.float32),
        state["qd"][here].astype(np.float32),
        state["F_user"][here].astype(np.float32),
        state["p_BF"][here].astype(np.float32),
        state["q"][rows[1:]].astype(np.float32),
        [" ".join(each) for each in kinds],
    )
