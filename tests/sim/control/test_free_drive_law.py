"""Free-drive law: what the hand asks for, what is taken off it, and that nothing drives an arm that nobody touches."""

import numpy as np
import pytest
from msgspec.structs import replace

from pendant.all_settings import Settings, apply
from pendant.guided.bias_follower import Slack
from pendant.inputs import Button, Command, Inputs
from pendant.program.steps import JointMove, Program, ProgramState
from pendant.tick.modes import Law, Mode, Phase
from pendant.walls.containment import WallState
from sim.arm.frames import joint_frames, rotation
from sim.arm.scenario import Load, Scenario
from sim.control.free_drive_law import COMPENSATED, FreeDriveLaw
from sim.control.hand_help import BRAKE, BRAKE_SPEED, DEAD_ZONE, HELP_BANDWIDTH, INTENT
from sim.estimation.adaptive_friction import AdaptiveFriction
from sim.exchange.desk import Wishes
from sim.plant.touch import Pull
from tests.sim.arms import UR5E
from tests.sim.bench import CENTRE, Bench, push
from tests.sim.laws import EXACT, N, decision, dynamics, estimate

Q = np.array(UR5E.chain.home)
MODEL = dynamics(Q)
P, R, JACOBIAN = (part.copy() for part in MODEL.update(Q))
GRAVITY = MODEL.gravity(Q).copy()
BREAKAWAY = AdaptiveFriction(UR5E).terms[:, 0]


def law(held: np.ndarray | None = None) -> FreeDriveLaw:
    module = FreeDriveLaw(UR5E, EXACT, dynamics(Q), tcp=np.zeros(3), R_FT=np.eye(3))
    module.start(held)
    return module


def asked(wrench: np.ndarray, with_friction: bool = False, gain: float = 1.0, **values: object) -> np.ndarray:
    """Torque beyond gravity for the user's wrench."""
    seen = estimate(**{"q": Q, "R_BF": R, "F_user": wrench, **values})
    return (
        law().torque(seen, decision(Law.FREE, gain=gain), JACOBIAN, friction=AdaptiveFriction(UR5E), with_friction=with_friction)
        - GRAVITY
    )


def test_without_a_hand_it_is_gravity_alone() -> None:
    assert np.abs(asked(np.zeros(6), with_friction=True)).max() < 1e-12


def test_what_held_the_arm_is_handed_over_and_goes() -> None:
    """A first-order decay of 0.05 s; after the brakes there is nothing to hand over."""
    beyond = np.array([5.0, -8.0, 3.0, 1.0, -0.5, 0.2])
    for held, handed in ((GRAVITY + beyond, beyond), (None, np.zeros(N))):
        module, seen, rubs = law(held=held), estimate(q=Q, R_BF=R), AdaptiveFriction(UR5E)
        freed = decision(Law.FREE, phase=Phase.SEQUENCE)
        for tick in range(126):
            torque = module.torque(seen, freed, JACOBIAN, friction=rubs, with_friction=True) - GRAVITY
            np.testing.assert_allclose(torque, handed * np.exp(-tick * 0.002 / 0.05), atol=1e-9)
        for _ in range(374):
            module.torque(seen, freed, JACOBIAN, friction=rubs, with_friction=True)
        torque = module.torque(seen, freed, JACOBIAN, friction=rubs, with_friction=True)
        np.testing.assert_array_equal(torque, MODEL.recursion.at_rest)  # after a second to the last bit


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_freeing_the_arm_after_a_program_does_not_shake_it(seed: int) -> None:
    """A motion leaves torque against friction in the motors; let go at once, it shook the flange by 1.0 to 1.4 m/s²."""
    settings = apply(Settings(), {"activation.period": 0.1})
    bench = Bench(Scenario(seed=seed), settings)
    rng = np.random.default_rng(seed)
    bench.run(0.5)
    goals = [Q + 0.3 * rng.uniform(-1.0, 1.0, N), Q]
    bench.do(program=Program(steps=tuple(JointMove(q=tuple(goal.tolist())) for goal in goals)))
    bench.do(Command.START_PROGRAM)
    while bench.tick().program is ProgramState.RUNNING:
        pass
    bench.run(0.5)
    felt: list[float] = []
    for _ in range(500):
        freed = bench.tick(Wishes(Inputs(held=frozenset({Button.FREE_DRIVE})), (), ())).law is Law.FREE
        if freed:
            felt.append(float(np.linalg.norm(bench.simulation.estimate.a_felt)))
    assert len(felt) > 200
    assert max(felt) < 0.65


