"""Whatever a client sends: only what it may do happens, and nobody else hears of the rest."""

import asyncio
import contextlib
import math
import socket
from collections.abc import Callable
from dataclasses import fields, is_dataclass
from typing import Any

import pytest
import viser
import viser._messages as wire
from websockets.exceptions import ConnectionClosed, InvalidStatus
from websockets.sync.client import connect

from app.web.access import message_gate as gate_module
from app.web.access.door import MAX_CLIENTS
from app.web.access.guard import VISER_VERSION
from app.web.access.message_gate import MAX_BYTES, MessageGate
from app.web.access.messages import (
    Camera,
    CommandTrigger,
    Drag,
    HandlesLetGo,
    HandlesMoved,
    HandlesTaken,
    HoldMessage,
    Update,
    Upload,
    UploadPart,
)
from app.web.server import Served
from pendant.inputs import Button, Command
from sim.plant.touch import Pull
from tests.app.web.fake_loop import FakeLoop
from tests.app.web.raw_client import CAMERA, VERSION, RawClient, until

UPGRADE = (
    "GET / HTTP/1.1\r\nHost: {host}\r\nUpgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Version: 13\r\n"
    "Sec-WebSocket-Key: MDEyMzQ1Njc4OWFiY2RlZg==\r\nSec-WebSocket-Protocol: viser-v1.1.1\r\n\r\n"
)
Join = Callable[[], RawClient]
HANDLED = {
    "CommandTriggerMessage",
    "FileTransferPart",
    "FileTransferStartUpload",
    "GuiButtonHoldMessage",
    "GuiFormDirtyMessage",
    "GuiFormSubmitMessage",
    "GuiUpdateMessage",
    "SceneNodeClickMessage",
    "SceneNodeDragMessage",
    "ScenePointerMessage",
    "ShareUrlDisconnect",
    "ShareUrlRequest",
    "TransformControlsDragEndMessage",
    "TransformControlsDragStartMessage",
    "TransformControlsUpdateMessage",
}


def refused(app: Served, reason: str, times: int = 1) -> None:
    """Wait until so many messages were refused for that reason, and see that none was for another."""
    until(lambda: app.guard.refused.total() >= times, f"{times} refusals")
    assert dict(app.guard.refused) == {reason: times}


def heard(app: Served, client: RawClient) -> list[dict[str, Any]]:
    """Everything that `client` has been told up to now."""
    app.server.gui.set_panel_label("mark")
    app.server.flush()
    return client.messages_until(lambda m: m["type"] == "SetGuiPanelLabelMessage" and m["label"] == "mark")


OURS = (Camera, Update, HoldMessage, CommandTrigger, Drag, HandlesMoved, HandlesTaken, HandlesLetGo, Upload, UploadPart)


def test_viser_is_the_version_that_the_guard_knows() -> None:
    assert viser.__version__ == VISER_VERSION


def test_viser_handles_the_messages_that_the_guard_knows(served: Served, join: Join) -> None:
    join()
    assert {message.__name__ for message in served.server._websock_server._incoming_handlers} == HANDLED
    own = served.server.get_clients()[0]._websock_connection._incoming_handlers
    assert {message.__name__ for message in own} - HANDLED == {"ViewerCameraMessage"}


@pytest.mark.parametrize("ours", OURS)
def test_admitted_messages_have_the_fields_of_visers(ours: Any) -> None:
    theirs = getattr(wire, ours.__struct_config__.tag)
    assert list(ours.__struct_fields__) == [field.name for field in fields(theirs)]


def test_a_viser_of_another_version_is_not_served(monkeypatch: pytest.MonkeyPatch, served: Served) -> None:
    monkeypatch.setattr(viser, "__version__", "1.1.2")
    with pytest.raises(RuntimeError, match=r"1\.1\.2 is installed.*1\.1\.1 only"), served.guard.installed():
        pass


