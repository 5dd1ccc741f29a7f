"""A dozen claims at one of the twelve seeds, both chosen by the commit's hash: over many commits, all of them at all seeds."""

import hashlib
import subprocess
from functools import cache
from pathlib import Path

import msgspec
import pytest

from app.runs.seed_runs import seeds_in
from app.session.session_file import find
from tests.app.session.test_claims import ROOTS, SESSIONS, ran
from tests.passed import ROOT, left_out_where_passed

SEEDS = range(1, 13)
ROWS = 12
"""Sessions that one commit runs."""

PASSED_AT: dict[str, str] = msgspec.json.decode((Path(__file__).parent / "passed_at.json").read_bytes())
"""Sessions and the seeds at which each has passed, as `pendant run NAME --seeds` takes them; a session that passes at more seeds
gets them here."""


def commit() -> str:
    """Hash of the commit that is checked out; empty without git."""
    asked = subprocess.run(["git", "rev-parse", "HEAD"], cwd=ROOT, capture_output=True, text=True, check=False)
    return asked.stdout.strip()


def chosen(of: str) -> tuple[int, list[str]]:
    """The seed of a commit, and its sessions: of those that have passed at this seed."""
    seed = SEEDS[_drawn(of) % len(SEEDS)]
    return seed, sorted(_pool(seed), key=lambda name: _drawn(f"{of} {name}"))[:ROWS]


@cache
def _pool(seed: int) -> list[str]:
    return [name for name, seeds in PASSED_AT.items() if seed in seeds_in(seeds)]


def _drawn(text: str) -> int:
    return int.from_bytes(hashlib.sha256(text.encode()).digest()[:8])


SEED, NAMES = chosen(commit())


@pytest.mark.parametrize("name", NAMES)
def test_a_claiming_session_holds_at_the_seed_of_the_commit(name: str, tmp_path: Path) -> None:
    with left_out_where_passed(f"{name}.{SEED}", (*ROOTS, __name__), find(name).read_text(), str(SEED)):
        outcome = ran(msgspec.structs.replace(SESSIONS[name], seed=SEED), tmp_path)
        assert outcome.verdicts
        assert [verdict for verdict in outcome.verdicts if not verdict.passed] == [], f"at seed {SEED}"


def test_a_commit_has_one_seed_and_a_dozen_rows() -> None:
    assert chosen("1f") == chosen("1f")
    seed, names = chosen("1f")
    assert seed in SEEDS
    assert len(set(names)) == ROWS


def test_another_hash_has_another_seed_and_all_have_all() -> None:
    drawn = [chosen(f"{number:040x}") for number in range(2000)]
    assert {seed for seed, _ in drawn} == set(SEEDS)
    assert drawn[0][1] != drawn[1][1]
    for seed in SEEDS:
        assert {name for at, names in drawn if at == seed for name in names} == set(_pool(seed))


def test_what_has_passed_are_sessions_that_show_claims() -> None:
    assert set(PASSED_AT) <= set(SESSIONS)
    assert all(set(seeds_in(seeds)) <= set(SEEDS) for seeds in PASSED_AT.values())
    assert all(len(_pool(seed)) >= ROWS for seed in SEEDS)
