"""The dashboard server's commands as PolyScope 5 answers them (DashboardServer e-Series), for the robot that there is."""

from collections.abc import Callable
from concurrent.futures import Future
from typing import Any, NamedTuple

from app.files.bad_input import BadInput
from app.robot_interface.controller.cabinet import Cabinet
from app.robot_interface.controller.callers import Ask
from app.robot_interface.controller.robot_words import SERIAL, VERSION, OperationalMode, RobotMode, RuntimeState, SafetyMode
from app.robot_interface.controller.scripts_side import Scripts
from pendant.events.event import Kind
from pendant.inputs import Command
from pendant.program.steps import ProgramState
from sim.arm.scenario import Load

BANNER = "Connected: Universal Robots Dashboard Server"

LOCAL = "Command is not allowed due to safety reasons, please switch robot to Remote Control mode and reconnect to port 29999"

LOCKED = "Cannot unlock protective stop until 5s after occurrence. Always inspect cause of protective stop before unlocking"

SOFTWARE = f"{VERSION[0]}.{VERSION[1]}.{VERSION[2]}.{VERSION[3]}"

READY = frozenset({SafetyMode.NORMAL, SafetyMode.REDUCED})
"""Safety modes in which drives can be switched on and programs started."""


class Pending(NamedTuple):
    """An answer that follows from what the robot does with a wish."""

    asked: "Future[Any]"
    answer: Callable[[Any], str]  # of what `asked` gives


Answer = str | Pending


