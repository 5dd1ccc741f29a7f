"""Contacts behind the flange sensor, felt by the joints: which link is touched, from its onset to its release (CD-2, CD-7, CD-8).

The slow rule, on the torques that the joints feel and the flange sensor does not: the newest mean against stored means. What a
link is pushed with turns that link's joint and those before it, and none beyond: the last joint that feels it tells the link
(Haddadin, De Luca, Albu-Schaeffer: Robot Collisions: A Survey on Detection, Isolation, and Identification, IEEE Transactions on
Robotics 33(6), 2017, section V). A push is reported once as it begins and once as it has gone, whatever it does between.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from pendant.contact.confirmation import Confirmation
from pendant.contact.contact_change import Change
from pendant.contact.contact_rules import HEAVIEST
from pendant.contact.history import MASK, SIZE, History
from pendant.contact.settings import ContactUse
from pendant.tick.pose import Vector
from pendant.tick.source_signal import ContactSignals

Array = NDArray[np.float64]

LINKS = ("elbow", "forearm", "wrist")
"""The parts that are told apart: what the joints before the elbow feel, what the elbow feels, too, and what joints beyond do."""
NEWEST = 20
"""Ticks of the newest mean: half a swing of the arm on its springs, which its model does not see in time."""
STORED = 20
"""Ticks of the stored means that it is held against."""
LAGS = (20, 60)
"""Their ages."""
SEEN = 5
"""Newest ticks whose mean tells the force and the acceleration at a sighting: half of the newest mean may be from before it."""
HELD = 40
"""Ticks of the mean that tells what is left of a contact: a swing."""
SHARE = 0.12
"""Of the largest torque that a joint feels: less at a joint farther out is an error of the model there."""
SURE = 0.4
"""Share of its bound from which on a joint feels a change that another joint has shown: two deviations."""
ENDED = 0.3
"""Share of the torques felt before, below which a change is a contact that ends: errors of the model alone are not so large."""
LEFT = 0.2
"""Share of a contact's largest torque lately, below which it has gone."""
LATELY = 0.996
"""By which that largest torque fades a tick: by two thirds in half a second."""
GONE = 12
"""Ticks in a row for which it must be gone: an arm that swings back feels little for less."""
CALM = 25
"""Ticks in a row in which the torques change by less than their bound, before a contact may begin again (CD-9a)."""
SETTLED = 20
"""Ticks over which they are looked at for that."""
SILENCE = 500
"""Ticks after which contacts are looked for again although the torques have not settled."""
BEFORE = 100
"""Age of the stored mean that tells what was before a change: older than any that a sighting holds the newest against."""
BEGUN = 0.2
"""Share of the change at the sighting, from which on a sample belongs to it."""


class Felt(NamedTuple):
    """A change of the contact of a link; vectors in B."""

    change: Change
    link: int  # of `LINKS`
    force: Vector  # change of the force of the arm on the outside [N]
    acceleration: Vector  # change of that of the link's point [m/s²]
    steps: int  # ticks back to its beginning


class Torques:
    """The last torques of n joints, and means over any part of them from running sums; age 0 is the newest."""

    __slots__ = ("_at", "_sums", "count")

    def __init__(self) -> None:
        self._sums: Array = np.zeros((SIZE, 0))
        self._at = 0
        self.count = 0  # since the last gap, at most SIZE - 1

    def push(self, torques: Array) -> None:
        """Take one tick (n,) [N·m]."""
        if self._sums.shape[1] != torques.size:
            self._sums, self.count = np.zeros((SIZE, torques.size)), 0
        before, self._at = self._at, (self._at + 1) & MASK
        self._sums[self._at] = self._sums[before] + torques
        self.count = min(self.count + 1, MASK)

    def gap(self) -> None:
        """A tick is missing: what was before it counts no more."""
        self._sums[self._at] = 0.0
        self.count = 0

    def mean(self, age: int, length: int) -> Array:
        """Mean (n,) of `length` ticks, the newest of them `age` ticks old; age + length <= count [N·m]."""
        sums = self._sums
        return (sums[(self._at - age) & MASK] - sums[(self._at - age - length) & MASK]) / length


