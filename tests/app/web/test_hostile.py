"""Every control of the page, used by those who may not, or as nobody may."""

import contextlib
import math
import socket
from collections.abc import Callable, Iterator
from dataclasses import fields
from typing import Any

import pytest
import viser

from app.web.access import message_gate as gate
from app.web.access.door import MAX_CLIENTS
from app.web.access.takes import MAX_TEXT
from app.web.server import Served
from pendant.inputs import Inputs
from tests.app.web.fake_loop import FakeLoop
from tests.app.web.raw_client import RawClient, until
from tests.app.web.tabs.test_teach_tab import register, upload

Join = Callable[[], RawClient]
EVIL = '<img src=x onerror="window.evil=1">'
UPGRADE = (
    "GET / HTTP/1.1\r\nHost: {host}\r\nUpgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Version: 13\r\n"
    "Sec-WebSocket-Key: MDEyMzQ1Njc4OWFiY2RlZg==\r\nSec-WebSocket-Protocol: viser-v1.1.1\r\n\r\n"
)


@pytest.fixture(autouse=True)
def impatient(monkeypatch: pytest.MonkeyPatch) -> None:
    """Hundreds of messages in a row are the point here; that they are read slowly is tested elsewhere."""
    monkeypatch.setattr(gate, "MAX_RATE", 100_000)


def controls(served: Served) -> dict[str, Any]:
    """All controls that every client sees, by id."""
    return served.server.gui._gui_input_handle_from_uuid


def other_value(control: Any) -> Any:
    """A value that the control takes and that is not the one it has; an upload button takes none."""
    if isinstance(control, viser.GuiButtonHandle):
        return True
    if isinstance(control, viser.GuiCheckboxHandle):
        return not control.value
    if isinstance(control, viser.GuiSliderHandle | viser.GuiNumberHandle):
        return control.min if control.value == control.max else control.max
    if isinstance(control, viser.GuiVector3Handle):
        return control.min if tuple(control.value) == control.max else control.max
    if isinstance(control, viser.GuiDropdownHandle | viser.GuiButtonGroupHandle):
        return control.options[-1] if control.value == control.options[0] else control.options[0]
    return "x"


def bad_values(control: Any) -> list[Any]:
    """Values of the right and of other types that the control must not take."""
    if isinstance(control, viser.GuiButtonHandle | viser.GuiCheckboxHandle):
        return ["x", 1.0, 0 if isinstance(control, viser.GuiCheckboxHandle) else False]
    if isinstance(control, viser.GuiVector3Handle):
        x, y, z = control.max
        return [(x, y, z + 1e-3), (-x - 1e-3, y, z), x, "x", True]
    if isinstance(control, viser.GuiSliderHandle | viser.GuiNumberHandle):
        beyond = 1e-9 + 1e-6 * abs(control.max - control.min)
        return [control.min - beyond, control.max + beyond, "x", True]
    if isinstance(control, viser.GuiDropdownHandle | viser.GuiButtonGroupHandle):
        return ["no such option", EVIL, 1, True]
    if isinstance(control, viser.GuiTextHandle):
        return ["x" * (MAX_TEXT + 1), "two\nlines", "\x1b[2J", "\u202e", 1, True]
    return ["x", 1, True]


def state(served: Served) -> list[Any]:
    """Everything that a page shows of its controls."""
    return [
        (uuid, control.value, {name: str(value) for name, value in vars(control._impl.props).items()})
        for uuid, control in controls(served).items()
    ]


@pytest.fixture
def untouched(served: Served, loop: FakeLoop) -> Iterator[None]:
    """See at the end that page, arm and simulation are as they were."""
    before = state(served)
    yield
    assert state(served) == before
    loop.advance()
    wishes = loop.wishes[-1]
    assert (wishes.inputs, wishes.touches, wishes.changes) == (Inputs(), (), ())
    assert (loop.paused, loop.speed, loop.resets, loop.begun) == (False, 1.0, 0, [])


