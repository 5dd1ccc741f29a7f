"""One arm in free-drive, watched by the observer: a fall, a step of the sensor, hands."""

import math
from typing import NamedTuple

import numpy as np

from benchmarks.drop import LONG, PACE
from benchmarks.hold import IDLE, enter, flange, lift
from benchmarks.payload import Case, simulation
from benchmarks.use import free_way
from pendant.all_settings import Settings, apply
from pendant.sensor.hand_model import KNOWN, SUSPECTED
from pendant.tick.modes import Mode
from sim.exchange.desk import Wishes
from sim.plant.changes import AnyChange, DropPayload, SensorFault
from sim.plant.touch import Pull, Push, Touch
from sim.simulation import Simulation

WATCHED = apply(LONG, {"free_drive.period": 20.0, "unexplained.payload": False})
UNANSWERED = apply(WATCHED, {"unexplained.sensor": False})  # a sensor that steps is used on
JUDGED = 30  # ticks after the fall
TOUCHES = 10  # on one arm


class Fall(NamedTuple):
    """One payload that falls."""

    case: Case
    how: str


class Step(NamedTuple):
    """One step of the sensor."""

    case: Case
    how: str
    size: float  # [N]


class Seen(NamedTuple):
    """What the observer makes of one case."""

    what: str
    mass: float  # [kg]
    odds: float  # that the payload changed, the best, log [nats]
    stepped: float  # that the sensor stepped
    known: float  # ticks until a fall is known, infinite without
    told: float  # ticks until a step is suspected and the help gone, infinite without


class Watch:
    """The observer, on one arm in free-drive."""

    def __init__(self, device: Simulation, mass: float) -> None:
        self._device, self.mass = device, mass
        self.begin()

    def begin(self) -> None:
        """A case begins."""
        self._ticks, self._odds, self._stepped = 0, -math.inf, -math.inf
        self._known = self._told = math.inf

    def tick(self, touches: tuple[Touch, ...] = (), changes: tuple[AnyChange, ...] = ()) -> bool:
        """One tick; whether the arm is still free."""
        decision = self._device.tick(Wishes(IDLE.inputs, touches, changes))
        estimate = self._device.estimate
        self._ticks += 1
        if self._known == math.inf:
            self._odds = max(self._odds, estimate.whose.lost_odds)
            self._stepped = max(self._stepped, estimate.whose.step_odds)
            if estimate.whose.lost_odds >= KNOWN:
                self._known = self._ticks
            if estimate.whose.step_odds >= SUSPECTED:
                self._told = min(self._told, self._ticks)
        return decision.mode is Mode.FREE_DRIVE

    def seen(self, what: str) -> Seen:
        """What came of the case."""
        return Seen(what, self.mass, self._odds, self._stepped, self._known, self._told)


def watch(case: Case, settings: Settings = WATCHED) -> tuple[Simulation, Watch | None]:
    """An arm in free-drive, and what watches it; None where it was not entered."""
    device = simulation(case, settings)
    if not enter(device):
        return device, None
    return device, Watch(device, case.true)


def measure_fall(fall: Fall) -> list[Seen]:
    """The time before, in which nothing falls, and the fall."""
    case, how = fall
    device, both = watch(case)
    if both is None:
        return []
    rng = np.random.default_rng([case.seed, case.number, 9])
    way = free_way(device, rng) if how in ("guided", "hand stays") else None
    weight = lift(device, case.true) * rng.uniform(0.97, 1.03)
    target, pace = flange(device) / 1000.0, 0.0

    def touches(tick: int) -> tuple[Touch, ...]:
        nonlocal target, pace
        if way is not None:
            pace = min(pace + 0.002, PACE)
            target = target + 0.002 * pace * way
            return (Pull("flange", (0.0, 0.0, 0.0), tuple(target.tolist()), 40.0),)
        if how == "carried":
            return (Push("flange", (0.0, 0.0, 0.0), tuple((min(tick / 50, 1.0) * weight).tolist())),)
        return ()

    if not all(both.tick(touches(tick)) for tick in range(100 if how == "rest" else 300)):
        return []
    before = both.seen("before")
    both.begin()
    for tick in range(JUDGED):
        both.tick(touches(tick) if how == "hand stays" else (), (DropPayload(),) if tick == 0 else ())
    return [before, both.seen(how)]


def measure_step(step: Step) -> list[Seen]:
    """The time before, in which nothing steps, and the step; a hand that guides goes on."""
    case, how, size = step
    device, both = watch(case, UNANSWERED)
    if both is None:
        return []
    rng = np.random.default_rng([case.seed, case.number, 13])
    direction = rng.normal(size=3)
    offsets = (size * direction / np.linalg.norm(direction)).tolist()
    changes = tuple(SensorFault(sensor="force_torque", channel=k, offset=offset) for k, offset in enumerate(offsets))
    way = free_way(device, rng) if how == "guided" else None
    target, pace = flange(device) / 1000.0, 0.0

    def touches() -> tuple[Touch, ...]:
        nonlocal target, pace
        if way is None:
            return ()
        pace = min(pace + 0.002, PACE)
        target = target + 0.002 * pace * way
        return (Pull("flange", (0.0, 0.0, 0.0), tuple(target.tolist()), 40.0),)

    if not all(both.tick(touches()) for _ in range(100 if how == "rest" else 300)):
        return []
    before = both.seen("before")
    both.begin()
    for tick in range(JUDGED):
        both.tick(touches(), changes if tick == 0 else ())
    return [before, both.seen(f"step {how}")]


def measure_touches(case: Case) -> list[Seen]:
    """Grabs, snatches and let-goes, as bench `drop` has them."""
    _, both = watch(case)
    found: list[Seen] = []
    rng = np.random.default_rng([case.seed, case.number, 11])
    for _ in range(TOUCHES if both is not None else 0):
        assert both is not None
        both.begin()
        direction = rng.normal(size=3)
        direction /= np.linalg.norm(direction)
        size, rise, held = rng.uniform(10.0, 60.0), int(rng.integers(5, 26)), int(rng.integers(10, 60))
        sudden = rng.uniform() < 0.5
        free = True
        for tick in range(rise + held + rise + 100):
            share = min((tick + 1) / rise, 1.0)
            if tick >= rise + held:
                share = 0.0 if sudden else max(1.0 - (tick - rise - held + 1) / rise, 0.0)
            free = free and both.tick((Push("flange", (0.0, 0.0, 0.0), tuple((share * size * direction).tolist())),))
        if not free:
            break
        found.append(both.seen("touch"))
    return found
