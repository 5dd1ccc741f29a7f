"""An imported arm is that of its file: as MuJoCo and Pinocchio read it themselves."""

from pathlib import Path

import mujoco
import numpy as np
import pinocchio as pin
import pytest

from app.arm_import.import_files import written
from app.arm_import.importing import Imported, imported
from app.arm_import.ratings import Weights, ratings
from app.files.bad_input import BadInput
from app.files.library import load_arm, load_tool, mesh_path
from app.web.arm_change import meshes_of
from sim.arm.chain import chain, tool_body
from sim.arm.frames import joint_frames
from sim.rigid_body.dynamics import Dynamics
from tests.app.arm_import.arms_of_the_test import MJCF, URDF, laid_out

POSTURES = 1000
EQUAL = 1e-9  # relative to the largest value


@pytest.fixture(scope="module")
def urdf(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Imported]:
    file = laid_out(tmp_path_factory.mktemp("urdf"), URDF, "arm.urdf")
    return file, imported(file)


@pytest.fixture(scope="module")
def mjcf(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Imported]:
    file = laid_out(tmp_path_factory.mktemp("mjcf"), MJCF)
    return file, imported(file)


def model_of(found: Imported) -> Dynamics:
    rigid, tool = chain(found.arm), tool_body(found.tool)
    return Dynamics(rigid, rigid.links, tool, mounting=[0.0, 0.0, 0.0], elbow=found.arm.chain.elbow)


def drawn(found: Imported) -> np.ndarray:
    low, high = np.array(found.arm.limits.ends).T
    return np.random.default_rng(7).uniform(low, high, (POSTURES, found.arm.n))


def assert_equal(ours: list[np.ndarray], theirs: list[np.ndarray]) -> None:
    a, b = np.array(ours), np.array(theirs)
    assert np.abs(a - b).max() < EQUAL * np.abs(b).max()


def test_a_urdf_is_as_pinocchio_reads_it(urdf: tuple[Path, Imported]) -> None:
    file, found = urdf
    theirs = pin.buildModelFromUrdf(str(file))
    data, flange = theirs.createData(), theirs.getFrameId("flange")
    ours = model_of(found)
    poses, forces, masses = ([], []), ([], []), ([], [])
    for q in drawn(found):
        # Its continuous joint has the coordinates cos and sin; the finger, beyond the flange, stays at 0.
        own = np.array([*q[:3], np.cos(q[3]), np.sin(q[3]), 0.0])
        pin.framesForwardKinematics(theirs, data, own)
        p, R, _ = ours.update(q)
        poses[0].append(np.column_stack([R, p]))
        poses[1].append(np.column_stack([data.oMf[flange].rotation, data.oMf[flange].translation]))
        forces[0].append(ours.gravity(q))
        forces[1].append(pin.computeGeneralizedGravity(theirs, data, own)[:4])
        masses[0].append(ours.mass(q).copy())
        full = np.triu(pin.crba(theirs, data, own))[:4, :4]
        masses[1].append(full + np.triu(full, 1).T)
    for each in (poses, forces, masses):
        assert_equal(*each)


def test_an_mjcf_is_as_mujoco_reads_it(mjcf: tuple[Path, Imported]) -> None:
    file, found = mjcf
    theirs = mujoco.MjModel.from_xml_path(str(file))
    theirs.dof_armature[:] = 0.0
    theirs.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_CONTACT | mujoco.mjtDisableBit.mjDSBL_CONSTRAINT
    data, ours = mujoco.MjData(theirs), model_of(found)
    poses, forces, masses = ([], []), ([], []), ([], [])
    for q in drawn(found):
        data.qpos[:] = q
        mujoco.mj_forward(theirs, data)
        p, R, _ = ours.update(q)
        site = data.site("attachment_site")
        poses[0].append(np.column_stack([R, p]))
        poses[1].append(np.column_stack([site.xmat.reshape(3, 3), site.xpos]))
        forces[0].append(ours.gravity(q))
        forces[1].append(data.qfrc_bias.copy())
        masses[0].append(ours.mass(q).copy())
        masses[1].append(np.zeros((3, 3)))
        mujoco.mj_fullM(theirs, data, masses[1][-1])
    for each in (poses, forces, masses):
        assert_equal(*each)


def test_the_file_says_what_it_can(urdf: tuple[Path, Imported], mjcf: tuple[Path, Imported]) -> None:
    arm = urdf[1].arm
    assert (arm.name, arm.chain.joints) == ("small-arm", ["j1", "j2", "j3", "j4"])
    assert arm.limits.ends[1] == (-2.0, 1.5)
    assert arm.limits.torque == [60.0, 60.0, 30.0, 12.0]
    assert arm.limits.speed == [2.0, 2.0, 2.5, 3.0]
    assert arm.masses.mass == pytest.approx([2.5, 2.0, 1.2, 0.5])  # the cover is part of the forearm
    arm = mjcf[1].arm
    assert arm.limits.torque == [50.0, 40.0, 20.0]
    assert arm.limits.ends[2] == pytest.approx((-np.radians(120.0), np.radians(140.0)))
    assert arm.motors.rotor_inertia[0] == 0.2
    assert arm.chain.home == [0.0, -0.5, 1.2]


