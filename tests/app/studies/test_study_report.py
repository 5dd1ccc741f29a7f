import re
from pathlib import Path

import msgspec
import pytest

from app.files.checked import load
from app.session.session_file import Session
from app.studies.data_set import write_data_set
from app.studies.one_run import CaseOutcome, Common, Task, run_case
from app.studies.plan import Plan
from app.studies.study_report import Rows, figures, write_study_report
from app.studies.sweep import row_of
from tests.app.studies.study_fakes import plan


@pytest.fixture
def answered(tmp_path: Path) -> tuple[Plan, Path]:
    whole = plan(samples=10)
    outcomes = [
        CaseOutcome(case, (case.number / 100, case.number % 3 == 0), "ok")
        if case.number != 5
        else CaseOutcome(case, (None, None), "error", "why <not>")
        for case in whole.cases()
    ]
    write_data_set(tmp_path / "rows", whole.study, lambda: [row_of(whole.study, each) for each in outcomes])
    return whole, tmp_path


def test_columns_are_numbers_or_words(answered: tuple[Plan, Path]) -> None:
    whole, out = answered
    rows = Rows(out / "rows", whole.study)
    assert rows.count == 80
    assert set(rows.column("sequence")) == {"true", "false"}
    assert rows.column("mass").dtype.kind == "f"
    assert rows.measure("refused")[:4].tolist() == [1.0, 0.0, 0.0, 1.0]
    assert rows.failed.sum() == 1
    assert rows.measure("way")[5] != rows.measure("way")[5]


def test_all_that_is_shown_is_drawn(answered: tuple[Plan, Path]) -> None:
    whole, out = answered
    captions = [caption for caption, _ in figures(whole.study, Rows(out / "rows", whole.study))]
    assert len(captions) == 5
    assert captions[0] == "Way over mass: mean, with its 95 % interval"
    assert captions[-1].startswith("Sensitivity")


def test_the_report_tells_what_ran_and_what_did_not(answered: tuple[Plan, Path]) -> None:
    whole, out = answered
    assert write_study_report(whole, out, out / "rows") == 1
    text = (out / "report.html").read_text()
    assert "80 of 80 runs, 1 of them with an error" in text
    assert "why &lt;not&gt;" in text
    assert text.count("<svg") == 5
    assert whole.case(0).id not in text
    outside = re.findall(r"""(?:src|href)=["'](?!#|data:)[^"']+""", text)
    assert outside == []


def test_a_worst_run_repeats_as_it_was(answered: tuple[Plan, Path]) -> None:
    whole, out = answered
    write_study_report(whole, out, out / "rows")
    path = out / "worst" / "run-000079.yaml"
    assert f"pendant run {path} --out" in (out / "report.html").read_text()
    session, case = load(path, Session), whole.case(79)
    assert (session.payload_true.mass, session.settings["sequence.on"], session.seed) == (
        case.factors[0],
        case.factors[2],
        case.seed,
    )
    task = Task(case, msgspec.json.encode(Common(whole.raw, whole.study.measures)))
    again = Task(case._replace(values=()), msgspec.json.encode(Common(msgspec.to_builtins(session), whole.study.measures)))
    assert run_case(task).measures == run_case(again).measures
