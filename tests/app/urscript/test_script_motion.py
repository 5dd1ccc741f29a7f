"""Scripts move the arm: what the commands of the language do, from the text to the simulated joints."""

import numpy as np
import pytest

from pendant.events.event import Kind
from pendant.inputs import Command, Inputs
from pendant.tick.modes import Mode, Safety
from tests.app.robot_interface.robot_bench import RobotBench
from tests.app.urscript.script_bench import ScriptBench


def told(text: str, ticks: int = 4000, bench: ScriptBench | None = None) -> tuple[list[float], str]:
    """The numbers that a program tells, and the error that ends it."""
    lines, trouble = (bench or ScriptBench()).run("def prog():\n" + text + "\nend\n", ticks)
    return [float(line) for line in lines], trouble


def test_a_joint_motion_ends_where_it_should() -> None:
    (moved,), trouble = told(
        "q = get_target_joint_positions()\n a = q[0]\n q[0] = a + 0.2\n movej(q, a=1.4, v=1.0)\n"
        " sleep(0.3)\n x = get_actual_joint_positions()\n textmsg(x[0] - a)"
    )
    assert moved == pytest.approx(0.2, abs=5e-4)
    assert trouble == ""


@pytest.mark.parametrize(("blend", "least", "most"), [("", 0.0, 1e-6), (", r=0.02", 0.05, 0.101)])
def test_with_a_blend_radius_the_tool_does_not_stop_between_two_lines(blend: str, least: float, most: float) -> None:
    (speed, missed), _ = told(
        "p = get_target_tcp_pose()\n"
        f" movel(pose_trans(p, p[0.05,0,0,0,0,0]), a=1.2, v=0.1{blend})\n"
        " s = get_target_tcp_speed()\n textmsg(norm(s))\n"
        " movel(pose_trans(p, p[0.05,0.05,0,0,0,0]), a=1.2, v=0.1)\n"
        " textmsg(point_dist(get_target_tcp_pose(), pose_trans(p, p[0.05,0.05,0,0,0,0])))"
    )
    assert least <= speed <= most
    assert missed < 2e-4


def test_servo_commands_are_followed_the_look_ahead_later() -> None:
    """At 0.2 rad/s and 0.1 s of look-ahead the arm is 0.02 rad behind, and its reference two ticks less."""
    (behind, turned), trouble = told(
        "q = get_target_joint_positions()\n a = q[0]\n i = 0\n"
        " while i < 1000:\n  i = i + 1\n  q[0] = q[0] + 0.0004\n  servoj(q, t=0.002, lookahead_time=0.1, gain=300)\n end\n"
        " t = get_target_joint_positions()\n textmsg(q[0] - t[0])\n stopj(2.0)\n"
        " x = get_actual_joint_positions()\n textmsg(x[0] - a)"
    )
    assert behind == pytest.approx(0.0192, abs=3e-4)
    assert 0.38 < turned < 0.4
    assert trouble == ""


def test_a_servo_target_out_of_range_ends_the_script_with_its_place() -> None:
    _, trouble = told("while True:\n  servoj([9,0,0,0,0,0], t=0.002)\n end")
    assert trouble.startswith("line 3, ")
    assert trouble.endswith(": servoj: joint 1 would reach 9.0000 rad, allowed ±6.2832")


def test_a_speed_without_an_acceleration_stays_as_it_is() -> None:
    (before, after), trouble = told(
        "speedj([0.2,0,0,0,0,0], 1.0, 0.5)\n s = get_target_joint_speeds()\n textmsg(s[0])\n"
        " speedj([0.5,0,0,0,0,0], 0, 0.2)\n s = get_target_joint_speeds()\n textmsg(s[0])\n stopj(2.0)"
    )
    assert (before, after) == (pytest.approx(0.2), pytest.approx(0.2))
    assert trouble == ""


def test_a_tool_speed_is_held_for_its_time() -> None:
    (up, aside), _ = told(
        "p = get_target_tcp_pose()\n speedl([0,0,0.05,0,0,0], 0.5, 1.0)\n stopl(1.0)\n"
        " e = get_target_tcp_pose()\n textmsg(e[2] - p[2])\n textmsg(e[0] - p[0])"
    )
    assert up == pytest.approx(0.05 * (1.0 - 0.05) + 0.05**2 / 2, abs=0.003)
    assert abs(aside) < 1e-4


