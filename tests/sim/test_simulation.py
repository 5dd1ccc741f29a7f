"""One tick of all of it: the same for a seed, blind to the truth, and what a laboratory may do to it."""

import dataclasses
import functools
from collections.abc import Callable
from typing import Any

import msgspec
import numpy as np
import pytest

import sim.simulation
from pendant.all_settings import Settings, apply
from pendant.events.event import Event, Kind
from pendant.inputs import Button, Command, Inputs
from pendant.program.steps import JointMove, LinearMove, Program, Wait
from pendant.tick.modes import Mode
from sim.arm.arm_file import Arm
from sim.arm.scenario import BoxObject, Load, Scenario
from sim.exchange.desk import Wishes
from sim.flange.external_wrench import ExternalWrench, Odds
from sim.plant.changes import AttachPayload, DropPayload, FrictionChange, MoveObject, SensorFault, Temperature
from sim.plant.touch import Push, Touch
from sim.sensing.calibration import Calibration
from sim.simulation import Simulation
from tests.sim.arms import PROBE, TWO_KG, UR5E
from tests.sim.bench import CENTRE, IDLE, NOMINAL, Bench, push

TABLE = BoxObject(name="table", position=[0.6, 0.6, 0.0], size=[0.4, 0.4, 0.1])
SETTINGS = apply(
    Settings(),
    # a push that does not care how fast the arm gets is not to end it
    {
        "activation.period": 0.5,
        "sequence.period": 0.5,
        "limits.operation.joint_speed.on": False,
        "limits.operation.tcp_speed.on": False,
        "collision.on": False,  # a payload that falls off a fast arm is one, and would end the program too soon
    },
)
SCENARIO = Scenario(seed=11, tool=PROBE, payload_true=TWO_KG, payload_configured=Load(mass=1.8), world=[TABLE])


def script(tick: int) -> Wishes:
    """5.6 s in which much happens: guided, sensors failing, stopped, reset, a program, a drop."""
    held = frozenset({Button.FREE_DRIVE}) if tick < 800 else frozenset()
    released = frozenset({Button.FREE_DRIVE}) if tick == 800 else frozenset()
    move = JointMove(q=(0.2, -1.3, 1.4, -1.8, -1.5, 0.3), speed=1.0, acceleration=1.0)
    steps = (move, Wait(duration=0.05), LinearMove(position=(9.0, 0.0, 0.0), quaternion=(0.0, 1.0, 0.0, 0.0)))
    commands = {
        1300: (Command.EMERGENCY_STOP,),
        1900: (Command.RESET,),
        2150: (Command.START_PROGRAM,),
        2600: (Command.NORMAL,),
    }.get(tick, ())
    touches: list[Touch] = []
    if 820 < tick < 1300:
        touches.append(push("flange", (5.0, 14.0, -5.0), (0.5, 0.0, 0.2)))
    if 1000 < tick < 1200:
        touches.append(push("elbow", (0.0, 5.0, 10.0)))
    changes = {
        300: (Temperature(celsius=35.0), FrictionChange(joint="elbow", factor=1.3)),
        900: (SensorFault(sensor="gyro", noise_factor=3.0),),
        1250: (SensorFault(sensor="force_torque", outage=True),),
        1350: (SensorFault(sensor="force_torque"),),
        2500: (DropPayload(),),
    }.get(tick, ())
    program = Program(name="trip", steps=steps) if tick == 1950 else None
    return Wishes(Inputs(held, released, commands, {}, program), tuple(touches), changes)


def play(simulation: Simulation) -> tuple[bytes, list[Event], bytes]:
    """Events as bytes and as they are; all true joint angles as bytes."""
    events: list[Event] = []
    angles = bytearray()
    where = simulation.plant
    for tick in range(2800):
        events += simulation.tick(script(tick)).events
        angles += where.q.tobytes()
    return msgspec.json.encode(events), events, bytes(angles)


@functools.cache
def played(seed: int, mismatch: str = "on") -> tuple[bytes, list[Event], bytes]:
    scenario = msgspec.structs.replace(SCENARIO, seed=seed, mismatch=mismatch)
    return play(Simulation(UR5E, scenario, SETTINGS))


