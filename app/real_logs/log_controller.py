"""The controller's own estimator and detectors, fed from a log in place of sensors."""

import math
from typing import NamedTuple

import numpy as np
from msgspec.structs import replace
from numpy.typing import NDArray

from app.real_logs.log_ticks import Ticks
from app.session.timeline_checks import Prepared
from pendant.contact.contact_monitor import ContactMonitor
from pendant.decision import EstimatorCommand
from pendant.safety.collision import Collisions
from pendant.sensor.sensor_spec import SensorSpec
from pendant.tick.estimate import Estimate
from pendant.tick.modes import Mode
from sim.identification.model_drift import ModelDrift
from sim.motion.moves import Reference
from sim.sensing.sensor_drift import sensor_spec
from sim.sensing.sensors import Sample
from sim.simulation import Simulation

Array = NDArray[np.float64]

MOVING = 0.01
"""Speed of a joint from which the arm moves, so that the force of a collision counts and not that of clamping [rad/s]."""
STOPPED = 5.0
"""So long a robot of UR is not reset after a protective stop (its dashboard's `unlock protective stop`): in a log, where the arm
goes on, what rises or ends in this time is of the same stop [s]."""
SIDES = 12
"""Numbers of accelerometers and gyros on both sides of the flange sensor: no log has them."""


class Estimates(NamedTuple):
    """What a block of k ticks gave, n joints."""

    tau_m: Array  # (k, n) measured motor torque, referred to the output [N·m]
    rotor: Array  # (k, n) of it, what accelerates the rotor [N·m]
    rigid: Array  # (k, n) of it, what the rigid model needs [N·m]
    friction: Array  # (k, n) of it, as learned so far [N·m]
    speed: Array  # (k, n) of the motors [rad/s]
    tau_J: Array  # (k, n) transmission torque [N·m]
    external: Array  # (k, n) external torque by the joints alone [N·m]
    felt: Array  # (k, n) external torque that the detectors are told, by the momentum [N·m]
    force: Array  # (k, 6) on the flange, axes of B; NaN where the log has none [N, N·m]

    @property
    def driven(self) -> Array:
        """What the model without friction leaves of the measured torque (k, n) [N·m]."""
        return self.tau_m - self.rotor - self.rigid

    @property
    def left(self) -> Array:
        """What model and learned friction leave of the measured torque (k, n) [N·m]."""
        return self.driven - self.friction


class LogNotice(NamedTuple):
    """What would have been told, and when."""

    t: float  # [s]
    what: str  # contact gained, contact lost, collision, ...
    part: str
    force: float  # that it was told by [N]
    rule: str  # that saw it


