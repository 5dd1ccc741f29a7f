"""What a hold withstands: its stiffness and its settling after a push on each link, and a motor at its current limit.

A UR5e in postures of hand-guiding work, mismatch on, and the nominal arm beside it. Truth is read for scoring alone.
"""

from typing import Literal, NamedTuple

import numpy as np
from msgspec.structs import replace

from app.files.library import load_arm
from benchmarks.common import Report, main, spread
from benchmarks.postures import posture
from pendant.all_settings import JointControl, Settings
from pendant.inputs import NOTHING, Command, Inputs
from pendant.program.steps import JointMove, Program, Wait
from pendant.tick.estimate import Estimate
from pendant.tick.modes import TICK, TICK_RATE
from sim.arm.scenario import Load, Scenario
from sim.control.feedback import Beginning, Feedback
from sim.exchange.desk import Wishes
from sim.motion.moves import Reference
from sim.plant.touch import Push
from sim.simulation import Simulation

Array = np.ndarray
IDLE = Wishes(NOTHING, (), ())
FORCE, PUSHED, RELEASED = 50.0, 1.0, 2.0  # [N], [s]
SETTLED = 0.3  # of the pushed point from where it was [mm], as benchmarks/hold.py asks of the flange after 2 s
LIMITED = 0.6  # of the shoulder's current: less than its move needs, more than its load
FULL_LOAD = Load(mass=5.0, com=[0.0, 0.0, 0.06])
Mismatch = Literal["on", "nominal"]


class Case(NamedTuple):
    """One posture, or one run at a limit."""

    number: int
    seed: int
    mismatch: Mismatch
    limit: float = 1.0  # on the filed currents
    waits: bool = True  # the integral at a limit


class Held(NamedTuple):
    """One push on one part."""

    part: str
    stiffness: float  # the push over the largest way that its point gave [N/m]
    settling: float  # time until that point is back to `SETTLED` for good [s], not a number for never
    back: float  # of that point after `RELEASED` [mm]


class Overshoot(NamedTuple):
    """One move with its motor at a limit, of the shoulder."""

    share: float  # of the ticks in which it was at its limit
    lag: float  # largest distance behind the reference [mrad]
    beyond: float  # largest distance beyond the target [mrad]


def push_links(case: Case) -> list[Held]:
    """`FORCE` on every part, across its way to the base, then hands off."""
    arm = load_arm("ur5e")
    probe = Simulation(arm, Scenario(mismatch="nominal"), Settings())
    q, _ = posture(np.random.default_rng([case.seed, case.number]), probe)
    simulation = Simulation(arm, Scenario(posture=q, seed=case.seed + case.number, mismatch=case.mismatch), Settings())
    plant = simulation.plant
    for _ in range(TICK_RATE):
        simulation.tick(IDLE)
    held = []
    for part in plant.parts[1:-1]:
        body = plant.model.body(part).id
        start = plant.data.xipos[body].copy()
        across = np.cross(start - plant.data.xpos[plant.model.body("foot").id], [0.3, 0.4, 0.866])
        along = across / np.linalg.norm(across)
        given = 1e-9
        wishes = Wishes(NOTHING, (Push(part, (0.0, 0.0, 0.0), tuple(FORCE * along)),), ())
        for _ in range(round(PUSHED * TICK_RATE)):
            simulation.tick(wishes)
            given = max(given, float((plant.data.xipos[body] - start) @ along))
        last, off = 0, 0.0
        for k in range(round(RELEASED * TICK_RATE)):
            simulation.tick(IDLE)
            off = 1000.0 * float(np.linalg.norm(plant.data.xipos[body] - start))
            last = k + 1 if off > SETTLED else last
        held.append(Held(part, FORCE / given, last * TICK if off <= SETTLED else np.nan, off))
    return held


class Winding(Feedback):
    """The feedback with an integral that knows nothing of the motors' limits."""

    def add(
        self,
        reference: Reference,
        desired: Array,
        estimate: Estimate,
        use: JointControl,
        *,
        excess: Array,
        waits: bool,
        torque: Array,
        start: Beginning | None,
        sticking: Array,
        stiffer: Array,
    ) -> None:
        """All corrections, as if the motors gave whatever is asked of them."""
        super().add(
            reference,
            desired,
            estimate,
            use,
            excess=np.zeros_like(excess),
            waits=waits,
            torque=torque,
            start=start,
            sticking=sticking,
            stiffer=stiffer,
        )


