"""The pages of results: one code, the worst over all bases, every miss for good."""

import csv
import json
import os
import shutil
import subprocess
from pathlib import Path
from typing import Any

import pytest

from benchmarks.common import Options, Report, bound
from tests.test_benchmarks import BENCHES
from tools import reliability, results

NEW, OLD = "0123456789ab", "ba9876543210"


def bench(folder: Path, name: str, seed: int, *rows: tuple[Any, ...], full: bool = True, digest: str = NEW) -> None:
    """Let a bench report: what, value, unit, at most, cases. Each file is younger than the one before."""
    report = Report(name, Options(full, seed, folder))
    for what, value, unit, most, n in rows:
        report.row(what, value, unit, at_most=most, n=n)
    finish(report, digest)


def shares(folder: Path, seed: int, *rows: tuple[str, int, int, float]) -> None:
    """Let a bench report shares: what, hits, cases, at least."""
    report = Report("intent", Options(True, seed, folder))
    for what, hits, n, least in rows:
        report.share(what, hits, n, at_least=least)
    finish(report, NEW)


def finish(report: Report, digest: str) -> None:
    """Write the report as one of another code, made in commit c0ffee1."""
    report.finish()
    folder = report.options.out
    written = folder / f"{report.name}-{'full' if report.options.full else 'quick'}-{report.options.seed}-{report.digest}.json"
    path = written.with_name(written.name.replace(report.digest, digest))
    path.write_text(json.dumps({**json.loads(written.read_text()), "digest": digest, "commit": "c0ffee1"}))
    written.unlink()
    age = len(list(folder.glob("*.json")))
    os.utime(path, (1e9 + age, 1e9 + age))


def lines(folder: Path, digest: str = NEW) -> list[str]:
    """The rows of all tables of the page."""
    found = [line for line in results.page(results.summary(results.read(folder), digest)).splitlines() if line.startswith("| ")]
    return [line for line in found if not line.startswith("| figure |")]


def make(folder: Path, out: Path, *more: str) -> int:
    return results.main([str(folder), "--out", str(out), "--built", str(out), *more])


def rows_of(path: Path) -> list[dict[str, str]]:
    with path.open(newline="") as file:
        return list(csv.DictReader(file))


def test_the_worst_base_stands_for_all_and_its_cases_are_counted_together(tmp_path: Path) -> None:
    bench(tmp_path, "hold", 2000, ("drift", 0.25, "mm", 0.2, 9), ("cases", 12, "", None, None), ("ended", 0, "", 0, None))
    bench(tmp_path, "hold", 1000, ("drift", 0.123456, "mm", 0.2, 12), ("ended", 0, "", 0, None))
    bench(tmp_path, "contact", 1000, ("delay a|b", 3.0, "ms", 7.0, 54), full=False)
    assert lines(tmp_path) == [
        "| delay a\\|b | ms | 54 | <= 7 | 3 | 1000 |  | yes |",
        "| drift | mm | 21 | <= 0.2 | 0.25 | 2000 |  | **no** |",
        "| ended |  |  | <= 0 | 0 | 1000 |  | yes |",
    ]
    page = results.page(results.summary(results.read(tmp_path), NEW))
    assert f"Code `{NEW}`, commit c0ffee1, settings " in page
    assert f"Of {len(BENCHES) + 2} benches 2 were measured. Of 3 bars: 2 held at every base, 1 missed." in page
    assert "## contact, quick size\n\nSeed bases 1000.\n" in page
    assert "## hold, full size\n\nSeed bases 1000, 2000.\n" in page
    missing = page.rpartition("## Not measured with this code\n\n")[2]
    assert missing.strip(".\n").split(", ") == sorted({*BENCHES, "races", "soak"} - {"hold", "contact"})
    assert str(tmp_path) not in page


def test_a_bar_with_two_ends_is_worst_where_it_is_farthest_out(tmp_path: Path) -> None:
    for seed, pace in ((1, 1.005), (2, 0.985), (3, 1.012)):
        report = Report("realtime", Options(True, seed, tmp_path))
        report.row("pace", pace, at_least=0.99, at_most=1.01)
        finish(report, NEW)
    assert lines(tmp_path) == ["| pace |  |  | >= 0.99 <= 1.01 | 0.985 | 2 |  | **no** |"]


