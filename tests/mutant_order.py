"""A pytest plugin of `make mutate`: the tests likeliest to notice a mutant come first, and those that hardly can are left out.

mutmut hands over every test that reaches a mutant, the quick before the slow, and stops at the first that fails. Most of the
pendant is reached by hundreds of whole sequences: a mutant that survives would take minutes, one without end half an hour. So it
has to be noticed by the tests of its own module, or by the quickest of the others. What only a slower one would notice counts as
a survivor.
"""

import os
import resource
import time
from collections.abc import Generator, Iterable, Mapping
from itertools import accumulate
from math import ceil
from pathlib import Path

import pytest

from tests.mutant_detours import Detour, standing

OTHERS = 6.0
"""s: what the tests of other modules may last together, by their durations with all detours; a fifth of it without them."""

FIRST = 16
"""Tests that are collected at first: half of the mutants die of three, and to collect hundreds takes longer than to run those."""

COLLECTION = 10.0
"""s: what it may take until the tests begin."""

ENDLESS = 3.0
"""A mutant has no end where its tests take this many times as long as without it, in processor time."""

_LATER = pytest.StashKey[list[str]]()
_detours: list[Detour] = []
"""As they were found before the first run without them."""


def pytest_configure(config: pytest.Config) -> None:
    """Order and choose the tests of the mutant under test.

    Without one all stay as they are: as mutmut measures durations, and looks whether the tests pass without and fail with its
    detours. It forks for each mutant from the process that did all that.
    """
    mutant = os.environ.get("MUTANT_UNDER_TEST", "")
    if mutant and "__mutmut_" not in mutant:
        for detour in _detours:
            detour.put_back()
        return
    if not _detours:
        _detours.extend(standing())
    for detour in _detours:
        detour.put(mutant)
    if mutant:
        _choose(config, mutant)


def _choose(config: pytest.Config, mutant: str) -> None:
    from mutmut.state import state  # installed by `make mutate` alone

    lasts = state().duration_by_test
    tests = chosen(config.args, mutant.partition(".x")[0].rpartition(".")[2], lasts)
    config.args, config.stash[_LATER] = tests[:FIRST], tests[FIRST:]
    config.option.tbstyle = "no"
    limit = COLLECTION + ENDLESS * sum(lasts[test] for test in tests)
    _, most = resource.getrlimit(resource.RLIMIT_CPU)
    resource.setrlimit(resource.RLIMIT_CPU, (ceil(time.process_time() + limit), most))


@pytest.hookimpl(wrapper=True)
def pytest_runtestloop(session: pytest.Session) -> Generator[None, object, object]:
    """Collect and run the rest where the first tests passed."""
    done = yield
    if later := session.config.stash.get(_LATER, []):
        session.config.stash[_LATER] = []
        session.perform_collect(later)
        return session.config.hook.pytest_runtestloop(session=session)
    return done


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