def test_what_moves_beyond_the_flange_is_the_tool(urdf: tuple[Path, Imported], mjcf: tuple[Path, Imported]) -> None:
    tool = urdf[1].tool
    assert tool is not None
    assert tool.mass == pytest.approx(0.35)
    # Hand 0.01 m beyond the flange, its centre 0.03 m on; the finger's centre 0.01 + 0.06 + 0.02 m beyond, 0.02 m aside.
    assert tool.com == pytest.approx([0.05 * 0.02 / 0.35, 0.0, (0.3 * 0.04 + 0.05 * 0.09) / 0.35])
    assert mjcf[1].tool is None


def test_it_is_written_and_read_again(urdf: tuple[Path, Imported], tmp_path: Path) -> None:
    file, found = urdf
    path = written(found, file, tmp_path)
    arm = load_arm(path)
    assert np.abs(np.array(joint_frames(arm, arm.chain.home)) - joint_frames(found.arm, found.arm.chain.home)).max() == 0.0
    assert arm.masses == found.arm.masses
    assert load_tool(path.with_name("small-arm-tool.yaml")) == found.tool
    assert mesh_path(arm, "j1").read_bytes()[:4] == b"glTF"
    assert set(meshes_of(arm)) == {"foot", "j1", "j2", "j3", "j4"}
    assert sorted(each.name for each in (path.parent / "source").rglob("*.*")) == ["arm.urdf", "block.stl"]
    assert "frictions.breakaway" in path.read_text(encoding="utf-8")
    written(found, file, tmp_path)  # once more: what an import wrote is replaced
    assert sorted(each.name for each in tmp_path.iterdir()) == ["small-arm"]
    (tmp_path / "small-arm" / "small-arm.yaml").unlink()
    with pytest.raises(BadInput, match="--out"):
        written(found, file, tmp_path)


def test_what_rules_have_made_is_told(urdf: tuple[Path, Imported], mjcf: tuple[Path, Imported]) -> None:
    fields = [name for name, _ in urdf[1].assumed]
    assert fields[0] == "payload"
    assert "limits.torque" not in fields
    assert "limits.speed" in [name for name, _ in mjcf[1].assumed]
    assert any("0.89" in line and line.startswith("frictions") for line in urdf[1].told)
    assert urdf[1].arm.frictions.status == "assumed"


def test_measured_values_replace_what_they_name(urdf: tuple[Path, Imported], tmp_path: Path) -> None:
    file, found = urdf
    values = tmp_path / "measured.yaml"
    values.write_text("payload: 1.5\nfrictions: {breakaway: [3.0, 3.0, 2.0, 1.0]}\naccuracy: {stiffness: 0.02}\n", "utf-8")
    again = imported(file, values=values)
    assert again.arm.payload == 1.5
    assert again.arm.frictions.breakaway == [3.0, 3.0, 2.0, 1.0]
    assert again.arm.frictions.torque == found.arm.frictions.torque
    assert (again.arm.frictions.status, again.arm.accuracy.stiffness) == ("measured", 0.02)
    assert "breakaway" not in again.arm.frictions.assumed
    assert "torque" in again.arm.frictions.assumed
    assert "frictions.breakaway" not in [name for name, _ in again.assumed]
    values.write_text("frictions: {breakway: [1.0]}\n", "utf-8")
    with pytest.raises(BadInput, match="breakway"):
        imported(file, values=values)


def test_arms_of_another_size_get_other_values(urdf: tuple[Path, Imported], tmp_path: Path) -> None:
    """A fifth of the torques: a geared servo by size, and all that is scaled from the torque."""
    small = URDF
    for torque, less in (("60", "12"), ("30", "6"), ('12" velocity="3', '2.5" velocity="3')):
        small = small.replace(f'effort="{torque}"', f'effort="{less}"')
    for mass, less in (("2.5", "0.3"), ("2.0", "0.2"), ("1.0", "0.1"), ("0.5", "0.06"), ("0.2", "0.02")):
        small = small.replace(f'<mass value="{mass}"/>', f'<mass value="{less}"/>')
    found = imported(laid_out(tmp_path, small, "arm.urdf"))
    assert found.arm.motors.gear[0] == 345.0
    assert urdf[1].arm.motors.gear[0] == 101.0
    assert found.arm.frictions.breakaway[0] < urdf[1].arm.frictions.breakaway[0]
    assert any("servos" in line for line in found.told)
    assert imported(laid_out(tmp_path, small, "arm.urdf"), drive="harmonic").arm.motors.gear[0] == 101.0


def test_torques_that_bear_little_more_than_the_arm_are_told() -> None:
    """Own weight takes 10 N·m, a kilogram 5 N·m more, and two thirds of the torque may be used."""
    weighed = Weights(np.array([[10.0]]), np.array([[5.0]]), moving=4.0)
    weak, strong = (ratings([torque], None, weighed, where="arm.urdf") for torque in (15.2, 18.0))
    assert (weak.payload, strong.payload) == pytest.approx((0.027, 0.4))
    assert "give its maker's payload and limits.torque by --measured" in weak.told[-1]
    assert not any("--measured" in line for line in strong.told)
    assert not any("--measured" in line for line in ratings([15.2], 0.1, weighed, where="arm.urdf").told), "it is given"
