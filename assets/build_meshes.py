"""Builds the pictures of the arms (assets/meshes) from the dimensions in their files: `python -m assets.build_meshes`.

Each link is a GLB in the link's joint frame (z = joint axis, q = 0) [m], made of surfaces of revolution: drums for the joint
housings, lids on their outer ends, a tapered tube along x where the link is long. An arm without an outline is drawn as its
collision shapes, with a ring where one link meets the next. The same file gives the same bytes.
"""

import sys
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from app.files.library import ASSETS, FOOT, load_arm, robots
from sim.arm.arm_file import Arm, Outline
from sim.arm.frames import hulls, link_transform, placements, rotation, transform, z_turned_to

Array = NDArray[np.float64]
Profile = list[tuple[float, float]]
"""Points (radius, z) [m] of half a section, upwards."""

SECTIONS = 36
"""Around a housing."""

SMOOTH = np.cos(np.radians(40.0))
"""Profile corners sharper than this are edges."""

PAINT: dict[str, tuple[tuple[float, float, float], float, float]] = {
    # colour (linear), metallic, roughness
    "body": ((0.56, 0.575, 0.59), 0.25, 0.42),
    "tube": ((0.47, 0.49, 0.51), 0.4, 0.36),
    "lid": ((0.165, 0.315, 0.435), 0.05, 0.38),
    "seal": ((0.035, 0.038, 0.042), 0.0, 0.7),
    "steel": ((0.40, 0.41, 0.42), 0.45, 0.35),
}


@dataclass
class Picture:
    """Surfaces by paint."""

    surfaces: dict[str, list[tuple[Array, Array, NDArray[np.int64]]]] = field(default_factory=dict)

    def lathe(self, paint: str, profile: Profile, pose: Array, sections: int = SECTIONS) -> None:
        """Adds the surface of revolution of `profile` about the z axis of `pose` (4, 4)."""
        points, normals, faces = _revolved(np.array(profile), sections)
        turned = points @ pose[:3, :3].T + pose[:3, 3], normals @ pose[:3, :3].T, faces
        self.surfaces.setdefault(paint, []).append(turned)

    def glb(self) -> bytes:
        """The picture as a binary glTF."""
        import trimesh.exchange.gltf  # slow to import
        from trimesh.visual.material import PBRMaterial
        from trimesh.visual.texture import TextureVisuals

        scene = trimesh.Scene()
        for paint in sorted(self.surfaces):
            colour, metallic, roughness = PAINT[paint]
            material = PBRMaterial(name=paint, baseColorFactor=[*colour, 1.0], metallicFactor=metallic, roughnessFactor=roughness)
            parts = self.surfaces[paint]
            starts = np.cumsum([0, *(len(points) for points, _, _ in parts)])
            mesh = trimesh.Trimesh(
                vertices=np.round(np.vstack([points for points, _, _ in parts]), 6),
                vertex_normals=np.round(np.vstack([normals for _, normals, _ in parts]), 4),
                faces=np.vstack([faces + start for (_, _, faces), start in zip(parts, starts, strict=False)]),
                visual=TextureVisuals(material=material),
                process=False,
            )
            scene.add_geometry(mesh, node_name=paint, geom_name=paint)
        data: Any = trimesh.exchange.gltf.export_glb(scene, include_normals=True)
        return bytes(data)


