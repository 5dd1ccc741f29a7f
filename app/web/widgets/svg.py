"""Small pictures for the pendant: mode light, countdown rings, tables. Every text that comes from elsewhere is escaped here."""

import math
from collections.abc import Iterable, Mapping, Sequence
from enum import StrEnum
from html import escape
from typing import NamedTuple


class Colour(StrEnum):
    """The colours of states; a word always stands beside them."""

    GREEN = "#2b8a3e"  # ready
    BLUE = "#1971c2"  # free-drive
    AMBER = "#e67700"  # about to end
    RED = "#c92a2a"  # stopped
    GREY = "#868e96"  # watching, waiting


class Bar(NamedTuple):
    """A value against its limit."""

    name: str
    part: str
    value: float
    limit: float
    unit: str

    @property
    def share(self) -> float:
        """Of the limit; 1 is at it."""
        return abs(self.value) / self.limit if self.limit > 0.0 else 0.0


RADIUS = 26.0
_AROUND = 2 * math.pi * RADIUS


class PaceWord(NamedTuple):
    """How the machine keeps up with the clock: a word, its colour, and a line for who asks."""

    word: str
    colour: Colour
    line: str


def light(mode: str, word: str, safety: str, colour: Colour, *, pace: PaceWord | None = None) -> str:
    """The mode light: mode in large letters, what it means in a word, safety mode beside it, and the pace below that."""
    told = ""
    if pace is not None:
        told = (
            f'<button type="button" class="pd-pace" style="--c:{pace.colour.value}" title="{escape(pace.line)}"><i></i>'
            f"{escape(pace.word)}</button>"
        )
    line = "" if pace is None else f'<p class="pd-pace-line">{escape(pace.line)}</p>'
    return (
        f'<div class="pd-light" style="--c:{colour.value}"><i></i><div><b>{escape(mode)}</b><span>{escape(word)}</span></div>'
        f"<em>Safety<strong>{escape(safety)}</strong>{told}</em></div>{line}"
    )


class Window(NamedTuple):
    """A running period."""

    name: str
    left: float  # [s]
    share: float  # of the whole, 0..1
    colour: Colour


def windows(running: Sequence[Window]) -> str:
    """The first of the running periods as a ring at the button above it, all of them in a line; its room stays the same."""
    ring = _ring(running[0]) if running else ""
    words = "".join(
        f'<span style="--c:{period.colour.value}"><i></i>{escape(period.name)} <b>{period.left:.1f} s</b></span>'
        for period in running
    )
    return f'<div class="pd-windows"><div class="pd-ring">{ring}</div><p>{words}</p></div>'


def _ring(period: Window) -> str:
    """A countdown ring with the seconds in its middle."""
    arc = _AROUND * min(max(period.share, 0.0), 1.0)
    label = f"{escape(period.name)} {period.left:.1f} s"
    return (
        f'<svg viewBox="0 0 64 64" width="46" height="46" role="img" aria-label="{label}">'
        f'<circle cx="32" cy="32" r="{RADIUS:g}" fill="none" stroke="currentColor" stroke-opacity=".3" stroke-width="7"/>'
        f'<circle cx="32" cy="32" r="{RADIUS:g}" fill="none" stroke="currentColor" stroke-width="7" stroke-linecap="round" '
        f'stroke-dasharray="{arc:.1f} {_AROUND:.1f}" transform="rotate(-90 32 32)"/>'
        f'<text x="32" y="39" text-anchor="middle" font-size="19" font-weight="700" fill="currentColor">'
        f"{period.left:.1f}</text></svg>"
    )


def beat(seconds: int) -> str:
    """Nothing to see: while it changes, the page knows that the server is there."""
    return f'<span hidden data-pd-beat="{seconds}"></span>'


def note(headline: str, text: str, colour: Colour, reasons: Sequence[str] = ()) -> str:
    """A short message: a headline, what to do, and the numbers that led to it."""
    lines = "".join(f"<li>{escape(reason)}</li>" for reason in reasons)
    return (
        f'<div class="pd-note" style="--c:{colour.value}"><b>{escape(headline)}</b>'
        f"{f'<span>{escape(text)}</span>' if text else ''}{f'<ul>{lines}</ul>' if lines else ''}</div>"
    )


