"""What pulls at the free arm: probabilities from odds, who is felt, and for how long a doubt is shown."""

import math
from itertools import product

import pytest

from pendant.guided.pull import (
    CERTAIN,
    KEPT,
    NOT_TOLD,
    SHARE_WORDS,
    CauseShares,
    HandFelt,
    PullCauses,
    PullWatch,
    felt,
)
from tests.items import each_of

ODDS = (NOT_TOLD, -800.0, -20.0, -1.0, -1e-9, 0.0, 1e-9, 1.0, 6.9, 6.91, 20.0, 800.0)


def of_one_whole(payload: float, sensor: float, rest: float) -> tuple[float, float]:
    """The odds of both against all else, for these weights."""
    return math.log(payload / (sensor + rest)), math.log(sensor / (payload + rest))


@each_of(product(HandFelt, ODDS, ODDS))
def test_the_shares_are_probabilities(who: HandFelt, lost: float, stepped: float) -> None:
    shares = PullCauses(who, lost, 1.0, stepped).shares
    assert all(0.0 <= share <= 1.0 for share in shares)
    assert math.fsum(shares) == pytest.approx(1.0, abs=1e-12)
    assert [share for at, share in enumerate(shares[:3]) if at != who] == [0.0, 0.0]


@pytest.mark.parametrize("rest", [1e-12, 1e-3, 0.4, 0.5, 0.6, 0.999, 1.0 - 2e-12])
@pytest.mark.parametrize("part", [0.01, 0.5, 0.99])
def test_of_one_whole_each_has_its_part(rest: float, part: float) -> None:
    payload = part * (1.0 - rest)
    sensor = 1.0 - rest - payload
    lost, stepped = of_one_whole(payload, sensor, rest)
    shares = PullCauses(HandFelt.FLANGE, lost, 1.0, stepped).shares
    assert shares == pytest.approx(CauseShares(0.0, rest, 0.0, payload, sensor), abs=1e-9)


def test_nothing_compared_is_nothing_told_against_a_hand() -> None:
    assert PullCauses(HandFelt.NOBODY).shares == (1.0, 0.0, 0.0, 0.0, 0.0)
    assert PullCauses(HandFelt.LINK).shares == (0.0, 0.0, 1.0, 0.0, 0.0)
    assert len(SHARE_WORDS) == len(CauseShares._fields)


@pytest.mark.parametrize(
    ("share", "lost", "gone", "told"),
    [
        (0.5, True, 1.0, "A hand"),
        (0.5 + 1e-6, True, 1.0, "The payload fell: 50 %"),
        (0.97, True, 1.0, "The payload fell: 97 %"),
        (0.97, True, 0.01, "The payload fell: 97 %"),
        (0.97, True, -0.5, "More payload: 97 %"),
        (0.97, False, 1.0, "The sensor stepped: 97 %"),
        (CERTAIN - 1e-6, True, 1.0, "The payload fell: 100 %"),
        (CERTAIN + 1e-6, True, 1.0, "The payload fell: over 99.9 %"),
        (CERTAIN + 1e-6, False, 1.0, "The sensor stepped: over 99.9 %"),
    ],
)
def test_the_likeliest_is_told_in_words(share: float, lost: bool, gone: float, told: str) -> None:
    odds = math.log(share / (1.0 - share))
    pull = PullCauses(HandFelt.FLANGE, odds, gone, NOT_TOLD) if lost else PullCauses(HandFelt.FLANGE, NOT_TOLD, gone, odds)
    assert pull.words == told


def test_who_is_felt_is_told_without_a_figure() -> None:
    assert [PullCauses(who).words for who in HandFelt] == ["No hand", "A hand", "A hand on a link"] == list(SHARE_WORDS[:3])


@pytest.mark.parametrize(
    ("force", "sensed", "usual", "led", "who"),
    [
        (0.999, 0.9, 0.9, False, HandFelt.NOBODY),
        (1.0, 1.0, 0.0, False, HandFelt.FLANGE),
        (1.0, 0.0, 1.0, False, HandFelt.FLANGE),
        (12.0, 0.999, 0.999, False, HandFelt.LINK),
        (0.0, 0.0, 0.0, True, HandFelt.LINK),
        (0.0, 0.0, 5.0, True, HandFelt.FLANGE),
    ],
)
def test_where_a_hand_is_felt(force: float, sensed: float, usual: float, led: bool, who: HandFelt) -> None:
    assert felt((0.0, force, 0.0), sensed=sensed, usual=usual, least=1.0, led=led) is who


def test_a_doubt_is_shown_for_a_tenth_of_a_second_also_after_free_drive() -> None:
    watch, hand, fell = PullWatch(), PullCauses(HandFelt.FLANGE), PullCauses(HandFelt.FLANGE, 13.5, 1.0, -20.0)
    watch.step(None)
    assert watch.shown is None
    for pull in (hand, fell):
        watch.step(pull)
        assert watch.shown is pull
    for _ in range(KEPT - 1):
        watch.step(hand)
        assert watch.shown is fell
    watch.step(hand)
    assert watch.shown is hand
    watch.step(fell)
    for _ in range(KEPT - 1):
        watch.step(None)
        assert watch.shown is fell
    watch.step(None)
    assert watch.shown is None


def test_of_equal_doubts_the_newest_is_shown() -> None:
    watch, nobody, hand = PullWatch(), PullCauses(HandFelt.NOBODY), PullCauses(HandFelt.FLANGE)
    for pull in (nobody, hand, nobody):
        watch.step(pull)
        assert watch.shown is pull
