"""Writes out/docs/modules.md: every module in a line, the first that it says of itself. Run: `python -m tools.modules`."""

import ast
from pathlib import Path

ROOT = Path(__file__).parent.parent
PAGE = ROOT / "out" / "docs" / "modules.md"
TOPS = ("pendant", "sim", "app", "benchmarks", "examples", "tools")


def rooms() -> list[str]:
    """Every folder of modules, its parent before it."""
    folders = {path.parent for top in TOPS for path in (ROOT / top).rglob("*.py")}
    return sorted(folder.relative_to(ROOT).as_posix() for folder in folders)


def first_line(path: Path) -> str:
    """What a module says of itself first, as Markdown.

    Raises:
        ValueError: it says nothing.
    """
    text = ast.get_docstring(ast.parse(path.read_text(encoding="utf-8")))
    if not text:
        raise ValueError(f"{path.name} has no docstring")
    return " ".join(text.split("\n\n")[0].split()).replace("[", "\\[")


def page() -> str:
    """The page as it should be."""
    lines = ["# Modules", "", "Written by `python -m tools.modules` from the modules themselves.", ""]
    for room in rooms():
        lines += [f"## {room}/", "", first_line(ROOT / room / "__init__.py"), ""]
        for path in sorted((ROOT / room).glob("*.py")):
            if path.stem != "__init__":
                lines.append(f"- [{path.stem}](../../{room}/{path.name}): {first_line(path)}")
        lines.append("")
    return "\n".join(lines)


if __name__ == "__main__":
    PAGE.parent.mkdir(parents=True, exist_ok=True)
    PAGE.write_text(page(), encoding="utf-8")
