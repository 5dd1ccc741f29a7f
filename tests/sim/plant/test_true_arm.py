"""The plant against analytic mechanics: weight, free motion, energy, friction, step size."""

import math
from typing import NamedTuple

import mujoco
import numpy as np
import pytest

from pendant.tick.modes import TICK
from sim.arm.arm_file import Arm
from sim.arm.scenario import Load, Scenario
from sim.plant.applied_touches import RESPONSE
from sim.plant.joint_friction import Friction, Sliding, input_side
from sim.plant.model import Step
from sim.plant.touch import Pull, Push
from sim.plant.true_arm import Plant
from tests.sim.arms import PROBE, TWO_KG, UR5E, arms

G = 9.81


def dofs(plant: Plant, prefix: str = "q") -> np.ndarray:
    return np.array([plant.model.joint(f"{prefix}/{name}").dofadr[0] for name in plant.arm.chain.joints])


def gravity_torque(plant: Plant) -> np.ndarray:
    return plant.data.qfrc_bias[dofs(plant)].copy()


@pytest.mark.parametrize("arm", arms(), ids=lambda arm: arm.name)
def test_weight_on_the_flange_sensor_in_any_posture(arm: Arm) -> None:
    rng = np.random.default_rng(1)
    for _ in range(8):
        posture = rng.uniform(-3.0, 3.0, arm.n).tolist()
        plant = Plant(arm, Scenario(posture=posture, tool=PROBE, payload_true=TWO_KG, mounting=rng.uniform(-3, 3, 3).tolist()))
        sensor = arm.sensors.force_torque
        assert sensor is not None
        weight = G * (2.0 + 0.3 + sensor.plate_mass)
        force = plant.flange[:3]
        assert abs(np.linalg.norm(force) - weight) < 0.1
        up = plant.data.xmat[plant.model.body("flange").id].reshape(3, 3).T @ [0.0, 0.0, 1.0]
        assert np.abs(force - weight * up).max() < 0.1, "the flange pushes its load up"


def test_weight_stays_on_the_sensor_while_the_arm_stands() -> None:
    plant = Plant(UR5E, Scenario(payload_true=Load(mass=3.0)))
    torque = gravity_torque(plant)
    forces = []
    for _ in range(250):
        plant.advance(torque)
        forces.append(np.linalg.norm(plant.flange[:3]))
    sensor = UR5E.sensors.force_torque
    assert sensor is not None
    assert abs(np.mean(forces) - G * (3.0 + sensor.plate_mass)) < 0.1


def test_a_standing_arm_stays_where_it_is() -> None:
    plant = Plant(UR5E, Scenario(payload_true=TWO_KG))
    start, torque = plant.q.copy(), gravity_torque(plant)
    for _ in range(1000):
        plant.advance(torque)
    assert np.abs(plant.q - start).max() < 1e-4
    assert np.abs(plant.qd).max() < 1e-5


@pytest.mark.parametrize("arm", arms(), ids=lambda arm: arm.name)
def test_brakes_take_the_weight_over_within_a_fraction_of_a_millimetre_and_give_it_back(arm: Arm) -> None:
    """Stretched out with 2 kg, the drive goes off as the brakes close; later it comes back as they open.

    The bristles of a joint at rest give 0.2 mrad before it breaks away, and twice that in a swing. Shoulder and elbow have levers
    of the whole and of half the reach.
    """
    plant = Plant(arm, Scenario(payload_true=TWO_KG, posture=[0.0, -0.2, 0.2, 0.0, 0.5, 0.0]))
    flange = plant.model.body("flange").id
    start, torque = plant.data.xpos[flange].copy(), gravity_torque(plant)
    farthest = 0.0
    for braked in (True, False):
        for _ in range(500):
            plant.advance(np.zeros(arm.n) if braked else torque, braked=braked)
            farthest = max(farthest, float(np.linalg.norm(plant.data.xpos[flange] - start)))
        assert np.abs(plant.qd).max() < 2e-3
    assert 1e-6 < farthest < 2.0 * 0.2e-3 * 1.5 * arm.reach


