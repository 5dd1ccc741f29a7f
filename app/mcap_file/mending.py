"""Writes the missing end of an MCAP file, after a killed process or a full disk."""

from pathlib import Path

from mcap.data_stream import RecordBuilder
from mcap.records import Metadata, MetadataIndex

from app.files.bad_input import ABSENT, BadInput
from app.files.regular_file import open_regular
from app.mcap_file.opening import summary_of_cut

MENDED = "mended"
"""Name of the note that a repair leaves in a file; it says how many bytes were left out."""


def repair(path: Path) -> bool:
    """Write a file's end if it is missing; True if it was. Bytes after the last whole chunk are cut off.

    Raises:
        BadInput: the file cannot be read or written, is no MCAP file, or is damaged before its last record.
    """
    cut = summary_of_cut(path)
    if cut is None:
        return False
    summary, table = cut
    table.close()
    note = RecordBuilder()
    Metadata(name=MENDED, metadata={"lost": str(table.size - table.end)}).write(note)
    record = note.end()
    summary.metadata.append(MetadataIndex(offset=table.end, length=len(record), name=MENDED))
    end = record + summary.write(table.end + len(record))
    try:
        with open_regular(path, "r+b") as file:
            file.truncate(table.end)
            file.seek(table.end)
            while end:
                end = end[file.write(end) or 0 :]
    except OSError as error:
        raise BadInput(str(path), "", ABSENT, f"cannot be repaired ({error.strerror})") from None
    return True
