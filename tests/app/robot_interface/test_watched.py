"""What clients see of a robot in a process of its own: refusals, stops and unlocking, control, faults on command."""

import socket
import struct
import time
from collections.abc import Callable, Iterator

import dashboard_client
import pytest
import rtde_receive

from app.log_reading.reader import read
from app.served_robot import ServedRobot

IN_FREE_DRIVE, REFUSED = 64, 66
TEACH_BUTTON, PROTECTIVE, SAFEGUARD, EMERGENCY, STOPPED = 1 << 2, 1 << 2, 1 << 4, 1 << 6 | 1 << 7, 1 << 10


@pytest.fixture(scope="module")
def robot(tmp_path_factory: pytest.TempPathFactory) -> Iterator[ServedRobot]:
    served = ServedRobot(tmp_path_factory.mktemp("robot"))
    served.start()
    yield served
    served.stop()


def test_what_a_client_does_is_refused_on_the_control_channel(robot: ServedRobot) -> None:
    with pytest.raises(ValueError, match=r"actions.0..do = dashboard: what no client does"):
        robot.do({"do": "dashboard", "at": 0.0, "send": "play"})


@pytest.fixture
def fresh(robot: ServedRobot) -> ServedRobot:
    """The robot soon after its start, in remote control."""
    return begun(robot, mismatch="nominal")


def begun(robot: ServedRobot, **setup: object) -> ServedRobot:
    """Begun anew, in remote control, and come to rest."""
    robot.begin(seed=3, **setup)
    robot.remote(True)
    until(lambda: robot.state()["tick"] > 300)
    return robot


def dashboard(robot: ServedRobot) -> Callable[[str], str]:
    """Says a line to the dashboard and gives the answer."""
    connection = socket.create_connection((robot.host, robot.ports["dashboard"]), timeout=5.0)
    lines = connection.makefile("rw", newline="\n")
    assert lines.readline() == "Connected: Universal Robots Dashboard Server\n"

    def say(line: str) -> str:
        lines.write(line + "\n")
        lines.flush()
        return lines.readline().rstrip("\n")

    return say


def until(done: Callable[[], bool], seconds: float = 8.0) -> None:
    end = time.monotonic() + seconds
    while not done():
        assert time.monotonic() < end
        time.sleep(0.01)


def test_a_wrong_payload_is_refused_and_told_in_bits_and_on_the_dashboard(fresh: ServedRobot) -> None:
    begun(fresh, payload_true={"mass": 2.0})
    fresh.do({"do": "settings", "at": 0.0, "set": {"activation.period": 0.2}})
    reading = rtde_receive.RTDEReceiveInterface(fresh.host, 500.0, ["safety_status_bits", "robot_status_bits", "robot_mode"])
    fresh.free_drive(5.0)
    refused = fresh.wait_for("refused_payload")
    assert refused["values"]["mass"] == pytest.approx(2.0, abs=0.5)
    until(lambda: fresh.field(f"output_bit_register_{REFUSED}") == 1)
    assert fresh.field(f"output_bit_register_{IN_FREE_DRIVE}") == 0
    assert "kg" in dashboard(fresh)("free-drive")
    assert "kg" in fresh.state()["refusal"]
    assert reading.getRobotStatus() & TEACH_BUTTON == 0
    assert reading.getSafetyStatusBits() == 1
    reading.disconnect()


def test_free_drive_is_told_in_a_urs_own_bit_and_its_period_ends_it(fresh: ServedRobot) -> None:
    fresh.do({"do": "settings", "at": 0.0, "set": {"activation.period": 0.2, "sequence.period": 0.5, "free_drive.period": 1.0}})
    reading = rtde_receive.RTDEReceiveInterface(fresh.host, 500.0, ["robot_status_bits", "safety_status_bits"])
    fresh.free_drive(20.0)
    until(lambda: reading.getRobotStatus() & TEACH_BUTTON != 0)
    until(lambda: reading.getRobotStatus() & TEACH_BUTTON == 0)
    assert fresh.wait_for("left_period")
    reading.disconnect()


