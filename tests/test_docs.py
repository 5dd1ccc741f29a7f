"""The documentation: what it names is there, and its examples work as they stand."""

import ast
import inspect
import math
import os
import re
import subprocess
import textwrap
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any, NamedTuple

import msgspec
import numpy as np
import pytest
import yaml

from app.files.checked import BadInput, convert
from app.files.library import load_arm
from app.session import actions
from app.session.session_file import Session
from app.web.scene import surfaces
from pendant.contact import contact_rules
from pendant.contact import settings as contact_settings
from pendant.contact.history import History
from pendant.limits import parameters
from pendant.limits import settings as limit_settings
from pendant.tick.source_signal import Signal
from pendant.walls import shapes, solids
from tests.items import each_of
from tests.pendant.contacts import limit
from tests.pendant.estimates import estimate
from tools import missed, modules, reactions, results, traceability
from tools.claims import claims_page

ROOT = Path(__file__).parent.parent
PAGES = sorted([ROOT / "README.md", ROOT / "CONTRIBUTING.md", *(ROOT / "docs").rglob("*.md")])
CHANGES = ROOT / "docs" / "how-to" / "change.md"
RECIPES = sorted(set((ROOT / "docs" / "how-to").glob("*.md")) - {CHANGES})
BLOCK = re.compile(r"```(\w+)\n(.*?)```", re.DOTALL)
NAMED = re.compile(r"(app|sim|pendant|assets|docs|tests|tools|benchmarks|examples)/[\w./-]*")
SPAN = re.compile(r"`([^`\n]+)`")


def named(page: Path) -> list[str]:
    """The files and folders of the repository that a page names; those of the user have no folder."""
    return [each for each in SPAN.findall(BLOCK.sub("", page.read_text())) if NAMED.fullmatch(each)]


def blocks(name: str, kind: str = "python") -> list[str]:
    """The code of a recipe's blocks."""
    found = [(lang, textwrap.dedent(code)) for lang, code in re.findall(r"```(\w+)\n(.*?)```", recipe(name), re.DOTALL)]
    return [code for lang, code in found if lang == kind]


def recipe(name: str) -> str:
    return (ROOT / "docs" / "how-to" / f"{name}.md").read_text()


def within(module: Any, code: str, **more: Any) -> dict[str, Any]:
    """What a block defines, read at the end of the module that it belongs to, where `more` is known."""
    names = {**vars(module), "math": math, **more}
    exec(compile(code, module.__name__, "exec", dont_inherit=True), names)
    return names


@each_of(PAGES, lambda page: page.name)
def test_every_file_and_link_that_a_page_names_is_there(page: Path) -> None:
    assert [name for name in named(page) if not any((top / name).exists() for top in (ROOT, ROOT / "tests"))] == []
    links = re.findall(r"\]\(([^)#:]+)\)", page.read_text())
    assert [link for link in links if not (page.parent / link).exists()] == []