def test_the_operator_sets_a_value(served: Served, join: Join) -> None:
    client, watcher = join(), join()
    client.set(served.lab.force._impl.uuid, value=80)
    until(lambda: served.hand.cap == 80.0, "the cap of the hand")
    told = [m for m in heard(served, watcher) if m["type"] == "GuiUpdateMessage" and m["uuid"] == served.lab.force._impl.uuid]
    assert told == [{"type": "GuiUpdateMessage", "uuid": served.lab.force._impl.uuid, "updates": {"value": 80.0}}]


def bad_updates() -> list[tuple[str, dict[str, Any], str]]:
    """Control, update, reason of the refusal."""
    return [
        ("force", {"value": 151.0}, "value not allowed"),
        ("force", {"value": 4.9}, "value not allowed"),
        ("force", {"value": math.nan}, "number out of bounds"),
        ("force", {"value": 2**63}, "number out of bounds"),
        ("force", {"value": math.inf}, "number out of bounds"),
        ("force", {"value": "80"}, "value not allowed"),
        ("force", {"value": True}, "value not allowed"),
        ("force", {"value": None}, "not understood"),
        ("force", {"value": [80.0]}, "not understood"),
        ("force", {"value": [math.nan]}, "not understood"),
        ("force", {"value": 80.0, "max": 1e6}, "attribute other than value"),
        ("force", {"max": 1e6}, "attribute other than value"),
        ("force", {"update_cb": []}, "not understood"),
        ("force", {}, "attribute other than value"),
        ("mode", {"value": "RUN"}, "value not allowed"),
        ("mode", {"value": 1}, "value not allowed"),
        ("mode", {"options": ["RUN"]}, "not understood"),
        ("stop", {"value": False}, "value not allowed"),
        ("stop", {"disabled": True}, "attribute other than value"),
        ("stop", {"visible": False}, "attribute other than value"),
        ("stop", {"update_cb": []}, "not understood"),
        ("stop", {"removed": True}, "attribute other than value"),
        ("leave", {"value": True}, "disabled control"),
        ("reset", {"value": True}, "disabled control"),
    ]


@pytest.mark.parametrize(("name", "update", "reason"), bad_updates())
def test_a_bad_update_of_the_operator_changes_nothing(
    served: Served, join: Join, loop: FakeLoop, name: str, update: dict[str, Any], reason: str
) -> None:
    client, watcher = join(), join()
    client.set(served.panel.free_drive._impl.uuid, value=True)
    until(lambda: served.guard.operator.holder == 0, "client 0 has control")
    control = getattr(served.lab if name == "force" else served.panel, name)
    state = (control.value, control.disabled, control.visible, list(control._impl.update_cb), vars(control._impl.props).copy())
    client.set(control._impl.uuid, **update)
    refused(served, reason)
    loop.advance()
    assert (control.value, control.disabled, control.visible, list(control._impl.update_cb), vars(control._impl.props)) == state
    assert loop.wishes[-1].inputs.commands == ()
    assert served.hand.cap == 50.0
    updates = [m for m in heard(served, watcher) if m["type"] == "GuiUpdateMessage" and m["uuid"] == control._impl.uuid]
    assert [m for m in updates if set(m["updates"]) & set(update)] == []


def test_a_refused_page_is_set_back(served: Served, join: Join) -> None:
    client = join()
    uuid = served.lab.force._impl.uuid
    client.set(uuid, value=1000.0)
    back = client.messages_until(lambda m: m["type"] == "GuiUpdateMessage" and m["uuid"] == uuid)[-1]
    assert back["updates"] == {"value": 50.0}


def test_a_disabled_button_cannot_be_held(served: Served, join: Join, loop: FakeLoop) -> None:
    client = join()
    served.panel.free_drive.disabled = True
    client.hold(served.panel.free_drive._impl.uuid)
    refused(served, "disabled control")
    loop.advance()
    assert loop.wishes[-1].inputs.held == frozenset()


