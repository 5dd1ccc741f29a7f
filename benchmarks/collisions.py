"""Collisions: a moving arm hits something with tool, elbow or forearm, and the same motion without the protective stop.

Jog, program, script and servo motions of four arms, with payloads within their own, meet a table, a post or foam of 1e3 to
2e5 N/m at 20 to 1,000 mm/s. A hit counts where the twin's force exceeds the limit by 20 % or the twin's tool is kept 20 mm from
where it should be. Truth is read for scoring alone. The second part is a tool that presses slowly, the third motion without a
contact, which nothing may stop.
"""

from itertools import pairwise
from typing import Literal, NamedTuple, get_args

import numpy as np
from msgspec.structs import replace as changed

from app.files.library import load_arm
from app.runs.network_run import NetworkRun
from app.session.actions import SendScript
from app.session.session_file import Session
from benchmarks.blocking.hit_forces import HitForces, draw
from benchmarks.blocking.motions import Case, Moves, Wanted
from benchmarks.blocking.places import box_across, tip
from benchmarks.common import Report, main, spread
from benchmarks.contacts.motion import IDLE, START, TOOL, program
from benchmarks.contacts.recording import contact_force, touching
from benchmarks.hold import ARMS
from benchmarks.postures import posture
from pendant.all_settings import Settings, apply
from pendant.events.event import Kind
from pendant.inputs import Command, Inputs
from pendant.tick.modes import TICK
from sim.arm.scenario import Load, Scenario, ToolModel
from sim.exchange.desk import Wishes
from sim.motion.jog import MANUAL
from sim.plant.changes import FrictionChange, Temperature
from sim.simulation import Simulation

Array = np.ndarray
Part = Literal["tool", "elbow", "forearm"]
MOVES: tuple[Moves, ...] = ("jog joint", "jog line", "program joint", "program line", "movej", "movel", "servoj", "speedj")
OF_JOINTS: tuple[Moves, ...] = ("jog joint", "program joint", "movej", "servoj", "speedj")
OBSTACLES = {"table": (0.4, 0.4, 0.2), "post": (0.1, 0.06, 0.3), "foam": (0.2, 0.2, 0.2)}  # across the motion first [m]
HARD, FOAM = (1e3, 2e5), (1e3, 5e3)  # stiffnesses [N/m]
SPEEDS = (0.02, 1.0)  # [m/s]
PAYLOADS = {"ur3e": (0.0, 2.0, 3.0)}
USUAL_PAYLOADS = (0.0, 2.0, 5.0)  # [kg]
RADII = {"tool": 0.02, "elbow": 0.075, "forearm": 0.06}  # about which the part is away from its middle [m]
BEHIND = 0.1  # that a motion ends behind the surface [m]
AFTER = 1.5  # that the arm is watched after the touch [s]
LATEST = 8.0  # in which a motion that meets nothing is given up [s]
FIRST_PEAK = 0.02  # [s]
OVER = 1.2  # times the limit, from where the twin's force counts
KEPT = 0.020  # from where it should be, from where the twin counts [m]
TRIES, SPACED = 8, 100_003
PRESSING = 0.01  # speed of a tool that presses [m/s]
PRESSED = 6.0  # that it is watched after the touch: by then 150 N are there from 2.5e3 N/m on [s]
TOLERANCE = 25.0  # of the tool force (docs/guide/stops.md) [N]
SPEED_EDGES = (0.02, 0.1, 0.25, 1.001)  # of the table's rows [m/s]
STIFFNESS_EDGES = (1e3, 1e4, 1e5, 2.001e5)  # and of its columns [N/m]
OFF = {"collision.on": False, "following.on": False}


class Strike(NamedTuple):
    """One motion into something."""

    arm: str
    part: Part
    moves: Moves
    obstacle: str
    stiffness: float  # [N/m]
    speed: float  # of the part [m/s]
    payload: float  # [kg]
    seed: int


class Course(NamedTuple):
    """What one run did."""

    touched: int  # tick of the first touch; 0: none
    shape: str  # of the arm, that touched
    peak: float  # largest force in the first 20 ms [N]
    later: float  # and after them [N]
    kept: float  # the furthest that the tool was from where it should be [m]
    stopped: str  # the part that the protective stop names; "" for none, "path" for a following error without one
    delay: float  # from the touch to the stop [s]


