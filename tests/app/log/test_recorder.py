"""A recording, read back by the public libraries: mcap itself, ROS 2's decoder, Foxglove's own protobuf schemas."""

import importlib
import math
import random
import threading
import time
from collections import Counter
from pathlib import Path
from typing import Any

import msgspec
import numpy as np
import pytest
from google.protobuf import json_format
from mcap.reader import make_reader
from mcap_ros2.decoder import DecoderFactory

from app.files.checked import BadInput, convert
from app.log import foxglove
from app.log.layout import LATER
from app.log.recorder import AHEAD, BLOCK, SLOW, Recorder
from app.log_reading.playback import Player, snapshot_at
from app.log_reading.reader import Log, read
from app.mcap_file.mending import repair
from app.runs.runner import record, simulate
from app.session.prepare import prepare
from app.session.session_file import Session
from benchmarks import crash
from pendant.inputs import NOTHING
from sim.exchange.desk import Wishes
from tests.app.log.older_recording import older

IDLE = Wishes(NOTHING, (), ())
SESSION: dict[str, Any] = {
    "title": "recorded",
    "duration": 1.5,
    "seed": 3,
    "settings": {"activation.period": 0.1, "sequence.period": 0.25},
    "payload_true": {"mass": 1.0},
    "payload_configured": {"mass": 1.0},
    "world": [{"kind": "box", "name": "table", "position": [0.0, 0.0, -0.5], "size": [1.0, 1.0, 0.1]}],
    "timeline": [
        {"at": 0.1, "do": "press", "control": "free_drive"},
        {"at": 0.2, "do": "settings", "set": {"free_drive.period": 5.0}},
        {"at": 0.8, "do": "push", "for": 0.2, "force": [3.0, -4.0, 0.0]},
    ],
}


@pytest.fixture(scope="module")
def recorded(tmp_path_factory: pytest.TempPathFactory) -> Path:
    out = tmp_path_factory.mktemp("recorded")
    session = convert(SESSION, Session, "s.yaml")
    assert record(session, prepare(session, "s.yaml"), out).events
    return out / "log.mcap"


@pytest.fixture(scope="module")
def log(recorded: Path) -> Log:
    return read(recorded)


def test_the_public_library_finds_every_channel_at_its_rate(recorded: Path) -> None:
    with recorded.open("rb") as file:
        reader = make_reader(file)
        summary = reader.get_summary()
        assert summary is not None
        counts = Counter(channel.topic for _, channel, _ in reader.iter_messages())
        times = [message.log_time for _, _, message in reader.iter_messages(topics=["/state"])]
    assert summary.statistics is not None
    assert summary.statistics.message_count == sum(counts.values())
    assert counts["/state"] == counts["/truth"] == 750
    assert counts["/tf"] == counts["/scene"] == counts["/pendant"] == pytest.approx(1.5 * 500 / 8, abs=1)
    assert counts["/robot"] == 1
    assert counts["/settings"] == 2  # at the start, and as changed
    assert counts["/events"] == counts["/log"] >= 3
    assert times == [2_000_000 * tick for tick in range(1, 751)]
    chunks = Counter(frozenset(channel for channel in each.message_index_offsets) for each in summary.chunk_indexes)
    numbers = {channel.topic: number for number, channel in summary.channels.items()}
    assert chunks[frozenset({numbers["/state"]})] == 7  # the first tick by itself, then quarters of a second
    assert chunks[frozenset({numbers["/truth"]})] == 7
    assert chunks[frozenset({numbers["/pendant"], numbers["/tf"], numbers["/scene"]})] == 7


def test_a_ros_decoder_reads_the_same_numbers(recorded: Path, log: Log) -> None:
    with recorded.open("rb") as file:
        reader = make_reader(file, decoder_factories=[DecoderFactory()])
        for topic, columns in (("/state", log.state), ("/truth", log.truth)):
            rows = [decoded for _, _, _, decoded in reader.iter_decoded_messages(topics=[topic])]
            assert [row.tick for row in rows] == log.ticks.tolist()
            for name, values in columns.items():
                np.testing.assert_array_equal(np.array([getattr(row, name.lower()) for row in rows]), values, err_msg=name)


def _times(value: Any) -> Any:
    """Times as protobuf's JSON has them."""
    if isinstance(value, list):
        return [_times(each) for each in value]
    if not isinstance(value, dict):
        return value
    if set(value) == {"sec", "nsec"}:
        return f"{value['sec']}.{value['nsec']:09d}s"
    return {key: _times(each) for key, each in value.items()}


