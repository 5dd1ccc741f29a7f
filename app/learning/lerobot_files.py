"""Writes demonstrations as a data set of LeRobot, format v3.0: Parquet tables, JSON, and a video for each demonstration.

The layout is that of https://huggingface.co/docs/lerobot/lerobot-dataset-v3; LeRobot itself is not needed.
"""

import json
import shutil
import tempfile
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from app.files.bad_input import ABSENT, BadInput
from app.learning.demonstrations import Demonstration
from app.learning.feature_statistics import Values, flat, joined, statistics

VERSION = "v3.0"
CHUNK = 1000
"""Largest number of files in a folder."""

FILE_MEGABYTES, VIDEO_MEGABYTES = 100, 200
"""Largest sizes of a table and of a video in this format [MB]."""

DATA = "data/chunk-{chunk_index:03d}/file-{file_index:03d}.parquet"
EPISODES = "meta/episodes/chunk-000/file-000.parquet"
VIDEOS = "videos/{video_key}/chunk-{chunk_index:03d}/file-{file_index:03d}.mp4"

STATE, ACTION, PICTURES, EVENTS = "observation.state", "action", "observation.images.front", "events"
COUNTERS = ("timestamp", "frame_index", "episode_index", "index", "task_index")


def parquet():
    """PyArrow and its module for Parquet.

    Raises:
        BadInput: it is not installed.
    """
    try:
        import pyarrow
        import pyarrow.parquet
    except ImportError:
        raise BadInput("export", "", ABSENT, "needs PyArrow: pip install 'pendant-sim[learning]'") from None
    return pyarrow, pyarrow.parquet


