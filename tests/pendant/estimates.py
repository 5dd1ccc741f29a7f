"""Estimates for tests: an arm at rest, with what a test wants to differ."""

from functools import cache
from operator import mul

import numpy as np
from numpy.typing import NDArray

from pendant.all_settings import Settings
from pendant.sensor.sensor_spec import SensorSpec
from pendant.tick.estimate import Estimate, WhoseForce

N = 6
SENSOR = SensorSpec()
HAND, MOVES = Settings().unexplained.force, Settings().unexplained.speed
"""From these on a force counts as a hand's [N], and the flange as moving [m/s]."""


def estimate(
    tick: int = 0,
    *,
    n: int = N,
    joints_valid: bool = True,
    wrench_valid: bool = True,
    qd: float | list[float] = 0.0,
    tau_ext: float | list[float] = 0.0,
    force: float | list[float] = 0.0,
    torque: float | list[float] = 0.0,
    speed: float | list[float] = 0.0,
    position: float | list[float] = 0.0,
    acceleration: float | list[float] = 0.0,
    acceleration_valid: bool = True,
    tau_J: float | list[float] = 0.0,
    v_tcp: float = 0.0,
    v_elbow: float = 0.0,
    tcp: list[float] | None = None,
    elbow: list[float] | None = None,
    felt: float | list[float] = 0.0,
    load_mass: float = 0.0,
    needed: list[float] | None = None,
    q: list[float] | None = None,
    theta: list[float] | None = None,
    theta_d: list[float] | None = None,
    friction: float | list[float] = 0.0,
    energy: float = 0.0,
    tau_hand: float | list[float] = 0.0,
    tau_certain: float | list[float] = 0.0,
    link: float | list[float] = 0.0,
    touch: float | list[float] = 0.0,
) -> Estimate:
    """An estimate, gravity along -z of B and F. A plain number is joint 0's or the x component.

    `needed` is the force that the configured load needs in its motion; what the sensor measures then follows from `force`.
    Many share their arrays, which cannot be written into: those of a `copy` can.
    """
    return Estimate(
        tick=tick,
        joints_valid=joints_valid,
        wrench_valid=wrench_valid,
        acceleration_valid=acceleration_valid,
        q=_zeros(n) if q is None else np.array(q),
        qd=_vector(qd, n),
        qdd=_zeros(n),
        theta=_zeros(n) if theta is None else np.array(theta),
        theta_d=_zeros(n) if theta_d is None else np.array(theta_d),
        tau_m=_zeros(n),
        tau_J=_vector(tau_J, n),
        tau_ext=_vector(tau_ext, n),
        w_sensor=_zeros(6) if needed is None else np.subtract(needed + [0.0] * 3, _listed(force, 3) + [0.0] * 3),
        F_user=_wrench(force, torque),
        a_F=AT_REST if acceleration == 0.0 else np.add(_listed(acceleration, 3), [0.0, 0.0, 9.81]),
        a_felt=_vector(acceleration, 3),
        p_BF=_vector(position, 3),
        R_BF=UNTURNED,
        v_F=_wrench(speed, 0.0),
        v_tcp=v_tcp,
        v_elbow=v_elbow,
        tcp=_zeros(6) if tcp is None else np.array(tcp),
        elbow=_zeros(6) if elbow is None else np.array(elbow),
        F_joints=_vector(felt, 3),
        current=_zeros(n),
        load_mass=load_mass,
        friction=_vector(friction, n),
        whose=WhoseForce(
            tau_hand=_vector(tau_hand, n),
            tau_certain=_vector(tau_certain, n),
            powers=(_power(qd, tau_hand), _power(qd, tau_certain), _power(qd, friction)),
            energy=energy,
            F_link=_vector(link, 3),
            F_touch=_vector(touch, 3),
        ),
    )


def _fixed(values: NDArray[np.float64]) -> NDArray[np.float64]:
    """Shared by all estimates: a test that writes into it fails."""
    values.flags.writeable = False
    return values


@cache
def _zeros(length: int) -> NDArray[np.float64]:
    return _fixed(np.zeros(length))


UNTURNED, AT_REST = _fixed(np.eye(3)), _fixed(np.array([0.0, 0.0, 9.81]))


def _listed(value: float | list[float], length: int) -> list[float]:
    return value if isinstance(value, list) else [value] + [0.0] * (length - 1)


def _vector(value: float | list[float], length: int) -> NDArray[np.float64]:
    return _zeros(length) if value == 0.0 else np.array(_listed(value, length))


def _power(speeds: float | list[float], torques: float | list[float]) -> float:
    """Of all joints [W]."""
    n = max(len(each) for each in (speeds, torques, [0.0]) if isinstance(each, list))
    return sum(map(mul, _listed(speeds, n), _listed(torques, n)))


def _wrench(linear: float | list[float], angular: float | list[float]) -> NDArray[np.float64]:
    return _zeros(6) if linear == angular == 0.0 else np.array(_listed(linear, 3) + _listed(angular, 3))