@pytest.mark.parametrize(("name", "frequency"), [("free_drive", 1000.0), ("leave_enabled", 30.0), ("force", 30.0)])
def test_only_the_hold_button_at_its_rate_is_held(served: Served, join: Join, name: str, frequency: float) -> None:
    client = join()
    control = {"leave_enabled": served.lab.restart, "force": served.lab.force, "free_drive": served.panel.free_drive}[name]
    client.hold(control._impl.uuid, frequency)
    refused(served, "not a hold button")


def others() -> dict[str, Any]:
    """All messages that viser, and what is built on it, know and a client may not send, by name."""
    known = {message.__name__: message for message in wire.Message.get_subclasses() if is_dataclass(message)}
    ours = {message.__struct_config__.tag for message in OURS}
    return {name: message for name, message in sorted(known.items()) if name not in ours}


@pytest.mark.parametrize("with_fields", [True, False])
def test_no_other_message_is_understood(served: Served, join: Join, monkeypatch: pytest.MonkeyPatch, with_fields: bool) -> None:
    monkeypatch.setattr(viser.ViserServer, "request_share_url", lambda *_: pytest.fail("a tunnel was asked for"))
    client = join()
    names = others()
    assert {"ShareUrlRequest", "SceneNodeClickMessage", "GetRenderResponseMessage"} <= set(names)
    for name, message in names.items():
        filler = {field.name: "x" for field in fields(message)} if with_fields else {}
        client.send(**(filler | {"type": name}))
    refused(served, "not understood", len(names))


def test_what_is_no_message_is_refused(served: Served, join: Join) -> None:
    client = join()
    bad: list[bytes | str] = [
        b"",
        b"\xc1",
        b"\xff" * 100,
        b"\x80",
        "text",
        b"\x93\x01\x02\x03",
        b"\x81\xa4type\x01",
        b"\x81\xa4type\xa1\xff",
    ]
    for raw in bad:
        client.socket.send(raw)
    refused(served, "not understood", len(bad))
    client.set(served.lab.force._impl.uuid, value=60.0)
    until(lambda: served.hand.cap == 60.0, "the connection still works")


def test_a_watcher_changes_nothing(served: Served, join: Join, loop: FakeLoop) -> None:
    operator, watcher = join(), join()
    operator.set(served.lab.force._impl.uuid, value=40.0)
    until(lambda: served.guard.operator.holder == 0, "client 0 has control")
    panel = served.panel
    watcher.set(served.lab.force._impl.uuid, value=90.0)
    watcher.set(panel.mode._impl.uuid, value="NORMAL")
    watcher.set(served.lab.clock._impl.uuid, value="Freeze")
    watcher.set(served.lab.speed._impl.uuid, value=0.5)
    watcher.set(served.lab.restart._impl.uuid, value=True)
    watcher.set(panel.free_drive._impl.uuid, value=True)
    watcher.hold(panel.free_drive._impl.uuid)
    watcher.drag("start")
    watcher.drag("update")
    refused(served, "not the operator", 9)
    loop.advance()
    assert (loop.wishes[-1].inputs.held, loop.wishes[-1].inputs.commands, loop.wishes[-1].touches) == (frozenset(), (), ())
    assert (served.hand.cap, panel.mode.value, served.lab.speed.value) == (40.0, "TEACH", 1.0)
    assert (loop.paused, loop.speed, loop.resets) == (False, 1.0, 0)
    told = [m["updates"] for m in heard(served, operator) if m["type"] == "GuiUpdateMessage" and "value" in m["updates"]]
    assert told == []


def test_the_emergency_stop_of_a_watcher_works(served: Served, join: Join, loop: FakeLoop) -> None:
    operator, watcher = join(), join()
    operator.set(served.lab.force._impl.uuid, value=40.0)
    until(lambda: served.guard.operator.holder == 0, "client 0 has control")
    watcher.set(served.panel.stop._impl.uuid, value=True)
    until(lambda: loop.advance() is None and Command.EMERGENCY_STOP in loop.wishes[-1].inputs.commands, "the stop")
    assert served.guard.operator.holder == 0
    assert served.guard.refused.total() == 0


