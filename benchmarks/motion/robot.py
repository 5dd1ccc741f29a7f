"""An arm without a plant, as far as its references look at it."""

from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from benchmarks.motion.drawn import Drawn, arm_of
from pendant.decision import Decision
from pendant.program.steps import Move
from pendant.tick.estimate import Estimate
from pendant.tick.modes import Law, Mode, Phase, Safety
from sim.arm.chain import NOTHING, chain
from sim.rigid_body.dynamics import Dynamics

Array = NDArray[np.float64]


@cache
def model(name: str) -> Dynamics:
    """The rigid model of an arm with nothing beyond its flange."""
    arm = arm_of(name)
    bodies = chain(arm)
    return Dynamics(bodies, bodies.links, NOTHING, mounting=[0.0, 0.0, 0.0], elbow=arm.chain.elbow)  # type: ignore[arg-type]


def standing(q: Array) -> Estimate:
    """An arm that stands, with every sensor well, as far as references look at it."""
    n = q.size
    zero: dict[str, Any] = {name: np.zeros(n) for name in ("qd", "qdd", "theta", "theta_d", "tau_m", "tau_J", "tau_ext")}
    return Estimate(
        tick=1,
        joints_valid=True,
        wrench_valid=True,
        acceleration_valid=True,
        q=q.copy(),
        **zero,
        w_sensor=np.zeros(6),
        F_user=np.zeros(6),
        a_F=np.zeros(3),
        p_BF=np.zeros(3),
        R_BF=np.eye(3),
        v_F=np.zeros(6),
        v_tcp=0.0,
        v_elbow=0.0,
    )


def decision(law: Law, move: Move | None, drawn: Drawn) -> Decision:
    """What is decided for a tick."""
    return Decision(
        mode=Mode.NORMAL,
        safety=Safety.NORMAL,
        phase=Phase.OFF,
        law=law,
        move=move,
        gain=0.0,
        force_cap=0.0,
        baseline=(0.0,) * 6,
        periods=(),
        events=(),
        speed=drawn.share,
        speed_limits=drawn.limits,
    )
