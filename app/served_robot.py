"""A robot in a process of its own, for tests and for clients: it starts, injects faults, gives back events, and stops."""

import atexit
import itertools
import json
import os
import secrets
import socket
import subprocess
import sys
import time
import urllib.error
import urllib.request
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from types import TracebackType
from typing import Any, Self

from app.robot_interface.ports import CONTROL, PORTS

PATIENCE = 60.0
"""Time in which a robot must answer [s]."""

NAP = 0.02
TRIES = 20
"""Addresses that are tried."""

Json = Any


class ServedRobot:
    """A robot in a process of its own, at a loopback address of its own, so that clients find it at the usual ports.

    Args:
        folder: for its output, its recordings and a configuration.
        setup: what it starts with, as a configuration file says it; None for a UR5e with nothing at its flange.

    Attributes:
        host: its address.
        ports: by the name of the interface, such as "RTDE".
    """

    def __init__(self, folder: Path, setup: Mapping[str, Json] | None = None) -> None:
        self._folder, self._setup = folder, setup
        self._token = secrets.token_urlsafe(16)
        self._pid = 0
        self._begun = 0  # number of the last event before the last start
        self.host = ""
        self.ports = dict(PORTS)

    def start(self) -> None:
        """Start it, and wait until it answers.

        Raises:
            RuntimeError: it ended, or does not answer in time; with what it said.
        """
        path = None
        if self._setup is not None:
            path = self._folder / "setup.yaml"
            path.write_text(json.dumps(self._setup), encoding="utf-8")
        for host in itertools.islice(free_addresses(), TRIES):
            self.host = host
            setup = None if path is None else str(path)
            self._pid = _NURSERY.order(folder=str(self._folder), setup=setup, host=host, token=self._token)
            if self._answers():
                return
            self.stop()
            said = (self._folder / "robot.log").read_text(encoding="utf-8")
            if "a port that is free" not in said:
                raise RuntimeError(f"the robot did not start: {said.strip() or 'it said nothing'}")
        raise RuntimeError(f"none of {TRIES} loopback addresses has its ports free")

    def stop(self) -> None:
        """End it, and wait until it has."""
        if self._pid:
            _NURSERY.order(stop=self._pid)
            self._pid = 0

    def __enter__(self) -> Self:
        self.start()
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None) -> None:
        self.stop()

    def do(self, *actions: Mapping[str, Json]) -> int:
        """Play actions as a session's time line has them; returns the tick from which `at` counts: 0.0 acts in the next."""
        return int(self._ask("actions", {"actions": list(actions)})["after"])

    def push(self, force: Sequence[float], seconds: float, part: str = "flange") -> int:
        """Push with a force in W [N]; returns as `do`."""
        return self.do({"do": "push", "at": 0.0, "for": seconds, "force": list(force), "part": part})

    def press(self, control: str) -> int:
        """Press a control of the pendant shortly, such as "emergency_stop"; returns as `do`."""
        return self.do({"do": "tap", "at": 0.0, "control": control})

    def change(self, **change: Json) -> int:
        """Change the true arm or world, such as `kind="drop_payload"`; returns as `do`."""
        return self.do({"do": "change", "at": 0.0, "change": change})

    def gripper(self, command: str, force: float | None = None) -> int:
        """Drive the gripper: "close", "open" or "stop", with a force of each finger [N]; returns as `do`."""
        return self.do({"do": "gripper", "at": 0.0, "command": command} | ({} if force is None else {"force": force}))

    def free_drive(self, seconds: float) -> None:
        """Ask for free-drive as the remote controller, for so long; 0.0 ends it."""
        self._ask("free-drive", {"seconds": seconds})

    def remote(self, on: bool) -> None:
        """Switch to remote control, or to local control."""
        self._ask("remote", {"on": on})

    def cut(self, seconds: float, interface: str = "all") -> None:
        """End the connections of an interface, and let none begin for so long."""
        self._ask("network", {"interface": interface, "cut": seconds})

    def delay(self, seconds: float, interface: str = "all") -> None:
        """Delay what is heard on an interface, until the next call."""
        self._ask("network", {"interface": interface, "delay": seconds})

    def conveyor(self, ticks_per_second: float, encoder: int = 0) -> None:
        """Turn an encoder of the robot from now on, as a conveyor does; a program has to set the encoder up."""
        self._ask("conveyor", {"encoder": encoder, "ticks_per_second": ticks_per_second})

    def pace(self, speed: float) -> None:
        """Let simulated time pass at a share of the clock's speed, 0.01 to 1."""
        self._ask("pace", {"speed": speed})

    def begin(self, **setup: Json) -> None:
        """Begin anew with another set-up, as a configuration file says it; the arm stays the same."""
        self._begun = self._last()
        self._ask("begin", setup)

    def restart(self) -> None:
        """Go back to the very start."""
        self._begun = self._last()
        self._ask("restart", {})

    def _last(self) -> int:
        """Number of the last event."""
        return next((int(event["number"]) for event in reversed(self.events())), 0)

    def state(self) -> dict[str, Json]:
        """Mode, safety, phase, program and more."""
        return dict(self._ask("state"))

    def events(self, after: int = 0) -> list[dict[str, Json]]:
        """All events with numbers above `after`: number, tick, kind, values, text."""
        return list(self._ask(f"events?after={after}"))

    def field(self, name: str) -> Json:
        """The value of an output field of RTDE."""
        return self._ask(f"field/{name}")

    def wait_for(self, kind: str, seconds: float = 10.0, after: int | None = None) -> dict[str, Json]:
        """Wait for an event, of those with numbers above `after`; None: of all since the last start.

        Raises:
            TimeoutError: it does not come in time; with the events that came.
        """
        end = time.monotonic() + seconds
        while True:
            events = self.events(self._begun if after is None else after)
            found = next((event for event in events if event["kind"] == kind), None)
            if found is not None:
                return found
            if time.monotonic() > end:
                raise TimeoutError(f"no {kind} in {seconds:g} s; there were {[event['kind'] for event in events]}")
            time.sleep(NAP)

    def wait_until(self, seconds: float = 10.0, **wanted: Json) -> dict[str, Json]:
        """Wait until `state` says what is wanted, such as `mode="FREE_DRIVE"`.

        Raises:
            TimeoutError: it does not in time; with the state.
        """
        end = time.monotonic() + seconds
        while True:
            state = self.state()
            if all(state[name] == value for name, value in wanted.items()):
                return state
            if time.monotonic() > end:
                raise TimeoutError(f"not {wanted} in {seconds:g} s; it is {state}")
            time.sleep(NAP)

    def record(self) -> None:
        """Record from now on."""
        self._ask("recording", {"on": True})

    def recording(self) -> Path:
        """End the recording, and say where it is.

        Raises:
            RuntimeError: there is none, or it could not be written.
        """
        told = self._ask("recording", {"on": False})
        if told["path"] is None or told["failure"]:
            raise RuntimeError(f"no recording: {told['failure'] or 'it was not switched on'}")
        return self._folder / str(told["path"])

    def _answers(self) -> bool:
        """Wait until it answers; False: it has ended, or is silent for too long."""
        end = time.monotonic() + PATIENCE
        while time.monotonic() < end and Path(f"/proc/{self._pid}/fd/0").exists():  # a process that has ended has no files
            try:
                if self.state()["tick"]:
                    return True
            except OSError:
                time.sleep(NAP)
        return False

    def _ask(self, path: str, body: Mapping[str, Json] | None = None) -> Json:
        """Ask the control channel. Raises ValueError: it refuses, in its words."""
        request = urllib.request.Request(
            f"http://{self.host}:{self.ports[CONTROL]}/{path}",
            data=None if body is None else json.dumps(body).encode(),
            headers={"Authorization": f"Bearer {self._token}", "Content-Type": "application/json"},
        )
        try:
            with _OPENER.open(request, timeout=30.0) as answer:
                return json.load(answer)
        except urllib.error.HTTPError as error:
            raise ValueError(json.load(error)["error"]) from None


