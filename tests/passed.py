"""Runs of whole sessions are left out where nothing that they depend on has changed since they passed.

A run that passes writes a digest of all that it depends on: the modules that a session imports, themselves and by others, the
files of assets/, the session's own file with its seed, Python, and the versions of all packages. `make test-full` leaves nothing
out (`WHOLE=1`), and neither does a fresh clone, which has no digest.
"""

import ast
import hashlib
import os
import platform
import sys
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from functools import cache
from importlib.metadata import distributions
from pathlib import Path

import pytest

ROOT = Path(__file__).parent.parent
FOLDER = ROOT / "out" / "passed"
TOPS = ("app", "sim", "pendant", "tests", "tools")
APART = ("sessions", "page")
"""Folders of assets/ of which a run uses no more than its own file."""

WHOLE = bool(os.environ.get("WHOLE"))
"""Nothing is left out, and products are whole instead of by pairs: `make test-full`."""


def imported(roots: Iterable[str], top: Path = ROOT) -> list[Path]:
    """The files of some modules and of all that these import, wherever in their code, with the packages that these are in."""
    found: dict[str, Path] = {}
    new = list(roots)
    while new:
        name = new.pop()
        path = _file(name, top)
        if name not in found and path is not None:
            found[name] = path
            new += _imports(path, name) | {name.rpartition(".")[0]}
    return sorted(found.values())


def _file(name: str, top: Path) -> Path | None:
    if name.partition(".")[0] not in TOPS:
        return None
    base = top / name.replace(".", "/")
    return next((path for path in (base.with_suffix(".py"), base / "__init__.py") if path.is_file()), None)


def _imports(path: Path, name: str) -> set[str]:
    found = set[str]()
    package = name if path.stem == "__init__" else name.rpartition(".")[0]
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            found |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            above = ".".join(package.split(".")[: len(package.split(".")) - node.level + 1]) if node.level else ""
            module = ".".join(part for part in (above, node.module) if part)
            found |= {module, *(f"{module}.{alias.name}" for alias in node.names)}
    return found


@cache
def shared(roots: tuple[str, ...], top: Path = ROOT) -> str:
    """Digest of what all sessions depend on: code, assets, Python and packages."""
    digest = hashlib.sha256(f"{sys.version} {platform.machine()}".encode())
    for name, version in sorted((str(each.name), each.version) for each in distributions()):
        digest.update(f"{name} {version}\n".encode())
    assets = (path for path in sorted((top / "assets").rglob("*")) if path.is_file())
    for path in [*imported(roots, top), *(path for path in assets if path.relative_to(top).parts[1] not in APART)]:
        digest.update(f"{path.relative_to(top)} {hashlib.sha256(path.read_bytes()).hexdigest()}\n".encode())
    return digest.hexdigest()


@contextmanager
def left_out_where_passed(
    name: str, roots: tuple[str, ...], *own: str, top: Path = ROOT, folder: Path = FOLDER, whole: bool = WHOLE
) -> Iterator[None]:
    """Leave the test out, as a skip, where it passed with the same digest; where it passes now, write that.

    Args:
        name: of the run, a file name.
        roots: modules that it uses.
        own: what else it depends on, such as the text of its file and what it is held against.
        top: folder of the product.
        folder: of the digests.
        whole: leave nothing out.
    """
    digest = hashlib.sha256("\0".join([shared(roots, top), *own]).encode()).hexdigest()
    kept = folder / name
    if not whole and kept.is_file() and kept.read_text() == digest:
        pytest.skip("nothing that it depends on has changed since it passed")
    kept.unlink(missing_ok=True)
    yield
    folder.mkdir(parents=True, exist_ok=True)
    kept.write_text(digest)
