"""Reads a recording by time and topic: opening one takes seconds for an hour, and memory only for what is asked for."""

import copy
import math
from collections.abc import Iterator, Sequence
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from app.files.bad_input import ABSENT, BadInput
from app.log.events_file import EventLine
from app.log_reading.columns import Columns, Stretch
from app.log_reading.integrity import missing, thinning
from app.log_reading.log_file import LogFile, open_log_file
from app.log_reading.picture_list import Frames, Pictures
from pendant.tick.modes import TICK, TICK_RATE
from sim.arm.arm_file import Arm
from sim.arm.scenario import Scenario


class Log:
    """A recorded run, or a part of it. What is in it is read when it is asked for.

    `state` and `truth` have for each name of app.log.layout an array with a row a tick: (k,) or (k, size); `state` the codes too.

    Attributes:
        path: of its file, or of the folder of its files.
        whole: every file has its end.
        missing: what of the run is not there, in words; "" where all of it is.
        thinned: how it was thinned when it was made, in words; "" where it was not.
        run: title, version, robot, seed, hash of the settings.
        events: what happened, in order.
        settings: the tick from which they hold, and all of them by name: those of the beginning, and whenever they changed.
        pictures: what the pendant said, at 60 Hz or as it was thinned.
        frames: poses in W by name, at the ticks of `pictures`.
    """

    def __init__(self, path: Path, files: Sequence[LogFile]) -> None:
        self.path, self._files = path, tuple(files)
        self.whole = all(file.table.whole for file in files)
        self.missing, self.thinned = missing(files), thinning(files[0])
        self.run: dict[str, str] = files[0].run
        self.arm: Arm = files[0].arm
        self.scenario: Scenario = files[0].scenario
        ends = [int(file.ticks.between(len(file.ticks) - 1, len(file.ticks))[0]) for file in files if len(file.ticks)]
        self.events: list[EventLine] = [event for file in files for event in file.events]
        self.settings: list[tuple[int, dict[str, Any]]] = [(each.tick, each.values) for file in files for each in file.settings]
        self._limit(0, max(ends, default=0) + 1)

    def _limit(self, begin: int, end: int) -> None:
        """Have it be the part from tick `begin` to before `end`."""
        self._begin, self._end = begin, end
        stretches = [_stretch(file, begin, end) for file in self._files]
        self._stretches = [each for each in stretches if each.length] or stretches[:1]
        self.state, self.truth = Columns(self._stretches, "state"), Columns(self._stretches, "truth")
        spans = [(file, *np.searchsorted(file.picture_ticks, (begin, end)).tolist()) for file in self._files]
        self.pictures, self.frames = Pictures(spans), Frames(spans)
        self.picture_ticks: NDArray[np.int64] = np.concatenate([file.picture_ticks[a:b] for file, a, b in spans])

    def __len__(self) -> int:
        return sum(each.length for each in self._stretches)

    @property
    def ticks(self) -> NDArray[np.int64]:
        """(k,)."""
        return np.concatenate([each.file.ticks.between(each.begin, each.end) for each in self._stretches])

    @property
    def t(self) -> NDArray[np.float64]:
        """(k,) time of each tick [s]."""
        return np.multiply(self.ticks, TICK, dtype=np.float64)

    @property
    def last_tick(self) -> int:
        """Of the rows; 0: there is none."""
        last = self._stretches[-1]
        return int(last.file.ticks.between(last.end - 1, last.end)[0]) if last.length else 0

    def row_of(self, tick: int) -> int:
        """The row of a tick, or of the first one after it; the number of rows where there is none."""
        at = 0
        for each in self._stretches:
            row = int(each.file.ticks.at_or_before(np.array([tick - 1]))[0]) + 1
            if row < each.end:
                return at + max(0, row - each.begin)
            at += each.length
        return at

    def between(self, begin: float, end: float) -> "Log":
        """The part from time `begin` to before `end` [s]."""
        return self._part(round(begin * TICK_RATE), self._end if math.isinf(end) else round(end * TICK_RATE))

    def stretches(self, seconds: float) -> Iterator["Log"]:
        """One part after the other: who goes through a long recording so needs memory for one of them."""
        step = max(1, round(seconds * TICK_RATE))
        for begin in range(self._begin, self._end, step):
            part = self._part(begin, begin + step)
            if len(part):
                yield part

    def _part(self, begin: int, end: int) -> "Log":
        begin, end = max(self._begin, begin), max(self._begin, min(self._end, end))
        part = copy.copy(self)
        part._limit(begin, end)
        part.events = [each for each in self.events if begin <= each.tick < end]
        before = [each for each in self.settings if each[0] < begin]
        part.settings = before[-1:] + [each for each in self.settings if begin <= each[0] < end]
        return part


def read(path: Path, begin: float | None = None, end: float | None = None) -> Log:
    """Open a recording, or a part of it.

    Args:
        path: of its file; or of a folder: its files in the order of their names are one recording.
        begin: time of the first tick [s]; None: from the beginning.
        end: time before which the last tick is [s]; None: to the end.

    Raises:
        BadInput: it cannot be read, is no recording of ours, or is damaged where it says what is in it. What is damaged elsewhere
            is found when it is asked for, and raises the same.
    """
    files = [open_log_file(each) for each in files_of(path)]
    _must_follow(path, files)
    log = Log(path, files)
    return log if begin is None and end is None else log.between(begin or 0.0, math.inf if end is None else end)


def files_of(path: Path) -> list[Path]:
    """The files of a recording. Raises BadInput: a folder has none."""
    if not path.is_dir():
        return [path]
    found = sorted(path.glob("*.mcap"))
    if not found:
        raise BadInput(str(path), "", ABSENT, "expected a recording, or a folder with the files of one")
    return found


def _must_follow(path: Path, files: Sequence[LogFile]) -> None:
    """Raise BadInput where files are not parts of one recording, in order."""
    for before, after in pairwise(files):
        alike = before.run.get("recording"), after.run.get("recording")
        if alike[0] is None or alike[0] != alike[1]:
            raise BadInput(str(path), "", after.path.name, f"another part of the recording that {before.path.name} begins")
        if len(before.ticks) and len(after.ticks):
            last = int(before.ticks.between(len(before.ticks) - 1, len(before.ticks))[0])
            if int(after.ticks.between(0, 1)[0]) <= last:
                raise BadInput(str(path), "", after.path.name, f"a part that follows {before.path.name}")


def _stretch(file: LogFile, begin: int, end: int) -> Stretch:
    low, high = file.ticks.at_or_before(np.array([begin - 1, end - 1])) + 1
    return Stretch(file, int(low), max(int(low), int(high)))
