"""One case, and batches of cases: what a target refuses is refused in one line, soon, and without much memory."""

import resource
import tempfile
import time
import traceback
from collections import Counter
from pathlib import Path
from random import Random
from typing import NamedTuple

from hypothesis import HealthCheck, Phase, given, settings
from hypothesis import seed as seeded

from tools.fuzz.targets import REFUSED, Target, targets

SLOWEST = 2.0
"""A case takes at most so long [s]."""

LARGEST = 300_000
"""And so much more memory than the ones before [kB]."""


CHECKS = (HealthCheck.too_slow, HealthCheck.data_too_large, HealthCheck.filter_too_much, HealthCheck.large_base_example)


class Batch(NamedTuple):
    """Cases that are drawn at once."""

    number: int  # of the target
    seed: int
    of_bytes: bool  # damaged bytes, or else cases that fit the types
    count: int


class BatchOutcome(NamedTuple):
    """What came of a batch."""

    target: str
    kind: str
    counts: Counter[str]
    defect: str  # that ended it; "" where there is none


class Found(Exception):
    """A case that is a defect."""


def damaged(data: bytes, chance: Random) -> bytes:
    """The bytes with some turned, taken out, doubled, or the end cut."""
    made = bytearray(data)
    for _ in range(chance.randint(1, 6)):
        at, length = chance.randrange(len(made) + 1), chance.choice((1, 1, 2, 8, 64))
        what = chance.randrange(5)
        if what == 0:
            made[at : at + length] = chance.randbytes(min(length, len(made) - at))
        elif what == 1:
            del made[at : at + length]
        elif what == 2:
            made[at:at] = made[at : at + length] * chance.randint(1, 50)
        elif what == 3:
            made[at:at] = chance.choice((b"1e308", b"-0", b"\x00", b"[[[[", b"{a: ", b"\xff", b"- ", b"99999999999999999999"))
        elif chance.random() < 0.3:
            del made[at:]
    return bytes(made)


def run(target: Target, content: bytes, folder: Path) -> bool:
    """One case. Returns whether it was accepted. Raises Found: it is a defect."""
    path = folder / f"case{target.suffix}"
    path.write_bytes(content)
    before, begun = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss, time.process_time()
    try:
        target.run(path)
        accepted = True
    except REFUSED as refusal:
        line = str(refusal)
        if "\n" in line or not line.isprintable():
            raise Found(f"{target.name}: not one line: {line!r}") from None
        accepted = False
    except Exception as error:
        raise Found(f"{target.name}: {traceback.format_exc()}") from error
    took = time.process_time() - begun
    grown = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before
    if took > SLOWEST or grown > LARGEST:
        raise Found(f"{target.name}: {took:.2f} s of processor time, {grown / 1000:.0f} MB")
    return accepted


def structured(target: Target, seed: int, count: int, folder: Path) -> Counter[str]:
    """Cases that fit the types."""
    told: Counter[str] = Counter()

    @seeded(seed)
    @settings(max_examples=count, database=None, deadline=None, phases=[Phase.generate], suppress_health_check=CHECKS)
    @given(target.structured)
    def one(content: bytes) -> None:
        told["cases"] += 1
        told["accepted"] += run(target, content, folder)

    one()
    return told


def by_bytes(target: Target, seed: int, count: int, folder: Path) -> Counter[str]:
    """Cases whose bytes are damaged."""
    chance, told = Random(seed), Counter[str]()
    for _ in range(count):
        told["cases"] += 1
        told["accepted"] += run(target, damaged(chance.choice(target.seeds), chance), folder)
    return told


def _named(job: Batch) -> tuple[Target, str]:
    return targets()[job.number], "bytes" if job.of_bytes else "structured"


def batch(job: Batch) -> BatchOutcome:
    """Run a batch of cases of one target."""
    target, kind = _named(job)
    with tempfile.TemporaryDirectory() as folder:
        first = Path(folder) / f"first{target.suffix}"
        first.write_bytes(target.seeds[0])
        target.run(first)  # what is loaded and compiled once does not count
        first.unlink()
        try:
            told = (by_bytes if job.of_bytes else structured)(target, job.seed, job.count, Path(folder))
            return BatchOutcome(target.name, kind, told, "")
        except Found as found:
            left = next(Path(folder).iterdir(), None)
            kept = Path("out/fuzz") / f"{target.name.replace(' ', '-')}-{kind}-{job.seed}{target.suffix}"
            if left is not None:
                kept.parent.mkdir(parents=True, exist_ok=True)
                kept.write_bytes(left.read_bytes())
            return BatchOutcome(target.name, kind, Counter(cases=1), f"{found}\nkept in {kept}")


def ended(job: Batch) -> BatchOutcome:
    """What stands for a batch that ended its process each time."""
    target, kind = _named(job)
    defect = f"{target.name}: {job.count} cases of kind {kind}, seed {job.seed}: the process that ran them ended"
    return BatchOutcome(target.name, kind, Counter(cases=1), defect)
