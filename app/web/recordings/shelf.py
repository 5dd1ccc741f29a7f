"""The recordings of a folder: which there are, and one of them opened without holding up whoever asks."""

import threading
from pathlib import Path

from app.files.checked import BadInput
from app.log.playback import Player
from app.log.reader import read

MOST = 50
"""Recordings that are offered."""

LARGEST = 400_000_000
"""Of a file that is opened beside a running arm: it takes the memory twice, and reading it the processor [bytes]."""


class Shelf:
    """A folder of recordings. `open` may be called from any thread; the file is read on a thread of its own.

    Args:
        folder: of the recordings.
        arm: name of the arm that is shown; recordings of others are not opened.

    Attributes:
        player: of the recording that is open; None while none is.
        opening: name of the file that is being read, or "".
        failure: why the last one was not opened, or "".
    """

    def __init__(self, folder: Path, arm: str) -> None:
        self._folder, self._arm = folder, arm
        self._reader: threading.Thread | None = None
        self.player: Player | None = None
        self.opening = ""
        self.failure = ""

    def names(self) -> tuple[str, ...]:
        """Files of the folder, the newest first."""
        try:
            found = [(path.stat().st_mtime, path.name) for path in self._folder.glob("*.mcap")]
        except OSError:  # one was taken away while we looked
            return ()
        return tuple([name for _, name in sorted(found, reverse=True)[:MOST]])

    def path(self, name: str) -> Path:
        """Of a file of the folder."""
        return self._folder / Path(name).name

    def open(self, name: str) -> None:
        """Read a file; nothing, while another is read."""
        if not self.opening:
            self.player, self.failure, self.opening = None, "", name
            self._reader = threading.Thread(target=self._read, args=(name,), name="replay", daemon=True)
            self._reader.start()

    def close(self) -> None:
        """Nothing is open any more."""
        if self._reader is not None:
            self._reader.join()
        self.player, self.failure = None, ""

    def _read(self, name: str) -> None:
        path = self.path(name)
        try:
            size = path.stat().st_size
            if size > LARGEST:
                raise BadInput(name, "size", f"{size / 1e6:.0f} MB", f"{LARGEST / 1e6:.0f} MB here; use pendant replay")
            player = Player(read(path))
            if player.log.arm.name != self._arm:
                raise BadInput(name, "arm", player.log.arm.name, f"{self._arm}, which is shown here")
            player.playing = True
            self.player = player
        except OSError as error:
            self.failure = f"{name}: cannot be read ({error.strerror})"
        except BadInput as error:
            self.failure = str(error)
        self.opening = ""
