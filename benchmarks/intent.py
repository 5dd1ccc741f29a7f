"""Intent: what must not start free-drive, bumps while it is tried, and pushes that are meant; sources FD-5 (c) to (f).

Many touches follow each other on one arm, with rests between. A push counts along -z of the base, within 30°. Truth is read for
scoring alone.
"""

import math
from collections import Counter
from typing import NamedTuple

import numpy as np

from benchmarks.arms import senses
from benchmarks.common import Report, main, spread
from benchmarks.hold import HOLD, IDLE, MOUNTINGS, RELEASE, flange
from benchmarks.payload import SETTINGS, Case, draw, simulation
from pendant.all_settings import Settings, apply
from pendant.event_table import TABLE
from pendant.events.event import Event, Kind
from pendant.events.event_row import Effect
from pendant.inputs import Command, Inputs
from pendant.program.steps import JointMove, Program
from pendant.settings.schema import ticks
from pendant.tick.modes import Mode
from sim.exchange.desk import Wishes
from sim.plant.touch import ZERO, Push
from sim.simulation import Simulation

THRESHOLD, PERIOD, ANGLE = 15.0, 1.0, 30.0  # [N], [s], [°]
PUSH: dict[str, float | bool | str] = {
    "activation.period": PERIOD,
    "free_drive.cool_down": 0.1,
    "signals.push.on": True,
    "signals.push.threshold": THRESHOLD,
    "signals.push.angle": ANGLE,
    "signals.push.z": -1.0,
}
FORCE = apply(Settings(), PUSH)
ALL = apply(FORCE, {"signals.twist.on": True, "signals.joints.on": True, "signals.pattern.on": True})
SHAKEN = apply(ALL, {"handshake.on": True})
REST = 500  # ticks between two touches
OFF = 0.02  # [s] in which a hand leaves the arm
LINKS = ("shoulder", "elbow", "wrist_1", "wrist_2", "wrist_3", "flange")
BUMPS, SLOW, FORBIDDEN = "bump", "slow", "forbidden"
CONE = "in-cone leaning"
PER_ARM = 9
TRIED = frozenset({Kind.SEQUENCE_STARTED, Kind.ENTERED})


class Touching(NamedTuple):
    """A touch of an arm."""

    kind: str
    part: str
    force: tuple[float, float, float]  # in W [N]
    torque: tuple[float, float, float]  # in W [N·m]
    length: float  # [s]
    tremor: tuple[float, float]  # share of the force (amplitude), and its frequency [Hz]
    pieces: float  # contacts of so long, with gaps as long; 0: one contact [s]
    sine: bool  # half a sine, as a knock; else it comes in 0.1 s

    def at(self, time: float) -> Push | None:
        """What is felt `time` seconds after its begin."""
        if time >= self.length or (self.pieces and int(time / self.pieces) % 2):
            return None
        share = math.sin(math.pi * time / self.length) if self.sine else min(time / 0.1, (self.length - time) / OFF, 1.0)
        share *= 1.0 + self.tremor[0] * math.sin(2.0 * math.pi * self.tremor[1] * time)
        x, y, z = (share * value for value in self.force)
        tx, ty, tz = (share * value for value in self.torque)
        return Push(self.part, ZERO, (x, y, z), (tx, ty, tz))


class Arm(NamedTuple):
    """An arm that is touched, again and again."""

    case: Case
    what: str  # "must not", "must not, force alone", "bumps in the check", "pushes"
    touches: int
    running: bool = False


class Count(NamedTuple):
    """What came of the touches of an arm."""

    touches: int
    wrong: tuple[str, ...]  # kinds of touches that started free-drive although they must not
    on_time: int
    entered: int
    way: float  # of the flange in a check, at most [mm]
    kinds: tuple[str, ...]  # of what refused
    wait: float = 0.0  # from the end of a push until the arm was free, at most [s]


def base_axes(device: Simulation) -> np.ndarray:
    """Orientation of B in W (3, 3)."""
    return device.plant.data.xmat[device.plant.model.body("foot").id].reshape(3, 3)


def direction(device: Simulation, rng: np.random.Generator, least: float, most: float) -> np.ndarray:
    """A direction in W whose angle to -z of the base lies between the two [°]."""
    angle, round_z = math.radians(rng.uniform(least, most)), rng.uniform(0.0, 2.0 * math.pi)
    across = math.sin(angle)
    return base_axes(device) @ np.array([across * math.cos(round_z), across * math.sin(round_z), -math.cos(angle)])


