"""report.html: one file without anything from outside, to read in a browser and to print."""

from collections.abc import Sequence
from html import escape
from math import isfinite

from app.log.events_file import EventLine
from app.report.document import Raw, document, mark, table
from app.report.summary import NOT_A_VALIDATION, SLOW, Peak, Summary


def page(summary: Summary, charts: Sequence[tuple[str, str]]) -> str:
    """The document."""
    run = summary.run
    title = escape(run.get("title", "run"))
    parts = [
        f"<h1>{title}</h1>",
        _verdict(summary),
        f'<p class="note">{escape(NOT_A_VALIDATION)}</p>',
        "<h2>What ran</h2>",
        table((), [*_identity(summary)]),
        *(
            ["<h2>Expectations</h2>", table(("", "expected", "seen"), [_expected(*each) for each in _verdicts(summary)])]
            if summary.expectations
            else []
        ),
        "<h2>Over time</h2>",
        *(["<p>Dotted: refusals, leavings, stops and changes in contact.</p>"] if summary.messages or summary.contacts else []),
        *(f"<figure>{svg}<figcaption>{escape(caption)}</figcaption></figure>" for caption, svg in charts),
        "<h2>Modes and periods</h2>",
        table(
            ("state", "from [s]", "to [s]", "length [s]"),
            [
                (span.name, f"{span.begin:.3f}", f"{span.end:.3f}", f"{span.end - span.begin:.3f}")
                for span in sorted([*summary.modes, *summary.phases], key=lambda span: span.begin)
            ],
        ),
        "<h2>Monitored values at their worst</h2>",
        table(
            ("parameter", "at [s]", "value", "limit", "unit", "of limit", "margin"),
            [
                (
                    each.parameter,
                    f"{each.t:.3f}",
                    f"{each.value:.4g}",
                    f"{each.limit:.4g}",
                    each.unit,
                    _share(each.share),
                    f"{abs(each.limit) - abs(each.value):.4g}",
                )
                for each in summary.margins
            ],
            "Nothing was monitored.",
        ),
        "<h2>Refusals, leavings and stops</h2>",
        table(("at [s]", "what", "guidance"), [_message(event) for event in summary.messages], "None."),
        "<h2>Stopping</h2>",
        table(
            ("at [s]", "cause", "time to rest [s]", "way of the flange [mm]"),
            [
                (f"{s.t:.3f}", s.kind, "not at rest" if s.time is None else f"{s.time:.3f}", f"{1000 * s.distance:.1f}")
                for s in summary.stops
            ],
            "No stop.",
        ),
        "<h2>Contacts</h2>",
        "<p>Look-back: since the first tick in which the detector sees the change. True onset: since the arm was truly touched, "
        "or no more, which the detector does not know.</p>",
        table(
            ("at [s]", "what", "rule", "look-back [ms]", "true onset [ms]", "action"),
            [_contact(*contact) for contact in zip(summary.contacts, summary.onset_delays, strict=True)],
            "No change in contact was detected.",
        ),
        "<h2>Peaks</h2>",
        table(
            ("quantity", "peak", "unit", "at [s]", "against"),
            [
                ("speed of the tool centre point", *_peak(summary.tcp_speed, 1000), "mm/s", *_against(summary.tcp_speed)),
                ("speed of the elbow", *_peak(summary.elbow_speed, 1000), "mm/s", *_against(summary.elbow_speed)),
                ("speed of a joint", *_peak(summary.joint_speed), "rad/s", f"{summary.joint_speed.t:.3f}", ""),
                *_forces(summary),
            ],
        ),
        "<h2>Force against body regions</h2>",
        f"<p>{_which(summary)} Where no transient contact is allowed, the peak counts as quasi-static. "
        "The limits are data with a source each, in assets/limits/body-regions.yaml.</p>",
        *(f'<p class="note">Told less than there was: {escape(each)}.</p>' for each in summary.clips),
        table(
            ("body region", "quasi-static [N]", "transient [N]", "of limit", "within", "source"),
            [
                (
                    each.region,
                    f"{each.quasi_static:g}",
                    "none allowed" if each.transient is None else f"{each.transient:g}",
                    _share(each.share),
                    Raw(mark(each.within, "yes", "NO")),
                    each.source,
                )
                for each in summary.forces
            ],
        ),
        f'<p class="note">{escape(NOT_A_VALIDATION)}</p>',
    ]
    return document(title, parts)


