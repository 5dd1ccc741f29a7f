"""Where the files of a recording are: names that no other recording has."""

import time
from contextlib import suppress
from pathlib import Path

from app.files.bad_input import ABSENT, BadInput


def free_path(folder: Path, *, parts: bool) -> Path:
    """A path that no other recording has, in this process or another one: the empty file, or folder of `parts`, is there from now
    on. Raises BadInput: it cannot be made.
    """
    stem, number = time.strftime("recording-%Y-%m-%d-%H%M%S"), 1
    try:
        folder.mkdir(parents=True, exist_ok=True)
        while True:
            name = stem if number == 1 else f"{stem}-{number}"
            path = folder / (name if parts else f"{name}.mcap")
            try:
                if parts:
                    path.mkdir()
                else:
                    path.open("xb").close()
            except FileExistsError:
                number += 1
            else:
                return path
    except OSError as error:
        raise BadInput(str(folder), "", ABSENT, f"cannot be written ({error.strerror})") from None


def part(folder: Path, number: int) -> Path:
    """The file of a part of the recording in a folder, counted from 1."""
    return folder / f"{number:03d}.mcap"


def discard(path: Path, *, parts: bool) -> None:
    """Remove what `free_path` made, and a first part, of a recording that did not begin; what cannot be removed stays."""
    with suppress(OSError):
        if parts:
            part(path, 1).unlink(missing_ok=True)
            path.rmdir()
        else:
            path.unlink()
