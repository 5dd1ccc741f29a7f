"""Free-drive with the shipped settings: every period to its tick, every leaving with its numbers."""

import math
from dataclasses import replace

import numpy as np
import pytest

from pendant.decision import Decision, Remaining
from pendant.estimate import Estimate
from pendant.events import Event, Kind
from pendant.freedrive import may_enter, origins
from pendant.inputs import NOTHING, Button, Command, Inputs
from pendant.modes import Law, Mode, Phase
from pendant.settings import Settings, apply
from pendant.supervisor import Supervisor
from tests.pendant.estimates import estimate

HOLD = Inputs(held=frozenset({Button.FREE_DRIVE}))
LET_GO = Inputs(released=frozenset({Button.FREE_DRIVE}))
JOINTS = ("base", "shoulder", "elbow", "wrist_1", "wrist_2", "wrist_3")

BY_HAND = {Phase.FEEDBACK, Phase.CONFIRM, Phase.LET_GO}
"""Phases that test_attempt.py is about."""


class Bench:
    """A supervisor that is stepped by hand; ticks count from 0. There is no activation sequence unless asked for."""

    def __init__(self, **changes: float | bool) -> None:
        names = {name.replace("__", "."): value for name, value in {"sequence__on": False, **changes}.items()}
        self.supervisor = Supervisor(apply(Settings(), names), 6, JOINTS)
        self.tick = -1
        self.last: Decision
        self.events: list[Event] = []

    def step(self, inputs: Inputs = NOTHING, value: Estimate | None = None) -> Decision:
        self.tick += 1
        value = value or estimate()
        value.tick = self.tick
        self.last = self.supervisor.step(value, inputs)
        self.events += self.last.events
        return self.last

    def run(self, count: int, inputs: Inputs = NOTHING, value: Estimate | None = None) -> Decision:
        for _ in range(count):
            self.step(inputs, value)
        return self.last

    def entered(self, value: Estimate | None = None) -> "Bench":
        """In FREE_DRIVE, button held."""
        self.run(60, NOTHING, value)
        self.run(501, HOLD, value)
        assert self.last.mode is Mode.FREE_DRIVE
        return self

    def in_period(self) -> "Bench":
        self.entered().step(LET_GO)
        assert self.last.phase is Phase.PERIOD
        self.events.clear()
        return self


def remaining(decision: Decision) -> dict[str, tuple[int, int]]:
    return {period.name: (period.ticks, period.total) for period in decision.periods}


@pytest.mark.parametrize(("seconds", "count"), [(0.0, 0), (0.002, 1), (0.25, 125), (1.0, 500), (15.0, 7500)])
def test_activation_lasts_its_period_to_the_tick(seconds: float, count: int) -> None:
    """FD-7, FD-20."""
    bench = Bench(activation__period=seconds)
    bench.run(60)
    for left in range(count, 0, -1):
        bench.step(HOLD)
        assert (bench.last.mode, bench.last.phase, bench.last.law) == (Mode.TEACH, Phase.ACTIVATION, Law.HOLD)
        assert remaining(bench.last) == {"activation": (left, count)}
    bench.step(HOLD)
    assert (bench.last.mode, bench.last.phase, bench.last.law) == (Mode.FREE_DRIVE, Phase.HELD, Law.FREE)
    assert bench.last.periods == ()
    assert [event.kind for event in bench.events] == [Kind.ACTIVATION_STARTED, Kind.ENTERED]
    assert bench.events[0] == Event(Kind.ACTIVATION_STARTED, 60, {"period": pytest.approx(seconds)})
    assert bench.events[1] == Event(Kind.ENTERED, 60 + count, {"from": Mode.TEACH, "gain": 1.0})


@pytest.mark.parametrize("held", [1, 2, 250, 499, 500])
def test_letting_go_before_the_end_cancels_without_a_cool_down(held: int) -> None:
    """FD-8a."""
    bench = Bench()
    bench.run(60)
    bench.run(held, HOLD)
    bench.step(LET_GO)
    assert (bench.last.mode, bench.last.phase, bench.last.periods) == (Mode.TEACH, Phase.OFF, ())
    values = {"value": pytest.approx(held / 500), "limit": 1.0}
    assert bench.events[-1] == Event(Kind.ACTIVATION_CANCELLED, 60 + held, values)
    assert bench.step(HOLD).phase is Phase.ACTIVATION
    assert remaining(bench.last) == {"activation": (500, 500)}


