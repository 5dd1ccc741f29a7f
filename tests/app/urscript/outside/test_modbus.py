"""Modbus signals of scripts against pymodbus's own server; a unit that is dead, slow or wrong."""

import socket
import threading
import time
from collections.abc import Iterator

import pytest

from app.urscript.outside import modbus_functions, modbus_units
from app.urscript.running.told import Telling, Told
from pendant.tick.modes import Mode
from tests.app.urscript.outside.servers import Modbus, free_port, raw_server
from tests.app.urscript.script_bench import ScriptBench


@pytest.fixture(scope="module")
def unit() -> Iterator[Modbus]:
    server = Modbus()
    yield server
    server.close()


@pytest.fixture
def bench(shared: ScriptBench) -> Iterator[ScriptBench]:
    yield shared
    shared.runner.memory.units.end()


@pytest.fixture(scope="module")
def shared() -> ScriptBench:
    return ScriptBench()


def paced(bench: ScriptBench, text: str, seconds: float = 6.0) -> tuple[list[str], str]:
    """As `ScriptBench.run`, at the clock's pace: what answers lives by the clock."""
    new: list[Told] = []
    bench.runner.listen(new.append)
    bench.runner.offer(text)
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        bench.robot.step()
        time.sleep(0.001)
        if bench.state is None:
            break
    bench.runner.stop()
    bench.robot.step()
    bench.runner.forget(new.append)
    trouble = bench.runner.trouble
    return [each.text for each in new if each.kind is Telling.TEXT], "" if trouble is None else str(trouble)


WAITED = """
  i = 0
  while modbus_get_error("{0}") != 0 and i < 1000:
    i = i + 1
    sync()
  end
"""


def add(port: int, rest: str) -> str:
    """The line that adds a signal of a unit on this machine."""
    return f'modbus_add_signal("127.0.0.1:{port}", 255, {rest})'


def whole(*lines: str) -> str:
    """A program of these lines."""
    return "def p():\n" + "".join(f"  {line}\n" for part in lines for line in part.splitlines()) + "end"


def program(unit: Modbus, signals: str, body: str) -> str:
    """A program that adds signals, waits for them, and goes on."""
    lines, waited = "", ""
    for signal in signals.split(";"):
        name = signal.split(",")[-1].split('"')[1] if signal.count(",") == 2 else signal.split('"')[1]
        lines += f'  modbus_add_signal("127.0.0.1:{unit.port}", 255, {signal.strip()})\n'
        waited += WAITED.format(name)
    return f"def program():\n{lines}{waited}" + "".join(f"  {line}\n" for line in body.splitlines()) + "end"


def test_what_a_unit_has_is_read(bench: ScriptBench, unit: Modbus) -> None:
    signals = '3, 0, "di"; 7, 2, "ri"; 9, 3, "ro"; 4, 1, "do"'
    body = "\n".join(f'textmsg(modbus_get_signal_status("{name}", False))' for name in ("di", "ri", "ro", "do"))
    told, trouble = paced(bench, program(unit, signals, body))
    assert (told, trouble) == (["True", "107", "109", "False"], "")


def test_several_in_a_row_are_a_list(bench: ScriptBench, unit: Modbus) -> None:
    text = program(unit, '0, 0, "di", True, 7; 20, 2, "ri", False, 3', 'textmsg(modbus_get_signal_status("di", False))')
    told, trouble = paced(bench, text + "\n")
    assert (told, trouble) == (["[True, False, False, True, False, False, True]"], "")
    assert paced(bench, 'textmsg(modbus_get_signal_status("ri"))') == (["[120, 121, 122]"], "")


def test_outputs_are_written(bench: ScriptBench, unit: Modbus) -> None:
    signals = '40, 1, "do"; 41, 3, "ro"; 50, 3, "rs", False, 2'
    body = (
        'modbus_set_output_signal("do", True, False)\nmodbus_set_output_register("ro", 4711, False)\n'
        'modbus_set_output_register("rs", [1, 65535], False)\nsleep(0.4)\n'
        'textmsg(modbus_get_signal_status("do", False))\ntextmsg(modbus_get_signal_status("ro", False))\n'
        'textmsg(modbus_get_signal_status("rs", False))'
    )
    assert paced(bench, program(unit, signals, body)) == (["True", "4711", "[1, 65535]"], "")
    assert {5, 6, 16} <= set(unit.heard)


def test_both_are_done_in_one_request(bench: ScriptBench, unit: Modbus) -> None:
    text = (
        f'def program():\n  modbus_add_rw_signal("127.0.0.1:{unit.port}", 255, 30, 2, 32, 1, "both")\n{WAITED.format("both")}'
        '  modbus_set_output_register("both", 77, False)\n  sleep(0.4)\n'
        f'  modbus_add_signal("127.0.0.1:{unit.port}", 255, 32, 3, "seen")\n{WAITED.format("seen")}'
        '  textmsg(modbus_get_signal_status("both"))\n  textmsg(modbus_get_signal_status("seen"))\nend'
    )
    assert paced(bench, text) == (["[130, 131]", "77"], "")
    assert 23 in unit.heard


