"""What ends free-drive while it lasts: limits, motion that nobody causes, payloads that drop or change, the way back."""

import itertools
import math
from collections.abc import Iterable

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from pendant.all_settings import Settings, apply
from pendant.decision import Decision
from pendant.events.event import Event, Kind
from pendant.guided.endings import CERTAIN, SWINGS, Ending, EndingWatch, _torque, way_back
from pendant.guided.endings import LASTS as STEP_LASTS
from pendant.guided.hidden_drop import LASTS, LEAST
from pendant.guided.sensor_bias import SURE, Slack
from pendant.guided.user_force import CARRIED, SWING, UserForce
from pendant.guided.work import ASKED, LEFT
from pendant.inputs import NOTHING, Button, Inputs
from pendant.supervisor import Supervisor
from pendant.tick.estimate import GRAVITY, Estimate
from pendant.tick.modes import TICK, Mode
from pendant.tick.pose import Vector, Wrench
from pendant.tick.state import state_of
from tests.pendant.estimates import estimate
from tests.pendant.telling import whole

JOINTS = ("base", "shoulder", "elbow", "wrist_1", "wrist_2", "wrist_3")
RATED = (150.0, 150.0, 150.0, 28.0, 28.0, 28.0)
ZEROS = (0.0,) * 6
G = 9.81
TWO = [0.0, 0.0, 2.0 * G]  # what 2 kg need at rest
FRICTION = 8.0  # of the elbow [N·m]
PAYS = ASKED * LEFT * FRICTION  # torque that pays for it [N·m]


class Free:
    """A free-drive that is watched."""

    def __init__(self, baseline: tuple[float, ...] = ZEROS, held: float = 0.0, **changes: float | bool) -> None:
        settings = apply(Settings(), {name.replace("__", "."): value for name, value in changes.items()})
        self.hand = UserForce(estimate(), baseline)
        self.operation, self.baseline = EndingWatch(estimate(), settings, joints=JOINTS, rated=RATED, held=held), baseline
        self.ticks, self.slack = 0, SURE

    def see(self, value: Estimate, use_wrench: bool = True, driven: bool = False, drifted: Wrench = ZEROS) -> Ending | None:
        """`slack` is set where a test wants some."""
        self.ticks += 1
        self.hand.step(value, use_wrench)
        baseline = tuple([a + b for a, b in zip(self.baseline, drifted, strict=True)]) if use_wrench else None
        return self.operation.step(value, self.hand, baseline=baseline, driven=driven, slack=self.slack)

    def until(self, values: Iterable[Estimate], **how: bool) -> Ending | None:
        return next((ending for value in values if (ending := self.see(value, **how)) is not None), None)


def loaded(force: list[float] | float = 0.0, needed: list[float] | None = None, mass: float = 2.0) -> Estimate:
    return estimate(force=force, needed=TWO if needed is None else needed, load_mass=mass)


@pytest.mark.parametrize(
    ("within", "beyond", "stop", "parameter", "limit"),
    [
        (estimate(v_tcp=1.5), estimate(v_tcp=1.51), False, "tcp speed", 1.5),
        (estimate(v_elbow=1.5), estimate(v_elbow=1.51), False, "elbow speed", 1.5),
        (estimate(qd=3.0), estimate(qd=-3.01), False, "joint speed", 3.0),
        (estimate(acceleration=39.0), estimate(acceleration=41.0), True, "flange acceleration", 40.0),
    ],
)
def test_an_operation_limit_leaves_or_stops_as_its_row_says(
    within: Estimate, beyond: Estimate, stop: bool, parameter: str, limit: float
) -> None:
    """FD-18."""
    assert Free().see(within) is None
    ending = Free().see(beyond)
    assert ending is not None
    assert ending.kind is (Kind.STOPPED_LIMIT if stop else Kind.LEFT_LIMIT)
    assert (ending.values["parameter"], ending.values["limit"]) == (parameter, pytest.approx(limit))


def test_a_joints_external_torque_has_its_time_and_stops() -> None:
    free = Free()
    assert free.until([estimate(tau_ext=120.0)] * 100) is None
    ending = free.until([estimate(tau_ext=-121.0)] * 100)
    assert ending is not None
    assert ending.kind is Kind.STOPPED_LIMIT
    assert (free.ticks, ending.values["limit"]) == (100 + 26, pytest.approx(120.0))
    assert Free().until([estimate(tau_ext=121.0, tau_J=100.0)] * 100) is not None, "whatever it carries"


