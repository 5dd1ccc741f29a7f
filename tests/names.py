"""The names that users write in their files and read in logs: none may go without a word.

`python -m tests.names` adds those that are new. A name that is gone stays in the list and needs a line in `GONE`.
"""

import json
from pathlib import Path
from typing import Any

from app.session.session_file import KINDS, schema_of
from app.studies.study_file import Study
from pendant.all_settings import describe
from pendant.event_table import TABLE
from pendant.settings.renamed import RENAMED

FILE = Path(__file__).parent / "names.json"

GONE = {
    "session control=confirm": "never accepted: each session that named it was refused",
    "event reduced_exceeded": "is called limit_exceeded, and tells of the limits of NORMAL as well",
    **{f"setting {old}": f"is called {new}, and who uses the old name is told so" for old, new in RENAMED.items()},
}
"""What was a name once, and why it is none now."""


def names() -> list[str]:
    """Every name: of settings, of events and their fields, and of the fields and choices in each kind of file."""
    found = {f"setting {row.name}" for row in describe()}
    found |= {f"event {kind.value}" for kind in TABLE}
    found |= {f"event {kind.value}.{key}" for kind, row in TABLE.items() for key in row.keys}
    for kind, of in {**KINDS, "study": Study}.items():
        for definition in json.loads(schema_of(kind, of))["$defs"].values():
            found |= {f"{kind} {name}" for name in _of(definition)}
    return sorted(found)


def _of(definition: dict[str, Any]) -> set[str]:
    """The fields of one type, after what tells it from others (`do=payload`), and the choices of each field."""
    fields: dict[str, Any] = definition.get("properties", {})
    tag = next((f"{name}={field['enum'][0]}" for name, field in fields.items() if len(field.get("enum", ())) == 1), "")
    found = {tag} if tag else set[str]()
    for name, field in fields.items():
        found.add(f"{tag}.{name}" if tag else name)
        for each in (field, *field.get("anyOf", ())):
            found |= {f"{name}={choice}" for choice in each.get("enum", ())}
    return found


if __name__ == "__main__":
    every = sorted({*json.loads(FILE.read_text(encoding="utf-8")), *names()})
    FILE.write_text(json.dumps(every, indent=0, ensure_ascii=False) + "\n", encoding="utf-8")
