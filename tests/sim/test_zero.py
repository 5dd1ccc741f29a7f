"""The flange sensor's zero in the simulation: subtracted once from every sample, and no contact, push or step to anybody."""

import numpy as np
import pytest

from pendant.all_settings import Settings, apply
from pendant.events.event import Event, Kind
from pendant.inputs import NOTHING, Command, Inputs
from sim.arm.scenario import Load, Scenario
from sim.exchange.desk import Wishes
from sim.plant.changes import SensorFault
from sim.plant.touch import Push
from sim.simulation import Simulation
from tests.sim.arms import TWO_KG, UR5E

FELT = {"contact.on": True, "signals.push.on": True, "signals.push.reported": True, "signals.push.threshold": 5.0}
IDLE = Wishes(NOTHING, (), ())
ZERO = Wishes(Inputs(commands=(Command.ZERO_SENSOR,)), (), ())


class Bench:
    """An arm of a seed, at rest."""

    def __init__(self, seed: int = 1, load: Load | None = None, **changes: float | bool) -> None:
        load = load or Load(mass=0.0)
        settings = apply(Settings(), {name.replace("__", "."): value for name, value in changes.items()} | FELT)
        self.device = Simulation(UR5E, Scenario(seed=seed, payload_true=load, payload_configured=load), settings)
        self.events: list[Event] = []
        self.felt: list[np.ndarray] = []

    def run(self, ticks: int, wishes: Wishes = IDLE) -> "Bench":
        for _ in range(ticks):
            self.events += self.device.tick(wishes).events
            self.felt.append(self.device.estimate.w_sensor.copy())
        return self

    def mean(self, ticks: int = 100) -> np.ndarray:
        return np.mean(self.felt[-ticks:], axis=0)

    def kinds(self) -> list[Kind]:
        return [event.kind for event in self.events]


def test_it_is_subtracted_once_from_every_sample_from_the_next_tick_on() -> None:
    one, other = Bench(), Bench()
    for bench in (one, other):
        bench.run(700)
    one.run(1, ZERO).run(500)
    other.run(1).run(500)
    zero = np.array(one.device.supervisor.zero)
    assert np.linalg.norm(zero[:3]) > 1.0
    for tick, (with_zero, without) in enumerate(zip(one.felt, other.felt, strict=True)):
        np.testing.assert_allclose(without - with_zero, zero if tick > 700 else 0.0 * zero, atol=1e-12)


@pytest.mark.parametrize("load", [None, TWO_KG], ids=["empty", "2 kg"])
@pytest.mark.parametrize("seed", [3, 4, 7])
def test_nothing_is_felt_of_it(seed: int, load: Load | None) -> None:
    bench = Bench(seed, load).run(1000)
    bench.events.clear()
    bench.run(1, ZERO).run(1500)
    assert bench.kinds() == [Kind.SENSOR_ZEROED]
    user = bench.device.estimate.F_user
    assert np.linalg.norm(user[:3]) < 1.5


def test_afterwards_contacts_and_pushes_are_found_as_before() -> None:
    bench = Bench(3).run(1000).run(1, ZERO).run(600)
    bench.events.clear()
    bench.run(100, Wishes(NOTHING, (Push("flange", (0.0, 0.0, 0.0), (0.0, 0.0, -20.0)),), ()))
    assert {Kind.CONTACT_GAINED, Kind.PUSHED} <= set(bench.kinds())


def test_detection_that_is_switched_on_just_after_sees_no_contact() -> None:
    bench = Bench(3).run(1).run(1, Wishes(Inputs(commands=(Command.DETECTION,)), (), ())).run(1000)
    assert not bench.device.settings.contact.on
    bench.events.clear()
    bench.run(1, ZERO).run(3).run(1, Wishes(Inputs(commands=(Command.DETECTION,)), (), ())).run(500)
    assert bench.kinds() == [Kind.SENSOR_ZEROED, Kind.SETTING_CHANGED]


@pytest.mark.parametrize(("size", "why_not"), [(3.0, ""), (6.0, "6.0 N is more than its zero can be off")])
def test_a_drifted_sensor_is_put_right_as_far_as_a_sensor_drifts(size: float, why_not: str) -> None:
    bench = Bench()
    bench.device = Simulation(UR5E, Scenario(mismatch="nominal"), Settings())
    bench.run(1, Wishes(NOTHING, (), (SensorFault(sensor="force_torque", channel=2, offset=size),))).run(800).events.clear()
    bench.run(1, ZERO).run(100)
    (event,) = bench.events
    if why_not:
        assert str(event.values["reason"]).startswith(why_not)
    else:
        assert event.values["z"] == pytest.approx(size, abs=0.1)
        assert UR5E.sensors.force_torque is not None
        assert bench.mean()[2] == pytest.approx(-9.81 * UR5E.sensors.force_torque.plate_mass, abs=0.1)


def test_a_saturated_sensor_is_known_as_such_whatever_is_subtracted() -> None:
    """CD-9: a ratio is not taken of a force that the sensor has cut off."""
    bench = Bench(2).run(700).run(1, ZERO).run(10)
    bench.run(60, Wishes(NOTHING, (Push("flange", (0.0, 0.0, 0.0), (0.0, 0.0, -300.0)),), ()))
    signal = next(iter(bench.device.estimate.signals.each()))
    assert signal is not None
    assert abs(bench.felt[-1][:3]).max() != pytest.approx(100.0)
    assert signal.saturated
