"""The payload wizard turns the wrist by itself: what it stops for, and what not (STRUCK and JOLTED of its turn_watch).

Loads of up to 5 kg that nobody entered, random postures and mountings. Nobody touches the arm; a hand pushes the flange while it
turns; something stands in the way of a wrist link, before the sensor. Truth is read for scoring alone.
"""

import math
from typing import NamedTuple

import numpy as np

from app.files.library import load_arm
from benchmarks.arms import USUAL
from benchmarks.common import Report, main, spread
from benchmarks.hold import IDLE, MOUNTINGS
from benchmarks.payload import postures
from pendant.all_settings import Settings
from pendant.events.event import Event, Kind
from pendant.inputs import Command, Inputs
from pendant.tick.modes import TICK_RATE, Law
from sim.arm.scenario import Load, Scenario
from sim.exchange.desk import Wishes
from sim.plant.touch import Push
from sim.simulation import Simulation

GRIDS = ("untouched", "pushed", "in the way")
RUN = Wishes(Inputs(commands=(Command.WIZARD_RUN,)), (), ())
SETTLE = 1.0  # [s] before it begins
LONGEST = 60.0  # [s] that it may take
PUSHES = (15.0, 30.0)  # of a hand, which rises within RISE [N]
RISE = 0.1  # [s]
STIFF, DAMPING = 75e3, 200.0  # of a hand in the way (ISO/TS 15066) [N/m, N s/m]
TRANSIENT, LASTING = 280.0, 140.0  # of a hand: largest force, and force that stays after half a second (ISO/TS 15066) [N]
AFTER = 1.0  # what stays is read so long after the end [s]
MASS_ERROR = 0.046  # docs/guide/tools.md [kg]
SLOW = 0.02  # a link that moves by less meets nothing yet [m/s]
WAITS = (0.1, 0.6)  # after the arm began to turn [s]
ENDS = {Kind.WIZARD_STOPPED, Kind.WIZARD_FINISHED, Kind.WIZARD_REFUSED}


class Case(NamedTuple):
    """One run of the wizard."""

    number: int
    seed: int
    mounting: str
    posture: tuple[float, ...]
    mass: float  # [kg]
    grid: str


class Result(NamedTuple):
    """What came of it."""

    end: str  # the event's kind; "" for none in time
    reason: str
    error: float  # of the mass that was found [kg], nan for none
    force: float  # of the hand as it stopped, or the largest of what stood in the way until then [N]
    stays: float  # of what stood in the way, a second after it stopped [N]
    delay: float  # from its beginning [s], nan where nothing touched


def measure_case(case: Case) -> Result:
    """From the command until it ends."""
    rng = np.random.default_rng([case.seed, case.number, GRIDS.index(case.grid)])
    centre = rng.uniform([-0.03, -0.03, 0.0], [0.03, 0.03, 0.1])
    device = Simulation(
        load_arm(USUAL),
        Scenario(
            mounting=list(MOUNTINGS[case.mounting]),
            posture=list(case.posture),
            payload_true=Load(mass=case.mass, com=centre.tolist()),
            seed=case.seed + case.number,
        ),
        Settings(),
    )
    for _ in range(round(SETTLE * TICK_RATE)):
        device.tick(IDLE)
    way = rng.normal(size=3)
    way /= np.linalg.norm(way)
    most, wait = float(rng.uniform(*PUSHES)), float(rng.uniform(*WAITS))
    turned, since, force, delay, decision = 0, 0, 0.0, math.nan, device.tick(RUN)
    before = device.snapshot().truth_links[-2, :3].copy()
    over, met, peak = 0, before, 0.0  # where the link meets what stands in its way
    events: list[Event] = list(decision.events)
    for _ in range(round(LONGEST * TICK_RATE)):
        over += any(event.kind in ENDS for event in events)
        if over > (AFTER * TICK_RATE if since and case.grid == "in the way" else 0):
            break
        turned += decision.law is Law.FOLLOW
        now = device.snapshot().truth_links[-2, :3].copy()
        speed, before = (now - before) * TICK_RATE, now
        begun = case.grid != "untouched" and turned > wait * TICK_RATE
        touches: tuple[Push, ...] = ()
        if begun and case.grid == "pushed":
            since += 1
            delay = since / TICK_RATE
            force = most * min(since / TICK_RATE / RISE, 1.0)
            touches = (Push("flange", (0.0, 0.0, 0.0), _triple(force * way)),)
        elif begun and (since or float(np.linalg.norm(speed)) > SLOW):
            if not since:
                met, way = now, speed / np.linalg.norm(speed)
            since += 1
            force = max(0.0, STIFF * float((now - met) @ way) + DAMPING * float(speed @ way)) if since > 1 else 0.0
            peak = max(peak, force)
            delay = since / TICK_RATE if not over else delay
            touches = (Push("wrist_3", (0.0, 0.0, 0.0), _triple(-force * way)),)
        decision = device.tick(Wishes(IDLE.inputs, touches, ()))
        events += decision.events
    end = next((event for event in events if event.kind in ENDS), None)
    found = decision.wizard.finding
    return Result(
        "" if end is None else end.kind.value,
        "" if end is None else str(end.values.get("reason", "")),
        math.nan if found is None else abs(found.mass - case.mass),
        force if case.grid == "pushed" else peak,
        force if case.grid == "in the way" else 0.0,
        delay,
    )


