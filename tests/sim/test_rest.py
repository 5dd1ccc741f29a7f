"""Time that passes without physics."""

import numpy as np
import pytest

from pendant.all_settings import Settings
from pendant.inputs import Command
from pendant.tick.modes import Mode
from sim.arm.scenario import Moving, Scenario
from sim.plant.changes import Temperature
from sim.sensing import calibration
from sim.simulation import Simulation
from tests.sim.arms import PROBE, UR5E
from tests.sim.bench import NOMINAL, Bench

DRAWN = Scenario(seed=5, tool=PROBE)


def test_zeros_after_a_rest_are_those_after_as_many_simulated_seconds_bit_for_bit() -> None:
    lasting, resting = Bench(DRAWN), Bench(DRAWN)
    for bench in (lasting, resting):
        bench.run(0.3)
    lasting.run(4.0)
    resting.simulation.rest(4.0)
    zeros = [bench.simulation.sensors.wrench_offset for bench in (lasting, resting)]
    assert zeros[0].tobytes() == zeros[1].tobytes()
    assert (zeros[0] != lasting.simulation.calibration.wrench_offset).all()
    for bench in (lasting, resting):
        bench.run(1.0)
    zeros = [bench.simulation.sensors.wrench_offset for bench in (lasting, resting)]
    assert zeros[0].tobytes() == zeros[1].tobytes()


def test_the_drift_has_a_source_of_its_own() -> None:
    """What else is drawn of a seed stays as it was when there were two sources."""
    errors, noise = np.random.default_rng(5).spawn(2)
    simulation = Simulation(UR5E, DRAWN, Settings())
    expected = calibration.draw(UR5E, errors)
    assert (simulation.calibration.wrench_offset == expected.wrench_offset).all()
    assert (simulation.calibration.wrench_warm == expected.wrench_warm).all()
    assert (simulation.sensors._noise[3, :6] == (noise.standard_normal((500, 36)) * simulation.sensors._sigma)[3, :6]).all()


def test_the_nominal_arm_does_not_drift() -> None:
    bench = Bench(NOMINAL)
    bench.run(0.1)
    bench.simulation.rest(3600)
    assert not bench.simulation.sensors.wrench_offset.any()


def test_clocks_go_on_together() -> None:
    bench = Bench(DRAWN)
    bench.run(0.1)
    bench.simulation.rest(2)
    assert bench.simulation.tick_count == bench.simulation.estimator.tick == 1050
    assert bench.plant.data.time == pytest.approx(2.1)
    bench.tick()
    snapshot = bench.simulation.snapshot()
    assert snapshot.tick == snapshot.estimate.tick == 1051
    (event,) = bench.do(Command.EMERGENCY_STOP).events
    assert event.tick == 1052


def test_joints_cool_as_in_simulated_seconds() -> None:
    lasting, resting = Bench(NOMINAL), Bench(NOMINAL)
    for bench in (lasting, resting):
        bench.change(Temperature(celsius=44.0), Temperature(joint="elbow", celsius=10.0))
        bench.run(0.3)
    lasting.run(10.0)
    resting.simulation.rest(10)
    warm, cool = lasting.plant.temperature, resting.plant.temperature
    assert np.abs(warm - 44.0).max() > 0.05
    assert cool == pytest.approx(warm, abs=2e-3)
    resting.simulation.rest(8 * 3600)
    assert resting.plant.temperature == pytest.approx(25.0, abs=0.01), "the room's"


def test_nothing_else_changes() -> None:
    """Of two nominal arms at room temperature one rests: both go on alike, bit for bit, but for the time."""
    lasting, resting = Bench(NOMINAL), Bench(NOMINAL)
    rows: list[list[bytes]] = [[], []]
    for bench, seen in zip((lasting, resting), rows, strict=True):
        bench.change(Temperature(celsius=25.0))
        bench.run(0.3)
        bench.plant.temperature[:] = 25.0
        if bench is resting:
            bench.simulation.rest(7200)
        for _ in range(600):
            bench.tick()
            seen.append(bench.plant.q.tobytes() + bench.estimate.w_sensor.tobytes() + bench.estimate.qd.tobytes())
    assert rows[0] == rows[1]
    assert not resting.events


@pytest.mark.parametrize("seed", range(4))
def test_a_robot_that_rested_says_nothing_of_it_and_goes_on(seed: int) -> None:
    bench = Bench(Scenario(seed=seed, tool=PROBE))
    bench.run(0.5)
    start = bench.flange
    for _ in range(3):
        bench.simulation.rest(1200)
        bench.run(0.5)
    assert not bench.events
    assert bench.mode is Mode.TEACH
    assert np.abs(bench.flange - start).max() < 1e-3


def test_an_object_that_moves_is_where_it_would_be_by_then() -> None:
    box = Moving(name="shuttle", position=[2.0, 2.0, 0.2], size=[0.1, 0.1, 0.1], amplitude=[0.5, 0.0, 0.0], period=8.0)
    lasting, resting = (Bench(Scenario(mismatch="nominal", world=[box])) for _ in range(2))
    for bench in (lasting, resting):
        bench.run(0.2)
    lasting.run(3.0)
    resting.simulation.rest(3)
    for bench in (lasting, resting):
        bench.run(0.1)
    assert np.allclose(lasting.plant.object_poses(), resting.plant.object_poses(), atol=1e-9)


@pytest.mark.parametrize("seconds", [-1.0, 0.5, float("nan"), float("inf")])
def test_a_rest_is_of_whole_seconds(seconds: float) -> None:
    simulation = Simulation(UR5E, DRAWN, Settings())
    with pytest.raises(ValueError, match="expected whole seconds, 0 or more"):
        simulation.rest(seconds)
    assert simulation.tick_count == 0


def test_a_rest_before_the_first_tick() -> None:
    bench = Bench(DRAWN)
    bench.simulation.rest(0)
    assert bench.simulation.tick_count == 0
    bench.simulation.rest(60)
    bench.run(0.1)
    assert bench.simulation.tick_count == bench.estimate.tick == 30_050
