"""The pictures: built from the arm's own numbers, closed, light, and meeting at the joints."""

import json
import struct
from pathlib import Path

import numpy as np
import pytest

from app.files.library import ASSETS, load_arm, robots
from assets.build_meshes import FOOT, build, pictures
from sim.arm.arm_file import Arm
from sim.arm.frames import hulls, link_transform

ARMS = {name: load_arm(name) for name in robots()}
OUTLINED = [name for name, arm in ARMS.items() if arm.outline is not None]
PICTURES = {name: pictures(arm) for name, arm in ARMS.items()}


def surfaces(arm: str, link: str) -> list[tuple[np.ndarray, np.ndarray, np.ndarray]]:
    return [surface for parts in PICTURES[arm][link].surfaces.values() for surface in parts]


def points(arm: str, link: str) -> np.ndarray:
    return np.vstack([vertices for vertices, _, _ in surfaces(arm, link)])


def glb(data: bytes) -> tuple[dict, bytes]:
    """The two chunks of a binary glTF."""
    assert data[:4] == b"glTF"
    (length,) = struct.unpack("<I", data[12:16])
    return json.loads(data[20 : 20 + length]), data[28 + length :]


def around(point: np.ndarray, vertices: np.ndarray, faces: np.ndarray) -> float:
    """How many times a surface winds around a point: the sum of its triangles' solid angles over 4 pi."""
    a, b, c = (vertices[faces[:, i]] - point for i in range(3))
    la, lb, lc = (np.linalg.norm(v, axis=1) for v in (a, b, c))
    top = np.einsum("ij,ij->i", a, np.cross(b, c))
    down = la * lb * lc + (a * b).sum(1) * lc + (b * c).sum(1) * la + (c * a).sum(1) * lb
    return float(np.sum(2 * np.arctan2(top, down)) / (4 * np.pi))


def encloses(arm: str, link: str, point: list[float]) -> bool:
    return any(around(np.array(point), vertices, faces) > 0.5 for vertices, _, faces in surfaces(arm, link))


def test_building_twice_gives_the_same_bytes(tmp_path: Path) -> None:
    for folder in ("one", "two"):
        build(ARMS["ur5e"], tmp_path / folder)
    files = sorted(path.name for path in (tmp_path / "one").iterdir())
    assert files == sorted([f"{FOOT}.glb", *(f"{joint}.glb" for joint in ARMS["ur5e"].chain.joints)])
    for name in files:
        assert (tmp_path / "one" / name).read_bytes() == (tmp_path / "two" / name).read_bytes()


@pytest.mark.parametrize("name", ARMS)
def test_the_shipped_pictures_are_those_of_the_data(name: str, tmp_path: Path) -> None:
    build(ARMS[name], tmp_path)
    for built in tmp_path.iterdir():
        mine, mine_data = glb(built.read_bytes())
        shipped, shipped_data = glb((ASSETS / "meshes" / name / built.name).read_bytes())
        for part in ("accessors", "materials", "meshes"):  # not "asset", which names the exporter's version
            assert mine[part] == shipped[part], f"{built.name}: run python -m assets.build_meshes"
        assert mine_data == shipped_data, f"{built.name}: run python -m assets.build_meshes"


@pytest.mark.parametrize("name", ARMS)
def test_an_arm_is_light(name: str) -> None:
    files = list((ASSETS / "meshes" / name).iterdir())
    assert len(files) == ARMS[name].n + 1
    assert sum(path.stat().st_size for path in files) < 2_000_000
    assert sum(len(faces) for link in PICTURES[name] for _, _, faces in surfaces(name, link)) < 25_000


@pytest.mark.parametrize("name", ARMS)
def test_every_surface_is_closed_and_faces_outwards(name: str) -> None:
    for link in PICTURES[name]:
        for vertices, normals, faces in surfaces(name, link):
            _, same = np.unique(np.round(vertices, 7), axis=0, return_inverse=True)
            merged = same.ravel()[faces]
            edges = np.vstack([merged[:, [0, 1]], merged[:, [1, 2]], merged[:, [2, 0]]])
            forth, count = np.unique(edges, axis=0, return_counts=True)
            assert (count == 1).all()
            assert {tuple(edge) for edge in forth} == {tuple(edge) for edge in forth[:, ::-1]}  # each edge once each way
            a, b, c = (vertices[faces[:, i]] for i in range(3))
            assert np.einsum("ij,ij->", a, np.cross(b, c)) > 0  # six times the volume
            flat = np.cross(b - a, c - a)
            assert (np.einsum("ij,ij->i", flat, normals[faces].mean(1)) > 0).all()
            np.testing.assert_allclose(np.linalg.norm(normals, axis=1), 1.0, atol=1e-9)


