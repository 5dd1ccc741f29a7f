"""The paced loop: in step with the clock, slower, paused, reset, late, broken. A clock of its own where it counts ticks."""

import gc
import os
import threading
import time
import weakref
from collections.abc import Callable, Iterator
from types import SimpleNamespace

import numpy as np
import pytest

import sim.run.lateness
import sim.run.loop
from pendant.all_settings import Settings
from pendant.decision import Decision
from pendant.events.event import Event, Kind
from pendant.inputs import Button, Command, Inputs
from pendant.tick.modes import Law, Mode, Phase, Safety
from pendant.walls.definitions import Area
from pendant.walls.shapes import Sphere
from sim.arm.scenario import Scenario
from sim.exchange.desk import Wishes
from sim.run.loop import DEBT, SNAPSHOT_TICKS, Loop
from sim.run.troubles import LONGEST_REASON
from sim.simulation import Simulation
from tests.sim.arms import UR5E
from tests.sim.bench import push

QUIET = Decision(Mode.TEACH, Safety.NORMAL, Phase.OFF, Law.HOLD, None, 0.0, 50.0, (0.0,) * 6, (), ())


@pytest.fixture(autouse=True)
def _ordinary_user(monkeypatch: pytest.MonkeyPatch) -> None:
    """A loop with a clock that never waits would take a whole core as a real-time thread."""

    def refuse(*_: object) -> None:
        raise PermissionError

    monkeypatch.setattr(os, "sched_setscheduler", refuse)


class Ticker:
    """A simulation that only counts, and calls `during` in each tick."""

    def __init__(self, during: Callable[[int], None] = lambda tick: None) -> None:
        self.plant = SimpleNamespace(tick=0)
        self.scenario = Scenario(seed=42)
        self.walls: tuple[Area, ...] = ()
        self.wishes: list[Wishes] = []
        self._during = during

    def tick(self, wishes: Wishes) -> Decision:
        self.plant.tick += 1
        self.wishes.append(wishes)
        self._during(self.plant.tick)
        return QUIET

    @property
    def tick_count(self) -> int:
        return self.plant.tick

    def snapshot(self) -> SimpleNamespace:
        return SimpleNamespace(tick=self.plant.tick)


class Clock:
    """A clock that only moves when somebody sleeps or `pass_by` says so."""

    def __init__(self) -> None:
        self.now = 100.0

    def perf_counter(self) -> float:
        return self.now

    def sleep(self, seconds: float) -> None:
        assert seconds >= 0.0
        self.now += seconds
        time.sleep(0.0)

    def pass_by(self, seconds: float) -> None:
        self.now += seconds


@pytest.fixture
def clock(monkeypatch: pytest.MonkeyPatch) -> Clock:
    clock = Clock()
    monkeypatch.setattr(sim.run.loop, "time", clock)
    return clock


@pytest.fixture
def running() -> Iterator[Callable[..., Loop]]:
    """Starts loops and ends them after the test."""
    loops: list[Loop] = []

    def start(make: Callable[[], object] | Loop = Ticker, **values: object) -> Loop:
        loop = make if isinstance(make, Loop) else Loop(make)
        for name, value in values.items():
            setattr(loop, name, value)
        loops.append(loop)
        loop.start()
        return loop

    yield start
    for loop in loops:
        loop.stop()


def until(condition: Callable[[], bool]) -> None:
    end = time.monotonic() + 20.0
    while not condition():
        assert time.monotonic() < end, "it never came to pass"
        time.sleep(0.001)


def test_it_keeps_the_pace_of_the_real_clock(running: Callable[..., Loop]) -> None:
    loop = running()
    begun, first = time.perf_counter(), loop.simulation.plant.tick
    time.sleep(1.5)
    took, done = time.perf_counter() - begun, loop.simulation.plant.tick - first
    # What a busy machine made it drop is not its fault: it was told.
    assert done * 0.002 + loop.dropped == pytest.approx(took, rel=0.2)
    assert 0.0 < loop.actual_rate < 1.2, "never ahead of the clock; a busy machine may hold it back"
    assert len(loop.lateness) == pytest.approx(done, abs=20)


@pytest.mark.parametrize("speed", [1.0, 0.5, 0.1])
def test_ticks_follow_the_clock_at_every_speed(running: Callable[..., Loop], clock: Clock, speed: float) -> None:
    times: list[float] = []
    loop = running(lambda: Ticker(lambda tick: times.append(clock.now)), speed=speed)
    until(lambda: len(times) > 700)
    assert np.allclose(np.diff(times[1:700]), 0.002 / speed, atol=1e-9)
    assert loop.actual_rate == pytest.approx(speed)
    assert loop.dropped == 0.0
    assert loop.events(0) == []


