"""What a robot keeps from one program to the next."""

from collections.abc import Callable

from app.robot_interface.controller.cabinet import Cabinet
from app.urscript.calculation.world_model import WorldModel
from app.urscript.machine.values import PoseValue
from app.urscript.outside.modbus_units import ModbusUnits
from app.urscript.robot.encoders import ConveyorEncoders
from app.urscript.robot.run_states import InstalledSignals
from sim.arm.frames import rotation_vector

FLAGS = 32


class RobotMemory:
    """Of one robot, until it starts over.

    Args:
        cabinet: the robot.

    Attributes:
        units: its Modbus signals.
        installed: what programs have set up of its signals.
        world: its frames.
        encoders: of its conveyors.
        ports: registers for general use, as its Modbus clients would see them.
        flags: of programs.
        kept: what programs set of motions that are planned, and ask for again.
    """

    def __init__(self, cabinet: Cabinet) -> None:
        self._cabinet = cabinet
        self.units = ModbusUnits(lambda: cabinet.clock)
        self.installed = InstalledSignals(cabinet, self.units)
        self.world = WorldModel(self._place(flange=True), self._place(flange=False))
        record = cabinet.record
        self.encoders = ConveyorEncoders(
            lambda: int(record.field("actual_digital_input_bits").item()),
            lambda: cabinet.state.conveyors,
            lambda index, count: record.put(f"encoder{index}_raw", (count + (1 << 31)) % (1 << 32) - (1 << 31)),
        )
        self.ports: dict[int, int] = {}
        self.flags = [False] * FLAGS
        self.kept = {"motion_version": 2.0, "jerk_gain_scaling": 1.0}

    def begin_program(self) -> None:
        """A program begins."""
        self.installed.begin()

    def end_program(self) -> None:
        """No program runs any more."""
        self.installed.end()

    def step(self) -> str:
        """One tick; what people are to be told, or ""."""
        self.installed.step()
        self.encoders.step()
        return self.units.step() if self.units.used else ""

    def end(self) -> None:
        """The robot starts over, or is there no more."""
        self.units.end()

    def _place(self, *, flange: bool) -> Callable[[], PoseValue]:
        """Tells where the flange, or the tool centre point, is in the base."""

        def place() -> PoseValue:
            simulation = self._cabinet.simulation
            p, R, _ = simulation.dynamics.places(simulation.estimate.q)
            if not flange:
                p, R = p + R @ simulation.tcp, R @ simulation.R_FT
            return PoseValue((*p.tolist(), *rotation_vector(R).tolist()))

        return place
