from collections.abc import Iterator
from html import escape
from pathlib import Path
from typing import Any

import msgspec
import numpy as np
import pytest

from app.files.checked import BadInput, convert
from app.files.library import load_arm, mesh_path
from app.log.recorded_messages import PendantMessage
from app.log.recorder import Recorder
from app.log_reading.playback import Player, snapshot_at, user_at
from app.log_reading.reader import Log, read
from app.runs.runner import simulate
from app.session.prepare import prepare
from app.session.session_file import Session
from app.session.timeline import Timeline
from app.web.access.listening import HERE
from app.web.recordings.event_marks import moment
from app.web.replay import Replay
from pendant.tick.modes import Mode
from sim.exchange.snapshot import Snapshot
from tests.app.web.raw_client import until

SESSION: dict[str, Any] = {
    "title": "played",
    "duration": 1.0,
    "settings": {"activation.period": 0.1, "sequence.period": 0.25},
    "payload_true": {"mass": 1.0},
    "payload_configured": {"mass": 1.0},
    "world": "table",
    "timeline": [
        {"at": 0.5, "do": "press", "control": "free_drive"},
        {"at": 0.9, "do": "push", "for": 0.2, "force": [3.0, -4.0, 0.0]},
    ],
}


@pytest.fixture(scope="module")
def played(tmp_path_factory: pytest.TempPathFactory) -> tuple[Log, dict[int, Snapshot]]:
    return play(SESSION, tmp_path_factory.mktemp("played") / "log.mcap", 500)


def play(content: dict[str, Any], path: Path, ticks: int) -> tuple[Log, dict[int, Snapshot]]:
    """A log, and every snapshot of its run."""
    session = convert(content, Session, "s.yaml")
    prepared = prepare(session, "s.yaml")
    simulation = simulate(prepared)
    timeline = Timeline(session.timeline, prepared.arm.chain.joints)
    seen: dict[int, Snapshot] = {}
    with Recorder(path, simulation, "played") as recorder:
        for tick in range(1, ticks + 1):
            decision = simulation.tick(timeline.wishes(tick, simulation.snapshot))
            timeline.see(tick, decision)
            recorder.see(simulation, decision)
            seen[tick] = simulation.snapshot()
    return read(path), seen


@pytest.fixture
def player(played: tuple[Log, dict[int, Snapshot]]) -> Player:
    return Player(played[0])


def test_time_runs_while_it_plays_and_stops_at_the_end(player: Player) -> None:
    player.advance(0.3)
    assert player.time == 0.0
    player.playing, player.speed = True, 2.0
    player.advance(0.25)
    assert player.time == pytest.approx(0.5)
    player.advance(9.0)
    assert (player.time, player.playing) == (1.0, False)
    player.jump(-3.0)
    assert player.time == 0.0


@pytest.mark.parametrize(("time", "row", "picture"), [(0.0, 0, 0), (0.002, 0, 0), (0.018, 8, 1), (0.017, 7, 0), (1.0, 499, 62)])
def test_a_time_has_its_tick_and_its_picture(player: Player, time: float, row: int, picture: int) -> None:
    player.jump(time)
    assert (player.row, player.picture) == (row, picture)
    assert player.log.pictures[picture].tick == 8 * picture + 1


def test_a_snapshot_comes_back_as_it_was(played: tuple[Log, dict[int, Snapshot]]) -> None:
    log, seen = played
    for picture in (0, 40, 57, 60):
        tick = 8 * picture + 1
        found, was = snapshot_at(log, picture, tick - 1), seen[tick]
        np.testing.assert_array_equal(found.truth_links, was.truth_links)
        np.testing.assert_array_equal(found.truth_objects, was.truth_objects)
        assert was.truth_payload is not None
        assert found.truth_payload is not None
        np.testing.assert_array_equal(found.truth_payload, was.truth_payload)
        for name in ("q", "tau_ext", "F_user", "v_F"):
            np.testing.assert_array_equal(getattr(found.estimate, name), getattr(was.estimate, name))
        for name in ("mode", "phase", "safety", "periods", "gain"):
            assert getattr(found.decision, name) == getattr(was.decision, name)
        assert (found.tick, found.truth_payload_mass, found.configured_mass) == (tick, 1.0, 1.0)
        assert found.touches == was.touches
        assert found.decision.pull == found.pull == was.decision.pull
        if picture >= 57:
            assert found.user is not None
            assert was.user is not None
            assert (found.user.force, found.user.at) == (was.user.force, was.user.at)
            assert was.user.covariance is not None, "a push is no step of the sensor"
            np.testing.assert_array_equal(found.user.covariance, was.user.covariance)
        else:
            assert found.user is was.user is None
    assert any(each.touches for each in log.pictures)


