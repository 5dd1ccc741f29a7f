"""The sensor's zero alone: what the reference follows, when zeroing is refused, what becomes the zero, when it is due."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import settings as hypothesis_settings
from hypothesis import strategies as st
from msgspec.structs import replace

from pendant.events.event import Event, Kind
from pendant.limits.parameters import ZEROS
from pendant.limits.settings import ActivationLimits
from pendant.limits.validity import WINDOW, WrenchMean
from pendant.sensor.sensor_errors import FALSE_ALARM
from pendant.sensor.sensor_spec import SensorSpec
from pendant.sensor.taring import AVERAGED, LEAST_PULL, LEAST_TWIST, TREMBLE, WINDOWS, Taring
from pendant.settings.schema import Limit
from pendant.tick.estimate import GRAVITY, Estimate
from pendant.tick.modes import TICK
from pendant.tick.pose import Wrench
from pendant.tick.state import state_of
from tests.pendant.estimates import estimate
from tests.pendant.telling import whole

SPEC = SensorSpec()
LIMITS = ActivationLimits()
NOISE = SPEC.noise_force / math.sqrt(WINDOW)
PULL = LEAST_PULL + FALSE_ALARM * NOISE
TWIST = LEAST_TWIST + FALSE_ALARM * SPEC.noise_torque / math.sqrt(WINDOW)
READY = (WINDOWS + 1) * WINDOW
"""Ticks after which an arm that stands can be zeroed, the first window's reference among them."""

