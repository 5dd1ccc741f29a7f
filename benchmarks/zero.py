"""Zero: somebody asks to zero the flange sensor while a hand rests on the arm, by 5 to 30 N, or while nobody touches it.

The hand came to rest within 0.05 to 3 s, some seconds before, at the flange or at the end of the tool; the robot has been on for
up to four hours. Where the zero is taken all the same, free-drive is entered with the hand on the arm, and the hand goes. Truth
is read for scoring alone.
"""

from typing import NamedTuple

import numpy as np

from benchmarks.common import Report, main, spread
from benchmarks.guided import grip
from benchmarks.hold import IDLE, MOUNTINGS, enter, flange
from benchmarks.payload import Case, draw, simulation
from pendant.events.event import Kind
from pendant.inputs import Command, Inputs
from pendant.tick.modes import TICK
from sim.exchange.desk import Wishes
from sim.plant.touch import Push

AFTER = 3.0  # [s] that are looked at when the hand has gone
LEARNS = 2.0  # [s] in which the untouched arm is seen before anybody comes
CLOSE = 1.0  # [N] of the true zero is where one that was taken with nobody on the arm must be: 1.4 % of a full payload are 0.7 N


class Press(NamedTuple):
    """One request to zero the sensor."""

    case: Case
    force: float  # of the hand, 0 for none [N]
    part: str
    comes: float  # within [s]
    rests: float  # for [s] before
    on: float  # the robot has been on for [s]


class Result(NamedTuple):
    """What came of it."""

    press: Press
    zeroed: bool
    why: str
    way: float  # of the flange when the hand had gone [mm]
    off: float  # what was taken, off the true zero [N]


def measure_press(press: Press) -> Result:
    """Let the robot stand, put the hand on it, ask."""
    device = simulation(press.case)
    device.rest(press.on)
    for _ in range(round(LEARNS / TICK)):
        device.tick(IDLE)
    rng = np.random.default_rng([press.case.seed, press.case.number, 23])
    direction = rng.normal(size=3)
    direction *= press.force / np.linalg.norm(direction)
    comes, rests = round(press.comes / TICK), round(press.rests / TICK)
    touches: tuple[Push, ...] = ()
    for tick in range(comes + rests):
        force = min((tick + 1) / comes, 1.0) * direction
        touches = (Push(press.part, grip(press.part), tuple(force.tolist())),) if press.force else ()
        device.tick(Wishes(IDLE.inputs, touches, ()))
    true = device.sensors.wrench_offset[:3]
    events = device.tick(Wishes(Inputs(commands=(Command.ZERO_SENSOR,)), touches, ())).events
    why = next((str(event.values["reason"]) for event in events if event.kind is Kind.ZERO_REFUSED), "")
    if why:
        return Result(press, False, why, 0.0, 0.0)
    off = float(np.linalg.norm(np.array(device.supervisor.zero[:3]) - true))
    way = 0.0
    if press.force and enter(device, touches):
        start = flange(device)
        for _ in range(round(AFTER / TICK)):
            device.tick(IDLE)
            way = max(way, float(np.linalg.norm(flange(device) - start)))
    return Result(press, True, "", way, off)


def presses(report: Report, count: int, touched: bool) -> list[Press]:
    """Right payloads of 0 to 5 kg, hands at random."""
    cases, _ = draw(report.options.seed + 2300 + 50 * touched, -(-count // len(MOUNTINGS)), "sensor")
    rng = np.random.default_rng([report.options.seed, 23])
    made: list[Press] = []
    for case in cases[:count]:
        mass = float(rng.uniform(0.0, 5.0)) if rng.random() < 0.7 else 0.0
        part = "flange" if rng.random() < 0.7 else "tool"
        force, comes, rests = float(rng.uniform(5.0, 30.0)), float(rng.uniform(0.05, 3.0)), float(rng.uniform(1.5, 6.0))
        on = float(round(rng.uniform(0.0, 4.0 * 3600.0)))
        made.append(Press(case._replace(true=mass, configured=mass), force * touched, part, comes, rests, on))
    return made


def measure(report: Report) -> None:
    """Fill the report."""
    full = report.options.full
    count = 1000 if full else 40
    held = spread(measure_press, presses(report, count, True))
    free = spread(measure_press, presses(report, count // 5, False))
    safe = [r for r in held if not r.zeroed or r.way <= 10.0]
    report.share("with a hand of 5 to 30 N: refused", sum(not r.zeroed for r in held), len(held))
    report.share("with a hand: refused, or no motion beyond 10 mm", len(safe), len(held), at_least=0.99)
    report.row("with a hand: way of the flange when it goes, largest", max(r.way for r in held), "mm", n=len(held))
    taken = [r for r in free if r.zeroed]
    report.share("with nobody on the arm: zeroed", len(taken), len(free), at_least=0.99)
    off = max((r.off for r in taken), default=0.0)
    report.row("zeroed: off the true zero, largest", off, "N", at_most=CLOSE, n=len(taken))
    for r in [r for r in held if r.zeroed][:5]:
        report.notes.append(
            f"zeroed with {r.press.force:.1f} N at the {r.press.part}, {r.press.case.true:.1f} kg, case {r.press.case.number}: "
            f"{r.way:.1f} mm"
        )
    for r in [r for r in free if not r.zeroed][:5]:
        report.notes.append(f"nobody on the arm, {r.press.case.true:.1f} kg, case {r.press.case.number}: {r.why}")


if __name__ == "__main__":
    main("zero", measure)
