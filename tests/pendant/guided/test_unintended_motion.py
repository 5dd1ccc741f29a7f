"""How far an arm goes on its own (FD-19); test_endings.py has for how long any arm does."""

from collections.abc import Iterable

import numpy as np
import pytest

from pendant.all_settings import Settings
from pendant.events.event import Values
from pendant.guided.bias_follower import Slack
from pendant.guided.unintended_motion import LEFT, UnintendedMotion
from pendant.guided.user_force import UserForce
from pendant.limits.parameters import reference
from pendant.sensor.hand_model import HALF, LASTS, LIGHT
from pendant.tick.estimate import Estimate, JointsFeel
from pendant.tick.modes import TICK
from pendant.tick.state import state_of
from tests.pendant.estimates import MOVES, SENSOR, estimate

ZEROS = (0.0,) * 6
FRICTION = 8.0  # of the elbow while it turns [N·m]
PAYS = HALF * LEFT * FRICTION  # torque there that pays for its friction [N·m]
HERE = [0.0, 0.1, 0.2]
WAYS = [(1.0, 0.0, 0.0), (0.0, -1.0, 0.0), (0.6, 0.0, 0.8)]
MOVING, AWAY = Settings().unexplained.speed, Settings().unexplained.distance
STEP = 0.0001  # in a tick that creeps [m]


def at(way: float, speed: float, to: tuple[float, float, float] = WAYS[0], turns: float = 0.0, felt: float = 0.0) -> Estimate:
    """The flange so far from where it entered [m]; the elbow turns at 0.2 rad/s where `turns` is 1, and feels this [N·m]."""
    third = [0.0, 0.0, 0.2 * turns, 0.0, 0.0, 0.0]
    place = [a + way * b for a, b in zip(HERE, to, strict=True)]
    rubs = [0.0, 0.0, FRICTION * turns, 0.0, 0.0, 0.0]
    return estimate(position=place, speed=speed, qd=third, tau_hand=[0.0, 0.0, felt, 0.0, 0.0, 0.0], friction=rubs)


class Bench:
    """An arm that was at rest, moved by hand tick by tick."""

    def __init__(self, sensor: bool = True) -> None:
        start = at(0.0, 0.0)
        self.alone, self.hand = (
            UnintendedMotion(Settings().unexplained, reference(start, None)),
            UserForce(start, ZEROS, SENSOR.offset_force),
        )
        self.sensor, self.ticks = sensor, 0

    def see(self, value: Estimate, driven: bool = False) -> Values | None:
        self.ticks += 1
        self.hand.step(value, self.sensor, MOVES)
        return self.alone.step(value, self.hand, use_wrench=self.sensor, driven=driven)

    def until(self, values: Iterable[Estimate]) -> Values | None:
        return next((told for value in values if (told := self.see(value)) is not None), None)

    def held(self, value: Estimate) -> None:
        """A hand at the flange for one tick, which the force, or what the joints feel, tells as it is."""
        self.hand.user = (0.0, 0.0, 40.0) if self.sensor else (0.0, 0.0, 0.0)
        value.whose = value.whose._replace(joints_feel=JointsFeel.NOTHING if self.sensor else JointsFeel.HAND)
        assert self.alone.step(value, self.hand, use_wrench=self.sensor, driven=False) is None
        self.hand.user = (0.0, 0.0, 0.0)

    def let_go(self, value: Estimate) -> None:
        """A hand, and then so long a wall that who was felt is not believed to be there any more."""
        self.held(value)
        value.whose = value.whose._replace(joints_feel=JointsFeel.NOTHING)
        for _ in range(LASTS):
            assert self.see(value, driven=True) is None
        self.ticks = 0


def creep(ticks: int, speed: float = 0.019, begins: float = 0.0, turns: float = 0.0, felt: float = 0.0) -> list[Estimate]:
    """It goes on slowly, `STEP` in each tick."""
    return [at(begins + STEP * tick, speed, turns=turns, felt=felt) for tick in range(1, ticks + 1)]


