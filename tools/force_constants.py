"""Counts the constants of the modules that judge whose force moves the arm: `python -m tools.force_constants`.

A constant is a name in capitals that a module sets to a number of its own. What is worked out from another constant of the
module, or only names a zero, is none. tests/test_force_constants.py holds the count.
"""

import ast
import re
import sys
from pathlib import Path
from typing import NamedTuple

ROOT = Path(__file__).parent.parent
MODULES = (
    "pendant/freedrive/manipulation.py",
    "pendant/guided/endings.py",
    "pendant/sensor/hand_model.py",
    "pendant/guided/bias_follower.py",
    "pendant/guided/sensor_bias.py",
    "pendant/guided/unintended_motion.py",
    "pendant/guided/user_force.py",
    "pendant/limits/residual.py",
    "pendant/signals/contact_free_baseline.py",
    "pendant/signals/joint_push.py",
    "sim/estimation/link_hand.py",
    "sim/estimation/payload_fall.py",
    "sim/estimation/sudden_change.py",
    "sim/flange/external_wrench.py",
    "sim/flange/step_answer.py",
    "sim/flange/wrench_hand.py",
    "sim/flange/wrench_hypotheses.py",
    "sim/flange/wrench_steps.py",
)
"""Where the rules live; one that is no more counts nothing."""

CAPITALS = re.compile(r"[A-Z][A-Z0-9_]*")
SHARED = frozenset({"TICK"})
"""Units: a constant may be worked out with them and is one all the same."""


class Constant(NamedTuple):
    """One number in the code."""

    name: str
    line: int
    sourced: bool  # a docstring or a comment stands with it


def constants(source: str) -> list[Constant]:
    """The constants of a module, in the order of its lines."""
    lines, body = source.splitlines(), ast.parse(source).body
    found: list[Constant] = []
    for place, statement in enumerate(body):
        if not isinstance(statement, ast.Assign):
            continue
        after = body[place + 1] if place + 1 < len(body) else None
        described = isinstance(after, ast.Expr) and isinstance(after.value, ast.Constant) and isinstance(after.value.value, str)
        sourced = described or "#" in lines[statement.lineno - 1]
        target = statement.targets[0]
        pairs = [(target, statement.value)]
        if isinstance(target, ast.Tuple) and isinstance(statement.value, ast.Tuple):
            pairs = list(zip(target.elts, statement.value.elts, strict=True))
        found += [
            Constant(name.id, statement.lineno, sourced)
            for name, value in pairs
            if isinstance(name, ast.Name) and CAPITALS.fullmatch(name.id) and _own(value)
        ]
    return found


def _own(value: ast.expr) -> bool:
    """An expression has a number of its own."""
    names = {node.id for node in ast.walk(value) if isinstance(node, ast.Name)}
    if any(CAPITALS.fullmatch(name) for name in names - SHARED):
        return False
    numbers = [node.value for node in ast.walk(value) if isinstance(node, ast.Constant)]
    return any(isinstance(number, int | float) and not isinstance(number, bool) and number != 0 for number in numbers)


def counts(root: Path = ROOT) -> dict[str, list[Constant]]:
    """The constants of each module that is there."""
    return {name: constants((root / name).read_text(encoding="utf-8")) for name in MODULES if (root / name).is_file()}


def main() -> None:
    """Print them."""
    found = counts()
    lines = [f"{len(some):3d}  {name}: {', '.join(constant.name for constant in some)}" for name, some in found.items()]
    lines.append(f"{sum(map(len, found.values())):3d}  in {sum(bool(some) for some in found.values())} modules")
    sys.stdout.write("\n".join(lines) + "\n")


if __name__ == "__main__":
    main()
