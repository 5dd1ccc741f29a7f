"""Picks: parts at random below an arm with two fingers, and what the arm does with them."""

import math
from typing import NamedTuple

import numpy as np
from scipy.optimize import least_squares

from app.files.library import load_tool
from benchmarks import arms
from benchmarks.hold import IDLE
from pendant.all_settings import Settings
from pendant.events.event import Event
from pendant.inputs import Command, Inputs
from pendant.program.steps import LinearMove, Program
from pendant.tick.modes import TICK
from sim.arm.arm_file import Arm
from sim.arm.chain import chain
from sim.arm.frames import quaternion_from_matrix, rotation, rotation_vector
from sim.arm.scenario import AnyObject, AnyPart, BoxObject, FreeBox, FreeCylinder, Load, Scenario
from sim.exchange.desk import Wishes
from sim.plant.changes import DriveGripper
from sim.simulation import Simulation

Array = np.ndarray

GRAVITY = 9.81  # [m/s²]
SPEED, ACCELERATION = 0.5, 0.6  # half of what a program usually asks for: 1 m/s, 1.2 m/s² (UR, movel) [m/s], [m/s²]
SPARE = 1.2  # a force that allows it by a fifth, or falls short by a fifth
OFF = 0.02  # largest distance of the part's middle from that of the fingers [m]
HIGH = 0.1  # the fingers begin so far above the part [m]
TOOL = load_tool("two-finger")
DOWN = np.array([[0.0, 1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, -1.0]])  # the tool looks down, its fingers close along y of B
ARM = 2.0 / 3.0 * 0.022 / math.sqrt(math.pi)  # of a pad's friction about its middle, docs/guide/gripper.md [m]


class Pick(NamedTuple):
    """One part, and how it is taken."""

    number: int
    seed: int
    arm: str
    box: bool
    size: tuple[float, float, float]  # along the fingers' way, across it, up [m]
    mass: float  # [kg]
    friction: float
    along: float  # of the part's middle from that of the fingers, on their way [m]
    across: float  # across it [m]
    place: tuple[float, float]  # of the fingers, in B [m]
    force: float  # of one finger [N]
    holds: bool  # the force allows it


def needed(pick: Pick, acceleration: float) -> float:
    """Force of a finger that friction needs when the part is lifted with an acceleration [N].

    Two pads hold 2 mu F along their faces, or 2 mu F (2/3 R) about their normal, and both on an ellipse; the part's weight acts
    `across` beside them.
    """
    return pick.mass * (GRAVITY + acceleration) * math.hypot(1.0, pick.across / ARM) / (2.0 * pick.friction)


def draw(seed: int, count: int, *, kinds: str, least: float = 0.1) -> list[Pick]:
    """Parts at random, for the arms in turn.

    Args:
        seed: base.
        count: how many.
        kinds: "both": every second force falls short; "holds": none does.
        least: lightest part [kg].
    """
    rng, made = np.random.default_rng([seed, 65, len(kinds)]), []
    while len(made) < count:
        number = len(made)
        mass, friction = math.exp(rng.uniform(math.log(least), math.log(4.0))), rng.uniform(0.3, 1.0)
        box, width = bool(rng.random() < 0.6), rng.uniform(0.02, 0.06)
        room = 0.5 * (0.08 - width)  # between the part and the open fingers
        along = rng.uniform(-1.0, 1.0) * min(OFF, room)
        reach = OFF if box else 0.8 * 0.5 * width * math.sin(math.atan(friction))
        across = rng.uniform(-1.0, 1.0) * min(reach, math.sqrt(OFF**2 - along**2))
        size = (width, rng.uniform(0.07, 0.09) if box else width, rng.uniform(0.04, 0.08))
        place = float(rng.uniform(-0.6, -0.4)), float(rng.uniform(-0.25, 0.05))
        name = ("ur5e", "ur10e")[number % 2]
        pick = Pick(number, seed, name, box, size, mass, friction, along, across, place, 0.0, True)
        holds = kinds == "holds" or number // 2 % 2 == 0
        force = max(SPARE * needed(pick, ACCELERATION), 20.0) if holds else needed(pick, 0.0) / SPARE
        if 20.0 <= force <= 235.0:
            made.append(pick._replace(force=force, holds=holds))
    return made


