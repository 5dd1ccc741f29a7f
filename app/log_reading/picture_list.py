"""The pictures of a recording by their numbers: what the pendant said, and the poses of all frames. Read when asked for."""

from collections.abc import Iterator, Sequence
from typing import Any, Generic, TypeVar, overload

import numpy as np
from numpy.typing import NDArray

from app.log.recorded_messages import FramesMessage, PendantMessage
from app.log_reading.log_file import LogFile, decoded, not_ours

T = TypeVar("T")

BLOCK = 256
"""Pictures that are read at a time by whoever goes through all."""

Spans = Sequence[tuple[LogFile, int, int]]
"""Of each file in order: the first picture of its own that counts, and the one after the last."""


class PictureList(Sequence[T], Generic[T]):
    """One topic of the pictures.

    Args:
        spans: of the files.

    Raises:
        BadInput: what is asked for is damaged.
    """

    def __init__(self, spans: Spans) -> None:
        self._spans = tuple(spans)
        self._length = sum(end - begin for _, begin, end in spans)

    def __len__(self) -> int:
        return self._length

    @overload
    def __getitem__(self, index: int) -> T: ...
    @overload
    def __getitem__(self, index: slice) -> list[T]: ...
    def __getitem__(self, index: int | slice) -> T | list[T]:
        if isinstance(index, slice):
            return [self[k] for k in range(*index.indices(self._length))]
        k = index + self._length if index < 0 else index
        for file, begin, end in self._spans:
            if 0 <= k < end - begin:
                return self._read(file, begin + k, begin + k + 1)[0]
            k -= end - begin
        raise IndexError(index)

    def __iter__(self) -> Iterator[T]:
        for file, begin, end in self._spans:
            for at in range(begin, end, BLOCK):
                yield from self._read(file, at, min(at + BLOCK, end))

    def _read(self, file: LogFile, begin: int, end: int) -> list[T]:
        """Pictures of one file, by their numbers in it."""
        raise NotImplementedError


class Pictures(PictureList[PendantMessage]):
    """What the pendant said."""

    def _read(self, file: LogFile, begin: int, end: int) -> list[PendantMessage]:
        return _of(file, begin, end, column=0, kind=PendantMessage)


class Frames(PictureList[dict[str, list[float]]]):
    """Poses in W by the names of their frames: position [m], quaternion wxyz."""

    def _read(self, file: LogFile, begin: int, end: int) -> list[dict[str, list[float]]]:
        needed = {"foot", *file.arm.chain.joints, "flange", *(f"object {thing.name}" for thing in file.scenario.world)}
        found = [each.poses() for each in _of(file, begin, end, column=1, kind=FramesMessage)]
        for frames in found:
            if not needed <= frames.keys():
                raise not_ours(file.path, ValueError(f"/tf lacks {', '.join(sorted(needed - frames.keys()))}"))
        return found


def _of(file: LogFile, begin: int, end: int, *, column: int, kind: type[T]) -> list[T]:
    numbers: NDArray[np.int64] = file.picture_rows[begin:end, column]
    messages, topic = (file.pictures, "/pendant") if column == 0 else (file.frames, "/tf")
    first, last = int(numbers[0]), int(numbers[-1]) + 1
    try:
        found: list[Any] = decoded(messages, first, last, kind=kind, topic=topic)
    except ValueError as error:
        raise not_ours(file.path, error) from None
    return [found[number - first] for number in numbers.tolist()]
