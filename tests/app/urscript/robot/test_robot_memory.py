"""What a robot keeps from one program to the next, and until it starts over."""

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
