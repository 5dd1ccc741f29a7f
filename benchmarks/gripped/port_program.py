"""A program that picks and places over and over through the gripper's port, in real time, beside three clients of the robot."""

import socket
import threading
import time
from pathlib import Path
from typing import NamedTuple

from app.robot_interface.ports import DASHBOARD, PRIMARY, REALTIME
from app.served_robot import ServedRobot

PART = [-0.45, -0.13, 0.03]
"""Where the part lies at first, in W [m]."""

SETUP = {
    "robot": "ur5e",
    "seed": 1000,
    "tool": "two-finger",
    "posture": [-0.0073, -1.4, 2.0, -2.17, -1.5708, -0.0073],
    "world": [
        {"kind": "box", "name": "table", "position": [-0.5, 0.0, -0.025], "size": [0.7, 1.2, 0.05]},
        {"kind": "free-box", "name": "part", "position": PART, "size": [0.06, 0.05, 0.06], "mass": 1.0, "friction": 0.6},
    ],
}

PROGRAM = """
def rounds():
  def go(place):
    socket_set_var("POS", place, "g")
    socket_read_byte_list(3, "g")
    while socket_get_var("PRE", "g") != place:
      sync()
    end
    while socket_get_var("OBJ", "g") == 0:
      sync()
    end
  end
  socket_open("127.0.0.1", 63352, "g")
  socket_set_var("ACT", 1, "g")
  socket_read_byte_list(3, "g")
  while socket_get_var("STA", "g") != 3:
    sync()
  end
  socket_set_var("GTO", 1, "g")
  socket_read_byte_list(3, "g")
  places = [p[-0.45, -0.13, 0.03, 2.2214, 2.2214, 0], p[-0.45, 0.07, 0.03, 2.2214, 2.2214, 0]]
  up = p[0, 0, 0.1, 0, 0, 0]
  k = 0
  while True:
    movel(pose_add(places[k % 2], up), a=0.6, v=0.5)
    movel(places[k % 2], a=0.6, v=0.2)
    go(255)
    if socket_get_var("OBJ", "g") != 2:
      textmsg("missed")
    end
    set_target_payload(1.925, [0, 0, 0.1125])
    movel(pose_add(places[k % 2], up), a=0.6, v=0.5)
    movel(pose_add(places[(k + 1) % 2], up), a=0.6, v=0.5)
    movel(places[(k + 1) % 2], a=0.6, v=0.2)
    go(0)
    set_target_payload(0.925, [0, 0, 0.058])
    movel(pose_add(places[(k + 1) % 2], up), a=0.6, v=0.5)
    k = k + 1
    textmsg("round ", k)
  end
end
"""


class Worked(NamedTuple):
    """What the program did."""

    rounds: int
    trouble: str  # why it ended, "" while it went on
    missed: int  # times that it closed on nothing
    pace: float  # simulated seconds a second


class _Client:
    """Reads all that the robot says on a port."""

    def __init__(self, host: str, port: int, ask: bytes = b"") -> None:
        self.text, self._ask, self._ends = "", ask, False
        self._socket = socket.create_connection((host, port))
        self._socket.settimeout(0.5)
        self._thread = threading.Thread(target=self._read, daemon=True)
        self._thread.start()

    def _read(self) -> None:
        while not self._ends:
            try:
                if self._ask:
                    self._socket.sendall(self._ask)
                    time.sleep(0.1)
                self.text = (self.text + self._socket.recv(65536).decode("latin-1"))[-(1 << 20) :]
            except TimeoutError:
                continue
            except OSError:
                return

    def close(self) -> None:
        """End it."""
        self._ends = True
        self._thread.join()
        self._socket.close()


def worked(folder: Path, seconds: float) -> Worked:
    """Run the program for so long [s]."""
    robot = ServedRobot(folder, SETUP)
    robot.start()
    try:
        ports = robot.ports
        clients = [
            _Client(robot.host, ports[PRIMARY]),
            _Client(robot.host, ports[REALTIME]),
            _Client(robot.host, ports[DASHBOARD], b"programState\n"),
        ]
        with socket.create_connection((robot.host, ports[PRIMARY])) as sender:
            sender.sendall(PROGRAM.encode())
            begun, first = time.monotonic(), int(robot.state()["tick"])
            time.sleep(seconds)
            last, took = int(robot.state()["tick"]), time.monotonic() - begun
        counted = [int(found) for found in _numbers(clients[0].text)]
        rounds = max(counted, default=0)
        trouble = "" if "PLAYING" in clients[2].text[-200:] else clients[2].text[-80:]
        missed = clients[0].text.count("missed")
        for client in clients:
            client.close()
        return Worked(rounds, trouble, missed, (last - first) * 0.002 / took)
    finally:
        robot.stop()


def _numbers(text: str) -> list[str]:
    digits = [piece[:6] for piece in text.split("round ")[1:]]
    return ["".join(c for c in piece if c.isdigit()) or "0" for piece in digits]
