"""Payload: true and configured each in 0 to 5 kg over postures and mountings, and nobody touches the arm.

Grids: with the flange sensor of a robot that was just switched on; of one that has turned its wrist since, wrong by 0.5 to 1 kg;
with the sensor invalid; with the sensor invalid, where a program moved the arm and then its payload changed by 1 to 1.5 kg; and
with activation sequence and walls off. Truth is read for scoring alone.
"""

import math
from typing import NamedTuple

import numpy as np

from benchmarks import arms
from benchmarks.common import NO_CASE, Report, main, spread
from benchmarks.hold import HOLD, IDLE, MOUNTINGS, RELEASE, enter, flange, go, settle, singular
from pendant.all_settings import Settings, apply
from pendant.event_table import TABLE, render
from pendant.events.event import Event, Kind
from pendant.events.event_row import Effect
from pendant.tick.modes import Mode
from sim.arm.scenario import Load, Scenario
from sim.exchange.desk import Wishes
from sim.plant.changes import AttachPayload, SensorFault
from sim.rigid_body.dynamics import Dynamics
from sim.simulation import Simulation

GRIDS = ("sensor", "no sensor", "unguarded", "turned", "moved")
LEAST = {"sensor": (1.0, 0.99), "no sensor": (2.0, 0.95), "turned": (0.5, 0.99), "moved": (1.0, 0.99)}
"""Payload error from which on so many are refused [kg]."""
WRONG = {"turned": (0.5, 1.0), "moved": (1.0, 1.5)}
"""Errors of a payload that is wrong, where not any is drawn [kg]."""
UNSENSED = ("no sensor", "moved")
SAID = {"sensor": 0.3, "turned": 0.3, "moved": 0.5}
"""By so much at most the mass is said wrong [kg]."""
ACCEPTED = 0.999
"""Of right payloads."""
UNGUARDED = 1.0  # [s] in free-drive that are looked at without sequence and walls
TURNED = math.cos(math.radians(30.0))  # least turn of gravity in the flange, where the wrist was turned before
SPAN = 1.5  # of that in each joint [rad]
MOVES, MOVED = 3, 1.0  # of a program that moves all joints, by so much at most [rad]
NEAR = 0.010  # [m] that a right payload's centre is configured wrong by, at most
SETTINGS = apply(Settings(), {"activation.period": 0.1})


class Case(NamedTuple):
    """One attempt."""

    number: int
    seed: int
    mounting: str
    posture: tuple[float, ...]
    true: float  # [kg]
    configured: float  # [kg]
    grid: str
    arm: str = arms.USUAL


class Result(NamedTuple):
    """What came of it; ways of the flange [mm]."""

    case: Case
    entered: bool
    before: float  # way until refused or entered
    whole: float  # way in all
    after_1_s: float
    reason: str  # text of the refusal
    said: float  # mass error in the refusal [kg], nan without
    best: float  # mass error, with the sensor's offset where nothing tells it from that [kg]
    cause: str  # parameter, or kind of the leaving


def postures(count: int, rng: np.random.Generator, arm_name: str = arms.USUAL) -> tuple[list[tuple[float, ...]], int]:
    """Random postures away from singularities, and how many were thrown away."""
    arm = arms.load(arm_name)
    probe: Dynamics = Simulation(arm, Scenario(mismatch="nominal"), Settings()).dynamics
    found: list[tuple[float, ...]] = []
    redrawn = 0
    while len(found) < count:
        q = rng.uniform(-2.6, 2.6, arm.n)
        if singular(probe, arm, q):
            redrawn += 1
        else:
            found.append(tuple(q.tolist()))
    return found, redrawn


def draw(options_seed: int, count: int, grid: str, arm: str = arms.USUAL) -> tuple[list[Case], int]:
    """`count` postures x 4 mountings; a third with the right payload, the others anything."""
    rng = np.random.default_rng([options_seed, GRIDS.index(grid) % 2])
    found, redrawn = postures(count, rng, arm)
    cases: list[Case] = []
    for posture in found:
        for mounting in MOUNTINGS:
            true, configured = rng.uniform(0.0, arms.heaviest(arm), 2)
            number = len(cases)
            if number % 3 == 0:
                configured = true
            elif grid in WRONG:
                off = float(rng.uniform(*WRONG[grid]))
                configured = true + off if true < arms.heaviest(arm) / 2.0 else true - off
            cases.append(Case(number, options_seed, mounting, posture, float(true), float(configured), grid, arm))
    return cases, redrawn


