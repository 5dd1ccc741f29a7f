"""Session files: what to simulate, what happens when, and what is expected of it. The schema; `prepare` checks and uses it."""

from pathlib import Path
from typing import Annotated, Any, Literal, NamedTuple, TypeVar

import msgspec
from msgspec import Meta

from app.files.checked import ABSENT, BadInput, load
from app.files.library import ASSETS, shipped
from app.files.regular_file import is_something
from app.session.actions import AnyAction, Walls
from app.session.expectations import AnyExpectation
from pendant.equipment.load import Angles
from pendant.equipment.tools import MOST as MOST_TOOLS
from pendant.program.steps import Program
from pendant.settings.bounds import MOST_JOINTS, MOST_OBJECTS, MOST_STEPS, Angle, Text
from sim.arm.arm_file import Arm
from sim.arm.scenario import AnyObject, Load, Mismatch, ToolModel

Posture = Annotated[list[Angle], Meta(max_length=MOST_JOINTS)]
Claims = Annotated[list[Text], Meta(max_length=MOST_STEPS)]
Tools = Annotated[list[ToolModel], Meta(max_length=MOST_TOOLS)]
World = Annotated[list[AnyObject], Meta(max_length=MOST_OBJECTS)]


class Setup(msgspec.Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """What to simulate: the header of a session, and the whole of a configuration file for `pendant serve --config`."""

    robot: Text = "ur5e"
    mounting: Literal["floor", "wall", "ceiling"] | Angles = "floor"  # or roll, pitch, yaw of B in W [rad]
    posture: Posture | None = None  # joint angles at the start; None: the arm's home [rad]
    tool: ToolModel | Text | None = None  # or the name of a shipped tool, or a path
    tools: Tools = []  # to choose from on the pendant, beside those shipped
    payload_true: Load = msgspec.field(default_factory=lambda: Load(mass=0.0))
    payload_configured: Load = msgspec.field(default_factory=lambda: Load(mass=0.0))
    settings: dict[str, float | bool | str] = {}  # overrides, by dotted name
    features: dict[str, Literal["on", "off"]] = {}  # by requirement id
    seed: Annotated[int, Meta(ge=0, le=2**31 - 1)] = 0
    mismatch: Mismatch = "on"  # errors as large as the arm's file states, none, or so many times as large
    soft_sensor: bool = False  # the flange sensor has its soft stiffness, for demonstration (CD-17)
    self_contact: bool = False  # the tool can touch the arm's own links (CD-2)
    world: World | Text = []  # objects, or the name of a bundled world
    walls: Walls = []  # virtual walls and areas, beside the tether (docs/guide/walls.md)


FIRST_START = Setup(world="table", self_contact=True)
"""What the page begins with where nothing else is said or kept: something to touch stands in front of the arm, which touches
itself, too."""


class Session(Setup, frozen=True, kw_only=True):
    """A scripted session."""

    title: Text
    watch: Text = ""  # what to look at, in two sentences; the page offers sessions that say it as scenarios
    duration: Annotated[float, Meta(ge=0.002, le=3600)]  # [s]
    claims: Claims = []  # that this session shows, by their names (app/session/claims.py)
    switch: str | None = None  # the feature, or setting that is true or false or a choice, without which it must fail
    program: Program | None = None  # loaded at the start
    timeline: Annotated[list[AnyAction], Meta(max_length=MOST_STEPS)] = []
    expectations: Annotated[list[AnyExpectation], Meta(max_length=MOST_STEPS)] = []


class WorldSection(msgspec.Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """A bundled world."""

    title: Text
    objects: World


KINDS: dict[str, type[Any]] = {"session": Session, "configuration": Setup, "robot": Arm, "tool": ToolModel}
"""The kinds of files that people write."""

T = TypeVar("T", bound=Setup)


def schema_of(kind: str, of: type[Any]) -> str:
    """The JSON schema of a kind of file, as text; `of` is its type, as in KINDS."""
    found = {"$schema": "https://json-schema.org/draft/2020-12/schema", "title": f"pendant {kind}"}
    return msgspec.json.format(msgspec.json.encode(found | msgspec.json.schema(of)), indent=1).decode() + "\n"


def folder(kind: str) -> Path:
    """The folder of bundled files of a kind: "sessions" or "worlds"."""
    return ASSETS / kind


def bundled(kind: str) -> list[str]:
    """Names of the bundled files of a kind, sorted."""
    return sorted(path.stem for path in folder(kind).glob("*.yaml"))


def find(name: str) -> Path:
    """The file that `name` means: a path, or the name of a bundled session.

    Raises BadInput: neither is there.
    """
    path = Path(name)
    if is_something(path):
        return path
    if name in bundled("sessions"):
        return folder("sessions") / f"{name}.yaml"
    raise BadInput(name, "", ABSENT, f"no such file; bundled sessions: {', '.join(bundled('sessions'))}")


def find_all(name: str) -> list[Path]:
    """The files that `name` means: those of a folder, sorted, or what `find` finds.

    Raises:
        BadInput: nothing is there.
    """
    path = Path(name)
    if not path.is_dir():
        return [find(name)]
    found = sorted([*path.glob("*.yaml"), *path.glob("*.yml")])
    if not found:
        raise BadInput(name, "", ABSENT, "no session in this folder; expected files that end in .yaml")
    return found


def opened(path: Path, kind: type[T], anywhere: bool = False) -> T:
    """The session or configuration at `path`, with the arm and the tool that it names found.

    Args:
        path: of the file.
        kind: Session or Setup.
        anywhere: files that it names may be anywhere on this machine.

    Raises:
        BadInput: as `load`; or it names a file that is neither in its folder nor below.
    """
    return located(load(path, kind), AllowedFiles(path.parent.resolve(), anywhere), path.name)


class AllowedFiles(NamedTuple):
    """The files that a set-up may name, beside the names of what is shipped."""

    folder: Path | None = None  # and below; None: none
    anywhere: bool = False  # on this machine


SHIPPED_ALONE = AllowedFiles()


def located(setup: T, files: AllowedFiles, where: str) -> T:
    """A set-up with the files of arm and tool that it names found. Raises BadInput: it names one that it may not name."""
    found: dict[str, str] = {}
    for field, library in (("robot", "robots"), ("tool", "tools")):
        name = getattr(setup, field)
        if isinstance(name, str) and not shipped(name, library):
            found[field] = _within(files, name, field=field, where=where)
    return msgspec.structs.replace(setup, **found)


def _within(files: AllowedFiles, name: str, *, field: str, where: str) -> str:
    try:
        path = ((files.folder or Path()) / name).resolve()
        allowed = files.anywhere or (files.folder is not None and path.is_relative_to(files.folder))
        there = allowed and path.exists()
    except (OSError, ValueError):  # a circle of links, a NUL, a name that is too long
        raise BadInput(where, field, name, "the name of a file") from None
    if not allowed:
        inside = "a shipped one" if files.folder is None else "a file in the folder of this one or below"
        raise BadInput(where, field, name, f"{inside}; with --any-file it may be anywhere")
    return str(path) if there else name
