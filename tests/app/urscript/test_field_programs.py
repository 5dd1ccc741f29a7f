"""Programs of the kinds that people wrote for real robots: each row of field_programs.yaml does what a robot does with it."""

import re
from pathlib import Path

import numpy as np
import pytest
import yaml

from app.robot_interface.dashboard.dashboard_commands import DashboardCommands, Pending
from app.urscript.running.told import Telling, Told
from pendant.events.event import Kind
from pendant.tick.modes import Mode
from sim.arm.scenario import Scenario
from tests.app.robot_interface.robot_bench import RobotBench
from tests.app.urscript.script_bench import ScriptBench

ROWS = yaml.safe_load((Path(__file__).parent / "field_programs.yaml").read_text(encoding="utf-8"))
NUMBER = re.compile(r"-?\d+(?:\.\d+)?(?:e[+-]?\d+)?")
LONG = 6000
"""Ticks that a program may take."""

ERRORS = frozenset({Kind.TOOL_REFUSED, Kind.COMMAND_REFUSED, Kind.PROGRAM_REFUSED, Kind.ZERO_REFUSED})
"""Events that a client of the primary interface reads as an error."""


@pytest.fixture(scope="module")
def shared() -> ScriptBench:
    return ScriptBench(RobotBench(scenario=Scenario(seed=7)))


@pytest.mark.parametrize("row", ROWS, ids=lambda row: f"{row['of']}: {row['run'].strip()[:40]}".replace("\n", "|"))
def test_a_program_does_what_a_robot_does_with_it(shared: ScriptBench, row: dict) -> None:
    bench = ScriptBench(RobotBench(scenario=Scenario(seed=8))) if row.get("fresh") else shared
    before = len(bench.robot.watcher.events)
    told, error = bench.run(row["run"], LONG)
    wanted, expected = row.get("error", ""), row.get("tells", [])
    assert error.startswith(wanted[:-3]) if wanted.endswith("...") else error == wanted
    assert [NUMBER.sub("#", text) for text in told] == [NUMBER.sub("#", text) for text in expected]
    numbers = [float(n) for text in told for n in NUMBER.findall(text)]
    assert numbers == pytest.approx([float(n) for text in expected for n in NUMBER.findall(text)], abs=row.get("within", 1e-6))
    if not wanted:
        assert not ERRORS & {event.kind for event in bench.robot.watcher.events[before:]}


def test_a_tcp_in_a_line_that_is_blended_does_not_disturb_that_line() -> None:
    """The first line keeps the tool that it was planned with: no joint's speed has a step."""
    bench = ScriptBench()
    bench.runner.offer(
        "def program():\n  movel(p[-0.55, -0.13, 0.40, 2.22, 2.22, 0], a=1, v=0.25, r=0.03)\n"
        "  set_tcp(p[0.1, 0, 0.1, 0, 0, 0])\n  movel(p[-0.45, -0.13, 0.40, 2.22, 2.22, 0], a=1, v=0.25)\nend"
    )
    steps, before = [], None
    for _ in range(3000):
        bench.robot.step()
        reference = bench.robot.simulation.controller.references.now
        assert reference is not None
        if before is not None:
            steps.append(float(np.abs(reference.qd - before).max()))
        before = reference.qd.copy()
        if bench.state is None:
            break
    assert bench.runner.trouble is None
    assert max(steps) < 0.02  # [rad/s] in a tick: 10 rad/s²


def test_a_secondary_program_changes_tcp_and_payload_too() -> None:
    bench = ScriptBench()
    bench.runner.offer(
        "sec dress():\n  set_payload(0.3)\n  set_payload_cog([0, 0, 0.02])\n  set_tcp(p[0, 0, 0.07, 0, 0, 0])\nend"
    )
    bench.robot.step(20)
    assert [told.text for told in bench.runner.told if told.kind is Telling.ASIDE] == []
    told, _ = bench.run("textmsg(get_target_payload_cog())\ntextmsg(get_tcp_offset())")
    assert told == ["[0, 0, 0.02]", "p[0, 0, 0.07, 0, 0, 0]"]


def test_a_tool_is_not_changed_in_free_drive_and_the_program_says_why() -> None:
    _, trouble = ScriptBench().run("def program():\n  freedrive_mode()\n  sleep(1)\n  set_tcp(p[0, 0, 0.1, 0, 0, 0])\nend")
    assert trouble.startswith("line 4, column 3: set_tcp(): ")
    assert "free-drive" in trouble