def test_a_joint_speed_that_nobody_renews_ends() -> None:
    (speed,), _ = told("speedj([0.2,0,0,0,0,0], 0.5, 0.1)\n sleep(1.0)\n s = get_target_joint_speeds()\n textmsg(s[0])")
    assert speed == 0.0


def test_a_circle_ends_where_it_should() -> None:
    (missed,), trouble = told(
        "p = get_target_tcp_pose()\n"
        " movec(pose_trans(p, p[0.05,0.05,0,0,0,0]), pose_trans(p, p[0.1,0,0,0,0,0]), a=1.0, v=0.1, mode=1)\n"
        " textmsg(point_dist(get_target_tcp_pose(), pose_trans(p, p[0.1,0,0,0,0,0])))"
    )
    assert missed < 3e-4
    assert trouble == ""


def begun(text: str, **robot: float) -> ScriptBench:
    """A script runs on a robot that is so."""
    bench = ScriptBench()
    if robot:
        bench.robot = RobotBench(**robot)  # type: ignore[arg-type]
        bench.runner = type(bench.runner)(bench.robot.cabinet)
        bench.robot.step(150)
    bench.runner.offer("def prog():\n" + text + "\nend\n")
    return bench


GUIDED = " freedrive_mode()\n sleep(60)\n end_freedrive_mode()"


def test_a_script_frees_the_arm_through_the_whole_activation() -> None:
    bench = begun(GUIDED)
    modes = []
    for _ in range(1500):
        modes.append(bench.robot.step().mode)
        if modes[-1] is Mode.FREE_DRIVE:
            break
    kinds = [event.kind for event in bench.robot.watcher.events]
    assert modes[-1] is Mode.FREE_DRIVE
    assert kinds.index(Kind.SEQUENCE_STARTED) < kinds.index(Kind.ENTERED)
    bench.runner.stop()
    bench.robot.step(10)
    assert bench.robot.step().mode is not Mode.FREE_DRIVE


def test_who_is_guided_by_hand_and_asks_again_goes_on_so() -> None:
    bench = begun(" while True:\n  freedrive_mode()\n  sleep(0.004)\n end")
    assert any(bench.robot.step().mode is Mode.FREE_DRIVE for _ in range(1500))
    bench.robot.step(100)
    kinds = [event.kind for event in bench.robot.watcher.events]
    assert bench.robot.step().mode is Mode.FREE_DRIVE
    assert kinds.count(Kind.SIGNAL_SEEN) == 1
    assert Kind.DEACTIVATED not in kinds


def test_the_sensor_is_zeroed_as_soon_as_the_arm_has_stood_after_a_motion() -> None:
    bench = begun(" q = get_target_joint_positions()\n q[0] = q[0] + 0.1\n movej(q)\n zero_ftsensor()\n sleep(5)")
    bench.robot.step(1500)
    kinds = [event.kind for event in bench.robot.watcher.events]
    assert Kind.SENSOR_ZEROED in kinds
    assert Kind.ZERO_REFUSED not in kinds


def test_forces_are_zeroed_at_once_also_where_the_sensor_cannot_be() -> None:
    bench = begun(" zero_ftsensor()\n while True:\n  speedj([0.02,0,0,0,0,0], 0.5, 0.5)\n end")
    bench.robot.step(5000)
    kinds = [event.kind for event in bench.robot.watcher.events]
    assert kinds.count(Kind.READING_ZEROED) == 1
    assert not {Kind.SENSOR_ZEROED, Kind.ZERO_REFUSED} & set(kinds)


def test_the_sensor_is_not_zeroed_while_a_script_pushes() -> None:
    push = " force_mode(p[0,0,0,0,0,0], [0,0,1,0,0,0], [0,0,0,0,0,0], 2, [0.1,0.1,0.1,0.2,0.2,0.2])\n"
    bench = begun(f" sleep(1)\n{push} sleep(1)\n zero_ftsensor()\n sleep(6)")
    bench.robot.step(4500)
    kinds = [event.kind for event in bench.robot.watcher.events]
    assert Kind.READING_ZEROED in kinds
    assert not {Kind.SENSOR_ZEROED, Kind.ZERO_REFUSED} & set(kinds)


