"""A simulation to drive by hand in tests: seconds instead of ticks, the truth beside it for scoring."""

import numpy as np
from numpy.typing import ArrayLike

from pendant.all_settings import Settings, apply
from pendant.decision import Decision
from pendant.events.event import Event
from pendant.inputs import NOTHING, Button, Command, Inputs
from pendant.program.steps import JointMove, LinearMove, Program, Wait
from pendant.tick.estimate import Estimate
from pendant.tick.modes import TICK_RATE, Mode
from sim.arm.arm_file import Arm
from sim.arm.scenario import Scenario
from sim.exchange.desk import Wishes
from sim.plant.changes import AnyChange
from sim.plant.touch import Push, Touch
from sim.simulation import Simulation
from tests.sim.arms import UR5E

CENTRE = (0.0, 0.0, 0.0)
IDLE = Wishes(NOTHING, (), ())
NOMINAL = Scenario(mismatch="nominal")
LONG = apply(
    Settings(),
    {"free_drive.period": 30.0, "limits.operation.joint_speed.on": False, "limits.operation.tcp_speed.on": False},
)
"""Shipped settings, but an untouched arm stays in free-drive for 30 s, and a push that never eases runs on."""


class Bench:
    """A simulation, its events and its last decision."""

    def __init__(self, scenario: Scenario = NOMINAL, settings: Settings = LONG, arm: Arm = UR5E) -> None:
        self.simulation = Simulation(arm, scenario, settings)
        self.plant = self.simulation.plant
        self.events: list[Event] = []
        self.mode = Mode.TEACH

    def tick(self, wishes: Wishes = IDLE) -> Decision:
        decision = self.simulation.tick(wishes)
        self.events += decision.events
        self.mode = decision.mode
        return decision

    def run(self, seconds: float, *touches: Touch) -> None:
        wishes = Wishes(NOTHING, touches, ())
        for _ in range(round(seconds * TICK_RATE)):
            self.tick(wishes)

    def do(self, *commands: Command, program: Program | None = None) -> Decision:
        return self.tick(Wishes(Inputs(commands=commands, program=program), (), ()))

    def change(self, *changes: AnyChange) -> Decision:
        return self.tick(Wishes(NOTHING, (), changes))

    def enter(self) -> None:
        """Hold the button until free-drive is on, then let go."""
        hold = Wishes(Inputs(held=frozenset({Button.FREE_DRIVE})), (), ())
        for _ in range(2 * TICK_RATE):
            if self.tick(hold).mode is Mode.FREE_DRIVE:
                break
        for _ in range(TICK_RATE // 2):  # longer than a short press, which would leave
            self.tick(hold)
        self.tick(Wishes(Inputs(released=frozenset({Button.FREE_DRIVE})), (), ()))
        assert self.mode is Mode.FREE_DRIVE

    def start(self, *steps: JointMove | LinearMove | Wait) -> None:
        """Load a program of these steps and start it, once the arm has stood long enough to count as static."""
        self.run(0.2)
        self.do(program=Program(steps=steps))
        self.do(Command.START_PROGRAM)
        assert self.mode is Mode.RUN

    def start_joint_move(self, q: ArrayLike, fraction: float) -> None:
        """Start a program of one joint move, at this fraction of the joints' limits."""
        self.start(JointMove(q=tuple(np.asarray(q, dtype=float).tolist()), speed=fraction, acceleration=fraction))

    @property
    def estimate(self) -> Estimate:
        """A copy of the last estimate."""
        return self.simulation.snapshot().estimate

    @property
    def flange(self) -> np.ndarray:
        """True position of the flange in W (3,) [m]."""
        return self.plant.poses()[-1, :3].copy()

    def drift(self, seconds: float, start: np.ndarray) -> float:
        """Largest distance of the flange from `start` while nobody does anything [m]."""
        worst = 0.0
        for _ in range(round(seconds * TICK_RATE)):
            self.tick()
            worst = max(worst, float(np.linalg.norm(self.flange - start)))
        return worst


def push(part: str, force: tuple[float, float, float], torque: tuple[float, float, float] = CENTRE) -> Push:
    return Push(part, CENTRE, force, torque)
