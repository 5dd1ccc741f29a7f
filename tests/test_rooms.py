"""The house: what a room may hold and use, how names and files may be (docs/architecture.md)."""

import ast
import re
from collections import Counter
from pathlib import Path

from tests.items import each_of

ROOT = Path(__file__).parent.parent
TOPS = ("pendant", "sim", "app")
MODULES = {
    ".".join(path.relative_to(ROOT).with_suffix("").parts): ast.parse(path.read_text(encoding="utf-8"))
    for top in TOPS
    for path in sorted((ROOT / top).rglob("*.py"))
    if path.stem != "__init__"
}
ROOMS = sorted({name.rpartition(".")[0] for name in MODULES} - {"pendant", "sim", "app", "app.web"})

SHARED = {"settings", "rows", "entry_rows"}
"""What a room gives to the table of events and to the schema of settings: modules without logic, which use no room."""

GROUND = {"pendant.tick", "pendant.events", "pendant.settings"}
"""What every room of the pendant stands on."""

MODULES_AT_MOST, LINES_AT_MOST = 12, 400


def place(module: str) -> str:
    """The room of a module; itself, where it stands above the rooms or says only what events and settings there are."""
    room, _, name = module.rpartition(".")
    return room if room in ROOMS and name not in SHARED else module


def imported(module: str) -> set[str]:
    """Modules of the product that one imports."""
    found: set[str] = set()
    for node in ast.walk(MODULES[module]):
        if isinstance(node, ast.Import):
            found |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            found |= {f"{node.module}.{alias.name}" for alias in node.names} | {node.module or ""}
    return found & MODULES.keys()


def uses(place_: str) -> set[str]:
    """Rooms and modules above rooms that are used from there."""
    inside = [module for module in MODULES if place(module) == place_]
    return {place(used) for module in inside for used in imported(module)} - {place_}


def named(room: str) -> set[str]:
    """The rooms that a room says that it uses."""
    text = (ROOT / room.replace(".", "/") / "__init__.py").read_text(encoding="utf-8")
    sentence = re.search(r"Uses ([^.]*)\.", text)
    return set() if sentence is None else set(re.findall(r"([a-z_/]+)/", sentence[1]))


@each_of(ROOMS)
def test_a_room_is_small(room: str) -> None:
    inside = [module for module in MODULES if module.rpartition(".")[0] == room]
    assert len(inside) <= MODULES_AT_MOST, sorted(inside)


@each_of(ROOMS)
def test_a_room_uses_what_it_says(room: str) -> None:
    top = room.partition(".")[0]
    found = {used for used in uses(room) if used in ROOMS and used not in GROUND and used.partition(".")[0] == top}
    assert named(room) == {used.removeprefix(f"{top}.").replace(".", "/") for used in found}


def test_no_room_comes_back_to_itself() -> None:
    left = {each: uses(each) for each in {place(module) for module in MODULES}}
    while free := {each for each, used in left.items() if not used & left.keys()}:
        for each in free:
            del left[each]
    assert not left, {each: sorted(used & left.keys()) for each, used in left.items()}


def test_what_all_rooms_share_uses_none_of_them() -> None:
    shared = [module for module in MODULES if module.rpartition(".")[2] in SHARED]
    assert len(shared) > 8
    for module in shared:
        assert {place(used) for used in imported(module)} <= GROUND, module


def test_no_module_has_the_name_of_another() -> None:
    names = Counter(module.rpartition(".")[2] for module in MODULES)
    assert {name for name, count in names.items() if count > 1 and name not in SHARED} == set()


def test_no_class_has_the_name_of_another() -> None:
    names = Counter(node.name for tree in MODULES.values() for node in ast.walk(tree) if isinstance(node, ast.ClassDef))
    assert [name for name, count in names.items() if count > 1] == []


def test_no_module_is_long() -> None:
    for path in [path for top in (*TOPS, "tools", "benchmarks") for path in (ROOT / top).rglob("*.py")]:
        assert len(path.read_text(encoding="utf-8").splitlines()) <= LINES_AT_MOST, path


def test_no_module_takes_what_another_keeps_to_itself() -> None:
    for module, tree in MODULES.items():
        for node in ast.walk(tree):
            if isinstance(node, ast.ImportFrom) and (node.module or "").partition(".")[0] in TOPS:
                assert not [alias.name for alias in node.names if alias.name.startswith("_")], module


def test_no_function_takes_more_than_four_values_by_position() -> None:
    """What comes after the fourth is named where it is given. Compiled kernels still take arrays by position: they name none."""
    crowded: list[str] = []
    for top in ("pendant", "sim", "app", "tools", "benchmarks"):
        for path in sorted((ROOT / top).rglob("*.py")):
            for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
                if not isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef):
                    continue
                names = [each.arg for each in node.args.posonlyargs + node.args.args]
                if len(names) - (names[:1] in (["self"], ["cls"])) > 4:
                    crowded.append(f"{path.relative_to(ROOT)}: {node.name}")
    assert crowded == []
