"""Reads a script: text to tree, or one error with line and column."""

from functools import cache
from typing import Any

from lark import Lark, Token, Transformer, UnexpectedInput
from lark.exceptions import UnexpectedCharacters, UnexpectedToken, VisitError

from app.urscript.language import tree
from app.urscript.language.grammar import GRAMMAR, LineEnds, expected
from app.urscript.language.trouble import NOWHERE, ScriptTrouble, Spot

LONGEST = 1 << 20
"""Of a script [bytes]."""

DEEPEST = 60
"""Brackets within one another."""

DEEPEST_TREE = 200
"""Blocks, operators and parts within one another: what walks the tree recurses."""

POSE_ITEMS = 6

VALUES = {"True": True, "true": True, "False": False, "false": False, "None": None}


def _at(token: Token) -> Spot:
    return Spot(token.line or 1, token.column or 1)


class _Build(Transformer[Token, Any]):
    """Makes the tree while the parser goes."""

    def start(self, items: list[Any]) -> list[tree.Node]:
        return _flat(items)

    body = start

    def number(self, items: list[Token]) -> tree.Literal:
        text = str(items[0])
        if text[:2] in ("0x", "0X"):
            return tree.Literal(_at(items[0]), int(text, 16))
        whole = text.isdigit() and len(text) < 11 and int(text) < 1 << 31
        return tree.Literal(_at(items[0]), int(text) if whole else float(text))

    def string(self, items: list[Token]) -> tree.Literal:
        return tree.Literal(_at(items[0]), str(items[0])[1:-1])

    def word(self, items: list[Token]) -> tree.Literal:
        return tree.Literal(_at(items[0]), VALUES[items[0]])

    def name(self, items: list[Token]) -> tree.Name:
        return tree.Name(_at(items[0]), str(items[0]))

    def binary(self, items: list[Any]) -> tree.Binary:
        return tree.Binary(_at(items[1]), str(items[1]), items[0], items[2])

    def unary(self, items: list[Any]) -> tree.Node:
        operator, operand = str(items[0]).replace("!", "not"), items[1]
        if operator == "-" and isinstance(operand, tree.Literal) and type(operand.value) in (int, float):
            return tree.Literal(_at(items[0]), -operand.value)  # pyright: ignore[reportOptionalOperand, reportOperatorIssue]
        return tree.Unary(_at(items[0]), operator, operand)

    def listing(self, items: list[Any]) -> tree.Items:
        return tree.Items(_at(items[0]), [item for item in items[1:] if item is not None])

    def pose(self, items: list[Any]) -> tree.Node:
        """Six values are a pose; one or two are an element of a variable that is called p."""
        place, values = _at(items[0]), items[1:]
        if len(values) == POSE_ITEMS:
            return tree.Items(place, values, pose=True)
        if len(values) > 2:
            raise ScriptTrouble(place, f"a pose has 6 values, this one has {len(values)}")
        return tree.Index(place, tree.Name(place, "p"), values)

    def subscript(self, items: list[Any]) -> tree.Index:
        return tree.Index(items[0].place, items[0], items[1:])

    def select(self, items: list[Any]) -> tree.Node:
        return tree.Member(items[0].place, items[0], str(items[1]))

    def argument(self, items: list[Any]) -> Any:
        return items[0]

    def named(self, items: list[Any]) -> tuple[str, tree.Node]:
        return str(items[0]), items[1]

    def arguments(self, items: list[Any]) -> list[Any]:
        return items

    def call(self, items: list[Any]) -> tree.Call:
        given = items[1] or []
        named = [each for each in given if isinstance(each, tuple)]
        places = [each for each in given if not isinstance(each, tuple)]
        if named and given.index(named[0]) < len(places):
            raise ScriptTrouble(_at(items[0]), f"{items[0]}(): arguments by name come last")
        return tree.Call(_at(items[0]), str(items[0]), places, named)

    def run(self, items: list[Any]) -> tree.Run:
        return tree.Run(_at(items[0]), items[1])

    def assign(self, items: list[Any]) -> tree.Assign:
        scope, target, value = items
        _variable(target)
        return tree.Assign(target.place, target, value, str(scope or ""))

    def declare(self, items: list[Any]) -> tree.Assign:
        scope, target = items
        _variable(target)
        return tree.Assign(target.place, target, tree.Literal(target.place, None), str(scope))

    def remote(self, items: list[Any]) -> tree.RemoteCall:
        of, name, given = items[0], str(items[1]), items[2] or []
        if any(isinstance(each, tuple) for each in given):
            raise ScriptTrouble(_at(items[1]), f"{name}(): a remote function has no arguments by name")
        while isinstance(of, tree.Member):
            of, name = of.of, f"{of.name}.{name}"
        return tree.RemoteCall(_at(items[1]), of, name, given)

    def call_statement(self, items: list[Any]) -> tree.Node:
        value = items[0]
        if isinstance(value, tree.Name) and value.name == "pass":  # a name, too: programs call variables so
            return tree.Jump(value.place, "pass")
        if not isinstance(value, tree.Call | tree.Run | tree.RemoteCall):
            raise ScriptTrouble(value.place, "a value alone is no statement")
        return tree.Evaluate(value.place, value)

    def jump(self, items: list[Token]) -> tree.Jump:
        return tree.Jump(_at(items[0]), str(items[0]))

    def return_(self, items: list[Any]) -> tree.Return:
        return tree.Return(_at(items[0]), items[1])

    def hold(self, items: list[Any]) -> tree.OnThread:
        return tree.OnThread(_at(items[0]), str(items[0]), items[1])

    def parameter(self, items: list[Any]) -> tree.FunctionParameter:
        return tree.FunctionParameter(_at(items[0]), str(items[0]), items[1])

    def parameters(self, items: list[Any]) -> list[Any]:
        return items

    def function(self, items: list[Any]) -> tree.Function:
        kind, name, parameters, body, _ = items
        return tree.Function(_at(name), str(kind), str(name), parameters or [], body)

    def if_(self, items: list[Any]) -> tree.If:
        place, branches, k = _at(items[0]), [], 0
        while isinstance(items[k], Token) and items[k].type in ("IF", "ELIF"):
            branches.append((items[k + 1], items[k + 2]))
            k += 3
        if isinstance(items[k], Token) and items[k].type == "ELSE":
            branches.append((None, items[k + 1]))
        return tree.If(place, branches)

    def while_(self, items: list[Any]) -> tree.While:
        return tree.While(_at(items[0]), items[1], items[2])

    def critical(self, items: list[Any]) -> list[tree.Node]:
        place = _at(items[0])
        return [tree.Jump(place, "enter_critical"), *items[1], tree.Jump(place, "exit_critical")]


