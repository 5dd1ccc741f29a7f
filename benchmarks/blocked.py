"""Blocked: a moving arm meets a table, a post, itself or a hand, presses for 0.2 to 10 s, and is stopped in every way there is.

From the stop on the tool may be no faster than it was then, by 20 mm/s, and go no further than it needs to stop, by 5 mm. What
stops it may be the robot itself, whose arm does not follow. The hand pushes against the motion by up to the rated torque of a
joint, and stays. Truth is read for scoring alone.
"""

import math
from collections import deque
from dataclasses import replace
from typing import Any, NamedTuple, get_args

import numpy as np
from msgspec.structs import replace as changed

from app.files.library import load_arm
from app.runs.network_run import NetworkRun
from app.session.actions import DashboardLine, SendScript
from app.session.session_file import Session
from benchmarks.arms import shoulder_height
from benchmarks.blocking.motions import Case, Moves, Obstacle, Stop, Wanted, stops
from benchmarks.blocking.places import box_across, tip
from benchmarks.common import Report, main, spread
from benchmarks.hold import ARMS
from benchmarks.postures import posture
from pendant.all_settings import Settings, apply
from pendant.decision import Decision
from pendant.events.event import Kind
from pendant.inputs import Command, Inputs
from pendant.tick.modes import TICK, Law
from sim.arm.scenario import BoxObject, Scenario, ToolModel
from sim.exchange.desk import Wishes
from sim.motion.jog import MANUAL
from sim.motion.moves import REACTION, SHORTEST_STOP, stop_time
from sim.plant.changes import SensorFault
from sim.plant.touch import Push
from sim.simulation import Simulation

AFTER = 3.0  # that the arm is watched after the stop [s]
FASTER, FURTHER = 0.020, 0.005  # that it may get [m/s], [m]
LATEST = 8.0  # in which a motion that meets nothing is given up [s]
NEAR = 0.05  # from the tool to what it meets, at most [m]
REACHED = 2.0  # and in this time [s]
POSTURES, SPACED = 8, 100_003  # that are tried for a case; between their seeds
SWING = 10  # ticks of a swing of the joints' gears, which a hit sets off
ASIDE = 1e-3  # over which a direction is measured [s]
HAND_COMES, HAND_RISES = 150, 100  # tick at which it begins, ticks in which it rises
THICK = {"table": (0.2, 0.2, 0.2), "post": (0.2, 0.06, 0.3)}  # across the motion first [m]
COMMANDS = {
    "protective": Command.PROTECTIVE_STOP,
    "safeguard": Command.SAFEGUARD_OPEN,
    "emergency": Command.EMERGENCY_STOP,
    "power off": Command.POWER_OFF,
    "pendant stop": Command.STOP_PROGRAM,
    "pause": Command.PAUSE_PROGRAM,
}


class Result(NamedTuple):
    """What the tool did after the stop."""

    case: Case
    stopped_by: str  # the event, or what the bench did
    before: float  # its speed at the stop [m/s]
    faster: float  # than that, at most [m/s]
    swings: float  # faster than in the last swing of the joints before, at most [m/s]
    further: float  # than it needs to stop [m]
    misread: float  # the largest error of a joint's estimated speed while it was pressed and after [rad/s]


def measure_case(case: Case) -> Result | None:
    """Press and stop; None where the arm met nothing in any of some postures."""
    for attempt in range(POSTURES):
        try:
            result = Trial(case._replace(seed=case.seed + SPACED * attempt)).run()
        except ValueError:  # it would begin inside of what it is to meet
            continue
        if result is not None:
            return result
    return None