def test_the_script_does_what_it_is_for() -> None:
    kinds = {event.kind for event in played(11)[1]}
    wanted = {Kind.ENTERED, Kind.MANIPULATION, Kind.WRENCH_LOST, Kind.EMERGENCY_STOP, Kind.RESET, Kind.PROGRAM_STARTED}
    assert Kind.PROGRAM_FAILED in kinds
    assert wanted <= kinds


def test_the_same_seed_gives_the_same_events_and_angles_bit_for_bit() -> None:
    events, _, angles = play(Simulation(UR5E, SCENARIO, SETTINGS))
    assert events == played(11)[0]
    assert angles == played(11)[2]


def test_another_seed_and_no_mismatch_give_other_events() -> None:
    first, second, nominal = (played(*case)[0] for case in ((11,), (12,), (11, "nominal")))
    assert len({first, second, nominal}) == 3


# The truth


class Sealed:
    """A plant that nobody can look into: while closed, every number in it is NaN, and to ask it for anything is an error."""

    def __init__(self, plant: Any) -> None:
        self.__dict__["plant"] = plant
        self.__dict__["kept"] = []
        owners = (plant.data, plant.model)
        names = ((owner, name) for owner in owners for name in dir(owner) if not name.startswith("_"))
        self.__dict__["of_mujoco"] = [(owner, name) for owner, name in names if self._is_real(getattr(owner, name))]
        self.close()

    @staticmethod
    def _is_real(value: object) -> bool:
        return isinstance(value, np.ndarray) and value.dtype == float and value.size > 0

    def _arrays(self) -> list[np.ndarray]:
        arrays = [getattr(owner, name) for owner, name in self.of_mujoco]
        arrays += [x for owner in (self.plant, self.plant.friction) for x in vars(owner).values() if self._is_real(x)]
        return [x for x in arrays if x.flags.writeable and x.size]

    def close(self) -> None:
        kept = [(x, x.copy()) for x in self._arrays()]
        assert len(kept) > 150
        for array, _ in kept:
            array.fill(np.nan)
        self.__dict__["kept"] = kept

    def opened(self, call: Callable[..., Any]) -> Callable[..., Any]:
        """`call`, during which the plant is as it is."""

        def inner(*args: Any) -> Any:
            for array, values in self.kept:
                array[...] = values
            self.__dict__["kept"] = []
            try:
                return call(*(self.plant if arg is self else arg for arg in args))
            finally:
                self.close()

        return inner

    def __getattr__(self, name: str) -> Any:
        if name == "advance":
            return self.opened(self.plant.advance)
        raise AssertionError(f"somebody looked at the truth: {name}")


def nan(count: int) -> list[float]:
    return [float("nan")] * count


def blinded_arm(arm: Arm) -> Arm:
    """Without what only the plant needs: torque ripple, warming. What a sensor's noise is at most is in its data sheet."""
    replace = msgspec.structs.replace
    thermals = replace(arm.thermals, capacity=nan(6), resistance=nan(6), ambient=float("nan"))
    return replace(arm, motors=replace(arm.motors, ripple=nan(6)), thermals=thermals)


def blinded_calibration(errors: Calibration) -> Calibration:
    """Without the sensors' errors: they reach the controller in measurements alone."""
    names = ("link_mass", "link_centre", "ripple", "ripple_phase", "wrench_gain", "wrench_offset", "wrench_warm")
    return dataclasses.replace(errors, **{name: np.full_like(getattr(errors, name), np.nan) for name in names})


def test_truth_never_reaches_the_controller(monkeypatch: pytest.MonkeyPatch) -> None:
    """With every truth a NaN wherever estimator, supervisor and controller could look, the events are the same bytes."""
    for name in ("Estimator", "Controller"):
        real = getattr(sim.simulation, name)

        def blind(arm: Arm, errors: Calibration, *rest: Any, real: Any = real, **named: Any) -> Any:
            return real(blinded_arm(arm), blinded_calibration(errors), *rest, **named)

        monkeypatch.setattr(sim.simulation, name, blind)
    simulation = Simulation(UR5E, SCENARIO, SETTINGS)
    plant = simulation.plant
    sealed = Sealed(plant)
    simulation.plant = sealed  # type: ignore[assignment]
    simulation.sensors.read = sealed.opened(simulation.sensors.read)  # type: ignore[method-assign]
    apply, lab = simulation.apply, {}

    def laboratory(change: Any) -> None:
        """A laboratory may touch the truth: in here the simulation has its plant back."""
        simulation.plant = plant
        try:
            sealed.opened(apply)(change)
        finally:
            simulation.plant = sealed  # type: ignore[assignment]
        lab[type(change)] = True

    simulation.apply = laboratory  # type: ignore[method-assign]
    simulation.scenario = msgspec.structs.replace(SCENARIO, payload_true=Load(mass=float("nan")), world=[], seed=0)
    simulation.arm = blinded_arm(UR5E)
    events: list[Event] = []
    for tick in range(2800):
        events += simulation.tick(script(tick)).events
        assert np.isnan(plant.q).all(), "the plant must be closed between ticks"
    assert msgspec.json.encode(events) == played(11)[0]
    assert len(lab) == 4


