"""Imported: arms from files hold, are freed and refused, led, walled in, and stop where they touch, at their home posture.

`IMPORTED_ARMS=FOLDER` names a folder that `pendant import --out FOLDER` has filled; without it two small arms are imported, a
URDF and an MJCF. The payload is the rated one, all mismatch is on. A hand has 15 N, or 1.5 times the arm's stated friction at the
flange where that is more. Lengths and speeds go with the reach. Truth is read for scoring alone.
"""

import os
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

import numpy as np

from app.arm_import.import_files import written
from app.arm_import.importing import imported
from app.files.bad_input import BadInput
from app.files.library import load_arm
from app.runs.runner import RunOutcome, run, simulate
from app.session.actions import Hold, Lean, LoadProgram, Press, Release, Tap
from app.session.expectations import Displacement, Never, State
from app.session.prepare import prepare
from app.session.profiles import Ramp
from app.session.session_file import Session
from benchmarks.arms import friction_at
from benchmarks.blocking.places import box_across, tip
from benchmarks.common import Report, main, spread
from benchmarks.contacts.recording import contact_force
from benchmarks.hold import easiest, flange
from pendant.all_settings import Settings
from pendant.decision import Decision
from pendant.events.event import Kind
from pendant.program.reaction import Until
from pendant.program.steps import JointMove, Program
from pendant.tick.estimate import GRAVITY
from pendant.tick.modes import TICK, Mode
from pendant.walls.definitions import AnyBorder, Area
from pendant.walls.shapes import HalfSpace
from sim.arm.arm_file import Arm
from sim.arm.scenario import Load, Scenario, ToolModel
from sim.simulation import Simulation
from tests.app.arm_import.arms_of_the_test import MJCF, URDF, laid_out

FOLDER = "IMPORTED_ARMS"
"""Environment variable: the folder of imported arms."""

USUAL_REACH = 0.85
"""Of the arm that lengths and speeds are of [m]."""

DRIFT = 0.3  # [mm] under the rated payload's weight
HAND, OVER_FRICTION, LED_AT = 15.0, 1.5, 0.1  # [N], times friction at this speed of the flange [m/s]
WRONG = {True: 0.2, False: 0.4}
"""Of the rated payload that is refused, by whether the arm senses forces at the flange or torques in its joints."""
SENSES_TORQUE = 0.05
"""Error of a transmission's stiffness from which down the deflection is a torque sensor."""

WAY, WALL, BEYOND = 0.15, 0.06, 0.010  # of the hand; to the wall; beyond it at most [m]
GAP, BEHIND, TABLE = 0.06, 0.06, 2e4  # before the table and behind its surface [m]; its stiffness [N/m]
BLOCK = 0.1
"""Side of the block that stands for a table [m]: no larger, for some of the arm may be below its flange."""
WAYS = ((0.0, 0.0, -1.0), (0.0, 1.0, 0.0), (0.0, -1.0, 0.0), (1.0, 0.0, 0.0), (-1.0, 0.0, 0.0), (0.0, 0.0, 1.0))
SLOW, FAST = 0.05, 0.25  # onto the table [m/s]
SOON = 1.0  # after the touch it is told [s]

WHATS = {
    "hold": "held under the rated payload's weight",
    "free": "freed with the right payload",
    "less": "payload told too light: refused",
    "more": "payload told too heavy: refused",
    "follow": "follows the hand",
    "wall": "stops at the wall",
    "table": "contact with a table told",
    "hit": "stopped by a collision",
}


class Case(NamedTuple):
    """One session of one arm."""

    arm: str  # path of its file
    what: str  # of `WHATS`
    seed: int


class Result(NamedTuple):
    """What came of it."""

    case: Case
    held: bool
    drift: float  # of the flange in `hold` [mm]
    why: str  # of what did not come, what was seen


def senses(arm: Arm) -> bool:
    """The arm feels forces by more than its motors' currents."""
    return arm.sensors.force_torque is not None or arm.accuracy.stiffness <= SENSES_TORQUE


def hand(arm: Arm) -> float:
    """Force of the hand [N]."""
    return max(HAND, OVER_FRICTION * friction_at(arm, "flange", LED_AT))


