"""The page records what is done on it, on a switch; the file is replayed there, and taken away."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from playwright.sync_api import Page

from app.log_reading.playback import Player
from app.log_reading.reader import read
from tests.e2e.cell import Cell
from tests.e2e.finger import pointer, tap
from tests.e2e.test_everyday import open_tab
from tests.e2e.test_tasks import LATER, click

pytestmark = pytest.mark.e2e


@pytest.fixture(autouse=True)
def in_a_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Recordings go into a folder of their own."""
    folder = tmp_path / "recordings"
    folder.mkdir()
    monkeypatch.chdir(folder)
    return folder


def record_a_push(page: Page, cell: Cell) -> None:
    """The arm is pushed between two clicks."""
    open_tab(page, "Record")
    switch = page.get_by_label("Record", exact=True).first
    tap(switch)
    cell.wait(lambda: cell.loop.watch is not None, "it records")
    page.get_by_text("recording-2").first.wait_for()
    cell.drag(page, 0, cell.position("wrist_3"), (-40.0, -60.0))
    cell.pass_time(0.5)
    pointer(page).up()
    tap(switch)
    page.get_by_text("saved").wait_for()


@pytest.mark.parametrize(("width", "height"), LATER)
def test_record_and_replay(
    visit: Callable[..., Page], cell: Cell, tmp_path: Path, in_a_folder: Path, width: int, height: int
) -> None:
    page = visit(width, height)
    record_a_push(page, cell)
    cell.wait(lambda: not cell.served.recording.writing, "the file is whole")
    (path,) = in_a_folder.iterdir()
    log = read(path)
    assert log.whole
    assert np.all(np.diff(log.ticks) == 1)
    assert np.linalg.norm(log.truth["touch_force"], axis=1).max() > 1.0
    ghost = cell.served.docks.recording.replay.ghost
    click(page, "Replay")
    page.get_by_text("Replay: the violet arm").wait_for()
    cell.wait(lambda: ghost.posture is not None, "the ghost moves")
    page.get_by_role("button", name="Replay", exact=True).wait_for(timeout=(Player(log).end + 20.0) * 1000.0)  # at its end
    assert ghost.posture == pytest.approx(tuple(log.state["q"][-1].tolist()))
    with page.expect_download() as saved:
        click(page, "Download")
    copy = tmp_path / "copy.mcap"
    saved.value.save_as(copy)
    assert copy.read_bytes() == path.read_bytes()
    click(page, "End the replay")
    cell.wait(lambda: ghost.posture is None, "over")
