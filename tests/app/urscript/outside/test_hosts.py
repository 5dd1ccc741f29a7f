"""Which hosts a script may call: one rule, for sockets, XML-RPC and Modbus."""

import socket
import threading
from typing import NoReturn

import pytest

from app.urscript.language.trouble import Misuse
from app.urscript.outside.hosts import AllowedHosts
from app.urscript.outside.modbus_client import FREQUENCY, ModbusUnit
from tests.app.urscript.script_bench import ScriptBench


@pytest.mark.parametrize(
    ("host", "address"),
    [
        ("127.0.0.1", "127.0.0.1"),
        ("localhost", "127.0.0.1"),
        ("127.8.9.10", "127.8.9.10"),
        ("::1", "::1"),
        ("10.1.2.3", "10.1.2.3"),
    ],
)
def test_this_machine_and_the_sender_may_be_called(host: str, address: str) -> None:
    assert AllowedHosts(frozenset({"10.1.2.3"}), print).address(host) == address


@pytest.mark.parametrize("host", ["10.1.2.4", "0.0.0.0", "8.8.8.8", "255.255.255.255", "::", "fe80::1", "::ffff:10.1.2.4"])
def test_nobody_else_may(host: str) -> None:
    with pytest.raises(Misuse, match="is not allowed: only this machine, and whoever sent the script"):
        AllowedHosts(frozenset({"10.1.2.3"}), print).address(host)


@pytest.mark.parametrize("host", ["", "camera", "example.org", "2130706433", "0x7f000001", "127.1", "127.0.0.1 ", "x" * 400])
def test_names_are_not_looked_up(host: str) -> None:
    with pytest.raises(Misuse, match="is no IP address; names are not looked up") as caught:
        AllowedHosts(frozenset(), print).address(host)
    assert len(str(caught.value)) < 120


@pytest.fixture(scope="module")
def bench() -> ScriptBench:
    return ScriptBench()


class Sent(Exception):
    """Something would have left this machine."""


@pytest.fixture
def sealed(monkeypatch: pytest.MonkeyPatch) -> list[object]:
    """Every address that is connected to, or asked for, from now on; none is reached."""
    tried: list[object] = []

    def see(*given: object, **_: object) -> NoReturn:
        tried.append(given)
        raise Sent

    for name in ("connect", "connect_ex", "sendto", "sendmsg"):
        monkeypatch.setattr(socket.socket, name, see)
    for name in ("create_connection", "getaddrinfo", "gethostbyname"):
        monkeypatch.setattr(socket, name, see)
    return tried


RULE = "is not allowed: only this machine, and whoever sent the script"
ABSENT = "nothing is sent, and it counts as a host that is not there"


def test_a_call_of_rpc_factory_to_nobody_else_ends_the_program(bench: ScriptBench, sealed: list[object]) -> None:
    """As it does where nobody is there (URScript manual)."""
    told, trouble = bench.run('x = rpc_factory("xmlrpc", "http://10.1.2.4:80/RPC2")')
    assert (told, trouble) == ([], f"line 1, column 5: rpc_factory(): address: 10.1.2.4 {RULE}")
    assert sealed == []


@pytest.mark.parametrize(
    ("host", "words"), [("10.1.2.4", f"10.1.2.4 {RULE}"), ("plc.local", "'plc.local' is no IP address; names are not looked up")]
)
def test_a_socket_to_nobody_else_is_not_opened_after_its_time(
    bench: ScriptBench, sealed: list[object], host: str, words: str
) -> None:
    text = f'''def p():
  begun = time()
  textmsg(socket_open("{host}", 80, "a", 0.5))
  textmsg(time().nanosec != begun.nanosec)
  textmsg(socket_open("{host}", 81, "b"))
  textmsg(socket_send_string("x", "b"))
  textmsg(socket_read_string("b"))
end'''
    told, trouble = bench.run(text, 2000)
    assert (told, trouble) == ([f"address: {words}; {ABSENT}", "False", "True", "False", "False", ""], "")
    assert sealed == []


