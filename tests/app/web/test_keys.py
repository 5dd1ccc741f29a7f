"""Keys of the page, as a browser sends them, and the switches of one page."""

from collections.abc import Callable
from typing import Any

import pytest

from app.web import keys
from app.web.server import Served
from pendant.inputs import Command
from pendant.modes import Mode
from tests.app.web.fake_loop import FakeLoop
from tests.app.web.raw_client import RawClient, until

Join = Callable[[], RawClient]


def press(served: Served, client: RawClient, letter: str) -> None:
    client.send(type="CommandTriggerMessage", uuid=served.keys.commands[letter]._impl.uuid)


def commanded(loop: FakeLoop, command: Command) -> Callable[[], bool]:
    return lambda: loop.advance() is None and command in loop.wishes[-1].inputs.commands


def test_no_key_is_one_of_visers(served: Served, join: Join) -> None:
    told = join().messages_until(lambda m: m["type"] == "RegisterCommandMessage" and m["props"]["hotkey"] == "B")
    shown: list[dict[str, Any]] = [m["props"] for m in told if m["type"] == "RegisterCommandMessage"]
    letters = [props["hotkey"] for props in shown]
    assert sorted(letters) == sorted(served.keys.commands)
    assert set(letters).isdisjoint("WASDQEK")  # its camera's, and its palette's with Ctrl
    assert all(props["modifier"] is None and props["label"] for props in shown)


def test_anyone_can_stop_with_a_key(served: Served, join: Join, loop: FakeLoop) -> None:
    operator, watcher = join(), join()
    operator.set(served.control._strips[0].take._impl.uuid, value=True)
    until(lambda: served.guard.operator.holder == 0, "client 0 has control")
    press(served, watcher, "X")
    until(commanded(loop, Command.EMERGENCY_STOP), "the stop")
    assert (served.guard.operator.holder, served.guard.refused.total()) == (0, 0)


@pytest.mark.parametrize("letter", ["L", "M", "P", "N"])
def test_a_watcher_presses_in_vain(served: Served, join: Join, loop: FakeLoop, letter: str) -> None:
    operator, watcher = join(), join()
    operator.set(served.control._strips[0].take._impl.uuid, value=True)
    until(lambda: served.guard.operator.holder == 0, "client 0 has control")
    press(served, watcher, letter)
    until(lambda: served.guard.refused["not the operator"] == 1, "refused")
    assert (loop.paused, loop.steps, served.docks.teach.lesson.waypoints) == (False, 0, [])


def test_a_disabled_or_unknown_key_is_refused(served: Served, join: Join, loop: FakeLoop) -> None:
    client = join()
    served.keys.commands["P"].disabled = True
    press(served, client, "P")
    client.send(type="CommandTriggerMessage", uuid="x")
    client.send(type="CommandTriggerMessage", uuid=served.panel.stop._impl.uuid)
    until(lambda: served.guard.refused.total() == 3, "refused")
    assert served.guard.refused == {"disabled control": 1, "unknown control": 2}
    assert not loop.paused


def test_free_drive_is_left_only_where_it_can_be(
    served: Served, join: Join, loop: FakeLoop, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(keys, "AGAIN", 0.0)
    client = join()
    press(served, client, "L")
    loop.mode = Mode.FREE_DRIVE
    until(lambda: not served.panel.leave.disabled, "it can be left")
    assert not commanded(loop, Command.LEAVE_FREE_DRIVE)()
    press(served, client, "L")
    until(commanded(loop, Command.LEAVE_FREE_DRIVE), "left")


def test_the_clock_is_paused_stepped_and_let_go_on(
    served: Served, join: Join, loop: FakeLoop, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(keys, "AGAIN", 0.0)
    client = join()
    press(served, client, "P")
    until(lambda: loop.paused and served.lab.clock.value == "Pause", "paused")
    press(served, client, "N")
    until(lambda: loop.steps == 1, "a step")
    press(served, client, "P")
    until(lambda: not loop.paused and served.lab.clock.value == "Run", "it goes on")


def test_a_key_held_down_counts_once(served: Served, join: Join, loop: FakeLoop) -> None:
    client, other = join(), join()
    for _ in range(20):
        press(served, client, "M")
    press(served, client, "N")
    until(lambda: loop.steps == 1, "the last of them")
    assert len(served.docks.teach.lesson.waypoints) == 1
    loop.mode = Mode.RUN
    until(lambda: served.docks.teach.register.disabled, "no waypoint while a program runs")
    client.close()
    until(lambda: served.keys._last == {}, "forgotten")
    press(served, other, "M")
    until(lambda: len(served.keys._last) == 1, "pressed")
    assert len(served.docks.teach.lesson.waypoints) == 1


def test_each_page_is_dark_or_light_for_itself(served: Served, join: Join) -> None:
    operator, watcher = join(), join()
    operator.set(served.control._strips[0].take._impl.uuid, value=True)
    pages = served.preferences._pages
    until(lambda: len(pages) == 2, "both have their switches")
    press(served, watcher, "T")
    told = watcher.messages_until(lambda m: m["type"] == "ThemeConfigurationMessage" and m["dark_mode"])
    assert told[-1]["colors"] is not None  # as in the light
    assert (pages[0].dark.value, pages[1].dark.value) == (False, True)
    watcher.set(pages[1].dark._impl.uuid, value=False)
    watcher.messages_until(lambda m: m["type"] == "ThemeConfigurationMessage" and not m["dark_mode"])
    press(served, watcher, "B")
    until(lambda: pages[1].speaker is not None, "sound")
    served.server.gui.set_panel_label("mark")
    served.server.flush()
    themes = operator.messages_until(lambda m: m["type"] == "SetGuiPanelLabelMessage" and m["label"] == "mark")
    assert [m["dark_mode"] for m in themes if m["type"] == "ThemeConfigurationMessage"] == [False]
    assert served.guard.refused.total() == 0