LEAST_CREPT = round(AWAY / STEP)  # ticks that are just allowed


@pytest.mark.parametrize("way", WAYS)
@pytest.mark.parametrize(("share", "stopped"), [(0.99, False), (1.01, True), (30.0, True)])
@pytest.mark.parametrize("sensor", [True, False])
def test_an_arm_that_nobody_touches_goes_so_far(
    sensor: bool, share: float, stopped: bool, way: tuple[float, float, float]
) -> None:
    bench = Bench(sensor)
    assert bench.see(at(0.0, 0.1)) is None
    told = bench.see(at(share * AWAY, 0.1, way))
    assert told == ({"distance": pytest.approx(1000.0 * share * AWAY), "time": 2 * TICK, "limit": MOVING} if stopped else None)


@pytest.mark.parametrize("sensor", [True, False])
def test_at_the_limit_it_may_be(sensor: bool) -> None:
    assert Bench(sensor).until([at(0.0, 0.1), at(AWAY, 0.1)]) is None


@pytest.mark.parametrize("speed", [0.0, 0.005, 0.019])
def test_however_slowly_with_the_sensor(speed: float) -> None:
    bench = Bench()
    told = bench.until(creep(1000, speed))
    assert bench.ticks in (LEAST_CREPT, LEAST_CREPT + 1)
    assert told == {"distance": pytest.approx(1000.0 * AWAY, abs=0.11), "time": 0.0, "limit": MOVING}


def test_without_it_a_light_hand_is_not_felt_and_the_way_begins_with_the_motion() -> None:
    bench = Bench(sensor=False)
    assert bench.until(creep(1000)) is None
    assert bench.until([at(0.1, 0.1), at(0.1 + 0.99 * AWAY, 0.1)]) is None
    assert bench.until([at(0.2, 0.019), at(0.3, 0.1), at(0.3 + 0.99 * AWAY, 0.1)]) is None
    assert bench.see(at(0.3 + 1.01 * AWAY, 0.1)) is not None


def test_with_it_what_it_crept_before_it_moved_counts() -> None:
    bench = Bench()
    assert bench.until(creep(LEAST_CREPT - 20)) is None
    assert bench.until([at(AWAY - 0.001, 0.1), at(AWAY + 0.001, 0.1)]) is not None
    assert bench.ticks == LEAST_CREPT - 18


@pytest.mark.parametrize("sensor", [True, False])
@pytest.mark.parametrize("driven", [True, False])
def test_an_arm_that_a_hand_or_a_wall_has_let_go_while_it_moved_has_its_time_alone(driven: bool, sensor: bool) -> None:
    """A hand that guides is light now and then; the arm comes to rest within its time, or is stopped."""
    bench = Bench(sensor)
    if driven:
        assert bench.see(at(0.0, 0.1), driven) is None
    else:
        bench.let_go(at(0.0, 0.1))
    assert bench.until([at(0.0, 0.1), at(0.5, 0.1)]) is None
    bench.see(at(0.6, 0.0))
    assert bench.until([at(0.6, 0.1), at(0.6 + 0.99 * AWAY, 0.1)]) is None
    assert bench.see(at(0.6 + 1.01 * AWAY, 0.1)) is not None


def test_a_way_begins_where_the_arm_came_to_rest_after_a_hand() -> None:
    bench = Bench()
    assert bench.until(creep(LEAST_CREPT - 5)) is None
    bench.let_go(at(AWAY, 0.019))
    assert bench.until(creep(LEAST_CREPT - 5, begins=AWAY)) is None
    assert bench.until(creep(20, begins=2 * AWAY)) is not None


@pytest.mark.parametrize(("share", "pushed"), [(0.99, False), (1.01, True)])
def test_a_hand_on_a_link_that_pays_for_the_friction_may_creep(share: float, pushed: bool) -> None:
    bench = Bench()
    told = bench.until(creep(6 * LEAST_CREPT, turns=1.0, felt=share * PAYS))
    assert (told is None) is pushed


