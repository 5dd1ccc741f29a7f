"""Sockets of a script: answers that are none, addresses that cannot be called, threads that use the same name."""

import socket
from typing import NoReturn

import pytest

from app.robot_interface.gripper.gripper_registers import NUMBER, GripperRegisters
from app.urscript.language.trouble import Misuse
from app.urscript.outside.hosts import AllowedHosts
from app.urscript.outside.remote_calls import XmlRpcServer
from app.urscript.outside.script_sockets import ScriptSockets
from tests.app.robot_interface.gripper.test_gripper_registers import Port
from tests.app.urscript.outside.servers import raw_server
from tests.app.urscript.script_bench import ScriptBench

RULE = "is not allowed: only this machine, and whoever sent the script"
ABSENT = f"{RULE}; nothing is sent, and it counts as a host that is not there"


@pytest.fixture(scope="module")
def bench() -> ScriptBench:
    return ScriptBench()


def no_socket(*_: object, **__: object) -> NoReturn:
    raise OSError(24, "Too many open files")


def no_such_zone(*_: object) -> NoReturn:
    raise socket.gaierror(-2, "Name or service not known")


@pytest.mark.parametrize(
    ("answer", "value"),
    [("speed 7", "7"), ("-12", "-12"), ("-123456789", "-123456789"), ("--5", "0"), ("²", "0"), ("1.5", "0"), ("", "0")],
)
def test_what_is_no_whole_number_is_0(bench: ScriptBench, answer: str, value: str) -> None:
    def say(connection: socket.socket) -> None:
        connection.recv(100)
        connection.sendall(f"{answer}\n".encode())

    with raw_server(say) as port:
        text = f'def p():\n  socket_open("127.0.0.1", {port})\n  textmsg(socket_get_var("speed", "socket_0", 60))\nend'
        assert bench.run(text, 30000) == ([value], "")


def test_loopback_has_no_zones(bench: ScriptBench) -> None:
    text = 'textmsg(socket_open("::1%x", 9, "a", 0.1))'
    assert bench.run(text) == ([f"address: ::1%x {ABSENT}", "False"], "")
    trouble = bench.run('x = rpc_factory("xmlrpc", "http://[::1%25x]:80")')[1]
    assert trouble == f"line 1, column 5: rpc_factory(): address: ::1%25x {RULE}"


def test_the_zone_of_a_sender_that_this_machine_has_not_is_nobody(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(socket.socket, "connect_ex", no_such_zone)
    hosts = AllowedHosts(frozenset({"fe80::1%x"}), print)
    assert hosts.reached("fe80::1%x") == "fe80::1%x"
    sockets = ScriptSockets(hosts)
    begun = sockets.begin("127.0.0.1", 9, "a")
    assert begun is not None
    connection, where = begun
    assert (connection.connected(where), connection.broken) == (False, True)
    sockets.end()
    with pytest.raises(Misuse, match=r"there is no server at 127\.0\.0\.1:9"):
        next(XmlRpcServer("127.0.0.1", 9, "/", patience=1.0).connect())


def test_a_machine_that_has_no_socket_left_reaches_nobody_but_its_gripper(
    bench: ScriptBench, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(socket, "socket", no_socket)
    assert bench.run('textmsg(socket_open("127.0.0.1", 9, "a", 0.1))') == (["False"], "")
    trouble = bench.run('x = rpc_factory("xmlrpc", "http://127.0.0.1:9/")')[1]
    assert trouble == "line 1, column 5: rpc_factory(): there is no server at 127.0.0.1:9"
    begun = ScriptSockets(AllowedHosts(frozenset(), print), GripperRegisters(Port())).begin("127.0.0.1", NUMBER, "g")
    assert begun is not None
    connection, where = begun
    assert connection.connected(where)
    assert connection.send(b"GET POS\n")
    assert connection.text(b"POS ", b"\n") is not None
    connection.close()
    assert not connection.send(b"GET POS\n")


def test_a_host_that_may_not_be_called_is_waited_for_in_bounds(bench: ScriptBench) -> None:
    told, trouble = bench.run('textmsg(socket_open("8.8.8.8", 80, "s", -1))', 2000)
    assert (told, trouble) == ([f"address: 8.8.8.8 {ABSENT}", "False"], "")


@pytest.mark.parametrize(("host", "told"), [("10.1.2.4", [f"address: 10.1.2.4 {ABSENT}"]), ("127.0.0.1", [])])
def test_who_waits_in_vain_leaves_the_socket_of_its_name_that_another_thread_opened_meanwhile(
    bench: ScriptBench, monkeypatch: pytest.MonkeyPatch, host: str, told: list[str]
) -> None:
    connect = socket.socket.connect_ex

    def slow(connection: socket.socket, address: tuple[str, int]) -> int:
        return 115 if address[1] == 9 else connect(connection, address)

    monkeypatch.setattr(socket.socket, "connect_ex", slow)
    with socket.socket() as server:
        server.bind(("127.0.0.1", 0))
        server.listen(1)
        text = f'''def p():
  thread other():
    sleep(0.1)
    textmsg(socket_open("127.0.0.1", {server.getsockname()[1]}, "s"))
  end
  t = run other()
  textmsg(socket_open("{host}", 9, "s", 0.5))
  join t
  textmsg(socket_send_string("x", "s"))
end'''
        assert bench.run(text, 2000) == ([*told, "True", "False", "True"], "")
