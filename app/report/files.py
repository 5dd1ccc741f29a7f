"""Writes summary.json and report.html of a run."""

from collections.abc import Sequence
from pathlib import Path

import msgspec

from app.files.checked import ABSENT, BadInput
from app.log_reading.reader import Log
from app.report.gathering import Gathered
from app.report.summary import Summary, summarise
from app.session.expectation_watch import Verdict


def write_report(log: Log, out: Path, verdicts: Sequence[Verdict] = ()) -> Summary:
    """Write `out`/summary.json and `out`/report.html of a log.

    Args:
        log: of the run.
        out: folder for the files; made when missing.
        verdicts: what became of the session's expectations.

    Raises:
        BadInput: the files cannot be written.
    """
    from app.report.charts import charts
    from app.report.page import page

    gathered = Gathered(log)
    summary = summarise(gathered, verdicts)
    try:
        out.mkdir(parents=True, exist_ok=True)
        (out / "summary.json").write_bytes(msgspec.json.format(msgspec.json.encode(summary), indent=1) + b"\n")
        (out / "report.html").write_text(page(summary, charts(gathered, summary)), encoding="utf-8")
    except OSError as error:
        raise BadInput(str(out), "", ABSENT, f"cannot be written ({error.strerror})") from None
    return summary
