"""The periods of free-drive: to the tick (FD-8a, FD-14, FD-15), anew (FD-16), off (FD-24), not told (FD-20); the way back."""

import pytest

from pendant.all_settings import Settings, apply
from pendant.context import Surroundings
from pendant.events.event import Event, Kind, posture_of
from pendant.freedrive.gate import Gate
from pendant.freedrive.periods import Periods, Remaining
from pendant.inputs import NOTHING, Command, Inputs
from pendant.limits.validity import Stillness, WrenchMean
from pendant.signals.sources import BUTTON, NONE
from pendant.tick.estimate import Estimate, JointsFeel, WhoseForce
from pendant.tick.limit_engine import Excess
from pendant.tick.modes import Law, Mode, Phase
from pendant.tick.pose import ORIGIN, Vector
from pendant.tick.state import state_of
from tests.pendant.estimates import estimate
from tests.pendant.freedrive.test_state_machine import HOLD, JOINTS, LET_GO, Bench, remaining
from tests.pendant.telling import whole_transition

ANEW = Inputs(commands=(Command.RESTART_PERIOD,))
STILL, MOVING, PUSHED = estimate(), estimate(qd=0.5), estimate(force=20.0)


class Quick(Bench):
    """Entered with the first tick of the button; periods of 250 ticks unless they are set."""

    def __init__(self, **changes: float | bool) -> None:
        super().__init__(**{"activation__period": 0.0, "free_drive__period": 0.5, "free_drive__restart_period": 0.5, **changes})


class Alone:
    """The periods without what is around them, their flange sensor in use; entered in tick 0."""

    def __init__(self, held: bool, value: Estimate = STILL, **changes: float | bool) -> None:
        self.settings = apply(Settings(), {name.replace("__", "."): change for name, change in changes.items()})
        self.tick, self.gate, self.held = 0, Gate(), held
        self.still, self.shaken = Stillness(), False
        self.gate.sense(held, BUTTON if held else NONE)
        wrench = tuple(value.F_user.tolist())
        self.periods = Periods(self._around(value), self.settings, held=held, wrench=wrench, joints=JOINTS)

    def step(self, value: Estimate = STILL, user: Vector = ORIGIN, pressed: Excess | None = None) -> list[Event]:
        self.tick += 1
        self.gate.sense(self.held, BUTTON if self.held else NONE)
        wrench = tuple(value.F_user.tolist())
        around = self._around(value)
        happened = self.periods.step(around, self.settings, self.gate, user=user, wrench=wrench, pressed=pressed)
        return whole_transition(happened, self.tick)

    def run(self, count: int, value: Estimate = STILL, user: Vector = ORIGIN) -> list[Event]:
        return [event for _ in range(count) for event in self.step(value, user)]

    def _around(self, value: Estimate) -> Surroundings:
        value.tick = self.tick
        return Surroundings(value, Mode.FREE_DRIVE, True, self.still, WrenchMean(), shaken=self.shaken)


def pressed(alone: Alone, ticks: int) -> list[Event]:
    """The button is held for so many ticks, in which nothing happens, and let go. Returns what happens then."""
    alone.held = True
    for _ in range(ticks):
        assert alone.step() == []
        assert (alone.periods.phase, alone.periods.remaining) == (Phase.HELD, None)
    alone.held = False
    return alone.step()


@pytest.mark.parametrize("after", [0, 1, 130, 248])
def test_the_free_drive_period_begins_anew(after: int) -> None:
    bench = Quick().in_period()
    bench.run(after)
    bench.step(ANEW)
    assert bench.last.events == (Event(Kind.PERIOD_ANEW, bench.tick, {"period": 0.5}),)
    assert remaining(bench.last) == {"free-drive": (250, 250)}
    assert bench.run(249).phase is Phase.PERIOD
    assert bench.step().mode is Mode.TEACH


def test_the_restart_period_begins_anew_with_its_own_length() -> None:
    bench = Quick(free_drive__restart_period=1.0).in_period()
    bench.run(10, NOTHING, MOVING)
    bench.run(300)
    bench.step(ANEW)
    assert (bench.last.phase, remaining(bench.last)) == (Phase.RESTART, {"restart": (500, 500)})


def test_a_hand_that_was_there_counts_from_the_new_begin() -> None:
    """FD-13: forces are changes since the period began."""
    bench = Quick().in_period()
    bench.step(ANEW, estimate(force=20.0))
    assert bench.step(NOTHING, estimate(force=20.0)).phase is Phase.PERIOD
    assert bench.step(NOTHING, estimate(force=11.9)).phase is Phase.GUIDED


