"""What the site has beside docs/: README, the pages that programs write, the gallery, the Python interface. A hook of MkDocs.

Links between pages are those of the repository; here each is led to its page of the site. A file that is no page, such as a
session, is put beside them as it is.
"""

import re
from pathlib import Path
from posixpath import dirname, join, normpath, relpath
from typing import Any

from mkdocs.exceptions import PluginError
from mkdocs.structure.files import File, Files

import pendant_sim

ROOT = Path(__file__).parents[1]

PAGES = {
    "README.md": "index.md",
    "docs/README.md": "contents.md",
    "CONTRIBUTING.md": "contributing.md",
    "CHANGELOG.md": "changelog.md",
    "SECURITY.md": "security.md",
    "out/gallery/README.md": "gallery/index.md",
}
"""Where pages of the repository, that are not below docs/, stand in the site."""

LINK = re.compile(r"(?P<text>\]\()(?P<target>[^)\s]+)(?P<end>\))")
FENCE = re.compile(r"(```.*?```)", re.DOTALL)
SECTIONS = (
    ("Home", "index.md"),
    ("Gallery", "gallery/index.md"),
    ("Guide", "guide/"),
    ("Explanation", "explanation/"),
    ("How to", "how-to/"),
    ("Reference", "reference/"),
    ("Results", "results/"),
    ("Python", "python.md"),
    ("Contents", "contents.md"),
    ("Architecture", "architecture.md"),
    ("Contributing", "contributing.md"),
    ("Changes", "changelog.md"),
    ("Security", "security.md"),
    ("Written by programs", "written/"),
)


def python_page() -> str:
    """The Python interface: each name of `pendant_sim`, from its docstring."""
    parts = ["# Python\n\nAll of it is imported from `pendant_sim`.\n"]
    for name in pendant_sim.__all__:
        module, its_name = pendant_sim.defined(name)
        parts.append(f"::: {module}.{its_name}\n    options:\n      heading: pendant_sim.{name}\n      toc_label: {name}\n")
    return "\n".join(parts)


def sources() -> dict[str, str]:
    """The pages, by where they stand in the repository: where they stand in the site."""
    found = {str(path.relative_to(ROOT)): str(path.relative_to(ROOT / "docs")) for path in sorted((ROOT / "docs").rglob("*.md"))}
    found.update({str(path.relative_to(ROOT)): f"written/{path.name}" for path in sorted((ROOT / "out/docs").glob("*.md"))})
    return found | PAGES


def led(text: str, page: str, pages: dict[str, str], files: dict[str, str]) -> str:
    """The text of a page with links as the site has them.

    Args:
        text: of the page.
        page: where it stands in the repository.
        pages: as `sources` gives them.
        files: what is linked and is no page, by where it stands in the repository: where it stands in the site. Is added to.
    """
    here = dirname(pages[page])

    def leads(match: re.Match[str]) -> str:
        target, hash_, anchor = match["target"].partition("#")
        if not target or "://" in target or target.startswith("mailto:"):
            return match[0]
        there = normpath(join(dirname(page), target))
        if there not in pages:
            if not (ROOT / there).is_file():
                raise PluginError(f"{page}: no such file: {target}")
            files[there] = there.removeprefix("docs/") if there.startswith("docs/") else f"files/{there.removeprefix('out/')}"
        to = pages.get(there) or files[there]
        return f"{match['text']}{relpath(to, here or '.')}{hash_}{anchor}{match['end']}"

    return "".join(part if k % 2 else LINK.sub(leads, part) for k, part in enumerate(FENCE.split(text)))


def on_files(files: Files, config: Any) -> Files:
    """Have the site's files be what `sources` names, with what they link to."""
    pages, linked = sources(), dict[str, str]()
    missing = [page for page in pages if not (ROOT / page).is_file()]
    if missing:
        raise PluginError(f"run `make site`, which writes these first: {', '.join(missing)}")
    made = Files([each for each in files if not each.src_uri.endswith(".md")])
    for page, place in pages.items():
        text = led((ROOT / page).read_text(encoding="utf-8"), page, pages, linked)
        made.append(File.generated(config, place, content=text))
    made.append(File.generated(config, "python.md", content=python_page()))
    for path, place in linked.items():
        if made.get_file_from_path(place) is None:
            made.append(File.generated(config, place, abs_src_path=str(ROOT / path)))
    config["nav"] = nav([*pages.values(), "python.md"])
    return made


def nav(places: list[str]) -> list[dict[str, Any]]:
    """The menu: a section a folder, of what is there."""
    menu: list[dict[str, Any]] = []
    for title, where in SECTIONS:
        found = [place for place in places if place.startswith(where)]
        if found:
            menu.append({title: found if where.endswith("/") else where})
    return menu
