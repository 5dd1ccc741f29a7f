"""Ring buffers of signals, and means and variances over any part of them from running sums (CD-4, CD-6, CD-8)."""

from statistics import median

from pendant.tick.source_signal import Signal

SIZE = 512
"""Samples kept: a second. A power of two, so that an index wraps by a mask."""

MASK = SIZE - 1

SUMMED = 256
"""Samples that sums begin with when nobody has asked for any so far: more than the longest window of any rule."""

Six = tuple[float, float, float, float, float, float]

NO_SUM: Six = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
"""Where sums start again; of their squares: NO_SQUARES."""

NO_SQUARES = (0.0, 0.0)


class History:
    """The last samples of one source; age 0 is the newest.

    Beside each sample stands the sum of all samples up to it (three of force, three of acceleration, and the squares of both
    sizes), so a mean or a variance over any window is one difference, and a tick costs the same whatever the windows are.
    Sums are made when they are asked for: a detector that is off only keeps the samples.
    """

    __slots__ = ("_at", "_behind", "_samples", "_squares", "_sums", "clean", "count")

    def __init__(self) -> None:
        self._samples: list[Signal] = [Signal(0.0, 0.0, 0.0, 0.0, 0.0, 0.0)] * SIZE
        self._sums: list[Six] = [NO_SUM] * SIZE
        self._squares: list[tuple[float, float]] = [NO_SQUARES] * SIZE
        self._at = 0  # where the newest stands
        self._behind = 0  # newest samples that are not in the sums yet
        self.count = 0  # samples since the last gap, at most SIZE - 1
        self.clean = 0  # of them, those since the last saturated one

    def push(self, signal: Signal) -> None:
        """Take one sample."""
        self._at = at = (self._at + 1) & MASK
        self._samples[at] = signal
        self._behind += 1
        if self.count < MASK:
            self.count += 1
        self.clean = 0 if signal.saturated else min(self.clean + 1, self.count)

    def _sum_up(self) -> None:
        """Bring the sums up to the newest sample."""
        behind = self._behind
        if behind > SUMMED:  # nobody listened for long
            self.shorten(SUMMED)
            behind = self.count
            self._sums[(self._at - behind) & MASK] = NO_SUM
            self._squares[(self._at - behind) & MASK] = NO_SQUARES
        sx, sy, sz, tx, ty, tz = self._sums[(self._at - behind) & MASK]
        ff, aa = self._squares[(self._at - behind) & MASK]
        for age in range(behind - 1, -1, -1):
            at = (self._at - age) & MASK
            fx, fy, fz, ax, ay, az = self._samples[at][:6]
            sx, sy, sz, tx, ty, tz = sx + fx, sy + fy, sz + fz, tx + ax, ty + ay, tz + az
            ff, aa = ff + fx * fx + fy * fy + fz * fz, aa + ax * ax + ay * ay + az * az
            self._sums[at] = (sx, sy, sz, tx, ty, tz)
            self._squares[at] = (ff, aa)
        self._behind = 0

    def gap(self) -> None:
        """A sample is missing: what was before it counts no more."""
        self._sums[self._at] = NO_SUM
        self._squares[self._at] = NO_SQUARES
        self.count = self.clean = self._behind = 0

    def shorten(self, length: int) -> None:
        """Only the newest `length` samples count from now on."""
        self.count, self.clean = min(self.count, length), min(self.clean, length)

    def sample(self, age: int) -> Signal:
        """The sample of `age` ticks ago, 0 <= age < count."""
        return self._samples[(self._at - age) & MASK]

    def mean(self, age: int, length: int) -> Six:
        """Mean force [N] and acceleration [m/s²] of `length` samples, the newest of them `age` ticks old."""
        if self._behind:
            self._sum_up()
        sums = self._sums
        a, b, c, d, e, f = sums[(self._at - age) & MASK]
        u, v, w, x, y, z = sums[(self._at - age - length) & MASK]
        share = 1.0 / length
        return (a - u) * share, (b - v) * share, (c - w) * share, (d - x) * share, (e - y) * share, (f - z) * share

    def median(self, age: int, length: int) -> Six:
        """Median of each component of force [N] and acceleration [m/s²], of `length` samples, the newest `age` ticks old."""
        a, b, c, d, e, f = zip(*(self.sample(age + k)[:6] for k in range(length)), strict=True)
        return median(a), median(b), median(c), median(d), median(e), median(f)

    def variances(self, age: int, length: int, mean: Six) -> tuple[float, float]:
        """Of force [N²] and acceleration [m²/s⁴], each the mean of its three axes, about `mean`, that of the same samples."""
        f, a = self._squares[(self._at - age) & MASK]
        g, b = self._squares[(self._at - age - length) & MASK]
        x, y, z, u, v, w = mean
        force = ((f - g) / length - x * x - y * y - z * z) / 3.0
        acceleration = ((a - b) / length - u * u - v * v - w * w) / 3.0
        return max(force, 0.0), max(acceleration, 0.0)
