"""Descriptions by name: of the package robot-descriptions, of a copy of MuJoCo Menagerie, and the one that a folder holds."""

import importlib
import os
import re
from importlib.util import find_spec
from pathlib import Path
from typing import NamedTuple

from app.files.bad_input import BadInput

PACKAGE = "robot_descriptions"
NAME = re.compile(r"[a-z][a-z0-9_]*_description")
"""A module of that package; it takes the description from its cache, or clones its repository."""

MENAGERIE = "MENAGERIE_ROOT"
"""Environment variable of the package mujoco-menagerie: folder of a local copy."""


class NamedDescription(NamedTuple):
    """A description, and the folder that its meshes may be read from; None: as beside a file."""

    file: Path
    within: Path | None = None


def named_description(said: Path) -> NamedDescription:
    """The description that a user means: a file; the one of a folder; or, where there is neither, a name of robot-descriptions or
    of a folder of MuJoCo Menagerie.

    Raises:
        BadInput: the folder holds none or some, robot-descriptions is not installed or has no such description.
    """
    name = str(said)
    if said.is_dir():
        return NamedDescription(_of_folder(said))
    if said.exists():
        return NamedDescription(said)
    if NAME.fullmatch(name):
        return _of_package(name)
    root = os.environ.get(MENAGERIE, "")
    if root and re.fullmatch(r"\w+", name) and (Path(root) / name).is_dir():
        return NamedDescription(_of_folder(Path(root) / name))
    return NamedDescription(said)


def _of_folder(folder: Path) -> Path:
    """The arm's description in a folder, as Menagerie lays them: what is called scene only puts an arm into a room."""
    found = [path for path in sorted(folder.iterdir()) if path.suffix in (".xml", ".urdf")]
    arms = [path for path in found if not path.stem.startswith("scene") and path.name != "package.xml"]
    if len(arms) != 1:
        have = ", ".join(path.name for path in arms) or "none"
        raise BadInput("FILE", "", str(folder), f"expected a folder with one description; it has {have}: name the file")
    return arms[0]


def _of_package(name: str) -> NamedDescription:
    """Where robot-descriptions has it: URDF before MJCF, as the former says speeds and torques."""
    if find_spec(PACKAGE) is None:
        raise BadInput(
            "FILE", "", name, "expected a file; for names of robot-descriptions install it: pip install robot-descriptions"
        )
    if find_spec(f"{PACKAGE}.{name}") is None:
        raise BadInput("FILE", "", name, "expected a file, or a name of robot-descriptions: it has none of this name")
    try:
        module = importlib.import_module(f"{PACKAGE}.{name}")
    except Exception as error:  # noqa: BLE001 - it clones with git, which fails in many ways
        reason = " ".join(str(error).split())[:200] or type(error).__name__
        raise BadInput("FILE", "", name, f"robot-descriptions cannot give it: {reason}") from None
    path = getattr(module, "URDF_PATH", None) or getattr(module, "MJCF_PATH", None)
    if path is None:
        raise BadInput("FILE", "", name, "robot-descriptions has it as a macro alone: expand it first (xacro FILE > arm.urdf)")
    return NamedDescription(Path(path), Path(module.REPOSITORY_PATH))
