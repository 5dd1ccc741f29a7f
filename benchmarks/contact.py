"""Change in contact: delay, force, kind and pose per stiffness and speed; silence in free motion; each rule; baselines.

Every approach starts with free motion, with sensor noise, latency, quantisation and averaging on and a payload that is up to
20 % wrong. Delays count from the true onset to the beginning of the tick in which the decision acts; an alarm before the
onset is a miss. Baselines get thresholds without any alarm on tuning motion. Truth is read for scoring alone.
"""

import math
from collections import defaultdict

import numpy as np

from benchmarks.common import Report, main, spread
from benchmarks.contacts import baselines
from benchmarks.contacts.approaches import REST, Approach
from benchmarks.contacts.motion import Free
from benchmarks.contacts.recording import TICK
from benchmarks.contacts.scores import RULES, Outcome, cost, delay_of, quiet, react, score, sweep

BARS = {  # p95 of the combination [ms] by stiffness [N/m] and speed [m/s]; None: information
    2e5: {0.25: 7.0, 0.1: 8.0, 0.02: 12.0, 0.005: 25.0},
    1e4: {0.25: 15.0, 0.1: 20.0, 0.02: 60.0, 0.005: 160.0},
    1e3: {0.25: 50.0, 0.1: 90.0, 0.02: None},
}
FORCE_BARS = {(1e4, 0.1): 15.0, (1e4, 0.25): 25.0, (1e3, 0.25): 15.0}  # median at detection [N]
HARD = 2e5
POSE_TICKS = 2.0
FAST, PARTS = 0.25, (0.0, 0.25, 0.5, 0.75)
"""At this speed [m/s] a tick is more than half of a median, and where in it a contact begins is chance. So each approach is made
once more for every one of these parts of a tick that the block stands farther away: the onsets cover the tick evenly."""
HOUR = 3600.0  # s: from this much tuning motion on, a baseline's threshold is what the combination is compared with
HAND_TRANSIENT = 280.0  # ISO/TS 15066, hand and fingers, transient contact [N]


def percentile(values: list[float], share: float) -> float:
    """A percentile that a single miss spoils only where it should: the smallest value that `share` of all do not exceed."""
    ordered = sorted(values)
    return ordered[max(0, math.ceil(share * len(ordered)) - 1)]


def measure(report: Report) -> None:
    full, seed = report.options.full, report.options.seed
    seeds = range(seed, seed + (6 if full else 1))
    tuning, scoring, seconds = (30, 50, 120.0) if full else (4, 8, 15.0)  # an hour; five hours over three seed bases
    cases = [
        Approach(stiffness, speed, angle, payload, at, farther=farther)
        for stiffness, row in BARS.items()
        for speed in row
        for angle in (0, 50, 80)
        for payload in (0.0, 2.0, 5.0)
        for at in seeds
        for farther in (PARTS if speed == FAST else PARTS[:1])
    ]
    outcomes = spread(score, cases)
    quiets = spread(quiet, [Free(100 + k, seconds, True) for k in range(tuning)])
    runs = spread(quiet, [Free(seed + k, seconds, False) for k in range(scoring)])
    _delays(report, outcomes)
    _baselines(report, outcomes, baselines.thresholds([baselines.Scores(scores) for _, _, scores in quiets]), tuning * seconds)
    _silence(report, runs, seconds)
    _reactions(
        report,
        [Approach(k, v, a, p, s, "stop") for k in BARS for v in (0.25, 0.1) for a in (0,) for p in (0.0, 5.0) for s in seeds],
    )
    _links(report, [Approach(k, v, part, 2.0, s) for k in (1e4, 2e5) for v in (0.25, 0.1) for part in (0, 1) for s in seeds])
    report.row("detector, three rules on one source: cost a tick", cost(outcomes[0].case), "µs", at_most=20.0)


def _delays(report: Report, outcomes: list[Outcome]) -> None:
    """Delay, force and kind, cell by cell; each rule alone."""
    for stiffness, speeds in BARS.items():
        for speed, bar in speeds.items():
            mine = [o for o in outcomes if (o.case.stiffness, o.case.speed) == (stiffness, speed)]
            where = f"{stiffness:g} N/m at {1000 * speed:g} mm/s"
            delays = [o.delay for o in mine]
            report.row(f"{where}: delay p50", percentile(delays, 0.5), "ms", n=len(mine))
            report.row(f"{where}: delay p95", percentile(delays, 0.95), "ms", at_most=bar, n=len(mine))
            report.row(f"{where}: delay max", max(delays), "ms", n=len(mine))
            missed = sum(math.isinf(value) for value in delays)
            report.share(f"{where}: missed", missed, len(mine), at_most=0.0 if bar else None)
            report.row(
                f"{where}: force at detection, median",
                float(np.nanmedian([o.force for o in mine])),
                "N",
                at_most=FORCE_BARS.get((stiffness, speed)),
                n=len(mine),
            )
            for name in RULES:
                value = percentile([o.rules[name.value] for o in mine], 0.5)
                report.row(f"{where}: rule {name} alone, p50", value, "ms", n=len(mine))
            for key in ("payload", "angle", "reach"):
                groups: dict[float | str, list[float]] = defaultdict(list)
                for o in mine:
                    groups[o.reach if key == "reach" else getattr(o.case, key)].append(o.delay)
                text = ", ".join(f"{value}: {percentile(group, 0.5):.1f}" for value, group in sorted(groups.items(), key=str))
                report.row(f"{where}: p50 by {key}", text, "ms", n=len(mine))
    barred = [o for o in outcomes if BARS[o.case.stiffness][o.case.speed] is not None]
    report.share("right kind", sum(o.kind_right for o in barred), len(barred), at_least=0.98)
    hard = [o.pose / (1000.0 * o.case.speed * TICK) for o in outcomes if o.case.stiffness == HARD and o.case.speed >= 0.02]
    what = "pose at contact, hard, 20 mm/s and up: p95 in ticks of travel"
    report.row(what, percentile(hard, 0.95), "", at_most=POSE_TICKS, n=len(hard))