def test_the_row_that_stops_comes_first() -> None:
    ending = Free().see(estimate(v_tcp=2.0, acceleration=50.0))
    assert ending is not None
    assert ending.kind is Kind.STOPPED_LIMIT


def test_the_users_force_has_its_time_and_counts_from_the_baseline() -> None:
    free = Free((2.0, 0.0, 0.0, 0.0, 0.0, 0.0))
    assert free.until([estimate(force=91.0)] * 500) is None
    ending = free.until([estimate(force=93.0)] * 500)
    assert ending is not None
    assert ending.values["value"] == pytest.approx(91.0)
    assert free.ticks == 500 + 51
    assert Free().until([estimate(force=[0.0, 0.0, -200.0])] * 500, use_wrench=False) is None
    free = Free()
    assert free.until([estimate(force=200.0)] * 40) is None
    assert free.until([estimate(force=200.0)] * 100, use_wrench=False) is None, "nor what it was before the sensor was lost"


def test_motion_that_nobody_causes_is_stopped_after_its_time() -> None:
    """FD-19."""
    free = Free()
    assert free.until([estimate(speed=0.03)] * 150) is None
    ending = free.see(estimate(speed=0.03))
    assert ending == Ending(Kind.STOPPED_MOTION, {"distance": 0.0, "time": pytest.approx(151 * TICK), "limit": 0.02})


@pytest.mark.parametrize(
    ("speed", "force", "driven"), [(0.019, 0.0, False), (0.03, 30.0, False), (0.03, 0.0, True)], ids=["slow", "hand", "driven"]
)
def test_a_hand_a_wall_or_rest_starts_its_time_afresh(speed: float, force: float, driven: bool) -> None:
    free = Free()
    assert free.until([estimate(speed=0.03)] * 149) is None
    assert free.see(estimate(speed=speed, force=force), driven=driven) is None
    assert free.until([estimate(speed=0.03)] * 150) is None or force > 0.0


@pytest.mark.parametrize(("user", "moved"), [((1.0, 2.0, 2.0), True), ((1.0, 2.0, 1.99), False), ((-2.0, 1.0, -2.0), True)])
def test_a_hand_has_its_least_force_in_whatever_direction(user: Vector, moved: bool) -> None:
    """FD-19: at it, 3 N, the hand moves the arm."""
    free = Free(unexplained__force=3.0)
    free.hand.user = user
    endings = [free.operation.step(estimate(speed=0.03), free.hand, baseline=ZEROS, driven=False) for _ in range(151)]
    assert (endings[-1] is None) is moved


def test_from_its_speed_on_the_arm_moves() -> None:
    assert Free(unexplained__speed=0.125).until([estimate(speed=0.125)] * 151) is not None


def test_a_hand_that_was_let_go_stops_counting_after_the_filter() -> None:
    free = Free()
    free.until([estimate(force=10.0, speed=0.1)] * 500)
    settle = math.ceil(SWING * math.log(10.0 / 1.0) / TICK)
    assert free.until([estimate(speed=0.1)] * (150 + settle - 2)) is None
    assert free.until([estimate(speed=0.1)] * 4) is not None


def elbow(felt: float, turns: float = 0.2, down: float = 0.0) -> Estimate:
    """Moving: what the elbow's joint feels [N·m], how fast it turns [rad/s], what pulls the flange down [N]."""
    third, torques = [0.0, 0.0, turns, 0.0, 0.0, 0.0], [0.0, 0.0, felt, 0.0, 0.0, 0.0]
    rubs = [0.0, 0.0, math.copysign(FRICTION, turns), 0.0, 0.0, 0.0]
    return estimate(speed=0.05, qd=third, tau_ext=torques, force=[0.0, 0.0, -down], friction=rubs)


@pytest.mark.parametrize("way", [1.0, -1.0])
def test_a_hand_on_a_link_that_pays_for_the_friction_leads_the_arm(way: float) -> None:
    """FD-19: for as long as it lasts; without it the arm is on its own again, and what was paid in advance does not help."""
    free = Free()
    assert free.until([elbow(way * 1.01 * PAYS, way * 0.2)] * 1000) is None
    assert free.until([elbow(way * 20.0, way * 0.2)] * 100) is None
    assert free.until([elbow(0.0, way * 0.2)] * 150) is None
    assert free.see(elbow(0.0, way * 0.2)) is not None


