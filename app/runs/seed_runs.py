"""One session at many seeds: which seeds, how many runs passed, and which expectation was near its bound."""

from collections.abc import Iterable
from typing import NamedTuple

from app.files.bad_input import BadInput
from app.runs.runner import RunOutcome

MAX_SEED = 2**31 - 1
"""The largest seed."""

MAX_SEEDS = 1000
"""One command runs a session at most this often. For more runs, use a study."""


def seeds_in(text: str) -> list[int]:
    """The seeds of a text, in its order: numbers and ranges with both ends, "1-12" or "1,3,7-9".

    Raises:
        BadInput: the text has another form, names a seed twice, or has too many seeds.
    """
    allowed = f"seeds and ranges of seeds, each once and at most {MAX_SEEDS} in all, such as 1-12 or 1,3,7-9"
    found: list[int] = []
    for part in text.split(","):
        first, dash, last = part.strip().partition("-")
        ends = (first, last if dash else first)
        if not all(end.isascii() and end.isdecimal() and len(end) <= len(str(MAX_SEED)) for end in ends):
            raise BadInput("--seeds", "", text, allowed)
        low, high = map(int, ends)
        if not low <= high <= MAX_SEED or high - low >= MAX_SEEDS:
            raise BadInput("--seeds", "", text, allowed)
        found += range(low, high + 1)
    if len(set(found)) < len(found) or len(found) > MAX_SEEDS:
        raise BadInput("--seeds", "", text, allowed)
    return found


class NotMet(NamedTuple):
    """An expectation that was not met at some seeds."""

    expected: str
    seeds: list[int]
    seen: str  # at the first of them


class NearestToBound(NamedTuple):
    """The met expectation that was nearest to its bound."""

    expected: str
    seed: int
    seen: str
    margin: float  # as a share of its bound


class SessionAtSeeds(NamedTuple):
    """The result of a session at many seeds."""

    name: str
    runs: int
    failed: list[int]  # seeds at which an expectation was not met
    missed: list[NotMet]
    nearest: NearestToBound | None  # None: no expectation has a bound, or none was within its bounds


def gathered(runs: Iterable[tuple[str, int, RunOutcome]]) -> list[SessionAtSeeds]:
    """Gather runs by their session's name: name, seed and outcome of each."""
    by_name: dict[str, dict[int, RunOutcome]] = {}
    for name, seed, outcome in runs:
        by_name.setdefault(name, {})[seed] = outcome
    return [_at_seeds(name, outcomes) for name, outcomes in by_name.items()]


def _at_seeds(name: str, outcomes: dict[int, RunOutcome]) -> SessionAtSeeds:
    missed: dict[int, NotMet] = {}
    nearest: NearestToBound | None = None
    for seed, outcome in outcomes.items():
        for place, verdict in enumerate(outcome.verdicts):
            if not verdict.passed:
                missed.setdefault(place, NotMet(verdict.expected, [], verdict.seen)).seeds.append(seed)
            elif verdict.margin is not None and (nearest is None or verdict.margin < nearest.margin):
                nearest = NearestToBound(verdict.expected, seed, verdict.seen, verdict.margin)
    failed = [seed for seed, outcome in outcomes.items() if not outcome.passed]
    return SessionAtSeeds(name, len(outcomes), failed, [missed[place] for place in sorted(missed)], nearest)
