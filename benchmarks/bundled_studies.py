"""The bundled studies, as their pages have it: `pendant sweep NAME --quick`, with two workers, report included.

The quick size of this bench does the shortest of them; the others are run one after another by the full size.
"""

import time
from pathlib import Path
from tempfile import TemporaryDirectory

from app.studies.data_set import read_data_set
from app.studies.study_file import studies
from benchmarks.common import Report, main
from benchmarks.sweeps.processes import command, finished

LONGEST = 300.0
"""What one may take [s]."""

SHORTEST = "contact-delay"


def measure(report: Report) -> None:
    """Fill the report."""
    for name in studies() if report.options.full else [SHORTEST]:
        with TemporaryDirectory() as folder:
            out = Path(folder) / name
            start = time.perf_counter()
            code = finished(command(name, out, "--quick", "--workers", "2", "--seed", str(report.options.seed)))
            took = time.perf_counter() - start
            n = read_data_set(out / "rows").num_rows
            report.row(f"{name}, quick: time", took, "s", at_most=LONGEST, n=n)
            report.row(f"{name}, quick: exit code", code, "", at_most=0)


if __name__ == "__main__":
    main("bundled_studies", measure)
