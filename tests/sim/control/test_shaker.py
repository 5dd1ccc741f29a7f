"""Haptic patterns on the arm: the joint follows, ends where it began, and a hand may take it along (HF-1, HF-2)."""

import numpy as np
import pytest

from pendant.all_settings import Settings, apply
from pendant.haptics import Pattern, Shake
from pendant.inputs import Command
from pendant.tick.estimate import Estimate
from pendant.tick.modes import Mode
from sim.arm.scenario import Load, Scenario
from sim.control.shaker import FURTHEST, MOST, Shaker
from tests.sim.arms import UR5E
from tests.sim.bench import Bench, push
from tests.sim.laws import N, estimate

ROTOR, RATED = UR5E.motors.rotor_inertia[-1], UR5E.limits.torque[-1]
FELT = apply(Settings(), {"haptics.on": True, "free_drive.period": 4.0})


def shake(angle: float = 0.0, speed: float = 0.0, acceleration: float = 0.0) -> Shake:
    return Shake(Pattern.ENTERED, angle, speed, acceleration)


def at(angle: float, speed: float = 0.0) -> Estimate:
    return estimate(theta=np.array([0.0] * (N - 1) + [angle]), theta_d=np.array([0.0] * (N - 1) + [speed]))


def test_it_begins_without_torque_and_pulls_towards_the_pattern() -> None:
    module = Shaker(ROTOR, RATED)
    assert module.torque(shake(), at(1.0), 1.2) == 0.0
    assert module.torque(shake(angle=0.001), at(1.0), 1.2) > 1.2
    assert module.torque(shake(angle=-0.001), at(1.0), 1.2) < -1.2
    assert module.torque(shake(), at(1.0, speed=0.1), 1.2) < 0.0
    assert module.torque(shake(acceleration=10.0), at(1.0), 1.2) == pytest.approx(13.0 * ROTOR)


def test_a_hand_takes_it_along_and_its_torque_is_bounded() -> None:
    module = Shaker(ROTOR, RATED)
    module.torque(shake(), at(0.0), 1.2)
    most = module.torque(shake(), at(0.5), 1.2)
    assert -MOST * RATED <= most < 0.0
    # The centre lies FURTHEST behind the hand now, and nothing swings back further.
    assert module.torque(shake(), at(0.5 - FURTHEST), 1.2) == pytest.approx(0.0, abs=1e-9)
    assert module.torque(shake(speed=1000.0), at(0.5), 1.2) == MOST * RATED
    module.stop()
    assert module.torque(shake(), at(-0.3), 1.2) == 0.0


@pytest.mark.parametrize("mass", [0.0, 4.0])
def test_the_last_joint_shakes_and_is_back_where_it_was(mass: float) -> None:
    load = Load(mass=mass, com=[0.03, 0.0, 0.08])
    bench = Bench(Scenario(payload_true=load, payload_configured=load, seed=4), FELT)
    bench.run(0.5)
    bench.enter()
    for law in ("free", "held"):
        others, start = bench.plant.q[:-1].copy(), float(bench.plant.q[-1])
        decision = bench.tick() if law == "free" else bench.do(Command.LEAVE_FREE_DRIVE)
        while decision.shake is None:
            start = float(bench.plant.q[-1])
            decision = bench.tick()
        ways = []
        while decision.shake is not None:
            ways.append(float(bench.plant.q[-1]) - start)
            decision = bench.tick()
        assert 0.006 < max(map(abs, ways)) < 2.5 * FELT.haptics.amplitude + 0.001
        bench.run(0.2)
        assert abs(float(bench.plant.q[-1]) - start) < 0.0006
        assert float(np.abs(bench.plant.q[:-1] - others).max()) < 0.001
        assert bench.mode is (Mode.FREE_DRIVE if law == "free" else Mode.TEACH)


def test_a_hand_that_turns_the_tool_meanwhile_is_not_stopped() -> None:
    bench = Bench(settings=FELT)
    bench.run(0.5)
    bench.enter()
    while bench.tick().shake is None:
        pass
    start = float(bench.plant.q[-1])
    x, y, z = (4.0 * bench.estimate.R_BF[:, 2]).tolist()
    bench.run(0.4, push("flange", (0.0, 0.0, 0.0), (x, y, z)))
    assert float(bench.plant.q[-1]) - start > 0.05
    assert bench.mode is Mode.FREE_DRIVE
