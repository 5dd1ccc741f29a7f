"""Which file a user means by a folder or by a name of a collection; no collection is installed here but one of the test."""

import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from app.arm_import.importing import imported
from app.arm_import.named_descriptions import PACKAGE, named_description
from app.files.bad_input import BadInput
from tests.app.arm_import.arms_of_the_test import MJCF, URDF, laid_out


@pytest.fixture
def collection(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """A package like robot-descriptions, whose arms are in the folder that is returned."""
    cache = tmp_path / "cache" / "small_robots"
    laid_out(cache / "urdf", URDF.replace("meshes/block.stl", "package://small_robots/urdf/meshes/block.stl"), "arm.urdf")
    package = tmp_path / "site" / PACKAGE
    package.mkdir(parents=True)
    (package / "__init__.py").touch()
    where = f"REPOSITORY_PATH = {str(cache)!r}\n"
    (package / "small_description.py").write_text(f"{where}URDF_PATH = REPOSITORY_PATH + '/urdf/arm.urdf'\n")
    (package / "macro_description.py").write_text(f"{where}XACRO_PATH = REPOSITORY_PATH + '/arm.xacro'\n")
    (package / "cloned_description.py").write_text("raise RuntimeError('git: no\\nnetwork')\n")
    monkeypatch.syspath_prepend(tmp_path / "site")
    yield cache
    for name in [each for each in sys.modules if each.partition(".")[0] == PACKAGE]:
        del sys.modules[name]


def test_a_name_of_the_package_is_a_file_of_its_repository(collection: Path) -> None:
    found = named_description(Path("small_description"))
    assert found == (collection / "urdf" / "arm.urdf", collection)
    assert imported(found.file, within=found.within).arm.n == 4


@pytest.mark.parametrize(
    ("name", "says"),
    [
        ("macro_description", "expand it first"),
        ("other_description", "none of this name"),
        ("cloned_description", "git: no network"),
    ],
)
def test_what_the_package_cannot_give_is_a_line(collection: Path, name: str, says: str) -> None:
    with pytest.raises(BadInput, match=says) as caught:
        named_description(Path(name))
    assert "\n" not in str(caught.value)


def test_a_package_that_is_not_installed_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, PACKAGE, None)
    with pytest.raises(BadInput, match="pip install robot-descriptions"):
        named_description(Path("small_description"))


def test_a_folder_of_menagerie_is_its_arm(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    file = laid_out(tmp_path / "other_arm", MJCF)
    (file.parent / "scene.xml").write_text('<mujoco><include file="arm.xml"/></mujoco>', encoding="utf-8")
    assert named_description(file) == (file, None)
    assert named_description(file.parent) == (file, None)
    assert named_description(Path("other_arm")).file == Path("other_arm"), "a file that is not there"
    monkeypatch.setenv("MENAGERIE_ROOT", str(tmp_path))
    assert named_description(Path("other_arm")) == (file, None)
    (file.parent / "hand.xml").write_text("<mujoco/>", encoding="utf-8")
    with pytest.raises(BadInput, match=r"arm\.xml, hand\.xml: name the file"):
        named_description(file.parent)
    with pytest.raises(BadInput, match="none"):
        named_description(file.parent / "meshes")
