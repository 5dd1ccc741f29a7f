"""The page records what is done on it, on a switch, and the file shows it again."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from playwright.sync_api import Page

from app.log.playback import Player
from app.log.reader import read
from tests.e2e.cell import Cell

pytestmark = pytest.mark.e2e


def test_a_push_is_recorded_between_two_clicks(
    visit: Callable[[], Page], cell: Cell, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    page = visit()
    page.get_by_role("tab", name="Record").click()
    switch = page.locator(f'[id="{cell.served.docks.recording.switch._impl.uuid}"]')
    switch.click()
    cell.wait(lambda: cell.loop.watch is not None, "it records")
    page.get_by_text("recording-2").wait_for()
    cell.drag(page, 0, cell.position("wrist_3"), (-40.0, -60.0))
    cell.pass_time(0.5)
    page.mouse.up()
    switch.click()
    page.get_by_text("saved").wait_for()
    cell.served.recording.close()
    (path,) = tmp_path.iterdir()
    log = read(path)
    assert log.whole
    assert np.all(np.diff(log.ticks) == 1)
    assert Player(log).end > 0.5
    assert np.linalg.norm(log.truth["touch_force"], axis=1).max() > 1.0
