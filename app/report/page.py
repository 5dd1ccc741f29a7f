"""report.html: one file without anything from outside, to read in a browser and to print."""

import re
from collections.abc import Iterable, Sequence
from html import escape

from app.log.events_file import EventLine
from app.report.summary import NOT_A_VALIDATION, SLOW, Peak, Summary

UNIT = re.compile(r"(?<=\d) (?=(?:s|ms|m|mm|m/s|N|N·m|rad|rad/s|kg)\b)")
"""Between a number and its unit no line is broken."""

STYLE = """
:root { --ink: #212529; --soft: #495057; --line: #dee2e6; --bad: #c92a2a; --good: #2b8a3e; }
* { box-sizing: border-box; }
body { margin: 0 auto; max-width: 19cm; padding: 1.2cm 0.6cm; color: var(--ink); background: white;
  font: 10pt/1.45 system-ui, "Segoe UI", Helvetica, Arial, sans-serif; }
h1 { font-size: 17pt; margin: 0 0 0.2em; line-height: 1.2; }
h2 { font-size: 12pt; margin: 1.5em 0 0.4em; border-bottom: 1px solid var(--line); break-after: avoid; }
p { margin: 0.4em 0; } h2 + p { break-after: avoid; }
.note { border-left: 4px solid #f59f00; background: #fff9db; padding: 0.5em 0.8em; break-inside: avoid; }
.verdict { font-size: 12pt; font-weight: 600; }
.bad { color: var(--bad); font-weight: 600; } .good { color: var(--good); font-weight: 600; }
table { border-collapse: collapse; width: 100%; font-size: 8.5pt; }
th, td { text-align: left; vertical-align: top; padding: 0.22em 0.9em 0.22em 0; border-bottom: 1px solid var(--line); }
th { color: var(--soft); font-weight: 600; } th.n { white-space: nowrap; }
td.n, th.n { text-align: right; font-variant-numeric: tabular-nums; }
tr { break-inside: avoid; } thead { display: table-header-group; }
figure { margin: 0.6em 0 0.9em; break-inside: avoid; } figure svg { width: 100%; height: auto; display: block; }
figcaption { font-size: 8.5pt; color: var(--soft); }
@page { size: A4; margin: 1.4cm 1.2cm 1.6cm;
  @bottom-right { content: counter(page) " / " counter(pages); font: 8pt Helvetica, Arial, sans-serif; color: #868e96; } }
@media print { body { padding: 0; max-width: none; } .note { print-color-adjust: exact; -webkit-print-color-adjust: exact; } }
"""