class Trial:
    """One case, tick by tick."""

    def __init__(self, case: Case) -> None:
        self.case = case
        self.rng = rng = np.random.default_rng(case.seed)
        self.near = min(NEAR, REACHED * case.speed)
        arm = load_arm(case.arm)
        tool = ToolModel(name="rod", mass=0.3, com=[0.0, 0.0, 0.05], tcp=[0.0, 0.0, 0.15], length=0.15, radius=0.02)
        scenario = Scenario(tool=tool, seed=case.seed, self_contact=True)
        probe = Simulation(arm, scenario, Settings())
        q, _ = posture(rng, probe)
        if case.obstacle == "own link":
            q = (np.array(arm.chain.home) + rng.uniform(-0.2, 0.2, arm.n)).tolist()
        self.q = np.array(q)
        self.probe = probe
        self.direction, self.qd = self._way()
        if case.obstacle in THICK:
            scenario = changed(scenario, world=[self._box(case.obstacle)])
        # A collision would stop the arm before it presses.
        jogs = {"program.speed": min(case.speed / MANUAL, 1.0)} if case.moves.startswith("jog") else {}
        use = apply(Settings(), {"collision.on": False, **jogs})
        self.device = Simulation(arm, changed(scenario, posture=q), use)
        self.hand = self._hand()
        self.wanted = Wanted(case, probe, q=self.q, qd=self.qd, direction=self.direction, near=self.near)
        self.network = None
        if not case.moves.startswith(("jog", "program")):
            timeline = [SendScript(at=0.1, text=self.wanted.script()), DashboardLine(at=0.1, send="stop")]
            self.network = NetworkRun(Session(title="blocked", robot=case.arm, duration=60.0, timeline=timeline), self.device)

    def _way(self) -> tuple[np.ndarray, np.ndarray]:
        """The tool's direction (3,) in B, and joint speeds (n,) at the speed of the case [rad/s]."""
        case, rng = self.case, self.rng
        p, R, jacobian = self.probe.dynamics.update(self.q)
        lever = R @ self.probe.tcp
        at_tcp = jacobian[:3] + np.cross(jacobian[3:].T, lever).T
        n = self.q.size
        if case.obstacle == "own link":
            upper_arm = 0.3 * self.probe.dynamics.places(self.q)[2] + [0.0, 0.0, 0.7 * shoulder_height(self.probe.arm)]
            towards = upper_arm - (p + lever)
        elif case.obstacle == "table":
            towards = np.array([0.0, 0.0, -1.0])
        else:
            towards = rng.normal(size=3) * [1.0, 1.0, 0.3]
        towards = towards / np.linalg.norm(towards)
        if case.moves in ("jog line", "program line", "movel", "speedl", "force"):
            if case.moves == "jog line":
                axis = int(np.argmax(np.abs(towards)))
                towards = np.sign(towards[axis]) * np.eye(3)[axis]
            full = np.vstack([at_tcp, jacobian[3:]])
            return towards, np.linalg.solve(full, np.concatenate([case.speed * towards, np.zeros(3)]))
        if case.moves == "jog joint":
            joint = int(np.argmax(np.abs(towards @ at_tcp)))
            qd = np.zeros(n)
            qd[joint] = np.sign(towards @ at_tcp[:, joint])
        else:
            qd = at_tcp.T @ towards
        velocity = at_tcp @ qd
        size = float(np.linalg.norm(velocity))
        return velocity / size, qd * (case.speed / size)

    def _box(self, kind: str) -> BoxObject:
        """What the tool meets, across its way."""
        p, R, _ = self.probe.dynamics.places(self.q)
        gap = 0.02 + 0.003 + float(self.rng.uniform(0.0, self.near))  # the tool's radius first
        surface = p + R @ self.probe.tcp + gap * self.direction
        return box_across(kind, surface, self.direction, THICK[kind], stiffness=self.case.stiffness)

    def _hand(self) -> Push | None:
        """What pushes at the tool against its motion."""
        if self.case.obstacle != "hand":
            return None
        _, R, jacobian = self.probe.dynamics.update(self.q)
        at_tcp = jacobian[:3] + np.cross(jacobian[3:].T, R @ self.probe.tcp).T
        rated = np.array(self.probe.arm.limits.torque)
        gravity = np.abs(self.probe.dynamics.gravity(self.q))
        most = float(np.min((rated - gravity) / np.maximum(np.abs(self.direction @ at_tcp), 1e-3)))
        force = -self.direction * self.case.share * most
        return Push("flange", tuple(self.probe.tcp.tolist()), tuple(force.tolist()))

    def run(self) -> Result | None:
        """Let it move, press, stop; then watch."""
        case, device = self.case, self.device
        ticks, blocked_at = 0, None
        place = tip(device)
        stop_tick, stopped_by = None, ""
        before = start = allowed = 0.0
        faster = swings = further = misread = 0.0
        last: deque[float] = deque(maxlen=SWING)
        moving = False
        drawn = math.inf
        while ticks < (LATEST + 25.0) / TICK:
            ending = ticks >= drawn
            decision = device.tick(self._wishes(ticks, moving, ending=ticks == drawn, ended=ending))
            ticks += 1
            if self.network is not None:
                self.network.see(ticks, decision)
            now = tip(device)
            speed = float(np.linalg.norm(now - place)) / TICK
            place = now
            if stop_tick is None:
                last.append(speed)
            moving = moving or decision.law is Law.FOLLOW
            estimate = device.estimate
            if blocked_at is None and ticks > 50 and self._touched():
                blocked_at = ticks
                drawn = ticks + round(case.pressed / TICK) if case.stop != "end" else math.inf
            if blocked_at is not None:
                misread = max(misread, float(np.abs(estimate.theta_d - device.plant.theta_d).max()))
            if stop_tick is None and moving and (decision.law is not Law.FOLLOW or (ticks == drawn + 1 and case.stop != "lost")):
                if blocked_at is None:
                    return None  # it came to its end, or was refused, before it met anything
                stop_tick, start, before = ticks, now.copy(), speed
                stopped_by = self._cause(decision)
                q, qd = device.plant.q, device.plant.qd
                limits = np.array(device.arm.limits.torque)
                rotor = np.array(device.arm.motors.rotor_inertia)
                length = max(SHORTEST_STOP, stop_time(device.dynamics, q, qd, rotor=rotor, torque=limits))
                allowed = before * (0.5 * length + REACTION)
            elif stop_tick is not None:
                faster = max(faster, speed - before)
                swings = max(swings, speed - max(last))
                further = max(further, float(np.linalg.norm(now - start)) - allowed)
                if ticks - stop_tick > AFTER / TICK:
                    return Result(case, stopped_by, before, faster, swings, further, misread)
            elif ticks > LATEST / TICK and blocked_at is None:
                return None
        return None

    def _cause(self, decision: Decision) -> str:
        kinds = [event.kind for event in decision.events]
        return next((kind.value for kind in kinds if kind in (Kind.PATH_LEFT, Kind.PROGRAM_FAILED)), self.case.stop)

    def _touched(self) -> bool:
        """What stands in the way is touched, or the hand is there with all its force."""
        return self.device.plant.touched if self.hand is None else self.device.tick_count > HAND_COMES + HAND_RISES

    def _wishes(self, tick: int, moving: bool, *, ending: bool, ended: bool) -> Wishes:
        """What is asked of this tick; `ending`: the stop comes now, `ended`: it has come."""
        case = self.case
        inputs, changes = Inputs(), ()
        if self.network is not None:
            actions = [(0, self._sent(0))] if tick == 50 else []
            if ending and case.stop == "dashboard stop":
                actions = [(1, self._sent(1))]
            wishes = self.network.wishes(tick + 1, self.device.snapshot, actions)
            inputs = wishes.inputs
            if case.stop == "lost" and ended:
                inputs = Inputs(commands=inputs.commands)
        elif case.moves.startswith("program"):
            if tick == 10:
                inputs = Inputs(program=self.wanted.program())
            elif tick == 50:
                inputs = Inputs(commands=(Command.START_PROGRAM,))
        elif tick >= 50 and not (case.stop == "release" and ended):
            inputs = Inputs(jog=self.wanted.jog())
        elif ending and case.stop == "release":
            inputs = Inputs(jog_released=True)
        if ending and case.stop in COMMANDS:
            inputs = _with(inputs, COMMANDS[case.stop])
        if ending and case.stop == "fault":
            changes = (SensorFault(sensor="motor_encoder", outage=True),)
        touches = ()
        if self.hand is not None and tick > HAND_COMES:
            share = min((tick - HAND_COMES) / HAND_RISES, 1.0)
            touches = (self.hand._replace(force=tuple(share * value for value in self.hand.force)),)
        return Wishes(inputs, touches, changes)

    def _sent(self, place: int) -> Any:
        return SendScript(at=0.1, text=self.wanted.script()) if place == 0 else DashboardLine(at=0.1, send="stop")