def bars(rows: Sequence[Bar], count: int) -> str:
    """Monitored values against their limits; `count` is how many there are in all."""
    lines = "".join(_bar(row) for row in rows)
    rest = count - len(rows)
    more = f"<p>and {rest} more, further from their limits</p>" if rest > 0 else ""
    return f'<div class="pd-bars">{lines}{more}</div>'


def _bar(row: Bar) -> str:
    colour = Colour.RED if row.share > 1.0 else Colour.AMBER if row.share > 0.7 else Colour.GREEN
    mark = "! " if row.share > 1.0 else ""
    return (
        f'<div style="--c:{colour.value};--s:{100.0 * min(row.share, 1.0):.0f}%"><span>{escape(row.name)}</span>'
        f"<em>{mark}{row.value:.2g} / {row.limit:.2g} {escape(row.unit)}</em><i></i></div>"
    )


def who(text: str, hint: str, colour: Colour, *, watching: bool = False) -> str:
    """Who has control, and what a client can do about it; a page that is `watching` greys what it cannot use."""
    mark = " data-pd-watching" if watching else ""
    return (
        f'<div class="pd-who" style="--c:{colour.value}"{mark}><i></i><span><b>{escape(text)}</b>'
        f"{f'<em>{escape(hint)}</em>' if hint else ''}</span></div>"
    )


def facts(pairs: Iterable[tuple[str, str]], hints: Mapping[str, str] = {}) -> str:
    """Names and values in two columns; `hints` has what is told when the pointer rests on a name."""
    rows = "".join(f"<dt{_hint(hints.get(name))}>{escape(name)}</dt><dd>{escape(value)}</dd>" for name, value in pairs)
    return f'<dl class="pd-facts">{rows}</dl>'


def _hint(text: str | None) -> str:
    return "" if text is None else f' title="{escape(text)}"'


def loads(true: float, configured: float) -> str:
    """The true and the configured payload side by side [kg], and what lies between them in a word."""
    error = true - configured
    word, colour = ("as configured", Colour.GREEN) if abs(error) < 0.05 else (f"{error:+.1f} kg wrong", Colour.AMBER)
    return (
        f'<div class="pd-loads" style="--c:{colour.value}"><span>True<b>{true:.1f} kg</b></span>'
        f"<span>Configured<b>{configured:.1f} kg</b></span><em>{word}</em></div>"
    )


def program_line(text: str) -> str:
    """Which program there is, or which step of it is done, in a line that keeps its height."""
    return f'<p class="pd-program" title="{escape(text)}">{escape(text)}</p>'


def differences(text: str, rows: Sequence[tuple[str, str, str]]) -> str:
    """What would change: name, from, to."""
    lines = "".join(f"<tr><td>{escape(name)}</td><td>{escape(old)}</td><td>{escape(new)}</td></tr>" for name, old, new in rows)
    head = "<tr><th>Setting</th><th>now</th><th>then</th></tr>"
    told = f"<table>{head}{lines}</table>" if rows else "<p>Nothing would change.</p>"
    return f'<div class="pd-diff"><p>{escape(text)}</p>{told}</div>'


def cards(groups: Mapping[str, Sequence[str]], chosen: str) -> str:
    """Titles to choose from, whole, under the heading of their group; a press chooses what the dropdown calls so."""
    inside = "".join(
        f"<h4>{escape(group)}</h4>"
        + "".join(
            f'<div role="radio" tabindex="0" data-pd-pick="{escape(title)}" aria-checked="{str(title == chosen).lower()}">'
            f"{escape(title)}</div>"
            for title in titles
        )
        for group, titles in groups.items()
    )
    return f'<div class="pd-cards" role="radiogroup" aria-label="Scenarios">{inside or "<p>Nothing has these words.</p>"}</div>'


def fine_print(text: str) -> str:
    """A line in small letters."""
    return f'<p class="pd-fine">{escape(text)}</p>'


def two_lines(text: str) -> str:
    """The same in a room that keeps its height: what stands below does not move under a finger."""
    return f'<div class="pd-two">{fine_print(text)}</div>'


class LogLine(NamedTuple):
    """A row of the event log. `moment` is its name in the choice of the plots; without a time it divides."""

    time: str
    text: str
    colour: Colour
    moment: str
    often: int


def ghosts(rows: Iterable[tuple[tuple[int, int, int], str]]) -> str:
    """The legend of the picture: colour of each ghost, and what it means. The page shows it over the picture."""
    lines = "".join(f'<p><i style="--c:rgb{colour}"></i>{escape(text)}</p>' for colour, text in rows)
    return f'<div class="pd-ghosts">{lines}</div>' if lines else ""


