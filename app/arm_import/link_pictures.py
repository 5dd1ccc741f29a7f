"""Pictures of an arm's links: simplified meshes, a GLB a link."""

import numpy as np
import trimesh
from numpy.typing import NDArray
from trimesh.exchange.gltf import export_glb
from trimesh.visual.material import PBRMaterial
from trimesh.visual.texture import TextureVisuals

Array = NDArray[np.float64]
Faces = NDArray[np.int64]

MOST_TRIANGLES = 12_000
"""Of the picture of a link: all links of an arm together load in a browser in a second or two."""

Painted = tuple[trimesh.Trimesh, tuple[float, float, float, float]]
"""A mesh in its link's joint frame [m], and its colour (red, green, blue, opacity, 0 to 1)."""


def picture(parts: list[Painted]) -> bytes:
    """A GLB of all parts; those of one colour are one surface, and together they have at most `MOST_TRIANGLES`."""
    by_colour: dict[tuple[float, float, float, float], list[trimesh.Trimesh]] = {}
    for mesh, colour in parts:
        by_colour.setdefault(colour, []).append(mesh)
    whole = {colour: _joined(meshes) for colour, meshes in by_colour.items()}
    total = sum(len(mesh.faces) for mesh in whole.values())
    scene = trimesh.Scene()
    for k, (colour, mesh) in enumerate(whole.items()):
        small = simplified(mesh, max(200, MOST_TRIANGLES * len(mesh.faces) // max(total, 1)))
        red, green, blue, opacity = (*(each**2.2 for each in colour[:3]), colour[3])  # glTF's colours are linear
        paint = PBRMaterial(baseColorFactor=[red, green, blue, opacity], metallicFactor=0.1, roughnessFactor=0.5)
        drawn = trimesh.Trimesh(np.round(small.vertices, 6), small.faces, visual=TextureVisuals(material=paint), process=False)
        scene.add_geometry(drawn, node_name=f"part{k}", geom_name=f"part{k}")
    data = export_glb(scene)
    assert isinstance(data, bytes)
    return data


def _joined(meshes: list[trimesh.Trimesh]) -> trimesh.Trimesh:
    starts = np.cumsum([0, *(len(mesh.vertices) for mesh in meshes)])
    vertices = np.vstack([mesh.vertices for mesh in meshes])
    faces = np.vstack([mesh.faces + start for mesh, start in zip(meshes, starts, strict=False)])
    return trimesh.Trimesh(vertices, faces, process=False)


def simplified(mesh: trimesh.Trimesh, most: int) -> trimesh.Trimesh:
    """A mesh of at most `most` triangles: corners that share a cell of a grid become one, at their mean.

    The grid is as fine as that allows (vertex clustering, Rossignac and Borrel 1993).
    """
    if len(mesh.faces) <= most:
        return mesh
    vertices, faces = np.asarray(mesh.vertices), np.asarray(mesh.faces)  # plain: trimesh hashes its own at each look
    low, high = mesh.bounds
    size = max(float((high - low).max()), 1e-6)
    cells = 2.0 * np.sqrt(most)
    while True:
        found = _clustered(vertices, faces, low, size / cells)
        if len(found.faces) <= most:
            return found
        cells *= max(0.5, min(0.9, float(np.sqrt(most / len(found.faces)))))


def _clustered(vertices: Array, corners: Faces, low: Array, cell: float) -> trimesh.Trimesh:
    grid = np.floor((vertices - low) / cell).astype(np.int64)
    _, place = np.unique(_key(grid), return_inverse=True)
    counts = np.bincount(place)
    means = np.column_stack([np.bincount(place, weights=vertices[:, i]) / counts for i in range(3)])
    faces = place[corners]
    whole = (faces[:, 0] != faces[:, 1]) & (faces[:, 1] != faces[:, 2]) & (faces[:, 2] != faces[:, 0])
    faces = faces[whole]
    _, first = np.unique(_key(np.sort(faces, axis=1)), return_index=True)
    return trimesh.Trimesh(means, faces[np.sort(first)], process=False)


def _key(rows: Faces) -> Faces:
    """One number for each row of three below 2^21 (m, 3): it is sorted sooner than rows are."""
    return (rows[:, 0] << 42) + (rows[:, 1] << 21) + rows[:, 2]