def _with(inputs: Inputs, command: Command) -> Inputs:
    return replace(inputs, commands=(*inputs.commands, command))


def cases(seed: int, count: int) -> list[Case]:
    """So many, drawn."""
    rng = np.random.default_rng([seed, 60])
    made: list[Case] = []
    for k in range(count):
        moves: Moves = get_args(Moves)[k % len(get_args(Moves))]
        obstacle: Obstacle = get_args(Obstacle)[int(rng.integers(4))]
        stop = stops(moves)[int(rng.integers(len(stops(moves))))]
        pressed = float(np.exp(rng.uniform(np.log(0.2), np.log(10.0))))
        speed = float(np.exp(rng.uniform(np.log(0.002), np.log(0.25))))
        stiffness = float(np.exp(rng.uniform(np.log(1e3), np.log(2e5))))
        share = float(rng.uniform(0.1, 1.0))
        if obstacle == "own link":  # that is further away
            speed = max(speed, 0.1)
        made.append(Case(ARMS[k // len(get_args(Moves)) % 4], moves, obstacle, stop, pressed, speed, stiffness, share, seed + k))
    return made


def measure(report: Report) -> None:
    """Fill the report."""
    wanted = 400 if report.options.full else 40
    found = spread(measure_case, cases(report.options.seed + 6000, round(1.6 * wanted)))
    results = [result for result in found if result is not None][:wanted]
    report.row("cases that met something", len(results), n=len(found))
    report.share(f"faster by {1e3 * FASTER:g} mm/s at most", sum(r.faster <= FASTER for r in results), len(results), at_least=1.0)
    swung = sum(r.swings <= FASTER for r in results)
    report.share(f"faster than in the 20 ms before by {1e3 * FASTER:g} mm/s at most", swung, len(results))
    report.share(
        f"further by {1e3 * FURTHER:g} mm at most", sum(r.further <= FURTHER for r in results), len(results), at_least=1.0
    )
    report.row("faster, the most", 1e3 * max(r.faster for r in results), "mm/s", n=len(results))
    report.row("further, the most", 1e3 * max(r.further for r in results), "mm", n=len(results))
    report.row("estimated speed of a motor, largest error", max(r.misread for r in results), "rad/s", n=len(results))
    for stop in get_args(Stop):
        some = [r for r in results if r.stopped_by == stop]
        if some:
            report.row(f"{stop}: faster, the most", 1e3 * max(r.faster for r in some), "mm/s", n=len(some))
    own = [r for r in results if r.stopped_by == Kind.PATH_LEFT]
    if own:
        report.row("did not follow: faster, the most", 1e3 * max(r.faster for r in own), "mm/s", n=len(own))
    wrong = sorted((r for r in results if r.faster > FASTER or r.further > FURTHER), key=lambda r: -r.faster)
    for r in wrong[:40]:
        after = f"{1e3 * r.faster:.0f} mm/s faster, {1e3 * r.further:.1f} mm further"
        report.notes.append(f"{r.case}: by {r.stopped_by}, {1e3 * r.before:.0f} mm/s, then {after}")


if __name__ == "__main__":
    main("blocked", measure)
