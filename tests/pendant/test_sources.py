"""The sources side by side, whatever is switched meanwhile (FD-5, FD-6a); test_signals.py has each of them."""

import pytest

from pendant.settings import Settings, apply
from pendant.sources import TOLD_AFTER, Presence, Sources
from tests.pendant.estimates import estimate


class Bench:
    """Sources of an arm that is held, one tick at a time."""

    def __init__(self) -> None:
        self.sources = Sources(6)

    def run(self, count: int, *switches: str, wrench: bool = True, **felt: float) -> list[tuple[Presence, bool]]:
        """With these switches of `signals` on: the signal, and whether a push is told, of each tick."""
        use = apply(Settings(), {f"signals.{switch}": True for switch in switches}).signals
        value, seen = estimate(wrench_valid=wrench, **felt), []
        for _ in range(count):
            seen.append((self.sources.step(value, wrench, True, True, False, use), self.sources.pushed() is not None))
        return seen


@pytest.mark.parametrize(("meanwhile", "wrench"), [("joints.on", True), ("twist.on", True), ("push.told", False)])
def test_a_push_is_told_once_though_it_is_asked_for_no_more_or_the_sensor_is_lost(meanwhile: str, wrench: bool) -> None:
    """FD-6a."""
    bench = Bench()
    bench.run(100, "push.told")
    assert any(bench.run(1, "push.told", force=20.0)[0][1] for _ in range(2 * TOLD_AFTER))
    assert not any(told for _, told in bench.run(60, meanwhile, wrench=wrench, force=20.0))


def test_a_push_counts_from_the_tick_in_which_it_is_asked_for() -> None:
    """FD-6a."""
    bench = Bench()
    bench.run(100, "push.told")
    bench.run(200, "push.told", force=20.0)
    bench.run(10, "joints.on", force=20.0)
    told = [told for _, told in bench.run(2 * TOLD_AFTER, "push.told", force=20.0)]
    assert told == [tick == TOLD_AFTER for tick in range(1, 2 * TOLD_AFTER + 1)]


@pytest.mark.parametrize(
    ("name", "other", "felt"),
    [("push", "twist", {"force": 13.0}), ("twist", "push", {"torque": 2.6}), ("force_step", "push", {"force": 8.5})],
)
def test_what_was_over_with_the_sensor_is_not_back_when_it_is_asked_for_again(
    name: str, other: str, felt: dict[str, float]
) -> None:
    """FD-5, FD-12: what would be enough to stay is not enough to come."""
    bench = Bench()
    bench.run(100, f"{other}.on")
    bench.run(2, f"{other}.on", wrench=False)
    bench.run(100, f"{other}.on")
    bench.run(100, f"{other}.on", **felt)
    assert not any(signal.source for signal, _ in bench.run(100, f"{name}.on", **felt))
