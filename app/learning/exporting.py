"""Exports a recording's demonstrations beside a running page: in a process of its own, so that the simulation is not delayed."""

import subprocess
import sys
from pathlib import Path

COMMAND = "from pendant_sim.start import main; main()"


class Exporting:
    """The export of one recording at a time.

    Attributes:
        folder: of the last data set; None before the first.
        told: the text that the last export printed, when it has ended.
        failed: the last export failed; `told` says why.
    """

    def __init__(self) -> None:
        self.folder: Path | None = None
        self.told = ""
        self.failed = False
        self._process: subprocess.Popen[str] | None = None

    @property
    def on(self) -> bool:
        """An export runs."""
        self._look()
        return self._process is not None

    def start(self, recording: Path) -> None:
        """Export into a folder beside the recording, named after it; does nothing while another export runs."""
        if self.on:
            return
        self.folder, self.told, self.failed = _free(recording), "", False
        command = [sys.executable, "-c", COMMAND, "export", str(recording), "--out", str(self.folder)]
        self._process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)

    def close(self) -> None:
        """End an export that runs."""
        if self._process is not None:
            self._process.terminate()
            self._process.communicate()
            self._process = None

    def _look(self) -> None:
        """Read the result of an export that has ended."""
        if self._process is None or self._process.poll() is None:
            return
        said, _ = self._process.communicate()
        self.failed = self._process.returncode != 0
        self.told = " ".join(said.split()).removeprefix("pendant: ")
        self._process = None


def _free(recording: Path) -> Path:
    """A folder that does not exist yet."""
    first = recording.with_name(f"{recording.stem}-demonstrations")
    folder, number = first, 1
    while folder.exists():
        number += 1
        folder = first.with_name(f"{first.name}-{number}")
    return folder
