from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from app.files.checked import convert, load
from app.runs.runner import RunOutcome, missed, run, simulate
from app.session.prepare import claiming, prepare
from app.session.session_file import Session, bundled, find
from benchmarks import determinism
from pendant.tick.modes import Mode
from tests import golden
from tests.app.fakes import FakeSimulation

SHORT: dict[str, Any] = {
    "title": "short",
    "duration": 2.2,
    "seed": 3,
    "settings": {"sequence.period": 0.25},
    "timeline": [
        {"at": 0.1, "do": "press", "control": "free_drive"},
        {"after": "mode FREE_DRIVE", "delay": 0.1, "do": "release", "control": "free_drive"},
        {"after": "mode FREE_DRIVE", "delay": 0.3, "do": "push", "for": 0.6, "force": [0, 20, 0]},
    ],
}


def made(**fields: Any) -> Session:
    return convert({**SHORT, **fields}, Session, "s.yaml")


def really(session: Session, out: Path) -> RunOutcome:
    prepared = prepare(session, "s.yaml")
    return run(session, prepared, simulate(prepared), out)


def test_the_modes_and_the_unmet_are_told(tmp_path: Path) -> None:
    session = made(
        timeline=[
            {"at": 0.5, "do": "press", "control": "free_drive"},
            {"after": "mode FREE_DRIVE", "delay": 0.5, "do": "release", "control": "free_drive"},
            {"after": "mode RUN", "do": "tap", "control": "reset"},
        ],
        expectations=[
            {"expect": "state", "mode": "FREE_DRIVE", "at": 0.7},
            {"expect": "displacement", "from": 0.1, "to": 0.2, "max": 0.01},
        ],
    )
    told: list[float] = []
    outcome = run(session, prepare(session, "s.yaml"), FakeSimulation(), tmp_path, progress=told.append)
    assert outcome.modes == [(0.002, Mode.TEACH), (0.5, Mode.FREE_DRIVE), (1.0, Mode.TEACH)]
    assert [verdict.passed for verdict in outcome.verdicts] == [True, False, False]
    assert outcome.verdicts[1].seen == "0.05 m at 0.200 s"
    assert outcome.verdicts[2].expected == "timeline[2] begins"
    assert not outcome.passed
    assert told == pytest.approx([0.1 * i for i in range(1, 23)])


def test_a_run_ends_with_a_verdict_that_is_enough(tmp_path: Path) -> None:
    """What has ended by then is told: also an event that did not come, of which no tick told."""
    session = made(
        duration=2.0,
        expectations=[
            {"expect": "state", "mode": "STOP", "at": 1.9},
            {"expect": "state", "mode": "TEACH", "at": 0.05},
            {"expect": "event", "kind": "left_period", "from": 0.0, "to": 0.25},
            {"expect": "no_event", "kind": "left_period"},
            {"expect": "state", "mode": "RUN", "at": 0.27},
        ],
    )
    ran = run(session, prepare(session, "s.yaml"), FakeSimulation(), tmp_path, enough=missed)
    assert [(told.expected, told.passed) for told in ran.verdicts] == [
        ("mode TEACH at 0.050 s", True),
        ("event left_period from 0.000 s to 0.250 s", False),
        ("mode RUN at 0.270 s", False),
    ]
    assert ran.seconds == pytest.approx(0.3)
    whole = run(session, prepare(session, "s.yaml"), FakeSimulation(), tmp_path, enough=lambda told: False)
    assert whole.seconds == 2.0
    assert len(whole.verdicts) == 5


def test_nobody_looks_no_snapshot_is_made(tmp_path: Path) -> None:
    class Blind(FakeSimulation):
        def snapshot(self) -> Any:
            raise AssertionError("nobody looks")

    session = made(expectations=[{"expect": "state", "mode": "TEACH", "at": 0.05}])
    assert run(session, prepare(session, "s.yaml"), Blind(), tmp_path).passed


def test_real_time_keeps_the_pace_of_the_clock(tmp_path: Path) -> None:
    session = made(duration=0.3, timeline=[])
    prepared = prepare(session, "s.yaml")
    assert run(session, prepared, FakeSimulation(), tmp_path, realtime=True).took >= 0.3
    assert run(session, prepared, FakeSimulation(), tmp_path).took < 0.3


def test_same_session_and_seed_give_the_same_bytes(tmp_path: Path) -> None:
    first, again, other = tmp_path / "first", tmp_path / "again", tmp_path / "other"
    assert really(made(), first).events
    really(made(), again)
    really(made(seed=4), other)
    bytes_of: Callable[[Path], bytes] = lambda folder: (folder / "events.jsonl").read_bytes()
    assert bytes_of(first) == bytes_of(again)
    assert bytes_of(first) != bytes_of(other)


def test_bundled_sessions_give_the_same_bytes_again_also_in_real_time() -> None:
    assert determinism.differing(list(determinism.REALTIME), realtime=True)[0] == []
    wrong, size = determinism.differing(["control-all-terms", "enabling-device"], realtime=False)
    assert wrong == []
    assert size > 1000


@pytest.mark.parametrize("name", sorted(set(bundled("sessions")) - set(claiming())))
def test_a_bundled_session_without_a_switch_meets_its_expectations(name: str, tmp_path: Path) -> None:
    session = load(find(name), Session)
    outcome = really(session, tmp_path)
    assert [verdict for verdict in outcome.verdicts if not verdict.passed] == []
    assert golden.differences(golden.known()[name], golden.deeds(outcome.events)) == []


@pytest.mark.parametrize(
    ("name", "spoil"),
    [
        ("free-drive", {"settings": {"activation.period": 1.5}}),
        ("hold", {"posture": [0.0, -1.2, 1.5, -1.87, -1.57, 0.0], "timeline": []}),
        ("program", {"timeline": [{"at": 0.3, "do": "program", "command": "start"}]}),
    ],
)
def test_a_bundled_session_fails_when_what_it_shows_is_missing(name: str, spoil: dict[str, Any], tmp_path: Path) -> None:
    raw = load(find(name), dict[str, object])
    assert not really(convert({**raw, **spoil}, Session, name), tmp_path).passed
