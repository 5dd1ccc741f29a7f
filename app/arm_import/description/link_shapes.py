"""The shapes of an arm's links: primitives and meshes of the description, where they are, and what they are for."""

import io
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from xml.etree.ElementTree import Element

import mujoco
import numpy as np
import trimesh
from numpy.typing import NDArray

from app.arm_import.description.link_tree import WORLD, parsed_spec
from app.arm_import.description.robot_xml import Description
from app.files.bad_input import ABSENT, BadInput
from sim.arm.frames import matrix_from_quaternion, rotation_from_rpy, transform

Array = NDArray[np.float64]

LARGEST_SHAPE = 5.0
"""Extent of a mesh [m]; what is larger is in millimetres."""

MOST_FACES = 5_000_000
"""Triangles of all meshes of an arm."""

DRAWN_GROUP = 2
"""Groups of MJCF's geoms that its viewer shows: up to this one."""

GREY = (0.72, 0.73, 0.75, 1.0)

STAND_IN = [0.0, 0.0, 0.0, 0.03, 0.0, 0.0, 0.0, 0.02, 0.0, 0.0, 0.0, 0.01]
"""Corners of the small body that stands for a mesh [m]; no two of its moments are alike."""


@dataclass(frozen=True, slots=True)
class LinkShape:
    """A shape in the frame of a link of the description [m]."""

    link: str
    mesh: trimesh.Trimesh
    drawn: bool
    touches: bool
    colour: tuple[float, float, float, float]


