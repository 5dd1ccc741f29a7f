"""What the product ships: arms and tools by name, and the meshes that go with them. A path in place of a name reads that file."""

import os
from functools import lru_cache
from pathlib import Path

import assets
from app.files.checked import ABSENT, BadInput, load
from app.files.yaml_text import read
from sim.arm.arm_file import Arm
from sim.arm.scenario import ToolModel
from sim.arm_problems import problems

ASSETS = Path(assets.__file__).parent


def robots() -> list[str]:
    """Names of the shipped arms, sorted."""
    return _names("robots")


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


def mesh_path(arm_name: str, link: str) -> Path:
    """The picture of a link: a GLB in the link's joint frame [m]. `link` is "foot" for the fixed base, else its joint's name.

    Raises:
        BadInput: there is none.
    """
    path = ASSETS / "meshes" / arm_name / f"{link}.glb"
    if not path.is_file():
        have = sorted(str(mesh.relative_to(ASSETS / "meshes").with_suffix("")) for mesh in (ASSETS / "meshes").glob("*/*.glb"))
        raise BadInput("meshes", f"{arm_name}/{link}", ABSENT, f"expected one of {', '.join(have)}")
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
    return arm


def _names(folder: str) -> list[str]:
    return sorted(path.stem for path in (ASSETS / folder).glob("*.yaml"))


def _path(name_or_path: str | Path, folder: str, what: str, where: str) -> Path:
    """A shipped name wins over a file of that name; what looks like a path is one, but for that of a folder."""
    text = str(name_or_path)
    if text in _names(folder):
        return ASSETS / folder / f"{text}.yaml"
    path = Path(name_or_path)
    folder_there = os.path.isdir(path)  # noqa: PTH112 - a path's own method raises where a name is too long
    if (path.suffix in (".yaml", ".yml") or len(path.parts) > 1) and not folder_there:
        return path
    raise BadInput(where, what, text, f"expected one of {', '.join(_names(folder))}, or the path of a YAML file")
