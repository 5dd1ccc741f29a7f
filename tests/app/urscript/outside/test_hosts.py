"""Which hosts a script may call: one rule, for sockets, XML-RPC and Modbus."""

import pytest

from app.urscript.language.trouble import Misuse
from app.urscript.outside.hosts import AllowedHosts
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
    assert AllowedHosts(frozenset({"10.1.2.3"})).address(host) == address


@pytest.mark.parametrize("host", ["10.1.2.4", "0.0.0.0", "8.8.8.8", "255.255.255.255", "::", "fe80::1", "::ffff:10.1.2.4"])
def test_nobody_else_may(host: str) -> None:
    with pytest.raises(Misuse, match="is not allowed: only this machine, and whoever sent the script"):
        AllowedHosts(frozenset({"10.1.2.3"})).address(host)


@pytest.mark.parametrize("host", ["", "camera", "example.org", "2130706433", "0x7f000001", "127.1", "127.0.0.1 ", "x" * 400])
def test_names_are_not_looked_up(host: str) -> None:
    with pytest.raises(Misuse, match="is no IP address; names are not looked up") as caught:
        AllowedHosts().address(host)
    assert len(str(caught.value)) < 120


@pytest.fixture(scope="module")
def bench() -> ScriptBench:
    return ScriptBench()


@pytest.mark.parametrize(
    "call",
    [
        'socket_open("10.1.2.4", 80)',
        'rpc_factory("xmlrpc", "http://10.1.2.4:80/RPC2")',
        'modbus_add_signal("10.1.2.4", 255, 0, 0, "a")',
        'modbus_add_rw_signal("10.1.2.4:5020", 255, 0, 1, 0, 1, "a")',
        'modbus_send_custom_command("10.1.2.4", 255, 3, [0, 1])',
        'modbus_reset_connection("10.1.2.4")',
    ],
)
def test_all_that_leaves_a_script_goes_by_the_rule(bench: ScriptBench, call: str) -> None:
    _, trouble = bench.run(f"x = {call}" if "add" not in call and "custom" not in call else call)
    assert trouble.endswith("10.1.2.4 is not allowed: only this machine, and whoever sent the script")
