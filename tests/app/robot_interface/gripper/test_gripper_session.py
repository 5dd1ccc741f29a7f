"""The gripper of a served robot: its port, its program, and its end."""

import socket
import time

import pytest

from app.served_robot import ServedRobot

PATIENCE = 15.0
"""For the fingers, on a machine that is busy [s]."""

SETUP = {
    "tool": "two-finger",
    "posture": [-0.0073, -1.2614, 2.2369, -2.5463, -1.5708, -0.0073],
    "world": [
        {"kind": "box", "name": "table", "position": [-0.5, 0.0, -0.075], "size": [0.6, 0.9, 0.05]},
        {"kind": "free-box", "name": "part", "position": [-0.45, -0.13, -0.02], "size": [0.06, 0.05, 0.06], "mass": 1.0},
    ],
}


def asked(connection: socket.socket, line: str) -> str:
    connection.sendall(line.encode() + b"\n")
    return connection.recv(100).decode().strip()


def wait(connection: socket.socket, line: str, wanted: str) -> None:
    end = time.monotonic() + PATIENCE
    while asked(connection, line) != wanted:
        assert time.monotonic() < end, f"{line} never gave {wanted}"
        time.sleep(0.01)


@pytest.mark.parametrize("robot", [SETUP], indirect=True)
def test_a_client_grips_and_the_port_closes_with_the_robot(robot: ServedRobot) -> None:
    with socket.create_connection((robot.host, robot.ports["gripper"]), 10.0) as connection:
        assert asked(connection, "SET ACT 1") == "ack"
        wait(connection, "GET STA", "STA 3")
        assert asked(connection, "nonsense") == "?"
        assert asked(connection, "SET GTO 1 POS 255 SPE 255 FOR 100") == "ack"
        wait(connection, "GET OBJ", "OBJ 2")
        assert asked(connection, "GET POS") == "POS 105"
        assert int(robot.field("actual_digital_input_bits")) >> 7 & 1
        robot.gripper("open")
        wait(connection, "GET POS", "POS 0")
        robot.stop()
        assert connection.recv(100) == b""
    with pytest.raises(OSError, match="refused"):
        socket.create_connection((robot.host, robot.ports["gripper"]), 2.0)


def test_a_robot_without_a_gripper_ends_the_connection(robot: ServedRobot) -> None:
    with socket.create_connection((robot.host, robot.ports["gripper"]), 10.0) as connection:
        connection.settimeout(10.0)
        assert connection.recv(100) == b""
