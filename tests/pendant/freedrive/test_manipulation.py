"""Manipulation, densely around every limit (FD-13)."""

import math
from collections.abc import Callable

import numpy as np
import pytest

from pendant.all_settings import Settings, apply
from pendant.freedrive.manipulation import Maintained
from pendant.sensor.hand_model import TOUCH
from pendant.tick.estimate import Estimate
from pendant.tick.limit_engine import Excess
from pendant.tick.pose import Wrench
from pendant.tick.state import state_of
from tests.pendant.estimates import estimate

JOINTS = ("base", "shoulder", "elbow", "wrist_1", "wrist_2", "wrist_3")
TILT = [0.6, 0.0, -0.8]
"""Gravity's direction on a tilted foot."""

# parameter: limit, unit, how an estimate gets a value of it at component k, number of components
PARAMETERS: dict[str, tuple[float, str, Callable[[float, int], Estimate], int]] = {
    "user force": (8.0, "N", lambda value, k: estimate(force=at(value, k, 3)), 2),
    "user torque": (1.5, "N·m", lambda value, k: estimate(torque=at(value, 2 - k, 3)), 1),
    "joint external torque": (8.0, "N·m", lambda value, k: estimate(tau_ext=at(value, k, 6)), 6),
    "joint speed": (0.05, "rad/s", lambda value, k: estimate(qd=at(value, k, 6)), 6),
    "flange speed": (0.02, "m/s", lambda value, k: estimate(speed=at(value, k, 3)), 3),
    "flange displacement": (0.01, "m", lambda value, k: estimate(position=at(value, k, 3)), 3),
    "flange acceleration": (1.5, "m/s²", lambda value, k: estimate(acceleration=at(value, k, 3)), 2),
}
JOINT = {"joint external torque", "joint speed"}


def at(value: float, index: int, length: int) -> list[float]:
    return [value if k == index else 0.0 for k in range(length)]


def felt(value: Estimate) -> Wrench:
    return tuple(value.F_user.tolist())


def see(watch: Maintained, value: Estimate) -> Excess | None:
    return watch.step(value, felt(value))


def maintained(start: Estimate | None = None, sensed: bool = True, **changes: float | bool) -> Maintained:
    names = {f"limits.maintain.{name.replace('__', '.')}": value for name, value in changes.items()}
    start = start or estimate()
    return Maintained(start, apply(Settings(), names), felt(start) if sensed else None, JOINTS)


@pytest.mark.parametrize("name", PARAMETERS)
def test_beyond_the_limit_and_not_at_it(name: str) -> None:
    limit, unit, make, count = PARAMETERS[name]
    near = [limit * (1 + step * 1e-12) for step in range(-5, 6)] + [limit * share for share in np.linspace(0, 3, 61)]
    for component in range(count):
        for value in near:
            for sign in (1.0, -1.0):
                excess = see(maintained(), make(sign * value, component))
                part = JOINTS[component] if name in JOINT else "flange"
                expected = Excess(name, part, value, limit, unit) if value > limit else None
                assert excess == expected, (value, component)


@pytest.mark.parametrize("name", PARAMETERS)
def test_a_limit_that_is_off_is_not_checked_and_one_with_time_is_late(name: str) -> None:
    limit, _, make, _ = PARAMETERS[name]
    key = {"joint external torque": "joint_torque"}.get(name, name.replace(" ", "_"))
    beyond = make(1.01 * limit, 0)
    off = maintained(**{f"{key}__on": False})
    assert all(see(off, beyond) is None for _ in range(20))
    late = maintained(**{f"{key}__time": 0.02})
    assert [see(late, beyond) is None for _ in range(11)] == [True] * 10 + [False]


def test_vectors_count_by_their_length() -> None:
    excess = see(maintained(), estimate(force=[5.0, 7.0, 0.0]))
    assert excess == Excess("user force", "flange", math.sqrt(74.0), 8.0, "N")
    excess = see(maintained(), estimate(speed=[0.012, -0.012, 0.012]))
    assert excess is not None
    assert excess.value == pytest.approx(0.012 * math.sqrt(3.0))


def test_forces_count_from_what_they_were_when_the_period_began() -> None:
    joints = [9.0, -20.0, 3.0, 1.0, 0.5, 0.2]
    leaning = estimate(force=[30.0, -12.0, 7.0], torque=[2.0, 1.0, -3.0], tau_ext=joints)
    assert see(maintained(leaning), leaning) is None
    let_go = see(maintained(leaning), estimate(tau_ext=joints))
    assert let_go is not None
    assert let_go.parameter == "user force"
    assert let_go.value == pytest.approx(math.sqrt(900 + 144 + 49), rel=1e-3)
    joints_only = see(maintained(estimate(tau_ext=joints)), estimate())
    assert joints_only == Excess("joint external torque", "shoulder", 20.0, 8.0, "N·m")