def test_free_acceleration_is_force_over_mass_and_parallel() -> None:
    plant = Plant(UR5E, Scenario(payload_true=Load(mass=2.0, com=[0.0, 0.0, 0.0])))
    sensor = UR5E.sensors.force_torque
    assert sensor is not None
    mass = 2.0 + sensor.plate_mass
    base = gravity_torque(plant)
    start = plant.flange.copy()
    for k in range(100):
        plant.advance(base + np.array([30.0, 40.0, -20.0, 5.0, 3.0, 1.0]) * np.sin(0.1 * k))
        force, acceleration = plant.flange[:3], plant.flange[12:15]
        # Centre of the load in the sensor's origin: force is mass times specific force, whatever the arm does.
        assert np.abs(force - mass * acceleration).max() < 0.02 * max(1.0, float(np.linalg.norm(force)))
    change_f, change_a = plant.flange[:3] - start[:3], plant.flange[12:15] - start[12:15]
    assert np.linalg.norm(change_a) > 0.5, "the motion must be a real one"
    assert change_f @ change_a > 0.999 * np.linalg.norm(change_f) * np.linalg.norm(change_a)


def energy(plant: Plant) -> float:
    """Kinetic, gravity, springs (main, hysteresis, sensor) and bristles, from first principles [J]."""
    model, data = plant.model, plant.data
    mass = np.zeros((model.nv, model.nv))
    mujoco.mj_fullM(model, data, mass)
    total = 0.5 * data.qvel @ mass @ data.qvel + G * (model.body_mass * data.xipos[:, 2]).sum()
    values = plant.arm.transmissions
    for i, name in enumerate(plant.arm.chain.joints):
        x = float(data.joint(f"theta/{name}").qpos[0] - data.joint(f"q/{name}").qpos[0])
        rest = data.plastic[model.tendon_plasticadr[model.tendon(f"hysteresis/{name}").id]]
        total += 0.5 * values.stiffness[i] * x**2 + 0.25 * values.stiffening[i] * x**4
        total += 0.5 * values.hysteresis_stiffness[i] * (x - rest) ** 2
        for side in ("theta", "q"):
            rub = model.actuator(f"friction/{side}/{name}")
            total += 0.5 * model.actuator_dynprm[rub.id, 5] * data.act[model.actuator_actadr[rub.id]] ** 2
    for axis in "xyz":
        slide = model.joint(f"sensor/{axis}")
        total += 0.5 * model.jnt_stiffness[slide.id] * data.qpos[slide.qposadr[0]] ** 2
    return float(total)


@pytest.mark.parametrize("arm", arms(), ids=lambda arm: arm.name)
def test_energy_of_the_passive_arm_never_grows(arm: Arm) -> None:
    plant = Plant(arm, Scenario(payload_true=Load(mass=1.0)))
    plant.model.actuator_biasprm[:, 0] = 0.0  # torque ripple is the motor's, and a motor is not passive
    means = []
    for _ in range(50):
        block = []
        for _ in range(10):
            plant.advance(np.zeros(arm.n))
            block.append(energy(plant))
        means.append(np.mean(block))
    assert means[0] - means[-1] > 0.1, "the arm must have fallen and lost energy to friction"
    assert max(np.diff(means)) < 1e-3


def friction_at(arm: Arm, joint: int, speed: float, wear: float = 1.0) -> float:
    """Mean motor torque [N·m] that turns one worn joint at a constant speed without gravity, both directions."""
    result = []
    for sign in (1.0, -1.0):
        plant = Plant(arm, Scenario(posture=[0.0, -1.57, 0.0, -1.57, 0.0, 0.0]))
        plant.model.opt.gravity[:] = 0.0
        plant.wear(joint, wear)
        for prefix in ("q", "theta"):
            plant.data.qvel[dofs(plant, prefix)[joint]] = sign * speed  # already turning: no acceleration to wait for
        target = plant.theta.copy()
        torques, integral = [], np.zeros(arm.n)
        ticks = 750 if speed < 0.1 else 500
        for k in range(ticks):
            target[joint] += 0.002 * sign * speed
            wanted = np.zeros(arm.n)
            wanted[joint] = sign * speed
            inertia = np.array(arm.motors.rotor_inertia)
            error = target - plant.theta
            integral += 0.002 * error
            torque = inertia * (4000.0 * error + 120.0 * (wanted - plant.theta_d) + 8000.0 * integral)
            plant.advance(torque)
            if k >= ticks // 2:
                torques.append(sign * torque[joint])
        result.append(np.mean(torques))
    return float(np.mean(result))