def test_a_hand_on_a_link_that_swings_is_told_by_its_work() -> None:
    assert Free().until([elbow(20.0 + 1.01 * PAYS), elbow(1.01 * PAYS - 20.0)] * 500) is None
    assert Free().until([elbow(20.0 + 0.5 * PAYS), elbow(0.5 * PAYS - 20.0)] * 500) is not None


@pytest.mark.parametrize(
    ("value", "use_wrench"),
    [
        (elbow(0.0), True),  # nobody
        (elbow(-5.0), True),  # nor what brakes
        (elbow(5.0, turns=0.0), True),  # nor what turns nothing
        (elbow(5.0), False),  # without the sensor it may hang at the flange
    ],
    ids=["small", "against", "still", "blind"],
)
def test_what_joints_feel_besides_is_no_hand(value: Estimate, use_wrench: bool) -> None:
    assert Free().until([value] * 151, use_wrench=use_wrench) is not None


def test_what_hangs_at_the_flange_is_no_hand_on_a_link() -> None:
    free = Free()
    assert free.until([elbow(5.0, down=6.0)] * 5000) is not None
    assert Free().until([elbow(5.0, down=3.0)] * 5000) is None
    assert Free().until([elbow(5.0, down=1.01 * CARRIED)] * 5000) is not None


def test_what_a_joint_felt_at_entry_is_no_hand() -> None:
    settings = Settings()
    operation = EndingWatch(elbow(5.0), settings, joints=JOINTS, rated=RATED, held=0.0)
    hand = UserForce(elbow(5.0), ZEROS)
    assert any(operation.step(elbow(5.0), hand, baseline=ZEROS, driven=False) for _ in range(151))


def test_motion_can_be_switched_off() -> None:
    assert Free(unexplained__motion=False).until([estimate(speed=0.3)] * 500) is None


def test_a_dropped_payload_takes_the_help_at_once_and_stops_in_20_ms() -> None:
    """FD-19: all of 2 kg is missing from one tick to the next, also while the arm is shaken by it."""
    free = Free()
    assert free.until([loaded()] * 100) is None
    shaken = [[0.0, 0.0, 2.0 * G * factor] for factor in (1.0, 3.0, -1.5, 0.5, 1.2, 2.0)]
    seen = [loaded(force=needed, needed=needed) for needed in shaken]
    assert free.see(seen[0]) is None
    assert free.operation.suspect
    ending = free.until(seen[1:])
    assert free.ticks == 100 + 1 + CERTAIN
    assert ending == Ending(Kind.STOPPED_PAYLOAD, {"mass": pytest.approx(-2.0), "force": pytest.approx(2.0 * G)})


def test_a_payload_that_comes_is_a_change_too() -> None:
    free = Free()
    free.until([loaded()] * 10)
    ending = free.until([loaded(force=[0.0, 0.0, -G])] * 10)
    assert ending is not None
    assert ending.values["mass"] == pytest.approx(1.0)


@pytest.mark.parametrize(
    "after",
    [
        [0.0, 0.0, 0.3 * LEAST],  # too small
        [2.0 * G, 0.0, 0.0],  # across
        [0.0, 0.0, 3.0 * 2.0 * G],  # more than there is
    ],
)
def test_what_no_payload_does_is_none(after: list[float]) -> None:
    free = Free()
    free.until([loaded()] * 10)
    assert free.until([loaded(force=after)] * 100) is None
    assert not free.operation.suspect


def test_a_hand_that_lets_go_ends_at_no_force_and_is_no_drop() -> None:
    free = Free()
    assert free.until([loaded(force=[0.0, 0.0, -15.0 * min(k / 50, 1.0)]) for k in range(200)]) is None
    assert free.until([loaded()] * 100) is None
    assert not free.operation.suspect


def test_a_hand_comes_slower_than_a_drop() -> None:
    free = Free()
    assert free.until([loaded(force=[0.0, 0.0, 20.0 * min(k / 20, 1.0)]) for k in range(300)]) is None


def test_the_fastest_grab_along_the_weight_is_no_drop() -> None:
    """FD-19: what a payload misses comes within two ticks; three quarters of it, grabbed within 10 ms, come in five."""
    ramp = [0.13, 0.28, 0.44, 0.6, 0.72]
    free = Free()
    assert free.until([loaded(mass=4.0, needed=[0.0, 0.0, 40.0])] * 60) is None
    shares = [*ramp, *[0.74] * 40]
    assert free.until(loaded(force=[0.0, 0.0, 40.0 * s], needed=[0.0, 0.0, 40.0], mass=4.0) for s in shares) is None


