"""The tab of the network: who is connected, what was said, who has control."""

import socket
from collections.abc import Iterator

import pytest
import viser

from app.robot_interface.controller.question import Question
from app.robot_interface.interfaces import RobotInterfaces
from app.robot_interface.transport.outbox import Outbox
from app.web.tabs.network_tab import LENGTH, NetworkTab
from pendant.all_settings import Settings
from pendant.inputs import Command
from pendant.program.steps import script_program
from sim.arm.scenario import Scenario
from sim.run.loop import Loop
from sim.simulation import Simulation
from tests.sim.arms import UR5E


@pytest.fixture(scope="module")
def server() -> Iterator[viser.ViserServer]:
    server = viser.ViserServer(host="127.0.0.1", port=0, verbose=False)
    yield server
    server.stop()


@pytest.fixture
def interfaces() -> Iterator[RobotInterfaces]:
    loop = Loop(lambda: Simulation(UR5E, Scenario(), Settings()))
    interfaces = RobotInterfaces(loop, UR5E, host="127.9.9.9")
    yield interfaces
    for each in interfaces._sockets.values():
        each.close()


def test_it_tells_who_is_there_and_what_was_said(server: viser.ViserServer, interfaces: RobotInterfaces) -> None:
    tab = NetworkTab(server.gui, interfaces)
    assert tab.show()
    assert not tab.show()
    assert "nobody" in tab.peers.shown
    peer = interfaces.peers.join("RTDE", "127.0.0.1:5", Outbox(socket.socket()))
    peer.about = "3 outputs at 500 Hz"
    assert tab.show()
    assert "127.0.0.1:5 3 outputs at 500 Hz" in tab.peers.shown
    assert "connected from 127.0.0.1:5" in tab.messages.shown
    for i in range(LENGTH + 5):
        interfaces.peers.note("dashboard", 0, f"message <{i}>")
    tab.show()
    assert f"message &lt;{LENGTH + 4}&gt;" in tab.messages.shown
    assert "message &lt;4&gt;" not in tab.messages.shown
    interfaces.peers.leave(peer, "it left")
    tab.show()
    assert "nobody" in tab.peers.shown


def test_it_tells_state_and_popup(server: viser.ViserServer, interfaces: RobotInterfaces) -> None:
    tab = NetworkTab(server.gui, interfaces)
    tab.show()
    assert "remote" in tab.status.shown
    question = Question("integer", "how many <i>")
    interfaces.cabinet.set(remote=False, popup="hello <b>", loaded=script_program("wave"), question=question)
    assert tab.show()
    assert "local" in tab.status.shown
    assert "hello &lt;b&gt;" in tab.status.shown
    assert "how many &lt;i&gt;" in tab.status.shown
    assert "STOPPED wave" in tab.status.shown


@pytest.mark.parametrize(("value", "command"), [("Local", Command.TEACH), ("Remote", Command.REMOTE)])
def test_the_switch_asks_for_control(
    server: viser.ViserServer, interfaces: RobotInterfaces, value: str, command: Command
) -> None:
    import asyncio

    tab = NetworkTab(server.gui, interfaces)
    tab.control.value = value
    for callback in tab.control._impl.update_cb:
        asyncio.run(callback(None))  # type: ignore[arg-type]
    assert {ask.commands for ask in interfaces.cabinet._asks} == {(command,)}
