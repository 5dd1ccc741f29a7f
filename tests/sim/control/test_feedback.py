"""Feedback: each term by its switch, delayed references, the integral and what stops it."""

import math
from typing import Any

import numpy as np
import pytest
from msgspec.structs import replace

from pendant.all_settings import JointControl
from pendant.tick.estimate import Estimate
from pendant.tick.modes import TICK
from sim.control.feedback import INTEGRAL_SHARE, SUPPORT, Beginning, Feedback, following_limit
from sim.motion.moves import DELAY, Reference
from tests.sim.arms import UR5E
from tests.sim.laws import EXACT, N, dynamics, estimate

FREE = np.zeros(N)
ZERO = np.zeros(N)
TERMS = ("theta", "theta_speed", "theta_acceleration", "q", "q_speed", "q_acceleration", "motor_torque", "tcp_pose", "tcp_speed")
TCP = np.array([0.0, 0.0, 0.1])
ROTOR = np.array(UR5E.motors.rotor_inertia)
OMEGA = 2.0 * math.pi * 12.0
COMPLIANCE = 1.0 / (np.array(UR5E.transmissions.stiffness) + np.array(UR5E.transmissions.hysteresis_stiffness))


def only(*names: str) -> JointControl:
    """These feedback terms and no other."""
    switches: dict[str, Any] = {name: name in names for name in TERMS}
    return JointControl(**switches)


def resting(q: np.ndarray) -> Reference:
    return Reference(q, ZERO, ZERO)


STANDING = resting(ZERO)


def begun(torque: np.ndarray, driven: bool = False) -> Beginning:
    """A law that takes over an arm that stands, with this motor torque."""
    return Beginning(torque, [STANDING] * DELAY, np.full(N, driven))


def correction(use: JointControl, seen: Estimate, reference: Reference = STANDING, load: np.ndarray = ZERO) -> np.ndarray:
    """What a fresh feedback adds to nothing."""
    torque = np.zeros(N)
    Feedback(UR5E, EXACT, dynamics(), TCP).add(
        reference, load, seen, use, excess=FREE, waits=False, torque=torque, start=None, sticking=ZERO, stiffer=ZERO
    )
    return torque


def test_with_every_term_off_nothing_is_added() -> None:
    seen = estimate(theta=np.ones(N), theta_d=np.ones(N), q=np.ones(N), tau_m=np.ones(N), theta_dd=np.ones(N))
    assert (correction(only(), seen) == 0.0).all()


def test_motor_angle_speed_and_acceleration() -> None:
    error = np.linspace(-1e-3, 2e-3, N)
    np.testing.assert_allclose(correction(only("theta"), estimate(theta=-error)), ROTOR * OMEGA**2 * error)
    np.testing.assert_allclose(correction(only("theta_speed"), estimate(theta_d=-error)), 2 * 1.25 * ROTOR * OMEGA * error)
    added = correction(only("theta_acceleration"), estimate(theta_dd=-100.0 * error))
    np.testing.assert_allclose(added, 0.1 * ROTOR * 100.0 * error)


def test_a_load_bends_the_spring_ahead_of_the_motor_angle() -> None:
    load = np.linspace(-40.0, 60.0, N)
    seen = estimate(theta=load * COMPLIANCE)
    np.testing.assert_allclose(correction(only("theta"), seen, load=load), 0.0, atol=1e-12)


def test_a_spring_learned_to_be_stiffer_bends_less() -> None:
    load, stiffer = np.linspace(-40.0, 30.0, N), np.linspace(-0.2, 0.2, N)
    bent = load * COMPLIANCE / (1.0 + stiffer)
    torque = np.zeros(N)
    module = Feedback(UR5E, EXACT, dynamics(), TCP)
    module.add(
        STANDING,
        load,
        estimate(theta=bent),
        only("theta"),
        excess=FREE,
        waits=False,
        torque=torque,
        start=None,
        sticking=ZERO,
        stiffer=stiffer,
    )
    np.testing.assert_allclose(torque, 0.0, atol=1e-12)


def test_output_speed_and_acceleration() -> None:
    error = np.linspace(-0.1, 0.2, N)
    added = correction(only("q_speed"), estimate(qd=-error))
    np.testing.assert_allclose(added, 0.05 * 2 * 1.25 * ROTOR * OMEGA * error)
    np.testing.assert_allclose(correction(only("q_acceleration"), estimate(qdd=-error)), 0.1 * ROTOR * error)


