"""The gallery: each example of examples/gallery is run and its picture kept. Run: python -m tools.gallery [FOLDER]

The folder, out/gallery where none is named, gets the pictures and README.md: a page with titles, pictures, what was said,
and the code.
"""

import ast
import os
import subprocess
import sys
from pathlib import Path
from typing import NamedTuple

ROOT = Path(__file__).parents[1]
EXAMPLES = sorted((ROOT / "examples" / "gallery").glob("[0-9]*.py"))

HEAD = """# Gallery

Each is a file that runs as it stands: `python examples/gallery/FILE`. `python -m tools.gallery` has made this page.
"""


class Shown(NamedTuple):
    """An example that ran."""

    title: str  # the first line of its docstring
    text: str  # the rest of it
    code: str
    said: str
    picture: Path


def show(example: Path, folder: Path) -> Shown:
    """Run an example in a folder.

    Raises:
        RuntimeError: it failed, complained, or left no picture; with what it said.
    """
    folder.mkdir(parents=True, exist_ok=True)
    environment = {**os.environ, "PYTHONPATH": str(ROOT)}
    done = subprocess.run(
        [sys.executable, str(example)], cwd=folder, env=environment, capture_output=True, text=True, check=False
    )
    picture = folder / f"{example.stem}.svg"
    if done.returncode or done.stderr or not picture.is_file():
        raise RuntimeError(f"{example.name}: {done.stderr.strip() or 'no picture'}")
    source = example.read_text()
    title, _, text = (ast.get_docstring(ast.parse(source)) or "").partition("\n")
    return Shown(title, text.strip(), source.split('"""', 2)[2].strip(), done.stdout.strip(), picture)


def page(shown: list[Shown]) -> str:
    """The page of examples that ran."""
    parts = [HEAD]
    for k, each in enumerate(shown, 1):
        parts.append(f"## {k}. {each.title}\n\n{each.text}\n\n![{each.title}]({each.picture.name})\n")
        parts.append(f"```text\n{each.said}\n```\n")
        parts.append(f'??? example "{each.picture.stem}.py"\n\n    ```python\n{_indented(each.code)}\n    ```\n')
    return "\n".join(parts)


def _indented(text: str) -> str:
    return "\n".join(f"    {line}" if line else "" for line in text.splitlines())


def main(folder: Path) -> None:
    """Run all examples and write the page."""
    (folder / "README.md").unlink(missing_ok=True)
    text = page([show(example, folder) for example in EXAMPLES])
    (folder / "README.md").write_text(text)


if __name__ == "__main__":
    main(Path([*sys.argv, "out/gallery"][1]))
