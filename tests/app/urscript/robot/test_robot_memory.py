"""What a robot keeps from one program to the next, and until it starts over."""

from app.files.library import load_tool
from sim.arm.scenario import Scenario
from tests.app.robot_interface.robot_bench import RobotBench
from tests.app.urscript.script_bench import ScriptBench


def test_flags_frames_ports_and_motion_settings_stay() -> None:
    bench = ScriptBench()
    text = 'set_flag(3, True)\nadd_frame("a", p[1, 0, 0, 0, 0, 0])\nwrite_port_register(128, 7)\njerk_gain_scaling_set(0.5)\n'
    assert bench.run(text) == ([], "")
    bench.runner.offer("sec beside():\n  set_flag(4, True)\n  set_flag(5, get_flag(3))\nend")
    bench.robot.step(5)
    asked = 'textmsg([get_flag(3), get_flag(4), get_flag(5), get_flag(6), is_frame("a"), read_port_register(128) == 7])'
    assert bench.run(f"{asked}\ntextmsg(jerk_gain_scaling_get())") == (["[True, True, True, False, True, True]", "0.5"], "")
    bench.robot.begin()
    bench.robot.step(150)
    found = ["[False, False, False, False, False, False]", "1"]
    assert bench.run(f"{asked}\ntextmsg(jerk_gain_scaling_get())") == (found, "")


def test_a_gripper_is_not_activated_any_more_after_a_restart() -> None:
    bench = ScriptBench(RobotBench(scenario=Scenario(mismatch="nominal", tool=load_tool("two-finger"))))
    assert bench.runner.gripper.answer("SET ACT 1 GTO 1") == b"ack"
    bench.robot.begin()
    bench.robot.step()
    assert bench.runner.gripper.answer("GET ACT") == b"ACT 0\n"
    assert bench.runner.gripper.answer("GET GTO") == b"GTO 0\n"


def test_an_output_that_goes_high_with_the_end_of_a_program_is_low_after_a_restart() -> None:
    bench = ScriptBench()
    bench.runner.offer("def program():\n  set_runstate_standard_digital_output_to_value(2, 2)\n  sleep(9)\nend")
    bench.robot.step(10)
    bench.robot.begin()
    bench.robot.step(5)
    assert bench.robot.cabinet.record.get("actual_digital_output_bits") == 0
