"""Sensors: noise, quantisation, saturation, lateness, faults, and that they average what they should."""

import copy
from types import SimpleNamespace

import msgspec
import mujoco
import numpy as np
import pytest

from sim.arm.scenario import Scenario
from sim.plant.changes import SensorFault
from sim.plant.true_arm import Plant
from sim.sensing import calibration
from sim.sensing.sensor_drift import SensorDrift
from sim.sensing.sensors import Sample, Sensors
from tests.sim.arms import UR5E
from tests.sim.bench import Bench, push

SENSOR = UR5E.sensors
FORCE_TORQUE = SENSOR.force_torque
assert FORCE_TORQUE is not None
GEAR = np.array(UR5E.motors.gear)
MOTOR = 2.0 * np.pi / SENSOR.encoders.motor_counts / GEAR
OUTPUT = np.full(6, 2.0 * np.pi / SENSOR.encoders.output_counts)


def column(channels: tuple[float, ...], count: int) -> np.ndarray:
    return np.tile(channels, (count, 1)).T


def inertial() -> list[np.ndarray]:
    assert SENSOR.accelerometer is not None
    assert SENSOR.gyro is not None
    return [column((c.range, c.quantum, c.noise), 3) for c in (SENSOR.accelerometer, SENSOR.gyro)]


SPAN, QUANTUM, NOISE = np.hstack([
    [np.full(6, np.inf), MOTOR, SENSOR.encoders.noise_counts * MOTOR],
    [np.full(6, np.inf), OUTPUT, SENSOR.encoders.noise_counts * OUTPUT],
    column((SENSOR.current.range, SENSOR.current.quantum, SENSOR.current.noise), 6),
    column((FORCE_TORQUE.force.range, FORCE_TORQUE.force.quantum, FORCE_TORQUE.force.noise), 3),
    column((FORCE_TORQUE.torque.range, FORCE_TORQUE.torque.quantum, FORCE_TORQUE.torque.noise), 3),
    *inertial(),
    *inertial(),
])  # fmt: skip
"""Of all 36 channels, in the order of `Sample.values`, from the arm's file."""


class Still:
    """A plant that says what it is told to."""

    def __init__(self) -> None:
        self.tick = 0
        self.step = SimpleNamespace(tick=0.002)
        self.theta, self.q, self.current = np.zeros((3, 6))
        self.flange = np.zeros(18)
        self.temperature = np.full(6, 40.0)

    def set(self, value: float) -> None:
        for array in (self.theta, self.q, self.current, self.flange):
            array[:] = value


def sensors(seed: int = 1, errors: calibration.Calibration | None = None, drift: SensorDrift | None = None) -> Sensors:
    return Sensors(UR5E, errors or calibration.nominal(UR5E), np.random.default_rng(seed), drift)


def drifting(errors: calibration.Calibration, seed: int = 1) -> SensorDrift:
    """The drift of the arm's file."""
    assert FORCE_TORQUE is not None
    assert FORCE_TORQUE.drift is not None
    return SensorDrift(FORCE_TORQUE.drift, errors, np.random.default_rng(seed))


def read(device: Sensors, plant: Still) -> Sample:
    """One tick."""
    sample = copy.deepcopy(device.read(plant, plant.current))
    plant.tick += 1
    return sample


def samples(device: Sensors, plant: Still, count: int) -> np.ndarray:
    return np.array([read(device, plant).values for _ in range(count)])


def test_noise_and_quantisation_have_the_size_of_the_arms_file() -> None:
    plant = Still()
    plant.set(0.1234)
    values = samples(sensors(), plant, 6000)
    # Rounding adds the variance of a uniform error of one quantum.
    expected = np.sqrt(NOISE**2 + QUANTUM**2 / 12.0)
    assert np.allclose(values.std(axis=0), expected, rtol=0.06)
    assert (np.abs(values.mean(axis=0) - 0.1234) < 5.0 * expected / np.sqrt(6000)).all(), "no error but noise on the nominal arm"
    counts = values / QUANTUM
    assert np.abs(counts - np.rint(counts)).max() < 1e-3, "whole counts only"
    assert (np.ptp(counts, axis=0) >= 1.0).all(), "no channel is frozen"


