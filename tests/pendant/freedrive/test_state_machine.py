"""Free-drive with the shipped settings: every period to its tick, every leaving with its numbers."""

import math

import numpy as np
import pytest

from pendant.all_settings import Settings, apply
from pendant.decision import Decision
from pendant.events.event import Event, Kind
from pendant.freedrive.periods import Remaining
from pendant.inputs import NOTHING, Button, Command, Inputs
from pendant.supervisor import Supervisor
from pendant.tick.estimate import Estimate
from pendant.tick.modes import Law, Mode, Phase, Safety
from pendant.tick.motion_status import NO_MOTION, MotionStatus
from pendant.tick.state import state_of
from tests.pendant.estimates import estimate
from tests.pendant.telling import whole

HOLD = Inputs(held=frozenset({Button.FREE_DRIVE}))
LET_GO = Inputs(released=frozenset({Button.FREE_DRIVE}))
JOINTS = ("base", "shoulder", "elbow", "wrist_1", "wrist_2", "wrist_3")

BY_HAND = {Phase.DELAY, Phase.FEEDBACK, Phase.CONFIRM, Phase.LET_GO}
"""Phases that test_attempt.py is about."""


class Bench:
    """A supervisor that is stepped by hand; ticks count from 0. There is no activation sequence unless asked for."""

    def __init__(self, **changes: float | bool) -> None:
        names = {name.replace("__", "."): value for name, value in {"sequence__on": False, **changes}.items()}
        self.supervisor = Supervisor(apply(Settings(), names), 6, joints=JOINTS)
        self.tick = -1
        self.last: Decision
        self.events: list[Event] = []

    def step(self, inputs: Inputs = NOTHING, value: Estimate | None = None, status: MotionStatus = NO_MOTION) -> Decision:
        self.tick += 1
        value = value or estimate()
        value.tick = self.tick
        self.last = self.supervisor.step(value, inputs, status)
        self.events += whole(self.last.events, self.tick)
        return self.last

    def run(
        self, count: int, inputs: Inputs = NOTHING, value: Estimate | None = None, status: MotionStatus = NO_MOTION
    ) -> Decision:
        for _ in range(count):
            self.step(inputs, value, status)
        return self.last

    def entered(self, value: Estimate | None = None) -> "Bench":
        """In the first tick of FREE_DRIVE, button held."""
        self.run(60, NOTHING, value)
        for _ in range(501):
            if self.step(HOLD, value).mode is Mode.FREE_DRIVE:
                break
        assert self.last.mode is Mode.FREE_DRIVE
        return self

    def in_period(self) -> "Bench":
        self.entered().step(LET_GO)
        assert self.last.phase is Phase.PERIOD
        self.events.clear()
        return self


def remaining(decision: Decision) -> dict[str, tuple[int, int]]:
    return {period.name: (period.ticks, period.total) for period in decision.periods}


def test_a_button_that_falls_silent_counts_as_released() -> None:
    """FD-23: 0.5 s are 250 ticks."""
    bench = Bench().entered()
    assert bench.run(250).phase is Phase.HELD
    bench.step()
    assert bench.last.phase is Phase.PERIOD
    assert bench.last.events == (Event(Kind.HOLD_SILENT, bench.tick, {"value": 0.502, "limit": 0.5}),)


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
    broken = estimate().copy()
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
    assert bench.run(100, NOTHING, estimate(force=40.0, felt=40.0)).baseline == kept
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
def test_a_flange_sensor_lost_in_free_drive_stops_the_arm(bad: Estimate) -> None:
    bench = Bench().entered(estimate(force=3.0))
    assert (bench.last.gain, bench.last.baseline[0]) == (1.0, pytest.approx(3.0))
    bench.step(HOLD, bad)
    assert (bench.last.mode, bench.last.safety, bench.last.gain) == (Mode.STOP, Safety.NORMAL, 0.0)
    assert bench.last.events == (Event(Kind.WRENCH_LOST, bench.tick, {}),)


@pytest.mark.parametrize("told", [True, False])
def test_a_leaving_that_nobody_asked_for_tells_the_way_back_to_the_posture_at_activation(told: bool) -> None:
    """FD-22, and only where it is switched on."""
    bench = Bench(free_drive__way_back=told).entered(estimate(q=[0.5, -1.0, 1.5, -0.25, 0.75, 0.0]))
    bench.step(HOLD, estimate(q=[0.5, -1.1, 1.7, -0.25, 0.75, 0.0], v_tcp=1.53))
    left, *others = bench.last.events
    assert left.kind is Kind.LEFT_LIMIT
    values = {"joints": "elbow -11.5°, shoulder +5.7°", "posture": "0.5000 -1.0000 1.5000 -0.2500 0.7500 0.0000"}
    assert others == ([Event(Kind.WAY_BACK, bench.tick, values)] if told else [])


def test_periods_are_published_together_and_only_while_they_run() -> None:
    bench = Bench().in_period()
    bench.step(HOLD)
    bench.step(LET_GO)
    bench.run(999)
    assert bench.last.periods == (Remaining("cool-down", 1, 1000),)
    assert bench.step().periods == ()


def test_where_nothing_was_begun_or_refused_a_payload_that_changes_or_a_stop_leaves_free_drive_as_it_is() -> None:
    free = Bench().supervisor._free
    before = state_of(free)
    free.forget()
    assert state_of(free) == before
    free.stop(Kind.DEACTIVATED, Settings())
    assert state_of(free) == before


