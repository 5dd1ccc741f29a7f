"""The rows of a study while it runs: a file that only grows, of lines that say by themselves whether they are whole."""

import os
import zlib
from collections.abc import Iterator
from pathlib import Path
from types import TracebackType
from typing import Any

import msgspec

from app.files.bad_input import ABSENT, BadInput


class RowJournal:
    """Appends rows, each on the disk before `append` returns. What a crash left of a last line is cut off when it is opened.

    Args:
        path: of the file.

    Raises:
        BadInput: it cannot be written.
    """

    def __init__(self, path: Path) -> None:
        self._path = path
        self._end = _whole(path)
        try:
            self._file = path.open("ab", buffering=0)
            self._file.truncate(self._end)
        except OSError as error:
            raise _unwritable(path, error) from None

    def __enter__(self) -> "RowJournal":
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None) -> None:
        self._file.close()

    def append(self, row: dict[str, Any]) -> None:
        """Add a row.

        Raises:
            BadInput: the disk is full, or fails; the file is as it was before.
        """
        line = sealed(msgspec.json.encode(row))
        try:
            written = self._file.write(line)
            if written != len(line):  # a disk that becomes full takes a part
                self._file.write(line[written:])
            os.fsync(self._file.fileno())
        except OSError as error:
            self._file.truncate(self._end)
            raise _unwritable(self._path, error) from None
        self._end += len(line)


def sealed(content: bytes) -> bytes:
    """A line with its checksum."""
    return b"%08x %s\n" % (zlib.crc32(content), content)


def rows(path: Path) -> Iterator[dict[str, Any]]:
    """All whole rows; none where there is no file."""
    return (msgspec.json.decode(line[9:]) for line in _lines(path))


def _lines(path: Path) -> Iterator[bytes]:
    if not path.is_file():
        return
    with path.open("rb") as file:
        for line in file:
            if not line.endswith(b"\n") or line[:8] != b"%08x" % zlib.crc32(line[9:-1]):
                return
            yield line


def _whole(path: Path) -> int:
    return sum(map(len, _lines(path)))


def _unwritable(path: Path, error: OSError) -> BadInput:
    return BadInput(
        str(path), "", ABSENT, f"cannot be written ({error.strerror}); what is done is kept, the same command goes on"
    )
