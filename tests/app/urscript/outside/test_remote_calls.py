"""A script calls functions of a server, Python's own XML-RPC server; a server that is dead, slow or wrong."""

import socket
import time
from collections.abc import Iterator

import pytest

from app.urscript.outside import remote_calls
from app.urscript.running.told import Telling
from tests.app.urscript.outside.servers import Rpc, free_port, raw_server
from tests.app.urscript.script_bench import ScriptBench


@pytest.fixture
def rpc() -> Iterator[Rpc]:
    server = Rpc()
    yield server
    server.close()


@pytest.fixture(scope="module")
def bench() -> ScriptBench:
    return ScriptBench()


def called(bench: ScriptBench, url: str, body: str, ticks: int = 30000) -> tuple[list[str], str]:
    text = "".join(f"  {line}\n" for line in body.splitlines())
    return bench.run(f'def program():\n  camera = rpc_factory("xmlrpc", "{url}")\n{text}end', ticks)


VALUES = [
    ("1", "1"),
    ("-2.5", "-2.5"),
    ("True", "True"),
    ('"snap"', "snap"),
    ("[1, 2, 3]", "[1, 2, 3]"),
    ("[[1, 2], [3, 4]]", "[[1, 2], [3, 4]]"),
    ("p[1, 2, 3, 0, 0, 0.5]", "p[1, 2, 3, 0, 0, 0.5]"),
    ("struct(a=1, b=[True])", "struct(a=1, b=[True])"),
    ('1, "a", p[0, 0, 0, 0, 0, 0]', "[1, a, p[0, 0, 0, 0, 0, 0]]"),
]


@pytest.mark.parametrize(("given", "told"), VALUES)
def test_values_go_there_and_come_back(bench: ScriptBench, rpc: Rpc, given: str, told: str) -> None:
    assert called(bench, rpc.url, f"textmsg(camera.echo({given}))") == ([told], "")


def test_a_pose_is_a_struct_of_its_numbers_on_the_other_side(bench: ScriptBench, rpc: Rpc) -> None:
    assert called(bench, rpc.url, "camera.echo(p[1, 2, 3, 0, 0, 0.5])\nx = camera.pose()\ntextmsg(x[2])") == (["0.4"], "")
    assert rpc.heard == [({"x": 1.0, "y": 2.0, "z": 3.0, "rx": 0.0, "ry": 0.0, "rz": 0.5},)]


def test_calls_stand_in_conditions_loops_functions_and_threads(bench: ScriptBench, rpc: Rpc) -> None:
    told, trouble = called(
        bench,
        rpc.url,
        "def twice(n):\n  return camera.echo(n) * 2\nend\n"
        "thread other():\n  global seen = camera.echo(7)\nend\n"
        "t = run other()\n"
        'if (! camera.start(2)):\n  textmsg("not")\nend\n'
        "i = 0\nwhile camera.echo(i) < 3:\n  i = i + 1\nend\n"
        "join t\ntextmsg(twice(i) + camera.echo(1) * camera.echo(10))\ntextmsg(seen)\ncamera.closeXMLRPCClientConnection()",
    )
    assert (told, trouble) == (["not", "16", "7"], "")


def test_a_secondary_program_may_call(bench: ScriptBench, rpc: Rpc) -> None:
    bench.runner.offer(f'sec tell():\n  camera = rpc_factory("xmlrpc", "{rpc.url}")\n  camera.start(5)\nend')
    for _ in range(20000):
        bench.robot.step()
        if rpc.heard:
            break
    assert rpc.heard == [(5,)]


def test_a_slow_server_holds_up_no_tick(bench: ScriptBench, rpc: Rpc) -> None:
    """While one thread waits for the answer, another goes on in every tick."""
    bench.runner.offer(
        f"def program():\n  n = 0\n  thread counts():\n    while True:\n      n = n + 1\n      sync()\n    end\n  end\n"
        f'  t = run counts()\n  camera = rpc_factory("xmlrpc", "{rpc.url}")\n  textmsg(camera.slow())\nend'
    )
    bench.robot.step(300)
    before = int(bench.runner.variables()["n"])
    bench.robot.step(500)
    assert int(bench.runner.variables()["n"]) == before + 500
    rpc.open.set()
    for _ in range(20000):
        bench.robot.step()
        if bench.state is None:
            break
    assert [told.text for told in bench.runner.told if told.kind is Telling.TEXT][-1] == "at last"


