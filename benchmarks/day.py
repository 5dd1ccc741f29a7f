"""Day: robots that stay switched on, and somebody who comes by every hour: does the first use work as on a robot just started?

Ten robots, a use in each of 24 hours. Between the uses the sensor's zero, the joints' temperatures and the clock go on without
physics (`Simulation.rest`). Two minutes around each use are simulated: a program; free-drive with the right payload, guided and
let go; a program; 2 kg that nobody told of; free-drive with these told, guided and let go; a program that carries them. Contact
detection is on while a program runs, and must stay silent. Who is asked to zero the sensor does. Truth is read for scoring alone.
"""

import math
from collections import Counter
from typing import NamedTuple

import numpy as np

from benchmarks.common import Report, main, spread
from benchmarks.guided import Path, across, place_of
from benchmarks.hold import HOLD, IDLE, MOUNTINGS, RELEASE
from benchmarks.payload import SETTINGS, Case, postures, simulation, told
from pendant.event_table import TABLE, render
from pendant.events.event import Event, Kind
from pendant.events.event_row import Effect, Severity
from pendant.inputs import Command, Inputs
from pendant.program.steps import JointMove, Program, ProgramState
from pendant.tick.modes import TICK, Mode
from sim.arm.scenario import Load
from sim.exchange.desk import Wishes
from sim.plant.changes import AttachPayload
from sim.plant.touch import Pull
from sim.simulation import Simulation

ROBOTS, HOURS = 10, 24
HOUR = 3600.0  # [s]
USE = 120.0  # [s] that are simulated around each use
WRONG = Load(mass=2.0, com=[0.0, 0.0, 0.05])
NOTHING_THERE = Load(mass=0.0)
SPAN = 0.3  # of a program's moves about where the robot stands [rad]
GUIDED = 15.0  # [s]

USUAL = frozenset({Kind.ZERO_DUE})
"""Warnings that somebody can act on, as this bench does."""

CONTACTS = frozenset(
    kind for kind in Kind if kind.value.startswith("contact_") or kind in (Kind.STOPPED_PAYLOAD, Kind.SENSOR_STEPPED)
)


class Robot(NamedTuple):
    """One robot and the hours in which it is used."""

    number: int
    seed: int
    hours: int
    hour: float  # from use to use [s]
    rests: bool  # between the uses without physics; else all of it is simulated


class Use(NamedTuple):
    """What came of one use."""

    robot: int
    hour: int
    entered: tuple[bool, bool]  # without a payload, with 2 kg as told
    refused: bool  # 2 kg that nobody told of
    off: float  # what was said of them, off what the sensor tells [kg]; not a number without
    zeroed: int
    refusals: tuple[str, ...]  # texts of refusals of what is right
    contacts: int  # told in free motion
    odd: tuple[str, ...]  # events that nobody could act on
    bias: tuple[float, ...]  # of the sensor (6,) [N, N·m]
    temperature: tuple[float, ...]  # of the joints [°C]


class Person:
    """Uses a robot tick by tick, and keeps the events."""

    def __init__(self, device: Simulation) -> None:
        self.device = device
        self.events: list[Event] = []

    def do(self, seconds: float, wishes: Wishes = IDLE, until: Mode | None = None) -> bool:
        """So long at most; True once the robot is in the mode `until`."""
        for _ in range(round(seconds / TICK)):
            decision = self.device.tick(wishes)
            self.events += decision.events
            if decision.mode is until:
                return True
        return False

    def ask(self, inputs: Inputs, *changes: AttachPayload) -> None:
        """For one tick."""
        self.events += self.device.tick(Wishes(inputs, (), changes)).events

    def enters(self) -> bool:
        """Hold the button, hands off; after a refusal wait until it can be held again."""
        entered = self.do(4.0, HOLD, Mode.FREE_DRIVE)
        self.events += self.device.tick(RELEASE).events
        if not entered:
            self.do(4.0)
        return entered

    def leads(self, rng: np.random.Generator) -> None:
        """Lead the flange for a while, then let go until free-drive ends by itself."""
        path = Path(place_of(self.device, "flange"), across(self.device, "flange"), "circle", rng)
        for tick in range(round(GUIDED / TICK)):
            target = tuple(path.at(tick * TICK).tolist())
            self.events += self.device.tick(Wishes(IDLE.inputs, (Pull("flange", (0.0, 0.0, 0.0), target),), ())).events
        self.do(8.0, until=Mode.TEACH)

    def runs(self, program: Program) -> int:
        """Run a program to its end; how many changes in contact were told, where there were none."""
        before = len(self.events)
        self.ask(Inputs(program=program, settings={"contact.on": True}))
        self.ask(Inputs(commands=(Command.START_PROGRAM,)))
        for _ in range(round(30.0 / TICK)):
            decision = self.device.tick(IDLE)
            self.events += decision.events
            if decision.program is not ProgramState.RUNNING:
                break
        self.do(0.5)
        self.ask(Inputs(settings={"contact.on": False}))
        return sum(event.kind in CONTACTS for event in self.events[before:])

    def carries(self, true: Load, configured: Load) -> None:
        """Put a payload on, and tell the pendant of another one."""
        self.ask(Inputs(load=configured), AttachPayload(load=true))
        self.do(2.0)


def moves(home: np.ndarray, rng: np.random.Generator) -> Program:
    """About where the robot stands, and back."""
    steps = [JointMove(q=tuple((home + SPAN * rng.uniform(-1.0, 1.0, home.size)).tolist())) for _ in range(3)]
    return Program(steps=(*steps, JointMove(q=tuple(home.tolist()))))


