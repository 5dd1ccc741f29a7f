"""Compiles a script: each function to a list of steps that the machine can stop between.

A step is a function of the frame; it gives the number of the next one, or says that the machine has to do something first.
What takes time within an expression, and what is long, is done beforehand, in the order of the text, and kept in the frame.
"""

from collections.abc import Callable
from typing import Any

from app.urscript.language import tree
from app.urscript.language.calling import Given, bound
from app.urscript.language.trouble import ScriptTrouble, not_found
from app.urscript.machine import expressions as make
from app.urscript.machine.analysis import MAIN, Routine, ScriptOutline, children, size
from app.urscript.machine.expressions import Frame, Read
from app.urscript.machine.held import Held
from app.urscript.machine.limits import HEAVY
from app.urscript.machine.signature import Builtin, NeededArgument
from app.urscript.machine.statements import Statements
from app.urscript.machine.values import UNSET, Value
from app.urscript.machine.worked import absent_called, as_it_is, kept, named_check, structured, worked


class Compiler:
    """Compiles one script for one machine."""

    def __init__(self, script: ScriptOutline, builtins: dict[str, Builtin], held: Held) -> None:
        self.script, self.builtins, self.held = script, builtins, held
        self.routine = script.main
        self.held_slots = 0  # slots in use by the present statement
        self._temporary: dict[int, Read] = {}  # of nodes done beforehand, by id
        self._stepped: dict[int, bool] = {}  # whether there are steps in a node, by id
        self._statements = Statements(self)

    def all(self) -> None:
        """Compile every function and the program."""
        for routine in (*self.script.routines.values(), self.script.main):
            self.routine = routine
            self._statements.whole(routine)

    def expression(self, node: tree.Node) -> Read:
        """The value of an expression; steps for what has to be done first are added to the present function."""
        if self._steps_in(node) or size(node) > HEAVY:
            self._beforehand(node)
        return self.plain(node)

    def _steps_in(self, node: tree.Node) -> bool:
        found = self._stepped.get(id(node))
        if found is None:
            own = isinstance(node, tree.RemoteCall) or (isinstance(node, tree.Call) and self._by_steps(node))
            found = self._stepped[id(node)] = own or any(self._steps_in(each) for each in children(node))
        return found

    def _by_steps(self, call: tree.Call) -> bool:
        routine = self.script.routines.get(call.name)
        if routine is not None:
            return routine.by_steps
        found = self.builtins.get(call.name)
        return found is not None and found.takes_time

    def _beforehand(self, node: tree.Node) -> None:
        """Do now, in the order of the text, what a plain expression cannot hold, and what comes before that."""
        if isinstance(node, tree.Binary) and node.operator in ("and", "or") and self._steps_in(node.right):
            self._short(node)
            return
        parts = list(children(node))
        last = max((k for k, part in enumerate(parts) if self._steps_in(part)), default=-1)
        for k, part in enumerate(parts):
            if self._steps_in(part) or size(part) > HEAVY // 4:
                self._beforehand(part)
            if (k < last or size(part) > HEAVY // 8) and not isinstance(part, tree.Literal):
                self._keep(part, self.plain(part))
        if isinstance(node, tree.RemoteCall) or (isinstance(node, tree.Call) and self._by_steps(node)):
            slot = self.slot()
            self._statements.call(node, slot)
            self._temporary[id(node)] = kept(slot)

    def _short(self, node: tree.Binary) -> None:
        """`and`, `or` whose second part takes time: only if the first does not decide."""
        slot = self.slot()
        first = make.condition(self.expression(node.left), node.left)
        wanted = node.operator == "and"
        self._statements.store_slot(slot, first, node.place)
        jump = self._statements.branch(kept(slot), node.place, wanted)
        second = make.condition(self.expression(node.right), node.right)
        self._statements.store_slot(slot, second, node.place)
        self._statements.land(jump)
        self._temporary[id(node)] = kept(slot)

    def _keep(self, node: tree.Node, value: Read) -> None:
        slot = self.slot()
        self._statements.store_slot(slot, value, node.place)
        self._temporary[id(node)] = kept(slot)

    def slot(self) -> int:
        """A place in the frame for the present statement."""
        routine = self.routine
        found = 1 + len(routine.slots) + self.held_slots
        self.held_slots += 1
        routine.size = max(routine.size, found + 1)
        return found

    def done(self) -> None:
        """A statement is compiled: what it kept is free."""
        self.held_slots = 0
        self._temporary.clear()
        self._stepped.clear()

    def plain(self, node: tree.Node) -> Read:
        """The value of an expression in which nothing has to be done first."""
        done = self._temporary.get(id(node))
        if done is not None:
            return done
        if isinstance(node, tree.Literal):
            return make.constant(node.value)
        if isinstance(node, tree.Name):
            return self.variable(node)
        if isinstance(node, tree.Binary):
            return self._binary(node)
        if isinstance(node, tree.Unary):
            x = self.plain(node.operand)
            if node.operator == "not":
                return make.opposite(make.condition(x, node.operand))
            return make.signed(x, node.place) if node.operator == "-" else x
        if isinstance(node, tree.Items):
            return make.listed([self.plain(each) for each in node.items], node.place, node.pose)
        if isinstance(node, tree.Index):
            return make.indexed(self.plain(node.of), [self.plain(each) for each in node.numbers], node.place)
        if isinstance(node, tree.Member):
            return make.selected(self.plain(node.of), node.name, node.place)
        if isinstance(node, tree.Run):
            return self._run(node)
        assert isinstance(node, tree.Call)
        return self._call(node)

    def variable(self, node: tree.Name) -> Read:
        """Read a variable."""
        slot = self.routine.slots.get(node.name)
        if slot is not None:
            return make.local(slot, node.name, node.place)
        number = self.script.globals.get(node.name)
        if number is None:
            raise not_found(node.place, node.name, f"{node.name} is not defined")
        return make.shared(self.held.globals, number, node.name, node.place)

    def _binary(self, node: tree.Binary) -> Read:
        operator = node.operator
        if operator == "or":
            choice = self._choice(node)
            if choice is not None:
                return choice
            return make.either([make.condition(self.plain(part), part) for part in self._chain(node)])
        x, y = self.plain(node.left), self.plain(node.right)
        if operator == "and":
            return make.both(make.condition(x, node.left), make.condition(y, node.right))
        if operator == "xor":
            return make.unequal(make.condition(x, node.left), make.condition(y, node.right))
        if operator == "==" and isinstance(node.right, tree.Literal):
            return self._same(node.left, x, node.right.value)
        if operator in "+-*/%":
            return make.arithmetic(operator, x, y, node.place)
        return make.comparison(operator, x, y, node.place)

    def _same(self, node: tree.Node, x: Read, value: Value) -> Read:
        if not isinstance(node, tree.Name) or id(node) in self._temporary:
            return make.same(x, value)
        slot = self.routine.slots.get(node.name)
        if slot is not None:
            return make.same_local(slot, value, x)
        return make.same_shared(self.held.globals, self.script.globals[node.name], value, x)

    def _choice(self, node: tree.Binary) -> Read | None:
        """Of one variable that is compared with several numbers."""
        names: set[str] = set()
        values: list[Value] = []
        for part in self._chain(node):
            if not (isinstance(part, tree.Binary) and part.operator == "==" and isinstance(part.left, tree.Name)):
                return None
            if not isinstance(part.right, tree.Literal) or type(part.right.value) not in (int, float):
                return None
            names.add(part.left.name)
            values.append(part.right.value)
        if len(names) > 1 or any(id(part) in self._temporary for part in self._chain(node)):
            return None
        part = self._chain(node)[0]
        assert isinstance(part, tree.Binary)
        return make.one_of(self.plain(part.left), values)

    def _chain(self, node: tree.Node) -> list[tree.Node]:
        """The parts of a or b or c."""
        if isinstance(node, tree.Binary) and node.operator == "or" and id(node) not in self._temporary:
            return [*self._chain(node.left), node.right]
        return [node]

    # calls

    def given(self, node: tree.Call, routine: Routine) -> list[Read]:
        """The values for the parameters of a function of the script."""
        defaults = {each.name: each.default for each in routine.parameters if each.default is not None}
        names = [each.name for each in routine.parameters]
        found = bound(node, names, {name: Given(None, default) for name, default in defaults.items()})
        return [self.plain(each.node) if each.node is not None else self._default(each.default) for each in found]

    def _default(self, node: Any) -> Read:
        routine, self.routine = self.routine, Routine(MAIN, [], [])
        try:
            if self._steps_in(node):
                raise ScriptTrouble(node.place, "a default cannot take time")
            return self.plain(node)
        finally:
            self.routine = routine

    def frame(self, node: tree.Call, routine: Routine) -> Callable[[Frame], Frame]:
        """Makes the frame of a call."""
        reads = self.given(node, routine)
        if not reads:
            return lambda f: [None] + [UNSET] * (routine.size - 1)

        def made(f: Frame) -> Frame:
            g: Frame = [None]
            g += [read(f) for read in reads]
            g += [UNSET] * (routine.size - len(g))
            return g

        return made

    def _call(self, node: tree.Call) -> Read:
        if node.name == "struct" and node.name not in self.script.routines:
            return self._struct(node)
        routine = self.script.routines.get(node.name)
        if routine is None:
            found = self.builtin(node)
            if found.absent:
                return absent_called(node.name, found.absent, [self.plain(each) for each in children(node)], node.place)
            return worked(node.name, found.work, self.checked(node, found), node.place)
        if routine.kind == "thread":
            raise ScriptTrouble(node.place, f"{node.name} is a thread: start it with run")
        made, code = self.frame(node, routine), routine.code

        def within(f: Frame) -> Value:
            g, pc = made(f), 0
            while pc >= 0:
                pc = code[pc](g)
            return g[0]

        return within

    def builtin(self, node: tree.Call) -> Builtin:
        """The function of the language of this name."""
        found = self.builtins.get(node.name)
        if found is None:
            raise not_found(node.place, node.name, f"there is no function {node.name}()")
        if found.barred:
            raise ScriptTrouble(node.place, f"{node.name}(): {found.barred}")
        return found

    def checked(self, node: tree.Call, found: Builtin) -> list[tuple[Read, Callable[[Value], Value]]]:
        """The arguments of a function of the language, each with its check."""
        may_lack = [each for each in found.parameters if not isinstance(each.default, NeededArgument)]
        defaults = {each.name: Given(None, each.default) for each in may_lack}
        given = bound(node, [each.name for each in found.parameters], defaults)
        reads: list[tuple[Read, Callable[[Value], Value]]] = []
        for each, taken in zip(given, found.parameters, strict=True):
            if each.node is None:
                reads.append((make.constant(each.default), as_it_is))
            else:
                check, name = taken.check, taken.name
                reads.append((self.plain(each.node), named_check(check, name)))
        return reads

    def _struct(self, node: tree.Call) -> Read:
        if node.arguments or not node.named:
            raise ScriptTrouble(node.place, "struct() has members by name")
        return structured([(name, self.plain(value)) for name, value in node.named], node.place)

    def _run(self, node: tree.Run) -> Read:
        routine = self.script.routines.get(node.call.name)
        if routine is None:
            raise not_found(node.call.place, node.call.name, f"there is no thread {node.call.name}()")
        made, held, place = self.frame(node.call, routine), self.held, node.place
        return lambda f: held.start(routine, made(f), place)
