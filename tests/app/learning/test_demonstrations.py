from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from app.files.bad_input import BadInput
from app.learning.demonstrations import LEAST, demonstrations
from app.log.layout import WORDS
from app.log_reading.reader import Log, read


@pytest.fixture(scope="module")
def log(led: Path) -> Log:
    return read(led)


def test_each_way_that_a_hand_led_the_arm_is_one(log: Log) -> None:
    ways = demonstrations(log, 25)
    assert len(ways) == 2
    assert [each.recording for each in ways] == ["log.mcap"] * 2
    for way, seconds in zip(ways, (1.2, 0.8), strict=True):
        assert (way.ticks[-1] - way.ticks[0]) / 500 == pytest.approx(seconds, abs=0.35)
        assert set(np.diff(way.ticks)) == {20}
    first, second = ways
    assert first.ticks[-1] < second.ticks[0]


def test_numbers_are_those_that_the_controller_knew(log: Log) -> None:
    way = demonstrations(log, 50)[0]
    rows = np.searchsorted(log.ticks, way.ticks)
    np.testing.assert_array_equal(way.angles, log.state["q"][rows].astype(np.float32))
    np.testing.assert_array_equal(way.speeds, log.state["qd"][rows].astype(np.float32))
    np.testing.assert_array_equal(way.wrench, log.state["F_user"][rows].astype(np.float32))
    np.testing.assert_array_equal(way.position, log.state["p_BF"][rows].astype(np.float32))
    assert not np.array_equal(way.angles, log.truth["q"][rows].astype(np.float32))


def test_the_action_is_where_the_hand_had_led_the_joints_by_the_next_row(log: Log) -> None:
    way = demonstrations(log, 50)[0]
    np.testing.assert_array_equal(way.path[:-1], way.angles[1:])
    after = np.searchsorted(log.ticks, way.ticks[-1] + 10)
    np.testing.assert_array_equal(way.path[-1], log.state["q"][after].astype(np.float32))
    assert float(np.abs(way.path - way.angles).max()) > 0.001


def test_events_stand_at_the_row_by_which_they_had_happened(log: Log) -> None:
    for way in demonstrations(log, 25):
        seen = [(event.tick, event.kind) for event in log.events if way.ticks[0] - 20 < event.tick <= way.ticks[-1]]
        assert seen
        for tick, kind in seen:
            row = int(np.flatnonzero(way.ticks >= tick)[0])
            assert kind in way.events[row].split()
        assert sum(len(each.split()) for each in way.events) == len(seen)


def test_who_only_stands_by_demonstrates_nothing(idle: Path) -> None:
    assert demonstrations(read(idle), 25) == []


def changed(log: Log, ticks: Any = None, **state: Any) -> Any:
    """The recording with another column, or with other ticks."""
    ticks = log.ticks if ticks is None else ticks
    return SimpleNamespace(path=log.path, events=log.events, settings=log.settings, ticks=ticks, state={**log.state, **state})


def test_a_nudge_is_no_demonstration(log: Log) -> None:
    first = demonstrations(log, 500)[0].ticks[0]
    begin = int(np.searchsorted(log.ticks, first))
    for length, found in ((LEAST - 1, 0), (LEAST + 1, 1)):
        phase = log.state["phase"].copy()
        phase[begin + length :] = 0
        assert len(demonstrations(changed(log, phase=phase), 500)) == found


def test_a_way_counts_while_the_button_is_held(log: Log) -> None:
    """The phase says then that the button is held, and not that somebody moves the arm."""
    way = demonstrations(log, 25)[0]
    within = (log.ticks >= way.ticks[0] - 100) & (log.ticks <= way.ticks[-1] + 300)
    phase = log.state["phase"].copy()
    phase[within] = WORDS["phase"].index("HELD")
    again = demonstrations(changed(log, phase=phase), 25)[0]
    assert abs(int(again.ticks[0] - way.ticks[0])) < 60
    assert abs(int(again.ticks[-1] - way.ticks[-1])) < 150


def test_ticks_that_are_missing_end_a_way(log: Log) -> None:
    way = demonstrations(log, 25)[0]
    ticks = log.ticks
    ticks[int(np.searchsorted(ticks, (way.ticks[0] + way.ticks[-1]) // 2)) :] += 5
    assert len(demonstrations(changed(log, ticks=ticks), 25)) == 3


@pytest.mark.parametrize("rate", [0, -5, 30, 501])
def test_rows_fall_on_ticks(log: Log, rate: int) -> None:
    with pytest.raises(BadInput, match=r"rate = .*divide 500: 1, 2, 4, 5, 10, 20, 25, 50"):
        demonstrations(log, rate)
