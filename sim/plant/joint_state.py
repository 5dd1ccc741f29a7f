"""What the physics says of the joints in a tick, gathered and averaged; what the joints do to it. Truth, as all of this room."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sim.compiled.kernel import kernel
from sim.compiled.record import Record, record
from sim.plant.joint_friction import input_side

Array = NDArray[np.float64]

SIGN_SPEED = 0.01  # [rad/s]

LEAST_RUBBING = 1e-3
"""MuJoCo's bristles divide by the torque at which they slide: a joint without friction has this [N·m], less than any seal's."""

FASTEST = 1e3
"""No joint is faster [rad/s]; one that is shows that the physics diverged."""


class PhysicsState(NamedTuple):
    """Arrays of MuJoCo's that a tick reads."""

    qpos: Array
    qvel: Array
    length: Array  # of the tendons, which are the springs
    rate: Array
    plastic: Array
    history: Array  # of the sensors


class PhysicsInput(NamedTuple):
    """Arrays of MuJoCo's that a tick writes, and where."""

    friction: Array  # parameters of the actuators that rub
    applied: Array  # generalised forces


def plant_record(n: int, substeps: int, channels: int) -> Record:
    """n joints, and the sensor values of so many substeps and channels at the flange; still all zero."""
    ints = f"{n}i8"
    return record(
        stiffness=(n,),
        stiffening=(n,),
        damping=(n,),
        slip_stiffness=(n,),
        # Where MuJoCo has them: positions and speeds of output and motor, main spring, slipping spring and its state.
        at_q=ints,
        at_theta=ints,
        dof_q=ints,
        dof_theta=ints,
        spring=ints,
        slip=ints,
        slip_state=ints,
        rubs=ints,  # the actuators that rub
        kept=f"({substeps},{channels})i8",  # each substep's sensor values
        q=(n,),
        theta=(n,),
        qd=(n,),
        theta_d=(n,),
        tau_J=(n,),
        temperature=(n,),
        friction_in=(n,),
        held=(n,),  # by the brakes, as they are
        heat=(n,),
        flange=(channels,),
    )


# Numba: a few hundred scalar operations a tick cost less than one call of numpy each. Arrays are written in place.


@kernel
def gather(plant, state) -> None:
    """Take angles, speeds and the true transmission torque from the physics."""
    state = PhysicsState(*state)
    own = plant[0]
    for i in range(own.q.size):
        own.q[i], own.theta[i] = state.qpos[own.at_q[i]], state.qpos[own.at_theta[i]]
        own.qd[i], own.theta_d[i] = state.qvel[own.dof_q[i]], state.qvel[own.dof_theta[i]]
        x = state.length[own.spring[i]]
        slip = own.slip_stiffness[i] * (state.length[own.slip[i]] - state.plastic[own.slip_state[i]])
        main = x * (own.stiffness[i] + own.stiffening[i] * x * x)
        own.tau_J[i] = main + own.damping[i] * state.rate[own.spring[i]] + slip


@kernel
def poses(positions, orientations, bodies):
    """Poses (m, 7) in W of some of MuJoCo's bodies: position [m], quaternion wxyz."""
    out = np.empty((bodies.size, 7))
    for k in range(bodies.size):
        for i in range(3):
            out[k, i] = positions[bodies[k], i]
        for i in range(4):
            out[k, 3 + i] = orientations[bodies[k], i]
    return out


@kernel
def sliding(plant, friction):
    """Friction (n,) of both sides at the present speeds, with their signs [N·m]."""
    own, rubs = plant[0], friction[0]
    out = np.empty(own.q.size)
    for i in range(out.size):
        sign = np.tanh(own.theta_d[i] / SIGN_SPEED)
        out[i] = (own.friction_in[i] + rubs.output_coulomb[i]) * sign + rubs.output_viscous[i] * own.qd[i]
    return out


@kernel
def drive(plant, friction, inputs, torque) -> None:
    """Friction of this tick, with what closed brakes hold, and the motors' torques."""
    own, written = plant[0], PhysicsInput(*inputs)
    input_side(friction, (own.theta_d, own.tau_J, own.temperature), own.friction_in)
    for i in range(own.rubs.size):
        own.friction_in[i] += own.held[i]
        row = written.friction[own.rubs[i]]
        row[3] = row[4] = max(own.friction_in[i], LEAST_RUBBING)
        written.applied[own.dof_theta[i]] = torque[i]


@kernel
def finish(plant, state) -> bool:
    """Gather the state, the mean of each flange sensor over the substeps, and the heat of friction.

    Returns:
        Whether all of it is finite, and no joint faster than anything is.
    """
    gather(plant, state)
    own, history = plant[0], PhysicsState(*state).history
    for j in range(own.flange.size):
        total = 0.0
        for k in range(own.kept.shape[0]):
            total += history[own.kept[k, j]]
        own.flange[j] = total / own.kept.shape[0]
    for i in range(own.heat.size):
        own.heat[i] += abs(own.friction_in[i] * own.theta_d[i])
    sane = True
    for i in range(own.q.size):
        sane = sane and abs(own.qd[i]) < FASTEST and abs(own.theta_d[i]) < FASTEST  # what is not a number is not less
    for j in range(own.flange.size):
        sane = sane and abs(own.flange[j]) < np.inf
    return sane
