import subprocess
import sys
from pathlib import Path

import pytest

from app.files.checked import BadInput
from app.files.library import ASSETS, load_arm, load_tool, mesh_path, robots, tools


def test_shipped_names() -> None:
    assert robots() == ["iiwa7", "ur10e", "ur16e", "ur3e", "ur5e"]
    assert tools() == ["flange", "gripper", "sphere", "two-finger", "vacuum-cup"]


@pytest.mark.parametrize("name", ["iiwa7", "ur3e", "ur5e", "ur10e", "ur16e"])
def test_an_arm_bears_the_name_of_its_file(name: str) -> None:
    assert load_arm(name).name == name


@pytest.mark.parametrize("name", ["flange", "gripper", "sphere", "two-finger", "vacuum-cup"])
def test_a_tool_bears_the_name_of_its_file(name: str) -> None:
    assert load_tool(name).name == name


def test_a_path_reads_that_file(tmp_path: Path) -> None:
    text = (ASSETS / "robots" / "ur5e.yaml").read_text("utf-8").replace("payload: 5.0", "payload: 4.5")
    mine = tmp_path / "mine.yaml"
    mine.write_text(text, "utf-8")
    assert load_arm(mine).payload == 4.5
    assert load_arm(str(mine)).payload == 4.5


def test_an_arm_is_read_once_and_anew_when_its_file_changed(tmp_path: Path) -> None:
    text = (ASSETS / "robots" / "ur5e.yaml").read_text("utf-8")
    mine = tmp_path / "mine.yaml"
    mine.write_text(text, "utf-8")
    first = load_arm(mine)
    assert load_arm(mine) is first
    mine.write_text(text.replace("payload: 5.0", "payload: 4.5"), "utf-8")
    assert load_arm(mine).payload == 4.5


def test_a_shipped_name_wins_over_a_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    Path("ur5e").write_text("nonsense", "utf-8")
    assert load_arm("ur5e").name == "ur5e"


def test_an_unknown_arm_lists_those_there_are() -> None:
    with pytest.raises(BadInput) as caught:
        load_arm("ur4e")
    assert (
        str(caught.value) == "robots: robot = ur4e: expected one of iiwa7, ur10e, ur16e, ur3e, ur5e, or the path of a YAML file"
    )


@pytest.mark.parametrize("name", ["", "../robots/ur5e", "ur5e\n", "a\x1b[31mb"])
def test_an_odd_name_is_one_clean_line(name: str) -> None:
    with pytest.raises(BadInput) as caught:
        load_arm(name)
    assert str(caught.value).isprintable()


def test_a_missing_file_says_so(tmp_path: Path) -> None:
    with pytest.raises(BadInput, match="expected an existing file"):
        load_arm(tmp_path / "none.yaml")


DRIFT = "arm.yaml: sensors.force_torque.drift"


@pytest.mark.parametrize(
    ("old", "new", "line"),
    [
        ("payload: 5.0", "payload: -1", "arm.yaml: payload = -1: expected a number >= 0.01 and <= 1000"),
        (
            "payload: 5.0",
            "payload: 5.0\npayload: 6.0",
            "arm.yaml: line 6: payload: expected each key once, it stands on line 5 too",
        ),
        ("  elbow: 2", "  elbow: 7", "arm.yaml: chain.elbow = 7: expected 0 to 5"),
        ("  elbow: 2", "  elbow: .nan", "arm.yaml: chain.elbow = nan: expected a finite number"),
        (
            "  status: measured",
            "  status: guessed",
            "arm.yaml: motors.status = guessed: expected one of official, measured, assumed",
        ),
        (
            "warm_up: 600.0",
            "warm_up: 0.0",
            f"{DRIFT}.warm_up = 0.0: expected a number >= 1 and <= 1e+06",
        ),
        (
            "walk_time: 1800.0",
            "walk_time: -1",
            f"{DRIFT}.walk_time = -1: expected a number >= 1 and <= 1e+06",
        ),
        (
            "walk_force: 0.3",
            "walk_force: -0.3",
            f"{DRIFT}.walk_force = -0.3: expected a number >= 0 and <= 1e+09",
        ),
        ("output_share: 0.08", "output_share: 1.08", "arm.yaml: frictions.output_share = 1.08: expected a number >= 0 and <= 1"),
    ],
)
def test_a_bad_arm_is_one_line(tmp_path: Path, old: str, new: str, line: str) -> None:
    text = (ASSETS / "robots" / "ur5e.yaml").read_text("utf-8")
    assert old in text
    path = tmp_path / "arm.yaml"
    path.write_text(text.replace(old, new, 1), "utf-8")
    with pytest.raises(BadInput) as caught:
        load_arm(path)
    assert str(caught.value) == line


def test_a_mesh_is_found_by_arm_and_link() -> None:
    assert mesh_path(load_arm("ur5e"), "foot").read_bytes()[:4] == b"glTF"
    assert mesh_path(load_arm("ur5e"), "wrist_3") != mesh_path(load_arm("ur5e"), "base")


def test_a_missing_mesh_lists_those_there_are() -> None:
    with pytest.raises(BadInput, match="ur5e/wrist_3"):
        mesh_path(load_arm("ur5e"), "wrist_4")


def test_the_library_does_not_wait_for_trimesh() -> None:
    code = "import sys, app.files.library; app.files.library.load_arm('ur5e'); sys.exit('trimesh' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code], cwd=ASSETS.parent, check=False).returncode == 0
