"""Two hundred files that are wrong in one place each: one clear line on standard error, exit code 2, never a traceback."""

import copy
import random
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import msgspec
import pytest

from app.files.checked import convert, load
from app.log.recorder import Recorder
from app.runs.runner import simulate
from app.session.prepare import prepare
from app.session.session_file import Session, bundled, find
from pendant.inputs import NOTHING
from sim.exchange.desk import Wishes
from tests.app.command_line import pendant

ODD: tuple[Any, ...] = (None, "", "soon", -1e9, 1e400, [], {}, [[]], {"a": 1}, "\x00", "2020-01-01", -(2**70))
COUNT = {"session": 60, "text": 60, "settings": 20, "program": 20, "log": 40}


def places(value: Any, path: tuple[Any, ...] = ()) -> Iterator[tuple[Any, ...]]:
    """Every place in nested values."""
    items = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ()
    for key, each in items:
        yield (*path, key)
        yield from places(each, (*path, key))


def spoiled(raw: Any, path: tuple[Any, ...], odd: Any) -> Any:
    """A copy with one value replaced."""
    raw = copy.deepcopy(raw)
    *way, last = path
    target = raw
    for key in way:
        target = target[key]
    target[last] = odd
    return raw


def bad_sessions(chance: random.Random) -> Iterator[bytes]:
    """Bundled sessions with an odd value in one place, as JSON, which is YAML too; those that happen to be fine are left out."""
    while True:
        raw = load(find(chance.choice(bundled("sessions"))), dict[str, Any])
        path = chance.choice(list(places(raw)))
        if path == ("title",):
            continue
        made = spoiled(raw, path, chance.choice(ODD))
        text = msgspec.json.encode(made)  # an endless number becomes null, which some fields take
        if not _fine(msgspec.json.decode(text)):
            yield text


def _fine(raw: Any) -> bool:
    from app.files.checked import BadInput

    try:
        prepare(convert(raw, Session, "s"), "s")
    except BadInput:
        return False
    return True


def bad_texts(chance: random.Random) -> Iterator[bytes]:
    """A bundled session's text with bytes that are no YAML, or that change what it says into what it may not say."""
    while True:
        text = find(chance.choice(bundled("sessions"))).read_bytes()
        at = chance.randrange(len(text))
        what = chance.choice(
            [b"\xff\xfe", b"\t- ", b"\nduration: 1\nduration: 2\n", b"&a [*a]", b"\n{", b"\n!!python/object:os\n"]
        )
        yield b"\n: " + text[:at] + what + text[at:]


def bad_settings(chance: random.Random) -> Iterator[bytes]:
    """A configuration with a setting that does not exist or is not allowed."""
    names = ("free_drive.period", "sequence.on", "limits.activation.flange_speed.max", "no.such", "", "free_drive")
    while True:
        value = chance.choice([-1.0, 1e9, "on", None, [1.0], {"a": 1.0}])
        yield msgspec.json.encode({"settings": {chance.choice(names): value}})


def bad_programs(chance: random.Random) -> Iterator[bytes]:
    """A session whose program has an odd value in one place."""
    raw = load(find("program"), dict[str, Any])
    while True:
        path = chance.choice([path for path in places(raw) if path[0] == "program" and path[-1] != "name"])
        made = spoiled(raw, path, chance.choice(ODD))
        text = msgspec.json.encode(made)  # an endless number becomes null, which some fields take
        if not _fine(msgspec.json.decode(text)):
            yield text


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> bytes:
    """A short log."""
    path = tmp_path_factory.mktemp("log") / "log.mcap"
    simulation = simulate(prepare(convert({"title": "t", "duration": 1.0}, Session, "s"), "s"))
    with Recorder(path, simulation, "t") as recorder:
        for _ in range(200):
            recorder.see(simulation, simulation.tick(Wishes(NOTHING, (), ())))
    return path.read_bytes()


def bad_logs(chance: random.Random, data: bytes) -> Iterator[bytes]:
    """No log, a log that ends before it begins, and a log with other bytes in its header, which must be there."""
    while True:
        kind = chance.randrange(3)
        if kind == 0:
            yield chance.randbytes(chance.randrange(400))
        elif kind == 1:
            yield data[: chance.randrange(2000)]
        else:
            at = chance.randrange(8, 30)
            yield data[:at] + bytes(each ^ 0xFF for each in data[at : at + 9]) + data[at + 9 :]


def refused(arguments: list[str], monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> str:
    code = pendant(monkeypatch, *arguments)
    out, err = capsys.readouterr()
    assert code == 2, (arguments, out, err)
    assert err.startswith("pendant: ")
    assert err.count("\n") == 1
    assert err.endswith("\n")
    assert err[:-1].isprintable()
    assert "Traceback" not in out + err
    return err


@pytest.mark.parametrize(
    ("kind", "make"),
    [("session", bad_sessions), ("text", bad_texts), ("settings", bad_settings), ("program", bad_programs)],
)
def test_a_malformed_file_is_one_line(
    kind: str, make: Any, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    files = make(random.Random(kind))
    path = tmp_path / "bad.yaml"
    for k in range(COUNT[kind]):
        path.write_bytes(next(files))
        command = ["check", str(path)] if k % 2 or kind == "settings" else ["run", str(path), "--out", str(tmp_path / "out")]
        assert "bad.yaml" in refused(command, monkeypatch, capsys)
    assert not (tmp_path / "out").exists()


def test_a_malformed_log_is_one_line(
    whole: bytes, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    def showed(*_: Any) -> None:
        raise AssertionError("a malformed log was shown")

    monkeypatch.setattr("app.serving.Replay", showed)
    files = bad_logs(random.Random("log"), whole)
    path = tmp_path / "bad.mcap"
    for _ in range(COUNT["log"]):
        path.write_bytes(next(files))
        assert "bad.mcap" in refused(["replay", str(path)], monkeypatch, capsys)


def test_any_byte_of_a_log_may_be_wrong(whole: bytes, tmp_path: Path) -> None:
    """Whatever is wrong in it, it is read, or refused in a line."""
    from app.files.checked import BadInput
    from app.log_reading.reader import read

    chance = random.Random(3)
    path = tmp_path / "bad.mcap"
    opened = 0
    for _ in range(60):
        at = chance.randrange(len(whole))
        path.write_bytes(whole[:at] + bytes([whole[at] ^ (1 + chance.randrange(255))]) + whole[at + 1 :])
        try:
            read(path)
            opened += 1
        except BadInput:
            continue
    assert opened < 60


def test_they_are_two_hundred() -> None:
    assert sum(COUNT.values()) == 200
