"""Approaches: free motion, then a contact of known stiffness, at a known speed, true onset and force beside it."""

from functools import cache
from typing import NamedTuple

import mujoco
import numpy as np
from numpy.typing import NDArray

from app.files.library import load_arm, load_tool
from benchmarks.contacts.recording import TICK, Recording, touching
from pendant.all_settings import Settings, apply
from pendant.events.event import Kind
from pendant.inputs import NOTHING, Command, Inputs
from pendant.program.reaction import Until
from pendant.program.steps import JointMove, LinearMove, Program
from sim.arm.frames import quaternion_from_matrix
from sim.arm.scenario import BoxObject, Load, Scenario
from sim.exchange.desk import Wishes
from sim.simulation import Simulation

Array = NDArray[np.float64]
ARM, TOOL = load_arm("ur5e"), load_tool("sphere")
IDLE = Wishes(NOTHING, (), ())
START = Wishes(Inputs(commands=(Command.START_PROGRAM,)), (), ())
AFTER = {2e5: 0.08, 1e4: 0.3, 1e3: 0.4}
"""How long a run goes on after the onset, by stiffness [s]."""
WORST_SINGULAR = 0.12
REST = 2.0
"""How long a program's end is looked at [s]."""
SETTLE = 150  # ticks at rest before the start


class Approach(NamedTuple):
    """One case."""

    stiffness: float  # [N/m]
    speed: float  # [m/s]
    angle: int  # of the motion against the tool's axis [degrees]
    payload: float  # configured; the true one is up to 20 % off [kg]
    seed: int
    react: str = ""  # what the program does at the contact; nothing: it goes on
    farther: float = 0.0  # how much farther the block stands [ticks of travel]


@cache
def probe() -> Simulation:
    return Simulation(ARM, Scenario(mismatch="nominal", tool=TOOL), Settings())


def kinematics(q: Array) -> tuple[Array, Array, Array]:
    """Flange position, orientation and Jacobian at q, copied."""
    p, R, jacobian = probe().dynamics.update(q)
    return p.copy(), R.copy(), jacobian.copy()


def posture(rng: np.random.Generator) -> Array:
    """A random posture away from singularities and from the floor."""
    while True:
        low, high = [-3.0, -2.2, 0.7, -2.6, 0.7, -3.0], [3.0, -0.6, 2.2, -0.6, 2.2, 3.0]
        q = rng.uniform(low, high)
        q[4] *= rng.choice([-1.0, 1.0])
        p, _, jacobian = kinematics(q)
        if np.linalg.svd(jacobian, compute_uv=False)[-1] > WORST_SINGULAR and p[2] > 0.15:
            return q


def rpy(R: Array) -> list[float]:
    return [float(np.arctan2(R[2, 1], R[2, 2])), float(-np.arcsin(R[2, 0])), float(np.arctan2(R[1, 0], R[0, 0]))]


def loads(rng: np.random.Generator, mass: float) -> tuple[Load, Load]:
    """The configured payload and the true one, up to 20 % off."""
    com = [0.0, 0.0, 0.05] if mass == 0.0 else [*(0.05 * rng.uniform(-1, 1, 2)).tolist(), 0.05]
    return Load(mass=mass, com=com), Load(mass=mass * float(1 + 0.2 * rng.uniform(-1, 1)), com=com)


def approach(case: Approach) -> Recording:
    """Run one case; postures in which the way is blocked or singular are drawn again."""
    rng = np.random.default_rng([case.seed, case.angle, int(10 * case.payload), 5])
    for _ in range(40):
        recording = _attempt(case, posture(rng), rng)
        if recording is not None:
            return recording
    raise RuntimeError(f"no posture for {case}")


def _attempt(case: Approach, q: Array, rng: np.random.Generator) -> Recording | None:
    configured, true = loads(rng, case.payload)
    p, R, _ = kinematics(q)
    tcp = p + R @ TOOL.tcp
    angle, around = np.radians(case.angle), rng.uniform(0.0, 2 * np.pi)
    way = R @ [np.sin(angle) * np.cos(around), np.sin(angle) * np.sin(around), np.cos(angle)]
    acceleration = 0.5 if case.speed > 0.03 else 0.2
    rise = case.speed * (case.speed / acceleration + 0.1) / 2 + 0.2 * case.speed + 0.3 * case.speed * (case.speed < 0.03)
    gap = rise + 0.1 * case.speed * rng.uniform(1.0, 2.0) + case.farther * case.speed * TICK
    cap = p + R @ [0.0, 0.0, TOOL.length - TOOL.radius]
    # The box stands a little out along the tool, so that the tip's cap meets it and not the shaft.
    out = R[:, 2] - (R[:, 2] @ way) * way
    out *= 0.03 * np.sin(angle) / max(float(np.linalg.norm(out)), 1e-9)
    face = cap + way * (TOOL.radius + gap) + out
    x = np.cross(-way, [0.3, 0.5, 0.8])
    x /= np.linalg.norm(x)
    turn = rpy(np.column_stack([x, np.cross(-way, x), -way]))
    box = BoxObject(
        name="block",
        position=(face + 0.05 * way).tolist(),
        rpy=turn,
        size=[0.08, 0.08, 0.1],
        stiffness=case.stiffness,
        friction=0.3,
    )
    until = Until(then=case.react) if case.react else None  # type: ignore[arg-type]
    goal = tcp + way * (gap + 0.3 * case.speed + 0.03)
    wxyz = tuple(quaternion_from_matrix(R).tolist())
    move = LinearMove(position=tuple(goal), quaternion=wxyz, speed=case.speed, acceleration=acceleration, until=until)
    scenario = Scenario(
        posture=q.tolist(), tool=TOOL, payload_true=true, payload_configured=configured, world=[box], seed=case.seed
    )
    simulation = Simulation(ARM, scenario, apply(Settings(), {"contact.on": not case.react}))
    return _run(simulation, move, case, "shape/tool")


