"""Writes summary.json and report.html of a run."""

from collections.abc import Sequence
from pathlib import Path

import msgspec

from app.files.checked import ABSENT, BadInput
from app.files.extras import there
from app.log_reading.reader import Log
from app.report.gathering import Gathered
from app.report.summary import Summary, summarise
from app.session.expectation_watch import Verdict

DRAWS = "matplotlib"
"""The package that draws the figures."""


def write_report(log: Log, out: Path, verdicts: Sequence[Verdict] = ()) -> Summary:
    """Write `out`/summary.json and `out`/report.html of a log; the second where what draws its figures is installed.

    Args:
        log: of the run.
        out: folder for the files; made when missing.
        verdicts: what became of the session's expectations.

    Raises:
        BadInput: the files cannot be written.
    """
    gathered = Gathered(log)
    summary = summarise(gathered, verdicts)
    try:
        out.mkdir(parents=True, exist_ok=True)
        (out / "summary.json").write_bytes(msgspec.json.format(msgspec.json.encode(summary), indent=1) + b"\n")
        if there(DRAWS):
            _write_page(gathered, summary, out / "report.html")
    except OSError as error:
        raise BadInput(str(out), "", ABSENT, f"cannot be written ({error.strerror})") from None
    return summary


def _write_page(gathered: Gathered, summary: Summary, path: Path) -> None:
    from app.report.charts import charts
    from app.report.page import page

    path.write_text(page(summary, charts(gathered, summary)), encoding="utf-8")
