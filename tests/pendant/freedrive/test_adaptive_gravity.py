"""Balancing of an arm that is refused free-drive (FD-10): when it begins, how it ends, what it reports."""

import math

import pytest

from pendant.events.event import Kind
from pendant.freedrive.adaptive_gravity import Balance
from pendant.inputs import NOTHING, Command, Inputs
from pendant.tick.estimate import Estimate
from pendant.tick.modes import Law, Mode, Phase, Safety
from tests.pendant.estimates import estimate
from tests.pendant.freedrive.test_state_machine import HOLD, LET_GO, Bench, remaining

HEAVIER = [0.0, 0.0, -19.62]
"""The user's force as of 2 kg more than configured [N]."""


def sinking(position: float = 0.003, force: list[float] | None = None, speed: float = 0.05) -> Estimate:
    """The joints move, the flange has left its place."""
    return estimate(position=position, qd=speed, force=force or [0.0, 0.0, 0.0])


def balanced(**changes: float | bool) -> Bench:
    """In the tick in which the flange is found beyond its limit, tick 561."""
    bench = Bench(**{"sequence__on": True, "sequence__beyond_limit": "balance", **changes})
    bench.run(60)
    bench.run(501, HOLD)
    bench.step(LET_GO, sinking())
    return bench


def kinds(bench: Bench) -> list[Kind]:
    return [event.kind for event in bench.last.events]


def test_beyond_a_limit_the_arm_stays_free_and_is_balanced() -> None:
    bench = balanced()
    assert kinds(bench) == [Kind.ENTRY_PREVENTED, Kind.COMPENSATING]
    last = bench.last
    assert (last.mode, last.phase, last.law, last.gain) == (Mode.TEACH, Phase.SEQUENCE, Law.FREE, 0.0)
    assert last.balance == Balance((0.0, 0.0, 1.0), True)
    assert last.events[-1].values == {"period": 2.0}
    assert remaining(last) == {"compensation": (1000, 1000)}
    assert remaining(bench.step(NOTHING, sinking())) == {"compensation": (999, 1000)}
    assert bench.last.monitored == ()


def test_help_for_the_hand_is_off_even_where_the_check_has_it() -> None:
    bench = Bench(sequence__on=True, sequence__beyond_limit="balance", sequence__amplified=True)
    bench.run(60)
    assert bench.run(501, HOLD).gain == 1.0
    assert bench.step(LET_GO, sinking()).gain == 0.0


@pytest.mark.parametrize(("moving", "count"), [(0, 150), (100, 150), (101, 151), (400, 450)])
def test_static_again_but_not_before_the_torque_has_settled_it_is_held(moving: int, count: int) -> None:
    """FD-10: static is 0.1 s, 50 ticks, from the first one at rest; 0.3 s are 150 ticks."""
    bench = balanced()
    bench.run(moving, NOTHING, sinking(0.004))
    assert bench.run(count - moving - 1, NOTHING, estimate(position=0.005)).law is Law.FREE
    bench.step(NOTHING, estimate(position=0.005))
    assert (bench.last.mode, bench.last.phase, bench.last.law) == (Mode.TEACH, Phase.OFF, Law.HOLD)
    assert bench.last.balance is None
    assert kinds(bench) == [Kind.COMPENSATED, Kind.LOAD_FOUND, Kind.REFUSED_LIMIT]
    assert bench.last.events[0].values == {"moved": pytest.approx(2.0), "time": pytest.approx(count / 500)}
    assert bench.last.events[2].tick == 561 + count
    assert bench.last.events[2].values["parameter"] == "flange displacement"
    assert remaining(bench.last) == {"cool-down": (1000, 1000)}


@pytest.mark.parametrize(("force", "mass", "way"), [(-19.62, 2.0, "down"), (9.81, -1.0, "up"), (0.4905, -0.05, "up")])
def test_what_it_bears_then_is_reported(force: float, mass: float, way: str) -> None:
    bench = balanced()
    bench.run(150, NOTHING, estimate(force=[3.0, 0.0, force]))
    assert bench.last.events[1].values == {"mass": pytest.approx(mass), "force": pytest.approx(abs(force)), "way": way}


def test_the_way_is_from_where_it_was_found() -> None:
    bench = Bench(sequence__on=True, sequence__beyond_limit="balance")
    bench.run(60)
    bench.run(501, HOLD)
    bench.step(LET_GO, estimate(position=[0.003, -0.001, 0.002], qd=0.05))
    bench.run(150, NOTHING, estimate(position=[0.005, 0.002, 0.008]))
    assert bench.last.events[0].values["moved"] == pytest.approx(7.0)