class DashboardCommands:
    """What each command does, and what it answers.

    Args:
        cabinet: the robot.
        model: as the dashboard names the arm, "UR5" for a UR5e.
    """

    def __init__(self, cabinet: Cabinet, model: str) -> None:
        self._cabinet, self._model = cabinet, model
        self._exact: dict[str, Callable[[], Answer]] = {
            "running": lambda: f"Program running: {_truth(self._plays)}",
            "robotmode": lambda: f"Robotmode: {cabinet.state.robot_mode.name}",
            "safetymode": lambda: f"Safetymode: {cabinet.state.safety_mode.name}",
            "safetystatus": lambda: f"Safetystatus: {cabinet.state.safety_mode.name}",
            "programstate": self._program_state,
            "get loaded program": self._loaded,
            "isprogramsaved": lambda: f"true {self._program}",
            "play": self._play,
            "stop": self._stop,
            "pause": self._pause,
            "power on": self._power_on,
            "power off": self._power_off,
            "brake release": self._release_brakes,
            "unlock protective stop": self._unlock,
            "restart safety": self._restart_safety,
            "close safety popup": lambda: "closing safety popup",
            "close popup": self._close_popup,
            "is in remote control": lambda: _truth(cabinet.state.remote),
            "polyscopeversion": lambda: f"URSoftware {SOFTWARE} (Nov 23 2026)",
            "version": lambda: SOFTWARE,
            "get serial number": lambda: SERIAL,
            "get robot model": lambda: self._model,
            "get operational mode": lambda: cabinet.state.operational.name,
            "clear operational mode": self._clear_operational,
            "savelog": lambda: "Log saved to disk",
            "free-drive": self._free_drive,
            "payload": self._payload,
        }
        self._begins: dict[str, Callable[[str], Answer]] = {
            "load installation": lambda name: f"File not found: {name}",
            "load": self._load,
            "set operational mode": self._set_operational,
            "popup": self._popup,
            "answer": self._answer,
            "addtolog": lambda text: "Added log message",
            "generate flight report": lambda text: "Error: this robot writes no flight reports; record it instead",
            "generate support file": lambda text: "Error: this robot writes no support files; record it instead",
            "set payload": self._set_payload,
        }
        self._remote_only = frozenset(
            {
                *("load", "load installation", "play", "stop", "pause", "power on", "power off", "brake release"),
                *("unlock protective stop", "restart safety", "set payload"),
            }
        )

    def answer(self, line: str, remote: bool) -> Answer:
        """The answer to a line.

        Args:
            line: without its end.
            remote: the robot was in remote control when the client connected.
        """
        text = line.strip()
        low = text.lower()
        if low in self._exact:
            return self._refusal(low, remote) or self._exact[low]()
        for verb, act in self._begins.items():
            if low.startswith(f"{verb} ") or low == verb:
                return self._refusal(verb, remote) or act(text[len(verb) :].strip())
        return f"could not understand: '{text}'"

    def _refusal(self, verb: str, remote: bool) -> str:
        """Why a command cannot be done now at all, or ""."""
        if verb not in self._remote_only:
            return ""
        if not remote:
            return LOCAL
        return f"Failed to execute: {verb}" if self._cabinet.state.failure else ""

    @property
    def _plays(self) -> bool:
        return self._cabinet.state.runtime is RuntimeState.PLAYING

    @property
    def _scripted(self) -> Scripts | None:
        """What runs a script now."""
        return None if self._cabinet.state.script is None else self._cabinet.script

    @property
    def _program(self) -> str:
        """Base name of the loaded program."""
        name = self._cabinet.state.program
        return f"{name}.urp" if name else "<unnamed>"

    def _program_state(self) -> str:
        return f"{self._cabinet.state.runtime.name} {self._program}"

    def _loaded(self) -> str:
        return f"Loaded program: /programs/{self._program}" if self._cabinet.state.program else "No program loaded"

    def _load(self, name: str) -> Answer:
        path = self._cabinet.programs.find(name)
        if path is None:
            return f"File not found: {name}"
        failed = f"Error while loading program: {name}"
        try:
            program = self._cabinet.programs.load(path)
        except BadInput:
            return failed
        return self._when(Ask(program=program), Kind.PROGRAM_LOADED, f"Loading program: {name}", failed)

    def _play(self) -> Answer:
        state = self._cabinet.state
        paused = state.program_state is ProgramState.PAUSED
        command = Command.RESUME_PROGRAM if paused else Command.START_REMOTELY
        kind = Kind.PROGRAM_RESUMED if paused else Kind.PROGRAM_STARTED
        if state.robot_mode is not RobotMode.RUNNING:
            return "Failed to execute: play"
        if self._scripted is not None:
            self._scripted.resume()
            return "Starting program"
        if state.loaded is None and not paused:
            return "Failed to execute: play"
        program = None if state.ready or paused else state.loaded
        ask = Ask((command,), program=program, standing=True)
        return self._when(ask, kind, "Starting program", "Failed to execute: play")

    def _stop(self) -> Answer:
        if self._cabinet.state.runtime is RuntimeState.STOPPED:
            return "Failed to execute: stop"
        if self._scripted is not None:
            self._scripted.stop()
            return "Stopped"
        return self._when(Ask((Command.STOP_PROGRAM,)), Kind.PROGRAM_STOPPED, "Stopped", "Failed to execute: stop")

    def _pause(self) -> Answer:
        if self._scripted is not None:
            self._scripted.pause()
            return "Pausing program" if self._plays else "Failed to execute: pause"
        return self._when(Ask((Command.PAUSE_PROGRAM,)), Kind.PROGRAM_PAUSED, "Pausing program", "Failed to execute: pause")

    def _power_on(self) -> Answer:
        return self._power(Ask(idle=True), "power on", "Powering on")

    def _power(self, ask: Ask, line: str, done: str) -> Answer:
        """Give the drives power; what has it already is answered as on a robot, and what may not have it is told."""
        state = self._cabinet.state
        if not state.powerless:
            return done
        return self._pending(ask, done) if state.safety_mode in READY else f"Failed to execute: {line}"

    def _power_off(self) -> Answer:
        return self._pending(Ask((Command.POWER_OFF,), idle=False), "Powering off")

    def _release_brakes(self) -> Answer:
        return self._power(Ask((Command.RESET,), standing=True), "brake release", "Brake releasing")

    def _unlock(self) -> Answer:
        state = self._cabinet.state
        if state.safety_mode is not SafetyMode.PROTECTIVE_STOP:
            return "Protective stop releasing"
        if state.locked_for > 0.0:
            return LOCKED
        return self._pending(Ask((Command.RESET,), standing=True), "Protective stop releasing")

    def _restart_safety(self) -> Answer:
        return self._pending(Ask((Command.POWER_OFF,), idle=False), "Restarting safety")

    def _popup(self, text: str) -> Answer:
        return Pending(self._cabinet.change(popup=text), lambda _: "showing popup")

    def _close_popup(self) -> Answer:
        return Pending(self._cabinet.change(popup=""), lambda _: "closing popup")

    def _answer(self, text: str) -> str:
        """Ours: the value that a program asks people for."""
        question = self._cabinet.state.question
        if question is None:
            return "Failed to execute: answer; no program asks"
        try:
            question.take(text)
        except ValueError as error:
            return f"Failed to execute: answer; {error}"
        return "Answered"

    def _set_operational(self, name: str) -> Answer:
        if name.upper() not in ("MANUAL", "AUTOMATIC"):
            return f"could not understand: 'set operational mode {name}'"
        asked = self._cabinet.change(operational=OperationalMode[name.upper()])
        return Pending(asked, lambda _: f"Operational mode {name.upper()} is set")

    def _clear_operational(self) -> Answer:
        asked = self._cabinet.change(operational=OperationalMode.NONE)
        return Pending(asked, lambda _: "No longer controlling the operational mode. Current operational mode: NONE")

    def _free_drive(self) -> str:
        """Ours: where free-drive stands, and why it was refused last."""
        state = self._cabinet.state
        return f"Free-drive: {state.phase.value}" + (f"; refused: {state.refusal}" if state.refusal else "")

    def _payload(self) -> Answer:
        """Ours: what is configured, tool and payload together."""
        return Pending(self._cabinet.look("payload", "payload_cog"), _payload_told)

    def _set_payload(self, text: str) -> Answer:
        """Ours: the payload beyond the tool, mass [kg] and centre in F [m]."""
        failed = "Failed to execute: set payload; expected MASS or MASS X Y Z, in kg and m"
        try:
            mass, *centre = (float(word) for word in text.split())
        except ValueError:
            return failed
        if len(centre) not in (0, 3):
            return failed
        load = Load(mass=mass, com=centre) if centre else Load(mass=mass)
        refused = Kind.TOOL_REFUSED
        asked = self._cabinet.ask(Ask(load=load))
        return Pending(asked, lambda seen: failed if any(e.kind is refused for e in seen) else "Setting payload")

    def _pending(self, ask: Ask, done: str) -> Pending:
        """`done`, when the robot has taken it."""
        return Pending(self._cabinet.ask(ask), lambda _: done)

    def _when(self, ask: Ask, kind: Kind, done: str, failed: str) -> Pending:
        """`done` if an event of `kind` follows, else `failed`."""
        return Pending(self._cabinet.ask(ask), lambda events: done if any(event.kind is kind for event in events) else failed)


def _payload_told(found: tuple[float, list[float]]) -> str:
    mass, (x, y, z) = found
    return f"Payload: {mass:g} kg at {x:g} {y:g} {z:g} m"


def _truth(value: bool) -> str:
    return "true" if value else "false"