def headings(page: Path) -> set[str]:
    """The anchors of a page, as a forge makes them of its headings."""
    found = re.findall(r"^#+ (.+)$", BLOCK.sub("", page.read_text()), re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-") for heading in found}


def test_every_link_to_a_heading_leads_to_one() -> None:
    links = [(page, *link) for page in PAGES for link in re.findall(r"\]\(([^)#:]*)#([^)]+)\)", page.read_text())]
    assert len(links) > 10
    there = [(page, page.parent / name if name else page, anchor) for page, name, anchor in links]
    assert [(page.name, to.name, anchor) for page, to, anchor in there if anchor not in headings(to)] == []


def test_the_index_has_every_page() -> None:
    index = (ROOT / "docs" / "README.md").read_text()
    pages = [page.relative_to(ROOT / "docs").as_posix() for page in (ROOT / "docs").rglob("*.md")]
    assert [page for page in pages if page != "README.md" and f"]({page})" not in index] == []
    assert "docs/README.md" in (ROOT / "README.md").read_text()


@pytest.mark.parametrize("page", RECIPES, ids=lambda page: page.stem)
def test_a_recipe_is_a_page_that_says_what_to_copy_from(page: Path) -> None:
    text = page.read_text()
    assert len(text.splitlines()) <= 65
    first = re.search(r"\*\*Copy from\*\* `([\w./-]+)`", text)
    assert first is not None
    assert (ROOT / first[1]).is_file()
    assert f"`{first[1]}`" in (ROOT / "docs" / "README.md").read_text()


@pytest.mark.parametrize("page", RECIPES, ids=lambda page: page.stem)
def test_what_a_recipe_names_in_the_code_is_in_its_files(page: Path) -> None:
    text = page.read_text()
    prose = re.sub(r"```.*?```", "", text, flags=re.DOTALL)
    code = "".join((ROOT / name).read_text() for name in named(page) if (ROOT / name).is_file())
    example = "".join(content for _, content in re.findall(r"```(\w+)\n(.*?)```", text, re.DOTALL))
    names = [each.split(".")[-1] for each in SPAN.findall(prose) if re.fullmatch(r"_?[A-Za-z]\w*(\.\w+)?", each)]
    assert len(names) >= 3
    assert [name for name in names if name not in code and name not in example] == []


class Place(NamedTuple):
    """A row of the table of what one may want to change."""

    wish: str
    path: Path
    names: list[str]  # to look for
    words: list[str]  # that stand there, where the names do not say the wish
    test: str


def places() -> list[Place]:
    """The table of what one may want to change."""
    rows = [
        [cell.strip() for cell in line.strip("|").split("|")] for line in CHANGES.read_text().splitlines() if line.startswith("|")
    ]
    found: list[Place] = []
    for wish, room, file, look, test in rows[2:]:
        words = re.findall(r"\bat `([^`]+)`", look)
        names = SPAN.findall(re.sub(r"\bat `[^`]+`", "", look))
        found.append(Place(wish, ROOT / room.strip("`") / file.strip("`"), names, words, test.strip("`")))
    return found


@cache
def defined(path: Path) -> dict[str, str]:
    """What a file defines, and the text of each. Members have dotted names, rules of a style sheet their selectors."""
    text = path.read_text()
    if path.suffix == ".yaml":
        return dict.fromkeys(keys(yaml.safe_load(text)), text)
    if path.suffix == ".css":
        return {selector: rule for rule, selector in re.findall(r"(^(\.[\w-]+)\{[^}]*\})", text, re.MULTILINE)}
    found: dict[str, str] = {}
    lines = text.splitlines()
    body = ast.parse(text).body
    for node, after in zip(body, [*body[1:], None], strict=True):
        told = after.end_lineno if isinstance(after, ast.Expr) else None  # the docstring of a constant
        found |= dict.fromkeys(names_of(node), "\n".join(lines[node.lineno - 1 : told or node.end_lineno]))
        if isinstance(node, ast.ClassDef):
            for member in node.body:
                inner = "\n".join(lines[member.lineno - 1 : member.end_lineno])
                found |= {f"{node.name}.{name}": inner for name in names_of(member)}
    return found


LITTLE = frozenset(
    re.findall(
        r"\w+",
        "what when which where with from that this they them into before after another there been does said says have must more "
        "much many only each other same else whether while long soon begins things thing value values without between the and "
        "how for its are has can may one who why not any out all own arm",
    )
)
"""Words of a wish that say nothing of where it is fulfilled."""


def stems(text: str) -> set[str]:
    """The words of a text, each cut to five letters; a name in camel case or with underscores is several."""
    spaced = re.sub(r"([a-z])([A-Z])", r"\1 \2", text).replace("_", " ").lower()
    return {word[:5] for word in re.findall(r"[a-z]{3,}", spaced) if word not in LITTLE}


def names_of(node: ast.stmt) -> set[str]:
    """The names that a statement gives to something."""
    if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef | ast.ClassDef):
        return {node.name}
    targets = node.targets if isinstance(node, ast.Assign) else [node.target] if isinstance(node, ast.AnnAssign) else []
    return {name.id for target in targets for name in ast.walk(target) if isinstance(name, ast.Name)}


def keys(values: dict[str, Any]) -> list[str]:
    """Dotted names of everything in a file of values."""
    inner = [f"{key}.{name}" for key, value in values.items() if isinstance(value, dict) for name in keys(value)]
    return [*values, *inner]


def test_there_are_many_wishes_and_each_only_once() -> None:
    wishes = [place.wish for place in places() if not place.wish.startswith("→")]
    assert len(wishes) >= 25
    assert len(set(wishes)) == len(wishes)


def test_what_one_may_want_to_change_is_where_the_table_says() -> None:
    wrong = [
        place.wish
        for place in places()
        if not place.names
        or not set(place.names) <= set(defined(place.path))
        or not re.fullmatch(r"(\w+/)*test_\w+\.py", place.test)
        or not (ROOT / "tests" / place.test).is_file()
    ]
    assert wrong == []


def test_the_code_at_each_place_speaks_of_the_wish() -> None:
    """It has a word of the wish, or one that the table says to look for; and all of these are there."""
    silent: list[tuple[str, str]] = []
    for place in places():
        code = defined(place.path)
        wish = stems(re.sub(r"\(\[.*?\]\(.*?\)\)", "", place.wish))
        texts = {name: code[name] for name in place.names}
        silent += [
            (place.wish, name)
            for name, text in texts.items()
            if not wish & stems(text) and not any(word in text for word in place.words)
        ]
        silent += [(place.wish, word) for word in place.words if not any(word in text for text in texts.values())]
    assert silent == []


