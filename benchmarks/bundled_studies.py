"""The bundled studies, as their pages have it: `pendant sweep NAME --quick`, with two workers, report included.

The quick size of this bench does one of them, the full size all, one after another. What they wrote stays beside its results.
"""

import shutil
import time

from app.studies.data_set import read_data_set
from app.studies.study_file import studies
from benchmarks.common import Report, main
from benchmarks.sweeps.processes import command, finished

LONGEST = 300.0
"""What one may take [s]."""

QUICK = "contact-delay"


def measure(report: Report) -> None:
    """Fill the report."""
    seed = report.options.seed
    for name in studies() if report.options.full else [QUICK]:
        out = report.options.out / "studies" / f"{name}-{seed}"
        shutil.rmtree(out, ignore_errors=True)
        start = time.perf_counter()
        code = finished(command(name, out, "--quick", "--workers", "2", "--seed", str(seed)))
        took = time.perf_counter() - start
        report.row(f"{name}: exit code", code, "", at_most=0)
        report.row(f"{name}: time", took, "s", at_most=LONGEST, n=read_data_set(out / "rows").num_rows)


if __name__ == "__main__":
    main("bundled_studies", measure)
