"""Guided: a hand leads the arm for 2 to 10 minutes; how often free-drive ends although it does.

It leads the flange, the tool, the wrist or the elbow on circles and lines, from place to place with pauses of 1 to 3 s in which a
waypoint is registered, and slowly and gently: with 1 to 5 N, and with more only while that moves nothing, as people do. Payloads
are right, the sensor drifts, all mismatch is on. In half of the pauses it lets go, and in the end: then the arm has to stay.
Truth is read for scoring alone.
"""

import math
from typing import NamedTuple

import mujoco
import numpy as np
from numpy.typing import NDArray

from benchmarks.arms import heaviest
from benchmarks.common import NO_CASE, Report, main, spread
from benchmarks.hold import IDLE, MOUNTINGS, enter
from benchmarks.payload import SETTINGS, Case, draw, simulation
from pendant.event_table import TABLE
from pendant.events.event import Kind
from pendant.events.event_row import LEAVING
from pendant.inputs import Command, Inputs
from pendant.tick.modes import TICK
from sim.exchange.desk import Wishes
from sim.plant.applied_touches import STIFFNESS
from sim.plant.touch import Pull
from sim.simulation import Simulation

Array = NDArray[np.float64]

PARTS = ("flange", "tool", "wrist_3", "wrist_1", "elbow")
STYLES = ("circle", "line", "teach", "gentle")
HAND = 50.0  # [N] at most
RATE = 20.0  # of the hand's targets, as a page sends them [1/s]
TOOL = 0.1  # beyond the flange [m]
ALONE = 30.0  # an arm that nobody touches goes so far at most [mm], as in the bench `drift`
LEAST_LEVER = 0.3  # [m] with which joints move a part that goes that way
STANDS, HARDER = 0.3, 40.0  # a hand that moves nothing for so long [s] pulls harder by so much a second [N/s]
OFF = 0.01  # [m] from where it is wanted, beyond which it does
GETS_HOLD = 0.3  # [s] after entry
COMES_TO_REST = 0.5  # [s] that an arm may take for it after the hand has let go
LET_GO = round(3.0 / TICK)  # ticks for which nobody holds it in the end


class Lead(NamedTuple):
    """One free-drive, and how it is led."""

    case: Case
    part: str
    style: str
    minutes: float


class Result(NamedTuple):
    """What came of it."""

    lead: Lead
    entered: bool
    led: float  # [min]
    end: str  # kind of an involuntary end, and its values
    caught: int  # times that a wall held the arm
    way: float  # of the part [m]
    alone: float  # way of the part while nobody holds it, after it may have come to rest; the longest [m]


class Path:
    """Where a hand wants a part to be: a curve in two directions across each other, and pauses.

    Args:
        start: of the part in W (3,) [m].
        across: two directions (2, 3) of length 1 in W, in which the part can go.
        style: of `STYLES`.
        rng: draws sizes and paces.
    """

    def __init__(self, start: Array, across: Array, style: str, rng: np.random.Generator) -> None:
        self._start, self._across, self._style, self._rng = start, across, style, rng
        slow = style == "gentle"
        self._size = float(rng.uniform(0.05, 0.08) if slow else rng.uniform(0.03, 0.08))
        self._period = float(rng.uniform(12.0, 20.0) if slow else rng.uniform(4.0, 8.0))
        self._from = self._to = np.zeros(2)
        self._leaves = self._arrives = self._rests = 0.0
        self.pauses = self.registers = False
        self.keeps_hold = True

    def at(self, t: float) -> Array:
        """The hand's target (3,) in W at `t` [s]; `pauses`, `keeps_hold`, `registers` say what is done then."""
        t = math.floor(t * RATE) / RATE
        turn = 2.0 * math.pi * t / self._period
        if self._style == "line":
            place = np.array([2.0 * self._size * math.sin(turn), 0.0])
        elif self._style == "teach":
            place = self._taught(t)
        elif not self._across[1].any():  # to and fro, at one pace: at a turn of a slow circle nobody would seem to move the arm
            place = self._size * np.array([2.0 * math.asin(math.sin(turn)) / math.pi, 0.0])
        else:
            place = self._size * np.array([math.sin(turn), 1.0 - math.cos(turn)])
        return self._start + place @ self._across

    def _taught(self, t: float) -> Array:
        if t >= self._rests:
            self._from, self._leaves = self._to, t
            while self._leg() < 0.08:
                self._to = self._rng.uniform(-0.1, 0.1, 2)
            self._arrives = t + 0.5 + self._leg() / 0.1
            self._rests = self._arrives + float(self._rng.uniform(1.0, 3.0))
            self.keeps_hold = bool(self._rng.random() < 0.5)
        self.pauses = t >= self._arrives
        self.registers = t >= 0.5 * (self._arrives + self._rests)
        share = min((t - self._leaves) / (self._arrives - self._leaves), 1.0)
        return self._from + (self._to - self._from) * (3.0 - 2.0 * share) * share**2

    def _leg(self) -> float:
        """From one place to the next [m], in the directions in which the part can go."""
        return float(np.linalg.norm((self._to - self._from) @ self._across))


