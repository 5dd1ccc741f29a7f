"""Writes pictures as a video that browsers and data loaders play."""

from fractions import Fraction
from pathlib import Path
from types import TracebackType

import numpy as np
from numpy.typing import NDArray

from app.files.bad_input import ABSENT, BadInput

CODEC, PIXELS = "libx264", "yuv420p"
GROUP = 2
"""Distance of key frames. Every second picture is one, because a data loader starts reading at any frame."""

QUALITY = "23"  # the encoder's constant rate factor


class Video:
    """An mp4 file. A context manager; pictures have an even number of rows and columns, all the same.

    Args:
        path: of the file; its folder is made when missing.
        rate: pictures a second.

    Raises:
        BadInput: the file cannot be written, or PyAV is not installed.
    """

    def __init__(self, path: Path, rate: int) -> None:
        av = encoder()
        try:
            path.parent.mkdir(parents=True, exist_ok=True)
            self._file = av.open(str(path), "w")
        except OSError as error:
            raise BadInput(str(path), "", ABSENT, f"cannot be written ({error.strerror})") from None
        self._stream = self._file.add_stream(CODEC, rate=Fraction(rate), options={"g": str(GROUP), "crf": QUALITY})
        self._stream.pix_fmt = PIXELS
        self._frame, self._sized = av.VideoFrame, False

    def __enter__(self) -> "Video":
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None) -> None:
        if self._sized:
            self._file.mux(self._stream.encode())
        self._file.close()

    def add(self, picture: NDArray[np.uint8]) -> None:
        """Append a picture (height, width, 3)."""
        if not self._sized:
            self._stream.height, self._stream.width = picture.shape[:2]
            self._sized = True
        self._file.mux(self._stream.encode(self._frame.from_ndarray(picture, format="rgb24")))


def encoder():
    """PyAV, which contains FFmpeg's encoders.

    Raises:
        BadInput: it is not installed.
    """
    try:
        import av
    except ImportError:
        raise BadInput("pictures", "", ABSENT, "need PyAV: pip install 'pendant-sim[learning]'") from None
    return av
