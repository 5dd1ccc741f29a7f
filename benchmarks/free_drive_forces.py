"""Free-drive: what a hand needs to lead, turn, start and stop an arm, with and without friction taken off.

Random postures (`benchmarks.postures`), mismatch on, 1 kg of payload configured right. A virtual hand (spring and damper) leads
the flange at 0.1 m/s along six directions, turns it at 0.3 rad/s, pushes the elbow, starts it from rest, and lets go. Each begins
in the posture as drawn, free-drive just entered: an arm that was pushed about stands elsewhere, often next to a singularity.
Besides, one long free-drive is measured: the arm is led and turned along all directions, pushed at the elbow, and let go. Truth
is read for scoring alone.

Another arm has the same bars, but for what its own numbers ask (`benchmarks.arms`): one that rubs more may be harder to lead and
to turn, and without a flange sensor a hand has to be more than the joints may miss. Such an arm stops where the payload's fall
would explain what its joints feel, as well as its gears are known; these ends are counted by themselves.
"""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from benchmarks.arms import LEVER, missed, rubs, senses
from benchmarks.common import NO_CASE, Report, main, spread
from benchmarks.controls.leading_hand import PACE, TURN, Array, Case, Hand, directions, elbow_directions

STAYED, ENDED, FALL = 0.0, np.nan, np.inf  # free-drive; FALL: ended as the joints felt what a payload that fell makes them feel
HUM = 0.005  # joint speed that counts as a limit cycle [rad/s]; a tenth of a millimetre at 10 Hz


class Result(NamedTuple):
    """What the hand needed in one posture."""

    entered: bool
    forces: dict[str, list[float]]  # of `PUSHES`, a value a direction [N], [N·m]; `ENDED` or `FALL` where free-drive ended
    rest: float = 0.0  # time to rest after letting go [s]
    drift: float = 0.0  # hands off [mm]
    long: tuple[float, float, float] = (0.0, 0.0, 0.0)  # one long free-drive: `STAYED`, `ENDED` or `FALL`; rest [s], drift [mm]
    last: float = 0.0  # speed of the fastest joint in the last second of that, RMS [rad/s]
    hum: float = 0.0  # RMS of a joint's speed about its mean while a hand holds on, still [rad/s]


PUSHES: dict[str, Callable[[Hand, Array], float]] = {
    "lead": Hand.lead,
    "turn": Hand.turn,
    "elbow": lambda hand, direction: hand.lead(direction, "elbow"),
    "breakaway": Hand.breakaway,
}


def ways(name: str, hand: Hand) -> Array:
    """Directions (k, 3) of one of `PUSHES`, from where the arm is now."""
    return elbow_directions(hand) if name == "elbow" else directions()


def measure_case(case: Case) -> tuple[Result, int]:
    """All figures of one posture, and how many postures were thrown away before it."""
    hand = Hand(case)
    forces: dict[str, list[float]] = {name: [] for name in PUSHES}
    if not hand.entered:
        return Result(False, forces), hand.thrown
    for name, push in PUSHES.items() if not case.over else ():
        for direction in ways(name, hand):
            fresh = Hand(case)
            force = push(fresh, direction)
            forces[name].append(force if fresh.free else FALL if fresh.fall else ENDED)
    result = Result(hand.entered, forces)
    if not case.helped:
        return result, hand.thrown
    rest, drift, last = hand.let_go(directions()[case.number % 6], case.rest)
    result = result._replace(rest=rest, drift=drift, last=last, hum=hand.hum())
    return (result if case.over else result._replace(long=long_free_drive(case))), hand.thrown


def long_free_drive(case: Case) -> tuple[float, float, float]:
    """Led, turned, pushed at the elbow, let go: how free-drive ended; rest [s], drift [mm]."""
    hand = Hand(case)
    for name in ("lead", "turn", "elbow"):
        for direction in ways(name, hand):
            PUSHES[name](hand, direction)
    how = STAYED if hand.free else FALL if hand.fall else ENDED
    rest, drift, _ = hand.let_go(directions()[case.number % 6], case.rest)
    return how, rest, drift


