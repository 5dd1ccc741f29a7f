"""The figures of a run, from its log and nothing else; summary.json is this value."""

import bisect
import hashlib
from collections.abc import Sequence
from typing import Any

import msgspec
import numpy as np

from app.log.events_file import EventLine
from app.log_reading.reader import Log
from app.report.gathering import Gathered, Peak, Span, from_event
from app.report.regions import regions
from app.session.expectation_watch import Verdict
from pendant.all_settings import concerns_safety, describe
from pendant.event_table import TABLE
from pendant.events.event import Kind
from pendant.events.event_row import Effect, Severity
from pendant.limits.parameters import PARAMETERS
from pendant.tick.modes import TICK, TICK_RATE

SLOW = 0.25
"""Speed of tcp and elbow that hand guiding is commonly held to [m/s]."""

AT_REST = 0.01
"""Every joint slower than this: the arm stands [rad/s]."""

RESTING = TICK_RATE // 10
"""It stands when that lasts for so many ticks, 0.1 s."""

LEAST_TOLD = 10.0
"""A smaller force on a link is not told by the joints [N]."""

STOPS = frozenset({Effect.LEAVE_TO_STOP, Effect.PROTECTIVE_STOP, Effect.EMERGENCY_STOP})
NOT_A_VALIDATION = (
    "This is the report of a simulation. It is not a validation of a robot cell: forces and pressures of a real contact have to "
    "be measured on the real robot (ISO/PAS 5672), and its risk assessment is the integrator's."
)


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


class Force(msgspec.Struct, frozen=True):
    """The force on the arm against what a body region bears."""

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
    limits: str  # safety checksum
    note: str = NOT_A_VALIDATION
    duration: float  # [s]
    whole: bool  # the log has its end
    missing: str  # what of the run is not in the log, in words; "" where all of it is
    thinned: str = ""  # how the log was thinned when it was made, in words: peaks between its ticks are not in it
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
    force_peak: Peak  # true, the larger of those on the tool and on a link [N]
    force_held: Peak  # the largest that lasted 0.5 s [N]
    on_tool: Peak  # true [N]
    on_link: Peak  # true, the largest on any link [N]
    told_tool: Peak  # as the flange sensor tells it [N]
    told_link: Peak  # the least that the joints tell [N]
    truth_known: bool  # the true forces are recorded; else `force_peak` and `force_held` are those that the flange sensor tells
    clips: list[str]  # what tells less force than there was, in words
    forces: list[Force]
    expectations: list[Expected]

    @property
    def passed(self) -> bool:
        """Whether every expectation was met."""
        return all(each.passed for each in self.expectations)


def summarise(gathered: Gathered, verdicts: Sequence[Verdict] = ()) -> Summary:
    """The figures of a run."""
    log = gathered.log
    peak, held = gathered.force_peak.found, gathered.force_held.found
    table = regions()
    last = log.settings[-1][1] if log.settings else {}
    contacts = [event for event in log.events if event.kind.startswith("contact_")]
    return Summary(
        run=log.run,
        limits=_checksum(last),
        duration=gathered.end,
        whole=log.whole,
        missing=log.missing,
        thinned=log.thinned,
        payload_configured=gathered.configured,
        payload_true=gathered.payload,
        modes=gathered.modes.found,
        phases=[span for span in gathered.phases.found if span.name != "OFF"],
        margins=_margins(gathered),
        messages=[event for event in log.events if _matters(event)],
        stops=[_stop(log, event) for event in log.events if TABLE[Kind(event.kind)].effect in STOPS],
        contacts=contacts,
        onset_delays=[_since_onset(gathered, event) for event in contacts],
        tcp_speed=gathered.tcp_speed.found,
        elbow_speed=gathered.elbow_speed.found,
        joint_speed=gathered.joint_speed.found,
        force_peak=peak,
        force_held=held,
        on_tool=gathered.on_tool.found,
        on_link=gathered.on_link.found,
        told_tool=gathered.told_tool.found,
        told_link=gathered.told_link.found,
        truth_known=gathered.truth_known,
        clips=_clips(gathered),
        forces=[
            Force(each.region, each.quasi_static, each.transient, *_within(peak.value, held.value, each), each.source)
            for each in table.regions
        ],
        expectations=[Expected(verdict.passed, verdict.expected, verdict.seen) for verdict in verdicts],
    )


