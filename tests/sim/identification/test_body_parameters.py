"""A body as ten numbers: there and back, in another frame, and which numbers can be a body."""

import numpy as np
import pytest

from sim.arm.chain import Body
from sim.arm.frames import rotation_from_rpy
from sim.identification.body_parameters import body_of, distance, is_body, moved, parameters_of

BODY = Body(2.0, np.array([0.1, -0.05, 0.2]), np.diag([0.03, 0.04, 0.05]))


def test_there_and_back():
    again = body_of(parameters_of(BODY))
    assert again.mass == pytest.approx(BODY.mass)
    assert again.com == pytest.approx(BODY.com)
    assert again.inertia == pytest.approx(BODY.inertia)


def test_in_another_frame_it_is_the_same_body():
    R, p = rotation_from_rpy([0.3, -0.5, 1.0]), np.array([0.2, 0.1, -0.3])
    there = body_of(moved(parameters_of(BODY), R, p))
    assert there.com == pytest.approx(R @ BODY.com + p)
    assert there.inertia == pytest.approx(R @ BODY.inertia @ R.T)


@pytest.mark.parametrize(
    ("inertia", "can"),
    [([0.03, 0.04, 0.05], True), ([0.01, 0.02, 0.029], True), ([0.01, 0.02, 0.031], False), ([0.03, 0.04, -0.01], False)],
)
def test_no_moment_of_inertia_is_larger_than_the_two_others_together(inertia, can):
    assert is_body(parameters_of(Body(1.0, np.array([0.1, 0.0, 0.0]), np.diag(inertia)))) is can


def test_a_step_of_less_than_the_distance_to_the_border_ends_at_a_body():
    start = parameters_of(BODY)
    D, rng = distance(start), np.random.default_rng(5)
    for _ in range(200):
        step = rng.normal(size=10) * np.abs(start + 0.01)
        assert is_body(start + 0.7 * step / np.sqrt(step @ D @ step))


def test_the_distance_is_the_same_in_any_frame():
    R, p = rotation_from_rpy([0.3, -0.5, 1.0]), np.array([0.2, 0.1, -0.3])
    step = 0.05 * parameters_of(Body(1.0, np.array([0.3, 0.1, 0.0]), np.diag([0.01, 0.02, 0.02])))
    start = parameters_of(BODY)
    here = step @ distance(start) @ step
    there = moved(step, R, p) @ distance(moved(start, R, p)) @ moved(step, R, p)
    assert there == pytest.approx(here, rel=1e-6)
