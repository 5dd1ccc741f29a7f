"""What is mended of a log, and told: order, gaps, units, missing speeds. What cannot be is refused in one line."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from app.files.bad_input import ABSENT, BadInput
from app.real_logs.joint_log import JointLog, counted
from sim.arm.arm_file import Arm

Array = NDArray[np.float64]

SLOWEST, FASTEST = 50.0, 1000.0
"""Rows a second that a log may have."""
RATE_SLACK = 1.1
"""Clocks of recorders are not exact, and rows get lost."""
GAP = 5.0
"""Times the usual distance of two rows: from here on nothing is derived across it. The longest below it is 0.1 s at 50 Hz."""
SHORTEST = 2.0
"""Of a log of which something can be told [s]."""
IMPOSSIBLE = {"t": np.inf, "q": 1e4, "qd": 1e4, "current": 1e6, "torque": 1e6, "theta": 1e4, "guided": 2.0}
"""What no arm has in any unit: a packet that was read from the wrong byte."""
UNUSABLE = 0.2
"""Largest share of rows that may lack a number."""
MOVES = 0.02
"""A joint whose angles differ by less has not moved [rad]."""
MOST_TORQUE = 2.0
"""Of the rated torque: friction and short peaks come on top of it."""
FITS = 0.2
"""Angles over time and speeds may differ so much, as one slope, before one of the units is wrong: lag and noise are less."""
SCALES = {
    "angles are degrees": ("q", np.pi / 180.0),
    "speeds are degrees a second": ("qd", np.pi / 180.0),
    "times are milliseconds": ("t", 1e-3),
    "times are microseconds": ("t", 1e-6),
    "times are nanoseconds": ("t", 1e-9),
}


def mend(name: str, columns: dict[str, Array], arm: Arm, told: list[str], *, given: frozenset[str] = frozenset()) -> JointLog:
    """A log as one value, of columns as they were read.

    Args:
        name: of the file.
        columns: of each quantity (k, width), NaN where there is no number; with t, q, and current or torque.
        arm: the arm.
        told: what was mended before.
        given: quantities whose unit the user has named, which is not asked again.

    Raises:
        BadInput: something is missing, or the numbers do not make sense.
    """
    for needed, words in (("t", "times"), ("q", "joint angles")):
        if needed not in columns:
            raise BadInput(name, "", ABSENT, f"has no column of {words} ({needed})")
    if "current" not in columns and "torque" not in columns:
        raise BadInput(name, "", ABSENT, "has no motor currents and no torques: nothing can be held against the model")
    told = list(told)
    columns = _rows(name, columns, told)
    columns = _in_order(columns, told)
    if len(columns["t"]) < 10:
        raise BadInput(name, "", ABSENT, f"has {counted(len(columns['t']), 'row')}; expected {SHORTEST:g} s of motion or more")
    columns["t"] = columns["t"][:, 0]
    _scale(name, columns, arm, told, given=given)
    t = columns["t"] = columns["t"] - columns["t"][0]
    rate = 1.0 / float(np.median(np.diff(t)))
    if not SLOWEST / RATE_SLACK <= rate <= FASTEST * RATE_SLACK:
        raise BadInput(name, "", ABSENT, f"has {rate:.3g} rows a second; expected {SLOWEST:g} to {FASTEST:g}")
    starts = _gaps(t, rate, told)
    if "qd" not in columns:
        columns["qd"] = _slopes(t, columns["q"], starts)
        told.append("it has no speeds: they are derived from the angles, and are noisier")
    log = JointLog(
        name,
        t,
        columns["q"],
        columns["qd"],
        columns.get("current"),
        columns.get("torque"),
        columns.get("wrench"),
        columns.get("temperature"),
        columns.get("theta"),
        None if "guided" not in columns else columns["guided"][:, 0] > 0.0,
        starts,
        (),
    )
    if log.seconds < SHORTEST:
        raise BadInput(name, "", ABSENT, f"is {log.seconds:.2f} s long; expected {SHORTEST:g} s or more")
    _refuse_impossible(log, arm)
    still = [joint for joint, width in zip(arm.chain.joints, np.ptp(log.q, axis=0), strict=True) if width < MOVES]
    if len(still) == arm.n:
        told.append("no joint moved: nothing is told of friction and inertia")
    elif still:
        told.append(f"{', '.join(still)} did not move: nothing is told of the friction there")
    return replace(log, told=tuple(told))


def _rows(name: str, columns: dict[str, Array], told: list[str]) -> dict[str, Array]:
    """The rows that have all numbers; a wrench or temperature alone may lack some."""
    count = len(columns["t"])
    needed = [
        (np.abs(each) < IMPOSSIBLE[what]).all(axis=1) for what, each in columns.items() if what not in ("wrench", "temperature")
    ]
    good = np.logical_and.reduce(needed)
    lost = count - int(good.sum())
    if lost > UNUSABLE * count:
        empty = [what for what, each in columns.items() if not np.isfinite(each).any(axis=0).all()]  # at least one column of it
        why = f"a column of {', '.join(empty)} is empty" if empty else "expected numbers in every row"
        raise BadInput(name, "", ABSENT, f"{lost} of {count} rows lack a number: {why}")
    if lost:
        told.append(f"{counted(lost, 'row')} without a number left out")
        columns = {what: each[good] for what, each in columns.items()}
    return dict(columns)


def _in_order(columns: dict[str, Array], told: list[str]) -> dict[str, Array]:
    t = columns["t"][:, 0]
    back = int((np.diff(t) < 0).sum())
    if back:
        order = np.argsort(t, kind="stable")
        columns = {what: each[order] for what, each in columns.items()}
        told.append(f"times went back {counted(back, 'time')}: rows are sorted")
        t = columns["t"][:, 0]
    fresh = np.diff(t, prepend=-np.inf) > 0
    if not fresh.all():
        told.append(f"{counted(int((~fresh).sum()), 'row')} of the same time as the one before left out")
        columns = {what: each[fresh] for what, each in columns.items()}
    return columns


def _scale(name: str, columns: dict[str, Array], arm: Arm, told: list[str], *, given: frozenset[str]) -> None:
    """Units: the rate tells that of the times, the ranges those of angles and currents, and both that of the speeds."""
    t, q = columns["t"], columns["q"]
    if "t" not in given:
        step = float(np.median(np.diff(t)))
        for words, (what, factor) in SCALES.items():
            if what == "t" and SLOWEST / RATE_SLACK <= 1.0 / (step * factor) <= RATE_SLACK * FASTEST:
                columns["t"] = t * factor
                told.append(f"{words}, by their distance")
                break
    if "q" not in given and float(np.abs(q).max()) > 2.0 * max(arm.limits.farthest):
        columns["q"] = q * (np.pi / 180.0)
        told.append("angles are degrees, by their range")
    if (
        "current" in columns
        and "current" not in given
        and float(np.median(np.abs(columns["current"]).max(axis=1))) > 10.0 * max(arm.motors.current)
    ):
        columns["current"] = columns["current"] * 1e-3
        told.append("currents are milliamperes, by their range")
    if "qd" in columns:
        _match_speeds(name, columns, told, given)


def _match_speeds(name: str, columns: dict[str, Array], told: list[str], given: frozenset[str]) -> None:
    """Hold the speeds against the angles over time: slope of one over the other, of all joints that move."""
    slope = _slope(columns)
    if slope is None or abs(slope - 1.0) < FITS:
        return
    for words, (what, factor) in SCALES.items():
        if what == "t" or what in given:
            continue
        # Were the angles degrees, they would rise 57 times as fast as the speeds say.
        if abs(slope * (factor if what == "q" else 1.0 / factor) - 1.0) < FITS:
            columns[what] = columns[what] * factor
            told.append(f"{words}, by angles and speeds together")
            return
    raise BadInput(name, "qd", ABSENT, f"the angles change {slope:.3g} times as fast as the speeds say: a unit is wrong")


def _slope(columns: dict[str, Array]) -> float | None:
    """Change of the angles over that of the speeds' sum; None: nothing moves."""
    t, q, qd = columns["t"], columns["q"], columns["qd"]
    if not np.ptp(q, axis=0).max() > MOVES:
        return None
    step = np.diff(t)
    usual = step < GAP * np.median(step)
    product = power = 0.0
    for i in range(q.shape[1]):  # joint by joint: an hour is not to be there five times
        said = (0.5 * (qd[1:, i] + qd[:-1, i]) * step)[usual]
        product += float(said @ np.diff(q[:, i])[usual])
        power += float(said @ said)
    return product / power if power > 0.0 else np.inf


