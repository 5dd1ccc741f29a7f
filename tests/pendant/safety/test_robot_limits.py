"""The robot's limits: REDUCED with its time to slow down in, what holds, and the stop beyond it (RL-4 to RL-6)."""

import math

import numpy as np
import pytest

from pendant.all_settings import Settings, apply
from pendant.events.event import Event, Kind
from pendant.inputs import NOTHING, Command, Inputs
from pendant.program.jog_move import JogMove
from pendant.program.steps import HandGuide, Program
from pendant.safety import robot_limits as limits_module
from pendant.safety.robot_limits import (
    ABOVE_RATED,
    JOINT_SPEED_TOLERANCE,
    POSITION_TOLERANCE,
    ArmRating,
    JointRange,
    SpeedLimits,
    robot_limits,
)
from pendant.safety.settings import FASTEST, FURTHEST
from pendant.supervisor import Supervisor
from pendant.tick.estimate import Estimate, MotionMeasures
from pendant.tick.modes import Law, Mode, Safety
from tests.pendant.estimates import estimate
from tests.pendant.freedrive.test_state_machine import JOINTS, LET_GO, Bench

ON, OFF = Inputs(commands=(Command.REDUCED_ON,)), Inputs(commands=(Command.REDUCED_OFF,))
RESET = Inputs(commands=(Command.RESET,))
NORMAL = SpeedLimits(1.5, 1.5, (6.4832,) * 6, 25.0, 0.4, 0.5)
REDUCED = SpeedLimits(0.75, 0.75, (6.4832,) * 6, 10.0, 0.3, 0.3)
ARM = ArmRating(JOINTS, ((-6.28, 6.28),) * 6, (3.14,) * 6)


def measured(**motion: float) -> Estimate:
    seen = estimate()
    seen.motion = MotionMeasures(**motion)
    return seen


def at(*q: float) -> Estimate:
    return estimate(q=[*q, *[0.0] * (6 - len(q))])


def reduced_bench(**changes: float | bool) -> Bench:
    bench = Bench(**changes).entered()
    bench.events.clear()
    bench.step(ON)
    return bench


def limits(reduced: bool = False, **changes: float) -> limits_module.RobotLimits:
    names = {f"robot_limits.{name.replace('__', '.')}": value for name, value in changes.items()}
    return robot_limits(apply(Settings(), names).robot_limits, ARM, reduced=reduced)


def test_what_holds_in_both_modes_as_shipped() -> None:
    normal, reduced = limits(), limits(reduced=True)
    assert (normal.mode, normal.speeds, normal.power, normal.forces) == (Safety.NORMAL, NORMAL, 300.0, (150.0, 150.0))
    assert (reduced.mode, reduced.speeds, reduced.power, reduced.forces) == (Safety.REDUCED, REDUCED, 200.0, (120.0, 120.0))
    assert normal.joint_speeds == pytest.approx([3.14 + ABOVE_RATED] * 6)
    assert normal.joint_range is None


def test_reduced_is_never_wider_than_normal() -> None:
    narrow = limits(reduced=True, normal__tool_speed=0.3, normal__momentum=5.0, normal__elbow_force=60.0, normal__power=20.0)
    assert narrow.speeds == REDUCED._replace(tcp=20.0 / 120.0, momentum=5.0)
    assert (narrow.power, narrow.forces) == (20.0, (120.0, 60.0))


def test_power_bounds_the_speed_of_a_tool_that_presses_as_it_may() -> None:
    """P = F v."""
    assert limits(normal__power=75.0).speeds.tcp == pytest.approx(75.0 / 150.0)
    assert limits(normal__power=75.0, normal__tool_force=50.0).speeds.tcp == pytest.approx(1.5)


def test_a_joint_is_as_fast_as_its_own_limit_and_never_much_faster_than_it_is_made_for() -> None:
    changes = {"normal__joint_speeds__j1": 1.0, "normal__joint_speeds__j6": 2.0, "reduced__joint_speeds__j6": 0.5}
    normal, reduced = limits(**changes), limits(reduced=True, **changes)
    assert normal.speeds.joints == (1.0, *[FASTEST] * 4, 2.0)
    rated = 3.14 + ABOVE_RATED
    assert normal.joint_speeds == pytest.approx([1.0 + JOINT_SPEED_TOLERANCE, *[rated] * 4, 2.0 + JOINT_SPEED_TOLERANCE])
    assert reduced.joint_speeds == pytest.approx([1.0 + JOINT_SPEED_TOLERANCE, *[rated] * 4, 0.5 + JOINT_SPEED_TOLERANCE])