@pytest.mark.parametrize("joint", range(6))
def test_friction_is_the_measured_curve_of_a_ur5e(joint: int) -> None:
    """Joint friction at 0.01, 0.5, 1.5 and 3.2 rad/s: motor torques of the factory calibration that the arm's file names, times
    the gear ratio of 101."""
    measured = (
        (5.78, 9.53, 13.85, 17.95),
        (6.53, 10.74, 16.06, 21.66),
        (5.02, 8.99, 13.72, 18.30),
        (1.42, 2.41, 3.35, 4.41),
        (1.23, 2.05, 2.96, 3.78),
        (1.26, 2.20, 2.99, 4.00),
    )[joint]
    for speed, torque in zip((0.01, 0.5, 1.5, 3.2), measured, strict=True):
        assert friction_at(UR5E, joint, speed) == pytest.approx(torque, rel=0.05), f"at {speed} rad/s"


@pytest.mark.parametrize("wear", [0.0, 0.5, 2.0])
def test_a_worn_joint_rubs_so_many_times_as_much_on_both_sides(wear: float) -> None:
    """8 % of it are on the output side: a factor on the other side alone would leave 4 % too little at 2."""
    assert friction_at(UR5E, 2, 1.5, wear) / friction_at(UR5E, 2, 1.5) == pytest.approx(wear, rel=0.01, abs=0.01)


def test_friction_rises_with_load_and_wear_and_falls_with_temperature() -> None:
    friction = Friction(UR5E)
    speed, out = np.full(6, 0.5), np.zeros((4, 6))
    cold, warm = np.full(6, 44.0), np.full(6, 54.0)
    input_side(friction.record, Sliding(speed, np.zeros(6), cold), out[0])
    input_side(friction.record, Sliding(speed, np.full(6, -40.0), cold), out[1])
    input_side(friction.record, Sliding(speed, np.zeros(6), warm), out[2])
    friction.wear(slice(None), 1.4)
    input_side(friction.record, Sliding(speed, np.zeros(6), cold), out[3])
    assert np.allclose(out[1] - out[0], 40.0 * np.array(UR5E.frictions.load))
    assert np.allclose(out[2] / out[0], 1.0 + 10.0 * UR5E.frictions.per_kelvin)
    assert np.allclose(out[3] / out[0], 1.4)


def bump_response(substeps: int) -> np.ndarray:
    """Deflections (ticks, n) after a half-sine bump of 10 ms, motors standing [rad]."""
    plant = Plant(UR5E, Scenario(payload_true=Load(mass=1.0)), Step(substeps))
    torque = gravity_torque(plant)
    rows = []
    for k in range(200):
        force = 100.0 * np.sin(np.pi * min(k, 5) / 5.0)
        plant.advance(torque, (Push("flange", (0.0, 0.0, 0.0), (force, force, force)),))
        rows.append(plant.theta - plant.q)
    return np.array(rows)


def test_half_the_step_leaves_joint_vibration_as_it_is() -> None:
    coarse, fine = bump_response(8), bump_response(16)
    swing = np.ptp(fine, axis=0)
    assert (swing > 1e-5).sum() >= 4, "the bump must shake the joints"
    shaken = swing > 1e-5
    assert (np.abs(np.ptp(coarse, axis=0) / swing - 1.0)[shaken] < 0.02).all()
    compared = 0
    for joint in np.flatnonzero(shaken):
        for band in (ARM_MODES, WRIST_MODES):
            whole, half = (main_line(np.diff(response[10:, joint]), *band) for response in (coarse, fine))
            if half.share > 0.4:
                compared += 1
                assert half.frequency > band[0] + 1.0, "a line, not the foot of one below"
                assert whole.frequency == pytest.approx(half.frequency, rel=0.02)
    assert compared >= 6


ARM_MODES, WRIST_MODES = (4.0, 40.0), (40.0, 200.0)  # [Hz]


class Line(NamedTuple):
    """The largest line of a band of a spectrum."""

    frequency: float  # [Hz]
    share: float  # of the largest line of all


def main_line(signal: np.ndarray, low: float, high: float) -> Line:
    """The largest line between two frequencies [Hz], interpolated by zero padding."""
    x = (signal - signal.mean()) * np.hanning(signal.size)
    spectrum, frequencies = np.abs(np.fft.rfft(x, 16384)), np.fft.rfftfreq(16384, 0.002)
    band = np.flatnonzero((frequencies > low) & (frequencies < high))
    at = band[np.argmax(spectrum[band])]
    return Line(float(frequencies[at]), float(spectrum[at] / spectrum.max()))


