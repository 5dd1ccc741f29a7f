"""The site: every page is there, every link leads somewhere."""

from pathlib import Path

import pytest
from mkdocs.commands.build import build
from mkdocs.config import load_config
from mkdocs.exceptions import PluginError

import pendant_sim
from tools import site

ROOT = Path(__file__).parents[1]


def test_the_site_builds_without_a_warning(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    config = load_config(str(ROOT / "mkdocs.yml"), site_dir=str(tmp_path))
    hook = next(iter(config.hooks.values()))
    monkeypatch.delitem(hook.PAGES, "out/gallery/README.md")  # a minute's work of its own
    build(config)  # strict: raises at the first warning
    names = (tmp_path / "python.html").read_text()
    assert [name for name in pendant_sim.__all__ if f"pendant_sim.{name}" not in names] == []
    assert (tmp_path / "guide" / "free-drive.html").is_file()
    assert "search" in (tmp_path / "index.html").read_text()


def test_a_link_leads_to_the_page_of_the_site() -> None:
    pages = {"README.md": "index.md", "docs/README.md": "contents.md", "docs/guide/walls.md": "guide/walls.md"}
    files: dict[str, str] = {}
    assert site.led("[a](docs/guide/walls.md#b)", "README.md", pages, files) == "[a](guide/walls.md#b)"
    assert site.led("[a](../../README.md)", "docs/guide/walls.md", pages, files) == "[a](../index.md)"
    assert site.led("[a](../../LICENSE)", "docs/guide/walls.md", pages, files) == "[a](../files/LICENSE)"
    assert site.led("[a](https://b.c) [d](#e)", "README.md", pages, files) == "[a](https://b.c) [d](#e)"
    assert site.led("```\n[a](b)\n```", "README.md", pages, files) == "```\n[a](b)\n```"
    assert files == {"LICENSE": "files/LICENSE"}


def test_a_link_to_nothing_is_named() -> None:
    with pytest.raises(PluginError, match=r"README\.md: no such file: docs/nothing\.md"):
        site.led("[a](docs/nothing.md)", "README.md", {"README.md": "index.md"}, {})