def use(robot: Robot, hour: int, device: Simulation, home: np.ndarray) -> Use:
    """Two minutes of it."""
    rng = np.random.default_rng([robot.seed, robot.number, hour])
    person, start = Person(device), device.tick_count
    bias, temperature = tuple(device.sensors.wrench_offset.tolist()), tuple(device.plant.temperature.tolist())
    person.do(1.0)
    person.events.clear()  # the rest moved the zero at once, as no sensor does: what detectors keep of it is older than this
    person.do(2.0)
    zeroed = 0
    if device.tick(IDLE).zero_due:
        person.ask(Inputs(commands=(Command.ZERO_SENSOR,)))
        zeroed = sum(event.kind is Kind.SENSOR_ZEROED for event in person.events)
    contacts = person.runs(moves(home, rng))
    events, person.events = person.events, []
    empty = person.enters()
    if empty:
        person.leads(rng)
    contacts += person.runs(moves(home, rng))
    right, person.events = person.events, []
    person.carries(WRONG, NOTHING_THERE)
    best = told(device, WRONG.mass)
    refused = not person.enters()
    wrong, person.events = person.events, []
    person.carries(WRONG, WRONG)
    loaded = person.enters()
    if loaded:
        person.leads(rng)
    contacts += person.runs(moves(home, rng))
    person.carries(NOTHING_THERE, NOTHING_THERE)
    right += person.events
    person.events = []
    person.do(USE - (device.tick_count - start) * TICK)
    right += person.events
    said = [float(event.values["mass"]) for event in wrong if event.kind is Kind.REFUSED_PAYLOAD]
    refusals = [" ".join(render(event)) for event in right if TABLE[event.kind].effect is Effect.NO_ENTRY]
    odd = [event.kind.value for event in events + right if _odd(event)]
    return Use(
        robot.number,
        hour,
        (empty, loaded),
        refused,
        min(abs(said[0] - best), abs(said[0] - WRONG.mass)) if said else math.nan,  # with a zero that is unknown, or known
        zeroed,
        tuple(refusals),
        contacts,
        tuple(odd),
        bias,
        temperature,
    )


def _odd(event: Event) -> bool:
    """A warning or a stop in a use in which nothing is wrong, but what somebody can act on."""
    row = TABLE[event.kind]
    return (row.severity >= Severity.WARNING or row.effect is Effect.NO_ENTRY) and event.kind not in USUAL


def measure_robot(robot: Robot) -> list[Use]:
    """All its hours."""
    rng = np.random.default_rng([robot.seed, 19])
    found = [None, *postures(ROBOTS, rng)[0]][robot.number]  # the first stands as it was delivered
    mounting = list(MOUNTINGS)[robot.number % len(MOUNTINGS)]
    case = Case(robot.number, robot.seed, mounting, found or (0.0, -1.2, 1.5, -1.87, -1.57, 0.0), 0.0, 0.0, "sensor")
    device = simulation(case, SETTINGS)
    home = device.estimate.q.copy()
    uses: list[Use] = []
    for hour in range(1, robot.hours + 1):
        rest = robot.hour * hour - math.ceil(device.tick_count * TICK)
        if robot.rests:
            device.rest(rest)
        else:
            for _ in range(round(rest / TICK)):
                device.tick(IDLE)
        uses.append(use(robot, hour, device, home))
    return uses


def measure(report: Report) -> None:
    """Fill the report."""
    full, seed = report.options.full, report.options.seed
    hour = HOUR if full else HOUR / 10.0
    plan = [Robot(0, seed, 1, hour, False), Robot(0, seed, 1, hour, True)]
    plan += [Robot(number, seed, HOURS if full else 2, HOUR, True) for number in range(ROBOTS if full else 3)]
    (simulated, *_), (rested, *_), *all_uses = spread(measure_robot, plan)
    uses = [each for some in all_uses for each in some]
    n = len(uses)
    report.row("without physics and with: zero of the sensor, apart", _apart(rested.bias, simulated.bias), "N", at_most=0.0)
    hot = _apart(rested.temperature, simulated.temperature)
    report.row("without physics and with: temperatures, apart", hot, "K", at_most=0.5)
    same = rested.entered == simulated.entered and rested.refused == simulated.refused
    report.row("without physics and with: the use the same", float(same), "", at_least=1.0)
    report.notes.append(f"without physics and with: {hour:.0f} s")
    report.share("entered without a payload", sum(u.entered[0] for u in uses), n, at_least=1.0)
    report.share("entered with 2 kg as told", sum(u.entered[1] for u in uses), n, at_least=1.0)
    report.share("refused with 2 kg that nobody told of", sum(u.refused for u in uses), n, at_least=1.0)
    off = max((u.off if not math.isnan(u.off) else math.inf for u in uses), default=math.inf)
    report.row("mass said, off what the sensor tells, largest", off, "kg", at_most=0.3, n=n)
    report.row("changes in contact told in free motion", sum(u.contacts for u in uses), "", at_most=0.0, n=n)
    odd = Counter(kind for u in uses for kind in u.odd)
    report.row("warnings and stops that nobody could act on", sum(odd.values()), "", at_most=0.0, n=n)
    report.share("uses before which the sensor was zeroed", sum(u.zeroed > 0 for u in uses), n)
    report.row("zero of the sensor off by, largest of an axis", max(max(map(abs, u.bias[:3])) for u in uses), "N", n=n)
    report.notes += [f"robot {u.robot}, hour {u.hour}: {text}" for u in uses for text in u.refusals]
    report.notes += [f"robot {u.robot}, hour {u.hour}: {', '.join(u.odd)}" for u in uses if u.odd]


def _apart(a: tuple[float, ...], b: tuple[float, ...]) -> float:
    return max(abs(x - y) for x, y in zip(a, b, strict=True))


if __name__ == "__main__":
    main("day", measure)