def test_the_seal_notices_who_looks() -> None:
    simulation = Simulation(UR5E, SCENARIO, SETTINGS)
    simulation.plant = Sealed(simulation.plant)  # type: ignore[assignment]
    with pytest.raises(AssertionError, match="somebody looked at the truth"):
        simulation.tick(IDLE)


# Snapshots


def frozen(value: object) -> object:
    """All of a value, arrays as bytes, to compare later."""
    if isinstance(value, np.ndarray):
        return value.tobytes()
    if dataclasses.is_dataclass(value) and not isinstance(value, type):
        return {field.name: frozen(getattr(value, field.name)) for field in dataclasses.fields(value)}
    return repr(value)


def test_a_snapshot_never_changes_afterwards() -> None:
    bench = Bench(SCENARIO)
    bench.enter()
    bench.run(0.1, push("flange", (0.0, 30.0, 0.0)), push("wrist_1", (0.0, 30.0, 0.0)))
    first = bench.simulation.snapshot()
    before = frozen(first)
    bench.change(DropPayload(), MoveObject(name="table", position=[0.0, 2.0, 0.0]))
    bench.run(0.2, push("flange", (0.0, 60.0, 20.0)))
    assert frozen(first) == before
    later = bench.simulation.snapshot()
    for field in dataclasses.fields(first.estimate):
        changed = frozen(getattr(later.estimate, field.name)) != frozen(getattr(first.estimate, field.name))
        same = {
            "joints_valid",
            "wrench_valid",
            "acceleration_valid",
            "following",  # free-drive follows nothing
            "link_force",
            "clipped",
            "g_B",
            "degraded",
            "tau_blur",  # of the arm's encoders
            "lost",
            "touched",
            "load_mass",
            "missing_mass",  # the flange sensor tells it
        }
        assert changed or field.name in same
    assert (later.truth_links != first.truth_links).any()
    assert (later.truth_objects != first.truth_objects).any()
    assert first.truth_payload_mass == 2.0
    assert later.truth_payload_mass == 0.0


def test_a_snapshot_shares_no_memory_with_the_simulation() -> None:
    bench = Bench(SCENARIO)
    bench.run(0.01)
    first, second = bench.simulation.snapshot(), bench.simulation.snapshot()
    for owner, twin in ((first, second), (first.estimate, second.estimate)):
        for field in dataclasses.fields(owner):
            mine, other = getattr(owner, field.name), getattr(twin, field.name)
            if isinstance(mine, np.ndarray):
                assert not np.shares_memory(mine, other), field.name
                assert not np.shares_memory(mine, bench.plant.data.qpos)
    for mine, other in zip(first.estimate.whose, second.estimate.whose, strict=True):
        assert not (isinstance(mine, np.ndarray) and np.shares_memory(mine, other))
    before = frozen(second)
    first.estimate.q[:] = 99.0
    first.truth_links[:] = 99.0
    assert frozen(second) == before


def test_a_snapshot_needs_a_tick() -> None:
    with pytest.raises(RuntimeError, match="at least one tick"):
        Simulation(UR5E, NOMINAL, Settings()).snapshot()


