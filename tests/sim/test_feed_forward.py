"""Feed-forward: the desired torques against the rigid model, the rotor and the friction, added by hand."""

import numpy as np

from sim.adaptive_friction import AdaptiveFriction
from sim.feed_forward import FeedForward
from sim.moves import Reference
from tests.sim.arms import UR5E
from tests.sim.control import EXACT, dynamics

Q, QD, QDD = np.array([0.3, -1.2, 1.1, -0.7, 0.4, 0.2]), np.linspace(-0.6, 0.8, 6), np.linspace(2.0, -3.0, 6)
MOTION = Reference(Q, QD, QDD)
ROTOR = np.array(UR5E.motors.rotor_inertia)


def equations_of_motion() -> np.ndarray:
    """M qdd + h, by energies: the mass matrix and the gravity of the model, Coriolis terms by differences of M."""
    model = dynamics()
    step, n = 1e-6, UR5E.n
    dM = np.stack([(model.mass(Q + step * row) - model.mass(Q - step * row)) / (2 * step) for row in np.eye(n)])
    coriolis = np.einsum("kij,k,j->i", dM, QD, QD) - 0.5 * np.einsum("ijk,j,k->i", dM, QD, QD)
    return model.mass(Q) @ QDD + coriolis + model.gravity(Q)


def test_without_friction_it_is_the_equation_of_motion_and_the_rotor() -> None:
    module = FeedForward(UR5E, EXACT, dynamics())
    torque = module.torque(MOTION, None, motion=True)
    expected = equations_of_motion()
    np.testing.assert_allclose(module.tau_J, expected, atol=1e-5)
    np.testing.assert_allclose(torque, expected + ROTOR * QDD, atol=1e-5)


def test_friction_splits_between_motor_and_transmission() -> None:
    module, friction = FeedForward(UR5E, EXACT, dynamics()), AdaptiveFriction(UR5E)
    friction.warmth[:] = 1.0
    torque = module.torque(MOTION, friction, motion=True)
    model = equations_of_motion()
    total = friction.at(QD, model)
    assert np.abs(total).min() > 1.0
    assert (np.sign(total) == np.sign(QD)).all()
    np.testing.assert_allclose(module.tau_J, model + UR5E.frictions.output_share * total, atol=1e-5)
    np.testing.assert_allclose(torque, model + total + ROTOR * QDD, atol=1e-5)


def test_without_motion_it_is_gravity_alone() -> None:
    module = FeedForward(UR5E, EXACT, dynamics())
    torque = module.torque(MOTION, AdaptiveFriction(UR5E), motion=False)
    np.testing.assert_allclose(torque, dynamics().gravity(Q))
    np.testing.assert_allclose(module.tau_J, torque)


def test_what_it_gave_before_stays() -> None:
    module = FeedForward(UR5E, EXACT, dynamics())
    module.torque(MOTION, None, motion=False)
    first = module.tau_J
    kept = first.copy()
    module.torque(Reference(Q + 0.5, QD, QDD), None, motion=False)
    assert (first == kept).all()