def test_a_program_that_is_ended_while_it_waits_ends_at_once(bench: ScriptBench, rpc: Rpc) -> None:
    bench.runner.offer(f'def program():\n  camera = rpc_factory("xmlrpc", "{rpc.url}")\n  camera.slow()\nend')
    bench.robot.step(300)
    bench.runner.stop()
    bench.robot.step(1)
    assert (bench.state, bench.runner.trouble) == (None, None)


def test_a_server_that_never_answers_is_given_up(bench: ScriptBench, rpc: Rpc, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(remote_calls, "PATIENCE", 0.4)
    _, trouble = called(bench, rpc.url, "camera.slow()")
    assert trouble == f"line 3, column 10: slow(): the server at 127.0.0.1:{rpc.port} has not answered for 0.4 s"


def test_a_dead_server_is_told(bench: ScriptBench) -> None:
    port = free_port()
    _, trouble = called(bench, f"http://127.0.0.1:{port}/RPC2", "camera.start(1)")
    assert trouble == f"line 2, column 12: rpc_factory(): there is no server at 127.0.0.1:{port}"


def test_a_server_that_dies_is_told(bench: ScriptBench, rpc: Rpc) -> None:
    bench.runner.offer(f'def program():\n  camera = rpc_factory("xmlrpc", "{rpc.url}")\n  sleep(1)\n  camera.start(1)\nend')
    bench.robot.step(200)
    rpc.close()
    for _ in range(20000):
        bench.robot.step()
        if bench.state is None:
            break
    assert bench.runner.trouble is not None
    assert bench.runner.trouble.text.startswith(f"start(): there is no server at 127.0.0.1:{rpc.port}")


@pytest.mark.parametrize(
    ("call", "words"),
    [
        ("camera.none()", "none(): the server says: <class 'Exception'>:method \"none\" is not supported"),
        ("camera.fails()", "fails(): the server says: <class 'ValueError'>:the lens is covered"),
        ("camera.start()", "start(): the server says: <class 'TypeError'>:"),
        ("camera.date()", "date(): the answer holds Binary, for which there is no value"),
    ],
)
def test_what_the_server_cannot_do_is_told_in_its_words(bench: ScriptBench, rpc: Rpc, call: str, words: str) -> None:
    told, trouble = called(bench, rpc.url, f'{call}\ntextmsg("on")')
    assert told == []
    assert trouble.startswith(f"line 3, column 10: {words}")


def spoken(data: bytes):
    def answer(connection: socket.socket) -> None:
        connection.recv(1 << 16)
        connection.sendall(data)

    return answer


def dripping(connection: socket.socket) -> None:
    connection.recv(1 << 16)
    connection.sendall(b"HTTP/1.0 200 OK\r\nContent-Type: text/xml\r\nContent-Length: 9000\r\n\r\n")
    for _ in range(9000):
        connection.sendall(b" ")
        time.sleep(0.02)


WHOLE = b"<methodResponse><params><param><value><int>99999999999999999999</int></value></param></params></methodResponse>"
"""Right, but for a number that no controller has: it is one with a decimal point."""

OK = b"HTTP/1.0 200 OK\r\nContent-Type: text/xml\r\n\r\n"


@pytest.mark.parametrize(
    ("data", "words"),
    [
        (OK + WHOLE, ""),
        (OK + b"<html>hello</html>", "the answer is no XML-RPC"),
        (OK + b"", "the answer is no XML-RPC"),
        (OK + b"<methodResponse><params><param><value><int>1</int>", "the answer is no XML-RPC"),
        (OK + b"<methodResponse>" + b" " * (1 << 21), "the answer is no XML-RPC: it has more than 1048576 bytes"),
        (b"HTTP/1.0 404 Not Found\r\n\r\n", "the server answers with HTTP 404 Not Found"),
        (b"HTTP/1.0 302 Found\r\nLocation: http://10.1.2.4/\r\n\r\n", "the server answers with HTTP 302 Found"),
        (b"220 mail.example.org ESMTP\r\n", "the answer is no XML-RPC"),
        (b"", "the connection to 127.0.0.1"),
    ],
)
def test_a_wrong_answer_is_told(bench: ScriptBench, data: bytes, words: str) -> None:
    with raw_server(spoken(data)) as port:
        _, trouble = called(bench, f"http://127.0.0.1:{port}/", "x = camera.start(1)")
    if words:
        assert trouble.startswith(f"line 3, column 14: start(): {words}")
    else:
        assert trouble == ""


def test_an_answer_that_drips_is_given_up(bench: ScriptBench, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(remote_calls, "PATIENCE", 0.5)
    with raw_server(dripping) as port:
        _, trouble = called(bench, f"http://127.0.0.1:{port}/", "x = camera.start(1)")
    assert trouble.startswith("line 3, column 14: start(): ")


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ('rpc_factory("corba", "http://127.0.0.1/")', "type: 'corba'; expected \"xmlrpc\""),
        ('rpc_factory("xmlrpc", "127.0.0.1:8080")', "url: '127.0.0.1:8080'; expected http://ADDRESS:PORT/PATH"),
        ('rpc_factory("xmlrpc", "http://127.0.0.1:x/")', "url: 'http://127.0.0.1:x/'; expected http://ADDRESS:PORT/PATH"),
        ('rpc_factory("xmlrpc", "http://127.0.0.1/a b")', "url: 'http://127.0.0.1/a b'; expected http://ADDRESS:PORT/PATH"),
    ],
)
def test_a_server_that_cannot_be_is_refused(bench: ScriptBench, text: str, words: str) -> None:
    assert bench.run(f"x = {text}")[1] == f"line 1, column 5: rpc_factory(): {words}"


