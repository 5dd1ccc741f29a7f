"""Paths with an offset, and conveyors: the tool is where the language's documents say, on the way too."""

import math

import pytest

from app.urscript.calculation.pose_algebra import distance, inverted, transformed
from app.urscript.machine.values import PoseValue
from app.urscript.running.told import Telling
from pendant.tick.modes import TICK_RATE
from tests.app.urscript.script_bench import ScriptBench

BELT = """
  encoder_enable_set_tick_count(0, {range})
  global n = {first}
  thread belt():
    while True:
      n = (n + {step}) % {many}
      encoder_set_tick_count(0, n)
      sync()
    end
  end
  h = run belt()
  sleep(0.2)
"""
BETTER = 0.5e-3
"""What is left of an offset that is followed [m]: a tick's way at 0.25 m/s."""


@pytest.fixture(scope="module")
def bench() -> ScriptBench:
    return ScriptBench()


def told(bench: ScriptBench, body: str, ticks: int = 4000) -> list[str]:
    lines, trouble = bench.run(f"def p():\n  movej([0.2, -1.4, 1.7, -1.87, -1.57, 0], v=3, a=8)\n{body}\nend", ticks)
    assert trouble == ""
    return lines


def numbers(line: str) -> list[float]:
    return [float(word) for word in line[line.index("[") + 1 : -1].split(",")]


def test_an_offset_counts_in_its_frame(bench: ScriptBench) -> None:
    """1 base, 2 tool, 4 base inverted; it is the same pose whatever frame it is asked in."""
    offset = "p[0.02, -0.01, 0.03, 0.05, 0.1, -0.2]"
    lines = told(
        bench,
        "  textmsg(get_target_tcp_pose())\n  path_offset_enable()\n  path_offset_set_alpha_filter(0.05)\n"
        + "".join(
            f"  path_offset_set({offset}, {kind})\n  sleep(0.6)\n  textmsg(get_target_tcp_pose())\n"
            f"  textmsg(path_offset_get(1))\n  textmsg(path_offset_get(2))\n  textmsg(path_offset_get(4))\n"
            for kind in (1, 2, 4)
        )
        + "  path_offset_disable()",
    )
    begin = PoseValue(numbers(lines[0]))
    given = PoseValue(numbers(offset))
    wanted = (transformed(given, begin), transformed(begin, given), transformed(inverted(given), begin))
    for k, goal in enumerate(wanted):
        there, in_base, in_tool, inverse = (PoseValue(numbers(line)) for line in lines[1 + 4 * k : 5 + 4 * k])
        assert distance(there, goal) < BETTER
        assert distance(transformed(in_base, begin), goal) < BETTER
        assert distance(transformed(begin, in_tool), goal) < BETTER
        assert distance(transformed(inverted(inverse), begin), goal) < BETTER


def test_an_offset_goes_with_the_way_and_its_limit_holds(bench: ScriptBench) -> None:
    """x along the way, y = x × the tool's z: a tool that points down and goes along -y of the base has its y along x."""
    lines = told(
        bench,
        "  p0 = get_target_tcp_pose()\n  path_offset_set_alpha_filter(0.05)\n  path_offset_enable()\n"
        "  path_offset_set_max_offset(0.03, 0.3)\n  path_offset_set(p[0, 0.2, 0, 0, 0, 0], 3)\n"
        "  thread look():\n    sleep(0.8)\n    textmsg(pose_sub(get_target_tcp_pose(), get_target_tcp_pose_along_path()))\n"
        "    textmsg(get_target_tcp_speed_along_path())\n    textmsg(path_offset_get(3))\n  end\n  h = run look()\n"
        "  movel(pose_add(p0, p[0, -0.2, 0, 0, 0, 0]), a=1, v=0.15)\n  textmsg(pose_sub(get_target_tcp_pose_along_path(), p0))\n"
        "  path_offset_disable()",
    )
    apart, speed, asked, way = (numbers(line) for line in lines)
    assert apart[:3] == pytest.approx([0.03, 0.0, 0.0], abs=BETTER)  # (0, -1, 0) × (0, 0, -1)
    assert speed[:3] == pytest.approx([0.0, -0.15, 0.0], abs=1e-3)
    assert asked[:3] == pytest.approx([0.0, 0.03, 0.0], abs=BETTER)
    assert way[:3] == pytest.approx([0.0, -0.2, 0.0], abs=BETTER)


@pytest.mark.parametrize(("first", "range_", "many"), [(0, 0, 1 << 31), (200, 1, 1 << 8)], ids=["wide", "8 bits"])
def test_a_linear_conveyor_is_followed_while_the_arm_moves(bench: ScriptBench, first: int, range_: int, many: int) -> None:
    lines = told(
        bench,
        BELT.format(range=range_, first=first, step=2, many=many)
        + "  p0 = get_target_tcp_pose()\n  t0 = time(0)\n  track_conveyor_linear(p[0, 2, 0, 0, 0, 0], 8000)\n"
        "  movel(pose_add(p0, p[0, 0, -0.1, 0, 0, 0]), a=1, v=0.2)\n  sleep(0.2)\n"
        "  textmsg(pose_sub(get_target_tcp_pose(), p0))\n  t1 = time(0)\n  textmsg(get_target_tcp_speed())\n"
        "  textmsg(pose_sub(get_target_tcp_pose_along_path(), p0))\n"
        "  textmsg([t1.sec - t0.sec + (t1.nanosec - t0.nanosec) / 1e9, 0])\n  stop_conveyor_tracking(4)\n"
        "  movel(p0, a=1, v=0.5)\n  textmsg(pose_sub(get_target_tcp_pose(), p0))",
    )
    way, speed, along, (seconds, _), back = (numbers(line) for line in lines)
    assert way[:3] == pytest.approx([0.0, 2 * TICK_RATE / 8000 * seconds, -0.1], abs=2 * BETTER)
    assert speed[:3] == pytest.approx([0.0, 2 * TICK_RATE / 8000, 0.0], abs=1e-3)
    assert along[:3] == pytest.approx([0.0, 0.0, -0.1], abs=BETTER)
    assert back[:3] == pytest.approx([0.0, 0.0, 0.0], abs=BETTER)


