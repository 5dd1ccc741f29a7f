"""Fuzz every way in for a time, on all cores: python -m tools.fuzz [--seconds 3600] [--cases 100000]. Exit code 1: a defect."""

import argparse
import os
import sys
import time
from collections import Counter
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context

from tools.fuzz.cases import batch
from tools.fuzz.targets import targets

BATCH = 250
"""Cases that are drawn at once."""

ENOUGH = 20
"""Defects after which it ends: there is something to mend."""


def main() -> int:
    """Run batches until the time is over, or until there were so many cases of each kind."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seconds", type=float, default=3600.0)
    parser.add_argument("--cases", type=int, default=10**9, help="of each kind, structured and bytes; then it ends")
    parser.add_argument("--seed", type=int, default=1)
    asked = parser.parse_args()
    names = [target.name for target in targets()]
    told: dict[tuple[str, str], Counter[str]] = {}
    done, defects = Counter[str](), 0
    begun, seed = time.monotonic(), asked.seed * 1_000_000_000
    with ProcessPoolExecutor(os.cpu_count(), mp_context=get_context("spawn")) as pool:
        while time.monotonic() - begun < asked.seconds and defects < ENOUGH:
            if min(done["structured"], done["bytes"]) >= asked.cases:
                break
            seed += 100_000
            jobs = [(number, seed + 10 * number + kind, bool(kind), BATCH) for number in range(len(names)) for kind in (0, 1)]
            for name, kind, counts, defect in pool.map(batch, jobs):
                told.setdefault((name, kind), Counter()).update(counts)
                done[kind] += counts["cases"]
                if defect:
                    defects += 1
                    sys.stdout.write(f"{defect}\n")
    for (name, kind), counts in sorted(told.items()):
        sys.stdout.write(f"{name:16} {kind:11} {counts['cases']:8d} cases, {counts['accepted']:8d} accepted\n")
    took = time.monotonic() - begun
    sys.stdout.write(f"{done['structured']} structured, {done['bytes']} of bytes, {defects} defects, {took:.0f} s\n")
    return 1 if defects else 0


if __name__ == "__main__":
    sys.exit(main())
