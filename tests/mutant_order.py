"""A pytest plugin of `make mutate`: the tests likeliest to notice a mutant come first, and those that hardly can are left out.

mutmut hands over every test that reaches a mutant, the quick before the slow, and stops at the first that fails. Most of the
pendant is reached by hundreds of whole sequences: a mutant that survives would take minutes, one without end half an hour. So it
has to be noticed by the tests of its own module, or by the quickest of the others. What only a slower one would notice counts as
a survivor.
"""

import os
import resource
import time
from collections.abc import Iterable, Mapping
from itertools import accumulate
from math import ceil
from pathlib import Path

import pytest

OTHERS = 2.0
"""s: what the tests of other modules may last together, by their durations without a mutant."""

COLLECTION = 10.0
"""s: what it may take until the tests begin."""

ENDLESS = 3.0
"""A mutant has no end where its tests take this many times as long as without it, in processor time."""


def pytest_configure(config: pytest.Config) -> None:
    """Order and choose the tests of the mutant under test; without one, as mutmut measures durations, all stay as they are.

    Before they are collected: that alone takes a second for thousands of them, and most mutants die of the first that runs.
    """
    mutant = os.environ.get("MUTANT_UNDER_TEST", "")
    if "__mutmut_" not in mutant:
        return
    from mutmut.state import state  # installed by `make mutate` alone

    lasts = state().duration_by_test
    config.args = chosen(config.args, mutant.partition(".x")[0].rpartition(".")[2], lasts)
    limit = COLLECTION + ENDLESS * sum(lasts[test] for test in config.args)
    _, most = resource.getrlimit(resource.RLIMIT_CPU)
    resource.setrlimit(resource.RLIMIT_CPU, (ceil(time.process_time() + limit), most))


def chosen(tests: Iterable[str], module: str, lasts: Mapping[str, float]) -> list[str]:
    """The tests to run, in their order.

    Args:
        tests: names of those that reach the mutant.
        module: of the mutant.
        lasts: how long each of them takes without a mutant [s].
    """
    quickest = sorted(tests, key=lambda test: lasts[test])
    own = [test for test in quickest if _of(test) == module]
    others = [test for test in quickest if _of(test) != module]
    spent = accumulate(lasts[test] for test in others)
    return [*own, *(test for test, total in zip(others, spent, strict=True) if total <= OTHERS)]


def _of(test: str) -> str:
    """The module that a test is of, by the name of its file."""
    return Path(test.partition("::")[0]).stem.removeprefix("test_")