def test_a_share_is_bounded_by_the_cases_of_all_bases(tmp_path: Path) -> None:
    shares(tmp_path, 1, ("entered", 100, 100, 0.9), ("named", 0, 0, 1.0), ("found", 0, 0, 0.5))
    shares(tmp_path, 2, ("entered", 95, 100, 0.9), ("named", 0, 0, 1.0), ("found", 2, 3, 0.5))
    assert lines(tmp_path) == [
        f"| entered |  | 200 | >= 0.9 | 0.95 | 2 | {bound(195, 200, upper=False):.4g} | yes |",
        "| named |  | 0 | >= 1 | no case | 1 |  | no case |",
        f"| found |  | 3 | >= 0.5 | 0.6667 | 2 | {bound(2, 3, upper=False):.4g} | yes |",
    ]
    assert "Of 3 bars: 2 held at every base, 1 without a case." in results.page(results.summary(results.read(tmp_path), NEW))


@pytest.mark.parametrize(("value", "told"), [("none came to rest", "none came to rest"), (float("nan"), "nan")])
def test_what_could_not_be_measured_holds_no_bar(tmp_path: Path, value: float | str, told: str) -> None:
    bench(tmp_path, "hold", 1, ("drift", 9.9, "mm", 0.2, 3))
    bench(tmp_path, "hold", 2, ("drift", value, "mm", 0.2, 3))
    assert lines(tmp_path) == [f"| drift | mm | 6 | <= 0.2 | {told} | 2 |  | **no** |"]


def test_a_page_is_of_one_code_the_newest_or_the_one_asked_for(tmp_path: Path) -> None:
    folder, out = tmp_path / "bench", tmp_path / "out"
    bench(folder, "hold", 1, ("drift", 0.1, "mm", 0.2, 3), digest=OLD)
    bench(folder, "drop", 1, ("rise", 5.0, "mm", 20.0, 3), digest=OLD)
    bench(folder, "hold", 2, ("drift", 0.15, "mm", 0.2, 3))
    assert make(folder, out) == 0
    assert (out / "results.md").read_text() == results.page(results.summary(results.read(folder), NEW))
    assert [(row["bench"], row["seed"], row["digest"]) for row in rows_of(out / "results.csv")] == [("hold", "2", NEW)]
    assert make(folder, out, "--digest", OLD) == 0
    assert [line.split(" | ")[4] for line in lines(folder, OLD)] == ["5", "0.1"]
    assert (out / "results.md").read_text() == results.page(results.summary(results.read(folder), OLD))
    assert [(row["bench"], row["digest"]) for row in rows_of(out / "results.csv")] == [("drop", OLD), ("hold", OLD)]


def test_the_values_of_each_base_are_in_the_table_with_those_without_a_bar(tmp_path: Path) -> None:
    folder, out = tmp_path / "bench", tmp_path / "out"
    bench(folder, "hold", 2, ("drift", 0.123456789, "mm", 0.2, 3), ("stiffness", 900, "N/m", None, None))
    make(folder, out)
    shared = {"bench": "hold", "size": "full", "seed": "2", "commit": "c0ffee1", "digest": NEW, "bound": ""}
    drift = {"figure": "drift", "unit": "mm", "n": "3", "value": "0.123456789", "bar": "<= 0.2", "held": "yes"}
    stiffness = {"figure": "stiffness", "unit": "N/m", "n": "", "value": "900", "bar": "", "held": ""}
    assert rows_of(out / "results.csv") == [{**shared, **drift}, {**shared, **stiffness}]


def test_a_miss_is_kept_when_its_results_are_gone_and_is_written_once(tmp_path: Path) -> None:
    folder, out = tmp_path / "bench", tmp_path / "out"
    bench(folder, "hold", 1, ("drift", 0.3, "mm", 0.2, 3), ("hold, after", "none", "mm", 0.2, 3), digest=OLD)
    shares(folder, 2, ("named", 0, 0, 1.0))
    make(folder, out)
    shutil.rmtree(folder)
    (out / "led_to.yaml").write_text(f'"{OLD} hold 1 drift": a stiffer | arm\n')
    bench(folder, "hold", 1, ("drift", 0.31, "mm", 0.2, 3), digest=OLD)  # the same once more
    bench(folder, "hold", 1, ("drift", 0.4, "mm", 0.2, 3))
    for _ in range(2):
        assert make(folder, out) == 0
        assert [(row["digest"], row["figure"], row["value"], row["bar"]) for row in rows_of(out / "history.csv")] == [
            (OLD, "drift", "0.3", "<= 0.2 mm"),
            (OLD, "hold, after", "none", "<= 0.2 mm"),
            (NEW, "drift", "0.4", "<= 0.2 mm"),
        ]
    page = (out / "history.md").read_text().splitlines()
    assert page[-3:] == [
        f"| `{OLD}` | c0ffee1 | hold | full | 1 | drift | 0.3 | <= 0.2 mm | a stiffer \\| arm |",
        f"| `{OLD}` | c0ffee1 | hold | full | 1 | hold, after | none | <= 0.2 mm | nothing is written down |",
        f"| `{NEW}` | c0ffee1 | hold | full | 1 | drift | 0.4 | <= 0.2 mm | nothing is written down |",
    ]


