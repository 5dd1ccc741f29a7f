"""Writes docs/modules.md: every module in a line, from the first line that it says of itself. Run as `python -m docs.modules`."""

import ast
from pathlib import Path

ROOT = Path(__file__).parent.parent
PAGE = ROOT / "docs" / "modules.md"
ROOMS = {
    "pendant": "Modes, free-drive, walls, contacts, programs, limits and events. Pure: time comes as ticks.",
    "sim": "The arm and its physics, sensors, estimates, control, one tick, the paced loop.",
    "app": "Files, command line, sessions.",
    "app/web": "The page.",
    "app/log": "Recordings.",
    "app/report": "Reports.",
    "benchmarks": "What `make bench` measures.",
    "benchmarks/contacts": "Cells, baselines and scores of `benchmarks/contact.py`.",
    "benchmarks/soak": "The users of `make soak`.",
    "examples": "Scripts to copy from.",
}


def first_line(path: Path) -> str:
    """What a module says of itself first.

    Raises:
        ValueError: it says nothing.
    """
    text = ast.get_docstring(ast.parse(path.read_text(encoding="utf-8")))
    if not text:
        raise ValueError(f"{path.name} has no docstring")
    return " ".join(text.split("\n\n")[0].split())


def page() -> str:
    """The page as it should be."""
    lines = ["# Modules", "", "Written by `python -m docs.modules` from the modules themselves.", ""]
    for room, does in ROOMS.items():
        lines += [f"## {room}/", "", does, ""]
        for path in sorted((ROOT / room).glob("*.py")):
            if path.stem != "__init__":
                lines.append(f"- [{path.stem}](../{room}/{path.name}): {first_line(path)}")
        lines.append("")
    return "\n".join(lines)


if __name__ == "__main__":
    PAGE.write_text(page(), encoding="utf-8")