def test_where_no_period_runs_none_begins() -> None:
    bench = Quick().entered()
    refused = {"command": Command.RESTART_PERIOD, "mode": Mode.FREE_DRIVE, "reason": "no period of free-drive runs"}
    assert bench.step(ANEW).events == (Event(Kind.COMMAND_REFUSED, bench.tick, refused),)
    bench.step(LET_GO)
    assert bench.run(249).phase is Phase.PERIOD  # and it is not kept for later
    assert bench.step().mode is Mode.TEACH
    assert bench.step(ANEW).events[0].kind is Kind.COMMAND_REFUSED


def test_none_begins_anew_where_that_is_switched_off() -> None:
    bench = Quick(free_drive__signal_renews=False).in_period()
    bench.run(248)
    refused = {"command": Command.RESTART_PERIOD, "mode": Mode.FREE_DRIVE, "reason": "periods are not started again here"}
    assert bench.step(ANEW).events == (Event(Kind.COMMAND_REFUSED, bench.tick, refused),)
    assert bench.step().mode is Mode.TEACH


@pytest.mark.parametrize(("longest", "period", "restart"), [(30.0, 5.0, 4.0), (4.5, 4.5, 4.0), (0.5, 0.5, 0.5)])
def test_no_period_is_longer_than_the_longest(longest: float, period: float, restart: float) -> None:
    names = {"free_drive__longest": longest, "free_drive__period": 5.0, "free_drive__restart_period": 4.0}
    bench = Quick(**names).in_period()
    assert remaining(bench.last) == {"free-drive": (period * 500, period * 500)}
    bench.run(10, NOTHING, MOVING)
    bench.run(50)
    assert remaining(bench.last) == {"restart": (restart * 500, restart * 500)}


def test_without_periods_free_drive_lasts() -> None:
    bench = Quick(free_drive__ends_by_period=False).entered()
    bench.events.clear()
    assert bench.step(LET_GO).phase is Phase.GUIDED
    bench.run(10, NOTHING, MOVING)
    assert bench.run(600).phase is Phase.GUIDED
    assert (bench.last.law, bench.last.periods, bench.events) == (Law.FREE, (), [])
    assert bench.step(Inputs(commands=(Command.LEAVE_FREE_DRIVE,))).mode is Mode.TEACH


def test_remainders_are_not_told_where_they_are_switched_off() -> None:
    bench = Quick(free_drive__remainders=False).in_period()
    assert (bench.last.phase, bench.last.periods) == (Phase.PERIOD, ())
    assert bench.run(249).periods == ()
    assert bench.step().mode is Mode.TEACH
    assert bench.last.periods == ()


@pytest.mark.parametrize("told", [True, False])
def test_the_way_back_is_told_where_it_is_switched_on(told: bool) -> None:
    bench = Quick(free_drive__way_back=told).in_period()
    bench.run(250, NOTHING, estimate(q=[0.1, 0.0, 0.0, 0.0, 0.0, 0.0]))
    assert [event.kind for event in bench.events] == [Kind.LEFT_PERIOD, Kind.WAY_BACK][: 1 + told]
    if told:
        assert posture_of(bench.events[-1].values) == (0.0,) * 6  # as it was at activation
        assert posture_of({}) == ()


WAYPOINT = Inputs(commands=(Command.REGISTER_WAYPOINT,))


def test_registering_a_waypoint_counts_as_manipulation() -> None:
    """FD-13."""
    bench = Quick().in_period()
    bench.run(248)
    bench.step(WAYPOINT)
    assert bench.last.events == (Event(Kind.WAYPOINT, bench.tick),)
    assert bench.last.phase is Phase.GUIDED
    assert bench.run(50).phase is Phase.RESTART
    assert remaining(bench.last) == {"restart": (250, 250)}
    assert bench.run(100).phase is Phase.RESTART  # it counts once


def test_registering_a_waypoint_elsewhere_changes_nothing() -> None:
    bench = Quick()
    bench.step(WAYPOINT)
    assert [event.kind for event in bench.events] == [Kind.WAYPOINT]
    assert (bench.last.mode, bench.last.phase) == (Mode.TEACH, Phase.OFF)