class DataSet:
    """A data set that is being written. `add` each demonstration, then `close`; until then the folder is not there or is empty.

    Args:
        folder: of the data set; it must not be there, or be empty.
        robot: name of the arm.
        joints: names of its joints, n of them.
        rate: rows a second.
        task: what the demonstrations show, in a sentence.
        pictures: height and width of the videos, or None for a set without.

    Raises:
        BadInput: the folder is not free or cannot be made, or PyArrow is not installed.
    """

    def __init__(
        self,
        folder: Path,
        robot: str,
        joints: Iterable[str],
        *,
        rate: int,
        task: str,
        pictures: tuple[int, int] | None = None,
    ) -> None:
        self._pa, self._pq = parquet()
        self._folder = folder
        try:
            if folder.exists() and (not folder.is_dir() or any(folder.iterdir())):
                raise BadInput(str(folder), "", ABSENT, "is there already; expected a folder that is not, or that is empty")
            folder.parent.mkdir(parents=True, exist_ok=True)
            self._beside = Path(tempfile.mkdtemp(prefix=f".{folder.name}-", dir=folder.parent))
            self._part = self._beside / "part"
            for path in (DATA.format(chunk_index=0, file_index=0), EPISODES):
                (self._part / path).parent.mkdir(parents=True)
        except OSError as error:
            raise BadInput(str(folder), "", ABSENT, f"cannot be written ({error.strerror})") from None
        self._robot, self._joints, self._rate, self._task, self._pictures = robot, list(joints), rate, task, pictures
        self._shown: list[tuple[Demonstration, NDArray[np.float64] | None]] = []

    def video_path(self) -> Path:
        """Where the video of the next demonstration is to be written, before it is added."""
        return self._part / VIDEOS.format(video_key=PICTURES, **_place(len(self._shown)))

    def add(self, shown: Demonstration, seen: NDArray[np.float64] | None = None) -> None:
        """Append a demonstration.

        Args:
            shown: its numbers.
            seen: pixels of some of its pictures (j, 3), 0 to 1, for their statistics; None: it has none.
        """
        self._shown.append((shown, seen))

    def close(self) -> int:
        """Write the tables, and move the folder to its place. Returns the number of demonstrations.

        Raises:
            BadInput: none was added, or a file cannot be written.
        """
        if not self._shown:
            raise BadInput(
                "export", "", ABSENT, "no demonstration in these recordings: nobody led the arm in free-drive for 0.5 s"
            )
        kinds = sorted({kind for shown, _ in self._shown for row in shown.events for kind in row.split()})
        rows, stats, tables, frames = [], [], [], 0
        for number, (shown, seen) in enumerate(self._shown):
            columns = _columns(shown, kinds, rate=self._rate, number=number, first=frames)
            stats.append({name: statistics(values) for name, values in columns.items()})
            if seen is not None:
                told = statistics(seen)
                stats[-1][PICTURES] = {name: each if name == "count" else each.reshape(3, 1, 1) for name, each in told.items()}
            rows.append(self._row(shown, number, frames) | flat(stats[-1]))
            tables.append(self._pa.table({name: self._column(values) for name, values in columns.items()}))
            frames += shown.ticks.size
        features = _features(self._joints, kinds, self._rate, self._pictures)
        try:
            self._write_rows(tables)
            self._pq.write_table(self._pa.Table.from_pylist(rows), self._part / EPISODES)
            self._write_tasks()
            self._write_json("stats", {name: joined([each[name] for each in stats]) for name in stats[0]})
            self._write_json("info", self._info(features, frames))
            if self._folder.exists():
                self._folder.rmdir()
            self._part.rename(self._folder)
            self._beside.rmdir()
        except OSError as error:
            raise BadInput(str(self._folder), "", ABSENT, f"cannot be written ({error.strerror})") from None
        return len(rows)

    def _row(self, shown: Demonstration, number: int, first: int) -> dict[str, Any]:
        """A demonstration's row in the table of episodes, without its statistics."""
        count, place = shown.ticks.size, _place(number)
        row: dict[str, Any] = {
            "episode_index": number,
            "tasks": [self._task],
            "length": count,
            "dataset_from_index": first,
            "dataset_to_index": first + count,
            "data/chunk_index": 0,
            "data/file_index": 0,
            "meta/episodes/chunk_index": 0,
            "meta/episodes/file_index": 0,
            "recording": shown.recording,
            "recording_from_tick": int(shown.ticks[0]),
            "recording_to_tick": int(shown.ticks[-1]),
        }
        if self._pictures is not None:
            row |= {f"videos/{PICTURES}/{name}": value for name, value in place.items()}
            row |= {f"videos/{PICTURES}/from_timestamp": 0.0, f"videos/{PICTURES}/to_timestamp": count / self._rate}
        return row

    def _write_rows(self, tables: list[Any]) -> None:
        """Write the data as one file: an hour at 25 rows a second has 20 MB, a fifth of what the format allows. Each
        demonstration is a row group."""
        path = self._part / DATA.format(chunk_index=0, file_index=0)
        with self._pq.ParquetWriter(path, tables[0].schema, compression="snappy") as writer:
            for table in tables:
                writer.write_table(table)

    def discard(self) -> None:
        """Delete the written files."""
        shutil.rmtree(self._beside, ignore_errors=True)

    def _column(self, values: NDArray[Any]) -> Any:
        """A column of the table. Several numbers in a row are a list of fixed length, as in LeRobot."""
        flat = self._pa.array(values.ravel())
        size = values.size // len(values)
        return flat if size == 1 else self._pa.FixedSizeListArray.from_arrays(flat, size)

    def _write_tasks(self) -> None:
        """Write the table of tasks. LeRobot reads it with pandas and needs the task's sentence as index; the metadata says so."""
        plain = {"metadata": None, "pandas_type": "int64", "numpy_type": "int64"}
        text = {"metadata": None, "pandas_type": "unicode", "numpy_type": "object"}
        columns = [{"name": "task_index", "field_name": "task_index", **plain}, {"name": "task", "field_name": "task", **text}]
        index = {"name": None, "field_name": None, **text, "metadata": {"encoding": "UTF-8"}}
        pandas = {"index_columns": ["task"], "column_indexes": [index], "columns": columns, "pandas_version": "2.0.0"}
        told = self._pa.table({"task_index": [0], "task": [self._task]}).replace_schema_metadata({"pandas": json.dumps(pandas)})
        self._pq.write_table(told, self._part / "meta/tasks.parquet")

    def _write_json(self, name: str, content: Any) -> None:
        (self._part / "meta" / f"{name}.json").write_text(json.dumps(content, indent=4, allow_nan=False), encoding="utf-8")

    def _info(self, features: dict[str, Any], frames: int) -> dict[str, Any]:
        return {
            "codebase_version": VERSION,
            "robot_type": self._robot,
            "total_episodes": len(self._shown),
            "total_frames": frames,
            "total_tasks": 1,
            "chunks_size": CHUNK,
            "data_files_size_in_mb": FILE_MEGABYTES,
            "video_files_size_in_mb": VIDEO_MEGABYTES,
            "fps": self._rate,
            "splits": {"train": f"0:{len(self._shown)}"},
            "data_path": DATA,
            "video_path": None if self._pictures is None else VIDEOS,
            "features": features,
        }


