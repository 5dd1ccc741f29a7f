"""The shipped arms against the published tables, typed in here a second time."""

import math

import numpy as np
import pytest

from app.files.library import load_arm, robots
from sim.arm.arm_file import Arm, Sourced
from sim.arm.frames import com_in_joint_frame, inertia_matrix, joint_frames, link_transform
from sim.arm_problems import problems

ARMS = {name: load_arm(name) for name in robots()}

# Joint origins of the UR5e in the vendor's URDF: xyz, rpy; every joint turns about z.
URDF = [
    ((0, 0, 0.1625), (0, 0, 0)),
    ((0, 0, 0), (math.pi / 2, 0, 0)),
    ((-0.425, 0, 0), (0, 0, 0)),
    ((-0.3922, 0, 0.1333), (0, 0, 0)),
    ((0, -0.0997, 0), (math.pi / 2, 0, 0)),
    ((0, 0.0996, 0), (math.pi / 2, math.pi, math.pi)),
]
URDF_COM = {
    "ur5e": [
        (0, -0.00193, -0.02561),
        (-0.2125, 0, 0.11336),
        (-0.2422, 0, 0.0265),
        (0, -0.01634, -0.0018),
        (0, 0.01634, -0.0018),
        (0, 0, -0.001159),
    ],
    "ur16e": [
        (0, -0.030, -0.016),
        (-0.1764, 0, 0.16),
        (-0.166, 0, 0.065),
        (0, -0.011, -0.009),
        (0, 0.012, -0.018),
        (0, 0, -0.044),
    ],
}

# In the axes of the DH link frames, as the vendor gives them: ixx iyy izz ixy ixz iyz.
VENDOR_TENSORS = {
    "ur3e": [
        (0.0027657, 0.0021501, 0.0025626, 9.6e-06, -1.49e-05, 0.0001873),
        (0.0042623, 0.0460284, 0.0448947, -4.09e-05, -0.001496, -1.29e-05),
        (0.0010511, 0.0113396, 0.0110895, 0, -3.31e-05, 2.2e-06),
        (0.0008174, 0.0006844, 0.0005497, -5e-07, 2.1e-06, 6.17e-05),
        (0.0006059, 0.0005837, 0.0003831, -6e-07, -6e-07, -2.71e-05),
        (0.000108, 0.0001086, 0.0001371, -1e-07, -1e-07, -2e-07),
    ],
    "ur5e": [
        (0.0070021, 0.00648091, 0.00657286, 7.3e-07, -1.053e-05, 0.00049994),
        (0.01505885, 0.33388086, 0.33247207, -5.4e-05, 5.63e-06, -1.81e-06),
        (0.00399632, 0.07879254, 0.0784851, -1.365e-05, 0.00137272, -6.6e-06),
        (0.00165491, 0.00135962, 0.00126279, -2.82e-06, -4.38e-06, 0.00010157),
        (0.00135617, 0.00127827, 0.00096614, -2.74e-06, 4.44e-06, -5.048e-05),
        (0.00018694, 0.00018908, 0.00025756, 6e-08, -1.7e-07, -9.2e-07),
    ],
    "ur10e": [
        (0.03408, 0.03529, 0.02156, 2e-05, -0.00425, 8e-05),
        (0.02814, 0.77068, 0.76943, 5e-05, -0.01561, 2e-05),
        (0.01014, 0.30928, 0.30646, 8e-05, 0.00916, 0),
        (0.00296, 0.00222, 0.00258, -1e-05, 0, -0.00024),
        (0.00296, 0.00222, 0.00258, -1e-05, 0, -0.00024),
        (0.0004, 0.00041, 0.00034, 0, 0, 0),
    ],
    "ur16e": [
        (0.03351, 0.03374, 0.021, 2e-05, -1e-05, 0.00374),
        (0.02796, 0.47558, 0.47635, -0.0001, -0.0072, 3e-05),
        (0.01091, 0.1206, 0.11714, 6e-05, 0.01012, 1e-05),
        (0.00609, 0.00245, 0.00579, -1e-05, 0, 0.00083),
        (0.00389, 0.00219, 0.00363, -1e-05, 0, -0.00045),
        (0.00117, 0.00118, 0.00084, 0, 0, 0),
    ],
}
VENDOR_MASSES = {
    "ur3e": [1.98, 3.4445, 1.437, 0.871, 0.805, 0.261],
    "ur5e": [3.761, 8.058, 2.846, 1.37, 1.3, 0.365],
    "ur10e": [7.369, 13.051, 3.989, 2.1, 1.98, 0.615],
    "ur16e": [7.369, 10.45, 4.321, 2.18, 2.033, 0.907],
}
VENDOR_COM = {  # in the DH link frames
    "ur3e": [[0, -0.02, 0], [0.13, 0, 0.1157], [0.05, 0, 0.0238], [0, 0, 0.01], [0, 0, 0.01], [0, 0, -0.02]],
    "ur10e": [[0.021, 0, 0.027], [0.38, 0, 0.158], [0.24, 0, 0.068], [0, 0.007, 0.018], [0, 0.007, 0.018], [0, 0, -0.026]],
}


