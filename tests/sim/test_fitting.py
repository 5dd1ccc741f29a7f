"""Tool and payload as the controller believes in them: changed between two ticks, led over while the arm stands."""

import msgspec
import numpy as np
import pytest

import pendant.equipment.tools
from pendant.all_settings import Settings, apply
from pendant.events.event import Kind
from pendant.inputs import Inputs
from pendant.program.steps import LinearMove
from pendant.tick.modes import Mode
from sim.arm.chain import tool_body
from sim.arm.frames import quaternion_from_matrix, rotation_from_rpy
from sim.arm.scenario import Load, Scenario, ToolModel, table
from sim.exchange.desk import Wishes
from tests.sim.bench import Bench

G = 9.81
GRIPPER = ToolModel(name="gripper", mass=0.9, com=[0.0, 0.0, 0.06], tcp=[0.0, 0.02, 0.16], length=0.16)
PROBE = ToolModel(name="probe", mass=0.3, com=[0.0, 0.0, 0.03], tcp=[0.0, 0.0, 0.05], inertia=[1e-3, 1e-3, 1e-3, 0.0, 0.0, 0.0])


def wish(tool: str = "", load: Load | None = None, tools: tuple[pendant.equipment.tools.Tool, ...] = ()) -> Wishes:
    return Wishes(Inputs(tool=tool, load=load, tools=tools), (), ())


def bench(scenario: Scenario, ramp: float) -> Bench:
    made = Bench(scenario, apply(Settings(), {"tools.ramp": ramp}))
    made.run(1.0)
    return made


def test_the_table_begins_with_the_tool_in_use_which_wins() -> None:
    other = ToolModel(name="gripper", mass=2.0, com=[0.0, 0.0, 0.0], tcp=[0.0, 0.0, 0.2])
    assert table(Scenario(tool=GRIPPER, tools=[other, PROBE])) == [GRIPPER, PROBE]
    assert [tool.name for tool in table(Scenario(tools=[PROBE, GRIPPER]))] == ["flange", "probe", "gripper"]
    bare = ToolModel(name="flange", mass=0.1, com=[0.0, 0.0, 0.0], tcp=[0.0, 0.0, 0.0])
    assert table(Scenario(tools=[PROBE, bare])) == [bare, PROBE]
    assert [tool.mass for tool in table(Scenario())] == [0.0]


def test_a_tool_takes_its_point_and_its_load_from_the_next_tick_on() -> None:
    device = bench(Scenario(mismatch="nominal", tool=GRIPPER, payload_configured=Load(mass=1.0), tools=[PROBE]), 0.0)
    before = device.estimate
    device.tick(wish("probe"))
    assert device.estimate.tcp[:3] == pytest.approx(before.tcp[:3], abs=1e-4), "a tick that has begun ends as it began"
    assert device.estimate.load_mass == before.load_mass == pytest.approx(0.13 + 0.9 + 1.0)
    device.tick()
    seen = device.estimate
    assert seen.load_mass == pytest.approx(0.13 + 0.3)
    assert seen.tcp[:3] == pytest.approx(seen.p_BF + seen.R_BF @ [0.0, 0.0, 0.05], abs=1e-9)
    signal = seen.signals.each()[0]
    assert signal is not None
    assert signal.mass == pytest.approx(0.13 + 0.3)
    assert device.simulation.dynamics.load.inertia[0, 0] > 1e-3, "the inertia that the table says"


def test_the_tool_in_use_is_believed_as_the_table_is_changed() -> None:
    device = bench(Scenario(mismatch="nominal", tool=GRIPPER, payload_configured=Load(mass=1.0), tools=[PROBE]), 0.0)
    assert device.simulation.tools == (GRIPPER, PROBE)
    ball = pendant.equipment.tools.Tool(name="gripper", mass=1.4, com=[0.0, 0.0, 0.1], tcp=[0.0, 0.0, 0.3])
    device.tick(wish(tools=(ball, PROBE)))
    device.tick()
    assert device.simulation.tools == (ball, PROBE)
    seen = device.estimate
    assert seen.load_mass == pytest.approx(0.13 + 1.4 + 1.0), "with what it holds"
    assert seen.tcp[:3] == pytest.approx(seen.p_BF + seen.R_BF @ [0.0, 0.0, 0.3], abs=1e-9)
    # Without a shape it counts as a sphere of water: r = (3 m / (4 pi rho))^(1/3), 2/5 m r^2.
    radius = (3.0 * 1.4 / (4000.0 * np.pi)) ** (1.0 / 3.0)
    assert tool_body(ball).inertia == pytest.approx(0.4 * 1.4 * radius**2 * np.eye(3))


