"""Takes the measures of one run, tick by tick; reads the truth as scoring does, after the tick."""

import math
from collections.abc import Callable

import mujoco
import numpy as np

from app.session.event_watch import PeriodRuns
from app.session.expectations import Value
from app.session.measures import ValueWatch, displacement
from app.session.triggers import Trigger
from app.studies.study_measures import (
    AnyMeasure,
    ContactForce,
    EventCount,
    EventTime,
    HasHappened,
    MeasuredDelay,
    OfKinds,
    OfLog,
    Passed,
    PeriodLength,
    QuantityStatistic,
    Statistic,
    StudyMeasure,
    WayMeasure,
)
from pendant.decision import Decision
from pendant.settings.schema import ticks
from pendant.tick.modes import TICK
from sim.exchange.scoring import point_of
from sim.plant.touch import Triple
from sim.simulation import Simulation

Number = float | bool | None


class Total:
    """A statistic of numbers that come one by one."""

    def __init__(self, statistic: Statistic) -> None:
        self._statistic = statistic
        self._count, self._sum, self._squares = 0, 0.0, 0.0
        self._low, self._high, self._last = math.inf, -math.inf, math.nan

    def add(self, value: float) -> None:
        """One more."""
        self._count += 1
        self._sum += value
        self._squares += value * value
        self._low, self._high, self._last = min(self._low, value), max(self._high, value), value

    def value(self) -> float | None:
        """Of all so far; None without any."""
        if not self._count:
            return None
        match self._statistic:
            case "largest":
                return self._high
            case "smallest":
                return self._low
            case "mean":
                return self._sum / self._count
            case "rms":
                return math.sqrt(self._squares / self._count)
            case "last":
                return self._last


class Taker:
    """Base: one measure, followed through a run."""

    def __init__(self, measure: StudyMeasure) -> None:
        self._trigger = Trigger(measure.after, measure.nth)
        self._begin = ticks(measure.begin)
        self._end = None if measure.end is None else ticks(measure.end)

    def see(self, tick: int, decision: Decision) -> None:
        """Take in one tick."""
        start = self._trigger.happened
        if start is None:
            self._trigger.see(tick, decision)
            start = self._trigger.happened
            if start is None:
                return
        if start + self._begin <= tick and (self._end is None or tick <= start + self._end):
            self.look(tick, decision, start)

    def look(self, tick: int, decision: Decision, start: int) -> None:
        """Take in one tick of the interval, which counts from the tick `start`."""
        raise NotImplementedError

    def value(self) -> Number:
        """What was measured; None: nothing."""
        raise NotImplementedError


class EventsTaker(Taker):
    """Takes measures of events."""

    def __init__(self, measure: OfKinds) -> None:
        super().__init__(measure)
        self._measure, self._kinds = measure, measure.matching()
        self._count, self._first = 0, None

    def look(self, tick: int, decision: Decision, start: int) -> None:
        """See `Taker.look`."""
        for event in decision.events:
            if event.kind.value in self._kinds:
                self._count += 1
                self._first = (tick - start) * TICK if self._first is None else self._first

    def value(self) -> Number:
        """See `Taker.value`."""
        if isinstance(self._measure, HasHappened):
            return self._count > 0
        return float(self._count) if isinstance(self._measure, EventCount) else self._first


class QuantityTaker(Taker):
    """Takes a quantity that expectations know."""

    def __init__(self, measure: QuantityStatistic, simulation: Simulation) -> None:
        super().__init__(measure)
        self._total, self._glance = Total(measure.statistic), simulation.glance
        joints = list(simulation.arm.chain.joints)
        self._watch = _Passing(
            joints, Trigger(None), wanted=Value(of=measure.of, joint=measure.joint, min=0.0), min=None, max=None
        )
        self._watch.told = self._total.add

    def look(self, tick: int, decision: Decision, start: int) -> None:
        """See `Taker.look`."""
        self._watch.look(tick, decision, self._glance)

    def value(self) -> Number:
        """See `Taker.value`."""
        return self._total.value()