def _baselines(report: Report, outcomes: list[Outcome], thresholds: dict[str, np.ndarray], seconds: float) -> None:
    """The best setting of each baseline in each cell against the combination.

    In less tuning motion than an hour there is less that a baseline must not take for a contact: lower thresholds, and no bar.
    """
    report.notes.append(f"baselines: thresholds without an alarm in {seconds / 3600:.2f} h of tuning motion")
    families = ("force threshold", "CUSUM", "momentum observer")
    for stiffness, speeds in BARS.items():
        for speed in speeds:
            mine = [o for o in outcomes if (o.case.stiffness, o.case.speed) == (stiffness, speed)]
            own = percentile([o.delay for o in mine], 0.5)
            for family in families:
                best, best_name, missed = math.inf, "none finds half of them", 1.0
                for name in (name for name in thresholds if name.startswith(family)):
                    delays = []
                    for o in mine:
                        row = baselines.alarm(o.scores[name], thresholds[name], o.rows)
                        delays.append(delay_of([] if row is None else [float(o.times[row])]))
                    if percentile(delays, 0.5) < best:
                        best, best_name = percentile(delays, 0.5), name
                        missed = sum(math.isinf(value) for value in delays) / len(delays)
                where = f"{stiffness:g} N/m at {1000 * speed:g} mm/s"
                report.row(f"{where}: {family}, best p50", best, "ms", n=len(mine))
                report.notes.append(f"{where}: {best_name}, missed {100 * missed:.0f} %")
                bar = 0.5 if family == "momentum observer" else 1.0
                share = own / best if math.isfinite(best) else 0.0
                at_most = bar if seconds >= HOUR else None
                report.row(f"{where}: own p50 over that of {family}", share, "", at_most=at_most, n=len(mine))


def _silence(report: Report, runs: list[tuple[Free, list[str], dict[str, np.ndarray]]], seconds: float) -> None:
    alarms = [f"seed {case.seed}: {event}" for case, events, _ in runs for event in events]
    report.row("false alarms in free motion, all sources", len(alarms), "", at_most=0, n=len(runs))
    report.notes.append(f"{len(runs) * seconds / 3600:.3f} h of free motion")
    report.notes += alarms[:20]


def _reactions(report: Report, cases: list[Approach]) -> None:
    """Peak force and impulse with the stop action; where `contact_pose` ends."""
    stops = spread(react, cases)
    for stiffness in BARS:
        for speed in (0.25, 0.1):
            mine = [s for s in stops if (s.case.stiffness, s.case.speed) == (stiffness, speed)]
            where = f"{stiffness:g} N/m at {1000 * speed:g} mm/s, stop"
            peak = max(s.peak for s in mine)
            report.row(f"{where}: peak force, worst", peak, "N", n=len(mine))
            if peak > HAND_TRANSIENT:
                report.notes.append(f"{where}: beyond {HAND_TRANSIENT:g} N (hand, transient)")
            report.row(f"{where}: impulse in 0.5 s, worst", max(s.impulse for s in mine), "N·s", n=len(mine))
    back = spread(react, [case._replace(react="contact_pose") for case in cases if case.stiffness == HARD])
    where = "hard contacts: back to the contact pose"
    report.row(f"{where}, 0.5 s after the program's end, worst", max(s.early for s in back), "mm", n=len(back))
    report.row(f"{where}, at rest ({REST:g} s), worst", max(s.end for s in back), "mm", at_most=0.5, n=len(back))


def _links(report: Report, cases: list[Approach]) -> None:
    """Contacts of elbow and forearm, which the flange sensor cannot see."""
    results = spread(sweep, cases)
    for part, name in enumerate(("elbow", "forearm")):
        for stiffness in (1e4, 2e5):
            for speed in (0.25, 0.1):
                mine = [r for r in results if (r[0].angle, r[0].stiffness, r[0].speed) == (part, stiffness, speed)]
                where = f"{name}, {stiffness:g} N/m at {1000 * speed:g} mm/s"
                report.row(f"{where}: delay p50", percentile([r[1] for r in mine], 0.5), "ms", n=len(mine))
                force = float(np.nanmedian([r[2] for r in mine]))
                report.row(f"{where}: force at detection, median", force, "N", n=len(mine))
                report.share(f"{where}: missed", sum(math.isinf(r[1]) for r in mine), len(mine), at_most=0.0)
    report.share("links: seen by the joints first", sum(r[3] for r in results), len(results))


if __name__ == "__main__":
    main("contact", measure)
