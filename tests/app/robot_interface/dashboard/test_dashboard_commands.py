"""The dashboard's commands against a robot that is ticked by hand: answers, and what they do."""

import re
from pathlib import Path

import pytest

from app.robot_interface.controller.robot_words import SafetyMode
from app.robot_interface.dashboard.dashboard_commands import LOCAL, LOCKED, DashboardCommands, Pending
from app.session.actions import Laboratory
from pendant.events.event import Event, Kind
from pendant.inputs import Command
from pendant.tick.modes import TICK_RATE, Mode
from sim.plant.changes import SensorFault
from tests.app.robot_interface.robot_bench import RobotBench


class Panel(RobotBench):
    """Says lines to the dashboard and gives its answers."""

    def __init__(self, programs: Path | None = None, **options: float) -> None:
        super().__init__(programs, **options)
        self.commands = DashboardCommands(self.cabinet, "UR5")
        self.step(60)

    def say(self, line: str, remote: bool = True) -> str:
        answer = self.commands.answer(line, remote)
        if isinstance(answer, Pending):
            if not answer.asked.done():
                self.step()
            answer = answer.answer(answer.asked.result(0.0))
        return answer


ALWAYS = {
    "running": "Program running: false",
    "robotmode": "Robotmode: RUNNING",
    "safetymode": "Safetymode: NORMAL",
    "safetystatus": "Safetystatus: NORMAL",
    "programState": "STOPPED <unnamed>",
    "get loaded program": "No program loaded",
    "isProgramSaved": "true <unnamed>",
    "close safety popup": "closing safety popup",
    "close popup": "closing popup",
    "answer 3": "Failed to execute: answer; no program asks",
    "popup hello": "showing popup",
    "is in remote control": "true",
    "PolyscopeVersion": "URSoftware 5.26.0.140462 (Nov 23 2026)",
    "version": "5.26.0.140462",
    "get serial number": "20265500001",
    "get robot model": "UR5",
    "get operational mode": "NONE",
    "set operational mode automatic": "Operational mode AUTOMATIC is set",
    "clear operational mode": "No longer controlling the operational mode. Current operational mode: NONE",
    "addToLog hello": "Added log message",
    "saveLog": "Log saved to disk",
    "generate flight report system": "Error: this robot writes no flight reports; record it instead",
    "generate support file .": "Error: this robot writes no support files; record it instead",
    "free-drive": "Free-drive: OFF",
    "payload": "Payload: 0 kg at 0 0 0 m",
    "dance": "could not understand: 'dance'",
    "set operational mode": "could not understand: 'set operational mode '",
}
"""Answers of a robot that stands, in local control as well."""

REMOTE_ONLY = {
    "load wave.urp": "Loading program: wave.urp",
    "load installation x.installation": "File not found: x.installation",
    "play": "Failed to execute: play",
    "stop": "Failed to execute: stop",
    "pause": "Failed to execute: pause",
    "power on": "Powering on",
    "power off": "Powering off",
    "brake release": "Brake releasing",
    "unlock protective stop": "Protective stop releasing",
    "restart safety": "Restarting safety",
    "set payload 1.5": "Setting payload",
}
"""The same of commands that need remote control."""


@pytest.mark.parametrize("line", ALWAYS)
@pytest.mark.parametrize("remote", [True, False])
def test_these_are_answered_in_local_control_too(line: str, remote: bool) -> None:
    assert Panel().say(line, remote) == ALWAYS[line]


@pytest.mark.parametrize("line", REMOTE_ONLY)
def test_these_need_remote_control(line: str) -> None:
    assert Panel().say(line) == REMOTE_ONLY[line]
    panel = Panel()
    assert panel.say(line, remote=False) == LOCAL
    assert [kind for kind in panel.kinds() if kind is not Kind.MODE_CHANGED] == []


def test_the_tables_have_every_command() -> None:
    commands = DashboardCommands(RobotBench().cabinet, "UR5")
    known = commands._exact.keys() | commands._begins.keys()
    assert {verb for verb in known if not any(line.lower().startswith(verb) for line in {**ALWAYS, **REMOTE_ONLY})} == set()
    assert commands._remote_only <= known


@pytest.mark.parametrize("line", ["POWER OFF", "  power off  ", "Power Off\r"])
def test_case_and_blanks_do_not_matter(line: str) -> None:
    assert Panel().say(line) == "Powering off"


def test_a_program_is_loaded_played_paused_and_stopped() -> None:
    """What the UR client library polls for after each command."""
    panel = Panel()
    assert panel.say("load wave.urp") == "Loading program: wave.urp"
    assert panel.say("programState") == "STOPPED wave.urp"
    assert panel.say("get loaded program") == "Loaded program: /programs/wave.urp"
    assert panel.say("isProgramSaved") == "true wave.urp"
    assert panel.say("play") == "Starting program"
    assert (panel.say("running"), panel.say("programState")) == ("Program running: true", "PLAYING wave.urp")
    assert panel.say("play") == "Failed to execute: play"
    assert panel.say("load wait.urp") == "Error while loading program: wait.urp"
    assert panel.say("pause") == "Pausing program"
    assert panel.say("programState") == "PAUSED wave.urp"
    panel.step(200)
    assert panel.say("play") == "Starting program"
    assert panel.say("stop") == "Stopped"
    assert panel.say("programState") == "STOPPED wave.urp"
    assert panel.simulation.snapshot().decision.mode is Mode.REMOTE


