"""Who uses the served robot at the same time: each on a thread of its own, at random, until a time.

An answer that refuses is none of their business; a connection that the robot ends is made again.
"""

import json
import random
import socket
import struct
import time
import urllib.error
import urllib.request
from collections import Counter
from contextlib import suppress
from pathlib import Path
from typing import Any

from app.robot_interface.controller.rtde_fields import OUTPUTS
from app.robot_interface.ports import CONTROL, DASHBOARD, PRIMARY, READ_ONLY, REALTIME, RTDE, SECONDARY
from benchmarks.network_clients import RECIPE, packed

KEPT = 3
"""Recordings that stay while others are made: a disk is finite."""

SCRIPTS = (
    'def talk():\n  i = 0\n  while True:\n    textmsg("so far ", i)\n    i = i + 1\n    sync()\n  end\nend\n',
    'def flood():\n  i = 0\n  while i < 400:\n    textmsg("line ", i)\n    i = i + 1\n  end\n  sync()\nend\n',
    'def move():\n  textmsg("goes")\n  movej([0.2, -1.4, 1.4, -1.5, -1.5, 0.1])\n  popup("there", "t", False, False)\nend\n',
    'def wrong():\n  textmsg("begins")\n  x = [1, 2]\n  textmsg(x[7])\nend\n',
    'def both():\n  thread t():\n    while True:\n      textmsg("beside")\n      sync()\n    end\n  end\n'
    "  h = run t()\n  sleep(3.0)\nend\n",
)
LINES = (
    "robotmode",
    "safetystatus",
    "programState",
    "get loaded program",
    "popup hello",
    "close popup",
    "load wave.urp",
    "play",
    "pause",
    "stop",
    "power on",
    "brake release",
    "unlock protective stop",
    "close safety popup",
    "set payload 1.0",
    "is in remote control",
)


class Attacked:
    """Where the robot is."""

    def __init__(self, host: str, ports: dict[str, int], token: str) -> None:
        self.host, self.ports, self._token = host, ports, token

    def ask(self, path: str, body: dict[str, Any] | None = None) -> Any:
        """Ask the control channel. Raises OSError: it refuses, or does not answer."""
        request = urllib.request.Request(
            f"http://{self.host}:{self.ports[CONTROL]}/{path}",
            data=None if body is None else json.dumps(body).encode(),
            headers={"Authorization": f"Bearer {self._token}"},
        )
        with urllib.request.urlopen(request, timeout=30.0) as answer:
            return json.load(answer)

    def connect(self, interface: str) -> socket.socket:
        """A connection to an interface."""
        return socket.create_connection((self.host, self.ports[interface]), timeout=5.0)


class Attacker:
    """One of them.

    Args:
        robot: that is used.
        seed: of all that it does.

    Attributes:
        done: how often each thing was done.
        surprises: what was raised that no robot should cause.
    """

    def __init__(self, robot: Attacked, seed: int) -> None:
        self.robot, self.chance = robot, random.Random(seed)
        self.done: Counter[str] = Counter()
        self.surprises: list[str] = []

    def run(self, end: float) -> None:
        """Go on until `end`, of `time.monotonic`."""
        while time.monotonic() < end:
            try:
                self.act()
                self.done["done"] += 1
            except urllib.error.HTTPError as refusal:
                self.done["refused"] += 1
                if refusal.code not in (400, 408):
                    self.surprises.append(f"{type(self).__name__}: {refusal.code} {refusal.read()[:200]!r}")
            except OSError as error:
                self.done[f"ended: {type(error).__name__}"] += 1
                time.sleep(0.1)

    def act(self) -> None:
        """One thing. Raises OSError: the connection has ended."""
        raise NotImplementedError

    def rest(self, mean: float) -> None:
        """Wait for a time of that mean [s]."""
        time.sleep(min(self.chance.expovariate(1.0 / mean), 5.0 * mean))


class Talker(Attacker):
    """Sends programs that talk."""

    def act(self) -> None:
        """Send one, and listen for a while to what is told."""
        text = self.chance.choices(SCRIPTS, (4, 2, 1, 1, 2))[0]
        with self.robot.connect(self.chance.choice((PRIMARY, SECONDARY, REALTIME))) as line:
            line.sendall(text.encode())
            _listen(line, self.chance.uniform(0.1, 3.0))