def test_the_restart_period_may_begin_with_the_manipulation() -> None:
    """FD-15: and every tick of it begins it anew."""
    bench = Quick(free_drive__restart_begins="manipulation", free_drive__restart_period=1.0).in_period()
    bench.run(200)
    for _ in range(40):
        bench.step(NOTHING, MOVING)
        assert (bench.last.phase, remaining(bench.last)) == (Phase.RESTART, {"restart": (500, 500)})
    assert bench.run(499).phase is Phase.RESTART
    bench.step(WAYPOINT)
    assert remaining(bench.last) == {"restart": (500, 500)}
    bench.run(499)
    assert bench.step().mode is Mode.TEACH
    assert [event.kind for event in bench.events] == [Kind.MANIPULATION, Kind.WAYPOINT, Kind.LEFT_RESTART]


def test_a_steady_push_counts_once_where_the_period_begins_with_it() -> None:
    bench = Quick(free_drive__restart_begins="manipulation", free_drive__restart_period=1.0).in_period()
    pushed = estimate(force=20.0, felt=20.0)
    bench.step(NOTHING, pushed)
    assert bench.last.phase is Phase.RESTART
    bench.run(499, NOTHING, pushed)
    assert bench.step(NOTHING, pushed).mode is Mode.TEACH


@pytest.mark.parametrize("begins", ["standstill", "force_ends"])
@pytest.mark.parametrize(("force", "touches"), [(0.99, False), (1.01, True)])
def test_the_restart_period_begins_when_nobody_touches_a_link(force: float, touches: bool, begins: str) -> None:
    """FD-13, FD-15: so the log has one event of a hand that stays there."""
    bench, touched = Quick(free_drive__restart_begins=begins).in_period(), estimate(touch=force)
    bench.step(WAYPOINT)
    bench.run(200, NOTHING, touched)
    assert bench.last.phase is (Phase.GUIDED if touches else Phase.RESTART)
    assert bench.step().phase is Phase.RESTART
    assert [event.kind for event in bench.events] == [Kind.WAYPOINT, Kind.RESTARTED]


@pytest.mark.parametrize(("ticks", "phase"), [(149, Phase.GUIDED), (150, Phase.RESTART)])
def test_an_arm_that_creeps_as_its_payload_has_fallen_rests(ticks: int, phase: Phase) -> None:
    """Without the flange sensor a fall may be known too late to stop for it, and friction does not quite hold the arm."""
    alone = Alone(False, static__time=0.3)
    led, falls = estimate(qd=0.02), estimate(qd=0.02)
    led.whose, falls.whose = WhoseForce(joints_feel=JointsFeel.HAND), WhoseForce(joints_feel=JointsFeel.FALL)
    alone.periods.register()
    for value, count in ((led, 200), (falls, 149), (led, 1)):
        alone.run(count, value)
    assert alone.periods.phase is Phase.GUIDED
    alone.run(ticks, falls)
    assert alone.periods.phase is phase


@pytest.mark.parametrize(("after_force", "rests"), [(True, True), (False, False)])
def test_the_restart_period_may_begin_when_the_hand_is_off_while_the_arm_still_moves(after_force: bool, rests: bool) -> None:
    names = {f"limits__maintain__{name}__on": False for name in ("joint_speed", "flange_speed")}
    bench = Quick(
        free_drive__restart_begins="force_ends" if after_force else "standstill", unexplained__motion=False, **names
    ).in_period()
    bench.run(200, NOTHING, estimate(force=20.0, felt=20.0, qd=0.3))
    assert bench.last.phase is Phase.GUIDED
    bench.run(150, NOTHING, estimate(qd=0.3))
    assert (bench.last.phase is Phase.RESTART) is rests


def test_the_hand_must_be_off_for_as_long_as_the_arm_must_be_static() -> None:
    bench = Quick(free_drive__restart_begins="force_ends", static__time=0.2, activation__period=0.2).in_period()
    bench.step(NOTHING, estimate(force=20.0))
    assert bench.run(99).phase is Phase.GUIDED
    assert bench.step().phase is Phase.RESTART


def test_the_hand_is_off_from_the_tick_after_its_last_push() -> None:
    """FD-15: a push at the limit is one."""
    alone = Alone(False, free_drive__restart_begins="force_ends", free_drive__longest=1.0, static__time=0.1, let_go__force=3.0)
    assert [event.kind for event in alone.step(PUSHED)] == [Kind.MANIPULATION]
    assert alone.run(70, PUSHED, (1.0, 2.0, 2.0)) == []
    assert alone.run(49, PUSHED, (1.0, 2.0, 1.99)) == []
    assert alone.periods.phase is Phase.GUIDED
    assert alone.step(PUSHED) == [Event(Kind.RESTARTED, alone.tick, {"period": 1.0})]


