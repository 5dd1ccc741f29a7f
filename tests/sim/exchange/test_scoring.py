"""A glance shows what a snapshot copies."""

import math

import numpy as np
import pytest

from pendant.all_settings import Settings
from pendant.inputs import NOTHING
from sim.arm.frames import matrix_from_quaternion
from sim.arm.scenario import Load, Scenario
from sim.exchange.desk import Wishes
from sim.exchange.scoring import Scored, point_of
from sim.simulation import Simulation
from tests.app.fakes import JOINTS, snapshot
from tests.sim.arms import UR5E

IDLE = Wishes(NOTHING, (), ())


def test_a_glance_shows_what_a_snapshot_copies() -> None:
    simulation = Simulation(UR5E, Scenario(payload_true=Load(mass=1.5), seed=4), Settings())
    for _ in range(20):
        simulation.tick(IDLE)
    seen, copy = simulation.glance(), simulation.snapshot()
    arrays = [
        name
        for name in vars(Scored)
        if name.startswith(("truth_", "wanted_")) and name not in ("truth_payload_mass", "truth_touched")
    ]
    assert len(arrays) == 5
    for name in arrays:
        np.testing.assert_array_equal(getattr(seen, name), getattr(copy, name), err_msg=name)
    assert seen.truth_payload_mass == copy.truth_payload_mass == 1.5
    assert seen.estimate is simulation.estimate


def test_a_glance_follows_the_ticks() -> None:
    simulation = Simulation(UR5E, Scenario(), Settings())
    simulation.tick(IDLE)
    seen, before = simulation.glance(), simulation.snapshot()
    simulation.tick(IDLE)
    assert seen.estimate.tick == before.estimate.tick + 1


def test_a_point_turns_with_its_part() -> None:
    half = math.sqrt(0.5)  # a quarter turn about z takes x to y
    seen = snapshot(1, (1.0, 2.0, 3.0), (half, 0.0, 0.0, half))
    assert point_of(seen, JOINTS, "flange", (0.1, 0.0, 0.0)) == pytest.approx((1.0, 2.1, 3.0))


def test_any_turn_agrees_with_the_rotation_matrix() -> None:
    quaternion = (0.5, -0.1, 0.7, math.sqrt(1 - 0.25 - 0.01 - 0.49))
    expected = matrix_from_quaternion(quaternion) @ [0.3, -0.2, 0.5] + [1.0, 2.0, 3.0]
    assert point_of(snapshot(1, (1.0, 2.0, 3.0), quaternion), JOINTS, "tool", (0.3, -0.2, 0.5)) == pytest.approx(tuple(expected))


def test_links_are_named_by_their_joints() -> None:
    assert point_of(snapshot(1), JOINTS, "elbow") == (7.0, 8.0, 9.0)
    assert point_of(snapshot(1, (1.0, 0.0, 0.0)), JOINTS, "foot") == (0.0, 0.0, 0.0)
