"""Which source runs: versions, commit, and a digest over all files of the product, by which machines compare it."""

import functools
import hashlib
import subprocess
from collections.abc import Iterable
from pathlib import Path

import app
import assets
import pendant
import sim
from app.files.versions import versions

PARTS = (app, assets, pendant, sim)
"""Packages that the numbers of a session depend on."""


def digest_of(root: Path, folders: Iterable[str]) -> str:
    """12 hex digits over names and bytes of all files of folders of `root`, except those that Python or an editor leaves."""
    files = [path for folder in folders for path in (root / folder).rglob("*") if path.is_file()]
    found = hashlib.sha256()
    for name in sorted(path.relative_to(root).as_posix() for path in files):
        if not any(part.startswith((".", "__pycache__")) for part in name.split("/")):
            content = (root / name).read_bytes()
            found.update(f"{name}\0{len(content)}\0".encode() + content)
    return found.hexdigest()[:12]


def commit_of(root: Path, folders: Iterable[str]) -> str:
    """The commit, with a `+` if files of the folders differ from it; "unknown" without git."""
    try:
        name = _git(root, "rev-parse", "--short", "HEAD")
        return name + "+" * bool(_git(root, "status", "--porcelain", "--", *folders))
    except (OSError, subprocess.CalledProcessError):
        return "unknown"


def _git(root: Path, *arguments: str) -> str:
    # With the folder given, git does not take another repository in which an unpacked archive happens to lie.
    command = ["git", "--git-dir", str(root / ".git"), "--work-tree", str(root), *arguments]
    return subprocess.run(command, cwd=root, capture_output=True, text=True, check=True).stdout.strip()


def _where() -> tuple[Path, tuple[str, ...]]:
    folders = [Path(part.__file__ or "").parent for part in PARTS]
    return folders[0].parent, tuple(folder.name for folder in folders)


@functools.cache
def source_digest() -> str:
    """Digest of the source that this process runs, computed at the first call."""
    return digest_of(*_where())


@functools.cache
def source_commit() -> str:
    """Commit of the source that this process runs."""
    return commit_of(*_where())


def identity() -> dict[str, str]:
    """Values that are equal in two processes that compute the same bits: versions by name, and the source digest."""
    return {**versions(), "source": source_digest()}
