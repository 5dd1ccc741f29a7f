"""Motions: anything that may move the arm is asked for, at random, and looked at in every tick, without a plant.

Program steps, Home, the payload wizard's turns, jogging, scripts: lengths of 0, of 1e-9 to 1 m and exact multiples of what
accelerations, speeds and ticks make of them; accelerations of 0.01 to 100, speeds of 0.001 to 10; from anywhere, the ends of
joints' ranges, singular postures, moving arms; on all arms. Each ends where it says, or there is a reason why it does not.
"""

import math
from collections import Counter

from benchmarks.common import Report, main, spread
from benchmarks.motion.drawn import KINDS
from benchmarks.motion.play import FAST, OFF, STEEP, TURNED, Outcome, play

CHUNK = 100  # motions that a worker does at once
REASONS = {
    "out of reach, or singular": ("out of reach", "singular"),
    "beyond a joint's range": ("would reach", "end of its range"),
    "its time is too short": ("it needs",),
    "no circle": ("points",),
}
"""What the words of a reason stand for; each other one is its own."""


def some(work: tuple[int, int, int]) -> list[Outcome]:
    """Motions of a seed from one number to another."""
    seed, first, end = work
    return [play(seed, number) for number in range(first, end)]


def measure(report: Report) -> None:
    """Fill the report."""
    count = 100_000 if report.options.full else 1000
    work = [(report.options.seed, first, min(first + CHUNK, count)) for first in range(0, count, CHUNK)]
    found = [outcome for chunk in spread(some, work) for outcome in chunk]
    for what, mark in (("that raise", "raises"), ("that do not end", "not end"), ("that end elsewhere", "ends elsewhere")):
        report.row(f"motions {what}", sum(mark in each.failure for each in found), at_most=0, n=count)
    report.row("motions for which something else does not hold", sum(bool(each.failure) for each in found), at_most=0, n=count)
    for start in sorted({each.start for each in found}):
        those = [each for each in found if each.start == start]
        report.row(f"from {start}: something does not hold", sum(bool(each.failure) for each in those), at_most=0, n=len(those))
    report.row("end, from where it says, farthest", 1e3 * max(each.off for each in found), "mm", at_most=1e3 * OFF)
    turned = math.degrees(max(each.turned for each in found))
    report.row("end, turned from how it says, most", turned, "°", at_most=math.degrees(TURNED))
    report.row("joint speed, over its limit", max(each.fast for each in found), at_most=FAST)
    report.row("step of joint speed in a tick, over acceleration limit x tick", max(each.steep for each in found), at_most=STEEP)
    gap = max(each.gap for each in found)
    report.row("step of position less speed x tick, over half of acceleration limit x tick²", gap, at_most=STEEP)
    report.share("stepped to its end", sum(each.stepped for each in found), count)
    report.share("refused or ended with a reason", sum(bool(each.reason) for each in found), count)
    reasons = Counter(_kind(each.reason) for each in found if each.reason)
    for reason in (*REASONS, *sorted(reasons.keys() - REASONS.keys())):
        report.share(f"reason: {reason}", reasons[reason], count)
    for kind in KINDS:
        those = [each for each in found if each.kind == kind]
        report.share(f"{kind}: with a reason", sum(bool(each.reason) for each in those), len(those))
    report.notes += [f"{n} x {reason}" for reason, n in Counter(each.reason for each in found if each.reason).most_common()]
    for each in [each for each in found if each.failure][:20]:
        report.notes.append(f"case {each.number}, {each.arm}, {each.kind} from {each.start}: {each.failure}")


def _kind(reason: str) -> str:
    return next((kind for kind, words in REASONS.items() if any(word in reason for word in words)), reason)


if __name__ == "__main__":
    main("motions", measure)
