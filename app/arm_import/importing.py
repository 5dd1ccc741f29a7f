"""From a description of an arm to an arm file with pictures: read, compared, completed, checked, written."""

from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
import trimesh
from msgspec.structs import replace
from numpy.typing import NDArray

from app.arm_import.agreement import (
    EQUAL,
    KINDS,
    Look,
    check_parsers,
    drawn,
    largest_differences,
    pinocchio_reading,
    written_reading,
)
from app.arm_import.arm_document import completed, usual_name, with_shapes
from app.arm_import.description.link_shapes import LinkShape, ShapeReader
from app.arm_import.description.link_tree import chain_to, tree_of
from app.arm_import.description.robot_xml import describe_arm
from app.arm_import.description.source_arm import MujocoReading, SourceArm, source_arm
from app.arm_import.description.source_files import SourceFolder
from app.arm_import.home_posture import home_posture
from app.arm_import.hull_capsules import Rod, capsules_round, surface_points
from app.arm_import.link_pictures import Painted, picture
from app.arm_import.measured_values import measured
from app.arm_import.size_rules import MEASURE_FIRST, Drive
from app.files.bad_input import ABSENT, BadInput
from app.files.checked import load
from app.files.library import FOOT, MESHES, shipped
from sim.arm.arm_file import Arm
from sim.arm.chain import Body
from sim.arm.frames import file_axes, inertia_numbers, transform
from sim.arm.scenario import ToolModel
from sim.arm_problems import problems

Array = NDArray[np.float64]

COMPARED = 200
"""Postures in which the readings of a file are compared."""

THIN = 0.15
"""Radius of the rod that stands for a link without shapes, over its length."""

LIGHTEST_TOOL = 1e-3
"""What hangs beyond the flange and weighs less is no tool [kg]."""


@dataclass(frozen=True, slots=True)
class Imported:
    """An arm that can be written.

    Attributes:
        arm: with all numbers.
        tool: what hangs beyond the flange; None: nothing.
        pictures: a GLB of each link by its joint's name, and of the foot.
        originals: the description and its meshes, by path.
        assumed: (field, what it does) of what rules have made, in the order in which it is worth measuring.
        told: what was read, locked, dropped and by which rules, a line each.
        measured: fields of measured values.
        postures: in which MuJoCo, Pinocchio and the arm agree.
    """

    arm: Arm
    tool: ToolModel | None
    pictures: dict[str, bytes]
    originals: dict[Path, bytes]
    assumed: list[tuple[str, str]]
    told: list[str]
    measured: list[str] = field(default_factory=list)
    postures: int = COMPARED


def imported(
    file: Path,
    *,
    flange: str | None = None,
    name: str | None = None,
    drive: Drive | None = None,
    within: Path | None = None,
    values: Path | None = None,
) -> Imported:
    """Import the arm of a URDF or MJCF file.

    Args:
        file: the description.
        flange: link or site that tools are mounted on; None: where that is clear.
        name: of the arm; None: that of the description.
        drive: kind of its drives; None: by size.
        within: folder that meshes may be read from; None: that of the file, or of its package.
        values: file of measured values, in the form of an arm file.

    Raises:
        BadInput: it cannot be imported; nothing is written.
    """
    files, where = SourceFolder(file, within), file.name
    description = describe_arm(files)
    chain = chain_to(description, tree_of(description), flange)
    reading = MujocoReading(description, chain)
    source = source_arm(description, chain, reading)
    other = pinocchio_reading(description, chain, reading.text)
    postures = drawn([joint.ends or (-np.pi, np.pi) for joint in source.joints], COMPARED)
    check_parsers(description, reading, other, postures)

    given = {} if values is None else load(values, dict[str, object])
    own_name = name or usual_name(source)
    if shipped(own_name, "robots"):
        raise BadInput("--name", "", own_name, "expected another name: an arm that comes with the product has it")
    done = completed(source, own_name, where, drive=drive, given=given)
    reader = ShapeReader(description)
    shapes = reader.shapes(set(source.frames))
    arm = with_shapes(replace(done.arm, meshes=MESHES), _rods(source, shapes))
    arm, changed = measured(arm, given, values.name) if values is not None else (arm, [])
    for wrong, value, allowed in problems(arm):
        raise BadInput(where, wrong, value, allowed)
    told = [f"flange: {chain.flange}"]
    told += [f"locked as drawn: {', '.join(chain.locked)}"] if chain.locked else []
    told += [f"not of this arm: {', '.join(sorted(chain.aside))}"] if chain.aside else []
    told += [*reader.told, *done.told]
    home = home_posture(arm, None if source.home is None else source.home.tolist())
    if home is not None and "chain.home" not in changed:
        arm = replace(arm, chain=replace(arm.chain, home=home.q))
    told.append(f"chain.home: {'no posture without collisions was found, look at it' if home is None else home.told}")
    if not any(each.startswith(("chain.", "masses.", "inertias.")) for each in changed):
        _check_written(where, reading.look, arm, tool=source.tool, postures=postures)
    fields = [(each, does) for each, does in MEASURE_FIRST.items() if _is_assumed(each, done.assumed, changed)]
    tool = _tool(f"{own_name}-tool", source, shapes)
    return Imported(arm, tool, _pictures(arm, source, shapes), files.read, fields, told, changed)


