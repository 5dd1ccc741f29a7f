"""What all reports are made of: one HTML file without anything from outside, its style, its tables."""

import re
from collections.abc import Iterable, Sequence
from html import escape

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


def document(title: str, parts: Sequence[str]) -> str:
    """The file; `title` and `parts` are HTML."""
    head = (
        f'<meta charset="utf-8"><meta name="viewport" content="width=device-width"><title>{title}</title><style>{STYLE}</style>'
    )
    return f'<!doctype html>\n<html lang="en"><head>{head}</head>\n<body>\n' + "\n".join(parts) + "\n</body></html>\n"


class Raw(str):
    """HTML already."""

    __slots__ = ()


def table(head: Sequence[str], rows: Iterable[Sequence[str]], empty: str = "") -> str:
    """A table, escaped; without rows the sentence `empty`."""
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
    return text if isinstance(text, Raw) else UNIT.sub("\u00a0", escape(text))


def _is_number(text: str) -> bool:
    try:
        float(text.removesuffix(" %"))
    except ValueError:
        return False
    return True


def mark(good: bool, yes: str, no: str) -> str:
    """A word in the colour of good or of bad."""
    return f'<span class="{"good" if good else "bad"}">{yes if good else no}</span>'
