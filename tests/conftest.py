"""What all tests share."""

import gc
from pathlib import Path

import pytest
from hypothesis import settings

# A deadline an example would time the machine, not the code. The examples are the same in every run, so that a test that passed
# passes again; `--hypothesis-profile=default` looks for new ones.
settings.register_profile("steady", deadline=None, derandomize=True)
settings.load_profile("steady")

HERE = Path(__file__).parent
ON_THE_CLOCK = tuple(
    f"{HERE / folder}/" for folder in ("e2e", "app/engine", "app/robot_interface", "app/urscript", "app/learning")
)
"""Tests with browsers, clients and processes that live by the machine's clock, which no test can stop."""


# Ten thousand tests are found, and none is thrown away: looking for garbage among them takes a fifth of the time to find them.
gc.disable()


def pytest_collection_finish() -> None:
    gc.enable()
    gc.freeze()


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """A test on the machine's clock that fails runs once more, and is named at the end as RERUN: a machine may be late once."""
    if config.pluginmanager.hasplugin("rerunfailures"):
        for item in items:
            if str(item.path).startswith(ON_THE_CLOCK):
                item.add_marker(pytest.mark.flaky(reruns=1))