def _which(summary: Summary) -> str:
    """Which force is held against the limits."""
    if summary.truth_known:
        return "The true force of hands and objects, the larger of those on the tool and on a link, 500 times a second."
    return "The force that the flange sensor tells, for this recording has no true one: it ends at its range and knows no links."


def _forces(summary: Summary) -> list[tuple[str, ...]]:
    """Rows of the forces: true beside told."""
    true = [
        ("force on the tool, true", summary.on_tool, ""),
        ("force on a link, true", summary.on_link, ""),
    ]
    rows = [
        ("largest force", summary.force_peak, "transient limits"),
        ("largest force for 0.5 s", summary.force_held, "quasi-static limits"),
        *(true if summary.truth_known else []),
        ("force on the tool, by the flange sensor", summary.told_tool, ""),
        ("force on a link, at least, by the joints", summary.told_link, ""),
    ]
    return [(name, *_peak(peak), "N", f"{peak.t:.3f}", against) for name, peak, against in rows if isfinite(peak.value)]


def _verdict(summary: Summary) -> str:
    if not summary.expectations:
        return '<p class="verdict">No expectations were given.</p>'
    failed = sum(not each.passed for each in summary.expectations)
    text = "All expectations met" if summary.passed else f"{failed} of {len(summary.expectations)} expectations not met"
    return f'<p class="verdict {"good" if summary.passed else "bad"}">{text}</p>'


def _verdicts(summary: Summary) -> list[tuple[bool, str, str]]:
    return [(each.passed, each.expected, each.seen) for each in summary.expectations]


def _expected(passed: bool, expected: str, seen: str) -> tuple[str, str, str]:
    return Raw(mark(passed, "met", "NOT MET")), expected, seen


def _identity(summary: Summary) -> list[tuple[str, str]]:
    run = summary.run
    names = ("pendant", "python", "mujoco", "pinocchio", "numpy")
    return [
        ("robot", run.get("robot", "")),
        ("seed", run.get("seed", "")),
        ("duration", f"{summary.duration:.3f} s"),
        *([("not whole", f"of the recording {summary.missing}")] if summary.missing else []),
        *([("thinned", f"{summary.thinned}: peaks between these are not in it")] if summary.thinned else []),
        ("payload configured, true", f"{summary.payload_configured:g} kg, {summary.payload_true:g} kg"),
        ("settings", run.get("settings", "")),
        ("safety checksum", summary.limits),
        ("versions", ", ".join(f"{name} {run[name]}" for name in names if name in run)),
    ]


def _message(event: EventLine) -> tuple[str, str, str]:
    return f"{event.t:.3f}", event.headline, event.guidance


def _contact(event: EventLine, onset: float | None) -> tuple[str, ...]:
    values = event.values
    true = "" if onset is None else f"{1000.0 * onset:.0f}"
    delay = f"{2 * float(values['steps']):.0f}" if "steps" in values else ""
    return f"{event.t:.3f}", event.headline, str(values.get("rule", "")), delay, true, str(values.get("action", ""))


def _peak(peak: Peak, factor: float = 1.0) -> tuple[str]:
    return (f"{factor * peak.value:.4g}",)


def _against(peak: Peak) -> tuple[str, Raw]:
    return f"{peak.t:.3f}", Raw(mark(peak.value <= SLOW, "within 250 mm/s", "above 250 mm/s"))


def _share(share: float) -> str:
    return f"{100 * share:.0f} %"
