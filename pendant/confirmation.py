"""Confirmation of a rule: seen in so many of the last ticks, in a row or all but some of them (CD-9)."""


class Confirmation:
    """Counts one rule's sightings."""

    __slots__ = ("_seen",)

    def __init__(self) -> None:
        self._seen = 0  # the last ticks as bits, the newest lowest

    def clear(self) -> None:
        """Forget what was seen."""
        self._seen = 0

    def step(self, seen: bool, count: int, misses: int) -> bool:
        """Take in one tick: True where `count` of the last `count + misses` ticks saw it, this one too."""
        bits = ((self._seen << 1) | seen) & ((1 << (count + misses)) - 1)
        self._seen = bits
        return seen and bits.bit_count() >= count
