"""An RTDE connection against a robot that is ticked by hand: handshake, streams, inputs, and what comes late."""

import asyncio
import socket
import struct
from collections.abc import Iterator

import pytest

from app.robot_interface.controller.rtde_fields import INPUTS, OUTPUTS
from app.robot_interface.rtde.rtde_inputs import FREE_DRIVE, KEEP_ALIVE, Recipe, RtdeInputs
from app.robot_interface.rtde.rtde_messages import Malformed, Reader, packed
from app.robot_interface.rtde.rtde_session import RtdeSession
from app.robot_interface.transport.outbox import Outbox
from app.robot_interface.transport.peers import Peers
from app.robot_interface.transport.tcp_port import Farewell
from pendant.events.event import Kind
from pendant.inputs import Command
from pendant.tick.modes import Mode
from tests.app.robot_interface.robot_bench import RobotBench

Answers = list[tuple[str, bytes]]


class Client:
    """One client: sends packages and reads what is answered."""

    def __init__(self, bench: RobotBench, inputs: RtdeInputs, peers: Peers, writable: bool = True) -> None:
        ours, self.socket = socket.socketpair()
        self.socket.setblocking(False)
        self.outbox = Outbox(ours)
        self.peer = peers.join("RTDE", "here", self.outbox)
        self.session = RtdeSession(bench.cabinet, inputs, peers, self.peer, outbox=self.outbox, writable=writable)
        self._reader, self._ours = Reader(), ours

    def hear(self) -> Answers:
        try:
            data = self.socket.recv(1 << 20)
        except BlockingIOError:
            return []
        return [(chr(kind), payload) for kind, payload in self._reader.feed(data)]

    def say(self, kind: str, payload: bytes = b"") -> Answers:
        asyncio.run(self.session.hear(packed(ord(kind), payload)))
        return self.hear()

    def stream(self, names: str, rate: float = 500.0) -> None:
        self.say("V", b"\0\2")
        kind, payload = self.say("O", struct.pack(">d", rate) + names.encode())[0]
        assert (kind, payload[0]) == ("O", 1)
        assert self.say("S") == [("S", b"\1")]


class Cell:
    """A robot and its clients."""

    def __init__(self) -> None:
        self.robot, self.peers = RobotBench(), Peers()
        self.inputs = RtdeInputs(self.robot.cabinet)
        self.clients: list[Client] = []
        self.robot.step(60)

    def client(self, writable: bool = True) -> Client:
        self.clients.append(Client(self.robot, self.inputs, self.peers, writable))
        return self.clients[-1]


@pytest.fixture
def cell() -> Iterator[Cell]:
    cell = Cell()
    yield cell
    for client in cell.clients:
        client.socket.close()
        client._ours.close()


def test_the_handshake_is_that_of_the_guide(cell: Cell) -> None:
    client = cell.client()
    assert client.say("V", b"\0\2") == [("V", b"\1")]
    assert client.say("V", b"\0\3") == [("V", b"\0")]
    assert client.say("v") == [("v", struct.pack(">4I", 5, 26, 0, 140462))]
    assert client.say("S") == [("S", b"\0")]  # without a recipe
    assert client.say("O", struct.pack(">d", 500.0) + b"timestamp,actual_q,robot_mode,") == [("O", b"\1DOUBLE,VECTOR6D,INT32")]
    assert client.say("S") == [("S", b"\1")]
    assert client.say("P") == [("P", b"\1")]


def test_every_tick_comes_once_and_in_order_and_pause_ends_it(cell: Cell) -> None:
    client = cell.client()
    client.stream("timestamp,control_step")
    cell.robot.step(50)
    packages = client.hear()
    assert {kind for kind, _ in packages} == {"U"}
    steps = [struct.unpack(">BdQ", payload)[2] for _, payload in packages]
    assert steps == list(range(61, 111))
    stamps = [struct.unpack(">BdQ", payload)[1] for _, payload in packages]
    assert stamps == pytest.approx([100.0 + 0.002 * step for step in steps])
    client.say("P")
    cell.robot.step(5)
    assert client.hear() == []


@pytest.mark.parametrize(("rate", "every"), [(500.0, 1), (125.0, 4), (250.0, 2), (10.0, 50), (1.0, 500), (300.0, 2)])
def test_a_rate_is_a_divisor_of_the_ticks(cell: Cell, rate: float, every: int) -> None:
    client = cell.client()
    client.stream("control_step", rate)
    steps = []
    for _ in range(10):
        cell.robot.step(100)
        steps += [struct.unpack(">BQ", payload)[1] for _, payload in client.hear()]
    assert [step % every for step in steps] == [0] * len(steps)
    assert len(steps) == 1060 // every - 60 // every


@pytest.mark.parametrize("rate", [0.0, -1.0, 0.99, 500.1, 1e9, float("nan"), float("inf")])
def test_a_rate_that_there_is_not_is_refused(cell: Cell, rate: float) -> None:
    client = cell.client()
    client.say("V", b"\0\2")
    assert client.say("O", struct.pack(">d", rate) + b"timestamp") == [("O", b"\0DOUBLE")]
    assert client.say("S") == [("S", b"\0")]


