"""Mutants of claims: they fit the code, each claim has one, and sessions notice them."""

import ast
import shutil
from collections import defaultdict
from contextlib import AbstractContextManager
from pathlib import Path
from typing import Any

import pytest

from app.files.checked import BadInput
from app.runs.runner import RunOutcome
from app.session.claims import CLAIMS
from app.session.expectation_watch import Verdict
from app.session.prepare import claiming
from app.session.session_file import find
from tests.items import each_of
from tests.passed import left_out_where_passed
from tools.claims import claim_mutants, claims_page
from tools.claims.claim_mutants import PRODUCT, Mutant, Verdicts, declared, importers, judged, mutated, run_mutants
from tools.claims.coverage import Outcomes, rows_of, with_trials

MUTANTS = declared()
SESSIONS = claiming()
SUPPORT = Mutant(
    session="control-torque-feedback",
    claims=["C 8"],
    file="sim/control/feedback.py",
    find="SUPPORT * own.error[i]",
    replace="-SUPPORT * own.error[i]",
    what="the sign",
    fails="displacement",
)


ROW: dict[str, Any] = {
    "name": "C 8",
    "session": "one",
    "seeds": [1, 2, 3, 7],
    "failed": [],
    "checks": ["mode TEACH"],
    "held_when_off": [],
    "mutants": [{"what": SUPPORT.what, "file": SUPPORT.file, "not_noticed": [], "seen": "2 m"}],
}
"""Of claims.json."""


@each_of(MUTANTS, lambda mutant: f"{mutant.session}: {mutant.what}")
def test_a_mutant_fits_the_code_and_is_code(mutant: Mutant) -> None:
    ast.parse(mutated(mutant))
    assert mutant.replace != mutant.find
    assert set(mutant.claims) <= set(SESSIONS[mutant.session].claims)


def test_what_a_mutant_breaks_is_among_what_its_session_expects() -> None:
    expected = {name: claims_page.checks(SESSIONS[name], name) for name in {mutant.session for mutant in MUTANTS}}
    unknown = [m for m in MUTANTS if not m.fails or not any(m.fails in line for line in expected[m.session])]
    assert unknown == []


def test_every_claim_has_a_mutant() -> None:
    tried = {claim for mutant in MUTANTS for claim in mutant.claims}
    assert [name for name in CLAIMS if name not in tried] == []
    assert len(MUTANTS) >= 130


def test_no_mutant_serves_two_claims_that_say_different_things() -> None:
    texts: defaultdict[tuple[str, str, str], set[str]] = defaultdict(set)
    for mutant in MUTANTS:
        texts[mutant.file, mutant.find, mutant.replace] |= {CLAIMS[name].text for name in mutant.claims}
    assert {change: said for change, said in texts.items() if len(said) > 1} == {}


def tried(mutant: Mutant) -> AbstractContextManager[None]:
    """A run of a mutant, which is left out where it passed."""
    return left_out_where_passed(f"{mutant.session}.mutant", (__name__,), repr(mutant), find(mutant.session).read_text())


def test_a_mutant_of_what_is_not_compiled_is_noticed() -> None:
    """`make claims` runs all."""
    first = next(mutant for mutant in MUTANTS if mutant.file.startswith("pendant/"))
    with tried(first):
        assert [trial.seen for trial in run_mutants([first], (1, 2)) if not trial.noticed] == []


def test_what_is_called_is_compiled_again() -> None:
    """The kernel that the simulation calls is in another module than the one that changes."""
    assert "def input_side" not in (PRODUCT / "sim/plant/joint_state.py").read_text()
    callee = Mutant(
        session="control-friction-learned",
        claims=["C 5"],
        file="sim/plant/joint_friction.py",
        find="out[i] = (curve * heat",
        replace="out[i] = 4.0 * (curve * heat",
        what="four times the true friction",
        fails="friction error",
    )
    with tried(callee):
        assert run_mutants([callee], (1, 2))[0].noticed


def test_what_imports_a_module_is_found() -> None:
    found = importers(PRODUCT, "sim/estimation/adaptive_friction.py")
    assert {"sim/estimation/adaptive_friction.py", "sim/control/feed_forward.py", "sim/simulation.py"} <= found
    assert not any(path.startswith("pendant/") for path in found)


def test_a_mutant_that_does_not_fit_is_refused(tmp_path: Path) -> None:
    (tmp_path / "sim/control").mkdir(parents=True)
    shutil.copy(PRODUCT / SUPPORT.file, tmp_path / SUPPORT.file)
    assert mutated(SUPPORT, tmp_path).count("-SUPPORT") == 1
    (tmp_path / SUPPORT.file).write_text("SUPPORT * own.error[i]\n" * 2)
    with pytest.raises(BadInput, match="not 2 times"):
        mutated(SUPPORT, tmp_path)
    (tmp_path / SUPPORT.file).unlink()
    with pytest.raises(BadInput, match="no such file"):
        run_mutants([SUPPORT], (1,), product=tmp_path)


