"""The figures of a run, from its log and nothing else; summary.json is this value."""

import hashlib
import math
from collections.abc import Sequence
from typing import Any

import msgspec
import numpy as np
from numpy.typing import NDArray

from app.log.events_file import EventLine
from app.log.layout import WORDS
from app.log.reader import Log
from app.report.regions import regions
from app.session.expectation_watch import Verdict
from pendant.all_settings import describe
from pendant.event_table import TABLE
from pendant.events.event import Kind
from pendant.events.event_row import Effect, Severity
from pendant.limits.parameters import PARAMETERS
from pendant.tick.modes import TICK, TICK_RATE

SLOW = 0.25
"""Speed of tcp and elbow that hand guiding is commonly held to [m/s]."""

HELD = TICK_RATE // 2
"""A force counts as quasi-static when it lasts for so many ticks, 0.5 s."""

AT_REST = 0.01
"""Every joint slower than this: the arm stands [rad/s]."""

RESTING = TICK_RATE // 10
"""It stands when that lasts for so many ticks, 0.1 s."""

STOPS = frozenset({Effect.LEAVE_TO_STOP, Effect.PROTECTIVE_STOP, Effect.EMERGENCY_STOP})
NOT_A_VALIDATION = (
    "This is the report of a simulation. It is not a validation of a robot cell: forces and pressures of a real contact have to "
    "be measured on the real robot (ISO/PAS 5672), and its risk assessment is the integrator's."
)


class Span(msgspec.Struct, frozen=True):
    """A state and the time that it lasted."""

    name: str
    begin: float  # [s]
    end: float  # [s]


class Margin(msgspec.Struct, frozen=True):
    """A monitored parameter at its worst, while it was checked."""

    parameter: str
    unit: str
    value: float  # where value over limit was largest
    limit: float
    share: float  # value over limit
    t: float  # [s]


class StopFigures(msgspec.Struct, frozen=True):
    """A stop: how long and how far until the arm stood."""

    kind: str
    t: float  # [s]
    time: float | None  # None: it did not stand before the end [s]
    distance: float  # way of the flange [m]


class Peak(msgspec.Struct, frozen=True):
    """The largest of a quantity."""

    value: float
    t: float  # [s]


class Force(msgspec.Struct, frozen=True):
    """The force at the flange against what a body region bears."""

    region: str
    quasi_static: float  # limit [N]
    transient: float | None  # limit [N]
    within: bool
    share: float  # the larger of both forces over their limits
    source: str


class Expected(msgspec.Struct, frozen=True):
    """An expectation of the session."""

    passed: bool
    expected: str
    seen: str


class Summary(msgspec.Struct, frozen=True, kw_only=True):
    """All figures of a run. SI units; times from the start of the run."""

    run: dict[str, str]  # title, versions, robot, seed, hash of the settings
    limits: str  # check sum of all limits
    note: str = NOT_A_VALIDATION
    duration: float  # [s]
    whole: bool  # the log has its end
    missing: str  # what of the run is not in the log, in words; "" where all of it is
    payload_configured: float  # at the end [kg]
    payload_true: float  # at the end [kg]
    modes: list[Span]
    phases: list[Span]
    margins: list[Margin]
    messages: list[EventLine]  # refusals, leavings and stops, with cause and guidance
    stops: list[StopFigures]
    contacts: list[EventLine]
    onset_delays: list[float | None]  # of each: from the true touch or parting; None where there was none, or no such thing [s]
    tcp_speed: Peak
    elbow_speed: Peak
    joint_speed: Peak
    force_peak: Peak  # of F_user's force [N]
    force_held: Peak  # the largest that lasted 0.5 s [N]
    forces: list[Force]
    expectations: list[Expected]

    @property
    def passed(self) -> bool:
        """Whether every expectation was met."""
        return all(each.passed for each in self.expectations)


def summarise(log: Log, verdicts: Sequence[Verdict] = ()) -> Summary:
    """The figures of a run."""
    state, t = log.state, log.t
    force = np.linalg.norm(state["F_user"][:, :3], axis=1)
    peak, held = _peak(force, t), _held(force, t)
    table = regions()
    last = log.settings[-1][1] if log.settings else {}
    contacts = [event for event in log.events if event.kind.startswith("contact_")]
    return Summary(
        run=log.run,
        limits=_checksum(last),
        duration=float(t[-1]) if len(t) else 0.0,
        whole=log.whole,
        missing=log.missing,
        payload_configured=float(state["configured_mass"][-1]) if len(t) else 0.0,
        payload_true=float(log.truth["payload_mass"][-1]) if len(t) else 0.0,
        modes=spans(state["mode"], t, WORDS["mode"]),
        phases=[span for span in spans(state["phase"], t, WORDS["phase"]) if span.name != "OFF"],
        margins=_margins(log),
        messages=[event for event in log.events if _matters(event)],
        stops=[_stop(log, event) for event in log.events if TABLE[Kind(event.kind)].effect in STOPS],
        contacts=contacts,
        onset_delays=[_since_onset(log, event) for event in contacts],
        tcp_speed=_peak(state["v_tcp"], t),
        elbow_speed=_peak(state["v_elbow"], t),
        joint_speed=_peak(np.abs(state["qd"]).max(axis=1, initial=0.0), t),
        force_peak=peak,
        force_held=held,
        forces=[
            Force(each.region, each.quasi_static, each.transient, *_within(peak.value, held.value, each), each.source)
            for each in table.regions
        ],
        expectations=[Expected(verdict.passed, verdict.expected, verdict.seen) for verdict in verdicts],
    )