def _revolved(profile: Array, sections: int) -> tuple[Array, Array, NDArray[np.int64]]:
    """Points, outward normals and triangles. Rings are doubled at edges, so that shading stays crisp there."""
    along = np.diff(profile, axis=0)
    outward = np.column_stack([along[:, 1], -along[:, 0]]) / np.linalg.norm(along, axis=1)[:, None]
    angle = np.linspace(0.0, 2.0 * np.pi, sections, endpoint=False)
    around = np.column_stack([np.cos(angle), np.sin(angle)])
    points: list[Array] = []
    normals: list[Array] = []
    faces: list[tuple[int, int, int]] = []

    def ring(point: Array, normal: Array) -> int:
        points.append(np.column_stack([around * point[0], np.full(sections, point[1])]))
        normals.append(np.column_stack([around * normal[0], np.full(sections, normal[1])]))
        return len(points) - 1

    upper = -1
    for k, normal in enumerate(outward):
        smooth_before = k > 0 and outward[k - 1] @ normal > SMOOTH
        smooth_after = k + 1 < len(outward) and outward[k + 1] @ normal > SMOOTH
        lower = upper if smooth_before else ring(profile[k], normal)
        mean = normal + outward[k + 1] if smooth_after else normal
        upper = ring(profile[k + 1], mean / np.linalg.norm(mean))
        for i in range(sections):
            j = (i + 1) % sections
            a, b, c, d = lower * sections + i, lower * sections + j, upper * sections + j, upper * sections + i
            if profile[k, 0] > 0:
                faces.append((a, b, c))
            if profile[k + 1, 0] > 0:
                faces.append((a, c, d))
    return np.vstack(points), np.vstack(normals), np.array(faces)


def drum(radius: float, low: float, high: float, low_edge: float, high_edge: float) -> Profile:
    """A closed cylinder from z = low to high, its edges rounded by these radii."""
    bottom = [(radius - low_edge * (1 - np.sin(t)), low + low_edge * (1 - np.cos(t))) for t in _arc(low_edge)]
    return [(0.0, low), *bottom, *_rounded(radius, high, high_edge), (0.0, high)]


def _rounded(radius: float, high: float, edge: float) -> Profile:
    """The upper edge of a drum."""
    return [(radius - edge * (1 - np.cos(t)), high - edge * (1 - np.sin(t))) for t in _arc(edge)]


def _arc(edge: float) -> Array:
    """Angles of the points of an edge: a large one is round, a small one a chamfer."""
    return np.linspace(0.0, np.pi / 2, 2 if edge < 0.0012 else 4 if edge < 0.01 else 6)


def _disc(radius: float, low: float, high: float) -> Profile:
    """A cylinder with plain edges."""
    return [(0.0, low), (radius, low), (radius, high), (0.0, high)]


def lid(radius: float, low: float, high: float) -> Profile:
    """A lid: rounded rim, shallow dish."""
    rim = drum(radius, low, high, 0.03 * radius, 0.3 * radius)[:-1]
    return [*rim, (0.6 * radius, high), (0.57 * radius, high - 0.03 * radius), (0.0, high - 0.03 * radius)]


def housing(picture: Picture, pose: Array, radius: float, seam: float, back: float) -> None:
    """A joint housing about z of `pose`: open towards the seam, closed by a lid at `back`; either may be the higher one."""
    if back < seam:
        pose, seam, back = pose @ transform(rotation(0, np.pi), np.zeros(3)), -seam, -back
    height = 0.34 * radius
    collar(picture, pose, radius, seam)
    picture.lathe("body", drum(radius, seam + 0.002, back - height - 0.0012, 0.05 * radius, 0.05 * radius), pose)
    picture.lathe("seal", _disc(0.965 * radius, back - height - 0.006, back - height + 0.004), pose)
    picture.lathe("lid", lid(radius, back - height, back), pose)


def collar(picture: Picture, pose: Array, radius: float, seam: float) -> None:
    """The dark ring in the gap between two links."""
    picture.lathe("seal", _disc(0.955 * radius, seam - 0.0015, seam + 0.006), pose)


def screws(picture: Picture, pose: Array, circle: float, radius: float, height: float, count: int) -> None:
    """Socket screws on a circle, standing on z = 0 of `pose`."""
    for k in range(count):
        around = np.pi / count + 2.0 * np.pi * k / count
        place = pose @ transform(np.eye(3), [circle * np.cos(around), circle * np.sin(around), 0.0])
        head = [(0.0, -0.001), (radius, -0.001), (radius, 0.85 * height), (0.85 * radius, height), (0.5 * radius, height)]
        picture.lathe("steel", [*head, (0.5 * radius, 0.4 * height), (0.0, 0.4 * height)], place, 14)