def touch(device: Simulation, rng: np.random.Generator, kind: str, *, cone: bool, running: bool) -> Touching:
    """One touch that must not start free-drive."""

    def made(name: str, part: str, force: np.ndarray, length: float, **more: object) -> Touching:
        values = {"torque": ZERO, "tremor": (0.0, 1.0), "pieces": 0.0, "sine": False, **more}
        return Touching(name, part, tuple(force.tolist()), length=length, **values)  # type: ignore[arg-type]

    away = direction(device, rng, 40.0, 180.0)
    part = str(rng.choice(LINKS))
    if kind == BUMPS:
        force = rng.uniform(5.0, 300.0) * direction(device, rng, 0.0, 180.0)
        return made(BUMPS, part, force, rng.uniform(0.002, 0.15), sine=True)
    if kind == SLOW:
        which = int(rng.integers(0, 5))
        if which == 0:
            lean = direction(device, rng, 0.0, 25.0) if cone else away
            return made(CONE if cone else "lean", "flange", rng.uniform(10.0, 60.0) * lean, rng.uniform(1.0, 5.0))
        if which == 1:
            tremor = (rng.uniform(0.1, 0.3), rng.uniform(6.0, 12.0))
            return made("resting hand", "flange", rng.uniform(5.0, 25.0) * away, rng.uniform(1.0, 4.0), tremor=tremor)
        if which == 2:
            down = np.array([0.0, 0.0, -1.0])
            return made("arm draped over a link", part if part != "flange" else "wrist_1", rng.uniform(5.0, 25.0) * down, 3.0)
        if which == 3:
            return made("cable", "flange", rng.uniform(5.0, 20.0) * away, 3.0, tremor=(0.3, 1.5))
        return made("clamped" if running else "slow collision", part, rng.uniform(20.0, 100.0) * away, 1.5)
    inside = direction(device, rng, 0.0, 25.0)
    if rng.uniform() < 0.5:
        axis = rng.normal(size=3)
        torque = tuple((rng.uniform(4.0, 10.0) * axis / np.linalg.norm(axis)).tolist())
        return made("too much torque", "flange", rng.uniform(18.0, 45.0) * inside, rng.uniform(1.2, 3.0), torque=torque)
    return made("short contacts", "flange", rng.uniform(18.0, 45.0) * inside, 5.0, pieces=rng.uniform(0.3, 0.9))


def run_touch(device: Simulation, touching: Touching, rest: int = REST) -> list[Event]:
    """Let it happen and rest; whatever was started is left again."""
    events: list[Event] = []
    for tick in range(round(500 * touching.length) + rest):
        push = touching.at(0.002 * tick)
        events += device.tick(Wishes(IDLE.inputs, () if push is None else (push,), ())).events
    leave(device)
    return events


def leave(device: Simulation) -> None:
    """End free-drive or a stop, and wait until the arm stands."""
    device.tick(Wishes(Inputs(commands=(Command.LEAVE_FREE_DRIVE,)), (), ()))
    for _ in range(200):
        if device.tick(IDLE).mode is Mode.STOP:
            device.tick(Wishes(Inputs(commands=(Command.RESET,)), (), ()))


def start(device: Simulation, rng: np.random.Generator) -> None:
    """A program that moves the joints to and fro for as long as it takes."""
    q = device.plant.q.copy()
    there = q + 0.2 * rng.uniform(-1.0, 1.0, q.size)
    moves = [JointMove(q=tuple(to.tolist()), speed=0.05, acceleration=0.1) for _ in range(50) for to in (there, q)]
    device.tick(Wishes(Inputs(program=Program(steps=tuple(moves))), (), ()))
    device.tick(Wishes(Inputs(commands=(Command.START_PROGRAM,)), (), ()))


def measure_arm(arm: Arm) -> Count:
    """All touches of one arm."""
    rng = np.random.default_rng([arm.case.seed, arm.case.number, 17])
    if not arm.what.startswith("must not"):
        return (measure_pushes if arm.what == "pushes" else measure_bumps)(arm, rng)
    alone = arm.what.endswith("force alone")
    device = simulation(arm.case, FORCE if alone else SHAKEN)
    wrong: list[str] = []
    for k in range(arm.touches):
        kind = (BUMPS, SLOW, FORBIDDEN)[k % 3]
        if arm.running and device.tick(IDLE).mode is not Mode.RUN:
            start(device, rng)
        touching = touch(device, rng, kind, cone=not arm.running and rng.uniform() < 0.5, running=arm.running)
        if any(event.kind in TRIED for event in run_touch(device, touching)):
            wrong.append(touching.kind)
    return Count(arm.touches, tuple(wrong), 0, 0, 0.0, ())


def measure_bumps(arm: Arm, rng: np.random.Generator) -> Count:
    """Bumps while the arm is freed to see whether it stays, the button held all the time."""
    device = simulation(arm.case, apply(SETTINGS, {"free_drive.cool_down": 0.1}))
    way, entered = 0.0, 0
    kinds: list[str] = []
    for _ in range(arm.touches):
        touching = touch(device, rng, BUMPS, cone=False, running=False)
        begin = int(rng.integers(5, 450))  # ticks into the check
        origin, since = flange(device), -1
        for _ in range(800):
            push = touching.at(0.002 * (since - begin)) if since >= begin else None
            decision = device.tick(Wishes(HOLD.inputs, () if push is None else (push,), ()))
            since = 0 if any(event.kind is Kind.SEQUENCE_STARTED for event in decision.events) else since + (since >= 0)
            if decision.mode is Mode.FREE_DRIVE:
                entered += 1
                break
            if since >= 0:
                way = max(way, float(np.linalg.norm(flange(device) - origin)))
            kinds += [e.kind.value for e in decision.events if TABLE[e.kind].effect is Effect.NO_ENTRY]
            if since >= 0 and any(TABLE[e.kind].effect is Effect.NO_ENTRY for e in decision.events):
                break
        for _ in range(150):  # what the bump still does to the arm that is held again
            if device.tick(RELEASE).mode is not Mode.FREE_DRIVE:
                way = max(way, float(np.linalg.norm(flange(device) - origin)))
        leave(device)
    return Count(arm.touches, (), 0, entered, way, tuple(kinds))


