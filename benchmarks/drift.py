"""Drift: free-drive is on with the right payload and nobody touches the arm; then its flange sensor drifts, steps or fails.

Ramps of 1 to 20 N over 10 s, steps of 5, 10 and 20 N, in any direction of the sensor; an outage. Truth is read for scoring alone.
"""

from typing import NamedTuple

import numpy as np

from benchmarks.arms import heaviest, senses
from benchmarks.common import Report, main, spread
from benchmarks.hold import IDLE, MOUNTINGS, enter, flange
from benchmarks.payload import SETTINGS, Case, draw, simulation
from pendant.all_settings import apply
from pendant.event_table import TABLE
from pendant.events.event import Kind
from pendant.events.event_row import LEAVING
from pendant.tick.modes import Mode
from sim.exchange.desk import Wishes
from sim.plant.changes import SensorFault

SECONDS = 10.0
LASTS = apply(SETTINGS, {"free_drive.period": SECONDS + 1.0, "free_drive.restart_period": SECONDS + 1.0})
STEPS = (5.0, 10.0, 20.0)  # [N]
MOVED = 5.0  # [mm] beyond which the cause must be named

NAMES = frozenset({Kind.WRENCH_LOST, Kind.WALL_REACHED, Kind.SENSOR_STEPPED, Kind.SENSOR_DRIFTED})
"""What names a cause, beside every leaving but those by a period."""

SILENT = frozenset({Kind.LEFT_PERIOD, Kind.LEFT_RESTART})


class Fault(NamedTuple):
    """One free-drive and what becomes of its sensor."""

    case: Case
    kind: str  # "ramp", "step", "outage"
    size: float  # at the end [N]


class Result(NamedTuple):
    """What came of it."""

    fault: Fault
    entered: bool
    way: float  # of the flange, at most [mm]
    named: bool
    kinds: tuple[str, ...]


def measure_fault(fault: Fault) -> Result:
    """Enter, let the sensor go wrong, watch."""
    device = simulation(fault.case, LASTS)
    if not enter(device):
        return Result(fault, False, 0.0, False, ())
    rng = np.random.default_rng([fault.case.seed, fault.case.number, 13])
    direction = rng.normal(size=3)
    direction *= fault.size / np.linalg.norm(direction)
    changes = (SensorFault(sensor="force_torque", outage=True),)
    if fault.kind == "ramp":
        rates = (direction / SECONDS).tolist()
        changes = tuple(SensorFault(sensor="force_torque", channel=k, drift=rate) for k, rate in enumerate(rates))
    elif fault.kind == "step":
        changes = tuple(SensorFault(sensor="force_torque", channel=k, offset=x) for k, x in enumerate(direction.tolist()))
    start = flange(device)
    way, named = 0.0, False
    kinds: list[str] = []
    for tick in range(round(500 * SECONDS)):
        decision = device.tick(Wishes(IDLE.inputs, (), changes if tick == 0 else ()))
        way = max(way, float(np.linalg.norm(flange(device) - start)))
        for event in decision.events:
            leaves = TABLE[event.kind].effect in LEAVING
            named = named or event.kind in NAMES or (leaves and event.kind not in SILENT)
            kinds += [event.kind.value] if leaves or event.kind in NAMES else []
        if decision.mode is not Mode.FREE_DRIVE and tick % 500 == 499:
            break
    return Result(fault, True, way, named, tuple(kinds))


def measure(report: Report) -> None:
    """Fill the report."""
    arm = report.options.arm
    if not senses(arm):
        report.notes.append("there is no sensor that could drift")
        return
    count = 200 if report.options.full else 20
    cases, _ = draw(report.options.seed + 1100, -(-count // len(MOUNTINGS)), "sensor", arm)
    rng = np.random.default_rng([report.options.seed, 13])
    faults: list[Fault] = []
    for k, case in enumerate(cases[:count]):
        mass = float(rng.uniform(0.0, heaviest(arm)))
        kind = ("ramp", "step", "ramp", "step", "outage")[k % 5]
        size = float(rng.uniform(1.0, 20.0)) if kind == "ramp" else STEPS[k // 5 % len(STEPS)]
        faults.append(Fault(case._replace(true=mass, configured=mass), kind, size))
    results = [result for result in spread(measure_fault, faults) if result.entered]
    for kind in ("ramp", "step", "outage"):
        some = [result for result in results if result.fault.kind == kind]
        report.row(f"{kind}: way of the flange, largest", max(r.way for r in some), "mm", at_most=30.0, n=len(some))
    far = [result for result in results if result.way > MOVED]
    report.share(f"moved by more than {MOVED:g} mm: cause named", sum(result.named for result in far), len(far), at_least=1.0)
    for r in sorted(results, key=lambda r: -r.way)[:4]:
        report.notes.append(
            f"{r.fault.kind} of {r.fault.size:.0f} N, {r.fault.case.true:.1f} kg: {r.way:.1f} mm; {', '.join(r.kinds)}"
        )


if __name__ == "__main__":
    main("drift", measure)