def _triple(vector: np.ndarray) -> tuple[float, float, float]:
    x, y, z = vector.tolist()
    return x, y, z


def draw(seed: int, count: int, grid: str) -> list[Case]:
    """`count` postures, each with a mounting and a load of its own."""
    rng = np.random.default_rng([seed, GRIDS.index(grid), 5])
    found, _ = postures(count, rng)
    mountings = list(MOUNTINGS)
    return [
        Case(number, seed, mountings[number % len(mountings)], posture, float(rng.uniform(0.0, 5.0)), grid)
        for number, posture in enumerate(found)
    ]


def measure(report: Report) -> None:
    """Fill the report."""
    count = 100 if report.options.full else 12
    results = {grid: spread(measure_case, draw(report.options.seed, count, grid)) for grid in GRIDS}
    calm = [r for r in results["untouched"] if r.end != Kind.WIZARD_REFUSED.value]
    finished = [r for r in calm if r.end == Kind.WIZARD_FINISHED.value]
    felt = [r for r in calm if r.end == Kind.WIZARD_STOPPED.value and "hands off" in r.reason]
    report.share("nobody touches: stopped for a force or a torque", len(felt), len(calm), at_most=0.01)
    report.share("nobody touches: finished", len(finished), len(calm))
    errors = [r.error for r in finished if not math.isnan(r.error)]
    report.row("nobody touches: error of the mass, worst", max(errors, default=math.nan), "kg", at_most=MASS_ERROR, n=len(errors))
    pushed = [r for r in results["pushed"] if not math.isnan(r.delay)]
    stopped = [r for r in pushed if r.end == Kind.WIZARD_STOPPED.value]
    report.share(f"pushed with {PUSHES[0]:g} to {PUSHES[1]:g} N at the flange: stopped", len(stopped), len(pushed), at_least=0.95)
    delays = [r.delay for r in stopped]
    report.row("pushed: delay, 95 %", float(np.quantile(delays, 0.95)) if delays else math.nan, "s", n=len(delays))
    barred = [r for r in results["in the way"] if not math.isnan(r.delay)]
    held = [r for r in barred if r.end == Kind.WIZARD_STOPPED.value]
    report.share("something in the way of a wrist link: stopped", len(held), len(barred), at_least=0.95)
    for what, values, most in (
        ("largest force", [r.force for r in held], TRANSIENT),
        (f"force that stays after {AFTER:g} s", [r.stays for r in held], LASTING),
    ):
        report.row(f"in the way: {what}, worst", max(values, default=math.nan), "N", at_most=most, n=len(values))
    for grid in GRIDS:
        for r in results[grid]:
            if (grid == "untouched") == (r.end != Kind.WIZARD_FINISHED.value):
                report.notes.append(f"{grid}: {r.end or 'no end'}, {r.reason}, {r.force:.0f} N")


if __name__ == "__main__":
    main("wizard", measure)
