import errno
import os
from pathlib import Path

import pytest

from app.files.bad_input import BadInput
from app.studies.row_journal import RowJournal, rows


def test_rows_come_back_in_order(tmp_path: Path) -> None:
    path = tmp_path / "journal"
    assert list(rows(path)) == []
    for part in ([0, 1], [2]):
        with RowJournal(path) as journal:
            for k in part:
                journal.append({"run": k, "text": "a\nb"})
    assert list(rows(path)) == [{"run": k, "text": "a\nb"} for k in range(3)]


@pytest.mark.parametrize("cut", range(1, 30, 4))
def test_what_a_crash_left_of_a_line_is_cut_off(tmp_path: Path, cut: int) -> None:
    path = tmp_path / "journal"
    with RowJournal(path) as journal:
        journal.append({"run": 0})
        journal.append({"run": 1, "text": "long enough to cut"})
    path.write_bytes(path.read_bytes()[:-cut])
    assert list(rows(path)) == [{"run": 0}]
    with RowJournal(path) as journal:
        journal.append({"run": 2})
    assert [row["run"] for row in rows(path)] == [0, 2]


def test_a_line_of_zeros_is_none(tmp_path: Path) -> None:
    path = tmp_path / "journal"
    with RowJournal(path) as journal:
        journal.append({"run": 0})
    with path.open("ab") as file:
        file.write(b"\0" * 40 + b"\n")
    assert list(rows(path)) == [{"run": 0}]


def test_a_full_disk_leaves_the_file_as_it_was(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "journal"

    def full(_: int) -> None:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    with RowJournal(path) as journal:
        journal.append({"run": 0})
        with monkeypatch.context() as patched:
            patched.setattr(os, "fsync", full)
            with pytest.raises(BadInput, match="No space left on device"):
                journal.append({"run": 1})
        assert [row["run"] for row in rows(path)] == [0]
        journal.append({"run": 1})
    assert [row["run"] for row in rows(path)] == [0, 1]


def test_a_folder_that_is_not_there_is_one_line(tmp_path: Path) -> None:
    with pytest.raises(BadInput, match="cannot be written"):
        RowJournal(tmp_path / "no" / "journal")