def test_a_payload_seen_at_once_is_refused_as_one_and_the_verdict_waits() -> None:
    bench = Bench(sequence__on=True, sequence__beyond_limit="balance")
    heavy = estimate(force=HEAVIER)
    bench.run(60, NOTHING, heavy)
    bench.run(501, HOLD, heavy)
    assert kinds(bench) == [Kind.SEQUENCE_STARTED, Kind.ENTRY_PREVENTED, Kind.COMPENSATING]
    bench.step(LET_GO, heavy)
    bench.run(149, NOTHING, heavy)
    assert kinds(bench) == [Kind.COMPENSATED, Kind.LOAD_FOUND, Kind.REFUSED_PAYLOAD]
    bench.events.clear()
    bench.run(1000, NOTHING, heavy)
    assert [event.kind for event in bench.events] == [Kind.RESIDUAL_STAYED]


def test_without_the_flange_sensor_nothing_is_said_of_the_load() -> None:
    bench = Bench(sequence__on=True, sequence__beyond_limit="balance")
    bare = estimate(wrench_valid=False)
    bench.run(60, NOTHING, bare)
    bench.run(501, HOLD, bare)
    moved = estimate(wrench_valid=False, position=0.003)
    bench.step(LET_GO, moved)
    assert bench.last.balance == Balance((0.0, 0.0, 1.0), False)
    bench.run(150, NOTHING, moved)
    assert kinds(bench) == [Kind.COMPENSATED, Kind.REFUSED_LIMIT]


def test_a_sensor_that_fails_meanwhile_is_not_gone_by() -> None:
    bench = balanced()
    bench.step(NOTHING, estimate(wrench_valid=False))
    assert bench.last.balance == Balance((0.0, 0.0, 1.0), False)
    bench.step()
    assert bench.last.balance == Balance((0.0, 0.0, 1.0), True)
    assert kinds(bench) == []


def test_an_arm_that_does_not_come_to_rest_is_held_after_two_seconds() -> None:
    bench = balanced()
    assert bench.run(999, NOTHING, sinking(0.004)).law is Law.FREE
    bench.step(NOTHING, sinking(0.004))
    assert kinds(bench)[:2] == [Kind.NOT_COMPENSATED, Kind.REFUSED_LIMIT]
    assert bench.last.events[0].values == {"moved": pytest.approx(1.0), "time": pytest.approx(2.0)}
    assert bench.last.law is Law.BRAKE


@pytest.mark.parametrize(("way", "held"), [(0.0099, False), (0.01, False), (math.nextafter(0.01, 1.0), True), (0.0101, True)])
def test_one_that_goes_too_far_is_held_at_once(way: float, held: bool) -> None:
    """10 mm from where its load was found beyond the limit."""
    bench = Bench(sequence__on=True, sequence__beyond_limit="balance")
    heavy = estimate(force=HEAVIER)
    bench.run(60, NOTHING, heavy)
    bench.run(501, HOLD, heavy)
    bench.step(LET_GO, sinking(way, HEAVIER))
    assert (Kind.NOT_COMPENSATED in kinds(bench)) is held
    assert (bench.last.law is Law.BRAKE) is held


@pytest.mark.parametrize("broken", [estimate(joints_valid=False), estimate(qd=math.nan)])
def test_without_its_joint_sensors_it_is_held_at_once(broken: Estimate) -> None:
    bench = balanced()
    bench.step(NOTHING, broken)
    assert kinds(bench)[-1] is Kind.REFUSED_SENSORS
    assert bench.last.balance is None


@pytest.mark.parametrize(
    ("command", "kind", "mode"),
    [
        (Command.LEAVE_FREE_DRIVE, Kind.DEACTIVATED, Mode.TEACH),
        (Command.NORMAL, Kind.REFUSED_MODE, Mode.NORMAL),
        (Command.EMERGENCY_STOP, Kind.EMERGENCY_STOP, Mode.STOP),
    ],
)
def test_what_ends_the_check_ends_this_too(command: Command, kind: Kind, mode: Mode) -> None:
    bench = balanced()
    bench.step(Inputs(commands=(command,)), sinking())
    assert kind in kinds(bench)
    assert (bench.last.mode, bench.last.phase, bench.last.balance) == (mode, Phase.OFF, None)


def test_a_protective_stop_comes_before_it() -> None:
    bench = balanced(sequence__beyond_limit="protective_stop")
    assert kinds(bench) == [Kind.ENTRY_PREVENTED, Kind.SEQUENCE_STOPPED]
    assert bench.last.safety is Safety.PROTECTIVE_STOP


def test_beyond_a_wall_it_is_balanced_as_well() -> None:
    """VW-6: 5 mm from where the check began; no other limit is on the way."""
    bench = Bench(sequence__on=True, sequence__beyond_limit="balance", limits__activation__flange_displacement__on=False)
    bench.run(60)
    bench.run(501, HOLD)
    bench.step(LET_GO, estimate(position=0.0051))
    assert kinds(bench) == [Kind.COMPENSATING]
    bench.run(150, NOTHING, estimate(position=0.0051))
    assert kinds(bench)[-1] is Kind.REFUSED_WALL


def test_it_is_told_from_every_other_state() -> None:
    bench = balanced()
    before = bench.supervisor.state
    bench.step(NOTHING, sinking())
    assert bench.supervisor.state != before