def test_a_force_that_was_there_at_entry_without_the_button_is_no_manipulation() -> None:
    """FD-13: the button is let go in the sequence."""
    bench, pushed = Bench(sequence__on=True, activation__period=0.0), estimate(force=10.0)
    bench.run(60, NOTHING, pushed)
    bench.step(HOLD, pushed)
    assert bench.step(LET_GO, pushed).phase is Phase.SEQUENCE
    ticks = bench.last.periods[0].ticks
    assert bench.run(ticks, NOTHING, pushed).phase is Phase.PERIOD
    assert bench.run(20, NOTHING, pushed).phase is Phase.PERIOD
    assert [event.kind for event in bench.events] == [Kind.ACTIVATION_STARTED, Kind.SEQUENCE_STARTED, Kind.ENTERED]


@pytest.mark.parametrize("held", [True, False])
def test_what_the_sensor_drifts_by_is_taken_off_only_while_nobody_moves_the_arm(held: bool) -> None:
    """FD-19: the button held, somebody does. At 2 N/s the means of two windows of 50 ticks are 0.102 N and 0.302 N."""
    bench = Bench(activation__period=0.0).in_period()
    for tick in range(110):
        bench.step(HOLD if held else NOTHING, estimate(force=0.004 * tick))
    assert bench.last.baseline[0] == (0.0 if held else pytest.approx(0.302))


def test_any_number_of_joints() -> None:
    supervisor = Supervisor(apply(Settings(), {"sequence.on": False}), 7)
    value = estimate(n=7).copy()
    value.qd[6] = 0.02
    for _ in range(501):
        decision = supervisor.step(value, HOLD)
    assert decision.events[0].values["joint"] == "joint 7"
    assert np.all(value.q == 0.0)


@pytest.mark.parametrize(("period", "kind"), [(0.0, Kind.LEFT_ENABLING), (1.0, Kind.REFUSED_ENABLING)])
def test_letting_go_of_the_enabling_device_ends_what_has_begun(period: float, kind: Kind) -> None:
    """In free-drive that is leaving, before a refusal."""
    bench = Bench(enabling__on=True, activation__period=period)
    bench.run(60)
    bench.step(Inputs(held=frozenset({Button.FREE_DRIVE, Button.ENABLING})))
    bench.step(Inputs(held=frozenset({Button.FREE_DRIVE}), released=frozenset({Button.ENABLING})))
    assert bench.last.events == (Event(kind, bench.tick, {"grip": "released"}),)
    assert (bench.last.mode, bench.last.phase) == (Mode.TEACH, Phase.OFF)


@pytest.mark.parametrize(("seconds", "after"), [(0.0, 0), (0.002, 1), (0.004, 1), (0.006, 2), (0.1, 49)])
def test_what_is_told_of_a_refused_payload_is_told_in_the_last_tick_of_the_cool_down(seconds: float, after: int) -> None:
    """FD-11: without a cool-down, never."""
    bench, loaded = (
        Bench(sequence__on=True, activation__period=0.0, free_drive__cool_down=seconds),
        estimate(force=[0.0, 0.0, 9.81]),
    )
    bench.run(60, NOTHING, loaded)
    assert bench.step(HOLD, loaded).events[-1].kind is Kind.REFUSED_PAYLOAD
    bench.events.clear()
    bench.run(60, NOTHING, loaded)
    values = {"force": pytest.approx(9.81), "mass": pytest.approx(-1.0), "zero": False}
    stayed = Event(Kind.RESIDUAL_STAYED, 60 + after, values)
    assert bench.events == ([stayed] if after else [])


def test_another_refusal_is_nobodys_payload() -> None:
    """FD-11."""
    bench, pushed = Bench(sequence__on=True, activation__period=0.0, free_drive__cool_down=0.1), estimate(force=30.0)
    bench.run(60, NOTHING, pushed)
    assert bench.step(HOLD, pushed).events[-1].kind is Kind.REFUSED_LIMIT
    bench.events.clear()
    bench.run(60)
    assert bench.events == []


def test_the_period_of_free_drive_is_published() -> None:
    """FD-20: not that of the activation."""
    assert remaining(Bench(activation__period=0.0).in_period().last) == {"free-drive": (1500, 1500)}


def test_no_state_of_free_drive_is_compared_with() -> None:
    """FD-9: the state must be 0.5 s old, and the arm held since; 300 ticks at rest in free-drive do not count."""
    bench = Bench(sequence__on=True, sequence__stored=True, sequence__age=0.5, sequence__period=0.1, activation__period=0.0)
    bench.run(300)
    bench.run(52, HOLD)
    assert bench.last.mode is Mode.FREE_DRIVE
    bench.step(LET_GO)
    bench.run(300)
    bench.step(Inputs(commands=(Command.LEAVE_FREE_DRIVE,)))
    bench.events.clear()
    bench.step(HOLD)
    assert bench.events[-1] == Event(Kind.REFUSED_NOT_STORED, bench.tick, {"age": 0.5})


def test_a_refusal_after_free_drive_was_left_tells_no_way_back() -> None:
    """FD-22."""
    bench = Bench(activation__period=0.0).entered(estimate(q=[0.5] * 6))
    bench.step(LET_GO)
    bench.step(Inputs(commands=(Command.LEAVE_FREE_DRIVE,)))
    bench.run(100)
    bench.step(HOLD, estimate(qd=0.1))
    assert [event.kind for event in bench.last.events] == [Kind.ACTIVATION_STARTED, Kind.REFUSED_MOVING]