@pytest.mark.parametrize(("seconds", "count"), [(0.5, 250), (3.0, 1500), (30.0, 15000)])
def test_a_period_of_any_length_lasts_to_its_tick(seconds: float, count: int) -> None:
    """FD-14."""
    alone = Alone(False, free_drive__period=seconds)
    assert alone.periods.remaining == Remaining("free-drive", count, count)
    assert alone.run(count - 1) == []
    assert alone.periods.remaining == Remaining("free-drive", 1, count)
    assert alone.step() == [Event(Kind.LEFT_PERIOD, count, {"limit": seconds})]


def test_the_free_drive_period_lasts_to_its_tick() -> None:
    """FD-14."""
    seconds, count = 0.5, 250
    bench = Quick(free_drive__period=seconds).in_period()
    assert remaining(bench.last) == {"free-drive": (count, count)}
    for left in range(count - 1, 0, -1):
        bench.step()
        assert remaining(bench.last) == {"free-drive": (left, count)}
        assert (bench.last.mode, bench.last.law, bench.last.events) == (Mode.FREE_DRIVE, Law.FREE, ())
    bench.step()
    assert (bench.last.mode, bench.last.phase, bench.last.law) == (Mode.TEACH, Phase.OFF, Law.HOLD)
    assert bench.events == [Event(Kind.LEFT_PERIOD, bench.tick, {"limit": seconds})]
    assert remaining(bench.last) == {"cool-down": (1000, 1000)}


@pytest.mark.parametrize("tick", [1, 2, 249, 250])
def test_manipulation_in_any_tick_of_the_period_keeps_free_drive(tick: int) -> None:
    """FD-13: also in the very last tick."""
    bench = Quick().in_period()
    bench.run(tick - 1)
    bench.step(NOTHING, estimate(force=8.001))
    assert bench.last.phase is Phase.GUIDED
    assert bench.last.periods == ()
    values = {"parameter": "user force", "part": "flange", "value": pytest.approx(8.001, abs=1e-3), "limit": 8.0, "unit": "N"}
    assert bench.last.events == (Event(Kind.MANIPULATION, bench.tick, values),)


def test_a_force_at_its_limit_is_no_manipulation() -> None:
    bench = Quick().in_period()
    assert bench.run(249, NOTHING, estimate(force=8.0)).phase is Phase.PERIOD
    assert bench.step(NOTHING, estimate(force=8.0)).phase is Phase.OFF


@pytest.mark.parametrize("seconds", [0.5, 1.0])
def test_the_restart_period_begins_when_the_arm_is_static_again(seconds: float) -> None:
    """FD-15."""
    count = round(seconds * 500)
    bench = Quick(free_drive__restart_period=seconds).in_period()
    bench.run(100, NOTHING, estimate(qd=0.5))
    assert bench.last.phase is Phase.GUIDED
    assert bench.run(49).phase is Phase.GUIDED
    assert bench.step().phase is Phase.RESTART
    assert bench.events[-1] == Event(Kind.RESTARTED, bench.tick, {"period": seconds})
    assert remaining(bench.last) == {"restart": (count, count)}
    assert bench.run(count - 1).mode is Mode.FREE_DRIVE
    assert remaining(bench.last) == {"restart": (1, count)}
    assert bench.step().mode is Mode.TEACH
    assert bench.events[-1] == Event(Kind.LEFT_RESTART, bench.tick, {"limit": seconds})


def test_a_push_that_moves_nothing_guides_for_the_static_time() -> None:
    bench = Quick().in_period()
    pushed = estimate(force=20.0, felt=20.0)
    assert bench.step(NOTHING, pushed).phase is Phase.GUIDED
    assert bench.run(49, NOTHING, pushed).phase is Phase.GUIDED
    assert bench.step(NOTHING, pushed).phase is Phase.RESTART
    # the steady push is what the new period counts from; letting go is a change
    assert bench.run(200, NOTHING, pushed).phase is Phase.RESTART
    assert bench.step().phase is Phase.GUIDED


@pytest.mark.parametrize(("held", "leaves"), [(1, True), (2, True), (199, True), (200, False), (201, False), (2000, False)])
@pytest.mark.parametrize("start", [Phase.PERIOD, Phase.GUIDED, Phase.RESTART])
def test_a_press_of_any_length_leaves_if_it_is_short(start: Phase, held: int, leaves: bool) -> None:
    """FD-8a, to the tick: 0.4 s are 200 ticks."""
    alone = Alone(False, free_drive__restart_begins="manipulation" if start is Phase.RESTART else "standstill")
    if start is not Phase.PERIOD:
        alone.step(PUSHED)
    assert alone.periods.phase is start
    events = pressed(alone, held)
    if leaves:
        assert events == [Event(Kind.LEFT_PRESS, alone.tick, {"value": pytest.approx(held / 500), "limit": 0.4})]
    else:
        assert (events, alone.periods.remaining) == ([], Remaining("free-drive", 1500, 1500))


