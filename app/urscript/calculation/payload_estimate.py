"""estimate_payload(): mass and centre of gravity from wrenches in several postures (URScript manual, module internals)."""

import math
from collections.abc import Callable, Iterator

import numpy as np

from app.urscript.calculation.pose_algebra import quaternion, rotation, times, turned_back
from app.urscript.language.trouble import Misuse
from app.urscript.machine.signature import Builtin, Taken, builtin, items, numbers, pose
from app.urscript.machine.values import StructValue, Value
from sim.arm.frames import matrix_from_quaternion

FEWEST = 4
"""Postures (URScript manual)."""


def of_payload_estimate(tcp_turn: Callable[[], tuple[float, ...]], gravity: Callable[[], tuple[float, ...]]) -> Iterator[Builtin]:
    """The only one.

    Args:
        tcp_turn: tells how the tool centre point is turned in the flange: rotation vector [rad].
        gravity: tells it in the base [m/s²].
    """

    def estimate(poses: tuple[Value, ...], wrenches: tuple[Value, ...]) -> Value:
        if len(poses) < FEWEST or len(poses) != len(wrenches):
            raise Misuse(f"{len(poses)} poses and {len(wrenches)} wrenches: expected as many of both, {FEWEST} at least")
        places, wrench = [pose(each) for each in poses], [numbers(6)(each) for each in wrenches]
        turns = [quaternion(tuple(each[3:])) for each in places]
        least = math.pi / (2.0 * len(poses))
        for i, one in enumerate(turns):
            for k, other in enumerate(turns[:i]):
                if math.hypot(*rotation(times(turned_back(one), other))) < least:
                    raise Misuse(f"poses {k} and {i} are turned by less than {least:.3f} rad from each other")
        back = matrix_from_quaternion(quaternion(tuple(tcp_turn()))).T
        R = [matrix_from_quaternion(each) @ back for each in turns]  # of the flange, in the base
        return _estimated(R, wrench, np.array(gravity()))

    yield builtin("estimate_payload", estimate, Taken("poses", items), Taken("wrenches", items))


def _estimated(R: list[np.ndarray], wrenches: list[tuple[float, ...]], g: np.ndarray) -> StructValue:
    """Least squares: f = m g + f_0 and t = m c x g + t_0, all of the wrench turned into the flange, where c is the same.

    An offset of the sensor, which is the same in the flange's axes, is found with it.
    """
    rows, values = [], []
    for turned, wrench in zip(R, wrenches, strict=True):
        down = turned.T @ g
        force, torque = turned.T @ np.array(wrench[:3]), turned.T @ np.array(wrench[3:])
        cross = np.array([[0.0, down[2], -down[1]], [-down[2], 0.0, down[0]], [down[1], -down[0], 0.0]])  # (m c) x g
        rows.append(np.hstack((down[:, None], np.zeros((3, 3)), np.eye(3), np.zeros((3, 3)))))
        rows.append(np.hstack((np.zeros((3, 1)), cross, np.zeros((3, 3)), np.eye(3))))
        values += [force, torque]
    found, *_ = np.linalg.lstsq(np.vstack(rows), np.concatenate(values), rcond=None)
    mass = float(found[0])
    centre = tuple((found[1:4] / mass).tolist()) if abs(mass) > 1e-6 else (0.0, 0.0, 0.0)
    return StructValue({"mass": mass, "cog": centre})
