"""A pytest plugin of `make mutate`: the tests likeliest to notice a mutant come first, and those that hardly can are left out.

mutmut hands over every test that reaches a mutant, the quick before the slow, and stops at the first that fails. Most of the
pendant is reached by hundreds of whole sequences: a mutant that survives would take minutes, one without end half an hour. So it
has to be noticed by the tests of its own module, or by the quickest of the others. What only a slower one would notice counts as
a survivor. Functions that the mutant leaves as they are get called straight, without mutmut's look at which mutant is under test.
"""

import os
import resource
import sys
import time
from collections.abc import Iterable, Mapping
from itertools import accumulate
from math import ceil
from pathlib import Path
from types import FunctionType

import pytest

OTHERS = 10.0
"""s: what the tests of other modules may last together, by their durations with all detours; a fifth of it without them."""

COLLECTION = 10.0
"""s: what it may take until the tests begin."""

DETOUR = "_trampoline_wrapper"
"""What mutmut calls the functions that it puts in place of others."""

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
    call_straight(mutant)
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


def call_straight(mutant: str) -> None:
    """Put the pendant's functions where mutmut's detours stand, but for the mutant's: most take longer than what they call.

    Those that somebody keeps elsewhere, in a table or a closure, still go round.
    """
    module, _, name = mutant.partition("__mutmut_")[0].rpartition(".")
    users = [user for key, user in sys.modules.items() if key.partition(".")[0] in ("pendant", "sim", "app", "tests")]
    classes = {value for user in users for value in vars(user).values() if isinstance(value, type)}
    for owner in (*users, *(one for one in classes if one.__module__.startswith("pendant."))):
        for key, value in list(vars(owner).items()):
            if isinstance(value, FunctionType) and value.__code__.co_name == DETOUR:
                original = value.__wrapped__
                if (original.__module__, _mangled(original.__qualname__)) != (module, name):
                    setattr(owner, key, original)


def _mangled(name: str) -> str:
    """A function's name as mutmut writes it, or a method's, given as `Class.method`."""
    return f"xǁ{name.replace('.', 'ǁ')}" if "." in name else f"x_{name}"


def _of(test: str) -> str:
    """The module that a test is of, by the name of its file."""
    return Path(test.partition("::")[0]).stem.removeprefix("test_")