def test_the_limits_that_ship_leave_each_arm_what_its_maker_configures() -> None:
    """Within half a degree a second: the configuration of a UR5e has 3.3416, that of a UR10e 2.2864 twice, then 3.3416."""
    for rated, wanted in (((3.1416,) * 6, [3.3416] * 6), ((2.0944, 2.0944, *[3.1416] * 4), [2.2864, 2.2864, *[3.3416] * 4])):
        held = robot_limits(Settings().robot_limits, ARM._replace(speeds=rated), reduced=False)
        assert held.joint_speeds == pytest.approx(wanted, abs=0.01)


def test_the_range_of_a_joint_is_what_both_leave_of_its_own() -> None:
    normal = {"normal__positions__j1_max": 1.0, "normal__positions__j3_min": -0.5, "reduced__positions__j1_max": 0.5}
    assert limits(**normal).joint_range == JointRange((-6.28, -6.28, -0.5, *[-6.28] * 3), (1.0, *[6.28] * 5))
    assert limits(reduced=True, **normal).joint_range == JointRange((-6.28, -6.28, -0.5, *[-6.28] * 3), (0.5, *[6.28] * 5))
    endless = robot_limits(Settings().robot_limits, ARM._replace(ranges=((-math.inf, math.inf),) * 6), reduced=False)
    assert endless.joint_range is None
    assert pytest.approx(math.radians(363), abs=1e-3) == FURTHEST


def test_the_input_is_a_safety_mode_with_limits() -> None:
    bench = reduced_bench()
    assert (bench.last.safety, bench.last.speed_limits) == (Safety.REDUCED, REDUCED)
    assert bench.events == [
        Event(Kind.REDUCED_ON, bench.tick, {"cause": "the input", "tcp": 0.75, "elbow": 0.75, "joint_speed": 6.4832})
    ]
    assert bench.step(ON).events == ()
    bench.step(OFF)
    assert (bench.last.safety, bench.last.speed_limits) == (Safety.NORMAL, NORMAL)
    assert bench.last.events == (Event(Kind.REDUCED_OFF, bench.tick, {}),)
    assert bench.step(OFF).events == ()
    assert bench.step(Inputs(commands=(Command.REDUCED_OFF, Command.REDUCED_ON))).safety is Safety.REDUCED


def test_the_arm_has_half_a_second_to_slow_down() -> None:
    """UR5e user manual, 8.2.1: within limits in 0.5 s after the trigger."""
    bench = reduced_bench()
    fast = estimate(qd=0.5, v_tcp=0.9)
    bench.run(249, NOTHING, fast)
    assert bench.last.mode is Mode.FREE_DRIVE
    bench.step(NOTHING, fast)
    assert (bench.last.mode, bench.last.safety, bench.last.law) == (Mode.STOP, Safety.PROTECTIVE_STOP, Law.BRAKE)


def test_who_leaves_reduced_in_its_first_half_second_is_watched_at_once() -> None:
    bench = reduced_bench()
    bench.step(OFF)
    bench.step(NOTHING, estimate(v_tcp=1.6))
    assert bench.last.mode is Mode.STOP


EXCEEDED = [
    (estimate(v_tcp=1.56), "tool speed", "tool", 1.56, 1.5, "m/s"),
    (estimate(v_elbow=1.56), "elbow speed", "elbow", 1.56, 1.5, "m/s"),
    (estimate(qd=[0.0, 0.0, -6.6, 0.0, 0.0, 0.0]), "joint speed", "elbow", 6.6, 6.4832, "rad/s"),
    (measured(momentum=28.1), "momentum", "arm", 28.1, 25.0, "kg·m/s"),
    (measured(power=311.0), "power", "tool", 311.0, 300.0, "W"),
]


@pytest.mark.parametrize(("over", "parameter", "part", "value", "limit", "unit"), EXCEEDED)
@pytest.mark.parametrize("free", [False, True])
def test_beyond_a_limit_and_its_tolerance_is_a_protective_stop_of_category_2(
    over: Estimate, parameter: str, part: str, value: float, limit: float, unit: str, free: bool
) -> None:
    bench = Bench().entered() if free else Bench()
    at_most = estimate(qd=[0.0, 0.0, 6.48, 0.0, 0.0, 0.0], v_tcp=1.549, v_elbow=1.549)
    at_most.motion = MotionMeasures(27.9, 309.0, 9.0, 9.0)  # who stands or is guided needs not be able to stop
    if not free:  # free-drive has limits of its own, which are lower
        bench.run(300, NOTHING, at_most)
        assert bench.last.mode is Mode.TEACH
    bench.events.clear()
    bench.step(NOTHING, over)
    values = {"parameter": parameter, "part": part, "value": value, "limit": pytest.approx(limit), "unit": unit}
    assert bench.events[0] == Event(Kind.LIMIT_EXCEEDED, bench.tick, {**values, "mode": "NORMAL", "position": False})
    assert (bench.last.mode, bench.last.law) == (Mode.STOP, Law.BRAKE)
    bench.step(LET_GO)
    bench.run(100)
    bench.step(RESET)
    assert (bench.last.mode, bench.last.safety) == (Mode.TEACH, Safety.NORMAL)