def test_results_from_before_there_was_a_digest_are_left_out_in_one_line(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    bench(tmp_path, "hold", 1, ("drift", 0.1, "mm", 0.2, 3))
    for name in ("drop", "day"):
        old = {"bench": name, "size": "full", "seed": 1, "settings": "s", "rows": [{"what": "w"}]}
        (tmp_path / f"{name}.json").write_text(json.dumps(old))
    capsys.readouterr()
    assert [document["bench"] for document in results.read(tmp_path)] == ["hold"]
    assert capsys.readouterr().err == "left out, for nobody knows of which code they are: day.json, drop.json\n"


def test_with_no_results_every_bench_is_listed_as_not_measured(tmp_path: Path) -> None:
    assert results.main(["--out", str(tmp_path), "--built", str(tmp_path)]) == 0
    for name in ("README.md", "results.md"):
        page = (tmp_path / name).read_text()
        assert "\nNothing was measured.\n" in page
        assert page.rpartition("\n\n")[2] == ", ".join(sorted([*BENCHES, "races", "soak"])) + ".\n"
        assert "|" not in page


def test_a_folder_without_results_takes_nothing_over(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    folder, out = tmp_path / "bench", tmp_path / "out"
    bench(folder, "hold", 1, ("drift", 0.1, "mm", 0.2, 3))
    assert make(folder, out) == 0
    kept = (out / "bars.json").read_bytes()
    assert make(tmp_path / "none", out) == 2
    assert capsys.readouterr().err.endswith("none: no bench has written a result there\n")
    assert (out / "bars.json").read_bytes() == kept


def test_the_first_page_has_what_a_reader_wants_and_each_missed_bar(tmp_path: Path) -> None:
    figure = "way while nobody holds the arm, largest"
    bench(tmp_path, "guided", 1, (figure, 0.5, "mm", 30.0, 3), ("other", 2.0, "mm", 30.0, 3))
    bench(tmp_path, "guided", 2, (figure, 40.0, "mm", 30.0, 3), ("other", 1.0, "mm", 30.0, 3))
    page = results.brief(results.summary(results.read(tmp_path), NEW))
    assert "| Displacement while nobody holds a freed arm | 40 mm | <= 30 | 6 |  | `guided`, full |" in page
    assert "| Drift in 10 s without a hand | not measured |  |  |  | `free_drive_forces` |" in page
    assert f"| `guided`, full | {figure} | 40 mm | <= 30 | 6 | 2 |" in page
    assert "| `guided`, full | 1, 2 | 1 | 1 | 0 |" in page
    assert "| other |" not in page


def test_the_summary_is_read_as_it_was_written(tmp_path: Path) -> None:
    bench(tmp_path, "hold", 1, ('drift, "α|β"', 0.1, "N·m", 0.2, 3), ("drift", float("nan"), "mm", 0.2, None))
    found = results.summary(results.read(tmp_path), NEW)
    results.write_summary(found, tmp_path / "bars.json")
    assert results.read_summary(tmp_path / "bars.json") == found
    assert sum(line.startswith("[") for line in (tmp_path / "bars.json").read_text().splitlines()) == 2


def test_every_figure_that_a_reader_wants_is_one_of_its_bench() -> None:
    measured = {
        (each.bench, bar.figure) for each in results.read_summary(results.PAGES / "bars.json").benches for bar in each.bars
    }
    there = {bench for bench, _ in measured}
    assert {bench for bench, _ in results.WANTED.values()} <= set(results.benches())
    assert [wanted for wanted in results.WANTED.values() if wanted[0] in there and wanted not in measured] == []


WRITTEN = {"bench": "a", "size": "full", "seed": 1, "settings": "s", "digest": NEW}


@pytest.mark.parametrize(
    ("name", "content", "why"),
    [
        ("bench/x.json", "{", "x.json: no JSON"),
        ("bench/x.json", "[]", "x.json: expected bench, size, seed"),
        ("bench/x.json", json.dumps({**WRITTEN, "rows": []}), "x.json: expected a commit"),
        (
            "bench/x.json",
            json.dumps({**WRITTEN, "commit": "c", "rows": [{"what": "w"}]}),
            "x.json: rows[0]: expected at_least, at",
        ),
        ("out/bars.json", "{", "bars.json: expected digest, of and benches"),
        ("out/bars.json", '{"digest": "a"}', "bars.json: expected digest, of and benches"),
        ("out/history.csv", "", "history.csv: expected the columns digest, commit"),
        ("out/history.csv", "digest,commit,bench,size,seed,figure,value,bar\na,b\n", "history.csv: expected the columns"),
        ("out/led_to.yaml", "- a\n", "led_to.yaml: expected a text for each"),
        ("out/led_to.yaml", "a hold 1 drift: 5\n", "led_to.yaml: expected a text for each"),
        ("out/led_to.yaml", "a hold 1 drift: b\n", "led_to.yaml: not in the history: a hold 1 drift"),
    ],
)
def test_what_is_not_as_it_should_be_is_one_clear_line(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], name: str, content: str, why: str
) -> None:
    for folder in ("bench", "out"):
        (tmp_path / folder).mkdir()
    (tmp_path / name).write_text(content)
    folders = [str(tmp_path / "bench")] if name.startswith("bench") else []
    assert results.main([*folders, "--out", str(tmp_path / "out"), "--built", str(tmp_path / "out")]) == 2
    said = capsys.readouterr().err
    assert why in said
    assert said.count("\n") == 1
    assert not list((tmp_path / "out").glob("*.md"))


def test_the_history_of_the_project_is_as_its_files_say_and_lost_no_row(tmp_path: Path) -> None:
    path = results.PAGES / "history.csv"
    copy = shutil.copy(path, tmp_path)
    known = results.remember([], Path(copy))
    assert results.followed(results.PAGES / "led_to.yaml", known)
    assert len({miss.key() for miss in known}) == len(known)

    def git(*arguments: str) -> str:
        return subprocess.run(["git", *arguments], cwd=results.ROOT, capture_output=True, text=True, check=False).stdout

    now = set(path.read_text().splitlines())
    name = path.relative_to(results.ROOT).as_posix()
    for commit in git("log", "--format=%h", "--", name).split():
        assert set(git("show", f"{commit}:{name}").splitlines()) <= now, f"rows of {commit} are lost"


def test_the_committed_page_is_of_its_summary() -> None:
    found = results.read_summary(results.PAGES / "bars.json")
    assert (results.PAGES / "README.md").read_text() == results.brief(found), "run python -m tools.results"


def test_how_often_what_is_told_is_true_is_a_curve_over_all_bases(tmp_path: Path) -> None:
    rows = ("a fall is told with 90 to 99 %: it is one", "a fall is told with 99 to 100 %: it is one")
    bench(tmp_path, "observer", 1000, (rows[0], 0.5, "", None, 4), (rows[1], 1.0, "", None, 30))
    bench(tmp_path, "observer", 2000, (rows[0], "no case", "", None, 0), (rows[1], 0.9, "", None, 10))
    bench(tmp_path, "observer", 3000, (rows[1], 0.1, "", None, 10), digest=OLD)
    documents = [document for document in results.read(tmp_path) if document["digest"] == NEW]
    assert reliability.points(documents) == {
        "fall": [reliability.Point(0.9, 0.99, 0.5, 4), reliability.Point(0.99, 1.0, pytest.approx(0.975), 40)]
    }
    assert make(tmp_path, tmp_path / "pages", "--digest", NEW) == 0
    assert (tmp_path / "pages" / reliability.NAME).stat().st_size > 1000
    assert f"]({reliability.NAME})" in (tmp_path / "pages" / "README.md").read_text()
    bench(tmp_path / "hold", "hold", 1000, ("drift", 0.1, "mm", 0.2, 9))
    assert make(tmp_path / "hold", tmp_path / "none", "--digest", NEW) == 0
    assert not (tmp_path / "none" / reliability.NAME).exists()
