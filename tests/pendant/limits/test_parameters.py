"""How every parameter is read, against numpy."""

import math

import msgspec
import numpy as np
import pytest

from pendant.all_settings import Settings
from pendant.limits.dynamic_limits import Shares
from pendant.limits.parameters import PARAMETERS, ZEROS, EntryValues, Monitor, Observed, reference
from pendant.limits.residual import PayloadError, split
from pendant.settings.schema import Limit, Section
from pendant.tick.state import state_of
from tests.pendant.estimates import estimate
from tests.pendant.test_all_settings import LIMITS, OFF

JOINTS = ("base", "shoulder", "elbow", "wrist_1", "wrist_2", "wrist_3")
RATED = (150.0, 150.0, 150.0, 28.0, 28.0, 28.0)


def view(value, since: EntryValues | None = None, scale: tuple[float, ...] = RATED, share: float = 0.0) -> Observed:
    parts, known = split(value.F_user.tolist(), (0.0, 0.0, 1.0)), PayloadError(-0.2, 0.1)
    since = since or EntryValues((0.0,) * 3, ZEROS, (0.0,) * 6, (0.0,) * 6)
    return Observed(value, since, parts, JOINTS, scale, share, payload=known)


def test_every_limit_of_every_stage_is_of_a_parameter() -> None:
    for stage, parameters in LIMITS.items():
        assert set(parameters) <= set(PARAMETERS), stage
    assert set(PARAMETERS) == set().union(*LIMITS.values())


@pytest.mark.parametrize("seed", range(10))
def test_sizes(seed: int) -> None:
    rng = np.random.default_rng(seed)
    value = estimate(v_tcp=0.7, v_elbow=0.3)
    value.p_BF, value.a_felt = rng.normal(size=(2, 3))
    value.v_F, value.q, value.qd, value.qdd, value.F_user, value.tau_m = rng.normal(size=(6, 6))
    value.R_BF = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    start, angles = rng.normal(size=3), rng.normal(size=6)
    since = EntryValues(tuple(start), ZEROS, (0.0,) * 6, tuple(angles))
    fastest, quickest, furthest = (int(np.abs(each).argmax()) for each in (value.qd, value.qdd, value.q - angles))
    value.current = rng.normal(size=6)
    strained = int((np.abs(value.tau_m) / RATED).argmax())
    expected = {
        "flange_displacement": (np.linalg.norm(value.p_BF - start), "flange"),
        "flange_speed": (np.linalg.norm(value.v_F[:3]), "flange"),
        "flange_acceleration": (np.linalg.norm(value.a_felt), "flange"),
        "tcp_speed": (0.7, "tcp"),
        "elbow_speed": (0.3, "elbow"),
        "joint_displacement": (abs(value.q[furthest] - angles[furthest]), JOINTS[furthest]),
        "joint_speed": (abs(value.qd[fastest]), JOINTS[fastest]),
        "joint_acceleration": (abs(value.qdd[quickest]), JOINTS[quickest]),
        "motor_torque": (abs(value.tau_m[strained]), JOINTS[strained]),
        "motor_current": (np.abs(value.current).max(), JOINTS[int(np.abs(value.current).argmax())]),
        "payload_force": (value.F_user[2], "flange"),
        "payload_torque": (math.hypot(*value.F_user[3:5]), "flange"),
        "payload_error": (0.2, "flange"),
        "user_force": (math.hypot(*value.F_user[:2]), "flange"),
        "user_torque": (abs(value.F_user[5]), "flange"),
    }
    for name, (size, part) in expected.items():
        found, where, _ = PARAMETERS[name].read(view(value, since), 1.0)
        assert found == pytest.approx(size), name
        assert where == part, name


@pytest.mark.parametrize("strength", [1.0, 0.02], ids=["beyond", "within"])
@pytest.mark.parametrize("seed", range(20))
def test_the_joint_nearest_to_its_own_limit_counts(seed: int, strength: float) -> None:
    """The limit is a share of the rated torque, and rises with the load."""
    rng = np.random.default_rng(seed)
    value = estimate()
    value.tau_ext, value.tau_J = strength * rng.normal(0.0, 5.0, (2, 6))
    before = strength * rng.normal(0.0, 2.0, 6)
    since = EntryValues((0.0,) * 3, ZEROS, tuple(before), (0.0,) * 6)
    size, part, high = PARAMETERS["joint_torque"].read(view(value, since, share=0.25), 0.04)
    limits = 0.04 * np.array(RATED) + 0.25 * np.abs(value.tau_J)
    shares = np.abs(value.tau_ext - before) / limits
    worst = int(shares.argmax())
    assert (shares[worst] > 1.0) == (strength == 1.0)
    assert part == JOINTS[worst]
    assert size == pytest.approx(abs(value.tau_ext[worst] - before[worst]))
    assert high == pytest.approx(limits[worst])