@pytest.mark.parametrize(
    ("name", "below", "above", "limit"),
    [("stopping_time", 0.449, 0.451, 0.4), ("stopping_distance", 0.539, 0.541, 0.5)],
)
def test_an_arm_that_follows_a_motion_must_be_able_to_stop(name: str, below: float, above: float, limit: float) -> None:
    bench = Bench()
    bench.run(60)
    jog = Inputs(jog=JogMove(id=-1, frame="joint", axis=0, sign=1, length=0.0))
    bench.run(5, jog, measured(**{name: below}))
    assert bench.last.law is Law.FOLLOW
    bench.step(jog, measured(**{name: above}))
    assert bench.last.mode is Mode.STOP
    event = next(event for event in bench.last.events if event.kind is Kind.LIMIT_EXCEEDED)
    assert (event.values["parameter"], event.values["limit"]) == (name.replace("_", " "), limit)


@pytest.mark.parametrize("over", [estimate(v_tcp=math.nan), estimate(v_elbow=math.nan), measured(momentum=math.nan)])
def test_what_is_not_a_number_exceeds_its_limit(over: Estimate) -> None:
    assert Bench().step(NOTHING, over).mode is Mode.STOP


def test_without_a_wrench_nothing_is_known_of_the_power() -> None:
    seen = measured(power=math.nan)
    seen.wrench_valid = False
    assert Bench().step(NOTHING, seen).mode is Mode.TEACH


def test_switched_off_there_are_no_limits() -> None:
    bench = reduced_bench(robot_limits__on=False)
    assert (bench.last.safety, bench.last.speed_limits, bench.last.joint_range) == (Safety.REDUCED, None, None)
    bench.run(400, NOTHING, estimate(v_tcp=0.95))
    assert bench.last.mode is Mode.FREE_DRIVE


def test_the_safety_checksum_is_on_every_decision() -> None:
    bench = Bench()
    first = bench.step().limits
    assert len(first) == 8
    bench.step(Inputs(settings={"program.speed": 0.5}))
    assert bench.step().limits == first
    bench.step(Inputs(settings={"robot_limits.reduced.joint_speeds.j4": 0.5}))
    assert bench.step().limits != first


@pytest.mark.parametrize(("reduced", "limit"), [(False, 150.0), (True, 120.0)])
@pytest.mark.parametrize("share", [0.95, 1.05])
def test_the_force_of_a_standing_arm_is_that_of_the_safety_mode(reduced: bool, limit: float, share: float) -> None:
    bench = Bench()
    bench.step(ON if reduced else OFF)
    felt = estimate(force=[share * limit, 0.0, 0.0])
    bench.step(NOTHING, felt)
    assert (bench.last.mode is Mode.STOP) == (share > 1.0)


def positions(**changes: float) -> Bench:
    """Joint 1 within ±1 rad in NORMAL, ±0.5 rad in REDUCED."""
    ends = {"normal.positions.j1_min": -1.0, "normal.positions.j1_max": 1.0, "reduced.positions.j1_max": 0.5}
    bench = Bench()
    settings = apply(Settings(), {f"robot_limits.{name}": value for name, value in ends.items()})
    bench.supervisor = Supervisor(settings, 6, joints=JOINTS, ranges=((-6.28, 6.28),) * 6)
    return bench


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_joint_outside_its_limits_by_the_tolerance_is_stopped(sign: float) -> None:
    bench = positions()
    bench.run(60)
    assert bench.last.joint_range == JointRange((-1.0, *[-6.28] * 5), (1.0, *[6.28] * 5))
    inside, outside = sign * (1.0 + 0.99 * POSITION_TOLERANCE), sign * (1.0 + 1.01 * POSITION_TOLERANCE)
    assert bench.step(NOTHING, at(inside)).mode is Mode.TEACH
    bench.step(NOTHING, at(outside))
    assert bench.last.mode is Mode.STOP
    event = bench.last.events[0]
    assert event.kind is Kind.LIMIT_EXCEEDED
    assert {**event.values, "value": 0.0} == {
        "parameter": "joint position", "part": JOINTS[0], "value": 0.0, "unit": "°", "mode": "NORMAL", "position": True,
        "limit": pytest.approx(sign * math.degrees(1.0)),
    }  # fmt: skip
    assert event.values["value"] == pytest.approx(math.degrees(outside))


