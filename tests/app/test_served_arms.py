"""One arm after the other in a served loop: network, recording, what was kept."""

import socket
import threading
from collections.abc import Iterator
from pathlib import Path

import pytest

from app.arm_import.import_files import written
from app.arm_import.importing import imported
from app.files.checked import BadInput
from app.files.library import own_arms, robots
from app.files.taught_program import Lesson, TaughtStep
from app.kept_setup import Cell, Keeper
from app.log.live import LiveRecording
from app.log_reading.reader import read
from app.robot_interface.controller.robot_words import RobotMode
from app.robot_interface.interfaces import RobotInterfaces
from app.robot_interface.ports import DASHBOARD
from app.robot_serving import Network
from app.runs.runner import simulate
from app.served_robot import free_addresses
from app.serving import ServedArms
from app.session.prepare import prepare
from app.session.session_file import Setup
from pendant.all_settings import Settings, apply
from sim.run.loop import Loop
from tests.app.arm_import.arms_of_the_test import MJCF, laid_out
from tests.app.web.raw_client import until

UR5E = prepare(Setup(), "test")


@pytest.fixture
def loop() -> Iterator[Loop]:
    running = Loop(lambda: simulate(UR5E))
    running.start()
    yield running
    running.stop()


def asked(interfaces: RobotInterfaces, line: str) -> str:
    """What the dashboard answers."""
    with socket.create_connection((interfaces.host, interfaces.ports[DASHBOARD]), timeout=5.0) as client:
        client.recv(200)
        client.sendall(f"{line}\n".encode())
        return client.recv(200).decode()


def test_another_arm_runs_and_answers_at_the_same_ports(loop: Loop, tmp_path: Path) -> None:
    recording = LiveRecording(loop, tmp_path)
    arms = ServedArms(loop, recording, network=Network(next(free_addresses())))
    first = arms.open(UR5E)
    try:
        assert first is not None
        assert "UR5" in asked(first, "get robot model")
        recording.start()
        until(lambda: recording.seconds > 0.1, "recorded")
        held = socket.create_connection((first.host, first.ports[DASHBOARD]), timeout=5.0)
        brought = arms.bring(arms.ready("ur10e"))
        assert loop.simulation.arm.name == "ur10e"
        assert held.recv(200).startswith(b"Connected")
        assert held.recv(200) == b"", "who was connected is parted from it"
        held.close()
        assert brought.interfaces is not None
        assert brought.interfaces is not first
        assert brought.interfaces.token == first.token, "who controls the channel still may"
        assert "UR10" in asked(brought.interfaces, "get robot model")
        assert "file of its own" in brought.said
        assert "can come again" in brought.said
    finally:
        arms.close()
        recording.close()
    # By time: the name of a second file within a second ends in -2, which sorts first.
    files = sorted(tmp_path.glob("*.mcap"), key=lambda path: path.stat().st_ctime_ns)
    assert [read(path).arm.name for path in files] == ["ur5e", "ur10e"]


