"""What the functions of the language need of the robot that they run on."""

from collections.abc import Generator
from typing import Any, Protocol

from app.robot_interface.controller.field_record import FieldRecord
from app.urscript.outside.hosts import AllowedHosts
from app.urscript.outside.script_sockets import ScriptSockets
from app.urscript.robot.path_offsets import PathOffsets
from app.urscript.robot.robot_memory import RobotMemory
from pendant.motion.script_requests import ForceMode, ScriptedMove
from sim.simulation import Simulation

Axes = tuple[float, ...]
"""Six numbers, or three: along x, y, z, then about them."""


class ArmSide(Protocol):
    """The arm: one motion at a time is done, and who waits for it asks every tick.

    Attributes:
        offsets: where it goes beside its motions.
    """

    offsets: PathOffsets

    def ask(self, move: ScriptedMove) -> int:
        """Ask for a motion or a stop from the next tick on, in place of what is done; its number."""
        ...

    def take(self) -> None:
        """A thread begins to move the arm, until it gives it back. Raises Misuse: another one does."""
        ...

    def give(self) -> None:
        """A thread moves the arm no more."""
        ...

    def done(self, number: int) -> bool:
        """Whether a motion is done, has come to where the next may begin, or another took its place.

        Raises:
            Misuse: it was refused.
        """
        ...

    def drop(self, number: int) -> None:
        """Nobody waits for a motion any more: the arm comes to rest, unless another one follows in this tick."""
        ...

    def push(self, force: ForceMode | None) -> None:
        """Push while the motion goes on, until the script ends or says otherwise; None: no more.

        Raises:
            Misuse: it goes beside its motions.
        """
        ...

    def aim(self) -> ScriptedMove | None:
        """The motion that the arm does; None: none."""
        ...

    def leave(self) -> None:
        """Be guided by hand no more."""
        ...

    def zero(self) -> Generator[None, None, None]:
        """As `zero_reading`; the sensor is zeroed too, for free-drive, if the arm stands soon."""
        ...

    def zero_reading(self) -> Generator[None, None, None]:
        """Tell forces against what is felt now; it lasts until they are. Raises Misuse: the sensor tells nothing."""
        ...

    def steps_back(self, direction: Axes) -> int:
        """Ticks since the tool has been in contact against this direction, axes of B; zeros for any; 0 for none."""
        ...

    def free_drive_status(self) -> int:
        """0 normal, 1 near a singularity, 2 too near one, as get_freedrive_status()."""
        ...


class RobotSide(Protocol):
    """The robot."""

    arm: ArmSide
    sockets: ScriptSockets
    hosts: AllowedHosts
    memory: RobotMemory
    record: FieldRecord
    seed: int

    @property
    def simulation(self) -> Simulation:
        """What runs now."""
        ...

    @property
    def clock(self) -> float:
        """The controller's [s]."""
        ...

    def say(self, text: str) -> None:
        """To the log, and to clients."""
        ...

    def popup(self, text: str, title: str, level: str, blocking: bool) -> None:
        """Show a message; `level` is "", "warning" or "error"."""
        ...

    def question(self, kind: str, text: str) -> Generator[None, None, Any]:
        """Ask people for a value of a kind, "boolean", "integer", "float" or "string"; it lasts until there is an answer."""
        ...

    @property
    def popup_shown(self) -> bool:
        """A popup is there that nobody has closed."""
        ...

    def command(self, word: str, **values: Any) -> None:
        """Something of the robot other than its motion: "protective_stop", "power_off", "gravity", "watchdog"."""
        ...

    def equip(self, word: str, **values: Any) -> Generator[None, None, None]:
        """Change the payload ("payload") or the tool centre point ("tcp"); it lasts until the change is in effect.

        Raises:
            Misuse: the robot does not take it.
        """
        ...
