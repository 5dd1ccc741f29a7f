"""Secondary programs: they run beside the one that moves the arm, and take no time of it."""

from collections.abc import Callable, Iterable

from app.urscript.language.trouble import NOWHERE, ScriptTrouble
from app.urscript.running.script_robot import OfferedScript, joined
from pendant.decision import Decision
from pendant.inputs import Inputs

SECONDARY_TICKS = 5
"""One that runs longer takes time, which it must not. What it waits for others, a server say, does not count."""

NEVER_ENDS = "a secondary program must not take time"


class SecondaryPrograms:
    """Those that run now.

    Args:
        close: takes one that is over, and why it could not go on.
    """

    def __init__(self, close: Callable[[OfferedScript, ScriptTrouble | None], None]) -> None:
        self._close = close
        self._running: list[tuple[OfferedScript, int]] = []  # and how many ticks of its own each has had

    def __len__(self) -> int:
        return len(self._running)

    def add(self, scripts: Iterable[OfferedScript]) -> None:
        """Run these, too."""
        self._running += [(script, 0) for script in scripts]

    def step(self, inputs: Inputs) -> Inputs:
        """One tick: what they want of the robot, added to what others want."""
        left: list[tuple[OfferedScript, int]] = []
        for script, age in self._running:
            over = script.machine.tick()
            inputs = joined(inputs, script.robot.taken())
            if not over and age >= SECONDARY_TICKS:
                script.machine.trouble, over = ScriptTrouble(NOWHERE, NEVER_ENDS), True
            if over:
                self._close(script, script.machine.trouble)
            else:
                left.append((script, age + (not script.machine.waits)))
        self._running = left
        return inputs

    def end(self) -> None:
        """None runs any more."""
        for script, _ in self._running:
            self._close(script, None)
        self._running = []

    def see(self, decision: Decision) -> None:
        """Take in what the robot decided."""
        for script, _ in self._running:
            script.robot.see(decision)