def measure_case(case: Case) -> Result:
    """Run the session and judge it."""
    arm = load_arm(case.arm)
    session = session_of(case, arm)
    prepared = prepare(session, case.what)
    device, places, touched = simulate(prepared), [], [0]

    def see(_: Decision) -> None:
        places.append(flange(device).copy())
        if not touched[0] and contact_force(device) > 0.0:
            touched[0] = len(places)

    outcome = run(session, prepared, device, None, see=see)
    unmet = [f"{verdict.expected}: {verdict.seen}" for verdict in outcome.verdicts if not verdict.passed]
    if case.what in TOLD:
        unmet += untold(outcome, TOLD[case.what], touched[0])
    way = np.array(places[round(2.0 / TICK) :])
    drift = float(np.linalg.norm(way - way[0], axis=1).max())
    if case.what == "hold" and drift > DRIFT:
        unmet.append(f"drift of {drift:.2f} mm")
    return Result(case, not unmet, drift, "; ".join(unmet[:2]))


TOLD = {"table": (Kind.CONTACT_GAINED,), "hit": (Kind.COLLISION, Kind.PATH_LEFT)}
"""The events that tell of a touch."""


def untold(outcome: RunOutcome, kinds: tuple[Kind, ...], touched: int) -> list[str]:
    """Why a touch in that tick, 0 for none, was not told soon after, or was told before."""
    if not touched:
        return ["nothing was touched"]
    told = [event.tick - touched for event in outcome.events if event.kind in kinds]
    if not told:
        return ["the touch was not told"]
    return [] if 0 <= told[0] * TICK <= SOON else [f"told {told[0] * TICK:.3f} s after the touch"]


def session_of(case: Case, arm: Arm) -> Session:
    """The session of a case."""
    return MAKERS[case.what](case, arm)


def _hold(case: Case, arm: Arm) -> Session:
    force = [0.0, 0.0, -GRAVITY * arm.payload]
    return Session(
        title="hold",
        robot=case.arm,
        seed=case.seed,
        duration=12.0,
        timeline=[Lean(at=0.5, length=20.0, force=force, profile=Ramp(rise=0.5, fall=0.5))],
        expectations=[State(mode=Mode.TEACH, safety="NORMAL", begin=0.0, end=12.0)],
    )


def _load(mass: float) -> Load:
    return Load(mass=mass, com=[0.0, 0.0, 0.03])


def _free(case: Case, arm: Arm) -> Session:
    return Session(
        title="free",
        robot=case.arm,
        seed=case.seed,
        duration=6.0,
        payload_true=_load(arm.payload),
        payload_configured=_load(arm.payload),
        timeline=[
            Press(at=0.5, control="free_drive"),
            Release(after="mode FREE_DRIVE", delay=0.3, control="free_drive"),
        ],
        expectations=[
            State(mode=Mode.FREE_DRIVE, by=4.0),
            State(mode=Mode.FREE_DRIVE, after="mode FREE_DRIVE", begin=0.0, end=1.5),
            Displacement(after="mode FREE_DRIVE", begin=0.0, end=1.5, max=0.01),
        ],
    )


def _wrong(case: Case, arm: Arm) -> Session:
    error = WRONG[senses(arm)] * arm.payload
    true, told = (arm.payload, arm.payload - error) if case.what == "less" else (arm.payload - error, arm.payload)
    return Session(
        title="wrong",
        robot=case.arm,
        seed=case.seed,
        duration=5.0,
        payload_true=_load(true),
        payload_configured=_load(told),
        timeline=[Tap(at=0.5, control="free_drive", length=3.0)],
        expectations=[Never(kind=Kind.ENTERED)],
    )


def _follow(case: Case, arm: Arm) -> Session:
    right, scale = _free(case, arm), arm.reach / USUAL_REACH
    probe = Simulation(arm, Scenario(payload_true=right.payload_true, payload_configured=right.payload_configured), Settings())
    towards = easiest(probe)
    carry, along = (WAY * scale * towards).tolist(), towards.tolist()
    start = flange(probe) / 1000.0
    bounds = (0.5 * WAY * scale, None)
    walls: list[AnyBorder] = []
    ends = [State(mode=Mode.FREE_DRIVE, after="mode FREE_DRIVE", begin=0.6, end=3.6)]
    if case.what == "wall":
        place = start + WALL * scale * towards
        shape = HalfSpace(normal=(along[0], along[1], along[2]))
        walls = [Area(name="there", shape=shape, reference="world", position=(float(place[0]), float(place[1]), float(place[2])))]
        bounds, ends = (0.5 * WALL * scale, WALL * scale + BEYOND), []
    low, high = bounds
    timeline = [*right.timeline, Hold(after="mode FREE_DRIVE", delay=0.6, length=3.0, carry=carry, cap=hand(arm))]
    led = Displacement(after="mode FREE_DRIVE", begin=0.5, end=3.6, along=along, min=low, max=high)
    return Session(
        title=case.what,
        robot=case.arm,
        seed=case.seed,
        duration=8.5,
        payload_true=right.payload_true,
        payload_configured=right.payload_configured,
        walls=walls,
        timeline=timeline,
        expectations=[State(mode=Mode.FREE_DRIVE, by=4.0), led, *ends],
    )