@pytest.mark.parametrize(("seconds", "count"), [(0.5, 250), (3.0, 1500), (30.0, 15000)])
def test_the_free_drive_period_lasts_to_its_tick(seconds: float, count: int) -> None:
    """FD-14."""
    bench = Bench(free_drive__period=seconds).in_period()
    assert remaining(bench.last) == {"free-drive": (count, count)}
    for left in range(count - 1, 0, -1):
        bench.step()
        assert remaining(bench.last) == {"free-drive": (left, count)}
        assert (bench.last.mode, bench.last.law, bench.last.events) == (Mode.FREE_DRIVE, Law.FREE, ())
    bench.step()
    assert (bench.last.mode, bench.last.phase, bench.last.law) == (Mode.TEACH, Phase.OFF, Law.HOLD)
    assert bench.events == [Event(Kind.LEFT_PERIOD, bench.tick, {"limit": seconds})]
    assert remaining(bench.last) == {"cool-down": (1000, 1000)}


@pytest.mark.parametrize("tick", [1, 2, 1499, 1500])
def test_manipulation_in_any_tick_of_the_period_keeps_free_drive(tick: int) -> None:
    """FD-13: also in the very last tick."""
    bench = Bench().in_period()
    bench.run(tick - 1)
    bench.step(NOTHING, estimate(force=8.001))
    assert bench.last.phase is Phase.GUIDED
    assert bench.last.periods == ()
    values = {"parameter": "user force", "part": "flange", "value": 8.001, "limit": 8.0, "unit": "N"}
    assert bench.last.events == (Event(Kind.MANIPULATION, bench.tick, values),)


def test_a_force_at_its_limit_is_no_manipulation() -> None:
    bench = Bench().in_period()
    assert bench.run(1499, NOTHING, estimate(force=8.0)).phase is Phase.PERIOD
    assert bench.step(NOTHING, estimate(force=8.0)).phase is Phase.OFF


@pytest.mark.parametrize("seconds", [0.5, 3.0])
def test_the_restart_period_begins_when_the_arm_is_static_again(seconds: float) -> None:
    """FD-15."""
    count = round(seconds * 500)
    bench = Bench(free_drive__restart_period=seconds).in_period()
    bench.run(700, NOTHING, estimate(qd=0.5))
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
    bench = Bench().in_period()
    pushed = estimate(force=20.0)
    assert bench.step(NOTHING, pushed).phase is Phase.GUIDED
    assert bench.run(49, NOTHING, pushed).phase is Phase.GUIDED
    assert bench.step(NOTHING, pushed).phase is Phase.RESTART
    # the steady push is what the new period counts from; letting go is a change
    assert bench.run(1000, NOTHING, pushed).phase is Phase.RESTART
    assert bench.step().phase is Phase.GUIDED


@pytest.mark.parametrize(("held", "leaves"), [(1, True), (2, True), (199, True), (200, False), (201, False), (2000, False)])
@pytest.mark.parametrize("start", ["period", "guided", "restart"])
def test_a_short_press_leaves_and_a_longer_one_suspends(start: str, held: int, leaves: bool) -> None:
    """FD-8a, to the tick: 0.4 s are 200 ticks."""
    bench = Bench().in_period()
    if start != "period":
        bench.run(1, NOTHING, estimate(qd=0.5))
    if start == "restart":
        bench.run(60)
    for _ in range(held):
        bench.step(HOLD)
        assert (bench.last.phase, bench.last.periods) == (Phase.HELD, ())
    bench.step(LET_GO)
    if leaves:
        assert bench.last.mode is Mode.TEACH
        values = {"value": pytest.approx(held / 500), "limit": 0.4}
        assert bench.last.events == (Event(Kind.LEFT_PRESS, bench.tick, values),)
        assert remaining(bench.last) == {"cool-down": (1000, 1000)}
    else:
        assert bench.last.mode is Mode.FREE_DRIVE
        assert remaining(bench.last) == {"free-drive": (1500, 1500)}