class TimeMark(NamedTuple):
    """An event on a time line: its place as a share of the line, the name of its moment, its colour."""

    share: float
    moment: str
    colour: Colour


def time_marks(line: str, marks: Iterable[TimeMark]) -> str:
    """Marks along the track of the slider whose id is `line`; a press on one chooses its moment."""
    ticks = "".join(
        f'<i style="left:{100.0 * mark.share:.2f}%;--c:{mark.colour.value}" title="{escape(mark.moment)}" '
        f'data-pd-pick="{escape(mark.moment)}"></i>'
        for mark in marks
    )
    return f'<div class="pd-marks" data-pd-line="{line}" aria-hidden="true">{ticks}</div>' if ticks else ""


def table(rows: Iterable[tuple[str, str, Colour]]) -> str:
    """A list of messages: time, text, colour of its mark."""
    return event_log(LogLine(time, text, colour, "", 1) for time, text, colour in rows)


def event_log(rows: Iterable[LogLine]) -> str:
    """The event log: colour of its mark, time, text, and how often."""
    lines = "".join(map(_log_line, rows))
    return (
        f'<div class="pd-events pd-log"><table>{lines}</table></div>'
        if lines
        else '<p class="pd-events pd-empty">Nothing has happened yet</p>'
    )


def _log_line(row: LogLine) -> str:
    if not row.time:
        return f'<tr class="pd-divide"><td colspan="3">{escape(row.text)}</td></tr>'
    often = f' <b class="pd-count">{row.often} ×</b>' if row.often > 1 else ""
    leads = f' tabindex="0" data-pd-pick="{escape(row.moment)}"' if row.moment else ""
    return (
        f'<tr{leads}><td style="--c:{row.colour.value}"><i></i></td>'
        f"<td>{escape(row.time)}</td><td>{escape(row.text)}{often}</td></tr>"
    )


def contacts(rows: Iterable[tuple[str, ...]], heads: Mapping[str, str | None] = {}) -> str:
    """The contact log: rows below `heads` with their hints. A press on a row chooses the contact that its first cell numbers."""
    lines = "".join(
        f'<tr tabindex="0" data-pd-pick="contact {escape(row[0])}">{"".join(f"<td>{escape(cell)}</td>" for cell in row)}</tr>'
        for row in rows
    )
    if not lines:
        return '<p class="pd-empty">No contact yet</p>'
    cells = "".join(f"<th{_hint(hint)}>{head}</th>" for head, hint in heads.items())
    return f'<div class="pd-contacts"><table><tr>{cells}</tr>{lines}</table></div>'


def limits(rows: Iterable[tuple[str, ...]]) -> str:
    """The robot's limits: name, value in both safety modes, tolerance."""
    lines = "".join(f"<tr>{''.join(f'<td>{escape(cell)}</td>' for cell in row)}</tr>" for row in rows)
    heads = "".join(f"<th>{head}</th>" for head in ("Limit", "Normal", "Reduced", "Tolerance"))
    return f'<div class="pd-contacts pd-limits"><table><tr>{heads}</tr>{lines}</table></div>'


def listing(rows: Iterable[tuple[int, str]], marked: int, state: str) -> str:
    """Lines of a program with their numbers; one is marked, which is in `state`: "" for where it went wrong."""
    lines = "".join(
        f"<li value={number}{NOW if number == marked else ''}>{escape(line) or '&nbsp;'}"
        f"{f' <em>{escape(state)}</em>' if number == marked and state else ''}</li>"
        for number, line in rows
    )
    return f'<ol class="pd-listing">{lines}</ol>' if lines else ""


NOW = ' class="pd-now"'


def steps(rows: Iterable[tuple[str, bool, bool]], state: str) -> str:
    """The steps of a program, to choose one: its text, whether it is chosen, and whether it is being done, in `state`."""
    lines = "".join(
        f'<div role="radio" tabindex="0" data-pd-pick="{escape(text)}" aria-checked="{str(chosen).lower()}"'
        f"{NOW if now else ''}>{escape(text)}{f' <em>{escape(state)}</em>' if now else ''}</div>"
        for text, chosen, now in rows
    )
    if not lines:
        return '<p class="pd-empty">No steps yet</p>'
    return f'<div class="pd-steps" role="radiogroup" aria-label="Steps of the program">{lines}</div>'
