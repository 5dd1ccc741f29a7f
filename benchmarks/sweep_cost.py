"""What the engine costs beside the ticks of the sessions that it runs, in time and in memory."""

from benchmarks.common import Report, main
from benchmarks.sweeps.costs import cost, memory


def measure(report: Report) -> None:
    """Fill the report."""
    cost(report)
    memory(report)


if __name__ == "__main__":
    main("sweep_cost", measure)
