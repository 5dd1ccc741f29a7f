"""The limits of what counts as the flange sensor's drift, at them and beside them (FD-19)."""

import pytest

from pendant.events.event import Kind
from pendant.guided.bias_follower import BiasFollower
from pendant.guided.sensor_bias import SensorBias
from pendant.guided.user_force import UserForce
from pendant.limits.validity import WINDOW, WrenchMean
from pendant.sensor.hand_model import HALF
from pendant.sensor.sensor_errors import FALSE_ALARM, LEVER, window_noise
from pendant.sensor.sensor_spec import SensorSpec
from pendant.tick.estimate import Estimate
from pendant.tick.modes import TICK
from pendant.tick.pose import ORIGIN
from tests.pendant.estimates import HAND, SENSOR, estimate
from tests.pendant.guided.test_sensor_bias import went

ZEROS = (0.0,) * 6
QUIET = FALSE_ALARM * window_noise(SENSOR, estimate())
"""What noise alone may make of a window's mean [N]."""


class Follows:
    """An arm that nobody moves, from a tick on; the means of its windows are told as they are."""

    def __init__(self, tick: int = 0, felt: tuple[float, float, float] = ORIGIN, sensor: SensorSpec = SENSOR) -> None:
        start = estimate(tick, felt=list(felt))
        self.bias, self.hand = SensorBias(sensor), UserForce(start, ZEROS, SENSOR.offset_force)
        self.bias.begin(start, True, WrenchMean())

    def window(self, value: Estimate) -> list[Kind]:
        """All its ticks look alike; the mean of one is exactly what it is."""
        mean = WrenchMean()
        mean.step(value)
        events = [self.bias.step(value, self.hand, mean, waits=True, still=True, force=HAND) for _ in range(WINDOW)]
        return [event.kind for event in events if event is not None]


@pytest.mark.parametrize("axis", range(3))
@pytest.mark.parametrize(("size", "held"), [(QUIET, False), (-QUIET, False), (1.001 * QUIET, True), (-1.001 * QUIET, True)])
def test_a_hand_that_holds_the_arm_is_known_in_every_axis_beyond_the_limit(axis: int, size: float, held: bool) -> None:
    force = [size if k == axis else 0.0 for k in range(6)]
    assert BiasFollower(SENSOR).held(tuple(force), estimate()) is held


@pytest.mark.parametrize(("torque", "force"), [(5.0, 0.9 * QUIET), (-5.0, 0.0)])
def test_a_torque_does_not_count_as_a_force_that_holds_the_arm(torque: float, force: float) -> None:
    assert not BiasFollower(SENSOR).held((0.0, 0.0, force, torque, 0.0, 0.0), estimate())


@pytest.mark.parametrize(("size", "answer", "follows"), [(HAND, 1.0, False), (0.999 * HAND, 1.0, True), (4.0, HALF, False)])
def test_at_the_limits_it_is_the_joints_that_tell(size: float, answer: float, follows: bool) -> None:
    drift = BiasFollower(SENSOR)
    drift.step(ZEROS, ORIGIN, HAND)
    taken = drift.step((size, 0.0, 0.0, 0.0, 0.0, 0.0), (answer * size, 0.0, 0.0), HAND)
    assert (taken is not None) is follows


@pytest.mark.parametrize("axis", range(3))
@pytest.mark.parametrize("way", [1.0, -1.0])
@pytest.mark.parametrize("steady", [5.0, -5.0])
def test_what_the_joints_feel_all_the_while_is_no_answer_to_a_drift(axis: int, way: float, steady: float) -> None:
    """A wrong payload hangs there: 5 N in each window alike, while the sensor goes on by 0.2 N in each, 2.4 N in all."""
    felt = (steady, steady, steady)
    follows = Follows(felt=felt)
    for window in range(13):
        force = [0.2 * window * way if k == axis else 0.0 for k in range(3)]
        assert follows.window(estimate(force=force, felt=list(felt))) == []
    assert follows.bias.baseline[:3] == pytest.approx([2.4 * way if k == axis else 0.0 for k in range(3)])


@pytest.mark.parametrize("axis", range(3))
@pytest.mark.parametrize("size", [2.4, -2.4])
def test_what_the_joints_come_to_feel_as_well_is_a_hands_in_every_axis(axis: int, size: float) -> None:
    """It comes after the first mean and stays: the next one has it, a window later, and nothing of it is taken off."""
    push = [size if k == axis else 0.0 for k in range(3)]
    follows = Follows()
    assert follows.window(estimate(felt=push)) == []
    for _ in range(8):
        assert follows.window(estimate(force=push, felt=push)) == []
    assert follows.bias.baseline == ZEROS


@pytest.mark.parametrize("axis", range(6))
@pytest.mark.parametrize("way", [1.0, -1.0])
def test_at_the_limit_of_what_it_may_drift_by_the_sensor_ends_free_drive(axis: int, way: float) -> None:
    """In steps that binary numbers hold exactly, 0.25 N and 1/32 N·m a window, all in the tick of the beginning."""
    sensor = SensorSpec(offset_force=5.0)
    step, limit = (0.25, 5.0) if axis < 3 else (0.03125, LEVER * 5.0)
    count, follows = round(limit / step), Follows(sensor=sensor)
    assert count * step == limit
    for window in range(count + 1):
        wrench = [way * step * window if k == axis else 0.0 for k in range(6)]
        assert follows.window(estimate(force=wrench[:3], torque=wrench[3:])) == [Kind.SENSOR_DRIFTED] * (window == count)


@pytest.mark.parametrize("axis", range(6))
@pytest.mark.parametrize(("share", "used"), [(0.97, True), (1.03, False)])
@pytest.mark.parametrize("began", [0, 100_000])
def test_what_it_does_by_itself_it_may_do_in_the_time_since_the_beginning(
    began: int, share: float, used: bool, axis: int
) -> None:
    """100 s: 7.31 N and 1.16 N·m. What was before the beginning is no time in which it drifted."""
    seconds, count = 100.0, 30  # so that each step is less than what may be drift in a window
    force, torque = (
        SENSOR.offset_force + went(seconds)[0],
        LEVER * SENSOR.offset_force + went(seconds)[1],
    )
    limit = force if axis < 3 else torque
    now, follows = began + round(seconds / TICK), Follows(began)
    for window in range(count + 1):
        wrench = [share * limit * window / count if k == axis else 0.0 for k in range(6)]
        events = follows.window(estimate(now, force=wrench[:3], torque=wrench[3:]))
        gone = window == count and not used
        assert events == [Kind.SENSOR_DRIFTED] * gone
