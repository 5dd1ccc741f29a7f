"""Session files: what to simulate, what happens when, and what is expected of it. The schema; `prepare` checks and uses it."""

from pathlib import Path
from typing import Annotated, Literal

import msgspec
from msgspec import Meta

from app.files.checked import ABSENT, BadInput
from app.files.library import ASSETS
from app.session.actions import AnyAction
from app.session.expectations import AnyExpectation
from pendant.program.steps import Program
from pendant.walls.definitions import AnyBorder
from sim.arm.scenario import AnyObject, Load, ToolModel, Vector


class Setup(msgspec.Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """What to simulate: the header of a session, and the whole of a configuration file for `pendant serve --config`."""

    robot: str = "ur5e"
    mounting: Literal["floor", "wall", "ceiling"] | Vector = "floor"  # or roll, pitch, yaw of B in W [rad]
    posture: list[float] | None = None  # joint angles at the start; None: the arm's home [rad]
    tool: ToolModel | str | None = None  # or the name of a shipped tool, or a path
    tools: list[ToolModel] = []  # to choose from on the pendant, besides those shipped
    payload_true: Load = msgspec.field(default_factory=lambda: Load(mass=0.0))
    payload_configured: Load = msgspec.field(default_factory=lambda: Load(mass=0.0))
    settings: dict[str, float | bool | str] = {}  # overrides, by dotted name
    features: dict[str, Literal["on", "off"]] = {}  # by requirement id
    seed: Annotated[int, Meta(ge=0, le=2**31 - 1)] = 0
    mismatch: Literal["on", "nominal"] = "on"
    soft_sensor: bool = False  # the flange sensor has its soft stiffness, for demonstration (CD-17)
    world: list[AnyObject] | str = []  # objects, or the name of a bundled world
    walls: list[AnyBorder] = []  # virtual walls and areas, besides the tether (docs/guide/walls.md)


class Session(Setup, frozen=True, kw_only=True):
    """A scripted session."""

    title: str
    watch: str = ""  # what to look at, in two sentences; the page offers sessions that say it as scenarios
    duration: Annotated[float, Meta(gt=0, le=3600)]  # [s]
    claims: list[str] = []  # rows of `pendant claims` that this session shows (app/session/claims.py)
    switch: str | None = None  # the feature, or setting that is true or false or a choice, without which it must fail
    program: Program | None = None  # loaded at the start
    timeline: list[AnyAction] = []
    expectations: list[AnyExpectation] = []


class WorldSection(msgspec.Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """A bundled world."""

    title: str
    objects: list[AnyObject]


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
    if path.is_file():
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
