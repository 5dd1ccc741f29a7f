"""Hands on links: a hand of 60 to 300 N pushes elbow or forearm, of a held arm and of one at work, holds and lets go.

It is reported within 100 ms of its begin, once, and once as it goes, at the part that it was reported at, and nowhere else. The
hand pushes across the link, over its outer third, in a direction that turns at least one joint with a lever of 0.2 m. Truth is
read for scoring alone.
"""

import numpy as np

from benchmarks.arms import USUAL, load
from benchmarks.common import Report, main, spread
from benchmarks.contacts.hands import LATEST, LinkHands, LinkTouch, forces, hands

MOST = 10.0  # [kg] that hang on an arm, where it bears so much
BESIDE = ("ur10e", "ur16e")
"""Arms that are looked at beside the usual one, without a bar."""
PUSHES = 4  # a case


def measure(report: Report) -> None:
    """Fill the report."""
    full, seed, arm = report.options.full, report.options.seed, report.options.arm
    rounds = {arm: 88 if full else 6}
    if arm == USUAL:
        rounds |= dict.fromkeys(BESIDE, 10 if full else 1)
    cases = [
        LinkHands(each, share * min(MOST, load(each).payload), soft, moving, seed + k, PUSHES)
        for each, count in rounds.items()
        for k in range(count)
        for share, soft, moving in ((0.0, False, False), (0.4, True, True), (1.0, False, k % 2 == 1))
    ]
    touches = [touch for some in spread(hands, cases) for touch in some]
    first = [touch for touch in touches if touch.case.arm == arm]
    _rows(report, arm, first, bar=True)
    for moving in (False, True):
        _rows(report, f"{arm}, at work" if moving else f"{arm}, held", [touch for touch in first if touch.case.moving is moving])
    for force in forces(arm):
        _rows(report, f"{arm}, {force:g} N", [touch for touch in first if touch.force == force])
    for each in list(rounds)[1:]:
        _rows(report, each, [touch for touch in touches if touch.case.arm == each])
    report.notes += [touch.story for touch in touches if _wrong(touch)][:60]


def _wrong(touch: LinkTouch) -> bool:
    return touch.delay > 1000.0 * LATEST or not touch.once or not touch.lost or touch.elsewhere > 0 or touch.right is False


def _rows(report: Report, what: str, touches: list[LinkTouch], bar: bool = False) -> None:
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
