"""What a real controller could measure: averaged, distorted, noisy, quantised, saturated and late."""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sim.arm.arm_file import Arm, Channels
from sim.compiled.kernel import kernel
from sim.compiled.record import record
from sim.plant.changes import SensorFault
from sim.plant.true_arm import Plant
from sim.sensing.calibration import Calibration
from sim.sensing.sensor_drift import SensorDrift

Array = NDArray[np.float64]

LATENCY = 1
"""Ticks between a measurement and its arrival at the controller."""

NOISE_BLOCK = 500  # ticks of noise drawn at once: a second
TEMPERATURE_TICKS = 50  # a temperature is read every 0.1 s


@dataclass(slots=True)
class Sample:
    """One tick's measurements, n joints; a channel that is out is not a number. Arrays are good until the next tick's arrive."""

    values: Array  # (3n + 18,) all of the below in one row
    theta: Array  # (n,) motor encoders, referred to the output [rad]
    q: Array  # (n,) output encoders [rad]
    current: Array  # (n,) motor currents [A]
    wrench: Array  # (6,) what the flange exerts on what it carries, in F [N, N·m]
    acceleration_flange: Array  # (3,) specific force before the flange sensor, in F [m/s²]
    gyro_flange: Array  # (3,) [rad/s]
    acceleration_tool: Array  # (3,) specific force behind the flange sensor, in F [m/s²]
    gyro_tool: Array  # (3,) [rad/s]
    temperature: Array  # (n,) [°C]
    joints_valid: bool
    wrench_valid: bool
    acceleration_valid: bool


class Measured(NamedTuple):
    """What is measured in a tick, as it is, n joints."""

    theta: Array  # (n,) [rad]
    q: Array  # (n,) [rad]
    current: Array  # (n,) [A]
    flange: Array  # (18,) as sim.plant.model.SENSORS


class Sensors:
    """All sensors of an arm.

    Encoders are latched at the end of a tick, everything else is the mean over it. The errors come from `calibration`, the
    noise from `rng`. The zero of the flange sensor moves with `drift`; None: it stays where it is.
    """

    def __init__(self, arm: Arm, calibration: Calibration, rng: np.random.Generator, drift: SensorDrift | None = None) -> None:
        n, sensors = arm.n, arm.sensors
        self._n, self._rng, self._drift = n, rng, drift
        self._groups = {
            "motor_encoder": slice(0, n),
            "output_encoder": slice(n, 2 * n),
            "current": slice(2 * n, 3 * n),
            "force_torque": slice(3 * n, 3 * n + 6),
            "accelerometer": np.r_[3 * n + 6 : 3 * n + 9, 3 * n + 12 : 3 * n + 15],
            "gyro": np.r_[3 * n + 9 : 3 * n + 12, 3 * n + 15 : 3 * n + 18],
        }
        size = 3 * n + 18
        encoders, force_torque = sensors.encoders, sensors.force_torque
        motor = 2.0 * np.pi / encoders.motor_counts / np.array(arm.motors.gear)
        output = 2.0 * np.pi / encoders.output_counts
        self._record = record(
            wrench_gain=(6, 6),
            ripple=(n, 2),  # of the output encoders
            phase=(n, 2),
            bias=(size,),
            rate=(size,),  # of the bias
            gain=(size,),  # of the noise
            quantum=(size,),
            span=(size,),
            noise=(NOISE_BLOCK, size),
        )
        own = self._record[0]
        own["wrench_gain"], own["ripple"], own["phase"] = calibration.wrench_gain, calibration.ripple, calibration.ripple_phase
        self._bias, self._rates, self._gain, self._quantum = own["bias"], own["rate"], own["gain"], own["quantum"]
        self._range, self._noise = own["span"], own["noise"]
        self._gain[:], self._quantum[:], self._range[:] = 1.0, 1.0, np.inf
        self._sigma = np.zeros(size)
        self._quantum[:n], self._sigma[:n] = motor, encoders.noise_counts * motor
        self._quantum[n : 2 * n], self._sigma[n : 2 * n] = output, encoders.noise_counts * output
        self._set("current", sensors.current)
        self._set("accelerometer", sensors.accelerometer)
        self._set("gyro", sensors.gyro)
        if force_torque is not None:
            for start, channels in ((3 * n, force_torque.force), (3 * n + 3, force_torque.torque)):
                part = slice(start, start + 3)
                self._quantum[part], self._sigma[part], self._range[part] = channels.quantum, channels.noise, channels.range
        self._bias[self._groups["force_torque"]] = calibration.wrench_offset
        self._fault_rates, self._drift_rate = np.zeros(size), np.zeros(6)  # the parts of `_rates` [unit/s]
        self._out = np.zeros(size, dtype=bool)
        for name, present in (("force_torque", force_torque), ("accelerometer", sensors.accelerometer), ("gyro", sensors.gyro)):
            if present is None:
                self._out[self._groups[name]] = True
        self._temperature_sensor = sensors.temperature
        self._temperature = np.zeros(n)
        self._rows = [_sample(np.empty(size), n) for _ in range(LATENCY + 2)]  # on their way, and the last that arrived
        self._next = 0
        self._line: list[Sample] = []
        self._any_out = bool(self._out.any())
        self._suspect = 0  # samples yet to arrive that may hold what is not a number

    def _set(self, name: str, channels: Channels | None) -> None:
        if channels is not None:
            part = self._groups[name]
            self._quantum[part], self._sigma[part], self._range[part] = channels.quantum, channels.noise, channels.range

    @property
    def wrench_offset(self) -> Array:
        """True offset of the flange sensor (6,) now, for scoring [N, N·m]."""
        return self._bias[self._groups["force_torque"]].copy()

    def fault(self, fault: SensorFault) -> None:
        """Let a sensor drift, get noisier or fail, from now on; a later fault of the same channels replaces the fault's drift.

        The flange sensor's own drift goes on beneath.
        """
        part = self._groups[fault.sensor]
        index = np.arange(self._bias.size)[part]
        if fault.channel is not None:
            index = index[fault.channel]
        self._bias[index] += fault.offset
        self._fault_rates[index] = fault.drift
        self._set_rates()
        self._gain[index] = fault.noise_factor
        self._out[index] = fault.outage
        self._any_out = bool(self._out.any())

    def _set_rates(self) -> None:
        self._rates[:] = self._fault_rates
        self._rates[self._groups["force_torque"]] += self._drift_rate

    def _begin_second(self, tick: int) -> None:
        """Let the flange sensor's own drift go on through the second that begins at `tick`, unless it does so already."""
        if self._drift is not None and tick >= NOISE_BLOCK * self._drift.second:
            self._drift_rate = self._drift.step()
            self._set_rates()

    def rest(self, tick: int, seconds: int, tick_length: float) -> None:
        """Let time pass without a measurement: zeros move as they would in ticks, bit for bit; what is on its way stays so.

        Args:
            tick: ticks done so far.
            seconds: whole seconds that pass, of `NOISE_BLOCK` ticks.
            tick_length: [s].
        """
        left = -tick % NOISE_BLOCK  # ticks until the next second begins
        for begin in range(tick + left, tick + left + seconds * NOISE_BLOCK, NOISE_BLOCK):
            _pass(self._record, left, tick_length)
            self._begin_second(begin)
            _pass(self._record, NOISE_BLOCK - left, tick_length)

    def read(self, plant: Plant, current: Array) -> Sample:
        """Measure the tick that `plant` has just finished; returns what arrives now, `LATENCY` ticks later.

        Args:
            plant: the true arm.
            current: true motor currents (n,) [A] during that tick.
        """
        tick, line = plant.tick, self._line
        row = tick % NOISE_BLOCK
        if row == 0 or not line:
            self._rng.standard_normal(out=self._noise)
            self._noise *= self._sigma
            self._begin_second(tick)
        if tick % TEMPERATURE_TICKS == 0 or not line:
            self._read_temperature(plant)
        self._next = (self._next + 1) % len(self._rows)
        sample = self._rows[self._next]
        value = sample.values
        passed = plant.step.tick if line else 0.0  # before the first sample no time has passed
        _measure(self._record, (plant.theta, plant.q, current, plant.flange), (row, passed), value)
        if self._any_out:
            value[self._out] = np.nan
            self._suspect = LATENCY + 1
        line.append(sample)
        if len(line) > LATENCY + 1:
            line.pop(0)
        return self._arrive(line[0])

    def _read_temperature(self, plant: Plant) -> None:
        sensor = self._temperature_sensor
        noisy = plant.temperature + sensor.noise * self._rng.standard_normal(self._n)
        self._temperature = np.rint(noisy / sensor.quantum) * sensor.quantum

    def _arrive(self, sample: Sample) -> Sample:
        """What is known of a sample when it arrives."""
        sample.temperature = self._temperature
        if self._suspect:
            self._suspect -= 1
            joints, flange = 3 * self._n, 3 * self._n + 6
            sample.joints_valid = bool(np.isfinite(sample.values[:joints]).all())
            sample.wrench_valid = bool(np.isfinite(sample.values[joints:flange]).all())
            sample.acceleration_valid = bool(np.isfinite(sample.values[flange:]).all())
        else:
            sample.joints_valid = sample.wrench_valid = sample.acceleration_valid = True
        return sample


