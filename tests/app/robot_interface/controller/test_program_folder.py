"""Programs by name: the user's first, nothing outside of the folders, and every bundled one runs."""

from pathlib import Path

import pytest

from app.files.bad_input import BadInput
from app.robot_interface.controller.program_folder import BUNDLED, ProgramFolder
from pendant.program.steps import misfit


def test_the_users_program_comes_before_a_bundled_one_of_its_name(tmp_path: Path) -> None:
    (tmp_path / "wave.yaml").write_text("steps: [{kind: wait, duration: 1.0}]")
    folder = ProgramFolder(tmp_path)
    assert folder.find("wave.urp") == tmp_path / "wave.yaml"
    assert folder.find("/programs/guide.urp") == BUNDLED / "guide.yaml"
    assert folder.names() == ["guide.urp", "wait.urp", "wave.urp"]


@pytest.mark.parametrize(
    "name", ["", ".urp", "../secret.urp", "/etc/passwd", "a/b.urp", "none.urp", "..", "w\0ve.urp", "wave\n.urp"]
)
def test_what_is_not_in_the_folder_is_not_found(name: str, tmp_path: Path) -> None:
    (tmp_path.parent / "secret.yaml").write_text("steps: [{kind: wait, duration: 1.0}]")
    assert ProgramFolder(tmp_path).find(name) is None


def test_a_file_that_is_no_program_is_said_in_one_line(tmp_path: Path) -> None:
    (tmp_path / "odd.yaml").write_text("steps: 7")
    with pytest.raises(BadInput, match="steps"):
        ProgramFolder(tmp_path).load(tmp_path / "odd.yaml")


@pytest.mark.parametrize("path", sorted(BUNDLED.glob("*.yaml")), ids=lambda path: path.stem)
def test_every_bundled_program_fits_an_arm_of_six_joints(path: Path) -> None:
    program = ProgramFolder().load(path)
    assert program.name == path.stem
    assert misfit(program, 6) is None
