"""What runs scripts, as the cabinet sees it."""

from typing import Protocol

from app.robot_interface.controller.robot_words import RuntimeState
from pendant.decision import Decision
from sim.exchange.desk import Wishes


class Scripts(Protocol):
    """What runs scripts, beside everybody else who acts."""

    @property
    def state(self) -> RuntimeState | None:
        """Of the script; None: none runs."""
        ...

    @property
    def name(self) -> str:
        """Of the script that runs."""
        ...

    @property
    def reads(self) -> bool:
        """A script runs, which may read the record."""
        ...

    def wishes(self, tick: int) -> Wishes | None:
        """What the script wants of the tick that begins; None: nothing."""
        ...

    def see(self, decision: Decision) -> None:
        """Take in what the robot decided."""
        ...

    def begin(self) -> None:
        """The simulation starts over."""
        ...

    def stop(self) -> None:
        """End the script."""
        ...

    def pause(self) -> None:
        """Let it wait."""
        ...

    def resume(self) -> None:
        """Let it go on."""
        ...