def _sample(values: Array, n: int) -> Sample:
    """A sample of `n` joints whose arrays are parts of `values`."""
    theta, q, current, rest = values[:n], values[n : 2 * n], values[2 * n : 3 * n], values[3 * n :]
    wrench, arm_side, tool_side = rest[:6], rest[6:12], rest[12:]
    return Sample(
        values,
        theta,
        q,
        current,
        wrench,
        arm_side[:3],
        arm_side[3:],
        tool_side[:3],
        tool_side[3:],
        np.zeros(n),
        True,
        True,
        True,
    )


@kernel
def _measure(sensors, measured, now, out) -> None:
    measured = Measured(*measured)
    own = sensors[0]
    theta, q, current, flange = measured
    row, tick = now
    ripple, phase, noise = own.ripple, own.phase, own.noise[row]
    n = theta.size
    for i in range(n):
        out[i] = theta[i]
        out[n + i] = q[i] + ripple[i, 0] * np.sin(q[i] + phase[i, 0]) + ripple[i, 1] * np.sin(2.0 * q[i] + phase[i, 1])
        out[2 * n + i] = current[i]
    for j in range(6):
        total = 0.0
        for k in range(6):
            total += own.wrench_gain[j, k] * flange[k]
        out[3 * n + j] = total
    for j in range(6, flange.size):
        out[3 * n + j] = flange[j]
    for k in range(out.size):
        own.bias[k] += own.rate[k] * tick
        value = np.rint((out[k] + own.bias[k] + noise[k] * own.gain[k]) / own.quantum[k]) * own.quantum[k]
        out[k] = min(max(value, -own.span[k]), own.span[k])


@kernel
def _pass(sensors, count, tick) -> None:
    """`count` ticks of the zeros alone, added up one by one as `_measure` does."""
    bias, rate = sensors[0].bias, sensors[0].rate
    for _ in range(count):
        for k in range(bias.size):
            bias[k] += rate[k] * tick