def test_a_push_acts_at_its_point() -> None:
    plant = Plant(UR5E, Scenario())
    plant.advance(gravity_torque(plant), (Push("elbow", (-0.2, 0.0, 0.0), (10.0, -5.0, 3.0), (0.5, 0.0, 0.0)),))
    body = plant.model.body("elbow").id
    point = np.array(plant.hands.touched[0][1])
    force, torque = plant.data.xfrc_applied[body, :3], plant.data.xfrc_applied[body, 3:]
    assert np.allclose(force, [10.0, -5.0, 3.0])
    assert np.allclose(torque, np.cross(point - plant.data.xipos[body], force) + np.array([0.5, 0.0, 0.0]), atol=0.02)
    plant.advance(gravity_torque(plant))
    assert not plant.data.xfrc_applied.any(), "a push ends with its tick"


def pulled(way: float, ticks: int) -> np.ndarray:
    """Force (3,) of a hand [N] that pulls the flange of a braked arm along y for so many ticks."""
    plant = Plant(UR5E, Scenario())
    flange = plant.data.xpos[plant.model.body("flange").id].copy()
    touch = Pull("flange", (0.0, 0.0, 0.0), tuple(flange + np.array([0.0, way, 0.0])), 50.0)
    for _ in range(ticks):
        plant.advance(gravity_torque(plant), (touch,), braked=True)
    return np.array(plant.hands.touched[0][2])


def test_the_hand_pulls_like_a_spring_and_never_beyond_its_cap() -> None:
    assert np.allclose(pulled(0.02, 200), [0.0, 800.0 * 0.02, 0.0], atol=1.0)
    assert np.linalg.norm(pulled(9.0, 200)) == pytest.approx(50.0)


@pytest.mark.parametrize("ticks", [1, 5, 15, 30])
def test_a_hands_force_comes_as_fast_as_a_hand_is(ticks: int) -> None:
    """No step of force: it begins where it takes hold, and goes on with its time constant."""
    share = 1.0 - math.exp(-ticks * TICK / RESPONSE)
    assert np.linalg.norm(pulled(0.02, ticks)) == pytest.approx(16.0 * share, abs=0.8)


def test_a_hand_that_takes_hold_again_begins_at_no_force() -> None:
    plant = Plant(UR5E, Scenario())
    flange = plant.data.xpos[plant.model.body("flange").id].copy()
    touch = Pull("flange", (0.0, 0.0, 0.0), tuple(flange + np.array([0.0, 0.05, 0.0])), 50.0)
    for touches in [(touch,)] * 100 + [()] * 1 + [(touch,)]:
        plant.advance(gravity_torque(plant), touches, braked=True)
    assert np.linalg.norm(plant.hands.touched[0][2]) < 8.0, "40 N before; the arm swings back against its damping"


def test_an_unknown_part_is_an_error() -> None:
    plant = Plant(UR5E, Scenario())
    with pytest.raises(KeyError):
        plant.advance(np.zeros(6), (Push("knee", (0.0, 0.0, 0.0), (1.0, 0.0, 0.0)),))


def test_a_dropped_payload_leaves_the_sensor_and_falls() -> None:
    plant = Plant(UR5E, Scenario(payload_true=TWO_KG))
    torque = gravity_torque(plant)
    plant.advance(torque)
    before = plant.payload.pose()
    plant.drop()
    for _ in range(20):
        plant.advance(torque)
    after = plant.payload.pose()
    assert before is not None
    assert after is not None
    assert plant.payload.load.mass == 0.0
    # 40 ms of free fall: 9.81 · 0.04² / 2 = 7.8 mm; what it had of the flange's speed is small.
    assert before[2] - after[2] == pytest.approx(0.5 * G * 0.04**2, rel=0.1)
    for _ in range(500):
        plant.advance(torque)
    rest = plant.payload.pose()
    assert rest is not None
    assert rest[2] == pytest.approx(0.05)


def test_attaching_a_payload_adds_its_weight() -> None:
    plant = Plant(UR5E, Scenario())
    plant.payload.attach(Load(mass=1.5))
    body = plant.model.body("payload").id
    assert plant.model.body_subtreemass[plant.model.body("flange").id] == pytest.approx(1.5 + 0.13)
    assert plant.model.body_mass[body] == 1.5


def test_joints_warm_up_by_friction_and_cool_down_without() -> None:
    plant = Plant(UR5E, Scenario())
    plant.temperature[:] = 40.0
    for _ in range(100):
        plant.advance(gravity_torque(plant))
    loss_rate = (40.0 - UR5E.thermals.ambient) / UR5E.thermals.resistance[0] / UR5E.thermals.capacity[0]
    assert 40.0 - plant.temperature[0] == pytest.approx(0.2 * loss_rate, rel=0.05)