def measure_pushes(arm: Arm, rng: np.random.Generator) -> Count:
    """Pushes as a user means them, then hands off, for as long as the arm may take to come to rest and to be checked."""
    device = simulation(arm.case, FORCE)
    on_time, entered, wait = 0, 0, 0.0
    kinds: list[str] = []
    for _ in range(arm.touches):
        force = rng.uniform(1.2, 3.0) * THRESHOLD * direction(device, rng, 0.0, 20.0)
        length = rng.uniform(1.2, 2.0) * PERIOD + 0.1
        tremor = (0.1 * math.sqrt(2.0), rng.uniform(6.0, 12.0))
        touching = Touching("push", "flange", tuple(force.tolist()), ZERO, length, tremor, 0.0, False)
        done = False
        for tick in range(ticks(length + FORCE.let_go.within + FORCE.sequence.period)):
            push = touching.at(0.002 * tick)
            decision = device.tick(Wishes(IDLE.inputs, () if push is None else (push,), ()))
            for event in decision.events:
                # The push passes the threshold while it comes, within 0.1 s.
                on_time += event.kind is Kind.LET_GO_ASKED and tick * 0.002 <= PERIOD + 0.1 + 0.05
                if event.kind is Kind.ENTERED:
                    done, wait = True, max(wait, 0.002 * tick - length)
                failed = TABLE[event.kind].effect is Effect.NO_ENTRY or event.kind is Kind.ACTIVATION_CANCELLED
                kinds += [event.kind.value] if failed else []
        entered += done
        leave(device)
    return Count(arm.touches, (), on_time, entered, 0.0, tuple(kinds), wait)


def arms(report: Report, what: str, count: int, per_arm: int) -> list[Arm]:
    """Arms with the right payload for `count` touches."""
    number = -(-count // per_arm)
    cases, _ = draw(report.options.seed + 1300, -(-number // len(MOUNTINGS)), "sensor", report.options.arm)
    found = [case._replace(configured=case.true) for case in cases[:number]]
    return [Arm(case, what, per_arm, what.startswith("must not") and k % 3 == 2) for k, case in enumerate(found)]


def measure(report: Report) -> None:
    """Fill the report."""
    full = report.options.full
    felt = senses(report.options.arm)  # a push, by the flange
    for what in ("must not", "must not, force alone") if felt else ("must not",):
        results = spread(measure_arm, arms(report, what, 1000 if full else 72, PER_ARM))
        wrong = Counter(kind for result in results for kind in result.wrong)
        touches = sum(result.touches for result in results)
        inside = wrong.pop(CONE, 0)
        how = "push felt by the flange, no handshake" if what.endswith("alone") else "all sources, handshake"
        report.share(f"{how}: touches that must not, activations", sum(wrong.values()), touches, at_most=0.0)
        report.row(f"{how}: activations by in-cone leaning", inside, "", at_most=None if what.endswith("alone") else 0)
        if wrong:
            report.notes.append(f"{how}: " + ", ".join(f"{kind} {number}" for kind, number in wrong.items()))
    results = spread(measure_arm, arms(report, "bumps in the check", 500 if full else 40, 8))
    bumps = sum(result.touches for result in results)
    report.share("bumps in the check: entered", sum(result.entered for result in results), bumps)
    report.row("bumps in the check: way of the flange, largest", max(r.way for r in results), "mm", at_most=10.0, n=bumps)
    refusals = Counter(kind for result in results for kind in result.kinds)
    report.notes.append("bumps: " + ", ".join(f"{kind} {number}" for kind, number in refusals.items()))
    if not felt:
        return
    results = spread(measure_arm, arms(report, "pushes", 1000 if full else 40, 8))
    pushes, on_time, entered = (sum(count) for count in zip(*((r.touches, r.on_time, r.entered) for r in results), strict=True))
    report.share("pushes: taken within 50 ms of the period's end", on_time, pushes, at_least=0.995)
    report.share("pushes, then hands off: entered", entered, pushes, at_least=0.99)
    report.row("pushes, then hands off: free after, longest", max(r.wait for r in results), "s", n=entered)
    failures = ", ".join(f"{k} {n}" for k, n in Counter(kind for result in results for kind in result.kinds).items())
    report.notes.append(f"pushes refused or cut short: {failures or 'none'}")


if __name__ == "__main__":
    main("intent", measure)
