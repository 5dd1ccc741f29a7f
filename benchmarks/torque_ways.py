"""The torque that is fed back, each way, and joint sensors lost: how well the arm follows a program and holds against a push.

A UR5e, its friction up to 40 % off the filed one, with and without payload. Each sensor is lost at all joints at once. A push
of 50 N at the flange lasts 2 s. Truth is read for scoring alone.
"""

from typing import Literal, NamedTuple

import numpy as np
from msgspec.structs import replace

from app.files.library import load_arm
from benchmarks.common import Report, main, spread
from benchmarks.controls.runs import FULL_LOAD, IDLE, PROGRAMS, Case, begin, run
from pendant.all_settings import FedBackTorque, JointControl, Settings
from pendant.decision import Decision
from pendant.inputs import NOTHING
from sim.arm.scenario import Load, Scenario
from sim.exchange.desk import Wishes
from sim.plant.changes import SensorFault
from sim.plant.touch import Push
from sim.simulation import Simulation

BEFORE, SCORED = 4.0, 4.0  # of a program, with all sensors, and then scored [s]
PUSH = Push("flange", (0.0, 0.0, 0.0), (0.0, 0.0, -50.0))
Sensor = Literal["nothing", "output_encoder", "current", "motor_encoder"]
OUT: tuple[Sensor, ...] = ("nothing", "output_encoder", "current", "motor_encoder")
FOLLOWED = {"nothing": 0.5, "output_encoder": 0.5, "current": 0.5}
"""Bar of the RMS tracking error by what is lost [mrad]; without motor angles a program ends."""
BENT = 3.0
"""Bar of what a push bends while the motors' brakes hold them [mrad]: 50 N at 0.85 m, and 2e4 N·m/rad less a fifth."""
HUM = 1.0
"""Bar of the change of the motor torques from tick to tick, RMS [N·m]: an arm that hums has 20."""


class Way(NamedTuple):
    """One run."""

    fed_back: FedBackTorque
    lost: Sensor
    program: str  # nothing: the arm is held and pushed
    payload: bool
    factor: float  # true friction over the filed one
    seed: int


class Score(NamedTuple):
    """What came of one run."""

    way: Way
    error: float  # RMS of the tracking error; for a held arm its largest deviation when the push has lasted 2 s [mrad]
    peak: float  # largest deviation [mrad]
    after: float  # 3 s after a push [mrad]
    hum: float  # RMS change of the motor torques from tick to tick [N·m]


def lose(simulation: Simulation, sensor: Sensor) -> None:
    """From the next tick on that sensor is out at every joint."""
    if sensor != "nothing":
        simulation.tick(Wishes(NOTHING, (), (SensorFault(sensor=sensor, outage=True),)))


def measure_way(way: Way) -> Score:
    """One run."""
    return follow(way) if way.program else hold(way)


def follow(way: Way) -> Score:
    """A program goes on without the sensor."""
    use = replace(JointControl(), fed_back=way.fed_back)
    simulation = begin(Case(way.program, 35.0, way.payload, way.factor, "on", way.seed), use)
    run(simulation, BEFORE)
    lose(simulation, way.lost)
    missed, torques = [], []

    def look(_: Decision) -> None:
        reference = simulation.controller.references.now
        assert reference is not None
        missed.append(1000.0 * (simulation.plant.q - reference.q))
        torques.append(simulation.controller.motor.command.copy())

    run(simulation, SCORED, look)
    error = np.array(missed)
    return Score(way, float(np.sqrt(np.mean(error**2))), float(np.abs(error).max()), 0.0, hum_of(torques))


def hold(way: Way) -> Score:
    """A held arm is pushed and let go."""
    load = FULL_LOAD if way.payload else Load(mass=0.0)
    scenario = Scenario(seed=way.seed, payload_true=load, payload_configured=load)
    use = replace(JointControl(), fed_back=way.fed_back)
    simulation = Simulation(load_arm("ur5e"), scenario, Settings(joint_control=use))
    simulation.plant.wear(slice(None), way.factor)
    run(simulation, 1.0)
    lose(simulation, way.lost)
    run(simulation, 1.5)
    start, moved, torques = simulation.plant.q.copy(), [], []

    def look(_: Decision) -> None:
        moved.append(1000.0 * float(np.abs(simulation.plant.q - start).max()))
        torques.append(simulation.controller.motor.command.copy())

    run(simulation, 2.0, look, PUSH)
    end = len(moved) - 1
    run(simulation, 3.0, look)
    simulation.tick(IDLE)
    return Score(way, moved[end], max(moved), moved[-1], hum_of(torques[-500:]))


def hum_of(torques: list[np.ndarray]) -> float:
    """RMS of the change from tick to tick."""
    return float(np.sqrt(np.mean(np.diff(torques, axis=0) ** 2)))


def measure(report: Report) -> None:
    """Fill the report."""
    full, seed = report.options.full, report.options.seed
    loads = [(payload, factor) for payload in (False, True) for factor in (0.6, 1.4)] if full else [(True, 1.4), (False, 0.6)]
    programs = ("", *PROGRAMS) if full else ("", *PROGRAMS[1:])
    seeds = range(seed, seed + (3 if full else 1))
    ways = [
        Way(fed_back, lost, program, *load, at)
        for fed_back in FedBackTorque
        for lost in OUT
        for program in programs
        for load in loads
        for at in seeds
        if not (program and lost == "motor_encoder")
    ]
    scores = spread(measure_way, ways)
    pooled: dict[str, float] = {}
    for fed_back in FedBackTorque:
        for lost in OUT:
            mine = [score for score in scores if (score.way.fed_back, score.way.lost) == (fed_back, lost)]
            what = f"{fed_back.value} fed back, {lost.replace('_', ' ')} lost"
            followed, held = [s for s in mine if s.way.program], [s for s in mine if not s.way.program]
            if followed:
                rms = float(np.sqrt(np.mean([s.error**2 for s in followed])))
                if lost == "nothing":
                    pooled[fed_back] = rms
                report.row(f"{what}: tracking error RMS", rms, "mrad", at_most=FOLLOWED[lost], n=len(followed))
                report.row(f"{what}: tracking error, largest", max(s.peak for s in followed), "mrad", n=len(followed))
                report.row(f"{what}: hum, worst", max(s.hum for s in followed), "N·m", at_most=HUM, n=len(followed))
            report.row(f"{what}: pushed with 50 N, largest", max(s.peak for s in held), "mrad", at_most=15.0, n=len(held))
            left = BENT if lost == "motor_encoder" else 1.5
            report.row(f"{what}: after 2 s of it, worst", max(s.error for s in held), "mrad", at_most=left, n=len(held))
            report.row(f"{what}: 3 s after it, worst", max(s.after for s in held), "mrad", at_most=1.5, n=len(held))
            report.row(f"{what}: held, hum, worst", max(s.hum for s in held), "N·m", at_most=HUM, n=len(held))
    ratio = pooled[FedBackTorque.FUSED] / pooled[FedBackTorque.DEFLECTION]
    report.row("fused over deflection: tracking error RMS", ratio, "", at_most=1.0)


if __name__ == "__main__":
    main("torque_ways", measure)