def reach(arm: Arm, point: Array) -> Array:
    """Joint angles (n,) with the tool centre point at a point (3,) in B, looking down."""
    rigid, tcp = chain(arm), np.array(TOOL.tcp)

    def error(q: Array) -> Array:
        p, R = np.zeros(3), np.eye(3)
        for i, angle in enumerate(q):
            p, R = p + R @ rigid.p[i], R @ rigid.R[i] @ rotation(2, angle)
        p, R = p + R @ rigid.p_flange, R @ rigid.R_flange
        return np.concatenate([p + R @ tcp - point, 0.3 * rotation_vector(R.T @ DOWN)])

    start = [0.0, -1.2, 1.9, -2.2, -1.57, 0.0]
    return least_squares(error, start, xtol=1e-12, ftol=1e-12).x


class Picking:
    """An arm, a table, a part on it, the fingers above it.

    Args:
        pick: what is done.
        part: there is one; else the arm and the table alone.
    """

    def __init__(self, pick: Pick, part: bool = True) -> None:
        self.pick = pick
        x, y = pick.place
        half = pick.size[2] / 2.0
        self.grips = np.array([x, y, half])  # where the fingers close, in B
        centre = [x + pick.across, y + pick.along, half]
        table = BoxObject(name="table", position=[-0.5, 0.0, -0.025], size=[0.7, 1.2, 0.05])
        own: AnyPart = (
            FreeBox(
                name="part",
                position=centre,
                size=[pick.size[1], pick.size[0], pick.size[2]],
                mass=pick.mass,
                friction=pick.friction,
            )
            if pick.box
            else FreeCylinder(
                name="part",
                position=centre,
                radius=pick.size[0] / 2.0,
                height=pick.size[2],
                mass=pick.mass,
                friction=pick.friction,
            )
        )
        arm = arms.load(pick.arm)
        posture = reach(arm, self.grips + np.array([0.0, 0.0, HIGH]))
        world: list[AnyObject] = [table, own] if part else [table]
        self.device = Simulation(
            arm, Scenario(posture=posture.tolist(), tool=TOOL, world=world, seed=pick.seed + pick.number), Settings()
        )
        self.events: list[Event] = []
        self.row = 1
        self.run(0.4)
        self.zero = self.device.estimate.p_BF + self.device.estimate.R_BF @ np.array(TOOL.tcp) - self.grips - [0.0, 0.0, HIGH]

    def run(self, seconds: float, wishes: Wishes = IDLE) -> None:
        """Let time pass; the wishes are of its first tick."""
        self.tick(wishes)
        for _ in range(round(seconds / TICK) - 1):
            self.tick(IDLE)

    def tick(self, wishes: Wishes) -> bool:
        """A tick; whether a program of moves ends with it."""
        events = self.device.tick(wishes).events
        self.events += events
        return any(event.kind.value in ENDS for event in events)

    def go(self, *ways: tuple[Array, float]) -> None:
        """Straight to points (3,) in B, each with a speed [m/s]."""
        R = quaternion_from_matrix(DOWN)
        steps = tuple(
            LinearMove(
                position=tuple((point + self.zero).tolist()),
                quaternion=tuple(R.tolist()),
                speed=speed,
                acceleration=ACCELERATION,
            )
            for point, speed in ways
        )
        self.run(0.3)
        self.tick(Wishes(Inputs(program=Program(steps=steps)), (), ()))
        self.tick(Wishes(Inputs(commands=(Command.START_PROGRAM,)), (), ()))
        for _ in range(round(20.0 / TICK)):
            if self.tick(IDLE):
                return

    def close(self) -> None:
        """Go down to the part and close on it."""
        self.go((self.grips, 0.15))
        self.run(0.9, Wishes(IDLE.inputs, (), (DriveGripper(command="close", force=self.pick.force),)))

    def open(self) -> None:
        """Let the part go."""
        self.run(0.9, Wishes(IDLE.inputs, (), (DriveGripper(command="open"),)))

    def tell(self) -> None:
        """Tell the controller what is in the gripper."""
        com = [0.0, self.pick.across, TOOL.tcp[2]]  # the fingers have pushed it to their middle
        self.run(1.4, Wishes(Inputs(load=Load(mass=self.pick.mass, com=com)), (), ()))

    @property
    def held(self) -> bool:
        """The gripper holds the part."""
        gripper = self.device.plant.gripper
        return gripper is not None and gripper.state.held != ""

    @property
    def part(self) -> Array:
        """True middle of the part (3,) in W [m]."""
        return self.device.plant.object_poses()[self.row, :3].copy()

    def in_flange(self) -> Array:
        """True middle of the part (3,) in F [m]."""
        plant = self.device.plant
        body = plant.flange_body
        return plant.data.xmat[body].reshape(3, 3).T @ (self.part - plant.data.xpos[body])


ENDS = frozenset({"program_finished", "program_stopped", "stopped", "collision", "program_failed"})
"""Events after which a program of moves does not go on."""
