"""Drop: payloads of 0.5 to 5 kg fall off an arm at rest or guided; and hands that grab, snatch and let go suddenly.

A grab rises in 10 to 50 ms, as a hand's does; a let-go takes no time at all. And a hand comes to carry a payload's weight, the
gripper opens, and the hand takes the payload away: nothing that is measured changes in that moment. Truth is read for scoring
alone.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from benchmarks.arms import heaviest, senses, strength
from benchmarks.common import NO_CASE, Report, main, spread
from benchmarks.hold import IDLE, enter, flange, lift
from benchmarks.payload import SETTINGS, Case, draw, simulation
from benchmarks.use import free_way
from pendant.all_settings import Settings, apply
from pendant.events.event import Kind
from pendant.tick.modes import Mode
from sim.exchange.desk import Wishes
from sim.plant.changes import DropPayload
from sim.plant.touch import Pull, Push, Touch
from sim.simulation import Simulation

Array = NDArray[np.float64]

LONG = apply(SETTINGS, {"free_drive.period": 10.0})
PACE = 0.25  # [m/s] of the hand that guides
HANDS = 10  # touches in one run
LIGHTEST = 0.3  # [kg] that a drop ought to be noticed of
MISTAKEN = 1.0 / 2000.0  # touches that may be taken for a drop, at most


class Drop(NamedTuple):
    """One drop."""

    case: Case
    guided: bool


class Fall(NamedTuple):
    """What came of it."""

    drop: Drop
    entered: bool
    speed: float  # of the flange when it dropped [m/s]
    delay: float  # to STOP [ms], infinite without
    rise: float  # against gravity, beyond what the same speed needs to stop [mm]
    ended: bool  # out of free-drive in the end
    noticed: bool  # as a payload that fell


class Touched(NamedTuple):
    """A run of hands on one arm."""

    entered: bool
    touches: int
    stops: int
    kinds: tuple[str, ...]


def measure_drop(drop: Drop) -> Fall:
    """Guide or wait, drop, look for 1.5 s."""
    settings: Settings = apply(LONG, {"free_drive.period": 1.5, "free_drive.restart_period": 1.0})
    device = simulation(drop.case, settings)
    way = free_way(device, np.random.default_rng([drop.case.seed, drop.case.number, 9])) if drop.guided else None
    entered = enter(device)
    target, pace = flange(device) / 1000.0, 0.0
    before, speed = flange(device), np.zeros(3)

    def touches() -> tuple[Touch, ...]:
        if way is None:
            return ()
        return (Pull("flange", (0.0, 0.0, 0.0), tuple(target.tolist()), 40.0),)

    for _ in range(400 if drop.guided else 100):
        if way is not None:
            pace = min(pace + 0.002, PACE)
            target = target + 0.002 * pace * way
        device.tick(Wishes(IDLE.inputs, touches(), ()))
        now = flange(device)
        speed, before = (now - before) * 0.5, now
    # the hand that guided lets go with the drop: it has nothing to hold on to
    return fall(device, drop, entered, speed)


def fall(device: Simulation, drop: Drop, entered: bool, speed: Array) -> Fall:
    """The payload falls, and nobody touches the arm, whose flange goes at that speed (3,) [m/s]."""
    start, up = flange(device), lift(device, 1.0)
    up /= np.linalg.norm(up)
    delay, highest, mode, noticed = float("inf"), 0.0, Mode.FREE_DRIVE, False
    for tick in range(1500):
        decision = device.tick(Wishes(IDLE.inputs, (), (DropPayload(),) if tick == 0 else ()))
        mode = decision.mode
        noticed = noticed or any(event.kind is Kind.STOPPED_PAYLOAD for event in decision.events)
        highest = max(highest, float((flange(device) - start) @ up))
        if mode is Mode.STOP and delay == float("inf"):
            delay = 2.0 * (tick + 1)
    own = max(float(speed @ up), 0.0)
    stopping = 1000.0 * own * 0.06  # [mm] what a stop from that speed takes anyway: 15 mm from 250 mm/s
    return Fall(drop, entered, float(np.linalg.norm(speed)), delay, highest - stopping, mode is not Mode.FREE_DRIVE, noticed)


def measure_taken(case: Case) -> Fall:
    """A hand comes to carry the payload, and takes it away after another 0.3 s; entered is an arm that is still free then."""
    device = simulation(case, LONG)
    enter(device)
    weight = lift(device, case.true) * np.random.default_rng([case.seed, case.number, 13]).uniform(0.9, 1.1)
    before, speed, mode = flange(device), np.zeros(3), Mode.TEACH
    for tick in range(400):
        push = Push("flange", (0.0, 0.0, 0.0), tuple((min(tick / 250.0, 1.0) * weight).tolist()))
        mode = device.tick(Wishes(IDLE.inputs, (push,), ())).mode
        now = flange(device)
        speed, before = (now - before) * 0.5, now
    return fall(device, Drop(case, True), mode is Mode.FREE_DRIVE, speed)


def measure_hands(case: Case) -> Touched:
    """Grabs, snatches and let-goes of 10 to 60 N in any direction, one after the other, on a weaker arm by weaker hands."""
    rng = np.random.default_rng([case.seed, case.number, 11])
    device = simulation(case, LONG)
    entered = enter(device)
    stops, touched = 0, 0
    kinds: list[str] = []
    for _ in range(HANDS if entered else 0):
        direction = rng.normal(size=3)
        direction /= np.linalg.norm(direction)
        size, rise, held = strength(case.arm) * rng.uniform(10.0, 60.0), int(rng.integers(5, 26)), int(rng.integers(10, 60))
        sudden = rng.uniform() < 0.5  # the let-go: at once, or as the grab came
        touched += 1
        for tick in range(rise + held + rise + 200):
            share = min((tick + 1) / rise, 1.0)
            if tick >= rise + held:
                share = 0.0 if sudden else max(1.0 - (tick - rise - held + 1) / rise, 0.0)
            push = Push("flange", (0.0, 0.0, 0.0), tuple((share * size * direction).tolist()))
            decision = device.tick(Wishes(IDLE.inputs, (push,), ()))
            kinds += [event.kind.value for event in decision.events if event.kind in STOPS]
            if decision.mode is not Mode.FREE_DRIVE:
                break
        if device.tick(IDLE).mode is not Mode.FREE_DRIVE:
            stops += device.tick(IDLE).mode is Mode.STOP
            break
    return Touched(entered, touched, stops, tuple(kinds))


STOPS = {Kind.STOPPED_PAYLOAD, Kind.STOPPED_MOTION, Kind.STOPPED_LIMIT, Kind.STOPPED_WALL, Kind.LEFT_LIMIT}


def measure(report: Report) -> None:
    """Fill the report."""
    count = 160 if report.options.full else 24
    rng = np.random.default_rng([report.options.seed, 3])
    arm = report.options.arm
    cases, _ = draw(report.options.seed + 700, count // 4, "sensor", arm)
    drops: list[Drop] = []
    for k, case in enumerate(cases):
        mass = float(rng.uniform(2.0, heaviest(arm)) if k % 3 else rng.uniform(0.5, 2.0))
        drops.append(Drop(case._replace(true=mass, configured=mass), bool(k % 2)))
    falls = [fall for fall in spread(measure_drop, drops) if fall.entered]
    if senses(arm):
        lightest = [Drop(case._replace(true=LIGHTEST, configured=LIGHTEST), bool(k % 2)) for k, case in enumerate(cases)]
        found = [fall for fall in spread(measure_drop, lightest) if fall.entered]
        for how, guided in (("at rest", False), ("guided", True)):
            some = [fall for fall in found if fall.drop.guided is guided]
            report.share(f"drops of {LIGHTEST:g} kg, {how}: noticed", sum(fall.noticed for fall in some), len(some))
        rise = max(fall.rise for fall in found)
        report.row(f"drops of {LIGHTEST:g} kg: rise beyond stopping", rise, "mm", at_most=20.0, n=len(found))
    heavy = [fall for fall in falls if fall.drop.case.true >= 2.0]
    light = [fall for fall in falls if fall.drop.case.true < 2.0]
    n = len(heavy)
    if senses(arm):  # without one no fall is known, it is the arm's motion that ends free-drive
        report.row("drops of 2 kg or more: STOP after, longest", max(f.delay for f in heavy), "ms", at_most=20.0, n=n)
    report.row("drops of 2 kg or more: rise beyond stopping", max(f.rise for f in heavy), "mm", at_most=20.0, n=n)
    n = len(light)
    report.row("drops of 0.5 to 2 kg: rise beyond stopping", max(f.rise for f in light), "mm", at_most=20.0, n=n)
    report.share("drops of 0.5 to 2 kg: out of free-drive", sum(f.ended for f in light), n, at_least=1.0)
    for f in sorted(falls, key=lambda f: -f.rise)[:4]:
        how = "guided" if f.drop.guided else "at rest"
        report.notes.append(f"{f.drop.case.true:.1f} kg, {how}, {f.speed:.2f} m/s: STOP {f.delay:.0f} ms, rise {f.rise:.1f} mm")
    taken_away = [case._replace(true=(mass := float(rng.uniform(2.0, heaviest(arm)))), configured=mass) for case in cases]
    some = [each for each in spread(measure_taken, taken_away) if each.entered]
    what = "a hand carries the payload, 2 kg or more, and takes it away"
    report.share(f"{what}: out of free-drive", sum(each.ended for each in some), len(some))
    report.row(f"{what}: rise beyond stopping", max((each.rise for each in some), default=NO_CASE), "mm", n=len(some))
    runs = spread(measure_hands, [case._replace(configured=case.true) for case in hands(report)])
    touches = sum(run.touches for run in runs)
    report.share("grabs, snatches and let-goes: STOP", sum(run.stops for run in runs), touches, at_most=0.01)
    taken = sum(run.kinds.count(Kind.STOPPED_PAYLOAD.value) for run in runs)
    report.share("grabs, snatches and let-goes: taken for a drop", taken, touches, at_most=MISTAKEN)
    kinds = sorted({kind for run in runs for kind in run.kinds})
    report.notes.append("hands ended free-drive by: " + (", ".join(kinds) or "nothing"))


def hands(report: Report) -> list[Case]:
    """Arms to lay hands on."""
    count = 640 if report.options.full else 24
    return draw(report.options.seed + 900, count // 4, "sensor", report.options.arm)[0]


if __name__ == "__main__":
    main("drop", measure)
