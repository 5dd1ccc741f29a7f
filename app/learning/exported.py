"""Makes a data set of recordings, for `pendant export` and for the button of the page."""

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from app.files.bad_input import ABSENT, BadInput
from app.learning.demonstrations import Demonstration, demonstrations
from app.learning.export_defaults import RATE, TASK
from app.learning.lerobot_files import DataSet
from app.log_reading.playback import snapshot_at
from app.log_reading.reader import Log, read

PIXELS = (240, 320)
"""Height and width of the pictures."""

SAMPLES = 8
"""Number of pictures of a demonstration that are used for the statistics of pixels."""


class Exported(NamedTuple):
    """A written data set."""

    folder: Path
    demonstrations: int
    frames: int


def recordings(paths: Sequence[Path]) -> list[Path]:
    """The recordings at these paths: files themselves, and all .mcap files in folders and below, sorted.

    Raises:
        BadInput: a folder holds none.
    """
    found: list[Path] = []
    for path in paths:
        inside = sorted(path.rglob("*.mcap")) if path.is_dir() else [path]
        if not inside:
            raise BadInput(str(path), "", ABSENT, "no recording in this folder; expected files that end in .mcap")
        found += inside
    return found


def export(
    paths: Sequence[Path],
    out: Path,
    *,
    rate: int = RATE,
    task: str = TASK,
    pictures: bool = False,
    told: Callable[[int, int], None] = lambda done, all_: None,
) -> Exported:
    """Write the demonstrations of recordings as a data set of LeRobot.

    Args:
        paths: recordings of one kind of arm, or folders of them.
        out: folder of the data set.
        rate: rows a second.
        task: what the demonstrations show.
        pictures: with videos.
        told: is called with the number of recordings that are done, and the number of all.

    Raises:
        BadInput: a recording cannot be read, is of another arm than the first, or cannot be exported; then nothing is
            written.
    """
    files = recordings(paths)
    data: DataSet | None = None
    arm, frames = "", 0
    try:
        for number, path in enumerate(files):
            log = read(path)
            if data is None:
                arm = log.arm.name
                size = PIXELS if pictures else None
                data = DataSet(out, arm, log.arm.chain.joints, rate=rate, task=task, pictures=size)
            elif log.arm.name != arm:
                raise BadInput(path.name, "robot", log.arm.name, f"{arm}, as in {files[0].name}: a data set is of one arm")
            for shown in demonstrations(log, rate):
                data.add(shown, _filmed(log, shown, data.video_path(), rate) if pictures else None)
                frames += shown.ticks.size
            told(number + 1, len(files))
        assert data is not None
        return Exported(out, data.close(), frames)
    except BaseException:
        if data is not None:
            data.discard()
        raise


def _filmed(log: Log, shown: Demonstration, path: Path, rate: int) -> NDArray[np.float64]:
    """Write the video of a demonstration; returns pixels (j, 3) of some pictures, 0 to 1.

    A recording has poses 62.5 times a second: a picture shows the last pose, up to 16 ms old.
    """
    from app.learning.camera import ArmCamera
    from app.learning.video import Video

    at, ticks = log.picture_ticks, log.ticks
    samples: list[NDArray[np.float64]] = []
    every = max(1, shown.rows.size // SAMPLES)
    camera = ArmCamera(log.arm, log.scenario, *PIXELS)
    try:
        with Video(path, rate) as video:
            for k, row in enumerate(shown.rows.tolist()):
                last = max(int(np.searchsorted(at, ticks[row], side="right")) - 1, 0)
                picture = camera.picture(snapshot_at(log, last, row))
                video.add(picture)
                if k % every == 0:
                    samples.append(picture[::4, ::4].reshape(-1, 3) / 255.0)
    finally:
        camera.close()
    return np.concatenate(samples)
