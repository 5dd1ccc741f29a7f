"""The control laws: holding, being guided, stopping, running, with the mismatch on. Small samples of benchmarks/hold.py."""

import numpy as np
import pytest

from benchmarks.contacts.approaches import Approach, approach
from pendant.all_settings import apply
from pendant.events.event import Kind
from pendant.inputs import Command
from pendant.program.steps import LinearMove, Wait
from pendant.tick.modes import Mode, Safety
from sim.arm.frames import joint_frames, quaternion_from_matrix, rotation, rotation_from_rpy
from sim.arm.scenario import Load, Scenario
from sim.plant.changes import AttachPayload
from sim.plant.touch import Pull
from tests.sim.arms import PROBE, TWO_KG, UR5E
from tests.sim.bench import CENTRE, LONG, NOMINAL, Bench, push

HOME = np.array(UR5E.chain.home)
SEED = 4
MOUNTINGS = {"floor": [0.0, 0.0, 0.0], "wall": [0.0, np.pi / 2, 0.0], "ceiling": [np.pi, 0.0, 0.0]}


def mounted(mounting: str, seed: int = SEED) -> Scenario:
    return Scenario(seed=seed, mounting=MOUNTINGS[mounting])


# Holding


@pytest.mark.parametrize("mounting", MOUNTINGS)
def test_it_holds_in_normal(mounting: str) -> None:
    bench = Bench(mounted(mounting))
    start = bench.flange
    bench.do(Command.NORMAL)
    assert bench.drift(10.0, start) < 0.2e-3
    assert bench.mode is Mode.NORMAL


def drag(bench: Bench, force: np.ndarray, seconds: float = 1.0) -> float:
    """Pull the flange with `force` [N], growing for 0.3 s; largest way [m]."""
    start, worst, ticks = bench.flange, 0.0, round(500 * seconds)
    for k in range(ticks):
        bench.run(0.002, push("flange", tuple(force * min(1.0, k / 150.0))))
        worst = max(worst, float(np.linalg.norm(bench.flange - start)))
    return worst


@pytest.mark.parametrize("direction", [(1, 0, 0), (0, 1, 0), (0, 0, 1), (0, 0, -1), (-0.577, -0.577, 0.577)])
def test_dragged_with_50_newtons_it_gives_way_a_little_and_comes_back(direction: tuple[float, float, float]) -> None:
    bench = Bench(Scenario(seed=SEED))
    bench.do(Command.NORMAL)
    bench.run(1.0)
    start = bench.flange
    way = drag(bench, 50.0 * np.array(direction, dtype=float))
    assert 1e-5 < way < 3e-3
    bench.run(1.5)
    assert np.linalg.norm(bench.flange - start) < 0.5e-3


@pytest.mark.parametrize("part", ["shoulder", "elbow", "wrist_1", "wrist_3"])
def test_a_push_on_a_link_is_held_against_and_forgotten(part: str) -> None:
    bench = Bench(Scenario(seed=SEED))
    bench.run(1.0)
    start = bench.flange
    bench.run(1.0, push(part, (25.0, 35.0, -25.0)))
    bench.run(1.5)
    assert np.linalg.norm(bench.flange - start) < 0.3e-3


def test_a_payload_that_nobody_told_of_is_caught() -> None:
    bench = Bench(Scenario(seed=SEED))
    bench.run(1.0)
    start = bench.flange
    bench.change(AttachPayload(load=TWO_KG))
    assert bench.drift(2.0, start) < 3e-3
    assert np.linalg.norm(bench.flange - start) < 0.5e-3


# Free-drive


@pytest.mark.parametrize("mounting", MOUNTINGS)
def test_in_free_drive_an_untouched_arm_stays(mounting: str) -> None:
    bench = Bench(mounted(mounting))
    bench.enter()
    assert bench.drift(10.0, bench.flange) < 2e-3
    assert bench.mode is Mode.FREE_DRIVE


def test_in_free_drive_a_configured_payload_stays() -> None:
    bench = Bench(Scenario(seed=SEED, tool=PROBE, payload_true=TWO_KG, payload_configured=TWO_KG))
    bench.enter()
    assert bench.drift(4.0, bench.flange) < 2e-3


