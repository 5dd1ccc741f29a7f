"""Contacts behind the flange sensor, felt by the joints: which link is touched, from its onset to its release (CD-2, CD-7, CD-8).

The slow rule, on the torques that the joints feel and the flange sensor does not: the newest mean against stored means. What a
link is pushed with turns that link's joint and those before it, and none beyond: the last joint that feels it tells the link
(Haddadin, De Luca, Albu-Schaeffer: Robot Collisions: A Survey on Detection, Isolation, and Identification, IEEE Transactions on
Robotics 33(6), 2017, section V). A push is reported once as it begins and once as it has gone, whatever it does between.
"""

from collections import deque
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from pendant.contact.confirmation import Confirmation
from pendant.contact.contact_change import Change
from pendant.contact.contact_rules import HEAVIEST
from pendant.contact.history import SIZE, History
from pendant.contact.joint_torques import Torques
from pendant.contact.settings import ContactUse
from pendant.tick.pose import Vector
from pendant.tick.source_signal import ContactSignals

Array = NDArray[np.float64]

LINKS = ("elbow", "forearm", "wrist")
"""The parts that are told apart: what the joints before the elbow feel, what the elbow feels, too, and what joints beyond do."""
ELBOW = 2
"""Source of `ContactSignals` that tells force and acceleration at the elbow; the next one those at the forearm's end."""
NEWEST = 10
"""Ticks of the newest mean: the encoders' noise is less than a tenth of a bound in it."""
FOLLOW = 0.0066
"""Share a tick by which what counts as no contact follows what is felt: a time constant of 0.3 s, so that a hand that comes
within a tenth of a second is there before it is followed, and what masses and encoders are wrong by in a motion is followed."""
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
LEFT = 0.3
"""Share of a contact's largest torque lately, below which it has gone: springs may be wrong by a fifth."""
LATELY = 0.996
"""By which that largest torque fades a tick: by two thirds in half a second."""
STRAYED = 2.0
"""Bounds by which what counts as no contact may have strayed meanwhile, for it is not followed: within them,"""
HALF = 0.45
"""this share of a contact's largest torque lately is enough to call it gone."""
GONE = 12
"""Ticks in a row for which it must be gone: an arm that swings back feels little for less."""
LETTING_GO = 30
"""Ticks within which a hand lets go, with the mean that shows it: 50 ms and half of that mean."""
BEFOREHAND = 120
"""Ticks that it is looked for in: `HELD`, `GONE`, and what an arm swings meanwhile."""
DROP = 0.65
"""Share of what is felt for sure that letting go takes at least: all of it but for a swing,"""
SUDDEN = 2.0
"""so many times what as many ticks took before: a lever that goes through zero as the arm moves takes as much in them;"""
CLEARLY = 1.5
"""and so many bounds: a swing takes less (guarded by the bench `link_hands`)."""
FADED = 500
"""Ticks after which a contact that faded has gone, too: an arm at 0.15 m/s has passed the levers at which 60 N are not felt."""
CALM = 25
"""Ticks in a row in which the torques change by less than their bound, before a contact may begin again (CD-9a)."""
SETTLED = 20
"""Ticks over which they are looked at for that."""
SILENCE = 500
"""Ticks after which contacts are looked for again although the torques have not settled."""
BEFORE = 100
"""Age of the oldest sample that may be the first of a contact."""
BEGUN = 0.2
"""Share of the change at the sighting, from which on a sample belongs to it."""


class LinkChange(NamedTuple):
    """A change of the contact of a link; vectors in B."""

    change: Change
    link: int  # of `LINKS`
    force: Vector  # change of the force of the arm on the outside [N]
    acceleration: Vector  # change of that of the link's point [m/s²]
    steps: int  # ticks back to its beginning


def _felt(new: Array, old: Array, signals: ContactSignals) -> tuple[Array, Array]:
    """What each joint feels of a contact in the change of torques and causes, and how wrong that may be, each (n,) [N·m].

    Friction at rest may hold as much as it can one way before, and the other way now.
    """
    n, (shares, misfit) = signals.joints, signals.known
    felt, causes = _of_contact(new - old, shares)
    wrong = misfit * causes
    return felt, np.sqrt(np.vecdot(wrong, wrong)) + (new[-n:] + old[-n:])


def _of_contact(change: Array, shares: Array) -> tuple[Array, Array]:
    """What each joint feels of a contact in a change of torques and causes (n,) [N·m], and the change of the causes (n, m)."""
    n = len(shares)
    causes = change[n:-n].reshape(shares.shape)
    return change[:n] - np.vecdot(shares, causes), causes


