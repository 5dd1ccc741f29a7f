"""What the functions of the language need of the robot that they run on."""

from typing import Any, Protocol

from app.robot_interface.controller.field_record import FieldRecord
from app.urscript.functions.script_sockets import ScriptSockets
from pendant.motion.script_requests import ForceMode, ScriptedMove
from sim.simulation import Simulation

Axes = tuple[float, ...]
"""Six numbers, or three: along x, y, z, then about them."""


class ArmSide(Protocol):
    """The arm: one motion at a time is done, and who waits for it asks every tick."""

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
        """Push while the motion goes on, until the script ends or says otherwise; None: no more."""
        ...

    def leave(self) -> None:
        """Be guided by hand no more."""
        ...

    def zero(self) -> None:
        """Zero the flange's sensor as soon as the arm has stood for a while."""
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

    @property
    def popup_shown(self) -> bool:
        """A popup is there that nobody has closed."""
        ...

    def command(self, word: str, **values: Any) -> None:
        """Something of the robot other than its motion: "payload", "tcp", "protective_stop", "gravity", "watchdog"."""
        ...
