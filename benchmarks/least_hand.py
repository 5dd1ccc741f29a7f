"""Least hand: how light a hand may be that leads an arm at rest: 0.7 to 5 N at the flange, 15 N at the elbow and at the wrist.

It comes in 0.1 s and stays for a second. At the flange it pulls in any direction, at a link across it; at least one joint turns
with a lever of 0.2 m, for a pull through the axes turns nothing. Payloads are right, all mismatch is on. Truth is read for
scoring alone.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from benchmarks.arms import LEVER
from benchmarks.common import Report, main, spread
from benchmarks.guided import grip, levers, place_of
from benchmarks.hold import IDLE, MOUNTINGS, enter
from benchmarks.payload import SETTINGS, Case, draw, simulation
from pendant.inputs import NOTHING
from pendant.tick.modes import TICK, Mode
from sim.exchange.desk import Wishes
from sim.plant.touch import Push
from sim.simulation import Simulation

Array = NDArray[np.float64]

FLANGE = (0.7, 1.0, 2.0, 3.0, 4.0, 5.0)  # [N]
LINK = 15.0  # [N]
LINKS = {"elbow": "shoulder", "wrist_1": "elbow"}
"""Parts that a hand takes behind the flange sensor, and from where their link comes."""
SURE = {("flange", 5.0): 0.99, ("elbow", LINK): 0.99, ("wrist_1", LINK): 0.99}
"""Hands of which so many have to lead the arm."""
WAITS, RISES, LASTS = (round(time / TICK) for time in (0.6, 0.1, 1.0))
LED = 2.0  # [mm]


class Hand(NamedTuple):
    """One hand on a free arm at rest."""

    case: Case
    part: str
    force: float  # [N]


class Result(NamedTuple):
    """What came of it."""

    hand: Hand
    entered: bool
    lever: float  # largest of a joint [m]
    way: float  # of the part, at most [mm]
    ended: bool  # free-drive did meanwhile


def measure_hand(hand: Hand) -> Result:
    """Enter, wait, pull."""
    device = simulation(hand.case, SETTINGS)
    if not enter(device):
        return Result(hand, False, 0.0, 0.0, False)
    for _ in range(WAITS):
        device.tick(IDLE)
    rng = np.random.default_rng([hand.case.seed, hand.case.number, 23])
    pull, lever = _drawn(device, hand.part, rng)
    start, way, ended = place_of(device, hand.part), 0.0, False
    for tick in range(LASTS):
        x, y, z = (min(tick / RISES, 1.0) * hand.force * pull).tolist()
        decision = device.tick(Wishes(NOTHING, (Push(hand.part, grip(hand.part), (x, y, z)),), ()))
        way = max(way, 1000.0 * float(np.linalg.norm(place_of(device, hand.part) - start)))
        ended = ended or decision.mode is not Mode.FREE_DRIVE
    return Result(hand, True, lever, way, ended)


def _drawn(device: Simulation, part: str, rng: np.random.Generator) -> tuple[Array, float]:
    """A direction in W (3,) of length 1, at a link across it, and the largest lever of a pull there on a joint [m]."""
    data, model, jacobian = device.plant.data, device.plant.model, levers(device, part)
    while True:
        pull = rng.normal(size=3)
        if part in LINKS:
            along = place_of(device, part) - data.xpos[model.body(LINKS[part]).id]
            pull -= (pull @ along) / (along @ along) * along
        pull /= np.linalg.norm(pull)
        lever = float(np.abs(pull @ jacobian).max())
        if lever >= LEVER:
            return pull, lever


def measure(report: Report) -> None:
    """Fill the report."""
    count = 200 if report.options.full else 16
    cases, _ = draw(report.options.seed + 2300, -(-count // len(MOUNTINGS)), "sensor")
    # The true payloads of the draw, for each is told here as it is.
    right = [case._replace(configured=case.true) for case in cases[:count]]
    kinds = [*(("flange", force) for force in FLANGE), *((part, LINK) for part in LINKS)]
    results = [r for r in spread(measure_hand, [Hand(case, *kind) for kind in kinds for case in right]) if r.entered]
    for kind in kinds:
        part, force = kind
        some = [r for r in results if r.hand[1:] == kind]
        led = sum(r.way > LED for r in some)
        report.share(f"{part}, {force:g} N: moved by more than {LED:g} mm", led, len(some), at_least=SURE.get(kind))
        report.row(f"{part}, {force:g} N: way in a second, p50", float(np.median([r.way for r in some])), "mm", n=len(some))
    report.share("free-drive ended meanwhile", sum(r.ended for r in results), len(results), at_most=0.0)
    for r in results:
        if r.ended or (r.hand[1:] in SURE and r.way <= LED):
            case, part, force = r.hand
            end = "; free-drive ended" if r.ended else ""
            report.notes.append(
                f"{part}, {force:g} N, lever {r.lever:.2f} m, {case.mounting}, case {case.number}: {r.way:.1f} mm{end}"
            )


if __name__ == "__main__":
    main("least_hand", measure)