def _clips(gathered: Gathered) -> list[str]:
    """What told less force than there was."""
    sensor, found = gathered.log.arm.sensors.force_torque, []
    tool, link = gathered.on_tool.found.value, gathered.on_link.found.value
    told, by_joints = gathered.told_tool.found.value, gathered.told_link.found.value
    if sensor is not None and tool > sensor.force.range:
        found.append(f"the flange sensor ends at {sensor.force.range:g} N an axis: {tool:.0f} N true, {told:.0f} N sensed")
    if link > max(by_joints, LEAST_TOLD):
        found.append(f"the flange sensor feels nothing of a link: {link:.0f} N true, at least {by_joints:.0f} N by the joints")
    return found


def _since_onset(gathered: Gathered, event: EventLine) -> float | None:
    """How long before a change in contact the arm was truly touched, or no more (CD-16) [s]."""
    if event.kind == Kind.CONTACT_RESISTANCE:
        return None
    times = gathered.touched[-1.0 if event.kind == Kind.CONTACT_LOST else 1.0]
    before = bisect.bisect_right(times, event.t)
    return round(event.t - times[before - 1], 6) if before else None


def _within(peak: float, held: float, region: Any) -> tuple[bool, float]:
    """Whether both forces are within a region's limits, and the larger share of them. Without a transient limit the peak counts
    against the quasi-static one."""
    share = max(held / region.quasi_static, peak / (region.transient or region.quasi_static))
    return share <= 1.0, share


def _margins(gathered: Gathered) -> list[Margin]:
    found: list[Margin] = []
    for name, row in PARAMETERS.items():
        worst = gathered.worst.get(name)
        if worst is not None and gathered.checked[name]:
            found.append(Margin(row.text, row.unit, worst.value, worst.limit, worst.share, worst.t))
    for event in gathered.log.events:  # what ends a check at once is told by its event alone
        worse = _told(event)
        if worse is not None and all(worse.share > each.share for each in found if each.parameter == worse.parameter):
            found = [*(each for each in found if each.parameter != worse.parameter), worse]
    return sorted(found, key=lambda margin: -margin.share)


def _told(event: EventLine) -> Margin | None:
    """The parameter beyond its limit that an event tells of."""
    told = {"parameter", "value", "limit", "unit"}
    values = event.values
    if not told <= values.keys() or not float(values["limit"]) or values["unit"] == "°":  # an angle is no share of a limit
        return None
    value, limit = float(values["value"]), float(values["limit"])
    return Margin(str(values["parameter"]), str(values["unit"]), value, limit, abs(value / limit), event.t)


def _matters(event: EventLine) -> bool:
    row = TABLE[Kind(event.kind)]
    if event.kind.startswith("contact_") or row.effect in (Effect.TRY, Effect.ENTER):
        return False
    return row.effect is not Effect.INFO or row.severity >= Severity.NOTICE


def _stop(log: Log, event: EventLine) -> StopFigures:
    """How long and how far from an event until the arm stands: from the first tick that begins RESTING ticks without motion."""
    moving, ways = np.zeros(0, dtype=bool), np.zeros(0)  # of the last ticks: whether it moves, and how far it has come
    done, way, place = 0, 0.0, None  # ticks before these; all of the way; where the flange is
    for part in from_event(log, event.tick * TICK):
        places = part.truth["flange"][:, :3]
        before = places[:1] if place is None else place
        steps = np.linalg.norm(np.diff(np.concatenate((before, places)), axis=0), axis=1)
        place = places[-1:]
        moving = np.concatenate((moving, np.abs(part.truth["qd"]).max(axis=1, initial=0.0) > AT_REST))
        ways = np.concatenate((ways, way + np.cumsum(steps)))
        way = float(ways[-1])
        quiet = np.convolve(moving, np.ones(RESTING))[RESTING - 1 :][: max(len(moving) - RESTING + 1, 0)] == 0
        if quiet.any():
            last = int(quiet.argmax())
            return StopFigures(event.kind, event.t, round((done + last) * TICK, 6), float(ways[last]))
        gone = max(0, len(moving) - RESTING + 1)
        done, moving, ways = done + gone, moving[gone:], ways[gone:]
    return StopFigures(event.kind, event.t, None, way)


def _checksum(values: dict[str, Any]) -> str:
    """Short hash of the settings that concern safety: 8 hexadecimal digits."""
    lines = "\n".join(f"{row.name}={values.get(row.name)!r}" for row in describe() if concerns_safety(row))
    return hashlib.sha256(lines.encode()).hexdigest()[:8]