def test_a_command_of_a_programs_own_is_sent(bench: ScriptBench, unit: Modbus) -> None:
    """Function 6 to register 60: the value 9."""
    command = f'modbus_send_custom_command("127.0.0.1:{unit.port}", 255, 6, [0, 60, 0, 9])'
    text = program(unit, '60, 3, "ro"', f'{command}\nsleep(0.6)\ntextmsg(modbus_get_signal_status("ro"))')
    assert paced(bench, text) == (["9"], "")


def test_an_address_that_the_unit_has_not_is_an_error_of_the_device(bench: ScriptBench, unit: Modbus) -> None:
    text = whole(
        add(unit.port, '5000, 3, "far"'),
        'modbus_set_signal_watchdog("far", 30)\nsleep(0.5)',
        'textmsg(modbus_get_error("far"))\ntextmsg(modbus_get_error("far", 1))\ntextmsg(modbus_get_error("far", 2))',
        'textmsg(modbus_get_time_since_signal_invalid("far") > 0.3)',
    )
    assert paced(bench, text) == (["2", "2", "0", "True"], "")


def test_reading_a_dead_units_signal_ends_the_program_after_the_watchdogs_time(bench: ScriptBench) -> None:
    port = free_port()
    loop = 'while True:\n  x = modbus_get_signal_status("di")\n  sync()\nend'
    words = f"Modbus signal di: no answer from 127.0.0.1:{port} for 2 s"
    told, trouble = bench.run(whole(add(port, '0, 0, "di"'), loop), 3000)
    assert trouble == f"line 4, column 9: modbus_get_signal_status(): {words}"
    assert told in ([], [words])


def test_within_the_watchdogs_time_the_value_before_is_read(bench: ScriptBench) -> None:
    read = 'textmsg(modbus_get_signal_status("di"))'
    text = whole(add(free_port(), '0, 0, "di"'), 'modbus_set_signal_watchdog("di", 2.5)', "sleep(2.2)", read)
    assert bench.run(text, 3000) == (["False"], "")


def test_signals_of_a_dead_unit_that_nobody_reads_are_told_once(bench: ScriptBench) -> None:
    """Found: saved programs add their installation's signals; the maker's example waits 15 s with modbus_get_error()."""
    port = free_port()
    waits = 'i = 0\nwhile modbus_get_error("do") != 0 and i < 2000:\n  i = i + 1\n  sync()\nend\ntextmsg("connection error")'
    writes = 'modbus_set_output_signal("do", True)'
    lines = [add(port, '0, 0, "di"'), add(port, '0, 1, "do"'), waits, writes, "sleep(1)"]
    told, trouble = bench.run(whole(*lines), 4000)
    assert (told, trouble) == ([f"Modbus signal di: no answer from 127.0.0.1:{port} for 2 s", "connection error"], "")
    assert bench.run('sleep(3)\ntextmsg("on")', 3000) == (["on"], "")


def test_a_unit_that_fails_when_no_program_runs_is_told_too(bench: ScriptBench) -> None:
    port = free_port()
    assert bench.run(whole(add(port, '0, 0, "di"'))) == ([], "")
    bench.robot.step(1100)
    assert bench.runner.told[-1].text == f"Modbus signal di: no answer from 127.0.0.1:{port} for 2 s"


def test_what_a_dead_unit_said_last_asks_for_no_free_drive(bench: ScriptBench) -> None:
    server = Modbus()
    text = whole(add(server.port, '0, 0, "hand"'), 'modbus_set_digital_input_action("hand", "freedrive")')
    assert paced(bench, text) == ([], "")
    assert any(bench.robot.step().mode is Mode.FREE_DRIVE or time.sleep(0.0005) for _ in range(3000))
    server.close()
    signal, end = bench.runner.memory.units.signal("hand"), time.monotonic() + 10.0
    while signal.valid and time.monotonic() < end:
        time.sleep(0.01)
    assert signal.values == (1,)
    assert bench.robot.step(300).mode is not Mode.FREE_DRIVE
    assert paced(bench, 'modbus_set_digital_input_action("hand", "default")') == ([], "")


