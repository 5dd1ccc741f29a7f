"""Runs programs that other people wrote, and tells how each ended: docs/reference/programs.md judges what this finds.

    python -m tools.found_programs FOLDER [--seconds S] [--out FILE]

gives every `*.script` of the folder to a UR5e that stands, each to a robot of its own: as one program, also a single
function without parameters, which a pendant only defines; `*.sent.script` cut into programs, as a text that a client sends;
`*.lines.script` line by line, each when the one before is done. A text of several programs counts as refused only where all
are. A program that asks for a pose out of the UR5e's reach is given to a UR10e as well. Nobody presses a button, no input is
on, no server answers. The exit code is 1 if a program lets the simulation fail.
"""

import argparse
import json
import sys
import time
from pathlib import Path
from typing import NamedTuple

from app.api import session, stepped
from app.robot_interface.controller.cabinet import Cabinet
from app.robot_interface.controller.program_folder import ProgramFolder
from app.urscript.language.trouble import ScriptTrouble
from app.urscript.running.script_runner import ScriptRunner
from app.urscript.running.told import Telling
from app.urscript.running.whole_text import run_text
from pendant.events.event import Kind
from pendant.inputs import NOTHING
from sim.exchange.desk import Wishes

SETTLED = 150
"""Ticks after which the arm stands."""

LAST = 50
"""Ticks after the end of a program, in which what it left to be done is done."""

WRONG = frozenset({Kind.TOOL_REFUSED, Kind.COMMAND_REFUSED, Kind.PROGRAM_REFUSED, Kind.ZERO_REFUSED, Kind.PROTECTIVE_STOP})
"""Events that tell people that something was not done, or that the arm was stopped."""

BEYOND = ("out of reach", "no joint angles reach")
"""What an error says of a pose that a longer arm may reach."""


class Ending(NamedTuple):
    """How a program ended."""

    program: str  # name of its file
    arm: str
    outcome: str  # "ended", "runs", "refused", "error", or "FAILED"
    words: str  # of the error, or what it told last
    line: int  # that runs, or 0
    events: tuple[str, ...]  # that tell of what was not done
    seconds: float  # simulated
    took: float  # [s]


class LoneRobot:
    """A robot without a network.

    Args:
        arm: its model.

    Attributes:
        kinds: of the events so far.
    """

    def __init__(self, arm: str) -> None:
        self._simulation = stepped(session({"title": "found", "robot": arm, "duration": 1.0}))
        self.cabinet = Cabinet(lambda: self._simulation, self._simulation.arm.chain.joints, ProgramFolder())
        self.runner = ScriptRunner(self.cabinet)
        self.kinds: set[Kind] = set()
        self.step(SETTLED)

    def step(self, count: int = 1) -> None:
        """So many ticks."""
        for _ in range(count):
            tick = self._simulation.tick_count + 1
            wishes = Wishes(NOTHING, (), ()).joined(self.cabinet.wishes(tick, self._simulation.snapshot))
            decision = self._simulation.tick(wishes)
            self.cabinet.see(tick, decision)
            self.kinds.update(event.kind for event in decision.events)


def offer(runner: ScriptRunner, text: str) -> None:
    """Run a text as one program."""
    runner.offer(text)


def run(path: Path, arm: str, ticks: int) -> Ending:
    """Run one program, or one line after the other."""
    text = path.read_bytes().decode("utf-8", "replace")
    robot, begun = LoneRobot(arm), time.perf_counter()
    runner, passed, errors = robot.runner, 0, []
    give = run_text if path.name.endswith(".sent.script") else offer
    for part in text.splitlines() if path.name.endswith(".lines.script") else [text]:
        try:
            if part.strip():
                give(runner, part)
        except ScriptTrouble as trouble:
            errors.append(("refused", str(trouble)))
            continue
        robot.step(2)
        while runner.state is not None and passed < ticks:
            robot.step()
            passed += 1
        if runner.state is None and runner.trouble is not None:
            errors.append(("error", str(runner.trouble)))
    told = [each.text for each in runner.told if each.kind in (Telling.TEXT, Telling.POPUP, Telling.QUESTION, Telling.ASIDE)]
    outcome, words = errors[0] if errors else ("ended" if runner.state is None else "runs", told[-1] if told else "")
    line = runner.line
    runner.stop()
    robot.step(LAST)
    events = tuple(sorted(kind.value for kind in robot.kinds & set(WRONG)))
    return Ending(path.name, arm, outcome, words, line, events, passed * 2e-3, time.perf_counter() - begun)


def judged(path: Path, ticks: int) -> Ending:
    """Run one program on the UR5e, and on the UR10e where it asks for more than the UR5e's reach."""
    ending = Ending(path.name, "", "FAILED", "", 0, (), 0.0, 0.0)
    for arm in ("ur5e", "ur10e"):
        try:
            ending = run(path, arm, ticks)
        except Exception as failure:  # noqa: BLE001 whatever a program brings about is what is looked for
            return ending._replace(arm=arm, outcome="FAILED", words=repr(failure))
        if not any(each in ending.words for each in BEYOND):
            break
    return ending


def main() -> int:
    """Run all programs of a folder."""
    parser = argparse.ArgumentParser(prog="python -m tools.found_programs", description=__doc__)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--seconds", type=float, default=20.0, help="simulated, that each gets")
    parser.add_argument("--out", type=Path, help="JSON file")
    values = parser.parse_args()
    found: list[Ending] = []
    for path in sorted(values.folder.glob("*.script")):
        found.append(judged(path, round(values.seconds / 2e-3)))
        each = found[-1]
        words = f"{each.words[:160]} {' '.join(each.events)}"
        sys.stdout.write(f"{each.outcome:8} {each.arm:6} {each.seconds:5.1f} s  {each.program}: {words}\n")
        sys.stdout.flush()
        if values.out is not None:
            values.out.write_text(json.dumps([each._asdict() for each in found], indent=1) + "\n", encoding="utf-8")
    outcomes = [each.outcome for each in found]
    sys.stdout.write(", ".join(f"{outcomes.count(each)} {each}" for each in sorted(set(outcomes))) + "\n")
    return 1 if "FAILED" in outcomes else 0


if __name__ == "__main__":
    sys.exit(main())