def page(summary: Summary, charts: Sequence[tuple[str, str]]) -> str:
    """The document."""
    run = summary.run
    title = escape(run.get("title", "run"))
    parts = [
        f"<h1>{title}</h1>",
        _verdict(summary),
        f'<p class="note">{escape(NOT_A_VALIDATION)}</p>',
        "<h2>What ran</h2>",
        _table((), [*_identity(summary)]),
        *(
            ["<h2>Expectations</h2>", _table(("", "expected", "seen"), [_expected(*each) for each in _verdicts(summary)])]
            if summary.expectations
            else []
        ),
        "<h2>Over time</h2>",
        *(["<p>Dotted: refusals, leavings, stops and changes in contact.</p>"] if summary.messages or summary.contacts else []),
        *(f"<figure>{svg}<figcaption>{escape(caption)}</figcaption></figure>" for caption, svg in charts),
        "<h2>Modes and periods</h2>",
        _table(
            ("state", "from [s]", "to [s]", "length [s]"),
            [
                (span.name, f"{span.begin:.3f}", f"{span.end:.3f}", f"{span.end - span.begin:.3f}")
                for span in sorted([*summary.modes, *summary.phases], key=lambda span: span.begin)
            ],
        ),
        "<h2>Monitored values at their worst</h2>",
        _table(
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
        _table(("at [s]", "what", "guidance"), [_message(event) for event in summary.messages], "None."),
        "<h2>Stopping</h2>",
        _table(
            ("at [s]", "cause", "time to rest [s]", "way of the flange [mm]"),
            [
                (f"{s.t:.3f}", s.kind, "not at rest" if s.time is None else f"{s.time:.3f}", f"{1000 * s.distance:.1f}")
                for s in summary.stops
            ],
            "No stop.",
        ),
        "<h2>Contacts</h2>",
        "<p>Delays as the detector tells them: since the first tick in which it sees the change. `make bench` measures them from "
        "the true onset.</p>",
        _table(
            ("at [s]", "what", "rule", "delay [ms]", "action"),
            [_contact(event) for event in summary.contacts],
            "No change in contact was detected.",
        ),
        "<h2>Peaks</h2>",
        _table(
            ("quantity", "peak", "unit", "at [s]", "against"),
            [
                ("speed of the tool centre point", *_peak(summary.tcp_speed, 1000), "mm/s", *_against(summary.tcp_speed)),
                ("speed of the elbow", *_peak(summary.elbow_speed, 1000), "mm/s", *_against(summary.elbow_speed)),
                ("speed of a joint", *_peak(summary.joint_speed), "rad/s", f"{summary.joint_speed.t:.3f}", ""),
                ("force at the flange", *_peak(summary.force_peak), "N", f"{summary.force_peak.t:.3f}", "transient limits"),
                ("force held for 0.5 s", *_peak(summary.force_held), "N", f"{summary.force_held.t:.3f}", "quasi-static limits"),
            ],
        ),
        "<h2>Force at the flange against body regions</h2>",
        "<p>Estimated force, that of hands included. Where no transient contact is allowed, the peak counts as quasi-static. "
        "The limits are data with a source each, in assets/limits/body-regions.yaml.</p>",
        _table(
            ("body region", "quasi-static [N]", "transient [N]", "of limit", "within", "source"),
            [
                (
                    each.region,
                    f"{each.quasi_static:g}",
                    "none allowed" if each.transient is None else f"{each.transient:g}",
                    _share(each.share),
                    _Raw(_mark(each.within, "yes", "NO")),
                    each.source,
                )
                for each in summary.forces
            ],
        ),
        f'<p class="note">{escape(NOT_A_VALIDATION)}</p>',
    ]
    head = (
        f'<meta charset="utf-8"><meta name="viewport" content="width=device-width"><title>{title}</title><style>{STYLE}</style>'
    )
    return f'<!doctype html>\n<html lang="en"><head>{head}</head>\n<body>\n' + "\n".join(parts) + "\n</body></html>\n"


class _Raw(str):
    """HTML already."""

    __slots__ = ()


def _table(head: Sequence[str], rows: Iterable[Sequence[str]], empty: str = "") -> str:
    rows = list(rows)
    if not rows:
        return f"<p>{escape(empty)}</p>"
    numeric = [all(_is_number(row[i]) for row in rows) for i in range(len(rows[0]))]
    classes = [' class="n"' if each else "" for each in numeric]
    top = "".join(f"<th{c}>{escape(name)}</th>" for c, name in zip(classes, head, strict=False))
    lines = ["".join(f"<td{c}>{_cell(cell)}</td>" for c, cell in zip(classes, row, strict=True)) for row in rows]
    header = f"<thead><tr>{top}</tr></thead>" if head else ""
    return f"<table>{header}<tbody>" + "".join(f"<tr>{line}</tr>" for line in lines) + "</tbody></table>"


def _cell(text: str) -> str:
    return text if isinstance(text, _Raw) else UNIT.sub("\u00a0", escape(text))


def _is_number(text: str) -> bool:
    try:
        float(text.removesuffix(" %"))
    except ValueError:
        return False
    return True


def _mark(good: bool, yes: str, no: str) -> str:
    return f'<span class="{"good" if good else "bad"}">{yes if good else no}</span>'


def _verdict(summary: Summary) -> str:
    if not summary.expectations:
        return '<p class="verdict">No expectations were given.</p>'
    failed = sum(not each.passed for each in summary.expectations)
    text = "All expectations met" if summary.passed else f"{failed} of {len(summary.expectations)} expectations not met"
    return f'<p class="verdict {"good" if summary.passed else "bad"}">{text}</p>'


def _verdicts(summary: Summary) -> list[tuple[bool, str, str]]:
    return [(each.passed, each.expected, each.seen) for each in summary.expectations]


def _expected(passed: bool, expected: str, seen: str) -> tuple[str, str, str]:
    return _Raw(_mark(passed, "met", "NOT MET")), expected, seen


def _identity(summary: Summary) -> list[tuple[str, str]]:
    run = summary.run
    names = ("pendant", "python", "mujoco", "pinocchio", "numpy")
    return [
        ("robot", run.get("robot", "")),
        ("seed", run.get("seed", "")),
        ("duration", f"{summary.duration:.3f} s"),
        *([("not whole", f"of the recording {summary.missing}")] if summary.missing else []),
        ("payload configured, true", f"{summary.payload_configured:g} kg, {summary.payload_true:g} kg"),
        ("settings", run.get("settings", "")),
        ("check sum of the limits", summary.limits),
        ("versions", ", ".join(f"{name} {run[name]}" for name in names if name in run)),
    ]


def _message(event: EventLine) -> tuple[str, str, str]:
    return f"{event.t:.3f}", event.headline, event.guidance


def _contact(event: EventLine) -> tuple[str, ...]:
    values = event.values
    delay = f"{2 * float(values['steps']):.0f}" if "steps" in values else ""
    return f"{event.t:.3f}", event.headline, str(values.get("rule", "")), delay, str(values.get("action", ""))


def _peak(peak: Peak, factor: float = 1.0) -> tuple[str]:
    return (f"{factor * peak.value:.4g}",)


def _against(peak: Peak) -> tuple[str, _Raw]:
    return f"{peak.t:.3f}", _Raw(_mark(peak.value <= SLOW, "within 250 mm/s", "above 250 mm/s"))


def _share(share: float) -> str:
    return f"{100 * share:.0f} %"