def grip(part: str) -> tuple[float, float, float]:
    """Where a hand takes a part, in its axes [m]: a tool at its end."""
    return (0.0, 0.0, TOOL) if part == "tool" else (0.0, 0.0, 0.0)


def place_of(device: Simulation, part: str) -> Array:
    """Where a hand takes a part, in W (3,) [m]."""
    data = device.plant.data
    body = device.plant.model.body("flange" if part == "tool" else part).id
    return data.xpos[body] + data.xmat[body].reshape(3, 3) @ grip(part)


def levers(device: Simulation, part: str) -> Array:
    """Way in W (3, n) of where a hand takes a part, for each turn of a joint [m]."""
    plant = device.plant
    jacobian = np.zeros((3, plant.model.nv))
    body = plant.model.body("flange" if part == "tool" else part).id
    mujoco.mj_jac(plant.model, plant.data, jacobian, None, place_of(device, part), body)
    return jacobian[:, [plant.model.joint(f"q/{name}").dofadr[0] for name in device.arm.chain.joints]]


def across(device: Simulation, part: str) -> Array:
    """The two directions (2, 3) in W in which a part goes best; the second is nothing where it goes in one alone."""
    directions, sizes, _ = np.linalg.svd(levers(device, part))
    return np.stack([directions[:, 0], directions[:, 1] * float(sizes[1] >= LEAST_LEVER)])


def measure_lead(lead: Lead) -> Result:
    """Enter, lead, and see whether it lasts."""
    device = simulation(lead.case, SETTINGS)
    if not enter(device):
        return Result(lead, False, 0.0, "", 0, 0.0, 0.0)
    rng = np.random.default_rng([lead.case.seed, lead.case.number, 17])
    for _ in range(round(GETS_HOLD / TICK)):
        device.tick(IDLE)
    last = place_of(device, lead.part)
    path = Path(last, across(device, lead.part), lead.style, rng)
    gentle = float(rng.uniform(1.0, 5.0)) if lead.style == "gentle" else HAND
    cap, more, stood, harder = gentle, 0.0, 0.0, False
    reach = ahead = np.zeros(3)
    caught, way, alone, end = 0, 0.0, 0.0, ""
    let_go, rests = 0.0, last  # since when nobody holds it [s], and where it should rest
    registered = False
    total = round(60.0 * lead.minutes / TICK)
    tick = 0
    for tick in range(total + LET_GO):
        target = path.at(tick * TICK)
        holds = tick < total and (path.keeps_hold or not path.pauses)
        touches = (Pull(lead.part, grip(lead.part), tuple((target + reach).tolist()), cap),) if holds else ()
        commands: tuple[Command, ...] = ()
        if path.registers != registered:
            registered = path.registers
            commands = (Command.REGISTER_WAYPOINT,) if registered else ()
        decision = device.tick(Wishes(Inputs(commands=commands), touches, ()))
        if tick % 50 == 0:
            now = place_of(device, lead.part)
            gone, last = float(np.linalg.norm(now - last)), now
            way += gone * (tick < total)
            let_go = 0.0 if holds else let_go + 0.1
            if let_go <= COMES_TO_REST:
                rests = now
            alone = max(alone, float(np.linalg.norm(now - rests)))
            stood = stood + 0.1 if gone < 0.001 else 0.0
            wanted = target - now
            harder = stood >= STANDS and not path.pauses and bool(np.linalg.norm(wanted) >= OFF)
            ahead = wanted / max(float(np.linalg.norm(wanted)), 1e-9)
        more = min(max(more + (HARDER if harder else -HARDER) * TICK, 0.0), HAND)
        cap = min(gentle + more, HAND)
        reach = more / STIFFNESS * ahead
        for event in decision.events if tick < total else ():
            caught += event.kind is Kind.WALL_REACHED
            if TABLE[event.kind].effect in LEAVING:
                values = ", ".join(f"{k} {v:.3g}" if isinstance(v, float) else f"{k} {v}" for k, v in event.values.items())
                end = f"{event.kind.value} ({values})"
        if end:
            break
    return Result(lead, True, min(tick + 1, total) * TICK / 60.0, end, caught, way, alone)


