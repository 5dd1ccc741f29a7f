"""One detector on signals of a load that is moved and pushed: what it finds, when, and what it must not find."""

import math
from collections.abc import Iterator

import msgspec
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from pendant.contact import Change
from pendant.contact_limits import OLDER
from pendant.contact_rules import NEW, Rule
from pendant.detector import CALM, GONE, PATIENCE, SETTLED, SILENCE, Detector, Finding
from pendant.signal import Signal
from tests.pendant.contacts import GRAVITY, USE, found, limit, ramp, signals

ONLY = {
    rule: msgspec.structs.replace(USE, **{other.value: other is rule for other in Rule})  # one rule alone
    for rule in Rule
}
START = 150


@pytest.mark.parametrize(
    ("rule", "slope", "within"),
    [
        (Rule.DIFFERENCE, 10.0, 3),
        (Rule.RATIO, 10.0, 3),
        (Rule.STATISTICAL, 1.0, 15),
        (Rule.SLOW, 0.2, 45),
        (Rule.INSTANT, 20.0, 5),
    ],
)
def test_each_rule_alone_finds_a_push(rule: Rule, slope: float, within: int) -> None:
    (tick, finding), *_ = found(signals(300, push=ramp(300, START, slope)), ONLY[rule])
    assert START < tick <= START + within
    assert finding.rule is rule
    assert finding.force[0] > 0.0
    assert abs(tick - finding.steps - START) <= 6 / slope + 2


def test_no_rule_no_finding() -> None:
    none = msgspec.structs.replace(ONLY[Rule.SLOW], slow=False)
    assert found(signals(300, push=ramp(300, START, 10.0)), none) == []


def test_all_rules_asked_for_is_stricter_than_any() -> None:
    strict = msgspec.structs.replace(USE, all_rules=True, ratio=False)
    stream = signals(400, push=ramp(400, START, 1.0))
    any_rule, every_rule = found(stream)[0][0], found(stream, strict)
    assert not every_rule or every_rule[0][0] > any_rule


def test_more_sensitive_is_sooner_and_less_is_later() -> None:
    stream = signals(400, push=ramp(400, START, 0.3))
    ticks = [found(stream, msgspec.structs.replace(USE, sensitivity=value))[0][0] for value in (2.0, 1.0, 0.25)]
    assert ticks == sorted(ticks)
    assert ticks[0] < ticks[2]


@settings(max_examples=30, deadline=None)
@given(st.integers(0, 9), st.floats(0.5, 5.0), st.floats(-0.2, 0.2), st.floats(0.3, 2.0), st.floats(2.0, 30.0))
def test_free_motion_of_a_wrong_payload_is_no_contact(seed: int, mass: float, wrong: float, rate: float, size: float) -> None:
    """Fast to and fro, the tool turning in gravity: dF and dA stay parallel, whatever the payload weighs."""
    t = np.arange(800) * 0.002
    motion = size * np.sin(2 * np.pi * rate * t)[:, None] * np.array([0.6, -0.5, 0.62])
    gravity = 9.81 * np.stack([np.sin(rate * t), np.zeros_like(t), -np.cos(rate * t)], axis=1)
    assert found(signals(800, mass=mass * (1 + wrong), believed=mass, motion=motion, gravity=gravity, seed=seed)) == []


@settings(max_examples=20, deadline=None)
@given(st.integers(0, 9), st.lists(st.floats(-8.0, 8.0), min_size=3, max_size=3))
def test_a_constant_bias_changes_nothing(seed: int, bias: list[float]) -> None:
    plain = signals(500, push=ramp(500, START, 1.0, top=20.0), seed=seed)
    biased = [s._replace(fx=s.fx + bias[0], fy=s.fy + bias[1], fz=s.fz + bias[2]) for s in plain]
    first, second = found(plain), found(biased)
    assert [(tick, f.change, f.rule, f.steps) for tick, f in first] == [(tick, f.change, f.rule, f.steps) for tick, f in second]
    assert len(first) == 1


@settings(max_examples=20, deadline=None)
@given(st.integers(0, 9), st.floats(-2.0, 2.0))
def test_a_slow_drift_changes_nothing(seed: int, drift: float) -> None:
    """Up to 2 N a minute, four times what the arms' files allow."""
    stream = [s._replace(fx=s.fx + drift / 60.0 * 0.002 * k) for k, s in enumerate(signals(1500, seed=seed))]
    assert found(stream) == []