def test_nothing_at_all_is_within_its_limit() -> None:
    assert PARAMETERS["joint_torque"].read(view(estimate()), 0.04) == (0.0, "base", 0.04 * RATED[0])


@pytest.mark.parametrize("stage", LIMITS)
def test_a_monitor_checks_what_is_on_and_measured(stage: str) -> None:
    section = getattr(Settings().limits, stage)
    assert isinstance(section, Section)
    monitor = Monitor(section)
    assert monitor.step(view(estimate())) == []
    names = [PARAMETERS[name].text for name in PARAMETERS if name in LIMITS[stage] and f"{stage}.{name}" not in OFF]
    assert [item.name for item in monitor.monitored()] == names
    assert {item.name for item in monitor.monitored() if math.isfinite(item.low)} <= {"payload-like force"}, "others are sizes"
    blind = Monitor(section)
    value = estimate(acceleration=90.0, force=95.0, torque=15.0, acceleration_valid=False)
    assert blind.step(msgspec.structs.replace(view(value), split=None)) == []
    sensed = {PARAMETERS[name].text for name in PARAMETERS if PARAMETERS[name].wrench or PARAMETERS[name].acceleration}
    assert [item.name for item in blind.monitored()] == [name for name in names if name not in sensed]
    seeing = Monitor(section)
    value.acceleration_valid = True
    for _ in range(51):
        beyond = seeing.step(view(value))
    assert {gauge.name for gauge in beyond} >= {"flange acceleration", "user force"}


@pytest.mark.parametrize(("margin", "high"), [(0.0, 0.3), (0.29, 0.3), (0.31, 0.31)])
def test_no_payload_is_wrong_by_what_a_right_one_may_seem_to_be(margin: float, high: float) -> None:
    known = msgspec.structs.replace(view(estimate()), payload=PayloadError(-0.5, margin))
    assert PARAMETERS["payload_error"].read(known, 0.3) == (0.5, "flange", high)
    unknown = msgspec.structs.replace(known, payload=None)
    assert PARAMETERS["payload_error"].read(unknown, 0.3) == (0.0, "", 0.3), "without a part it is not shown"


def test_a_motor_is_judged_by_its_rated_torque() -> None:
    value = estimate().copy()
    value.tau_m[1], value.tau_m[4] = -60.0, 13.0
    assert PARAMETERS["motor_torque"].read(view(value), 0.5) == (13.0, "wrist_2", 14.0)
    value.tau_m[1] = -72.0
    assert PARAMETERS["motor_torque"].read(view(value), 0.5) == (72.0, "shoulder", 75.0)


def test_limits_carry_reaction_and_time() -> None:
    class Few(Section, frozen=True, forbid_unknown_fields=True, kw_only=True):
        payload_force: Limit = Limit(max=5.0, time=0.004)
        user_force: Limit = Limit(max=5.0, on=False)

    monitor = Monitor(Few())
    heavy = view(estimate(force=[50.0, 0.0, -5.1]))
    assert [len(monitor.step(heavy)) for _ in range(3)] == [0, 0, 1]
    assert [gauge.stop for gauge in monitor.step(heavy)] == [False], "STOP is a reaction of limits that say so"
    (shown,) = monitor.monitored()
    assert (shown.value, shown.low, shown.limit, shown.high) == (-5.1, -5.0, -5.0, 5.0)
    within = view(estimate(force=[50.0, 0.0, -5.0]))
    assert [len(monitor.step(each)) for each in (within, heavy, heavy, heavy)] == [0, 0, 0, 1], "the time starts again"
    assert state_of(monitor) != state_of(Monitor(Few()))
    monitor.step(view(estimate(force=[50.0, 0.0, 2.5])))
    monitor.step(view(estimate(force=[50.0, 0.0, 3.0])))
    assert [shown.value for shown in monitor.monitored()] == [3.0], "what is within is shown as well"


