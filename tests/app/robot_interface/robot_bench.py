"""A robot without a network: a simulation that is ticked by hand, and the cabinet that its interfaces share."""

from pathlib import Path

from app.robot_interface.controller.cabinet import Cabinet
from app.robot_interface.controller.callers import Ask
from app.robot_interface.controller.program_folder import ProgramFolder
from pendant.all_settings import Settings, apply
from pendant.decision import Decision
from pendant.events.event import Event, Kind
from pendant.inputs import NOTHING, Command, Inputs
from sim.arm.scenario import Load, Scenario
from sim.exchange.desk import Wishes
from sim.plant.changes import AnyChange
from sim.plant.touch import Touch
from sim.simulation import Simulation
from tests.sim.arms import UR5E
from tests.sim.bench import push


class Watcher:
    """Keeps what it is told."""

    def __init__(self) -> None:
        self.ticks: list[int] = []
        self.events: list[Event] = []

    def tick(self, number: int) -> None:
        self.ticks.append(number)

    def told(self, event: Event) -> None:
        self.events.append(event)

    def repeat(self) -> None:
        self.ticks.append(-1)

    def again(self) -> None:
        self.ticks.append(-2)


class RobotBench:
    """Ticks as the loop does."""

    def __init__(
        self,
        programs: Path | None = None,
        true: float = 0.0,
        configured: float = 0.0,
        scenario: Scenario | None = None,
        **settings: float | bool,
    ) -> None:
        self.settings = apply(Settings(), {name.replace("__", "."): value for name, value in settings.items()})
        self.scenario = scenario or Scenario(
            payload_true=Load(mass=true), payload_configured=Load(mass=configured), mismatch="nominal"
        )
        self.cabinet = Cabinet(lambda: self.simulation, UR5E.chain.joints, ProgramFolder(programs))
        self.watcher = Watcher()
        self.cabinet.listen(self.watcher)
        self.begin()

    def begin(self) -> None:
        """Start over."""
        self.events: list[Event] = []
        self.simulation = Simulation(UR5E, self.scenario, self.settings)

    def pull(self, force: tuple[float, float, float], count: int) -> Decision:
        """A hand pulls at the flange with this force, axes of W [N]."""
        return self.step(count, touches=(push("flange", force),))

    def change(self, *changes: AnyChange) -> Decision:
        """Something happens to the arm or around it."""
        return self.step(changes=changes)

    def step(
        self, count: int = 1, inputs: Inputs = NOTHING, touches: tuple[Touch, ...] = (), changes: tuple[AnyChange, ...] = ()
    ) -> Decision:
        """`inputs` are those of the page, in the first of the ticks, like `changes`; `touches` last for all of them."""
        decision = None
        for _ in range(count):
            tick = self.simulation.tick_count + 1
            wishes = Wishes(inputs, touches, changes).joined(self.cabinet.wishes(tick, self.simulation.snapshot))
            decision = self.simulation.tick(wishes)
            self.cabinet.see(tick, decision)
            self.events += decision.events
            inputs, changes = NOTHING, ()
        assert decision is not None
        return decision

    def ask(self, *commands: Command) -> tuple[Event, ...]:
        """What a tick with these wishes of a client brings."""
        done = self.cabinet.ask(Ask(commands))
        self.step()
        return done.result(0.0)

    def page(self, *commands: Command) -> Decision:
        """A tick with commands of the pendant's page."""
        return self.step(1, Inputs(commands=commands))

    def kinds(self) -> list[Kind]:
        """Of all events since the simulation began."""
        return [event.kind for event in self.events]
