"""REDUCED: an input, a time to slow down in, then limits of tool, elbow and joints."""

import math

import pytest

from pendant.events.event import Event, Kind
from pendant.inputs import NOTHING, Command, Inputs
from pendant.robot.reduced import SpeedLimits
from pendant.tick.estimate import Estimate
from pendant.tick.modes import Law, Mode, Safety
from tests.pendant.estimates import estimate
from tests.pendant.freedrive.test_state_machine import LET_GO, Bench

ON, OFF = Inputs(commands=(Command.REDUCED_ON,)), Inputs(commands=(Command.REDUCED_OFF,))


def reduced_bench(**changes: float | bool) -> Bench:
    bench = Bench(**changes).entered()
    bench.events.clear()
    bench.step(ON)
    return bench


def test_the_input_is_a_safety_mode_with_limits() -> None:
    bench = reduced_bench()
    assert bench.last.safety is Safety.REDUCED
    assert bench.last.speed_limits == SpeedLimits(0.25, 0.25, 1.0)
    assert bench.events == [Event(Kind.REDUCED_ON, bench.tick, {"tcp": 0.25, "elbow": 0.25, "joint_speed": 1.0})]
    assert bench.step(ON).events == ()
    bench.step(OFF)
    assert bench.last.safety is Safety.NORMAL
    assert bench.last.speed_limits is None
    assert bench.last.events == (Event(Kind.REDUCED_OFF, bench.tick, {}),)
    assert bench.step(OFF).events == ()
    assert bench.step(Inputs(commands=(Command.REDUCED_OFF, Command.REDUCED_ON))).safety is Safety.REDUCED


def test_the_arm_has_half_a_second_to_slow_down() -> None:
    """UR5e user manual, 8.2.1: within limits in 0.5 s after the trigger, else stop category 0."""
    bench = reduced_bench()
    fast = estimate(qd=0.5, v_tcp=0.4)
    bench.run(249, NOTHING, fast)
    assert bench.last.mode is Mode.FREE_DRIVE
    bench.step(NOTHING, fast)
    assert (bench.last.mode, bench.last.safety, bench.last.law) == (Mode.STOP, Safety.PROTECTIVE_STOP, Law.OFF)


@pytest.mark.parametrize(
    ("fast", "parameter", "part", "value", "limit"),
    [
        (estimate(v_tcp=0.251), "tcp speed", "tcp", 0.251, 0.25),
        (estimate(v_elbow=0.251), "elbow speed", "elbow", 0.251, 0.25),
        (estimate(qd=[0.0, 0.0, -1.01, 0.0, 0.0, 0.0]), "joint speed", "elbow", 1.01, 1.0),
    ],
)
def test_beyond_a_limit_is_a_protective_stop_of_category_0(
    fast: Estimate, parameter: str, part: str, value: float, limit: float
) -> None:
    bench = reduced_bench()
    at = estimate(qd=[0.0, 0.0, 1.0, 0.0, 0.0, 0.0], v_tcp=0.25, v_elbow=0.25)
    bench.run(300, NOTHING, at)
    assert bench.last.mode is Mode.FREE_DRIVE
    bench.step(NOTHING, fast)
    unit = "rad/s" if parameter == "joint speed" else "m/s"
    values = {"parameter": parameter, "part": part, "value": value, "limit": limit, "unit": unit}
    assert bench.last.events == (Event(Kind.REDUCED_EXCEEDED, bench.tick, values),)
    assert bench.last.law is Law.OFF
    bench.step(LET_GO)
    bench.run(100)
    bench.step(Inputs(commands=(Command.RESET,)))
    assert (bench.last.mode, bench.last.safety) == (Mode.TEACH, Safety.REDUCED)


def test_what_is_not_a_number_is_too_fast() -> None:
    bench = reduced_bench()
    bench.run(300)
    bench.step(NOTHING, estimate(v_tcp=math.nan))
    assert bench.last.mode is Mode.STOP


def test_with_its_switch_off_it_has_no_limits() -> None:
    bench = reduced_bench(reduced__on=False)
    assert (bench.last.safety, bench.last.speed_limits) == (Safety.REDUCED, None)
    bench.run(400, NOTHING, estimate(v_tcp=0.9))
    assert bench.last.mode is Mode.FREE_DRIVE


def test_the_limits_checksum_is_on_every_decision() -> None:
    bench = Bench()
    first = bench.step().limits
    assert len(first) == 8
    bench.step(Inputs(settings={"free_drive.period": 5.0}))
    assert bench.step().limits == first
    bench.step(Inputs(settings={"reduced.joint_speed": 0.5}))
    assert bench.step().limits != first
