"""Postures in which people guide an arm by hand, drawn at random."""

import numpy as np

from sim.simulation import Simulation

NEAREST, FURTHEST = 0.3, 0.75  # of the flange from the base's axis: in front of the arm or beside it, within reach [m]
LOWEST, HIGHEST = 0.0, 0.9  # of the flange over the base's foot: from the table to the chest [m]
SHOULDER, ELBOW = (-2.3, -0.5), (0.5, 2.4)  # elbow up and bent: neither stretched nor folded [rad]
TILT = 1.2  # of the tool from straight down, towards the arm or away from it [rad]
ALIGNED = 0.6  # wrist 2 is at least so far from where the wrist's axes align [rad]
SMALLEST_SINGULAR = 0.1
REACH = 0.85  # of the arm that these lengths are of; nearest and furthest, and what is singular, go with the reach [m]


def posture(rng: np.random.Generator, probe: Simulation) -> tuple[list[float], int]:
    """A posture in which people guide an arm by hand, and how many were thrown away before it as too near a singularity.

    The tool is in front of the arm or beside it within reach, between table and chest, and looks more or less down; the elbow
    is up and bent, the wrist not aligned. All joint angles are uniform within that. What lies elsewhere is drawn again
    without being counted.
    """
    thrown, size = 0, probe.arm.reach / REACH
    for _ in range(10000):
        shoulder, elbow = rng.uniform(*SHOULDER), rng.uniform(*ELBOW)
        wrist_1 = -0.5 * np.pi + rng.uniform(-TILT, TILT) - shoulder - elbow
        wrist_2 = rng.choice([-1.0, 1.0]) * rng.uniform(ALIGNED, np.pi - ALIGNED)
        q = np.array([rng.uniform(-np.pi, np.pi), shoulder, elbow, wrist_1, wrist_2, rng.uniform(-np.pi, np.pi)])
        p, _, jacobian = probe.dynamics.update(q)
        if not (NEAREST <= float(np.hypot(p[0], p[1])) / size <= FURTHEST and LOWEST <= p[2] <= HIGHEST):
            continue
        if np.linalg.svd(jacobian, compute_uv=False)[-1] > SMALLEST_SINGULAR * size:
            return q.tolist(), thrown
        thrown += 1
    raise RuntimeError("no posture of hand-guiding work in 10000")
