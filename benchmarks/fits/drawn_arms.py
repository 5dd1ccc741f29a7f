"""Arms drawn at random round a filed one, and logs of them: what a fit should find is known, its model is not quite theirs."""

import numpy as np

from sim.arm.chain import NOTHING, Body, chain, plate_body
from sim.identification.motion_samples import sampled
from sim.identification.torque_model import LoggedRun
from sim.rigid_body.dynamics import Dynamics

RATE = 125.0
WARMING = 0.015  # change of friction by temperature from the middle of a run to its ends
TURN = 0.02  # change of friction over a turn of the joint
SLOW, SLOW_SPEED = 0.03, 0.15  # more friction when slow, of the curve; and up to which speed [rad/s]


class DrawnArm:
    """An arm that differs from its file as arms of a series do, and more in its friction.

    What the model of a fit does not have: friction that changes as a joint turns and warms, and is higher when slow; ripple;
    joints that turn round without a jump; noise.
    """

    def __init__(self, arm, seed, seconds=60.0):
        self.rng = rng = np.random.default_rng(seed)
        n = arm.n
        self.filed, self.n, self.seconds = arm, n, seconds

        def factor(bound, size=n):
            return 1.0 + bound * rng.uniform(-1.0, 1.0, size)

        self.constant = factor(0.03)
        self.rotor = np.array(arm.motors.rotor_inertia) * factor(0.4)
        wear = rng.uniform(0.6, 1.6, n)
        speed = np.array(arm.frictions.speed)
        self.smooth = np.array(arm.frictions.torque) * wear[:, None] * factor(0.08, (n, len(speed)))
        self.curves = self.smooth * self.slow(speed)  # of the middle of a run, and the mean of a turn
        self.load_friction = np.array(arm.frictions.load) * rng.uniform(0.3, 2.0, n)
        self.offset = 0.002 * np.array(arm.limits.torque) * rng.uniform(-1.0, 1.0, n)
        self.ripple = np.array(arm.motors.ripple), rng.uniform(0.0, 6.28, n)
        self.turn = rng.uniform(0.0, 6.28, n)
        self.warming = WARMING * rng.uniform(-1.0, 1.0, n)
        self.points = np.linalg.inv(np.vander(np.sqrt(speed)))
        rigid = chain(arm)
        masses, shift = factor(0.02), rng.uniform(-0.003, 0.003, (n, 3))
        links = [
            Body(link.mass * m, link.com + s, link.inertia * m) for link, m, s in zip(rigid.links, masses, shift, strict=True)
        ]
        mass, radius = rng.uniform(0.5, 3.0), 0.05
        com = rng.uniform(-0.05, 0.05, 3) + np.array([0.0, 0.0, 0.07])
        self.load = Body(mass, com, np.eye(3) * 0.4 * mass * radius**2)
        plate = plate_body(arm)
        self.models = [
            Dynamics(rigid, tuple(links), body, mounting=[0.0, 0.0, 0.0], elbow=arm.chain.elbow)
            for body in (plate + NOTHING, plate + self.load)
        ]

    def slow(self, speed):
        return 1.0 + SLOW * np.exp(-speed / SLOW_SPEED)

    def friction(self, speeds, points):
        """Curves (n, k) through points (n, m) at speeds (k,), without what is more when slow."""
        filed = self.filed.frictions.speed
        root = np.sqrt(np.clip(speeds, filed[0], filed[-1]))
        return points @ (np.vander(root, len(filed)) @ self.points).T

    def log(self, loaded, still=()):
        """Times, angles, speeds, torques of harmonic motion, as the file's torque constants take them."""
        arm, rng, n = self.filed, self.rng, self.n
        t = np.arange(round(RATE * self.seconds)) / RATE
        w = 2.0 * np.pi / 20.0 * np.arange(1, 8)
        a, phase = rng.uniform(-1.0, 1.0, (n, 7)), rng.uniform(0.0, 6.28, (n, 7))
        angle = w[None, :, None] * t + phase[:, :, None]
        qd = (a[:, :, None] * np.cos(angle)).sum(axis=1)
        scale = rng.uniform(1.2, 1.7, n) / np.abs(qd).max(axis=1)
        scale[list(still)] = 0.0
        q = (scale * ((a / w)[:, :, None] * np.sin(angle)).sum(axis=1).T) + np.array([0.0, -1.2, 1.0, -1.5, 0.5, 0.0])[:n]
        qd, qdd = scale * qd.T, -scale * ((a * w)[:, :, None] * np.sin(angle)).sum(axis=1).T
        model = self.models[loaded]
        rigid = np.array([model.inverse(*row) for row in zip(q, qd, qdd, strict=True)])
        curve = np.stack([self.friction(np.abs(qd[:, i]), self.smooth)[i] for i in range(n)], axis=1) * self.slow(np.abs(qd))
        curve *= (1.0 + TURN * np.sin(q + self.turn)) * (1.0 + self.warming * np.linspace(-1.0, 1.0, len(t))[:, None])
        friction = np.tanh(qd / 0.005) * (curve + self.load_friction * np.abs(rigid))
        ripple, start = self.ripple
        torque = rigid + self.rotor * qdd + friction + self.offset + ripple * np.sin(2.0 * np.array(arm.motors.gear) * q + start)
        torque = torque / self.constant
        torque += 0.02 * np.array(arm.motors.gear) * np.array(arm.motors.torque_constant) * rng.standard_normal(q.shape)
        return t, q + 1e-5 * rng.standard_normal(q.shape), qd + 2e-3 * rng.standard_normal(q.shape), torque

    def run(self, loaded, still=(), name="drawn"):
        """A log as a fit takes it."""
        return LoggedRun(name, sampled([self.log(loaded, still)], self.filed.frictions.speed), bool(loaded))
