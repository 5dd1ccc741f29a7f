"""What ends free-drive while it lasts: limits, motion that nobody causes, payloads that drop or change, the way back."""

import math
from collections.abc import Iterable

import pytest

from pendant.all_settings import Settings, apply
from pendant.decision import Decision
from pendant.events.event import Event, Kind
from pendant.guided.bias_follower import SURE
from pendant.guided.endings import Ending, EndingWatch, _torque, way_back
from pendant.guided.unintended_motion import LEFT
from pendant.guided.user_force import SWING, UserForce
from pendant.inputs import NOTHING, Button, Inputs
from pendant.sensor.hand_model import HALF, KNOWN, LIGHT, SUSPECTED, TOUCH, TOUCHES
from pendant.supervisor import Supervisor
from pendant.tick.estimate import Estimate
from pendant.tick.modes import TICK, Mode
from pendant.tick.pose import Vector, Wrench
from pendant.tick.state import state_of
from tests.pendant.estimates import MOVES, SENSOR, estimate
from tests.pendant.telling import whole

JOINTS = ("base", "shoulder", "elbow", "wrist_1", "wrist_2", "wrist_3")
RATED = (150.0, 150.0, 150.0, 28.0, 28.0, 28.0)
ZEROS = (0.0,) * 6
G = 9.81
TWO = [0.0, 0.0, 2.0 * G]  # what 2 kg need at rest
FRICTION = 8.0  # of the elbow [N·m]
PAYS = HALF * LEFT * FRICTION  # torque that pays for it [N·m]


class Free:
    """A free-drive that is watched."""

    def __init__(self, baseline: tuple[float, ...] = ZEROS, held: float = 0.0, **changes: float | bool) -> None:
        settings = apply(Settings(), {name.replace("__", "."): value for name, value in changes.items()})
        self.hand = UserForce(estimate(), baseline, SENSOR.offset_force)
        self.baseline = baseline
        self.operation = EndingWatch(estimate(), settings, joints=JOINTS, rated=RATED, held=held)
        self.ticks, self.slack = 0, SURE

    def see(self, value: Estimate, use_wrench: bool = True, driven: bool = False, drifted: Wrench = ZEROS) -> Ending | None:
        """`slack` is set where a test wants some."""
        self.ticks += 1
        self.hand.step(value, use_wrench, MOVES)
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


@pytest.mark.parametrize("pushed", [False, True])
def test_a_hands_force_lowers_limits_where_it_is_asked_for(pushed: bool) -> None:
    """FD-12b: motion is resisted from a lower speed on."""
    free = Free(soft__on=True, soft__pushed=pushed)
    before = estimate()
    assert free.see(before) is None
    resisted = free.operation.damping
    for _ in range(50):
        free.see(estimate(force=[60.0, 0.0, 0.0]))
    assert resisted is not None
    assert free.operation.damping is not None
    assert (free.operation.damping[0] < resisted[0]) is pushed


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
    return estimate(speed=0.05, qd=third, tau_hand=torques, force=[0.0, 0.0, -down], friction=rubs)


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
    ],
    ids=["small", "against", "still"],
)
def test_what_joints_feel_besides_is_no_hand(value: Estimate, use_wrench: bool) -> None:
    assert Free().until([value] * 151, use_wrench=use_wrench) is not None


@pytest.mark.parametrize(("down", "ends"), [(0.99 * LIGHT, False), (1.01 * LIGHT, True)])
def test_what_hangs_at_the_flange_does_no_hands_work(down: float, ends: bool) -> None:
    """It sinks at 0.05 m/s, and after some seconds its weight counts as a payload's."""
    free, value = Free(), elbow(0.0, down=down)
    value.v_F[:3] = [0.0, 0.0, -0.05]
    assert (free.until([value] * 5000) is not None) is ends


def test_under_what_hangs_there_a_hand_on_a_link_is_told_by_its_work_too() -> None:
    assert Free().until([elbow(5.0, down=20.0)] * 5000) is None


def test_motion_can_be_switched_off() -> None:
    assert Free(unexplained__motion=False).until([estimate(speed=0.3)] * 500) is None


def lost(odds: float, share: float = 1.0) -> Estimate:
    """A payload of which so much may be gone."""
    value = loaded()
    value.whose = value.whose._replace(lost_odds=odds, lost_share=share)
    return value


def test_a_payload_that_is_known_to_be_gone_stops() -> None:
    """FD-19."""
    free = Free(held=2.0)
    assert free.until([lost(KNOWN - 1e-9)] * 100) is None
    assert free.see(lost(KNOWN, 0.9)) == Ending(
        Kind.STOPPED_PAYLOAD, {"mass": pytest.approx(-1.8), "force": pytest.approx(1.8 * G)}
    )


