"""One session on a changed copy of the product, in a process of its own.

What does not change is imported here, and the compiler of kernels is started, so that processes forked from one that has imported
this module have it all. The product itself is imported by `trial` alone, from the copy.
"""

import sys
from multiprocessing.connection import Connection
from pathlib import Path
from typing import Any

import coal  # pyright: ignore[reportMissingTypeStubs, reportUnusedImport]  # noqa: F401
import mcap.writer  # noqa: F401
import msgspec  # noqa: F401
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


def trial(copy: str, asked: tuple[str, str], out: str, told: Connection) -> None:
    """Run a bundled session of the copy; `told` is sent its verdicts, as tuples, or a line that says why there are none.

    Args:
        copy: folder with the packages of the product.
        asked: name of the session; words of the expectation with which the run ends where that is not met.
        out: folder for what the run writes.
        told: where the result is sent.
    """
    for name in [name for name in sys.modules if name.partition(".")[0] in TOPS]:
        del sys.modules[name]
    sys.path.insert(0, copy)
    try:
        told.send(_verdicts(Path(copy), *asked, Path(out)))
    except Exception as error:  # noqa: BLE001 - whatever a mutant breaks down with
        told.send(f"breaks down: {type(error).__name__}: {' '.join(str(error).split())}")


def _verdicts(copy: Path, session: str, fails: str, out: Path) -> list[tuple[bool, str, str, bool]]:
    import app
    from app.files.checked import load
    from app.runs.runner import missed, run, simulate
    from app.session.prepare import prepare
    from app.session.session_file import Session, find

    assert Path(app.__file__).is_relative_to(copy), "the product itself was imported, not its copy"
    asked = load(find(session), Session)
    prepared = prepare(asked, f"{session}.yaml")
    outcome = run(asked, prepared, simulate(prepared), out, enough=lambda told: missed(told) and fails in told.expected)
    return [(verdict.passed, verdict.expected, verdict.seen, verdict.looked) for verdict in outcome.verdicts]