def _touch(case: Case, arm: Arm) -> Session:
    """Down, or else the first way on which the block is not where some of the arm is."""
    for way in WAYS:
        session = _touching(case, arm, np.array(way))
        try:
            simulate(prepare(session, case.what))
        except BadInput:
            continue
        return session
    raise ValueError(f"{arm.name}: no way leads from its home posture to a block")


def _touching(case: Case, arm: Arm, way: np.ndarray) -> Session:
    scale = arm.reach / USUAL_REACH
    length = 0.1 * scale
    rod = ToolModel(
        name="rod",
        mass=0.1 * arm.payload,
        com=[0.0, 0.0, 0.5 * length],
        tcp=[0.0, 0.0, length],
        length=length,
        radius=0.02 * scale,
    )
    probe = Simulation(arm, Scenario(tool=rod), Settings())
    q, place = np.array(arm.chain.home), tip(probe)
    _, R, jacobian = probe.dynamics.update(q)
    moved = jacobian[:3] + np.cross(jacobian[3:].T, R @ probe.tcp).T
    qd = moved.T @ way
    velocity = moved @ qd
    size, speed = float(np.linalg.norm(velocity)), scale * (SLOW if case.what == "table" else FAST)
    towards = velocity / size
    side = BLOCK * scale
    table = box_across("table", place + (GAP * scale + rod.radius) * towards, towards, (side, side, side), stiffness=TABLE)
    share = min(float(np.max(np.abs(qd) * speed / size / np.array(arm.limits.speed))), 1.0)
    goal = q + qd * (scale * (GAP + BEHIND) / size)
    until = Until(change="gained") if case.what == "table" else None
    return Session(
        title=case.what,
        robot=case.arm,
        seed=case.seed,
        duration=6.0,
        tool=rod,
        world=[table],
        settings={"contact.on": case.what == "table"},
        program=Program(name="down", steps=(JointMove(q=tuple(goal.tolist()), speed=share, acceleration=0.5, until=until),)),
        timeline=[LoadProgram(at=0.5, command="start")],
        expectations=[State(safety="PROTECTIVE_STOP", by=6.0)] if case.what == "hit" else [],
    )


MAKERS: dict[str, Callable[[Case, Arm], Session]] = {
    "hold": _hold,
    "free": _free,
    "less": _wrong,
    "more": _wrong,
    "follow": _follow,
    "wall": _follow,
    "table": _touch,
    "hit": _touch,
}


def arms_in(folder: Path) -> list[Path]:
    """Files of the arms that imports have written there."""
    return sorted(path for path in folder.glob("*/*.yaml") if path.stem == path.parent.name)


def small_arms(folder: Path) -> list[Path]:
    """Files of two small arms, imported into a folder."""
    files = (laid_out(folder / "urdf", URDF, "arm.urdf"), laid_out(folder / "mjcf", MJCF))
    return [written(imported(file), file, folder / "arms") for file in files]


def measure(report: Report) -> None:
    """Fill the report."""
    named = os.environ.get(FOLDER, "")
    with tempfile.TemporaryDirectory() as scratch:
        paths = arms_in(Path(named).resolve()) if named else small_arms(Path(scratch))
        seeds = range(report.options.seed, report.options.seed + (3 if report.options.full else 1))
        found = spread(measure_case, [Case(str(path), what, seed) for path in paths for what in WHATS for seed in seeds])
        for path in paths:
            _rows(report, load_arm(path), [each for each in found if each.case.arm == str(path)])


def _rows(report: Report, arm: Arm, found: list[Result]) -> None:
    """The rows of one arm."""
    report.row(f"{arm.name}: rated payload", arm.payload, "kg")
    report.row(f"{arm.name}: payload error that is to be refused", WRONG[senses(arm)] * arm.payload, "kg")
    report.row(f"{arm.name}: force of the hand", hand(arm), "N")
    for what, words in WHATS.items():
        these = [each for each in found if each.case.what == what]
        if what == "hold":
            report.row(f"{arm.name}: drift, {words}", max(each.drift for each in these), "mm", at_most=DRIFT, n=len(these))
        report.share(f"{arm.name}: {words}", sum(each.held for each in these), len(these), at_least=1.0)
        report.notes += [f"{arm.name}, {what}, seed {each.case.seed}: {each.why}" for each in these if not each.held]


if __name__ == "__main__":
    main("imported", measure)
