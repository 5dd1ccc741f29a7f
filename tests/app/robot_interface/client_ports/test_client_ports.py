"""Primary, secondary and real-time packages, read by the layouts of the documentation."""

import asyncio
import socket
import struct
from collections.abc import Iterator

import pytest

from app.robot_interface.client_ports import primary_messages as messages
from app.robot_interface.client_ports.bare_commands import LINES, LONGEST
from app.robot_interface.client_ports.client_session import PrimarySession, RealtimeSession, StreamSession, Talking
from app.robot_interface.client_ports.primary_packages import ROBOT_TYPES, RobotState
from app.robot_interface.client_ports.realtime_package import SIZE
from app.robot_interface.controller.robot_words import SafetyMode
from app.robot_interface.dashboard.dashboard_commands import DashboardCommands
from app.robot_interface.transport.outbox import Outbox
from app.robot_interface.transport.peers import Peers
from app.robot_interface.transport.tcp_port import Farewell
from app.urscript.running.script_runner import ScriptRunner
from pendant.events.event import Event, Kind
from pendant.inputs import Command
from tests.app.robot_interface.robot_bench import RobotBench
from tests.sim.arms import UR5E

SIZES = {0: 47, 1: 251, 2: 37, 3: 75, 4: 101, 5: 225, 6: 445, 7: 61, 8: 9, 11: 26, 12: 8}
"""Of the packages in a robot state [bytes]."""


class Cell:
    """A robot, and one connection of each kind."""

    def __init__(self) -> None:
        self.robot, self.peers = RobotBench(), Peers()
        self.robot.step(60)
        self.commands = DashboardCommands(self.robot.cabinet, "UR5")
        self.state = RobotState(self.robot.cabinet, UR5E)
        self.scripts = ScriptRunner(self.robot.cabinet)
        self._sockets: list[socket.socket] = []

    def open(self, kind: str, writable: bool = True) -> tuple[StreamSession, socket.socket]:
        ours, theirs = socket.socketpair()
        theirs.setblocking(False)
        self._sockets += [ours, theirs]
        outbox = Outbox(ours)
        peer = self.peers.join(kind, "here", outbox)
        common = (Talking(self.robot.cabinet, self.commands, self.peers, self.scripts), peer)
        if kind == "real-time":
            return RealtimeSession(*common, outbox=outbox, writable=writable), theirs
        told = kind == "primary"
        session = PrimarySession(*common, outbox=outbox, writable=writable, state=self.state, messages=told)
        return session, theirs

    def close(self) -> None:
        for each in self._sockets:
            each.close()


@pytest.fixture
def cell() -> Iterator[Cell]:
    cell = Cell()
    yield cell
    cell.close()


def packages(theirs: socket.socket) -> list[bytes]:
    """What has come, without the sizes."""
    try:
        data = theirs.recv(1 << 20)
    except BlockingIOError:
        return []
    found = []
    while data:
        (size,) = struct.unpack_from(">i", data)
        found.append(data[4:size])
        data = data[size:]
    return found


def parts(state: bytes) -> dict[int, bytes]:
    """Packages in a robot state."""
    assert state[0] == 16
    found, at = {}, 1
    while at < len(state):
        size, kind = struct.unpack_from(">IB", state, at)
        found[kind] = state[at + 5 : at + size]
        at += size
    return found


def say(session: StreamSession, text: str | bytes) -> None:
    asyncio.run(session.hear(text.encode() if isinstance(text, str) else text))


def test_a_client_is_told_version_and_state_first(cell: Cell) -> None:
    _, theirs = cell.open("primary")
    cell.robot.step()
    version, state, _ = packages(theirs)
    assert (version[0], version[9:11]) == (20, struct.pack(">bB", -2, 3))
    assert version[11:21] == b"\x09URControl"
    assert struct.unpack_from(">BBii", version, 21) == (5, 26, 0, 140462)
    assert {kind: len(body) + 5 for kind, body in parts(state).items()} == SIZES


def test_the_secondary_interface_has_the_state_without_messages(cell: Cell) -> None:
    _, theirs = cell.open("secondary")
    packages(theirs)
    cell.robot.page(Command.EMERGENCY_STOP)
    cell.robot.step(50)
    assert {state[0] for state in packages(theirs)} == {16}


def test_ten_states_a_second(cell: Cell) -> None:
    _, theirs = cell.open("primary")
    cell.robot.step()
    packages(theirs)
    cell.robot.step(500)
    assert sum(each[0] == 16 for each in packages(theirs)) == 10


