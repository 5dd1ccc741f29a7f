"""The recordings of a folder."""

import os
import threading
import time
from pathlib import Path

import pytest

from app.files.checked import BadInput, convert
from app.log_reading.reader import read
from app.runs.runner import record
from app.session.prepare import prepare
from app.session.session_file import Session
from app.web.recordings import shelf as module
from app.web.recordings.shelf import MOST, Shelf


def recorded(folder: Path) -> Path:
    """A short recording in a folder."""
    session = convert({"title": "short", "duration": 0.3}, Session, "s.yaml")
    record(session, prepare(session, "s.yaml"), folder)
    return folder / "log.mcap"


def wait(shelf: Shelf) -> None:
    """Until a file is read."""
    end = time.monotonic() + 30.0
    while shelf.opening:
        assert time.monotonic() < end
        time.sleep(0.01)


def test_the_newest_comes_first_and_only_recordings(tmp_path: Path) -> None:
    shelf = Shelf(tmp_path, "ur5e")
    assert shelf.names() == ()
    for k in range(MOST + 3):
        path = tmp_path / f"recording-{k}.mcap"
        path.touch()
        os.utime(path, (k, k))
    (tmp_path / "notes.txt").touch()
    assert shelf.names() == tuple(f"recording-{k}.mcap" for k in range(MOST + 2, 2, -1))
    assert Shelf(tmp_path / "nowhere", "ur5e").names() == ()


def test_a_recording_is_opened_and_plays(tmp_path: Path) -> None:
    path = recorded(tmp_path)
    shelf = Shelf(tmp_path, "ur5e")
    shelf.open(path.name)
    shelf.open("another.mcap")  # one at a time
    wait(shelf)
    assert (shelf.failure, shelf.opening) == ("", "")
    assert shelf.player is not None
    assert shelf.player.playing
    shelf.close()
    assert shelf.player is None


def test_what_is_not_opened_is_one_line(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = recorded(tmp_path)
    (tmp_path / "broken.mcap").write_bytes(b"nothing")
    for shelf, name, said in (
        (Shelf(tmp_path, "ur5e"), "gone.mcap", "existing file"),
        (Shelf(tmp_path, "ur5e"), "broken.mcap", "broken.mcap"),
        (Shelf(tmp_path, "ur10e"), path.name, "arm"),
    ):
        shelf.open(name)
        wait(shelf)
        assert shelf.player is None
        assert said in shelf.failure
        assert "\n" not in shelf.failure
    monkeypatch.setattr(module, "read", lambda path: 1 // 0)
    shelf = Shelf(tmp_path, "ur5e")
    shelf.open(path.name)
    wait(shelf)
    assert "ZeroDivisionError" in shelf.failure


def test_what_is_closed_while_it_is_opened_stays_closed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The page stood still until the file was read."""
    path, gate = recorded(tmp_path), threading.Event()
    monkeypatch.setattr(module, "read", lambda where: gate.wait() and read(where))
    shelf = Shelf(tmp_path, "ur5e")
    shelf.open(path.name)
    shelf.close()
    shelf.open(path.name)
    shelf.close()
    gate.set()
    time.sleep(0.3)
    assert (shelf.player, shelf.opening, shelf.failure) == (None, "", "")


def test_what_is_given_to_a_browser_is_a_file_that_is_not_too_large(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = recorded(tmp_path)
    shelf = Shelf(tmp_path, "ur5e")
    assert shelf.content(path.name) == path.read_bytes()
    (tmp_path / "parts").mkdir()
    path.rename(tmp_path / "parts" / "001.mcap")
    assert shelf.names() == ("parts",)
    for name, said in (("parts", "in parts"), ("gone.mcap", "cannot be read")):
        with pytest.raises(BadInput, match=said):
            shelf.content(name)
    (tmp_path / "x.mcap").write_bytes(b"12345678901")
    monkeypatch.setattr(module, "LARGEST_DOWNLOAD", 10)
    with pytest.raises(BadInput, match="at most"):
        shelf.content("x.mcap")


def test_a_name_leads_to_no_other_folder(tmp_path: Path) -> None:
    assert Shelf(tmp_path, "ur5e").path("../../etc/passwd") == tmp_path / "passwd"
