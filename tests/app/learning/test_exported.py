import json
import shutil
from pathlib import Path

import av
import numpy as np
import pyarrow.parquet as pq
import pytest

from app.api import run, session
from app.files.bad_input import BadInput
from app.learning.demonstrations import demonstrations
from app.learning.exported import PIXELS, export, recordings
from app.log_reading.reader import read


def test_the_numbers_of_a_recording_come_back(led: Path, tmp_path: Path) -> None:
    told: list[tuple[int, int]] = []
    made = export([led], tmp_path / "set", rate=50, task="Lead it.", told=lambda done, of: told.append((done, of)))
    ways = demonstrations(read(led), 50)
    table = pq.read_table(made.folder / "data")
    assert (made.demonstrations, made.frames) == (2, sum(way.ticks.size for way in ways)) == (2, table.num_rows)
    np.testing.assert_array_equal(table.column("observation.state").to_pylist(), np.concatenate([way.angles for way in ways]))
    np.testing.assert_array_equal(table.column("action").to_pylist(), np.concatenate([way.path for way in ways]))
    assert told == [(1, 1)]


def test_a_folder_stands_for_all_recordings_in_it(led: Path, tmp_path: Path) -> None:
    for name in ("b/log.mcap", "a/log.mcap"):
        (tmp_path / name).parent.mkdir()
        shutil.copy(led, tmp_path / name)
    assert recordings([tmp_path]) == [tmp_path / "a/log.mcap", tmp_path / "b/log.mcap"]
    assert export([tmp_path], tmp_path / "set").demonstrations == 4


def test_a_demonstration_has_a_video_of_as_many_frames(led: Path, tmp_path: Path) -> None:
    made = export([led], tmp_path / "set", rate=10, pictures=True)
    rows = pq.read_table(made.folder / "meta/episodes").to_pylist()
    for row in rows:
        path = made.folder / f"videos/observation.images.front/chunk-000/file-{row['episode_index']:03d}.mp4"
        with av.open(str(path)) as file:
            assert file.streams.video[0].average_rate == 10
            frames = [frame.to_ndarray(format="rgb24") for frame in file.decode(video=0)]
        assert len(frames) == row["length"]
        assert frames[0].shape == (*PIXELS, 3)
        assert float(np.abs(frames[-1].astype(int) - frames[0]).mean()) > 0.5  # the arm has moved
    info = json.loads((made.folder / "meta/info.json").read_text())
    assert info["features"]["observation.images.front"]["shape"] == [*PIXELS, 3]
    assert np.shape(json.loads((made.folder / "meta/stats.json").read_text())["observation.images.front"]["mean"]) == (3, 1, 1)


def test_recordings_of_two_arms_make_no_set(led: Path, tmp_path: Path) -> None:
    run(session({"title": "other", "duration": 0.1, "robot": "ur3e"}), tmp_path / "other")
    with pytest.raises(BadInput, match=r"robot = ur3e: ur5e, as in log\.mcap"):
        export([led, tmp_path / "other"], tmp_path / "set")
    assert not list(tmp_path.glob("set*"))


def test_recordings_without_a_demonstration_make_no_set(idle: Path, tmp_path: Path) -> None:
    with pytest.raises(BadInput, match="nobody led the arm"):
        export([idle], tmp_path / "set")
    assert not list(tmp_path.glob("set*"))


def test_a_folder_without_recordings_is_told(tmp_path: Path) -> None:
    with pytest.raises(BadInput, match="no recording in this folder"):
        recordings([tmp_path])
