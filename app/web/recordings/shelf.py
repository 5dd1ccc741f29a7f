"""The recordings of a folder: which there are, and one of them opened without holding up whoever asks."""

import threading
from pathlib import Path
from typing import NamedTuple

from app.files.checked import ABSENT, BadInput
from app.log_reading.playback import Player
from app.log_reading.reader import read
from sim.run.troubles import reason_of

MOST = 50
"""Recordings that are offered."""

LARGEST_DOWNLOAD = 400_000_000
"""Of a file that is given to a browser: it takes its memory twice [bytes]."""


class Found(NamedTuple):
    """What became of an opening."""

    asked: int
    player: Player | None
    failure: str


class Shelf:
    """A folder of recordings. Lives on viser's event loop; a recording is opened on a thread of its own.

    Args:
        folder: of the recordings.
        arm: name of the arm that is shown; recordings of others are not opened.
    """

    def __init__(self, folder: Path, arm: str) -> None:
        self._folder, self._arm = folder, arm
        self._asked = 0  # how often something was to be opened, or closed: what an older opening finds is let go
        self._found: Found | None = None  # by the thread that opens; replaced whole
        self._player: Player | None = None
        self._opening = self.failure = ""

    @property
    def player(self) -> Player | None:
        """Of the recording that is open; None while none is."""
        self._look()
        return self._player

    @property
    def opening(self) -> str:
        """Name of the recording that is being opened, or ""."""
        self._look()
        return self._opening

    def names(self) -> tuple[str, ...]:
        """Recordings of the folder, the newest first: files, and folders of those in parts."""
        try:
            paths = {*self._folder.glob("*.mcap"), *(path.parent for path in self._folder.glob("*/*.mcap"))}
            found = [(path.stat().st_mtime, path.name) for path in paths]
        except OSError:  # one was taken away while we looked
            return ()
        return tuple([name for _, name in sorted(found, reverse=True)[:MOST]])

    def path(self, name: str) -> Path:
        """Of a recording in the folder."""
        return self._folder / Path(name).name

    def content(self, name: str) -> bytes:
        """Of a file, for a browser. Raises BadInput: it is none, is too large, or cannot be read."""
        path = self.path(name)
        try:
            if path.is_dir():
                raise BadInput(name, "", ABSENT, "a recording in parts; its files are in the folder of this name")
            size = path.stat().st_size
            if size > LARGEST_DOWNLOAD:
                allowed = f"at most {LARGEST_DOWNLOAD / 1e6:.0f} MB; it is in {self._folder.resolve()}"
                raise BadInput(name, "size", f"{size / 1e6:.0f} MB", allowed)
            return path.read_bytes()
        except OSError as error:
            raise BadInput(name, "", ABSENT, f"cannot be read ({error.strerror})") from None

    def open(self, name: str) -> None:
        """Open a recording; nothing, while another is opened."""
        if not self.opening:
            self._asked += 1
            self._player, self.failure, self._opening = None, "", name
            threading.Thread(target=self._read, args=(name, self._asked), name="replay", daemon=True).start()

    def close(self) -> None:
        """Nothing is open any more."""
        self._asked += 1
        self._player, self.failure, self._opening = None, "", ""

    def _look(self) -> None:
        """Take what was opened meanwhile."""
        found = self._found
        if found is not None and found.asked == self._asked:
            self._found = None
            self._player, self.failure, self._opening = found.player, found.failure, ""

    def _read(self, name: str, asked: int) -> None:
        """On a thread of its own."""
        try:
            player = Player(read(self.path(name)))
            if player.log.arm.name != self._arm:
                raise BadInput(name, "arm", player.log.arm.name, f"{self._arm}, which is shown here")
            player.playing = True
            self._found = Found(asked, player, "")
        except BadInput as error:
            self._found = Found(asked, None, str(error))
        except Exception as error:  # noqa: BLE001 - whatever it is, the opening has an end
            self._found = Found(asked, None, f"{name}: {reason_of(error)}")
