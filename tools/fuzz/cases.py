"""One case, and batches of cases: what a target refuses is refused in one line, soon, and without much memory."""

import resource
import tempfile
import time
import traceback
from collections import Counter
from pathlib import Path
from random import Random

from hypothesis import HealthCheck, Phase, given, settings
from hypothesis import seed as seeded

from tools.fuzz.targets import REFUSED, Target, targets

SLOWEST = 2.0
"""A case takes at most so long [s]."""

LARGEST = 300_000
"""And so much more memory than the ones before [kB]."""


CHECKS = (HealthCheck.too_slow, HealthCheck.data_too_large, HealthCheck.filter_too_much, HealthCheck.large_base_example)


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


def batch(job: tuple[int, int, bool, int]) -> tuple[str, str, Counter[str], str]:
    """A batch of cases of one target: its name, the kind, the counts, and the defect that ended it."""
    number, seed, of_bytes, count = job
    target = targets()[number]
    kind = "bytes" if of_bytes else "structured"
    with tempfile.TemporaryDirectory() as folder:
        first = Path(folder) / f"first{target.suffix}"
        first.write_bytes(target.seeds[0])
        target.run(first)  # what is loaded and compiled once does not count
        first.unlink()
        try:
            told = (by_bytes if of_bytes else structured)(target, seed, count, Path(folder))
            return target.name, kind, told, ""
        except Found as found:
            left = next(Path(folder).iterdir(), None)
            kept = Path("out/fuzz") / f"{target.name.replace(' ', '-')}-{kind}-{seed}{target.suffix}"
            if left is not None:
                kept.parent.mkdir(parents=True, exist_ok=True)
                kept.write_bytes(left.read_bytes())
            return target.name, kind, Counter(cases=1), f"{found}\nkept in {kept}"
