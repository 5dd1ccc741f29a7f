"""The XML of a description as a tree, with nothing left in it that would read a file or run wild."""

import math
from pathlib import Path
from typing import Literal, NamedTuple
from xml.etree.ElementTree import Element, TreeBuilder
from xml.parsers import expat

from app.arm_import.description.source_files import SourceFolder
from app.files.bad_input import ABSENT, BadInput

MOST_ELEMENTS = 50_000
"""In a description: the largest humanoids of public collections have 5,000."""

DEEPEST = 100
"""Nesting of elements: below what the recursion of parsers bears."""

TEXTS = {"name", "class", "childclass", "file", "filename", "mesh", "material", "joint", "body", "site", "link", "type", "model"}
"""Attributes that hold words: a name may be "nan"."""

REFUSED = ("attach", "replicate", "composite", "flexcomp", "plugin")
"""Elements of MJCF that make bodies of other files or of rules; their bodies have no place in the tree of the text."""


class Description(NamedTuple):
    """A description of an arm."""

    kind: Literal["URDF", "MJCF"]
    root: Element
    files: SourceFolder


def describe_arm(files: SourceFolder) -> Description:
    """Read a description, with what it includes in place.

    Raises:
        BadInput: it is no URDF or MJCF, is too large, or holds what is never taken: a document type, entities, circles of
            includes, numbers that are not finite.
    """
    name = files.file.name
    root = _tree(files.text(files.file, ""), name)
    kinds: dict[str, Literal["URDF", "MJCF"]] = {"robot": "URDF", "mujoco": "MJCF"}
    if root.tag not in kinds:
        raise BadInput(name, "", root.tag, "expected a <robot> of URDF or a <mujoco> of MJCF")
    kind = kinds[root.tag]
    if kind == "MJCF":
        _include(root, files, [files.file])
        _name_all(root)
    for element in root.iter():
        if kind == "URDF" and ("xacro" in element.tag or "${" in "".join(element.attrib.values())):
            raise BadInput(name, _place(element), ABSENT, "is a macro of xacro: expand it first (xacro FILE > arm.urdf)")
        if kind == "MJCF" and element.tag in REFUSED:
            raise BadInput(name, _place(element), ABSENT, f"<{element.tag}> cannot be imported: save the compiled model first")
        _finite(element, name)
    return Description(kind, root, files)


def _tree(text: str, name: str) -> Element:
    """The elements of a text, without a document type: what that can do, entities and other files, no arm needs."""
    builder = TreeBuilder()
    depth = count = 0

    def begin(tag: str, attributes: dict[str, str]) -> None:
        nonlocal depth, count
        depth, count = depth + 1, count + 1
        if depth > DEEPEST or count > MOST_ELEMENTS:
            raise BadInput(name, tag, ABSENT, f"expected at most {MOST_ELEMENTS} elements, {DEEPEST} deep")
        builder.start(tag, attributes)

    def end(tag: str) -> None:
        nonlocal depth
        depth -= 1
        builder.end(tag)

    def refuse(*_: object) -> None:
        raise BadInput(name, "", ABSENT, "expected no document type and no entities")

    parser = expat.ParserCreate()
    parser.StartElementHandler, parser.EndElementHandler = begin, end
    parser.StartDoctypeDeclHandler = parser.EntityDeclHandler = refuse
    try:
        parser.Parse(text, True)
        return builder.close()
    except expat.ExpatError as error:
        raise BadInput(name, f"line {error.lineno}", ABSENT, f"expected XML ({expat.ErrorString(error.code)})") from None


def _include(element: Element, files: SourceFolder, within: list[Path]) -> None:
    """Put the elements of included files in place of the includes. MuJoCo takes a path relative to the main file."""
    for place, child in reversed(list(enumerate(element))):
        if child.tag != "include":
            _include(child, files, within)
            continue
        path = files.find(child.get("file", ""), files.file.parent, "include.file")
        if path in within:
            raise BadInput(files.file.name, "include.file", child.get("file"), "expected includes without a circle")
        if len(within) > DEEPEST:
            raise BadInput(files.file.name, "include.file", child.get("file"), f"expected includes at most {DEEPEST} deep")
        part = _tree(files.text(path, "include.file"), path.name)
        _include(part, files, [*within, path])
        element[place : place + 1] = list(part)
        if sum(1 for _ in element.iter()) > MOST_ELEMENTS:
            raise BadInput(files.file.name, "include.file", child.get("file"), f"expected at most {MOST_ELEMENTS} elements")


def _name_all(root: Element) -> None:
    """Give a name to bodies and joints of MJCF that have none: its parsers and our messages speak of them by name."""
    taken = {element.get("name") for element in root.iter()}
    for world in root.findall("worldbody"):
        for kind in ("body", "joint"):
            for k, element in enumerate(world.iter(kind)):
                if element.get("name") is None:
                    own = f"{kind}{k}"
                    while own in taken:
                        own += "_"
                    taken.add(own)
                    element.set("name", own)


def _finite(element: Element, name: str) -> None:
    for key, value in element.attrib.items():
        if key in TEXTS:
            continue
        for word in value.split():
            try:
                number = float(word)
            except ValueError:
                continue
            if not math.isfinite(number):
                raise BadInput(name, f"{_place(element)}.{key}", value, "expected finite numbers")


def _place(element: Element) -> str:
    own = element.get("name")
    return element.tag if own is None else f"{element.tag} {own}"