@pytest.mark.parametrize("g", [[0.48, 0.6, -0.64], [-0.64, 0.48, 0.6], [0.6, -0.64, 0.48]])
def test_what_counts_of_a_wrench_that_stays_is_what_no_payload_explains(g: list[float]) -> None:
    """The whole change, but for what has stayed of it: of the force along gravity, of the torque across it."""
    force, torque, up, ticks = np.array([9.0, -13.0, 17.0]), np.array([2.0, 5.0, -3.0]), -np.array(g), 100
    stayed = 1.0 - math.exp(-ticks / TOUCH)
    slow_force, slow_torque = stayed * force, stayed * torque
    expected = {
        "user force": np.linalg.norm(force - (slow_force @ up) * up),
        "user torque": np.linalg.norm(torque - slow_torque + (slow_torque @ up) * up),
    }
    for name, changes in (("user force", {}), ("user torque", {"user_force__on": False})):
        start, pushed = estimate(), estimate(force=force.tolist(), torque=torque.tolist())
        start.g_B = pushed.g_B = 9.81 * np.array(g)
        watch = maintained(start, **changes)
        excess = [see(watch, pushed) for _ in range(ticks)][-1]
        assert excess is not None
        assert (excess.parameter, excess.value) == (name, pytest.approx(expected[name]))


def drift(rate: float, seconds: float, direction: list[float], g: list[float]) -> Excess | None:
    """A force that grows by `rate` [N/s] along `direction`."""
    watch = None
    for k in range(round(500 * seconds)):
        value = estimate(force=(np.array(direction) * rate * k / 500).tolist())
        value.g_B = 9.81 * np.array(g)
        watch = watch or Maintained(value, Settings(), felt(value), JOINTS)
        excess = see(watch, value)
        if excess is not None:
            return excess
    return None


@pytest.mark.parametrize("g", [[0.0, 0.0, -1.0], [0.0, 0.0, 1.0], [-1.0, 0.0, 0.0], TILT])
def test_what_stays_along_gravity_is_a_payload_and_no_manipulation(g: list[float]) -> None:
    """A payload-like residual never counts as manipulation; a hand is told by its change, or by what is across gravity."""
    assert drift(3.0, 10.0, g, g) is None
    assert drift(-3.0, 10.0, g, g) is None
    across = np.cross(g, [0.3, 0.9, 0.1])
    across /= np.linalg.norm(across)
    excess = drift(3.0, 10.0, across.tolist(), g)
    assert excess is not None
    assert excess.value == pytest.approx(8.0, abs=0.01)
    sudden = drift(30.0, 1.0, g, g)
    assert sudden is not None
    assert sudden.parameter == "user force"


def test_a_torque_that_stays_across_gravity_is_a_payload_and_one_about_it_is_not() -> None:
    watch = maintained()
    for k in range(2500):
        assert see(watch, estimate(torque=[0.002 * k, -0.001 * k, 0.0])) is None
    watch = maintained()
    values = [see(watch, estimate(torque=[0.0, 0.0, 0.002 * k])) for k in range(800)]
    assert next(k for k, value in enumerate(values) if value) == 751


def test_without_the_flange_sensor_the_joints_judge_alone() -> None:
    """FD-3a."""
    pushed = estimate(force=100.0, torque=20.0, acceleration=30.0, acceleration_valid=False).copy()
    pushed.F_user[:] = math.nan
    watch = maintained(pushed, sensed=False)
    assert watch.step(pushed, None) is None
    pushed.qd[3] = 0.3
    assert watch.step(pushed, None) == Excess("joint speed", "wrist_1", 0.3, 0.05, "rad/s")


def test_any_number_of_joints() -> None:
    names = tuple(f"joint {k}" for k in range(1, 8))
    watch = Maintained(estimate(n=7), Settings(), (0.0,) * 6, names)
    excess = see(watch, estimate(n=7, tau_ext=at(12.0, 6, 7)))
    assert excess == Excess("joint external torque", "joint 7", 12.0, 8.0, "N·m")


