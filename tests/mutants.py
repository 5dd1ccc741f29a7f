"""Sums up a run of mutmut: survivors of each module, and whether they are few enough. Run as `python -m tests.mutants`."""

import json
import sys
from collections import Counter
from collections.abc import Mapping
from pathlib import Path

SHARE = 0.10
"""Of all mutants, this share may survive at most."""

SURVIVED = (0, 33)  # exit codes of the tests: all passed; none was there to fail
NOT_RUN = None


def summary(codes: Mapping[str, int | None]) -> tuple[list[str], float]:
    """Lines to print, worst module first, and the share of survivors.

    Args:
        codes: exit code of the tests by name of the mutant, None for one that was not tried.

    Raises:
        ValueError: no mutant was tried.
    """
    tried = {name: code for name, code in codes.items() if code is not NOT_RUN}
    if not tried:
        raise ValueError("no mutant was tried: run mutmut first")
    alive = [name for name, code in tried.items() if code in SURVIVED]
    every, left = Counter(map(_module, tried)), Counter(map(_module, alive))
    lines = [f"{left[name]:5d} of {every[name]:5d}  {name}" for name, _ in left.most_common()]
    return [*lines, f"{len(alive):5d} of {len(tried):5d}  in all: {100 * len(alive) / len(tried):.1f} %"], len(alive) / len(tried)


def _module(mutant: str) -> str:
    return ".".join(mutant.split(".")[:-1])


def main(folder: Path) -> int:
    """Print the summary of the run in `folder`; 1 where too many survived."""
    codes: dict[str, int | None] = {}
    for path in sorted(folder.rglob("*.meta")):
        codes |= json.loads(path.read_text(encoding="utf-8"))["exit_code_by_key"]
    lines, share = summary(codes)
    sys.stdout.write("\n".join(lines) + "\n")
    return int(share > SHARE)


if __name__ == "__main__":
    sys.exit(main(Path("mutants")))