def test_the_wrench_is_amplified_through_the_jacobian_and_its_force_capped() -> None:
    wrench = np.array([20.0, -10.0, 5.0, 0.5, 1.0, -0.3])
    np.testing.assert_allclose(asked(wrench, gain=1.5), JACOBIAN.T @ (1.5 * wrench), atol=1e-9)
    size = np.linalg.norm(4.0 * wrench[:3])
    np.testing.assert_allclose(asked(4.0 * wrench), JACOBIAN.T @ (4.0 * wrench * (50.0 / size)), atol=1e-9)


@pytest.mark.parametrize(
    ("slack", "pulls", "turns"),
    [((0.0, 0.0), 1.0, 1.0), ((5.0, 0.0), 0.75, 1.0), ((0.0, 0.5), 1.0, 0.5), ((20.1, 1.1), 0.0, 0.0)],
)
def test_what_may_be_the_sensors_drift_asks_for_nothing(slack: tuple[float, float], pulls: float, turns: float) -> None:
    """FD-19: of 20 N and 1 N·m, each by itself; what is more is helped in its direction."""
    force, torque = np.array([12.0, -16.0, 0.0]), np.array([0.6, 0.0, -0.8])
    seen, free = estimate(q=Q, R_BF=R, F_user=np.concatenate([force, torque])), decision(Law.FREE, gain=1.5)
    helped = law().torque(
        seen, replace(free, slack=Slack(*slack)), JACOBIAN, friction=AdaptiveFriction(UR5E), with_friction=False
    )
    wanted = JACOBIAN.T @ (1.5 * np.concatenate([pulls * force, turns * torque]))
    np.testing.assert_allclose(helped - GRAVITY, wanted, atol=1e-9)


def test_a_force_is_capped_after_what_may_be_drift_is_off() -> None:
    seen = estimate(q=Q, R_BF=R, F_user=np.array([80.0, 0.0, 0.0, 0.0, 0.0, 0.0]))
    for slack, force in ((10.0, 50.0), (40.0, 40.0)):
        free = replace(decision(Law.FREE, gain=1.0), slack=Slack(slack, 0.0))
        torque = law().torque(seen, free, JACOBIAN, friction=AdaptiveFriction(UR5E), with_friction=False)
        np.testing.assert_allclose(torque - GRAVITY, JACOBIAN[0] * force, atol=1e-9)


def test_an_offset_of_the_sensor_turns_with_the_flange() -> None:
    offset = np.array([3.0, 1.0, -2.0, 0.2, 0.1, -0.1])
    module = law()
    turn = rotation(2, 1.1)
    turned = np.concatenate([turn @ offset[:3], turn @ offset[3:]])
    seen = estimate(q=Q, R_BF=turn, F_user=turned)
    torque = module.torque(
        seen, decision(Law.FREE, gain=1.0, baseline=tuple(offset)), JACOBIAN, friction=AdaptiveFriction(UR5E), with_friction=True
    )
    np.testing.assert_allclose(torque, GRAVITY, atol=1e-9)


def test_before_free_drive_is_entered_nothing_helps_the_hand() -> None:
    seen = estimate(q=Q, R_BF=R, F_user=np.array([30.0, 0, 0, 0, 0, 0]), tau_ext=np.full(N, 50.0))
    trying = decision(Law.FREE, phase=Phase.SEQUENCE)
    np.testing.assert_allclose(
        law().torque(seen, trying, JACOBIAN, friction=AdaptiveFriction(UR5E), with_friction=True), GRAVITY, atol=1e-9
    )


