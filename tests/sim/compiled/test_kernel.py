"""Records in kernels, and a cache that outlives a change of the code."""

import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from sim.compiled.kernel import kernel
from sim.compiled.record import Record, record

ENVIRONMENT = {**os.environ, "PYTHONPATH": str(Path(__file__).parents[3])}

MODULE = """
from typing import NamedTuple

import numpy as np

from sim.compiled.kernel import kernel


class {name}(NamedTuple):
    values: np.ndarray


@kernel
def total(given):
    return given.values.sum() + {more}


print(total({name}(np.ones(3))))
"""


@kernel
def _move(thing, by) -> None:
    own = thing[0]
    for i in range(own.place.size):
        own.place[i] += own.scale * by[i]
        own.turn[i, i] = own.place[i]
    own.count += 1


@pytest.fixture
def thing() -> Record:
    return record(place=(3,), turn=(3, 3), scale=(), count="i8")


def test_a_kernel_reads_and_writes_the_columns_of_a_record(thing: Record) -> None:
    place = thing["place"][0]
    thing["scale"] = 2.0
    _move(thing, np.array([1.0, 2.0, 3.0]))
    _move(thing, np.array([1.0, 2.0, 3.0]))
    np.testing.assert_array_equal(place, [4.0, 8.0, 12.0])
    np.testing.assert_array_equal(thing["turn"][0], np.diag([4.0, 8.0, 12.0]))
    assert thing["count"][0] == 2


def test_a_record_begins_with_zeros(thing: Record) -> None:
    assert thing.shape == (1,)
    assert [np.abs(thing[name]).max() for name in thing.dtype.names or ()] == [0.0] * 4


@pytest.mark.parametrize(("name", "more"), [("Given", 1), ("Renamed", 0), ("Renamed", 1)])
def test_a_cached_kernel_whose_types_were_renamed_is_compiled_again(name: str, more: int, tmp_path: Path) -> None:
    def said(name: str, more: int) -> str:
        (tmp_path / "module.py").write_text(MODULE.format(name=name, more=more), encoding="utf-8")
        done = subprocess.run(
            [sys.executable, "module.py"], cwd=tmp_path, capture_output=True, text=True, env=ENVIRONMENT, check=False
        )
        assert done.returncode == 0, done.stderr
        return done.stdout.strip()

    assert said("Given", 0) == "3.0"
    assert said(name, more) == f"{3.0 + more}"