class _Nursery:
    """The process in which robots begin; started when this module is imported, so that it is ready when one is asked for."""

    def __init__(self) -> None:
        # Without bytecode half of the start is spent on compiling; kernels are kept beside their modules anyway.
        kept = {name: value for name, value in os.environ.items() if name != "PYTHONDONTWRITEBYTECODE"}
        self._process = subprocess.Popen(
            [sys.executable, "-m", "app.robot_nursery"], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True, env=kept
        )
        atexit.register(self.close)

    def order(self, **order: Json) -> int:
        """Hand over an order. Raises RuntimeError: the process has ended."""
        assert self._process.stdin is not None
        assert self._process.stdout is not None
        try:
            self._process.stdin.write(json.dumps(order) + "\n")
            self._process.stdin.flush()
            return int(self._process.stdout.readline())
        except (OSError, ValueError):
            raise RuntimeError("the process in which robots begin has ended; what it said is above") from None

    def close(self) -> None:
        """End all robots, and the process."""
        if self._process.stdin is not None:
            self._process.stdin.close()
        self._process.wait()


_NURSERY = _Nursery()

_OPENER = urllib.request.build_opener(urllib.request.ProxyHandler({}))  # no proxy of the user's for this machine


def free_addresses() -> Iterator[str]:
    """Loopback addresses drawn by chance, whose usual ports are free now."""
    while True:
        host = f"127.{1 + secrets.randbelow(254)}.{secrets.randbelow(256)}.{1 + secrets.randbelow(254)}"
        with socket.socket() as probe:
            probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
            probe.bind((host, PORTS[CONTROL]))
        yield host