def test_the_press_that_entered_may_be_short_without_leaving() -> None:
    bench = Bench(activation__period=0.0)
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
    bench = Bench().entered()
    bench.run(20000, HOLD)
    assert (bench.last.phase, bench.last.periods) == (Phase.HELD, ())


def test_hold_to_run_leaves_on_release() -> None:
    bench = Bench(button__hold_to_run=True).entered()
    bench.run(1000, HOLD)
    bench.step(LET_GO)
    assert (bench.last.mode, bench.last.events) == (Mode.TEACH, (Event(Kind.LEFT_RELEASE, bench.tick, {}),))


def test_a_button_that_falls_silent_counts_as_released() -> None:
    """FD-23: 0.5 s are 250 ticks."""
    bench = Bench().entered()
    assert bench.run(250).phase is Phase.HELD
    bench.step()
    assert bench.last.phase is Phase.PERIOD
    assert bench.last.events == (Event(Kind.HOLD_SILENT, bench.tick, {"value": 0.502, "limit": 0.5}),)


def test_a_stutter_during_activation_does_not_cancel_it_and_silence_does() -> None:
    bench = Bench()
    bench.run(60)
    bench.step(HOLD)
    bench.run(250)
    bench.step(HOLD)
    assert bench.last.phase is Phase.ACTIVATION
    bench.run(248)
    assert remaining(bench.last) == {"activation": (1, 500)}
    assert bench.step().phase is Phase.HELD
    bench = Bench(activation__period=2.0)
    bench.run(60)
    bench.step(HOLD)
    assert bench.run(250).phase is Phase.ACTIVATION
    bench.step()
    assert [event.kind for event in bench.last.events] == [Kind.HOLD_SILENT, Kind.ACTIVATION_CANCELLED]


@pytest.mark.parametrize(("seconds", "count"), [(0.0, 0), (0.1, 50), (2.0, 1000), (30.0, 15000)])
def test_the_cool_down_lasts_to_its_tick(seconds: float, count: int) -> None:
    """FD-12c: a new press counts when the cool-down has ended."""
    bench = Bench(free_drive__cool_down=seconds).in_period()
    bench.step(HOLD)
    bench.step(LET_GO)
    left = bench.tick
    assert bench.events[-1].kind is Kind.LEFT_PRESS
    bench.events.clear()
    while bench.step(HOLD).phase is Phase.OFF:
        assert remaining(bench.last) == {"cool-down": (count - (bench.tick - left), count)}
    assert bench.tick == left + max(count, 1)
    expected = [] if count < 2 else [Event(Kind.NOT_YET, left + 1, {"remaining": pytest.approx((count - 1) / 500)})]
    assert bench.events == [*expected, Event(Kind.ACTIVATION_STARTED, bench.tick, {"period": 1.0})]


@pytest.mark.parametrize(("absent", "counts"), [(1, False), (98, False), (99, False), (100, True), (101, True)])
def test_a_signal_present_at_a_leaving_counts_after_an_absence(absent: int, counts: bool) -> None:
    """FD-7: 0.2 s are 100 ticks. FD-17 starts no cool-down."""
    bench = Bench().entered()
    bench.step(replace(HOLD, commands=(Command.LEAVE_FREE_DRIVE,)))
    assert (bench.last.mode, bench.last.periods) == (Mode.TEACH, ())
    assert bench.last.events == (Event(Kind.DEACTIVATED, bench.tick, {}),)
    bench.run(1200, HOLD)
    assert bench.last.phase is Phase.OFF
    bench.step(LET_GO)
    bench.run(absent - 1)
    bench.events.clear()
    bench.step(HOLD)
    assert bench.last.phase is (Phase.ACTIVATION if counts else Phase.OFF)
    assert [event.kind for event in bench.events] == [Kind.ACTIVATION_STARTED if counts else Kind.NOT_YET]


