"""Which rules of a detector count, alone and together, and how long a contact lasts that none of them sees go."""

from collections.abc import Iterable
from itertools import combinations

import msgspec
import numpy as np
import pytest

from pendant.contact.confirmation import Confirmation
from pendant.contact.contact_rules import NEW, Rule, hard, slow, statistical, values
from pendant.contact.detector import GONE, SILENCE, Detector
from pendant.contact.history import History
from pendant.contact.settings import ContactUse, RulesNeeded
from tests.pendant.contact.test_detector import ringing
from tests.pendant.contacts import USE, found, limit, ramp, signals

START = 60
SETS = [rules for length in range(1, len(Rule) + 1) for rules in combinations(Rule, length)]


def only(rules: Iterable[Rule], **others: bool) -> ContactUse:
    """Settings with these rules alone, each confirmed by its own count."""
    return msgspec.structs.replace(USE, retrospective=False, **{rule.value: rule in rules for rule in Rule}, **others)


@pytest.mark.parametrize("of_values", [False, True])
def test_a_change_is_found_by_any_of_the_rules_that_are_on_or_by_all(of_values: bool) -> None:
    """CD-9, CD-10: in the first tick in which one of them is confirmed, or all of them; the first of them is named."""
    stream = signals(100, push=ramp(100, START, 2.0, top=60.0), noise=0.3, seed=3)
    history, limits, counts = History(), limit(), {rule: Confirmation() for rule in Rule}
    needed = dict.fromkeys(Rule, USE.hard_count) | {Rule.STATISTICAL: USE.soft_count, Rule.SLOW: USE.slow_count}
    confirmed: list[set[Rule]] = []
    for signal in stream:
        history.push(signal)
        instant, ratio_of_values = values(history, limits)
        change = hard(history, limits)
        seen = {
            Rule.DIFFERENCE: int(change.difference),
            Rule.RATIO: int(change.ratio or (of_values and ratio_of_values)),
            Rule.INSTANT: int(instant),
            Rule.STATISTICAL: int(statistical(history, limits)),
            Rule.SLOW: slow(history, limits).sightings,
        }
        confirmed.append({rule for rule in Rule if counts[rule].step(seen[rule], needed[rule], int(USE.misses))})
    assert len({frozenset(rules) for rules in confirmed}) > 5
    for rules in SETS:
        for needed in RulesNeeded:
            enough = len(rules) if needed is RulesNeeded.ALL else 1
            expected = next(tick for tick, seen in enumerate(confirmed) if len(seen & set(rules)) >= enough)
            (tick, finding), *_ = found(stream, only(rules, rules_needed=needed, ratio_of_values=of_values))
            assert (tick, finding.rule in confirmed[tick]) == (expected, True), (rules, needed)


@pytest.mark.parametrize("off", [only([]), only([Rule.SLOW]), only([Rule.RATIO])])
def test_a_rule_that_is_off_does_not_count(off: ContactUse) -> None:
    """CD-9: switched on between its two sightings, it takes two more."""
    stream = signals(START + 20, push=ramp(START + 20, START, 5.0), noise=0.0)  # by then the others are not confirmed
    on, detector = only([Rule.DIFFERENCE]), Detector()
    first = found(stream, on)[0][0]
    ticks = []
    for tick, signal in enumerate(stream):
        detector.sense(signal)
        if detector.step(on if tick >= first else off, limit()) is not None:
            ticks.append(tick)
    assert ticks[0] == first + 1


def lasts(detector: Detector, after: np.ndarray) -> int:
    """How many ticks of the force `after` [N], which no rule looks at, a contact of 10 N lasts."""
    push = np.zeros((START + 40 + len(after), 3))
    push[START : START + 40, 0], push[START + 40 :, 0] = 10.0, after
    ticks = 0
    for tick, signal in enumerate(signals(len(push), push=push, noise=0.0)):
        detector.sense(signal)
        detector.step(only([Rule.DIFFERENCE] if tick < START + 40 else []), limit())
        ticks += tick >= START + 40 and detector.touching
    return ticks


def test_a_contact_is_over_after_a_fifth_of_a_second_without_any_force() -> None:
    """In a row, and gone in all of the newest five samples; a contact that comes later lasts as long."""
    gone = np.zeros(NEW + 2 * GONE)
    again = gone.copy()
    again[60] = 10.0
    detector = Detector()
    assert [lasts(detector, force) for force in (gone, gone, again)] == [NEW + GONE - 2, NEW + GONE - 2, 60 + NEW + GONE - 1]


def test_a_contact_that_goes_as_it_listens_again_lasts_as_long() -> None:
    """CD-9a: whatever was before it, here one that was over after such a time."""
    detector = Detector()
    lasts(detector, np.zeros(NEW + 2 * GONE))
    end = START + 1 + SILENCE  # seen in the second tick
    push = ringing(end + 2 * GONE, START)
    push[end - NEW + 2 :] = 0.0
    ticks = 0
    for tick, signal in enumerate(signals(len(push), push=push, noise=0.0)):
        detector.sense(signal)
        detector.step(only([Rule.DIFFERENCE] if tick <= end else []), limit())
        ticks += tick > end and detector.touching
    assert ticks == GONE - 1


@pytest.mark.parametrize("older", range(4))
def test_older_pairs_confirm_a_difference_in_the_tick_in_which_all_of_them_show_it(older: int) -> None:
    """CD-9: the first tick of a run that shows it counts as the oldest pair; without older pairs ten in a row are needed."""
    stream = signals(START + 20, push=ramp(START + 20, START, 5.0), noise=0.0)
    use = msgspec.structs.replace(only([Rule.DIFFERENCE]), hard_count=10, older_pairs=older)
    history, limits = History(), limit()
    shows: list[bool] = []
    for signal in stream:
        history.push(signal)
        shows.append(hard(history, limits).difference)
    first = shows.index(True)
    assert all(shows[first : first + 10])
    assert found(stream, use)[0][0] == first + (older or 9)
