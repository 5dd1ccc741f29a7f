"""Hands on links: a hand of 60 to 300 N pushes elbow or forearm, of a held arm and of one at work, holds and lets go.

It is reported within 100 ms of its begin, once, and once as it goes, at the part that it was reported at, and nowhere else. The
hand pushes across the link, over its outer third, in a direction that turns at least one joint with a lever of 0.2 m. Truth is
read for scoring alone.
"""

import numpy as np

from benchmarks.common import Report, main, spread
from benchmarks.contacts.hands import LATEST, Hands, Touch, hands

ARMS = {"ur5e": 5.0, "ur10e": 10.0, "ur16e": 10.0}
"""The arms, each with the largest payload of this bench [kg]. A UR3e cannot withstand such hands: its shoulder holds 54 N·m."""
FORCES = (60.0, 80.0, 120.0, 200.0, 300.0)
PUSHES = 4  # a case


def measure(report: Report) -> None:
    """Fill the report."""
    full, seed = report.options.full, report.options.seed
    rounds = {"ur5e": 88 if full else 6, "ur10e": 10 if full else 1, "ur16e": 10 if full else 1}
    cases = [
        Hands(arm, share * most, soft, moving, seed + k, PUSHES)
        for arm, most in ARMS.items()
        for k in range(rounds[arm])
        for share, soft, moving in ((0.0, False, False), (0.4, True, True), (1.0, False, k % 2 == 1))
    ]
    touches = [touch for some in spread(hands, cases) for touch in some]
    first = [touch for touch in touches if touch.case.arm == "ur5e"]
    _rows(report, "ur5e", first, bar=True)
    for moving in (False, True):
        _rows(report, "ur5e, at work" if moving else "ur5e, held", [touch for touch in first if touch.case.moving is moving])
    for force in FORCES:
        _rows(report, f"ur5e, {force:g} N", [touch for touch in first if touch.force == force])
    for arm in list(ARMS)[1:]:
        _rows(report, arm, [touch for touch in touches if touch.case.arm == arm])
    report.notes += [touch.story for touch in touches if _wrong(touch)][:60]


def _wrong(touch: Touch) -> bool:
    return touch.delay > 1000.0 * LATEST or not touch.once or not touch.lost or touch.elsewhere > 0 or touch.right is False


def _rows(report: Report, what: str, touches: list[Touch], bar: bool = False) -> None:
    late = sum(touch.delay <= 1000.0 * LATEST for touch in touches)
    report.share(f"{what}: reported within 100 ms", late, len(touches), at_least=0.99 if bar else None)
    delays = sorted(touch.delay for touch in touches)
    report.row(f"{what}: delay p50", float(np.median(delays)), "ms", n=len(touches))
    report.row(f"{what}: delay p99", delays[min(len(delays) - 1, int(0.99 * len(delays)))], "ms", n=len(touches))
    report.share(f"{what}: one onset, one release", sum(touch.once for touch in touches), len(touches))
    lost = sum(touch.lost and touch.elsewhere == 0 for touch in touches)
    report.share(f"{what}: lost where it was gained, nothing elsewhere", lost, len(touches), at_least=0.99 if bar else None)
    told = [touch.right for touch in touches if touch.right is not None]
    report.share(f"{what}: the right link", sum(told), len(told), at_least=0.97 if bar else None)


if __name__ == "__main__":
    main("link_hands", measure)