@pytest.mark.parametrize("mounting", MOUNTINGS)
@pytest.mark.parametrize("direction", [(0.0, 1.0, 0.0), (0.6, 0.0, 0.8)])
def test_in_free_drive_20_newtons_move_the_flange(mounting: str, direction: tuple[float, float, float]) -> None:
    R_WB = rotation_from_rpy(MOUNTINGS[mounting])
    force = 20.0 * R_WB @ direction
    bench = Bench(mounted(mounting))
    bench.enter()
    start = bench.flange
    bench.run(1.0, push("flange", tuple(force)))
    way = bench.flange - start
    assert np.linalg.norm(way) > 0.1
    assert way @ force > 0.5 * np.linalg.norm(way) * 20.0, "towards where it is pushed"


def test_ten_newtons_break_away() -> None:
    """FD-2: breakaway at the flange at most 10 N."""
    for direction in np.vstack([np.eye(3), -np.eye(3)]):
        bench = Bench(Scenario(seed=SEED))
        bench.enter()
        start = bench.flange
        bench.run(1.0, push("flange", tuple(10.0 * direction)))
        assert np.linalg.norm(bench.flange - start) > 0.01, f"stuck along {direction}"


@pytest.mark.parametrize("part", ["elbow", "wrist_1"])
def test_in_free_drive_a_link_can_be_pushed(part: str) -> None:
    """FD-3: pushing a link directly moves the arm too; the flange sensor feels nothing of it."""
    bench = Bench(Scenario(seed=SEED))
    bench.enter()
    start = bench.plant.poses()[:, :3].copy()
    bench.run(1.0, push(part, (0.0, 50.0, 0.0)))
    moved = bench.plant.poses()[:, :3] - start
    assert moved[-1, 1] > 0.05
    assert moved[1 + UR5E.chain.joints.index("wrist_1"), 1] > 0.05


def test_a_guided_arm_comes_to_rest_when_let_go() -> None:
    bench = Bench(Scenario(seed=SEED))
    bench.enter()
    bench.run(0.5, push("flange", (0.0, 15.0, 0.0)))
    assert bench.estimate.v_tcp > 0.05
    bench.run(1.5)
    before = bench.flange
    bench.run(0.2)
    assert np.linalg.norm(bench.flange - before) / 0.2 < 2e-3


def test_the_amplified_force_is_capped() -> None:
    """FD-3: |F_user| counts up to 50 N: pulling twice as hard is not amplified twice as much."""
    currents = []
    knocked = apply(LONG, {"limits.operation.flange_acceleration.on": False})  # 150 N at once is a knock
    for size in (50.0, 150.0):
        bench = Bench(NOMINAL, knocked)
        bench.enter()
        bench.run(0.012, push("flange", (0.0, size, 0.0)))
        currents.append(torque(bench)[0])
    rest = Bench(NOMINAL)
    rest.enter()
    rest.run(0.012)
    base = torque(rest)[0]
    assert abs(currents[0] - base) > 5.0
    assert (currents[1] - base) / (currents[0] - base) == pytest.approx(1.0, abs=0.35)


def torque(bench: Bench) -> np.ndarray:
    """Motor torque at the output (n,) [N·m], as the plant was given it."""
    dofs = [bench.plant.model.joint(f"theta/{name}").dofadr[0] for name in UR5E.chain.joints]
    return bench.plant.data.qfrc_applied[dofs].copy()


# Stopping


def guide(bench: Bench, direction: tuple[float, float, float], speed: float) -> None:
    """Guide the flange by a hand until it moves at `speed` [m/s]."""
    target, pace, before = bench.flange, 0.0, bench.flange
    for _ in range(1500):
        pace = min(pace + 0.0008, 1.1 * speed)
        target = target + 0.002 * pace * np.array(direction)
        bench.run(0.002, Pull("flange", CENTRE, tuple(target), 100.0))
        now = bench.flange
        if np.linalg.norm(now - before) * 500.0 >= speed:
            return
        before = now
    raise AssertionError(f"the hand never reached {speed} m/s")


@pytest.mark.parametrize("direction", [(0.0, 1.0, 0.0), (0.0, -1.0, 0.0), (0.0, 0.0, -1.0), (0.7, 0.0, 0.7)])
def test_a_stop_out_of_free_drive_is_short_and_holds(direction: tuple[float, float, float]) -> None:
    bench = Bench(Scenario(seed=SEED))
    bench.enter()
    guide(bench, direction, 0.25)
    start = bench.flange
    bench.do(Command.EMERGENCY_STOP)
    assert bench.drift(1.0, start) < 15e-3
    assert bench.drift(2.0, bench.flange) < 0.2e-3
    assert bench.mode is Mode.STOP


