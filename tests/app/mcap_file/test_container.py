"""What a recording keeps in memory while it is written."""

import tracemalloc

from mcap.records import Chunk

from app.mcap_file.file_summary import FileSummary, index_of

HOUR = 14_400
"""Chunks of an hour."""


def add(summary: FileSummary, count: int, as_bytes: bool) -> None:
    """The indices of so many chunks, as a recording makes them."""
    for k in range(count):
        chunk = Chunk("zstd", bytes(10), 250_000_000 * (k + 1), 250_000_000 * k, 0, 400_000)
        index = index_of(
            chunk, 100_000 * k, 100_000, offsets={channel: 100_000 * k + 10 * channel for channel in range(1, 8)}, indices=4_000
        )
        summary.done(index) if as_bytes else summary.chunks.append(index)


def test_the_index_is_the_same_whether_it_may_still_change_or_not() -> None:
    kept, packed, empty = FileSummary(), FileSummary(), FileSummary()
    add(kept, 5, as_bytes=False)
    add(packed, 5, as_bytes=True)
    assert kept.write(1_000) == packed.write(1_000)
    assert len(empty.write(1_000)) < len(packed.write(1_000))


def test_an_hour_of_recording_keeps_few_megabytes() -> None:
    """In bytes: as objects they took 10 MB an hour, a quarter of a gigabyte in a day."""
    summary = FileSummary()
    tracemalloc.start()
    before = tracemalloc.get_traced_memory()[0]
    add(summary, HOUR, as_bytes=True)
    grown = tracemalloc.get_traced_memory()[0] - before
    tracemalloc.stop()
    assert grown < 3.5e6
