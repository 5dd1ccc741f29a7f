"""Studies: the same rows whoever does the runs; no row lost whatever dies; a study of 100 000 rows."""

from pathlib import Path
from tempfile import TemporaryDirectory

import msgspec

from benchmarks.common import Report, main
from benchmarks.sweeps.costs import large, study_fields
from benchmarks.sweeps.faults import all_killed, disk_full, same_rows, scheduler_killed, workers_killed


def measure(report: Report) -> None:
    """Fill the report."""
    with TemporaryDirectory() as folder:
        here = Path(folder)
        large(report, here)
        study = here / "study.yaml"
        study.write_bytes(msgspec.yaml.encode(study_fields(120 if report.options.full else 60, 3.0)))
        wanted = same_rows(report, here, study)
        workers_killed(report, here, study, wanted)
        all_killed(report, here, study, wanted)
        scheduler_killed(report, here, study, wanted)
        disk_full(report, here, study, wanted)


if __name__ == "__main__":
    main("sweep", measure)