def test_a_joint_that_was_stopped_outside_may_come_back_and_not_go_out_again() -> None:
    bench = positions()
    bench.run(60)
    bench.run(200, NOTHING, at(1.3))
    assert bench.last.mode is Mode.STOP
    assert bench.step(RESET, at(1.3)).mode is Mode.TEACH
    for q in (1.305, 1.25, 1.2):
        assert bench.run(10, NOTHING, at(q)).mode is Mode.TEACH
    assert bench.step(NOTHING, at(1.215)).mode is Mode.STOP


def test_reduced_has_joint_positions_of_its_own() -> None:
    bench = positions()
    bench.run(60, NOTHING, at(0.8))
    bench.step(ON, at(0.8))
    assert bench.last.joint_range == JointRange((-1.0, *[-6.28] * 5), (0.5, *[6.28] * 5))
    assert bench.run(249, NOTHING, at(0.8)).mode is Mode.TEACH
    assert bench.run(20, NOTHING, at(0.8)).mode is Mode.STOP
    bench.run(60, NOTHING, at(0.8))
    assert bench.step(RESET, at(0.8)).mode is Mode.TEACH
    assert bench.run(300, NOTHING, at(0.8)).mode is Mode.TEACH


def test_an_angle_that_is_not_a_number_is_told_by_others() -> None:
    bench = positions()
    bench.run(60)
    assert Kind.LIMIT_EXCEEDED not in [event.kind for event in bench.step(NOTHING, at(np.nan)).events]


def test_while_the_arm_slows_down_for_reduced_the_limits_of_normal_hold() -> None:
    bench = Bench()
    bench.step(ON)
    bench.run(10, NOTHING, estimate(v_tcp=1.4))
    assert bench.last.mode is Mode.TEACH, "more than REDUCED allows, for it has just begun"
    bench.events.clear()
    bench.step(NOTHING, estimate(v_tcp=1.56))
    assert bench.last.mode is Mode.STOP
    assert bench.events[0].values["mode"] == "NORMAL"


def test_a_stop_ends_the_time_to_slow_down_in() -> None:
    bench = Bench()
    bench.step(ON)
    bench.step(Inputs(commands=(Command.PROTECTIVE_STOP,)))
    bench.step(LET_GO)
    bench.run(100)
    bench.step(RESET)
    assert bench.step(NOTHING, estimate(v_tcp=0.9)).mode is Mode.STOP


@pytest.mark.parametrize("before", [{}, {"robot_limits.normal.positions.j6_max": 3.0}])
def test_a_joint_that_is_outside_of_new_limits_may_be_led_back_whatever_held_before(before: dict[str, float]) -> None:
    bench = Bench(**before)
    bench.run(20, NOTHING, at(1.0))
    bench.step(Inputs(settings={"robot_limits.normal.positions.j1_max": 0.5}), at(1.0))
    assert bench.run(20, NOTHING, at(1.0)).mode is Mode.TEACH
    assert bench.step(NOTHING, at(1.1)).mode is Mode.STOP, "not further out"


@pytest.mark.parametrize("before", [{}, {"robot_limits.normal.positions.j6_max": 3.0}])
def test_a_joint_that_reduced_finds_outside_is_stopped_whatever_held_before(before: dict[str, float]) -> None:
    bench = Bench(**before, **{"robot_limits.reduced.positions.j1_max": 0.5})
    bench.run(20, NOTHING, at(1.0))
    bench.step(ON, at(1.0))
    assert bench.run(249, NOTHING, at(1.0)).mode is Mode.TEACH
    assert bench.run(2, NOTHING, at(1.0)).mode is Mode.STOP
    bench.run(100, LET_GO, at(1.0))
    bench.step(RESET, at(1.0))
    assert bench.run(20, NOTHING, at(1.0)).mode is Mode.TEACH, "it may be led back"
    assert bench.step(NOTHING, at(1.1)).mode is Mode.STOP, "and not further out"


def test_an_arm_that_a_program_has_guided_needs_not_be_able_to_stop_by_itself() -> None:
    """As one that is freed by the button: a hand moves it."""
    bench = Bench()
    bench.run(60)
    bench.step(Inputs(program=Program(steps=(HandGuide(),))))
    bench.run(300)
    bench.step(Inputs(commands=(Command.START_PROGRAM,)))
    for _ in range(2000):
        if bench.step().mode is Mode.FREE_DRIVE:
            break
    assert bench.last.mode is Mode.FREE_DRIVE
    bench.run(3, NOTHING, measured(stopping_time=0.9, stopping_distance=0.9))
    assert bench.last.mode is Mode.FREE_DRIVE