def test_a_program_that_waits_for_contact_after_zeroing_sees_none() -> None:
    """Fifteen programs in the field: zero, then move until the force is above a threshold."""
    told, trouble = ScriptBench(RobotBench(scenario=Scenario(seed=5))).run(
        "def program():\n  movej([0, -1.2, 1.5, -1.87, -1.57, 0])\n  zero_ftsensor()\n  n = 0\n"
        "  while n < 500:\n    if force() > 2:\n      textmsg(force())\n      halt\n    end\n"
        "    n = n + 1\n    sync()\n  end\nend",
        4000,
    )
    assert (told, trouble) == ([], "")


def test_a_hand_on_the_arm_is_told_and_the_zero_is_not_waited_for() -> None:
    bench = ScriptBench()
    bench.robot.pull((0.0, 15.0, 0.0), 200)
    bench.runner.offer("def program():\n  zero_ftsensor()\n  textmsg(force())\nend")
    bench.robot.pull((0.0, 15.0, 0.0), 10)
    assert Kind.READING_ZEROED_PULLED in bench.robot.kinds()
    assert float(next(told.text for told in bench.runner.told if told.kind is Telling.TEXT)) < 1.0


def test_inputs_with_the_action_freedrive_ask_for_it() -> None:
    bench = ScriptBench()
    bench.run('set_gp_boolean_input_action(70, "freedrive")')
    bench.robot.cabinet.record.put("input_bit_register_70", True)
    assert any(bench.robot.step().mode is Mode.FREE_DRIVE for _ in range(1500))
    bench.robot.cabinet.record.put("input_bit_register_70", False)
    bench.robot.step(100)
    assert bench.robot.step().mode is not Mode.FREE_DRIVE
    bench.run("set_input_actions_to_default()")
    bench.robot.cabinet.record.put("input_bit_register_70", True)
    assert not any(bench.robot.step().mode is Mode.FREE_DRIVE for _ in range(1500))


def test_outputs_follow_the_state_of_the_program() -> None:
    """1: low while none runs; 2: high while none runs; 3: high while one runs."""
    bench = ScriptBench()
    bench.run(
        "set_runstate_standard_digital_output_to_value(3, 3)\nset_runstate_configurable_digital_output_to_value(1, 1)\n"
        "set_runstate_tool_digital_output_to_value(0, 2)\nset_runstate_standard_analog_output_to_value(1, 2)\n"
        "set_runstate_gp_boolean_output_to_value(70, 3)\nset_configurable_digital_out(1, True)\nset_standard_digital_out(5, True)"
    )
    get = bench.robot.cabinet.record.get
    assert get("actual_digital_output_bits") == 1 << 5 | 1 << 16
    assert (get("standard_analog_output1"), get("output_bit_register_70")) == (10.0, 0)
    bench.runner.offer("sleep(1)")
    bench.robot.step(2)
    assert get("actual_digital_output_bits") == 1 << 3 | 1 << 5 | 1 << 16
    assert get("output_bit_register_70") == 1


# The dashboard


class Panel:
    """The dashboard of a robot that runs scripts."""

    def __init__(self) -> None:
        self.bench = ScriptBench()
        self.commands = DashboardCommands(self.bench.robot.cabinet, "UR5")

    def say(self, line: str) -> str:
        answer = self.commands.answer(line, remote=True)
        if not isinstance(answer, Pending):
            return answer
        done = answer.asked
        while not done.done():
            self.bench.robot.step()
        return answer.answer(done.result(0.0))


@pytest.fixture
def panel() -> Panel:
    return Panel()


MOVES = 'def hello():\n  textmsg("once")\n  movej([0, -1.2, 1.5, -1.87, -1.57, 0])\nend'


def test_play_after_a_script_from_the_network_fails_for_nothing_is_loaded(panel: Panel) -> None:
    panel.bench.run(MOVES, LONG)
    assert panel.say("get loaded program") == "No program loaded"
    assert panel.say("programState") == "STOPPED <unnamed>"
    assert panel.say("play") == "Failed to execute: play"
    panel.bench.robot.step(300)
    assert panel.say("programState") == "STOPPED <unnamed>"


