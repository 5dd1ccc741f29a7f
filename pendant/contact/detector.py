"""One contact detector: the rules side by side on one source, and what the change was (CD-9a, CD-10, CD-13, CD-14)."""

import math
from typing import NamedTuple

from pendant.contact.confirmation import Confirmation
from pendant.contact.contact_change import Change
from pendant.contact.contact_limits import ContactLimits
from pendant.contact.contact_rules import NEW, Rule, clear, contact_force, hard, slow, statistical, values
from pendant.contact.history import History, Six
from pendant.contact.settings import ContactUse, RulesNeeded
from pendant.tick.pose import Vector
from pendant.tick.source_signal import Signal

BEFORE = 10
"""Samples of the mean that a change is measured from."""
LONGEST = 60
"""Ticks before a sighting in which its first suspicious sample is looked for."""
SUSPICIOUS = 2.0
"""Deviations of noise beyond which a sample belongs to the change: one in forty that does not, does by chance."""
SETTLED = 10
"""Ticks over which a settled force hardly changes (CD-9a)."""
CALM = 6
"""Ticks in a row for which that must hold: a ringing force looks settled now and then."""
PATIENCE = 40
"""Ticks after which a change of an existing contact is judged although the force has not settled, if it falls no more."""
FALLS = 0.95
"""Share of the force that is left after `SETTLED` ticks, below which it falls: an object that parts slowly takes some time."""
SILENCE = 250
"""Ticks after which a detector listens again although the force has not settled."""
GONE = 100
"""Ticks without any force after which a contact counts as over."""
SMALL = 0.35
"""Share of the force before, below which what is left counts as small (CD-13)."""


class Finding(NamedTuple):
    """A change in contact as one source saw it; vectors in the source's axes, as in `Signal`."""

    change: Change
    rule: Rule
    force: Vector  # change of the contact force, as the rule saw it [N]
    acceleration: Vector  # change of the acceleration, as the rule saw it [m/s²]
    ratio: float  # of the two [kg]
    steps: int  # ticks back to the first suspicious sample


class _Sighting(NamedTuple):
    rule: Rule
    since: int  # ticks back to the first suspicious sample, when it was seen
    before: Six  # mean force and acceleration before it
    force: Vector  # change of the contact force [N]
    acceleration: Vector  # change of the acceleration [m/s²]
    ratio: float  # of the two [kg]


