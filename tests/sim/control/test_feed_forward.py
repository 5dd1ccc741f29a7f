"""Feed-forward: the desired torques against the rigid model, the rotor and the friction, added by hand."""

import numpy as np

from pendant.tick.modes import TICK
from sim.control.feed_forward import FeedForward
from sim.estimation.adaptive_friction import AdaptiveFriction
from sim.motion.moves import Reference
from tests.sim.arms import UR5E
from tests.sim.laws import EXACT, dynamics

Q, QD, QDD = np.array([0.3, -1.2, 1.1, -0.7, 0.4, 0.2]), np.linspace(-0.6, 0.8, 6), np.linspace(2.0, -3.0, 6)
MOTION = Reference(Q, QD, QDD)
ROTOR = np.array(UR5E.motors.rotor_inertia)
AS_FILED = np.zeros(UR5E.n)


def equations_of_motion() -> np.ndarray:
    """M qdd + h, by energies: the mass matrix and the gravity of the model, Coriolis terms by differences of M."""
    model = dynamics()
    step, n = 1e-6, UR5E.n
    dM = np.stack([(model.mass(Q + step * row) - model.mass(Q - step * row)) / (2 * step) for row in np.eye(n)])
    coriolis = np.einsum("kij,k,j->i", dM, QD, QD) - 0.5 * np.einsum("ijk,j,k->i", dM, QD, QD)
    return model.mass(Q) @ QDD + coriolis + model.gravity(Q)


def test_without_friction_it_is_the_equation_of_motion_and_the_rotor() -> None:
    module = FeedForward(UR5E, EXACT, dynamics())
    torque = module.torque(MOTION, None, motion=True, stiffer=AS_FILED)
    expected = equations_of_motion()
    np.testing.assert_allclose(module.tau_J, expected, atol=1e-5)
    np.testing.assert_allclose(torque, expected + ROTOR * QDD, atol=1e-5)


def test_friction_splits_between_motor_and_transmission() -> None:
    module, friction = FeedForward(UR5E, EXACT, dynamics()), AdaptiveFriction(UR5E)
    for _ in range(200):  # ways of many bristles, even of the slowest joint
        torque = module.torque(MOTION, friction, motion=True, stiffer=AS_FILED)
    model = equations_of_motion()
    total = friction.at(QD, model)
    assert np.abs(total).min() > 1.0
    assert (np.sign(total) == np.sign(QD)).all()
    np.testing.assert_allclose(module.tau_J, model + UR5E.frictions.output_share * total, atol=1e-5)
    np.testing.assert_allclose(torque, model + total + ROTOR * QDD, atol=1e-5)


def test_without_motion_it_is_gravity_alone() -> None:
    module = FeedForward(UR5E, EXACT, dynamics())
    torque = module.torque(MOTION, AdaptiveFriction(UR5E), motion=False, stiffer=AS_FILED)
    np.testing.assert_allclose(torque, dynamics().gravity(Q))
    np.testing.assert_allclose(module.tau_J, torque)


def test_what_it_gave_before_stays() -> None:
    module = FeedForward(UR5E, EXACT, dynamics())
    module.torque(MOTION, None, motion=False, stiffer=AS_FILED)
    first = module.tau_J
    kept = first.copy()
    module.torque(Reference(Q + 0.5, QD, QDD), None, motion=False, stiffer=AS_FILED)
    assert (first == kept).all()


def rubbed(module: FeedForward, friction: AdaptiveFriction, qd: float, stiffer: np.ndarray = AS_FILED) -> np.ndarray:
    """Friction that is fed forward for a uniform motion at one place."""
    motion = Reference(Q, np.full(UR5E.n, qd), np.zeros(UR5E.n))
    return module.torque(motion, friction, motion=True, stiffer=stiffer) - FeedForward(UR5E, EXACT, dynamics()).torque(
        motion, None, motion=True, stiffer=stiffer
    )


def test_friction_turns_round_over_the_way_of_the_bristles_whatever_the_speed() -> None:
    """Dahl: after the way x beyond a reversal friction is 1 - 2 exp(-x presliding / f) of sliding friction."""
    presliding = np.array(UR5E.frictions.presliding)
    for speed in (0.002, 0.02):
        module, friction = FeedForward(UR5E, EXACT, dynamics()), AdaptiveFriction(UR5E)
        for _ in range(2000):
            rubbed(module, friction, -speed)
        for ticks in range(1, 200):
            fed = rubbed(module, friction, speed)
            sliding = friction.at(np.full(UR5E.n, speed), module.tau_J)
            # The load of the output's friction moves the motor, too: little beside the motion.
            expected = sliding * (1.0 - 2.0 * np.exp(-ticks * speed * TICK * presliding / sliding))
            np.testing.assert_allclose(fed, expected, atol=0.02 * sliding.max())


def test_friction_stays_where_the_motion_stops_and_is_unknown_where_it_begins() -> None:
    module, friction = FeedForward(UR5E, EXACT, dynamics()), AdaptiveFriction(UR5E)
    for _ in range(500):
        moving = rubbed(module, friction, 0.01)
    np.testing.assert_allclose(rubbed(module, friction, 0.0), moving, rtol=0.1)
    begun = module.torque(Reference(Q, np.zeros(UR5E.n), np.zeros(UR5E.n)), friction, motion=True, stiffer=AS_FILED, fresh=True)
    np.testing.assert_allclose(begun, dynamics().gravity(Q), atol=1e-9)


def test_a_load_that_changes_turns_the_motor_against_its_friction() -> None:
    """The output stands, the push grows: the spring bends, and the motor rubs; less so where the spring is stiffer."""
    fed = []
    for stiffer in (AS_FILED, np.full(UR5E.n, 0.2)):
        module, friction = FeedForward(UR5E, EXACT, dynamics()), AdaptiveFriction(UR5E)
        still = Reference(Q, np.zeros(UR5E.n), np.zeros(UR5E.n))
        push = np.zeros(UR5E.n)
        module.torque(still, friction, motion=True, stiffer=stiffer, push=push, fresh=True)
        push = np.full(UR5E.n, 0.1)
        fed.append(module.torque(still, friction, motion=True, stiffer=stiffer, push=push) - dynamics().gravity(Q) - push)
    stiffness = np.array(UR5E.transmissions.stiffness) + np.array(UR5E.transmissions.hysteresis_stiffness)
    np.testing.assert_allclose(fed[0], 0.1 / stiffness * np.array(UR5E.frictions.presliding), rtol=0.05)
    np.testing.assert_allclose(fed[1], fed[0] / 1.2, rtol=0.05)
