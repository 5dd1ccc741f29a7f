"""Motion and torque of a log as a fit takes them: evenly spaced, filtered without lag, with accelerations.

Both sides of the equation of motion pass the same filter, so that the jump of friction where a joint turns round is as smooth in
the model as it is in the filtered torque.

Source: Gautier, Dynamic identification of robots with power model, ICRA 1997; Swevers, Verdonck, De Schutter, Dynamic model
identification for industrial robots, IEEE Control Systems 27(5), 2007.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import binary_dilation, binary_opening
from scipy.signal import butter, sosfiltfilt

Array = NDArray[np.float64]

CUTOFF = 6.0
"""Of the filter [Hz]: programmed motions are slower, gears of an arm with 10 Hz and more ring above."""
FASTEST = 125.0
"""Rows a second that are used: a joint that turns round is seen to 8 ms."""
KEPT = 25.0
"""Samples a second that are kept at most: at twice the cut-off a sample already says little that its neighbours do not."""
EDGE = 0.3
"""Time at both ends of a stretch in which the filter knows one side alone [s]."""
PIECE = 60.0
"""Time that is filtered at once: so much is held in memory at the full rate [s]."""
LEAST_ROWS = 50
"""Of a stretch beside its edges: of fewer the filter knows nothing."""
REST, RESTS = 0.005, 0.05
"""A joint that is slower [rad/s] for longer [s] rests, and its friction is anything up to the breakaway."""
MEMORY = 0.15
"""Time round a sample of which the filter makes it [s]."""


@dataclass(frozen=True, slots=True)
class Samples:
    """Motion and torque of an arm of n joints in k moments, in order."""

    t: Array  # (k,) [s]
    q: Array  # (k, n) [rad]
    qd: Array  # (k, n) [rad/s]
    qdd: Array  # (k, n) [rad/s²]
    torque: Array  # (k, n) of the motors, referred to the output [N·m]
    slip: Array  # (k, n, m) sign(q') sqrt(|q'|)^(m-1) ... sign(q'), filtered as the torque
    moves: NDArray[np.bool_]  # (k, n) whether the joint moved all the time of which the sample is made

    def __getitem__(self, part: slice) -> "Samples":
        """Some of them."""
        return Samples(**{name: getattr(self, name)[part] for name in Samples.__slots__})


class EvenRows(NamedTuple):
    """Rows of a piece of a log at an even rate."""

    rate: float  # a second
    t: Array  # (k,) [s]
    q: Array  # (k, n) [rad]
    qd: Array  # (k, n) [rad/s]
    torque: Array  # (k, n) [N·m]


def sampled(stretches: Sequence[tuple[Array, Array, Array, Array]], speeds: Sequence[float], kept: float = KEPT) -> Samples:
    """Samples of the stretches of a log.

    Args:
        stretches: times (k,) rising [s], angles, speeds, motor torques (k, n) each.
        speeds: at which the friction curve has its m points, rising [rad/s]; it is level beyond both ends.
        kept: samples a second.
    """
    parts = [_of_piece(piece, speeds, kept) for stretch in stretches for piece in _pieces(*stretch)]
    if not parts:
        n = stretches[0][1].shape[1]
        nothing = EvenRows(FASTEST, np.zeros(LEAST_ROWS), *(np.zeros((LEAST_ROWS, n)) for _ in range(3)))
        return _of_piece(nothing, speeds, kept)[:0]
    return Samples(**{name: np.concatenate([getattr(part, name) for part in parts]) for name in Samples.__slots__})


def _pieces(t: Array, q: Array, qd: Array, torque: Array) -> Iterator[EvenRows]:
    """Pieces of a stretch, which overlap by what their edges lose."""
    rate = min(FASTEST, 1.0 / float(np.median(np.diff(t)))) if len(t) > 1 else 0.0
    start = float(t[0])
    while rate and t[-1] - start > 2.0 * EDGE + LEAST_ROWS / rate:
        end = min(start + PIECE, float(t[-1]))
        even = np.arange(start, end, 1.0 / rate)
        rows = slice(max(0, int(np.searchsorted(t, start)) - 1), int(np.searchsorted(t, end)) + 1)

        def regular(values: Array, even: Array = even, rows: slice = rows) -> Array:
            return np.column_stack([np.interp(even, t[rows], column) for column in values[rows].T])

        yield EvenRows(rate, even, regular(q), regular(qd), regular(torque))
        start = end - 2.0 * EDGE


def _of_piece(piece: EvenRows, speeds: Sequence[float], kept: float) -> Samples:
    rate, even, q, qd, torque = piece
    sections = butter(4, CUTOFF / (0.5 * rate), output="sos")

    def smooth(values: Array) -> Array:
        return sosfiltfilt(sections, values, axis=0)

    speed = smooth(qd)
    edge, every = round(EDGE * rate), max(1, round(rate / kept))
    keep = slice(edge, len(even) - edge, every)
    root = np.sqrt(np.clip(np.abs(qd), speeds[0], speeds[-1]))
    slip: Array = np.sign(qd)[..., None] * root[..., None] ** np.arange(len(speeds) - 1.0, -1.0, -1.0)
    rests = binary_opening(np.abs(qd) < REST, np.ones((max(2, round(RESTS * rate)), 1)))
    near = np.asarray(binary_dilation(rests, np.ones((2 * round(MEMORY * rate) + 1, 1))), dtype=np.bool_)
    return Samples(
        t=even[keep],
        q=smooth(q)[keep],
        qd=speed[keep],
        qdd=np.gradient(speed, 1.0 / rate, axis=0)[keep],
        torque=smooth(torque)[keep],
        slip=smooth(slip)[keep],
        moves=np.logical_not(near)[keep],
    )
