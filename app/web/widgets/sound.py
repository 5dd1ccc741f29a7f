"""Tones on the page: the only file that knows viser-audio, and how a page is made to sound.

viser-audio 0.1.0 keeps what it sends for pages that come later, which would hear every tone of the past. Here each page that
wants sound is sent its tones by itself. It gets the player when its switch is set: only then a browser lets it sound, and
before that the player would lay its own button over the page.
"""

import viser
import viser._messages
import viser_audio
from viser_audio.messages import AudioMessage

from app.tones import RATE, Tone

VOLUME = 0.25


class Speaker:
    """The sound of one page.

    Args:
        client: the page; it has just been clicked, or its browser lets nothing sound.
    """

    def __init__(self, client: viser.ClientHandle) -> None:
        self._client = client
        self._queue(viser._messages.RunJavascriptMessage(viser_audio.runtime_source()))
        api = viser_audio.AudioApi(self._queue)
        self._clips = {tone: api.add(f"/sound/{tone.name}", tone.samples(), RATE, volume=VOLUME) for tone in Tone}

    def play(self, tone: Tone) -> None:
        """Let it be heard from its beginning."""
        self._clips[tone].play(0.0)

    def _queue(self, message: AudioMessage | viser._messages.Message) -> None:
        self._client._websock_connection.queue_message(message)