def test_a_field_that_there_is_not_makes_the_recipe_invalid(cell: Cell) -> None:
    client = cell.client()
    client.say("V", b"\0\2")
    assert client.say("O", struct.pack(">d", 500.0) + b"timestamp,nonsense") == [("O", b"\0DOUBLE,NOT_FOUND")]
    assert client.say("S") == [("S", b"\0")]
    assert client.say("O", struct.pack(">d", 500.0)) == [("O", b"\0")]


def test_version_one_has_no_rate_and_no_recipe_id(cell: Cell) -> None:
    client = cell.client()
    assert client.say("V", b"\0\1") == [("V", b"\1")]
    assert client.say("O", b"robot_mode,payload") == [("O", b"INT32,DOUBLE")]
    assert client.say("S") == [("S", b"\1")]
    cell.robot.step(8)
    assert client.hear() == [("U", struct.pack(">id", 7, 0.0))] * 2  # 125 Hz


def test_every_output_field_can_be_asked_for(cell: Cell) -> None:
    client = cell.client()
    client.say("V", b"\0\2")
    for name, kind in OUTPUTS.items():
        assert client.say("O", struct.pack(">d", 500.0) + name.encode()) == [("O", b"\1" + kind.encode())]


def test_inputs_have_one_owner_until_it_leaves(cell: Cell) -> None:
    first, second = cell.client(), cell.client()
    for client in (first, second):
        client.say("V", b"\0\2")
    assert first.say("I", b"input_int_register_24,speed_slider_mask") == [("I", b"\1INT32,UINT32")]
    assert first.say("I", b"input_int_register_24") == [("I", b"\2INT32")]  # the same connection may again
    assert second.say("I", b"input_int_register_24,input_int_register_25") == [("I", b"\0IN_USE,INT32")]
    assert first.say("I", b"input_int_register_25") == [("I", b"\3INT32")]  # the refused recipe claimed nothing
    assert second.say("I", b"nonsense") == [("I", b"\0NOT_FOUND")]
    assert second.say("I", b"") == [("I", b"\0")]
    first.session.over()
    assert second.say("I", b"input_int_register_24") == [("I", b"\1INT32")]


def test_a_connection_has_at_most_255_input_recipes(cell: Cell) -> None:
    client = cell.client()
    answers = [client.say("I", b"input_int_register_24")[0][1][0] for _ in range(257)]
    assert answers == [*range(1, 256), 0, 0]


def test_the_read_only_port_takes_no_inputs(cell: Cell) -> None:
    assert cell.client(writable=False).say("I", b"input_int_register_24") == [("I", b"\0IN_USE")]


@pytest.mark.parametrize(
    ("names", "values", "field", "told"),
    [
        (("input_int_register_24",), ">i", "input_int_register_24", -7),
        (("input_double_register_47",), ">d", "input_double_register_47", 2.5),
        (("input_bit_register_64",), ">B", "input_bit_register_64", 1),
        (("input_bit_registers0_to_31",), ">I", "input_bit_registers0_to_31", 0xDEADBEEF),
    ],
)
def test_registers_are_read_back(cell: Cell, names: tuple[str, ...], values: str, field: str, told: float) -> None:
    client = cell.client()
    client.say("I", ",".join(names).encode())
    client.say("U", b"\1" + struct.pack(values, told))
    assert cell.robot.cabinet.record.get(field) == told


@pytest.mark.parametrize(
    ("name", "mask", "value", "bits"),
    [
        ("standard_digital_output", 0b101, 0b111, 0b101),
        ("configurable_digital_output", 0b10, 0b10, 0b10 << 8),
        ("tool_digital_output", 0b11, 0b10, 0b10 << 16),
        ("tool_digital_output", 0xFF, 0xFF, 0b11 << 16),
        ("standard_digital_output", 0, 0xFF, 0),
    ],
)
def test_outputs_change_where_the_mask_says(cell: Cell, name: str, mask: int, value: int, bits: int) -> None:
    client = cell.client()
    client.say("I", f"{name}_mask,{name}".encode())
    client.say("U", bytes([1, mask, value]))
    assert cell.robot.cabinet.record.get("actual_digital_output_bits") == bits
    assert cell.robot.cabinet.record.get("actual_configurable_digital_output_bits") == bits >> 8 & 0xFF
    client.say("U", bytes([1, mask, 0]))
    assert cell.robot.cabinet.record.get("actual_digital_output_bits") == 0


def test_analog_outputs_are_set_as_ratios_stay_in_their_range_and_are_told_in_volts_or_amperes(cell: Cell) -> None:
    client, get = cell.client(), cell.robot.cabinet.record.get
    client.say("I", b"standard_analog_output_mask,standard_analog_output_type,standard_analog_output_0,standard_analog_output_1")
    client.say("U", struct.pack(">BBBdd", 1, 1, 3, 0.25, 0.75))
    assert (get("standard_analog_output0"), get("standard_analog_output1")) == (2.5, 0.0)
    client.say("U", struct.pack(">BBBdd", 1, 2, 1, 0.5, 7.0))
    assert (get("standard_analog_output0"), get("standard_analog_output1")) == (2.5, 0.020)
    assert get("analog_io_types") == 0b0111