def foot(arm: Arm) -> Picture:
    """The fixed base: foot with screws, housing of the first joint, cable socket."""
    picture, outline = Picture(), _outline(arm)
    radius, wide, seam = outline.housing_radius[0], outline.foot_radius, outline.seam[0]
    upright = np.eye(4)
    picture.lathe("body", drum(wide, 0.0, 0.2 * radius, 0.001, 0.06 * radius), upright)
    shoulder = [
        (0.0, 0.1 * radius),
        (0.5 * (wide + radius), 0.1 * radius),
        (1.03 * radius, 0.36 * radius),
        (radius, 0.5 * radius),
    ]
    picture.lathe("body", [*shoulder, *_rounded(radius, seam - 0.002, 0.05 * radius), (0.0, seam - 0.002)], upright)
    if wide > 1.12 * radius:
        screws(picture, transform(np.eye(3), [0.0, 0.0, 0.2 * radius]), 0.92 * wide, 0.06 * radius, 0.07 * radius, 4)
    plug = transform(rotation(1, np.pi / 2), [0.0, 0.0, 0.62 * radius])
    picture.lathe("body", drum(0.24 * radius, 0.7 * radius, 1.06 * radius, 0.001, 0.03 * radius), plug, 24)
    picture.lathe("seal", drum(0.18 * radius, 0.9 * radius, 1.2 * radius, 0.001, 0.03 * radius), plug, 20)
    return picture


def knee(arm: Arm, k: int) -> Picture:
    """A link that turns the axis: a neck about its own joint's axis into the housing of the next joint."""
    picture, outline = Picture(), _outline(arm)
    inner, outer = outline.housing_radius[k], outline.housing_radius[k + 1]
    centre, seam = arm.chain.d[k], outline.seam[k]
    collar(picture, np.eye(4), inner, seam)
    waist = min(inner, 0.985 * outer)
    neck = [(0.0, seam + 0.002), (0.95 * inner, seam + 0.002), (inner, seam + 0.002 + 0.05 * inner)]
    neck += [(inner, centre - 0.62 * outer), (waist, centre - 0.5 * outer), (waist, centre - 0.1 * outer), (0.0, centre)]
    picture.lathe("body", neck, np.eye(4))
    housing(picture, link_transform(arm, k), outer, outline.seam[k + 1], -1.12 * outer)
    return picture


def beam(arm: Arm, k: int) -> Picture:
    """A long link: housings of its own and the next joint, a tapered tube between them."""
    picture, outline = Picture(), _outline(arm)
    z, middle = outline.tube_offset[k], outline.tube_radius[k]
    near, far = outline.housing_radius[k], outline.housing_radius[k + 1]
    a, ahead = arm.chain.a[k], link_transform(arm, k)
    for pose, radius, seam, centre in (
        (np.eye(4), near, outline.seam[k], z),
        (ahead, far, outline.seam[k + 1], z - arm.chain.d[k]),
    ):
        housing(picture, pose, radius, seam, centre + np.copysign(1.12 * radius, centre - seam))
    length = abs(a)
    tube = transform(rotation(1, np.copysign(np.pi / 2, a)), [0.0, 0.0, z])
    start, end = 0.90 * near, 0.94 * far if far > middle else 1.02 * middle
    hub, rim = 1.32 * near, length - 1.32 * far
    picture.lathe("body", _sleeve(start, 0.3 * near, hub), tube)
    picture.lathe("body", [(r, length - x) for r, x in reversed(_sleeve(end, 0.3 * far, 1.32 * far))], tube)
    narrow = min(middle, 0.96 * end)
    taper = [(middle, hub - 0.002), (middle, 0.5 * length), (narrow, rim + 0.002)]
    picture.lathe("tube", [(0.0, hub - 0.002), *taper, (0.0, rim + 0.002)], tube)
    return picture


def _sleeve(radius: float, low: float, high: float) -> Profile:
    """What grips the tube at a housing: slightly wider at the housing, its free edge rounded."""
    return [(0.0, low), (1.04 * radius, low), *_rounded(radius, high, 0.08 * radius), (0.0, high)]