def test_a_knock_gives_the_help_back() -> None:
    free = Free()
    free.until([loaded()] * 10)
    free.until([loaded(force=[0.0, 0.0, 15.0])] * CERTAIN)
    assert free.operation.suspect
    assert free.see(loaded()) is None
    assert not free.operation.suspect


def test_without_sensor_or_load_or_switch_no_drop_is_looked_for() -> None:
    drop = [loaded(force=[0.0, 0.0, 15.0])] * 50
    for free, how in ((Free(), False), (Free(unexplained__payload=False), True)):
        free.until([loaded()] * 10)
        assert free.until(drop, use_wrench=how) is None
    free = Free()
    assert free.until([loaded(mass=0.0)] * 10 + [loaded(force=[0.0, 0.0, 15.0], mass=0.0)] * 50) is None


def test_losing_the_sensor_ends_a_suspicion() -> None:
    free = Free()
    free.until([loaded()] * 10 + [loaded(force=[0.0, 0.0, 15.0])] * 2)
    assert free.operation.suspect
    free.see(loaded(), use_wrench=False)
    assert not free.operation.suspect


def test_without_a_load_nothing_is_suspected() -> None:
    free = Free()
    assert free.see(loaded(mass=0.0)) is None
    assert free.operation.suspect is False


def test_a_hand_that_is_there_at_entry_or_as_the_sensor_comes_back_is_no_step() -> None:
    hand = loaded(force=[0.0, 0.0, 0.3 * 2.0 * G])
    assert Free().until([hand] * 30) is None
    free = Free()
    assert free.until(loaded(force=[0.0, 0.0, 0.3 * 2.0 * G * min(k / 50, 1.0)]) for k in range(100)) is None
    free.see(hand, use_wrench=False)
    assert free.until([hand] * 30) is None


def test_what_drops_is_reckoned_along_what_the_load_needs_in_the_flanges_axes() -> None:
    """FD-19: sensor's offset, turned flange, a hand that pulls across: 90 % of 2 kg, of which a fifth was a hand's before."""
    offset, needs, hand = np.array([1.0, -2.0, 0.5]), np.array([6.0, -8.0, 15.0]), np.array([3.0, 4.5, 5.53])
    R_BF = np.array([[0.0, -1.0, 0.0], [0.6, 0.0, -0.8], [0.8, 0.0, 0.6]])
    np.testing.assert_allclose(hand @ needs / (needs @ needs), 0.2, atol=0.001)

    def felt(missing: np.ndarray) -> Estimate:
        """As `missing` comes to the sensor's offset, axes of F."""
        value = loaded(mass=2.0)
        value.R_BF, value.F_user[:3], value.w_sensor[:3] = R_BF, R_BF @ (missing + offset), needs - missing - offset
        return value

    baseline = (*(R_BF @ offset), 0.7, 0.8, 0.9)
    in_flange = (*offset.tolist(), 0.0, 0.0, 0.0)
    operation = EndingWatch(felt(hand), Settings(), joints=JOINTS, rated=RATED, held=0.0)
    watched = UserForce(felt(hand), baseline)
    endings = [operation.step(felt(hand), watched, baseline=in_flange, driven=False) for _ in range(20)]
    missing = 0.9 * needs + np.array([0.4, 0.3, -0.2])
    endings += [operation.step(felt(missing), watched, baseline=in_flange, driven=False) for _ in range(1 + CERTAIN)]
    share = missing @ needs / (needs @ needs)
    values = {"mass": pytest.approx(-2.0 * share), "force": pytest.approx(2.0 * GRAVITY * share)}
    assert endings == [*[None] * (19 + 1 + CERTAIN), Ending(Kind.STOPPED_PAYLOAD, values)]


def stepping(*shares: float, weight: float = 8.0, swings: bool = False) -> tuple[int | None, bool]:
    """In which tick, of the first share that is missing of a load in 20 ticks at rest or of swinging, it is a drop; and suspected
    in the end."""
    free, mass = Free(), weight / GRAVITY
    free.until([loaded(needed=[0.0, 0.0, 2.0 * weight if swings else weight], mass=mass)] * 20)
    ending = free.until(loaded(force=[0.0, 0.0, share * weight], needed=[0.0, 0.0, weight], mass=mass) for share in shares)
    return None if ending is None else free.ticks - 20, free.operation.suspect


