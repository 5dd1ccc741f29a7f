"""A log of a UR10e that nobody has: harmonic motion, currents of the rigid model and a plain friction, as text."""

import numpy as np

from app.files.library import load_arm
from sim.arm.chain import NOTHING, chain, plate_body
from sim.rigid_body.dynamics import Dynamics

ARM = load_arm("ur10e")


def harmonics(t, seed=1, speed=0.8):
    """Angles, speeds and accelerations of a motion of five harmonics a joint, from rest."""
    rng = np.random.default_rng(seed)
    n, w = ARM.n, 2.0 * np.pi / 20.0 * np.arange(1, 6)
    a = rng.uniform(-1.0, 1.0, (n, 5))
    phase = rng.uniform(0.0, 2.0 * np.pi, (n, 5))
    angle = w[None, :, None] * t[None, None, :] + phase[:, :, None]
    qd = (a[:, :, None] * np.cos(angle)).sum(axis=1)
    scale = speed / np.abs(qd).max(axis=1)
    qd = scale[:, None] * qd
    q = scale[:, None] * (a[:, :, None] / w[None, :, None] * np.sin(angle)).sum(axis=1)
    qdd = -scale[:, None] * (a[:, :, None] * w[None, :, None] * np.sin(angle)).sum(axis=1)
    return q.T + np.array([0.0, -1.2, 1.0, -1.5, 0.5, 0.0]), qd.T, qdd.T


def columns(seconds=6.0, rate=125.0, seed=1, noise=0.05):
    t = np.arange(round(seconds * rate)) / rate
    q, qd, qdd = harmonics(t, seed)
    rigid = chain(ARM)
    model = Dynamics(rigid, rigid.links, plate_body(ARM) + NOTHING, mounting=(0.0, 0.0, 0.0), elbow=ARM.chain.elbow)
    motors = np.array(ARM.motors.gear) * np.array(ARM.motors.torque_constant)
    torque = np.array([model.inverse(*row) for row in zip(q, qd, qdd, strict=True)])
    torque += qdd * np.array(ARM.motors.rotor_inertia) + np.tanh(qd / 0.01) * 4.0 + 5.0 * qd
    current = torque / motors + noise * np.random.default_rng(seed).standard_normal(torque.shape)
    return {"t": t, "q": q, "qd": qd, "current": current}


def header(names=("actual_q", "actual_qd", "actual_current"), time="timestamp", n=6):
    return [time, *(f"{name}_{k}" for name in names for k in range(n))]


def rows(values, keys=("t", "q", "qd", "current")):
    return np.column_stack([values[key] for key in keys])


def text(table, names=None, parting=",", digits=6):
    lines = [] if names is None else [parting.join(names)]
    lines += [parting.join(f"{cell:.{digits}f}" for cell in row) for row in table]
    return "\n".join(lines) + "\n"
