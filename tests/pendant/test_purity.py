"""pendant/ is a pure function: what it may import, said file by file."""

import ast
from pathlib import Path

import pendant
from tests.items import each_of

ALLOWED = {
    "collections",
    "copy",
    "dataclasses",
    "enum",
    "hashlib",
    "itertools",
    "math",
    "operator",
    "statistics",
    "types",
    "typing",
}
ALLOWED |= {"msgspec", "numpy", "pendant"}
CALLS = {"open", "print", "input", "exec", "eval", "__import__", "breakpoint"}
FILES = sorted(Path(pendant.__path__[0]).rglob("*.py"))


def test_there_are_files() -> None:
    assert "supervisor.py" in {file.name for file in FILES}


@each_of(FILES, lambda file: file.name)
def test_it_imports_and_calls_only_what_is_pure(file: Path) -> None:
    tree = ast.parse(file.read_text(encoding="utf-8"))
    names: set[str] = set()
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            names |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0
            names.add(node.module or "")
        elif isinstance(node, ast.Call) and isinstance(node.func, ast.Name):
            assert node.func.id not in CALLS
        elif isinstance(node, ast.Attribute):
            assert node.attr != "random"
        assert not isinstance(node, (ast.Global, ast.Nonlocal))
    assert {name.split(".")[0] for name in names} <= ALLOWED