def test_a_snapshot_tells_mode_touches_and_both_payloads() -> None:
    bench = Bench(Scenario(payload_true=TWO_KG, payload_configured=Load(mass=0.5)))
    bench.run(0.01, Push("elbow", CENTRE, (1.0, 2.0, 3.0), (0.1, 0.2, 0.3)))
    snapshot = bench.simulation.snapshot()
    assert snapshot.tick == bench.simulation.tick_count == 5
    assert snapshot.decision.mode is Mode.TEACH
    assert snapshot.truth_payload_mass == 2.0
    assert snapshot.configured_mass == 0.5
    ((part, point, force, torque),) = snapshot.touches
    assert (part, force, torque) == ("elbow", (1.0, 2.0, 3.0), (0.1, 0.2, 0.3))
    assert point == pytest.approx(tuple(snapshot.truth_links[3, :3]), abs=1e-4)


# The laboratory


def test_changes_act_on_the_true_arm_and_on_nothing_the_controller_believes() -> None:
    bench = Bench(SCENARIO)
    bench.run(0.1)
    q = np.array(UR5E.chain.home)
    believed = bench.simulation.dynamics.gravity(q).copy()
    bench.change(
        AttachPayload(load=Load(mass=4.0)), FrictionChange(factor=2.0), Temperature(joint="wrist_2", celsius=60.0),
        MoveObject(name="table", position=[1.0, 1.0, 0.0]),
    )  # fmt: skip
    plant = bench.plant
    assert plant.payload.load.mass == 4.0
    assert plant.friction.factor.tolist() == [2.0] * 6
    assert plant.temperature[4] == pytest.approx(60.0, abs=0.1)
    assert plant.temperature[3] < 50.0
    assert np.allclose(plant.object_poses()[0, :3], [1.0, 1.0, 0.0])
    assert (bench.simulation.dynamics.gravity(q) == believed).all()
    assert bench.simulation.fitting.mass == 1.8


def test_a_change_of_an_unknown_joint_or_object_is_an_error() -> None:
    simulation = Simulation(UR5E, SCENARIO, SETTINGS)
    with pytest.raises(KeyError, match=r"knee.*there are base, shoulder"):
        simulation.apply(FrictionChange(joint="knee", factor=1.0))
    with pytest.raises(KeyError):
        simulation.apply(MoveObject(name="chair", position=[0.0, 0.0, 0.0]))


def test_a_configured_payload_changes_what_the_controller_believes() -> None:
    bench = Bench(NOMINAL)
    q = np.array(UR5E.chain.home)
    before = bench.simulation.dynamics.gravity(q).copy()
    bench.tick(Wishes(Inputs(load=Load(mass=2.0, com=[0.0, 0.0, 0.1])), (), ()))
    bench.run(1.1)
    jump = bench.simulation.dynamics.gravity(q) - before
    p, R, jacobian = (x.copy() for x in bench.simulation.dynamics.update(q))
    wrench = np.concatenate([[0.0, 0.0, 2.0 * 9.81], np.cross(R @ [0.0, 0.0, 0.1], [0.0, 0.0, 2.0 * 9.81])])
    assert np.allclose(jump, jacobian.T @ wrench, atol=1e-9)
    assert p[2] > 0.0


def test_what_the_bias_may_be_wrong_by_is_told_to_whoever_asks_whose_force_it_is(monkeypatch: pytest.MonkeyPatch) -> None:
    """FD-19: in free-drive as the pendant decided last, which is more with time; else nothing is asked."""
    told: list[tuple[bool, float]] = []
    inner = ExternalWrench.update

    def update(self: ExternalWrench, bias: tuple[float, ...] | None, unsure: float = 0.0, *, accelerations: bool) -> Odds:
        told.append((bias is not None, unsure))
        return inner(self, bias, unsure, accelerations=accelerations)

    monkeypatch.setattr(ExternalWrench, "update", update)
    bench = Bench(Scenario(seed=2))
    bench.run(0.5)
    assert told == []
    bench.enter()
    decided = [bench.tick(Wishes(Inputs(), (push("flange", (0.0, 12.0, 0.0)),), ())) for _ in range(100)]
    assert [unsure for _, unsure in told[-99:]] == [each.slack.force / 3.0 for each in decided[:-1]]
    assert told[-1][0]
    assert 0.0 < told[-99][1] < told[-1][1]


def test_settings_follow_the_pendants() -> None:
    bench = Bench(NOMINAL, Settings())
    bench.tick(Wishes(Inputs(settings={"free_drive.period": 7.0}), (), ()))
    assert bench.simulation.settings.free_drive.period == 7.0