ACROSS = np.array([[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])
"""R_BF of a flange whose z axis is the base's x axis: gravity is along its -y."""


class Bench:
    """The module with a sensor that has no noise; F_user is given in axes of F."""

    def __init__(self, spec: SensorSpec = SPEC, limits: ActivationLimits = LIMITS) -> None:
        self.taring, self.mean, self.limits = Taring(spec), WrenchMean(), limits
        self.tick, self.R, self.load = 0, np.eye(3), 0.0
        self.wrench: Wrench = ZEROS  # with the zero of the start
        self.events: list[Event] = []

    def value(self) -> Estimate:
        now = np.add(self.wrench, self.taring.zero)
        value = estimate(self.tick, load_mass=self.load)
        value.R_BF = self.R
        value.F_user = np.concatenate([self.R @ now[:3], self.R @ now[3:]])
        return value

    def step(self, stands: bool = True) -> list[Event]:
        self.tick += 1
        value = self.value()
        assert self.mean.step(value)
        told = whole(self.taring.step(value, self.mean, stands, self.limits), self.tick)
        self.events += told
        return told

    def run(self, ticks: int, stands: bool = True) -> "Bench":
        for _ in range(ticks):
            self.step(stands)
        return self

    def feel(self, *wrench: float) -> "Bench":
        self.wrench = (*wrench, *(0.0,) * (6 - len(wrench)))
        return self

    def wait(self, seconds: float) -> "Bench":
        """Time passes in which the arm is not looked at."""
        self.step(stands=False)
        self.tick += round(seconds / TICK)
        return self

    def why_not(self) -> str:
        return self.taring.why_not(self.value(), self.mean)

    def zero(self) -> Event:
        """As the running robot does it."""
        assert self.why_not() == ""
        gone, event = self.taring.tare(self.value())
        self.mean.shift((*(self.R @ gone[:3]), *(self.R @ gone[3:])))
        return whole([event], self.tick)[0]

    def pulled(self, *wrench: float) -> str:
        """Why not, where this is felt in the last window alone."""
        return self.feel(*wrench).run(WINDOW).why_not()


def ready(*wrench: float) -> Bench:
    return Bench().feel(*wrench).run(READY)


def test_it_needs_a_second_and_the_window_before() -> None:
    bench = Bench()
    for tick in range(WINDOWS * WINDOW - 1):
        bench.step()
        assert "must stand untouched for 1.1 s" in bench.why_not(), tick
    bench.step()
    assert bench.why_not() == ""
    bench.step(stands=False)
    assert "must stand untouched for 1.1 s" in bench.why_not()


def test_what_is_felt_becomes_the_zero_and_is_told() -> None:
    bench = ready(1.0, -2.0, 2.0, 0.03, 0.0, -0.04)
    event = bench.zero()
    assert bench.taring.zero == pytest.approx((-1.0, 2.0, -2.0, -0.03, 0.0, 0.04)), "F_user is minus what the sensor has too much"
    assert event.kind is Kind.SENSOR_ZEROED
    assert event.values == pytest.approx({"force": 3.0, "torque": 0.05, "x": -1.0, "y": 2.0, "z": -2.0})
    bench.run(1)
    assert bench.mean.mean() == pytest.approx(ZEROS), "what is in the window is shifted as well"
    assert bench.zero().values["force"] == pytest.approx(0.0), "and zeroing again is possible at once, and changes nothing"


def test_the_zero_is_the_mean_of_the_last_half_second() -> None:
    bench = ready()
    for k in range(AVERAGED):
        bench.feel(0.01 * k).run(WINDOW)
    assert bench.zero().values["force"] == pytest.approx(0.01 * (AVERAGED - 1) / 2)


def test_a_zero_is_in_axes_of_the_flange() -> None:
    bench = Bench()
    bench.R = ACROSS
    bench.feel(1.0, 0.0, 0.5).run(READY)
    bench.zero()
    bench.R = np.eye(3)
    bench.run(READY)
    assert bench.why_not() == ""
    assert bench.zero().values["force"] == pytest.approx(0.0, abs=1e-12)


@pytest.mark.parametrize("off", [-0.5, -0.1, -0.01, -0.001, 0.001, 0.01, 0.1, 0.5, 3.5])
@pytest.mark.parametrize("way", [(1.0, 0.0, 0.0), (0.0, 0.0, -1.0)])
def test_a_force_beyond_what_noise_explains_pulls(off: float, way: tuple[float, ...]) -> None:
    bench = ready(1.0, 1.0, 1.0)
    size = PULL + off + SPEC.drift_force * WINDOW * TICK  # the reference has gone a little along
    why_not = bench.pulled(*(1.0 + size * each for each in way))
    if off > 0.0:
        assert why_not == f"{PULL + off:.1f} N more than on the untouched arm: let go of it"
    else:
        assert "trembles" in why_not, "for it has just come"
        assert bench.run(WINDOWS * WINDOW).why_not() == ""


@pytest.mark.parametrize("off", [-0.1, -0.001, 0.001, 0.1])
def test_a_torque_beyond_what_noise_explains_twists(off: float) -> None:
    bench = ready()
    why_not = bench.pulled(0.0, 0.0, 0.0, 0.0, TWIST + off + SPEC.drift_torque * WINDOW * TICK)
    assert why_not == (f"{TWIST + off:.2f} N·m more than on the untouched arm: let go of it" if off > 0 else "")


def test_what_pulls_is_noticed_in_the_tick_and_not_only_when_a_window_is_full() -> None:
    bench = ready().feel(30.0).run(3)
    assert bench.why_not() == "1.8 N more than on the untouched arm: let go of it"
    assert bench.run(2).why_not() == "3.0 N more than on the untouched arm: let go of it"


@pytest.mark.parametrize("share", [0.9, 0.99, 1.01, 1.1, 3.0])
def test_a_force_that_trembles_is_a_hands(share: float) -> None:
    """The windows' means are at +-a: their standard deviation is a sqrt(10/9), on one of three axes."""
    bench = ready()
    a = share * TREMBLE * NOISE * math.sqrt(3.0 * (WINDOWS - 1) / WINDOWS)
    for k in range(WINDOWS):
        bench.feel(a * (-1) ** k).run(WINDOW)
    size = share * TREMBLE * NOISE
    trembles = f"the force trembles by {size:.2f} N, at rest by {NOISE:.2f} N: hands off the arm"
    assert bench.why_not() == (trembles if share > 1.0 else "")


@pytest.mark.parametrize("mass", [0.0, 1.0, 5.0])
def test_a_load_makes_more_noise(mass: float) -> None:
    noise = math.hypot(SPEC.noise_force, SPEC.noise_acceleration * mass) / math.sqrt(WINDOW)
    for off in (-0.01, 0.01):
        bench = Bench()
        bench.load = mass
        bench.run(READY)
        assert ("more than" in bench.pulled(0.0, LEAST_PULL + FALSE_ALARM * noise + off + SPEC.drift_force * WINDOW * TICK)) is (
            off > 0
        )


@pytest.mark.parametrize("axis", range(3))
@pytest.mark.parametrize("size", [-5.01, -4.99, 4.99, 5.01])
def test_more_than_a_zero_can_be_off_is_a_payload(axis: int, size: float) -> None:
    wrench = [0.0] * 3
    wrench[axis] = size
    why_not = ready(*wrench).why_not()
    if abs(size) < SPEC.offset_force:
        assert why_not == ""
    else:
        mass = abs(size) / GRAVITY if axis == 2 else 0.0
        way = "less" if axis == 2 and size > 0 else "more"
        told = f"{abs(size):.1f} N is more than its zero can be off; the payload may be {mass:.1f} kg {way} than configured"
        assert why_not == told


def test_two_kilograms_are_named() -> None:
    why_not = ready(0.0, 0.0, -2.0 * GRAVITY).why_not()
    assert why_not == "19.6 N is more than its zero can be off; the payload may be 2.0 kg more than configured"


@pytest.mark.parametrize("axis", range(3))
@pytest.mark.parametrize("size", [-0.401, -0.399, 0.399, 0.401])
def test_more_torque_than_a_zero_can_be_off_is_a_payload_elsewhere(axis: int, size: float) -> None:
    wrench = [0.0] * 6
    wrench[3 + axis] = size
    told = "0.40 N·m is more than its zero can be off; the payload's centre may be elsewhere than configured"
    assert ready(*wrench).why_not() == (told if abs(size) > SPEC.offset_torque else "")


def test_the_bound_is_of_all_that_is_subtracted_and_not_of_each_time() -> None:
    bench = ready(3.0)
    bench.zero()
    bench.wait(300.0).feel(5.5).run(READY)
    assert bench.why_not() == "5.5 N is more than its zero can be off; the payload may be 0.0 kg more than configured"
    bench.feel(4.9).run(READY)
    bench.zero()
    assert bench.taring.zero[0] == pytest.approx(-4.9)


def test_the_gain_of_the_sensor_is_part_of_the_bound() -> None:
    bench = Bench()
    bench.load = 5.0
    bench.feel(
        0.0,
        0.0,
        SPEC.offset_force + SPEC.gain * 5.0 * GRAVITY - 0.01,
        0.0,
        0.0,
        SPEC.offset_torque + 0.2 * SPEC.gain * 5.0 * GRAVITY - 0.01,
    )
    assert bench.run(READY).why_not() == ""


def test_what_was_there_in_the_first_window_cannot_be_told() -> None:
    assert ready(4.0).why_not() == ""


def test_the_reference_goes_along_as_fast_as_the_sensor_drifts() -> None:
    """A zigzag at the fastest drift on all axes: once in a minute it is looked at, and zeroing is always possible."""
    bench, force, torque = Bench(), 0.0, 0.0
    for minute in range(60):
        way = 60.0 if minute // 5 % 2 else -60.0
        force, torque = force + SPEC.drift_force * way, torque + SPEC.drift_torque * way
        assert max(abs(force), 10.0 * abs(torque)) < 5.0
        bench.wait(60.0).feel(force, -force, force, torque, torque, -torque).run(READY)
        assert bench.why_not() == "", minute
        assert bench.taring.explains(bench.value(), tuple(bench.value().F_user.tolist()))


@pytest.mark.parametrize("size", [5.0, 8.0, 30.0])
@pytest.mark.parametrize("minutes", [0.2, 1.0, 2.0, 3.0, 3.9])
def test_a_hand_that_comes_is_refused_for_minutes(size: float, minutes: float) -> None:
    """The reference goes towards it as fast as drift: (5 N - 1.6 N) / 0.014 N/s are 4 minutes."""
    bench = ready(0.5).feel(0.5 + size).run(READY).wait(60.0 * minutes).run(READY)
    assert "more than on the untouched arm: let go of it" in bench.why_not()


def test_a_hand_that_stays_for_longer_cannot_be_told_from_drift() -> None:
    assert ready(0.0).feel(4.9).run(READY).wait(300.0).run(READY).why_not() == ""


def test_a_hand_that_went_leaves_the_zero_as_good_as_before() -> None:
    bench = ready().feel(0.0, 4.0).run(READY).wait(60.0).run(READY).feel().run(READY)
    assert bench.why_not() == ""
    assert bench.zero().values["force"] == pytest.approx(0.0, abs=1e-9)


@given(way=st.tuples(*[st.floats(-1, 1)] * 3).filter(lambda way: math.hypot(*way) > 0.1), steps=st.integers(1, 6))
@hypothesis_settings(max_examples=20, deadline=None)
def test_however_often_it_is_zeroed_a_growing_hand_gets_no_farther_than_one_that_is_not_noticed(
    way: tuple[float, ...], steps: int
) -> None:
    """Zeroing moves the reference along: what is taken for untouched does not add up."""
    bench, size = ready(), math.hypot(*way)
    for k in range(1, 11):
        bench.feel(*(4.0 / 10 * k * each / size for each in way)).run(steps * WINDOW)
        if not bench.why_not():
            bench.taring.tare(bench.value())
    drift = SPEC.drift_force * bench.tick * TICK * math.sqrt(3.0)
    assert math.hypot(*bench.taring.zero[:3]) <= PULL + drift + 1e-9


@pytest.mark.parametrize(("off", "possible"), [(-1.0, True), (-0.01, True), (0.01, False), (1.0, False)])
def test_while_it_was_not_followed_it_may_have_drifted(off: float, possible: bool) -> None:
    """A minute in free-drive: 0.84 N more are no hand's."""
    bench = ready().wait(60.0)
    time = (READY + 1 + READY) * TICK + 60.0 - READY * TICK
    bench.feel(0.0, 0.0, SPEC.drift_force * time + PULL + off).run(READY)
    assert (bench.why_not() == "") is possible


@pytest.mark.parametrize(("mass", "size", "pulls"), [(5.0, 0.9, False), (5.0, 3.4, True), (0.0, 1.8, True), (2.0, 2.3, True)])
def test_in_another_posture_a_load_may_weigh_something_else(mass: float, size: float, pulls: bool) -> None:
    """1.4 % of the change of its weight, which for 5 kg turned by 90 degrees is 0.97 N."""
    bench = Bench()
    bench.load = mass
    bench.run(READY).step(stands=False)
    bench.R = ACROSS
    bench.feel(0.0, size).run(READY)
    assert ("untouched arm" in bench.why_not()) is pulls


def test_another_load_or_a_sensor_that_was_out_begins_again() -> None:
    bench = ready()
    bench.feel(0.0, 4.0).taring.restart(lost=False)
    assert "must stand untouched" in bench.why_not()
    assert bench.run(READY).why_not() == ""


def test_the_zero_stays_when_the_sensor_was_out() -> None:
    bench = ready(1.0)
    bench.zero()
    bench.taring.restart(lost=False)
    assert bench.taring.zero[0] == pytest.approx(-1.0)


@pytest.mark.parametrize(
    ("wrench", "limit"),
    [
        ((0.0, 0.0, 1.0), "payload_force"),
        ((0.0, 0.0, -1.0), "payload_force"),
        ((0.0, 1.0, 0.0), "user_force"),
        ((0.0, 0.0, 0.0, 0.6, 0.8), "payload_torque"),
        ((0.0, 0.0, 0.0, 0.0, 0.0, -1.0), "user_torque"),
    ],
)
@pytest.mark.parametrize("share", [0.65, 0.66, 0.67, 0.68, 0.9])
def test_it_is_due_from_two_thirds_of_a_limit_on_and_told_once(wrench: tuple[float, ...], limit: str, share: float) -> None:
    most = 4.0 if "force" in limit else 0.4
    limits = replace(LIMITS, **{limit: Limit(max=most)})
    bench = Bench(limits=limits).feel(*(share * most * each for each in wrench)).run(READY)
    due = share > 2.0 / 3.0
    assert [event.kind for event in bench.events] == [Kind.ZERO_DUE] * due
    assert bench.taring.due is due
    if due:
        assert bench.events[0].tick == WINDOW
        force, torque = (*wrench, 0.0, 0.0, 0.0)[:3], (*wrench, 0.0, 0.0, 0.0)[3:6]
        assert bench.events[0].values["force"] == pytest.approx(share * most * math.hypot(*force))
        assert bench.events[0].values["torque"] == pytest.approx(share * most * math.hypot(*torque))


def test_a_limit_that_is_off_makes_nothing_due() -> None:
    limits = ActivationLimits(payload_force=Limit(max=4.0, on=False))
    assert Bench(limits=limits).feel(0.0, 0.0, 3.9).run(READY).events == []


def test_it_is_due_until_half_the_limit_or_until_it_is_zeroed() -> None:
    bench = Bench().feel(0.0, 0.0, 4.4).run(READY)
    assert bench.taring.due
    for force, due in ((3.2, True), (3.11, True), (3.09, False), (4.1, False), (4.2, True)):
        bench.wait(200.0).feel(0.0, 0.0, force).run(READY)
        assert bench.taring.due is due, force
    assert [event.kind for event in bench.events] == [Kind.ZERO_DUE] * 2
    bench.zero()
    assert not bench.taring.due
    bench.run(READY)
    assert len(bench.events) == 2


def test_what_pulls_makes_nothing_due_and_changes_nothing() -> None:
    bench = ready().feel(0.0, 0.0, 5.0).run(READY)
    assert bench.events == []
    assert not bench.taring.due


def test_what_is_more_than_a_zero_makes_nothing_due() -> None:
    assert ready(0.0, 0.0, -5.1).events == []
    assert len(ready(0.0, 0.0, -4.8).events) == 1


@pytest.mark.parametrize(("wrench", "can"), [((0.0, 0.0, 4.89), True), ((0.0, 0.0, 4.91), False), ((4.8, 4.8, 4.8), True)])
def test_what_the_zero_explains(wrench: Wrench, can: bool) -> None:
    bench = Bench().feel(*wrench)
    assert bench.taring.explains(bench.value(), (*wrench, 0.0, 0.0, 0.0)) is can
    turned = (*(ACROSS @ np.array(wrench)).tolist(), 0.0, 0.0, 0.0)
    bench.R = ACROSS
    assert bench.taring.explains(bench.value(), turned) is can


def test_equal_memories_decide_equally() -> None:
    one, other = ready(1.0), ready(1.0)
    assert state_of(one.taring) == state_of(other.taring)
    one.step()
    assert state_of(one.taring) != state_of(other.taring)
    other.step()
    one.zero()
    assert state_of(one.taring) != state_of(other.taring)


def test_most_ticks_only_count(monkeypatch: pytest.MonkeyPatch) -> None:
    bench, asked = Bench(), []
    mean = WrenchMean.mean
    monkeypatch.setattr(WrenchMean, "mean", lambda self: asked.append(1) or mean(self))
    bench.run(10 * WINDOW)
    assert len(asked) == 10


def test_noise_and_drift_alone_refuse_nothing() -> None:
    """A hundred seconds of a sensor that is as noisy as it is said to be; each window's mean is drawn at once."""
    rng, bench = np.random.default_rng(5), Bench().run(WINDOW)
    noise = [NOISE] * 3 + [SPEC.noise_torque / math.sqrt(WINDOW)] * 3
    for second in range(100):
        for _ in range(WINDOWS):
            bench.feel(*rng.normal([0.012 * second] * 3 + [0.0] * 3, noise).tolist()).run(WINDOW)
        assert bench.why_not() == "", second


def test_the_payloads_error_is_told_without_what_was_zeroed() -> None:
    """0.5 kg too much, and a bias that was zeroed with it; F_user is minus what the sensor has too much."""
    bench = Bench()
    bias, weight = (2.0, -1.0, -1.0), 0.5 * GRAVITY
    bench.feel(-bias[0], -bias[1], -bias[2] - weight).run(READY)
    assert bench.taring.payload_error(bench.value(), tuple(bench.value().F_user.tolist())) is None
    bench.zero()
    bench.run(1, stands=False).R = ACROSS
    bench.feel(-bias[0], -bias[1] + ACROSS[2, 1] * -weight, -bias[2])
    bench.run(READY)
    told = bench.taring.payload_error(bench.value(), tuple(bench.value().F_user.tolist()))
    assert told is not None
    assert told.mass == pytest.approx(0.5, abs=0.05)
    assert told.margin < 0.3
    bench.taring.restart(lost=False)
    assert bench.taring.payload_error(bench.value(), ZEROS) is None, "one other posture does not tell another load"


def test_a_sensor_that_was_out_tells_nothing_of_the_payload() -> None:
    bench = ready()
    bench.run(1, stands=False).R = ACROSS
    bench.run(READY)
    assert bench.taring.payload_error(bench.value(), ZEROS) is not None
    bench.taring.restart(lost=True)
    bench.run(READY)
    assert bench.taring.payload_error(bench.value(), ZEROS) is None