def test_the_work_counts_from_where_the_arm_rested() -> None:
    """All of it, also what was done while the arm was faster for a moment; not what was before a hand."""
    bench = Bench()
    assert bench.until(creep(50, turns=1.0, felt=2.0 * PAYS)) is None
    assert bench.until(at(0.006, 0.1, turns=1.0, felt=2.0 * PAYS) for _ in range(100)) is None
    assert bench.until(creep(100, begins=0.0095, turns=1.0)) is None, "150 of 250 ticks are paid twice"
    bench = Bench()
    assert bench.until(creep(100, turns=1.0, felt=9.0)) is None
    bench.let_go(at(0.0, 0.019))
    assert bench.until(creep(LEAST_CREPT + 5, turns=1.0, felt=0.9 * PAYS)) is not None


def test_what_hangs_at_the_flange_is_no_hand() -> None:
    bench = Bench()
    bench.hand.usual = (0.0, 0.0, -LIGHT)
    told = (bench.alone.step(value, bench.hand, use_wrench=True, driven=False) for value in creep(400, turns=1.0))
    assert any(values is not None for values in told)


def test_who_leads_a_link_does_so_as_long_as_it_is_paid_for() -> None:
    """Then it may run on alone for its time; once at rest its way is measured from there."""
    bench = Bench()
    bench.held(at(0.0, 0.1))
    assert bench.until(at(0.001 * tick, 0.1, turns=1.0, felt=1.01 * PAYS) for tick in range(5000)) is None
    bench.see(at(5.0, 0.1, turns=1.0, felt=1.01 * PAYS))
    assert bench.until([at(5.1, 0.1, turns=1.0)] * 150) is None
    told = bench.see(at(5.1, 0.1, turns=1.0))
    assert told == {"distance": pytest.approx(0.0), "time": pytest.approx(0.302), "limit": MOVING}
    bench = Bench()
    bench.let_go(at(0.0, 0.1))
    assert bench.until(at(0.001, 0.1, turns=1.0, felt=5.0) for _ in range(151)) is None
    assert bench.see(at(0.2, 0.0)) is None
    assert bench.until(creep(LEAST_CREPT - 5, begins=0.2)) is None
    assert bench.until(creep(20, begins=0.2 + AWAY)) is not None


def test_with_what_hangs_there_work_on_a_link_excuses_a_motion_and_its_own_does_not() -> None:
    """No payload is among the torques of contacts behind the flange sensor."""
    for felt, stopped in ((9.0, False), (0.0, True)):
        bench = Bench()
        bench.let_go(at(0.0, 0.1))
        bench.hand.usual = (LIGHT, 0.0, 0.0)
        value = at(0.0, 0.1, turns=1.0, felt=felt)
        told = [bench.alone.step(value, bench.hand, use_wrench=True, driven=False) for _ in range(151)]
        assert told[:150] == [None] * 150
        assert (told[150] is not None) is stopped


def test_its_state_tells_all_of_it() -> None:
    one, other = Bench(), Bench()
    for value in (at(0.0, 0.1), at(0.001, 0.015, turns=1.0, felt=1.0)):
        one.see(value)
        assert state_of(one.alone) != state_of(other.alone)
        other.see(value)
        assert state_of(one.alone) == state_of(other.alone)


def test_who_leads_a_link_is_known_and_half_of_the_time_without_is_doubtful() -> None:
    bench = Bench()
    bench.let_go(at(0.0, 0.1))
    assert (bench.alone.led, bench.alone.doubtful) == (False, False)
    bench.see(at(0.0, 0.1, turns=1.0, felt=1.01 * PAYS))
    assert (bench.alone.led, bench.alone.doubtful) == (True, False)
    for tick in range(1, 152):
        told = bench.see(at(0.0, 0.1, turns=1.0))
        assert (bench.alone.led, bench.alone.doubtful, told is None) == (False, tick > 75, tick <= 150)
    bench.see(at(0.0, 0.1, turns=1.0, felt=20.0))
    assert bench.alone.doubtful, "until it is paid for"
    bench.see(at(0.0, 0.0))
    assert (bench.alone.led, bench.alone.doubtful) == (False, False)


