"""A hand on a link, told by the joints that it turns while nobody is felt at the flange (FD-19)."""

from pendant.estimate import Estimate

LEAST = 0.012
"""Of a joint's rated torque: so much in the direction in which it turns is a hand. An error of the friction estimate is less."""

UNSURE = 0.5
"""And of the standard deviation of what the joints feel: the gear's unknown stiffness, of which a part of the load changes."""

TURNS = 0.02  # a joint that is slower says nothing of who turns it [rad/s]


class LinkPush:
    """What each joint felt in the direction in which it turned, since somebody was last felt: who pushes a link turns its joints.

    The mean is over swings of the arm. It is asked only while nobody is felt at the flange.
    """

    __slots__ = ("_before", "_rated", "_sums", "_ticks")

    def __init__(self, before: tuple[float, ...], rated: tuple[float, ...]) -> None:
        """
        Args:
            before: tau_ext at entry, which is nobody's [N·m].
            rated: torque of each joint [N·m].
        """
        self._before, self._rated = before, rated
        self._ticks, self._sums = 0, [0.0] * len(rated)

    @property
    def memory(self) -> tuple[object, ...]:
        """All of its state, to compare."""
        return (self._ticks, tuple(self._sums), self._before)

    def begin(self) -> None:
        """Nobody is felt at the flange from here on."""
        self._ticks, self._sums = 0, [0.0] * len(self._rated)

    def step(self, estimate: Estimate) -> None:
        """One tick in which the arm moves and nobody is felt at the flange."""
        self._ticks += 1
        sums = self._sums
        felt = zip(estimate.qd.tolist(), estimate.tau_ext.tolist(), self._before, strict=True)
        for i, (speed, now, before) in enumerate(felt):
            if speed >= TURNS:
                sums[i] += now - before
            elif speed <= -TURNS:
                sums[i] += before - now

    def told(self, estimate: Estimate) -> bool:
        """Whether a joint was pushed, in the mean over those ticks."""
        each = zip(self._sums, self._rated, estimate.tau_ext_deviation.tolist(), strict=True)
        return self._ticks > 0 and any(
            felt >= self._ticks * max(LEAST * rated, UNSURE * deviation) for felt, rated, deviation in each
        )
