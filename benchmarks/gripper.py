"""Gripper: parts of 0.1 to 4 kg at random are gripped, carried, dropped, held and put down, by a UR5e and a UR10e.

Friction, size, place and where the fingers close, up to 20 mm beside the part's middle, are random. Every second force is a fifth
above what friction needs at half the usual speed, the others are a fifth below what it needs at rest: the first parts must be
carried, the others fall. Then a minute of holding, parts put down, free-drive with a part that nobody told of, and what a tick
costs. Last, a program drives the gripper through its port, beside three clients, in real time. Truth is read for scoring alone.
"""

import time
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import NamedTuple

import numpy as np

from benchmarks.common import Report, main, spread
from benchmarks.gripped.picks import HIGH, SPEED, Pick, Picking, draw, needed
from benchmarks.gripped.port_program import worked
from benchmarks.hold import HOLD, IDLE
from pendant.events.event import Kind
from pendant.tick.modes import TICK

ASIDE = np.array([0.0, 0.25, 0.0])
"""Way of a part across the table, in B [m]."""

UP = np.array([0.0, 0.0, HIGH])
PRESSED = 3.0
"""Time for which the button of free-drive is held [s]."""

TURNS, TICKS = 12, 100
"""How often, and how many ticks each time, the cost of a tick is looked at."""


class Carried(NamedTuple):
    """What came of a pick."""

    pick: Pick
    gripped: bool
    held: bool  # at the end of the way
    slid: float  # of the part in the gripper, in a minute [mm]; 0: not looked at
    off: float  # of the part from where it was to be put [mm]; 0: not put down


class Untold(NamedTuple):
    """Free-drive with a part that nobody told of."""

    pick: Pick
    held: bool
    entered: bool
    refused: bool


def carry(pick: Pick) -> Carried:
    """Grip a part, tell of it, lift it and carry it aside."""
    picking = Picking(pick)
    picking.close()
    gripped = picking.held
    picking.tell()
    picking.go((picking.grips + UP, SPEED), (picking.grips + UP + ASIDE, SPEED))
    return Carried(pick, gripped, picking.held, 0.0, 0.0)


def hold(pick: Pick) -> Carried:
    """Hold a part in the air for a minute."""
    picking = Picking(pick)
    picking.close()
    picking.tell()
    picking.go((picking.grips + UP, SPEED))
    before = picking.in_flange()
    picking.run(60.0)
    return Carried(pick, True, picking.held, 1e3 * float(np.linalg.norm(picking.in_flange() - before)), 0.0)


def place(pick: Pick) -> Carried:
    """Put a part down beside where it was."""
    picking = Picking(pick)
    picking.close()
    picking.tell()
    wanted = picking.part + ASIDE
    aside = picking.grips + ASIDE
    picking.go((picking.grips + UP, SPEED), (aside + UP, SPEED), (aside, 0.1))
    picking.open()
    picking.go((aside + UP, SPEED))
    return Carried(pick, True, picking.held, 0.0, 1e3 * float(np.linalg.norm(picking.part - wanted)))


def untold(pick: Pick) -> Untold:
    """Grip a part, lift it, and ask for free-drive."""
    picking = Picking(pick)
    picking.close()
    picking.go((picking.grips + UP, 0.1))
    picking.run(0.5)
    held = picking.held
    picking.events.clear()
    for _ in range(round(PRESSED / TICK)):
        picking.tick(HOLD)
    kinds = {event.kind for event in picking.events}
    return Untold(pick, held, Kind.ENTERED in kinds, Kind.REFUSED_PAYLOAD in kinds)


def cost(pick: Pick) -> tuple[float, float, float]:
    """Processor time of a tick: a part in the gripper; the same arm beside its table; a part that lies on the table [µs]."""
    held, bare, lies = Picking(pick), Picking(pick, part=False), Picking(pick)
    held.close()
    held.go((held.grips + UP, SPEED))
    spans: list[list[float]] = [[], [], []]
    for _ in range(TURNS):
        for found, picking in zip(spans, (held, bare, lies), strict=True):
            begun = time.process_time()
            for _ in range(TICKS):
                picking.device.tick(IDLE)
            found.append((time.process_time() - begun) / TICKS * 1e6)
    return float(np.median(spans[0])), float(np.median(spans[1])), float(np.median(spans[2]))


def measure(report: Report) -> None:
    """Fill the report."""
    full, seed = report.options.full, report.options.seed
    picks = draw(seed, 300 if full else 30, kinds="both")
    found = spread(carry, picks)
    strong, weak = [r for r in found if r.pick.holds], [r for r in found if not r.pick.holds]
    report.share("a part between the fingers: gripped", sum(r.gripped for r in found), len(found), at_least=1.0)
    report.share("a force that allows it by a fifth: carried", sum(r.held for r in strong), len(strong), at_least=1.0)
    report.share("a force that falls short by a fifth: dropped", sum(not r.held for r in weak), len(weak), at_least=1.0)
    kept = spread(hold, draw(seed + 1, 10 if full else 2, kinds="holds"))
    report.row("held for a minute: slides by, largest", max(r.slid for r in kept), "mm", at_most=1.0, n=len(kept))
    report.share("held for a minute: still there", sum(r.held for r in kept), len(kept), at_least=1.0)
    put = spread(place, draw(seed + 2, 20 if full else 6, kinds="holds"))
    report.row("put down: off its place, largest", max(r.off for r in put), "mm", at_most=2.0, n=len(put))
    asked = spread(untold, draw(seed + 3, 100 if full else 12, kinds="holds", least=1.0))
    report.share("part of 1 to 4 kg that nobody told of: held", sum(r.held for r in asked), len(asked), at_least=1.0)
    held = [r for r in asked if r.held]
    report.share("not told of: free-drive refused", sum(r.refused and not r.entered for r in held), len(held), at_least=0.97)
    carried, bare, lying = cost(draw(seed + 4, 1, kinds="holds")[0])
    report.row("a tick with a part in the gripper, as a multiple of one without parts", carried / bare, "", at_most=1.5)
    report.row("a tick with a part that lies on the table, the same", lying / bare, "")
    with TemporaryDirectory() as folder:
        work = worked(Path(folder), 600.0 if full else 30.0)
    report.row("a program beside three clients: rounds of pick and place", work.rounds, "", at_least=1, n=1)
    report.row("a program beside three clients: it ended early", work.trouble or "no", "")
    report.row("a program beside three clients: closed on nothing", work.missed, "times", at_most=0)
    report.row("a program beside three clients: simulated seconds a second", work.pace, "")
    for r in [r for r in found if r.held is not r.pick.holds or not r.gripped][:5]:
        report.notes.append(f"{r.pick}: gripped {r.gripped}, held {r.held}; friction needs {needed(r.pick, 0.0):.0f} N at rest")
    for r in [r for r in asked if not r.held or not r.refused or r.entered][:5]:
        report.notes.append(f"{r.pick}: held {r.held}, refused {r.refused}, entered {r.entered}")


if __name__ == "__main__":
    main("gripper", measure)