def axis_of(arm: Arm, k: int) -> tuple[list[float], np.ndarray]:
    """Where the axis of joint k + 1 passes through the middle of link k, and the pose of that joint's frame, both in link k."""
    ahead = link_transform(arm, k)
    assert arm.outline is not None
    height = arm.outline.tube_offset[k] if arm.chain.a[k] else arm.chain.d[k]
    return [float(ahead[0, 3]), float(ahead[1, 3]), height], ahead


@pytest.mark.parametrize("name", OUTLINED)
def test_a_link_holds_the_next_joint(name: str) -> None:
    arm = ARMS[name]
    assert arm.outline is not None
    assert encloses(name, FOOT, [0, 0, 0.5 * arm.outline.seam[0]])
    for k in range(arm.n - 1):
        assert encloses(name, arm.chain.joints[k], axis_of(arm, k)[0])


@pytest.mark.parametrize("name", OUTLINED)
def test_links_meet_at_the_seams(name: str) -> None:
    """Near a joint's axis one link ends, and the next begins, within 2 mm of the seam, on opposite sides of it."""
    arm, links = ARMS[name], [FOOT, *ARMS[name].chain.joints]
    assert arm.outline is not None
    for k, seam in enumerate(arm.outline.seam):
        before = np.eye(4) if k == 0 else link_transform(arm, k - 1)
        radius = arm.outline.housing_radius[k]
        ends = []
        for link, pose in ((links[k], before), (links[k + 1], np.eye(4))):
            seen = (points(name, link) - pose[:3, 3]) @ pose[:3, :3]
            near = seen[(np.hypot(seen[:, 0], seen[:, 1]) < 1.01 * radius) & (np.abs(seen[:, 2] - seam) < 0.01)]
            assert len(near)
            ends.append(near[np.argmin(np.abs(near[:, 2] - seam)), 2])
        assert np.abs(np.array(ends) - seam).max() < 0.0021


@pytest.mark.parametrize("name", OUTLINED)
def test_the_flange_is_where_the_chain_ends(name: str) -> None:
    arm = ARMS[name]
    seen = points(name, arm.chain.joints[-1])
    assert seen[:, 2].max() == pytest.approx(arm.chain.d[-1], abs=2e-4)  # the dark holes stand a tenth of a millimetre proud
    assert points(name, FOOT)[:, 2].min() == pytest.approx(0.0, abs=1e-12)


@pytest.mark.parametrize("name", [name for name in ARMS if name not in OUTLINED])
def test_without_an_outline_the_shapes_are_the_picture(name: str) -> None:
    """Everything that can touch is drawn, in the joint's frame, and the face of the flange is where the chain ends."""
    arm = ARMS[name]
    for shape in hulls(arm):
        link = FOOT if shape.link < 0 else arm.chain.joints[shape.link]
        start, end = np.array(shape.start), np.array(shape.end)
        way = (end - start) / np.linalg.norm(end - start)
        for tip in (start - shape.radius * way, end + shape.radius * way):
            assert np.linalg.norm(points(name, link) - tip, axis=1).min() < 1e-6
    face = link_transform(arm, arm.n - 1)
    seen = (points(name, arm.chain.joints[-1]) - face[:3, 3]) @ face[:3, :3]
    assert (np.abs(seen[np.hypot(seen[:, 0], seen[:, 1]) > 0.031][:, 2]) < 1e-9).any()


@pytest.mark.parametrize("name", OUTLINED)
def test_collision_shapes_follow_the_picture(name: str) -> None:
    """Capsules round off the edges of the housings; nothing sticks out further than half a housing's radius."""
    arm = ARMS[name]
    assert arm.outline is not None
    for k, link in enumerate(arm.chain.joints):
        seen = points(name, link)
        outside = np.full(len(seen), np.inf)
        for shape in arm.shapes:
            if shape.link == k:
                start, along = np.array(shape.start), np.array(shape.end) - shape.start
                t = np.clip((seen - start) @ along / (along @ along), 0, 1)
                outside = np.minimum(outside, np.linalg.norm(seen - start - t[:, None] * along, axis=1) - shape.radius)
                for end in (shape.start, shape.end):
                    assert encloses(name, link, end)
        assert outside.max() < 0.51 * max(arm.outline.housing_radius[k : k + 2])