def test_a_hand_at_the_flange_ends_a_doubt() -> None:
    bench = Bench()
    assert bench.until(at(0.0, 0.1, turns=1.0) for _ in range(100)) is None
    assert bench.alone.doubtful
    bench.held(at(0.0, 0.1))
    assert not bench.alone.doubtful


def test_beside_a_sensor_that_is_not_used_no_work_excuses_a_motion() -> None:
    """It stepped, and what the joints feel beside it may be its error."""
    bench = Bench(sensor=False)
    bench.held(unseen(JointsFeel.HAND))
    assert bench.until([at(0.0, 0.1, turns=1.0, felt=9.0)] * 150) is None
    assert bench.see(at(0.0, 0.1, turns=1.0, felt=9.0)) is not None


def unseen(feels: JointsFeel, way: float = 0.0, speed: float = 0.1, felt: float = 9.0) -> Estimate:
    """What an arm without a flange sensor tells; the torques of a hand would pay for its motion."""
    value = at(way, speed, turns=1.0, felt=felt if feels is JointsFeel.HAND else 0.0)
    value.whose = value.whose._replace(joints_feel=feels)
    return value


def test_without_the_sensor_a_hand_is_what_neither_errors_nor_a_fall_explain() -> None:
    """However far, and for however long; it leads the arm where its torques pay for the motion."""
    bench = Bench(sensor=False)
    assert bench.until(unseen(JointsFeel.HAND, 0.001 * tick) for tick in range(2000)) is None
    assert (bench.alone.led, bench.alone.doubtful) == (True, False)
    bench.see(unseen(JointsFeel.HAND, 2.0, felt=-9.0))
    assert not bench.alone.led
    bench.hand.user = (0.0, 0.0, 40.0)
    told = [bench.alone.step(unseen(JointsFeel.NOTHING, 2.0), bench.hand, use_wrench=False, driven=False) for _ in range(151)]
    assert told[:150] == [None] * 150
    assert told[150] is not None, "a force that the joints may err by is none"


@pytest.mark.parametrize("feels", [JointsFeel.NOTHING, JointsFeel.FALL])
def test_without_the_sensor_no_work_excuses_a_motion_that_errors_or_a_fall_explain(feels: JointsFeel) -> None:
    """Half of the time is doubtful, and a fall at once, at rest, too; whether anybody leads an arm that stands is not known."""
    bench, falls = Bench(sensor=False), feels is JointsFeel.FALL
    bench.held(unseen(JointsFeel.HAND))
    for tick in range(1, 152):
        told = bench.see(unseen(feels))
        assert (bench.alone.led, bench.alone.doubtful, told is None) == (False, falls or tick > 75, tick <= 150)
    bench = Bench(sensor=False)
    bench.held(unseen(JointsFeel.HAND))
    assert bench.alone.led
    bench.see(unseen(feels, speed=0.0))
    assert (bench.alone.led, bench.alone.doubtful) == (False, falls)
    bench.held(unseen(JointsFeel.HAND))
    assert not bench.alone.doubtful


@pytest.mark.parametrize(("feels", "far"), [(JointsFeel.NOTHING, False), (JointsFeel.FALL, True)])
@pytest.mark.parametrize("share", [0.99, 1.01])
def test_a_payload_that_may_have_fallen_off_a_guided_arm_has_a_way_and_not_a_time(
    share: float, feels: JointsFeel, far: bool
) -> None:
    bench = Bench(sensor=False)
    bench.held(unseen(JointsFeel.HAND))
    assert bench.see(unseen(feels)) is None
    told = bench.see(unseen(feels, share * AWAY))
    assert told == (
        {"distance": pytest.approx(1000.0 * share * AWAY), "time": 2 * TICK, "limit": MOVING} if far and share > 1.0 else None
    )


