"""Estimates for tests: an arm at rest, with what a test wants to differ."""

import numpy as np

from pendant.estimate import Estimate

N = 6


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
    move_done: int = 0,
    move_refused: str = "",
) -> Estimate:
    """An estimate. A plain number for `qd` or `tau_ext` is joint 0's, for `force`, `torque` and `speed` the x component."""

    def vector(value: float | list[float], length: int) -> list[float]:
        return value if isinstance(value, list) else [value] + [0.0] * (length - 1)

    return Estimate(
        tick=tick,
        joints_valid=joints_valid,
        wrench_valid=wrench_valid,
        acceleration_valid=True,
        q=np.zeros(n),
        qd=np.array(vector(qd, n)),
        qdd=np.zeros(n),
        theta=np.zeros(n),
        theta_d=np.zeros(n),
        tau_m=np.zeros(n),
        tau_J=np.zeros(n),
        tau_ext=np.array(vector(tau_ext, n)),
        w_sensor=np.zeros(6),
        F_user=np.array(vector(force, 3) + vector(torque, 3)),
        a_F=np.zeros(3),
        p_BF=np.zeros(3),
        R_BF=np.eye(3),
        v_F=np.array(vector(speed, 3) + [0.0] * 3),
        v_tcp=0.0,
        v_elbow=0.0,
        move_done=move_done,
        move_refused=move_refused,
    )
