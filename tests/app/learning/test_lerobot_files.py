"""What a data set holds, read by PyArrow as LeRobot and others read it."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from app.files.bad_input import BadInput
from app.learning.demonstrations import Demonstration
from app.learning.lerobot_files import DataSet

JOINTS = ["one", "two"]


def demonstration(seed: int, count: int, events: dict[int, str]) -> Demonstration:
    rng = np.random.default_rng(seed)

    def some(columns: int) -> np.ndarray:
        return rng.normal(size=(count, columns)).astype(np.float32)

    ticks = 1000 + 20 * np.arange(count)
    told = [events.get(k, "") for k in range(count)]
    return Demonstration(f"{seed}.mcap", np.arange(count), ticks, some(2), some(2), some(6), some(3), some(2), told)


SHOWN = [demonstration(1, 7, {2: "manipulation", 4: "tap manipulation"}), demonstration(2, 5, {0: "wall_touched"})]


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    data = DataSet(tmp_path / "set", "arm", JOINTS, rate=25, task="Show it.")
    for each in SHOWN:
        data.add(each)
    assert data.close() == 2
    return tmp_path / "set"


def column(folder: Path, name: str) -> Any:
    return np.array(pq.read_table(folder / "data/chunk-000/file-000.parquet").column(name).to_pylist())


@pytest.mark.parametrize(
    ("name", "field"),
    [
        ("observation.state", "angles"),
        ("action", "path"),
        ("observation.velocity", "speeds"),
        ("observation.wrench", "wrench"),
        ("observation.flange_position", "position"),
    ],
)
def test_numbers_come_back_as_they_were(folder: Path, name: str, field: str) -> None:
    np.testing.assert_array_equal(column(folder, name), np.concatenate([getattr(each, field) for each in SHOWN]))


def test_events_are_labels(folder: Path) -> None:
    names = json.loads((folder / "meta/info.json").read_text())["features"]["events"]["names"]
    assert names == ["manipulation", "tap", "wall_touched"]
    labels = column(folder, "events")
    assert labels.shape == (12, 3)
    assert {(int(k), names[j]) for k, j in np.argwhere(labels)} == {
        (2, "manipulation"),
        (4, "manipulation"),
        (4, "tap"),
        (7, "wall_touched"),
    }
    assert set(np.unique(labels)) == {0, 1}


def test_a_single_label_is_a_number_and_none_is_no_column(tmp_path: Path) -> None:
    for name, events in (("one", {1: "tap"}), ("none", {})):
        data = DataSet(tmp_path / name, "arm", JOINTS, rate=25, task="Show it.")
        data.add(demonstration(3, 4, events))
        data.close()
    assert column(tmp_path / "one", "events").tolist() == [0, 1, 0, 0]
    assert "events" not in pq.read_schema(tmp_path / "none/data/chunk-000/file-000.parquet").names
    assert "events" not in json.loads((tmp_path / "none/meta/info.json").read_text())["features"]


def test_rows_are_counted_and_timed(folder: Path) -> None:
    assert column(folder, "index").tolist() == list(range(12))
    assert column(folder, "frame_index").tolist() == [*range(7), *range(5)]
    assert column(folder, "episode_index").tolist() == [0] * 7 + [1] * 5
    np.testing.assert_allclose(column(folder, "timestamp"), [*np.arange(7) / 25, *np.arange(5) / 25], atol=1e-7)
    assert pq.ParquetFile(folder / "data/chunk-000/file-000.parquet").num_row_groups == 2


def test_types_are_those_of_the_format(folder: Path) -> None:
    schema = pq.read_schema(folder / "data/chunk-000/file-000.parquet")
    assert schema.field("observation.state").type == pa.list_(pa.float32(), 2)
    assert schema.field("events").type == pa.list_(pa.int64(), 3)
    assert schema.field("timestamp").type == pa.float32()
    features = json.loads((folder / "meta/info.json").read_text())["features"]
    assert set(schema.names) == set(features)
    for name, told in features.items():
        kind = schema.field(name).type
        size, number = (kind.list_size, kind.value_type) if pa.types.is_fixed_size_list(kind) else (1, kind)
        assert told["shape"] == [size]
        assert told["dtype"] == {"float": "float32"}.get(str(number), str(number))


def test_the_files_say_what_there_is(folder: Path) -> None:
    info = json.loads((folder / "meta/info.json").read_text())
    told = {key: info[key] for key in ("codebase_version", "robot_type", "fps", "total_episodes", "total_frames", "splits")}
    assert told == {
        "codebase_version": "v3.0",
        "robot_type": "arm",
        "fps": 25,
        "total_episodes": 2,
        "total_frames": 12,
        "splits": {"train": "0:2"},
    }
    assert info["features"]["observation.state"]["names"] == ["one [rad]", "two [rad]"]
    assert info["video_path"] is None
    rows = pq.read_table(folder / "meta/episodes/chunk-000/file-000.parquet").to_pylist()
    assert [(row["episode_index"], row["length"], row["dataset_from_index"], row["dataset_to_index"]) for row in rows] == [
        (0, 7, 0, 7),
        (1, 5, 7, 12),
    ]
    assert [(row["recording"], row["recording_from_tick"], row["recording_to_tick"]) for row in rows] == [
        ("1.mcap", 1000, 1120),
        ("2.mcap", 1000, 1080),
    ]
    assert rows[0]["tasks"] == ["Show it."]


def test_the_task_is_the_index_that_pandas_reads(folder: Path) -> None:
    table = pq.read_table(folder / "meta/tasks.parquet")
    assert table.to_pylist() == [{"task_index": 0, "task": "Show it."}]
    assert json.loads(table.schema.metadata[b"pandas"])["index_columns"] == ["task"]


def test_statistics_are_those_of_all_rows(folder: Path) -> None:
    stats = json.loads((folder / "meta/stats.json").read_text())
    every = np.concatenate([each.angles for each in SHOWN]).astype(float)
    told = stats["observation.state"]
    for name, expected in (("min", every.min(0)), ("max", every.max(0)), ("mean", every.mean(0)), ("std", every.std(0))):
        np.testing.assert_allclose(told[name], expected, rtol=1e-6)
    assert told["count"] == [12]
    assert set(stats) == set(json.loads((folder / "meta/info.json").read_text())["features"])
    rows = pq.read_table(folder / "meta/episodes/chunk-000/file-000.parquet").to_pylist()
    np.testing.assert_allclose(rows[1]["stats/action/max"], SHOWN[1].path.max(axis=0), rtol=1e-6)


def test_until_it_is_closed_nothing_stands_in_its_place(tmp_path: Path) -> None:
    data = DataSet(tmp_path / "set", "arm", JOINTS, rate=25, task="Show it.")
    data.add(SHOWN[0])
    assert not (tmp_path / "set").exists()
    data.discard()
    assert list(tmp_path.iterdir()) == []


def test_a_folder_that_holds_something_is_left_alone(tmp_path: Path) -> None:
    (tmp_path / "kept").write_text("mine")
    with pytest.raises(BadInput, match="is there already"):
        DataSet(tmp_path, "arm", JOINTS, rate=25, task="Show it.")
    assert [path.name for path in tmp_path.iterdir()] == ["kept"]


def test_a_set_without_a_demonstration_is_none(tmp_path: Path) -> None:
    data = DataSet(tmp_path / "set", "arm", JOINTS, rate=25, task="Show it.")
    with pytest.raises(BadInput, match="no demonstration in these recordings"):
        data.close()
