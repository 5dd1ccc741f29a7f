"""What pulls at the free arm, as far as is known: nobody, a hand, a payload that changed, a sensor that stepped (FD-19).

The estimator says how likely it is that the payload changed, and that the sensor stepped, each against all else. What is left of
the probability is a hand's where one is felt, else nobody's: that is decided, not weighed.
"""

import math
from enum import IntEnum
from typing import NamedTuple

from pendant.settings.schema import ticks
from pendant.tick.pose import Vector, norm

KEPT = ticks(0.1)
"""Ticks for which a doubt is shown: it lasts some ticks only, and a picture has to be seen."""

CERTAIN = 0.999
"""From this share on no figure is told but this."""

NOT_TOLD = -math.inf
"""Log of odds where nothing is compared [nats]."""


class HandFelt(IntEnum):
    """Where a hand is felt."""

    NOBODY = 0
    FLANGE = 1  # or somewhere, where the flange sensor is not used
    LINK = 2  # the joints feel it and the flange sensor does not; an object may make it, too


class CauseShares(NamedTuple):
    """Probabilities of what pulls at the arm; their sum is 1."""

    nobody: float
    hand: float
    link: float
    payload: float
    sensor: float


class PullCauses(NamedTuple):
    """What is known of one tick."""

    felt: HandFelt
    lost_odds: float = NOT_TOLD  # as in `Estimate`
    lost_share: float = 0.0
    step_odds: float = NOT_TOLD

    @property
    def doubt(self) -> float:
        """Log of the odds of the likelier of the causes that are no hand [nats]."""
        return max(self.lost_odds, self.step_odds)

    @property
    def shares(self) -> CauseShares:
        """How likely each is."""
        payload, sensor = _probability(self.lost_odds), _probability(self.step_odds)
        both = payload + sensor
        if both > 1.0:  # by rounding
            payload, sensor, both = payload / both, sensor / both, 1.0
        felt, rest = self.felt, 1.0 - both
        nobody, hand, link = (rest if felt is each else 0.0 for each in HandFelt)
        return CauseShares(nobody, hand, link, payload, sensor)

    @property
    def words(self) -> str:
        """The likeliest cause, and how likely it is unless it is who is felt."""
        shares = self.shares
        likely = max(shares.payload, shares.sensor)
        if likely <= max(shares[:3]):
            return SHARE_WORDS[self.felt]
        if shares.sensor > shares.payload:
            what = "The sensor stepped"
        else:
            what = "The payload fell" if self.lost_share > 0.0 else "More payload"
        return f"{what}: over {100.0 * CERTAIN:.1f} %" if likely > CERTAIN else f"{what}: {100.0 * likely:.0f} %"


SHARE_WORDS = ("No hand", "A hand", "A hand on a link", "Payload changed", "Sensor stepped")
"""Of the fields of `CauseShares`; the first ones are those of `HandFelt`."""


def felt(force: Vector, *, sensed: float, usual: float, least: float, led: bool) -> HandFelt:
    """Where a hand is felt in a tick, with the flange sensor.

    Args:
        force: the user's [N].
        sensed: what of the force at the flange sensor is no swing of the arm and no payload, its size [N].
        usual: the mean of the force there lately, its size [N].
        least: so large is a hand's force [N].
        led: somebody pays for the motion.
    """
    if not led and norm(force) < least:
        return _NOBODY
    return _LINK if sensed < least and usual < least else _FLANGE


class PullWatch:
    """Keeps for `KEPT` ticks what is least a hand, for pictures that come every few ticks.

    Attributes:
        shown: that; None while free-drive has been off for as long.
    """

    __slots__ = ("_age", "_doubt", "shown")

    def __init__(self) -> None:
        self.shown: PullCauses | None = None
        self._age = 0
        self._doubt = NOT_TOLD  # of `shown`

    def step(self, pull: PullCauses | None) -> None:
        """One tick; None: the arm is not free."""
        self._age += 1
        if pull is not None:
            doubt = pull.doubt
            if self.shown is None or self._age >= KEPT or doubt >= self._doubt:
                self.shown, self._doubt, self._age = pull, doubt, 0
        elif self.shown is not None and self._age >= KEPT:
            self.shown = None


def _probability(odds: float) -> float:
    """Of the log of odds [nats]."""
    if odds >= 0.0:
        return 1.0 / (1.0 + math.exp(-odds))
    ratio = math.exp(odds)
    return ratio / (1.0 + ratio)


_NOBODY, _FLANGE, _LINK = HandFelt  # looked up in every tick