def _run(simulation: Simulation, move: LinearMove | JointMove, case: Approach, shape: str) -> Recording | None:
    """The move from rest to `AFTER` the onset, or to `REST` after the program's end.

    None where something else is touched or the way is not possible.
    """
    plant = simulation.plant
    simulation.tick(Wishes(Inputs(program=Program(steps=(move,))), (), ()))
    for _ in range(SETTLE):
        if plant.data.ncon:  # the block stands in the arm, and would push it away
            return None
        simulation.tick(IDLE)
    recording, wish = Recording(), START
    gap = before = np.inf
    tool, block = (plant.model.geom(name).id for name in ("shape/tool", "object/block"))
    over = np.inf  # when the program is
    while plant.tick * TICK < (
        max(recording.onset + 0.5, over + REST) if case.react else recording.onset + AFTER[case.stiffness]
    ):
        decision = simulation.tick(wish)
        wish = IDLE
        recording.add(simulation, decision.contacts)
        if any(event.kind is Kind.PROGRAM_FAILED for event in decision.events) or plant.tick > 6000:
            return None
        if any(event.kind is Kind.PROGRAM_FINISHED for event in decision.events):
            over = plant.tick * TICK
        name = touching(simulation)
        if name and recording.onset == np.inf:
            if shape not in (name, "any") or before == np.inf:
                return None
            recording.touched_by = name
            pace = max(before - gap, 0.2 * case.speed * TICK)
            # Within the tick: by the gap at its begin and the speed of the tick before; for links, the tick's begin.
            recording.onset = (plant.tick - 1) * TICK + (gap / pace * TICK if shape != "any" else 0.0)
        if recording.onset == np.inf:
            before, gap = gap, mujoco.mj_geomDistance(plant.model, plant.data, tool, block, 1.0, None)
    return recording


def link_contact(case: Approach) -> Recording:
    """A sweep of the base that meets a block with the elbow (`angle` 0) or the forearm (`angle` 1), behind the sensor."""
    rng = np.random.default_rng([case.seed, case.angle, 9])
    for _ in range(40):
        q = np.array([rng.uniform(-2, 2), rng.uniform(-1.0, -0.5), rng.uniform(0.4, 1.2), rng.uniform(-2, -1), -1.57, 0.0])
        kinematics(q)
        model = probe().dynamics
        model.recursion.run(q, np.zeros((3, 6)), np.zeros(3))
        elbow, wrist = model.recursion.origins[2].copy(), model.recursion.origins[3].copy()
        point = elbow if case.angle == 0 else 0.4 * elbow + 0.6 * wrist
        radius = float(np.hypot(point[0], point[1]))
        if radius < 0.2 or point[2] < 0.3:
            continue
        rate = case.speed / radius
        sweep = rate * 0.8 + 1.2  # the tubes stand out sideways from the joints' axes
        c, s = np.cos(sweep), np.sin(sweep)
        place = np.array([c * point[0] - s * point[1], s * point[0] + c * point[1], point[2]])
        heading = float(np.arctan2(place[1], place[0]))
        box = BoxObject(
            name="block", position=place.tolist(), rpy=[0.0, 0.0, heading], size=[0.12, 0.1, 0.12], stiffness=case.stiffness
        )
        goal = q.copy()
        goal[0] += sweep + 0.3
        move = JointMove(q=tuple(goal.tolist()), speed=min(1.0, rate / ARM.limits.speed[0]), acceleration=0.3)
        configured, true = loads(rng, case.payload)
        scenario = Scenario(
            posture=q.tolist(), tool=TOOL, payload_true=true, payload_configured=configured, world=[box], seed=case.seed
        )
        recording = _run(Simulation(ARM, scenario, apply(Settings(), {"contact.on": True})), move, case, "any")
        if recording is not None and recording.touched_by != "shape/tool":
            return recording
    raise RuntimeError(f"no posture for {case}")
