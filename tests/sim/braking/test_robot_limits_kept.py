"""The robot's limits are kept by moving more slowly, on every arm; motions that keep them are left alone (RL-4, RL-6)."""

from functools import cache
from typing import NamedTuple

import numpy as np
import pinocchio as pin
import pytest

from app.files.library import load_arm
from pendant.all_settings import Settings, apply
from pendant.events.event import Kind
from pendant.inputs import Inputs
from pendant.program.jog_move import JogMove
from pendant.program.steps import JointMove
from pendant.tick.modes import Mode
from sim.arm.scenario import Load, Scenario
from sim.exchange.desk import Wishes
from sim.motion.moves import REACTION, SHORTEST_STOP, stop_time
from sim.simulation import Simulation
from tests.sim.bench import NOMINAL, Bench

ARMS = ("ur3e", "ur5e", "ur10e")
KEPT = ("tool_speed", "elbow_speed", "joint_speeds.j1", "momentum", "stopping_time", "stopping_distance")
TURN = (1.6, 0.5, 0.0, 0.0, 0.0, 0.0)
"""Of the joints of a move with which each arm comes to every limit [rad]."""
BELOW, ABOVE = 1.0 / 0.95, 1.0 / 1.05
"""Limits that the largest value of the move is 5 % below, and 5 % above."""


class Moved(NamedTuple):
    """What a move did."""

    q: np.ndarray  # references (k, n) [rad]
    qd: np.ndarray  # [rad/s]
    kinds: tuple[Kind, ...]
    most: dict[str, float]  # of each limited quantity

    @property
    def stopped(self) -> bool:
        return Kind.LIMIT_EXCEEDED in self.kinds


@cache
def moved(arm: str, **limits: float) -> Moved:
    """A fast joint move with the arm's payload, with limits of NORMAL, or with the switch off where none is given."""
    names = {f"robot_limits.normal.{name}": value for name, value in limits.items()}
    file = load_arm(arm)
    load = Load(mass=file.payload, com=[0.0, 0.0, 0.05])
    scenario = Scenario(mismatch="nominal", payload_true=load, payload_configured=load)
    bench = Bench(scenario, apply(Settings(), names or {"robot_limits.on": False}), file)
    bench.start(JointMove(q=tuple(np.add(file.chain.home, TURN).tolist()), speed=0.7, acceleration=0.6))
    q, qd = [], []
    while bench.mode is Mode.RUN and len(q) < 3000:
        bench.tick()
        now = bench.simulation.controller.references.now
        assert now is not None
        q.append(now.q.copy())
        qd.append(now.qd.copy())
    rows = np.array(q), np.array(qd)
    return Moved(*rows, tuple([event.kind for event in bench.events]), largest(bench.simulation, *rows))


def largest(simulation: Simulation, q: np.ndarray, qd: np.ndarray) -> dict[str, float]:
    """The largest of each quantity, by its definition."""
    model, arm = simulation.dynamics, simulation.arm
    rotor, torque = np.array(arm.motors.rotor_inertia), np.array(arm.limits.torque)
    seen = []
    for angles, speeds in zip(q[::5], qd[::5], strict=True):
        places = [model.places(angles + side * 1e-6 * speeds) for side in (-1.0, 1.0)]
        tcp = np.linalg.norm(np.subtract(*[p + R @ simulation.tcp for p, R, _ in places])) / 2e-6
        elbow = np.linalg.norm(places[1][2] - places[0][2]) / 2e-6
        pin.computeCentroidalMomentum(model.model, model.data, angles, speeds)
        momentum = float(np.linalg.norm(model.data.hg.linear))
        length = max(stop_time(model, angles, speeds, rotor=rotor, torque=torque), SHORTEST_STOP)
        way = max(tcp, elbow) * (0.5 * length + REACTION)
        seen.append((tcp, elbow, abs(speeds[0]), momentum, length + REACTION, way))
    return dict(zip(KEPT, np.max(seen, axis=0).tolist(), strict=True))


@pytest.mark.parametrize("name", KEPT)
@pytest.mark.parametrize("arm", ARMS)
def test_a_limit_that_is_kept_changes_nothing_and_another_slows_the_move_down(arm: str, name: str) -> None:
    free = moved(arm)
    limit = free.most[name]
    below, above = moved(arm, **{**WIDE, name: limit * BELOW}), moved(arm, **{**WIDE, name: limit * ABOVE})
    np.testing.assert_array_equal(below.q, free.q)
    assert not below.stopped
    assert 0.97 < above.most[name] / (limit * ABOVE) < 1.01  # about 60 places of it are looked at
    assert len(above.q) > 1.01 * len(free.q)
    assert not above.stopped
    assert Kind.PROGRAM_FINISHED in above.kinds
    np.testing.assert_allclose(above.q[-1], free.q[-1], atol=1e-9)


WIDE = {"tool_speed": 5.0, "elbow_speed": 5.0, "momentum": 100.0, "power": 1000.0, "stopping_time": 2.0, "stopping_distance": 3.0}


@pytest.mark.parametrize("arm", ARMS)
def test_a_lower_power_slows_the_tool_down(arm: str) -> None:
    """P = F v, at the force that the tool may have."""
    speed = moved(arm).most["tool_speed"]
    below, above = (moved(arm, **{**WIDE, "tool_force": 50.0, "power": 50.0 * speed * side}) for side in (BELOW, ABOVE))
    np.testing.assert_array_equal(below.q, moved(arm).q)
    assert above.most["tool_speed"] == pytest.approx(speed * ABOVE, rel=0.03)


@pytest.mark.parametrize("arm", ARMS)
@pytest.mark.parametrize("side", [BELOW, ABOVE])
def test_a_move_comes_to_rest_at_the_limit_of_a_joint(arm: str, side: float) -> None:
    free, home = moved(arm), load_arm(arm).chain.home[0]
    limit = home + TURN[0] * side
    limited = moved(arm, **{**WIDE, "positions.j1_max": limit})
    assert not limited.stopped
    if side > 1.0:
        np.testing.assert_array_equal(limited.q, free.q)
        return
    assert Kind.PROGRAM_FAILED in limited.kinds
    assert limit - 0.01 < limited.q[:, 0].max() <= limit + 0.001
    assert np.abs(np.diff(limited.qd[:, 0])).max() / 0.002 < 2.0 * load_arm(arm).limits.acceleration[0]  # no jump


def test_a_jogged_joint_comes_to_rest_at_its_limit_and_goes_back() -> None:
    bench = Bench(NOMINAL, apply(Settings(), {"robot_limits.normal.positions.j1_max": 0.2}))
    bench.run(0.2)

    def jog(sign: int) -> None:
        wishes = Wishes(Inputs(jog=JogMove(id=-1, frame="joint", axis=0, sign=sign, length=0.0)), (), ())
        for _ in range(1000):
            bench.tick(wishes)
        bench.run(0.5)

    jog(1)
    assert 0.19 < bench.estimate.q[0] < 0.202
    jog(-1)
    assert bench.estimate.q[0] < 0.1
    assert Kind.LIMIT_EXCEEDED not in [event.kind for event in bench.events]