class ShapeReader:
    """Reads the shapes of a description."""

    def __init__(self, arm: Description) -> None:
        self._missed: dict[str, list[str]] = {}
        self._arm, self._where, self._faces = arm, arm.files.file.name, 0
        self._meshes: dict[tuple[Path, tuple[float, ...]], trimesh.Trimesh | None] = {}

    def shapes(self, links: set[str]) -> list[LinkShape]:
        """The shapes of these links. Raises BadInput: a mesh is missing, outside of the folder, too large or none."""
        found = list(self._urdf(links) if self._arm.kind == "URDF" else self._mjcf(links))
        for shape in found:
            if not np.isfinite(shape.mesh.vertices).all():
                raise BadInput(self._where, f"mesh of {shape.link}", ABSENT, "expected finite numbers")
        return found

    @property
    def told(self) -> list[str]:
        """What could not be read, and is done without, a line a reason."""
        return [
            f"{len(names)} meshes not read, as {why}: {', '.join(sorted(set(names))[:4])} ..."
            for why, names in self._missed.items()
        ]

    def _urdf(self, links: set[str]) -> Iterator[LinkShape]:
        paints = {paint.get("name"): paint.find("color") for paint in self._arm.root.findall("material")}
        for link in self._arm.root.findall("link"):
            name = link.get("name", "")
            if name not in links:
                continue
            for role in ("visual", "collision"):
                for part in link.findall(role):
                    mesh = self._urdf_mesh(part, f"link {name}.{role}")
                    if mesh is None:
                        continue
                    paint = part.find("material")
                    own = None if paint is None else paint.find("color")
                    shade = own if own is not None or paint is None else paints.get(paint.get("name"))
                    colour = _colour(None if shade is None else shade.get("rgba"))
                    yield LinkShape(name, mesh, role == "visual", role == "collision", colour)

    def _urdf_mesh(self, part: Element, field: str) -> trimesh.Trimesh | None:
        geometry = part.find("geometry")
        kind = None if geometry is None or not len(geometry) else geometry[0]
        if kind is None:
            return None
        if kind.tag == "mesh":
            path = self._arm.files.find(kind.get("filename", ""), self._arm.files.file.parent, f"{field}.mesh")
            mesh = self._load(path, _numbers(kind, "scale", "1 1 1", where=self._where), f"{field}.mesh")
        else:
            mesh = self._primitive(kind, field)
        origin = part.find("origin")
        if mesh is None or origin is None:
            return mesh
        xyz, rpy = (_numbers(origin, key, "0 0 0", where=self._where) for key in ("xyz", "rpy"))
        return mesh.copy().apply_transform(transform(rotation_from_rpy(rpy), xyz))

    def _primitive(self, kind: Element, field: str) -> trimesh.Trimesh | None:
        if kind.tag == "box":
            return trimesh.creation.box(self._size(kind, "size", 3, field))
        if kind.tag == "sphere":
            return trimesh.creation.icosphere(subdivisions=2, radius=self._size(kind, "radius", 1, field)[0])
        if kind.tag in ("cylinder", "capsule"):
            radius, length = (self._size(kind, key, 1, field)[0] for key in ("radius", "length"))
            make = trimesh.creation.cylinder if kind.tag == "cylinder" else trimesh.creation.capsule
            mesh = make(radius=radius, height=length)
            if kind.tag == "capsule":
                mesh.apply_translation([0.0, 0.0, -mesh.bounds.mean(axis=0)[2]])
            return mesh
        raise BadInput(self._where, field, kind.tag, "expected a box, cylinder, sphere, capsule or mesh")

    def _size(self, kind: Element, key: str, number: int, field: str) -> Array:
        values = _numbers(kind, key, "", number=number, where=self._where)
        if not (values > 0.0).all() or values.max() > LARGEST_SHAPE:
            raise BadInput(self._where, f"{field}.{key}", kind.get(key), f"expected more than 0 and at most {LARGEST_SHAPE:g} m")
        return values

    def _mjcf(self, links: set[str]) -> Iterator[LinkShape]:
        arm, spec = self._arm, parsed_spec(self._arm)
        files = {_mesh_name(mesh): (mesh.file, np.array(mesh.scale)) for mesh in spec.meshes}
        paints = {paint.name: np.array(paint.rgba) for paint in spec.materials}
        geoms = _placed(spec)
        try:
            model = spec.compile()
        except ValueError as error:
            raise BadInput(
                self._where, "geom", ABSENT, f"MuJoCo cannot read its shapes: {' '.join(str(error).split())}"
            ) from None
        meshdir = _mesh_folder(arm)
        for number, geom in enumerate(geoms):
            name = geom.parent.name
            if name not in links or name == WORLD:
                continue
            place = model.geom(f"shape{number}")
            pose = transform(matrix_from_quaternion(place.quat), place.pos)
            if geom.type == mujoco.mjtGeom.mjGEOM_MESH:
                file, scale = files[geom.meshname]
                if not file:
                    continue
                mesh = self._load(arm.files.find(file, meshdir, f"mesh {geom.meshname}"), scale, f"mesh {geom.meshname}")
                k = model.mesh(geom.meshname).id
                pose = pose @ np.linalg.inv(transform(matrix_from_quaternion(model.mesh_quat[k]), model.mesh_pos[k]))
            else:
                mesh = _mjcf_primitive(geom.type, np.array(place.size))
            if mesh is not None:
                touches = bool(geom.contype or geom.conaffinity)
                rgba = np.array(paints.get(geom.material, geom.rgba))
                colour = tuple(float(each) for each in rgba.tolist())
                yield LinkShape(name, mesh.copy().apply_transform(pose), geom.group <= DRAWN_GROUP, touches, colour)  # type: ignore[arg-type]

    def _load(self, path: Path, scale: Array, field: str) -> trimesh.Trimesh | None:
        key = (path, tuple(scale.tolist()))
        if key not in self._meshes:
            self._meshes[key] = self._read(path, scale, field)
        return self._meshes[key]

    def _read(self, path: Path, scale: Array, field: str) -> trimesh.Trimesh | None:
        data, kind = self._arm.files.mesh(path, field), path.suffix.lower().removeprefix(".")
        if kind not in ("stl", "obj", "ply", "off", "glb", "dae"):
            self._missed.setdefault(f".{kind} is no form of mesh that is known", []).append(path.name)
            return None
        try:
            # From bytes, without a resolver: a mesh that names other files gets none of them.
            loaded = trimesh.load_mesh(io.BytesIO(data), file_type=kind, process=False, skip_materials=True)
        except ImportError:
            self._missed.setdefault("COLLADA needs `pip install pycollada`", []).append(path.name)
            return None
        except Exception as error:  # noqa: BLE001 - readers of meshes raise whatever the bytes lead to
            raise BadInput(path.name, field, ABSENT, f"expected a mesh ({' '.join(str(error).split())[:120]})") from None
        if not isinstance(loaded, trimesh.Trimesh) or not len(loaded.faces):
            raise BadInput(path.name, field, ABSENT, "expected a mesh of triangles")
        self._faces += len(loaded.faces)
        if self._faces > MOST_FACES:
            raise BadInput(path.name, field, self._faces, f"expected meshes of at most {MOST_FACES} triangles together")
        mesh = trimesh.Trimesh(np.asarray(loaded.vertices) * scale, loaded.faces, process=False)
        size = float(np.ptp(mesh.bounds, axis=0).max())
        if not size <= LARGEST_SHAPE:
            allowed = f"expected at most {LARGEST_SHAPE:g} m: is it in millimetres, and a scale of 0.001 missing?"
            raise BadInput(path.name, field, f"{size:g} m", allowed)
        return mesh


