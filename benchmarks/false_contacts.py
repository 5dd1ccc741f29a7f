"""False contacts: free motion over all combinations of payload, stiff and soft flange sensor, and arm; all sources are on.

Random programs at full speed, payloads up to 20 % wrong and off the axis, friction, warmth and drift of the sensor that change.
Nothing is touched, so whatever is reported is false. In full size 5 hours a seed base.
"""

from benchmarks.common import Report, main, spread
from benchmarks.contacts.motion import Free
from benchmarks.contacts.scores import quiet

ARMS = {"ur5e": (0.0, 2.0, 5.0), "ur3e": (0.0, 2.0, 3.0), "ur10e": (0.0, 2.0, 5.0), "ur16e": (0.0, 2.0, 5.0)}
"""The arms, each with its payloads; a UR3e carries no more than 3 kg [kg]."""
FULL, QUICK = 750.0, 25.0  # of each combination [s]


def measure(report: Report) -> None:
    """Fill the report."""
    seconds = FULL if report.options.full else QUICK
    combinations = [(arm, mass, soft) for arm, masses in ARMS.items() for mass in masses for soft in (False, True)]
    cases = [
        Free(report.options.seed + k, seconds, False, arm=arm, mass=mass, soft=soft)
        for k, (arm, mass, soft) in enumerate(combinations)
    ]
    runs = spread(quiet, cases)
    for arm in ARMS:
        found = [event for case, events, _ in runs for event in events if case.arm == arm]
        report.row(f"{arm}: false contacts", len(found), "", at_most=0, n=len([1 for case, *_ in runs if case.arm == arm]))
    report.notes.append(f"{len(runs) * seconds / 3600:.2f} h of free motion")
    stories = [f"{case.arm} {case.mass:g} kg soft={case.soft} seed {case.seed}: {e}" for case, events, _ in runs for e in events]
    report.notes += stories[:60]


if __name__ == "__main__":
    main("false_contacts", measure)