def test_motor_torque_against_what_was_asked_for() -> None:
    torque = np.full(N, 5.0)
    seen = estimate(tau_m=np.linspace(0.0, 10.0, N))
    module = Feedback(UR5E, EXACT, dynamics(), TCP)
    module.add(
        resting(ZERO),
        ZERO,
        seen,
        only("motor_torque"),
        excess=FREE,
        waits=False,
        torque=torque,
        start=None,
        sticking=ZERO,
        stiffer=ZERO,
    )
    np.testing.assert_allclose(torque, 5.0 + 0.1 * (5.0 - np.linspace(0.0, 10.0, N)))


@pytest.mark.parametrize("term", ["tcp_pose", "tcp_speed"])
def test_the_tool_centre_point_is_pulled_back(term: str) -> None:
    """The torque is J^T times a force along the error: its power along the error is positive, and as large as said."""
    model, q = dynamics(), np.array(UR5E.chain.home)
    p, R, jacobian = (part.copy() for part in model.update(q))
    at_tcp = jacobian[:3] + np.cross(jacobian[3:].T, R @ TCP).T
    way = np.array([0.002, -0.001, 0.003])
    if term == "tcp_pose":
        seen, stiffness = estimate(q=q, p_BF=p - way, R_BF=R), 500.0
    else:
        rate = np.linalg.pinv(at_tcp) @ way
        seen, stiffness = estimate(q=q, qd=-rate, p_BF=p, R_BF=R), 20.0
    np.testing.assert_allclose(correction(only(term), seen, resting(q)), at_tcp.T @ (stiffness * way), atol=1e-12)


def test_each_measurement_is_compared_with_its_own_reference() -> None:
    """A reference that moves, measured DELAY ticks late without any error, asks for nothing."""
    module = Feedback(UR5E, EXACT, dynamics(), TCP)
    for k in range(40):
        late = max(k - DELAY, 0)
        torque = np.zeros(N)
        seen = estimate(theta=np.full(N, 0.01 * late), q=np.full(N, 0.01 * late))
        module.add(
            resting(np.full(N, 0.01 * k)),
            ZERO,
            seen,
            only("theta", "q"),
            excess=FREE,
            waits=False,
            torque=torque,
            start=None,
            sticking=ZERO,
            stiffer=ZERO,
        )
        assert np.abs(torque).max() < 1e-9


def test_the_integral_grows_with_the_output_error_and_waits_in_the_dead_band() -> None:
    counts = 2.0 * math.pi / UR5E.sensors.encoders.output_counts
    error = counts * np.array([0.0, 2.9, -2.9, 3.1, -3.1, 100.0])
    module = Feedback(UR5E, EXACT, dynamics(), TCP)
    for _ in range(10):
        torque = np.zeros(N)
        module.add(
            resting(error),
            ZERO,
            estimate(),
            only("q"),
            excess=FREE,
            waits=False,
            torque=torque,
            start=None,
            sticking=ZERO,
            stiffer=ZERO,
        )
    expected = 10 * 0.002 * ROTOR * OMEGA**2 / 0.1 * error
    expected[:3] = 0.0
    np.testing.assert_allclose(torque, expected)


def test_the_integral_keeps_its_value_while_it_is_told_to_wait() -> None:
    """What stands in the way of a motion that is stopped is not pushed on."""
    module, pushes = Feedback(UR5E, EXACT, dynamics(), TCP), []
    for waits in (False, True, True, False):
        torque = np.zeros(N)
        module.add(
            resting(np.full(N, 0.01)),
            ZERO,
            estimate(),
            only("q"),
            excess=FREE,
            waits=waits,
            torque=torque,
            start=None,
            sticking=ZERO,
            stiffer=ZERO,
        )
        pushes.append(torque)
    np.testing.assert_allclose(pushes, np.outer([1, 1, 1, 2], pushes[0]))
    times = 0.002 * ROTOR * OMEGA**2 * 0.01 / pushes[0]
    np.testing.assert_allclose(times[3:], 0.1)
    assert ((times[:3] > 0.11) & (times[:3] < 0.17)).all(), "slower where the arm swings slowly"


def moving(q: np.ndarray, speed: float) -> Reference:
    return Reference(q, np.full(N, speed), ZERO)