def _stamped(value: Any) -> Any:
    if isinstance(value, list):
        return [_stamped(each) for each in value]
    if not isinstance(value, dict):
        return value
    found = {key: _stamped(each) for key, each in value.items()}
    if "timestamp" in found:
        found["timestamp"] = "1970-01-01T00:00:00Z"
    return found


@pytest.mark.parametrize(
    ("topic", "name"), [("/tf", "FrameTransforms"), ("/scene", "SceneUpdate"), ("/robot", "SceneUpdate"), ("/log", "Log")]
)
def test_messages_are_what_foxglove_expects(recorded: Path, topic: str, name: str) -> None:
    message_type = getattr(importlib.import_module(f"foxglove_schemas_protobuf.{name}_pb2"), name)
    import jsonschema

    with recorded.open("rb") as file:
        for schema, _, message in make_reader(file).iter_messages(topics=[topic]):
            assert schema is not None
            assert (schema.name, schema.encoding) == (f"foxglove.{name}", "jsonschema")
            content = msgspec.json.decode(message.data)
            jsonschema.validate(content, _strict(msgspec.json.decode(schema.data)))
            json_format.ParseDict(_stamped(_times(content)), message_type())  # refuses what it does not know


def _strict(schema: Any) -> Any:
    """The schema, with nothing missing and nothing more."""
    if isinstance(schema, list):
        return [_strict(each) for each in schema]
    if not isinstance(schema, dict):
        return schema
    found = {key: _strict(each) for key, each in schema.items()}
    if schema.get("type") == "object":
        found |= {"additionalProperties": False, "required": list(schema["properties"])} if "properties" in schema else {}
    return found


def test_the_numbers_are_those_of_the_run(tmp_path: Path) -> None:
    session = convert({**SESSION, "duration": 0.4, "timeline": []}, Session, "s.yaml")
    simulation = simulate(prepare(session, "s.yaml"))
    seen: list[Any] = []
    with Recorder(tmp_path / "log.mcap", simulation, "t") as recorder:
        for _ in range(200):
            recorder.see(simulation, simulation.tick(IDLE))
            seen.append(simulation.snapshot())
    log = read(tmp_path / "log.mcap")
    for name in ("q", "qd", "qdd", "theta", "theta_d", "tau_m", "tau_J", "tau_ext", "friction", "w_sensor", "F_user", "a_F"):
        np.testing.assert_array_equal(log.state[name], [getattr(each.estimate, name) for each in seen], err_msg=name)
    for name in ("p_BF", "v_F", "v_tcp", "v_elbow"):
        np.testing.assert_array_equal(log.state[name], [getattr(each.estimate, name) for each in seen], err_msg=name)
    np.testing.assert_array_equal(log.truth["flange"], [each.truth_links[-1] for each in seen])
    np.testing.assert_array_equal(log.truth["tau_J"], [each.truth_tau_J for each in seen])
    np.testing.assert_allclose(log.truth["friction"], [each.truth_friction for each in seen], rtol=1e-12)
    assert set(log.truth["payload_mass"]) == {1.0}
    np.testing.assert_array_equal(log.frames[3]["elbow"], seen[24].truth_links[3])
    np.testing.assert_array_equal(log.frames[3]["object table"], seen[24].truth_objects[0])


def test_states_events_and_monitored_values_are_there(log: Log) -> None:
    assert log.whole
    assert log.run["title"] == "recorded"
    assert log.scenario.seed == 3
    assert log.arm.name == "ur5e"
    sequence = log.state["phase"] == 2
    assert 120 <= int(sequence.sum()) <= 126
    limit = log.state["limit_flange_speed"]
    assert np.all(limit[sequence] == 0.02)
    assert np.all(np.isnan(limit[~sequence]))
    assert np.all(log.state["valid"] == 7)
    changed = next(event.tick for event in log.events if event.kind == "setting_changed")
    assert log.events[0].kind == "activation_started"
    assert [(tick, values["free_drive.period"]) for tick, values in log.settings] == [(0, 3.0), (changed, 5.0)]
    pushed = log.truth["touch_force"][(log.t > 0.81) & (log.t < 0.99)]
    np.testing.assert_array_equal(pushed, np.tile([3.0, -4.0, 0.0], (len(pushed), 1)))


