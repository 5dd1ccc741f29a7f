"""What the contact detectors are fed with: signs, axes, points, and what is not valid (CD-2)."""

import numpy as np
import pytest

from app.files.library import load_arm, load_tool
from pendant.all_settings import Settings, apply
from pendant.inputs import NOTHING, Button, Command, Inputs
from pendant.program.steps import JointMove, Program
from pendant.tick.modes import Mode
from pendant.tick.source_signal import Signal
from sim.arm.scenario import Load, Scenario
from sim.estimation.momentum_observer import READY
from sim.exchange.desk import Wishes
from sim.plant.changes import FrictionChange, SensorFault
from sim.plant.touch import Push
from sim.simulation import Simulation

ARM, TOOL = load_arm("ur5e"), load_tool("sphere")
IDLE = Wishes(NOTHING, (), ())
HELD = Wishes(Inputs(held=frozenset({Button.FREE_DRIVE})), (), ())


def simulation(soft: bool = False, **changes: bool) -> Simulation:
    load = Load(mass=2.0, com=[0.05, -0.03, 0.06])
    scenario = Scenario(tool=TOOL, payload_true=load, payload_configured=load, mismatch="nominal", soft_sensor=soft, seed=3)
    sim = Simulation(ARM, scenario, apply(Settings(), {f"contact.{name}": on for name, on in changes.items()}))
    for _ in range(READY + 2):  # the links' torques are known after that
        sim.tick(IDLE)
    return sim


def mean(sim: Simulation, source: int, ticks: int, wishes: Wishes = IDLE) -> np.ndarray:
    """Mean force, acceleration and gravity over some ticks."""
    rows = []
    for _ in range(ticks):
        sim.tick(wishes)
        signal = sim.snapshot().estimate.signals.each()[source]
        assert signal is not None
        rows.append(signal[:9])
    return np.mean(rows, axis=0).reshape(3, 3)


def move(sim: Simulation, way: list[float]) -> None:
    """A joint move by `way` [rad], until it is in full swing."""
    goal = tuple((np.array(ARM.chain.home) + way).tolist())
    sim.tick(Wishes(Inputs(program=Program(steps=(JointMove(q=goal),))), (), ()))
    for k in range(450):
        sim.tick(Wishes(Inputs(commands=(Command.START_PROGRAM,)), (), ()) if k == 150 else IDLE)


def test_at_rest_force_is_mass_times_acceleration_in_the_flange() -> None:
    sim = simulation(flange=True)
    for source in (0, 1):
        mean(sim, source, 20)
        force, acceleration, gravity = mean(sim, source, 200)
        signal = sim.snapshot().estimate.signals.each()[source]
        assert isinstance(signal, Signal)
        assert signal.mass == pytest.approx(TOOL.mass + 2.0 + 0.13)  # the sensor's own plate is carried too
        assert force == pytest.approx(signal.mass * acceleration, abs=0.3)
        assert acceleration == pytest.approx(-gravity, abs=0.05)
        assert sim.snapshot().estimate.R_BF @ gravity == pytest.approx([0.0, 0.0, -9.81], abs=1e-3)


def test_a_force_against_the_tool_is_one_of_the_arm_the_other_way() -> None:
    sim = simulation()
    before = mean(sim, 0, 100)
    push = Wishes(NOTHING, (Push("tool", (0.0, 0.0, 0.1), (0.0, 20.0, 0.0)),), ())
    first = mean(sim, 0, 8, push)
    mean(sim, 0, 200, push)
    after = mean(sim, 0, 100, push)
    R = sim.snapshot().estimate.R_BF
    assert R @ (after[0] - before[0]) == pytest.approx([0.0, -20.0, 0.0], abs=1.0)
    change, acceleration = R @ (first[0] - before[0]), R @ (first[1] - before[1])
    assert change[1] < 0.0 < acceleration[1]  # opposite


@pytest.mark.parametrize(("part", "point", "way"), [("tool", (0.0, 0.0, 0.1), -1.0), ("elbow", (-0.3, 0.0, 0.0), 1.0)])
@pytest.mark.parametrize("soft", [False, True])
def test_who_moves_whom_at_the_flange(part: str, point: tuple[float, float, float], way: float, soft: bool) -> None:
    """CD-0: what touches the tool moves the arm; a push on the forearm moves the tool, in its first ticks."""
    sim = simulation(soft=soft)
    for _ in range(30):
        sim.tick(IDLE)
    told = []
    for force in (40.0, 80.0, 80.0, 80.0, 80.0):
        sim.tick(Wishes(NOTHING, (Push(part, point, (0.0, force, 0.0)),), ()))
        signal = sim.snapshot().estimate.signals.each()[0]
        assert signal is not None
        told.append(way * signal.driven)
    assert max(told) > 10.0
    assert next(one for one in told if abs(one) > 3.0) > 0.0  # later the load swings on a soft sensor