def test_kinds_gained_resistance_and_lost() -> None:
    n = 2400
    push = ramp(n, START, 5.0, top=20.0)
    push[900:] += ramp(n, 900, 5.0, top=20.0)[900:]
    push[1600:] -= ramp(n, 1600, 8.0, top=40.0)[1600:]
    seen = found(signals(n, push=push))
    assert [finding.change for _, finding in seen] == [Change.GAINED, Change.RESISTANCE, Change.LOST]
    for (tick, finding), begin in zip(seen, (START, 900, 1600), strict=True):
        assert abs(tick - finding.steps - begin) <= 2


def test_a_falling_resistance_is_not_a_lost_contact() -> None:
    push = ramp(1500, START, 5.0, top=30.0)
    push[800:] -= ramp(1500, 800, 5.0, top=15.0)[800:]
    assert [finding.change for _, finding in found(signals(1500, push=push))] == [Change.GAINED, Change.RESISTANCE]


def test_a_slow_squeeze_is_clamping() -> None:
    seen = found(signals(600, arm=1e6, push=ramp(600, START, 0.1)))
    assert seen[0][1].change is Change.CLAMPING
    assert seen[0][1].rule is Rule.SLOW


def test_it_is_silent_until_the_force_has_settled() -> None:
    n = START + SILENCE + 400
    seen = found(signals(n, push=ramp(n, START, 0.6)))
    assert len([tick for tick, _ in seen if tick < START + 200]) == 1


def test_a_contact_that_went_too_gently_is_over_after_a_while() -> None:
    n = 4000
    push = ramp(n, START, 1.5, top=3.0)
    push[700:2700, 0] = np.linspace(3.0, 0.0, 2000)  # 0.75 N a second: no rule sees it
    push[2700:] = ramp(n, 3300, 5.0, top=20.0)[2700:]
    seen = found(signals(n, push=push))
    assert [finding.change for _, finding in seen] == [Change.GAINED, Change.GAINED]
    assert seen[1][0] > 2700 + GONE


def test_a_knock_that_is_over_before_the_force_settles_leaves_no_contact() -> None:
    push = ramp(1200, START, 15.0, top=30.0)
    push[START + 8 :] = 0.0
    push[700:] = ramp(1200, 700, 15.0, top=30.0)[700:]
    assert [finding.change for _, finding in found(signals(1200, push=push))] == [Change.GAINED, Change.GAINED]


def test_a_gap_in_the_signal_makes_it_begin_anew() -> None:
    detector = Detector()
    for signal in signals(300, push=ramp(300, START, 5.0, top=20.0)):
        detector.sense(signal)
        detector.step(USE, limit())
    assert detector.touching
    detector.sense(None)
    assert detector.step(USE, limit()) is None
    assert not detector.touching
    assert not detector.silent


def test_it_finds_what_lies_in_any_direction() -> None:
    rng = np.random.default_rng(4)
    for _ in range(10):
        way = rng.normal(size=3)
        way /= np.linalg.norm(way)
        (_, finding), *_ = found(signals(250, push=ramp(250, START, 8.0, way=tuple(way))))
        assert np.dot(finding.force, way) > 0.9 * np.linalg.norm(finding.force)
        assert np.dot(finding.acceleration, way) < 0.0
        assert finding.ratio < 0.0


def test_gravity_is_that_of_the_earth() -> None:
    assert np.linalg.norm(GRAVITY) == 9.81


def test_a_clear_change_is_confirmed_on_older_samples_at_once() -> None:
    """CD-9: with the retrospective variant in its first tick, without it in the tick after."""
    stream = signals(200, push=ramp(200, START, 30.0, top=60.0))
    use = ONLY[Rule.DIFFERENCE]
    later = msgspec.structs.replace(use, retrospective=False)
    assert [found(stream, each)[0][0] - START for each in (use, later)] == [1, 2]


def test_without_older_samples_a_clear_change_needs_a_second_tick() -> None:
    push = np.zeros((60, 3))
    push[30:] = [30.0, 0.0, 0.0]
    stream = signals(60, push=push, noise=0.0)
    assert found(stream[30 - OLDER :], ONLY[Rule.DIFFERENCE])[0][0] == OLDER  # at once: enough samples before it
    assert found(stream[31 - OLDER :], ONLY[Rule.DIFFERENCE])[0][0] == OLDER  # one less: one tick later


