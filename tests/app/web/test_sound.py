"""When the page sounds, and what it is sent for that."""

import json
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import msgspec
import numpy as np
import pytest

from app.web.server import Served
from app.web.sound import RATE, Tone, tone_for
from pendant.decision import Decision, Remaining, WallState
from pendant.modes import Mode, Phase
from tests.app.web.fake_loop import FakeLoop
from tests.app.web.raw_client import RawClient, until

Join = Callable[[], RawClient]


@dataclass
class At:
    """What of a decision can be heard."""

    mode: Mode = Mode.TEACH
    phase: Phase = Phase.OFF
    left: float | None = None  # of a free-drive period [s]
    near: float | None = None  # to a wall
    period: str = "free-drive"

    @property
    def decision(self) -> Decision:
        loop = FakeLoop()
        loop.mode, loop.phase = self.mode, self.phase
        if self.left is not None:
            loop.periods = (Remaining(self.period, round(500 * self.left), 1500),)
        decision = loop.latest().decision
        if self.near is None:
            return decision
        wall = WallState("wall", "flange", (0.0,) * 3, 0.1, (1.0, 0.0, 0.0), self.near, False, (0.0,) * 3)
        return msgspec.structs.replace(decision, walls=(wall,))


@pytest.mark.parametrize(
    ("before", "now", "tone"),
    [
        (At(), At(), None),
        (At(), At(Mode.STOP), Tone.STOP),
        (At(Mode.FREE_DRIVE), At(Mode.STOP), Tone.STOP),  # the stop, and not that free-drive has ended
        (At(Mode.STOP), At(Mode.STOP), None),
        (At(Mode.STOP), At(), None),
        (At(), At(phase=Phase.FEEDBACK), Tone.ASK),
        (At(phase=Phase.FEEDBACK), At(phase=Phase.FEEDBACK), None),
        (At(), At(Mode.FREE_DRIVE), Tone.FREE),
        (At(Mode.FREE_DRIVE), At(), Tone.HELD),
        (At(Mode.FREE_DRIVE, near=0.0), At(Mode.FREE_DRIVE, near=0.1), Tone.WALL),
        (At(Mode.FREE_DRIVE, near=0.1), At(Mode.FREE_DRIVE, near=0.9), None),
        (At(Mode.FREE_DRIVE, near=0.9), At(Mode.FREE_DRIVE, near=0.0), None),
        (At(left=3.02), At(left=3.0), Tone.COUNT),
        (At(left=2.9), At(left=2.1), None),
        (At(left=2.02), At(left=1.98), Tone.COUNT),
        (At(left=1.02), At(left=0.9), Tone.COUNT),
        (At(left=8.02), At(left=7.9), None),
        (At(left=1.0), At(left=3.0), None),  # it began anew
        (At(left=1.0), At(), None),
        (At(left=2.02, period="cool-down"), At(left=1.98, period="cool-down"), None),
    ],
)
def test_a_change_has_its_tone(before: At, now: At, tone: Tone | None) -> None:
    assert tone_for(before.decision, now.decision) is tone


@pytest.mark.parametrize("tone", Tone)
def test_a_tone_has_its_pitches_swells_and_fades(tone: Tone) -> None:
    pitches, length = tone.value
    samples = tone.samples()
    assert len(samples) == len(pitches) * round(length * RATE)
    assert np.abs(samples).max() <= 1.0
    for pitch, part in zip(pitches, np.split(samples, len(pitches)), strict=True):
        assert abs(part[0]) < 1e-6
        assert abs(part[-1]) < 0.05
        spectrum = np.abs(np.fft.rfft(part, 1 << 16))
        assert spectrum.argmax() * RATE / (1 << 16) == pytest.approx(pitch, rel=0.03)


def sounds(client: RawClient, last: str) -> list[str]:
    """The clips that the page was told to play, up to the one named `last`."""
    played: list[str] = []

    def see(message: dict[str, Any]) -> bool:
        if message["type"] != "RunJavascriptMessage" or "__VISER_AUDIO__.receive(" not in message["source"][:60]:
            return False
        told = json.loads(json.loads(message["source"].partition("receive(")[2].removesuffix(");")))
        if told["type"] == "AudioPlaybackMessage":
            assert (told["playing"], told["offset"]) == (True, 0.0)
            played.append(told["name"])
        return told["type"] == "AudioPlaybackMessage" and told["name"] == last

    client.messages_until(see)
    return played


def test_only_the_page_that_wants_it_is_sent_sound(served: Served, join: Join, loop: FakeLoop) -> None:
    loud, silent = join(), join()
    pages = served.preferences._pages
    until(lambda: len(pages) == 2, "both have their switches")
    loud.set(pages[0].sound._impl.uuid, value=True)
    until(lambda: pages[0].speaker is not None, "a speaker")
    loop.mode = Mode.FREE_DRIVE
    assert sounds(loud, "/sound/FREE") == ["/sound/FREE"]
    loop.mode = Mode.STOP
    assert sounds(loud, "/sound/STOP") == ["/sound/STOP"]
    served.server.gui.set_panel_label("mark")
    told = silent.messages_until(lambda m: m["type"] == "SetGuiPanelLabelMessage" and m["label"] == "mark")
    assert [m for m in told if m["type"] == "RunJavascriptMessage"] == []


def test_switched_off_it_is_silent_and_who_leaves_is_forgotten(served: Served, join: Join, loop: FakeLoop) -> None:
    client = join()
    pages = served.preferences._pages
    until(lambda: len(pages) == 1, "the switches")
    for value in (True, False):
        client.set(pages[0].sound._impl.uuid, value=value)
        until(lambda value=value: (pages[0].speaker is not None) is value, "switched")
    anyone = len(served.guard._anyone)
    client.close()
    until(lambda: not pages, "forgotten")
    assert len(served.guard._anyone) == anyone - 2
    loop.mode = Mode.STOP
    until(lambda: served.preferences._before is not None and served.preferences._before.mode is Mode.STOP, "seen by nobody")