def _numbers(element: Element, key: str, usual: str, *, where: str, number: int = 3) -> Array:
    said = element.get(key, usual)
    try:
        values = np.array([float(word) for word in said.split()])
    except ValueError:
        values = np.zeros(0)
    if values.size != number:
        raise BadInput(where, f"{element.tag}.{key}", said, f"expected {number} numbers")
    return values


def _colour(said: str | None) -> tuple[float, float, float, float]:
    try:
        r, g, b, a = (min(max(float(word), 0.0), 1.0) for word in (said or "").split())
    except ValueError:
        return GREY
    return r, g, b, a


def _mesh_name(mesh: mujoco.MjsMesh) -> str:
    return mesh.name or Path(mesh.file).stem


def _mesh_folder(arm: Description) -> Path:
    said = ""
    for compiler in arm.root.findall("compiler"):
        said = compiler.get("meshdir", compiler.get("assetdir", said))
    return arm.files.file.parent / said


def _solid(geom: mujoco.MjsGeom) -> bool:
    return geom.type in (
        mujoco.mjtGeom.mjGEOM_SPHERE,
        mujoco.mjtGeom.mjGEOM_CAPSULE,
        mujoco.mjtGeom.mjGEOM_ELLIPSOID,
        mujoco.mjtGeom.mjGEOM_CYLINDER,
        mujoco.mjtGeom.mjGEOM_BOX,
        mujoco.mjtGeom.mjGEOM_MESH,
    )


def _mjcf_primitive(kind: mujoco.mjtGeom, size: Array) -> trimesh.Trimesh | None:
    if kind == mujoco.mjtGeom.mjGEOM_BOX:
        return trimesh.creation.box(2.0 * size)
    if kind == mujoco.mjtGeom.mjGEOM_CYLINDER:
        return trimesh.creation.cylinder(radius=size[0], height=2.0 * size[1])
    if kind == mujoco.mjtGeom.mjGEOM_CAPSULE:
        mesh = trimesh.creation.capsule(radius=size[0], height=2.0 * size[1])
        return mesh.apply_translation([0.0, 0.0, -mesh.bounds.mean(axis=0)[2]])
    radii = np.full(3, size[0]) if kind == mujoco.mjtGeom.mjGEOM_SPHERE else size
    return trimesh.creation.icosphere(subdivisions=2).apply_scale(radii)


def _placed(spec: mujoco.MjSpec) -> list[mujoco.MjsGeom]:
    """Name the solid geoms and make `spec` compile without files, joints and what needs them.

    One small body stands for each mesh: where MuJoCo puts it says where it puts the mesh.
    """
    for things in (spec.sensors, spec.actuators, spec.keys, spec.equalities, spec.tendons, spec.excludes, spec.pairs, spec.skins):
        for thing in list(things):
            spec.delete(thing)
    for body in spec.bodies:
        for thing in [*body.joints, *body.cameras, *body.lights]:
            spec.delete(thing)
        for geom in list(body.geoms):
            if not _solid(geom):
                spec.delete(geom)
    for mesh in spec.meshes:
        mesh.name, mesh.file, mesh.scale = _mesh_name(mesh), "", [1.0, 1.0, 1.0]
        mesh.uservert = STAND_IN
    for texture in list(spec.textures):
        spec.delete(texture)
    geoms = [geom for body in spec.bodies for geom in body.geoms]
    for k, geom in enumerate(geoms):
        geom.name = f"shape{k}"
    return geoms
