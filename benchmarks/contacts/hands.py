"""A hand on a link behind the flange sensor: it pushes across the link, holds, and lets go. Truth is read for scoring alone."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from app.files.library import load_tool
from benchmarks.arms import LEVER, load, strength
from benchmarks.contacts.approaches import START
from benchmarks.contacts.motion import program
from benchmarks.contacts.recording import TICK
from pendant.all_settings import Settings, apply
from pendant.contact.contact_change import Change
from pendant.inputs import NOTHING, Inputs
from sim.arm.arm_file import Arm
from sim.arm.scenario import Load, Scenario
from sim.exchange.desk import Wishes
from sim.plant.touch import Push
from sim.simulation import Simulation

Array = NDArray[np.float64]
TOOL = load_tool("sphere")
LOW, HIGH = np.array([-3.0, -2.4, -2.3, -3.0, -3.0, -3.0]), np.array([3.0, -0.6, 2.3, 3.0, 3.0, 3.0])
START_AFTER, PAUSE = 150, 350  # ticks at rest before the first push, and between two
FELT, UNFELT = 0.1, 0.02
"""The link's own joint feels a push from this lever on, and does not below that [m]: between, either link may be named."""
LATEST = 0.1  # s


class LinkHands(NamedTuple):
    """One arm in one posture or program, pushed several times."""

    arm: str
    payload: float  # configured; the true one is up to 20 % off [kg]
    soft: bool
    moving: bool
    seed: int
    pushes: int = 4


class LinkTouch(NamedTuple):
    """One push, scored."""

    case: LinkHands
    link: str
    force: float  # [N]
    delay: float  # from its begin to the first report of any link [ms], infinite for none in time
    right: bool | None  # the link is named; None: it cannot be told
    once: bool  # one onset and one release
    lost: bool  # the release is lost at the part of the onset
    elsewhere: int  # other reports
    story: str


def hands(case: LinkHands) -> list[LinkTouch]:
    """Run one case."""
    rng = np.random.default_rng([case.seed, 41])
    arm = load(case.arm)
    com = [*(0.05 * rng.uniform(-1, 1, 2)).tolist(), 0.06]
    believed, true = (Load(mass=mass, com=com) for mass in (case.payload, case.payload * float(rng.uniform(0.8, 1.2))))
    q = rng.uniform(LOW, HIGH)
    scenario = Scenario(
        posture=q.tolist(), tool=TOOL, payload_true=true, payload_configured=believed, soft_sensor=case.soft, seed=case.seed
    )
    simulation = Simulation(arm, scenario, apply(Settings(), {"contact.on": True}))
    if case.moving:
        simulation.tick(Wishes(Inputs(program=program(rng, q, 40)), (), ()))
    wait(simulation, START_AFTER)
    if case.moving:
        simulation.tick(START)
        wait(simulation, 200)
    return [push(simulation, arm, case, rng) for _ in range(case.pushes)]


def forces(arm: str) -> list[float]:
    """Of hands [N]."""
    return [force * strength(arm) for force in (60.0, 80.0, 120.0, 200.0, 300.0)]


def wait(simulation: Simulation, ticks: int) -> None:
    """Nobody touches the arm."""
    for _ in range(ticks):
        simulation.tick(Wishes(NOTHING, (), ()))


def push(simulation: Simulation, arm: Arm, case: LinkHands, rng: np.random.Generator) -> LinkTouch:
    """One push, and what came of it until the arm is calm again."""
    link = int(rng.integers(2))
    joint = arm.chain.elbow - 1 + link
    part, share = arm.chain.joints[joint], float(rng.uniform(0.7, 0.95))
    force = float(rng.choice(forces(case.arm)))
    rise, fall = (int(rng.integers(2, 25)) for _ in range(2))  # ticks: no hand comes or goes within one
    point, way, levers = drawn(simulation, arm, joint, share=share, rng=rng)
    for _ in range(200):
        if max(abs(levers)) >= LEVER:
            break
        point, way, levers = drawn(simulation, arm, joint, share=share, rng=rng)
    held = int(rng.integers(150, 500))
    found: list[tuple[int, str, Change]] = []
    for k in range(rise + held + fall + PAUSE):
        size = force * float(np.interp(k, [0, rise, rise + held, rise + held + fall], [0.0, 1.0, 1.0, 0.0]))
        touches = (Push(part, point, (size * float(way[0]), size * float(way[1]), size * float(way[2]))),) if size else ()
        decision = simulation.tick(Wishes(NOTHING, touches, ()))
        found += [(k, contact.part, contact.change) for contact in decision.contacts]
    first = next(((k, named) for k, named, change in found if change is Change.GAINED and named != "tool"), (np.inf, ""))
    own = abs(levers[joint])
    expected = arm_part(link, own)
    onsets = [named for k, named, change in found if change is Change.GAINED and k < rise + held]
    releases = [named for k, named, change in found if change is Change.LOST and k >= rise + held]
    return LinkTouch(
        case,
        ("elbow", "forearm")[link],
        force,
        1000.0 * TICK * first[0],
        None if expected is None else first[1] == expected,
        len(onsets) == 1 and len(releases) == 1,
        bool(onsets) and releases == onsets[:1],
        len(found) - len(onsets[:1]) - len(releases[:1]),
        f"{case} {part} {force:g} N: " + ", ".join(f"{k} {named} {change}" for k, named, change in found),
    )


def arm_part(link: int, own: float) -> str | None:
    """The part that the joints can tell; `own` is the lever of the push on the link's own joint [m]."""
    if link == 0 or own < UNFELT:
        return "elbow"
    return "forearm" if own >= FELT else None


def drawn(
    simulation: Simulation, arm: Arm, joint: int, *, share: float, rng: np.random.Generator
) -> tuple[tuple[float, float, float], Array, Array]:
    """A point of the link in its own frame, a direction across the link in W, and the lever of a push there on each joint."""
    rigid = simulation.dynamics.recursion
    origins, axes = rigid.origins, rigid.jacobian[3:].T
    along = origins[joint + 1] - origins[joint]
    p = origins[joint] + share * along
    way = rng.normal(size=3)
    unit = along / np.linalg.norm(along)
    way -= (way @ unit) * unit
    way /= np.linalg.norm(way)
    levers = np.array([axes[i] @ np.cross(p - origins[i], way) if i <= joint else 0.0 for i in range(arm.n)])
    body = simulation.plant.model.body(arm.chain.joints[joint]).id
    R, at = simulation.plant.data.xmat[body].reshape(3, 3), simulation.plant.data.xpos[body]
    x, y, z = (R.T @ (p - at)).tolist()
    return (x, y, z), way, levers
