"""What the product ships: arms and tools by name, and the meshes that go with them. A path in place of a name reads that file."""

import os
from functools import lru_cache
from pathlib import Path

from msgspec.structs import replace

import assets
from app.files.checked import ABSENT, BadInput, load
from app.files.yaml_text import read
from sim.arm.arm_file import Arm
from sim.arm.scenario import ToolModel
from sim.arm_problems import problems

ASSETS = Path(assets.__file__).parent

FOOT = "foot"
"""Name of the fixed base's picture; those of links have their joints' names."""

MESHES = "meshes"
"""Folder of an imported arm's pictures, beside its file."""


def robots() -> list[str]:
    """Names of the shipped arms, sorted."""
    return _names("robots")


def own_arms() -> Path:
    """The folder of the user's own arms (XDG base directory specification): a folder each, as `pendant import` writes it."""
    base = os.environ.get("XDG_DATA_HOME", "")
    return (Path(base) if base.startswith("/") else Path.home() / ".local" / "share") / "pendant" / "arms"


def own_robots() -> list[str]:
    """Names of the user's own arms, sorted; one that has the name of a shipped arm is not found by its name."""
    found = {path.stem for path in own_arms().glob("*/*.yaml") if path.stem == path.parent.name}
    return sorted(found - set(robots()))


def tools() -> list[str]:
    """Names of the shipped tools, sorted."""
    return _names("tools")


def load_arm(name_or_path: str | Path, where: str = "robots") -> Arm:
    """The arm of that name, or of the file at that path; `where` names the file or option that asks for it.

    Raises:
        BadInput: no such arm, or its file does not make sense.
    """
    path = _path(name_or_path, "robots", "robot", where)
    return _arm(path, read(path, path.name))


def load_tool(name_or_path: str | Path, where: str = "tools") -> ToolModel:
    """The tool of that name, or of the file at that path; `where` names the file or option that asks for it.

    Raises:
        BadInput: no such tool, or its file does not make sense.
    """
    path = _path(name_or_path, "tools", "tool", where)
    return _tool(path, read(path, path.name))


def mesh_path(arm: Arm, link: str) -> Path:
    """The picture of a link: a GLB in the link's joint frame [m]. `link` is "foot" for the fixed base, else its joint's name.

    Raises:
        BadInput: there is none.
    """
    folder = Path(arm.meshes) if arm.meshes else ASSETS / "meshes" / arm.name
    path = folder / f"{link}.glb"
    if not path.is_file():
        have = ", ".join(sorted(f"{folder.name}/{mesh.stem}" for mesh in folder.glob("*.glb")))
        raise BadInput("meshes", f"{arm.name}/{link}", ABSENT, f"expected one of {have or 'none: nobody drew them'}")
    return path


def shipped(name: str, folder: str) -> bool:
    """Whether `name` is one of those that the product ships in a folder of its library, "robots" or "tools"."""
    return name in _names(folder)


@lru_cache(maxsize=64)
def _tool(path: Path, _text: str) -> ToolModel:
    """As `_arm`."""
    return load(path, ToolModel)


@lru_cache(maxsize=16)
def _arm(path: Path, _text: str) -> Arm:
    """Read once a process, as every session needs it; `_text` is what the file says, so that a changed one is read anew."""
    arm = load(path, Arm)
    for field, value, allowed in problems(arm):
        raise BadInput(path.name, field, value, allowed)
    if not arm.meshes:
        return arm
    folder = (path.parent / arm.meshes).resolve()
    if not folder.is_relative_to(path.parent.resolve()):
        raise BadInput(path.name, "meshes", arm.meshes, "expected a folder beside the file")
    return replace(arm, meshes=str(folder))


def _names(folder: str) -> list[str]:
    return sorted(path.stem for path in (ASSETS / folder).glob("*.yaml"))


def _path(name_or_path: str | Path, folder: str, what: str, where: str) -> Path:
    """A shipped name, then that of an arm of the user's own, wins over a file of that name.

    What looks like a path is one, but for that of a folder.
    """
    text = str(name_or_path)
    if text in _names(folder):
        return ASSETS / folder / f"{text}.yaml"
    if folder == "robots" and text in own_robots():
        return own_arms() / text / f"{text}.yaml"
    path = Path(name_or_path)
    folder_there = os.path.isdir(path)  # noqa: PTH112 - a path's own method raises where a name is too long
    if (path.suffix in (".yaml", ".yml") or len(path.parts) > 1) and not folder_there:
        return path
    own = own_robots() if folder == "robots" else []
    raise BadInput(where, what, text, f"expected one of {', '.join([*_names(folder), *own])}, or the path of a YAML file")