def test_noise_differs_from_channel_to_channel_and_from_tick_to_tick() -> None:
    values = samples(sensors(), Still(), 4000)
    spread = values / values.std(axis=0)
    correlation = spread.T @ spread / 4000 - np.eye(36)
    assert np.abs(correlation).max() < 0.1
    assert np.abs((spread[1:] * spread[:-1]).mean(axis=0)).max() < 0.1


def test_measurements_arrive_one_tick_late() -> None:
    plant, device = Still(), sensors()
    samples(device, plant, 3)
    plant.set(2.0)
    assert np.abs(read(device, plant).values).max() < 1.0, "in the tick of the change the old value arrives"
    assert np.abs(read(device, plant).values - 2.0).max() < 1.0


def test_sensors_saturate_at_their_range_both_ways() -> None:
    plant, device = Still(), sensors()
    for sign in (1.0, -1.0):
        plant.set(sign * 1e4)
        values = samples(device, plant, 3)[-1]
        limited = np.isfinite(SPAN)
        assert (values[limited] == sign * SPAN[limited]).all()
        assert np.allclose(values[~limited], sign * 1e4), "encoders count on"


def test_the_same_source_of_noise_gives_the_same_samples() -> None:
    first, again, other = (samples(sensors(seed), Still(), 1200) for seed in (1, 1, 2))
    assert first.tobytes() == again.tobytes()
    assert (first != other).any(axis=0).all()


FIRST = {"motor_encoder": 0, "output_encoder": 6, "current": 12, "force_torque": 18, "accelerometer": 24, "gyro": 27}
"""Index of each sensor's first channel."""


@pytest.mark.parametrize("name", FIRST)
def test_step_drift_and_noise_factor_of_one_channel(name: str) -> None:
    plant, device = Still(), sensors()
    samples(device, plant, 3)
    k = FIRST[name] + 1
    unit = max(QUANTUM[k], NOISE[k])
    device.fault(SensorFault(sensor=name, channel=1, offset=100.0 * unit, drift=50.0 * unit, noise_factor=4.0))
    values = samples(device, plant, 2001)[1:]
    time = 0.002 * np.arange(1, 2001)
    rate, start = np.polyfit(time, values[:, k], 1)
    assert start == pytest.approx(100.0 * unit, abs=unit)
    assert rate == pytest.approx(50.0 * unit, abs=unit)
    noise = (values[:, k] - start - rate * time).std()
    assert noise == pytest.approx(np.hypot(4.0 * NOISE[k], QUANTUM[k] / np.sqrt(12.0)), rel=0.1)
    others = np.delete(values, k, axis=1)
    assert np.allclose(others.std(axis=0), np.delete(np.sqrt(NOISE**2 + QUANTUM**2 / 12.0), k), rtol=0.1)
    assert (np.abs(others.mean(axis=0)) < np.delete(unit_of_mean(2000), k)).all(), "the others go on as they were"


def unit_of_mean(count: int) -> np.ndarray:
    return 5.0 * np.sqrt(NOISE**2 + QUANTUM**2 / 12.0) / np.sqrt(count)


def test_a_fault_of_the_whole_sensor_reaches_all_its_channels_on_both_faces() -> None:
    plant, device = Still(), sensors()
    device.fault(SensorFault(sensor="accelerometer", offset=20.0))
    device.fault(SensorFault(sensor="motor_encoder", offset=1.0))
    values = samples(device, plant, 5)[-1]
    moved = np.abs(values) > 0.9
    assert np.flatnonzero(moved).tolist() == [0, 1, 2, 3, 4, 5, 24, 25, 26, 30, 31, 32]


