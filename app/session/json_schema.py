"""JSON schemas of the files that people write, from the types that read them."""

from typing import Any

import msgspec

from app.session.session_file import Session, Setup
from sim.arm.arm_file import Arm
from sim.arm.scenario import ToolModel

KINDS: dict[str, type[Any]] = {"session": Session, "configuration": Setup, "robot": Arm, "tool": ToolModel}


def schema_of(kind: str) -> str:
    """The schema of a kind of file, one of KINDS, as text."""
    found = {"$schema": "https://json-schema.org/draft/2020-12/schema", "title": f"pendant {kind}"}
    return msgspec.json.format(msgspec.json.encode(found | msgspec.json.schema(KINDS[kind])), indent=1).decode() + "\n"