class Result(NamedTuple):
    """A strike and its twin."""

    strike: Strike
    seen: Course
    twin: Course


def measure_strike(strike: Strike) -> Result | None:
    """Both runs; None where the arm met nothing in any of some postures."""
    for drawn in _drawn(strike):
        if (seen := _course(drawn)) is not None:
            twin = Trial(drawn, OFF).run()
            assert twin is not None
            return Result(strike, seen, twin)
    return None


def measure_pressed(strike: Strike) -> tuple[float, str] | None:
    """Largest force [N] of a tool that presses, and the part that the stop names; None where it met nothing."""
    met = next((seen for seen in (_course(drawn, PRESSED) for drawn in _drawn(strike)) if seen is not None), None)
    return None if met is None else (_most(met), met.stopped)


def _drawn(strike: Strike) -> list[Strike]:
    return [strike._replace(seed=strike.seed + SPACED * attempt) for attempt in range(TRIES)]


def _course(strike: Strike, after: float = AFTER) -> Course | None:
    try:
        return Trial(strike, {}).run(after)
    except ValueError:  # it would begin inside of what it is to meet
        return None


class Reaching(Wanted):
    """A motion that ends behind the surface."""

    def reach(self) -> float:
        return self.near + BEHIND


class Trial:
    """One run, tick by tick."""

    def __init__(self, strike: Strike, use: dict[str, bool]) -> None:
        self.strike, self.rng = strike, np.random.default_rng([strike.seed, 62])
        arm = load_arm(strike.arm)
        tool = ToolModel(name="rod", mass=0.3, com=[0.0, 0.0, 0.05], tcp=[0.0, 0.0, 0.15], length=0.15, radius=0.02)
        load = Load(mass=strike.payload, com=[0.0, 0.0, 0.05])
        scenario = Scenario(tool=tool, payload_true=load, payload_configured=load, seed=strike.seed)
        probe = Simulation(arm, scenario, Settings())
        q, _ = posture(self.rng, probe)
        self.q, self.probe = np.array(q), probe
        direction, qd = self._way()
        gap = float(self.rng.uniform(0.02, 0.02 + 0.2 * min(strike.speed, 0.5)))
        surface = self.place + (gap + RADII[strike.part]) * direction
        box = box_across("hit", surface, direction, OBSTACLES[strike.obstacle], stiffness=strike.stiffness)
        jogs = {"program.speed": min(strike.speed / MANUAL, 1.0)} if strike.moves.startswith("jog") else {}
        self.device = Simulation(arm, changed(scenario, world=[box], posture=q), apply(Settings(), {**jogs, **use}))
        case = Case(strike.arm, strike.moves, "post", "protective", 1.0, strike.speed, strike.stiffness, 0.5, strike.seed)
        self.wanted = Reaching(case, probe, q=self.q, qd=qd, direction=direction, near=gap)
        self.network = None
        if not strike.moves.startswith(("jog", "program")):
            self.send = SendScript(at=0.1, text=self.wanted.script())
            session = Session(title="collision", robot=strike.arm, duration=60.0, timeline=[self.send])
            self.network = NetworkRun(session, self.device)

    def _part(self) -> tuple[Array, Array]:
        """Where the part is (3,) [m], and how it moves with the joints (3, n) [m]."""
        p, R, jacobian = self.probe.dynamics.update(self.q)
        lever = R @ self.probe.tcp
        if self.strike.part == "tool":
            return p + lever, jacobian[:3] + np.cross(jacobian[3:].T, lever).T
        rigid, elbow = self.probe.dynamics.recursion, self.probe.arm.chain.elbow
        rigid.run(self.q, np.zeros((3, self.q.size)), self.probe.tcp)
        origins = rigid.origins
        share = 0.0 if self.strike.part == "elbow" else float(self.rng.uniform(0.3, 0.9))
        place = origins[elbow] + share * (origins[elbow + 1] - origins[elbow])
        moved = np.zeros((3, self.q.size))
        for i in range(elbow if share == 0.0 else elbow + 1):
            moved[:, i] = np.cross(jacobian[3:, i], place - origins[i])
        return place.copy(), moved

    def _way(self) -> tuple[Array, Array]:
        """The part's direction (3,) in B, and joint speeds (n,) at the speed of the strike [rad/s]."""
        strike, rng = self.strike, self.rng
        self.place, moved = self._part()
        towards = np.array([0.0, 0.0, -1.0]) if strike.obstacle == "table" else rng.normal(size=3) * [1.0, 1.0, 0.3]
        towards /= np.linalg.norm(towards)
        if strike.moves in OF_JOINTS:
            qd = moved.T @ towards
            if strike.moves == "jog joint":
                joint = int(np.argmax(np.abs(qd)))
                qd = np.sign(qd[joint]) * np.eye(self.q.size)[joint]
            velocity = moved @ qd
            size = float(np.linalg.norm(velocity))
            return velocity / size, qd * (strike.speed / size)
        if strike.moves == "jog line":
            axis = int(np.argmax(np.abs(towards)))
            towards = np.sign(towards[axis]) * np.eye(3)[axis]
        _, R, jacobian = self.probe.dynamics.update(self.q)
        full = np.vstack([jacobian[:3] + np.cross(jacobian[3:].T, R @ self.probe.tcp).T, jacobian[3:]])
        return towards, np.linalg.solve(full, np.concatenate([strike.speed * towards, np.zeros(3)]))

    def run(self, after: float = AFTER) -> Course | None:
        """Let it move and hit, and watch it so long [s] from then on; None where it met nothing."""
        device, ticks, touched, shape = self.device, 0, 0, ""
        peak = later = kept = 0.0
        stopped, stopped_at = "", 0
        while True:
            decision = device.tick(self._wishes(ticks))
            ticks += 1
            if self.network is not None:
                self.network.see(ticks, decision)
            force = contact_force(device)
            if force > 0.0 and not touched:
                if ticks <= 50:
                    return None
                touched, shape = ticks, touching(device)
            for event in decision.events:
                if event.kind in (Kind.COLLISION, Kind.PATH_LEFT) and not stopped:
                    stopped = str(event.values["part"]) or "path"
                    stopped_at = ticks
            if touched:
                if (ticks - touched) * TICK <= FIRST_PEAK:
                    peak = max(peak, force)
                else:
                    later = max(later, force)
                wanted = device.controller.references.now
                if wanted is not None:
                    kept = max(kept, self._apart(wanted.q))
            elif stopped or ticks > LATEST / TICK:
                return None
            if touched and (ticks - touched) * TICK > after:
                return Course(touched, shape, peak, later, kept, stopped, (stopped_at - touched) * TICK if stopped else 0.0)

    def _apart(self, q: Array) -> float:
        p, R, _ = self.probe.dynamics.places(q)
        return float(np.linalg.norm(p + R @ self.probe.tcp - tip(self.device)))

    def _wishes(self, tick: int) -> Wishes:
        moves = self.strike.moves
        if self.network is not None:
            return self.network.wishes(tick + 1, self.device.snapshot, [(0, self.send)] if tick == 50 else [])
        if moves.startswith("program"):
            if tick == 10:
                return Wishes(Inputs(program=self.wanted.program()), (), ())
            return Wishes(Inputs(commands=(Command.START_PROGRAM,)), (), ()) if tick == 50 else IDLE
        return Wishes(Inputs(jog=self.wanted.jog()), (), ()) if tick >= 50 else IDLE