def leads(report: Report, minutes: float) -> list[Lead]:
    """So many guided minutes in all, every part in every style."""
    rng = np.random.default_rng([report.options.seed, 17])
    arm, lengths = report.options.arm, list[float]()
    while sum(lengths) < minutes:
        lengths.append(float(rng.uniform(2.0, 10.0)) if report.options.full else 1.0)
    cases, _ = draw(report.options.seed + 1700, -(-len(lengths) // len(MOUNTINGS)), "sensor", arm)
    made: list[Lead] = []
    for k, (case, length) in enumerate(zip(cases, lengths, strict=False)):
        mass = float(rng.uniform(0.0, heaviest(arm))) if rng.random() < 0.5 else 0.0
        case = case._replace(true=mass, configured=mass)
        made.append(Lead(case, PARTS[k % len(PARTS)], STYLES[k // len(PARTS) % len(STYLES)], length))
    return made


def measure(report: Report) -> None:
    """Fill the report."""
    results = spread(measure_lead, leads(report, 1510.0 if report.options.full else 20.0))
    led = [result for result in results if result.entered]
    minutes = sum(result.led for result in led)
    ends = [result for result in led if result.end]
    report.share("free-drives, entered", len(led), len(results))
    report.row("guided", minutes, "min", n=len(led))
    report.share("guided minutes in which free-drive ends although a hand leads", len(ends), round(minutes), at_most=1.0 / 500.0)
    for style in STYLES:
        some = [result for result in led if result.lead.style == style]
        report.share(f"{style}: involuntary ends", sum(bool(result.end) for result in some), len(some))
        speed = sum(r.way for r in some) / sum(60.0 * r.led for r in some)
        report.row(f"{style}: speed of the part, mean", speed, "m/s", n=len(some))
    loose = [1000.0 * result.alone for result in led if not result.end]
    report.row("way while nobody holds the arm, largest", max(loose, default=NO_CASE), "mm", at_most=ALONE, n=len(loose))
    report.share("such a way beyond that", sum(each > ALONE for each in loose), len(loose))
    report.row("a wall held a led arm, in 300 minutes", 300.0 * sum(r.caught for r in led) / minutes, "", n=len(led))
    for r in led:
        if r.end or 1000.0 * r.alone > ALONE:
            what = f"after {r.led:.1f} min {r.end}" if r.end else f"alone {1000.0 * r.alone:.0f} mm"
            case = r.lead.case
            report.notes.append(
                f"{r.lead.style} at {r.lead.part}, {case.true:.1f} kg, {case.mounting}, case {case.number}: {what}"
            )


if __name__ == "__main__":
    main("guided", measure)
