"""Counts the modules that estimate or decide whose force moves a free arm: `python -m tools.whose_force`.

A line counts once for each 100 characters of it, a blank line once. Code that only moves to another of these modules counts as
before.
"""

import sys
from pathlib import Path

from tools.force_constants import MODULES as JUDGING
from tools.force_constants import ROOT

LONG = 100
"""Characters of a line that counts once."""

MODULES = tuple(
    sorted(
        (
            *JUDGING,
            "pendant/guided/pull.py",
            "pendant/sensor/sensor_errors.py",
            "sim/estimation/momentum_observer.py",
            "sim/estimation/torque_balance.py",
            "sim/estimation/torque_errors.py",
            "sim/estimation/transmission_torque.py",
            "sim/exchange/told_force.py",
            "sim/flange/flange_forces.py",
        )
    )
)
"""Those with rules, with the model of what the rules weigh, and those that tell the result. One that is gone counts nothing."""


def count(source: str) -> int:
    """Lines of a module; one of 101 to 200 characters counts twice."""
    return sum(max(1, -(-len(line) // LONG)) for line in source.splitlines())


def counts(root: Path = ROOT) -> dict[str, int]:
    """Lines of each module that is there."""
    return {name: count((root / name).read_text(encoding="utf-8")) for name in MODULES if (root / name).is_file()}


def main() -> None:
    """Print them."""
    found = counts()
    lines = [f"{lines:5d}  {name}" for name, lines in found.items()]
    sys.stdout.write("\n".join([*lines, f"{sum(found.values()):5d}  in {len(found)} modules"]) + "\n")


if __name__ == "__main__":
    main()