@pytest.mark.parametrize(
    ("shares", "tick"),
    [
        ([0.5] * 20, 1 + CERTAIN),  # half of the load, 4 N
        ([0.499] * 20, None),  # fewer than 4 N
        ([0.2, 0.2, *[0.5] * 20], 3 + CERTAIN),  # the step is 0.6 of what is missing then
        ([0.21, 0.21, *[0.5] * 20], None),
        ([-0.4, -0.4, *[0.6] * 20], 3 + CERTAIN),  # what is missing is 0.6 of the step
        ([-0.41, -0.41, *[0.6] * 20], None),
        ([0.45, *[0.9] * 20], 2 + CERTAIN),  # the first tick shows a part of it
        ([1.0, 1.0, *[0.6] * 20], 1 + CERTAIN),  # afterwards at least 0.6 of it are missing
        ([1.0, 1.0, *[0.59] * 20], None),
        ([0.5, 0.5, *[0.675] * 20], 1 + CERTAIN),  # and at most 1.35 of it
        ([0.5, 0.5, *[0.68] * 20], None),
        ([0.9, *[0.1] * 20], None),  # a knock
    ],
)
def test_a_step_of_a_load_to_the_last_newton(shares: list[float], tick: int | None) -> None:
    """FD-19."""
    assert stepping(*shares) == (tick, tick is not None)


@pytest.mark.parametrize(("share", "tick"), [(0.5, 1 + CERTAIN), (0.499, None)])
def test_where_the_arm_swings_half_of_the_load_is_a_step(share: float, tick: int | None) -> None:
    assert stepping(*[share] * 20, weight=16.0, swings=True)[0] == tick
    assert stepping(*[0.5] * 20, swings=True)[0] == 1 + CERTAIN


@pytest.mark.parametrize(("share", "dropped"), [(0.69, False), (0.71, True)])
def test_of_a_step_what_may_be_the_sensors_drift_is_no_payload(share: float, dropped: bool) -> None:
    """After minutes of guiding 3 N may be its own: a load of 10 N must miss 7 N, not 4."""
    free, mass = Free(), 10.0 / GRAVITY
    free.slack = Slack(3.0, 0.2)
    needed = [0.0, 0.0, 10.0]
    assert free.until([loaded(needed=needed, mass=mass)] * 20) is None
    assert (free.until([loaded(force=[0.0, 0.0, 10.0 * share], needed=needed, mass=mass)] * 20) is not None) is dropped


def test_less_than_half_of_a_load_must_last() -> None:
    assert stepping(*[0.499] * 20, weight=16.0)[0] == 1 + STEP_LASTS


def test_the_lightest_load_whose_drop_is_seen_weighs_four_newtons() -> None:
    assert stepping(*[1.0] * 20, weight=4.0)[0] == 1 + CERTAIN
    assert stepping(*[1.1] * 20, weight=3.99)[0] is None


def test_in_free_fall_what_little_a_load_needs_is_the_measure() -> None:
    """FD-19: nothing at all, too."""
    falls = [[0.0, 0.0, 0.0]] * 2 + [[0.0, 0.0, 0.5]] * 10
    free = Free()
    assert free.until([loaded(needed=need) for need in falls]) is None
    ending = free.until([loaded(force=[0.0, 0.0, 0.45], needed=[0.0, 0.0, 0.5])] * 20)
    assert ending == Ending(Kind.STOPPED_PAYLOAD, {"mass": pytest.approx(-1.8), "force": pytest.approx(1.8 * G)})
    free = Free()
    assert free.until([loaded(force=[0.0, 0.0, 0.22], needed=[0.0, 0.0, 0.5])] * 10) is None
    free.see(loaded(force=[0.0, 0.0, 0.45], needed=[0.0, 0.0, 0.5]))
    assert not free.operation.suspect, "half of it was missing before"


@pytest.mark.parametrize(
    ("course", "found"),
    [
        ([(9, 1.0)], False),
        ([(10, 1.0)], True),
        ([(10, 1.1)], True),  # a load of 19.6 N that needs 21.6 N hardly swings
        ([(60, 1.0), (2, 2.0)], True),
        ([(60, 1.0), (3, 2.0)], False),  # however long it was calm
        ([(60, 1.0), (20, 2.0), (9, 1.0)], False),
        ([(60, 1.0), (20, 2.0), (10, 1.0)], True),
    ],
)
def test_the_arm_is_calm_after_ten_calm_ticks_and_a_swinging_one_undoes_ten(course: list[tuple[int, float]], found: bool) -> None:
    """FD-19: so long a small step is none."""
    free = Free()
    assert free.until(loaded(needed=[0.0, 0.0, 2.0 * G * needs]) for count, needs in course for _ in range(count)) is None
    free.see(loaded(force=[0.0, 0.0, 0.3 * 2.0 * G]))
    assert free.operation.suspect is found