def test_poses_can_be_followed_in_every_tick() -> None:
    """A search for joint angles next to those that the arm has fits into a tick, with what else a client's program does."""
    (searches,), trouble = told(
        "x = get_target_tcp_pose()\n n = 0\n"
        " while n < 200:\n  n = n + 1\n  x[2] = x[2] + 0.0001\n"
        "  servoj(get_inverse_kin(x, get_target_joint_positions()), t=0.002)\n end\n textmsg(n)",
        ticks=210,
    )
    assert searches == 200
    assert trouble == ""


def test_a_payload_that_nobody_told_of_is_refused_to_a_script_too() -> None:
    bench = begun(GUIDED, true=2.0)
    for _ in range(1500):
        assert bench.robot.step().mode is not Mode.FREE_DRIVE
    assert any(event.kind.value.startswith("refused_") for event in bench.robot.watcher.events)


@pytest.mark.parametrize("command", [Command.EMERGENCY_STOP, Command.SAFEGUARD_OPEN])
def test_a_stop_ends_the_motion_of_a_script(command: Command) -> None:
    bench = begun(" while True:\n  speedj([0.2,0,0,0,0,0], 0.5, 0.5)\n end")
    bench.robot.step(300)
    bench.robot.step(1, Inputs(commands=(command,)))
    assert bench.robot.step().mode is Mode.STOP
    bench.robot.step(600)
    assert bench.state is None or bench.robot.step().mode is Mode.STOP
    assert abs(bench.robot.simulation.plant.qd).max() < 1e-3


def test_a_script_may_ask_for_a_protective_stop() -> None:
    bench = begun(" speedj([0.2,0,0,0,0,0], 0.5, 0.5)\n protective_stop()\n sleep(5)")
    bench.robot.step(600)
    decision = bench.robot.step()
    assert (decision.mode, decision.safety) == (Mode.STOP, Safety.PROTECTIVE_STOP)
    assert bench.state is None
    assert [event.kind for event in bench.robot.watcher.events].count(Kind.PROTECTIVE_STOP) == 1


THREADS = """thread goes():
  while True:
    speedj([0.1,0,0,0,0,0], 0.5, 0.02)
  end
end
h = run goes()
sleep(0.3)
{then}
movej(get_target_joint_positions(), a=1.0, v=1.0)
textmsg(1)"""


def test_two_threads_do_not_move_the_arm_at_once() -> None:
    _, trouble = told(THREADS.format(then="sync()"))
    assert trouble.endswith("another thread is controlling the robot")
    assert told(THREADS.format(then="kill h")) == ([1.0], "")


PROCESS = """ p = get_target_tcp_pose()
 movep(pose_trans(p, p[0.08,0,0,0,0,0]), a=1.2, v=0.1, r={r})
 movep(pose_trans(p, p[0.08,0.08,0,0,0,0]), a=1.2, v=0.1, r={r})
 movep(pose_trans(p, p[0,0.08,0,0,0,0]), a=1.2, v=0.1, r={r})
 {last}(p, a=1.2, v=0.1)
 textmsg(point_dist(get_target_tcp_pose(), p))"""


@pytest.mark.parametrize(("last", "r", "slowest"), [("movep", 0.02, 0.098), ("movel", 0.02, 0.01), ("movep", 0.0, 0.0)])
def test_lines_of_a_process_are_gone_at_one_speed(last: str, r: float, slowest: float) -> None:
    """From script to reference: three corners of a square of 80 mm; the last line is left out where another kind of motion is."""
    bench = begun(PROCESS.format(last=last, r=r))
    speeds = []
    bench.robot.step()
    while bench.state is not None:
        bench.robot.step()
        speeds.append(float(np.linalg.norm(bench.robot.cabinet.record.field("target_TCP_speed")[:3])))
        assert len(speeds) < 4000
    moving = [k for k, speed in enumerate(speeds) if speed > 0.05]
    whole = speeds[moving[0] + 50 : moving[-1] - 50]
    assert bench.runner.trouble is None
    assert float(bench.runner.told[-2].text) < 2e-4
    assert max(whole) < 0.102
    assert min(whole) == pytest.approx(0.0, abs=1e-3) if slowest == 0.0 else min(whole) > slowest
