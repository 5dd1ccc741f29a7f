"""Confirmation of a rule: seen in so many of the last ticks, in a row or all but some of them (CD-9)."""


class Confirmation:
    """Counts one rule's sightings."""

    __slots__ = ("_seen",)

    def __init__(self) -> None:
        self._seen = 0  # the last ticks as bits, the newest lowest

    def clear(self) -> None:
        """Forget what was seen."""
        self._seen = 0

    def step(self, sightings: int, count: int, misses: int) -> bool:
        """Take in one tick: True where it holds a sighting and the last `count + misses` hold `count` of them.

        A tick without one counts as one miss, a tick with several as so many ticks.
        """
        bits = (self._seen << sightings) | ((1 << sightings) - 1) if sightings else self._seen << 1
        bits &= (1 << (count + misses)) - 1
        self._seen = bits
        return sightings > 0 and bits.bit_count() >= count
