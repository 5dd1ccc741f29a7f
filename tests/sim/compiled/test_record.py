import pytest

from sim.compiled.record import Number, record


def test_records_of_the_same_columns_share_their_layout() -> None:
    first, second = record(angle=(6,), number="i8"), record(angle=(6,), number="i8")
    assert first.dtype is second.dtype  # equal is not enough: kernels compare what is not the same object, column by column
    assert first is not second


def test_other_columns_have_another_layout() -> None:
    assert record(angle=(6,)).dtype != record(angle=(7,)).dtype
    assert record(angle=(6,)).dtype != record(torque=(6,)).dtype


def test_a_record_begins_with_zeros_in_the_shapes_asked_for() -> None:
    one = record(angle=(2, 3), share=(), number="i8")
    assert one["angle"][0].shape == (2, 3)
    assert one["share"][0] == one["number"][0] == 0
    assert not one["angle"].any()


class Kept:
    angle = Number()

    def __init__(self) -> None:
        self._own = record(angle=())[0]


def test_a_number_of_a_record_is_read_and_not_written() -> None:
    one, other = Kept(), Kept()
    one._own["angle"] = 0.5
    assert (one.angle, other.angle) == (0.5, 0.0)
    assert type(one.angle) is float
    with pytest.raises(AttributeError, match="angle"):
        one.angle = 1.0