@pytest.mark.parametrize("phase", [phase for phase in Phase if phase not in {Phase.OFF, *BY_HAND}])
def test_the_deactivation_signal_leaves_every_phase_at_once(phase: Phase) -> None:
    """FD-17."""
    bench = Bench(sequence__on=phase is Phase.SEQUENCE)
    bench.run(60)
    bench.step(HOLD)
    if phase is not Phase.ACTIVATION:
        bench.run(500, HOLD)
    if phase not in (Phase.ACTIVATION, Phase.HELD):
        bench.step(LET_GO)
    if phase in (Phase.GUIDED, Phase.RESTART):
        bench.step(NOTHING, estimate(qd=0.5))
    if phase is Phase.RESTART:
        bench.run(60)
    assert bench.last.phase is phase
    bench.step(Inputs(commands=(Command.LEAVE_FREE_DRIVE,)))
    assert (bench.last.mode, bench.last.phase) == (Mode.TEACH, Phase.OFF)
    assert bench.last.events == (Event(Kind.DEACTIVATED, bench.tick, {}),)
    bench.step(LET_GO)
    bench.run(99)
    assert bench.step(HOLD).phase is Phase.ACTIVATION


@pytest.mark.parametrize("name", ["q", "qd", "theta", "theta_d", "tau_J", "tau_ext", "v_F"])
def test_entry_is_refused_and_free_drive_stopped_when_a_joint_value_is_no_number(name: str) -> None:
    """FD-12."""
    broken = estimate()
    getattr(broken, name)[2] = math.nan
    bench = Bench()
    bench.run(60)
    bench.run(500, HOLD)
    bench.step(HOLD, broken)
    assert bench.last.mode is Mode.TEACH
    assert bench.last.events == (Event(Kind.REFUSED_SENSORS, bench.tick, {"sensor": "joint encoders and motor currents"}),)
    assert remaining(bench.last) == {"cool-down": (1000, 1000)}
    bench = Bench().in_period()
    bench.step(NOTHING, broken)
    assert (bench.last.mode, bench.last.law, bench.last.phase) == (Mode.STOP, Law.BRAKE, Phase.OFF)
    assert bench.last.events == (Event(Kind.SENSORS_LOST, bench.tick, {"sensor": "joint encoders and motor currents"}),)


@pytest.mark.parametrize(("ago", "entered"), [(0, False), (1, False), (49, False), (50, True), (51, True)])
def test_entry_is_refused_unless_the_arm_was_static(ago: int, entered: bool) -> None:
    """0.1 s are 50 ticks."""
    bench = Bench()
    bench.run(60)
    bench.run(500 - ago, HOLD)
    bench.step(HOLD, estimate(qd=[0.0, 0.0, -0.0123, 0.0, 0.0, 0.0]))
    bench.run(ago, HOLD)
    assert (bench.last.mode is Mode.FREE_DRIVE) == entered
    if not entered:
        values = {"joint": "elbow", "value": 0.0123, "limit": 0.01, "time": 0.1}
        assert bench.last.events == (Event(Kind.REFUSED_MOVING, bench.tick, values),)


def test_a_moving_arm_is_braked_after_leaving_until_it_is_static() -> None:
    bench = Bench().in_period()
    moving = estimate(qd=0.5)
    bench.run(20, NOTHING, moving)
    bench.step(Inputs(commands=(Command.LEAVE_FREE_DRIVE,)), moving)
    assert bench.last.law is Law.BRAKE
    assert bench.run(30, NOTHING, moving).law is Law.BRAKE
    assert bench.run(49).law is Law.BRAKE
    assert bench.step().law is Law.HOLD
    assert bench.step(NOTHING, moving).law is Law.HOLD


def test_the_baseline_is_the_mean_force_of_the_last_tenth_of_a_second_before_entry() -> None:
    bench = Bench()
    bench.run(60)
    bench.run(451, HOLD, estimate(force=100.0))
    for tick in range(50):
        bench.step(HOLD, estimate(force=[float(tick), 2.0, -1.0], torque=[0.5, 0.0, 0.1 * tick]))
    assert bench.last.mode is Mode.FREE_DRIVE
    assert bench.last.baseline == pytest.approx((24.5, 2.0, -1.0, 0.5, 0.0, 2.45))
    kept = bench.last.baseline
    bench.step(LET_GO)
    assert bench.run(100, NOTHING, estimate(force=40.0)).baseline == kept
    assert bench.step(Inputs(commands=(Command.LEAVE_FREE_DRIVE,))).baseline == (0.0,) * 6