def simulation(case: Case, settings: Settings = SETTINGS) -> Simulation:
    """The arm before the attempt, after it has settled."""
    rng = np.random.default_rng([case.seed, case.number, 7])
    centre = rng.uniform([-0.03, -0.03, 0.0], [0.03, 0.03, 0.1])
    shift = rng.normal(size=3)
    shift *= NEAR * rng.uniform() / np.linalg.norm(shift)
    arm = arms.load(case.arm)
    device = Simulation(
        arm,
        Scenario(
            mounting=list(MOUNTINGS[case.mounting]),
            posture=list(case.posture),
            payload_true=Load(mass=case.configured if case.grid == "moved" else case.true, com=centre.tolist()),
            payload_configured=Load(mass=case.configured, com=(centre + shift).tolist()),
            seed=case.seed + case.number,
        ),
        settings,
    )
    fails = case.grid in UNSENSED and arm.sensors.force_torque is not None
    changes = (SensorFault(sensor="force_torque", outage=True),) if fails else ()
    device.tick(Wishes(IDLE.inputs, (), changes))
    settle(device)
    if case.grid == "turned":
        turn_wrist(device, rng)
    elif case.grid == "moved":
        move_about(device, rng)
        device.tick(Wishes(IDLE.inputs, (), (AttachPayload(load=Load(mass=case.true, com=centre.tolist())),)))
        settle(device)
    return device


def move_about(device: Simulation, rng: np.random.Generator) -> None:
    """A program moves all joints, not next to a singularity: the gears are learned."""
    home, goals = device.estimate.q.copy(), []
    while len(goals) < MOVES:
        there = home + rng.uniform(-MOVED, MOVED, home.size)
        if not singular(device.dynamics, device.arm, there):
            goals.append(there)
    go(device, *goals)


def turn_wrist(device: Simulation, rng: np.random.Generator) -> None:
    """A program turns the wrist to another posture, away from singularities, in which the arm settles as before."""
    settle(device)
    before = device.estimate.q.copy()
    down = device.dynamics.gravity_B @ device.dynamics.update(before)[1]
    while True:
        there = before.copy()
        there[-3:] += rng.uniform(-SPAN, SPAN, 3)
        turned = down @ (device.dynamics.gravity_B @ device.dynamics.update(there)[1]) < TURNED * (down @ down)
        if turned and not singular(device.dynamics, device.arm, there):
            break
    go(device, there)


def told(device: Simulation, error: float) -> float:
    """The mass error that the sensor could best tell [kg]: the true `error`, and what its zero is off by, along gravity."""
    R_BF = device.snapshot().estimate.R_BF
    offset = R_BF @ (device.sensors.wrench_offset[:3] - np.array(device.supervisor.zero[:3]))
    return error + float(offset @ device.dynamics.gravity_B) / -(9.81**2)


def measure_case(case: Case) -> Result:
    """One attempt, from pressing the button to the end of the free-drive period."""
    unguarded = case.grid == "unguarded"
    settings = apply(SETTINGS, {"sequence.on": False, "walls.on": False}) if unguarded else SETTINGS
    device = simulation(case, settings)
    start = flange(device)
    events: list[Event] = []
    before = whole = after = 0.0
    entered = over = False
    best = math.nan
    since = 0
    seconds = settings.activation.period + (UNGUARDED if unguarded else settings.sequence.period + settings.free_drive.period)
    for tick in range(round(500 * seconds) + 100):
        decision = device.tick(RELEASE if entered else HOLD)
        events += decision.events
        whole = max(whole, float(np.linalg.norm(flange(device) - start)))
        if decision.mode is Mode.FREE_DRIVE and not entered:
            entered, since = True, tick
        over = over or any(TABLE[event.kind].effect is Effect.NO_ENTRY for event in decision.events)
        if not entered:
            before = whole
        if any(event.kind is Kind.SEQUENCE_STARTED for event in decision.events):
            best = case.true - case.configured
            if case.grid == "sensor":  # else its zero is known, or there is none
                best = told(device, best)
        if over and not entered and tick > 500:
            break
        if entered and tick - since == 500:
            after = whole
    refusal = next((event for event in events if TABLE[event.kind].effect is Effect.NO_ENTRY), None)
    ends = [event.kind.value for event in events if TABLE[event.kind].effect in (Effect.LEAVE, Effect.LEAVE_TO_STOP)]
    reason = " ".join(render(refusal)).lower() if refusal is not None else ""
    said = float(refusal.values.get("mass", math.nan)) if refusal is not None else math.nan
    why = str(refusal.values.get("parameter", refusal.kind.value)) if refusal is not None else ", ".join(ends)
    return Result(case, entered, before, whole, after, reason, said, best, why)


