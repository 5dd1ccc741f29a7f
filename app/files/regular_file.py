"""Files of the disk, and nothing else: a pipe would make whoever reads it wait, and a device has no end."""

import os
import stat
from io import FileIO
from pathlib import Path

from app.files.bad_input import ABSENT, BadInput


def open_regular(path: Path, mode: str = "rb") -> FileIO:
    """Open a regular file, without buffer; `mode` "rb" to read it, "r+b" to change it.

    Raises:
        BadInput: there is none, it cannot be opened, or it is no regular file.
    """
    flags = os.O_RDONLY if mode == "rb" else os.O_RDWR
    try:
        number = os.open(path, flags | os.O_NONBLOCK | os.O_CLOEXEC)  # without it, opening a pipe waits for its other end
    except FileNotFoundError:
        raise BadInput(str(path), "", ABSENT, "expected an existing file") from None
    except (OSError, ValueError) as error:  # ValueError: a NUL in its name
        raise BadInput(str(path), "", ABSENT, f"expected a readable file ({getattr(error, 'strerror', None) or error})") from None
    if not stat.S_ISREG(os.fstat(number).st_mode):
        os.close(number)
        raise BadInput(str(path), "", ABSENT, f"is {_kind(path)}; expected a regular file")
    return FileIO(number, mode.replace("b", ""))


def is_something(path: Path) -> bool:
    """Whether there is something that is no folder: who opens it says what is wrong with it."""
    return os.path.exists(path) and not os.path.isdir(path)  # noqa: PTH110, PTH112 - a path's own methods raise at a long name


def _kind(path: Path) -> str:
    return "a folder" if path.is_dir() else "a pipe" if path.is_fifo() else "a device or a socket"
