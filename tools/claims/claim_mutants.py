"""Targeted mutants: the smallest change of code that takes away exactly what a claim says, and whether its session notices it.

They are data, in tools/claims/mutants. Each runs in a copy of the product, never in the product itself, at all seeds in one
process. Kernels are compiled again, once, where the change can be in them: in the changed module and in every one that imports
it, itself or by others.
"""

import ast
import multiprocessing
import os
import shutil
import tempfile
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from functools import cache
from multiprocessing.connection import Connection, wait
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

import msgspec

from app.files.checked import ABSENT, BadInput, load
from app.files.library import ASSETS

if TYPE_CHECKING:
    from multiprocessing.context import ForkServerContext, ForkServerProcess

FOLDER = Path(__file__).parent / "mutants"

PRODUCT = ASSETS.parent
"""The folder of the product's packages."""

TOPS = ("app", "sim", "pendant", "assets")

LINKED = (".nbc", ".nbi", ".glb")

LONGEST = 180.0
"""A session with a mutant that has not ended by then never will [s]."""

Verdicts = list[tuple[bool, str, str, bool]]
"""Of each expectation: passed, what was expected, what was seen, and whether its moment came."""


class Mutant(msgspec.Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """A change of one file, and the session that must fail with it."""

    session: str
    claims: list[str]  # that say what it takes away
    file: str  # path from the product's folder
    find: str  # text that the file holds once
    replace: str
    what: str  # the change, in words
    fails: str  # words of the expectation that must not be met


class MutantFile(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """A file of mutants."""

    mutants: list[Mutant]


class Trial(NamedTuple):
    """What became of a session with a mutant."""

    mutant: Mutant
    not_noticed: tuple[int, ...]  # seeds at which the session did not fail for the reason that the mutant names
    seen: str  # at the first of these, or else at the first of all

    @property
    def noticed(self) -> bool:
        """Whether the session noticed it at each seed."""
        return not self.not_noticed


def declared() -> list[Mutant]:
    """All of them, file by file.

    Raises:
        BadInput: a file cannot be read.
    """
    paths = sorted(FOLDER.glob("*.yaml"))
    return [mutant for path in paths for mutant in load(path, MutantFile).mutants]


def mutated(mutant: Mutant, folder: Path = PRODUCT) -> str:
    """The text of its file in `folder`, with the change.

    Raises:
        BadInput: there is no such file, or it does not hold the text once.
    """
    try:
        text = (folder / mutant.file).read_text(encoding="utf-8")
    except OSError:
        raise BadInput(mutant.file, "", ABSENT, "no such file") from None
    if text.count(mutant.find) != 1:
        raise BadInput(mutant.file, mutant.what, mutant.find, f"a text that is there once, not {text.count(mutant.find)} times")
    return text.replace(mutant.find, mutant.replace)


def copy_of(product: Path, folder: Path) -> Path:
    """Copy the product's packages, with what is compiled of them; gives `folder`."""
    for top in TOPS:
        shutil.copytree(product / top, folder / top, copy_function=_copy)
    return folder


def _copy(source: str, target: str) -> None:
    """What is compiled, and pictures, are never written in place: a link will do."""
    with suppress(OSError):
        if source.endswith(LINKED):
            os.link(source, target)
            return
    shutil.copy2(source, target)


def change(mutant: Mutant, copy: Path, product: Path = PRODUCT) -> None:
    """Make the change in a copy. What was compiled of the file, and of all that import it, is thrown away."""
    (copy / mutant.file).write_text(mutated(mutant, copy), encoding="utf-8")
    for path in importers(product, mutant.file):
        for compiled in (copy / path).parent.glob(f"__pycache__/{Path(path).stem}.*.nb[ic]"):
            compiled.unlink()


def importers(folder: Path, file: str) -> set[str]:
    """The file and all of the product's files that import it, themselves or by others."""
    paths, uses = _graph(folder)
    found, new = set[str](), {_module(file)}
    while new:
        found |= new
        new = {name for name, used in uses.items() if used & new} - found
    return {paths[name] for name in found if name in paths}


@cache
def _graph(folder: Path) -> tuple[dict[str, str], dict[str, set[str]]]:
    """Paths of the product's modules, and which of each other they import, by name."""
    paths = {_module(path): path for top in TOPS[:3] for path in _sources(folder, top)}
    return paths, {name: _imports(folder / path, set(paths)) for name, path in paths.items()}


def _sources(folder: Path, top: str) -> Iterator[str]:
    return (path.relative_to(folder).as_posix() for path in (folder / top).rglob("*.py"))


def _module(path: str) -> str:
    return path.removesuffix(".py").removesuffix("/__init__").replace("/", ".")


def _imports(path: Path, known: set[str]) -> set[str]:
    found = set[str]()
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.ImportFrom) and node.module:
            found |= {node.module, *(f"{node.module}.{alias.name}" for alias in node.names)}
        elif isinstance(node, ast.Import):
            found |= {alias.name for alias in node.names}
    return found & known


def judged(mutant: Mutant, told: dict[int, Verdicts | str]) -> Trial:
    """Whether the session noticed the mutant at each seed, of what it came to there, and what was seen."""
    found = {seed: _judged(mutant, verdicts) for seed, verdicts in told.items()}
    missed = tuple(seed for seed, (noticed, _) in found.items() if not noticed)
    return Trial(mutant, missed, found[next(iter(missed or found))][1])


def _judged(mutant: Mutant, verdicts: Verdicts | str) -> tuple[bool, str]:
    if isinstance(verdicts, str):
        return False, verdicts
    failed = [(expected, seen, looked) for passed, expected, seen, looked in verdicts if not passed]
    named = [f"{expected}: {seen}" for expected, seen, looked in failed if looked and mutant.fails in expected]
    if named:
        return True, named[0]
    if failed:
        return False, f"fails, but for another reason: {failed[0][0]}: {failed[0][1]}"
    return False, "everything is as expected"


@dataclass(slots=True)
class _Run:
    mutant: Mutant
    process: "ForkServerProcess"
    told: Connection
    seeds: tuple[int, ...]
    folder: "tempfile.TemporaryDirectory[str]"
    found: dict[int, Verdicts | str] = field(default_factory=dict[int, "Verdicts | str"])
    until: float = field(default_factory=lambda: time.monotonic() + LONGEST)

    def over(self) -> bool:
        """Take in what the process said of its next seeds; True when it has said all, or will say no more."""
        with suppress(EOFError):
            while len(self.found) < len(self.seeds) and self.told.poll():
                self.found[self.seeds[len(self.found)]] = self.told.recv()
                self.until = time.monotonic() + LONGEST
        return len(self.found) == len(self.seeds) or not self.process.is_alive() or time.monotonic() >= self.until

    def end(self) -> Trial:
        """End the process; of a seed that it said nothing of, say why."""
        late = time.monotonic() >= self.until
        self.told.close()
        self.process.kill()
        self.process.join()
        self.folder.cleanup()
        unsaid = f"has not ended after {LONGEST:g} s" if late else "breaks down"
        return judged(self.mutant, {seed: self.found.get(seed, unsaid) for seed in self.seeds})


def run_mutants(
    chosen: Sequence[Mutant],
    seeds: Sequence[int],
    told: Callable[[int, int], None] = lambda done, of: None,
    *,
    workers: int | None = None,
    product: Path = PRODUCT,
) -> list[Trial]:
    """Run the session of each mutant in a copy with its change, at each seed; copies in parallel.

    Args:
        chosen: the mutants.
        seeds: at which each runs.
        told: how many copies are done, of how many.
        workers: processes at once; None: as many as there are cores.
        product: what is copied.

    Raises:
        BadInput: a mutant does not fit the product.
    """
    for mutant in chosen:
        mutated(mutant, product)
    context = multiprocessing.get_context("forkserver")
    context.set_forkserver_preload(["tools.claims.mutant_trial"])
    trials: dict[int, Trial] = {}
    running: dict[int, _Run] = {}
    waiting = list(enumerate(chosen))
    try:
        while waiting or running:
            while waiting and len(running) < (workers or os.cpu_count() or 1):
                place, mutant = waiting.pop(0)
                running[place] = _started(context, mutant, tuple(seeds), product)
            left = min(run.until for run in running.values()) - time.monotonic()
            wait([run.told for run in running.values()], timeout=min(1.0, max(0.0, left)))
            for place, run in list(running.items()):
                if run.over():
                    trials[place] = running.pop(place).end()
                    told(len(trials), len(chosen))
    finally:
        for run in running.values():
            run.end()
    return [trials[place] for place in range(len(chosen))]


def _started(context: "ForkServerContext", mutant: Mutant, seeds: tuple[int, ...], product: Path) -> _Run:
    from tools.claims.mutant_trial import Asked, trial  # it imports much

    folder = tempfile.TemporaryDirectory(prefix="pendant-mutant-")
    copy = copy_of(product, Path(folder.name) / "product")
    change(mutant, copy, product)
    ours, theirs = context.Pipe(duplex=False)
    asked = Asked(str(copy), mutant.session, mutant.fails, seeds)
    process = context.Process(target=trial, args=(asked, theirs), daemon=True)
    process.start()
    theirs.close()
    return _Run(mutant, process, ours, seeds, folder)