def wrist(arm: Arm, k: int) -> Picture:
    """The last link: a short drum and the tool flange with its bolt circle and connector."""
    picture, outline = Picture(), _outline(arm)
    radius, disc, seam = outline.housing_radius[k], outline.flange_radius, outline.seam[k]
    face = arm.chain.d[k]
    flange = min(disc, 0.98 * radius)
    step = face - 0.0075
    collar(picture, np.eye(4), radius, seam)
    picture.lathe("body", drum(radius, seam + 0.002, step, 0.05 * radius, 0.07 * radius), np.eye(4))
    bore = 0.5 * flange
    top = drum(flange, step - 0.002, face, 0.0005, 0.0009)[:-1]
    picture.lathe("steel", [*top, (bore, face), (bore, face - 0.006), (0.0, face - 0.006)], np.eye(4))
    circle = 0.025 * flange / 0.0315
    for j in range(4):  # threaded holes, dark discs a hair above the face
        around = np.pi / 4 + np.pi / 2 * j
        hole = transform(np.eye(3), [circle * np.cos(around), circle * np.sin(around), face])
        picture.lathe("seal", _disc(0.0033, -0.001, 0.0001), hole, 16)
    pin = transform(np.eye(3), [circle, 0.0, face])
    picture.lathe("seal", _disc(0.003, -0.001, 0.0001), pin, 16)
    socket = transform(rotation(0, np.pi / 2), [0.0, 0.0, 0.5 * (seam + step) + 0.001])
    picture.lathe("seal", drum(0.0062, 0.9 * radius, 1.06 * radius, 0.0005, 0.001), socket, 18)
    picture.lathe("steel", drum(0.0045, radius, 1.16 * radius, 0.0005, 0.0012), socket, 18)
    return picture


def _outline(arm: Arm) -> Outline:
    assert arm.outline is not None
    return arm.outline


def capsule(radius: float, length: float) -> Profile:
    """A capsule whose axis runs from 0 to `length`."""
    around = np.linspace(0.0, np.pi / 2, 9)[1:-1]
    lower = [(radius * np.sin(t), -radius * np.cos(t)) for t in around]
    upper = [(r, length - z) for r, z in reversed(lower)]
    return [(0.0, -radius), *lower, (radius, 0.0), (radius, length), *upper, (0.0, length + radius)]


def shaped(arm: Arm, k: int) -> Picture:
    """A link as its collision shapes, -1 the foot; at its joint a ring, at the end of the last the flange."""
    picture, own = Picture(), [shape for shape in hulls(arm) if shape.link == k]
    for shape in own:
        start, way = np.array(shape.start), np.subtract(shape.end, shape.start)
        length = float(np.linalg.norm(way))
        pose = transform(z_turned_to(way), start)
        picture.lathe("body" if k < 0 or k % 2 == 0 else "tube", capsule(shape.radius, length), pose)
    if k >= 0:
        before = [shape for shape in hulls(arm) if shape.link == k - 1]
        wide = max([shape.radius for shape in [*own, *before]], default=0.03)
        picture.lathe("lid", drum(1.02 * wide, -0.006, 0.006, 0.001, 0.001), np.eye(4))
    if k == arm.n - 1:
        face = placements(arm)[-1]
        picture.lathe("steel", _disc(0.0315, -0.006, 0.0), face)
    return picture


def pictures(arm: Arm) -> dict[str, Picture]:
    """The pictures of an arm by link: `FOOT`, then each link by its joint's name."""
    if arm.outline is None:
        return {name: shaped(arm, k) for k, name in enumerate([FOOT, *arm.chain.joints], -1)}
    built = {FOOT: foot(arm)}
    for k, name in enumerate(arm.chain.joints):
        shape = wrist if k == arm.n - 1 else beam if arm.chain.a[k] else knee
        built[name] = shape(arm, k)
    return built


def build(arm: Arm, folder: Path) -> None:
    """Writes the pictures of an arm into `folder`, which is made."""
    folder.mkdir(parents=True, exist_ok=True)
    for name, picture in pictures(arm).items():
        (folder / f"{name}.glb").write_bytes(picture.glb())


if __name__ == "__main__":
    for robot in sys.argv[1:] or robots():
        build(load_arm(robot), ASSETS / "meshes" / robot)
