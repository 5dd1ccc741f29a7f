"""direct_torque of scripts: joint torques beside gravity, with shares of the friction, under the joints' limits."""

import numpy as np
import pytest

from app.robot_interface.controller.robot_words import ControlMode
from pendant.events.event import Kind
from pendant.inputs import Command, Inputs
from pendant.motion.script_requests import DirectTorque
from pendant.tick.modes import TICK
from tests.app.urscript.script_bench import ScriptBench

NONE, ALL = "[0,0,0,0,0,0]", "[1,1,1,1,1,1]"


class Torques(ScriptBench):
    """A robot that runs a program, and what its arm does."""

    def follow(self, torque: str, ticks: int, then: str = "", scales: str = f", {ALL}, {ALL}", patience: int = 900) -> np.ndarray:
        """True joint angles (rows, 6) from the program's first motion on, while it runs and 300 ticks longer [rad]."""
        self.runner.offer(
            f"def p():\n i = 0\n while i < {ticks}:\n  i = i + 1\n  direct_torque({torque}{scales})\n end\n{then}\nend"
        )
        rows, left = [], 300
        for _ in range(patience):
            done = self.robot.step()
            if isinstance(done.move, DirectTorque) or rows:
                rows.append(self.q)
            left -= self.state is None
            if not left:
                break
        return np.array(rows)

    @property
    def q(self) -> np.ndarray:
        return self.robot.simulation.plant.q.copy()


@pytest.fixture
def bench() -> Torques:
    return Torques()


def test_without_torques_the_arm_stands(bench: Torques) -> None:
    """Gravity comes by itself, and no share of the friction up to the whole of it drives a joint."""
    for scales in (f", {NONE}, {NONE}", "", f", {ALL}, {ALL}"):
        rows = bench.follow(NONE, 200, scales=scales)
        assert np.abs(rows - rows[0]).max() < 1e-3


def test_a_joint_accelerates_by_its_torque_over_the_inertia(bench: Torques) -> None:
    simulation = bench.robot.simulation
    upper = np.triu(simulation.dynamics.mass(bench.q))
    inertia = upper + np.triu(upper, 1).T + np.diag(simulation.arm.motors.rotor_inertia)
    expected = np.linalg.solve(inertia, [20.0, 0.0, 0.0, 0.0, 0.0, 0.0])[0]
    speed = np.diff(bench.follow("[20,0,0,0,0,0]", 75)[:, 0]) / TICK
    assert (speed[70] - speed[20]) / (50 * TICK) == pytest.approx(expected, rel=0.1)


def test_friction_that_is_not_made_up_for_holds_the_joint_back(bench: Torques) -> None:
    """2 N·m on the last joint: half of it is friction that does not depend on the speed, the rest lets it turn slowly."""
    with_none = bench.follow("[0,0,0,0,0,2]", 150, scales=f", {NONE}, {NONE}")[:, 5]
    usual = bench.follow("[0,0,0,0,0,2]", 150, scales="")[:, 5]
    assert 0.02 < np.ptp(with_none) < 0.5 * np.ptp(usual)
    assert np.ptp(bench.follow("[0,0,0,0,0,1]", 150, scales=f", {NONE}, {NONE}")[:, 5]) < 2e-3


def test_the_part_that_grows_with_the_speed_has_a_share_of_its_own(bench: Torques) -> None:
    alone = [
        np.ptp(bench.follow("[0,0,0,0,0,2]", 150, scales=f", {viscous}, {coulomb}")[:, 5])
        for viscous, coulomb in ((NONE, NONE), (ALL, NONE), (NONE, ALL), (ALL, ALL))
    ]
    assert alone[0] < min(alone[1:3])
    assert max(alone[1:3]) < alone[3]


def test_where_no_new_torque_comes_the_arm_comes_to_rest_and_the_program_goes_on(bench: Torques) -> None:
    rows = bench.follow("[0,0,0,0,0,1.5]", 100, " sleep(0.5)\n textmsg(7)")
    speed = np.abs(np.diff(rows[:, 5])) / TICK
    assert speed.max() > 0.3
    assert speed[150:200].max() < 0.01
    assert "7" in [told.text for told in bench.runner.told]
    assert bench.runner.trouble is None


def test_a_speed_takes_over_from_a_moving_arm(bench: Torques) -> None:
    rows = bench.follow("[0,0,0,0,0,1.5]", 100, " speedj([0,0,0,0,0,0.5], 5, 0.6)\n stopj(5)")
    speed = np.diff(rows[:, 5]) / TICK
    assert speed[100:].min() > -0.02
    assert speed[260:350] == pytest.approx(0.5, abs=0.03)  # 2 rad/s less 5 rad/s² for 0.3 s, from the 100th tick on


@pytest.mark.parametrize(
    ("torque", "scales", "told"),
    [
        ("[0,0,0,0,0,25]", f", {ALL}, {ALL}", "joint 6 moves at 3."),
        ("[0,0,0,0,0,3]", f", {NONE}, {NONE}", "joint 6 would stop at 6."),
    ],
)
def test_limits_that_the_program_does_not_keep_end_it_and_the_arm_brakes(
    bench: Torques, torque: str, scales: str, told: str
) -> None:
    rows = bench.follow(torque, 9000, scales=scales, patience=9000)
    assert bench.runner.trouble is not None
    assert bench.runner.trouble.text.startswith(told)
    assert np.abs(rows).max() < 2 * np.pi
    assert np.abs(np.diff(rows[-50:], axis=0)).max() < 1e-5
    assert Kind.PROGRAM_FAILED in [event.kind for event in bench.robot.watcher.events]


def test_what_is_too_fast_in_reduced_is_a_protective_stop(bench: Torques) -> None:
    bench.robot.step(300, inputs=Inputs(commands=(Command.REDUCED_ON,)))
    bench.follow("[60,0,0,0,0,0]", 500)
    assert Kind.LIMIT_EXCEEDED in [event.kind for event in bench.robot.watcher.events]
    assert bench.state is None


def test_clients_see_that_torques_are_commanded(bench: Torques) -> None:
    seen = set()
    bench.runner.offer("def p():\n i = 0\n while i < 50:\n  i = i + 1\n  direct_torque([0,0,0,0,0,0])\n end\n sleep(0.1)\nend")
    for _ in range(150):
        bench.robot.step()
        seen.add(bench.robot.cabinet.state.control_mode)
    assert seen == {ControlMode.POSITION, ControlMode.TORQUE}


def test_nothing_is_learned_of_friction_meanwhile(bench: Torques) -> None:
    """Who commands torques may well push on something that no sensor tells."""
    friction = bench.robot.simulation.estimator.friction
    before = friction.terms.copy()
    bench.follow("[0,0,0,0,0,1.5]", 150)
    learned = np.abs(friction.terms - before)[5].max()
    bench.follow(NONE, 1, " speedj([0,0,0,0,0,0.5], 5, 0.6)\n stopj(5)")
    assert learned < 0.1 * np.abs(friction.terms - before)[5].max()