class LogController:
    """Estimator, contact detectors and the watch for collisions of a controller, as a simulation's tick calls them.

    Args:
        prepared: arm, tool, payload, mounting and settings that the controller is to believe in.
        two_angles: the log has motor angles, so that the gears' deflection is known.
        looks: contacts and collisions are looked for; else only torques are estimated.
    """

    def __init__(self, prepared: Prepared, *, two_angles: bool, looks: bool = True) -> None:
        arm, settings = prepared.arm, prepared.settings
        made = Simulation(arm, prepared.scenario, settings)
        self._estimator, self._sources, self._watch = made.estimator, made.contact_sources, made.watch
        self._dynamics, self._rigid, constants = made.dynamics, made.dynamics.recursion, made.calibration
        self._settings, self._looks = settings, looks
        known: SensorSpec = sensor_spec(arm)
        self._monitor, self._collisions = ContactMonitor(known), Collisions(tuple(arm.chain.joints))
        way = settings.joint_control
        use = way if two_angles else replace(way, from_deflection=False, friction_from=type(way)().friction_from)
        self._command = EstimatorCommand(use=use)
        motors = arm.motors
        self._rotor = np.array(motors.rotor_inertia) * constants.rotor_inertia
        self._per_ampere = np.array(motors.gear) * np.array(motors.torque_constant) * constants.motor_constant
        self._sample = _sample(arm.n)
        self._stopped_until = -math.inf  # of the log's times [s]

    @property
    def friction(self) -> Array:
        """Terms of the friction as learned (n, TERMS)."""
        return self._estimator.friction.terms

    @property
    def breakaway(self) -> Array:
        """What a standing joint may hold by friction as learned (n,) [N·m]."""
        return self._estimator.friction.breakaway

    def drift(self) -> ModelDrift:
        """Of the rigid model and the rotors that it believes in."""
        return ModelDrift(self._dynamics, self._rotor)

    def follow(self, ticks: Ticks) -> tuple[Estimates, list[LogNotice]]:
        """What is estimated in these ticks, and what would have been told.

        A stretch may begin in motion: until the filters know its speed, nothing is learned and nothing told.
        """
        estimator, sample, rigid = self._estimator, self._sample, self._rigid
        n, k = ticks.q.shape[1], len(ticks.t)
        tau_m, rotor, rigid_torque, rubs, speed, tau_J, external, felt = np.empty((8, k, n))
        out = Estimates(tau_m, rotor, rigid_torque, rubs, speed, tau_J, external, felt, np.full((k, 6), np.nan))
        told: list[LogNotice] = []
        values = np.full((k, 3 * n + 6 + SIDES), np.nan)
        values[:, :n], values[:, n : 2 * n], values[:, 2 * n : 3 * n] = ticks.theta, ticks.q, ticks.tau_m / self._per_ampere
        if ticks.wrench is not None:
            values[:, 3 * n : 3 * n + 6] = ticks.wrench
        sensed = np.asarray(np.isfinite(values[:, 3 * n : 3 * n + 6]).all(axis=1))
        plan = [Reference(*each) for each in zip(*ticks.planned, strict=True)]
        if ticks.run_in:
            estimator.started = False
            estimator.momentum.forget()
        momentum, friction, gears = estimator.momentum, estimator.friction, estimator.transmission
        for j in range(k):
            sample.values[:] = values[j]
            sample.temperature, sample.wrench_valid = ticks.temperature[j], bool(sensed[j])
            planned, knows = bool(ticks.learns[j]), j >= ticks.run_in
            answered = plan[j] if planned else None
            estimate = estimator.update(sample, self._command, answered=answered, learn=planned and knows)
            out.tau_m[j], out.rotor[j], out.rigid[j] = estimator.tau_m, estimate.theta_dd, rigid.torque
            out.friction[j], out.speed[j], out.tau_J[j] = friction.total, estimate.theta_d, gears.fused
            out.external[j], out.felt[j] = gears.external, momentum.residual
            if sensed[j]:
                out.force[j] = estimate.F_user
            if self._looks and knows:
                told += self._look(float(ticks.t[j]), estimate, planned)
        out.rotor[:] *= self._rotor
        return out, told

    def _look(self, t: float, estimate: Estimate, planned: bool) -> list[LogNotice]:
        """What a tick tells; `planned`: no hand leads the arm."""
        sample, settings = self._sample, self._settings
        estimate.signals = self._sources.read(sample, estimate, self._estimator.jacobian, settings.contact, looks=True)
        watched = self._watch.read(sample, estimate, None, free=not planned)
        estimate.clipped, estimate.link_force, estimate.following, estimate.motion = watched
        mode = Mode.NORMAL if planned else Mode.FREE_DRIVE
        told = [
            LogNotice(t, f"contact {each.change.value}", each.part, math.hypot(*each.force), each.rule)
            for each in self._monitor.step(estimate, settings.contact, mode, on=True)
        ]
        if not planned or t < self._stopped_until:
            self._collisions.rest()
            return told
        moves = max(map(abs, estimate.qd.tolist())) > MOVING
        hit = self._collisions.step(estimate, settings.collision, moves=moves)
        if hit is not None:
            self._stopped_until = t + STOPPED
            values = hit.values
            told.append(LogNotice(t, "collision", str(values["part"]), float(values["force"]), f"over {values['limit']:.0f} N"))
        return told


def _sample(n: int) -> Sample:
    """Measurements of n joints, in which no accelerometer is."""
    values = np.full(3 * n + 6 + SIDES, np.nan)
    theta, q, current, rest = values[:n], values[n : 2 * n], values[2 * n : 3 * n], values[3 * n :]
    sides = rest[6:9], rest[9:12], rest[12:15], rest[15:]
    return Sample(values, theta, q, current, rest[:6], *sides, np.zeros(n), True, False, False)
