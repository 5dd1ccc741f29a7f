"""The gripper's text protocol: what real programs say, and what nobody should say (GR-3)."""

from dataclasses import dataclass, field

import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.robot_interface.gripper.gripper_registers import UNKNOWN, GripperLines, GripperRegisters
from sim.gripping.finger_drive import GripperState
from sim.plant.changes import DriveGripper

OPEN = GripperState(False, False, "", False, 0.085, 0.085, 0.085, 235.0)


@dataclass
class Port:
    gripper: GripperState | None = OPEN
    ticks: int = 10
    orders: list[DriveGripper] = field(default_factory=list)

    def drive(self, change: DriveGripper) -> None:
        self.orders.append(change)


def activated() -> tuple[Port, GripperRegisters]:
    port = Port()
    registers = GripperRegisters(port)
    assert registers.answer("SET ACT 1") == b"ack"
    assert registers.answer("GET STA") == b"STA 1\n"
    port.ticks += 2
    assert registers.answer("GET STA") == b"STA 3\n"
    assert registers.answer("SET GTO 1") == b"ack"
    port.orders.clear()
    return port, registers


def test_it_moves_where_it_is_told() -> None:
    port, registers = activated()
    assert registers.answer("SET POS 255 SPE 0 FOR 51") == b"ack"
    assert port.orders == [DriveGripper(opening=0.0, speed_share=0.0, force_share=0.2)]
    assert registers.answer("GET PRE") == b"PRE 255\n"
    assert registers.answer("GET OBJ") == b"OBJ 0\n", "the order is on its way"


@pytest.mark.parametrize(
    ("state", "pos", "obj"),
    [
        (OPEN, 0, 3),
        (OPEN._replace(moving=True, opening=0.0425), 128, 0),
        (OPEN._replace(held="part", met=True, opening=0.034), 153, 2),
        (OPEN._replace(opening=0.0), 255, 3),
    ],
)
def test_it_tells_position_and_object(state: GripperState, pos: int, obj: int) -> None:
    port, registers = activated()
    port.gripper, port.ticks = state, 100
    assert registers.answer("GET POS") == f"POS {pos}\n".encode()
    assert registers.answer("GET OBJ") == f"OBJ {obj}\n".encode()


def test_it_does_not_move_before_it_is_activated() -> None:
    port = Port()
    registers = GripperRegisters(port)
    assert registers.answer("SET GTO 1 POS 255") == b"ack"
    assert port.orders == []
    assert registers.answer("GET FLT") == b"FLT 7\n"


def test_it_stops_where_it_is_told_to_go_nowhere() -> None:
    port, registers = activated()
    registers.answer("SET GTO 0")
    assert port.orders == [DriveGripper(command="stop")]
    registers.answer("SET ATR 1")
    registers.answer("SET GTO 1 POS 255")
    assert port.orders[1:] == [DriveGripper(command="open")], "released: it does nothing until it is activated anew"
    assert registers.answer("GET FLT") == b"FLT 15\n"


def test_an_activation_that_nobody_watched_is_over_all_the_same() -> None:
    port = Port()
    registers = GripperRegisters(port)
    registers.answer("SET ACT 1")
    port.ticks += 2
    registers.answer("SET GTO 1 POS 255")
    assert registers.answer("GET OBJ") == b"OBJ 0\n", "it moves"
    assert registers.answer("GET STA") == b"STA 3\n", "and has been activated before"


def test_an_activation_goes_on_while_the_fingers_open() -> None:
    port = Port(OPEN._replace(moving=True, opening=0.04))
    registers = GripperRegisters(port)
    registers.answer("SET ACT 1")
    port.ticks += 2
    registers.answer("SET SPE 7")
    assert registers.answer("GET STA") == b"STA 1\n"


def test_nothing_is_left_of_what_was_set_where_the_simulation_starts_over() -> None:
    port, registers = activated()
    registers.answer("SET ATR 1 POS 255 SPE 7")
    port.ticks += 1
    registers.begin()
    wanted = {"ACT": 0, "STA": 0, "GTO": 0, "ATR": 0, "PRE": 0, "SPE": 255, "FLT": 0, "OBJ": 3}
    assert {name: registers.answer(f"GET {name}") for name in wanted} == {
        name: f"{name} {value}\n".encode() for name, value in wanted.items()
    }


def test_programs_ask_which_grippers_there_are() -> None:
    _, registers = activated()
    assert registers.answer("GET SID") == b"[9]              "
    assert registers.answer("SET SID 9") == b"ack"


@pytest.mark.parametrize(
    "line",
    [
        "GET",
        "GET XYZ",
        "GET POS POS",
        "SET",
        "SET POS",
        "SET POS 256",
        "SET POS -1",
        "SET POS 1.5",
        "SET POS ٣",
        "SET OBJ 1",
        "SET POS 1 SPE",
        "SET POS 1 XYZ 2",
        "get pos",
        "HELLO",
    ],
)
def test_what_is_no_line_gets_one_clear_answer(line: str) -> None:
    port, registers = activated()
    assert registers.answer(line) == UNKNOWN
    assert port.orders == []


def test_nothing_is_set_of_a_line_that_is_wrong() -> None:
    _, registers = activated()
    registers.answer("SET FOR 7 SPE 999")
    assert registers.answer("GET FOR") == b"FOR 255\n"


def test_a_robot_without_a_gripper_answers_nothing_else() -> None:
    registers = GripperRegisters(Port(gripper=None))
    assert not registers.there
    assert registers.answer("GET POS") == UNKNOWN


def test_lines_come_in_pieces_and_a_get_without_its_end() -> None:
    _, registers = activated()
    lines = GripperLines(registers)
    assert lines.hear(b"SET POS") == b""
    assert lines.hear(b" 0 SPE 9") == b""
    assert lines.hear(b"\nGET SPE\r\nGET FO") == b"ackSPE 9\n"
    assert lines.hear(b"R") == b"FOR 255\n"
    assert lines.hear(b"\n") == b""
    assert lines.hear(b"x" * 1025) is None


@given(st.binary(max_size=200))
def test_no_bytes_break_it(data: bytes) -> None:
    lines = GripperLines(GripperRegisters(Port()))
    assert lines.hear(data) is not None
