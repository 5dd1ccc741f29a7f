"""The switch that records what the page shows, and the name of the file."""

import viser

from app.log.live import LiveRecording
from app.web.widgets import svg
from app.web.widgets.html import Html
from app.web.widgets.svg import Colour


class RecordingSwitch:
    """The tab with the switch and what it says."""

    def __init__(self, gui: viser.GuiApi, recording: LiveRecording) -> None:
        self._recording = recording
        self.switch = gui.add_checkbox("Record", recording.on, hint="Into a file that pendant replay and Foxglove open.")
        self.status = Html(gui)

        @self.switch.on_update
        async def _(_: viser.GuiEvent) -> None:
            if self.switch.value != recording.on:
                (recording.start if self.switch.value else recording.stop)()

    def show(self) -> bool:
        """Bring switch and words up to date; True if anything changed."""
        recording = self._recording
        ended = self.switch.value and not recording.on  # by itself
        if ended:
            self.switch.value = False
        return self.status.show(self._words()) or ended

    def _words(self) -> str:
        recording = self._recording
        if recording.failure:
            return svg.note("Not recorded", recording.failure, Colour.RED)
        if recording.path is None:
            return svg.facts([("File", "none yet")])
        word = f"{recording.seconds:.1f} s" if recording.on else "saved"
        return svg.facts([("Recorded" if recording.on else "Recording", word), ("File", recording.path.name)])