def test_a_reference_is_what_is_so_now() -> None:
    value = estimate(position=[1.0, 2.0, 3.0], force=[4.0, 5.0, 6.0], torque=7.0, tau_ext=[1.0, 2.0, 3.0, 4.0, 5.0, 6.0]).copy()
    value.q[2] = 0.5
    torques, angles = (1.0, 2.0, 3.0, 4.0, 5.0, 6.0), (0.0, 0.0, 0.5, 0.0, 0.0, 0.0)
    assert reference(value, tuple(value.F_user.tolist())) == EntryValues(
        (1.0, 2.0, 3.0), (4.0, 5.0, 6.0, 7.0, 0.0, 0.0), torques, angles
    )
    assert reference(value, None) == EntryValues((1.0, 2.0, 3.0), ZEROS, torques, angles)


@pytest.mark.parametrize(
    ("name", "share"),
    [
        ("flange_displacement", 0.9),
        ("joint_displacement", 0.9),
        ("flange_speed", 0.8),
        ("tcp_speed", 0.8),
        ("elbow_speed", 0.8),
        ("joint_speed", 0.7),
        ("flange_acceleration", 0.6),
        ("joint_acceleration", 0.5),
    ],
)
def test_each_limit_falls_by_its_own_share(name: str, share: float) -> None:
    """FD-12b."""
    shares = Shares(way=0.9, speed=0.8, turning=0.7, linear=0.6, angular=0.5)
    _, _, high = PARAMETERS[name].read(msgspec.structs.replace(view(estimate()), shares=shares), 2.0)
    assert high == pytest.approx(2.0 * share)


@pytest.mark.parametrize(
    ("name", "share"),
    [
        ("flange_displacement", 0.9),
        ("flange_speed", 0.8),
        ("tcp_speed", 0.8),
        ("elbow_speed", 0.8),
        ("flange_acceleration", 0.6),
    ],
)
def test_a_linear_limit_falls_along_gravity_as_well(name: str, share: float) -> None:
    """FD-12b (v): of p_BF - p0, or of the speed or acceleration of the part."""
    up, value, start = np.array([2.0, -3.0, 6.0]) / 7.0, estimate(), (0.4, -0.1, 0.3)
    vector = np.array([0.5, 0.3, -0.2])
    value.p_BF, value.a_felt, value.v_F = vector + start, vector, np.append(vector, np.zeros(3))
    value.tcp = value.elbow = np.append(np.zeros(3), vector)
    shares = Shares(way=0.9, speed=0.8, linear=0.6, vertical=0.5, up=tuple(up))
    since = EntryValues(start, ZEROS, (0.0,) * 6, (0.0,) * 6)
    _, _, high = PARAMETERS[name].read(msgspec.structs.replace(view(value, since), shares=shares), 2.0)
    vertical = vector @ up / np.linalg.norm(vector)
    assert high == pytest.approx(2.0 * share / math.sqrt(1.0 + 3.0 * vertical**2))


def test_no_joint_is_refused_for_what_its_encoder_makes_of_its_torque() -> None:
    """Of rated 100 N·m each joint may have 4, and a quarter of its load; a coarse encoder makes 7."""
    value = estimate(tau_ext=[5.0, 7.5, 0.0, 0.0, 0.0, 0.0], tau_J=[0.0, 10.0, 0.0, 0.0, 0.0, 0.0])
    rated = (100.0,) * 6
    assert PARAMETERS["joint_torque"].read(view(value, scale=rated, share=0.25), 0.04) == (5.0, "base", 4.0)
    value.tau_blur = (3.0, 7.0, 3.0, 3.0, 3.0, 3.0)
    assert PARAMETERS["joint_torque"].read(view(value, scale=rated, share=0.25), 0.04) == (5.0, "base", 4.0)
    value.tau_blur = (7.0, 7.0, 3.0, 3.0, 3.0, 3.0)
    assert PARAMETERS["joint_torque"].read(view(value, scale=rated, share=0.25), 0.04)[1:] == ("shoulder", 9.5)
    assert PARAMETERS["joint_torque"].read(view(value, scale=rated), 0.8)[2] == 80.0, "what ends free-drive stays as it is"
