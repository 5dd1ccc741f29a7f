"""How far behind the commands of servoj the joints are, given anew in every tick.

What a UR is measured to do: with a look-ahead of 0.03 s and a gain of 1200 the measured joint angles are 17 ticks of 2 ms, 34 ms,
behind those sent, by cross-correlation; 2 or 3 of these ticks are the way there and back (Universal Robots Client Library,
issue 86, "Reduce Delay Time of ServoJ Command"). So the arm is the look-ahead behind, and 4 ms more at most; the manual names the
look-ahead alone, 0.03 to 0.2 s. Here there is no way there and back: commands are given and angles measured on the robot.

Angles that go on evenly are followed by the look-ahead T whatever the gain K is (sim/motion/streams.py). A sine of w rad/s is
followed atan(T w / (1 - w²/K)) / w later: for the lowest gain, 100, that is a tenth more, and no manual or measurement says
what a UR does there, so that row has no bar.
https://github.com/UniversalRobots/Universal_Robots_Client_Library/issues/86
"""

import math
from itertools import count

import numpy as np
from numpy.typing import NDArray

from app.api import session, stepped
from app.robot_interface.controller.cabinet import Cabinet
from app.robot_interface.controller.program_folder import ProgramFolder
from app.urscript.running.script_runner import ScriptRunner
from benchmarks.common import Report, main
from pendant.inputs import NOTHING
from pendant.tick.modes import TICK, TICK_RATE
from sim.exchange.desk import Wishes

BEYOND = 4.0
"""More than the look-ahead [ms], by the measurement above."""

GAINS = (100.0, 300.0, 1200.0, 2000.0)
LOOKAHEADS = (0.03, 0.05, 0.1, 0.2)
JOINTS = {"base": 0, "elbow": 2, "wrist 3": 5}
SECONDS = 6.0
FREQUENCY, AMPLITUDE = 0.5, 0.15  # of the sine [Hz, rad]; it grows from nothing in a second

SPEED = 0.1  # of the even way, which it reaches in a second [rad/s]
DEFAULT_GAIN = 300.0
"""Of a UR; the measurement was made with a larger one."""

SINE = f"grown * {AMPLITUDE} * sin({2.0 * math.pi * FREQUENCY} * t)"
EVEN = f"{SPEED} * grown * (t - 0.5 * grown)"

PROGRAM = """def servo():
  q = get_target_joint_positions()
  begin = q[{joint}]
  k = 0
  while k < {ticks}:
    t = k * {tick}
    grown = t
    if grown > 1:
      grown = 1
    end
    q[{joint}] = begin + {way}
    write_output_float_register(0, q[{joint}])
    servoj(q, t={tick}, lookahead_time={lookahead}, gain={gain})
    k = k + 1
  end
  stopj(2.0)
end
"""

Array = NDArray[np.float64]


def followed(joint: int, way: str, lookahead: float, gain: float, *, seed: int) -> tuple[Array, Array]:
    """Angles of a joint that the script commands along `way`, and those that are measured, tick by tick [rad]."""
    simulation = stepped(session({"title": "servo", "robot": "ur5e", "seed": seed, "duration": 1.0}))
    cabinet = Cabinet(lambda: simulation, simulation.arm.chain.joints, ProgramFolder())
    runner = ScriptRunner(cabinet)
    commanded: list[float] = []
    measured: list[float] = []
    ticks = round(SECONDS * TICK_RATE)
    text = PROGRAM.format(joint=joint, ticks=ticks, tick=TICK, way=way, lookahead=lookahead, gain=gain)
    for tick in range(1, ticks + 2 * TICK_RATE):
        if tick == TICK_RATE // 2:
            runner.offer(text)
        decision = simulation.tick(Wishes(NOTHING, (), ()).joined(cabinet.wishes(tick, simulation.snapshot)))
        cabinet.see(tick, decision)
        if tick > TICK_RATE // 2 and runner.state is not None:
            commanded.append(float(cabinet.record.get("output_double_register_0")))  # pyright: ignore[reportArgumentType]
            measured.append(float(simulation.estimate.q[joint]))
    if runner.trouble is not None:
        raise RuntimeError(str(runner.trouble))
    there = slice(2 * TICK_RATE, ticks)  # the sine has its full size
    return np.array(commanded)[there], np.array(measured)[there]


def delay(commanded: Array, measured: Array) -> float:
    """By which the measured angles follow the commanded ones [ms]: where their difference is least, between ticks as well."""
    a = commanded - commanded.mean()
    most = round(0.4 * TICK_RATE)
    squares = np.array([float(np.mean((measured[most:] - measured.mean() - a[most - k : a.size - k]) ** 2)) for k in range(most)])
    k = int(np.argmin(squares[1:-1])) + 1
    before, here, after = squares[k - 1 : k + 2].tolist()
    return 1000.0 * TICK * (k + 0.5 * (before - after) / (before - 2.0 * here + after))


def behind(commanded: Array, measured: Array) -> float:
    """By which the measured angles follow commanded ones that go on evenly [ms]."""
    return 1000.0 * float(np.mean(commanded - measured)) / SPEED


def measure(report: Report) -> None:
    """Fill the report."""
    full, seeds = report.options.full, count(report.options.seed)
    joints = tuple(JOINTS.values()) if full else (0,)
    for lookahead in LOOKAHEADS:
        most = 1000.0 * lookahead + BEYOND
        for gain in GAINS if full else (300.0, 1200.0):
            what, bar = f"look-ahead {lookahead:g} s, gain {gain:g}", most if gain >= DEFAULT_GAIN else None
            sines = [delay(*followed(joint, SINE, lookahead, gain, seed=next(seeds))) for joint in joints]
            report.row(f"{what}: delay of a sine", max(sines), "ms", at_most=bar, n=len(joints))
            evens = [behind(*followed(joint, EVEN, lookahead, gain, seed=next(seeds))) for joint in joints]
            report.row(f"{what}: delay of an even way", max(evens), "ms", at_most=most, n=len(joints))


if __name__ == "__main__":
    main("servo_delay", measure)
