"""What a report needs of a recording, gathered in one pass: in memory that does not grow with the recording's length."""

import math
from collections.abc import Iterator
from itertools import pairwise
from typing import Any, NamedTuple

import msgspec
import numpy as np
from numpy.typing import NDArray

from app.log.layout import PULL, WORDS
from app.log_reading.playback import pull_of
from app.log_reading.reader import Log
from pendant.guided.pull import PullCauses
from pendant.limits.parameters import PARAMETERS
from pendant.tick.modes import TICK, TICK_RATE

Array = NDArray[np.float64]

HELD = TICK_RATE // 2
"""A force counts as quasi-static when it lasts for so many ticks, 0.5 s."""

POINTS = 1500
"""Most points of a line."""

STRETCH = 30.0
"""Of a recording that is gone through [s]."""

COLUMNS = 200
"""Stretches of the run in the chart of what pulls at the arm: each some pixels wide."""


class Span(msgspec.Struct, frozen=True):
    """A state and the time that it lasted."""

    name: str
    begin: float  # [s]
    end: float  # [s]


class Peak(msgspec.Struct, frozen=True):
    """The largest of a quantity."""

    value: float
    t: float  # [s]


class Nearest(NamedTuple):
    """A monitored value where it came nearest to its limit, or was most above it."""

    share: float
    value: float
    limit: float
    t: float  # [s]


class Column(NamedTuple):
    """A stretch of time in which the arm is free somewhere."""

    begin: float  # [s]
    end: float
    pull: PullCauses


class PeakSeen:
    """The first largest value so far; what is not a number is none."""

    def __init__(self) -> None:
        self.found = Peak(0.0, 0.0)
        self._largest: float | None = None

    def see(self, values: Array, t: Array) -> None:
        """Take in values, (k,), at their times."""
        if not len(values):
            return
        numbers = np.nan_to_num(values, nan=-math.inf)
        k = int(np.argmax(numbers))
        if self._largest is None or numbers[k] > self._largest:
            self._largest, self.found = float(numbers[k]), Peak(float(values[k]), float(t[k]))


class HeldSeen:
    """The largest value that was there for `HELD` ticks without a break, and when that began."""

    def __init__(self) -> None:
        self._peak = PeakSeen()
        self._values, self._t = np.zeros(0), np.zeros(0)  # the last ones, which more may follow

    def see(self, values: Array, t: Array) -> None:
        """Take in values, (k,), at their times."""
        self._values, self._t = np.concatenate((self._values, values)), np.concatenate((self._t, t))
        if len(self._values) >= HELD:
            windows = np.lib.stride_tricks.sliding_window_view(self._values, HELD)
            self._peak.see(windows.min(axis=1), self._t[: len(windows)])
            self._values, self._t = self._values[1 - HELD :], self._t[1 - HELD :]

    @property
    def found(self) -> Peak:
        """It, and when it began."""
        return self._peak.found


class SpansSeen:
    """Runs of equal codes."""

    def __init__(self, words: tuple[str, ...]) -> None:
        self._words = words
        self._spans: list[list[Any]] = []  # code, begin, end

    def see(self, codes: NDArray[Any], t: Array) -> None:
        """Take in codes, (k,), at their times."""
        edges = [0, *(np.flatnonzero(np.diff(codes)) + 1).tolist(), len(codes)]
        for a, b in pairwise(edges):
            code, begin, last = int(codes[a]), float(t[a]), float(t[b - 1])
            if self._spans and self._spans[-1][0] == code:
                self._spans[-1][2] = last
                continue
            if self._spans:
                self._spans[-1][2] = begin
            self._spans.append([code, begin, last])

    @property
    def found(self) -> list[Span]:
        """All of them; each ends where the next one begins."""
        return [Span(self._words[code], round(begin, 6), round(end, 6)) for code, begin, end in self._spans]


