"""One detector on signals of a load that is moved and pushed: what it finds, when, and what it must not find."""

import math
from collections.abc import Iterator

import msgspec
import numpy as np
import pytest

from pendant.contact.contact_change import Change
from pendant.contact.contact_limits import OLDER
from pendant.contact.contact_rules import NEW, Rule
from pendant.contact.detector import CALM, GONE, PATIENCE, SETTLED, SILENCE, Detector, Finding
from pendant.tick.source_signal import Signal
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
    assert (finding.rule, finding.change) == (rule, Change.GAINED)
    assert finding.force[0] > 0.0
    assert abs(tick - finding.steps - START) <= 6 / slope + 2


def test_no_rule_no_finding() -> None:
    none = msgspec.structs.replace(ONLY[Rule.SLOW], slow=False)
    assert found(signals(300, push=ramp(300, START, 10.0)), none) == []


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
        assert finding.ratio == pytest.approx(np.dot(push, a) / np.dot(a, a))


def test_the_first_suspicious_sample_of_a_ramp_is_the_first_beyond_the_noise() -> None:
    """CD-14: 2 deviations of F - m·A, 0.15 N and 0.1 m/s² of 1 kg: 0.36 N, which 0.05 N a tick reach with the eighth."""
    stream = signals(400, arm=1e6, push=ramp(400, START, 0.05, way=(0.0, -0.6, 0.8)), noise=0.0)
    (tick, finding), *_ = found(stream, ONLY[Rule.SLOW])
    assert tick - finding.steps == START + 8


@pytest.mark.parametrize(("rule", "count", "told"), [(Rule.DIFFERENCE, 2, 5), (Rule.INSTANT, 1, 1), (Rule.INSTANT, 2, 2)])
def test_no_change_is_looked_for_before_a_gap(rule: Rule, count: int, told: int) -> None:
    """CD-4, CD-14: 20, 25, 30 N ... from the first sample on that is there; ten times as much was before the gap."""
    use, stream = msgspec.structs.replace(ONLY[rule], hard_count=count), signals(5, push=ramp(5, -4, 5.0), noise=0.0)
    detector, findings = Detector(), []
    for signal in [*signals(40, push=ramp(40, 0, 200.0, top=200.0), noise=0.0), None]:
        detector.sense(signal)
    for signal in stream[:told]:
        detector.sense(signal)
        findings.append(detector.step(use, limit()))
    *none, finding = findings
    assert none == [None] * (told - 1)
    assert finding is not None
    assert finding.force == pytest.approx((5.0 * (told - 1), 0.0, 0.0))
    assert finding.steps == max(told - 2, 0)


@pytest.mark.parametrize("rule", [Rule.DIFFERENCE, Rule.RATIO])
@pytest.mark.parametrize(("ways", "steps"), [((-60.0, 20.0, 20.0), 1), ((20.0, 20.0, 20.0), 2), ((20.0, 20.0, -60.0), 0)])
def test_a_force_that_swings_round_began_where_it_turned(ways: tuple[float, float, float], steps: int, rule: Rule) -> None:
    """CD-14: what the newest two samples show, along any axis and whatever the sensor's bias."""
    use = msgspec.structs.replace(ONLY[rule], retrospective=False, hard_count=3)
    for axis in range(3):
        push = np.zeros((START + 3, 3))
        push[START:, axis] = ways
        stream = signals(START + 3, push=push, noise=0.0)
        ((tick, finding),) = found([s._replace(fx=s.fx - 150.0, fy=s.fy - 120.0, fz=s.fz - 90.0) for s in stream], use)
        assert (tick, finding.steps) == (START + 2, steps)


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


@pytest.mark.parametrize(("late", "changes"), [(-1, 1), (0, 1), (1, 2)])
def test_a_change_up_to_the_tick_in_which_it_would_listen_again_prolongs_the_silence(late: int, changes: int) -> None:
    """CD-9a: it is the same event; a tick later it is another."""
    push = ramp(300, START, 50.0, top=50.0)
    push[START + SETTLED + NEW + CALM + late :, 0] += 10.0
    assert len([finding for _, _, finding in heard(push) if finding is not None]) == changes


def test_a_force_that_never_settles_keeps_it_silent_for_half_a_second() -> None:
    """CD-9a."""
    silent = [detector.silent for _, detector, _ in heard(ringing(START + SILENCE + 20, START))]
    begun = silent.index(True)
    assert silent[begun:].index(False) == SILENCE


@pytest.mark.parametrize(("without", "touching"), [(NEW - 1, True), (NEW, False)])
def test_after_the_silence_a_force_that_has_just_gone_is_no_contact(without: int, touching: bool) -> None:
    """CD-9a: gone in all of the newest samples."""
    end = START + SILENCE
    push = ringing(end + 1, START)
    push[end + 1 - without :] = 0.0
    *_, (_, detector, _) = heard(push)
    assert (detector.silent, detector.touching) == (False, touching)


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
    assert finding is not None
    assert finding.change is Change.RESISTANCE
    assert PATIENCE <= tick - begun <= PATIENCE + SETTLED  # as soon as it does not fall


@pytest.mark.parametrize(("high", "change"), [(3, Change.LOST), (4, Change.RESISTANCE)])
def test_a_change_is_judged_by_its_last_fifteen_ticks(high: int, change: Change) -> None:
    """CD-13: of 20 N, 17.5 N count, of which 6.1 N are small; of 30 N in 3 of 15 ticks 4.7 N count, in 4 of them 6.5 N."""
    judged = 500 + PATIENCE
    push = ramp(judged + 1, START, 20.0, top=20.0)
    push[500:] = ringing(judged + 1, 500)[500:]
    push[judged - 20 : judged - (SETTLED + NEW) + 1 + high] = [30.0, 0.0, 0.0]
    push[judged - (SETTLED + NEW) + 1 + high :] = 0.0
    *_, (_, _, finding) = heard(push)
    assert finding is not None
    assert finding.change is change


def test_a_knock_on_a_contact_that_has_gone_unseen_leaves_none() -> None:
    """CD-13: there was nothing any more, and there is nothing again; what is known of the contact is not over yet."""
    push = ramp(800, START, 2.0, top=2.0)
    push[300:700, 0], push[700:] = np.linspace(2.0, 0.7, 400), [0.7, 0.0, 0.0]
    push[700:706, 0] = 30.0
    assert [finding.change for _, _, finding in heard(push) if finding is not None] == [Change.GAINED, Change.LOST]


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


def test_a_detector_begins_free_of_contact_and_listening() -> None:
    detector = Detector()
    assert (detector.touching, detector.silent) == (False, False)