@pytest.mark.parametrize("gain", [0.0, 1.0, 2.5])
def test_the_gain_helps_only_in_free_drive(gain: float) -> None:
    """FD-3."""
    bench = Bench(free_drive__gain=gain)
    assert bench.run(60).gain == 0.0
    assert bench.run(500, HOLD).gain == 0.0
    assert bench.step(HOLD).gain == gain
    assert bench.step(Inputs(commands=(Command.LEAVE_FREE_DRIVE,))).gain == 0.0


def test_without_a_flange_sensor_free_drive_is_entered_without_help() -> None:
    """FD-3a."""
    blind = estimate(wrench_valid=False, force=30.0)
    bench = Bench().entered(blind)
    assert (bench.last.gain, bench.last.baseline) == (0.0, (0.0,) * 6)
    assert bench.last.events == (Event(Kind.ENTERED, bench.tick, {"from": Mode.TEACH, "gain": 0.0}),)
    bench.step(LET_GO, blind)
    # a sensor that comes back is not used before the next entry
    assert bench.run(100, NOTHING, estimate(force=50.0)).phase is Phase.PERIOD
    assert bench.last.gain == 0.0
    assert bench.step(NOTHING, estimate(tau_ext=8.1)).phase is Phase.GUIDED


@pytest.mark.parametrize("bad", [estimate(wrench_valid=False, force=3.0), estimate(force=math.nan), estimate(torque=math.inf)])
def test_a_flange_sensor_lost_in_free_drive_takes_its_help_away_for_good(bad: Estimate) -> None:
    bench = Bench().entered(estimate(force=3.0))
    assert (bench.last.gain, bench.last.baseline[0]) == (1.0, pytest.approx(3.0))
    bench.step(HOLD, bad)
    assert (bench.last.mode, bench.last.gain, bench.last.baseline) == (Mode.FREE_DRIVE, 0.0, (0.0,) * 6)
    assert bench.last.events == (Event(Kind.WRENCH_LOST, bench.tick, {}),)
    bench.run(10, HOLD)
    assert (bench.last.gain, bench.last.events) == (0.0, ())


@pytest.mark.parametrize("mode", [Mode.NORMAL, Mode.REMOTE, Mode.TEACH])
@pytest.mark.parametrize("allowed", [(), ("normal",), ("teach",), ("normal", "teach", "run")])
def test_free_drive_is_entered_from_the_allowed_modes_alone(mode: Mode, allowed: tuple[str, ...]) -> None:
    """FD-1."""
    bench = Bench(**{f"free_drive__allowed_from__{name}": name in allowed for name in ("normal", "teach", "run")})
    bench.run(60)
    bench.step(Inputs(commands=(Command(mode.value.lower()),)))
    bench.events.clear()
    bench.step(HOLD)
    if mode.value.lower() in allowed:
        assert bench.run(500, HOLD).mode is Mode.FREE_DRIVE
        bench.step(LET_GO)
        assert bench.run(1500).mode is mode
    else:
        text = {(): "none", ("normal",): "NORMAL", ("teach",): "TEACH"}.get(allowed, "NORMAL, TEACH, RUN")
        assert bench.events == [Event(Kind.REFUSED_MODE, bench.tick, {"mode": mode, "allowed": text})]
        assert bench.run(600, HOLD).mode is mode


def test_no_setting_allows_entry_from_remote_stop_or_free_drive() -> None:
    everything = {f"free_drive.allowed_from.{name}": True for name in ("normal", "teach", "run")}
    settings = apply(Settings(), everything)
    assert {mode for mode in Mode if may_enter(mode, settings)} == {Mode.NORMAL, Mode.TEACH, Mode.RUN}
    assert origins(settings) == "NORMAL, TEACH, RUN"


def test_periods_are_published_together_and_only_while_they_run() -> None:
    bench = Bench().in_period()
    bench.step(HOLD)
    bench.step(LET_GO)
    bench.run(999)
    assert bench.last.periods == (Remaining("cool-down", 1, 1000),)
    assert bench.step().periods == ()


def test_any_number_of_joints() -> None:
    supervisor = Supervisor(apply(Settings(), {"sequence.on": False}), 7)
    value = estimate(n=7)
    value.qd[6] = 0.02
    for _ in range(501):
        decision = supervisor.step(value, HOLD)
    assert decision.events[0].values["joint"] == "joint 7"
    assert np.all(value.q == 0.0)
