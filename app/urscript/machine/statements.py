"""Compiles statements to steps."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any
from weakref import proxy

from app.urscript.language import tree
from app.urscript.language.trouble import ScriptTrouble, Spot
from app.urscript.machine import expressions as make
from app.urscript.machine.analysis import Routine, base, expressions, size
from app.urscript.machine.expressions import Frame, Read
from app.urscript.machine.held import HALT, JOIN, RETURN, SYNC
from app.urscript.machine.stores import changed, cost_within, put_own, put_shared
from app.urscript.machine.values import StructValue
from app.urscript.machine.worked import called, remote_waited, waited

if TYPE_CHECKING:
    from app.urscript.machine.compiler import Compiler

BULKY = frozenset({tuple, str, StructValue})


class Statements:
    """Adds the steps of statements to the function that is being compiled."""

    def __init__(self, compiler: Compiler) -> None:
        self._compiler: Compiler = proxy(compiler)  # which has this: no circle, so that both go with their last user
        self._loops: list[tuple[int, list[int]]] = []  # of each loop that is open: its first step, and who leaves it

    @property
    def _code(self) -> list:
        return self._compiler.routine.code

    def whole(self, routine: Routine) -> None:
        """Compile a function."""
        self._loops = []
        self._body(routine.body)
        self._add(lambda f: RETURN, routine.place)

    def _add(self, step: Any, place: Spot, cost: int = 1) -> int:
        routine = self._compiler.routine
        routine.code.append(step)
        routine.costs.append(cost)
        routine.places.append(place)
        return len(routine.code) - 1

    def _body(self, body: list[tree.Node]) -> None:
        for each in body:
            if not isinstance(each, tree.Function):
                self._statement(each)
                self._compiler.done()

    def _statement(self, node: tree.Node) -> None:
        if isinstance(node, tree.Assign):
            self._assign(node)
        elif isinstance(node, tree.Evaluate):
            self._evaluate(node)
        elif isinstance(node, tree.If):
            self._if(node)
        elif isinstance(node, tree.While):
            self._while(node)
        elif isinstance(node, tree.Return):
            self._return(node)
        elif isinstance(node, tree.OnThread):
            self._hold(node)
        elif isinstance(node, tree.Jump):
            self._jump(node)

    # steps that go elsewhere

    def branch(self, condition: Read, place: Spot, stay: bool, cost: int = 1) -> int:
        """A step that goes on where the condition is `stay`, else to where `land` says."""
        at = self._add(None, place, cost)
        self._code[at] = (condition, stay)
        return at

    def land(self, at: int) -> None:
        """What `branch` leaves out ends here."""
        condition, stay = self._code[at]
        there, following = len(self._code), at + 1
        if stay:
            self._code[at] = lambda f: following if condition(f) else there
        else:
            self._code[at] = lambda f: there if condition(f) else following

    def _go(self, at: int, there: int) -> None:
        self._code[at] = lambda f: there

    def _if(self, node: tree.If) -> None:
        ends: list[int] = []
        for k, (condition, body) in enumerate(node.branches):
            jump = None
            if condition is not None:
                read = make.condition(self._compiler.expression(condition), condition)
                jump = self.branch(read, condition.place, True, self._cost(condition))
                self._compiler.done()
            self._body(body)
            if k < len(node.branches) - 1:
                ends.append(self._add(None, node.place))
            if jump is not None:
                self.land(jump)
        for end in ends:
            self._go(end, len(self._code))

    def _while(self, node: tree.While) -> None:
        start = len(self._code)
        read = make.condition(self._compiler.expression(node.condition), node.condition)
        jump = self.branch(read, node.place, True, self._cost(node.condition))
        self._compiler.done()
        self._loops.append((start, []))
        self._body(node.body)
        self._go(self._add(None, node.place), start)
        self.land(jump)
        for end in self._loops.pop()[1]:
            self._go(end, len(self._code))

    def _jump(self, node: tree.Jump) -> None:
        held = self._compiler.held
        if node.word in ("break", "continue"):
            if not self._loops:
                raise ScriptTrouble(node.place, f"{node.word} outside of a loop")
            start, ends = self._loops[-1]
            at = self._add(None, node.place)
            if node.word == "break":
                ends.append(at)
            else:
                self._go(at, start)
        elif node.word == "halt":
            self._add(lambda f: HALT, node.place)
        else:
            following, inside = len(self._code) + 1, node.word == "enter_critical"

            def step(_: Frame) -> int:
                held.critical(inside)
                return following

            self._add(step, node.place)

    def _return(self, node: tree.Return) -> None:
        if node.value is None:
            self._add(lambda f: RETURN, node.place)
            return
        value = self._compiler.expression(node.value)

        def step(f: Frame) -> int:
            f[0] = value(f)
            return RETURN

        self._add(step, node.place, self._cost(node))

    def _hold(self, node: tree.OnThread) -> None:
        held, place = self._compiler.held, node.place
        thread = self._compiler.expression(node.thread)
        following = len(self._code) + 1

        def kill(f: Frame) -> int:
            held.kill(thread(f), place)
            return following

        def join(f: Frame) -> int:
            held.joined = thread(f)
            return JOIN

        self._add(kill if node.word == "kill" else join, place)

    # calls

    def _evaluate(self, node: tree.Evaluate) -> None:
        call = node.value
        if isinstance(call, tree.Call) and call.name == "sync" and not call.arguments:
            self._add(lambda f: SYNC, node.place)
            return
        value = self._compiler.expression(call)
        following = len(self._code) + 1

        def step(f: Frame) -> int:
            value(f)
            return following

        self._add(step, node.place, self._cost(node))

    def call(self, node: tree.Call | tree.RemoteCall, slot: int) -> None:
        """A call that takes steps or time; its result is put into the frame at `slot`."""
        compiler, held = self._compiler, self._compiler.held
        if isinstance(node, tree.RemoteCall):
            reads = [compiler.plain(each) for each in node.arguments]
            step = remote_waited(held, node, slot, compiler.plain(node.of), arguments=reads)
        elif (routine := compiler.script.routines.get(node.name)) is not None:
            if routine.kind == "thread":
                raise ScriptTrouble(node.place, f"{node.name} is a thread: start it with run")
            step = called(held, routine, compiler.frame(node, routine), slot)
        else:
            found = compiler.builtin(node)
            step = waited(held, node, slot, found.work, arguments=compiler.checked(node, found))
        self._add(step, node.place, size(node))

    # assignments

    def store_slot(self, slot: int, value: Read, place: Spot) -> None:
        """Put a value into the frame."""
        following = len(self._code) + 1

        def step(f: Frame) -> int:
            f[slot] = value(f)
            return following

        self._add(step, place)

    def _assign(self, node: tree.Assign) -> None:
        compiler, place, cost = self._compiler, node.place, self._cost(node)
        name = base(node.target)
        slot = None if node.scope == "global" else compiler.routine.slots.get(name)
        own = slot is not None
        number = slot if slot is not None else compiler.script.globals[name]
        if isinstance(node.value, tree.Literal) and node.value.value is None and not isinstance(node.target, tree.Name):
            raise ScriptTrouble(place, "a part of a value cannot be None")
        path = [] if isinstance(node.target, tree.Name) else self._path(node.target)
        value = compiler.expression(node.value)
        if path:
            value = changed(compiler.variable(tree.Name(place, name)), path, value, place)
        following, values, made = len(self._code) + 1, compiler.held.globals, compiler.held.made

        plain = node.value
        if not path and (make.is_bool(plain) or (isinstance(plain, tree.Literal) and type(plain.value) is not str)):
            if own:
                self._add(put_own(number, value, following), place, cost)
            else:
                self._add(put_shared(values, number, value, following), place, cost)
            return

        def to_own(f: Frame) -> int:
            found = value(f)
            if type(found) in BULKY:
                made(found, place)
            f[number] = found
            return following

        def to_shared(f: Frame) -> int:
            found = value(f)
            if type(found) in BULKY:
                made(found, place)
            values[number] = found
            return following

        self._add(to_own if own else to_shared, place, cost)

    def _path(self, target: tree.Node) -> list[tuple[str, list[Read]]]:
        """The way from a variable to its part: members and indices."""
        if isinstance(target, tree.Name):
            return []
        if isinstance(target, tree.Member):
            return [*self._path(target.of), (target.name, [])]
        assert isinstance(target, tree.Index)
        return [*self._path(target.of), ("", [self._compiler.expression(each) for each in target.numbers])]

    def _cost(self, node: tree.Node) -> int:
        parts = expressions(node) or [node]
        routines = self._compiler.script.routines
        total = 1
        for part in parts:
            total += size(part) + cost_within(part, routines)
        return total