@pytest.mark.parametrize(("mask", "share", "speed"), [(1, 0.5, 0.5), (1, 7.0, 1.0), (1, -3.0, 0.0), (0, 0.5, 1.0)])
def test_the_speed_slider_is_the_setting_that_programs_run_by(cell: Cell, mask: int, share: float, speed: float) -> None:
    client = cell.client()
    client.say("I", b"speed_slider_mask,speed_slider_fraction")
    client.say("U", struct.pack(">BId", 1, mask, share))
    cell.robot.step(2)
    assert cell.robot.simulation.settings.program.speed == speed
    assert cell.robot.cabinet.record.get("target_speed_fraction") == speed


def test_free_drive_needs_its_register_written_again_and_again(cell: Cell) -> None:
    client, robot = cell.client(), cell.robot
    client.say("I", FREE_DRIVE.encode())
    for _ in range(12):
        client.say("U", b"\1\1")
        robot.step(100)
    assert robot.cabinet.state.mode is Mode.FREE_DRIVE
    robot.step(KEEP_ALIVE - 100)
    assert robot.cabinet.state.mode is Mode.FREE_DRIVE
    robot.step(2)
    assert robot.cabinet.state.mode is Mode.REMOTE
    assert Kind.DEACTIVATED in robot.kinds()


@pytest.mark.parametrize("how", ["low", "gone"])
def test_free_drive_ends_when_the_register_goes_low_or_its_owner_is_gone(cell: Cell, how: str) -> None:
    client, robot = cell.client(), cell.robot
    client.say("I", FREE_DRIVE.encode())
    for _ in range(12):
        client.say("U", b"\1\1")
        robot.step(100)
    if how == "low":
        client.say("U", b"\1\0")
    else:
        client.session.over()
    robot.step(2)
    assert robot.cabinet.state.mode is Mode.REMOTE


def test_a_package_of_another_length_is_read_as_far_as_it_goes() -> None:
    recipe = Recipe(["input_int_register_24", "input_double_register_24"])
    assert recipe.values(struct.pack(">id", 5, 1.5) + b"more") == {"input_int_register_24": 5, "input_double_register_24": 1.5}
    assert recipe.values(struct.pack(">i", 5)) == {"input_int_register_24": 5}
    assert recipe.values(b"\0") == {}


@pytest.mark.parametrize("value", [float("nan"), float("inf"), -float("inf")])
def test_numbers_that_are_not_finite_end_the_connection(cell: Cell, value: float) -> None:
    with pytest.raises(Malformed):
        Recipe(["input_double_register_24"]).values(struct.pack(">d", value))
    client = cell.client()
    client.say("I", b"input_double_register_24")
    with pytest.raises(Farewell, match="finite"):
        client.say("U", b"\1" + struct.pack(">d", value))
    assert cell.robot.cabinet.record.get("input_double_register_24") == 0.0


def test_every_input_field_has_a_recipe() -> None:
    for name in INPUTS:
        assert Recipe([name]).values(bytes(48)).keys() == {name}


def test_what_is_no_request_is_passed_over(cell: Cell) -> None:
    client = cell.client()
    client.say("V", b"\0\2")
    for kind, payload in (("V", b""), ("O", b"\0"), ("U", b""), ("U", b"\7"), ("z", b"abc"), ("M", b"\2hi")):
        assert client.say(kind, payload) == []


def test_events_are_told_as_messages_while_it_streams(cell: Cell) -> None:
    client = cell.client()
    client.say("V", b"\0\2")
    cell.robot.page(Command.SAFEGUARD_OPEN)
    assert client.hear() == []
    client.stream("robot_mode", 1.0)
    cell.robot.page(Command.EMERGENCY_STOP)
    messages = [payload for kind, payload in client.hear() if kind == "M"]
    assert len(messages) == 1
    assert messages[0][1:15] == b"Emergency stop"
    assert messages[0][-1] == 1  # an error


def test_a_late_reader_misses_packages_and_is_told_when_it_reads_again(cell: Cell) -> None:
    client = cell.client()
    client._ours.setsockopt(socket.SOL_SOCKET, socket.SO_SNDBUF, 4096)
    client.stream("timestamp,actual_q,actual_qd,control_step")
    cell.robot.step(300)
    assert client.outbox.skipped > 0
    got = client.hear()
    for _ in range(20):
        client.outbox.flush()
        got += client.hear()
    cell.robot.step(3)
    got += client.hear()
    steps = [struct.unpack_from(">Q", payload, len(payload) - 8)[0] for kind, payload in got if kind == "U"]
    assert steps == sorted(set(steps))
    assert steps[-1] == cell.robot.cabinet.ticks
    assert any(kind == "M" and b"skipped" in payload for kind, payload in got)
    assert any("too slowly" in said.text for said in cell.peers.said())


def test_while_nothing_is_simulated_the_last_package_is_repeated(cell: Cell) -> None:
    client = cell.client()
    client.stream("control_step")
    cell.robot.step()
    before = client.hear()
    cell.robot.cabinet.repeat()
    assert client.hear() == before
