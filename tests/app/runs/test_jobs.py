from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import jsonschema
import msgspec
import pytest

from app.files.checked import BadInput, convert, load
from app.runs.jobs import Job, run_all
from app.runs.junit import junit, write
from app.runs.runner import RunOutcome
from app.runs.seed_runs import NearestToBound, NotMet, gathered, seeds_in
from app.session.expectation_watch import Verdict
from app.session.session_file import KINDS, Session, bundled, find, find_all, schema_of
from tests.app.command_line import pendant

SHORT: dict[str, Any] = {
    "title": "short",
    "duration": 0.1,
    "expectations": [{"expect": "state", "mode": "TEACH", "at": 0.05}],
}


def session(**fields: Any) -> Session:
    return convert({**SHORT, **fields}, Session, "s.yaml")


def files(folder: Path, **sessions: dict[str, Any]) -> None:
    for name, fields in sessions.items():
        (folder / f"{name}.yaml").write_bytes(msgspec.yaml.encode({**SHORT, **fields}))


def test_jobs_run_in_processes_and_keep_their_places(tmp_path: Path) -> None:
    jobs = [Job("s.yaml", session(duration=0.05 * (k + 1)), tmp_path / str(k)) for k in range(3)]
    found = dict(run_all(jobs))
    assert [found[k].seconds for k in range(3)] == pytest.approx([0.05, 0.1, 0.15])
    for k in range(3):
        kept = {path.name for path in (tmp_path / str(k)).iterdir()}
        assert kept == {"events.jsonl", "log.mcap", "summary.json", "report.html"}


def test_a_job_that_cannot_be_used_is_told(tmp_path: Path) -> None:
    jobs = [Job("good.yaml", session(), tmp_path / "a"), Job("bad.yaml", session(robot="ur6"), tmp_path / "b")]
    with pytest.raises(BadInput, match="ur6"):
        dict(run_all(jobs))


