"""Files that are wrong or hostile: one clear line each, nothing written, and nothing read outside of the folder."""

import re
from collections.abc import Callable
from pathlib import Path

import pytest

from app.arm_import.description import link_shapes, source_files
from app.arm_import.import_files import written
from app.arm_import.importing import imported
from app.files.bad_input import BadInput
from app.files.regular_file import open_regular
from tests.app.arm_import.arms_of_the_test import MJCF, URDF, block, laid_out

LOOP = '<equality><connect body1="two" body2="base" anchor="0 0 0"/></equality>'
MESH = "meshes/block.stl"

Bound = Callable[[pytest.MonkeyPatch], None]


def changed(old: str, new: str, text: str = URDF) -> str:
    """The description with one thing changed."""
    assert old in text
    return text.replace(old, new)


def long_chain(joints: int) -> str:
    """A URDF with so many revolute joints one after the other."""
    one = '<inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>'
    links = "".join(f'<link name="l{k}">{one}</link>' for k in range(joints + 1))
    ends = '<limit lower="-1" upper="1" effort="500" velocity="1"/>'
    chain = "".join(
        f'<joint name="j{k}" type="revolute"><origin xyz="0 0 0.1"/><parent link="l{k}"/><child link="l{k + 1}"/>{ends}</joint>'
        for k in range(joints)
    )
    return f'<robot name="long">{links}{chain}</robot>'


ENTITY = '<!DOCTYPE robot [<!ENTITY x SYSTEM "file:///etc/passwd">]>'
LAUGHS = '<!DOCTYPE r [<!ENTITY a "ha"><!ENTITY b "&a;&a;&a;&a;">]><robot name="&b;"/>'

MASSY = 'ixx="0.02" iyy="0.02" izz="0.004" ixy="0" ixz="0.001"'
LAST = '<axis xyz="1 0 0"/>\n'
SECOND = '<joint name="x" type="fixed"><parent link="base"/><child link="fore"/></joint></robot>'
FREE = ('<body name="one" pos="0 0 0.1" childclass="big">', '<body name="one"><freejoint/>')
TWICE = ('<joint name="a" axis="0 0 1"/>', '<joint name="a"/><joint name="d" axis="1 0 0"/>')

FILES: dict[str, tuple[str, str]] = {
    "empty": ("", "expected XML"),
    "no XML": ("robot: yes", "expected XML"),
    "not closed": (URDF[:-20], "expected XML"),
    "another kind": ("<sdf><model/></sdf>", "expected a <robot>"),
    "external entity": (ENTITY + URDF.partition("?>")[2], "no entities"),
    "entities of entities": (LAUGHS, "no entities"),
    "deep": ("<robot>" + "<a>" * 5000, "deep"),
    "many elements": ("<robot>" + "<link/>" * 60_000 + "</robot>", "at most"),
    "macro": (changed('mass value="2.5"', 'mass value="${m}"'), "xacro"),
    "NaN": (changed('mass value="2.5"', 'mass value="nan"'), "finite"),
    "infinite": (changed('xyz="0 0 0.3"', 'xyz="0 0 inf"'), "finite"),
    "no number": (changed('mass value="2.5"', 'mass value="heavy"'), "cannot read"),
    "zero inertia": (changed(MASSY, 'ixx="0" iyy="0" izz="0" ixy="0" ixz="0"'), "'upper'"),
    "no mass": (changed('<mass value="2.0"/>', '<mass value="0"/>'), "'upper'"),
    "negative mass": (changed('<mass value="2.0"/>', '<mass value="-2"/>'), "'upper'"),
    "inertia of no body": (changed('ixx="0.02" iyy="0.02" izz="0.004"', 'ixx="0.2" iyy="0.02" izz="0.004"'), "'upper'"),
    "millimetres": (changed('xyz="0 0 0.3"', 'xyz="0 0 300"'), "millimetres"),
    "mesh in millimetres": (changed(' scale="0.001 0.001 0.001"', ""), "millimetres"),
    "no joints": ('<robot name="r"><link name="a"/></robot>', "--flange"),
    "one joint": (long_chain(1), "2 to 8"),
    "nine joints": (long_chain(9), "2 to 8"),
    "prismatic": (changed('name="j3" type="revolute"', 'name="j3" type="prismatic"'), "revolute joints"),
    "free base": (changed('name="j1" type="revolute"', 'name="j1" type="floating"'), "base that is fixed"),
    "two roots": (changed("</robot>", '<link name="other"/></robot>'), "one root"),
    "link without a name": (changed('<link name="cover">', "<link>"), "link.name"),
    "two links of a name": (changed('<link name="cover">', '<link name="fore">'), "link.name"),
    "closed loop": (changed("</robot>", SECOND), "loop"),
    "circle": (changed('<parent link="base"/>', '<parent link="wrist"/>'), "without a circle"),
    "unknown parent": (changed('<parent link="upper"/>', '<parent link="lower"/>'), "name of a link"),
    "follows another": (changed(LAST, LAST + '<mimic joint="j1"/>'), "mimic"),
    "ends the wrong way": (changed('lower="-2" upper="1.5"', 'lower="1.5" upper="-2"'), "smallest angle"),
    "too weak": (changed('upper="1.5" effort="60"', 'upper="1.5" effort="3"'), "own weight"),
    "missing mesh": (changed(MESH, "meshes/other.stl"), "existing file"),
    "mesh outside": (changed(MESH, "../secret.stl"), "outside"),
    "mesh by absolute path": (changed(MESH, "/etc/hostname"), "outside"),
    "mesh by a package": (changed(MESH, "package://secret/secret.stl"), "package"),
    "mesh over the network": (changed(MESH, "http://example.org/block.stl"), "expected a path"),
    "mesh that is none": (changed(MESH, "arm.xml").replace("arm.xml", "meshes/none.stl"), "a mesh"),
    "free base of MJCF": (changed(*FREE, MJCF), "base that is fixed"),
    "closed loop of MJCF": (changed("<actuator>", LOOP + "<actuator>", MJCF), "closes a loop"),
    "slide of MJCF": (changed('name="c" axis="0 0 1"', 'name="c" type="slide" axis="0 0 1"', MJCF), "revolute"),
    "cyclic include": (changed("<worldbody>", '<include file="arm.xml"/><worldbody>', MJCF), "circle"),
    "include outside": (changed("<worldbody>", '<include file="../secret.xml"/><worldbody>', MJCF), "outside"),
    "meshes outside": (changed('meshdir="meshes"', 'meshdir="../.."', MJCF), "outside"),
    "two joints a body": (changed(*TWICE, MJCF), "one a body"),
    "unknown element": (changed("<worldbody>", "<wordlbody/><worldbody>", MJCF), "MJCF"),
    "other models": (changed("<worldbody>", '<worldbody><attach model="x" body="b" prefix="p"/>', MJCF), "<attach>"),
}