def test_a_socket_to_nobody_else_ends_the_one_of_its_name(bench: ScriptBench) -> None:
    with socket.socket() as server:
        server.bind(("127.0.0.1", 0))
        server.listen(1)
        opens = f'textmsg(socket_open("127.0.0.1", {server.getsockname()[1]}))\ntextmsg(socket_open("10.1.2.4", 80))\n'
        told, trouble = bench.run(f'{opens}textmsg(socket_send_string("x"))', 2000)
    assert (told[0], told[2:], trouble) == ("True", ["False", "False"], "")


@pytest.mark.parametrize(
    "add",
    [
        'modbus_add_signal("10.1.2.4", 255, 0, 3, "a")',
        'modbus_add_rw_signal("10.1.2.4:5020", 255, 0, 1, 0, 1, "a")',
        'modbus_add_signal("10.1.2.4:70", 255, 0, 3, "a")\nmodbus_send_custom_command("10.1.2.4", 255, 3, [0, 1])',
    ],
)
def test_a_modbus_unit_that_is_nobody_else_is_out_of_order(bench: ScriptBench, sealed: list[object], add: str) -> None:
    body = (
        f'{add}\nmodbus_set_output_register("a", 1)\nmodbus_set_signal_update_frequency("a", 5)\n'
        'modbus_reset_connection("10.1.2.4", False)\nsleep(0.3)\ntextmsg(modbus_get_error("a"))\n'
        'textmsg(modbus_get_time_since_signal_invalid("a") > 0.2)\n'
        'sleep(1.8)\ntextmsg(modbus_get_signal_status("a"))'
    )
    told, trouble = bench.run(body, 2000)
    bench.runner.memory.units.end()
    port = add.partition("10.1.2.4:")[2].partition('"')[0] or "502"
    late = f"Modbus signal a: no answer from 10.1.2.4:{port} for 2 s"
    assert told == [f"address: 10.1.2.4 {RULE}; {ABSENT}", "100", "True", late]
    assert trouble.endswith(f"modbus_get_signal_status(): {late}")
    assert sealed == []
    assert not any(thread.name == "modbus 10.1.2.4" for thread in threading.enumerate())


def test_a_unit_of_another_sender_is_not_called_for_a_program_that_may_not(
    bench: ScriptBench, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The signal stays when the sender's program is over; another program's signal there is out of order all the same."""
    begun: list[ModbusUnit] = []

    def start(unit: ModbusUnit) -> None:
        begun.append(unit)

    monkeypatch.setattr(ModbusUnit, "start", start)
    bench.runner.offer('modbus_add_signal("10.1.2.3", 255, 0, 2, "theirs")', frozenset({"10.1.2.3"}))
    bench.robot.step(5)
    bench.run('modbus_add_signal("10.1.2.3", 255, 0, 2, "ours")')
    assert [[each.name for each in unit.signals] for unit in begun] == [["theirs"]]
    bench.runner.memory.units.end()


@pytest.mark.parametrize(
    "call",
    [
        'modbus_set_output_register("theirs", 5)',
        'modbus_set_signal_update_frequency("theirs", 50)',
        'modbus_set_runstate_dependent_choice("theirs", 3)',
    ],
)
def test_nothing_is_sent_to_a_unit_of_another_sender_for_a_program_that_may_not(
    bench: ScriptBench, monkeypatch: pytest.MonkeyPatch, call: str
) -> None:
    monkeypatch.setattr(ModbusUnit, "start", lambda _: None)
    bench.runner.offer('modbus_add_signal("10.1.2.3", 255, 0, 3, "theirs")', frozenset({"10.1.2.3"}))
    bench.robot.step(5)
    signal = bench.runner.memory.units.signal("theirs")
    assert bench.run(call) == ([f"address: 10.1.2.3 {RULE}; {ABSENT}"], "")
    assert (signal.wanted, signal.frequency) == (None, FREQUENCY)
    bench.runner.offer(call, frozenset({"10.1.2.3"}))
    bench.robot.step(5)
    assert (signal.wanted, signal.frequency) != (None, FREQUENCY)
    bench.runner.begin()


def test_a_host_is_told_once_and_not_more_hosts_than_people_read(bench: ScriptBench) -> None:
    told: list[str] = []
    hosts = AllowedHosts(frozenset(), told.append)
    for k in (1, 1, *range(1, 250)):
        assert hosts.reached(f"10.1.2.{k}") is None
    assert len(told) == 100
    assert hosts.reached("127.0.0.1") == "127.0.0.1"
