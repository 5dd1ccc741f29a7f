"""The soak's user uses the page as it may, and the soak judges what it has seen."""

import json
import random
import time
from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from app.web.panel.mode_panel import CONFIRM, HOLD, LEAVE
from app.web.server import serve
from benchmarks.common import Options, Report
from benchmarks.soak import first_use
from benchmarks.soak import served as soaked
from benchmarks.soak.__main__ import judge, judge_first_uses
from benchmarks.soak.client import FREE_DRIVE, Client
from benchmarks.soak.first_use import FirstUses
from benchmarks.soak.served import BUILD, Pace, State
from benchmarks.soak.user import User
from pendant.event_table import render
from pendant.events.event import Event, Kind
from pendant.tick.modes import Mode, Phase
from sim.arm.scenario import Scenario
from tests.app.web.fake_loop import ARM, FakeLoop

MODES_OF_THE_BUTTON = (
    (HOLD, Mode.TEACH, Phase.OFF),
    (CONFIRM, Mode.TEACH, Phase.CONFIRM),
    (LEAVE, Mode.FREE_DRIVE, Phase.GUIDED),
)


def test_a_user_uses_the_page_as_it_may_and_comes_back(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("benchmarks.soak.user.PACE", 0.02)
    monkeypatch.setattr("benchmarks.soak.user.STAY", 2.0)
    monkeypatch.setattr("benchmarks.soak.user.ARRIVE", 0.3)
    loop = FakeLoop()
    app = serve(loop, ARM, Scenario())
    user, looker = User(app.url, 1), User(app.url, 2, idle=True)
    user.run(time.monotonic() + 14.0)
    looker.run(time.monotonic() + 1.0)
    app.close()
    assert user.stayed
    assert looker.stayed
    assert user.done["come"] >= 2
    assert user.done["set"] >= 3
    assert set(looker.done) == {"come"}
    assert set(app.guard.refused) <= {"disabled control"}  # what was disabled while it was being pressed
    assert loop.desk.take().touches == ()


def test_whoever_comes_back_knows_the_page() -> None:
    """All that a first use presses, reads and drags is on the page under that name."""
    loop = FakeLoop()
    app = serve(loop, ARM, Scenario())
    client = Client(app.url)
    client.come()
    button = client.called(HOLD)
    client.look(1.0)
    named = {thing.get("label"): thing for thing in client.things.values()}
    used = ("Take", "Release", "Clock", "Run", "Begin", "Reset", "Hand [N]", "True [kg]", "Configured")
    pressed = {client.called(label) for label in used}
    chosen = client.offering(first_use.SCENARIO)
    client.set(client.called("View"), "All settings")
    client.look(0.5)
    kept = {thing.get("label") for thing in client.things.values()}
    said, mode = first_use.page_text(client), first_use.mode(client)
    for label, loop.mode, loop.phase in MODES_OF_THE_BUTTON:
        end = time.monotonic() + 10.0
        while client.things[button]["label"] != label and time.monotonic() < end:
            client.look(0.1)
        assert client.things[button]["label"] == label
        assert client.called(*FREE_DRIVE) == button
    client.go()
    app.close()
    assert client.things[chosen]["label"] == "Chosen"
    assert len(pressed) == len(used)
    assert client.things[first_use.FLANGE]["drag"]
    assert mode == first_use.READY
    assert said.startswith("TEACH Ready")
    assert "The arm can be guided by hand" in said
    assert "Hold-to-run free-drive" in named
    assert "Hold-to-run free-drive" not in kept, "a control that is taken from the page is not used any more"
    ends = [render(Event(kind, 1, {"limit": 3.0}))[0] for kind in (Kind.LEFT_PERIOD, Kind.LEFT_RESTART)]
    assert tuple(ends) == first_use.BY_ITSELF


def test_first_uses_are_due_one_by_one_and_each_refusal_is_told(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    answers, hushed = iter(("", "2 kg too many", "")), []
    uses = FirstUses(10.0)
    start = time.monotonic()
    monkeypatch.setattr(first_use, "tidy", lambda client, mass: hushed.append(uses.hush.is_set()))
    monkeypatch.setattr(first_use, "enter", lambda client: next(answers))
    monkeypatch.setattr(first_use, "guide_and_leave", lambda client: "stopped" if uses.entered == 2 else "")
    quiet: Any = SimpleNamespace(look=lambda seconds: None)
    for number in (1, 2, 3):
        assert not uses.due(start + 10.0 * number - 1.0)
        assert uses.due(start + 10.0 * number + 1.0)
        uses.do(quiet, random.Random(number))
    assert (hushed, uses.hush.is_set()) == ([True] * 3, False)
    assert (uses.begun, uses.entered, uses.ended) == (3, 2, 1)
    report = Report("soak", Options(False, 1000, tmp_path))
    judge_first_uses(report, uses)
    assert [row["what"] for row in report.rows if row["held"] is False] == ["first uses that entered free-drive"]
    assert [note.partition(" kg: ")[2] for note in report.notes] == ["refused: 2 kg too many", "entered, but: stopped"]
    assert not FirstUses().due(start + 1e9)


def test_others_let_go_and_look_on_while_somebody_uses_the_arm(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("benchmarks.soak.user.PACE", 0.02)
    monkeypatch.setattr("benchmarks.soak.user.ARRIVE", 0.3)
    app = serve(FakeLoop(), ARM, Scenario())
    uses = FirstUses()
    uses.hush.set()
    user = User(app.url, 1, first_uses=uses)
    user.run(time.monotonic() + 1.0)
    app.close()
    assert user.stayed
    assert set(user.done) == {"come"}


def states(**changes: Callable[[int], Any]) -> list[dict[str, Any]]:
    """Ten good minutes, a state each second."""
    good: dict[str, Callable[[int], Any]] = {
        "at": lambda second: second,
        "memory": lambda second: 400.0,
        "simulated": float,
        "real": float,
        "dropped": lambda second: 0.0,
        "resets": lambda second: 0,
        "events": lambda second: second,
        "clients": lambda second: 3,
        "failed": lambda second: False,
    }
    return [{name: value(second) for name, value in (good | changes).items()} for second in range(1, 601)]


@pytest.mark.parametrize(
    ("changes", "log", "missed"),
    [
        ({}, "", set()),
        ({"memory": lambda s: 400.0 + s / 15.0}, "", set()),  # 17 MB in the last four and a half minutes
        ({"memory": lambda s: 400.0 + s / 10.0}, "", {"memory grown since"}),
        ({"memory": lambda s: 900.0 if s < 290 else 400.0}, "", set()),  # before it is warm nothing counts
        ({"simulated": lambda s: 0.98 * s}, "", {"pace, simulated over real time"}),
        ({"simulated": lambda s: 1.02 * s}, "", {"pace, simulated over real time"}),
        ({"failed": lambda s: s == 30}, "", {"simulation or page stands"}),
        ({}, "Traceback (most recent call last):\n", {"lines of the log"}),
    ],
)
def test_what_went_wrong_is_a_missed_bar(changes: dict[str, Any], log: str, missed: set[str], tmp_path: Path) -> None:
    report = Report("soak", Options(False, 1000, tmp_path))
    judge(report, states(**changes), log, 300.0)
    assert {row["what"] for row in report.rows if row["held"] is False} == missed
    assert (tmp_path / "soak.log").exists() is bool(log)
    json.dumps(report.rows)


def test_the_pace_leaves_out_pauses_slow_motion_and_what_comes_before_another_scenario(monkeypatch: pytest.MonkeyPatch) -> None:
    now = [0.0]
    monkeypatch.setattr(soaked.time, "monotonic", lambda: now[0])
    loop: Any = SimpleNamespace(paused=False, speed=1.0, simulation=SimpleNamespace(tick_count=0))
    pace, state = Pace(loop), State()

    def pass_time(looks: int, ticks: int) -> None:
        for _ in range(looks):
            now[0] += 0.5
            loop.simulation.tick_count += ticks
            pace.look(state)

    pass_time(1 + BUILD, 250)
    assert state.real == 0.0  # the first look, and what another scenario would take back
    pass_time(20, 245)
    assert state.real == pytest.approx(10.0)
    loop.paused = True
    pass_time(5, 0)
    loop.paused, loop.speed = False, 0.5
    pass_time(5, 125)
    loop.speed = 1.0
    pass_time(1, 0)  # it had been slow at the look before
    assert state.real == pytest.approx(10.0)
    pass_time(3, 0)  # the next scenario is being built
    loop.simulation = SimpleNamespace(tick_count=0)
    pass_time(1, 100)
    assert (state.resets, state.real) == (1, pytest.approx(11.5))
    pass_time(1 + BUILD + 4, 250)
    assert state.real == pytest.approx(11.5 + 2.0)
    assert state.simulated == pytest.approx(10 * 0.5 + 13 * 0.49 + 4 * 0.5)