def test_friction_is_taken_off_where_the_hand_asks_never_where_the_arm_moves() -> None:
    wrench = np.array([0.0, 40.0, 0.0, 0.0, 0.0, 0.0])
    plain = asked(wrench)
    sliding = np.array([8.0, -9.0, 7.0, 2.0, -2.0, 2.0])
    helped = asked(wrench, with_friction=True, friction=sliding)
    ask = JACOBIAN.T @ wrench
    full = np.abs(ask) > (INTENT + DEAD_ZONE) * BREAKAWAY
    assert full.any()
    expected = np.sign(ask) * COMPENSATED * np.maximum(np.abs(sliding), BREAKAWAY)
    np.testing.assert_allclose((helped - plain)[full], expected[full])
    none = np.abs(ask) < DEAD_ZONE * BREAKAWAY
    assert np.abs((helped - plain)[none]).max(initial=0.0) < 1e-12


def test_without_amplification_a_hand_at_the_flange_gets_its_friction_taken_off() -> None:
    """FD-3: a gain of 0 is the limit of a small one."""
    seen = estimate(q=Q, R_BF=R, F_user=np.array([0.0, 40.0, 0.0, 0.0, 0.0, 0.0]), theta_d=np.full(N, 0.2))
    free = decision(Law.FREE, gain=1e-9)
    none, small, deaf = (
        law().torque(seen, how, JACOBIAN, friction=AdaptiveFriction(UR5E), with_friction=True)
        for how in (replace(free, gain=0.0), free, replace(free, gain=0.0, flange_help=False))
    )
    np.testing.assert_allclose(none, small, atol=1e-6)
    assert np.abs(none - deaf).max() > 1.0


def test_where_nobody_may_lead_the_arm_it_gets_no_help_with_its_friction_and_brakes() -> None:
    """FD-19. The hand's own force is amplified on."""
    wrench, speed = np.array([0.0, 40.0, 0.0, 0.0, 0.0, 0.0]), np.full(N, 0.2)
    seen = estimate(q=Q, R_BF=R, F_user=wrench, friction=np.full(N, 7.0), theta_d=speed)
    free = decision(Law.FREE, gain=1.0)
    torques = [
        law().torque(seen, how, JACOBIAN, friction=AdaptiveFriction(UR5E), with_friction=True)
        for how in (free, replace(free, doubtful=True))
    ]
    expected = GRAVITY + JACOBIAN.T @ wrench - BRAKE * BREAKAWAY * np.tanh(speed / BRAKE_SPEED)
    np.testing.assert_allclose(torques[1], expected)
    assert np.abs(torques[0] - torques[1]).max() > 1.0


def felt(certain: np.ndarray, speed: float = 0.0, ticks: int = 60, **values: object) -> np.ndarray:
    """Torque beyond gravity where the joints have felt so much for certain for some ticks, at this speed of all [rad/s]."""
    module = law()
    seen = estimate(**{"q": Q, "R_BF": R, "tau_certain": certain, "theta_d": np.full(N, speed), **values})
    for _ in range(ticks):
        out = module.torque(seen, decision(Law.FREE, gain=1.0), JACOBIAN, friction=AdaptiveFriction(UR5E), with_friction=True)
    return out - GRAVITY


@pytest.mark.parametrize("way", [1.0, -1.0])
def test_a_hand_on_a_link_is_helped_by_what_of_its_torque_is_certain(way: float) -> None:
    """AF-7: that alone; the joints' torque may have other causes. A joint follows it as soon as a hand at the flange."""
    certain = way * BREAKAWAY * np.array([0.049, 0.05 + 0.06, 0.171, 1.0, 0.0, 0.05])
    full = COMPENSATED * BREAKAWAY
    np.testing.assert_allclose(felt(certain, tau_hand=np.full(N, 9.0)), way * full * [0.0, 0.5, 1.0, 1.0, 0.0, 0.0], atol=1e-3)
    smooth = 1.0 - np.exp(-2.0 * np.pi * HELP_BANDWIDTH * 0.002)
    first = np.minimum((smooth * np.abs(certain) / BREAKAWAY - DEAD_ZONE).clip(0.0) / INTENT, 1.0)
    np.testing.assert_allclose(felt(certain, ticks=1), way * full * first, atol=1e-9)