class LinkWatch:
    """Watches the links behind the flange sensor. At most one of them is in contact, as far as is known."""

    __slots__ = ("_age", "_begun", "_bound", "_calm", "_count", "_largest", "_rest", "points", "silent", "torques", "touched")

    def __init__(self) -> None:
        self.points = (History(), History())  # force and acceleration at the elbow, and at the forearm's end
        self.torques = Torques()
        self.touched: int | None = None  # which of `LINKS`
        self.silent = False  # after a release, until the torques have settled
        self._begun = False  # there is something to forget
        self._count = Confirmation()
        self._rest: Array = np.zeros(0)  # torques before the contact [N·m]
        self._bound: Array = np.zeros(0)  # the least bound of a torque since then [N·m]
        self._largest = 0.0  # contact torque lately, over its bound
        self._calm = 0  # ticks for which the contact has been gone, or the torques calm
        self._age = 0  # ticks since the last change

    def sense(self, signals: ContactSignals) -> None:
        """Take one tick into the buffers; one in which the joints or the sensor do not tell is a gap."""
        if not signals.behind.size:
            if self.torques.count:
                self.gap()
            return
        elbow, forearm = signals.each()[2:4]
        assert elbow is not None
        assert forearm is not None
        if elbow.saturated:
            self.gap()
            return
        self.torques.push(signals.behind)
        self.points[0].push(elbow)
        self.points[1].push(forearm)

    def gap(self) -> None:
        """What was before counts no more, and nothing is known to be touched."""
        self.torques.gap()
        for point in self.points:
            point.gap()
        self.forget()

    def forget(self) -> None:
        """Start again with what is in the buffers, free of contact as far as is known."""
        if not self._begun:
            return
        self._begun = False
        self.touched, self.silent = None, False
        self._count.clear()

    def step(self, use: ContactUse, signals: ContactSignals, scale: float) -> Felt | None:
        """One tick, after `sense`; `scale` is that of all thresholds."""
        if self.torques.count < SETTLED + NEWEST:
            return None
        self._begun = True
        bound = signals.doubt * (use.link_limit * scale)
        new = self.torques.mean(0, NEWEST)
        if self.touched is not None:
            return self._held(new, bound, signals.elbow)
        if self.silent:
            self._settle(new, bound, signals.elbow)
            return None
        return self._onset(new, bound, use, signals.elbow)

    def _onset(self, new: Array, bound: Array, use: ContactUse, elbow: int) -> Felt | None:
        """Free: what a joint up to the elbow feels beyond errors of model and sensors is a contact that begins.

        Or it is one that ends, where less is felt than before: it began too gently to be seen.
        """
        sightings = 0
        for lag in LAGS:
            if self.torques.count >= lag + STORED:
                felt = np.abs(new - self.torques.mean(lag, STORED))[: elbow + 1] / bound[: elbow + 1]
                sightings = max(sightings, int(felt.max()))
        if not self._count.step(min(sightings, HEAVIEST), use.slow_count, use.misses):
            return None
        lag = min(BEFORE, self.torques.count - STORED)
        old = self.torques.mean(lag, STORED)
        change = np.abs(new - old)
        told = np.flatnonzero((change >= SURE * bound) & (change >= SHARE * change.max()))
        last = int(told[-1]) if told.size else elbow - 1
        link = min(max(last - elbow + 1, 0), len(LINKS) - 1)
        largest = float((change / bound)[: elbow + 1].max())
        if float((np.abs(new) / bound).max()) < ENDED * float((np.abs(old) / bound).max()) and (np.abs(old) > 2.0 * bound).any():
            self._over()
            return self._felt(Change.LOST, link, new, old, lag)
        self.touched, self._calm, self._age = link, 0, 0
        self._rest, self._bound, self._largest = old, bound, largest
        return self._felt(Change.GAINED, link, new, old, lag)

    def _held(self, new: Array, bound: Array, elbow: int) -> Felt | None:
        """In contact: it has gone where little is left of its torques."""
        self._age += 1
        self._bound = np.minimum(self._bound, bound)
        if self._age < HELD:  # that mean still holds ticks from before the contact
            return None
        left = float((np.abs(self.torques.mean(0, HELD) - self._rest) / self._bound)[: elbow + 1].max())
        self._largest = max(left, LATELY * self._largest)
        self._calm = self._calm + 1 if left < max(1.0, LEFT * self._largest) else 0
        if self._calm < GONE or self.touched is None:
            return None
        link, lag = self.touched, min(BEFORE, self.torques.count - STORED)
        self._over()
        return self._felt(Change.LOST, link, new, self.torques.mean(lag, STORED), lag)

    def _over(self) -> None:
        self.touched, self.silent, self._calm, self._age = None, True, 0, 0
        self._count.clear()

    def _settle(self, new: Array, bound: Array, elbow: int) -> None:
        """After a release: silent until the torques are calm; then statistics start again (CD-9a)."""
        self._age += 1
        calm = bool((np.abs(new - self.torques.mean(SETTLED, NEWEST)) < bound)[: elbow + 1].all())
        self._calm = self._calm + 1 if calm else 0
        if self._calm >= CALM or self._age >= SILENCE:
            self.silent = False
            self.torques.count = SETTLED + NEWEST

    def _felt(self, change: Change, link: int, new: Array, old: Array, lag: int) -> Felt:
        """What is reported: force and acceleration at the link, as the newest mean and the stored one tell them (CD-16)."""
        point = self.points[min(link, 1)]
        n, o = point.mean(0, SEEN), point.mean(lag, STORED)
        force, acceleration = (n[0] - o[0], n[1] - o[1], n[2] - o[2]), (n[3] - o[3], n[4] - o[4], n[5] - o[5])
        way = new - old
        least, steps = BEGUN * float(way @ way), 0
        while steps < lag + NEWEST and float((self.torques.mean(steps, 1) - old) @ way) > least:
            steps += 1
        return Felt(change, link, force, acceleration, max(steps - 1, 0))