def test_the_robots_mode_is_told_by_the_layout(cell: Cell) -> None:
    layout = struct.Struct(">Q7?bB3dB")
    clock, *rest = layout.unpack(parts(cell.state.primary()[4:])[0])
    assert clock == pytest.approx(cell.robot.cabinet.clock * 1e6)
    assert rest == [True, True, True, False, False, False, False, 7, 0, 1.0, 1.0, 1.0, 0]
    cell.robot.page(Command.EMERGENCY_STOP)
    cell.robot.step()
    _, *rest = layout.unpack(parts(cell.state.primary()[4:])[0])
    assert rest[:8] == [True, True, False, True, False, False, False, 3]


def test_joints_tool_masterboard_and_pose_are_told_by_the_layout(cell: Cell) -> None:
    found, get = parts(cell.state.primary()[4:]), cell.robot.cabinet.record.get
    for joint in range(6):
        q, target, qd, _, volts, _, _, mode = struct.unpack_from(">3d4fB", found[1], 41 * joint)
        assert (q, target, qd) == (get("actual_q")[joint], get("target_q")[joint], get("actual_qd")[joint])  # type: ignore[index]
        assert (volts, mode) == (48.0, 253)
    assert struct.unpack(">12d", found[4])[:6] == tuple(get("actual_TCP_pose"))  # type: ignore[arg-type]
    assert struct.unpack(">7d", found[7])[:6] == tuple(get("actual_TCP_force"))  # type: ignore[arg-type]
    board = struct.unpack(">II2B2d2b2d4f3BI3B", found[3])
    assert board[14:16] == (SafetyMode.NORMAL, 0)
    cell.robot.page(Command.REDUCED_ON)
    board = struct.unpack(">II2B2d2b2d4f3BI3B", parts(cell.state.primary()[4:])[3])
    assert board[14:16] == (SafetyMode.REDUCED, 1)


def test_limits_and_geometry_are_those_of_the_arms_file(cell: Cell) -> None:
    found = parts(cell.state.primary()[4:])
    numbers = struct.unpack(">12d12d5d24d4i", found[6])
    assert numbers[:2] == (-UR5E.limits.position[0], UR5E.limits.position[0])
    assert numbers[12:14] == (UR5E.limits.speed[0], UR5E.limits.acceleration[0])
    assert list(numbers[29:35]) == UR5E.chain.a
    assert numbers[-2] == ROBOT_TYPES["ur5e"] == 1
    kinematics = struct.unpack(">6I24dI", found[5])
    assert list(kinematics[12:30]) == [*UR5E.chain.a, *UR5E.chain.d, *UR5E.chain.alpha]


def test_messages_of_events_programs_and_safety(cell: Cell) -> None:
    session, theirs = cell.open("primary")
    cell.robot.step()
    packages(theirs)
    cell.robot.page(Command.EMERGENCY_STOP)
    kinds = [each[10] for each in packages(theirs) if each[0] == 20]
    assert kinds == [messages.MessageType.ERROR, messages.MessageType.SAFETY_MODE]
    session.over()
    cell.robot.step(60)
    assert packages(theirs) == []


@pytest.mark.parametrize(
    ("kind", "joint", "more", "code"),
    [
        (Kind.COLLISION, "wrist_3", {"limit": 50.0}, (157, 5)),
        (Kind.COLLISION, "base", {"limit": 50.0}, (157, 0)),
        (Kind.PATH_LEFT, "elbow", {"value": 1.0, "limit": 0.8, "distance": 4.0}, (153, 2)),
    ],
)
def test_a_protective_stop_has_the_code_that_clients_of_a_ur_know(
    cell: Cell, kind: Kind, joint: str, more: dict[str, float], code: tuple[int, int]
) -> None:
    """C157: a collision of joint n; C153: joint n deviates from the path."""
    session, theirs = cell.open("primary")
    cell.robot.step()
    packages(theirs)
    met = {"part": "tool", "force": 60.0, "speed": 100.0, "x": 0.0, "y": 0.0, "z": 0.0, "posture": ""}
    session.told(Event(kind, 1, {"joint": joint, **met, **more}))
    (told,) = packages(theirs)
    assert told[10] == messages.MessageType.ERROR
    assert struct.unpack_from(">iii", told, 11) == (*code, 3)


def test_a_program_is_told_by_the_keys_that_clients_wait_for(cell: Cell) -> None:
    _, theirs = cell.open("primary")
    cell.robot.step()
    packages(theirs)
    for command in ("load wave.urp", "play"):
        answer = cell.commands.answer(command, True)
        assert not isinstance(answer, str)
        cell.robot.step()
    (key,) = [each for each in packages(theirs) if each[0] == 20 and each[10] == messages.MessageType.KEY]
    assert key[11:] == struct.pack(">iiB", 0, 0, 19) + b"PROGRAM_XXX_STARTEDwave"