def test_a_network_that_cannot_be_opened_again_has_ended_and_it_is_said(
    loop: Loop, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """As for an arm of seven joints, which these protocols cannot tell."""
    arms = ServedArms(loop, LiveRecording(loop, tmp_path), network=Network(next(free_addresses())))
    assert arms.open(UR5E) is not None

    def refuse(*_: object, token: str | None) -> RobotInterfaces:
        raise BadInput("--interfaces", "robot", "ur10e", "an arm of 6 joints")

    monkeypatch.setattr("app.serving.open_interfaces", refuse)
    try:
        brought = arms.bring(arms.ready("ur10e"))
    finally:
        arms.close()
    assert brought.interfaces is None
    assert brought.scripts is not None
    assert "The network interfaces have ended" in brought.said
    assert loop.simulation.arm.name == "ur10e"


UNIT = "127.77.1.2"
"""Nobody is there."""


def has_thread() -> bool:
    return any(thread.name == f"modbus {UNIT}" for thread in threading.enumerate())


@pytest.mark.parametrize("networked", [True, False])
def test_what_scripts_have_begun_ends_with_their_robot(loop: Loop, tmp_path: Path, networked: bool) -> None:
    network = Network(next(free_addresses())) if networked else None
    arms = ServedArms(loop, LiveRecording(loop, tmp_path), network=network)
    arms.open(UR5E)
    scripts = arms.scripts(UR5E.arm)
    with socket.socket() as server:
        server.bind(("127.0.0.1", 0))
        server.listen(4)
        server.settimeout(10.0)
        text = f'''def p():
  modbus_add_signal("{UNIT}", 255, 0, 2, "a")
  socket_open("127.0.0.1", {server.getsockname()[1]}, "a")
  while True:
    sync()
  end
end'''
        ends = [lambda: arms.bring(arms.ready("ur10e")), arms.close]
        for end in ends:
            assert scripts is not None
            running = scripts
            until(lambda running=running: running.cabinet.state.robot_mode is RobotMode.RUNNING, "the robot runs")
            scripts.offer(text)
            connection, _ = server.accept()
            connection.settimeout(10.0)
            assert has_thread()
            brought = end()
            with connection:
                assert connection.recv(1) == b""
            until(lambda: not has_thread(), "its thread has ended")
            assert (running.state, running.trouble, loop.failure) == (None, None, "")
            scripts = None if brought is None else brought.scripts


def test_another_arm_begins_as_it_was_kept(loop: Loop, tmp_path: Path) -> None:
    keeper, settings = Keeper(tmp_path, "ur10e"), apply(Settings(), {"free_drive.period": 7.0})
    lesson = Lesson(steps=[TaughtStep(do="wait", seconds=2.0)])
    cell = Cell(setup=Setup(robot="ur10e", settings={"free_drive.period": 7.0}), taught=lesson)
    keeper.keep(cell)
    ready = ServedArms(loop, LiveRecording(loop, tmp_path), folder=tmp_path).ready("ur10e")
    assert (ready.prepared.settings, ready.cell) == (settings, cell)
    assert ready.keeper is not None
    keeper.path.write_text("[")
    ready = ServedArms(loop, LiveRecording(loop, tmp_path), folder=tmp_path).ready("ur10e")
    assert (ready.prepared.settings, ready.keeper) == (Settings(), None)
    assert ServedArms(loop, LiveRecording(loop, tmp_path)).ready("ur10e", cell).cell == cell, "the page held it"
    assert ServedArms(loop, LiveRecording(loop, tmp_path)).ready("ur10e").keeper is None


def test_an_imported_arm_is_in_the_list_and_begins_as_it_was_kept(
    loop: Loop, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("XDG_DATA_HOME", str(tmp_path / "data"))
    arms = ServedArms(loop, LiveRecording(loop, tmp_path), folder=tmp_path)
    assert arms.names == tuple(robots())
    file = laid_out(tmp_path / "source", MJCF)
    written(imported(file), file, own_arms())
    assert arms.names == (*robots(), "other-arm")
    kept = Cell(setup=Setup(robot="other-arm", settings={"free_drive.period": 7.0}), taught=Lesson())
    Keeper(tmp_path, "other-arm").keep(kept)
    ready = arms.ready("other-arm")
    assert ready.keeper is not None
    assert (ready.keeper.path, ready.cell) == (tmp_path / "other-arm.yaml", kept)
    assert set(ready.meshes) >= {"foot", "a", "b", "c"}
    arms.bring(ready)
    assert loop.simulation.arm.title == "Other Arm"


@pytest.mark.parametrize("name", ["nobody", "../ur5e"])
def test_an_arm_that_there_is_not_is_refused(loop: Loop, tmp_path: Path, name: str) -> None:
    arms = ServedArms(loop, LiveRecording(loop, tmp_path))
    with pytest.raises(BadInput):
        arms.ready(name)
