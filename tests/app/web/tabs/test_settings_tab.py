"""Settings as controls."""

from collections.abc import Callable

import pytest

from app.web.server import Served
from app.web.tabs.settings_tab import BASIC, CHANGED, SECTIONS, section_of
from pendant.all_settings import Settings, apply, describe, limits_checksum
from pendant.tick.modes import Mode
from tests.app.web.fake_loop import FakeLoop
from tests.app.web.raw_client import RawClient, until

Join = Callable[[], RawClient]


def expert(served: Served, client: RawClient) -> None:
    tab = served.docks.settings
    client.set(tab.expert._impl.uuid, value=True)
    until(lambda: tab.section.options == SECTIONS, "all sections")


def choose(served: Served, client: RawClient, section: str) -> None:
    tab = served.docks.settings
    client.set(tab.section._impl.uuid, value=section)
    until(lambda: all(name.startswith(f"{section}.") for name in tab.controls), f"section {section}")


def test_every_setting_is_in_a_section_and_has_a_control_with_its_range(served: Served, join: Join) -> None:
    client = join()
    tab = served.docks.settings
    expert(served, client)
    seen: set[str] = set()
    for section in (*SECTIONS[1:], SECTIONS[0]):
        choose(served, client, section)
        for row in describe():
            if section_of(row) == section:
                control = tab.controls[row.name]
                seen.add(row.name)
                assert control.value == row.default
                assert row.low is None or (control.min, control.max) == (row.low, row.high)
        texts = "".join(text.content for text in tab._texts)
        assert all(row.id in texts for row in describe() if section_of(row) == section)
    assert seen == {row.name for row in describe()}


def test_the_basic_settings_are_shown_and_what_was_changed(served: Served, join: Join, loop: FakeLoop) -> None:
    client = join()
    tab = served.docks.settings
    assert tab.section.options == BASIC
    choose(served, client, "walls")
    basic = {row.name for row in describe() if row.basic}
    assert set(tab.controls) == {name for name in basic if name.startswith("walls.")}
    loop.settings = apply(Settings(), {"walls.averaging": 0.5})
    choose(served, client, "contact")
    choose(served, client, "walls")
    assert set(tab.controls) == {name for name in basic if name.startswith("walls.")} | {"walls.averaging"}
    client.set(tab.defaults._impl.uuid, value=True)
    of_walls = {row.name: row.default for row in describe() if row.name.startswith("walls.")}
    until(lambda: loop.advance() is None and loop.wishes[-1].inputs.settings == of_walls, "the whole section")


def test_a_choice_is_a_list_of_its_words(served: Served, join: Join, loop: FakeLoop) -> None:
    client = join()
    choose(served, client, "walls")
    control = served.docks.settings.controls["walls.tether_reaction"]
    assert control.options == ("stay", "leave", "stop")
    client.set(control._impl.uuid, value="leave")
    until(lambda: loop.advance() is None and loop.wishes[-1].inputs.settings == {"walls.tether_reaction": "leave"}, "the wish")
    client.set(control._impl.uuid, value="fly")
    until(lambda: served.guard.refused["value not allowed"] == 1, "refused")


def test_a_changed_value_goes_to_the_desk_and_is_marked_once_it_holds(served: Served, join: Join, loop: FakeLoop) -> None:
    client = join()
    choose(served, client, "free_drive")
    control = served.docks.settings.controls["free_drive.period"]
    client.set(control._impl.uuid, value=7.5)
    until(lambda: loop.advance() is None and loop.wishes[-1].inputs.settings == {"free_drive.period": 7.5}, "the wish")
    assert not control.label.startswith(CHANGED)
    loop.settings = apply(Settings(), {"free_drive.period": 7.5})
    until(lambda: control.label.startswith(CHANGED), "marked")
    until(lambda: limits_checksum(loop.settings) in served.docks.settings._line.shown, "the checksum")
    client.set(served.docks.settings.defaults._impl.uuid, value=True)
    until(lambda: loop.advance() is None and loop.wishes[-1].inputs.settings.get("free_drive.period") == 3.0, "the default")


@pytest.mark.parametrize(("name", "value"), [("free_drive.gain", 3.1), ("free_drive.gain", True), ("free_drive.gain", "1")])
def test_a_value_out_of_range_is_refused_at_the_door(served: Served, join: Join, name: str, value: object) -> None:
    client = join()
    choose(served, client, "free_drive")
    client.set(served.docks.settings.controls[name]._impl.uuid, value=value)
    until(lambda: served.guard.refused["value not allowed"] == 1, "refused")


def test_limits_are_locked_while_the_arm_is_free_and_periods_are_not(served: Served, join: Join, loop: FakeLoop) -> None:
    client = join()
    choose(served, client, "free_drive")
    controls = served.docks.settings.controls
    loop.mode = Mode.FREE_DRIVE
    until(lambda: controls["free_drive.gain"].disabled, "locked")
    assert not controls["free_drive.period"].disabled
    assert served.docks.settings.defaults.disabled
    loop.mode = Mode.TEACH
    until(lambda: not controls["free_drive.gain"].disabled, "open again")


def test_a_refused_change_is_set_back_on_the_page(served: Served, join: Join, loop: FakeLoop) -> None:
    client = join()
    choose(served, client, "free_drive")
    control = served.docks.settings.controls["free_drive.gain"]
    client.set(control._impl.uuid, value=2.0)
    until(lambda: control.value == 2.0, "shown")
    loop.refuse()
    until(lambda: control.value == 1.0, "set back")
