"""The control channel from outside: what it answers, what it opens, and that nobody who waits costs another."""

import json
import os
import socket
import time
import urllib.error
import urllib.request
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from app.files.bad_input import BadInput
from app.log.live import LiveRecording
from app.robot_interface.faults import control_channel, timed_http
from app.robot_interface.interfaces import RobotInterfaces
from app.robot_interface.ports import CONTROL
from app.served_robot import ServedRobot, free_addresses
from app.session.session_file import SHIPPED_ALONE, AllowedFiles, Setup, located
from pendant.all_settings import Settings
from sim.arm.scenario import Scenario
from sim.run.loop import Loop
from sim.simulation import Simulation
from tests.app.web.raw_client import until
from tests.sim.arms import UR5E

TOKEN = "t"


class Channel:
    """A robot in this process, and its control channel."""

    def __init__(self, folder: Path) -> None:
        self.loop = Loop(lambda: Simulation(UR5E, Scenario(seed=1), Settings()))
        self.host = next(free_addresses())
        self.recording = LiveRecording(self.loop, folder / "logs")
        self.robot = RobotInterfaces(
            self.loop, UR5E, host=self.host, token=TOKEN, recording=self.recording, files=AllowedFiles(folder)
        )
        self.robot.start()
        self.loop.start()
        self.port = self.robot.ports[CONTROL]

    def close(self) -> None:
        self.recording.close()
        self.robot.close()
        self.loop.stop()

    def ask(self, path: str, body: Any = None, method: str | None = None, token: str = TOKEN) -> tuple[int, Any]:
        """Status and JSON of an answer."""
        request = urllib.request.Request(
            f"http://{self.host}:{self.port}/{path}",
            data=None if body is None else json.dumps(body).encode(),
            headers={"Authorization": f"Bearer {token}"},
            method=method,
        )
        try:
            with urllib.request.urlopen(request, timeout=30.0) as answer:
                return answer.status, json.load(answer)
        except urllib.error.HTTPError as error:
            return error.code, json.load(error)

    def say(self, data: bytes) -> socket.socket:
        """A connection that has said something."""
        made = socket.create_connection((self.host, self.port), timeout=10.0)
        made.sendall(data)
        return made

    def head(self, line: str, *more: str) -> bytes:
        """A request's head."""
        lines = [line, f"Host: {self.host}:{self.port}", f"Authorization: Bearer {TOKEN}", *more]
        return ("\r\n".join(lines) + "\r\n\r\n").encode()


def heard(made: socket.socket) -> tuple[int, Any]:
    """Status and JSON of what comes until the connection ends."""
    data = b""
    while part := made.recv(4096):
        data += part
    head, _, body = data.partition(b"\r\n\r\n")
    return int(head.split()[1]), json.loads(body)


@pytest.fixture
def channel(tmp_path: Path) -> Iterator[Channel]:
    made = Channel(tmp_path)
    yield made
    made.close()


def test_a_field_is_worked_out_when_it_is_asked_for(channel: Channel) -> None:
    """All were zero until some client of RTDE had asked for them: a test that read one passed, whatever the robot did."""
    until(lambda: channel.loop.simulation.tick_count > 50, "it runs")
    status, q = channel.ask("field/actual_q")
    assert (status, [round(angle, 1) for angle in q]) == (200, [round(angle, 1) for angle in UR5E.chain.home])
    assert channel.ask("field/robot_mode") == (200, 7)
    assert channel.ask("field/target_gravity")[1] != [0.0, 0.0, 0.0]
    channel.ask("pace", {"paused": True})
    until(lambda: channel.loop.actual_rate == 0.0, "it stands")
    assert channel.ask("field/timestamp")[1] == channel.ask("field/timestamp")[1], "a paused robot answers, too"
    channel.ask("pace", {"paused": False})