def test_after_a_reset_the_log_counts_on(tmp_path: Path) -> None:
    prepared = prepare(convert({**SESSION, "timeline": []}, Session, "s.yaml"), "s.yaml")
    first, second = simulate(prepared), simulate(prepared)
    with Recorder(tmp_path / "log.mcap", first, "t") as recorder:
        for simulation in (first, second):
            for _ in range(20):
                recorder.see(simulation, simulation.tick(IDLE))
    assert read(tmp_path / "log.mcap").ticks.tolist() == list(range(1, 41))


def test_a_recording_that_begins_later_counts_from_its_own_start(tmp_path: Path) -> None:
    simulation = simulate(prepare(convert({**SESSION, "timeline": []}, Session, "s.yaml"), "s.yaml"))
    for _ in range(30):
        simulation.tick(IDLE)
    with Recorder(tmp_path / "log.mcap", simulation, "t") as recorder:
        for _ in range(20):
            recorder.see(simulation, simulation.tick(IDLE))
    log = read(tmp_path / "log.mcap")
    assert log.ticks.tolist() == list(range(1, 21))
    assert Player(log).end == pytest.approx(0.04)


def test_a_slow_disk_ends_a_recording_that_must_not_wait(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    simulation = simulate(prepare(convert({**SESSION, "timeline": []}, Session, "s.yaml"), "s.yaml"))
    recorder = Recorder(tmp_path / "log.mcap", simulation, "t", waits=False)
    gate = threading.Event()
    monkeypatch.setattr(recorder._writer, "pack", lambda block: gate.wait())
    decision = simulation.tick(IDLE)
    for _ in range(BLOCK * (AHEAD + 3)):
        recorder.see(simulation, decision)
    assert recorder.failure is SLOW
    gate.set()
    with pytest.raises(BadInput, match="the disk is too slow"):
        recorder.close()


@pytest.mark.parametrize("vector", [(3.0, 0.0, 0.0), (-3.0, 0.0, 0.0), (0.0, 5.0, 0.0), (1.0, -2.0, 3.0), (0.0, 0.0, -9.0)])
def test_an_arrow_points_along_its_force(vector: tuple[float, float, float]) -> None:
    turn = foxglove.arrow((0.0, 0.0, 0.0), vector)["pose"]["orientation"]
    w, x, y, z = (turn[key] for key in "wxyz")
    along = (1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y + w * z), 2.0 * (x * z - w * y))  # first column of the rotation
    size = math.hypot(*vector)
    assert along == pytest.approx([each / size for each in vector], abs=1e-12)


def test_a_killed_process_leaves_all_but_the_last_second(tmp_path: Path) -> None:
    chance = random.Random(6)
    for k in range(3):
        done = crash.kill(tmp_path / str(k), chance.uniform(0.0, 1.0))
        path = tmp_path / str(k) / "log.mcap"
        log = read(path)
        assert not log.whole
        assert log.t[-1] >= done - 1.0
        assert log.ticks.tolist() == list(range(1, len(log.ticks) + 1))
        assert repair(path)
        assert not repair(path)
        with path.open("rb") as file:
            summary = make_reader(file).get_summary()
        assert summary is not None
        assert summary.statistics is not None
        assert summary.statistics.channel_message_counts[1] == len(log.ticks)
        assert read(path).whole


