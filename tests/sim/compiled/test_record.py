from sim.compiled.record import record


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
