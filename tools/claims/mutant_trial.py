"""One session on a changed copy of the product, at some seeds, in a process of its own.

What does not change is imported here, and the compiler of kernels is started, so that processes forked from one that has imported
this module have it all. The product itself is imported by `trial` alone, from the copy.
"""

import sys
from multiprocessing.connection import Connection
from pathlib import Path
from typing import Any, NamedTuple

import coal  # pyright: ignore[reportMissingTypeStubs, reportUnusedImport]  # noqa: F401
import mcap.writer  # noqa: F401
import msgspec
import mujoco  # noqa: F401
import numba
import numpy as np  # noqa: F401
import pinocchio  # pyright: ignore[reportMissingTypeStubs, reportUnusedImport]  # noqa: F401
import yaml  # noqa: F401

TOPS = ("app", "sim", "pendant", "assets")
"""Packages of the product."""


def _nothing() -> None:
    """What the compiler is started with."""


_start: Any = numba.njit(_nothing)
_start()


class Asked(NamedTuple):
    """What a process is to run."""

    copy: str  # folder with the packages of the product
    session: str  # name of a bundled one
    fails: str  # words of the expectation with which a run ends where that is not met
    seeds: tuple[int, ...]


def trial(asked: Asked, told: Connection) -> None:
    """Run the session at each seed; for each, `told` is sent its verdicts, as tuples, or a line that says why there are none."""
    for name in [name for name in sys.modules if name.partition(".")[0] in TOPS]:
        del sys.modules[name]
    sys.path.insert(0, asked.copy)
    for seed in asked.seeds:
        try:
            told.send(_verdicts(asked, seed))
        except Exception as error:  # noqa: BLE001 - whatever a mutant breaks down with
            told.send(f"breaks down: {type(error).__name__}: {' '.join(str(error).split())}")


def _verdicts(asked: Asked, seed: int) -> list[tuple[bool, str, str, bool]]:
    import app
    from app.files.checked import load
    from app.runs.runner import missed, run, simulate
    from app.session.prepare import prepare
    from app.session.session_file import Session, find

    assert Path(app.__file__).is_relative_to(asked.copy), "the product itself was imported, not its copy"
    session = msgspec.structs.replace(load(find(asked.session), Session), seed=seed)
    prepared = prepare(session, f"{asked.session}.yaml")
    outcome = run(session, prepared, simulate(prepared), None, enough=lambda told: missed(told) and asked.fails in told.expected)
    return [(verdict.passed, verdict.expected, verdict.seen, verdict.looked) for verdict in outcome.verdicts]
