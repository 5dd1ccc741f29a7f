"""A model on its own: a torque it does not know moves it as that torque would, friction at rest holds, a gap ends it."""

import numpy as np
import pytest

from pendant.tick.modes import TICK
from sim.arm.chain import NOTHING, chain, plate_body
from sim.identification.model_drift import HORIZON, ModelDrift
from sim.rigid_body.dynamics import Dynamics
from tests.app.real_logs.synthetic_logs import ARM

ROTOR = np.array(ARM.motors.rotor_inertia)
TICKS = 400
UNKNOWN = np.array([3.0, -5.0, 2.0, 0.5, -0.5, 0.2])
FAST, SLOW = np.full((TICKS, ARM.n), 0.5), np.zeros((TICKS, ARM.n))
HOLDS = np.full(ARM.n, 1.5)


@pytest.fixture
def drift():
    rigid = chain(ARM)
    model = Dynamics(rigid, rigid.links, plate_body(ARM) + NOTHING, mounting=(0.0, 0.0, 0.0), elbow=ARM.chain.elbow)
    return ModelDrift(model, ROTOR), model


def test_an_unknown_torque_moves_it_as_it_would_move_the_arm(drift):
    """d = r t² / 2 M, after the horizon as at it."""
    made, model = drift
    q, left = np.array(ARM.chain.home), np.tile(UNKNOWN, (TICKS, 1))
    integral = made.add(left, left, FAST, holds=HOLDS)
    apart = made.angles(np.tile(q, (2, 1)), integral[[TICKS // 2, -1]])
    mass = model.mass(q) + np.diag(ROTOR)
    for each in apart:
        assert mass @ each == pytest.approx(0.5 * HORIZON**2 * UNKNOWN, rel=0.01)


def test_blocks_are_as_one(drift):
    made, _ = drift
    left = np.random.default_rng(2).normal(size=(TICKS, ARM.n))
    whole = made.add(left, left, FAST, holds=HOLDS)
    made.begin()
    parts = [made.add(left[part], left[part], FAST[part], holds=HOLDS) for part in (slice(0, 90), slice(90, None))]
    assert np.abs(np.concatenate(parts) - whole).max() < 1e-12


def test_what_friction_may_hold_moves_no_joint_that_stands(drift):
    made, _ = drift
    left = np.tile(UNKNOWN, (TICKS, 1))
    integral = made.add(np.zeros_like(left), left, SLOW, holds=HOLDS)[-1]
    beyond = np.sign(UNKNOWN) * np.maximum(np.abs(UNKNOWN) - HOLDS, 0.0)
    assert integral == pytest.approx(0.5 * HORIZON**2 * beyond, rel=0.01)
    assert (integral[3:] == 0.0).all()


def test_a_stretch_begins_where_it_was_measured(drift):
    made, _ = drift
    left = np.tile(UNKNOWN, (TICKS, 1))
    made.add(left, left, FAST, holds=HOLDS)
    made.begin()
    assert np.abs(made.add(left, left, FAST, holds=HOLDS)[0]).max() <= TICK * TICK * np.abs(UNKNOWN).max()
