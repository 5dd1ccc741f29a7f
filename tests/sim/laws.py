"""What tests of the control modules share: estimates, decisions and a rigid model without an arm that moves."""

from typing import Any

import numpy as np

from pendant.decision import Decision
from pendant.program.steps import Move
from pendant.tick.estimate import Estimate, WhoseForce
from pendant.tick.modes import Law, Mode, Phase, Safety
from sim.arm.arm_file import Arm
from sim.arm.chain import Body, chain
from sim.braking.motion_meter import MotionMeter
from sim.motion.moves import Strength
from sim.rigid_body.dynamics import Dynamics
from sim.sensing.calibration import nominal
from tests.sim.arms import UR5E

N = UR5E.n
EXACT = nominal(UR5E)
NOTHING = Body(0.0, np.zeros(3), np.zeros((3, 3)))


def dynamics(q: np.ndarray | None = None, arm: Arm = UR5E) -> Dynamics:
    """The rigid model on the floor, at rest at these angles or at zero, with nothing beyond the flange."""
    rigid, n = chain(arm), arm.n
    model = Dynamics(rigid, rigid.links, NOTHING, mounting=[0.0, 0.0, 0.0], elbow=arm.chain.elbow)
    model.recursion.run(np.zeros(n) if q is None else q, np.zeros((3, n)), np.zeros(3))  # as the estimator does in every tick
    return model


def meter(model: Dynamics, tcp: np.ndarray) -> MotionMeter:
    """Measures motions of that arm."""
    strength = Strength(model, np.array(UR5E.motors.rotor_inertia), np.array(UR5E.limits.torque))
    return MotionMeter(model, tcp, strength.braking())


def estimate(**values: Any) -> Estimate:
    """An arm at rest at zero with every sensor well, but for `values`."""
    zero = {name: np.zeros(N) for name in ("q", "qd", "qdd", "theta", "theta_d", "theta_dd", "tau_m", "tau_J", "tau_ext")}
    known: dict[str, Any] = {
        **zero,
        "tick": 1,
        "joints_valid": True,
        "wrench_valid": True,
        "acceleration_valid": True,
        "w_sensor": np.zeros(6),
        "F_user": np.zeros(6),
        "a_F": np.zeros(3),
        "a_felt": np.zeros(3),
        "p_BF": np.zeros(3),
        "R_BF": np.eye(3),
        "v_F": np.zeros(6),
        "v_tcp": 0.0,
        "v_elbow": 0.0,
        "friction": np.zeros(N),
        "friction_deviation": np.zeros(N),
        "tau_ways": np.zeros((3, N)),
    }
    hand = {name: values.pop(name, np.zeros(N)) for name in ("tau_hand", "tau_certain")}
    return Estimate(**{**known, **values}, whose=WhoseForce(**hand))


def decision(
    law: Law,
    move: Move | None = None,
    gain: float = 0.0,
    cap: float = 50.0,
    baseline: tuple[float, ...] = (),
    phase: Phase = Phase.PERIOD,
) -> Decision:
    """A decision for this law, without periods or events."""
    return Decision(
        mode=Mode.TEACH,
        safety=Safety.NORMAL,
        phase=phase,
        law=law,
        move=move,
        gain=gain,
        flange_help=gain > 0.0,
        force_cap=cap,
        baseline=baseline or (0.0,) * 6,
        periods=(),
        events=(),
    )
