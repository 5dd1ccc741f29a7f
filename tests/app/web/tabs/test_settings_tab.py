"""Settings as controls."""

from collections.abc import Callable
from threading import Thread

import pytest

from app.web.server import Served
from app.web.tabs.settings_tab import BASIC, VIEWS
from app.web.tuning.presets import as_file, from_file, presets
from app.web.tuning.setting_words import CHANGED, SAFETY, SECTIONS, section_of, title_of
from pendant.all_settings import Settings, apply, describe, safety_checksum
from pendant.limits.axis_locks import JOINTS
from pendant.tick.modes import Mode
from tests.app.web.fake_loop import FakeLoop
from tests.app.web.raw_client import RawClient, until
from tests.pendant.test_all_settings import other

Join = Callable[[], RawClient]


def view(served: Served, client: RawClient, name: str) -> None:
    tab = served.docks.settings
    if tab.view.value != name or name == VIEWS[2]:
        client.set(tab.view._impl.uuid, value=name)
    until(lambda: tab.section.visible == (name == VIEWS[2]) and tab.preset.visible == (name == VIEWS[1]), f"view {name}")


def expert(served: Served, client: RawClient) -> None:
    tab = served.docks.settings
    view(served, client, VIEWS[2])
    client.set(tab.expert._impl.uuid, value=True)
    until(lambda: tab.section.options == tuple(map(title_of, SECTIONS)), "all sections")


def choose(served: Served, client: RawClient, section: str) -> None:
    tab = served.docks.settings
    if not tab.section.visible:
        view(served, client, VIEWS[2])
    client.set(tab.section._impl.uuid, value=title_of(section))
    until(lambda: bool(tab.controls) and all(name.startswith(f"{section}.") for name in tab.controls), f"section {section}")


HERE = [row for row in describe() if row.name not in {f"joints.{name}" for name in JOINTS[6:]}]
"""The settings that an arm of six joints has."""


def test_every_setting_is_in_a_section_and_has_a_control_with_its_range(served: Served, join: Join) -> None:
    client = join()
    tab = served.docks.settings
    expert(served, client)
    seen: set[str] = set()
    for section in (*SECTIONS[1:], SECTIONS[0]):
        choose(served, client, section)
        for row in HERE:
            if section_of(row) == section:
                control = tab.controls[row.name]
                seen.add(row.name)
                assert control.value == row.default
                assert row.low is None or (control.min, control.max) == (row.low, row.high)
        hints = "".join(control.hint for control in tab.controls.values())
        assert all(row.id in hints for row in HERE if section_of(row) == section)
        texts = "".join(text.shown for text in tab._texts.values())
        assert not any(row.id in texts for row in describe())
    assert seen == {row.name for row in HERE}
    assert {row.name for row in describe()} - seen == {f"joints.j{number}" for number in range(7, 13)}, "this arm has six"


def test_the_basic_settings_are_shown_and_what_was_changed(served: Served, join: Join, loop: FakeLoop) -> None:
    client = join()
    tab = served.docks.settings
    assert tab.section.options == tuple(map(title_of, BASIC))
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
    until(lambda: safety_checksum(loop.settings) in served.docks.settings._line.shown, "the checksum")
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
    until(lambda: loop.advance() is None and loop.wishes[-1].inputs.settings == {"free_drive.gain": 2.0}, "the wish")
    assert control.value == 2.0
    loop.refuse()
    until(lambda: control.value == 1.0, "set back")


def test_the_safety_page_has_a_dozen_values_that_people_know(served: Served, join: Join, loop: FakeLoop) -> None:
    client = join()
    tab = served.docks.settings
    assert set(tab.controls) == set(SAFETY)
    assert len(SAFETY) <= 12
    client.set(tab.controls["robot_limits.reduced.tool_speed"]._impl.uuid, value=0.1)
    until(
        lambda: loop.advance() is None and loop.wishes[-1].inputs.settings == {"robot_limits.reduced.tool_speed": 0.1}, "the wish"
    )


def test_what_is_typed_counts_when_it_is_all_typed(served: Served, join: Join, loop: FakeLoop) -> None:
    client = join()
    control = served.docks.settings.controls["free_drive.period"]
    for value in (1.0, 10.0, 15.0):
        client.set(control._impl.uuid, value=value)
    until(lambda: loop.advance() is None and bool(loop.wishes[-1].inputs.settings), "a wish")
    assert loop.wishes[-1].inputs.settings == {"free_drive.period": 15.0}