@pytest.mark.parametrize("link", [1.0, -1.0])
def test_of_two_hands_the_one_that_asks_for_more_leads_a_joint(link: float) -> None:
    wrench = np.array([0.0, 40.0, 0.0, 0.0, 0.0, 0.0])
    ask = JACOBIAN.T @ wrench
    for share, leads in ((0.9, np.sign(ask)), (1.1, link * np.sign(ask))):
        helped = felt(link * share * ask, F_user=wrench) - ask
        asks = np.abs(ask) > 1.2 * (INTENT + DEAD_ZONE) * BREAKAWAY
        assert asks.any()
        np.testing.assert_allclose(helped[asks], (COMPENSATED * BREAKAWAY * leads)[asks], rtol=1e-3)


def test_a_joint_of_which_nothing_is_asked_is_braked() -> None:
    speed = 2.0 * BRAKE_SPEED
    full = BRAKE * BREAKAWAY * np.tanh(2.0)
    for way in (1.0, -1.0):
        np.testing.assert_allclose(felt(np.zeros(N), speed=way * speed), -way * full, rtol=1e-6)
        half = felt(0.11 * BREAKAWAY, speed=way * speed)  # helped by half of it
        np.testing.assert_allclose(half, 0.5 * (COMPENSATED * BREAKAWAY - way * full), rtol=3e-3, atol=1e-3)


@pytest.mark.parametrize(("share", "braked"), [(0.0, 1.0), (0.5, 0.5), (1.0, 0.0), (2.0, 0.0), (-2.0, 1.0)])
@pytest.mark.parametrize("way", [1.0, -1.0])
def test_unless_a_hand_may_push_it_on(way: float, share: float, braked: float) -> None:
    """One that was felt a moment ago, and helps along by so much of what is helped in full. None does without help."""
    speed, along = 2.0 * BRAKE_SPEED, share * way * INTENT * BREAKAWAY
    full = -way * BRAKE * BREAKAWAY * np.tanh(2.0)
    np.testing.assert_allclose(felt(np.zeros(N), speed=way * speed, tau_hand=along), braked * full, rtol=1e-6, atol=1e-9)
    seen = estimate(q=Q, R_BF=R, theta_d=np.full(N, way * speed), tau_hand=along)
    doubtful = replace(decision(Law.FREE, gain=1.0), doubtful=True)
    alone = law().torque(seen, doubtful, JACOBIAN, friction=AdaptiveFriction(UR5E), with_friction=True)
    np.testing.assert_allclose(alone - GRAVITY, full, rtol=1e-6)


@pytest.mark.parametrize("way", [1.0, -1.0])
@pytest.mark.parametrize("then", [1.5, 1.0, 0.7, 0.2])
def test_who_pushes_a_joint_on_keeps_up_its_speed(way: float, then: float) -> None:
    """One that slows down is braked again, as far as its kinetic energy is less than lately: who was felt there has let go."""
    module, speed, rubs = law(), 2.0 * BRAKE_SPEED, AdaptiveFriction(UR5E)
    free, along = decision(Law.FREE, gain=1.0), np.full(N, way * 9.0)
    for fast in (*[1.0] * 500, then):
        seen = estimate(q=Q, R_BF=R, theta_d=np.full(N, way * fast * speed), tau_hand=along)
        torque = module.torque(seen, free, JACOBIAN, friction=rubs, with_friction=True) - GRAVITY
    lately = 1.0 + (1.0 - np.exp(-0.002 / 0.05)) * (then - 1.0)
    braked = max(1.0 - (then / lately) ** 2, 0.0)
    np.testing.assert_allclose(torque, -way * braked * BRAKE * BREAKAWAY * np.tanh(2.0 * then), rtol=1e-3, atol=1e-3)
    module.start(held=None)
    torque = module.torque(seen, free, JACOBIAN, friction=rubs, with_friction=True) - GRAVITY
    np.testing.assert_allclose(torque, 0.0, atol=1e-9)  # nothing is known of its speed before


