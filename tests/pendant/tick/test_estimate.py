"""The estimate as a value: what it is without what nobody told, and its copy."""

from dataclasses import MISSING, fields

import numpy as np
import pytest

from pendant.tick.estimate import NOT_ASKED, Estimate, WhoseForce
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
    drawn = {name: rng.normal(size=len(value) or 6) for name, value in known.whose._asdict().items() if _is_array(value)}
    known.whose = WhoseForce(lost_odds=3.0, **drawn)
    copy = known.copy()
    for value, twin in zip(known.whose, copy.whose, strict=True):
        assert not (_is_array(value) and value is twin)
        np.testing.assert_array_equal(value, twin)
    for each in fields(Estimate):
        value = getattr(known, each.name)
        if isinstance(value, np.ndarray):
            assert getattr(copy, each.name) is not value
            np.testing.assert_array_equal(getattr(copy, each.name), value)
        elif each.name != "whose":
            assert getattr(copy, each.name) == value


def test_what_is_told_of_nobodys_force_belongs_to_all_and_nobody_writes_it() -> None:
    assert len(NOT_ASKED.tau_hand) == len(NOT_ASKED.tau_certain) == 0
    for force in (NOT_ASKED.F_link, NOT_ASKED.F_touch):
        with pytest.raises(ValueError, match="read-only"):
            force[0] = 1.0


def _is_array(value: object) -> bool:
    return isinstance(value, np.ndarray)