@pytest.mark.parametrize("mass", [0.5, 2.0])
def test_what_it_reports_of_a_step_in_space(mass: float) -> None:
    """CD-13, CD-14: force on the object, change of acceleration and their ratio, since the sample before the first one."""
    rng = np.random.default_rng(8)
    for _ in range(20):
        force, acceleration, push, g = rng.normal(0.0, 3.0, 3), rng.normal(0.0, 1.0, 3), rng.normal(size=3), GRAVITY
        push *= 40.0 / np.linalg.norm(push)
        a = -push / 3.0 + rng.normal(0.0, 1.0, 3)
        rest = Signal(*force.tolist(), *acceleration.tolist(), *g.tolist(), mass, 2.0)
        now = Signal(*(force + push + mass * a).tolist(), *(acceleration + a).tolist(), *g.tolist(), mass, 2.0)
        (tick, finding), *_ = found([rest] * START + [now] * 20)
        assert tick - finding.steps == START
        assert finding.force == pytest.approx(push)
        assert finding.acceleration == pytest.approx(a)
        assert finding.ratio == pytest.approx(np.dot(push + mass * a, a) / np.dot(a, a))


def test_the_first_suspicious_sample_of_a_ramp_is_the_first_beyond_the_noise() -> None:
    """CD-14: 2 deviations of F - m·A, 0.15 N and 0.1 m/s² of 1 kg: 0.36 N, which 0.05 N a tick reach with the eighth."""
    stream = signals(400, arm=1e6, push=ramp(400, START, 0.05, way=(0.0, -0.6, 0.8)), noise=0.0)
    (tick, finding), *_ = found(stream, ONLY[Rule.SLOW])
    assert tick - finding.steps == START + 8


def heard(push: np.ndarray) -> Iterator[tuple[int, Detector, Finding | None]]:
    """Tick by tick, without noise."""
    detector = Detector()
    for tick, signal in enumerate(signals(len(push), push=push, noise=0.0)):
        detector.sense(signal)
        yield tick, detector, detector.step(USE, limit())


def ringing(n: int, start: int) -> np.ndarray:
    """From `start` on, 30 and 10 N in turns of ten ticks: what it was ten ticks ago it never is."""
    push = np.zeros((n, 3))
    push[start:, 0] = [30.0 if k // 10 % 2 == 0 else 10.0 for k in range(n - start)]
    return push


def test_it_listens_again_six_ticks_after_what_was_ten_ticks_apart_is_the_same() -> None:
    """CD-9a: five samples against five that are ten ticks older, from the fifteenth tick on, six times in a row."""
    silent = [detector.silent for _, detector, _ in heard(ramp(400, START, 50.0, top=50.0))]
    assert silent.count(True) == SETTLED + NEW + CALM - 1
    for _, detector, _ in heard(ramp(400, START, 50.0, top=50.0)):
        if detector.touching and not detector.silent:
            assert detector.history.count == SETTLED + NEW, "what was before the contact counts no more"
            break


def test_a_force_that_never_settles_keeps_it_silent_for_half_a_second() -> None:
    """CD-9a."""
    silent = [detector.silent for _, detector, _ in heard(ringing(START + SILENCE + 20, START))]
    begun = silent.index(True)
    assert silent[begun:].index(False) == SILENCE


def test_a_change_of_a_contact_that_never_settles_is_judged_in_the_end() -> None:
    push = ramp(900, START, 20.0, top=20.0)
    push[500:] = 2.0 * ringing(900, 500)[500:]
    begun = None
    for tick, detector, finding in heard(push):
        if tick > 450 and detector.silent and begun is None:
            begun = tick
        if tick > 450 and finding is not None:
            break
    assert begun is not None
    assert (tick - begun, finding.change) == (PATIENCE, Change.RESISTANCE)  # type: ignore[union-attr]


def test_a_small_rest_is_a_lost_contact_and_the_next_is_gained() -> None:
    """CD-13: 5 of 20 N are left; then 20 N more."""
    push = ramp(1200, START, 20.0, top=20.0)
    push[500:, 0], push[800:, 0] = 5.0, 25.0
    changes = [finding.change for _, _, finding in heard(push) if finding is not None]
    assert changes == [Change.GAINED, Change.LOST, Change.GAINED]


def test_a_knock_has_left_no_contact_when_it_listens_again() -> None:
    push = ramp(400, START, 40.0, top=40.0)
    push[START + 6 :] = 0.0
    after = [detector.touching for tick, detector, _ in heard(push) if tick > START + 5 and not detector.silent]
    assert after
    assert not any(after)


def test_a_wrong_payload_may_explain_a_part_of_a_force() -> None:
    """CD-11: 0.8 N of noise, and a quarter of 1 kg for each m/s² of change."""
    before, now = (1.0, 2.0, 3.0, 0.0, 0.0, 9.81), (1.0, 2.0, 8.0, 0.0, 3.0, 13.81)
    # F - m·A changes by 5 - 4 N along z and -3 N along y, A by 5 m/s².
    assert Detector()._size(now, before, limit()) == pytest.approx(math.sqrt(10.0) - 0.8 - 1.25)
    assert Detector()._size(before, before, limit()) == 0.0
