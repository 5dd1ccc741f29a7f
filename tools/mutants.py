"""Sums up a run of mutmut: survivors of each module, and whether they are few enough. Run as `python -m tools.mutants`.

mutmut imports the pendant once and forks for each mutant. What runs only on import, as do the tables of settings and events, has
run by then, mutant or no mutant: its survivors are tried again, each in a process that imports with the mutant set.
"""

import json
import os
import subprocess
import sys
from collections import Counter
from collections.abc import Mapping
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

SHARE = 0.10
"""Of all mutants, this share may survive at most."""

SURVIVED = (0, 5, 33)  # exit codes of the tests: all passed; none was chosen; none was there to fail
NOT_RUN = None
TABLES = ("tests/pendant/test_event_table.py", "tests/pendant/test_all_settings.py")
"""Tests of what the pendant makes on import."""

PROBE = """
import sys
from importlib import import_module
from pathlib import Path

ran = set()
sys.setprofile(lambda frame, *_: ran.add(f"{frame.f_globals.get('__name__')}.{frame.f_code.co_name}"))
for path in sorted(Path("pendant").rglob("*.py")):
    import_module(".".join(path.with_suffix("").parts))
sys.setprofile(None)
print("\\n".join(name for name in ran if name.endswith("__mutmut_orig")))
"""
"""Prints the functions, by mutmut's names of their originals, that run while the pendant is imported."""


def summary(codes: Mapping[str, int | None]) -> tuple[list[str], float]:
    """Lines to print, survivors by name and modules, worst first, and the share of survivors.

    Args:
        codes: exit code of the tests by name of the mutant, None for one that was not tried.

    Raises:
        ValueError: no mutant was tried.
    """
    tried = {name: code for name, code in codes.items() if code is not NOT_RUN}
    if not tried:
        raise ValueError("no mutant was tried: run mutmut first")
    alive = _survivors(tried)
    every, left = Counter(map(_module, tried)), Counter(map(_module, alive))
    lines = [*alive, *(f"{left[name]:5d} of {every[name]:5d}  {name}" for name, _ in left.most_common())]
    return [*lines, f"{len(alive):5d} of {len(tried):5d}  in all: {100 * len(alive) / len(tried):.1f} %"], len(alive) / len(tried)


def _survivors(codes: Mapping[str, int | None]) -> list[str]:
    return [name for name, code in codes.items() if code in SURVIVED]


def _module(mutant: str) -> str:
    return ".".join(mutant.split(".")[:-1])


def second_trial(codes: Mapping[str, int | None], folder: Path) -> dict[str, int]:
    """Exit codes of the tests of tables for the survivors of what runs on import, by name.

    Args:
        codes: as for `summary`.
        folder: the mutated tree, with its tests.
    """
    probe = subprocess.run([sys.executable, "-c", PROBE], cwd=folder, check=True, capture_output=True, text=True)
    on_import = {name.partition("__mutmut_")[0] for name in probe.stdout.split()}
    again = [name for name in _survivors(codes) if name.partition("__mutmut_")[0] in on_import]

    def trial(mutant: str) -> int:
        command = [sys.executable, "-m", "pytest", "-x", "-q", "-p", "no:cacheprovider", *TABLES]
        environment = {**os.environ, "MUTANT_UNDER_TEST": mutant}
        return subprocess.run(command, cwd=folder, env=environment, check=False, capture_output=True).returncode

    with ThreadPoolExecutor(os.cpu_count()) as pool:
        return dict(zip(again, pool.map(trial, again), strict=True))


def main(folder: Path) -> int:
    """Print the summary of the run in `folder`; 1 where too many survived."""
    codes: dict[str, int | None] = {}
    for path in sorted(folder.rglob("*.meta")):
        codes |= json.loads(path.read_text(encoding="utf-8"))["exit_code_by_key"]
    lines, share = summary(codes | second_trial(codes, folder))
    sys.stdout.write("\n".join(lines) + "\n")
    return int(share > SHARE)


if __name__ == "__main__":
    sys.exit(main(Path("mutants")))