@pytest.mark.parametrize(
    ("body", "words"),
    [
        ("x = 3\nx.start(1)", "line 4, column 5: .start() of an integer: expected a handle, as rpc_factory() gives it"),
        ("camera.echo(None)", "line 3, column 10: echo(): None cannot be sent"),
        ("camera.echo(a=1)", "line 3, column 10: echo(): a remote function has no arguments by name"),
        ("camera.echo", "line 3, column 3: a value alone is no statement"),
    ],
)
def test_a_wrong_call_is_told(bench: ScriptBench, rpc: Rpc, body: str, words: str) -> None:
    assert called(bench, rpc.url, body)[1] == words


def test_a_dot_in_the_name_of_a_remote_function_is_the_servers(bench: ScriptBench, rpc: Rpc) -> None:
    """Found: the text of a URCap calls `server.getTCP` and others of one part of its server."""
    body = (
        "textmsg(camera.tool.mass(camera.echo(2)))\n"
        "cell = struct(left=struct(camera=camera), number=1)\n"
        "textmsg(cell.left.camera.tool.mass(3))\ntextmsg(cell.left.camera.echo(4))\n"
        "cell.right.echo(1)"
    )
    told, trouble = called(bench, rpc.url, body)
    assert told == ["0.5", "0.75", "4"]
    assert trouble == "line 7, column 14: right.echo(): the struct has no member right; it has left, number"
    assert rpc.heard == [(2,), (2,), (3,), (4,)]


def test_a_server_that_has_no_such_part_says_so(bench: ScriptBench, rpc: Rpc) -> None:
    _, trouble = called(bench, rpc.url, "camera.arm.mass(1)")
    assert trouble == ("line 3, column 14: arm.mass(): the server says: <class 'Exception'>:method \"arm.mass\" is not supported")
    assert called(bench, rpc.url, "x = camera.tool")[1] == "line 3, column 7: .tool of a handle: expected a struct"