@pytest.mark.parametrize("channel", [None, 1])
@pytest.mark.parametrize("name", FIRST)
def test_an_outage_is_not_a_number_and_says_so_as_long_as_it_lasts(name: str, channel: int | None) -> None:
    plant, device = Still(), sensors()
    samples(device, plant, 3)

    def flags(sample: Sample) -> tuple[bool, bool, bool]:
        return sample.joints_valid, sample.wrench_valid, sample.acceleration_valid

    broken = tuple(
        name not in group
        for group in (("motor_encoder", "output_encoder", "current"), ("force_torque",), ("accelerometer", "gyro"))
    )
    device.fault(SensorFault(sensor=name, channel=channel, outage=True))
    seen = [read(device, plant) for _ in range(4)]
    device.fault(SensorFault(sensor=name, channel=channel))
    seen += [read(device, plant) for _ in range(3)]
    # What was measured in ticks 0 to 3 arrives in ticks 1 to 4.
    out = [not np.isfinite(sample.values).all() for sample in seen]
    assert out == [False, True, True, True, True, False, False]
    assert [flags(sample) for sample in seen] == [broken if bad else (True, True, True) for bad in out]
    missing = np.flatnonzero(np.isnan(seen[2].values))
    size = {"force_torque": 6, "accelerometer": 3, "gyro": 3}.get(name, 6)
    first = FIRST[name]
    whole = [*range(first, first + size), *(range(first + 6, first + 9) if size == 3 else ())]
    assert missing.tolist() == (whole if channel is None else [first + channel])


def test_the_flange_sensor_is_off_by_its_offset_and_follows_its_drift() -> None:
    errors = calibration.draw(UR5E, np.random.default_rng(8))
    plant, device, alone = Still(), sensors(errors=errors, drift=drifting(errors)), drifting(errors)
    values = samples(device, plant, 30001)[1:, 18:24]
    begin, end = values[:500].mean(axis=0), values[-500:].mean(axis=0)
    sigma = 5.0 * NOISE[18:24] / np.sqrt(500)
    moved = np.cumsum([alone.step() for _ in range(60)], axis=0)  # by the end of each second
    assert (np.abs(begin - errors.wrench_offset) < sigma + 0.05).all()
    assert (np.abs(begin[:3]) < 4.0 + sigma[:3]).all()
    assert (np.abs(begin[3:]) < 0.3 + sigma[3:]).all()
    minute = end - begin  # 59 s lie between the middles of both
    assert np.allclose(minute, moved[58:].mean(axis=0) - 0.5 * moved[0], atol=2.0 * sigma.max())
    assert np.abs(minute[:3]).max() > 0.05, "it does drift"


def test_between_two_seconds_the_zero_moves_evenly() -> None:
    errors = calibration.draw(UR5E, np.random.default_rng(8))
    plant, device, alone = Still(), sensors(errors=errors, drift=drifting(errors)), drifting(errors)
    device.read(plant, plant.current)  # as it comes late: the first sample is taken before any time has passed
    zeros = []
    for _ in range(1500):
        read(device, plant)
        zeros.append(device.wrench_offset)
    start = errors.wrench_offset
    for second in range(3):
        rate = alone.step()
        assert np.allclose(np.diff([start, *zeros], axis=0)[500 * second : 500 * second + 500], 0.002 * rate, atol=1e-14)
        assert np.allclose(zeros[500 * second + 499], alone.error, atol=1e-12)


def test_without_drift_the_zero_of_the_flange_sensor_stays() -> None:
    errors = calibration.draw(UR5E, np.random.default_rng(8))
    plant, device = Still(), sensors(errors=errors)
    samples(device, plant, 1100)
    device.rest(plant.tick, 3600, 0.002)
    assert (device.wrench_offset == errors.wrench_offset).all()