def test_what_the_integral_won_against_stiction_goes_over_to_the_friction_fed_forward() -> None:
    """After 2 mrad of sliding only what friction could not have held is left."""
    module, sticking = Feedback(UR5E, EXACT, dynamics(), TCP), np.full(N, 2.0)
    torque = np.zeros(N)
    while torque.min() < 5.0:
        torque = np.zeros(N)
        module.add(
            resting(np.full(N, 0.002)),
            ZERO,
            estimate(),
            only("q"),
            excess=FREE,
            waits=False,
            torque=torque,
            start=None,
            sticking=sticking,
            stiffer=ZERO,
        )
    won = torque.copy()
    there = estimate(q=np.full(N, 0.002))
    for _ in range(50):
        torque = np.zeros(N)
        module.add(
            moving(np.full(N, 0.002), 0.02),
            ZERO,
            there,
            only("q"),
            excess=FREE,
            waits=False,
            torque=torque,
            start=None,
            sticking=sticking,
            stiffer=ZERO,
        )
    np.testing.assert_allclose(torque, won - 2.0, atol=0.05)


def test_a_load_that_comes_bends_the_spring_at_a_speed() -> None:
    module = Feedback(UR5E, EXACT, dynamics(), TCP)
    module.add(
        resting(ZERO),
        ZERO,
        estimate(),
        only("theta_speed"),
        excess=FREE,
        waits=False,
        torque=np.zeros(N),
        start=begun(ZERO),
        sticking=ZERO,
        stiffer=ZERO,
    )
    for load in (10.0, 20.0, 30.0, 40.0):
        torque = np.zeros(N)
        module.add(
            resting(ZERO),
            np.full(N, load),
            estimate(),
            only("theta_speed"),
            excess=FREE,
            waits=False,
            torque=torque,
            start=None,
            sticking=ZERO,
            stiffer=ZERO,
        )
    np.testing.assert_allclose(torque, 2 * 1.25 * ROTOR * OMEGA * COMPLIANCE * 10.0 / 0.002)


def test_the_integral_goes_back_where_more_is_asked_than_the_motor_gives() -> None:
    """AF-6: a limit of 5 N·m. What is asked settles there instead of winding up, and leaves it as the error does."""
    limit = np.array([5.0, 1e9, 5.0, 1e9, 5.0, 1e9])
    module, excess, torque = Feedback(UR5E, EXACT, dynamics(), TCP), np.zeros(N), np.zeros(N)
    step = 0.1 * 0.002 / 0.1 * ROTOR * OMEGA**2  # of the integral in a tick
    for error, ticks in ((0.1, 100), (-0.02, 100)):
        for _ in range(ticks):
            torque = np.zeros(N)
            module.add(
                resting(np.full(N, error)),
                ZERO,
                estimate(),
                only("q"),
                excess=excess,
                waits=False,
                torque=torque,
                start=None,
                sticking=ZERO,
                stiffer=ZERO,
            )
            excess = np.where(torque > limit, torque - limit, 0.0)
        if error > 0.0:
            assert (torque[limit < 1e9] < 5.0 + 1.01 * step[limit < 1e9]).all()
            assert (torque[limit > 1e9 - 1.0] >= INTEGRAL_SHARE * np.array(UR5E.limits.torque)[limit > 1e9 - 1.0]).all()
    assert (torque[limit < 1e9] < 5.0 - 10.0 * 0.1 * step[limit < 1e9]).all()


def test_taking_over_asks_for_the_feed_forward_alone() -> None:
    """Bumpless: whatever the corrections would do at once is taken up by the integral."""
    module = Feedback(UR5E, EXACT, dynamics(), TCP)
    seen = estimate(theta=np.linspace(-0.01, 0.01, N), theta_d=np.full(N, 0.3))
    torque, fed = np.linspace(1.0, 9.0, N), np.linspace(2.0, -4.0, N)
    module.add(
        resting(ZERO),
        ZERO,
        seen,
        JointControl(),
        excess=FREE,
        waits=False,
        torque=torque,
        start=begun(fed),
        sticking=ZERO,
        stiffer=ZERO,
    )
    np.testing.assert_allclose(torque, fed)


def test_switches_may_change_from_tick_to_tick() -> None:
    module = Feedback(UR5E, EXACT, dynamics(), TCP)
    seen = estimate(theta=np.full(N, -1e-3))
    sums = []
    for use in (only("theta"), only(), only("theta")):
        torque = np.zeros(N)
        module.add(
            resting(ZERO), ZERO, seen, use, excess=FREE, waits=False, torque=torque, start=None, sticking=ZERO, stiffer=ZERO
        )
        sums.append(float(torque.sum()))
    assert sums[0] == sums[2] > 0.0
    assert sums[1] == 0.0


