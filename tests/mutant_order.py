"""A pytest plugin of `make mutate`: the tests likeliest to notice a mutant come first, and those that hardly can are left out.

mutmut hands over every test that reaches a mutant, the quick before the slow, and stops at the first that fails. Most of the
pendant is reached by hundreds of whole sequences: a mutant that survives would take minutes, one without end half an hour. So it
has to be noticed by the tests of its own module, or by the quickest of the others. What only a slower one would notice counts as
a survivor.
"""

import os
import resource
import time
from itertools import accumulate
from math import ceil
from pathlib import Path

import pytest
from mutmut.state import state

OTHERS = 2.0
"""s: what the tests of other modules may last together, by their durations without a mutant."""

COLLECTION = 10.0
"""s: what it may take until the tests begin."""

ENDLESS = 3.0
"""A mutant has no end where its tests take this many times as long as without it, in processor time."""


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Order and choose the tests of the mutant under test; without one, as mutmut measures durations, all stay as they are."""
    mutant = os.environ.get("MUTANT_UNDER_TEST", "")
    if "__mutmut_" not in mutant:
        return
    module = mutant.partition(".x")[0].rpartition(".")[2]
    lasts = state().duration_by_test
    own = [item for item in items if Path(item.location[0]).stem == f"test_{module}"]
    others = sorted((item for item in items if item not in own), key=lambda item: lasts[item.nodeid])
    spent = accumulate(lasts[item.nodeid] for item in others)
    chosen = [item for item, total in zip(others, spent, strict=True) if total <= OTHERS]
    config.hook.pytest_deselected(items=others[len(chosen) :])
    items[:] = [*sorted(own, key=lambda item: lasts[item.nodeid]), *chosen]
    limit = COLLECTION + ENDLESS * sum(lasts[item.nodeid] for item in items)
    _, most = resource.getrlimit(resource.RLIMIT_CPU)
    resource.setrlimit(resource.RLIMIT_CPU, (ceil(time.process_time() + limit), most))
