"""The tab Record: the switch that records what the page shows, replay of what was recorded, export of its demonstrations."""

import viser

from app.learning.exporting import Exporting
from app.log.live import LiveRecording
from app.web.recordings.replay_controls import ReplayControls
from app.web.recordings.shelf import Shelf
from app.web.widgets import svg
from app.web.widgets.html import Html, enable
from app.web.widgets.svg import Colour
from sim.arm.arm_file import Arm
from sim.exchange.snapshot import Snapshot


class RecordingSwitch:
    """The tab with the switch and what it says."""

    def __init__(self, server: viser.ViserServer, recording: LiveRecording, arm: Arm) -> None:
        gui = server.gui
        self._recording = recording
        self._wrote = ""
        self.switch = gui.add_checkbox("Record", recording.on, hint="Into a file that can be replayed here, and by Foxglove")
        self.status = Html(gui)
        self.replay = ReplayControls(server, arm, Shelf(recording.folder, arm.name), busy=lambda: recording.writing)
        self.export = gui.add_button(
            "Export demonstrations", disabled=True, hint="Of the last recording: each way that a hand led the arm, for LeRobot."
        )
        self.exported = Html(gui)
        self._exporting = Exporting()

        @self.export.on_click
        async def _(_: viser.GuiEvent) -> None:
            if recording.path is not None and not recording.on:
                self._exporting.start(recording.path)

        @self.switch.on_update
        async def _(_: viser.GuiEvent) -> None:
            if self.switch.value != recording.on:
                (recording.start if self.switch.value else recording.stop)()

    def show(self, snapshot: Snapshot) -> bool:
        """Bring switch, words and replay up to date; True if anything changed."""
        recording = self._recording
        if recording.writing != self._wrote:
            self._wrote = recording.writing
            self.replay.look()
        ended = self.switch.value and not recording.on  # by itself
        if ended:
            self.switch.value = False
        possible = recording.path is not None and not recording.on and not self._exporting.on
        words = self.status.show(self._words()), self.exported.show(self._export_words())
        return any([*words, enable(self.export, possible), ended, self.replay.show(snapshot)])

    def close(self) -> None:
        """End an export that runs."""
        self._exporting.close()

    def _export_words(self) -> str:
        exporting = self._exporting
        if exporting.on and exporting.folder is not None:
            return svg.facts([("Exporting", exporting.folder.name)])
        if exporting.failed:
            return svg.note("Not exported", exporting.told, Colour.RED)
        return "" if exporting.folder is None else svg.facts([("Exported", exporting.told)])

    def _words(self) -> str:
        recording = self._recording
        if recording.failure:
            return svg.note("Not recorded", recording.failure, Colour.RED)
        place = svg.fine_print(f"Recordings are kept in {recording.folder.resolve()}")
        if recording.path is None:
            return svg.facts([("File", "none yet")]) + place
        word = f"{recording.seconds:.1f} s" if recording.on else "saved"
        return svg.facts([("Recorded" if recording.on else "Recording", word), ("File", recording.path.name)]) + place