def test_a_dropped_payload_is_a_protective_stop_that_unlocks_after_five_seconds(fresh: ServedRobot) -> None:
    begun(fresh, payload_true={"mass": 3.0}, payload_configured={"mass": 3.0})
    fresh.do({"do": "settings", "at": 0.0, "set": {"activation.period": 0.2, "sequence.period": 0.5}})
    reading = rtde_receive.RTDEReceiveInterface(fresh.host, 500.0, ["safety_status_bits", "safety_mode"])
    say = dashboard(fresh)
    fresh.free_drive(30.0)
    fresh.wait_for("entered")
    dropped = fresh.change(kind="drop_payload")
    stopped = fresh.wait_for("stopped_payload")
    assert 0 < stopped["tick"] - dropped < 250
    until(lambda: reading.getSafetyStatusBits() == PROTECTIVE | STOPPED)
    assert reading.getSafetyMode() == 3
    assert say("safetystatus") == "Safetystatus: PROTECTIVE_STOP"
    assert say("unlock protective stop").startswith("Cannot unlock protective stop until 5s after occurrence")
    fresh.free_drive(0.0)
    until(lambda: (fresh.state()["tick"] - stopped["tick"]) * 0.002 > 5.0)
    assert say("unlock protective stop") == "Protective stop releasing"
    until(lambda: reading.getSafetyStatusBits() == 1)
    assert say("robotmode") == "Robotmode: RUNNING"
    reading.disconnect()


def test_emergency_stop_safeguard_and_reduced_are_told_as_the_tables_say(fresh: ServedRobot) -> None:
    reading = rtde_receive.RTDEReceiveInterface(fresh.host, 500.0, ["safety_status_bits", "robot_mode", "safety_mode"])
    say = dashboard(fresh)
    fresh.press("reduced_on")
    until(lambda: (reading.getSafetyStatusBits(), reading.getSafetyMode()) == (2, 2))
    fresh.press("reduced_off")
    fresh.press("safeguard_open")
    until(lambda: (reading.getSafetyStatusBits(), reading.getSafetyMode()) == (SAFEGUARD | STOPPED, 5))
    assert reading.getRobotMode() == 7
    fresh.press("safeguard_closed")
    fresh.press("reset")
    until(lambda: reading.getSafetyStatusBits() == 1)
    fresh.press("emergency_stop")
    until(lambda: (reading.getSafetyStatusBits(), reading.getSafetyMode()) == (EMERGENCY | STOPPED, 7))
    until(lambda: reading.getRobotMode() == 3)
    assert say("brake release") == "Failed to execute: brake release"
    assert say("safetymode") == "Safetymode: ROBOT_EMERGENCY_STOP"
    fresh.press("emergency_stop_released")
    until(lambda: (reading.getSafetyStatusBits(), reading.getRobotMode()) == (1, 3))
    say("power on")
    assert say("robotmode") == "Robotmode: IDLE"
    say("brake release")
    until(lambda: reading.getRobotMode() == 7)
    reading.disconnect()


def test_in_local_control_a_client_has_to_come_again_after_the_switch(fresh: ServedRobot) -> None:
    fresh.remote(False)
    fresh.wait_until(remote=False)
    say = dashboard(fresh)
    assert say("is in remote control") == "false"
    assert "Remote Control" in say("power off")
    fresh.remote(True)
    fresh.wait_until(remote=True)
    assert "reconnect" in say("power off")
    assert dashboard(fresh)("power off") == "Powering off"


def test_a_program_runs_when_a_client_plays_it(fresh: ServedRobot) -> None:
    client = dashboard_client.DashboardClient(fresh.host)
    client.connect()
    client.loadURP("wave.urp")
    client.play()
    assert client.running()
    fresh.wait_for("program_finished", 20.0)
    assert client.programState() == "STOPPED wave.urp"
    client.disconnect()


def test_a_cut_cable_ends_connections_and_clients_come_back(fresh: ServedRobot) -> None:
    reading = rtde_receive.RTDEReceiveInterface(fresh.host, 500.0, ["timestamp"])
    fresh.cut(0.3, "RTDE")
    until(lambda: not reading.isConnected())
    time.sleep(0.3)
    assert reading.reconnect()
    before = reading.getTimestamp()
    until(lambda: reading.getTimestamp() > before)
    reading.disconnect()


