"""Encoders of conveyors: they count pulses at digital inputs, or a program tells their count (URScript manual, encoder_*)."""

from collections.abc import Callable, Sequence
from enum import IntEnum

from app.urscript.language.trouble import Misuse
from pendant.tick.modes import TICK

RANGES = ((-(1 << 31), 1 << 32), (0, 1 << 8), (0, 1 << 16), (0, 1 << 24), (0, 1 << 32))
"""Lowest count, and how many there are, by the number of a range."""

QUADRATURE = {(0b00, 0b10): 1, (0b10, 0b11): 1, (0b11, 0b01): 1, (0b01, 0b00): 1}
"""Steps forward of the bits A and B; A comes first."""


class Decoder(IntEnum):
    """What counts at the inputs."""

    NONE = 0
    QUADRATURE = 1
    BOTH_EDGES = 2
    RISING = 3
    FALLING = 4


class Encoder:
    """One of them; each count wraps around at the ends of its range.

    Attributes:
        count: of ticks.
        ready: a program has set it up.
        told: a program tells its count.
    """

    def __init__(self) -> None:
        self.count = 0
        self.ready = self.told = False
        self._decoder, self._inputs, self._bits = Decoder.NONE, (0, 0), 0
        self._lowest, self._many = RANGES[0]
        self._part = 0.0  # of a tick that a conveyor has turned it by

    def decode(self, decoder: Decoder, inputs: tuple[int, int]) -> None:
        """Count pulses at digital inputs A and B from now on, from 0."""
        self._begin(0)
        self._decoder, self._inputs, self.ready, self.told = decoder, inputs, decoder is not Decoder.NONE, False

    def be_told(self, range_: int) -> None:
        """Be told the count from now on."""
        self._begin(range_)
        self._decoder, self.ready, self.told = Decoder.NONE, True, True

    def tell(self, count: int) -> None:
        """The count, by the program. Raises Misuse: it is out of range."""
        if not self._lowest <= count < self._lowest + self._many:
            raise Misuse(f"count: {count}, allowed: {self._lowest} to {self._lowest + self._many - 1}")
        self.count = count

    def unwound(self, change: float) -> float:
        """A difference of two counts, without what wrapping around adds to it."""
        half = 0.5 * self._many
        return (change + half) % self._many - half if abs(change) > half else change

    def step(self, bits: int, rate: float = 0.0) -> None:
        """One tick, with these digital inputs; `rate`: of pulses that come faster than inputs are read [1/s]."""
        if self._decoder is Decoder.NONE:
            return
        a, b = self._inputs
        before, self._bits = self._bits, (bits >> a & 1) << 1 | bits >> b & 1
        self._part += rate * TICK
        whole = int(self._part)
        self._part -= whole
        self._count(whole + self._pulses(before, self._bits))

    def _pulses(self, before: int, now: int) -> int:
        if before == now:
            return 0
        if self._decoder is Decoder.QUADRATURE:
            return QUADRATURE.get((before, now), 0) - QUADRATURE.get((now, before), 0)
        rose, fell = not before & 0b10 and now & 0b10, before & 0b10 and not now & 0b10
        counted = {Decoder.BOTH_EDGES: rose or fell, Decoder.RISING: rose, Decoder.FALLING: fell}
        return int(bool(counted[self._decoder]))

    def _count(self, ticks: int) -> None:
        self.count = (self.count + ticks - self._lowest) % self._many + self._lowest

    def _begin(self, range_: int) -> None:
        self.count, self._part = 0, 0.0
        self._lowest, self._many = RANGES[range_]


class ConveyorEncoders:
    """Both of a robot.

    Args:
        bits: gives the digital inputs.
        rates: gives how fast the laboratory has conveyors turn them [1/s].
        show: takes number and count of one that has changed.
    """

    def __init__(self, bits: Callable[[], int], rates: Callable[[], Sequence[float]], show: Callable[[int, int], None]) -> None:
        self._bits, self._rates, self._show = bits, rates, show
        self._all = (Encoder(), Encoder())
        self._shown = [0, 0]

    def __getitem__(self, index: int) -> Encoder:
        return self._all[index]

    def step(self) -> None:
        """One tick."""
        for index, encoder in enumerate(self._all):
            if encoder.ready:
                if not encoder.told:
                    encoder.step(self._bits(), self._rates()[index])
                if encoder.count != self._shown[index]:
                    self._shown[index] = encoder.count
                    self._show(index, encoder.count)