def refused(served: Served, count: int) -> dict[str, int]:
    """Wait until so many messages were refused; how many for which reason."""
    until(lambda: served.guard.refused.total() >= count, f"{count} refusals", seconds=20.0)
    assert served.guard.refused.total() == count
    return dict(served.guard.refused)


def test_the_operator_sets_every_control_to_its_other_end(served: Served, join: Join) -> None:
    client = join()
    usable = {u: c for u, c in controls(served).items() if c.visible and not c.disabled}
    able = [u for u, c in usable.items() if not isinstance(c, viser.GuiUploadButtonHandle)]
    settings = served.docks.settings
    before = (settings.section.visible, settings.preset.visible)
    assert len(able) > 40
    teach = served.docks.teach
    # They make other options and controls, or take some away.
    steps = teach.steps
    makers = (steps.kind, steps.loop, teach.register, steps.insert, settings.take_limits, settings.view)
    late = ["", *(control._impl.uuid for control in makers)]
    for uuid in sorted(able, key=lambda uuid: late.index(uuid) if uuid in late else 0):
        client.set(uuid, value=other_value(controls(served)[uuid]))
    until(lambda: (settings.section.visible, settings.preset.visible) != before, "the last of them")
    assert served.guard.refused.total() == 0
    assert served.lab.setup.seed.value == 2**31 - 1


def test_no_control_takes_an_attribute_other_than_its_value(served: Served, join: Join, untouched: None) -> None:
    client = join()
    count = 0
    for uuid, control in controls(served).items():
        attributes = {field.name for field in fields(control._impl.props)} | {"disabled", "visible", "order", "update_cb"}
        assert "value" not in attributes - {"value"}
        for name in sorted(attributes - {"value"}):
            client.set(uuid, **{name: 1})
            client.set(uuid, **{"value": other_value(control), name: 1})
            count += 2
    assert count > 500
    reasons = refused(served, count)
    assert set(reasons) <= {"attribute other than value", "disabled control", "not an upload button"}


def test_no_control_takes_a_value_that_it_does_not_offer(served: Served, join: Join, untouched: None) -> None:
    client = join()
    count = 0
    for uuid, control in controls(served).items():
        for value in bad_values(control):
            client.set(uuid, value=value)
            count += 1
    reasons = refused(served, count)
    assert set(reasons) <= {"value not allowed", "disabled control"}
    assert reasons["value not allowed"] > 100


@pytest.mark.parametrize("value", [[], [0.0] * 4, [0.0, 0.0, "x"], [0.0, True, 0.0], [0.0, [0.0], 0.0], [math.nan] * 3])
def test_three_numbers_are_three_numbers(served: Served, join: Join, untouched: None, value: list[Any]) -> None:
    client = join()
    client.set(served.docks.tools.editor.com._impl.uuid, value=value)
    assert set(refused(served, 1)) <= {"not understood", "number out of bounds"}


def test_no_disabled_control_takes_anything(served: Served, join: Join, loop: FakeLoop, monkeypatch: pytest.MonkeyPatch) -> None:
    client = join()
    monkeypatch.setattr(served, "draw", lambda: True)  # which would enable them again
    able = {u: c for u, c in controls(served).items() if not isinstance(c, viser.GuiButtonGroupHandle)}  # viser's cannot
    for control in able.values():
        control.disabled = True
    before = state(served)
    for uuid, control in able.items():
        client.set(uuid, value=other_value(control))
        client.hold(uuid)
    assert refused(served, 2 * len(able)) == {"disabled control": 2 * len(able)}
    loop.advance()
    assert (state(served), loop.wishes[-1].inputs) == (before, Inputs())


