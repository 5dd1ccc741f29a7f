"""The estimator against analytic motion, the plant's truth and known pushes."""

from dataclasses import replace

import numpy as np
import pytest

from pendant.all_settings import apply
from pendant.decision import EstimatorCommand
from pendant.inputs import Inputs
from pendant.tick.modes import TICK, Mode
from sim.arm.chain import Body, chain
from sim.arm.frames import joint_frames, rotation_from_rpy
from sim.arm.scenario import Load, Scenario
from sim.estimation.estimator import Estimator
from sim.estimation.joint_tracking import SPEED_BANDWIDTH, TORQUE_BANDWIDTH, tracking_gains
from sim.estimation.transmission_torque import DEFLECTION
from sim.exchange.desk import Wishes
from sim.flange.flange_forces import FlangeForces
from sim.plant.changes import AttachPayload, SensorFault
from sim.plant.touch import Pull
from sim.rigid_body.dynamics import Dynamics
from sim.sensing import calibration
from sim.sensing.sensors import Sample
from tests.sim.arms import PROBE, TWO_KG, UR5E
from tests.sim.bench import CENTRE, LONG, Bench, push

G = 9.81
FLOOR, WALL, TILTED = [0.0, 0.0, 0.0], [0.0, np.pi / 2, 0.0], [0.6, 0.4, 0.2]
BENT = [0.3, -1.2, 1.5, -0.8, -1.2, 0.7]
LEANING = [-2.2138, 1.4963, -1.8777, 0.5938, -0.5613, 0.2716]


def sample(theta: np.ndarray, q: np.ndarray, *, joints: bool = True) -> Sample:
    """Noiseless encoders, no current, no flange sensors."""
    values = np.concatenate([theta, q, np.zeros(24)])
    parts = np.split(values, [6, 12, 18, 24, 27, 30, 33])
    return Sample(values, *parts, np.full(6, 40.0), joints, False, False)


def estimator() -> Estimator:
    rigid = chain(UR5E)
    nothing = Body(0.0, np.zeros(3), np.zeros((3, 3)))
    dynamics = Dynamics(rigid, rigid.links, nothing, mounting=FLOOR, elbow=UR5E.chain.elbow)
    return Estimator(UR5E, calibration.nominal(UR5E), dynamics, np.array(PROBE.tcp))


def follow(angle, ticks: int = 400, bias=None):
    device = estimator()
    for k in range(ticks):
        q = angle(0.002 * k)
        result = device.update(sample(q, q), EstimatorCommand(bias=bias))
    return result


def test_the_kinetic_energy_in_free_drive_is_that_of_links_and_rotors() -> None:
    speed = np.array([0.1, -0.5, 1.0, -2.0, 3.0, 0.3])
    result = follow(lambda t: BENT + speed * t, bias=(0.0,) * 6)
    inertia = estimator()._dynamics.mass(result.q) + np.diag(UR5E.motors.rotor_inertia)
    assert result.whose.energy == pytest.approx(0.5 * speed @ inertia @ speed, rel=1e-6)


def test_a_steady_speed_is_followed_without_lag() -> None:
    speed = np.array([0.1, -0.5, 1.0, -2.0, 3.0, 0.3])
    result = follow(lambda t: BENT + speed * t)
    assert np.allclose(result.qd, speed, atol=1e-9)
    assert np.allclose(result.theta_d, speed, atol=1e-9)
    assert np.allclose(result.qdd, 0.0, atol=1e-7)


def test_a_steady_acceleration_is_followed_in_speed_and_acceleration() -> None:
    acceleration = np.array([0.1, -0.5, 1.0, -2.0, 3.0, 0.3])
    result = follow(lambda t: BENT + 0.5 * acceleration * t * t)
    assert np.allclose(result.qd, acceleration * 0.002 * 399, atol=1e-7)
    assert np.allclose(result.qdd, acceleration, atol=1e-5)


@pytest.mark.parametrize("bandwidth", [SPEED_BANDWIDTH, TORQUE_BANDWIDTH])
def test_the_filters_three_poles_are_at_its_bandwidth(bandwidth: float) -> None:
    alpha, beta, gamma = tracking_gains(bandwidth)
    predict = np.array([[1.0, 0.002, 0.5 * 0.002**2], [0.0, 1.0, 0.002], [0.0, 0.0, 1.0]])
    correct = np.eye(3) - np.outer([alpha, beta, gamma], [1.0, 0.0, 0.0])
    # A triple pole: compare the characteristic polynomial, eigenvalues of a triple root are badly conditioned.
    r = np.exp(-2.0 * np.pi * bandwidth * 0.002)
    assert np.allclose(np.poly(correct @ predict), [1.0, -3.0 * r, 3.0 * r**2, -(r**3)], atol=1e-9)


