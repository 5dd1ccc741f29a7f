"""An arm's file with the numbers of a fit in it."""

import msgspec
import numpy as np
from numpy.typing import NDArray

from sim.arm.arm_file import Accuracy, Arm
from sim.arm.frames import file_axes, inertia_numbers, link_frame
from sim.identification.arm_fit import ArmFit, told
from sim.identification.body_parameters import body_of

Array = NDArray[np.float64]

LEAST_TORQUE = 1e-3  # of friction and of a rotor's inertia in a file, where 0 is not allowed
SURE = 2.0  # deviations that the file's accuracy states
MOST_RATIO = 0.3  # that a file can state


def fitted_arm(found: ArmFit, name: str, source: str, *, weighed: bool) -> Arm:
    """The arm with its fitted numbers: friction, rotor inertia, torque constants, masses, centres and moments of the links.

    Args:
        found: the fit.
        name: of the arm.
        source: which logs, for the file.
        weighed: a load of known mass was carried, so that the torque constants are measured.
    """
    arm, at, x = found.model.arm, found.places, found.x
    mass, centres, tensors = list[float](), list[list[float]](), list[list[float]]()
    for k in range(arm.n):
        body = body_of(found.model.link_of_file(x, k))
        mass.append(round(body.mass, 4))
        centres.append(_rounded((np.linalg.inv(link_frame(arm, k)) @ [*body.com, 1.0])[:3], 5))
        axes = file_axes(arm, k)
        tensors.append(_rounded(inertia_numbers(axes.T @ body.inertia @ axes), 6))
    curves = np.maximum(x[at.friction].reshape(arm.n, at.m), LEAST_TORQUE)
    slowest = curves[:, 0] / np.array(arm.frictions.torque)[:, 0]
    constant = np.array(arm.motors.torque_constant) * (1.0 + x[at.constant])
    known = {"torque_constant": weighed, "rotor_inertia": bool(told(found)[at.rotor].all())}
    motors = msgspec.structs.replace(
        arm.motors,
        status="measured",
        source=f"{source} Torque constants by {'a load that was weighed' if weighed else 'the filed masses of the links'}.",
        assumed=[*(each for each, sure in known.items() if not sure), "current", "gear", "ripple"],
        torque_constant=_rounded(constant, 6),
        rotor_inertia=_rounded(np.maximum(x[at.rotor], LEAST_TORQUE), 4),
    )
    frictions = msgspec.structs.replace(
        arm.frictions,
        status="measured",
        source=f"{source} Breakaway and bristles in proportion to the slowest point of the curve.",
        assumed=["output_share", "per_kelvin", "presliding", "breakaway", "temperature"],
        torque=[_rounded(curve, 4) for curve in curves],
        load=_rounded(np.maximum(x[at.load_friction], 0.0), 4),
        breakaway=_rounded(np.array(arm.frictions.breakaway) * slowest, 4),
        presliding=_rounded(np.array(arm.frictions.presliding) * slowest, 1),
    )
    before = f"{source} Known before, and fitted within that: {arm.masses.source}"[:2000]
    masses = msgspec.structs.replace(arm.masses, status="measured", source=before, mass=mass, com=centres)
    inertias = msgspec.structs.replace(arm.inertias, status="measured", source=source, tensor=tensors)
    return msgspec.structs.replace(
        arm,
        name=name,
        motors=motors,
        frictions=frictions,
        masses=masses,
        inertias=inertias,
        accuracy=stated_accuracy(found, source),
    )


def stated_accuracy(found: ArmFit, source: str) -> Accuracy:
    """What the fitted constants may be wrong by: two standard deviations, of the joint where they are largest.

    Where no joint was told, and of what is not fitted, what the file stated stays.
    """
    arm, at, sure, d = found.model.arm, found.places, told(found), found.deviation

    def largest(part: slice, size: Array, before: float) -> float:
        ratio = SURE * d[part] / size
        return round(min(float(ratio[sure[part]].max()), MOST_RATIO), 4) if sure[part].any() else before

    motor = largest(at.constant, np.ones(arm.n), arm.accuracy.motor_constant)
    rotor = largest(at.rotor, np.maximum(found.x[at.rotor], LEAST_TORQUE), arm.accuracy.rotor_inertia)
    before = f"{source} Two standard deviations of what is fitted. The rest as before: {arm.accuracy.source}"
    stays = [each for each in Accuracy.__struct_fields__ if each not in ("status", "source", "assumed", *_fitted(found))]
    return msgspec.structs.replace(
        arm.accuracy, status="measured", source=before[:2000], assumed=stays, motor_constant=motor, rotor_inertia=rotor
    )


def _fitted(found: ArmFit) -> list[str]:
    """Names of the accuracies that the runs told."""
    parts = {"motor_constant": found.places.constant, "rotor_inertia": found.places.rotor}
    return [name for name, part in parts.items() if told(found)[part].any()]


def _rounded(values, digits: int) -> list[float]:
    return [round(float(value), digits) for value in values]