def test_a_field_of_a_simulation_that_has_broken_down_is_answered(channel: Channel, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(channel.loop.simulation, "tick", lambda wishes: 1 // 0)
    until(lambda: channel.loop.failure != "", "it broke down")
    assert channel.ask("field/safety_mode") == (200, 9)
    state = channel.ask("state")[1]
    assert (state["failure"], state["safety_mode"]) == ("ZeroDivisionError: integer division or modulo by zero", "FAULT")
    monkeypatch.undo()
    assert channel.ask("restart", {})[0] == 200
    assert channel.ask("state")[1]["failure"] == ""


def test_what_is_broken_is_in_the_state(channel: Channel) -> None:
    assert channel.ask("state")[1]["broken"] == {}
    channel.loop.troubles.failed("the tab Script", RuntimeError("deque mutated during iteration"))
    assert channel.ask("state")[1]["broken"] == {"the tab Script": "RuntimeError: deque mutated during iteration"}
    until(lambda: any(each["kind"] == "part_broken" for each in channel.ask("events")[1]), "it is an event")


@pytest.mark.parametrize(
    ("path", "body", "method", "status"),
    [
        ("nothing", None, None, 404),
        ("state", {}, "POST", 405),
        ("actions", None, "GET", 405),
        ("state", None, "BREW", 405),
        ("field/none", None, None, 400),
        ("events?after=x", None, None, 400),
        ("actions", [1], None, 400),
        ("pace", {"speed": 7.0}, None, 400),
        ("begin", {"robot": 3}, None, 400),
    ],
)
def test_every_error_is_json(channel: Channel, path: str, body: Any, method: str | None, status: int) -> None:
    code, said = channel.ask(path, body, method)
    assert code == status
    assert list(said) == ["error"]
    assert said["error"].startswith("control channel: ")


@pytest.mark.parametrize(
    "data", [b"\x16\x03\x01\x02\x00", b"GET\r\n\r\n", b"GET / HTTP/x\r\n\r\n", b"POST /x HTTP/1.1\r\nContent-Length: x\r\n\r\n"]
)
def test_what_is_no_request_is_answered_in_json(channel: Channel, data: bytes) -> None:
    status, said = heard(channel.say(data))
    assert status == 400
    assert "no" in said["error"]


def test_who_has_no_token_is_told_in_json(channel: Channel) -> None:
    assert channel.ask("state", token="x") == (401, {"error": "Authorization: expected Bearer and the token"})


def test_an_error_of_our_own_is_json_and_told(channel: Channel, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(channel.robot.peers, "all", lambda: 1 // 0)
    status, said = channel.ask("connections")
    assert (status, said["error"]) == (500, "control channel: ZeroDivisionError: integer division or modulo by zero")
    assert "a request of the control channel" in channel.loop.troubles.now()


def test_half_a_request_costs_nobody_else(channel: Channel) -> None:
    """200 of them, and whoever had the token was answered a bare 503."""
    waiting = [channel.say(b"POST /state HTTP/1.1\r\nHost: ") for _ in range(200)]
    began = time.monotonic()
    answers = [channel.ask("state")[0] for _ in range(20)]
    assert answers == [200] * 20
    assert time.monotonic() - began < 10.0
    bodies = [channel.say(channel.head("POST /pace HTTP/1.1", "Content-Length: 20") + b"{") for _ in range(40)]
    assert [channel.ask("state")[0] for _ in range(5)] == [200] * 5
    for made in (*waiting, *bodies):
        made.close()


def test_a_request_has_a_time_limit(channel: Channel, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(timed_http, "HEAD_TIME", 0.3)
    monkeypatch.setattr(control_channel, "LONGEST", 0.5)
    for data in (b"", b"GET /state HT", channel.head("POST /pace HTTP/1.1", "Content-Length: 20") + b"{"):
        status, said = heard(channel.say(data))
        assert (status, list(said)) == (408, ["error"])
    made = channel.say(channel.head("GET /state HTTP/1.1"))
    assert b"200 OK" in made.recv(65536)
    made.sendall(b"GET /st")
    assert heard(made)[0] == 408, "the second on a connection, too"


def test_more_than_may_wait_are_ended_the_oldest_first(channel: Channel, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(timed_http, "MOST_WAITING", 3)
    made = []
    for _ in range(4):
        made.append(channel.say(b"GET /state"))
        time.sleep(0.1)  # until it is read
    assert heard(made[0])[0] == 408
    assert channel.ask("state")[0] == 200
    for each in made[1:]:
        each.close()


def test_a_set_up_names_what_the_command_line_may_and_nothing_else(channel: Channel, tmp_path: Path) -> None:
    """Any file of the machine could be had, and errors told which there are."""
    said: list[str] = []
    for path in ("/etc/passwd", "/etc/no-such-file.yaml", "/proc/self/environ", "/x.yaml"):
        for field in ("robot", "tool"):
            status, answer = channel.ask("begin", {field: path})
            assert status == 400
            said.append(answer["error"].replace(path, "X").replace(field, "F"))
    assert set(said) == {"control channel: F = X: a file in the folder of this one or below; with --any-file it may be anywhere"}
    (tmp_path / "tool.yaml").write_text("name: mine\nmass: 0.5\ncom: [0.0, 0.0, 0.05]\ntcp: [0.0, 0.0, 0.1]\n")
    assert channel.ask("begin", {"tool": "tool.yaml"})[0] == 200
    assert channel.loop.scenario.tool is not None
    assert channel.loop.scenario.tool.name == "mine"


def test_without_a_configuration_only_what_is_shipped_may_be_named() -> None:
    assert located(Setup(), SHIPPED_ALONE, "x") == Setup()
    for name in ("tool.yaml", "/etc/passwd"):
        with pytest.raises(BadInput, match=r"tool = .*: a shipped one; with --any-file it may be anywhere"):
            located(Setup(tool=name), SHIPPED_ALONE, "x")
    assert located(Setup(tool="/etc/passwd"), AllowedFiles(anywhere=True), "x").tool == "/etc/passwd"


def test_a_pipe_keeps_nobody_waiting(channel: Channel, tmp_path: Path) -> None:
    """Reading one waited for its other end, for good: neither Ctrl-C nor SIGTERM ended the process then."""
    os.mkfifo(tmp_path / "pipe.yaml")
    began = time.monotonic()
    status, said = channel.ask("begin", {"tool": "pipe.yaml"})
    assert (status, time.monotonic() - began < 3.0) == (400, True)
    assert "is a pipe; expected a regular file" in said["error"]


def test_a_recording_on_a_full_disk_is_refused_and_one_that_breaks_is_told(
    channel: Channel, monkeypatch: pytest.MonkeyPatch
) -> None:
    """It was answered with 200 and the path of the last one."""
    from app.files import disk_room

    monkeypatch.setattr(disk_room, "free", lambda folder: 1_000_000)
    status, said = channel.ask("recording", {"on": True})
    assert status == 400
    assert "a disk with 50 MB of room" in said["error"]
    assert channel.ask("state")[1]["recording"] is None
    monkeypatch.undo()
    status, said = channel.ask("recording", {"on": True})
    assert (status, said["failure"]) == (200, "")
    assert channel.ask("state")[1]["recording"] == said["path"]
    monkeypatch.setattr(disk_room, "free", lambda folder: 0)
    began = time.monotonic()
    until(lambda: channel.ask("state")[1]["recording"] is None, "it has ended")
    assert "the disk is full" in channel.ask("state")[1]["recording_failure"]
    until(lambda: any(each["kind"] == "recording_broken" for each in channel.ask("events")[1]), "it is an event")
    assert time.monotonic() - began < 5.0


def test_a_wish_that_a_restart_takes_away_is_answered(channel: Channel) -> None:
    """Who had asked for an action as the simulation started over was never answered."""
    channel.ask("pace", {"paused": True})
    until(lambda: channel.loop.actual_rate == 0.0, "it stands")
    begun = channel.robot.cabinet.act([])
    channel.loop.reset().result(10.0)
    assert begun.cancelled()
    channel.ask("pace", {"paused": False})


def test_a_request_that_is_not_whole_when_the_robot_ends_is_no_error(tmp_path: Path) -> None:
    robot = ServedRobot(tmp_path)
    robot.start()
    head = "POST /begin HTTP/1.1\r\nHost: {}:{}\r\nAuthorization: Bearer {}\r\nContent-Length: 1000\r\n\r\n{{"
    with socket.create_connection((robot.host, robot.ports[CONTROL]), 5.0) as line:
        line.sendall(head.format(robot.host, robot.ports[CONTROL], robot._token).encode())
        robot.state()  # by the time it has answered it has read what came before
        robot.stop()
    assert "Traceback" not in (tmp_path / "robot.log").read_text()