def test_leaving_free_drive_at_rest_moves_nothing() -> None:
    bench = Bench(Scenario(seed=SEED))
    bench.enter()
    bench.run(0.5)
    start = bench.flange
    bench.do(Command.LEAVE_FREE_DRIVE)
    assert bench.drift(2.0, start) < 0.3e-3
    assert bench.mode is Mode.TEACH


# Running


def finish(bench: Bench, seconds: float = 10.0) -> None:
    for _ in range(round(500 * seconds)):
        if bench.tick().mode is not Mode.RUN:
            return
    raise AssertionError("the program never ends")


TARGET = np.add(HOME, [0.5, -0.2, 0.3, 0.3, -0.4, 0.8])


@pytest.mark.parametrize("seed", [SEED, None], ids=["mismatch", "nominal"])
def test_a_joint_move_is_followed_to_its_target(seed: int | None) -> None:
    """Every joint within 2 mrad of its target, and never faster than its share of the limit."""
    bench = Bench(NOMINAL if seed is None else Scenario(seed=seed, payload_true=TWO_KG, payload_configured=TWO_KG))
    bench.start_joint_move(TARGET, 0.5)
    fastest = np.zeros(6)
    for _ in range(5000):
        if bench.tick().mode is not Mode.RUN:
            break
        fastest = np.maximum(fastest, np.abs(bench.plant.qd))
    assert bench.events[-1].kind is Kind.PROGRAM_FINISHED
    assert (fastest < 0.5 * np.array(UR5E.limits.speed) * 1.1).all()
    assert fastest.max() > 0.3
    bench.run(0.5)
    assert np.abs(bench.plant.q - TARGET).max() < 2e-3
    assert bench.drift(1.0, bench.flange) < 0.2e-3


def test_a_line_is_followed_and_ends_at_its_pose() -> None:
    """True tool centre point within 1.5 mm of the line, and within 1 mm and 2 mrad of the pose at its end."""
    bench = Bench(Scenario(seed=SEED, tool=PROBE))
    bench.run(0.2)
    flange = joint_frames(UR5E, bench.plant.q)[-1]
    R = flange[:3, :3]
    p = flange[:3, 3] + R @ PROBE.tcp
    goal, turned = np.add(p, [0.1, 0.15, 0.1]), R @ rotation(2, 0.4)
    quaternion = quaternion_from_matrix(turned)
    bench.start(LinearMove(position=tuple(goal), quaternion=tuple(quaternion), speed=0.15, acceleration=0.5))
    along = (goal - p) / np.linalg.norm(goal - p)
    worst, fastest, before = 0.0, 0.0, p
    for _ in range(5000):
        mode = bench.tick().mode
        frame = joint_frames(UR5E, bench.plant.q)[-1]
        point = frame[:3, 3] + frame[:3, :3] @ PROBE.tcp
        worst = max(worst, float(np.linalg.norm(np.cross(point - p, along))))
        fastest = max(fastest, bench.estimate.v_tcp)
        before = point
        if mode is not Mode.RUN:
            break
    assert bench.events[-1].kind is Kind.PROGRAM_FINISHED
    assert worst < 1.5e-3
    assert fastest == pytest.approx(0.15, rel=0.15)
    bench.run(0.5)
    frame = joint_frames(UR5E, bench.plant.q)[-1]
    assert np.linalg.norm(frame[:3, 3] + frame[:3, :3] @ PROBE.tcp - goal) < 1e-3
    assert np.linalg.norm(frame[:3, :3] - turned) / np.sqrt(2.0) < 2e-3
    assert np.linalg.norm(before - p) > 0.15


def test_a_paused_program_stands_and_goes_on_when_resumed() -> None:
    bench = Bench(Scenario(seed=SEED))
    bench.start_joint_move(TARGET, 0.3)
    bench.run(0.8)
    assert np.abs(bench.plant.qd).max() > 0.2, "paused in full motion"
    bench.do(Command.PAUSE_PROGRAM)
    bench.run(0.8)
    start = bench.flange
    assert np.abs(bench.plant.q - TARGET).max() > 0.05, "half-way"
    assert bench.drift(0.5, start) < 0.2e-3
    bench.do(Command.RESUME_PROGRAM)
    finish(bench)
    bench.run(0.5)
    assert bench.events[-1].kind is Kind.PROGRAM_FINISHED
    assert np.abs(bench.plant.q - TARGET).max() < 2e-3