def _sizes(new: Array, old: Array, limit: Array, signals: ContactSignals) -> tuple[float, float]:
    """What a joint up to the elbow feels in a change, and what of it its errors cannot make; the largest of each, in bounds."""
    felt, wrong = _felt(new, old, signals)
    size = np.abs(felt)
    return float((size / limit)[: signals.elbow + 1].max()), max(float(((size - wrong) / limit)[: signals.elbow + 1].max()), 0.0)


class LinkWatch:
    """Watches the links behind the flange sensor. At most one of them is in contact, as far as is known."""

    __slots__ = (
        "_age",
        "_begun",
        "_calm",
        "_count",
        "_faded",
        "_largest",
        "_left_out",
        "_rest",
        "_unread",
        "points",
        "silent",
        "torques",
        "touched",
    )

    def __init__(self) -> None:
        self.points = (History(), History())  # force and acceleration at the elbow, and at the forearm's end
        self._unread = deque[ContactSignals](maxlen=SIZE)  # that these have not got yet: they are seldom asked
        self.torques = Torques()  # that the joints feel, the causes of their errors, and what friction may hold of them
        self.touched: int | None = None  # which of `LINKS`
        self.silent = False  # after a release, until the torques have settled
        self._begun = False  # there is something to forget
        self._left_out = False  # of this tick nothing is known
        self._count = Confirmation()
        self._rest: Array = np.zeros(0)  # torques and causes where nothing is touched; empty: not known
        self._largest = 0.0  # contact torque lately, over its bound
        self._calm = 0  # ticks for which the contact has been gone, or the torques calm
        self._faded = 0  # ticks for which nothing of the contact is felt
        self._age = 0  # ticks since the last change

    def sense(self, signals: ContactSignals) -> None:
        """Take one tick into the buffers. Without joints it is a gap; with the sensor at the end of its range it is left out."""
        if not signals.joints:
            if self.torques.count:
                self.gap()
            return
        self._left_out = signals.saturated(ELBOW)
        if self._left_out:
            return
        self.torques.push(signals.felt)
        self._unread.append(signals)

    def gap(self) -> None:
        """What was before counts no more, and nothing is known to be touched."""
        self.torques.gap()
        self._unread.clear()
        for point in self.points:
            point.gap()
        self._rest = np.zeros(0)
        self.forget()

    def forget(self) -> None:
        """Start again with what is in the buffers, free of contact as far as is known."""
        if not self._begun:
            return
        self._begun = False
        self.touched, self.silent = None, False
        self._rest = np.zeros(0)
        self._count.clear()

    def step(self, use: ContactUse, signals: ContactSignals, scale: float) -> LinkChange | None:
        """One tick, after `sense`; `scale` is that of all thresholds."""
        if self._left_out or self.torques.count < SETTLED + NEWEST:
            return None
        self._begun = True
        new = self.torques.mean(0, NEWEST)
        if not self._rest.size:
            self._rest = self.torques.mean(NEWEST, SETTLED)
        limit = signals.doubt * (use.link_limit * scale)
        if self.touched is not None:
            return self._held(new, limit, signals)
        if self.silent:
            self._settle(new, limit, signals)
            return None
        return self._onset(new, limit, use, signals)

    def _onset(self, new: Array, limit: Array, use: ContactUse, signals: ContactSignals) -> LinkChange | None:
        """Free: what a joint up to the elbow feels beyond errors of model and sensors is a contact that begins.

        Or it is one that ends, where less is felt than before: it began too gently to be seen.
        """
        elbow, n = signals.elbow, limit.size
        felt, _ = _of_contact(new - self._rest, signals.known[0])
        if float((np.abs(felt) / limit)[: elbow + 1].max()) < 1.0:  # so nobody asks how wrong it may be
            self._count.step(0, use.slow_count, use.misses)
            self._follow(new, signals)
            return None
        felt, wrong = _felt(new, self._rest, signals)
        bound = limit + wrong
        largest = float((np.abs(felt) / bound)[: elbow + 1].max())
        if not self._count.step(min(int(largest), HEAVIEST), use.slow_count, use.misses):
            if largest < 1.0:
                self._follow(new, signals)
            return None
        change = np.abs(felt)
        told = np.flatnonzero((change >= SURE * bound) & (change >= SHARE * change.max()))
        last = int(told[-1]) if told.size else elbow - 1
        link = min(max(last - elbow + 1, 0), len(LINKS) - 1)
        old, nothing = self._rest, np.zeros_like(new)
        before, now = (np.abs(_felt(each, nothing, signals)[0]) / bound for each in (old, new))
        if now.max() < ENDED * before.max() and before.max() > 2.0:
            self._over()
            return self._reported(Change.LOST, link, new[:n], old[:n])
        self.touched, self._calm, self._age, self._largest = link, 0, 0, 0.0
        self._faded = 0
        return self._reported(Change.GAINED, link, new[:n], old[:n])

    def _follow(self, new: Array, signals: ContactSignals) -> None:
        """What counts as no contact follows; not where the arm stands and friction may hide a hand that comes slowly."""
        now = FOLLOW * (new - self._rest)
        if signals.stands:
            hides = new[-signals.joints :] > 0.0
            each = now[signals.joints : -signals.joints].reshape((signals.joints, -1))
            now[: signals.joints][hides], now[-signals.joints :][hides], each[hides] = 0.0, 0.0, 0.0
        self._rest += now

    def _held(self, new: Array, limit: Array, signals: ContactSignals) -> LinkChange | None:
        """In contact: it has gone where little is left of its torques, at once if they went as fast as a hand lets go."""
        self._age += 1
        if self._age < HELD:  # that mean still holds ticks from before the contact
            return None
        size, left = _sizes(self.torques.mean(0, HELD), self._rest, limit, signals)
        self._largest = max(left, LATELY * self._largest)
        gone = max(1.0, LEFT * self._largest, min(STRAYED, HALF * self._largest))
        if self._calm > GONE:  # it has faded: what strays meanwhile is no hand that is felt again
            gone = max(gone, STRAYED)
        self._calm = self._calm + 1 if left < gone else 0
        # What may be an error may as well be a hand: only what is not felt at all has faded.
        self._faded = self._faded + 1 if size < gone else 0
        gone_now = self._calm > 0 and self._calm % GONE == 0 and self._let_go(limit, signals)
        if self.touched is None or not (gone_now or self._faded == FADED):
            return None
        link, n, touched = self.touched, limit.size, self.torques.mean(min(BEFORE, self.torques.count - NEWEST), NEWEST)
        self._over()
        return self._reported(Change.LOST, link, new[:n], touched[:n])

    def _let_go(self, limit: Array, signals: ContactSignals) -> bool:
        """What some joint felt went as fast as a hand goes. Where it faded, the arm may have moved until no joint has a lever."""
        ages = range(0, min(BEFOREHAND + LETTING_GO, self._age, self.torques.count - NEWEST), NEWEST)
        means, n, last = [self.torques.mean(age, NEWEST) for age in ages], LETTING_GO // NEWEST, signals.elbow + 1
        for new, old, older in zip(means, means[n : BEFOREHAND // NEWEST], means[2 * n :] + means[-1:] * n, strict=False):
            felt, wrong = (each[:last] for each in _felt(old, self._rest, signals))
            left, _ = _felt(new, self._rest, signals)
            went, doubt = _felt(old, new, signals)
            before, _ = _felt(older, old, signals)
            sudden = np.maximum(DROP * (np.abs(felt) - wrong), SUDDEN * np.abs(before[:last]))
            sudden = np.maximum(sudden, CLEARLY * limit[:last])
            if ((np.abs(left[:last]) < np.abs(felt)) & (np.abs(went[:last]) - doubt[:last] >= sudden)).any():
                return True
        return False

    def _over(self) -> None:
        self.touched, self.silent, self._calm, self._age = None, True, 0, 0
        self._count.clear()

    def _settle(self, new: Array, limit: Array, signals: ContactSignals) -> None:
        """After a release: silent until the torques are calm; then statistics start again (CD-9a)."""
        self._age += 1
        self._rest = self.torques.mean(SETTLED, NEWEST)
        calm = _sizes(new, self._rest, limit, signals)[1] < 1.0
        self._calm = self._calm + 1 if calm else 0
        if self._calm >= CALM or self._age >= SILENCE:
            self.silent = False

    def _reported(self, change: Change, link: int, new: Array, old: Array) -> LinkChange:
        """What is reported: force and acceleration at the link, as the newest mean and the stored one tell them (CD-16)."""
        for signals in self._unread:
            for each, signal in zip(self.points, signals.each(ELBOW, ELBOW + len(self.points)), strict=True):
                assert signal is not None
                each.push(signal)
        self._unread.clear()
        point, n = self.points[min(link, 1)], new.size
        oldest = min(BEFORE, self.torques.count - NEWEST)
        way = new - old
        least, steps = BEGUN * float(way @ way), 0
        while steps < oldest and float((self.torques.mean(steps, 1)[:n] - old) @ way) > least:
            steps += 1
        lag = min(steps + NEWEST, oldest)
        now, then = point.mean(0, SEEN), point.mean(lag, min(SEEN, point.count - lag))
        force = (now[0] - then[0], now[1] - then[1], now[2] - then[2])
        acceleration = (now[3] - then[3], now[4] - then[4], now[5] - then[5])
        return LinkChange(change, link, force, acceleration, max(steps - 1, 0))