def test_a_paused_robot_stays_connected(fresh: ServedRobot) -> None:
    reading = rtde_receive.RTDEReceiveInterface(fresh.host, 500.0, ["timestamp"])
    fresh._ask("pace", {"paused": True})
    time.sleep(3.0)  # a client gives up after 2.5 s of silence
    assert reading.isConnected()
    before = reading.getTimestamp()
    fresh._ask("pace", {"paused": False})
    until(lambda: reading.getTimestamp() > before)
    reading.disconnect()


@pytest.mark.parametrize("moment", [0.0, 0.1, 0.502])
def test_a_fault_comes_in_the_tick_that_was_asked_for(fresh: ServedRobot, moment: float) -> None:
    asked = fresh.do({"do": "tap", "at": moment, "control": "emergency_stop"})
    assert fresh.wait_for("emergency_stop")["tick"] == asked + max(1, round(moment * 500))


def test_a_recording_is_given_back(fresh: ServedRobot) -> None:
    fresh.record()
    until(lambda: fresh.state()["recording"] is not None)
    fresh.push((0.0, 10.0, 0.0), 0.5)
    time.sleep(0.8)
    log = read(fresh.recording())
    assert log.whole
    assert len(log.ticks) > 200


def test_odd_packets_from_the_network_stop_nothing(fresh: ServedRobot) -> None:
    tick = fresh.state()["tick"]
    for name, data in (
        ("RTDE", struct.pack(">HB", 2, 86)),
        ("dashboard", b"\xff\xfe\n" + b"x" * 5000),
        ("primary", b"\0" * 1000 + b"\n"),
        ("real-time", b"def f():\nend\n"),
        ("dashboard", b"GET / HTTP/1.1\r\n\r\n"),
    ):
        with socket.create_connection((fresh.host, fresh.ports[name]), timeout=5.0) as odd:
            odd.sendall(data)
    until(lambda: fresh.state()["tick"] > tick + 100)
    assert fresh.state()["failure"] == ""


def test_a_conveyor_of_the_laboratory_is_followed(fresh: ServedRobot) -> None:
    text = b"encoder_enable_pulse_decode(1, 1, 0, 1)\n  track_conveyor_linear(p[0,1,0,0,0,0], 10000, 1)\n  sleep(60)"
    with socket.create_connection((fresh.host, fresh.ports["primary"]), timeout=5.0) as client:
        client.sendall(b"def p():\n  " + text + b"\nend\n")
        fresh.wait_until(runtime_state="PLAYING")
        fresh.conveyor(500.0, encoder=1)
        until(lambda: fresh.field("encoder1_raw") > 100)
        fresh.conveyor(0.0, encoder=1)
        time.sleep(0.5)
        before = fresh.field("actual_TCP_pose")[1]
        fresh.conveyor(500.0, encoder=1)
        count = fresh.field("encoder1_raw")
        until(lambda: fresh.field("encoder1_raw") > count + 500)
        assert fresh.field("actual_TCP_pose")[1] - before > 0.03


@pytest.mark.parametrize(
    ("path", "body", "said"),
    [
        ("actions", {"actions": []}, "actions"),
        ("actions", {"actions": [{"do": "push", "at": 0.0, "for": 1.0, "force": [0, 0, 0], "part": "nose"}]}, "nose"),
        ("actions", {"actions": [{"do": "press", "at": 0.0, "control": "dance"}]}, "dance"),
        ("network", {"interface": "pigeon"}, "pigeon"),
        ("network", {"cut": -1.0}, "cut"),
        ("pace", {"speed": 2.0}, "speed"),
        ("begin", {"robot": "ur10e"}, "another arm"),
        ("begin", {"seed": -1}, "seed"),
        ("begin", {"payload_true": {"mass": 1e9}}, "mass"),
        ("free-drive", {"seconds": "long"}, "seconds"),
        ("remote", {}, "on"),
        ("conveyor", {"encoder": 2, "ticks_per_second": 5.0}, "encoder"),
    ],
)
def test_what_cannot_be_asked_is_said_in_one_line(fresh: ServedRobot, path: str, body: dict[str, object], said: str) -> None:
    with pytest.raises(ValueError, match=said) as caught:
        fresh._ask(path, body)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("path", ["nothing", "field/nonsense", "events?after=x"])
def test_there_is_no_such_thing(robot: ServedRobot, path: str) -> None:
    with pytest.raises(ValueError, match=r"control channel|Not Found"):
        robot._ask(path)
