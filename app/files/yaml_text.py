"""YAML text into plain values, stricter than YAML: one document, no aliases, no repeated keys, no surprising words."""

import re
from pathlib import Path
from typing import Any, ClassVar

import yaml
from yaml.composer import Composer

from app.files.bad_input import ABSENT, BadInput, shown
from app.files.regular_file import open_regular

LARGEST = 2_000_000
"""Largest file that is read [bytes]."""

MOST = 60_000
"""Values in a file, each list and mapping counted as one more: a wall of 2,000 vertices and 4,000 faces has 30,000."""

DEEPEST = 40
"""Deepest nesting that is accepted; below what the parser's recursion bears."""


def read(path: Path, where: str) -> str:
    """The text of a file.

    Raises:
        BadInput: there is none, it is too large or not UTF-8.
    """
    if "\0" in str(path):
        raise BadInput(where, "", str(path), "expected the name of a file")
    data = bytearray()
    try:
        with open_regular(path) as file:
            while len(data) <= LARGEST and (part := file.read(LARGEST + 1)):
                data += part
    except OSError as error:
        raise BadInput(str(path), "", ABSENT, f"expected a readable file ({error.strerror})") from None
    if len(data) > LARGEST:
        raise BadInput(where, "", ABSENT, f"expected at most {LARGEST} bytes")
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = data[: error.start].count(b"\n") + 1
        raise BadInput(where, f"line {line}", bytes(data[error.start : error.start + 4]), "expected text in UTF-8") from None


class _Loader(Composer, yaml.CSafeLoader):
    """YAML 1.2's plain forms: no aliases, no repeated keys, `1e3` is a number; yes, no, on and off are words.

    Text becomes events in libyaml, six times as fast as in Python; nodes are made of them here, where they can be refused.
    """

    yaml_implicit_resolvers: ClassVar = {
        first: [(tag, pattern) for tag, pattern in rules if not tag.endswith((":bool", ":float", ":int", ":timestamp"))]
        for first, rules in yaml.CSafeLoader.yaml_implicit_resolvers.items()
    }

    def __init__(self, stream: str) -> None:
        yaml.CSafeLoader.__init__(self, stream)
        Composer.__init__(self)
        self.depth = self.count = 0

    def compose_node(self, parent: Any, index: Any) -> Any:
        event: Any = self.peek_event()
        if isinstance(event, yaml.AliasEvent) or getattr(event, "anchor", None):
            raise _Refused(event.start_mark.line, event.anchor, "expected no anchors and aliases")
        if getattr(event, "tag", None) is not None:
            raise _Refused(event.start_mark.line, event.tag, "expected no tags")
        self.depth += 1
        self.count += 1
        if self.count > MOST:
            raise _Refused(event.start_mark.line, "here", f"expected at most {MOST} values in a file")
        if self.depth > DEEPEST:
            raise _Refused(
                event.start_mark.line,
                event.value if isinstance(event, yaml.ScalarEvent) else "here",
                f"expected at most {DEEPEST} levels of nesting",
            )
        node = super().compose_node(parent, index)
        self.depth -= 1
        return node

    def construct_mapping(self, node: Any, deep: bool = False) -> dict[Any, Any]:
        seen: dict[str, int] = {}
        for key, _ in node.value:
            if not isinstance(key, yaml.ScalarNode) or key.tag != "tag:yaml.org,2002:str":
                what = key.value if isinstance(key, yaml.ScalarNode) else "a list or mapping"
                raise _Refused(key.start_mark.line, what, "expected a text as key")
            if key.value in seen:
                raise _Refused(key.start_mark.line, key.value, f"expected each key once, it stands on line {seen[key.value]} too")
            seen[key.value] = key.start_mark.line + 1
        return super().construct_mapping(node, deep)


_Loader.add_implicit_resolver("tag:yaml.org,2002:bool", re.compile(r"^(?:true|false|True|False)$"), list("tfTF"))
_Loader.add_implicit_resolver("tag:yaml.org,2002:int", re.compile(r"^[-+]?[0-9]+$"), list("-+0123456789"))
_Loader.add_implicit_resolver(
    "tag:yaml.org,2002:float",
    re.compile(
        r"^[-+]?(?:\.[0-9]+|[0-9]+\.[0-9]*|[0-9]+(?=[eE]))(?:[eE][-+]?[0-9]+)?$|^[-+]?\.(?:inf|Inf|INF)$|^\.(?:nan|NaN|NAN)$"
    ),
    list("-+0123456789."),
)


def _number(loader: yaml.CSafeLoader, node: yaml.ScalarNode) -> int:
    text = loader.construct_scalar(node)
    if len(text) > 30:
        raise _Refused(node.start_mark.line, text, "expected a number of at most 30 digits")
    return int(text)


_Loader.add_constructor("tag:yaml.org,2002:int", _number)  # base 10: YAML 1.1 would read 010 as 8


class _Refused(Exception):
    """A line (counted from 0), what stands there, what is allowed."""


def parsed(text: str, where: str) -> object:
    """Plain values (dict, list, str, int, float, bool, None) of YAML `text`.

    Raises:
        BadInput: it is no YAML, repeats a key, or uses what is refused; the field is the line.
    """
    try:
        return yaml.load(text, Loader=_Loader)
    except _Refused as refused:
        line, what, allowed = refused.args
        raise BadInput(where, f"line {line + 1}: {shown(what)}", ABSENT, allowed) from None
    except yaml.MarkedYAMLError as error:
        mark = error.problem_mark or error.context_mark
        line = f"line {min(mark.line, text.count(chr(10))) + 1}" if mark else ""  # libyaml puts an end below the last line
        problem = error.problem or error.context or ""
        if "nesting depth" in problem:  # libyaml 0.2.6 reads ahead and gives up at 1000, before the loader sees an event
            raise BadInput(where, f"{line}: here", ABSENT, f"expected at most {DEEPEST} levels of nesting") from None
        raise BadInput(where, line, ABSENT, f"expected YAML ({problem})") from None
    except yaml.YAMLError as error:
        raise BadInput(where, "", ABSENT, f"expected YAML ({error})") from None
