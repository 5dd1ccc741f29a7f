"""Which change of the robot has which tone, and how a tone sounds."""

from dataclasses import dataclass

import msgspec
import numpy as np
import pytest

from app.tones import RATE, Tone, tone_for
from pendant.decision import Decision
from pendant.freedrive.periods import Remaining
from pendant.tick.modes import Mode, Phase
from pendant.walls.containment import WallState
from tests.app import fakes


@dataclass
class At:
    """What of a decision can be heard."""

    mode: Mode = Mode.TEACH
    phase: Phase = Phase.OFF
    left: float | None = None  # of a free-drive period [s]
    near: float | None = None  # to a wall
    period: str = "free-drive"
    signs: int = 0

    @property
    def decision(self) -> Decision:
        periods = () if self.left is None else (Remaining(self.period, round(500 * self.left), 1500),)
        decision = msgspec.structs.replace(fakes.decision(self.mode, self.phase, periods=periods), signs=self.signs)
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
        (At(), At(phase=Phase.SEQUENCE, left=0.5, period="feedback"), Tone.ASK),  # within the sequence
        (At(left=0.6, period="feedback"), At(left=0.5, period="feedback"), None),
        (At(signs=2), At(signs=3), Tone.SIGN),
        (At(signs=2), At(Mode.FREE_DRIVE, signs=3), Tone.SIGN),
        (At(signs=2), At(signs=2), None),
        (At(signs=2), At(Mode.STOP, signs=3), Tone.STOP),
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
