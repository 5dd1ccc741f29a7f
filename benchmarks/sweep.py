"""Studies: the same rows whoever does the runs; no row lost whatever dies; what it costs beside the sessions' own ticks."""

from pathlib import Path
from tempfile import TemporaryDirectory

import msgspec

from app.studies.plan import Plan
from app.studies.study_file import open_study, studies
from benchmarks.common import Report, main
from benchmarks.sweeps.costs import cost, large, memory, study_fields
from benchmarks.sweeps.faults import all_killed, disk_full, same_rows, scheduler_killed, workers_killed


def bundled_study(report: Report) -> None:
    """How many runs the quick sizes have."""
    for name in studies():
        study, base = open_study(name, quick=True)
        report.row(f"{name}, quick: runs", Plan(study, base, name).size, "")


def measure(report: Report) -> None:
    """Fill the report."""
    cost(report)  # first: what others do on the machine costs the least while it is short
    with TemporaryDirectory() as folder:
        here = Path(folder)
        large(report, here)
        study = here / "study.yaml"
        study.write_bytes(msgspec.yaml.encode(study_fields(120 if report.options.full else 60, 1.0)))
        wanted = same_rows(report, here, study)
        workers_killed(report, here, study, wanted)
        all_killed(report, here, study, wanted)
        scheduler_killed(report, here, study, wanted)
        disk_full(report, here, study, wanted)
    memory(report)
    bundled_study(report)


if __name__ == "__main__":
    main("sweep", measure)
