"""Keys of the page, as a browser sends them, and the switches of one page."""

from collections.abc import Callable
from typing import Any

import pytest

from app.web import keys
from app.web.server import Served
from pendant.inputs import Command
from pendant.tick.modes import Mode
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
    until(lambda: loop.paused and served.lab.clock.value == "Freeze", "paused")
    press(served, client, "N")
    until(lambda: loop.steps == 1, "a step")
    press(served, client, "P")
    until(lambda: not loop.paused and served.lab.clock.value == "Go on", "it goes on")


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


def painted(client: RawClient, dark: bool, floor: float) -> tuple[dict[str, Any], dict[str, Any]]:
    """Wait until the page is dark or light, and its new floor lies where it did; its theme and the look of its floor."""
    seen: dict[str, dict[str, Any]] = {}

    def see(message: dict[str, Any]) -> bool:
        if message["type"] == "ThemeConfigurationMessage":
            seen.clear()
        seen[message["type"]] = message
        there = message["type"] == "SetPositionMessage" and message["name"] == "/floor"
        theme = seen.get("ThemeConfigurationMessage", {"dark_mode": not dark})
        return there and abs(message["position"][2] - floor) < 1e-6 and theme["dark_mode"] is dark and "GridMessage" in seen

    client.messages_until(see)
    return seen["ThemeConfigurationMessage"], seen["GridMessage"]["props"]


def test_each_page_is_dark_or_light_for_itself(served: Served, join: Join) -> None:
    until(lambda: served._shown >= 0, "the first picture, which lays the floor")
    served.scene._floor.position = (0.0, 0.0, -0.4)
    operator, watcher = join(), join()
    operator.set(served.control._strips[0].take._impl.uuid, value=True)
    pages = served.preferences._pages
    until(lambda: len(pages) == 2, "both have their switches")
    press(served, watcher, "T")
    theme, floor = painted(watcher, True, -0.4)
    assert theme["colors"] is not None  # as in the light
    assert max(floor["plane_color"]) < 100
    assert (pages[0].dark.value, pages[1].dark.value) == (False, True)
    watcher.set(pages[1].dark._impl.uuid, value=False)
    assert min(painted(watcher, False, -0.4)[1]["plane_color"]) > 200
    press(served, watcher, "B")
    until(lambda: pages[1].speaker is not None, "sound")
    served.server.gui.set_panel_label("mark")
    served.server.flush()
    told = operator.messages_until(lambda m: m["type"] == "SetGuiPanelLabelMessage" and m["label"] == "mark")
    assert [m["dark_mode"] for m in told if m["type"] == "ThemeConfigurationMessage"] == [False]
    assert [min(m["props"]["plane_color"]) > 200 for m in told if m["type"] == "GridMessage"] == [True]
    assert served.guard.refused.total() == 0