@pytest.mark.parametrize("led", [True, False])
@pytest.mark.parametrize("speed", [0.0, 0.019, 0.1])
def test_the_way_of_a_fall_begins_with_it_and_counts_however_slow_it_is(speed: float, led: bool) -> None:
    bench = Bench(sensor=False)
    if led:
        bench.held(unseen(JointsFeel.HAND, 0.0, 0.1))
    assert bench.until([unseen(JointsFeel.NOTHING, 0.1, speed), unseen(JointsFeel.FALL, 0.1 + 0.99 * AWAY, speed)]) is None
    told = bench.see(unseen(JointsFeel.FALL, 0.1 + 1.01 * AWAY, speed))
    assert told is not None
    assert told["distance"] == pytest.approx(1010.0 * AWAY)


HELD = 9
"""Ticks for which a hand that half of the ticks tell is known against noise in a tenth: log(2000 * 250) / log(5), rounded up."""


@pytest.mark.parametrize("feels", [JointsFeel.HAND, JointsFeel.NOTHING])
@pytest.mark.parametrize(("ticks", "again"), [(HELD - 1, False), (HELD, True)])
def test_the_way_of_a_fall_begins_again_after_what_noise_cannot_make_of_it(ticks: int, again: bool, feels: JointsFeel) -> None:
    bench = Bench(sensor=False)
    assert bench.until([unseen(JointsFeel.FALL, 0.0), unseen(JointsFeel.FALL, 0.99 * AWAY)]) is None
    assert bench.until([unseen(feels, 0.99 * AWAY)] * ticks) is None
    assert (bench.see(unseen(JointsFeel.FALL, 1.98 * AWAY)) is None) is again
    assert bench.see(unseen(JointsFeel.FALL, 2.0 * AWAY)) is not None


@pytest.mark.parametrize(("share", "led"), [(0.1, False), (0.5, True)])
def test_an_arm_that_rises_alone_is_not_led_by_noise(share: float, led: bool) -> None:
    """A fall of a payload that was told wrong is felt in most ticks, and a hand that pushes upward in half of them."""
    bench, rng = Bench(sensor=False), np.random.default_rng(3)
    felt = [JointsFeel.HAND if rng.uniform() < share else JointsFeel.FALL for _ in range(3000)]
    told = bench.until(unseen(feels, 0.0001 * tick) for tick, feels in enumerate(felt))
    assert (told is None) is led


def test_half_of_the_way_from_rest_is_doubtful_without_the_sensor_too() -> None:
    bench = Bench(sensor=False)
    bench.see(at(0.0, 0.1))
    bench.see(at(0.49 * AWAY, 0.1))
    assert not bench.alone.doubtful
    bench.see(at(0.51 * AWAY, 0.1))
    assert bench.alone.doubtful
    bench.held(at(0.51 * AWAY, 0.1))
    assert not bench.alone.doubtful


@pytest.mark.parametrize(("force", "hand"), [(2.9, False), (3.1, True)])
def test_a_force_that_may_be_drift_is_no_hand_unless_it_works(force: float, hand: bool) -> None:
    """Two newtons may be the sensor's, and one is the least of a hand."""
    bench = Bench()
    value = at(0.0, 0.1, turns=1.0)
    bench.hand.user = (0.0, force, 0.0)
    told = [bench.alone.step(value, bench.hand, use_wrench=True, driven=False, slack=Slack(2.0, 0.2)) for _ in range(151)]
    assert (told[-1] is None) is hand


@pytest.mark.parametrize(("slack", "told"), [(0.0, False), (2.0, True)])
def test_a_light_hand_along_gravity_works_at_the_flange(slack: float, told: bool) -> None:
    """What stays along gravity is no user's force; but it goes along with the arm, at 0.1 m/s."""
    bench = Bench()
    bench.held(at(0.0, 0.1))
    bench.hand.usual = (2.0, 0.0, 0.0)
    value = at(0.0, 0.1, turns=1.0)
    drifts = Slack(slack, 0.1 * slack)
    assert (
        any(bench.alone.step(value, bench.hand, use_wrench=True, driven=False, slack=drifts) is not None for _ in range(400))
        is told
    )