def test_a_file_cut_anywhere_in_its_last_chunks_counts_what_it_holds(tmp_path: Path) -> None:
    """Also between a chunk and its index, where the messages are there and not counted."""
    path, copy = tmp_path / "log.mcap", tmp_path / "copy.mcap"
    simulation = simulate(prepare(convert({**SESSION, "timeline": []}, Session, "s.yaml"), "s.yaml"))
    with Recorder(path, simulation, "t") as recorder:
        for _ in range(3 * BLOCK):
            recorder.see(simulation, simulation.tick(IDLE))
    data = path.read_bytes()
    with path.open("rb") as file:
        summary = make_reader(file).get_summary()
    assert summary is not None
    numbers = {channel.topic: number for number, channel in summary.channels.items()}
    seen: set[tuple[int, int]] = set()
    for last in summary.chunk_indexes[-3:]:
        end = last.chunk_start_offset + last.chunk_length
        whole = end + last.message_index_length
        for at in (last.chunk_start_offset, end - 1, end, end + 1, whole - 1, whole):
            copy.write_bytes(data[:at])
            ticks = len(read(copy).ticks)
            assert repair(copy)
            with copy.open("rb") as file:
                told = make_reader(file).get_summary()
            assert told is not None
            assert told.statistics is not None
            counts = told.statistics.channel_message_counts
            state, truth = counts[numbers["/state"]], counts[numbers["/truth"]]
            assert ticks == min(state, truth) == len(read(copy).ticks)
            if state > truth:
                assert f"{state - truth} of {state} ticks of /truth" in read(copy).missing
            with copy.open("rb") as file:
                there = Counter(channel.topic for _, channel, _ in make_reader(file).iter_messages())
            assert (there["/state"], there["/truth"]) == (state, truth)
            seen.add((state, truth))
    before = 3 * BLOCK - (3 * BLOCK - 1) % BLOCK
    assert seen == {(before, before), (3 * BLOCK, before), (3 * BLOCK, 3 * BLOCK)}


def test_killed_at_once_it_holds_the_first_tick(tmp_path: Path) -> None:
    simulation = simulate(prepare(convert({**SESSION, "timeline": []}, Session, "s.yaml"), "s.yaml"))
    path, copy = tmp_path / "log.mcap", tmp_path / "copy.mcap"
    with Recorder(path, simulation, "t") as recorder:
        recorder.see(simulation, simulation.tick(IDLE))
        while not (log := _opened(path)) or not log.pictures:
            time.sleep(0.01)
        copy.write_bytes(path.read_bytes())
    log = read(copy)
    assert not log.whole
    assert log.ticks.tolist() == [1]
    assert Player(log).end == pytest.approx(0.002)


def test_cut_anywhere_it_opens_or_says_why_not(recorded: Path, tmp_path: Path) -> None:
    data = recorded.read_bytes()
    whole = read(recorded)
    chance = random.Random(1)
    path = tmp_path / "cut.mcap"
    for _ in range(30):
        path.write_bytes(data[: chance.randrange(len(data))])
        log = _opened(path)
        if log is None:
            assert path.stat().st_size < 8000  # before the channels and the arm are all there
            continue
        np.testing.assert_array_equal(log.state["q"], whole.state["q"][: len(log.ticks)])
        assert repair(path) == (not log.whole)
        assert len(read(path).ticks) == len(log.ticks)


def _opened(path: Path) -> Log | None:
    try:
        return read(path)
    except BadInput:
        return None


def test_a_full_disk_is_one_line(tmp_path: Path) -> None:
    simulation = simulate(prepare(convert({**SESSION, "timeline": []}, Session, "s.yaml"), "s.yaml"))
    with pytest.raises(BadInput, match="cannot be written"):
        Recorder(tmp_path, simulation, "t")
    full = Path("/dev/full")  # opens, and takes nothing
    with pytest.raises(BadInput, match="cannot be written"):
        Recorder(full, simulation, "t")


def test_a_disk_that_fills_up_ends_the_recording_alone(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    simulation = simulate(prepare(convert({**SESSION, "timeline": []}, Session, "s.yaml"), "s.yaml"))
    recorder = Recorder(tmp_path / "log.mcap", simulation, "t")

    def full(*_: Any) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(recorder._writer._file, "flush", full)
    for _ in range(300):
        recorder.see(simulation, simulation.tick(IDLE))
    with pytest.raises(BadInput, match="could not be written to its end"):
        recorder.close()


def test_a_recording_from_before_a_column_came_is_read_and_one_that_lacks_another_is_not(recorded: Path, tmp_path: Path) -> None:
    old, copy, whole = tmp_path / "old.mcap", tmp_path / "other.mcap", read(recorded)
    older(recorded, old, set(LATER))
    log = read(old)
    assert np.isnan(log.truth["touched"]).all()
    assert np.isnan(log.state["limit_motor_current"]).all()
    for name in ("q", "configured_mass", "limit_joint_torque", "mode"):
        np.testing.assert_array_equal(log.state[name], whole.state[name])
    np.testing.assert_array_equal(log.truth["payload_mass"], whole.truth["payload_mass"])
    assert not snapshot_at(log, 0, 0).truth_touched
    older(recorded, copy, {"payload_mass"})
    with pytest.raises(BadInput, match="/truth has other columns"):
        read(copy)