@pytest.mark.parametrize("turns", [True, False])
def test_a_circular_conveyor_turns_about_its_centre(bench: ScriptBench, turns: bool) -> None:
    lines = told(
        bench,
        BELT.format(range=0, first=3500, step=2, many=3600) + "  p0 = get_target_tcp_pose()\n  textmsg(p0)\n"
        f"  track_conveyor_circular(p[-0.4, -0.3, 0, 0, 0, 0], 3600, {turns})\n  n0 = n\n  sleep(0.5)\n"
        "  textmsg(get_target_tcp_pose())\n  textmsg([(n - n0 + 3600) % 3600, 0])\n  stop_conveyor_tracking()",
    )
    begin, there, (ticks, _) = PoseValue(numbers(lines[0])), PoseValue(numbers(lines[1])), numbers(lines[2])
    centre = PoseValue((-0.4, -0.3, 0.0, 0.0, 0.0, 0.0))
    turn = PoseValue((0.0, 0.0, 0.0, 0.0, 0.0, 2.0 * math.pi * ticks / 3600))
    goal = transformed(transformed(transformed(centre, turn), inverted(centre)), begin)
    assert there[:3] == pytest.approx(goal[:3], abs=4 * BETTER)
    assert distance(there, PoseValue((*there[:3], *(goal if turns else begin)[3:]))) < 0.02


def test_a_paused_arm_goes_on_with_the_conveyor_where_it_stood(bench: ScriptBench) -> None:
    runner, robot = bench.runner, bench.robot
    runner.offer(
        "def p():\n  encoder_enable_pulse_decode(0, 1, 0, 1)\n  track_conveyor_linear(p[0,1,0,0,0,0], 5000)\n  sleep(60)\nend"
    )
    robot.cabinet.turn_conveyor(0, 500.0).result()
    place = lambda: list(robot.cabinet.record.get("target_TCP_pose"))  # pyright: ignore
    robot.step(500)
    assert robot.cabinet.record.get("encoder0_raw") == pytest.approx(500, abs=5)
    runner.pause()
    robot.step(500)
    stood = place()
    runner.resume()
    robot.step(50)
    assert max(abs(a - b) for a, b in zip(place(), stood, strict=True)) < 0.012
    robot.step(450)
    assert place()[1] - stood[1] == pytest.approx(0.1, abs=0.012)
    robot.cabinet.turn_conveyor(0, 20_000.0).result()
    robot.step(1000)
    assert "singular" in str(runner.trouble)
    assert [each.kind for each in runner.told][-1] is Telling.ENDED


TRACK = "track_conveyor_linear(p[1,0,0,0,0,0], 500)"
PUSH = "force_mode(p[0,0,0,0,0,0],[0,0,1,0,0,0],[0,0,5,0,0,0],2,[1,1,1,1,1,1])"

WRONG = {
    "track_conveyor_linear(p[1,0,0,0,0,0], 500, 1)": "encoder 1 is not set up",
    "encoder_set_tick_count(1, 5)": "encoder 1 is not told its count",
    "encoder_enable_pulse_decode(0, 1, 2, 2)": "A and B: both are input 2",
    "encoder_enable_pulse_decode(0, 1, 4, 2)": "A: 4",
    "encoder_enable_set_tick_count(0, 1)\n  encoder_set_tick_count(0, 256)": "count: 256, allowed: 0 to 255",
    "encoder_enable_set_tick_count(0, 1)\n  track_conveyor_linear(p[0,0,0,1,0,0], 500)": "is no direction",
    f"encoder_enable_set_tick_count(0, 0)\n  path_offset_enable()\n  {TRACK}": "path_offset_disable() first",
    f"encoder_enable_set_tick_count(0, 0)\n  {TRACK}\n  path_offset_enable()": "stop_conveyor_tracking() first",
    f"path_offset_enable()\n  {PUSH}": "path_offset_disable()",
    f"{PUSH}\n  path_offset_enable()": "end_force_mode() first",
    "path_offset_set(p[0,0,0,0,0,0], 5)": "type: 5",
}


@pytest.mark.parametrize(("text", "why"), WRONG.items(), ids=[text[-50:] for text in WRONG])
def test_what_cannot_be_done_ends_the_program_with_a_reason(bench: ScriptBench, text: str, why: str) -> None:
    bench.robot.cabinet.turn_conveyor(0, 0.0).result()
    lines, trouble = bench.run(f"def p():\n  {text}\n  sleep(5)\nend", 300)
    assert lines == []
    assert why in trouble


def test_the_waypoint_is_that_of_the_motion_that_runs(bench: ScriptBench) -> None:
    lines = told(
        bench,
        "  global p0 = get_target_tcp_pose()\n  thread look():\n    sleep(0.2)\n"
        "    textmsg(pose_sub(get_target_waypoint(), p0))\n"
        "    sleep(2)\n    textmsg(pose_sub(get_target_waypoint(), get_target_tcp_pose()))\n  end\n  h = run look()\n"
        "  movel(pose_add(p0, p[0, 0, -0.1, 0, 0, 0]), a=1, v=0.2)\n  join h",
    )
    assert numbers(lines[0])[:3] == pytest.approx([0.0, 0.0, -0.1], abs=1e-5)
    assert numbers(lines[1])[:3] == pytest.approx([0.0, 0.0, 0.0], abs=1e-5)