def test_the_real_time_package_has_every_number_in_its_place(cell: Cell) -> None:
    _, theirs = cell.open("real-time")
    cell.robot.step(3)
    found, get = packages(theirs), cell.robot.cabinet.record.get
    assert [len(each) + 4 for each in found] == [SIZE] * 3
    numbers = struct.unpack(">152d", found[-1])
    assert numbers[0] == get("timestamp")
    assert list(numbers[1:7]) == get("target_q")
    assert list(numbers[31:37]) == get("actual_q")
    assert list(numbers[55:61]) == get("actual_TCP_pose")
    assert list(numbers[67:73]) == get("actual_TCP_force")
    assert numbers[94] == 7.0
    assert numbers[95:101] == (253.0,) * 6
    assert numbers[101] == 1.0
    assert list(numbers[108:111]) == get("actual_tool_accelerometer")
    assert numbers[117] == 1.0
    assert (numbers[130], numbers[131]) == (0.0, 1.0)
    assert list(numbers[132:135]) == get("elbow_position")
    assert numbers[138] == 1.0
    assert numbers[142] == get("payload")
    assert list(numbers[143:146]) == get("payload_cog")


@pytest.mark.parametrize("kind", ["primary", "secondary", "real-time"])
@pytest.mark.parametrize(("line", "told"), [("power off", Kind.POWERED_OFF), ("set robotmode run", None), ("stop program", None)])
def test_lines_that_a_controller_knows_are_done(cell: Cell, kind: str, line: str, told: Kind | None) -> None:
    assert line in LINES
    session, _ = cell.open(kind)
    say(session, line + "\n")
    cell.robot.step()
    assert told is None or told in cell.robot.kinds()
    if line == "power off":
        cell.robot.step(5)
        say(session, "set robotmode run\n")
        cell.robot.step(2)
        assert Kind.RESET in cell.robot.kinds()


def test_in_local_control_nothing_is_done(cell: Cell) -> None:
    session, _ = cell.open("primary")
    cell.robot.page(Command.TEACH)
    say(session, "power off\n")
    cell.robot.step()
    assert Kind.POWERED_OFF not in cell.robot.kinds()
    assert "local control" in cell.peers.said()[-1].text


def test_the_read_only_port_does_nothing(cell: Cell) -> None:
    session, theirs = cell.open("primary", writable=False)
    packages(theirs)
    say(session, "power off\n")
    cell.robot.step()
    assert Kind.POWERED_OFF not in cell.robot.kinds()
    assert b"C210" in packages(theirs)[0]


def kinds(theirs: socket.socket) -> dict[int, list[bytes]]:
    """Bodies of the messages that have come, by their kind."""
    found: dict[int, list[bytes]] = {}
    for each in packages(theirs):
        if each[0] == 20:
            found.setdefault(each[10], []).append(each[11:])
    return found


@pytest.mark.parametrize("kind", ["primary", "secondary", "real-time"])
def test_a_program_runs_and_primary_clients_are_told(cell: Cell, kind: str) -> None:
    session, _ = cell.open(kind)
    _, watching = cell.open("primary")
    packages(watching)
    for part in ("def hel", "lo():\n  textms", 'g("x=", 1)\n  sleep(0.01)\nen', "d\n"):
        say(session, part)
    cell.robot.step(2)
    assert cell.robot.cabinet.state.runtime.name == "PLAYING"
    cell.robot.step(10)
    assert cell.robot.cabinet.state.runtime.name == "STOPPED"
    told = kinds(watching)
    assert told[messages.MessageType.TEXT] == [b"x=1"]
    assert [each[9:] for each in told[messages.MessageType.KEY]] == [b"PROGRAM_XXX_STARTEDhello", b"PROGRAM_XXX_STOPPEDhello"]


def test_a_program_that_moves_the_arm_is_told_of_once(cell: Cell) -> None:
    session, theirs = cell.open("primary")
    cell.robot.step(150)
    packages(theirs)
    say(session, "def way():\n  speedj([0.1,0,0,0,0,0], 0.5, 0.5)\nend\n")
    cell.robot.step(600)
    told = [each[9:] for each in kinds(theirs)[messages.MessageType.KEY]]
    assert told == [b"PROGRAM_XXX_STARTEDway", b"PROGRAM_XXX_STOPPEDway"]


def test_an_error_is_told_with_line_and_column(cell: Cell) -> None:
    session, theirs = cell.open("primary")
    packages(theirs)
    say(session, "def f():\n  x = = 1\nend\n")
    say(session, "def f():\n  sync()\n  x = [1][2]\nend\n")
    cell.robot.step(5)
    told = kinds(theirs)[messages.MessageType.RUNTIME_EXCEPTION]
    assert told[0] == struct.pack(">ii", 2, 7) + b"syntax_error_on_line:2:  x = = 1:"
    assert told[-1] == struct.pack(">ii", 3, 7) + b"index 2 out of range: there are 1 elements, counted from 0"