GRIPPED: dict[str, Any] = {
    "title": "gripped",
    "duration": 1.0,
    "tool": "two-finger",
    "world": [
        {"kind": "free-cylinder", "name": "can", "position": [-0.9, 0.3, 0.05], "radius": 0.03, "height": 0.1, "mass": 0.5}
    ],
    "timeline": [{"at": 0.02, "do": "gripper", "command": "close", "force": 40.0}],
}


def test_the_gripper_comes_back_with_its_fingers_where_they_were(tmp_path: Path) -> None:
    log, seen = play(GRIPPED, tmp_path / "log.mcap", 200)
    found = [snapshot_at(log, picture, 8 * picture).gripper for picture in range(len(log.pictures))]
    assert found == [seen[8 * picture + 1].gripper for picture in range(len(log.pictures))]
    openings = [each.opening for each in found if each is not None]
    assert openings[-1] < openings[0]


def test_a_recording_from_before_the_users_force_came_has_none(played: tuple[Log, dict[int, Snapshot]]) -> None:
    said = msgspec.to_builtins(played[0].pictures[57])
    assert user_at(msgspec.convert(said, PendantMessage)) is not None
    del said["user"]
    assert user_at(msgspec.convert(said, PendantMessage)) is None


def test_a_log_without_a_tick_is_refused(played: tuple[Log, dict[int, Snapshot]]) -> None:
    with pytest.raises(BadInput, match="holds no tick"):
        Player(played[0].between(5.0, 6.0))


@pytest.fixture
def replay(player: Player) -> Iterator[Replay]:
    parts = ("foot", *player.log.arm.chain.joints)
    shown = Replay(player, {part: mesh_path(load_arm("ur5e"), part).read_bytes() for part in parts}, HERE, 0)
    yield shown
    shown.close()


def test_the_page_follows_the_player(replay: Replay) -> None:
    player = replay.player
    until(lambda: "Time" in replay.facts.shown, "the page shows the start")
    player.jump(0.95)
    until(lambda: replay.time_line.line.value == 0.95, "the time line follows")
    until(lambda: Mode.FREE_DRIVE.replace("_", "-") in replay.light.shown, "the mode is shown")
    player.playing = True
    until(lambda: not player.playing, "it plays to its end")
    assert player.time == player.end


def test_events_are_marks_on_the_time_line_and_rows_that_lead_there(replay: Replay) -> None:
    player, (first, *_, last) = replay.player, replay.player.log.events
    for event in (first, last):
        assert f'data-pd-pick="{escape(moment(event))}"' in replay.time_line.marks.shown
        replay.time_line.marks.choice.value = moment(event)
        until(lambda event=event: player.time == pytest.approx(event.t), "it is gone to")
    assert f"left:{100.0 * last.t / player.end:.2f}%" in replay.time_line.marks.shown


def test_a_plot_marks_the_time(replay: Replay) -> None:
    replay.player.jump(0.5)
    replay._mark()
    handle, data = replay._series[0]
    spike = np.asarray(handle.data[-1])
    assert data[0][int(spike.argmax())] == pytest.approx(0.5, abs=0.01)
    assert np.count_nonzero(spike) == 1


def test_replay_says_in_a_line_what_it_cannot_show(tmp_path: Path) -> None:
    from app.serving import replay_until_interrupted

    (tmp_path / "x.mcap").write_bytes(b"no log")
    for name, says in (("x.mcap", "is no MCAP file"), ("none.mcap", "none.mcap")):
        with (
            pytest.raises(BadInput, match=says),
            replay_until_interrupted(tmp_path / name, host="127.0.0.1", port=0, usual=0, open_browser=False),
        ):
            pass