def test_a_watcher_can_use_nothing_but_the_stop(served: Served, join: Join, untouched: None) -> None:
    operator, watcher = join(), join()
    operator.set(served.control._strips[0].take._impl.uuid, value=True)
    until(lambda: served.guard.operator.holder == 0, "the operator has control")
    others = {uuid: control for uuid, control in controls(served).items() if control is not served.panel.stop}
    for uuid, control in others.items():
        watcher.set(uuid, value=other_value(control))
        watcher.hold(uuid)
    for phase in ("start", "update"):
        watcher.drag(phase)
    reasons = refused(served, 2 * len(others) + 2)
    assert set(reasons) == {"not the operator", "disabled control", "not a hold button", "value not allowed"}
    uploads = [control for control in others.values() if isinstance(control, viser.GuiUploadButtonHandle)]
    assert reasons["value not allowed"] == sum(not control.disabled for control in uploads) > 0  # these have none


def test_a_text_of_a_user_stays_a_text(served: Served, join: Join) -> None:
    client = join()
    teach = served.docks.teach
    register(served, client, 1)
    client.set(teach.name._impl.uuid, value=EVIL)
    until(lambda: teach.lesson.waypoints[0].name == EVIL, "renamed")
    client.set(teach.steps.insert._impl.uuid, value="After")
    until(lambda: len(teach.lesson.plan) == 2, "a step to it")
    for content in (f"{EVIL}: 1", f"waypoints: [{{name: '{EVIL}'}}]", f"waypoints: {EVIL}", f"- {EVIL}", f"'{EVIL}"):
        before = teach.filed.shown
        upload(client, teach.load._impl.uuid, content.encode(), filename=EVIL)
        until(lambda before=before: teach.filed.shown != before, "an answer to the file")
        assert "File refused" in teach.filed.shown
    until(lambda: "onerror" in teach.steps.list.shown, "the step is listed")
    pieces = told(served, join())
    assert sum("onerror" in piece for piece in pieces) >= 2
    for piece in pieces:
        assert "<img" not in piece


def told(served: Served, newcomer: RawClient) -> list[str]:
    """Every piece of HTML that a page gets which is opened now."""
    served.server.gui.set_panel_label("mark")
    served.server.flush()
    messages = newcomer.messages_until(lambda m: m["type"] == "SetGuiPanelLabelMessage" and m["label"] == "mark")
    assert [m for m in messages if m["type"] in ("GuiMarkdownMessage", "RunJavascriptMessage")] == []
    pieces = [m["props"]["content"] for m in messages if m["type"] == "GuiHtmlMessage"]
    pieces += [m["updates"]["content"] for m in messages if m["type"] == "GuiUpdateMessage" and "content" in m["updates"]]
    assert len(pieces) > 10
    return pieces


def test_two_hundred_connections_change_nothing_for_those_who_are_there(served: Served, join: Join) -> None:
    operator = join()
    address, port = served.url.removeprefix("http://").split(":")
    upgrade = UPGRADE.format(host=f"{address}:{port}").encode()
    with contextlib.ExitStack() as stack:
        opened = [stack.enter_context(socket.create_connection((address, int(port)))) for _ in range(200)]
        for number, connection in enumerate(opened):  # whole, cut, nothing at all, and no request
            connection.sendall((upgrade, upgrade[:40], b"", b"\x16\x03\x01\r\n\r\n")[number % 4])
        answers = [connection.recv(12) for connection in opened[0::4]]
        assert (answers.count(b"HTTP/1.1 101"), answers.count(b"HTTP/1.1 503")) == (MAX_CLIENTS - 1, 51 - MAX_CLIENTS)
        assert [connection.recv(12) for connection in opened[3::4]] == [b""] * 50  # hung up at once
        operator.set(served.lab.force._impl.uuid, value=80.0)
        until(lambda: served.hand.cap == 80.0, "the operator is heard")
    until(lambda: len(served.guard.door.inside) == 1, "their places are free")
    until(lambda: len(served.server.get_clients()) == 1, "viser has forgotten them")
    RawClient(served.url).close()