def test_play_after_a_script_starts_what_was_loaded_before_it(panel: Panel) -> None:
    assert panel.say("load wave.urp") == "Loading program: wave.urp"
    panel.bench.run(MOVES, LONG)
    assert panel.say("get loaded program") == "Loaded program: /programs/wave.urp"
    assert panel.say("play") == "Starting program"
    assert panel.say("programState") == "PLAYING wave.urp"
    assert panel.bench.robot.simulation.supervisor.program is panel.bench.robot.cabinet.state.loaded


# What RTDE tells


def test_the_target_moment_of_a_standing_arm_is_the_models() -> None:
    """The first axis is vertical: gravity gives it no torque; the others hold the arm's weight. A UR10e tells 0.0 there."""
    bench = ScriptBench(RobotBench(scenario=Scenario(seed=3)))
    bench.run("def a():\n  movej([-0.28, -1.95, -1.67, -1.53, 0.99, 0.39], v=1.2)\nend", LONG)
    bench.robot.step(200)
    bench.robot.cabinet.refresh()
    simulation, get = bench.robot.simulation, bench.robot.cabinet.record.get
    moment, current = np.array(get("target_moment")), np.array(get("target_current"))
    assert abs(moment[0]) < 1e-6
    assert moment == pytest.approx(simulation.dynamics.gravity(np.array(get("target_q"))), abs=1e-6)
    motors = simulation.arm.motors
    assert current * np.array(motors.gear) * np.array(motors.torque_constant) == pytest.approx(moment)


def test_the_target_moment_of_a_motion_is_what_its_acceleration_needs() -> None:
    bench = ScriptBench()
    bench.runner.offer("def a():\n  movej([1.5, -1.2, 1.5, -1.87, -1.57, 0], a=2, v=1.5)\nend")
    bench.robot.step(60)
    bench.robot.cabinet.refresh()
    get, dynamics = bench.robot.cabinet.record.get, bench.robot.simulation.dynamics
    q, qd, qdd = (np.array(get(name)) for name in ("target_q", "target_qd", "target_qdd"))
    assert abs(qdd[0]) > 0.1
    assert np.array(get("target_moment")) == pytest.approx(dynamics.inverse(q, qd, qdd), abs=1e-9)


def test_without_power_no_moment_is_wanted(panel: Panel) -> None:
    panel.say("power off")
    panel.bench.robot.step(200)
    panel.bench.robot.cabinet.refresh()
    assert panel.bench.robot.cabinet.record.get("target_moment") == [0.0] * 6


def test_the_actual_current_is_the_measured_one() -> None:
    """Not the torque that the controller believes in, over a constant that is a little off."""
    bench = ScriptBench(RobotBench(scenario=Scenario(seed=3)))
    bench.robot.step(20)
    bench.robot.cabinet.refresh()
    simulation = bench.robot.simulation
    assert np.abs(simulation.calibration.motor_constant - 1.0).max() > 1e-3
    told = np.array(bench.robot.cabinet.record.get("actual_current"))
    assert told == pytest.approx(simulation.estimate.current * np.array(simulation.arm.motors.current))
    assert told == pytest.approx(simulation.current, abs=0.1)  # that the motors were given two ticks before


def test_a_program_that_asks_for_free_drive_without_end_is_guided_and_its_end_is_no_refusal() -> None:
    """Found: `while True: teach_mode()`. Nothing is refused when it is stopped while the arm is free."""
    bench = ScriptBench()
    bench.runner.offer("def program():\n  while True:\n    teach_mode()\n  end\nend")
    assert bench.robot.step(1200).mode is Mode.FREE_DRIVE
    bench.runner.stop()
    assert bench.robot.step(400).mode is not Mode.FREE_DRIVE
    assert bench.runner.trouble is None
    assert not ERRORS & {event.kind for event in bench.robot.watcher.events}


@pytest.mark.parametrize("head", ["def", "sec"])
def test_a_script_that_was_read_before_a_restart_is_not_run_after_it(head: str) -> None:
    bench = ScriptBench()
    told: list[Told] = []
    bench.runner.listen(told.append)
    bench.runner.offer(f'{head} old():\n  textmsg("runs")\nend\n')
    bench.robot.begin()
    bench.robot.step(3)
    assert [each.text for each in told if each.kind in (Telling.TROUBLE, Telling.ASIDE)] == ["the simulation has started over"]
    assert "runs" not in [each.text for each in told]
    assert bench.state is None