@pytest.mark.parametrize(("name", "content"), [("none.urp", None), ("../wave.urp", None)])
def test_a_program_that_is_not_there_is_not_found(name: str, content: None) -> None:
    assert Panel().say(f"load {name}") == f"File not found: {name}"


def test_a_program_that_cannot_be_read_is_said(tmp_path: Path) -> None:
    (tmp_path / "odd.yaml").write_text("steps: 7")
    (tmp_path / "five.yaml").write_text("steps: [{kind: joint, q: [0, 0, 0, 0, 0]}]")
    panel = Panel(tmp_path)
    assert panel.say("load odd.urp") == "Error while loading program: odd.urp"
    assert panel.say("load five.urp") == "Error while loading program: five.urp"


def test_power_off_on_and_brake_release_go_through_the_modes() -> None:
    panel = Panel()
    panel.say("power off")
    assert panel.say("robotmode") == "Robotmode: POWER_OFF"
    assert panel.say("play") == "Failed to execute: play"
    panel.say("power on")
    assert panel.say("robotmode") == "Robotmode: IDLE"
    assert panel.say("play") == "Failed to execute: play"
    panel.say("power off")
    assert panel.say("robotmode") == "Robotmode: POWER_OFF"
    panel.say("brake release")  # from POWER_OFF it powers on, too
    assert panel.say("robotmode") == "Robotmode: RUNNING"
    panel.step(2)
    assert panel.simulation.snapshot().decision.mode is Mode.REMOTE


def test_an_emergency_stop_is_not_ended_by_a_client_until_its_button_is_out() -> None:
    panel = Panel()
    panel.page(Command.EMERGENCY_STOP)
    for line, answer in (
        ("power on", "Failed to execute: power on"),
        ("brake release", "Failed to execute: brake release"),
        ("unlock protective stop", "Protective stop releasing"),
    ):
        assert panel.say(line) == answer
        panel.step(60)
        assert (panel.say("robotmode"), panel.say("safetymode")) == ("Robotmode: POWER_OFF", "Safetymode: ROBOT_EMERGENCY_STOP")
    panel.page(Command.EMERGENCY_STOP_RELEASED)
    assert (panel.say("robotmode"), panel.say("safetymode")) == ("Robotmode: POWER_OFF", "Safetymode: NORMAL")
    panel.say("power on")
    panel.say("brake release")
    assert panel.say("robotmode") == "Robotmode: RUNNING"


def test_a_simulation_that_has_broken_down_has_no_power_to_give() -> None:
    panel = Panel()
    panel.cabinet.note(Event(Kind.BROKEN_DOWN, 60, {"reason": "it broke"}))
    assert panel.say("safetymode") == "Safetymode: FAULT"
    for line in ("power on", "brake release"):
        assert panel.say(line) == f"Failed to execute: {line}"


def test_a_popup_goes_with_the_power() -> None:
    panel = Panel()
    panel.say("popup Refill the feeder")
    assert panel.cabinet.state.popup == "Refill the feeder"
    panel.say("power off")
    assert panel.cabinet.state.popup == ""


def protected() -> Panel:
    """A program was running when the joints' sensors failed."""
    panel = Panel()
    panel.say("load wave.urp")
    panel.say("play")
    panel.cabinet.act([Laboratory(at=0.0, change=SensorFault(sensor="motor_encoder", outage=True))])
    panel.step(5)
    panel.cabinet.act([Laboratory(at=0.0, change=SensorFault(sensor="motor_encoder"))])
    assert panel.cabinet.state.safety_mode is SafetyMode.PROTECTIVE_STOP
    return panel


def test_a_protective_stop_is_unlocked_after_five_seconds_and_not_before() -> None:
    panel = protected()
    begun = panel.cabinet.state.stopped_at
    assert panel.say("safetystatus") == "Safetystatus: PROTECTIVE_STOP"
    assert panel.say("robotmode") == "Robotmode: RUNNING"
    assert panel.say("unlock protective stop") == LOCKED
    panel.say("brake release")
    panel.step(begun + 5 * TICK_RATE - 1 - panel.simulation.tick_count)
    assert panel.say("unlock protective stop") == LOCKED
    panel.step()
    assert panel.say("unlock protective stop") == "Protective stop releasing"
    assert panel.say("safetymode") == "Safetymode: NORMAL"
    panel.step(2)
    assert panel.simulation.snapshot().decision.mode is Mode.REMOTE
    assert panel.say("play") == "Starting program"


def test_why_free_drive_was_refused_is_told_until_it_is_entered() -> None:
    panel = Panel(true=2.0)
    panel.cabinet.free_drive_until = panel.cabinet.ticks + 2000
    panel.step(1500)
    assert re.fullmatch(r"Free-drive: OFF; refused: .*kg.*", panel.say("free-drive"))


@pytest.mark.parametrize("text", ["", "x", "1 2", "1 2 3 4 5", "nan", "inf", "-1", "1e9", "1 99 0 0", "1 0 0 nan"])
def test_a_payload_that_cannot_be_is_refused(text: str) -> None:
    panel = Panel()
    assert panel.say(f"set payload {text}".strip()).startswith("Failed to execute: set payload")
    assert panel.say("payload") == "Payload: 0 kg at 0 0 0 m"


def test_a_payload_is_configured_with_its_centre() -> None:
    panel = Panel()
    assert panel.say("set payload 1.5 0 0 0.1") == "Setting payload"
    panel.step(520)  # it is gone over to within a second
    assert panel.say("payload") == "Payload: 1.5 kg at 0 0 0.1 m"