def test_a_load_off_the_axis_that_is_shaken_keeps_its_force_along_its_acceleration() -> None:
    """CD-0: a jump of friction lets the arm vibrate at 60 Hz; a turning that is known late would look like a contact's force."""
    load = Load(mass=4.0, com=[-0.08, 0.03, 0.05])
    scenario = Scenario(tool=TOOL, payload_true=load, payload_configured=load, mismatch="nominal", seed=3)
    sim = Simulation(ARM, scenario, Settings())
    for sensor in ("force_torque", "accelerometer", "gyro"):
        sim.tick(Wishes(NOTHING, (), (SensorFault(sensor=sensor, noise_factor=0.0),)))
    move(sim, [1.0, 0.3, -0.3, 1.0, 1.0, 1.0])
    rows = []
    for changes in ((FrictionChange(factor=1.4),), *((),) * 40):
        sim.tick(Wishes(NOTHING, (), changes))
        signal = sim.snapshot().estimate.signals.each()[0]
        assert signal is not None
        rows.append([*signal[:6], signal.mass, signal.lever, signal.sx, signal.sy, signal.sz])
    table = np.array(rows)
    force, acceleration, mass = table[:, :3], table[:, 3:6], table[0, 6]
    assert np.ptp(acceleration, axis=0).max() > 2.0
    contact = force - mass * acceleration
    assert np.linalg.norm(contact - contact[0], axis=1).max() < 6.5  # with a turning smoothed at 60 Hz 9.8 N
    assert table[0, 7] == pytest.approx(0.09, abs=0.01)  # of tool and load together
    # What is left is the turning's: it lies along its changes, which say how late it is known.
    changes, left = mass * table[1:, 8:].ravel(), (contact - contact[0])[1:].ravel()
    late = float(changes @ left / (changes @ changes))
    assert late == pytest.approx(0.65, abs=0.15)  # half a tick, and the filter
    assert np.linalg.norm(left - late * changes) < 0.7 * np.linalg.norm(left)


def test_after_an_outage_a_turning_is_no_jump() -> None:
    sim = simulation()
    sim.tick(Wishes(NOTHING, (), (SensorFault(sensor="gyro", outage=True),)))
    move(sim, [1.5, 0.0, 0.0, 0.0, 0.0, 1.5])
    sim.tick(Wishes(NOTHING, (), (SensorFault(sensor="gyro", noise_factor=0.0),)))
    accelerations = []
    for _ in range(10):
        sim.tick(IDLE)
        signal = sim.snapshot().estimate.signals.each()[0]
        if signal is not None:
            accelerations.append(signal[3:6])
    assert len(accelerations) > 5
    assert np.ptp(np.array(accelerations), axis=0).max() < 1.5


@pytest.mark.parametrize(("source", "part", "point"), [(2, "shoulder", (-0.425, 0.0, 0.138)), (3, "elbow", (-0.392, 0.0, 0.0))])
def test_a_push_on_a_link_shows_in_its_source(source: int, part: str, point: tuple[float, float, float]) -> None:
    sim = simulation()
    before = mean(sim, source, 200)
    push = Wishes(NOTHING, (Push(part, point, (0.0, 60.0, 0.0)),), ())
    mean(sim, source, 300, push)
    after = mean(sim, source, 100, push)
    change = after[0] - before[0]
    assert change[1] < -15.0  # most of it; the smallest force that explains the torques is damped
    assert abs(change[1]) > abs(change[0])
    assert after[1] == pytest.approx([0.0, 0.0, 9.81], abs=0.1)


def test_the_tool_centre_point_is_where_it_is() -> None:
    sim = simulation()
    sim.tick(IDLE)
    sim.tick(IDLE)
    plant = sim.plant
    body = plant.model.body("flange").id
    tip = plant.data.xpos[body] + plant.data.xmat[body].reshape(3, 3) @ TOOL.tcp
    assert sim.snapshot().estimate.tcp[:3] == pytest.approx(tip, abs=5e-4)