def spans(codes: NDArray[Any], t: NDArray[np.float64], words: tuple[str, ...]) -> list[Span]:
    """Runs of equal codes (k,), as spans."""
    if not len(codes):
        return []
    edges = [0, *(np.flatnonzero(np.diff(codes)) + 1).tolist(), len(codes)]
    ends = [*t[edges[1:-1]].tolist(), float(t[-1])]
    return [Span(str(words[codes[a]]), round(float(t[a]), 6), round(end, 6)) for a, end in zip(edges[:-1], ends, strict=True)]


def _since_onset(log: Log, event: EventLine) -> float | None:
    """How long before a change in contact the arm was truly touched, or no more (CD-16) [s]."""
    if event.kind == Kind.CONTACT_RESISTANCE:
        return None
    way = -1.0 if event.kind == Kind.CONTACT_LOST else 1.0
    edges = log.t[1:][np.diff(log.truth["touched"]) == way]
    before = edges[edges <= event.t]
    return round(event.t - float(before[-1]), 6) if len(before) else None


def _peak(values: NDArray[np.float64], t: NDArray[np.float64]) -> Peak:
    if not len(values):
        return Peak(0.0, 0.0)
    k = int(np.argmax(np.nan_to_num(values, nan=-math.inf)))
    return Peak(float(values[k]), float(t[k]))


def _held(force: NDArray[np.float64], t: NDArray[np.float64]) -> Peak:
    """The largest force that was there for HELD ticks without a break, and when that began."""
    if len(force) < HELD:
        return Peak(0.0, 0.0)
    windows = np.lib.stride_tricks.sliding_window_view(force, HELD)
    return _peak(windows.min(axis=1), t[: len(windows)])


def _within(peak: float, held: float, region: Any) -> tuple[bool, float]:
    """Whether both forces are within a region's limits, and the larger share of them. Without a transient limit the peak counts
    against the quasi-static one."""
    share = max(held / region.quasi_static, peak / (region.transient or region.quasi_static))
    return share <= 1.0, share


def _margins(log: Log) -> list[Margin]:
    found: list[Margin] = []
    for name, row in PARAMETERS.items():
        value, limit = log.state[f"monitored_{name}"], log.state[f"limit_{name}"]
        share = np.abs(value) / np.abs(limit)
        if np.any(np.isfinite(share)):
            k = int(np.nanargmax(share))
            found.append(Margin(row.text, row.unit, float(value[k]), float(limit[k]), float(share[k]), float(log.t[k])))
    for event in log.events:  # what ends a check at once is told by its event alone
        worse = _told(event)
        if worse is not None and all(worse.share > each.share for each in found if each.parameter == worse.parameter):
            found = [*(each for each in found if each.parameter != worse.parameter), worse]
    return sorted(found, key=lambda margin: -margin.share)


def _told(event: EventLine) -> Margin | None:
    """The parameter beyond its limit that an event tells of."""
    told = {"parameter", "value", "limit", "unit"}
    values = event.values
    if not told <= values.keys() or not float(values["limit"]):
        return None
    value, limit = float(values["value"]), float(values["limit"])
    return Margin(str(values["parameter"]), str(values["unit"]), value, limit, abs(value / limit), event.t)


def _matters(event: EventLine) -> bool:
    row = TABLE[Kind(event.kind)]
    if event.kind.startswith("contact_") or row.effect in (Effect.TRY, Effect.ENTER):
        return False
    return row.effect is not Effect.INFO or row.severity >= Severity.NOTICE


def _stop(log: Log, event: EventLine) -> StopFigures:
    after = log.ticks >= event.tick
    moving = np.abs(log.truth["qd"][after]).max(axis=1, initial=0.0) > AT_REST
    places = log.truth["flange"][after, :3]
    # At rest from the first tick that begins so many ticks without motion.
    quiet = np.convolve(moving, np.ones(RESTING))[RESTING - 1 :][: max(len(moving) - RESTING + 1, 0)] == 0
    last = int(quiet.argmax()) if quiet.any() else len(moving) - 1
    way = float(np.linalg.norm(np.diff(places[: last + 1], axis=0), axis=1).sum())
    return StopFigures(event.kind, event.t, round(last * TICK, 6) if quiet.any() else None, way)


def _checksum(values: dict[str, Any]) -> str:
    """Short hash of all limits, those settings that cannot be changed in free-drive: 8 hexadecimal digits."""
    lines = "\n".join(f"{row.name}={values.get(row.name)!r}" for row in describe() if row.locked)
    return hashlib.sha256(lines.encode()).hexdigest()[:8]
