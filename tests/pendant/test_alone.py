"""How far an arm without its flange sensor goes on its own (FD-19); test_operation.py has for how long any arm does."""

import pytest

from pendant.alone import AWAY, Alone
from pendant.estimate import Estimate
from pendant.events import Values
from pendant.hand import Hand
from pendant.modes import TICK
from pendant.settings import Settings
from tests.pendant.estimates import estimate

ZEROS = (0.0,) * 6
RATED = (150.0, 150.0, 150.0, 28.0, 28.0, 28.0)
WAYS = [(1.0, 0.0, 0.0), (0.0, -1.0, 0.0), (0.6, 0.0, 0.8)]


class Bench:
    """An arm that was at rest, moved by hand tick by tick."""

    def __init__(self, sensor: bool = False) -> None:
        self.alone, self.hand, self.sensor = Alone(Settings().unexplained, ZEROS, RATED), Hand(estimate(), ZEROS), sensor

    def see(self, value: Estimate, driven: bool = False) -> Values | None:
        self.hand.step(value, self.sensor)
        return self.alone.step(value, self.hand, self.sensor, driven)

    def go(self, distance: float, way: tuple[float, float, float] = WAYS[0], start: float = 0.3) -> Values | None:
        """Two ticks of motion, and what is told in the second, after so much of a way."""
        assert self.see(estimate(position=[start, 0.1, 0.2], speed=0.1)) is None
        x, y, z = (distance * share for share in way)
        return self.see(estimate(position=[start + x, 0.1 + y, 0.2 + z], speed=0.1))


@pytest.mark.parametrize("way", WAYS)
@pytest.mark.parametrize(("share", "stopped"), [(0.99, False), (1.01, True), (30.0, True)])
@pytest.mark.parametrize("sensor", [True, False])
def test_an_arm_that_nobody_touches_goes_so_far_without_the_sensor(
    sensor: bool, share: float, stopped: bool, way: tuple[float, float, float]
) -> None:
    told = Bench(sensor).go(share * AWAY, way)
    assert told == ({"value": 0.1, "limit": 0.02, "time": pytest.approx(2 * TICK)} if stopped and not sensor else None)


def test_its_way_begins_where_it_begins_to_move() -> None:
    """An arm that creeps slower than what counts as motion has no way."""
    bench = Bench()
    for tick in range(1000):
        assert bench.see(estimate(position=[0.0001 * tick, 0.0, 0.0], speed=0.019)) is None
    assert bench.go(0.99 * AWAY) is None
    assert bench.see(estimate(speed=0.019)) is None
    assert bench.go(0.99 * AWAY, start=0.7) is None
    assert bench.see(estimate(position=[0.7 + 1.01 * AWAY, 0.1, 0.2], speed=0.1)) is not None


@pytest.mark.parametrize("driven", [True, False])
def test_an_arm_that_a_hand_or_a_wall_has_let_go_while_it_moved_has_its_time_alone(driven: bool) -> None:
    """A hand that guides is light now and then; the arm comes to rest within its time, or is stopped."""
    bench, moved = Bench(), estimate(speed=0.1)
    bench.hand.user = (0.0, 0.0, 0.0 if driven else 40.0)
    assert bench.alone.step(moved, bench.hand, False, driven) is None
    assert bench.go(30.0 * AWAY) is None
    bench.see(estimate())
    assert bench.go(1.01 * AWAY) is not None


def test_its_memory_tells_all_of_it() -> None:
    one, other = Bench(), Bench()
    one.see(estimate(speed=0.1))
    assert one.alone.memory != other.alone.memory
    other.see(estimate(speed=0.1))
    assert one.alone.memory == other.alone.memory
