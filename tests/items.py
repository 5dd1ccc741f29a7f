"""One test of many items that are alike: quick to collect, and it names the items that fail."""

from collections.abc import Callable, Iterable
from inspect import signature
from typing import Any

import pytest

SHOWN = 5
"""Items whose failures are told in whole; of all others the names."""

Test = Callable[..., None]


def each_of(items: Iterable[Any], name: Callable[..., object] = lambda *item: item) -> Callable[[Test], Callable[[], None]]:
    """Make one test of a test of an item.

    Args:
        items: for a test of one argument what it gets, for a test of several arguments a tuple of these.
        name: what a failure calls an item, of the same arguments.

    Raises:
        ValueError: there is no item, so that the test could not fail.
    """
    those = list(items)
    if not those:
        raise ValueError("no items: the test could not fail")

    def one(test: Test) -> Callable[[], None]:
        several = len(signature(test).parameters) > 1

        def test_all() -> None:
            failed: dict[str, str] = {}
            for item in those:
                values = tuple(item) if several else (item,)
                try:
                    test(*values)
                except (Exception, pytest.fail.Exception) as error:  # noqa: BLE001 whatever fails is told with its item
                    failed[str(name(*values))] = f"{type(error).__name__}: {error}"
            told = [f"{of}: {why}" for of, why in list(failed.items())[:SHOWN]]
            if len(failed) > SHOWN:
                told.append(f"and {', '.join(list(failed)[SHOWN:])}")
            assert not failed, "\n".join([f"{len(failed)} of {len(those)} items:", *told])

        test_all.__name__, test_all.__doc__, test_all.__module__ = test.__name__, test.__doc__, test.__module__
        return test_all

    return one