@pytest.mark.parametrize(("turn", "told"), [(0.0, True), (2.0, False), (-2.0, True)])
def test_so_does_its_torque(turn: float, told: bool) -> None:
    """1 N·m at the end of a tool, with 0.2 N·m that may be drift."""
    bench = Bench()
    bench.held(at(0.0, 0.1))
    value = at(0.0, 0.1, turns=1.0)
    value.v_F[3:] = [0.0, 0.0, turn]
    torque, slack = (0.0, 0.0, 1.0), Slack(2.0, 0.2)
    assert (
        any(
            bench.alone.step(value, bench.hand, use_wrench=True, driven=False, slack=slack, torque=torque) is not None
            for _ in range(400)
        )
        is told
    )


@pytest.mark.parametrize(("turn", "led"), [(0.199, False), (0.21, True)])
def test_of_a_torque_what_may_be_drift_pays_for_nothing(turn: float, led: bool) -> None:
    bench = Bench()
    value = at(0.0, 0.1, turns=1.0)
    value.v_F[3:] = [0.0, 0.0, 1000.0]
    bench.alone.step(value, bench.hand, use_wrench=True, driven=False, slack=Slack(2.0, 0.2), torque=(0.0, 0.0, turn))
    assert bench.alone.led is led


@pytest.mark.parametrize("pays", [0.99, 1.01])
def test_who_is_felt_leads_the_arm_where_the_motion_is_paid_for(pays: float) -> None:
    bench = Bench()
    bench.hand.user = (0.0, 0.0, 40.0)
    bench.alone.step(at(0.0, 0.1, turns=1.0, felt=pays * PAYS), bench.hand, use_wrench=True, driven=False)
    assert bench.alone.led is (pays > 1.0)
    bench.alone.step(at(0.0, 0.0, turns=1.0, felt=2.0 * PAYS), bench.hand, use_wrench=True, driven=False)
    assert not bench.alone.led, "it does not move"


@pytest.mark.parametrize("pays", [0.99, 1.01])
def test_who_leads_an_arm_that_is_held_back_before_a_joint_limit_is_known(pays: float) -> None:
    """The spring there is the motors' own: it does no external work."""
    bench = Bench()
    bench.see(at(0.0, 0.1, turns=1.0, felt=pays * PAYS), driven=True)
    assert bench.alone.led is (pays > 1.0)


def test_what_was_paid_while_a_hand_was_felt_does_not_count_later() -> None:
    bench = Bench()
    bench.hand.user = (0.0, 0.0, 40.0)
    for _ in range(1000):
        bench.alone.step(at(0.0, 0.1, turns=1.0), bench.hand, use_wrench=True, driven=False)
    bench.let_go(at(0.0, 0.1, turns=1.0))
    assert bench.until([at(0.0, 0.1, turns=1.0)] * 150) is None, "nor what was owed"
    assert bench.see(at(0.0, 0.1, turns=1.0)) is not None


@pytest.mark.parametrize(("felt", "led"), [(0.99 * PAYS, False), (1.01 * PAYS, True)])
def test_who_leads_it_slowly_is_known_from_where_it_rested(felt: float, led: bool) -> None:
    bench = Bench()
    assert bench.until(creep(20, turns=1.0, felt=felt)) is None
    assert bench.alone.led is led
    bench.alone.step(creep(21, turns=1.0, felt=felt)[-1], bench.hand, use_wrench=True, driven=True)
    assert not bench.alone.led, "a wall drives it"


@pytest.mark.parametrize("carried", [0.0, LIGHT])
def test_half_of_the_way_that_nobody_pays_for_is_doubtful(carried: float) -> None:
    """The doubt stays while the arm rests there, for the way would go on; a hand that is felt ends it."""
    bench = Bench()
    bench.hand.usual = (carried, 0.0, 0.0)

    def see(value: Estimate) -> bool:
        assert bench.alone.step(value, bench.hand, use_wrench=True, driven=False) is None
        return bench.alone.doubtful

    assert not see(at(0.99 * 0.5 * AWAY, 0.01, turns=1.0))
    assert see(at(1.01 * 0.5 * AWAY, 0.01, turns=1.0))
    assert see(at(1.01 * 0.5 * AWAY, 0.0))
    bench.held(at(1.01 * 0.5 * AWAY, 0.0))
    assert not see(at(1.01 * 0.5 * AWAY, 0.0))
    assert not see(at(1.99 * 0.5 * AWAY, 0.0)), "from where it rested after the hand"


