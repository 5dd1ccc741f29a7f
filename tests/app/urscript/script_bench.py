"""A robot without a network that runs scripts, for the tests of the language."""

from app.robot_interface.controller.robot_words import RuntimeState
from app.urscript.language.trouble import ScriptTrouble
from app.urscript.running.script_runner import ScriptRunner
from app.urscript.running.told import Telling, Told
from tests.app.robot_interface.robot_bench import RobotBench

SETTLED = 150
"""Ticks after which the arm stands."""


class ScriptBench:
    """Runs one script after the other."""

    def __init__(self, robot: RobotBench | None = None) -> None:
        self.robot = robot or RobotBench()
        self.runner = ScriptRunner(self.robot.cabinet)
        self.robot.step(SETTLED)

    def run(self, text: str, ticks: int = 1500) -> tuple[list[str], str]:
        """What a script tells with textmsg, and the error that ends it; one that still runs after `ticks` is ended."""
        new: list[Told] = []
        self.runner.listen(new.append)
        try:
            self.runner.offer(text)
        except ScriptTrouble as trouble:
            return [], str(trouble)
        for _ in range(ticks):
            self.robot.step()
            if self.state is None:
                break
        self.runner.stop()
        self.robot.step()
        self.runner.forget(new.append)
        trouble = self.runner.trouble
        return [each.text for each in new if each.kind is Telling.TEXT], "" if trouble is None else str(trouble)

    @property
    def state(self) -> RuntimeState | None:
        return self.runner.state
