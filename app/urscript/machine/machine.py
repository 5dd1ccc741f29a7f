"""Runs a compiled script in the ticks of the robot: its threads take turns, and none can hold up a tick."""

from typing import Any

from app.urscript.language import tree
from app.urscript.language.trouble import Misuse, ScriptTrouble, Spot
from app.urscript.machine.analysis import Routine, ScriptOutline, outline
from app.urscript.machine.compiler import Compiler
from app.urscript.machine.expressions import Frame
from app.urscript.machine.held import CALL, JOIN, RETURN, SYNC, WAIT, Halted, Strand
from app.urscript.machine.limits import (
    DEEPEST_CALLS,
    MEMORY_LOOK,
    MOST_MEMORY,
    MOST_SLOTS,
    MOST_THREADS,
    NODES_A_TICK,
    NODES_OF_START,
    NODES_WITHOUT_TIME,
)
from app.urscript.machine.operators import effort
from app.urscript.machine.signature import Builtin
from app.urscript.machine.values import UNSET, Value, safely_shown, weight


class Machine:
    """One script.

    Args:
        body: as it was read.
        builtins: the functions of the language.

    Raises:
        ScriptTrouble: a name is unknown, a call does not fit, or the like.
    """

    def __init__(self, body: list[tree.Node], builtins: dict[str, Builtin]) -> None:
        self.globals: list[Value] = []
        self.called: Any = None
        self.waiting: Any = None
        self.joined: Value = 0
        self.script: ScriptOutline = outline(body, builtins)
        self.globals += [UNSET] * len(self.script.globals)
        try:
            Compiler(self.script, builtins, self).all()
        except ScriptTrouble:
            self.let_go()
            raise
        finally:
            for routine in (self.script.main, *self.script.routines.values()):
                routine.body = []
        main = self.script.main
        self._count = 1
        self._main = Strand(1, main, [UNSET] * main.size)
        self._strands = [self._main]
        self._now = self._main
        self._ticks = 0
        self._inside = 0  # of critical parts
        self._fresh = 0  # numbers and characters made since the last look at what is held
        self._owed = 0  # steps that were done beyond the budgets of the ticks so far
        self.ended = False
        self.trouble: ScriptTrouble | None = None  # why it cannot go on
        self.breathless: Spot | None = None  # where a thread first computed for a second without letting time pass

    @property
    def line(self) -> int:
        """Of the program, where it is; 0 once it has ended."""
        strand = self._main
        return 0 if self.ended else strand.routine.places[min(strand.pc, len(strand.routine.places) - 1)].line

    @property
    def waits(self) -> bool:
        """Every thread waits for something outside of the script, or for another thread."""
        return all(strand.wait is not None or strand.joins for strand in self._strands)

    def variables(self) -> dict[str, str]:
        """All variables that every function sees, as text."""
        found = zip(self.script.globals, list(self.globals), strict=False)
        return {name: safely_shown(value) for name, value in found if value is not UNSET}

    def tick(self, budget: int = NODES_A_TICK) -> bool:
        """Run until every thread waits, or the budget is used up. Returns whether it has ended, by itself or by an error."""
        if self.ended:
            return True
        budget, self._owed = budget - self._owed, max(self._owed - budget, 0)
        if budget <= 0:
            return False
        try:
            self._turns(budget)
        except ScriptTrouble as trouble:
            self.trouble = trouble
            self.stop()
        except Halted:
            self.stop()
        except RecursionError:
            self.trouble = ScriptTrouble(self._place(), "too many calls within one another")
            self.stop()
        if self._main not in self._strands:
            self.stop()
        return self.ended

    def _turns(self, budget: int) -> None:
        """Let each thread run once, as far as the budget goes; those that it did not reach come first in the next tick."""
        self._ticks = ticks = self._ticks + 1
        waiting = len(self._strands)
        while waiting:
            strand = self._strands[0] if self._strands else None
            if strand is None or strand.ran == ticks:
                strand = next((each for each in self._strands if each.ran != ticks), None)
            if strand is None:
                return
            if budget <= 0:
                at = self._strands.index(strand)
                self._strands = self._strands[at:] + self._strands[:at]
                return
            strand.ran = ticks
            share = budget if self._inside else max(budget // waiting, 60)
            left = self._run(strand, share)
            budget -= share - left
            waiting = max(waiting - 1, 1)
            if left <= 0 and self._inside:
                self._strands = [strand, *(each for each in self._strands if each is not strand)]
                return

    def stop(self) -> None:
        """End all threads, and what they wait for."""
        self.ended = True
        for strand in self._strands:
            if strand.wait is not None:
                strand.wait.close()
        self._strands = []

    def let_go(self) -> None:
        """It has ended, and is used no more: what it consists of goes now, step by step, so that nobody has to look for it."""
        for routine in (self.script.main, *self.script.routines.values()):
            while routine.code:
                routine.code.pop()
                routine.places.pop()

    def start(self, routine: Routine, frame: Frame, place: Spot) -> int:
        """Start a thread; its number."""
        if len(self._strands) >= MOST_THREADS:
            raise ScriptTrouble(place, f"more than {MOST_THREADS} threads")
        self._count += 1
        effort[0] += NODES_OF_START
        self._strands.append(Strand(self._count, routine, frame, parent=self._now.number))
        self._room(place)
        return self._count

    def kill(self, thread: Value, place: Spot) -> None:
        """End a thread, and those that it started; one that has ended, or a number of none, is left as it is."""
        found = self._find(thread, place)
        if found is None:
            return
        gone = {found.number}
        for each in sorted(self._strands, key=lambda strand: strand.number):  # a child's number is the greater one
            if each.parent in gone:
                gone.add(each.number)
        if self._now.number in gone:
            raise ScriptTrouble(place, "a thread cannot kill itself")
        for each in self._strands:
            if each.number in gone and each.wait is not None:
                each.wait.close()
        self._strands = [each for each in self._strands if each.number not in gone]

    def critical(self, inside: bool) -> None:
        """A part begins or ends in which no other thread runs unless this one waits."""
        self._inside = 1 if inside else 0

    def made(self, value: Value, place: Spot) -> None:
        """A list or a text is kept."""
        size = weight(value)
        effort[0] += size
        self._fresh += size
        if self._fresh > MEMORY_LOOK:
            self._fresh = 0
            frames = [strand.frame for strand in self._strands] + [
                frame for strand in self._strands for _, _, frame, _ in strand.callers
            ]
            held = sum(weight(each) for frame in (self.globals, *frames) for each in frame)
            if held > MOST_MEMORY:
                raise ScriptTrouble(place, f"out of memory: variables hold more than {MOST_MEMORY} values")

    def _room(self, place: Spot) -> None:
        slots = sum(len(strand.frame) + sum(len(each[2]) for each in strand.callers) for strand in self._strands)
        if slots > MOST_SLOTS:
            raise ScriptTrouble(place, f"more than {MOST_SLOTS} variables in running functions")

    def _find(self, thread: Value, place: Spot) -> Strand | None:
        if type(thread) is not int:
            raise ScriptTrouble(place, "expected a thread, as run gives it")
        return next((each for each in self._strands if each.number == thread), None)

    def _place(self) -> Spot:
        strand = self._now
        places = strand.routine.places
        return places[min(strand.pc, len(places) - 1)]

    def _resumed(self, strand: Strand) -> bool:
        """Whether what a thread waits for is over."""
        if strand.joins:
            if any(each.number == strand.joins for each in self._strands):
                return False
            strand.joins = 0
        if strand.wait is None:
            return True
        try:
            next(strand.wait)
        except StopIteration as done:
            strand.frame[strand.slot], strand.wait = done.value, None
            return True
        except Misuse as misuse:
            strand.wait = None
            raise ScriptTrouble(strand.where, f"{strand.function}(): {misuse}") from None
        strand.spent = 0
        return False

    def _run(self, strand: Strand, budget: int) -> int:
        """Run one thread until it waits; what is left of the budget, 0 or less where it was used up."""
        self._now = strand
        if (strand.wait is not None or strand.joins) and not self._resumed(strand):
            return budget
        routine, pc, frame = strand.routine, strand.pc, strand.frame
        code, costs, begun = routine.code, routine.costs, budget
        try:
            while budget > 0:
                budget -= costs[pc]
                following = code[pc](frame)
                if effort[0] > 20:
                    budget, effort[0] = budget - effort[0], 0
                if following >= 0:
                    pc = following
                    continue
                if following == SYNC:
                    pc += 1
                    strand.spent, begun = 0, budget
                    return max(budget, 1)
                if following == CALL:
                    called, g, slot = self.called
                    strand.callers.append((routine, pc + 1, frame, slot))
                    if len(strand.callers) > DEEPEST_CALLS:
                        raise ScriptTrouble(routine.places[pc], f"more than {DEEPEST_CALLS} calls within one another")
                    routine, frame, pc = called, g, 0
                    code, costs = routine.code, routine.costs
                    if len(g) > 20:
                        self._room(routine.place)
                elif following == RETURN:
                    if not strand.callers:
                        self._strands = [each for each in self._strands if each is not strand]
                        return max(budget, 1)
                    value = frame[0]
                    routine, pc, frame, slot = strand.callers.pop()
                    frame[slot] = value
                    code, costs = routine.code, routine.costs
                elif following == WAIT:
                    strand.wait, strand.slot, strand.where, strand.function = self.waiting
                    strand.frame, pc = frame, pc + 1
                    if not self._resumed(strand):
                        begun = budget
                        return max(budget, 1)
                elif following == JOIN:
                    pc += 1
                    found = self._find(self.joined, routine.places[pc - 1])
                    if found is strand:
                        raise ScriptTrouble(routine.places[pc - 1], "a thread cannot wait for itself")
                    if found is not None:
                        strand.joins, begun = found.number, budget
                        return max(budget, 1)
                else:
                    raise Halted
            return 0
        finally:
            strand.routine, strand.pc, strand.frame = routine, pc, frame
            strand.spent += begun - budget
            self._owed += max(-budget, 0)
            if strand.spent > NODES_WITHOUT_TIME and budget <= 0 and self.breathless is None:
                self.breathless = routine.places[pc]
