"""Guided demonstrations in a recording: each path along which a hand led the arm, as rows at an even rate."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from app.files.bad_input import BadInput
from app.log.layout import WORDS
from app.log_reading.reader import Log
from pendant.tick.modes import TICK_RATE, Mode, Phase

LEAST = TICK_RATE // 2
"""Least ticks of a demonstration, 0.5 s: a shorter path is only a nudge."""

_FREE = WORDS["mode"].index(Mode.FREE_DRIVE.value)
_GUIDED, _HELD = (WORDS["phase"].index(phase.value) for phase in (Phase.GUIDED, Phase.HELD))


@dataclass(frozen=True, slots=True)
class Demonstration:
    """One guided path, k rows for n joints. It has only what the controller knew, not the truth of the recording."""

    recording: str  # name of its file
    rows: NDArray[np.intp]  # (k,) rows of the recording's arrays
    ticks: NDArray[np.int64]  # (k,) of the recording
    angles: NDArray[np.float32]  # (k, n) [rad]
    speeds: NDArray[np.float32]  # (k, n) [rad/s]
    wrench: NDArray[np.float32]  # (k, 6) the user's on the flange, axes of B [N, N·m]
    position: NDArray[np.float32]  # (k, 3) of the flange in B [m]
    path: NDArray[np.float32]  # (k, n) joint angles of the next row, to which the hand led the arm [rad]
    events: list[str]  # (k) kinds of the events since the row before, with a space between; "" for none


def demonstrations(log: Log, rate: int) -> list[Demonstration]:
    """The guided paths of a recording, in the order of time.

    A path begins with the first tick in which a hand moves the freed arm, and ends with the last such tick before free-drive
    ends, whether the button is held or not. Pauses between them belong to the path.

    Args:
        log: the recording.
        rate: rows a second; it divides the rate of the ticks.

    Raises:
        BadInput: `rate` does not divide the rate of the ticks.
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
    """The first row of each guided path, and the row after its last row."""
    free = log.state["mode"] == _FREE
    guided = free & ((log.state["phase"] == _GUIDED) | ((log.state["phase"] == _HELD) & _moving(log)))
    # A stay in free-drive ends where the mode changes, and where ticks are missing.
    borders = np.flatnonzero((np.diff(free.astype(np.int8)) != 0) | (np.diff(log.ticks) != 1)) + 1
    stays = zip([0, *borders.tolist()], [*borders.tolist(), free.size], strict=True)
    ways = []
    for begin, end in stays:
        moved = begin + np.flatnonzero(guided[begin:end])
        if moved.size:
            ways.append((int(moved[0]), int(moved[-1]) + 1))
    return ways


def _moving(log: Log) -> NDArray[np.bool_]:
    """Rows in which the arm is faster than the limit for moving it by hand (FD-13). While the button is held, no phase shows
    this."""
    settings = log.settings[0][1]
    flange, joint = (float(settings[f"limits.maintain.{name}.max"]) for name in ("flange_speed", "joint_speed"))
    fast = np.linalg.norm(log.state["v_F"][:, :3], axis=1) > flange
    return fast | (np.abs(log.state["qd"]).max(axis=1) > joint)


def _taken(log: Log, rows: NDArray[np.intp]) -> Demonstration:
    """Make a demonstration of these rows. The last row is only the target of the row before it."""
    here, state = rows[:-1], log.state
    ticks = log.ticks[here]
    kinds: list[list[str]] = [[] for _ in here]
    for event in log.events:
        # An event belongs to the first row after it; events before and after the path are left out.
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