def test_a_mutant_is_noticed_for_the_reason_that_it_names() -> None:
    other = (False, "mode TEACH", "at 1 s", True)
    named = (False, "largest displacement of flange at most 1 m", "2 m", True)
    at_one: list[tuple[Verdicts | str, bool, str]] = [
        ([other, named], True, "largest displacement of flange at most 1 m: 2 m"),
        ([other], False, "fails, but for another reason: mode TEACH: at 1 s"),
        ([(False, "displacement", "never came", False)], False, "fails, but for another reason: displacement: never came"),
        ([(True, "displacement", "1 m", True)], False, "everything is as expected"),
        ("breaks down", False, "breaks down"),
    ]
    for verdicts, noticed, seen in at_one:
        assert judged(SUPPORT, {5: verdicts}) == (SUPPORT, () if noticed else (5,), seen)
    assert judged(SUPPORT, {1: [named], 2: "breaks down", 9: [other]}) == (SUPPORT, (2, 9), "breaks down")
    assert judged(SUPPORT, {1: [named], 2: [named]}).noticed


def test_one_that_does_not_end_is_ended(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(claim_mutants, "LONGEST", 0.0)
    ended = run_mutants([SUPPORT], (1, 2))[0]
    assert (ended.not_noticed, ended.seen) == ((1, 2), "has not ended after 0 s")


def test_a_row_is_shown_only_where_its_mutants_are_noticed() -> None:
    sessions = {"control-torque-feedback": SESSIONS["control-torque-feedback"]}
    met, unmet = RunOutcome(verdicts=[Verdict(True, "a", "b")]), RunOutcome(verdicts=[Verdict(False, "a", "b")])
    rows = rows_of(sessions, {"control-torque-feedback": Outcomes({1: met}, {1: unmet})})
    noticed = with_trials(rows, [judged(SUPPORT, {1: [(False, "displacement", "2 m", True)]})])
    missed = with_trials(rows, [judged(SUPPORT, {1: "breaks down"})])
    states = [{row.claim.name: row.state for row in told if row.session} for told in (noticed, missed)]
    assert states[0]["C 8"] == "shown"
    assert states[0]["C 17"] == "has no mutant"
    assert states[1]["C 8"] == "holds with a mutant"


def test_the_page_has_a_row_for_each_claim_with_each_of_its_sessions() -> None:
    wanted = claims_page.expected()
    rows = [line for line in claims_page.page(wanted, claims_page.read_seen()).splitlines() if line.startswith("| ")][1:]
    assert [row.split(" | ")[0] for row in rows] == [f"| {name}" for name in CLAIMS]
    assert sum(row.count("`: ") for row in rows) == len(wanted)


def test_what_a_run_showed_is_read_back_as_it_was_written(tmp_path: Path) -> None:
    rows = claims_page.seen_in([ROW, {**ROW, "session": None}, {**ROW, "session": "other", "failed": [2], "held_when_off": [1]}])
    claims_page.write_seen(rows, tmp_path / "claims.csv")
    read = claims_page.read_seen(tmp_path / "claims.csv")
    assert list(read.values()) == rows
    assert [each[1:-1] for each in rows] == [("one", "1-3,7", "", "", 1, 0), ("other", "1,3,7", "2", "1", 1, 0)]
    assert [each.shown for each in rows] == ["yes", "no"]
    unnoticed = claims_page.seen_in([{**ROW, "mutants": [{**ROW["mutants"][0], "not_noticed": [2]}]}])
    assert (unnoticed[0].not_noticed, unnoticed[0].shown) == (1, "no")


@pytest.mark.parametrize(
    "newer",
    [{"checks": ["mode STOP"]}, {"mutants": []}, {"mutants": [SUPPORT, SUPPORT]}],
    ids=["expectations", "a mutant less", "a mutant more"],
)
def test_a_row_is_not_run_where_something_of_it_is_newer(newer: dict[str, Any]) -> None:
    seen = claims_page.seen_in([ROW])[0]
    ran = claims_page.Expected("C 8", "one", "AF-2", ["mode TEACH"], [SUPPORT])
    assert claims_page.shown(ran, seen) == "yes"
    assert claims_page.shown(ran._replace(**newer), seen) == claims_page.NOT_RUN
    assert claims_page.shown(ran, None) == claims_page.NOT_RUN


def test_the_long_page_has_what_is_expected_and_what_was_seen() -> None:
    wanted = [claims_page.Expected("C 8", "one", "AF-2", ["mode TEACH"], [SUPPORT])]
    page = claims_page.details(wanted, {("C 8", "one"): claims_page.seen_in([ROW])[0]}, [ROW])
    told = "the sign (`sim/control/feedback.py`) - not met: displacement"
    assert page.endswith(f"| C 8 | one | AF-2 | mode TEACH | {told}; seen: 2 m | yes |\n")
    assert claims_page.details(wanted, {}, []).endswith(f"| C 8 | one | AF-2 | mode TEACH | {told} | not run |\n")