def test_a_program_replaces_the_one_that_runs_and_a_secondary_one_runs_beside(cell: Cell) -> None:
    session, theirs = cell.open("primary")
    packages(theirs)
    say(session, "def first():\n  while True:\n    sync()\n  end\nend\n")
    cell.robot.step(2)
    say(session, 'sec beside():\n  textmsg("beside")\nend\n')
    cell.robot.step(2)
    assert cell.scripts.name == "first"
    say(session, 'def second():\n  textmsg("second")\n  sleep(1)\nend\n')
    cell.robot.step(2)
    assert cell.scripts.name == "second"
    assert kinds(theirs)[messages.MessageType.TEXT] == [b"beside", b"second"]
    say(session, "stop program\n")
    cell.robot.step(2)
    assert cell.scripts.state is None


def test_errors_are_in_the_words_that_clients_compare_and_in_ascii(cell: Cell) -> None:
    """robot_program_runner of UR's ROS driver and its client library look for these."""
    session, theirs = cell.open("primary")
    packages(theirs)
    say(session, "def f():\n  nonsense(1)\nend\n")
    say(session, "x = not_there\n")
    say(session, "sec beside():\n  x = [1][4]\nend\n")
    say(session, 'textmsg("° ± ü …")\n')
    cell.robot.step(5)
    told = kinds(theirs)
    assert [each[8:] for each in told[messages.MessageType.RUNTIME_EXCEPTION]] == [
        b"compile_error_name_not_found:nonsense:",
        b"compile_error_name_not_found:not_there:",
    ]
    keys = [each[8:] for each in told[messages.MessageType.KEY]]
    assert [each for each in keys if b"SECONDARY" in each] == [
        b"\x1fSECONDARY_PROGRAM_EXCEPTION_XXXindex 4 out of range: there are 1 elements, counted from 0"
    ]
    assert b" deg +- u ..." in told[messages.MessageType.TEXT]
    assert b"beside, line 2: index 4 out of range: there are 1 elements, counted from 0" in told[messages.MessageType.TEXT]


@pytest.mark.parametrize(
    ("kind", "said", "value"),
    [("boolean", "TRUE", "True"), ("integer", "-7", "-7"), ("float", "2.5", "2.5"), ("string", "two words", "two words")],
)
def test_a_program_asks_people_and_the_dashboard_answers(cell: Cell, kind: str, said: str, value: str) -> None:
    session, theirs = cell.open("primary")
    packages(theirs)
    assert cell.commands.answer("answer 5", True) == "Failed to execute: answer; no program asks"
    say(session, f'def p():\n  textmsg("got ", request_{kind}_from_primary_client("How many?"))\nend\n')
    cell.robot.step(5)
    (asked,) = kinds(theirs)[messages.MessageType.REQUEST_VALUE]
    number = ("boolean", "integer", "float", "string").index(kind)
    assert asked == struct.pack(">II", 0, number) + b"How many?"
    if kind != "string":
        for wrong in ("nan", "maybe", "1e400"):
            assert str(cell.commands.answer(f"answer {wrong}", True)).startswith("Failed to execute: answer; expected")
    if kind == "integer":
        assert "32 bits" in str(cell.commands.answer("answer 2147483648", True))
    cell.robot.step(5)
    assert cell.scripts.state is not None
    assert cell.commands.answer(f"answer {said}", True) == "Answered"
    cell.robot.step(5)
    assert kinds(theirs)[messages.MessageType.TEXT] == [f"got {value}".encode()]
    assert cell.robot.cabinet.state.question is None


def test_a_question_is_over_with_its_program(cell: Cell) -> None:
    session, _ = cell.open("primary")
    say(session, 'def p():\n  x = request_float_from_primary_client("How far?")\nend\n')
    cell.robot.step(3)
    assert cell.robot.cabinet.state.question is not None
    say(session, "stop program\n")
    cell.robot.step(3)
    assert cell.robot.cabinet.state.question is None


def test_a_line_alone_is_a_program(cell: Cell) -> None:
    session, _ = cell.open("primary")
    say(session, "set_digital_out(3, True)\n")
    cell.robot.step(2)
    assert int(cell.robot.cabinet.record.get("actual_digital_output_bits")) == 8


def test_a_line_without_an_end_ends_the_connection(cell: Cell) -> None:
    session, _ = cell.open("primary")
    say(session, b"x" * LONGEST)
    with pytest.raises(Farewell):
        say(session, b"x")
    assert StreamSession.repeat is not PrimarySession.repeat