def _gaps(t: Array, rate: float, told: list[str]) -> tuple[int, ...]:
    step = np.diff(t)
    at = np.flatnonzero(step > GAP / rate)
    if at.size:
        longest = int(at[step[at].argmax()])
        told.append(
            f"{counted(at.size, 'gap')}, the longest of {step[longest]:.2f} s at {t[longest]:.2f} s: nothing is derived across"
        )
    return (0, *(int(k) + 1 for k in at))


def _slopes(t: Array, q: Array, starts: tuple[int, ...]) -> Array:
    out = np.zeros_like(q)
    for a, b in zip(starts, (*starts[1:], len(t)), strict=True):
        if b - a > 2:
            out[a:b] = np.gradient(q[a:b], t[a:b], axis=0)
    return out


def _refuse_impossible(log: JointLog, arm: Arm) -> None:
    """Numbers that no such arm can have."""
    for what, values, limits in (("q", log.q, arm.limits.farthest), ("qd", log.qd, arm.limits.speed)):
        most, allowed = _most(values), 1.5 * np.array(limits)
        wrong = int((most / allowed).argmax())
        if most[wrong] > allowed[wrong]:
            unit = "rad" if what == "q" else "rad/s"
            raise BadInput(
                log.name,
                f"{what} of {arm.chain.joints[wrong]}",
                f"{most[wrong]:.4g} {unit}",
                f"the {arm.name} has {limits[wrong]:.4g}: another arm, or another unit",
            )
    torque = _most(log.motor_torque(arm)) / np.array(arm.limits.torque)
    wrong = int(torque.argmax())
    if torque[wrong] > MOST_TORQUE:
        what = "current" if log.torque is None else "torque"
        raise BadInput(
            log.name,
            f"{what} of {arm.chain.joints[wrong]}",
            f"{torque[wrong]:.3g} times the rated torque",
            f"the {arm.name} cannot: another arm, another unit, or another order of columns",
        )


def _most(values: Array) -> Array:
    """Largest size of each column (n,), but for a thousandth that may be glitches."""
    return np.array([np.quantile(np.abs(values[:, i]), 0.999) for i in range(values.shape[1])])