def test_a_place_that_does_not_speak_of_the_wish_is_found() -> None:
    code = defined(ROOT / "pendant" / "freedrive" / "sequence.py")
    wish = stems("what a refusal says of a wrong payload")
    assert wish & stems(code["Sequence.refusal"])
    assert not wish & stems(code["Sequence.reasons"])


def test_the_glossary_has_each_term_once_in_order_with_a_known_source_and_a_name_in_the_code() -> None:
    lines = [line for line in (ROOT / "docs/reference/glossary.md").read_text().splitlines() if line.startswith("| ")]
    rows = [[cell.strip() for cell in line.strip("|").split("|")] for line in lines]
    known = {source for row in rows if len(row) == 2 for source in row[0].split(", ")}
    terms = [row for row in rows if len(row) == 4][1:]
    assert len(terms) >= 45
    assert [row[0] for row in terms] == sorted({row[0] for row in terms}, key=str.lower)
    code = "".join(path.read_text() for top in ("pendant", "sim", "app") for path in (ROOT / top).rglob("*.py"))
    words = set(re.findall(r"\w+", code))
    for term, _, source, name in terms:
        assert set(source.split(", ")) <= known, term
        names = SPAN.findall(name)
        assert names or "conventions" in name, term
        assert {part for each in names for part in each.split(".")} <= words, term


def test_the_parameter_of_the_example_is_read() -> None:
    reader, row, cell = blocks("monitored-parameter")
    names = within(parameters, reader)
    made: dict[str, Any] = eval("{" + row + "}", names)
    value = estimate()
    value.v_F = np.array([9.0, 9.0, 9.0, 1.0, -2.0, 2.0])
    view = parameters.Observed(value, parameters.EntryValues((0.0,) * 3, (0.0,) * 6, (0.0,) * 6, (0.0,) * 6), None, (), (), 0.0)
    assert made["flange_turn"].read(view, 4.0) == (3.0, "flange", 4.0)
    assert set(made["flange_turn"]._fields) == set(parameters.Parameter._fields)
    section = within(limit_settings, f"class Made(Section, frozen=True):\n    {cell}")["Made"]()
    assert (section.flange_turn.max, section.flange_turn.on) == (4.0, True)


def test_the_shape_of_the_example_is_what_it_says() -> None:
    field, shape, case = blocks("wall-shape")
    made = within(shapes, "")
    made["solids"] = type("Solids", (), {"capsule": staticmethod(within(solids, field)["capsule"])})
    exec(compile(shape, "shapes", "exec", dont_inherit=True), made)
    pill = msgspec.convert({"kind": "capsule", "radius": 0.1, "height": 0.2}, made["Capsule"])
    distance = pill.field()
    assert distance(0.0, 0.0, 0.5) == pytest.approx((0.3, 0.0, 0.0, 1.0))
    assert distance(0.0, -0.3, 0.05) == pytest.approx((0.2, 0.0, -1.0, 0.0))
    rng = np.random.default_rng(3)
    axis = np.array([0.0, 0.0, 1.0]) * np.linspace(-0.1, 0.1, 2001)[:, None]
    for point in [*rng.normal(0.0, 0.15, (50, 3)), np.zeros(3)]:
        far, *slope = distance(*point.tolist())
        assert far == pytest.approx(np.linalg.norm(point - axis, axis=1).min() - 0.1, abs=1e-6)
        assert distance(*(point - far * np.array(slope)).tolist())[0] == pytest.approx(0.0, abs=1e-9)
    picture = f"def picture(shape):\n    match shape:\n{textwrap.indent(case, ' ' * 8)}"
    drawn = within(surfaces, picture, Capsule=made["Capsule"])["picture"](pill)
    assert max(abs(distance(*corner)[0]) for corner in drawn.vertices.tolist()) == pytest.approx(0.0, abs=1e-6)


def test_the_rule_of_the_example_sees_a_large_force() -> None:
    name, rule, switches, use = blocks("contact-rule")
    assert name.strip() == 'LEVEL = "level"'
    level: Callable[..., bool] = within(contact_rules, rule)["level"]
    thresholds = type("Limit", (), {"level_force": 40.0, "mass": limit().mass})()
    history = History()
    assert not level(history, thresholds)
    for force, seen in ((39.0, False), (41.0, True)):
        history.push(Signal(force, 0.0, 0.0, 0.0, 0.0, 0.0))
        assert level(history, thresholds) is seen
    made = within(contact_settings, "class Made(Section, frozen=True):\n" + textwrap.indent(switches, "    "))["Made"]()
    assert (made.level, made.level_force) == (False, 40.0)
    for word in ("wanted", "counts", "hard_count", "misses", "seen", "NEW"):
        assert word in use
        assert word in (ROOT / "pendant" / "contact" / "detector.py").read_text()