@pytest.mark.parametrize(("softer", "damped"), [(1.0, 0.2), (0.5, 0.1)], ids=["as filed", "half as stiff"])
def test_a_heavy_arm_on_its_springs_does_not_swing_by_itself(softer: float, damped: float) -> None:
    """Poles of the loop round one joint, stretched out with the largest payload: rotor, spring and all it moves.

    J theta'' = S tau - tau - K theta - D theta' - K_i z,    M q'' = tau = k (theta - q),    z' = q
    """
    spring = UR5E.transmissions
    names = ("stiffness", "hysteresis_stiffness")
    arm = replace(UR5E, transmissions=replace(spring, **{name: [softer * x for x in getattr(spring, name)] for name in names}))
    model = dynamics()
    stretched = np.array([0.0, 0.0, 0.0, 0.0, -1.57, 0.0])
    ways = model.update(stretched)[2][:3].copy()
    inertia = model.mass(stretched).diagonal() + arm.payload * np.sum(ways**2, axis=0)

    def asked(seen: Estimate, *names: str, ticks: int = 1) -> np.ndarray:
        module, torques = Feedback(arm, EXACT, model, TCP), []
        for _ in range(ticks):
            torques.append(np.zeros(N))
            module.add(
                STANDING,
                ZERO,
                seen,
                only(*names),
                excess=FREE,
                waits=False,
                torque=torques[-1],
                start=None,
                sticking=ZERO,
                stiffer=ZERO,
            )
        return torques[-1] - (torques[-2] if ticks > 1 else 0.0)

    way = np.full(N, -0.01)
    stiffness, damping = asked(estimate(theta=way), "theta") / 0.01, asked(estimate(theta_d=way), "theta_speed") / 0.01
    integral = asked(estimate(q=way), "q", ticks=3) / 0.01 / TICK
    for i in range(N):
        k, J = 1.0 / COMPLIANCE[i] * softer, ROTOR[i]
        loop = np.zeros((5, 5))  # theta, theta', q, q', z
        loop[0, 1] = loop[2, 3] = loop[4, 2] = 1.0
        loop[1] = [-(stiffness[i] + (1.0 - SUPPORT) * k) / J, -damping[i] / J, (1.0 - SUPPORT) * k / J, 0.0, -integral[i] / J]
        loop[3, [0, 2]] = k / inertia[i], -k / inertia[i]
        poles = np.linalg.eigvals(loop)
        swings = poles[np.abs(poles) < 2.0 * math.pi * 10.0]
        assert (-swings.real / np.abs(swings)).min() > damped, UR5E.chain.joints[i]


def test_a_joint_asks_for_its_rated_torque_at_the_largest_following_error() -> None:
    """RL-1: the load turns the motor against the position loop, which the torque feedback stiffens, and bends the gear."""
    rated = np.array(UR5E.limits.torque)
    motor = rated * (1.0 - SUPPORT) / (ROTOR * OMEGA**2)
    np.testing.assert_allclose(following_limit(UR5E), motor + rated * COMPLIANCE)
    assert (np.degrees(following_limit(UR5E)) > 1.0).all()
    assert (np.degrees(following_limit(UR5E)) < 1.6).all()


@pytest.mark.parametrize("sign", [-1.0, 1.0])
def test_the_integral_of_an_arm_that_is_held_stops_at_its_share_of_the_rated_torque(sign: float) -> None:
    """AF-6: and it goes back as soon as the error does."""
    module, most = Feedback(UR5E, EXACT, dynamics(), TCP), INTEGRAL_SHARE * np.array(UR5E.limits.torque)
    torque = np.zeros(N)

    def asked(error: float) -> np.ndarray:
        torque = np.zeros(N)
        add = resting(np.full(N, error)), ZERO, estimate(), only("q")
        module.add(*add, excess=FREE, waits=False, torque=torque, start=None, sticking=ZERO, stiffer=ZERO)
        return torque

    for _ in range(20000):
        torque = asked(0.01 * sign)
    grown = sign * torque
    assert (grown >= most).all()
    assert (grown <= 1.05 * most).all()
    for _ in range(DELAY + 1):
        torque = asked(-0.01 * sign)
    assert (sign * torque < grown).all()


def test_a_law_begins_with_the_torque_that_it_is_told_and_joints_that_were_driven_without_an_integral() -> None:
    """RL-2."""
    fed, error = np.full(N, 40.0), np.full(N, 1e-3)
    add = STANDING, ZERO, estimate(theta=-error), only("theta", "q")
    for driven, wanted in ((False, fed), (True, ROTOR * OMEGA**2 * error)):
        torque = np.zeros(N)
        start = begun(fed, driven)
        Feedback(UR5E, EXACT, dynamics(), TCP).add(
            *add, excess=FREE, waits=False, torque=torque, start=start, sticking=ZERO, stiffer=ZERO
        )
        np.testing.assert_allclose(torque, wanted)
