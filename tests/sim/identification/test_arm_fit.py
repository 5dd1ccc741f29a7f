"""A fit of logs of drawn arms: what it finds is true within what it states, and what no log tells stays as filed."""

import numpy as np
import pytest

from app.files.library import load_arm
from benchmarks.fits.drawn_arms import DrawnArm
from sim.identification.arm_fit import fit, told
from sim.identification.body_parameters import is_body
from sim.identification.fitted_arm import fitted_arm
from sim.identification.motion_samples import sampled
from sim.identification.torque_model import LoggedRun, TorqueModel

ARM = load_arm("ur10e")
STILL = [2, 5]


@pytest.fixture(scope="module")
def drawn():
    return DrawnArm(ARM, 71, seconds=40.0)


@pytest.fixture(scope="module")
def found(drawn):
    return fit(TorqueModel(ARM), [drawn.run(False), drawn.run(True)])


@pytest.fixture(scope="module")
def half_still(drawn):
    return fit(TorqueModel(ARM), [drawn.run(False, STILL)])


def test_it_finds_friction_rotors_and_load(found, drawn):
    at, speeds = found.places, np.linspace(0.05, 1.2, 24)
    curves = drawn.friction(speeds, found.x[at.friction].reshape(6, -1))
    true = drawn.friction(speeds, drawn.smooth) * drawn.slow(speeds)
    assert np.median(np.abs(curves / true - 1.0), axis=1).max() < 0.05
    assert np.abs(found.x[at.rotor] / drawn.rotor - 1.0).max() < 0.10
    assert found.x[at.load][0] == pytest.approx(drawn.load.mass, abs=0.05)


def test_what_it_states_holds(found, drawn):
    at = found.places
    true = [(at.friction, drawn.curves.ravel()), (at.rotor, drawn.rotor), (at.load_friction, drawn.load_friction)]
    true += [(at.offset, drawn.offset), (at.constant, drawn.constant - 1.0)]
    off = np.concatenate([np.abs(found.x[part] - value) / found.deviation[part] for part, value in true])
    assert (off < 2.0).mean() > 0.8  # of one arm; its values are not independent: benchmarks/fit.py has fifty
    assert np.median(off) > 0.1  # and is no empty statement


def test_a_weight_that_is_known_tells_the_torque_constants_better(found, drawn):
    at, mass = found.places, drawn.load.mass
    weighed = fit(TorqueModel(ARM), [drawn.run(False), drawn.run(True)], mass)
    assert weighed.x[at.load][0] == pytest.approx(mass, abs=0.01)
    assert weighed.deviation[at.constant][1] < found.deviation[at.constant][1]


def test_all_links_are_bodies(found):
    assert all(is_body(found.model.link(found.x, k)) for k in range(6))


def test_what_no_run_tells_stays_as_filed(half_still):
    at, sure = half_still.places, told(half_still)
    for part, filed in ((at.rotor, ARM.motors.rotor_inertia), (at.load_friction, ARM.frictions.load)):
        assert not sure[part][STILL].any()
        assert half_still.x[part][STILL] == pytest.approx(np.array(filed)[STILL], rel=1e-3)
    for joint in STILL:
        assert not sure[at.curve(joint)].any()
        assert half_still.x[at.curve(joint)] == pytest.approx(np.array(ARM.frictions.torque[joint]), rel=1e-3)
    assert sure[at.rotor][[1, 3, 4]].all()


def test_the_file_has_what_was_found_and_how_sure_it_is(found):
    made, at = fitted_arm(found, "mine", "A log.", weighed=False), found.places
    assert made.frictions.status == "measured"
    assert np.array(made.frictions.torque) == pytest.approx(found.x[at.friction].reshape(6, -1), abs=1e-4)
    assert made.accuracy.rotor_inertia == pytest.approx((2.0 * found.deviation / found.x)[at.rotor].max(), abs=1e-3)
    assert "rotor_inertia" not in made.accuracy.assumed
    assert "torque_constant" in made.motors.assumed
    again = TorqueModel(made)
    assert again.links == pytest.approx(np.array([found.model.link(found.x, k) for k in range(6)]), abs=2e-3)


def test_a_joint_that_rests_is_not_counted():
    t = np.arange(0.0, 10.0, 0.008)
    qd = np.where((t > 4.0) & (t < 6.0), 0.0, 0.5)[:, None]
    samples = sampled([(t, np.cumsum(qd, axis=0) * 0.008, qd, qd)], ARM.frictions.speed)
    rests = (samples.t > 3.9) & (samples.t < 6.1)
    assert not samples.moves[rests].any()
    assert samples.moves[(samples.t < 3.7) | (samples.t > 6.3)].all()


def test_a_stretch_that_is_too_short_gives_no_sample():
    t, rest = np.arange(0.0, 0.5, 0.008), np.zeros((63, 6))
    assert len(sampled([(t, rest, rest, rest)], ARM.frictions.speed).t) == 0


def test_what_is_left_of_a_run_is_less_than_before(found, drawn):
    other = LoggedRun("other", sampled([drawn.log(False)], ARM.frictions.speed))
    (after, moves), (before, _) = found.left(other), found.left(other, found.before)
    assert all(after[i][moves[i]].std() < 0.5 * before[i][moves[i]].std() for i in range(6))