def test_speeds_at_rest_are_far_below_what_counts_as_moving() -> None:
    bench = Bench(Scenario())
    bench.run(0.5)
    worst = 0.0
    for _ in range(500):
        bench.tick()
        worst = max(worst, float(np.abs(bench.estimate.qd).max()))
    assert worst < 0.005, "rad/s; static is 0.01"


def test_speeds_of_tool_elbow_and_flange_are_those_of_the_kinematics() -> None:
    speed = np.array([0.4, -0.5, 0.3, -0.6, 0.7, 0.9])
    result = follow(lambda t: BENT + speed * (t - 0.002 * 399))
    step = 1e-6

    def points(q: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        frames = joint_frames(UR5E, q)
        return frames[-1][:3, 3], (frames[-1] @ [*PROBE.tcp, 1.0])[:3], frames[UR5E.chain.elbow][:3, 3]

    ahead, behind = points(BENT + step * speed), points(BENT - step * speed)
    flange, tcp, elbow = ((a - b) / (2.0 * step) for a, b in zip(ahead, behind, strict=True))
    assert np.allclose(result.v_F[:3], flange, atol=1e-6)
    assert result.v_tcp == pytest.approx(np.linalg.norm(tcp), abs=1e-6)
    assert result.v_elbow == pytest.approx(np.linalg.norm(elbow), abs=1e-6)
    assert np.allclose(result.tcp, [*points(BENT)[1], *tcp], atol=1e-6)
    assert np.allclose(result.elbow, [*points(BENT)[2], *elbow], atol=1e-6)
    spin = joint_frames(UR5E, BENT + step * speed)[-1][:3, :3] @ joint_frames(UR5E, BENT - step * speed)[-1][:3, :3].T
    turn = np.array([spin[2, 1], spin[0, 2], spin[1, 0]]) / (2.0 * step)
    assert np.allclose(result.v_F[3:], turn, atol=1e-6)


def test_invalid_joints_leave_the_last_estimate_and_do_not_count_as_motion_afterwards() -> None:
    device = estimator()
    q = np.array(BENT)
    for _ in range(100):
        q = q + 0.002 * 0.7
        device.update(sample(q, q))
    nothing = np.full(6, np.nan)
    for _ in range(50):
        result = device.update(sample(nothing, nothing, joints=False))
        assert not result.joints_valid
        assert (result.q == q).all()
        assert np.allclose(result.qd, 0.7, atol=1e-6)
        assert np.isfinite(result.tau_ext).all()
    moved = q + 0.1
    for _ in range(20):
        result = device.update(sample(moved, moved))
        assert result.joints_valid
        assert (result.q == moved).all()
        assert np.abs(result.qd).max() < 1e-9


def test_an_outage_from_the_first_tick_on_is_survived() -> None:
    bench = Bench()
    start = bench.flange
    bench.change(SensorFault(sensor="output_encoder", outage=True))
    bench.run(0.1)
    assert not bench.estimate.joints_valid
    bench.change(SensorFault(sensor="output_encoder"))
    bench.run(0.5)
    assert bench.estimate.joints_valid
    assert np.isfinite(bench.estimate.tau_J).all()
    assert np.linalg.norm(bench.flange - start) < 1e-3


# Torques


def means(bench: Bench, seconds: float, *touches) -> dict[str, np.ndarray]:
    """Means of estimates, and of the true transmission torque, while `touches` last."""
    rows: dict[str, list[np.ndarray]] = {"F_user": [], "tau_ext": [], "tau_J": [], "deflection": [], "true": []}
    for _ in range(round(500 * seconds)):
        bench.run(0.002, *touches)
        now = bench.estimate
        for name in ("F_user", "tau_ext", "tau_J"):
            rows[name].append(getattr(now, name))
        rows["deflection"].append(now.tau_ways[DEFLECTION])
        rows["true"].append(bench.plant.tau_J.copy())
    return {name: np.mean(values, axis=0) for name, values in rows.items()}


@pytest.mark.parametrize("mounting", [FLOOR, WALL, TILTED], ids=["floor", "wall", "tilted"])
@pytest.mark.parametrize("posture", [None, BENT], ids=["home", "bent"])
def test_torque_from_the_deflection_is_the_true_one_on_the_nominal_arm(
    mounting: list[float], posture: list[float] | None
) -> None:
    """Within 0.15 N·m at rest and under a push, hysteresis included."""
    bench = Bench(
        Scenario(mismatch="nominal", mounting=mounting, posture=posture, payload_true=TWO_KG, payload_configured=TWO_KG)
    )
    bench.run(0.4)
    for touches in ((), (push("flange", (30.0, -20.0, 25.0)),), ()):
        bench.run(0.3, *touches)
        seen = means(bench, 0.2, *touches)
        assert np.abs(seen["deflection"] - seen["true"]).max() < 0.15
    assert np.abs(seen["true"]).max() > 5.0, "there must be something to measure"


def test_stiffness_error_shows_in_the_torque_from_the_deflection() -> None:
    scenario = Scenario(seed=3)
    bench = Bench(scenario)
    bench.run(0.5)
    seen = means(bench, 0.2)
    loaded = np.abs(seen["true"]) > 5.0
    wrong = np.abs(seen["deflection"] / seen["true"] - 1.0)[loaded]
    # 20 % of stiffness, and a ripple of 0.1 mrad of the encoder.
    bound = 0.2 + 1e-4 * 1.1 * np.array(UR5E.transmissions.stiffness)[loaded] * 1.2 / np.abs(seen["true"])[loaded]
    assert (wrong < bound + 0.02).all()
    assert wrong.max() > 0.01


@pytest.mark.parametrize("mounting", [FLOOR, WALL, TILTED], ids=["floor", "wall", "tilted"])
def test_a_push_on_the_flange_shows_as_it_is(mounting: list[float]) -> None:
    """F_user: size, direction, sign, axes of B; tau_ext = J^T F up to what the output's own friction holds."""
    force, torque = np.array([12.0, -7.0, 9.0]), np.array([0.5, 0.3, -0.4])
    bench = Bench(Scenario(mismatch="nominal", mounting=mounting, posture=BENT, payload_true=TWO_KG, payload_configured=TWO_KG))
    bench.run(0.5)
    before = means(bench, 0.3)
    assert np.abs(before["F_user"][:3]).max() < 0.1
    assert np.abs(before["F_user"][3:]).max() < 0.01
    touch = push("flange", tuple(force), tuple(torque))
    bench.run(0.5, touch)
    pushed = means(bench, 0.3, touch)
    R_BW = rotation_from_rpy(mounting).T
    expected = np.concatenate([R_BW @ force, R_BW @ torque])
    assert np.abs(pushed["F_user"] - expected)[:3].max() < 0.1
    assert np.abs(pushed["F_user"] - expected)[3:].max() < 0.01
    jacobian = numeric_jacobian(bench.plant.q)
    seen = pushed["tau_ext"] - before["tau_ext"]
    # The output side's dry friction is a tenth of a joint's and keeps what it keeps.
    tolerance = 0.15 + 2.0 * UR5E.frictions.output_share * np.array(UR5E.frictions.breakaway)
    assert (np.abs(seen - jacobian.T @ expected) < tolerance).all()
    assert np.abs(jacobian.T @ expected).max() > 4.0


def numeric_jacobian(q: np.ndarray) -> np.ndarray:
    """Of the flange (6, n), from the frames alone."""
    jacobian, R = np.empty((6, 6)), joint_frames(UR5E, q)[-1][:3, :3]
    for i in range(6):
        step = np.zeros(6)
        step[i] = 1e-6
        ahead, behind = joint_frames(UR5E, q + step)[-1], joint_frames(UR5E, q - step)[-1]
        jacobian[:3, i] = (ahead[:3, 3] - behind[:3, 3]) / 2e-6
        spin = (ahead[:3, :3] - behind[:3, :3]) @ R.T / 2e-6
        jacobian[3:, i] = spin[2, 1], spin[0, 2], spin[1, 0]
    return jacobian


def test_a_push_behind_the_sensor_shows_in_the_joints_alone() -> None:
    bench = Bench()
    bench.run(0.5)
    before = means(bench, 0.3)
    touch = push("wrist_1", (0.0, 25.0, 0.0))
    bench.run(0.5, touch)
    seen = means(bench, 0.3, touch)
    assert np.abs(seen["F_user"] - before["F_user"])[:3].max() < 0.1
    change = seen["tau_ext"] - before["tau_ext"]
    origin = joint_frames(UR5E, bench.plant.q)[3][:3, 3]
    assert change[0] == pytest.approx(25.0 * origin[0], abs=0.3 + 2 * 0.08 * 5.78), "force times lever about the base axis"
    assert np.abs(change[3:]).max() < 0.3, "the wrist beyond it feels nothing"


@pytest.mark.parametrize("seed", range(6))
def test_a_right_payload_is_no_user_force_in_any_posture(seed: int) -> None:
    rng = np.random.default_rng(seed)
    bench = Bench(
        Scenario(
            mismatch="nominal",
            posture=rng.uniform(-3.0, 3.0, 6).tolist(),
            mounting=rng.uniform(-3.0, 3.0, 3).tolist(),
            tool=PROBE,
            payload_true=TWO_KG,
            payload_configured=TWO_KG,
            seed=seed,
        )
    )
    bench.run(0.3)
    seen = means(bench, 0.4)["F_user"]
    assert np.linalg.norm(seen[:3]) < 0.15
    assert np.linalg.norm(seen[3:]) < 0.015


@pytest.mark.parametrize("mounting", [FLOOR, WALL, TILTED], ids=["floor", "wall", "tilted"])
def test_a_payload_that_nobody_configured_looks_like_a_pull_of_its_weight(mounting: list[float]) -> None:
    bench = Bench(Scenario(mismatch="nominal", mounting=mounting))
    bench.run(0.2)
    bench.change(AttachPayload(load=Load(mass=1.5, com=[0.0, 0.0, 0.06])))
    bench.run(1.0)
    seen = means(bench, 0.3)["F_user"]
    down = rotation_from_rpy(mounting).T @ [0.0, 0.0, -1.5 * G]
    assert np.abs(seen[:3] - down).max() < 0.15
    lever = joint_frames(UR5E, bench.plant.q)[-1][:3, :3] @ [0.0, 0.0, 0.06]
    assert np.abs(seen[3:] - np.cross(lever, down)).max() < 0.02


def test_a_payload_that_is_configured_but_absent_looks_like_a_lift() -> None:
    bench = Bench()
    bench.run(0.2)
    bench.tick(Wishes(Inputs(load=Load(mass=1.5, com=[0.0, 0.0, 0.06])), (), ()))
    bench.run(2.0)
    seen = means(bench, 0.3)["F_user"]
    assert np.abs(seen[:3] - [0.0, 0.0, 1.5 * G]).max() < 0.15


@pytest.mark.parametrize("accelerometer", [True, False], ids=["measured", "from the model"])
def test_inertia_of_a_payload_in_fast_motion_is_no_user_force(accelerometer: bool) -> None:
    """2 kg at up to 1.8 m/s and full acceleration."""
    faster = apply(LONG, {"robot_limits.on": False})
    bench = Bench(Scenario(mismatch="nominal", payload_true=TWO_KG, payload_configured=TWO_KG), settings=faster)
    if not accelerometer:
        bench.change(SensorFault(sensor="accelerometer", outage=True))
    bench.run(0.3)
    target = np.add(UR5E.chain.home, [0.8, -0.3, 0.4, 0.3, 0.5, 1.0])
    bench.start_joint_move(target, 1.0)
    worst, fastest, inertial = 0.0, 0.0, 0.0
    for _ in range(280):
        bench.tick()
        now = bench.estimate
        worst, fastest = max(worst, float(np.linalg.norm(now.F_user[:3]))), max(fastest, now.v_tcp)
        inertial = max(inertial, float(np.linalg.norm(now.R_BF @ now.w_sensor[:3] - [0.0, 0.0, 2.13 * G])))
    assert fastest > 1.5
    assert inertial > 20.0
    assert worst < (4.0 if accelerometer else 0.5 * inertial), "accelerations of the joints come late, by their filter"


@pytest.mark.parametrize(("frequency", "most"), [(10.0, 0.25), (30.0, 0.6), (45.0, 0.75)])
def test_a_load_that_swings_with_the_wrists_is_mostly_no_user_force(frequency: float, most: float) -> None:
    """FD-3: the share of its inertia that is taken for a hand's, in the modes of a guided arm, about the flange's origin."""
    rigid, mass, lever = chain(UR5E), 3.0, 0.1
    load = Body(mass, np.array([0.0, 0.0, lever]), np.zeros((3, 3)))
    dynamics = Dynamics(rigid, rigid.links, load, mounting=FLOOR, elbow=UR5E.chain.elbow)
    dynamics.update(np.array(BENT))
    forces, turning = FlangeForces(dynamics), 2.0 * np.pi * frequency
    off = 0.0
    for k in range(300):
        wrench, gyro = np.zeros(6), np.array([0.1 * np.sin(turning * TICK * k), 0.0, 0.0])
        needed = mass * lever * 0.1 * turning * np.cos(turning * TICK * k)
        wrench[1], wrench[3] = -needed, lever * needed
        still = sample(np.zeros(6), np.zeros(6))
        seen = replace(still, wrench=wrench, gyro_tool=gyro, wrench_valid=True, acceleration_valid=True)
        forces.update(seen, np.array(BENT), np.zeros((3, 6)), np.zeros(6))
        off = max(off, float(np.linalg.norm(forces.F_user[:3]))) if k > 100 else 0.0
    assert off < most * mass * lever * 0.1 * turning


def test_what_the_joints_do_not_feel_of_the_sensors_wrench_is_known_in_their_torques() -> None:
    """FD-19: J' F_user - tau_ext; of a wrench that they feel as well nothing is left."""
    rigid, rng = chain(UR5E), np.random.default_rng(1)
    dynamics = Dynamics(rigid, rigid.links, Body(2.0, np.array([0.0, 0.0, 0.1]), np.zeros((3, 3))), mounting=FLOOR, elbow=2)
    still, felt = np.zeros((3, 6)), rng.normal(size=6)
    dynamics.recursion.run(np.array(BENT), still, np.zeros(3))
    forces = FlangeForces(dynamics)
    seen = replace(sample(np.zeros(6), np.zeros(6)), wrench=rng.normal(size=6), wrench_valid=True, acceleration_valid=True)
    forces.update(seen, np.array(BENT), still, felt)
    torques = dynamics.recursion.jacobian.T @ forces.F_user
    assert forces.record[0]["apart"] == pytest.approx(torques - felt)
    forces.update(seen, np.array(BENT), still, torques)
    assert forces.record[0]["apart"] == pytest.approx(np.zeros(6), abs=1e-9)


def test_a_lost_flange_sensor_means_no_user_force() -> None:
    bench = Bench(Scenario(payload_true=TWO_KG))
    bench.run(0.2)
    assert np.linalg.norm(bench.estimate.F_user) > 5.0
    bench.change(SensorFault(sensor="force_torque", channel=2, outage=True))
    bench.run(0.01)
    assert not bench.estimate.wrench_valid
    assert (bench.estimate.F_user == 0.0).all()
    bench.change(SensorFault(sensor="force_torque", channel=2))
    bench.run(0.01)
    assert bench.estimate.wrench_valid
    assert np.linalg.norm(bench.estimate.F_user) > 5.0


def test_motor_torque_comes_from_the_current_and_the_motor_constant() -> None:
    for scenario, error in ((Scenario(mismatch="nominal"), 0.0), (Scenario(seed=2), 0.03)):
        bench = Bench(scenario)
        rows, true = [], []
        for _ in range(300):
            rows.append(bench.estimate.tau_m if bench.simulation.tick_count else np.zeros(6))
            bench.run(0.002, push("flange", CENTRE))
            dofs = [bench.plant.model.joint(f"theta/{name}").dofadr[0] for name in UR5E.chain.joints]
            true.append(bench.plant.data.qfrc_applied[dofs].copy())
        seen, applied = np.mean(rows[100:], axis=0), np.mean(true[98:-2], axis=0)
        assert np.allclose(seen, applied, rtol=error + 0.002, atol=0.05)


@pytest.mark.parametrize(
    ("mounting", "down"), [(FLOOR, [0.0, 0.0, -G]), (WALL, [G, 0.0, 0.0]), ([np.pi, 0.0, 0.0], [0.0, 0.0, G])]
)
def test_gravity_is_given_in_the_axes_of_the_base(mounting: list[float], down: list[float]) -> None:
    """On a wall z of B is along x of W, so that down is along x of B."""
    rigid = chain(UR5E)
    nothing = Body(0.0, np.zeros(3), np.zeros((3, 3)))
    device = Estimator(
        UR5E,
        calibration.nominal(UR5E),
        Dynamics(rigid, rigid.links, nothing, mounting=mounting, elbow=2),
        np.zeros(3),
    )
    result = device.update(sample(np.zeros(6), np.zeros(6)))
    np.testing.assert_allclose(result.g_B, down, atol=1e-12)
    assert result.copy().g_B is not result.g_B


def test_the_joints_tell_a_force_on_the_flange() -> None:
    """Against the damped least squares of the textbook, and near a push that really acts."""
    bench = Bench(Scenario(mismatch="nominal", posture=[0.3, -1.2, 1.4, -1.3, -1.2, 0.2]))
    bench.run(0.5)
    before = bench.estimate.F_joints
    bench.run(0.5, push("flange", (20.0, -15.0, 25.0)))
    seen = bench.estimate
    jacobian = bench.simulation.estimator.jacobian[:3]
    expected = np.linalg.solve(jacobian @ jacobian.T + 0.01 * np.eye(3), jacobian @ seen.tau_ext)
    assert np.allclose(seen.F_joints, expected, atol=1e-9)
    assert np.linalg.norm(seen.F_joints - before - [20.0, -15.0, 25.0]) < 12.0


def test_gravity_is_taken_off_what_the_accelerometer_feels() -> None:
    """On a wall: next to nothing at rest, in axes of B; a copy keeps it."""
    bench = Bench(Scenario(mismatch="nominal", mounting=WALL, posture=[0.3, -1.2, 1.4, -1.3, -1.2, 0.2]))
    bench.run(0.2)
    seen = bench.estimate
    np.testing.assert_allclose(seen.a_felt, seen.R_BF @ seen.a_F + seen.g_B, atol=1e-12)
    assert np.linalg.norm(seen.a_F) > 9.0
    assert np.linalg.norm(seen.a_felt) < 0.5
    assert seen.copy().a_felt is not seen.a_felt


@pytest.mark.parametrize(
    ("part", "forwards"), [("elbow", [0.0, -0.905, -0.425]), ("flange", [0.0, 0.0, -1.0])], ids=["elbow", "flange"]
)
def test_a_hand_is_never_learned(part: str, forwards: list[float]) -> None:
    """AF-2: on a link no sensor tells its force, so it would pass for less friction and another gear, and stay when it has gone.
    Nor at the flange: what joints feel would shift, and what they felt at entry would tell no more who pushes a link.
    """
    load = Load(mass=1.0, com=[0.0, 0.0, 0.05])
    posture = [1.58, -1.13, 0.67, -2.17, 2.3, -1.33]
    bench = Bench(Scenario(seed=1003, posture=posture, payload_true=load, payload_configured=load))
    bench.enter()
    estimator = bench.simulation.estimator
    known = (estimator.friction.terms.copy(), estimator.transmission.stiffer.copy())
    untouched = means(bench, 0.3)["tau_ext"]
    body = bench.plant.model.body(part).id
    start = bench.plant.data.xpos[body].copy()
    target = start.copy()
    for k in range(500):
        target += np.array(forwards) * 0.1 * 0.002 * min(k / 100.0, 1.0)
        bench.run(0.002, Pull(part, CENTRE, tuple(target), 300.0))
    assert (bench.plant.data.xpos[body] - start) @ forwards > 0.055, "it goes along"
    assert bench.mode is Mode.FREE_DRIVE, "who guides the arm by its elbow is somebody (FD-19)"
    assert (estimator.friction.terms == known[0]).all()
    assert (estimator.transmission.stiffer == known[1]).all()
    bench.run(0.5)
    assert np.abs(means(bench, 0.3)["tau_ext"] - untouched).max() < 4.0


def pushed_and_left(bench: Bench) -> np.ndarray:
    """Change (6,) of what the joints feel from before a push of 0.87 s at the flange to after it [N·m]."""
    untouched = means(bench, 0.1)["tau_ext"]
    bench.run(0.87, push("flange", (-16.3, 9.7, -17.1)))
    bench.run(0.5)
    return np.abs(means(bench, 0.1)["tau_ext"] - untouched)


def test_an_arm_that_is_held_learns_nothing_from_a_push() -> None:
    """AF-2, AF-3: what it swings by as the hand lets go is no motion of its own; nothing is left of the push (FD-5e)."""
    load = Load(mass=4.643, com=[0.0, 0.0, 0.05])
    bench = Bench(Scenario(seed=2303, mounting=TILTED, posture=LEANING, payload_true=load, payload_configured=load))
    bench.run(0.5)
    estimator = bench.simulation.estimator
    known = (estimator.friction.terms.copy(), estimator.transmission.stiffer.copy())
    for _ in range(3):
        assert pushed_and_left(bench).max() < 2.0
    assert (estimator.friction.terms == known[0]).all()
    assert (estimator.transmission.stiffer == known[1]).all()