def urdf_step(xyz: tuple[float, ...], rpy: tuple[float, ...], q: float) -> np.ndarray:
    """A URDF joint: fixed-axis roll, pitch, yaw, then the joint's turn about z."""
    (r, p, y), pose = rpy, np.eye(4)
    c, s = math.cos, math.sin
    pose[:3, :3] = [
        [c(y) * c(p), c(y) * s(p) * s(r) - s(y) * c(r), c(y) * s(p) * c(r) + s(y) * s(r)],
        [s(y) * c(p), s(y) * s(p) * s(r) + c(y) * c(r), s(y) * s(p) * c(r) - c(y) * s(r)],
        [-s(p), c(p) * s(r), c(p) * c(r)],
    ]
    pose[:3, 3] = xyz
    turn = np.eye(4)
    turn[:2, :2] = [[c(q), -s(q)], [s(q), c(q)]]
    return pose @ turn


@pytest.mark.parametrize("seed", range(5))
def test_the_ur5e_is_where_its_urdf_says(seed: int) -> None:
    q = np.random.default_rng(seed).uniform(-6, 6, 6)
    frames, pose = joint_frames(ARMS["ur5e"], q), np.eye(4)
    for k, (xyz, rpy) in enumerate(URDF):
        pose = pose @ urdf_step(xyz, rpy, q[k])
        # A URDF link frame is the joint frame moved along its own axis by d.
        along = frames[k][:3, 3] + ARMS["ur5e"].chain.d[k] * frames[k][:3, 2]
        np.testing.assert_allclose(along, pose[:3, 3], atol=1e-9)
        np.testing.assert_allclose(frames[k][:3, :3], pose[:3, :3], atol=1e-9)
    np.testing.assert_allclose(frames[6], pose, atol=1e-9)  # the flange, for wrist_3 has no turn after d


def test_there_are_five_arms() -> None:
    assert sorted(ARMS) == ["iiwa7", "ur10e", "ur16e", "ur3e", "ur5e"]


@pytest.mark.parametrize("arm", ARMS.values(), ids=ARMS)
def test_a_shipped_arm_makes_sense(arm: Arm) -> None:
    assert problems(arm) == []


@pytest.mark.parametrize(
    ("name", "total", "a2", "a3", "d"),
    [
        ("ur3e", 8.7985, -0.24355, -0.2132, [0.15185, 0, 0, 0.13105, 0.08535, 0.0921]),
        ("ur5e", 17.7, -0.425, -0.3922, [0.1625, 0, 0, 0.1333, 0.0997, 0.0996]),
        ("ur10e", 29.104, -0.6127, -0.57155, [0.1807, 0, 0, 0.17415, 0.11985, 0.11655]),
        ("ur16e", 27.26, -0.4784, -0.36, [0.1807, 0, 0, 0.17415, 0.11985, 0.11655]),
    ],
)
def test_lengths_and_total_mass(name: str, total: float, a2: float, a3: float, d: list[float]) -> None:
    arm = ARMS[name]
    assert sum(arm.masses.mass) == pytest.approx(total, abs=1e-9)
    assert arm.chain.a == [0, a2, a3, 0, 0, 0]
    assert arm.chain.d == d
    np.testing.assert_allclose(arm.chain.alpha, np.array([1, 0, 0, 1, -1, 0]) * math.pi / 2)