def test_a_bad_file_of_a_folder_ends_no_other_one(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    monkeypatch.setenv("COLUMNS", "160")
    files(
        tmp_path, good={}, wrong={"robot": "ur6"}, deep={"world": [{"kind": "plane", "name": "roof", "position": [0, 0, 20.0]}]}
    )
    (tmp_path / "torn.yaml").write_text("{")
    out, report = tmp_path / "out", tmp_path / "report.xml"
    assert pendant(monkeypatch, "run", str(tmp_path), "--out", str(out), "--junit", str(report)) == 2
    said = capsys.readouterr()
    assert "1 sessions passed, 0 not" in said.out
    lines = said.err.splitlines()[-3:]
    assert [line.split(":")[1].strip() for line in lines] == ["torn.yaml", "wrong.yaml", "deep.yaml"], "as it begins: the last"
    assert (out / "good" / "events.jsonl").exists()
    document = ElementTree.parse(report).getroot()
    assert (document.get("errors"), len(document.findall(".//error"))) == ("3", 3)


def test_a_folder_of_bad_files_says_each(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    files(tmp_path, wrong={"robot": "ur6"}, worse={"robot": "ur7"})
    assert pendant(monkeypatch, "run", str(tmp_path)) == 2
    said = capsys.readouterr().err
    assert "ur6" in said
    assert "ur7" in said


def test_a_folder_runs_as_a_whole(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    monkeypatch.setenv("COLUMNS", "160")
    files(tmp_path, good={}, bad={"expectations": [{"expect": "state", "mode": "RUN", "at": 0.05}]})
    out = tmp_path / "out"
    assert pendant(monkeypatch, "run", str(tmp_path), "--out", str(out), "--junit", str(out / "junit.xml")) == 1
    shown = capsys.readouterr().out
    assert "1 sessions passed, 1 not" in shown
    assert "expected mode RUN at 0.050 s" in shown
    assert (out / "good" / "report.html").is_file()
    root = ElementTree.parse(out / "junit.xml").getroot()
    assert (root.get("tests"), root.get("failures")) == ("2", "1")
    assert [suite.get("name") for suite in root] == ["bad", "good"]


def test_two_files_of_one_name_are_refused(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    files(tmp_path, good={})
    path = str(tmp_path / "good.yaml")
    assert pendant(monkeypatch, "run", path, path) == 2
    assert "two files of the same name" in capsys.readouterr().err


def test_what_a_name_means(tmp_path: Path) -> None:
    with pytest.raises(BadInput, match="no session in this folder"):
        find_all(str(tmp_path))
    files(tmp_path, b={}, a={})
    assert [path.name for path in find_all(str(tmp_path))] == ["a.yaml", "b.yaml"]
    assert find_all("hold") == [find("hold")]


def test_junit_has_a_case_for_each_expectation(tmp_path: Path) -> None:
    outcome = RunOutcome(verdicts=[Verdict(True, "a < b", "x"), Verdict(False, "c\x01d", "y & z")], took=0.5)
    root = ElementTree.fromstring(junit({"one": outcome}))
    cases = root.findall("./testsuite/testcase")
    assert [case.get("name") for case in cases] == ["a < b", "c d"]
    failures = [case.find("failure") for case in cases]
    assert failures[0] is None
    assert failures[1] is not None
    assert failures[1].get("message") == "y & z"
    (tmp_path / "file").write_text("")
    with pytest.raises(BadInput):
        write(tmp_path / "file" / "junit.xml", {})


def test_the_schema_accepts_every_bundled_session() -> None:
    schema = jsonschema.Draft202012Validator(msgspec.json.decode(schema_of("session", Session)))
    for name in bundled("sessions"):
        found = [error.message for error in schema.iter_errors(load(find(name), dict[str, object]))]
        assert (name, found) == (name, [])


@pytest.mark.parametrize(
    "spoil", [{"duration": "long"}, {"duration": -1.0}, {"seed": 0.5}, {"colour": "red"}, {"timeline": [{}]}]
)
def test_the_schema_refuses_what_the_reader_refuses(spoil: dict[str, Any]) -> None:
    with pytest.raises(jsonschema.ValidationError):
        jsonschema.validate({**SHORT, **spoil}, msgspec.json.decode(schema_of("session", Session)))
    with pytest.raises(BadInput):
        session(**spoil)


def test_the_command_prints_a_schema(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    for kind in KINDS:
        assert pendant(monkeypatch, "schema", kind) == 0
        jsonschema.Draft202012Validator.check_schema(msgspec.json.decode(capsys.readouterr().out))
    assert pendant(monkeypatch, "schema", "poem") == 2
    assert "one of session, configuration" in capsys.readouterr().err


MOVED: dict[str, Any] = {"expectations": [{"expect": "displacement", "max": 0.01, "to": 0.1}]}


def test_a_session_runs_at_each_seed(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    monkeypatch.setenv("COLUMNS", "200")
    files(tmp_path, good=MOVED, bad={"expectations": [{"expect": "state", "mode": "RUN", "at": 0.05}]})
    out = tmp_path / "out"
    assert pendant(monkeypatch, "run", str(tmp_path), "--seeds", "3,1-2", "--out", str(out), "--junit", str(out / "j.xml")) == 1
    shown = capsys.readouterr().out
    assert "1 of 2 sessions passed at every seed, 3 of 6 runs" in shown
    assert "seeds 3, 1, 2: expected mode RUN at 0.050 s" in shown
    assert "nearest to its bound, by" in shown
    assert (out / "good" / "seed-2" / "events.jsonl").is_file()
    names = [suite.get("name") for suite in ElementTree.parse(out / "j.xml").getroot()]
    assert names == [f"{name} at seed {seed}" for name in ("bad", "good") for seed in (3, 1, 2)]
    assert pendant(monkeypatch, "run", str(tmp_path / "good.yaml"), "--seeds", "7", "--out", str(out)) == 0
    assert (out / "seed-7" / "events.jsonl").is_file()


def test_seeds_that_are_none_are_refused_before_anything_runs(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    files(tmp_path, good={})
    for wrong in ("", "x", "3-1", "1,,2", "-1", "1-2-3", "1,1", "2147483648", "0-1000", "1-900,1000-1900"):
        assert pendant(monkeypatch, "run", str(tmp_path), f"--seeds={wrong}") == 2, wrong
        assert "such as 1-12 or 1,3,7-9" in capsys.readouterr().err
    assert pendant(monkeypatch, "run", str(tmp_path), "--seeds", "1-2", "--seed", "3") == 2
    assert "either --seed or --seeds" in capsys.readouterr().err


def test_seeds_are_numbers_and_ranges() -> None:
    assert seeds_in("1-3") == [1, 2, 3]
    assert seeds_in("9, 1-2,0") == [9, 1, 2, 0]


def test_the_nearest_is_the_one_with_the_least_to_spare_and_what_failed_is_no_nearest() -> None:
    def outcome(*verdicts: Verdict) -> RunOutcome:
        return RunOutcome(verdicts=list(verdicts))

    runs = {
        4: outcome(Verdict(True, "a", "0.9", margin=0.1), Verdict(True, "b", "yes")),
        5: outcome(Verdict(True, "a", "0.97", margin=0.03), Verdict(False, "b", "no", margin=-0.5)),
        6: outcome(Verdict(False, "a", "1.1", margin=-0.1), Verdict(False, "b", "never")),
    }
    (found,) = gathered(("one", seed, outcome) for seed, outcome in runs.items())
    assert (found.runs, found.failed) == (3, [5, 6])
    assert found.missed == [NotMet("a", [6], "1.1"), NotMet("b", [5, 6], "no")]
    assert found.nearest == NearestToBound("a", 5, "0.97", 0.03)