def _variable(target: tree.Node) -> None:
    """Raise ScriptTrouble where nothing can be assigned."""
    of = target
    while isinstance(of, tree.Index | tree.Member):
        of = of.of
    if not isinstance(of, tree.Name):
        raise ScriptTrouble(target.place, "nothing can be assigned to this")


def _flat(items: list[Any]) -> list[tree.Node]:
    found: list[tree.Node] = []
    for item in items:
        if isinstance(item, list):
            found += item
        elif not (isinstance(item, tree.Jump) and item.word == "pass"):
            found.append(item)
    return found


@cache
def _parser() -> Lark:
    return Lark(
        GRAMMAR, parser="lalr", lexer="basic", postlex=LineEnds(), transformer=_Build(), maybe_placeholders=True, strict=False
    )


def read_script(text: str) -> list[tree.Node]:
    """The statements of a script.

    Raises:
        ScriptTrouble: it cannot be read; with the first place where it goes wrong.
    """
    if len(text) > LONGEST:
        raise ScriptTrouble(NOWHERE, f"the script has {len(text)} characters, allowed: {LONGEST}")
    _shallow(text)
    lines = text.split("\n")

    def wrong(place: Spot, sentence: str) -> ScriptTrouble:
        """An error of syntax; a robot's words are those that clients of its primary interface show."""
        line = lines[place.line - 1].rstrip("\r") if place.line <= len(lines) else ""
        return ScriptTrouble(place, f"syntax error{sentence}", f"syntax_error_on_line:{place.line}:{line}:")

    parser = _parser()
    try:
        body: list[tree.Node] = parser.parse(text)  # pyright: ignore[reportAssignmentType]: the transformer's, not Lark's tree
    except VisitError as error:
        if isinstance(error.orig_exc, ScriptTrouble):
            raise error.orig_exc from None
        raise
    except UnexpectedCharacters as error:
        raise wrong(Spot(error.line, error.column), f": unexpected character {error.char!r}") from None
    except UnexpectedToken as error:
        token = error.token
        if token.type == "$END":
            last = text.rstrip().split("\n")
            raise wrong(Spot(len(last), len(last[-1]) + 1), ": the text ends too early") from None
        shown = "the end of the line" if token.type == "_NL" else f"'{str(token)[:30]}'"
        raise wrong(_at(token), f": unexpected {shown}{expected(set(error.expected))}") from None
    except UnexpectedInput as error:
        raise wrong(Spot(error.line, error.column), "") from None
    for depth, level in enumerate(tree.levels(body)):
        if depth == DEEPEST_TREE:
            raise ScriptTrouble(level[0].place, f"blocks and operators within one another, more than {DEEPEST_TREE}")
    return body


def _shallow(text: str) -> None:
    """Raise ScriptTrouble where brackets are nested too deeply, or a line is too long."""
    depth, deepest = 0, DEEPEST
    for number, line in enumerate(text.split("\n"), 1):
        if len(line) > 1 << 15:
            raise ScriptTrouble(Spot(number, 1), f"the line has {len(line)} characters, allowed: {1 << 15}")
        code = line.split("#", 1)[0]
        for column, character in enumerate(code, 1):
            if character in "([":
                depth += 1
                if depth > deepest:
                    raise ScriptTrouble(Spot(number, column), f"brackets within brackets, more than {deepest}")
            elif character in ")]":
                depth = max(depth - 1, 0)