@pytest.mark.parametrize("what", FILES)
def test_one_line_and_nothing_written(what: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    text, allowed = FILES[what]
    (tmp_path / "secret.stl").write_bytes(block())
    (tmp_path / "secret.xml").write_text("<mujoco/>", encoding="utf-8")
    (tmp_path / "secret").mkdir()
    folder = tmp_path / "arm"
    file = laid_out(folder, text)
    (folder / "meshes" / "none.stl").write_bytes(b"solid of nothing")
    before, read = sorted(tmp_path.rglob("*")), watched(monkeypatch)
    with pytest.raises(BadInput) as caught:
        written(imported(file), file, tmp_path / "out")
    assert "\n" not in str(caught.value)
    assert re.search(re.escape(allowed), str(caught.value)), str(caught.value)
    assert sorted(tmp_path.rglob("*")) == before
    assert all(path.is_relative_to(folder) for path in read)


def watched(monkeypatch: pytest.MonkeyPatch) -> list[Path]:
    """Every file that an import opens from now on."""
    read: list[Path] = []

    def opening(path: Path, mode: str = "rb") -> object:
        read.append(path.resolve())
        return open_regular(path, mode)

    monkeypatch.setattr(source_files, "open_regular", opening)
    return read


def smaller_meshes(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(source_files, "LARGEST_MESHES", 100)


def fewer_faces(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(link_shapes, "MOST_FACES", 5)


def smaller_text(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(source_files, "LARGEST_XML", 100)


@pytest.mark.parametrize("bound", [smaller_meshes, fewer_faces, smaller_text])
def test_what_is_too_large_is_refused(
    bound: Callable[[pytest.MonkeyPatch], None], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    bound(monkeypatch)
    with pytest.raises(BadInput, match="at most"):
        imported(laid_out(tmp_path, URDF))


def test_a_link_to_a_file_outside_is_not_followed(tmp_path: Path) -> None:
    file = laid_out(tmp_path / "arm", URDF)
    (tmp_path / "secret.stl").write_bytes(block())
    (tmp_path / "arm" / MESH).unlink()
    (tmp_path / "arm" / MESH).symlink_to(tmp_path / "secret.stl")
    with pytest.raises(BadInput, match="outside"):
        imported(file)
    assert imported(file, within=tmp_path).arm.n == 4
