"""Fit: what `pendant fit` finds of drawn arms from a minute without and a minute with a load that was not weighed.

The arms differ from their file and from the model of the fit (benchmarks/fits/drawn_arms.py). Friction is judged at the speeds
that the logs have, each number that the logs told by the uncertainty that is stated of it.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from benchmarks.arms import load
from benchmarks.common import Report, main, spread
from benchmarks.fits.drawn_arms import DrawnArm
from sim.identification.arm_fit import fit, told
from sim.identification.torque_model import TorqueModel

Array = NDArray[np.float64]

ARM = "ur10e"
SPEEDS = np.linspace(0.05, 1.2, 24)  # [rad/s]
WIDTH = 2.0  # deviations


class Result(NamedTuple):
    """One drawn arm of n joints: relative errors (n,), of the load [kg], and errors over deviations of all that was told."""

    friction: Array
    rotor: Array
    load: float
    off: dict[str, Array]


def measure_arm(seed: int) -> Result:
    """Fit one drawn arm."""
    model = TorqueModel(load(ARM))
    arm, at = DrawnArm(load(ARM), seed), model.places
    found = fit(model, [arm.run(False), arm.run(True)])
    true = {
        "friction": (at.friction, arm.curves.ravel()),
        "rise with load": (at.load_friction, arm.load_friction),
        "asymmetry": (at.offset, arm.offset),
        "rotor inertia": (at.rotor, arm.rotor),
        "torque constant": (at.constant, arm.constant - 1.0),
        "mass of the load": (slice(at.load.start, at.load.start + 1), np.array([arm.load.mass])),
    }
    sure = told(found)
    off = {what: ((found.x[part] - value) / found.deviation[part])[sure[part]] for what, (part, value) in true.items()}
    curves = [arm.friction(SPEEDS, points) for points in (arm.smooth, found.x[at.friction].reshape(arm.n, at.m))]
    true_curves = curves[0] * arm.slow(SPEEDS)
    friction = np.sqrt(np.mean((curves[1] / true_curves - 1.0) ** 2, axis=1))
    rotor = np.abs(found.x[at.rotor] / arm.rotor - 1.0)
    return Result(friction, rotor, abs(float(found.x[at.load.start]) - arm.load.mass), off)


def measure(report: Report) -> None:
    """Fill the report."""
    count = 50 if report.options.full else 4
    results = spread(measure_arm, [report.options.seed + number for number in range(count)])
    for what, errors, bar, unit in (
        ("friction, error of a joint", np.concatenate([100.0 * r.friction for r in results]), 5.0, "%"),
        ("rotor inertia, error of a joint", np.concatenate([100.0 * r.rotor for r in results]), 10.0, "%"),
        ("mass of the load, error", np.array([1000.0 * r.load for r in results]), 50.0, "g"),
    ):
        report.row(f"{what}, 95th percentile", float(np.percentile(errors, 95)), unit, at_most=bar, n=errors.size)
        report.row(f"{what}, largest", float(errors.max()), unit, n=errors.size)
    for what in results[0].off:
        off = np.abs(np.concatenate([r.off[what] for r in results]))
        report.share(f"{what}: within two deviations", int((off < WIDTH).sum()), off.size)
    off = np.abs(np.concatenate([each for r in results for what, each in r.off.items() if what != "mass of the load"]))
    share = float((off < WIDTH).mean())
    report.row("all values of joints: within two deviations", share, at_least=0.90, at_most=0.99, n=off.size)


if __name__ == "__main__":
    main("fit", measure)