class _Passing(ValueWatch):
    """Reads a quantity as an expectation does, and passes it on."""

    told: Callable[[float], None]

    def number(self, value: float, tick: int) -> None:
        """See `BoundsWatch.number`."""
        self.told(value)


class WayTaker(Taker):
    """Takes a displacement."""

    def __init__(self, measure: WayMeasure, simulation: Simulation) -> None:
        super().__init__(measure)
        self._measure, self._glance, self._joints = measure, simulation.glance, list(simulation.arm.chain.joints)
        self._begun_at: Triple | None = None
        self._total = Total(measure.statistic)

    def look(self, tick: int, decision: Decision, start: int) -> None:
        """See `Taker.look`."""
        now = point_of(self._glance(), self._joints, self._measure.part)
        self._begun_at = now if self._begun_at is None else self._begun_at
        self._total.add(displacement(now, self._begun_at, self._measure.along))

    def value(self) -> Number:
        """See `Taker.value`."""
        return self._total.value()


class PeriodTaker(Taker):
    """Takes the length of a period."""

    def __init__(self, measure: PeriodLength) -> None:
        super().__init__(measure)
        self._wanted, self._runs = measure.run, PeriodRuns(measure.period)

    def look(self, tick: int, decision: Decision, start: int) -> None:
        """See `Taker.look`."""
        self._runs.see(tick, decision)

    def value(self) -> Number:
        """See `Taker.value`."""
        ended = self._runs.ended
        return ended[self._wanted - 1].length * TICK if len(ended) >= self._wanted else None


class ContactTaker(Taker):
    """Takes what the true contacts of the arm say: the first one's beginning, and forces."""

    def __init__(self, measure: MeasuredDelay | ContactForce, simulation: Simulation) -> None:
        super().__init__(measure)
        self._measure, self._plant = measure, simulation.plant
        model = self._plant.model
        self._of_arm = [model.geom(k).name.startswith("shape/") for k in range(model.ngeom)]
        self._wrench = np.zeros(6)
        self._onset: float | None = None  # [s]
        self._delay: float | None = None
        self._most = 0.0
        self._place = self._plant.poses()[-1][:3].copy()

    def look(self, tick: int, decision: Decision, start: int) -> None:
        """See `Taker.look`."""
        data, deepest = self._plant.data, None
        for k in range(data.ncon):
            contact = data.contact[k]
            if self._of_arm[int(contact.geom1)] != self._of_arm[int(contact.geom2)]:
                deepest = min(contact.dist, math.inf if deepest is None else deepest)
                if isinstance(self._measure, ContactForce):
                    mujoco.mj_contactForce(self._plant.model, data, k, self._wrench)
                    self._most = max(self._most, float(self._wrench[0]))
        if isinstance(self._measure, ContactForce):
            return
        if self._onset is None:
            place = self._plant.poses()[-1][:3].copy()
            if deepest is not None:
                # Within the tick: by how deep it is in at the end, and how far the flange went in the tick.
                way = math.dist(place, self._place)
                self._onset = tick * TICK - TICK * (min(1.0, max(0.0, -deepest) / way) if way > 0.0 else 1.0)
            self._place = place
        if self._onset is not None and self._delay is None and any(each.kind in self._measure.kinds for each in decision.events):
            # A tick's decision acts from its beginning; one of the tick of the contact cannot know of it.
            delay = (tick - 1) * TICK - self._onset
            self._delay = 1000.0 * delay if delay >= 0.0 else None

    def value(self) -> Number:
        """See `Taker.value`."""
        return self._most if isinstance(self._measure, ContactForce) else self._delay


def taker(measure: AnyMeasure, simulation: Simulation) -> Taker | None:
    """What takes a measure while the run goes; None for one that is taken after it."""
    match measure:
        case HasHappened() | EventCount() | EventTime():
            return EventsTaker(measure)
        case QuantityStatistic():
            return QuantityTaker(measure, simulation)
        case WayMeasure():
            return WayTaker(measure, simulation)
        case PeriodLength():
            return PeriodTaker(measure)
        case MeasuredDelay() | ContactForce():
            return ContactTaker(measure, simulation)
        case Passed() | OfLog():
            return None