def test_a_drag_pulls_and_its_end_lets_go(served: Served, join: Join, loop: FakeLoop) -> None:
    client = join()
    client.drag("start")
    client.drag("update", to=(0.3, 0.2, 0.1))
    until(lambda: any(isinstance(t, Pull) and t.target == (0.3, 0.2, 0.1) for t in loop.desk.take().touches), "a pull")
    client.drag("end")
    until(lambda: loop.desk.take().touches == (), "let go")


def test_a_closed_connection_releases_at_once(served: Served, join: Join, loop: FakeLoop) -> None:
    client, other = join(), join()
    client.drag("start")
    client.hold(served.panel.free_drive._impl.uuid)
    until(lambda: loop.advance() is None and bool(loop.wishes[-1].touches), "a touch")
    client.close()
    until(lambda: loop.advance() is None and Button.FREE_DRIVE in loop.wishes[-1].inputs.released, "the release")
    assert loop.desk.take().touches == ()
    other.set(served.lab.force._impl.uuid, value=60.0)
    until(lambda: served.guard.operator.holder == 1, "control is free")


def test_a_network_that_stalls_lets_go(served: Served, join: Join, loop: FakeLoop, monkeypatch: pytest.MonkeyPatch) -> None:
    async def no_answer(gate: MessageGate) -> asyncio.Future[float]:
        return asyncio.get_running_loop().create_future()

    client = join()
    client.drag("start")
    client.hold(served.panel.free_drive._impl.uuid)
    until(lambda: loop.advance() is None and bool(loop.wishes[-1].touches), "a touch")
    monkeypatch.setattr(MessageGate, "ping", no_answer)
    until(lambda: loop.advance() is None and Button.FREE_DRIVE in loop.wishes[-1].inputs.released, "the release")
    assert loop.desk.take().touches == ()
    client.drag("update", to=(0.3, 0.2, 0.1))
    client.set(served.lab.force._impl.uuid, value=60.0)
    until(lambda: served.hand.cap == 60.0, "it is heard again")
    assert loop.desk.take().touches == ()


@pytest.mark.parametrize(
    ("change", "reason"),
    [
        ({"name": "/floor"}, "not draggable"),
        ({"name": "/world/0"}, "not draggable"),
        ({"owner": "1"}, "not draggable"),
        ({"end_position": [math.nan, 0.0, 0.0]}, "number out of bounds"),
        ({"end_position": [0.0, 1e300, 0.0]}, "number out of bounds"),
        ({"end_position": [0.0, 0.0]}, "not understood"),
        ({"instance_index": 1}, "not understood"),
        ({"phase": "jump"}, "not understood"),
        ({"extra": 1}, "not understood"),
    ],
)
def test_a_bad_drag_is_refused(served: Served, join: Join, loop: FakeLoop, change: dict[str, Any], reason: str) -> None:
    client = join()
    client.drag("start", **change)
    refused(served, reason)
    assert loop.desk.take().touches == ()


def test_nothing_counts_before_the_camera(served: Served, loop: FakeLoop) -> None:
    client = RawClient(served.url, camera=False)
    client.set(served.panel.stop._impl.uuid, value=True)
    client.set(served.lab.force._impl.uuid, value=90.0)
    refused(served, "not connected", 2)
    assert served.lab.force.value == 50.0
    client.close()


def test_a_camera_that_is_not_finite_is_refused(served: Served, join: Join) -> None:
    client = join()
    client.send(**(CAMERA | {"fov": math.inf}))
    refused(served, "number out of bounds")