class Streamer(Attacker):
    """Reads RTDE, writes registers, comes and goes; sometimes without a goodbye, or without reading."""

    def act(self) -> None:
        """One connection."""
        with self.robot.connect(RTDE) as line:
            rate = self.chance.choice((1.0, 125.0, 500.0))
            names = ",".join(self.chance.sample(RECIPE.split(","), 6))
            line.sendall(packed("V", b"\0\2"))
            line.sendall(packed("O", struct.pack(">d", rate) + names.encode()))
            line.sendall(packed("I", b"input_bit_register_127,input_int_register_24"))
            line.sendall(packed("S"))
            end = time.monotonic() + self.chance.uniform(0.1, 3.0)
            while time.monotonic() < end:
                line.sendall(packed("U", struct.pack(">B?i", 1, self.chance.random() < 0.3, self.chance.randrange(9))))
                _listen(line, 0.05)


class Watcher(Attacker):
    """Reads what the robot sends by itself to clients that may only read."""

    def act(self) -> None:
        """One connection."""
        with self.robot.connect(PRIMARY + READ_ONLY) as line:
            _listen(line, self.chance.uniform(0.1, 4.0))


class Caller(Attacker):
    """Says lines to the dashboard."""

    def act(self) -> None:
        """One connection, some lines."""
        with self.robot.connect(DASHBOARD) as line:
            for _ in range(self.chance.randrange(1, 12)):
                line.sendall(f"{self.chance.choice(LINES)}\n".encode())
                line.recv(4096)
                self.rest(0.1)


class Reader(Attacker):
    """Asks the control channel for all that it tells."""

    def act(self) -> None:
        """Ask one thing."""
        self.robot.ask(
            self.chance.choice(("state", "events", "messages", "connections", f"field/{self.chance.choice([*OUTPUTS])}"))
        )
        self.rest(0.02)


class Laboratory(Attacker):
    """Does to the robot what a laboratory does, and begins it anew."""

    def act(self) -> None:
        """Do one thing."""
        chance = self.chance
        force = [chance.uniform(-40.0, 40.0) for _ in range(3)]
        acts: list[tuple[str, dict[str, Any]]] = [
            ("actions", {"actions": [{"do": "push", "at": 0.0, "for": 0.3, "force": force}]}),
            ("actions", {"actions": [{"do": "tap", "at": 0.0, "control": chance.choice(("emergency_stop", "free_drive"))}]}),
            ("network", {"interface": chance.choice(("all", "RTDE", "dashboard")), "cut": 0.2}),
            ("network", {"interface": "all", "delay": chance.choice((0.0, 0.01))}),
            ("free-drive", {"seconds": 1.0}),
            ("remote", {"on": chance.random() < 0.8}),
            ("pace", {"speed": chance.choice((0.5, 1.0)), "paused": False}),
            ("pace", {"paused": True, "ticks": 3}),
            ("restart", {}),
            ("begin", {"world": chance.choice(("none", "table")), "seed": chance.randrange(100)}),
        ]
        path, body = chance.choices(acts, (6, 2, 1, 2, 2, 2, 3, 1, 1, 1))[0]
        self.robot.ask(path, body)
        self.done[path] += 1
        self.rest(0.5)
        if body.get("paused"):
            self.robot.ask("pace", {"paused": False})


class Recorder(Attacker):
    """Throws the switch of the recording; keeps the last recordings, and the first one.

    Args:
        robot: that is used.
        seed: of all that it does.
        folder: of the recordings.
    """

    def __init__(self, robot: Attacked, seed: int, folder: Path) -> None:
        super().__init__(robot, seed)
        self._folder = folder

    def act(self) -> None:
        """Throw it."""
        self.robot.ask("recording", {"on": self.chance.random() < 0.6})
        self.rest(1.0)
        files = sorted(self._folder.glob("*.mcap"), key=lambda path: path.stat().st_mtime)
        for path in files[1:-KEPT]:
            with suppress(OSError):
                path.unlink()


def _listen(line: socket.socket, seconds: float) -> None:
    """Take what comes, for so long. Raises OSError: the robot ended it."""
    end = time.monotonic() + seconds
    while (left := end - time.monotonic()) > 0.0:
        line.settimeout(left)
        with suppress(TimeoutError):
            if not line.recv(1 << 16):
                raise ConnectionError