def test_a_payload_that_comes_is_a_change_too() -> None:
    """FD-19."""
    ending = Free(held=2.0).see(lost(KNOWN, -0.5))
    assert ending == Ending(Kind.STOPPED_PAYLOAD, {"mass": pytest.approx(1.0), "force": pytest.approx(G)})


def test_while_a_payload_may_be_gone_nothing_helps() -> None:
    """FD-19: and once it may not, the help is back."""
    free = Free(held=2.0)
    for odds, suspected in ((0.0, False), (SUSPECTED - 1e-9, False), (SUSPECTED, True), (KNOWN - 1.0, True), (-math.inf, False)):
        assert free.see(lost(odds)) is None
        assert free.operation.suspect is suspected
    free.see(lost(SUSPECTED))
    free.see(lost(SUSPECTED), use_wrench=False)
    assert free.operation.suspect is False, "nobody knows without the sensor"


@pytest.mark.parametrize(("payload", "sensor"), [(True, True), (False, True), (True, False)])
def test_each_switch_stands_for_its_own_odds(payload: bool, sensor: bool) -> None:
    """FD-19."""
    free = Free(held=2.0, unexplained__payload=payload, unexplained__sensor=sensor)
    assert free.see(lost(SUSPECTED)) is None
    assert free.operation.suspect is payload
    stepped = loaded()
    stepped.whose = stepped.whose._replace(step_odds=SUSPECTED)
    assert free.see(stepped) is None
    assert free.operation.suspect is sensor
    free.see(stepped, use_wrench=False)
    assert free.operation.suspect is False


def test_without_sensor_or_switch_no_drop_is_looked_for() -> None:
    assert Free(held=2.0).until([lost(2.0 * KNOWN)] * 50, use_wrench=False) is None
    free = Free(held=2.0, unexplained__payload=False)
    assert free.until([lost(2.0 * KNOWN)] * 50) is None
    assert free.operation.suspect is False


def test_one_touch_of_2000_may_be_taken_for_a_drop() -> None:
    assert math.exp(-KNOWN) * TOUCH == pytest.approx(1.0 / TOUCHES)
    assert TOUCH * TICK == 0.5


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
    assert robot.step(lost(SUSPECTED)).gain == 0.0
    assert robot.step(loaded()).gain == 1.0
    decision = robot.step(lost(KNOWN))
    assert decision.mode is Mode.STOP
    assert robot.events[-1].kind is Kind.STOPPED_PAYLOAD
    assert decision.pull is not None
    assert decision.pull.lost_odds == KNOWN, "what ended it is told with its end"
    assert robot.step(loaded()).pull is None


def test_an_involuntary_leaving_tells_the_way_back_and_one_that_was_asked_for_does_not() -> None:
    robot = Robot()
    away = estimate(q=[0.1, 0.0, 0.0, 0.0, 0.0, -0.2], v_tcp=1.53, load_mass=2.0, needed=TWO)
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


def test_the_hands_torque_is_its_change_in_every_axis() -> None:
    """FD-12b."""
    baseline = (9.0, 9.0, 9.0, 0.1, 0.2, 0.3)
    assert _torque(estimate(torque=[0.3, 0.6, -0.1]), baseline) == pytest.approx((0.2, 0.4, -0.4))
    # The baseline turns with the flange: here a quarter round z.
    turned = estimate(torque=[0.3, 0.6, -0.1]).copy()
    turned.R_BF[:] = [[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]
    assert _torque(turned, baseline) == pytest.approx((0.5, 0.5, -0.4))


def fallen() -> Estimate:
    """The joints tell that the payload fell."""
    value = loaded()
    value.whose = value.whose._replace(payload_fell=True)
    return value


def test_without_the_flange_sensor_the_joints_tell_that_the_payload_fell() -> None:
    """FD-19: all of it."""
    free = Free(held=2.0)
    assert free.see(loaded(), use_wrench=False) is None
    ending = free.see(fallen(), use_wrench=False)
    assert ending == Ending(Kind.STOPPED_PAYLOAD, {"mass": -2.0, "force": pytest.approx(2.0 * G)})


def test_where_the_flange_sensor_is_used_the_joints_are_not_asked() -> None:
    assert Free(held=2.0).see(fallen()) is None


def test_the_switch_stands_for_what_the_joints_tell_as_well() -> None:
    assert Free(held=2.0, unexplained__payload=False).see(fallen(), use_wrench=False) is None
