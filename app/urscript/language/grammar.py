"""The grammar of URScript, for Lark (LALR), and the sentences that its errors become.

A statement ends with its line. A line goes on inside brackets, after an operator, a comma or `=`, as programs of clients need.
"""

from collections.abc import Iterator

from lark import Token

from app.urscript.language.trouble import ScriptTrouble, Spot

GRAMMAR = r"""
start: _block
_block: _NL* _statement*
_statement: _simple _NL* | _compound _NL*
_simple: assign | call_statement | jump | return_ | hold
_compound: function | if_ | while_ | critical

body: _NL* _statement*

function: KIND NAME "(" [parameters] ")" ":" body END
parameters: parameter ("," parameter)*
parameter: NAME ["=" expression]

if_: IF expression ":" body (ELIF expression ":" body)* [ELSE ":" body] END
while_: WHILE expression ":" body END
critical: CRITICAL ":" body END

assign: [SCOPE] postfix "=" expression
      | SCOPE postfix -> declare
call_statement: postfix
jump: JUMP
return_: RETURN [expression]
hold: HOLD expression

?expression: disjunction
?disjunction: conjunction | disjunction OR conjunction -> binary | disjunction XOR conjunction -> binary
?conjunction: inversion | conjunction AND inversion -> binary
?inversion: comparison | NOT inversion -> unary
?comparison: sum | comparison COMPARE sum -> binary
?sum: product | sum SIGN product -> binary
?product: sign | product FACTOR sign -> binary
?sign: postfix | SIGN sign -> unary
?postfix: atom | postfix "[" _expressions "]" -> subscript | postfix "." (NAME | KIND) -> select
        | postfix "." NAME "(" [arguments] ")" -> remote
?atom: NUMBER -> number
     | STRING -> string
     | WORD -> word
     | NAME -> name
     | call
     | RUN call -> run
     | pose
     | LSQB [_expressions] "]" -> listing
     | "(" expression ")"
call: NAME "(" [arguments] ")"
pose: POSE _expressions "]"
arguments: argument ("," argument)*
argument: NAME "=" expression -> named | expression
_expressions: expression ("," expression)*

KIND.3: /(def|thread|sec)\b/
IF.3: /if\b/
ELIF.3: /elif\b/
ELSE.3: /else\b/
WHILE.3: /while\b/
CRITICAL.3: /critical\b(?=\s*:)/
END.3: /end\b/
SCOPE.3: /(local|global)\b/
JUMP.3: /(break|continue|halt|enter_critical|exit_critical)\b/
RETURN.3: /return\b/
HOLD.3: /(join|kill)\b/
RUN.3: /run\b/
NOT.3: /not\b|!(?!=)/
AND.3: /and\b/
OR.3: /or\b/
XOR.3: /xor\b/
WORD.3: /(True|False|None|true|false)\b/
POSE.3: /p\s*\[/
NAME: /[A-Za-z_]\w*/
NUMBER: /0[xX][0-9a-fA-F]+|(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?/
STRING: /"[^"\n]*"|'[^'\n]*'/
LSQB: "["
COMPARE.2: /==|!=|<=|>=|<|>/
SIGN: /[+-]/
FACTOR: /[*\/%]/
_NL: /\r?\n/
COMMENT: /#[^\n]*/
LABEL: /\$[^\n]*/
BLANK: /[ \t\f]+|\\\r?\n/
%ignore COMMENT
%ignore LABEL
%ignore BLANK
"""

GOES_ON = frozenset({"SIGN", "FACTOR", "COMPARE", "AND", "OR", "XOR", "NOT", "EQUAL", "COMMA", "RUN"})
"""A line that ends with one of these goes on in the next."""

OPENING, CLOSING = frozenset({"LPAR", "LSQB", "POSE"}), frozenset({"RPAR", "RSQB"})

WORDS = {
    "NAME": "a name",
    "NUMBER": "a number",
    "STRING": "a text in quotes",
    "END": "end",
    "COLON": ":",
    "EQUAL": "=",
    "COMMA": ",",
    "LPAR": "(",
    "RPAR": ")",
    "LSQB": "[",
    "RSQB": "]",
    "_NL": "the end of the line",
    "$END": "the end of the text",
}
"""How errors call what was expected."""


MOST_TOKENS = 400_000
"""Of a script: words, numbers and signs. 10 000 motions have so many."""


class LineEnds:
    """Leaves out the ends of lines that go on in the next one, and counts what is left."""

    always_accept = ("_NL",)

    def process(self, stream: Iterator[Token]) -> Iterator[Token]:
        """What the parser gets of the lexer's stream. Raises ScriptTrouble: it is too long."""
        depth, before = 0, ""
        for number, token in enumerate(stream):
            if number == MOST_TOKENS:
                place = Spot(token.line or 1, token.column or 1)
                raise ScriptTrouble(place, f"the script has more than {MOST_TOKENS} words, numbers and signs")
            kind = token.type
            if kind in OPENING:
                depth += 1
            elif kind in CLOSING:
                depth = max(depth - 1, 0)
            elif kind == "_NL" and (depth or before in GOES_ON):
                continue
            before = kind
            yield token


def expected(kinds: set[str]) -> str:
    """Of what a syntax error says was expected, at most one thing that helps; "" for none."""
    for kind in ("RPAR", "RSQB", "COLON", "END", "_NL"):
        if kind in kinds and len(kinds) <= 24:
            return f"; expected {WORDS[kind]}"
    return ""
