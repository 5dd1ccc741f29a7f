"""What is known of a script before it runs: its functions, its variables, and which of its functions take time."""

from collections.abc import Iterator
from dataclasses import dataclass, field

from app.urscript.language import tree
from app.urscript.language.trouble import NOWHERE, ScriptTrouble, Spot
from app.urscript.machine.limits import HEAVY, MOST_FUNCTIONS
from app.urscript.machine.signature import Builtin

MAIN = "the program"


@dataclass(slots=True)
class Routine:
    """A function, a thread or the program itself: what it consists of, and what it is compiled to.

    A frame is a list: the value that is returned, parameters, other variables, and what statements keep for a moment.
    """

    name: str
    parameters: list[tree.FunctionParameter]
    body: list[tree.Node]
    kind: str = "def"
    place: Spot = NOWHERE
    slots: dict[str, int] = field(default_factory=dict)
    size: int = 1
    by_steps: bool = True  # takes time, loops, calls itself, or is long: the machine runs it; the others run within a statement
    cost: int = 0
    code: list = field(default_factory=list)  # of functions of a frame, each gives the number of the next
    costs: list[int] = field(default_factory=list)  # steps that each counts
    places: list[Spot] = field(default_factory=list)


@dataclass(slots=True)
class ScriptOutline:
    """A script, looked through."""

    name: str
    secondary: bool
    main: Routine
    routines: dict[str, Routine]
    globals: dict[str, int]  # place of each variable that all functions see


def children(node: tree.Node) -> Iterator[tree.Node]:
    """The expressions in an expression."""
    if isinstance(node, tree.Unary):
        yield node.operand
    elif isinstance(node, tree.Binary):
        yield node.left
        yield node.right
    elif isinstance(node, tree.Items):
        yield from node.items
    elif isinstance(node, tree.Index):
        yield node.of
        yield from node.numbers
    elif isinstance(node, tree.Member):
        yield node.of
    elif isinstance(node, tree.Call):
        yield from node.arguments
        yield from (value for _, value in node.named)
    elif isinstance(node, tree.RemoteCall):
        yield node.of
        yield from node.arguments
    elif isinstance(node, tree.Run):
        yield from children(node.call)


def expressions(statement: tree.Node) -> list[tree.Node]:
    """The expressions that a statement itself has, not those of statements in it."""
    if isinstance(statement, tree.Assign):
        of, found = statement.target, [statement.value]
        while isinstance(of, tree.Index | tree.Member):
            found += of.numbers if isinstance(of, tree.Index) else []
            of = of.of
        return found
    if isinstance(statement, tree.Evaluate):
        return [statement.value]
    if isinstance(statement, tree.If):
        return [condition for condition, _ in statement.branches if condition is not None]
    if isinstance(statement, tree.While):
        return [statement.condition]
    if isinstance(statement, tree.Return):
        return [] if statement.value is None else [statement.value]
    return [statement.thread] if isinstance(statement, tree.OnThread) else []


def statements(body: list[tree.Node]) -> Iterator[tree.Node]:
    """All statements of a body, those of functions in it left out."""
    for statement in body:
        yield statement
        if isinstance(statement, tree.If):
            for _, branch in statement.branches:
                yield from statements(branch)
        elif isinstance(statement, tree.While):
            yield from statements(statement.body)


def base(target: tree.Node) -> str:
    """The variable of which something is assigned."""
    while isinstance(target, tree.Index | tree.Member):
        target = target.of
    assert isinstance(target, tree.Name)
    return target.name


