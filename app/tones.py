"""Tones for feedback and countdowns (FD-8, FD-21, VW-7): which one a change of the robot gives, and how it sounds."""

from enum import Enum

import numpy as np

from pendant.decision import Decision
from pendant.tick.modes import TICK_RATE, Mode, Phase

RATE = 16_000
"""Of the samples [Hz]."""

EDGE = 0.01
"""A tone swells and fades for so long, so that it does not click [s]."""

COUNTED = ("free-drive", "restart", "confirmation")
"""Periods whose last seconds are counted."""

COUNT_FROM = 3
"""Seconds that are counted down."""


class Tone(Enum):
    """What can be heard: frequencies, one after the other [Hz], and how long each [s]."""

    STOP = ((330.0, 220.0, 330.0, 220.0), 0.16)
    ASK = ((660.0, 880.0), 0.12)
    FREE = ((440.0, 660.0), 0.09)
    HELD = ((660.0, 440.0), 0.09)
    SIGN = ((880.0, 880.0), 0.08)
    WALL = ((990.0,), 0.07)
    COUNT = ((770.0,), 0.05)

    def samples(self) -> np.ndarray:
        """(n,) at RATE, within [-1, 1]."""
        pitches, length = self.value
        t = np.arange(round(length * RATE)) / RATE
        swell = np.minimum(1.0, np.minimum(t, length - t) / EDGE)
        return np.concatenate([swell * np.sin(2.0 * np.pi * pitch * t) for pitch in pitches]).astype(np.float32)


def tone_for(before: Decision, now: Decision) -> Tone | None:
    """What is to be heard at the change from one decision to a later one; of several things the most urgent."""
    if now.mode is Mode.STOP and before.mode is not Mode.STOP:
        return Tone.STOP
    if _asks(now) and not _asks(before):
        return Tone.ASK
    if now.signs > before.signs:
        return Tone.SIGN
    if (now.mode is Mode.FREE_DRIVE) is not (before.mode is Mode.FREE_DRIVE):
        return Tone.FREE if now.mode is Mode.FREE_DRIVE else Tone.HELD
    if any(wall.near > 0.0 for wall in now.walls) and not any(wall.near > 0.0 for wall in before.walls):
        return Tone.WALL
    return Tone.COUNT if _seconds(now) < _seconds(before) else None


def _asks(decision: Decision) -> bool:
    """The robot asks for a confirmation, before the activation sequence or within it."""
    return decision.phase is Phase.FEEDBACK or any(period.name == "feedback" for period in decision.periods)


def _seconds(decision: Decision) -> int:
    """Whole seconds left of the counted period that ends first, if it is about to end; else more than are counted."""
    left = [-(-period.ticks // TICK_RATE) for period in decision.periods if period.name in COUNTED]
    return min([*left, COUNT_FROM + 1])