def test_the_arm_of_the_example_is_one(tmp_path: Path) -> None:
    (changed,) = blocks("arm", "yaml")
    copied = yaml.safe_load((ROOT / "assets/robots/ur5e.yaml").read_text())
    path = tmp_path / "my-arm.yaml"
    path.write_text(yaml.safe_dump({**copied, **yaml.safe_load(changed)}))
    arm = load_arm(path)
    assert (arm.name, arm.title, arm.payload) == ("ur5e", "My arm", 6.0)


def test_the_action_of_the_example_shakes() -> None:
    (code,) = blocks("session-action")
    shake = within(actions, code)["Shake"]
    (written,) = yaml.safe_load(blocks("session-action", "yaml")[0])["timeline"]
    action = msgspec.convert(written, shake)
    assert action.push(0.0).force == (0.0, 0.0, 0.0)
    assert action.push(1.0 / 12.0).force == pytest.approx((0.0, 60.0, 0.0))  # a quarter of 3 Hz
    assert inspect.getdoc(shake)
    with pytest.raises(BadInput, match="timeline"):
        convert({"title": "t", "duration": 1.0, "timeline": [written]}, Session, "s.yaml")  # it is not there yet


def test_the_architecture_has_every_room_and_every_module_above_them() -> None:
    text = (ROOT / "docs" / "architecture.md").read_text()
    rooms = {f"{folder}/" for folder in modules.rooms() if folder.split("/")[0] in ("pendant", "sim", "app") and "/" in folder}
    above = {
        path.relative_to(ROOT).as_posix() for top in ("pendant", "sim", "app", "app/web") for path in (ROOT / top).glob("*.py")
    }
    wanted = {name for name in rooms - {"app/web/"} | above if not name.endswith("__init__.py")}
    assert sorted(name for name in wanted if f"`{name}`" not in text) == []


def test_the_text_of_docs_in_git_is_short() -> None:
    """What programs print is built: pages are for people, and summaries have a row a claim or a bar."""
    tracked = subprocess.run(
        ["git", "ls-files", "docs"], cwd=ROOT, capture_output=True, text=True, check=True
    ).stdout.splitlines()
    sizes = {name: (ROOT / name).stat().st_size for name in tracked if (ROOT / name).is_file() and not name.endswith(".webp")}
    assert sum(sizes.values()) <= 400_000
    assert sum(size for name, size in sizes.items() if not name.endswith(".md")) <= 60_000


def test_the_changelog_is_a_line_a_change() -> None:
    lines = (ROOT / "CHANGELOG.md").read_text().splitlines()
    assert sum(len(line.encode()) + 1 for line in lines) <= 8_000
    versions = [line for line in lines if line.startswith("## ")]
    assert [bool(re.fullmatch(r"## \[\d+\.\d+\.\d+(rc\d+)?\]( - .+)?", line)) for line in versions] == [True] * len(versions)
    changes = lines[lines.index(versions[0]) :]
    assert [each for each in changes if each and not re.match(r"## |- (Added|Changed|Fixed|Removed): [A-Z*`].*\.$", each)] == []
    assert len(set(changes) - {""}) == sum(map(bool, changes))


def test_the_links_of_pages_that_are_built_lead_somewhere() -> None:
    """`make docs` writes them into out/docs."""
    found = results.read_summary(results.PAGES / "bars.json")
    claims = claims_page.page(claims_page.expected(), claims_page.read_seen())
    pages = [modules.page(), traceability.page(), reactions.page(), claims, results.page(found), missed.history([], {})]
    links = [link for page in pages for link in re.findall(r"\]\(([^)#:]+)\)", page)]
    assert len(links) > 500
    assert [link for link in links if not Path(os.path.normpath(ROOT / "out" / "docs" / link)).exists()] == []


def test_the_list_of_modules_has_each_module_once() -> None:
    listed = re.findall(r"^- \[\w+\]\(\.\./\.\./(.+?)\)", modules.page(), re.MULTILINE)
    there = [path for top in modules.TOPS for path in (ROOT / top).rglob("*.py") if path.stem != "__init__"]
    assert sorted(listed) == sorted(path.relative_to(ROOT).as_posix() for path in there)


def test_a_module_that_says_nothing_of_itself_is_named(tmp_path: Path) -> None:
    silent = tmp_path / "silent.py"
    silent.write_text("x = 1\n")
    with pytest.raises(ValueError, match=r"^silent\.py has no docstring$"):
        modules.first_line(silent)
