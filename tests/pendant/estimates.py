"""Estimates for tests: an arm at rest, with what a test wants to differ."""

import numpy as np

from pendant.all_settings import Settings
from pendant.sensor.sensor_spec import SensorSpec
from pendant.tick.estimate import Estimate

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
    move_done: int = 0,
    move_refused: str = "",
    tcp: list[float] | None = None,
    elbow: list[float] | None = None,
    felt: float | list[float] = 0.0,
    load_mass: float = 0.0,
    needed: list[float] | None = None,
    q: list[float] | None = None,
    theta: list[float] | None = None,
    theta_d: list[float] | None = None,
    tau_ext_deviation: float = 0.0,
    friction: float | list[float] = 0.0,
    energy: float = 0.0,
    tau_hand: float | list[float] = 0.0,
    link: float | list[float] = 0.0,
) -> Estimate:
    """An estimate, gravity along -z of B and F. A plain number is joint 0's or the x component.

    `needed` is the force that the configured load needs in its motion; what the sensor measures then follows from `force`.
    """

    def vector(value: float | list[float], length: int) -> list[float]:
        return value if isinstance(value, list) else [value] + [0.0] * (length - 1)

    return Estimate(
        tick=tick,
        joints_valid=joints_valid,
        wrench_valid=wrench_valid,
        acceleration_valid=acceleration_valid,
        q=np.array(q or [0.0] * n),
        qd=np.array(vector(qd, n)),
        qdd=np.zeros(n),
        theta=np.array(theta or [0.0] * n),
        theta_d=np.array(theta_d or [0.0] * n),
        tau_m=np.zeros(n),
        tau_J=np.array(vector(tau_J, n)),
        tau_ext=np.array(vector(tau_ext, n)),
        tau_ext_deviation=np.full(n, tau_ext_deviation),
        w_sensor=np.zeros(6) if needed is None else np.subtract(needed + [0.0] * 3, vector(force, 3) + [0.0] * 3),
        F_user=np.array(vector(force, 3) + vector(torque, 3)),
        a_F=np.add(vector(acceleration, 3), [0.0, 0.0, 9.81]),
        a_felt=np.array(vector(acceleration, 3)),
        p_BF=np.array(vector(position, 3)),
        R_BF=np.eye(3),
        v_F=np.array(vector(speed, 3) + [0.0] * 3),
        v_tcp=v_tcp,
        v_elbow=v_elbow,
        move_done=move_done,
        move_refused=move_refused,
        tcp=np.array(tcp or [0.0] * 6),
        elbow=np.array(elbow or [0.0] * 6),
        F_joints=np.array(vector(felt, 3)),
        current=np.zeros(n),
        load_mass=load_mass,
        friction=np.array(vector(friction, n)),
        energy=energy,
        tau_hand=np.array(vector(tau_hand, n)),
        F_link=np.array(vector(link, 3)),
    )
