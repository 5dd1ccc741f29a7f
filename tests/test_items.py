"""One test of many items tells which of them fail."""

import pytest

from tests.items import each_of


def test_all_that_fail_are_named_and_the_first_told_in_whole() -> None:
    tried: list[int] = []

    @each_of(range(20), lambda number: f"number {number}")
    def test_small(number: int) -> None:
        """Small numbers alone."""
        tried.append(number)
        assert number < 12, "too large"

    with pytest.raises(AssertionError) as failed:
        test_small()
    said = str(failed.value)
    assert said.startswith("8 of 20 items:\nnumber 12: AssertionError: too large")
    assert "and number 17, number 18, number 19" in said
    assert tried == list(range(20))
    assert (test_small.__name__, test_small.__doc__) == ("test_small", "Small numbers alone.")


def test_an_item_of_several_arguments_is_a_tuple_and_any_error_counts() -> None:
    @each_of([(1, 2), (1, 0)])
    def test_division(a: int, b: int) -> None:
        assert a / b

    with pytest.raises(AssertionError, match=r"^1 of 2 items:\n\(1, 0\): ZeroDivisionError"):
        test_division()

    @each_of([(1, 2), (1, 3)])
    def test_division_that_works(a: int, b: int) -> None:
        assert a / b

    test_division_that_works()


def test_no_items_are_no_test() -> None:
    with pytest.raises(ValueError, match="could not fail"):
        each_of([])