FORCES = (
    ("lead", "force to keep 0.1 m/s", "N", 12.0),
    ("turn", "torque to keep turning at 0.3 rad/s", "N·m", 2.0),
    ("elbow", "force at the elbow to keep 0.1 m/s", "N", 30.0),
    ("breakaway", "force that starts it from rest", "N", 15.0),
)


def allowed(name: str, usual: float, arm: str) -> float:
    """What one of `FORCES` may be at most, on an arm [N], [N·m]. A torque at the flange is felt by joints in full."""
    if name == "turn":
        return usual * rubs(arm, "wrist", TURN) + missed(arm)
    return usual * rubs(arm, "elbow" if name == "elbow" else "flange", PACE) + missed(arm) / LEVER


def report_ends(report: Report, what: str, values: Array) -> None:
    """Rows of how many of them ended."""
    report.share(f"{what} ended meanwhile", int(np.isnan(values).sum()), values.size, at_most=0.0)
    if not senses(report.options.arm):
        report.share(f"{what} ended as if the payload fell", int(np.isinf(values).sum()), values.size)


def measure(report: Report) -> None:
    """Fill the report."""
    count, seed, arm = (50 if report.options.full else 6), report.options.seed, report.options.arm
    cases = [Case(k, seed, helped=on, arm=arm) for on in (True, False) for k in range(count)]
    cases += [Case(k, seed, over=True, rest=10.0 if report.options.full else 4.0, arm=arm) for k in range(count)]
    rows = spread(measure_case, cases)
    helped, plain = [row for row, _ in rows[:count]], [row for row, _ in rows[count : 2 * count]]
    thrown = sum(number for _, number in rows[:count])
    report.share("postures near a singularity thrown away", thrown, thrown + count, at_most=0.15)
    # A right payload's acceptance has its bar in the payload bench; a posture that was refused has no forces.
    report.share("refused at entry", sum(not row.entered for row in helped), count)
    helped, plain = [row for row in helped if row.entered], [row for row in plain if row.entered]
    for name, what, unit, usual in FORCES:
        bar = allowed(name, usual, arm)
        values, others = (np.concatenate([row.forces[name] for row in side]) for side in (helped, plain))
        report_ends(report, f"{what}: free-drive", values)
        values, others = values[np.isfinite(values)], others[np.isfinite(others)]
        if not (values.size and others.size):
            report.row(f"{what}, p95", NO_CASE, unit, at_most=bar, n=0)
            continue
        report.row(f"{what}, p95", p95 := float(np.percentile(values, 95)), unit, at_most=bar, n=values.size)
        for part, value in (("median", np.median(values)), ("largest", values.max())):
            report.row(f"{what}, {part}", float(value), unit, n=values.size)
        report.row(f"{what}, p95 without compensation", float(np.percentile(others, 95)), unit, n=others.size)
        times = float(np.percentile(others, 95)) / p95
        report.row(f"{what}, without over with compensation", times, "times", at_least=1.0, n=values.size)
    n = len(helped)
    report.row("rest after letting go, worst", max(row.rest for row in helped), "s", at_most=0.3, n=n)
    report.row("drift hands off, 10 s, worst", max(row.drift for row in helped), "mm", at_most=2.0, n=n)
    report.row("speed while a hand holds on, RMS, worst", max(row.hum for row in helped), "rad/s", at_most=HUM, n=n)
    long = np.array([row.long for row in helped])
    report_ends(report, "a long free-drive:", long[:, 0])
    stayed = long[long[:, 0] == STAYED].tolist()
    n = len(stayed)
    for k, what, unit, bar in ((1, "rest after it", "s", 0.3), (2, "drift after it, hands off", "mm", 2.0)):
        worst = max((each[k] for each in stayed), default=NO_CASE)
        report.row(f"a long free-drive: {what}, worst", worst, unit, at_most=bar, n=n)
    over = [row for row, _ in rows[2 * count :] if row.entered]
    n = len(over)
    what = "20 % too much: fastest joint long after letting go, worst"
    report.row(what, max(row.last for row in over), "rad/s", at_most=HUM, n=n)
    what = "20 % too much: speed while a hand holds on, RMS, worst"
    report.row(what, max(row.hum for row in over), "rad/s", at_most=HUM, n=n)
    report.row("20 % too much: drift hands off, worst", max(row.drift for row in over), "mm", n=n)


if __name__ == "__main__":
    main("free_drive_forces", measure)