def _place(number: int) -> dict[str, int]:
    """Folder and file of a demonstration's video."""
    return {"chunk_index": number // CHUNK, "file_index": number % CHUNK}


def _columns(shown: Demonstration, kinds: list[str], *, rate: int, number: int, first: int) -> Values:
    """The columns of a demonstration: (k,) or (k, m). `kinds`: kinds of events; `first`: number, in the data
    set, of the demonstration's first row."""
    count = shown.ticks.size
    return {
        STATE: shown.angles,
        ACTION: shown.path,
        "observation.velocity": shown.speeds,
        "observation.wrench": shown.wrench,
        "observation.flange_position": shown.position,
        **(
            {EVENTS: np.array([[kind in row.split() for kind in kinds] for row in shown.events], dtype=np.int64)} if kinds else {}
        ),
        "timestamp": np.arange(count, dtype=np.float32) / np.float32(rate),
        "frame_index": np.arange(count),
        "episode_index": np.full(count, number),
        "index": np.arange(first, first + count),
        "task_index": np.zeros(count, dtype=np.int64),
    }


def _features(joints: list[str], kinds: list[str], rate: int, pictures: tuple[int, int] | None) -> dict[str, Any]:
    """Names, types and sizes of the columns. Names have units; axes are those of B. Each kind of event has a number: 1 where it
    happened."""
    force = [f"{axis} [{unit}]" for axis, unit in zip(("fx", "fy", "fz", "tx", "ty", "tz"), ["N"] * 3 + ["N m"] * 3, strict=True)]
    vectors = {
        STATE: [f"{name} [rad]" for name in joints],
        ACTION: [f"{name} [rad]" for name in joints],
        "observation.velocity": [f"{name} [rad/s]" for name in joints],
        "observation.wrench": force,
        "observation.flange_position": ["x [m]", "y [m]", "z [m]"],
    }
    found: dict[str, Any] = {name: {"dtype": "float32", "shape": [len(names)], "names": names} for name, names in vectors.items()}
    if pictures is not None:
        video = {
            "video.height": pictures[0],
            "video.width": pictures[1],
            "video.codec": "h264",
            "video.pix_fmt": "yuv420p",
            "video.is_depth_map": False,
            "video.fps": rate,
            "video.channels": 3,
            "has_audio": False,
        }
        found[PICTURES] = {"dtype": "video", "shape": [*pictures, 3], "names": ["height", "width", "channels"], "info": video}
    if kinds:
        found[EVENTS] = {"dtype": "int64", "shape": [len(kinds)], "names": kinds}
    for name in COUNTERS:
        found[name] = {"dtype": "float32" if name == "timestamp" else "int64", "shape": [1], "names": None}
    return found