def test_a_drop_as_large_as_the_hand_that_lets_go_is_found_by_its_size() -> None:
    """FD-19: a hand pulled up with three quarters of the load; the help goes at once, and comes back where it was none."""
    pulled = [loaded(force=[0.0, 2.0, 15.0 * min(k / 50, 1.0)]) for k in range(100)]
    free = Free(held=2.0)
    assert free.until(pulled) is None
    assert free.see(loaded(force=TWO)) is None
    assert free.operation.suspect
    assert free.until([loaded(force=TWO)] * 20) == Ending(Kind.STOPPED_PAYLOAD, {"mass": -2.0, "force": 2.0 * G})
    assert free.ticks == 100 + 1 + LASTS
    free = Free(held=2.0)
    assert free.until([*pulled, loaded(force=TWO)]) is None
    free.see(loaded(), use_wrench=False)
    assert not free.operation.suspect
    assert Free().until([*pulled, *[loaded(force=TWO)] * 100]) is None, "a tool does not drop"


def swinging(share: float, count: int = 60) -> list[Estimate]:
    """The load needs 14 to 25 N, and `share` of that is missing."""
    needs = [2.0 * G * (1.0 + 0.3 * math.sin(0.5 * k)) for k in range(count)]
    return [loaded(force=[0.0, 0.0, share * need], needed=[0.0, 0.0, need]) for need in needs]


@pytest.mark.parametrize("share", [0.85, -0.6])
def test_a_drop_that_a_letting_go_hides_is_found_by_how_it_swings(share: float) -> None:
    """FD-19: no step is seen, for the hand's force goes in the same tick; what is missing follows the load's inertia."""
    free = Free()
    assert free.until([loaded(force=[9.0, 20.0, -15.0])] * 50) is None
    ending = free.until(swinging(share))
    assert ending is not None
    assert ending.kind is Kind.STOPPED_PAYLOAD
    assert ending.values["mass"] == pytest.approx(-2.0 * share)
    assert free.ticks <= 50 + 20


def test_a_hand_does_not_swing_with_the_load() -> None:
    needs = [2.0 * G * (1.0 + 0.3 * math.sin(0.5 * k)) for k in range(200)]
    free = Free()
    assert free.until(loaded(force=[0.0, 0.0, -min(0.4 * k, 15.0)]) for k in range(100)) is None
    assert free.until(loaded(force=[0.0, 0.0, -15.0], needed=[0.0, 0.0, need]) for need in needs) is None


