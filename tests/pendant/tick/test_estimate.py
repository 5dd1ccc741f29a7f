"""The estimate as a value: what it is without what nobody told, and its copy."""

from dataclasses import MISSING, fields

import numpy as np

from pendant.tick.estimate import Estimate
from tests.pendant.estimates import estimate

NEEDED = [each.name for each in fields(Estimate) if each.default is MISSING and each.default_factory is MISSING]


def test_what_is_not_told_is_nothing_and_belongs_to_one_estimate() -> None:
    known = estimate()
    one, other = (Estimate(**{name: getattr(known, name) for name in NEEDED}) for _ in range(2))
    for name in ("theta_dd", "friction", "friction_deviation", "tau_ways"):
        assert getattr(one, name).size == 0
        assert getattr(one, name) is not getattr(other, name)
    for name in ("tcp", "elbow", "F_joints", "a_felt"):
        assert not getattr(one, name).any()
        assert getattr(one, name).shape == ((6,) if name in ("tcp", "elbow") else (3,))
        assert getattr(one, name) is not getattr(other, name)
    assert one.lost == ()


def test_a_copy_has_the_same_values_in_arrays_of_its_own() -> None:
    rng = np.random.default_rng(3)
    known = estimate()
    for each in fields(Estimate):
        value = getattr(known, each.name)
        if isinstance(value, np.ndarray):
            setattr(known, each.name, rng.normal(size=value.shape if value.size else (6,)))
        elif isinstance(value, float):
            setattr(known, each.name, rng.normal())
    copy = known.copy()
    for each in fields(Estimate):
        value = getattr(known, each.name)
        if isinstance(value, np.ndarray):
            assert getattr(copy, each.name) is not value
            np.testing.assert_array_equal(getattr(copy, each.name), value)
        else:
            assert getattr(copy, each.name) == value