def test_a_unit_that_comes_back_is_connected_again(bench: ScriptBench) -> None:
    first = Modbus()
    port = first.port
    text = program(
        first,
        '3, 2, "ri"',
        'modbus_set_signal_watchdog("ri", 60)\ntextmsg("there")\nwhile modbus_get_error("ri") == 0:\n  sync()\nend\n'
        'textmsg("gone")\nwhile modbus_get_error("ri") != 0:\n  sync()\nend\ntextmsg(modbus_get_signal_status("ri"))',
    )
    bench.runner.offer(text)
    bench.robot.step()
    second = first
    new: list[Told] = []
    bench.runner.listen(new.append)
    told: list[str] = []
    end = time.monotonic() + 20.0
    while time.monotonic() < end and bench.state is not None:
        bench.robot.step()
        time.sleep(0.001)
        now = [each.text for each in new if each.kind is Telling.TEXT]
        if len(now) > len(told):
            told = now
            if told[-1] == "there":
                first.close()
            elif told[-1] == "gone":
                second = Modbus(port)
    second.close()
    assert told == ["there", "gone", "103"]


def test_what_is_written_to_a_unit_that_is_not_there_is_not_written_later(bench: ScriptBench) -> None:
    """But what follows the program's state is: the unit must not take a program for running that is over."""
    port = free_port()
    names = ("word", "run")
    watchdogs = "\n".join(f'modbus_set_signal_watchdog("{name}", 60)' for name in names)
    writes = 'modbus_set_runstate_dependent_choice("run", 3)\nmodbus_set_output_register("word", 4711)\nsleep(1)'
    assert paced(bench, whole(add(port, '41, 3, "word"'), add(port, '42, 3, "run"'), watchdogs, writes)) == ([], "")
    server = Modbus(port)
    word, run = map(bench.runner.memory.units.signal, names)
    end = time.monotonic() + 10.0
    while not (word.valid and run.valid and run.values == (0,)):
        assert time.monotonic() < end
        time.sleep(0.01)
    server.close()
    assert word.values == (141,)
    assert server.heard.count(6) == 1


def test_what_a_silent_unit_does_not_answer_is_not_written_again(bench: ScriptBench) -> None:
    with raw_server(silent) as port:
        assert bench.run(whole(add(port, '41, 3, "word"'), 'modbus_set_output_register("word", 4711)')) == ([], "")
        word, end = bench.runner.memory.units.signal("word"), time.monotonic() + 10.0
        while word.wanted is not None:
            assert time.monotonic() < end
            time.sleep(0.01)
        assert not word.connected


def silent(connection: socket.socket) -> None:
    while connection.recv(1 << 12):
        pass


def babbling(connection: socket.socket) -> None:
    while connection.recv(1 << 12):
        connection.sendall(b"HTTP/1.0 400 Bad Request\r\n\r\n" * 20)


def short(connection: socket.socket) -> None:
    """A frame that says it has one register, and has none."""
    while data := connection.recv(1 << 12):
        connection.sendall(data[:4] + b"\0\3" + data[6:7] + b"\4\0")


@pytest.mark.parametrize("answer", [silent, babbling, short])
def test_reading_a_unit_that_is_slow_or_wrong_ends_the_program_and_holds_up_no_tick(bench: ScriptBench, answer) -> None:
    with raw_server(answer) as port:
        loop = 'while True:\n  n = n + 1\n  x = modbus_get_signal_status("ri")\n  sync()\nend'
        text = whole("n = 0", add(port, '0, 2, "ri"'), loop)
        bench.runner.offer(text)
        bench.robot.step(200)
        before = int(bench.runner.variables()["n"])
        bench.robot.step(500)
        assert int(bench.runner.variables()["n"]) == before + 500
        bench.robot.step(400)
        assert bench.runner.trouble is not None
        assert bench.runner.trouble.text.startswith("modbus_get_signal_status(): Modbus signal ri: no answer from")


def test_an_output_follows_the_programs_state_and_an_input_asks_for_free_drive(bench: ScriptBench, unit: Modbus) -> None:
    follows = 'modbus_set_runstate_dependent_choice("run", 3)\nsleep(0.4)\ntextmsg(modbus_get_signal_status("run"))'
    assert paced(bench, program(unit, '20, 1, "run"', follows)) == (["True"], "")
    assert paced(bench, 'sleep(0.5)\nmodbus_set_runstate_dependent_choice("run", 0)') == ([], "")
    text = whole(add(unit.port, '0, 0, "hand"'), 'modbus_set_digital_input_action("hand", "freedrive")')
    assert paced(bench, text) == ([], "")
    assert any(bench.robot.step().mode is Mode.FREE_DRIVE or time.sleep(0.0005) for _ in range(3000))
    assert paced(bench, 'modbus_set_digital_input_action("hand", "default")') == ([], "")


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ('modbus_get_signal_status("none", False)', "signal_name: there is no signal 'none'"),
        ('modbus_add_signal("127.0.0.1", 255, 0, 7, "a")', "signal_type: 7 is out of range, allowed: 0 to 3"),
        ('modbus_add_signal("127.0.0.1:x", 255, 0, 1, "a")', "IP: '127.0.0.1:x'; expected ADDRESS or ADDRESS:PORT"),
        ('modbus_add_signal("127.0.0.1:²", 255, 0, 1, "a")', "IP: '127.0.0.1:²'; expected ADDRESS or ADDRESS:PORT"),
        ('modbus_add_signal("127.0.0.1", 255, 0, 1, "")', "signal_name: '' has 0 characters, allowed: 1 to 20"),
        ('modbus_send_custom_command("127.0.0.1", 1, 6, [300])', "300 is out of range, allowed: 0 to 255"),
        ('modbus_reset_connection("127.0.0.1")', "connection_id: there is no signal at 127.0.0.1"),
    ],
)
def test_what_cannot_be_is_told(bench: ScriptBench, text: str, words: str) -> None:
    assert bench.run(whole(text))[1] == f"line 2, column 3: {text.partition('(')[0]}(): {words}"