class Detector:
    """Watches one source. Its buffers fill in every tick, its rules count only while it is switched on (CD-1, CD-4)."""

    __slots__ = ("_age", "_begun", "_calm", "_counts", "_gone", "_pending", "_rest", "history", "silent", "touching")

    def __init__(self) -> None:
        self.history = History()
        self._begun = False  # there is something to forget
        self.touching = False  # in contact, as far as is known
        self.silent = False  # after an event, until the force has settled
        self._rest: Six | None = None  # force and acceleration before contact was gained
        self._counts = {rule: Confirmation() for rule in Rule}
        self._pending: _Sighting | None = None  # a change of an existing contact, to be judged when the force has settled
        self._age = 0  # ticks since the sighting
        self._calm = 0  # ticks for which the force has been settled
        self._gone = 0  # ticks for which a contact's force has been gone

    def sense(self, signal: Signal | None) -> None:
        """Take one tick's signal into the buffers; None: the source is not valid."""
        if signal is None:
            self.history.gap()
            self.forget()
        else:
            self.history.push(signal)

    def forget(self) -> None:
        """Start again with what is in the buffers, free of contact as far as is known."""
        if not self._begun:
            return
        self._begun = False
        self.touching, self.silent = False, False
        self._rest, self._pending = None, None
        self._clear()

    def step(self, use: ContactUse, limit: ContactLimits) -> Finding | None:
        """One tick of the rules, after `sense`."""
        if self.history.count == 0:
            return None
        self._begun = True
        if self.silent:
            return self._wait(limit)
        seen = self._rule(use, limit)
        if seen is None:
            self._watch_rest(limit)
            return None
        rule, length, dead = seen
        sighting = self._look_back(rule, length, limit)
        self.silent, self._age, self._gone = True, 0, 0
        self._clear()
        if self.touching:
            self._pending = sighting
            return None
        self.touching, self._rest = True, sighting.before
        return self._finding(Change.CLAMPING if dead else Change.GAINED, sighting)

    def _rule(self, use: ContactUse, limit: ContactLimits) -> tuple[Rule, int, bool] | None:
        """The rule that saw a change, how far back the change may reach, and whether the acceleration has died out."""
        history, counts, misses, hard_count = self.history, self._counts, use.misses, use.hard_count
        of_values = ratio_of_values = False
        # Values show that something is touched. A change of it they cannot show: its force is there before and after, and an
        # arm that swings against it has an acceleration opposite to it in every other half of the swing.
        instant = use.instant and not self.touching
        if instant or (use.ratio_of_values and not self.touching):
            of_values, ratio_of_values = values(history, limit)
        wanted = use.difference + use.ratio
        seen = self._hard(use, limit, ratio_of_values and use.ratio_of_values) if wanted else []
        if instant:
            wanted += 1
            if counts[Rule.INSTANT].step(of_values, hard_count, misses):
                seen.append((Rule.INSTANT, NEW, False))
        if use.statistical:
            wanted += 1
            if counts[Rule.STATISTICAL].step(statistical(history, limit), use.soft_count, misses):
                seen.append((Rule.STATISTICAL, use.tested + use.soft_count, False))
        if use.slow:
            wanted += 1
            sightings, dead = slow(history, limit)
            if counts[Rule.SLOW].step(sightings, use.slow_count, misses):
                seen.append((Rule.SLOW, LONGEST, dead))
        if not seen or (use.rules_needed is RulesNeeded.ALL and len(seen) < wanted):
            return None
        return seen[0]

    def _hard(self, use: ContactUse, limit: ContactLimits, of_values: bool) -> list[tuple[Rule, int, bool]]:
        """Difference and ratio rule, as `_rule`; `of_values`: the values of now show the ratio, too (CD-4, CD-5)."""
        counts, misses, hard_count = self._counts, use.misses, use.hard_count
        seen: list[tuple[Rule, int, bool]] = []
        change, step = hard(self.history, limit), max(use.force_step, use.acceleration_step)
        if use.difference:
            confirmed = counts[Rule.DIFFERENCE].step(change.difference, hard_count, misses)
            if confirmed or (use.retrospective and clear(self.history, limit)) or (change.difference and self._older(use, limit)):
                seen.append((Rule.DIFFERENCE, step + max(hard_count, use.older_pairs), False))
        if use.ratio and counts[Rule.RATIO].step(change.ratio or of_values, hard_count, misses):
            seen.append((Rule.RATIO, step + hard_count, False))
        return seen

    def _older(self, use: ContactUse, limit: ContactLimits) -> bool:
        """Every older pair of samples shows the difference, too: the buffer confirms it (CD-9)."""
        ages = range(1, use.older_pairs + 1)
        return use.older_pairs > 0 and all(hard(self.history, limit, age).difference for age in ages)

    def _look_back(self, rule: Rule, length: int, limit: ContactLimits) -> _Sighting:
        """Find the first suspicious sample: the change's direction is known now, so go back while samples lie in it."""
        history, mass = self.history, limit.mass
        count = history.count
        start = min(length, count - 1)
        before = history.mean(start, min(BEFORE, count - start))
        rest, now = contact_force(before, mass), contact_force(history.mean(0, min(2, count)), mass)
        ux, uy, uz = now[0] - rest[0], now[1] - rest[1], now[2] - rest[2]
        size = math.sqrt(ux * ux + uy * uy + uz * uz) or 1.0
        noise = SUSPICIOUS * math.sqrt(limit.force_variance + mass * mass * limit.acceleration_variance)
        first = 0
        for age in range(start):
            fx, fy, fz = contact_force(history.sample(age)[:6], mass)
            if (fx - rest[0]) * ux + (fy - rest[1]) * uy + (fz - rest[2]) * uz < noise * size:
                break
            first = age
        # How many of the newest samples the rule compared.
        looked_at = {Rule.STATISTICAL: limit.tested, Rule.SLOW: limit.newest}.get(rule, 1)
        seen = history.mean(0, min(looked_at, count))
        return _Sighting(rule, first, before, *_change(before, seen, limit))

    def _finding(self, change: Change, sighting: _Sighting) -> Finding:
        """What is reported of a sighting: the kind is of now, force and acceleration are those that the rule saw (CD-16)."""
        _, since, _, force, acceleration, ratio = sighting
        return Finding(change, sighting.rule, force, acceleration, ratio, since + self._age)

    def _wait(self, limit: ContactLimits) -> Finding | None:
        """A tick of silence (CD-9a); at its end the change of an existing contact is judged, and statistics start again."""
        self._age += 1
        self._calm = self._calm + 1 if self._age >= SETTLED + NEW and self._settled(limit) else 0
        settled = self._calm >= CALM
        finding = None
        if self._pending is not None and (settled or (self._age >= PATIENCE and not self._falls(limit))):
            finding, self._pending = self._judge(self._pending, limit), None
        if settled or self._age >= SILENCE:
            self.silent = False
            self.history.shorten(SETTLED + NEW)
            if self.touching and self._rest is not None and self._alike(self.history.mean(0, NEW), self._rest, limit):
                self.touching, self._rest = False, None
        return finding

    def _falls(self, limit: ContactLimits) -> bool:
        """The force of the contact grows less, and something of it is left."""
        assert self._rest is not None
        history = self.history
        before, now = (self._size(history.mean(age, NEW), self._rest, limit) for age in (SETTLED, 0))
        return self._age < SILENCE and 0.0 < now < FALLS * before

    def _settled(self, limit: ContactLimits) -> bool:
        history = self.history
        return self._alike(history.mean(0, NEW), history.mean(SETTLED, NEW), limit)

    def _watch_rest(self, limit: ContactLimits) -> None:
        """A contact that went too gently to be seen is over when its force has been gone for a while."""
        if self._rest is None:
            return
        gone = self._alike(self.history.mean(0, NEW), self._rest, limit)
        self._gone = self._gone + 1 if gone else 0
        if self._gone >= GONE:
            self.touching, self._rest = False, None

    def _judge(self, sighting: _Sighting, limit: ContactLimits) -> Finding:
        """Lost where the force is small again; else its resistance has changed."""
        assert self._rest is not None
        before = self._size(sighting.before, self._rest, limit)
        after = self._size(self.history.mean(0, SETTLED + NEW), self._rest, limit)
        change = Change.RESISTANCE
        if after <= SMALL * before:
            change, self.touching, self._rest = Change.LOST, False, None
        return self._finding(change, sighting)

    def _size(self, sample: Six, rest: Six, limit: ContactLimits) -> float:
        """Contact force against `rest` beyond what noise and a wrong payload may explain [N]."""
        mass = limit.mass
        fx, fy, fz = contact_force(sample, mass)
        gx, gy, gz = contact_force(rest, mass)
        change = math.dist(sample[3:], rest[3:])
        return max(0.0, math.dist((fx, fy, fz), (gx, gy, gz)) - limit.slow_force - limit.payload_margin * change)

    def _alike(self, sample: Six, rest: Six, limit: ContactLimits) -> bool:
        """Noise and a wrong payload may explain all of the contact force between the two."""
        return self._size(sample, rest, limit) == 0.0

    def _clear(self) -> None:
        for count in self._counts.values():
            count.clear()


def _change(before: Six, now: Six, limit: ContactLimits) -> tuple[Vector, Vector, float]:
    """Change of the contact force [N] and of the acceleration [m/s²] between two samples, and their ratio [kg]."""
    ax, ay, az = now[3] - before[3], now[4] - before[4], now[5] - before[5]
    gx, gy, gz = contact_force(before, limit.mass)
    hx, hy, hz = contact_force(now, limit.mass)
    fx, fy, fz = hx - gx, hy - gy, hz - gz
    ratio = (fx * ax + fy * ay + fz * az) / max(ax * ax + ay * ay + az * az, limit.acceleration_variance)
    return (fx, fy, fz), (ax, ay, az), ratio
