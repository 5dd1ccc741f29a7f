"""Observer: payloads that fall, a flange sensor that steps, and hands, as the bank of hypotheses sees them.

Payloads of 0.3 to 5 kg fall from an arm at rest; from a guided one whose hand lets go with it, or stays; and out of a hand that
carries their weight. The sensor of an arm at rest steps by 5 to 20 N, or of a guided one. Hands grab, snatch and let go. Of what
is told with 99 % or more, 98.5 % has to be true. Nothing ends free-drive here: a fall and a step are judged for 60 ms, or until
a fall is known, for then STOP would follow. Truth is read for scoring alone.
"""

import itertools
import math

import numpy as np

from benchmarks.arms import heaviest, senses
from benchmarks.common import Report, main, spread
from benchmarks.payload import draw
from benchmarks.wrenches.watched import Fall, Seen, Step, measure_fall, measure_step, measure_touches

FALLS = ("rest", "guided", "hand stays", "carried")
STEPS = ("rest", "guided")
LIGHTEST = 0.3  # [kg]
SIZES = (5.0, 20.0)  # of a step [N]
LEVELS = (0.5, 0.9, 0.99, 1.0)
SOME = 1e-9  # the odds are 0 at least, in nats: that much is told where nothing is
HONEST = 0.985  # of what is told with 99 % or more


def measure(report: Report) -> None:
    """Fill the report."""
    full, arm = report.options.full, report.options.arm
    if not senses(arm):
        report.notes.append("without a flange sensor there is no observer")
        return
    most = heaviest(arm)
    rng = np.random.default_rng([report.options.seed, 23])
    cases, _ = draw(report.options.seed + 2300, 100 if full else 10, "sensor", arm)
    falls: list[Fall] = []
    for k, case in enumerate(cases):
        mass = float(np.exp(rng.uniform(*np.log([LIGHTEST, most]))))
        falls.append(Fall(case._replace(true=mass, configured=mass), FALLS[k // 4 % 4]))
    hands, _ = draw(report.options.seed + 2500, 50 if full else 5, "sensor", arm)
    steps: list[Step] = []
    cases, _ = draw(report.options.seed + 2700, 60 if full else 6, "sensor", arm)
    for k, case in enumerate(cases):
        mass = float(rng.uniform(0.0, most))
        steps.append(Step(case._replace(true=mass, configured=mass), STEPS[k // 4 % 2], float(rng.uniform(*SIZES))))
    seen = [one for some in spread(measure_fall, falls) for one in some]
    seen += [one for some in spread(measure_step, steps) for one in some]
    seen += [one for some in spread(measure_touches, [case._replace(configured=case.true) for case in hands]) for one in some]
    fallen = [one for one in seen if one.what in FALLS]
    stepped = [one for one in seen if one.what.startswith("step")]
    for how in FALLS:
        score(report, f"payload falls, {how}", [one for one in fallen if one.what == how])
    score(report, "payload of less than 1 kg falls", [one for one in fallen if one.mass < 1.0])
    for how in STEPS:
        some = [one for one in stepped if one.what == f"step {how}"]
        report.share(f"sensor steps, {how}: suspected by the observer", sum(one.told < math.inf for one in some), len(some))
    late = [2.0 * one.told for one in stepped if one.told < math.inf]
    if late:
        report.row("sensor steps: observer suspects after, longest", max(late), "ms", n=len(late))
    touches = [one for one in seen if one.what == "touch"]
    away(report, "before a fall or a step", [one for one in seen if one.what == "before"])
    away(report, "grab or let-go", touches)
    classes = (fallen, stepped, touches)
    for low, high in itertools.pairwise(LEVELS):
        reliability(report, "a fall", (low, high), [[one.odds for one in some] for some in classes], true=0)
        reliability(report, "a step", (low, high), [[one.stepped for one in some] for some in classes], true=1)


def score(report: Report, what: str, some: list[Seen]) -> None:
    """How many of these falls are known, and how soon."""
    n = len(some)
    report.share(f"{what}: known to the observer", sum(one.known < math.inf for one in some), n)
    late = [2.0 * one.known for one in some if one.known < math.inf]
    if late:
        report.row(f"{what}: observer knows after, longest", max(late), "ms", n=len(late))


def away(report: Report, what: str, some: list[Seen]) -> None:
    """How many of these are taken for a fall, and for a step."""
    n = len(some)
    report.share(f"{what}: taken for a fall by the observer", sum(one.known < math.inf for one in some), n)
    report.share(f"{what}: suspected to be a step by the observer", sum(one.told < math.inf for one in some), n)
    if some:
        report.row(f"{what}: log of the odds of a fall, largest", max(one.odds for one in some), "nats", n=n)
        report.row(f"{what}: log of the odds of a step, largest", max(one.stepped for one in some), "nats", n=n)


def reliability(report: Report, what: str, level: tuple[float, float], odds: list[list[float]], *, true: int) -> None:
    """Of what is told with this probability, as much is true; falls, steps and touches are made equally frequent.

    Args:
        report: gets the row.
        what: is told.
        level: the probability.
        odds: of it, in the cases of each class.
        true: which class it is.
    """
    low, high = (math.log(p / (1.0 - p)) if p < 1.0 else math.inf for p in level)
    told = [sum(max(low, SOME) <= one < high for one in some) for some in odds]
    shares = [hits / max(len(some), 1) for hits, some in zip(told, odds, strict=True)]
    share = shares[true] / sum(shares) if sum(shares) > 0.0 else "no case"
    name = f"{what} is told with {100.0 * level[0]:g} to {100.0 * level[1]:g} %: it is one"
    report.row(name, share, n=sum(told), at_least=HONEST if level[1] == 1.0 else None)


if __name__ == "__main__":
    main("observer", measure)