@pytest.mark.parametrize(("held", "leaves"), [(1, True), (49, True), (50, False)])
def test_a_short_press_leaves_and_a_longer_one_suspends(held: int, leaves: bool) -> None:
    """FD-8a, to the tick: 0.1 s are 50 ticks."""
    bench = Quick(button__short_press=0.1).in_period()
    for _ in range(held):
        bench.step(HOLD)
        assert (bench.last.phase, bench.last.periods) == (Phase.HELD, ())
    bench.step(LET_GO)
    if leaves:
        assert bench.last.mode is Mode.TEACH
        values = {"value": pytest.approx(held / 500), "limit": 0.1}
        assert bench.last.events == (Event(Kind.LEFT_PRESS, bench.tick, values),)
        assert remaining(bench.last) == {"cool-down": (1000, 1000)}
    else:
        assert bench.last.mode is Mode.FREE_DRIVE
        assert remaining(bench.last) == {"free-drive": (250, 250)}


def test_the_press_that_entered_may_be_short_without_leaving() -> None:
    bench = Quick()
    bench.run(60)
    bench.step(HOLD)
    assert bench.step(LET_GO).phase is Phase.PERIOD
    # the same when free-drive was left by a short press before
    bench.step(HOLD)
    assert bench.step(LET_GO).phase is Phase.OFF
    bench.run(1000)
    assert bench.step(HOLD).phase is Phase.HELD
    assert bench.step(LET_GO).phase is Phase.PERIOD


def test_held_for_long_suspends_everything() -> None:
    alone = Alone(True)
    entered = state_of(alone.periods)
    assert alone.run(2000) == []
    assert (alone.periods.phase, alone.periods.remaining, alone.periods.waits) == (Phase.HELD, None, False)
    assert state_of(alone.periods) == entered
    assert pressed(alone, 0) == []
    assert (alone.periods.phase, alone.periods.waits) == (Phase.PERIOD, True)


@pytest.mark.parametrize("held", [False, True])
def test_a_force_that_was_there_as_the_period_began_is_no_manipulation(held: bool) -> None:
    """FD-13, at entry and at the release: forces are changes since the period began."""
    alone = Alone(held, PUSHED)
    alone.held = False
    assert alone.run(5, PUSHED) == []
    assert alone.periods.phase is Phase.PERIOD
    values = {"parameter": "user force", "part": "flange", "value": pytest.approx(8.5), "limit": 8.0, "unit": "N"}
    assert alone.step(estimate(force=28.5)) == [Event(Kind.MANIPULATION, alone.tick, values)]


PRESSED = Excess("user force", "arm", 30.0, 12.0, "N")


def test_a_hand_that_presses_steadily_keeps_free_drive() -> None:
    """FD-13: in the period, and where the guided arm rests; the restart period begins when it lets go."""
    alone = Alone(False, free_drive__restart_period=0.5)
    alone.still.count = 1000
    assert alone.step(pressed=PRESSED) == [Event(Kind.MANIPULATION, 1, dict(PRESSED._asdict()))]
    for _ in range(1000):
        assert alone.step(pressed=PRESSED) == []
    assert alone.periods.phase is Phase.GUIDED
    assert [event.kind for event in alone.run(251)] == [Kind.RESTARTED, Kind.LEFT_RESTART]


def test_while_a_pattern_shakes_the_arm_a_steady_force_is_nobodys() -> None:
    alone = Alone(False, free_drive__period=0.5)
    alone.shaken = True
    assert [event.kind for _ in range(250) for event in alone.step(pressed=PRESSED)] == [Kind.LEFT_PERIOD]


def test_hold_to_run_leaves_on_release() -> None:
    bench = Quick(button__hold_to_run=True).entered()
    bench.run(100, HOLD)
    bench.step(LET_GO)
    assert (bench.last.mode, bench.last.events) == (Mode.TEACH, (Event(Kind.LEFT_RELEASE, bench.tick, {}),))


@pytest.mark.parametrize("ticks", [1, 2, 500])
def test_where_the_button_is_held_to_run_to_let_it_go_leaves(ticks: int) -> None:
    """FD-8a: however long it was held."""
    (left,) = pressed(Alone(held=True, button__hold_to_run=True), ticks)
    assert (left.kind, left.tick) == (Kind.LEFT_RELEASE, ticks + 1)
