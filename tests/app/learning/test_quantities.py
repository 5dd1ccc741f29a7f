import numpy as np
import pytest

from app.learning.quantities import QuantityBox, even

BOX = QuantityBox((even("angle", (1.0, 2.0), "rad", "of joints"), even("force", (30.0,) * 3, "N", "of a hand")))


def test_the_numbers_of_a_box_have_names_units_and_bounds() -> None:
    assert BOX.shape == (5,)
    assert BOX.dtype == np.float32
    np.testing.assert_array_equal(BOX.high, [1.0, 2.0, 30.0, 30.0, 30.0])
    np.testing.assert_array_equal(BOX.low, -BOX.high)
    assert repr(BOX) == "QuantityBox(angle[2] rad, force[3] N)"


def test_a_quantity_is_found_by_its_name() -> None:
    assert BOX.part("angle") == slice(0, 2)
    assert BOX.part("force") == slice(2, 5)
    with pytest.raises(KeyError, match="'speed': there are angle, force"):
        BOX.part("speed")


def test_what_is_beyond_a_bound_is_told_as_the_bound() -> None:
    told = BOX.within(np.array([0.5, -3.0]), np.array([40.0, -1.0, -31.0]))
    assert told.dtype == np.float32
    np.testing.assert_array_equal(told, np.array([0.5, -2.0, 30.0, -1.0, -30.0], dtype=np.float32))
    assert told in BOX