def _is_assumed(name: str, by_rule: list[str], changed: list[str]) -> bool:
    """Whether a rule has made the field: of what a file may say that which it does not, of the rest all."""
    if any(each == name or each.startswith(f"{name}.") for each in changed):
        return False
    return name in by_rule or not name.startswith(("limits.", "payload", "motors.rotor_inertia"))


def _rods(source: SourceArm, shapes: list[LinkShape]) -> dict[int, list[Rod]]:
    """Capsules round each link, -1 the foot: of what touches, else of what is drawn; of nothing, a rod to the next joint."""
    found: dict[int, list[Rod]] = {}
    for k in range(-1, len(source.joints)):
        own = _meshes(source, shapes, k, touching=True)
        if own:
            found[k] = capsules_round(surface_points(own))
        elif k >= 0:
            end = source.placements[k + 1][:3, 3]
            length = float(np.linalg.norm(end))
            if length > 0.0:
                found[k] = [(np.zeros(3), end, min(max(THIN * length, 0.005), 0.06))]
    return found


def _meshes(source: SourceArm, shapes: list[LinkShape], k: int, *, touching: bool) -> list[trimesh.Trimesh]:
    """Meshes of link k in its frame; `touching`: those that touch, or what is drawn where none does."""
    here = [shape for shape in shapes if source.frames[shape.link][0] == k]
    wanted = [shape for shape in here if (shape.touches if touching else shape.drawn)] or here
    return [shape.mesh.copy().apply_transform(source.frames[shape.link][1]) for shape in wanted]


def _pictures(arm: Arm, source: SourceArm, shapes: list[LinkShape]) -> dict[str, bytes]:
    """A GLB of each link in its joint frame; of links without a shape none."""
    found: dict[str, bytes] = {}
    for k, name in enumerate([FOOT, *arm.chain.joints], -1):
        here = [shape for shape in shapes if source.frames[shape.link][0] == k]
        drawn = [shape for shape in here if shape.drawn] or here
        turn = np.eye(4) if k < 0 else transform(file_axes(arm, k), np.zeros(3))
        parts: list[Painted] = [
            (shape.mesh.copy().apply_transform(turn @ source.frames[shape.link][1]), shape.colour) for shape in drawn
        ]
        if parts:
            found[name] = picture(parts)
    return found


def _tool(name: str, source: SourceArm, shapes: list[LinkShape]) -> ToolModel | None:
    """What hangs beyond the flange, as a tool: as long and as wide as its shapes, its centre point at their end."""
    body = source.tool
    if body.mass < LIGHTEST_TOOL:
        return None
    meshes = _meshes(source, shapes, len(source.joints), touching=True)
    corners = np.vstack([mesh.vertices for mesh in meshes]) if meshes else np.zeros((1, 3))
    length = float(np.clip(corners[:, 2].max(), 0.0, 1.0))
    radius = float(np.clip(np.abs(corners[:, :2]).max(axis=0).min(), 0.01, 0.3))
    rounded = round(length, 4)
    return ToolModel(
        name=name,
        mass=body.mass,
        com=body.com.tolist(),
        inertia=inertia_numbers(body.inertia),
        tcp=[0.0, 0.0, rounded],
        length=rounded,
        radius=round(radius, 4),
    )


def _check_written(where: str, look: Look, arm: Arm, *, tool: Body, postures: Array) -> None:
    """Raise BadInput where the arm is not the one that was read; measured masses and lengths are meant to be others."""
    found = largest_differences(look, written_reading(arm, tool), postures)
    for kind, difference in zip(KINDS, found, strict=True):
        if difference > EQUAL:
            raise BadInput(where, kind, ABSENT, f"the arm file and MuJoCo differ by {difference:.2g} of the largest value")
