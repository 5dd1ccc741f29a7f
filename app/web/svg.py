"""Small pictures for the pendant: mode light, countdown rings, tables. Every text that comes from elsewhere is escaped here."""

import math
from collections.abc import Iterable
from enum import StrEnum
from html import escape


class Colour(StrEnum):
    """The colours of states; a word always stands beside them."""

    GREEN = "#2b8a3e"  # ready
    BLUE = "#1971c2"  # free-drive
    AMBER = "#e67700"  # about to end
    RED = "#c92a2a"  # stopped
    GREY = "#868e96"  # watching, waiting


RADIUS = 26.0
_AROUND = 2 * math.pi * RADIUS


def light(mode: str, word: str, safety: str, colour: Colour) -> str:
    """The mode light: mode in large letters, what it means in a word, safety mode beside it."""
    return (
        f'<div class="pd-light" style="--c:{colour.value}"><i></i><div><b>{escape(mode)}</b><span>{escape(word)}</span></div>'
        f"<em>Safety<strong>{escape(safety)}</strong></em></div>"
    )


def ring(name: str, left: float, share: float, colour: Colour) -> str:
    """A countdown ring: `left` seconds in the middle, `share` (0..1) of the circle, `name` below."""
    arc = _AROUND * min(max(share, 0.0), 1.0)
    return (
        '<figure><svg viewBox="0 0 64 64" width="64" height="64" role="img">'
        f'<circle cx="32" cy="32" r="{RADIUS:g}" fill="none" stroke="#e9ecef" stroke-width="6"/>'
        f'<circle cx="32" cy="32" r="{RADIUS:g}" fill="none" stroke="{colour.value}" stroke-width="6" stroke-linecap="round" '
        f'stroke-dasharray="{arc:.1f} {_AROUND:.1f}" transform="rotate(-90 32 32)"/>'
        f'<text x="32" y="37" text-anchor="middle" font-size="15" font-weight="600" fill="#343a40">{left:.1f}</text></svg>'
        f"<figcaption>{escape(name)}</figcaption></figure>"
    )


def rings(pictures: Iterable[str]) -> str:
    """Rings side by side, or a line that says there are none: the room they take stays the same."""
    inside = "".join(pictures) or "<p>No period is running</p>"
    return f'<div class="pd-rings">{inside}</div>'


def note(headline: str, text: str, colour: Colour) -> str:
    """A short message: a headline and what to do."""
    return (
        f'<div class="pd-note" style="--c:{colour.value}"><b>{escape(headline)}</b>'
        f"{f'<span>{escape(text)}</span>' if text else ''}</div>"
    )


def who(text: str, colour: Colour) -> str:
    """Who has control, in a line."""
    return f'<div class="pd-who" style="--c:{colour.value}"><i></i><b>{escape(text)}</b></div>'


def facts(pairs: Iterable[tuple[str, str]]) -> str:
    """Names and values in two columns."""
    rows = "".join(f"<dt>{escape(name)}</dt><dd>{escape(value)}</dd>" for name, value in pairs)
    return f'<dl class="pd-facts">{rows}</dl>'


def table(rows: Iterable[tuple[str, str, Colour]]) -> str:
    """The event log: time, text, colour of its mark."""
    lines = "".join(
        f'<tr><td style="--c:{colour.value}"><i></i></td><td>{escape(time)}</td><td>{escape(text)}</td></tr>'
        for time, text, colour in rows
    )
    return (
        f'<div class="pd-events pd-log"><table>{lines}</table></div>'
        if lines
        else '<p class="pd-events pd-empty">Nothing has happened yet</p>'
    )
