"""Measured values in place of what rules have made."""

from collections.abc import Mapping

import msgspec

from app.files.checked import convert
from sim.arm.arm_file import Arm


def measured(arm: Arm, values: Mapping[str, object], where: str) -> tuple[Arm, list[str]]:
    """The arm with values of a file of measured ones in place of its own, and the names of these fields.

    Raises:
        BadInput: the file names a field that an arm has not, or a value that none can have.
    """
    raw = msgspec.to_builtins(arm)
    changed = _merged(raw, values, "", where)
    return convert(raw, Arm, where), changed


def _merged(own: dict[str, object], values: Mapping[str, object], path: str, where: str) -> list[str]:
    """Put `values` into `own`; the dotted names of what they replace. Of a group that was assumed the rest still is."""
    changed: list[str] = []
    for key, value in values.items():
        inner = own.get(key)
        if not (isinstance(value, dict) and isinstance(inner, dict)):
            own[key] = value
            changed.append(f"{path}{key}")
            continue
        changed += _merged(inner, value, f"{path}{key}.", where)
        if "status" in inner and "status" not in value:
            before = _fields(inner) if inner["status"] == "assumed" else inner["assumed"]
            inner["assumed"] = [field for field in before if field not in value]
            inner["status"] = "measured"
            inner["source"] = f"{where}; the rest: {inner['source']}"[:2000]
    return changed


def _fields(group: Mapping[str, object]) -> list[str]:
    return [key for key in group if key not in ("status", "source", "assumed")]
