"""Force over time: how an effort of a session's hand rises, stays and falls. A profile gives a factor on the effort's force."""

import math
from typing import Annotated

import msgspec
from msgspec import Meta

from pendant.settings.bounds import MOST_STEPS, Gain, Share, Time

Frequency = Annotated[float, Meta(ge=0.01, le=100.0)]  # of a hand that trembles [Hz]


class Profile(msgspec.Struct, frozen=True, forbid_unknown_fields=True, kw_only=True, tag_field="shape"):
    """Base of all profiles."""

    def factor(self, t: float, length: float) -> float:
        """Factor on the force, `t` seconds after the start of an effort of `length` seconds, 0 <= t <= length."""
        raise NotImplementedError


class Constant(Profile, tag="constant", frozen=True, kw_only=True):
    """All of it at once, to the end."""

    def factor(self, t: float, length: float) -> float:
        """See `Profile.factor`."""
        return 1.0


class Ramp(Profile, tag="ramp", frozen=True, kw_only=True):
    """Rises in `rise`, stays, falls in `fall`; both straight."""

    rise: Time = 0.2  # [s]
    fall: Time = 0.2  # [s]

    def factor(self, t: float, length: float) -> float:
        """See `Profile.factor`."""
        up = t / self.rise if self.rise > 0 else 1.0
        down = (length - t) / self.fall if self.fall > 0 else 1.0
        return min(1.0, up, down)


class HalfSine(Profile, tag="half-sine", frozen=True, kw_only=True):
    """A bump: half a period of a sine, its peak in the middle."""

    def factor(self, t: float, length: float) -> float:
        """See `Profile.factor`."""
        return math.sin(math.pi * t / length)


class Tremor(Profile, tag="tremor", frozen=True, kw_only=True):
    """A hand that trembles: a ramp, times 1 + share·sin(2 pi frequency t)."""

    rise: Time = 0.2  # [s]
    fall: Time = 0.2  # [s]
    frequency: Frequency = 8.0  # of a physiological tremor: 6..12 [Hz]
    share: Share = 0.1  # amplitude, as a share of the force

    def factor(self, t: float, length: float) -> float:
        """See `Profile.factor`."""
        wave = 1.0 + self.share * math.sin(2.0 * math.pi * self.frequency * t)
        return wave * Ramp(rise=self.rise, fall=self.fall).factor(t, length)


class Points(Profile, tag="points", frozen=True, kw_only=True):
    """Straight between given points; before the first and after the last as those."""

    times: Annotated[list[Time], Meta(min_length=2, max_length=MOST_STEPS)]  # after the start, rising [s]
    factors: Annotated[list[Gain], Meta(max_length=MOST_STEPS)]

    def __post_init__(self) -> None:
        """Check that the lists fit each other."""
        if len(self.times) != len(self.factors):
            raise ValueError(f"{len(self.times)} times but {len(self.factors)} factors: one factor a time is needed")
        if any(b <= a for a, b in zip(self.times, self.times[1:], strict=False)):
            raise ValueError(f"times {self.times} must rise")

    def factor(self, t: float, length: float) -> float:
        """See `Profile.factor`."""
        if t <= self.times[0]:
            return self.factors[0]
        for i in range(1, len(self.times)):
            if t <= self.times[i]:
                share = (t - self.times[i - 1]) / (self.times[i] - self.times[i - 1])
                return self.factors[i - 1] + share * (self.factors[i] - self.factors[i - 1])
        return self.factors[-1]


AnyProfile = Constant | Ramp | HalfSine | Tremor | Points