def test_a_fault_adds_to_the_drift_and_a_later_fault_replaces_the_earlier_one_alone() -> None:
    errors = calibration.draw(UR5E, np.random.default_rng(8))
    plant, device, sound = Still(), sensors(errors=errors, drift=drifting(errors)), sensors(errors=errors, drift=drifting(errors))

    def added(seconds: int) -> np.ndarray:
        for each in (device, sound):
            each.rest(plant.tick, seconds, 0.002)
        plant.tick += 500 * seconds
        return device.wrench_offset - sound.wrench_offset

    plant.tick = 137
    assert (added(60) == 0.0).all()
    device.fault(SensorFault(sensor="force_torque", channel=2, offset=2.0, drift=0.01))
    assert np.allclose(added(100), [0.0, 0.0, 3.0, 0.0, 0.0, 0.0], atol=1e-9)
    device.fault(SensorFault(sensor="force_torque", channel=2, drift=-0.02))
    assert np.allclose(added(100), [0.0, 0.0, 1.0, 0.0, 0.0, 0.0], atol=1e-9)
    device.fault(SensorFault(sensor="force_torque"))
    assert np.allclose(added(100), [0.0, 0.0, 1.0, 0.0, 0.0, 0.0], atol=1e-9)


@pytest.mark.parametrize("before", [0, 1, 137, 500, 999])
def test_a_rest_moves_every_zero_as_ticks_do_bit_for_bit(before: int) -> None:
    errors = calibration.draw(UR5E, np.random.default_rng(8))
    plant, other = Still(), Still()
    lasting, resting = (sensors(errors=errors, drift=drifting(errors)) for _ in range(2))
    for each, where in ((lasting, plant), (resting, other)):
        each.read(where, where.current)
        samples(each, where, before)
        each.fault(SensorFault(sensor="force_torque", drift=0.003))
        each.fault(SensorFault(sensor="gyro", channel=1, drift=0.001))
    samples(lasting, plant, 3500)
    resting.rest(other.tick, 7, 0.002)
    other.tick += 3500
    assert lasting._bias.tobytes() == resting._bias.tobytes()
    for each, where in ((lasting, plant), (resting, other)):
        samples(each, where, 700)
    assert lasting._bias.tobytes() == resting._bias.tobytes(), "and so it goes on"


def test_samples_on_their_way_survive_a_rest() -> None:
    plant, device = Still(), sensors()
    plant.set(2.0)
    samples(device, plant, 3)
    device.rest(plant.tick, 60, 0.002)
    plant.tick += 30000
    plant.set(0.0)
    assert np.abs(read(device, plant).values - 2.0).max() < 1.0
    assert np.abs(read(device, plant).values).max() < 1.0


def test_gain_and_cross_talk_of_the_flange_sensor() -> None:
    errors = calibration.draw(UR5E, np.random.default_rng(3))
    plant, device = Still(), sensors(errors=errors)
    zero = samples(device, plant, 500)[1:, 18:24].mean(axis=0)
    plant.flange[:6] = load = np.array([40.0, -30.0, 20.0, 4.0, 3.0, -2.0])
    loaded = samples(device, plant, 501)[2:, 18:24].mean(axis=0)
    wrong = loaded - zero - load
    full = np.array([100.0] * 3 + [20.0] * 3)
    # 1 % of the load in each channel, and of every other channel's share of its range.
    bound = 0.01 * np.abs(load) + 0.01 * full * (np.abs(load) / full).sum() + 0.05 * full / 100.0
    assert (np.abs(wrong) < bound).all()
    assert (np.abs(wrong) > 0.0).all()


def test_ripple_of_the_output_encoder_over_a_turn() -> None:
    errors = calibration.draw(UR5E, np.random.default_rng(4))
    plant, device = Still(), sensors(errors=errors)
    error = []
    for angle in np.linspace(0.0, 2.0 * np.pi, 200):
        plant.q[:] = plant.theta[:] = angle
        error.append(samples(device, plant, 4)[2:, :12].mean(axis=0) - angle)
    worst = np.abs(np.array(error)).max(axis=0)
    noise = 4.0 * NOISE[:12] + QUANTUM[:12]
    assert (worst[:6] < noise[:6]).all(), "the motor's has none"
    assert (worst[6:] < 1e-4 + noise[6:]).all()
    assert (worst[6:] > 3e-5).all()