def test_its_state_tells_all_of_it() -> None:
    one, other = maintained(), maintained()
    see(one, estimate(force=[1.0, 0.0, 0.5]))
    assert state_of(one) != state_of(other)
    see(other, estimate(force=[1.0, 0.0, 0.5]))
    assert state_of(one) == state_of(other)


@pytest.mark.parametrize(("share", "force", "torque"), [(0.0, 8.0, 8.0), (0.5, 8.0 + 0.5 * 3.0 * 9.81, 8.0 + 0.5 * 40.0)])
def test_force_limits_may_rise_with_the_load(share: float, force: float, torque: float) -> None:
    """FD-13: the payload's weight for the user's force, the joint's own load for its torque."""
    start = estimate(load_mass=3.0, tau_J=40.0)
    for value, within in ((0.999, True), (1.001, False)):
        module = maintained(start, load_share=share)
        push = estimate(load_mass=3.0, tau_J=40.0, force=value * force)
        assert (see(module, push) is None) is within
        module = maintained(start, load_share=share)
        push = estimate(load_mass=3.0, tau_J=40.0, tau_ext=value * torque)
        assert (see(module, push) is None) is within


def test_a_period_that_begins_anew_is_as_one_that_begins() -> None:
    """FD-16: also what has been smoothed of the load begins with nothing."""
    watch, pushed = maintained(), estimate(force=[3.0, 1.0, -5.0], torque=[0.3, 0.2, 0.1])
    for _ in range(20):
        see(watch, pushed)
    watch.anew(pushed, felt(pushed))
    fresh = maintained(pushed)
    assert (watch._since, watch._slow) == (fresh._since, fresh._slow)


@pytest.mark.parametrize("at_begin", [(0.0, 0.0, 0.0), (3.0, -1.0, 2.0)])
@pytest.mark.parametrize("axis", range(3))
@pytest.mark.parametrize("share", [-1.01, -0.99, 0.0, 0.99, 1.01, 9.0])
def test_a_hand_on_a_link_counts_by_a_change_that_is_a_hands(share: float, axis: int, at_begin: tuple[float, ...]) -> None:
    """It is told without what sensor and joints may err by; so it counts from the force on that is a hand's (FD-19)."""
    least = Settings().unexplained.force
    now = [value + (share * least if k == axis else 0.0) for k, value in enumerate(at_begin)]
    excess = see(maintained(estimate(link=list(at_begin))), estimate(link=now))
    assert excess == (Excess("user force", "link", pytest.approx(abs(share) * least), least, "N") if abs(share) > 1.0 else None)


@pytest.mark.parametrize("axis", range(3))
@pytest.mark.parametrize("share", [-1.01, -0.99, 0.99, 1.01])
def test_who_touches_an_arm_that_stands_counts(share: float, axis: int) -> None:
    """It is told as a change already (FD-13), beside the flange sensor alone."""
    least = Settings().unexplained.force
    watch, now = maintained(), estimate(touch=[share * least * (k == axis) for k in range(3)])
    excess = see(watch, now)
    assert excess == (Excess("user force", "link", pytest.approx(abs(share) * least), least, "N") if abs(share) > 1.0 else None)
    assert maintained(sensed=False).step(now, None) is None


def test_where_no_force_counts_none_on_a_link_does() -> None:
    off = apply(Settings(), {"limits.maintain.user_force.on": False})
    watch = Maintained(estimate(), off, felt(estimate()), JOINTS)
    assert see(watch, estimate(link=9.0, touch=9.0)) is None
    assert not watch.touched(estimate(touch=9.0), felt(estimate()))
    assert maintained().touched(estimate(touch=9.0), felt(estimate()))


def test_as_the_period_starts_again_so_does_what_is_felt_on_a_link() -> None:
    """What hangs on a link does not keep an arm free."""
    watch, hung = maintained(), estimate(link=[0.0, 0.0, -9.0])
    assert see(watch, hung) is not None
    watch.anew(hung, felt(hung))
    assert see(watch, hung) is None
    assert see(watch, estimate()) is not None


def test_without_the_flange_sensor_no_hand_on_a_link_is_told() -> None:
    watch = maintained(sensed=False)
    assert watch.step(estimate(link=[9.0, 0.0, 0.0]), None) is None
    begun = Maintained(estimate(link=[9.0, 0.0, 0.0]), Settings(), None, JOINTS)
    assert begun.step(estimate(), None) is None


def test_another_parameter_is_told_first() -> None:
    excess = see(maintained(), estimate(link=[9.0, 0.0, 0.0], speed=[0.1, 0.0, 0.0]))
    assert excess is not None
    assert excess.parameter == "flange speed"
