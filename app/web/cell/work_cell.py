"""The cell that is the user's: what it is now, its history, and what stands in for it while a scenario runs beside it."""

import math
import time
from collections.abc import Callable
from concurrent.futures import Future
from typing import Protocol

from msgspec.structs import replace

from app.files.checked import BadInput
from app.files.taught_program import Lesson
from app.kept_setup import Cell, CellNow, Keeper, any_cell, cell_of, check_cell, text_of
from app.runs.runner import simulate
from app.session.prepare import Prepared
from app.web.running import Running
from pendant.all_settings import describe, value_of
from pendant.tick.modes import Law, Mode, Phase
from sim.arm.arm_file import Arm
from sim.arm.scenario import Scenario, table
from sim.plant.changes import AttachPayload

SETTLED = 0.6
"""What changes within such a time of the last change is one step of the history [s]."""

REMEMBERED = 100
"""Steps that can be undone."""


class Desktop(Protocol):
    """What of a cell is on the page alone."""

    def taught(self) -> Lesson:
        """What is taught."""
        ...

    def script(self) -> str:
        """The program in URScript; "": none."""
        ...

    def show(self, taught: Lesson, script: str) -> None:
        """Have these instead."""
        ...


class WorkCell:
    """Lives on viser's event loop; `see` runs in the painter, which is there, too.

    Args:
        loop: that runs.
        arm: of the page.
        desktop: what is taught, and the script.
        keeper: keeps the cell for the next start; None: nobody does.
        clock: rising [s].

    Attributes:
        lines: names of inputs and outputs.
        lent: the user's cell, while a scenario runs beside it; None: what runs is the user's.
    """

    def __init__(
        self, loop: Running, arm: Arm, desktop: Desktop, keeper: Keeper | None, *, clock: Callable[[], float] = time.monotonic
    ) -> None:
        self._loop, self._arm, self._desktop, self._keeper, self._clock = loop, arm, desktop, keeper, clock
        self.lines: dict[str, str] = {}
        self.lent: Cell | None = None
        self._seen: CellNow | None = None
        self._changed = -math.inf  # when it changed last, since the history has taken it in
        self._settled: Cell | None = None  # the newest of the history
        self._before: list[Cell] = []
        self._undone: list[Cell] = []
        self._beginning: Future[None] | None = None  # another beginning that was asked for
        self._choosing = ""  # the tool that is to be in use once another beginning has begun

    @property
    def problem(self) -> str:
        """Why nothing is kept for the next start, or ""."""
        return "" if self._keeper is None else self._keeper.problem

    @property
    def keeps(self) -> bool:
        """It is kept for the next start."""
        return self._keeper is not None and not self._keeper.problem

    @property
    def undoes(self) -> bool:
        """There is something to undo."""
        return bool(self._before) and self.lent is None

    @property
    def redoes(self) -> bool:
        """There is something to do again."""
        return bool(self._undone) and self.lent is None

    def mine(self) -> Cell:
        """The user's cell, whatever runs."""
        return cell_of(self._now()) if self.lent is None else self.lent

    def file(self) -> bytes:
        """The user's cell as a file."""
        return text_of(self.mine()).encode()

    def begin_with(self, cell: Cell) -> None:
        """The loop has begun from this cell: bring in what is beside it."""
        self._desktop.show(cell.taught, cell.script)
        self.lines = dict(cell.lines)
        if cell.in_use:
            self._loop.desk.choose(cell.in_use)
        self._settled = None

    def see(self, *, now: float | None = None) -> None:
        """Take in what was changed: into the history, and into what is kept; `now` is the clock, infinite to keep it at once."""
        if self.lent is not None:
            return
        clock, cell = self._clock() if now is None else now, self._now()
        if self._choosing and cell.in_use == self._choosing:
            self._choosing = ""
        if not cell.same(self._seen):
            self._seen, self._changed = cell, self._clock()
        if self._settled is None:
            self._settled, self._changed = cell_of(cell), math.inf
        elif clock >= self._changed + SETTLED and not self._choosing and (self._beginning is None or self._beginning.done()):
            self._changed = math.inf
            self._remember(cell_of(cell))
        if self._keeper is not None and not self._keeper.problem:
            self._keeper.see(cell, now=clock)

    def lend(self) -> None:
        """Something else is about to run beside the user's cell."""
        if self.lent is None:
            self.see(now=math.inf)
            self.lent = cell_of(self._now())

    def give_back(self) -> None:
        """The user's cell again, as it was, from its start."""
        if self.lent is not None:
            cell, self.lent = self.lent, None
            self._begin(cell, check_cell(cell, "the cell"))

    def adopt(self) -> None:
        """What runs is the user's cell from now on; the one before can be had again by an undo."""
        self.lent = None

    def start_over(self) -> None:
        """From the start of what runs, with all that was made of it."""
        if self.lent is not None or self._loop.failure:
            self._loop.reset()
            return
        cell = self.mine()
        self._begin(cell, check_cell(cell, "the cell"))

    def read(self, name: str, content: bytes) -> None:
        """Begin with the cell of a file, or with that of its parts which are in it. Raises BadInput: it cannot be used."""
        cell = any_cell(name, content, self.mine())
        prepared = check_cell(cell, name)
        simulate(prepared)
        self.see(now=math.inf)
        self.lent = None
        self._begin(cell, prepared)

    def asks(self, again: bool = False) -> str:
        """What an undo (or its undoing) would do to the arm, for a question; "": nothing that anybody must be asked."""
        stack = self._undone if again else self._before
        if not stack:
            return ""
        if not self._idle():
            return "This stops the arm and begins again"
        return "" if self._stays(check_cell(stack[-1], "the cell").scenario) else "The arm goes to its start for this"

    def undo(self, again: bool = False) -> None:
        """Back by one step; `again`: forth by one."""
        source, sink = (self._undone, self._before) if again else (self._before, self._undone)
        if not source or self.lent is not None:
            return
        asks, cell = self.asks(again), source.pop()
        sink.append(self.mine())
        prepared = check_cell(cell, "the cell")
        if asks:
            self._begin(cell, prepared)
        else:
            self._change(cell, prepared)

    def _now(self) -> CellNow:
        loop, fitting = self._loop, self._loop.latest().decision.estimator.fitting
        scenario = loop.scenario
        return CellNow(
            arm=self._arm,
            scenario=scenario,
            settings=loop.settings,
            walls=loop.walls,
            tools=loop.tools,
            payload_true=loop.payload_true,
            payload_configured=scenario.payload_configured if fitting is None else fitting.load,
            in_use=table(scenario)[0].name if fitting is None else fitting.tool.name,
            taught=self._desktop.taught(),
            script=self._desktop.script(),
            lines=dict(self.lines),
        )

    def _remember(self, cell: Cell) -> None:
        """Another step of the history."""
        if self._settled is not None and cell != self._settled:
            self._before = [*self._before, self._settled][-REMEMBERED:]
            self._undone = []
        self._settled = cell

    def _idle(self) -> bool:
        """The arm stands, and nothing moves it by itself."""
        decision = self._loop.latest().decision
        stands = decision.law is Law.HOLD and decision.phase is Phase.OFF and not decision.wizard.doing
        return stands and decision.mode in (Mode.TEACH, Mode.NORMAL)

    def _stays(self, wanted: Scenario) -> bool:
        """Whether what runs can become that scenario without another beginning."""
        now, mounted, other = self._loop.scenario, self._loop.scenario.tool, wanted.tool
        if mounted is not None and other is not None:
            other = replace(other, tcp=mounted.tcp, rpy=mounted.rpy)
        same = {"tools": now.tools, "walls": now.walls, "tool": other}
        loads = {"payload_true": now.payload_true, "payload_configured": now.payload_configured}
        return replace(wanted, **same, **loads) == now

    def _change(self, cell: Cell, prepared: Prepared) -> None:
        """Have what runs become that cell."""
        desk, loop, now, scenario = self._loop.desk, self._loop, self._now(), prepared.scenario
        values = {row.name: value_of(prepared.settings, row.name) for row in describe()}
        if changed := {name: value for name, value in values.items() if value_of(loop.settings, name) != value}:
            desk.set(changed)
        if tuple(scenario.walls) != loop.walls:
            desk.fence(tuple(scenario.walls))
        if (tools := tuple(table(scenario))) != loop.tools:
            desk.tabulate(tools)
        if scenario.payload_configured != now.payload_configured:
            desk.configure(scenario.payload_configured)
        if scenario.payload_true != now.payload_true:
            desk.change(AttachPayload(load=scenario.payload_true))
        if (in_use := cell.in_use or tools[0].name) != now.in_use:
            desk.choose(in_use)
        self._put(cell)

    def _begin(self, cell: Cell, prepared: Prepared) -> None:
        """Begin anew with a cell."""
        self._choosing = cell.in_use
        self._beginning = self._loop.begin(lambda: simulate(prepared))
        self._beginning.add_done_callback(self._choose)
        self._put(cell)

    def _choose(self, begun: "Future[None]") -> None:
        if self._choosing and not begun.cancelled() and begun.exception() is None:
            self._loop.desk.choose(self._choosing)

    def _put(self, cell: Cell) -> None:
        """What is on the page alone; the history is there already."""
        self._desktop.show(cell.taught, cell.script)
        self.lines, self._settled = dict(cell.lines), cell

    def try_file(self, name: str, content: bytes) -> str:
        """Begin with the cell of a file; why that cannot be, in a line, or ""."""
        try:
            self.read(name, content)
        except BadInput as refusal:
            return str(refusal)
        return ""