def test_a_tool_that_is_turned_is_moved_by_its_own_frame_as_soon_as_it_is_in_use() -> None:
    bent = msgspec.structs.replace(GRIPPER, name="bent", rpy=[0.3, 0.5, 0.0])
    device = bench(Scenario(mismatch="nominal", tool=GRIPPER, payload_true=Load(mass=0.0), tools=[bent]), 0.0)
    device.tick(wish("bent"))
    device.run(0.5)
    start = device.estimate
    R_FT = rotation_from_rpy(bent.rpy)
    position = np.add(start.tcp[:3], [0.0, 0.05, 0.0])
    # The tool is to keep its orientation: so is the flange.
    quaternion = quaternion_from_matrix(start.R_BF @ R_FT)
    device.start(LinearMove(position=tuple(position.tolist()), quaternion=tuple(quaternion.tolist()), speed=0.2))
    device.run(1.5)
    assert device.mode is Mode.TEACH
    assert device.estimate.tcp[:3] == pytest.approx(position, abs=3e-4)
    assert pytest.approx(start.R_BF, abs=2e-3) == device.estimate.R_BF


def test_the_load_goes_over_in_a_straight_line_of_mass_and_moment() -> None:
    first, last = Load(mass=1.0, com=[0.02, 0.0, 0.04]), Load(mass=3.0, com=[0.0, 0.0, 0.10])
    device = bench(Scenario(mismatch="nominal", payload_configured=first), 0.2)
    device.tick(wish(load=last))
    masses, moments = [], []
    for _ in range(103):
        device.tick()
        load = device.simulation.dynamics.load
        masses.append(load.mass - 0.13)
        moments.append(load.mass * load.com)
    assert masses[:101] == pytest.approx(np.linspace(1.0, 3.0, 101).tolist())
    start, end = np.array([0.02, 0.0, 0.04]), 3.0 * np.array([0.0, 0.0, 0.10])
    for k in (0, 30, 100):
        assert moments[k] == pytest.approx(start + k / 100 * (end - start), abs=1e-9)
    assert masses[-1] == masses[100]


def test_a_change_in_the_middle_of_another_does_not_jump() -> None:
    device = bench(Scenario(mismatch="nominal"), 0.2)
    device.tick(wish(load=Load(mass=2.0)))
    for _ in range(51):
        device.tick()
    assert device.simulation.dynamics.load.mass == pytest.approx(0.13 + 1.0)
    device.tick(wish(load=Load(mass=0.0)))
    device.tick()
    assert device.simulation.dynamics.load.mass == pytest.approx(0.13 + 1.02)
    device.run(0.4)
    assert device.simulation.dynamics.load.mass == pytest.approx(0.13)


@pytest.mark.parametrize("seed", [1, 2])
def test_a_payload_led_over_hardly_moves_the_arm(seed: int) -> None:
    """2 kg are carried and nobody said so; when they are entered, the hold torque follows in a second. At once, the flange
    moves by more than five times as much."""
    ways = {}
    for ramp in (0.0, 1.0):
        device = bench(Scenario(seed=seed, payload_true=Load(mass=2.0)), ramp)
        start = device.flange
        device.tick(wish(load=Load(mass=2.0)))
        ways[ramp] = device.drift(1.5, start)
        assert [event.kind for event in device.events] == [Kind.PAYLOAD_CHANGED]
    assert ways[1.0] < 0.0006
    assert ways[0.0] > 5.0 * ways[1.0]


def test_what_the_joints_learned_from_the_old_load_is_forgotten() -> None:
    """A wrong payload, learned from while a program moves, passes for soft springs; later it would pass for a push."""
    device = Bench(Scenario(seed=4, payload_true=Load(mass=2.0, com=[0.02, 0.0, 0.06])), apply(Settings(), {"tools.ramp": 0.1}))
    device.run(0.8)
    device.start_joint_move([0.0, -1.2, 1.5, -1.87, -0.77, 0.8], 0.6)
    device.run(1.5)
    learned = device.simulation.estimator.transmission.stiffer
    assert np.abs(learned).max() > 0.02
    device.tick(wish(load=Load(mass=2.0, com=[0.02, 0.0, 0.06])))
    device.run(0.4)
    assert np.abs(learned).max() == 0.0


@pytest.mark.parametrize("wished", [wish("gripper"), wish(load=Load(mass=3.0))], ids=["tool", "payload"])
def test_a_change_at_once_is_no_contact_and_no_push(wished: Wishes) -> None:
    """With every detector and source on; the estimates jump by 20 N and 10 N."""
    names = ("contact.on", "contact.flange", "signals.push.on", "signals.push.reported", "signals.joints.on", "signals.twist.on")
    two = Load(mass=2.0)
    settings = apply(Settings(), {"tools.ramp": 0.0, "signals.push.angle": 90.0} | dict.fromkeys(names, True))
    device = Bench(Scenario(seed=1, payload_true=two, payload_configured=two, tools=[GRIPPER]), settings)
    device.run(1.0)
    device.tick(wished)
    device.run(2.5)
    assert {event.kind for event in device.events} <= {Kind.TOOL_CHANGED, Kind.PAYLOAD_CHANGED}
