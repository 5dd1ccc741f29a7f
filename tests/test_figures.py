"""The page of figures: all bars of all benches, whichever seed bases there are."""

import json
from pathlib import Path
from typing import Any

import pytest

from benchmarks.common import Options, Report
from docs import figures


def bench(folder: Path, name: str, seed: int, rows: list[tuple[Any, ...]], full: bool = True) -> None:
    """Let a bench report: what, value, unit, at most."""
    report = Report(name, Options(full, seed, folder))
    for what, value, unit, most in rows:
        report.row(what, value, unit, at_most=most)
    report.notes.append("took 12 s")
    report.finish()


def lines(folder: Path) -> list[str]:
    """The page's table, without its two lines of heading."""
    page = figures.page(figures.results(folder))
    return [line for line in page.splitlines() if line.startswith("| ")][2:]


def test_seed_bases_stand_side_by_side_and_a_missed_bar_is_seen(tmp_path: Path) -> None:
    bench(tmp_path, "hold", 1000, [("drift", 0.123456, "mm", 0.2), ("cases", 12, "", None), ("missed", 0, "", 0)])
    bench(tmp_path, "hold", 2000, [("drift", 0.25, "mm", 0.2), ("missed", 0, "", 0)])
    bench(tmp_path, "contact", 1000, [("delay a|b", 3.0, "ms", 7.0)])
    assert lines(tmp_path) == [
        "| contact | delay a\\|b | <= 7 ms | 3 | – | yes |",
        "| hold | drift | <= 0.2 mm | 0.1235 | **0.25** | **no** |",
        "| hold | missed | <= 0 | 0 | 0 | yes |",
    ]
    page = figures.page(figures.results(tmp_path))
    assert "| bench | figure | bar | base 1000 | base 2000 | held |" in page
    assert "2 of 3 bars are held at every seed base measured." in page
    assert "python -m docs.figures" in page
    assert "took" not in page
    assert str(tmp_path) not in page


def test_the_full_size_of_a_bench_wins_over_its_quick_one(tmp_path: Path) -> None:
    bench(tmp_path, "hold", 1000, [("drift", 0.1, "mm", 0.2)], full=False)
    assert lines(tmp_path) == ["| hold (quick) | drift | <= 0.2 mm | 0.1 | yes |"]
    bench(tmp_path, "hold", 1000, [("drift", 0.15, "mm", 0.2)])
    bench(tmp_path, "hold", 2000, [("drift", 0.12, "mm", 0.2)], full=False)
    assert lines(tmp_path) == [
        "| hold | drift | <= 0.2 mm | 0.15 | – | yes |",
        "| hold (quick) | drift | <= 0.2 mm | – | 0.12 | yes |",
    ]


def test_what_could_not_be_measured_holds_no_bar(tmp_path: Path) -> None:
    bench(tmp_path, "hold", 1000, [("drift", "none came to rest", "mm", 0.2), ("worst", float("nan"), "mm", 0.2)])
    assert lines(tmp_path) == [
        "| hold | drift | <= 0.2 mm | **none came to rest** | **no** |",
        "| hold | worst | <= 0.2 mm | **nan** | **no** |",
    ]


def test_results_of_different_settings_are_told_apart(tmp_path: Path) -> None:
    bench(tmp_path, "hold", 1000, [("drift", 0.1, "mm", 0.2)])
    path = next(tmp_path.glob("hold-full-1000-*.json"))
    document = json.loads(path.read_text())
    assert f"Settings `{document['settings']}`." in figures.page(figures.results(tmp_path))
    (tmp_path / "other.json").write_text(json.dumps({**document, "bench": "drop", "settings": "00c0ffee"}))
    assert "`00c0ffee` (drop)" in figures.page(figures.results(tmp_path))


@pytest.mark.parametrize(
    ("content", "why"),
    [
        (None, "no results of benches; run `make bench` first"),
        ("{", "x.json: no JSON"),
        ("[]", "x.json: expected bench, size, seed"),
        ('{"bench": "a", "size": "full", "seed": 1, "settings": "s", "rows": [{"what": "w"}]}', "x.json: rows[0]: expected what"),
    ],
)
def test_no_result_is_one_clear_line(tmp_path: Path, capsys: pytest.CaptureFixture[str], content: str | None, why: str) -> None:
    if content is not None:
        (tmp_path / "x.json").write_text(content)
    out = tmp_path / "figures.md"
    assert figures.main(["--results", str(tmp_path), "--out", str(out)]) == 2
    said = capsys.readouterr().err
    assert why in said
    assert said.count("\n") == 1
    assert not out.exists()


def test_the_page_is_written(tmp_path: Path) -> None:
    bench(tmp_path, "hold", 3000, [("drift", 0.1, "mm", 0.2)])
    out = tmp_path / "figures.md"
    assert figures.main(["--results", str(tmp_path), "--out", str(out)]) == 0
    assert out.read_text() == figures.page(figures.results(tmp_path))