def test_a_preset_lists_its_changes_then_is_taken_and_undone(served: Served, join: Join, loop: FakeLoop) -> None:
    client = join()
    tab = served.docks.settings
    view(served, client, VIEWS[1])
    until(lambda: "Nothing would change" in tab.listed.shown, "what runs is as shipped")
    client.set(tab.preset._impl.uuid, value="Classroom")
    until(lambda: "Limits during free-drive: Tcp speed" in tab.listed.shown, "the list")
    assert "<td>1.5 m/s</td><td>0.7 m/s</td>" in tab.listed.shown
    client.set(tab.take._impl.uuid, value=True)
    until(lambda: loop.advance() is None and bool(loop.wishes[-1].inputs.settings), "the wish")
    wanted = loop.wishes[-1].inputs.settings
    assert apply(Settings(), wanted) == presets()["Classroom"].whole
    loop.settings = apply(Settings(), wanted)
    until(lambda: not tab.undo.disabled and "Nothing would change" in tab.listed.shown, "taken")
    client.set(tab.undo._impl.uuid, value=True)
    until(lambda: loop.advance() is None and bool(loop.wishes[-1].inputs.settings), "undone")
    assert apply(loop.settings, loop.wishes[-1].inputs.settings) == Settings()


def test_search_finds_by_words_sections_and_requirements(served: Served, join: Join) -> None:
    client = join()
    tab = served.docks.settings
    view(served, client, VIEWS[2])
    client.set(tab.search._impl.uuid, value="tether radius")
    until(lambda: "walls.operation_radius" in tab.controls, "found")
    assert all(name.startswith("walls.") for name in tab.controls)
    client.set(tab.search._impl.uuid, value="no such words")
    until(lambda: tab.controls == {}, "nothing found")


def test_settings_are_saved_as_a_file_that_lists_its_changes_before_they_are_taken(loop: FakeLoop, still: Served) -> None:
    tab = still.docks.settings
    loop.settings = apply(Settings(), {"free_drive.period": 7.0, "contact.on": True})
    content = as_file(loop.settings)
    loop.settings = Settings()
    tab.view.value, tab._chosen = VIEWS[1], VIEWS[1]
    tab.read("mine.yaml", content)
    assert tab.preset.value == "Saved"
    assert "<td>7 s</td>" in tab.listed.shown
    loop.advance()
    assert loop.wishes[-1].inputs.settings == {}  # nothing is taken yet
    assert from_file("mine.yaml", content).settings == {"free_drive.period": 7.0, "contact.on": True}


@pytest.mark.parametrize(
    ("content", "said"),
    [
        (b"title: x\ntext: y\nsettings: {free_drive.period: 1e9}", "settings.free_drive.period"),
        (b"title: x\ntext: y\nsettings: {free_drive.periods: 1}", "settings.free_drive.periods"),
        (b"settings: {}", "title"),
        (b"<b>no</b>", "&lt;b&gt;"),
        (b"", "mine.yaml"),
    ],
)
def test_a_file_of_settings_that_makes_no_sense_is_refused_in_a_line(still: Served, content: bytes, said: str) -> None:
    tab = still.docks.settings
    before = tab.preset.options
    tab.read("mine.yaml", content)
    assert "File refused" in tab.message.shown
    assert said in tab.message.shown
    assert "<b>no" not in tab.message.shown
    assert tab.preset.options == before


def test_a_file_named_as_a_shipped_preset_stands_beside_it(still: Served) -> None:
    tab = still.docks.settings
    tab.read("mine.yaml", b"title: Classroom\ntext: mine\nsettings: {}")
    assert tab.preset.value == "Classroom (file)"
    assert tab.preset.options[-1] == "Classroom (file)"


def test_a_file_is_not_read_while_the_controls_are_made(still: Served) -> None:
    tab = still.docks.settings
    before = tab.preset.options
    reader = Thread(target=tab.read, args=("mine.yaml", b"title: Mine\ntext: mine\nsettings: {}"))
    with tab._lock:
        reader.start()
        reader.join(0.2)
        assert tab.preset.options == before
    reader.join()
    assert tab.preset.options[-1] == "Mine"


def test_whatever_the_safety_page_shows_changes_its_checksum(loop: FakeLoop, still: Served) -> None:
    tab = still.docks.settings

    def page() -> tuple[str, tuple[object, ...]]:
        tab.show(loop.latest(), [])
        checksum = tab._line.shown.split("Safety checksum</dt><dd>")[1][:8]
        return checksum, (tab.limits.shown, *(control.value for control in tab.controls.values()))

    shipped, shown = page()
    seen = {shipped: shown}
    for row in describe():
        loop.settings = apply(Settings(), {row.name: other(row)})
        checksum, now = page()
        assert seen.setdefault(checksum, now) == now, f"{row.name} is shown, and the checksum stays"
    assert len({values for values in seen.values() if values != shown}) > len(SAFETY)