def strikes(seed: int, count: int) -> list[Strike]:
    """So many, drawn."""
    rng = np.random.default_rng([seed, 62])
    made: list[Strike] = []
    for k in range(count):
        part: Part = get_args(Part)[k % 3]
        kinds = MOVES if part == "tool" else OF_JOINTS
        arm, moves = ARMS[k // 3 % 4], kinds[int(rng.integers(len(kinds)))]
        obstacle = list(OBSTACLES)[int(rng.integers(3))]
        stiffness = float(np.exp(rng.uniform(*np.log(FOAM if obstacle == "foam" else HARD))))
        most = MANUAL if moves.startswith("jog") else SPEEDS[1]
        speed = float(np.exp(rng.uniform(np.log(SPEEDS[0]), np.log(most))))
        payload = float(rng.choice(PAYLOADS.get(arm, USUAL_PAYLOADS)))
        made.append(Strike(arm, part, moves, obstacle, stiffness, speed, payload, seed + k))
    return made


class Quiet(NamedTuple):
    """Motion without a contact."""

    arm: str
    payload: float  # [kg]
    wrong: float  # by which the configured one is less [kg]
    seconds: float
    seed: int


def measure_quiet(case: Quiet) -> tuple[Quiet, list[str], float]:
    """Protective stops of a program at full speed, and the largest force that the tool seemed to feel [N]."""
    rng = np.random.default_rng([case.seed, 62])
    around, arm = rng.uniform(0.0, 2.0 * np.pi), load_arm(case.arm)
    com = [0.05 * float(np.cos(around)), 0.05 * float(np.sin(around)), 0.05]
    loads = [Load(mass=mass, com=com) for mass in (case.payload, case.payload - case.wrong)]
    scenario = Scenario(tool=TOOL, payload_true=loads[0], payload_configured=loads[1], seed=case.seed)
    device = Simulation(arm, scenario, Settings())
    friction, celsius = float(rng.choice([0.7, 1.0, 1.3])), float(rng.choice([0.0, 20.0, 50.0]))
    moves = program(rng, np.array(arm.chain.home), int(2 * case.seconds))
    device.tick(Wishes(Inputs(program=moves), (), (FrictionChange(factor=friction), Temperature(celsius=celsius))))
    for _ in range(150):
        device.tick(IDLE)
    stops, most = [], 0.0
    start = 0
    for k in range(round(case.seconds / TICK)):
        wish = IDLE
        if k == start:
            wish = START
        elif k == start - 1:
            wish = Wishes(Inputs(commands=(Command.RESET,)), (), ())
        decision = device.tick(wish)
        most = max(most, float(np.linalg.norm(device.estimate.F_user[:3])))
        for event in decision.events:
            if event.kind in (Kind.COLLISION, Kind.PATH_LEFT):
                stops.append(f"{event.kind} at {k * TICK:.2f} s {event.values}")
                start = k + 500
    return case, stops, most


def measure(report: Report) -> None:
    """Fill the report."""
    wanted = 600 if report.options.full else 40
    base = report.options.seed
    found = spread(measure_strike, strikes(base + 6200, round(1.3 * wanted)))
    results = [result for result in found if result is not None][:wanted]
    limit = Settings().collision.clamping
    hard = [r for r in results if _most(r.twin) > OVER * limit or r.twin.kept > KEPT]
    stopped = [r for r in hard if r.seen.stopped]
    named = [r for r in stopped if r.seen.stopped != "path"]
    report.row("strikes that met something", len(results), n=len(found))
    report.share("hits that are stopped", len(stopped), len(hard), at_least=0.99)
    report.share("hits of which the part is right", sum(_right(r) for r in stopped), len(stopped), at_least=0.95)
    report.row("stopped by the following error instead", len(stopped) - len(named), n=len(stopped))
    report.share("stops that name two parts", sum(" or " in r.seen.stopped for r in stopped), len(stopped))
    soft = [r for r in results if r not in hard]
    report.share("softer touches that are stopped", sum(bool(r.seen.stopped) for r in soft), len(soft))
    if named:
        report.row("touch to stop, median", 1e3 * float(np.median([r.seen.delay for r in named])), "ms", n=len(named))
        ratio = [r.seen.later / max(r.twin.later, 1.0) for r in named]
        report.row("largest force after 20 ms, of the twin's, median", float(np.median(ratio)), "", n=len(named))
        report.row("first peak, of the twin's, median", float(np.median([r.seen.peak / max(r.twin.peak, 1.0) for r in named])))
    _table(report, hard)
    report.options.out.mkdir(parents=True, exist_ok=True)
    forces = [HitForces(r.strike.speed, r.strike.stiffness, _most(r.seen), _most(r.twin)) for r in hard if r.seen.stopped]
    draw(forces, STIFFNESS_EDGES, report.options.out / f"collisions-{base}.webp")
    for part in get_args(Part):
        some = [r for r in hard if r.strike.part == part]
        report.share(f"{part}: stopped", sum(bool(r.seen.stopped) for r in some), len(some))
    _pressed(report, base)
    _quiet(report, base)
    wrong = [r for r in hard if not r.seen.stopped] + [r for r in stopped if not _right(r)]
    for r in wrong[:40]:
        report.notes.append(f"{r.strike}: {r.seen}; without {r.twin}")


def _table(report: Report, hard: list[Result]) -> None:
    """Medians by speed and stiffness; a cell without a hit is left out."""
    for low, high in pairwise(SPEED_EDGES):
        for soft, stiff in pairwise(STIFFNESS_EDGES):
            some = [r for r in hard if low <= r.strike.speed < high and _cell(r, soft, stiff)]
            if some:
                cell = f"{1e3 * low:.0f} to {1e3 * high:.0f} mm/s on {soft:g} to {stiff:g} N/m"
                report.row(f"{cell}: touch to stop", 1e3 * float(np.median([r.seen.delay for r in some])), "ms", n=len(some))
                peaks = [(_most(r.seen), _most(r.twin)) for r in some]
                for name, k in (("largest force", 0), ("largest force without the stop", 1)):
                    report.row(f"{cell}: {name}", float(np.median([each[k] for each in peaks])), "N", n=len(some))


def _most(course: Course) -> float:
    return max(course.peak, course.later)


def _cell(r: Result, soft: float, stiff: float) -> bool:
    return bool(r.seen.stopped) and soft <= r.strike.stiffness < stiff


def _pressed(report: Report, base: int) -> None:
    """A tool that presses slowly: its force stays within the tool force and its tolerance."""
    drawn = [strike for strike in strikes(base + 7400, 360 if report.options.full else 72) if strike.part == "tool"]
    found = spread(measure_pressed, [strike._replace(speed=PRESSING) for strike in drawn])
    met = [pressed for pressed in found if pressed is not None]
    most = Settings().robot_limits.normal.tool_force + TOLERANCE
    report.share("tools that press at 10 mm/s and are stopped", sum(bool(stopped) for _, stopped in met), len(met))
    report.row("largest force of them", max(force for force, _ in met), "N", at_most=most, n=len(met))


def _quiet(report: Report, base: int) -> None:
    seconds = 1000.0 if report.options.full else 60.0
    combinations = [(arm, mass) for arm in ARMS for mass in PAYLOADS.get(arm, USUAL_PAYLOADS)]
    right = [Quiet(arm, mass, 0.0, seconds, base + k) for k, (arm, mass) in enumerate(combinations)]
    off = [Quiet(arm, mass, 0.5, seconds, base + 100 + k) for k, (arm, mass) in enumerate(combinations) if mass]
    for name, cases, most in (("right payload", right, 0.0), ("payload 0.5 kg more than told", off, None)):
        runs = spread(measure_quiet, cases)
        hours = seconds * len(cases) / 3600.0
        bar = hours if most is None else most
        report.row(f"false stops, {name}", sum(len(stops) for _, stops, _ in runs), "", at_most=bar, n=len(cases))
        report.row(f"largest force that the tool seemed to feel, {name}", max(felt for *_, felt in runs), "N", n=len(cases))
        report.notes += [f"{case.arm} {case.payload:g} kg seed {case.seed}: {stop}" for case, stops, _ in runs for stop in stops][
            :20
        ]


def _right(r: Result) -> bool:
    """The stop names the part that touched, whichever was there first: a wrist is wider than what it hangs on."""
    told = r.seen.stopped.split(" or ")
    return any(part in told for part in _touched(r))


def _touched(r: Result) -> tuple[str, ...]:
    """The part whose shape touched. At the elbow upper arm and forearm meet: the forearm is the elbow, too, where that was to
    touch."""
    number = r.seen.shape.removeprefix("shape/")
    if number == "tool":
        return ("tool",)
    arm = load_arm(r.strike.arm)
    beyond = arm.shapes[int(number)].link - arm.chain.elbow
    if beyond:
        return ("wrist",) if beyond > 0 else ("elbow",)
    return ("forearm", "elbow") if r.strike.part == "elbow" else ("forearm",)


if __name__ == "__main__":
    main("collisions", measure)