def test_temperatures_are_coarse_and_read_ten_times_a_second() -> None:
    plant, device = Still(), sensors()
    plant.temperature[:] = 40.04
    seen = [read(device, plant).temperature for _ in range(5000)]
    changes = [k for k in range(1, 5000) if (seen[k] != seen[k - 1]).any()]
    assert {k % 50 for k in changes} == {0}
    rows = np.array(seen[::50])
    assert np.allclose(rows * 10.0, np.rint(rows * 10.0))
    assert np.allclose(rows.mean(axis=0), 40.04, atol=0.06)
    assert np.allclose(rows.std(axis=0), np.hypot(0.1, 0.1 / np.sqrt(12.0)), rtol=0.35)


def test_the_flange_is_averaged_over_the_tick(monkeypatch: pytest.MonkeyPatch) -> None:
    steps, one = [], mujoco.mj_step

    def single_steps(model: mujoco.MjModel, data: mujoco.MjData, nstep: int) -> None:
        for _ in range(nstep):
            one(model, data)
            steps.append(data.sensordata.copy())

    plant = Plant(UR5E, Scenario())
    torque = np.array([0.0, -40.0, 10.0, 0.0, 0.0, 0.0])
    plant.advance(torque)
    monkeypatch.setattr(mujoco, "mj_step", single_steps)
    plant.advance(torque, (push("flange", (80.0, 0.0, 30.0)),))
    order = [a + k for a in (plant.model.sensor(name).adr[0] for name in names()) for k in range(3)]
    each = np.array(steps)[:, order]
    assert len(each) == 8
    assert np.ptp(each[:, :3], axis=0).max() > 1.0, "the force must change within the tick"
    assert np.allclose(plant.flange, each.mean(axis=0), atol=1e-9)


def names() -> tuple[str, ...]:
    return ("force", "torque", "accelerometer_flange", "gyro_flange", "accelerometer_tool", "gyro_tool")


def test_encoders_are_latched_at_the_ticks_end() -> None:
    plant, device = Plant(UR5E, Scenario()), sensors()
    torque = np.array([30.0, -60.0, 20.0, 6.0, 5.0, 4.0])
    before = None
    for _ in range(100):
        plant.advance(torque)
        sample = device.read(plant, torque)
        if before is not None:
            assert (np.abs(sample.theta - before[0]) < 5.0 * NOISE[:6] + MOTOR).all()
            assert (np.abs(sample.q - before[1]) < 5.0 * NOISE[6:12] + OUTPUT).all()
        before = plant.theta.copy(), plant.q.copy()
    # Half a tick of motion, which a mean would be off by, must stand out of noise and quantum.
    assert (0.001 * np.abs(plant.theta_d[:3]) > 5.0 * NOISE[:3] + MOTOR[:3]).all()


def test_an_arm_without_flange_sensors_holds_and_can_be_guided() -> None:
    """FD-3a."""
    bare = msgspec.structs.replace(SENSOR, force_torque=None, accelerometer=None, gyro=None)
    bench = Bench(arm=msgspec.structs.replace(UR5E, sensors=bare))
    bench.run(1.0)
    estimate = bench.estimate
    assert estimate.joints_valid
    assert not estimate.wrench_valid
    assert not estimate.acceleration_valid
    assert (estimate.F_user == 0.0).all()
    assert bench.drift(2.0, bench.flange) < 2e-4
    bench.enter()
    assert bench.drift(2.0, bench.flange) < 2e-3
    start = bench.flange
    bench.run(1.0, push("flange", (0.0, 50.0, 0.0)))
    assert (bench.estimate.F_user == 0.0).all()
    assert (bench.flange - start)[1] > 0.1
