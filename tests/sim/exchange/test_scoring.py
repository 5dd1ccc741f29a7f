"""A glance shows what a snapshot copies."""

import numpy as np

from pendant.all_settings import Settings
from pendant.inputs import NOTHING
from sim.arm.scenario import Load, Scenario
from sim.exchange.desk import Wishes
from sim.exchange.scoring import Scored
from sim.simulation import Simulation
from tests.sim.arms import UR5E

IDLE = Wishes(NOTHING, (), ())


def test_a_glance_shows_what_a_snapshot_copies() -> None:
    simulation = Simulation(UR5E, Scenario(payload_true=Load(mass=1.5), seed=4), Settings())
    for _ in range(20):
        simulation.tick(IDLE)
    seen, copy = simulation.glance(), simulation.snapshot()
    arrays = [name for name in vars(Scored) if name.startswith(("truth_", "wanted_")) and name != "truth_payload_mass"]
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