@pytest.mark.parametrize("name", VENDOR_MASSES)
def test_masses(name: str) -> None:
    assert ARMS[name].masses.mass == VENDOR_MASSES[name]


@pytest.mark.parametrize("name", VENDOR_COM)
def test_centres_of_mass(name: str) -> None:
    assert ARMS[name].masses.com == VENDOR_COM[name]


@pytest.mark.parametrize("name", URDF_COM)
def test_centres_of_mass_agree_with_the_urdf(name: str) -> None:
    arm = ARMS[name]
    for k, expected in enumerate(URDF_COM[name]):
        np.testing.assert_allclose(com_in_joint_frame(arm, k) - [0, 0, arm.chain.d[k]], expected, atol=1e-6)


@pytest.mark.parametrize("k", range(6))
@pytest.mark.parametrize("name", VENDOR_TENSORS)
def test_tensors_are_the_vendors_turned_into_joint_axes(name: str, k: int) -> None:
    xx, yy, zz, xy, xz, yz = VENDOR_TENSORS[name][k]
    in_dh = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    axes = link_transform(ARMS[name], k)[:3, :3]  # columns: the DH axes in joint axes
    for omega in np.random.default_rng(k).normal(size=(6, 3)):  # kinetic energy does not depend on the axes
        energy = omega @ inertia_matrix(ARMS[name].inertias.tensor[k]) @ omega
        assert energy == pytest.approx((axes.T @ omega) @ in_dh @ (axes.T @ omega), rel=1e-7)


def test_upper_arms_turn_hardest_about_axes_across_them() -> None:
    for name in VENDOR_TENSORS:
        xx, yy, zz, *_ = ARMS[name].inertias.tensor[1]
        assert min(yy, zz) > 8 * xx  # the tube runs along x of the joint frame


@pytest.mark.parametrize(
    ("name", "torque", "speed_deg"),
    [
        ("ur3e", [54, 54, 28, 9, 9, 9], [180, 180, 180, 360, 360, 360]),
        ("ur5e", [150, 150, 150, 28, 28, 28], [180] * 6),
        ("ur10e", [330, 330, 150, 54, 54, 54], [120, 120, 180, 180, 180, 180]),
        ("ur16e", [330, 330, 150, 54, 54, 54], [120, 120, 180, 180, 180, 180]),
    ],
)
def test_limits(name: str, torque: list[float], speed_deg: list[float]) -> None:
    limits = ARMS[name].limits
    assert limits.torque == torque
    np.testing.assert_allclose(np.degrees(limits.speed), speed_deg, rtol=1e-12)
    np.testing.assert_allclose(np.degrees(limits.position), 360.0, rtol=1e-12)


def test_the_ur5e_rubs_as_measured() -> None:
    frictions = ARMS["ur5e"].frictions
    assert frictions.speed == [0.01, 0.5, 1.5, 3.2]
    measured = [
        [5.78, 9.53, 13.85, 17.95],
        [6.53, 10.74, 16.06, 21.66],
        [5.02, 8.99, 13.72, 18.30],
        [1.42, 2.41, 3.35, 4.41],
        [1.23, 2.05, 2.96, 3.78],
        [1.26, 2.20, 2.99, 4.00],
    ]
    np.testing.assert_allclose(frictions.torque, measured, rtol=0.01)
    stiction_mNm = [(55.5, 58.9), (63.8, 65.6), (49.7, 49.9), (14.0, 14.1), (12.4, 12.1), (12.5, 12.5)]
    np.testing.assert_allclose(frictions.breakaway, [0.101 * (a + b) / 2 for a, b in stiction_mNm], rtol=0.01)