def test_small_debts_are_caught_up(running: Callable[..., Loop], clock: Clock) -> None:
    times: list[float] = []

    def during(tick: int) -> None:
        times.append(clock.now)
        if tick == 100:
            clock.pass_by(0.8 * DEBT)

    loop = running(lambda: Ticker(during))
    until(lambda: len(times) > 300)
    # After the hiccup the ticks are again where they would have been without it.
    assert times[299] - times[1] == pytest.approx(298 * 0.002)
    assert loop.dropped == 0.0
    assert loop.events(0) == []


def test_a_large_debt_is_dropped_and_told(running: Callable[..., Loop], clock: Clock) -> None:
    times: list[float] = []

    def during(tick: int) -> None:
        times.append(clock.now)
        if tick == 100:
            clock.pass_by(0.25)

    loop = running(lambda: Ticker(during))
    until(lambda: len(times) > 300)
    # The tick was due 2 ms after the last, and came 250 ms after it.
    assert loop.dropped == pytest.approx(0.248)
    assert times[299] - times[1] == pytest.approx(298 * 0.002 + 0.248), "lost time is not chased"
    assert np.diff(times[102:299]) == pytest.approx(0.002)


def test_a_spell_of_stalls_is_told_once_when_it_is_over(
    running: Callable[..., Loop], clock: Clock, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(sim.run.lateness, "CALM", 0.5)
    loop = running(lambda: Ticker(lambda tick: clock.pass_by(0.25 if tick in (100, 200, 300) else 0.0)))
    until(lambda: loop.simulation.plant.tick > 600)
    (event,) = loop.events(0)
    assert event.kind is Kind.OVERRUN
    assert event.tick == pytest.approx(300 + 250, abs=2), "0.5 s of calm after the last"
    assert event.values["often"] == "3 times in 1 s"
    assert loop.dropped == pytest.approx(3 * 0.248), "the measure counts each"


def test_a_machine_that_never_keeps_up_loses_none_of_the_account(running: Callable[..., Loop], clock: Clock) -> None:
    loop = running(lambda: Ticker(lambda tick: clock.pass_by(1.0)))
    until(lambda: loop.simulation.plant.tick > 150)
    loop.stop()
    told = loop.events(0)
    assert len(told) == pytest.approx((clock.now - 100.0) / 60.0, abs=1.0), "once a minute"
    assert sum(float(event.values["lost"]) for event in told) == pytest.approx(loop.dropped, abs=0.01)


def test_a_spell_is_over_in_a_pause_as_well(running: Callable[..., Loop], clock: Clock) -> None:
    loop = running(lambda: Ticker(lambda tick: clock.pass_by(0.25 if tick == 100 else 0.0)))
    until(lambda: loop.simulation.plant.tick > 120)
    assert loop.events(0) == []
    loop.paused = True
    until(lambda: len(loop.events(0)) == 1)


def test_paused_it_stands_and_steps_one_tick_at_a_time(running: Callable[..., Loop]) -> None:
    loop = running()
    until(lambda: loop.simulation.plant.tick > 20)
    loop.paused = True
    until(lambda: loop.actual_rate == 0.0 and loop.latest().tick == loop.simulation.plant.tick)
    time.sleep(0.05)
    stood = loop.simulation.plant.tick
    for k in range(1, 4):
        loop.step_once()
        until(lambda k=k: loop.latest().tick == stood + k)
        time.sleep(0.03)
        assert loop.simulation.plant.tick == stood + k
    loop.paused = False
    until(lambda: loop.simulation.plant.tick > stood + 50)


def test_steps_asked_for_while_running_are_none_later(running: Callable[..., Loop]) -> None:
    loop = running()
    for _ in range(10000):
        loop.step_once()
    loop.paused = True
    stood = loop.simulation.plant.tick
    time.sleep(0.2)
    assert loop.simulation.plant.tick <= stood + 30, "what was left of a debt, no more"


def test_after_a_pause_no_time_is_made_up_for(running: Callable[..., Loop], clock: Clock) -> None:
    times: list[float] = []
    loop = running(lambda: Ticker(lambda tick: times.append(clock.now)))
    until(lambda: len(times) > 50)
    loop.paused = True
    until(lambda: clock.now > times[-1] + 10.0)
    count = len(times)
    loop.paused = False
    until(lambda: len(times) > count + 50)
    assert np.diff(times[count + 1 : count + 50]) == pytest.approx(0.002)
    assert loop.dropped == 0.0


def test_snapshots_come_every_few_ticks(running: Callable[..., Loop], clock: Clock) -> None:
    loop = running()
    seen = set()
    end = time.monotonic() + 10.0
    while len(seen) < 20 and time.monotonic() < end:
        seen.add(loop.latest().tick)
    assert len(seen) >= 20
    assert {tick % SNAPSHOT_TICKS for tick in seen} == {1}


def test_a_reset_starts_anew_and_lets_go_of_everything(running: Callable[..., Loop]) -> None:
    made: list[Simulation] = []

    def make() -> Simulation:
        made.append(Simulation(UR5E, Scenario(seed=5), Settings()))
        return made[-1]

    loop = running(make)
    start = loop.latest().truth_links
    loop.desk.touch("hand", push("flange", (0.0, 40.0, 0.0)))
    loop.desk.command(Command.EMERGENCY_STOP)
    until(lambda: loop.latest().decision.mode is Mode.STOP and bool(loop.latest().touches))
    told = len(loop.events(0))
    assert told >= 1
    loop.paused = True
    time.sleep(0.05)
    loop.desk.hold(Button.FREE_DRIVE)
    loop.desk.command(Command.NORMAL)
    loop.reset()
    until(lambda: loop.latest().tick == 1)
    now = loop.latest()
    assert len(made) == 2
    assert loop.simulation is made[1]
    assert loop.seed == 5
    assert now.decision.mode is Mode.TEACH
    assert now.touches == ()
    # Bit for bit: the same first tick of the same seed.
    assert now.truth_links.tobytes() == start.tobytes()
    assert len(loop.events(0)) == told, "what happened before stays; nothing held or commanded came over"
    assert loop.events(told) == []


def test_a_reset_takes_no_wall_away_and_another_simulation_brings_its_own(running: Callable[..., Loop]) -> None:
    floor = Area(name="floor", shape=Sphere(radius=0.5))
    loop = running(lambda: Simulation(UR5E, Scenario(), Settings()))
    loop.desk.fence((floor,))
    until(lambda: loop.walls == (floor,))
    until(lambda: loop.latest().tick > 20)
    loop.reset()
    until(lambda: loop.latest().tick < 20)
    until(lambda: loop.walls == (floor,))
    loop.begin(lambda: Simulation(UR5E, Scenario(), Settings()))
    until(lambda: loop.walls == ())
    assert [event.kind for event in loop.events(0)].count(Kind.WALLS_CHANGED) == 2


def test_the_simulation_before_a_reset_is_gone_with_it(running: Callable[..., Loop]) -> None:
    loop = running(lambda: Simulation(UR5E, Scenario(), Settings()))
    first = weakref.ref(loop.simulation)
    loop.reset()
    until(lambda: loop.simulation is not first())  # the first one is kept out of every collection
    gc.disable()
    try:
        before = weakref.ref(loop.simulation.plant)
        loop.reset()
        until(lambda: before() is None)
    finally:
        gc.enable()


class Note:
    """A script that asks for a reset in its third tick, and keeps what it saw."""

    def __init__(self) -> None:
        self.seen: list[int] = []

    def wishes(self, tick: int, snapshot: Callable[[], object]) -> Wishes:
        return Wishes(Inputs(commands=(Command.RESET,) if tick == 3 else ()), (), ())

    def see(self, tick: int, decision: Decision) -> None:
        self.seen.append(tick)


def test_another_simulation_begins_with_a_script_and_a_reset_leads_back_to_its_start(clock: Clock) -> None:
    loop = Loop(Ticker)
    notes: list[Note] = []

    def write() -> Note:
        notes.append(Note())
        return notes[-1]

    loop.start()
    until(lambda: loop.simulation.plant.tick > 5)
    first = loop.simulation
    loop.begin(Ticker, write)
    until(lambda: loop.simulation is not first and loop.simulation.plant.tick > 5)
    second = loop.simulation
    loop.desk.command(Command.TEACH)
    loop.reset()
    until(lambda: loop.simulation is not second and loop.simulation.plant.tick > 5)
    loop.stop()
    assert [w.inputs.commands for w in second.wishes[:4]] == [(), (), (Command.RESET,), ()]
    assert len(notes) == 2
    assert notes[1].seen == list(range(1, loop.simulation.plant.tick + 1))


def test_touches_last_and_the_rest_is_taken_once(running: Callable[..., Loop], clock: Clock) -> None:
    loop = Loop(Ticker)
    loop.desk.touch("hand", push("flange", (1.0, 0.0, 0.0)))
    loop.desk.command(Command.RESET)
    loop.start()
    until(lambda: loop.simulation.plant.tick > 30)
    loop.stop()
    wishes = loop.simulation.wishes
    assert [w.inputs.commands for w in wishes[:30]] == [(Command.RESET,), *[()] * 29]
    assert all(len(w.touches) == 1 for w in wishes)


def test_before_the_start_there_is_nothing_to_see() -> None:
    with pytest.raises(RuntimeError, match="not been started"):
        Loop(Ticker).latest()


def breaking(at: int) -> Callable[[], Ticker]:
    def during(tick: int) -> None:
        if tick == at:
            raise FloatingPointError("speed is not finite")

    return lambda: Ticker(during)


def test_an_error_in_a_tick_is_told_and_nothing_more_is_simulated(
    running: Callable[..., Loop], caplog: pytest.LogCaptureFixture
) -> None:
    told: list[Event] = []
    made = Loop(breaking(30))
    made.log.listen(told.append)
    loop = running(made)
    until(lambda: bool(told))
    reason = "FloatingPointError: speed is not finite"
    assert loop.failure == reason
    assert told == loop.events(0) == [Event(Kind.BROKEN_DOWN, 30, {"reason": reason})]
    assert "speed is not finite" in caplog.text, "the log has the cause, with where it happened"
    loop.desk.touch("hand", push("flange", (1.0, 0.0, 0.0)))
    time.sleep(0.05)
    assert loop.simulation.plant.tick == 30
    assert loop.latest().tick == 25, "what was there last is still shown"


def test_after_an_error_one_can_start_over(running: Callable[..., Loop]) -> None:
    made: list[Ticker] = []

    def make() -> Ticker:
        made.append(breaking(30)() if not made else Ticker())
        return made[-1]

    loop = running(make)
    until(lambda: loop.failure != "")
    loop.desk.command(Command.START_PROGRAM)
    loop.reset()
    until(lambda: loop.simulation is not made[0] and loop.simulation.plant.tick > 50)
    assert loop.failure == ""
    assert not any(wishes.inputs.commands for wishes in made[1].wishes), "what was wished meanwhile is forgotten"


def test_what_cannot_begin_leaves_the_way_back_to_what_ran(running: Callable[..., Loop]) -> None:
    def refuse() -> Ticker:
        raise ValueError("mass matrix is not positive")

    loop = running()
    first = loop.simulation
    loop.begin(refuse)
    until(lambda: loop.failure != "")
    assert loop.simulation is first
    loop.reset()
    until(lambda: loop.simulation is not first and loop.simulation.plant.tick > 10)
    assert loop.failure == ""


def test_a_long_reason_is_cut(running: Callable[..., Loop]) -> None:
    def refuse() -> Ticker:
        raise ValueError("x" * 5000)

    loop = running()
    loop.begin(refuse)
    until(lambda: loop.failure != "")
    assert len(loop.failure) == LONGEST_REASON


def test_stop_ends_the_thread(running: Callable[..., Loop]) -> None:
    loop = running()
    loop.stop()
    stood = loop.simulation.plant.tick
    time.sleep(0.05)
    assert loop.simulation.plant.tick == stood
    loop.stop()


def test_it_asks_for_real_time_and_goes_on_where_that_is_refused(
    running: Callable[..., Loop], monkeypatch: pytest.MonkeyPatch
) -> None:
    asked = []

    def refuse(pid: int, policy: int, parameters: os.sched_param) -> None:
        asked.append((pid, policy & ~os.SCHED_RESET_ON_FORK, threading.current_thread().name))
        raise PermissionError

    monkeypatch.setattr(os, "sched_setscheduler", refuse)
    loop = running()
    until(lambda: loop.simulation.plant.tick > 10)
    assert asked == [(0, os.SCHED_RR, "simulation")]


def test_a_watch_is_shown_every_tick() -> None:
    loop = Loop(Ticker)
    seen: list[int] = []
    loop.watch = lambda simulation, decision: seen.append(simulation.plant.tick)
    loop.start()
    until(lambda: len(seen) > 20)
    loop.watch = None
    loop.stop()
    assert seen == list(range(1, len(seen) + 1))