@pytest.mark.parametrize("ticks", [6, 9, 20])
@pytest.mark.parametrize("size", [8.0, 12.0, 18.0])
def test_a_steady_hand_is_no_drop_while_the_load_swings_into_its_direction(size: float, ticks: int) -> None:
    """FD-19: its share of what the load needs steps, its force does not."""
    along, across = [-20.0, 0.0, 2.0], [2.0, 0.0, 20.0]
    free = Free()
    assert free.until(loaded(force=[-size * min(k / 50, 1.0), 0.0, 0.0]) for k in range(100)) is None
    needs = [along if k // ticks % 2 else across for k in range(400)]
    assert free.until(loaded(force=[-size, 0.0, 0.0], needed=need) for need in needs) is None


def test_what_changes_slowly_with_the_load_is_a_hand() -> None:
    slow = [2.0 * G * (1.0 + 0.4 * k / 300) for k in range(300)]
    free = Free()
    assert free.until(loaded(force=[0.0, 0.0, 0.002 * k * G]) for k in range(300)) is None
    assert free.until(loaded(force=[0.0, 0.0, 0.6 * need], needed=[0.0, 0.0, need]) for need in slow) is None


@pytest.mark.parametrize(("swings", "found"), [(False, True), (True, False)])
def test_where_the_arm_swings_a_small_step_is_none(swings: bool, found: bool) -> None:
    """A residual swings with the arm: so small a step is told from it only while the arm is calm."""
    free = Free()
    free.until(swinging(0.0) if swings else [loaded()] * 60)
    ending = free.until([loaded(force=[0.0, 0.0, 0.3 * 2.0 * G])] * 20)
    assert (ending is not None) is found


@given(st.floats(0.8, 5.0), st.floats(0.0, 1.0), st.lists(st.floats(-20.0, 60.0), min_size=8, max_size=8))
def test_a_whole_load_that_drops_in_any_motion_is_found(mass: float, tilt: float, lifts: list[float]) -> None:
    free = Free()
    start = [mass * G * math.sin(tilt), 0.0, mass * G * math.cos(tilt)]
    free.until([loaded(needed=start, mass=mass)] * 10)
    motion = [[start[0], 0.0, start[2] + mass * lift] for lift in lifts]
    ending = free.until([loaded(force=needed, needed=needed, mass=mass) for needed in [start, *motion]])
    assert ending is not None
    assert ending.values["mass"] == pytest.approx(-mass)


@pytest.mark.parametrize(
    ("now", "text"),
    [
        ((0.0,) * 6, ""),
        ((0.0, 0.0, 0.008, 0.0, 0.0, 0.0), ""),
        ((0.1, -0.2, 0.009, 0.0, 0.0, 0.0), "shoulder +11.5°, base -5.7°, elbow -0.5°"),
        ((0.0, 0.0, 0.0, math.radians(0.5), 0.0, math.radians(0.499)), "wrist_1 -0.5°"),
        ((0.1, 0.2, 0.3, 0.4, 0.5, 0.6), "wrist_3 -34.4°, wrist_2 -28.6°, wrist_1 -22.9°, elbow -17.2°"),
    ],
)
def test_the_way_back_names_the_joints_that_are_off(now: tuple[float, ...], text: str) -> None:
    """FD-22."""
    assert way_back((0.0,) * 6, now, JOINTS) == text


class Robot:
    """A supervisor in free-drive, entered at q = 0 with 2 kg."""

    def __init__(self) -> None:
        self.supervisor = Supervisor(Settings(), 6, joints=JOINTS, rated=RATED)
        self.events: list[Event] = []
        self.tick = -1
        hold = Inputs(held=frozenset({Button.FREE_DRIVE}))
        self.run(60, loaded())
        self.run(501, loaded(), hold)
        assert self.run(502, loaded(), Inputs(released=frozenset({Button.FREE_DRIVE}))).mode is Mode.FREE_DRIVE

    def run(self, count: int, value: Estimate, inputs: Inputs = NOTHING) -> Decision:
        for _ in range(count - 1):
            self.step(value, inputs)
        return self.step(value, inputs)

    def step(self, value: Estimate, inputs: Inputs = NOTHING) -> Decision:
        self.tick += 1
        value.tick = self.tick
        decision = self.supervisor.step(value, inputs)
        self.events += whole(decision.events, self.tick)
        return decision


def test_a_drop_in_the_robot_removes_the_gain_in_its_tick_and_stops() -> None:
    robot = Robot()
    assert robot.step(loaded()).gain == 1.0
    dropped = loaded(force=TWO)
    assert robot.step(dropped).gain == 0.0
    decision = robot.run(CERTAIN, dropped)
    assert decision.mode is Mode.STOP
    assert robot.events[-1].kind is Kind.STOPPED_PAYLOAD


def test_an_involuntary_leaving_tells_the_way_back_and_one_that_was_asked_for_does_not() -> None:
    robot = Robot()
    away = estimate(q=[0.1, 0.0, 0.0, 0.0, 0.0, -0.2], v_tcp=2.0, load_mass=2.0, needed=TWO)
    robot.step(away)
    assert [event.kind for event in robot.events[-2:]] == [Kind.LEFT_LIMIT, Kind.WAY_BACK]
    assert robot.events[-1].values["joints"] == "wrist_3 +11.5°, base -5.7°"
    robot = Robot()
    near = estimate(q=[0.1, 0.0, 0.0, 0.0, 0.0, -0.2], load_mass=2.0, needed=TWO)
    robot.run(20, near, Inputs(held=frozenset({Button.FREE_DRIVE})))
    robot.run(2, near, Inputs(released=frozenset({Button.FREE_DRIVE})))
    assert robot.events[-1].kind is Kind.LEFT_PRESS


def test_equal_histories_are_equal() -> None:
    one, two = Free(), Free()
    assert state_of(one.operation) == state_of(two.operation)
    one.see(loaded(force=[0.0, 0.0, 3.0]))
    assert state_of(one.operation) != state_of(two.operation)


FULL, LOW, HIGH = 2.0 * G, 14.0**2, 25.0**2
"""Weight of the load [N]; squares of what it needs, in turns [N²]."""


def followed(*rows: tuple[int, float, float], weight: float = FULL, low: float = LOW) -> list[bool]:
    """Of so many ticks each: the share that is missing, and what is missing across it [N]."""
    operation, course = Free().operation, [row[1:] for row in rows for _ in range(row[0])]
    squares = itertools.cycle((low, HIGH))
    return [operation._follows(share, across, square, weight) for (share, across), square in zip(course, squares, strict=False)]


def test_what_is_missing_follows_the_load_for_eight_ticks() -> None:
    """FD-19."""
    assert followed((8, 0.8, 0.0)) == [False] * 7 + [True]
    assert not any(followed((20, 0.8, 0.0), low=HIGH / 1.9)), "the load hardly swings"
    assert not any(followed((20, 0.8, 0.0), low=1.001 * HIGH / (SWINGS * SWINGS)))
    assert followed((8, 0.8, 0.0), low=HIGH / (SWINGS * SWINGS))[-1]
    assert followed((8, -0.5, 0.0))[-1], "half of the load is enough"
    assert followed((8, -0.5, 0.0), weight=2.0 * LEAST)[-1], "if that is 4 N"


def test_one_tick_that_is_like_no_load_begins_it_anew() -> None:
    """FD-19: across, more than all of it, less than half, fewer than 4 N; a share that strays by more than a tenth."""
    for between in ((1, 0.8, 30.0), (1, 1.2, 0.0), (1, 0.4, 0.0)):
        assert followed((6, 0.8, 0.0), between, (8, 0.8, 0.0)) == [False] * 14 + [True]
    assert not any(followed((20, 0.45, 0.0)))
    assert not any(followed((20, 0.6, 0.0), weight=6.0))
    strays = [(1, 0.8 + 0.09 * (k % 2), 0.0) for k in range(20)]
    assert not any(followed(*strays))
    assert any(followed(*[(1, 0.8 + 0.07 * (k % 2), 0.0) for k in range(20)]))
    assert followed((5, 0.8, 0.0), (8, 0.95, 0.0)) == [False] * 12 + [True]
    assert followed((4, 0.5625, 0.0), (4, 0.625, 0.0))[-1], "a tenth is not more than a tenth"


@pytest.mark.parametrize(
    ("share", "across", "like"),
    [
        (0.6, 6.1, True),
        (0.6, 6.3, False),
        (1.0, 9.0, True),
        (1.0, 9.01, False),
        (1.15, 0.0, True),
        (-1.15, 0.0, True),
        (1.16, 0.0, False),
    ],
)
def test_a_share_of_the_load_lies_along_it_and_is_hardly_more_than_all(share: float, across: float, like: bool) -> None:
    """FD-19: of 20 N, 0.35 of what is missing may lie across it, and 2 N of noise."""
    assert EndingWatch._like(share, across, 20.0**2) is like


def test_the_hands_torque_is_its_change_in_every_axis() -> None:
    """FD-12b."""
    baseline = (9.0, 9.0, 9.0, 0.1, 0.2, 0.3)
    assert _torque(estimate(torque=[0.3, 0.6, -0.1]), baseline) == pytest.approx((0.2, 0.4, -0.4))
    # The baseline turns with the flange: here a quarter round z.
    turned = estimate(torque=[0.3, 0.6, -0.1])
    turned.R_BF[:] = [[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]
    assert _torque(turned, baseline) == pytest.approx((0.5, 0.5, -0.4))


@pytest.mark.parametrize("axis", range(3))
@pytest.mark.parametrize("size", [-3.9, 0.0, 3.9])
def test_a_drop_is_told_whatever_the_sensor_has_drifted_by(size: float, axis: int) -> None:
    """FD-19: what was taken off is missing of no load."""
    free = Free(held=2.0)
    drifted = tuple([size if k == axis else 0.0 for k in range(6)])
    force = np.array(drifted[:3])
    for _ in range(20):
        assert free.see(loaded(force.tolist()), drifted=drifted) is None
    endings = [free.see(loaded((force + TWO).tolist()), drifted=drifted) for _ in range(CERTAIN + 1)]
    assert endings[:-1] == [None] * CERTAIN
    assert endings[-1] is not None
    assert endings[-1].values == {"mass": pytest.approx(-2.0), "force": pytest.approx(TWO[2])}