def test_a_doubt_ends_when_the_way_is_paid_for() -> None:
    bench = Bench()
    bench.see(at(0.6 * AWAY, 0.01, turns=1.0))
    assert bench.alone.doubtful
    bench.see(at(0.6 * AWAY, 0.01, turns=1.0, felt=9.0))
    assert not bench.alone.doubtful


def test_without_help_an_arm_has_time_to_come_to_rest() -> None:
    """A hand that pays now and then owes half of the time late: then the doubt lasts for as long before the arm is stopped."""
    bench = Bench()
    assert bench.until(at(0.001, 0.1, turns=1.0, felt=0.6 * PAYS) for _ in range(187)) is None
    assert not bench.alone.doubtful
    doubted = 0
    for _ in range(2000):
        told = bench.see(at(0.001, 0.1, turns=1.0))
        doubted += bench.alone.doubtful
        if told is not None:
            break
    assert doubted >= 75


def test_who_pays_late_or_no_more_has_half_of_the_way_without_help() -> None:
    """Paid up to 12 mm, and no more from there on: the arm may brake for 7.5 mm from where the work was used up."""
    bench = Bench()
    for value in creep(120, turns=1.0, felt=1.001 * PAYS):
        assert bench.see(value) is None
        assert not bench.alone.doubtful
    told = bench.until(creep(300, begins=0.012, turns=1.0))
    assert told is not None
    assert told["distance"] == pytest.approx(12.0 + 0.5 * 1000.0 * AWAY, abs=0.3)


@pytest.mark.parametrize("ticks", [75, 76])
def test_under_what_hangs_there_half_of_the_time_is_doubtful_too(ticks: int) -> None:
    bench = Bench()
    bench.held(at(0.0, 0.1))
    bench.hand.usual = (LIGHT, 0.0, 0.0)
    for _ in range(ticks):
        bench.alone.step(at(0.0, 0.1, turns=1.0), bench.hand, use_wrench=True, driven=False)
    assert bench.alone.doubtful is (ticks > 75)


def test_who_was_felt_a_moment_ago_counts_no_more_than_who_never_was() -> None:
    bench = Bench()
    bench.held(at(0.0, 0.05))
    assert bench.until(creep(149, 0.05)) is None
    assert bench.until(creep(5, 0.05, begins=0.015)) is not None


def test_beside_a_sensor_that_is_not_used_nobody_is_believed_to_be_there() -> None:
    bench = Bench()
    bench.held(at(0.0, 0.05))
    bench.sensor = False
    assert bench.until(creep(149, 0.05)) is None
    assert bench.until(creep(5, 0.05, begins=0.015)) is not None


@pytest.mark.parametrize("taken", [3.0, -3.0, 0.0])
@pytest.mark.parametrize("way", [1.0, -1.0])
def test_what_was_taken_for_a_payload_and_was_a_hand_leads_no_arm_once_it_has_gone(way: float, taken: float) -> None:
    """Nobody is there: the sensor has drifted by 2 N, and its force along gravity lacks what was taken for a payload's."""
    start = at(0.0, 0.0)
    alone = UnintendedMotion(Settings().unexplained, reference(start, None))
    hand, slack = UserForce(start, ZEROS, SENSOR.offset_force), Slack(3.0, 0.5)
    for tick in range(1, 400):
        hand.usual, hand.user, hand._slow = (0.0, 0.0, way * 2.0), (0.0, 0.0, way * 2.0 - taken), taken
        led = alone.step(at(STEP * tick, 0.05), hand, use_wrench=True, driven=False, slack=slack) is None
        if not led:
            break
    assert not led