@pytest.mark.parametrize("origin", ["https://evil.example", "null", "http://localhost:1", "http://127.0.0.1.evil.example"])
def test_a_foreign_origin_is_refused(served: Served, origin: str) -> None:
    with pytest.raises(InvalidStatus) as turned_away:
        RawClient(served.url, origin=origin)
    assert turned_away.value.response.status_code == 403
    assert dict(served.guard.refused) == {"foreign origin": 1}


def test_our_own_origin_is_let_in(served: Served) -> None:
    RawClient(served.url, origin=served.url).close()


@pytest.mark.parametrize("host", ["evil.example", "evil.example:80", "127.0.0.1.evil.example", "localhost.evil.example:8080"])
def test_a_foreign_host_is_refused(served: Served, host: str) -> None:
    with pytest.raises(InvalidStatus) as turned_away:
        _with_host(served.url, host)
    assert turned_away.value.response.status_code == 403
    assert dict(served.guard.refused) == {"foreign host": 1}


@pytest.mark.parametrize("host", ["localhost", "127.0.0.1:9999", "localhost:8080", "[::1]:8080"])
def test_a_host_of_this_machine_is_let_in(served: Served, host: str) -> None:
    _with_host(served.url, host)
    assert dict(served.guard.refused) == {}


def test_two_hosts_are_refused(served: Served) -> None:
    with pytest.raises(InvalidStatus) as turned_away:
        _with_host(served.url, "localhost", {"Host": "localhost"})
    assert turned_away.value.response.status_code == 403


def _with_host(url: str, host: str, more: dict[str, str] | None = None) -> None:
    """Open a connection that names `host` while it goes to `url`."""
    address, port = url.removeprefix("http://").split(":")
    plain = socket.create_connection((address, int(port)))
    connect(f"ws://{host}", sock=plain, subprotocols=[VERSION], proxy=None, additional_headers=more).close()


def test_an_oversized_message_ends_the_connection(served: Served, join: Join, loop: FakeLoop) -> None:
    client = join()
    client.drag("start")
    until(lambda: bool(loop.desk.take().touches), "a touch")
    client.socket.send(b"\x00" * (MAX_BYTES + 1))
    with pytest.raises(ConnectionClosed) as closed:
        client.messages_until(lambda _: False)
    assert closed.value.rcvd is not None
    assert closed.value.rcvd.code == 1009
    until(lambda: loop.desk.take().touches == (), "let go")


def test_one_client_too_many_is_refused(served: Served, join: Join) -> None:
    first = [join() for _ in range(MAX_CLIENTS)]
    with pytest.raises(InvalidStatus) as turned_away:
        RawClient(served.url)
    assert turned_away.value.response.status_code == 503
    assert f"at most {MAX_CLIENTS} clients" in turned_away.value.response.body.decode()
    first[0].close()
    until(lambda: len(served.guard.door.inside) == MAX_CLIENTS - 1, "a place is free")
    RawClient(served.url).close()


def test_connections_are_counted_at_the_door(served: Served) -> None:
    address, port = served.url.removeprefix("http://").split(":")
    with contextlib.ExitStack() as stack:
        clients = [stack.enter_context(socket.create_connection((address, int(port)))) for _ in range(3 * MAX_CLIENTS)]
        for client in clients:
            client.sendall(UPGRADE.format(host=f"{address}:{port}").encode())
        answers = [client.recv(12).decode() for client in clients]
    assert answers.count("HTTP/1.1 101") == MAX_CLIENTS
    assert answers.count("HTTP/1.1 503") == 2 * MAX_CLIENTS


def test_a_flood_is_read_slowly(served: Served, join: Join, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(gate_module, "MAX_RATE", 20)
    client, other = join(), join()
    for _ in range(200):
        client.send(type="ShareUrlRequest")
    until(lambda: served.guard.refused["too fast"] > 0, "the flood is seen")
    assert served.guard.refused["not understood"] < 100
    other.set(served.lab.force._impl.uuid, value=70.0)
    until(lambda: served.hand.cap == 70.0, "the others are served", seconds=5.0)