@pytest.mark.parametrize("fraction", [0.3, 1.0])
def test_an_emergency_stop_in_a_move_comes_to_rest_on_its_way(fraction: float) -> None:
    bench = Bench(Scenario(seed=SEED))
    bench.start_joint_move(np.add(HOME, [1.5, 0.2, 0.2, 0.0, 0.0, 1.0]), fraction)
    bench.run(0.5)
    q, qd = bench.plant.q.copy(), bench.plant.qd.copy()
    assert np.abs(qd).max() > 0.3
    decision = bench.do(Command.EMERGENCY_STOP)
    assert decision.mode is Mode.STOP
    assert decision.safety is Safety.EMERGENCY_STOP
    way = 0.0
    for _ in range(400):
        bench.tick()
        way = max(way, float(np.abs(bench.plant.q - q).max()))
    # Half of speed times the time that its limit needs; twice that for a soft stop, and some for the lag.
    least = 0.5 * float((qd**2 / np.array(UR5E.limits.acceleration)).max())
    assert way < 2.5 * least + 0.05 * np.abs(qd).max()
    assert bench.drift(1.0, bench.flange) < 0.2e-3
    assert bench.mode is Mode.STOP


def test_what_stops_a_motion_is_not_pushed_on() -> None:
    """A block of 2e5 N/m met at 250 mm/s with 5 kg in hand: the integral, had it gone on, would press with 186 N for seconds."""
    force = np.array(approach(Approach(2e5, 0.25, 0, 5.0, 4, "stop")).force)
    assert force.max() > 150.0
    assert force[-250:].mean() < 60.0


def test_steps_follow_each_other() -> None:
    bench = Bench(Scenario(seed=SEED))
    here = tuple(HOME.tolist())
    bench.start_joint_move(TARGET, 0.6)
    finish(bench)
    bench.start(Wait(duration=0.3))
    begun = bench.simulation.tick_count
    finish(bench)
    assert bench.simulation.tick_count - begun == pytest.approx(150, abs=2)
    bench.start_joint_move(here, 0.6)
    finish(bench)
    bench.run(0.5)
    assert np.abs(bench.plant.q - HOME).max() < 2e-3


def test_an_impossible_move_ends_the_program_with_the_reason_and_moves_nothing() -> None:
    bench = Bench(Scenario(seed=SEED))
    bench.run(0.2)
    start = bench.flange
    bench.start(LinearMove(position=(2.0, 0.0, 0.0), quaternion=(0.0, 1.0, 0.0, 0.0)))
    assert bench.drift(0.5, start) < 0.1e-3
    failure = next(event for event in bench.events if event.kind is Kind.PROGRAM_FAILED)
    assert "out of reach or singular" in str(failure.values["reason"])
    assert bench.mode is not Mode.RUN


# Currents


def test_currents_never_exceed_the_motors_limit_even_when_all_of_it_is_needed() -> None:
    limit = np.array(UR5E.motors.current) * np.array(UR5E.motors.gear) * np.array(UR5E.motors.torque_constant)
    bench = Bench(Scenario(seed=SEED))
    worst = np.zeros(6)
    for _ in range(500):
        bench.run(0.002, push("flange", (300.0, 300.0, 200.0), (60.0, 60.0, 60.0)))
        worst = np.maximum(worst, np.abs(torque(bench)) / limit)
    assert (worst <= 1.0 + 1e-9).all()
    # The gear's torque limit, and what friction takes at full speed; 3 % of the motor constant nobody knows.
    useful = np.array(UR5E.limits.torque) + np.array([row[-1] for row in UR5E.frictions.torque])
    assert (worst * limit <= useful / 0.97).all()
    assert (worst * limit > 0.97 * useful).any(), "the limit must have been reached"


def test_fast_moves_leave_current_to_spare() -> None:
    limit = np.array(UR5E.motors.current) * np.array(UR5E.motors.gear) * np.array(UR5E.motors.torque_constant)
    bench = Bench(Scenario(seed=SEED, payload_true=Load(mass=3.0), payload_configured=Load(mass=3.0)), LONG)
    bench.start_joint_move(TARGET, 1.0)
    worst = np.zeros(6)
    for _ in range(600):
        bench.tick()
        worst = np.maximum(worst, np.abs(torque(bench)) / limit)
    assert (worst < 1.0).all()
    assert np.abs(bench.plant.q - TARGET).max() < 5e-3