def reach_limit(case: Case) -> Overshoot:
    """Lift the full payload at full acceleration, with the shoulder's current limited, then stand."""
    arm = load_arm("ur5e")
    current = list(arm.motors.current)
    current[1] *= case.limit
    arm = replace(arm, motors=replace(arm.motors, current=current))
    scenario = Scenario(
        seed=case.seed + case.number, mismatch=case.mismatch, payload_true=FULL_LOAD, payload_configured=FULL_LOAD
    )
    simulation = Simulation(arm, scenario, Settings())
    controller, plant = simulation.controller, simulation.plant
    if not case.waits:
        controller.feedback = Winding(arm, simulation.calibration, simulation.dynamics, simulation.tcp)
    end = np.array(arm.chain.home) + np.array([0.0, -0.5, 0.0, 0.0, 0.0, 0.0])
    program = Program(steps=(JointMove(q=tuple(end), speed=0.8, acceleration=1.0), Wait(duration=3.0)))
    simulation.tick(Wishes(Inputs(program=program), (), ()))
    for _ in range(150):
        simulation.tick(IDLE)
    simulation.tick(Wishes(Inputs(commands=(Command.START_PROGRAM,)), (), ()))
    limited, lag, beyond, ticks = 0, 0.0, 0.0, 2 * TICK_RATE
    for _ in range(ticks):
        simulation.tick(IDLE)
        reference = controller.references.now
        assert reference is not None
        limited += bool(controller.motor.excess[1] != 0.0)
        lag = max(lag, 1000.0 * float(plant.q[1] - reference.q[1]))
        beyond = max(beyond, 1000.0 * float(end[1] - plant.q[1]))
    return Overshoot(limited / ticks, lag, beyond)


def measure(report: Report) -> None:
    """Fill the report."""
    seed, full = report.options.seed, report.options.full
    counts: dict[Mismatch, int] = {"on": 20 if full else 4, "nominal": 5 if full else 2}
    cases = [Case(k, seed, mismatch) for mismatch, count in counts.items() for k in range(count)]
    results = dict(zip(cases, spread(push_links, cases), strict=True))
    for mismatch in counts:
        held = [row for case, rows in results.items() if case.mismatch == mismatch for row in rows]
        for part in dict.fromkeys(row.part for row in held):
            mine = [row for row in held if row.part == part]
            label = f"mismatch {mismatch}: {FORCE:g} N on {part}"
            report.row(f"{label}: stiffness, least", min(row.stiffness for row in mine), "N/m", n=len(mine))
            settling = max(row.settling for row in mine)
            report.row(f"{label}: settling to {SETTLED:g} mm, worst", settling, "s", at_most=RELEASED, n=len(mine))
    runs = 6 if full else 2
    kinds = {"no limit": (1.0, True), "limit": (LIMITED, True), "limit, integral goes on": (LIMITED, False)}
    cases = [Case(k, seed, "on", limit, waits) for limit, waits in kinds.values() for k in range(runs)]
    found = spread(reach_limit, cases)
    rows = {name: found[k * runs : (k + 1) * runs] for k, name in enumerate(kinds)}
    limited = rows["limit"]
    least = 100.0 * min(row.share for row in limited)
    report.row("shoulder at its current limit, least share of 2 s", least, "%", at_least=1.0, n=runs)
    for name, mine in rows.items():
        report.row(f"shoulder, {name}: behind its reference, largest", max(row.lag for row in mine), "mrad", n=runs)
        report.row(f"shoulder, {name}: beyond its target, largest", max(row.beyond for row in mine), "mrad", n=runs)
    share = max(row.beyond / row.lag for row in limited)
    report.row("beyond the target after a limit, of what it was behind", 100.0 * share, "%", at_most=5.0, n=runs)


if __name__ == "__main__":
    main("hold_push", measure)
