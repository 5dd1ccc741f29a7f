"""Scores of an approach, a reaction, a sweep with a link, and free motion; truth is read here alone."""

import math
import time
from typing import NamedTuple

import msgspec
import numpy as np

from benchmarks.contacts import baselines
from benchmarks.contacts.approaches import REST, Approach, approach, link_contact
from benchmarks.contacts.motion import Free, free
from benchmarks.contacts.recording import TICK, Recording
from pendant.contact.contact_change import Change
from pendant.contact.contact_limits import limits
from pendant.contact.contact_rules import Rule
from pendant.contact.detector import Detector
from pendant.contact.settings import ContactUse
from pendant.tick.modes import Mode

DIED_OUT = 0.3  # true change of acceleration with which a slow contact is rightly called clamping [m/s²]
REACHES = {"beyond 0.6 m": 0.6, "0.4 to 0.6 m": 0.4, "below 0.4 m": 0.0}
"""Classes of postures, by the least distance of the tool from the base's axis [m]."""

RULES = {rule: {other.value: other is rule for other in Rule} for rule in Rule}


class Outcome(NamedTuple):
    """One approach, scored. Delays in ms, infinite for a miss."""

    case: Approach
    delay: float
    force: float  # true, at detection [N]
    kind_right: bool
    pose: float  # way from the pose at contact to the true one, through the same encoders [mm]
    reach: str  # of the posture: the tool's distance from the base's axis at the contact
    rules: dict[str, float]
    scores: dict[str, np.ndarray]
    onset_row: int
    rows: int
    times: np.ndarray  # of each row against the onset [ms]


def truth_of(recording: Recording) -> tuple[int, np.ndarray]:
    """Row whose signals are the first to hold the contact, and times of decisions against the onset [ms]."""
    times = 1000.0 * (np.array(recording.time) - recording.onset)
    # A row's decision sees the tick that ended a tick before it began (the latency), averaged.
    return int(np.searchsorted(times, 0.0)) + 1, times


def _at_onset(recording: Recording, first: int, times: np.ndarray) -> np.ndarray:
    """p_BT (3,) at the true onset, between begin and end of its tick: encoders saw them in the rows `first` - 1 and `first`."""
    begin, end = np.array(recording.tip[first - 1]), np.array(recording.tip[first])
    return end - (end - begin) * times[first - 1] / (1000.0 * TICK)


def delay_of(ticks: list[float]) -> float:
    """Delay of the first alarm [ms]; infinite where there is none, or one before the onset."""
    return ticks[0] if ticks and ticks[0] >= 0.0 else math.inf


def alone(recording: Recording, rule: Rule, times: np.ndarray) -> float:
    """Delay of one rule by itself [ms]."""
    use = msgspec.structs.replace(ContactUse(), **RULES[rule])
    detector = Detector()
    for row, (signal, *_) in enumerate(recording.signals):
        assert signal is not None
        detector.sense(signal)
        limit = limits(
            use, Mode.RUN, mass=signal.mass, effective_mass=signal.effective_mass, speed=recording.speed[row], lever=signal.lever
        )
        if detector.step(use, limit) is not None:
            return delay_of([float(times[row])])
    return math.inf


def score(case: Approach) -> Outcome:
    """Run and score one approach."""
    recording = approach(case)
    first, times = truth_of(recording)
    found = [(1000.0 * (at - recording.onset), contact) for at, contact in recording.contacts if contact.part == "tool"]
    delay = delay_of([at for at, _ in found])
    force, right, pose = math.nan, False, math.nan
    x, y, _ = recording.tip[first - 1]
    reach = next(name for name, least in REACHES.items() if math.hypot(x, y) >= least)
    if math.isfinite(delay):
        row = int(np.argmin(np.abs(times - delay)))
        contact = found[0][1]
        force = recording.force[row - 1]
        a = np.array(recording.acceleration)
        gone = float(np.linalg.norm(a[row - 10 : row].mean(axis=0) - a[max(0, first - 22) : first - 2].mean(axis=0)))
        right = contact.change is Change.GAINED or (contact.change is Change.CLAMPING and gone < DIED_OUT)
        pose = 1000.0 * math.dist(contact.pose.p_BT, _at_onset(recording, first, times))
    return Outcome(
        case,
        delay,
        force,
        right,
        pose,
        reach,
        {rule.value: alone(recording, rule, times) for rule in Rule},
        baselines.scores(recording).by_name,
        first,
        len(times),
        times,
    )


class Stop(NamedTuple):
    """One approach whose program stops at the contact."""

    case: Approach
    peak: float  # true force [N]
    impulse: float  # true force over the first 0.5 s [N·s]
    early: float  # from the contact pose to the place half a second after the program's end [mm]
    end: float  # to where `contact_pose` has come to rest [mm]


def react(case: Approach) -> Stop:
    """Run one approach with its program's reaction."""
    recording = approach(case)
    force = np.array(recording.force)
    times = np.array(recording.time)
    near = (times >= recording.onset - TICK) & (times < recording.onset + 0.5)
    contact = recording.contacts[0][1] if recording.contacts else None
    early, end = (
        math.nan if contact is None else 1000.0 * math.dist(contact.pose.p_BT, recording.tip[row])
        for row in (round((0.5 - REST) / TICK), -1)
    )
    return Stop(case, float(force.max()), float(force[near].sum() * TICK), early, end)


def sweep(case: Approach) -> tuple[Approach, float, float, bool]:
    """A link's contact: case, delay [ms], true force at detection [N], and whether a source of that link saw it first."""
    recording = link_contact(case)
    _, times = truth_of(recording)
    found = [(1000.0 * (at - recording.onset), contact) for at, contact in recording.contacts]
    delay = delay_of([at for at, _ in found])
    force = recording.force[int(np.argmin(np.abs(times - delay))) - 1] if math.isfinite(delay) else math.nan
    return case, delay, force, bool(found) and found[0][1].source == "joints"


def quiet(case: Free) -> tuple[Free, list[str], dict[str, np.ndarray]]:
    """False alarms of one run of free motion, and the baselines' scores."""
    recording = free(case)
    events = [f"{contact.part} {contact.rule} {contact.change} at {at:.2f} s" for at, contact in recording.contacts]
    return case, events, baselines.scores(recording).by_name if case.record else {}


def cost(case: Approach) -> float:
    """Median of 9 [µs a tick]: hard, soft and slow rule on the signals of one approach."""
    recording = approach(case)
    use = msgspec.structs.replace(ContactUse(), instant=False, ratio=False)
    signals = [signals[0] for signals in recording.signals]
    first = signals[0]
    assert first is not None
    limit = limits(use, Mode.RUN, mass=first.mass, effective_mass=first.effective_mass, speed=0.0, lever=first.lever)
    times = []
    for _ in range(9):
        detector = Detector()
        begin = time.perf_counter()
        for signal in signals:
            detector.sense(signal)
            detector.step(use, limit)
        times.append((time.perf_counter() - begin) / len(signals))
    return 1e6 * float(np.median(times))