class LineSeen:
    """At most about `POINTS` points of a line; of each stretch the largest is kept, at its own time."""

    def __init__(self, length: int) -> None:
        self._step = max(1, -(-length // POINTS))
        self._t, self._values = np.zeros(0), np.zeros(0)  # of the stretch that is not whole yet
        self._points: list[tuple[Array, Array]] = []

    def see(self, values: Array, t: Array) -> None:
        """Take in values, (k,), at their times."""
        self._t, self._values = np.concatenate((self._t, t)), np.concatenate((self._values, values))
        whole = len(self._t) // self._step * self._step
        blocks = np.nan_to_num(self._values[:whole], nan=0.0).reshape(-1, self._step)
        at = blocks.argmax(axis=1) + self._step * np.arange(len(blocks))
        self._points.append((self._t[at], self._values[at]))
        self._t, self._values = self._t[whole:], self._values[whole:]

    @property
    def found(self) -> tuple[Array, Array]:
        """Times and values."""
        points = [*self._points, (self._t, self._values)]
        return np.concatenate([t for t, _ in points]), np.concatenate([values for _, values in points])


def thinned(t: Array, values: Array) -> tuple[Array, Array]:
    """A whole line at once, as `LineSeen`."""
    line = LineSeen(len(t))
    line.see(values, t)
    return line.found


class PullsSeen:
    """The pull of the tick that is least a hand's, in `COLUMNS` stretches of the run; those without free-drive are left out.

    A payload that falls ends free-drive within some ticks: in one of so many stretches they are wide enough to be seen.
    """

    def __init__(self, length: int) -> None:
        count = min(COLUMNS, length)
        sizes = [length // count + (k < length % count) for k in range(count)] if count else []
        self._ends = np.cumsum(sizes)
        self._done = 0  # rows
        self._best: dict[int, tuple[float, dict[str, float]]] = {}  # of a stretch: the doubt, and what pulled then
        self._spans: dict[int, list[float]] = {}

    def see(self, log: Log, t: Array) -> None:
        """Take in a part of the recording."""
        state = {name: log.state[name] for name in PULL}
        free = np.isfinite(state["felt"])
        doubt = np.fmax(np.nan_to_num(state["lost_odds"], nan=-np.inf), np.nan_to_num(state["step_odds"], nan=-np.inf))
        begin = 0
        while begin < len(t):
            column = int(np.searchsorted(self._ends, self._done + begin, side="right"))
            end = min(len(t), int(self._ends[column]) - self._done)
            self._spans.setdefault(column, [float(t[begin]), 0.0])[1] = float(t[end - 1])
            rows = begin + np.flatnonzero(free[begin:end])
            if len(rows):
                row = int(rows[doubt[rows].argmax()])
                if column not in self._best or doubt[row] > self._best[column][0]:
                    self._best[column] = (float(doubt[row]), {name: float(values[row]) for name, values in state.items()})
            begin = end
        self._done += len(t)

    @property
    def found(self) -> list[Column]:
        """In the order of time."""
        columns: list[Column] = []
        for column, (_, state) in sorted(self._best.items()):
            pull = pull_of(state)
            assert pull is not None
            begin, end = self._spans[column]
            columns.append(Column(begin - TICK, end, pull))
        return columns


class Gathered:
    """Of a whole recording. SI units."""

    def __init__(self, log: Log) -> None:
        length = len(log)
        self.log = log
        self.end = 0.0  # [s]
        self.tcp_speed, self.elbow_speed, self.joint_speed = PeakSeen(), PeakSeen(), PeakSeen()
        self.force_peak, self.force_held = PeakSeen(), HeldSeen()  # true, where the recording has it
        self.on_tool, self.on_link = PeakSeen(), PeakSeen()  # true
        self.told_tool, self.told_link = PeakSeen(), PeakSeen()  # as the controller estimates it
        self.truth_known = False  # whether the true forces are recorded
        self.modes, self.phases = SpansSeen(WORDS["mode"]), SpansSeen(WORDS["phase"])
        self.worst: dict[str, Nearest] = {}
        self.checked = dict.fromkeys(PARAMETERS, 0)  # ticks in which each is
        self.touched: dict[float, list[float]] = {1.0: [], -1.0: []}  # times at which a touch begins, and ends
        self.configured, self.payload = 0.0, 0.0  # at the end [kg]
        self.lines = {name: LineSeen(length) for name in ("tcp", "elbow", "force", "true")}  # speeds [mm/s], forces [N]
        self.torques = {joint: LineSeen(length) for joint in log.arm.chain.joints}  # external, sizes [N·m]
        self.shares = {name: LineSeen(length) for name in PARAMETERS}
        self.pulls = PullsSeen(length)
        self._touch: float | None = None
        for part in log.stretches(STRETCH):
            self._see(part)

    def _see(self, part: Log) -> None:
        state, t = part.state, part.t
        force = np.linalg.norm(state["F_user"][:, :3], axis=1)
        tool, link = part.truth["contact_tool"], part.truth["contact_link"]
        self.truth_known = self.truth_known or bool(np.isfinite(tool).any())
        true = np.fmax(tool, link) if self.truth_known else force
        self.on_tool.see(tool, t)
        self.on_link.see(link, t)
        self.told_tool.see(force, t)
        self.told_link.see(state["link_force"], t)
        self.end = float(t[-1])
        self.tcp_speed.see(state["v_tcp"], t)
        self.elbow_speed.see(state["v_elbow"], t)
        self.joint_speed.see(np.abs(state["qd"]).max(axis=1, initial=0.0), t)
        self.force_peak.see(true, t)
        self.force_held.see(true, t)
        self.modes.see(state["mode"], t)
        self.phases.see(state["phase"], t)
        self.configured, self.payload = float(state["configured_mass"][-1]), float(part.truth["payload_mass"][-1])
        self.pulls.see(part, t)
        self.lines["tcp"].see(1000 * state["v_tcp"], t)
        self.lines["elbow"].see(1000 * state["v_elbow"], t)
        self.lines["force"].see(force, t)
        self.lines["true"].see(true, t)
        torque = np.abs(state["tau_ext"])
        for i, joint in enumerate(part.arm.chain.joints):
            self.torques[joint].see(torque[:, i], t)
        self._see_limits(part, t)
        self._see_touches(part.truth["touched"], t)

    def _see_limits(self, part: Log, t: Array) -> None:
        for name in PARAMETERS:
            value, limit = part.state[f"monitored_{name}"], part.state[f"limit_{name}"]
            share = np.abs(value) / np.abs(limit)
            self.shares[name].see(100.0 * np.abs(value / limit), t)
            checked = int(np.isfinite(share).sum())
            self.checked[name] += checked
            if not bool(np.all(np.isnan(share))):
                k = int(np.nanargmax(share))
                if name not in self.worst or share[k] > self.worst[name].share:
                    self.worst[name] = Nearest(float(share[k]), float(value[k]), float(limit[k]), float(t[k]))

    def _see_touches(self, touched: Array, t: Array) -> None:
        before = touched[:1] if self._touch is None else np.array([self._touch])
        edges = np.diff(np.concatenate((before, touched)))
        for way, times in self.touched.items():
            times += t[edges == way].tolist()
        self._touch = float(touched[-1])


def from_event(log: Log, t: float) -> Iterator[Log]:
    """The recording from a time on [s], in parts that are short: who looks for the end of a motion seldom needs more than one."""
    return log.between(t, math.inf).stretches(5.0)
