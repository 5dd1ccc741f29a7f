"""estimate_payload() with what the arm measures of a payload that nobody told it."""

import pytest

from tests.app.robot_interface.robot_bench import RobotBench
from tests.app.urscript.script_bench import ScriptBench

POSTURES = ("[0.2, -1.4, 1.7, -1.87, -1.57, 0]", "[0.2, -1.4, 1.7, -1.87, -0.6, 0]", "[0.2, -1.4, 1.7, -0.9, -1.57, 0]")
LAST = "[0.2, -1.4, 1.7, -1.87, -2.5, 1.5]"


@pytest.mark.parametrize("mass", [0.8, 2.1])
def test_it_finds_mass_and_centre(mass: float) -> None:
    """The load hangs before the flange, not beside it; the sensor is good to a few newtons, and differences are better."""
    bench = ScriptBench(RobotBench(true=mass))
    there = "\n".join(
        f"  movej({q}, a=8, v=3)\n  sleep(0.4)\n  poses[{k}] = get_actual_tcp_pose()\n  w = get_tcp_force()\n"
        f"  i = 0\n  while i < 6:\n    wrenches[{k}, i] = w[i]\n    i = i + 1\n  end"
        for k, q in enumerate((*POSTURES, LAST))
    )
    told, trouble = bench.run(
        "def p():\n  here = get_actual_tcp_pose()\n  poses = [here, here, here, here]\n"
        "  wrenches = [[0.0,0,0,0,0,0],[0.0,0,0,0,0,0],[0.0,0,0,0,0,0],[0.0,0,0,0,0,0]]\n"
        f"{there}\n  found = estimate_payload(poses, wrenches)\n  textmsg(found.mass)\n  textmsg(found.cog)\nend",
        6000,
    )
    assert trouble == ""
    assert float(told[0]) == pytest.approx(mass, abs=0.1)
    x, y, _ = (float(value) for value in told[1][1:-1].split(","))
    assert (x, y) == pytest.approx((0.0, 0.0), abs=0.02)