def test_the_effective_mass_is_that_of_the_links_at_the_flange() -> None:
    sim = simulation()
    sim.tick(IDLE)
    signal = sim.snapshot().estimate.signals.each()[0]
    assert signal is not None
    bare = Simulation(ARM, Scenario(mismatch="nominal"), Settings())
    J = bare.dynamics.update(bare.plant.q)[2][:3]
    mobility = J @ np.linalg.inv(bare.dynamics.mass(bare.plant.q)) @ J.T
    lightest = 1.0 / np.linalg.eigvalsh(mobility)[-1]
    assert signal.effective_mass == pytest.approx(lightest, rel=0.3)


def test_what_is_off_or_not_valid_gives_nothing() -> None:
    sim = simulation(links=False)
    sim.tick(IDLE)
    assert [signal is not None for signal in sim.snapshot().estimate.signals.each()] == [True, False, False, False]
    sim = simulation(flange=True)
    fault = SensorFault(sensor="accelerometer", outage=True)
    sim.tick(Wishes(NOTHING, (), (fault,)))
    sim.tick(IDLE)
    sim.tick(IDLE)
    assert [signal is not None for signal in sim.snapshot().estimate.signals.each()] == [False, False, True, True]


def guided(**changes: bool) -> Simulation:
    """A simulation in free-drive, the button held."""
    sim = simulation(**changes)
    for _ in range(1200):
        if sim.tick(HELD).mode is Mode.FREE_DRIVE:
            return sim
    raise AssertionError("free-drive was not entered")


@pytest.mark.parametrize("on", [False, True])
def test_in_free_drive_there_are_signals_where_contacts_are_looked_for(on: bool) -> None:
    """Else nothing needs them: while the arm is free no program begins, which would need those of the ticks before."""
    sim = guided(on=on)
    sim.tick(HELD)
    assert [signal is not None for signal in sim.estimate.signals.each()] == [on, False, on, on]
    sim.tick(Wishes(Inputs(commands=(Command.DETECTION,)), (), ()))
    for _ in range(2):
        sim.tick(HELD)
    assert [signal is not None for signal in sim.estimate.signals.each()] == [not on, False, not on, not on]


def test_a_knock_is_found_soon_after_detection_was_switched_on_in_free_drive() -> None:
    """The detectors begin with the first signal: what was before the gap is compared with nothing."""
    sim = guided()
    sim.tick(Wishes(Inputs(held=HELD.inputs.held, commands=(Command.DETECTION,)), (), ()))
    for _ in range(50):
        assert not sim.tick(HELD).contacts
    knock = (Push("tool", (0.0, 0.0, 0.1), (0.0, 60.0, 0.0)),)
    assert any(sim.tick(Wishes(HELD.inputs, knock, ())).contacts for _ in range(25))


def test_when_free_drive_is_over_there_are_signals() -> None:
    sim = guided()
    for _ in range(2):
        sim.tick(Wishes(Inputs(commands=(Command.LEAVE_FREE_DRIVE,)), (), ()))
    assert [signal is not None for signal in sim.estimate.signals.each()] == [True, False, True, True]


def test_a_payload_configured_anew_is_the_mass_from_then_on() -> None:
    sim = simulation()
    sim.tick(IDLE)
    sim.tick(Wishes(Inputs(load=Load(mass=1.0), settings={"tools.ramp": 0.0}), (), ()))
    for _ in range(600):
        sim.tick(IDLE)
    signal = sim.snapshot().estimate.signals.each()[0]
    assert signal is not None
    assert signal.mass == pytest.approx(TOOL.mass + 1.0 + 0.13)


def test_a_force_at_the_end_of_the_sensors_range_is_marked() -> None:
    sim = simulation(flange=True)
    sim.tick(IDLE)
    assert not any(signal.saturated for signal in sim.snapshot().estimate.signals.each() if signal is not None)
    mean(sim, 0, 5, Wishes(NOTHING, (Push("tool", (0.0, 0.0, 0.1), (0.0, 300.0, 0.0)),), ()))
    tool, flange, elbow, _ = sim.snapshot().estimate.signals.each()
    assert tool is not None
    assert flange is not None
    assert elbow is not None
    assert max(map(abs, tool[:3])) == 100.0  # the data file's range
    assert (tool.saturated, flange.saturated, elbow.saturated) == (1.0, 1.0, 1.0)  # the links' torques are told by it