def test_the_ur10e_rubs_as_identified_by_others() -> None:
    """Viscous and Coulomb friction by the authors of the logs, in their drive gains [N·m/A], at half a radian a second."""
    arm = ARMS["ur10e"]
    viscous = np.array([21.26, 20.22, 10.38, 3.58, 2.49, 3.03])
    coulomb = np.array([12.55, 13.27, 4.99, 2.00, 2.69, 2.30])
    gains = np.array([10.0, 10.6956, 8.4566, 9.0029, 9.4800, 10.1232])
    theirs = (coulomb + 0.5 * viscous) * np.array(arm.motors.gear) * np.array(arm.motors.torque_constant) / gains
    loads = np.array([0.0, 58.0, 23.0, 0.0, 0.0, 0.0])  # mean torque behind the gears in those logs [N·m]
    ours = np.array(arm.frictions.torque)[:, 1] + np.array(arm.frictions.load) * loads
    np.testing.assert_allclose(ours, theirs, rtol=0.05)


@pytest.mark.parametrize("arm", ARMS.values(), ids=ARMS)
def test_friction_grows_ever_more_slowly(arm: Arm) -> None:
    speed, torque = np.array(arm.frictions.speed), np.array(arm.frictions.torque)
    slopes = np.diff(torque, axis=1) / np.diff(speed)
    assert (slopes > 0).all()
    assert (np.diff(slopes, axis=1) < 0).all()


@pytest.mark.parametrize("arm", ARMS.values(), ids=ARMS)
def test_a_motor_moves_its_rated_load_at_full_speed(arm: Arm) -> None:
    for k in range(arm.n):
        full = arm.motors.gear[k] * arm.motors.torque_constant[k] * arm.motors.current[k]
        rubs = np.interp(arm.limits.speed[k], arm.frictions.speed, arm.frictions.torque[k])
        assert full > arm.limits.torque[k] * (1 + arm.frictions.load[k]) + rubs


@pytest.mark.parametrize("arm", ARMS.values(), ids=ARMS)
def test_a_transmission_is_stiffer_by_15_percent_at_rated_torque(arm: Arm) -> None:
    t = arm.transmissions
    for k, rated in enumerate(arm.limits.torque):
        twist = np.roots([t.stiffening[k], 0, t.stiffness[k], -rated])
        twist = twist[np.abs(twist.imag) < 1e-12].real[0]
        assert rated / twist / t.stiffness[k] == pytest.approx(1.15, abs=0.005)
        assert t.hysteresis_stiffness[k] * t.hysteresis_yield[k] == pytest.approx(0.01 * rated, rel=0.05)


@pytest.mark.parametrize("arm", ARMS.values(), ids=ARMS)
def test_the_default_posture_points_the_tool_at_the_floor(arm: Arm) -> None:
    flange = joint_frames(arm, arm.chain.home)[-1]
    np.testing.assert_allclose(flange[:3, 2], [0, 0, -1], atol=0.01)
    assert flange[2, 3] > 0.2
    assert 0.5 * arm.reach < np.linalg.norm(flange[:2, 3]) < 0.95 * arm.reach


def groups(value: object, path: str = "") -> list[tuple[str, Sourced]]:
    found = []
    for name in getattr(value, "__struct_fields__", ()):
        inner = getattr(value, name)
        found += [(f"{path}{name}", inner)] if isinstance(inner, Sourced) else []
        found += groups(inner, f"{path}{name}.")
    return found


@pytest.mark.parametrize("arm", ARMS.values(), ids=ARMS)
def test_every_value_says_where_it_comes_from(arm: Arm) -> None:
    found = dict(groups(arm))
    assert {"chain", "masses", "motors", "frictions", "sensors.encoders", "sensors.current", "accuracy"} <= set(found)
    if arm.sensors.force_torque is not None:
        assert {"outline", "sensors.force_torque.force", "sensors.gyro"} <= set(found)
    for group in found.values():
        assert group.status in ("official", "measured", "assumed")
        assert len(group.source) >= 10


def test_the_flange_sensor_measures_twice_its_rated_range() -> None:
    for name, rated in {"ur3e": 30, "ur5e": 50, "ur10e": 100, "ur16e": 160}.items():
        sensor = ARMS[name].sensors.force_torque
        assert sensor is not None
        assert sensor.force.range == 2 * rated
        assert sensor.force.range > 1.2 * 9.81 * ARMS[name].payload