def outline(body: list[tree.Node], builtins: dict[str, Builtin]) -> ScriptOutline:
    """Look a script through: a single function without parameters is a program by its name, anything else is one without a name.

    Raises:
        ScriptTrouble: a function is defined in a way that cannot be.
    """
    name, secondary = "unnamed", False
    if len(body) == 1 and isinstance(body[0], tree.Function):
        whole = body[0]
        if whole.kind == "thread":
            raise ScriptTrouble(whole.place, "a thread alone is no program")
        if not whole.parameters:
            name, secondary, body = whole.name, whole.kind == "sec", whole.body
        elif whole.kind == "sec":
            raise ScriptTrouble(whole.place, f"{whole.name}: a secondary program has no parameters")
    main = Routine(MAIN, [], body)
    routines: dict[str, Routine] = {}
    _collect(body, routines)
    every = [main, *routines.values()]
    shared = {base(each.target): 0 for each in statements(body) if isinstance(each, tree.Assign)}
    for routine in every:
        for each in statements(routine.body):
            if isinstance(each, tree.Assign) and each.scope == "global":
                shared[base(each.target)] = 0
    for number, each in enumerate(shared):
        shared[each] = number
    for routine in routines.values():
        _lay_out(routine, shared)
    _who_takes_time(main, routines, builtins)
    return ScriptOutline(name, secondary, main, routines, shared)


def _collect(body: list[tree.Node], found: dict[str, Routine]) -> None:
    for each in statements(body):
        if isinstance(each, tree.Function):
            if each.kind == "sec":
                raise ScriptTrouble(each.place, "a secondary program cannot be inside another program")
            found[each.name] = Routine(each.name, each.parameters, each.body, each.kind, each.place)
            if len(found) > MOST_FUNCTIONS:
                raise ScriptTrouble(each.place, f"more than {MOST_FUNCTIONS} functions")
            names = [parameter.name for parameter in each.parameters]
            if len(set(names)) < len(names):
                raise ScriptTrouble(each.place, f"{each.name}: two parameters have the same name")
            _collect(each.body, found)


def _lay_out(routine: Routine, shared: dict[str, int]) -> None:
    """Where a function's own variables are in its frame."""
    slots = routine.slots
    for parameter in routine.parameters:
        slots[parameter.name] = 1 + len(slots)
    for each in statements(routine.body):
        if isinstance(each, tree.Assign) and each.scope != "global":
            name = base(each.target)
            if name not in slots and (each.scope == "local" or name not in shared):
                slots[name] = 1 + len(slots)
    routine.size = 1 + len(slots)


def calls(node: tree.Node) -> Iterator[tree.Call]:
    """All calls in an expression; what a thread is started with is called elsewhere."""
    left = [node]
    while left:
        each = left.pop()
        if isinstance(each, tree.Call):
            yield each
        left += children(each)


def calls_out(node: tree.Node) -> bool:
    """A function of a server is called in an expression."""
    return isinstance(node, tree.RemoteCall) or any(calls_out(each) for each in children(node))


def _who_takes_time(main: Routine, routines: dict[str, Routine], builtins: dict[str, Builtin]) -> None:
    """Find the functions that run within a statement: short, without loops, and calling only such."""
    state: dict[str, bool | None] = {}
    for routine in routines.values():
        _runs_within(routine, state, routines, builtins)
    main.by_steps = True


def _runs_within(
    routine: Routine, state: dict[str, bool | None], routines: dict[str, Routine], builtins: dict[str, Builtin]
) -> bool:
    known = state.get(routine.name, "new")
    if known != "new":
        return bool(known)  # None: it calls itself
    state[routine.name] = None
    cost, plain = 2, routine.kind == "def"
    for each in statements(routine.body):
        cost += 1 + sum(size(expression) for expression in expressions(each))
        plain = plain and not isinstance(each, tree.While | tree.OnThread) and not any(map(calls_out, expressions(each)))
        for call in (call for expression in expressions(each) for call in calls(expression)):
            called = routines.get(call.name)
            if called is not None:
                plain = len(state) < 200 and _runs_within(called, state, routines, builtins) and plain
                cost += called.cost
            elif call.name not in builtins or builtins[call.name].takes_time:
                plain = False
    routine.cost = cost
    routine.by_steps = not (plain and cost <= HEAVY)
    state[routine.name] = not routine.by_steps
    return not routine.by_steps


def size(node: tree.Node) -> int:
    """Nodes of an expression."""
    if not node.size:
        node.size = 1 + sum(size(each) for each in children(node))
    return node.size
