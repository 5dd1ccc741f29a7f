from pathlib import Path

from app.learning.exporting import Exporting
from tests.app.web.raw_client import until


def test_a_process_of_its_own_exports_beside_the_recording(tmp_path: Path, monkeypatch) -> None:
    said = "import sys; print('3 demonstrations, 90 rows:', sys.argv[-1]); print(sys.argv[1:3])"
    monkeypatch.setattr("app.learning.exporting.COMMAND", said)
    exporting = Exporting()
    assert not exporting.on
    exporting.start(tmp_path / "recording-1.mcap")
    until(lambda: not exporting.on, "it has ended", seconds=60.0)
    folder = tmp_path / "recording-1-demonstrations"
    assert exporting.folder == folder
    assert not exporting.failed
    assert exporting.told == f"3 demonstrations, 90 rows: {folder} ['export', '{tmp_path / 'recording-1.mcap'}']"
    folder.mkdir()
    exporting.start(tmp_path / "recording-1.mcap")
    assert exporting.folder == tmp_path / "recording-1-demonstrations-2"
    exporting.close()


def test_what_cannot_be_exported_is_told(tmp_path: Path) -> None:
    exporting = Exporting()
    exporting.start(tmp_path / "gone.mcap")
    until(lambda: not exporting.on, "it has ended", seconds=60.0)
    assert exporting.failed
    assert exporting.told.endswith("gone.mcap: expected an existing file")


def test_one_at_a_time_and_none_after_the_end(tmp_path: Path, monkeypatch) -> None:
    monkeypatch.setattr("app.learning.exporting.COMMAND", "import time; time.sleep(60)")
    exporting = Exporting()
    exporting.start(tmp_path / "a.mcap")
    exporting.start(tmp_path / "b.mcap")
    assert exporting.folder == tmp_path / "a-demonstrations"
    assert exporting.on
    exporting.close()
    assert not exporting.on
    exporting.close()