def test_a_signal_of_another_kind_is_not_written(bench: ScriptBench, unit: Modbus) -> None:
    add = f'modbus_add_signal("127.0.0.1:{unit.port}", 255, 0, 2, "ri")'
    _, trouble = bench.run(f'def p():\n  {add}\n  modbus_set_output_register("ri", 1)\nend')
    assert trouble == "line 3, column 3: modbus_set_output_register(): signal_name: ri is no register output"
    add = f'modbus_add_signal("127.0.0.1:{unit.port}", 255, 0, 3, "ro", False, 2)'
    _, trouble = bench.run(f'def p():\n  {add}\n  modbus_set_output_register("ro", 1)\nend')
    assert trouble == "line 3, column 3: modbus_set_output_register(): 1 values, the signal has 2"


def test_a_register_follows_the_programs_state(bench: ScriptBench, unit: Modbus) -> None:
    """Found: pendants write this line for each register output."""
    follows = 'modbus_set_runstate_dependent_choice("word", 3)\nmodbus_set_runstate_dependent_choice("words", 3)\nsleep(0.4)'
    tells = 'textmsg(modbus_get_signal_status("word"))\ntextmsg(modbus_get_signal_status("words"))'
    signals = '33, 3, "word"; 34, 3, "words", False, 2'
    assert paced(bench, program(unit, signals, f"{follows}\n{tells}")) == (["1", "[1, 1]"], "")
    units, end = bench.runner.memory.units, time.monotonic() + 10.0
    while any(units.signal("word").values) or any(units.signal("words").values):
        assert time.monotonic() < end
        bench.robot.step()
        time.sleep(0.001)


def test_an_input_follows_no_state(bench: ScriptBench, unit: Modbus) -> None:
    text = whole(add(unit.port, '3, 2, "ri"'), 'modbus_set_runstate_dependent_choice("ri", 3)')
    assert bench.run(text)[1] == "line 3, column 3: modbus_set_runstate_dependent_choice(): signal_name: ri is no output"


def test_a_connection_is_made_anew(bench: ScriptBench, unit: Modbus) -> None:
    text = program(unit, '3, 2, "ri"', f'modbus_reset_connection("127.0.0.1:{unit.port}")\ntextmsg(modbus_get_error("ri"))')
    assert paced(bench, text) == (["0"], "")


def test_a_connection_that_stays_bad_is_told(bench: ScriptBench, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(modbus_functions, "RECONNECTING", 0.5)
    text = (
        f'def p():\n  modbus_add_signal("127.0.0.1:{free_port()}", 255, 0, 2, "ri")\n  modbus_reset_connection("127.0.0.1")\nend'
    )
    assert bench.run(text)[1] == "line 3, column 3: modbus_reset_connection(): the signals at 127.0.0.1 have errors for 0.5 s"


def test_there_are_not_more_signals_than_a_robot_has_room_for(bench: ScriptBench, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(modbus_units, "MOST_SIGNALS", 3)
    text = f'i = 0\nwhile i < 5:\n  modbus_add_signal("127.0.0.1:{free_port()}", 255, i, 2, str_cat("s", i))\n  i = i + 1\nend'
    assert bench.run(text)[1] == "line 3, column 3: modbus_add_signal(): more than 3 signals, or 16 units"


def test_no_thread_is_left(bench: ScriptBench, unit: Modbus) -> None:
    bench.run(f'modbus_add_signal("127.0.0.1:{unit.port}", 255, 0, 2, "ri")')
    assert any(thread.name.startswith("modbus") for thread in threading.enumerate())
    bench.runner.begin()
    end = time.monotonic() + 5.0
    while any(thread.name.startswith("modbus 1") for thread in threading.enumerate()) and time.monotonic() < end:
        time.sleep(0.01)
    assert not any(thread.name.startswith("modbus 1") for thread in threading.enumerate())