def accepted(case: Case) -> bool:
    """Whether an attempt ends in free-drive."""
    return enter(simulation(case))


def measure(report: Report) -> None:
    """Fill the report."""
    count = 100 if report.options.full else 9
    arm = report.options.arm
    if arms.senses(arm):
        cases, _ = draw(report.options.seed + 300, 750 if report.options.full else 15, "sensor", arm)
        right = spread(accepted, [case._replace(configured=case.true) for case in cases])
        report.share("right payloads alone, accepted", sum(right), len(right), at_least=ACCEPTED)
    for grid in GRIDS if arms.senses(arm) else ("no sensor", "unguarded", "moved"):
        cases, redrawn = draw(report.options.seed, count if grid != "unguarded" else max(count // 3, 5), grid, arm)
        results = spread(measure_case, cases)
        (score_unguarded if grid == "unguarded" else score)(report, grid, results)
        report.notes.append(f"{grid}: {redrawn} postures near a singularity drawn again for {count}")


def score_unguarded(report: Report, grid: str, results: list[Result]) -> None:
    """What an arm does that nobody checks and nothing holds."""
    heavy = [r.whole for r in results if abs(r.case.true - r.case.configured) >= 2.0]
    what = f"{grid}, wrong by 2 kg or more: way in the first second"
    report.row(f"{what}, median", float(np.median(heavy)) if heavy else NO_CASE, "mm", n=len(heavy))
    report.row(f"{what}, largest", max(heavy, default=NO_CASE), "mm", n=len(heavy))


def score(report: Report, grid: str, results: list[Result]) -> None:
    """The bars of the grid with the checks on."""
    n = len(results)
    refused = [r for r in results if not r.entered]
    report.row(f"{grid}: way until refused or entered, largest", max(r.before for r in results), "mm", at_most=10.0, n=n)
    p95 = float(np.percentile([r.whole for r in refused], 95)) if refused else 0.0
    report.row(f"{grid}, refused: way, 95th percentile", p95, "mm", at_most=3.0, n=len(refused))
    report.row(f"{grid}: way of the flange in the whole period, largest", max(r.whole for r in results), "mm", at_most=30.0, n=n)
    least, share = LEAST[grid]
    wrong = [r for r in results if abs(r.case.true - r.case.configured) >= least]
    found = sum(not r.entered for r in wrong)
    report.share(f"{grid}: wrong by {least:g} kg or more, refused", found, len(wrong), at_least=share)
    right = [r for r in results if r.case.true == r.case.configured]
    report.share(f"{grid}: right payloads, accepted", sum(r.entered for r in right), len(right), at_least=ACCEPTED)
    unseen = [r for r in wrong if r.entered]
    for r in unseen[:5]:
        error = r.case.true - r.case.configured
        angles = ", ".join(f"{angle:.2f}" for angle in r.case.posture)
        report.notes.append(f"{grid}: not seen: {error:+.1f} kg, {r.case.mounting}, posture {angles}; flange {r.whole:.1f} mm")
    report.notes.append(f"{grid}: {len(unseen)} errors of {least:g} kg or more not seen")
    for r in [r for r in right if not r.entered][:5]:
        report.notes.append(f"{grid}: right payload refused: {r.cause}, case {r.case.number}, {r.case.mounting}")
    named = [r for r in wrong if not r.entered]
    if grid != "no sensor":
        payload = sum("payload" in r.reason and ("push" in r.reason or "let go" in r.reason) for r in named)
        report.share(f"{grid}: reason names payload or push", payload, len(named), at_least=0.99)
        off = [abs(r.said - r.best) for r in named if not math.isnan(r.said)]
        largest = max(off, default=math.nan)
        what = "the truth" if grid in UNSENSED else "what the sensor tells"
        report.row(f"{grid}: mass said, off {what}, largest", largest, "kg", at_most=SAID[grid], n=len(off))


if __name__ == "__main__":
    main("payload", measure)
