"""Which column of a table is what: by the names of RTDE, or by a map that the user gives."""

import re
from dataclasses import dataclass, field

import numpy as np

from app.files.bad_input import ABSENT, BadInput

JOINT_QUANTITIES = ("q", "qd", "current", "torque", "temperature")
QUANTITIES = ("t", *JOINT_QUANTITIES, "wrench")
WRENCH_AXES = 6

RTDE = {
    "timestamp": "t",
    "actual_q": "q",
    "actual_qd": "qd",
    "actual_current": "current",
    "actual_current_as_torque": "torque",
    "joint_temperatures": "temperature",
}
"""Names of RTDE's outputs (Real-Time Data Exchange guide of Universal Robots), each with what it is here."""

UNITS = {
    "t": {"s": 1.0, "ms": 1e-3, "us": 1e-6, "ns": 1e-9},
    "q": {"rad": 1.0, "deg": np.pi / 180.0},
    "qd": {"rad/s": 1.0, "deg/s": np.pi / 180.0},
    "current": {"A": 1.0, "mA": 1e-3},
    "torque": {"Nm": 1.0, "Nmm": 1e-3},
    "temperature": {"C": 1.0},
    "wrench": {"N": 1.0},
}
"""Units that a map of columns may name, each with its size in the unit used here."""

GRAMMAR = "expected columns in order, such as t,q,qd,current,-12 or t:ms,q:deg,qd:deg/s,torque; -12 skips twelve"


@dataclass(frozen=True, slots=True)
class ColumnMap:
    """Where each quantity stands in a table: numbers of columns, and the factor on them where the user named a unit."""

    places: dict[str, tuple[int, ...]]
    factors: dict[str, float] = field(default_factory=dict)
    left_out: tuple[str, ...] = ()  # names of the header that are not used


def by_map(text: str, n: int) -> ColumnMap:
    """A map of columns as `--columns` gives it, for n joints: NAME or NAME:UNIT stands for all joints, -K for K columns.

    Raises:
        BadInput: it has another word, unit or form, or says a quantity twice.
    """
    places: dict[str, tuple[int, ...]] = {}
    factors: dict[str, float] = {}
    at = 0
    for word in text.split(","):
        skipped = re.fullmatch(r"\s*-(\d{0,4})\s*", word)
        if skipped:
            at += int(skipped[1] or 1)
            continue
        name, colon, unit = (part.strip() for part in word.partition(":"))
        if name not in QUANTITIES or name in places:
            raise BadInput("--columns", "", word, f"{GRAMMAR}; there are {', '.join(QUANTITIES)}, each once")
        if colon and unit not in UNITS[name]:
            raise BadInput("--columns", name, unit, f"expected one of {', '.join(UNITS[name])}")
        width = 1 if name == "t" else WRENCH_AXES if name == "wrench" else n
        places[name], at = tuple(range(at, at + width)), at + width
        if colon:
            factors[name] = UNITS[name][unit]
    return ColumnMap(places, factors)


def by_header(names: list[str], n: int, where: str) -> ColumnMap:
    """A map of columns from a header of RTDE names, a joint's with its number after it: actual_q_0, or actual_q[0].

    Raises:
        BadInput: a quantity lacks a joint, or stands there twice.
    """
    found: dict[str, dict[int, int]] = {}
    used = set[int]()
    for at, name in enumerate(names):
        match = re.fullmatch(r"(\w+?)(?:_(\d+)|\[(\d+)\])?", name.strip().strip("\"'"))
        quantity = RTDE.get(match[1]) if match else None
        if match is None or quantity is None:
            continue
        joint = int(match[2] or match[3] or 0)
        if joint in found.setdefault(quantity, {}):
            raise BadInput(where, name, ABSENT, "stands in the header twice")
        found[quantity][joint] = at
        used.add(at)
    rtde = {ours: theirs for theirs, ours in RTDE.items()}
    for quantity, columns in found.items():
        wanted = 1 if quantity == "t" else n
        if sorted(columns) != list(range(wanted)):
            raise BadInput(
                where, rtde[quantity], ABSENT, f"has {len(columns)} columns; expected {wanted}, numbered 0 to {wanted - 1}"
            )
    left = tuple(name.strip() for at, name in enumerate(names) if at not in used)
    return ColumnMap({quantity: tuple(columns[k] for k in sorted(columns)) for quantity, columns in found.items()}, {}, left)
