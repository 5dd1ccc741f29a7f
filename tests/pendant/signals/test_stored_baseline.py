"""States that the activation sequence may be compared with (FD-9): which one is found, and when none is."""

import pytest

from pendant.limits.validity import WrenchMean
from pendant.signals.stored_baseline import EVERY, OLDEST, Stored
from pendant.tick.state import state_of
from tests.pendant.estimates import estimate


def kept(until: int, wrench: bool = True) -> Stored:
    """A state whenever one is due, up to tick `until`; the flange of tick t is t millimetres away."""
    stored = Stored()
    for tick in filter(stored.due, range(until + 1)):
        stored.keep(estimate(tick, position=0.001 * tick), wrench, WrenchMean())
    return stored


def test_a_state_is_kept_every_twentieth_of_a_second() -> None:
    assert (EVERY, OLDEST) == (25, 7525)
    stored = kept(0)
    assert [tick for tick in range(60) if stored.due(tick)][:2] == [25, 26]
    assert Stored().due(0)


@pytest.mark.parametrize("age", [250, 251, 262, 274, 275, 276, 500, 999, 1000])
@pytest.mark.parametrize("tick", [1000, 1001, 1010, 1024])
def test_the_youngest_that_is_old_enough_is_found(tick: int, age: int) -> None:
    found = kept(tick).of(tick, age, True)
    assert found is not None
    assert found.position[0] == pytest.approx(0.001 * 25 * ((tick - age) // 25))


@pytest.mark.parametrize(("tick", "there"), [(249, False), (250, True), (251, True), (7524, True), (7525, True), (7526, False)])
def test_none_is_too_young_or_too_old(tick: int, there: bool) -> None:
    """The only one is of tick 0; it may be 0.5 to 15 s old, and the time between two."""
    assert (kept(0).of(tick, 250, True) is not None) is there


@pytest.mark.parametrize("until", [7499, 7500, 7525, 9000, 9024])
def test_fifteen_seconds_are_kept(until: int) -> None:
    found = kept(until).of(until, 7500, True)
    assert (found is not None) is (until >= 7500)
    if found is not None:
        assert found.position[0] == pytest.approx(0.001 * 25 * ((until - 7500) // 25))


def test_none_is_kept_that_is_too_old_to_be_compared_with() -> None:
    """A robot runs for weeks."""
    assert [tick for tick, _ in kept(16000)._states] == list(range(16000 - OLDEST, 16001, EVERY))


def test_what_is_kept_is_the_arm() -> None:
    mean = WrenchMean()
    for value in (2.0, 4.0):
        mean.step(estimate(force=[0.0, value, 0.0]))
    stored = Stored()
    stored.keep(estimate(5, tau_ext=7.0, q=[0.1] * 6, position=[0.1, 0.2, 0.3]), True, mean)
    found = stored.of(255, 250, True)
    assert found is not None
    assert found.position == (0.1, 0.2, 0.3)
    assert found.wrench == (0.0, 3.0, 0.0, 0.0, 0.0, 0.0)
    assert found.torques == (7.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    assert found.angles == (0.1,) * 6


def test_states_of_other_sensors_are_not_compared_with() -> None:
    with_sensor, without = kept(500), kept(500, wrench=False)
    assert with_sensor.of(500, 250, False) is None
    assert without.of(500, 250, True) is None
    assert without.of(500, 250, False) is not None
    without.keep(estimate(525), True, WrenchMean())
    assert without.of(774, 250, True) is None
    assert without.of(775, 250, True) is not None


def test_what_is_forgotten_is_gone() -> None:
    stored, other = kept(500), kept(500)
    assert state_of(stored) == state_of(other)
    stored.forget()
    assert state_of(stored) != state_of(other)
    assert stored.of(500, 250, True) is None
    assert stored.due(501)