def test_who_leads_the_arm_by_its_elbow_leads_it_smoothly() -> None:
    """AF-7: links that swing on their springs passed for a hand, and what was done for it kept the arm shaking at 30 Hz."""
    load = Load(mass=1.0, com=[0.0, 0.0, 0.05])
    posture = [1.28, -0.96, 1.89, -1.99, 1.32, -2.17]
    bench = Bench(Scenario(seed=9, posture=posture, payload_true=load, payload_configured=load))
    bench.enter()
    body = bench.plant.model.body("elbow").id
    target = bench.plant.data.xpos[body].copy()
    round_base = np.cross([0.0, 0.0, 1.0], target)
    round_base /= np.linalg.norm(round_base)
    speeds, forces = [], []
    for k in range(500):
        target += round_base * 0.1 * 0.002 * min(k / 100.0, 1.0)
        bench.run(0.002, Pull("elbow", CENTRE, tuple(target), 300.0))
        speeds.append(bench.plant.qd[0])
        forces.append(np.array(bench.plant.hands.touched[0][2]) @ round_base)
    late = np.array(speeds[300:])
    smooth = np.convolve(late, np.ones(17) / 17.0, mode="same")[20:-20]  # over a period of that shaking
    assert np.std(late[20:-20] - smooth) < 0.01
    assert np.mean(forces[250:]) < 25.0
    assert bench.mode is Mode.FREE_DRIVE


def test_a_walls_force_acts_at_its_part_and_on_the_joints_that_move_it() -> None:
    """By virtual work: the torque of a force at a point is the force's share along how each joint moves the point."""
    force = np.array([3.0, -7.0, 5.0])
    tcp = np.array([0.02, -0.01, 0.15, 1.0])

    def points(q: np.ndarray) -> dict[str, np.ndarray]:
        frames = joint_frames(UR5E, q)
        return {"flange": frames[-1][:3, 3], "tcp": (frames[-1] @ tcp)[:3], "elbow": frames[UR5E.chain.elbow][:3, 3]}

    seen = estimate(q=Q, R_BF=R, p_BF=P)
    for part, place in points(Q).items():
        state = WallState("wall", part, tuple(place.tolist()), 0.0, (1.0, 0.0, 0.0), 1.0, False, tuple(force.tolist()))
        held = replace(decision(Law.FREE), walls=(state, replace(state, force=(0.0, 0.0, 0.0))))
        torque = law().torque(seen, held, JACOBIAN, friction=AdaptiveFriction(UR5E), with_friction=True) - GRAVITY
        for i in range(N):
            step = np.zeros(N)
            step[i] = 1e-6
            moved = (points(Q + step)[part] - points(Q - step)[part]) / 2e-6
            assert abs(torque[i] - force @ moved) < 1e-6, (part, i)


def test_before_the_end_of_a_joints_range_its_zone_is_added() -> None:
    zones = (0.0, -20.0, 0.0, 3.0, 0.0, 0.0)
    seen = estimate(q=Q, R_BF=R)
    held = replace(decision(Law.FREE), zones=zones)
    torque = law().torque(seen, held, JACOBIAN, friction=AdaptiveFriction(UR5E), with_friction=True)
    np.testing.assert_allclose(torque - GRAVITY, zones, atol=1e-9)


def ranged(base: float) -> Bench:
    """In free-drive with the base at this angle [rad], stretched enough that a push sideways is a large torque."""
    settings = apply(Settings(), {"activation.period": 0.1, "free_drive.period": 30.0})
    bench = Bench(Scenario(seed=4, posture=[base, -1.2, 1.5, -1.87, -1.57, 0.0]), settings=settings)
    bench.enter()
    return bench


def test_a_push_of_50_newtons_into_the_end_of_a_range_is_held() -> None:
    bench = ranged(5.9)
    highest = 0.0
    for _ in range(500):
        sideways = bench.plant.q[0] - np.pi / 2.0
        bench.run(0.004, push("flange", (50.0 * np.cos(sideways), 50.0 * np.sin(sideways), 0.0)))
        highest = max(highest, float(bench.plant.q[0]))
    assert bench.mode is Mode.FREE_DRIVE
    assert 6.233 < highest < 2.0 * np.pi
    bench.run(0.5)
    assert bench.mode is Mode.FREE_DRIVE
    assert highest - 0.1 < bench.plant.q[0], "let go, it comes out of the zone and no further than its width"


def test_an_arm_freed_within_the_zone_stands_and_comes_out_freely() -> None:
    bench = ranged(6.275)
    start = bench.plant.q.copy()
    bench.run(1.0)
    assert np.abs(bench.plant.q - start).max() < 1e-3
    bench.run(0.5, push("flange", (0.0, 15.0, 0.0)))
    assert bench.plant.q[0] < 6.2
