"""How much room a disk has: looked at before something is written, and while it grows."""

import errno
import shutil
from pathlib import Path

from app.files.bad_input import ABSENT, BadInput

TO_BEGIN = 50_000_000
"""Room that a recording needs to begin: a minute and a half of it [bytes]."""

TO_GO_ON = 10_000_000
"""Room that must be left while it goes on, beside that for the file's end: so that it can be ended as it should [bytes]."""


def free(folder: Path) -> int:
    """Room in a folder, or in the nearest above it that is there [bytes]. Raises OSError: the disk does not answer."""
    while not folder.exists() and folder != folder.parent:
        folder = folder.parent
    return shutil.disk_usage(folder).free


def must_have_room(folder: Path) -> None:
    """Raise BadInput where a recording must not begin."""
    try:
        left = free(folder)
    except OSError as error:
        raise BadInput(str(folder), "", ABSENT, f"cannot be written ({error.strerror})") from None
    if left < TO_BEGIN:
        allowed = f"a disk with {TO_BEGIN / 1e6:.0f} MB of room for a recording"
        raise BadInput(str(folder), "room", f"{left / 1e6:.1f} MB", allowed)


def must_go_on(folder: Path, end: int) -> None:
    """Raise OSError where a file must end now: `end` is what its end takes [bytes]."""
    left = free(folder)
    if left < TO_GO_ON + end:
        raise OSError(errno.ENOSPC, f"the disk is full, but for {left / 1e6:.1f} MB")
