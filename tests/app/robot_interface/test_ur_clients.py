"""Clients that robot programs use, unmodified: every public function of theirs, against one robot in a process of its own."""

import csv
import math
import time
from collections.abc import Callable, Iterator, Mapping
from functools import partial
from pathlib import Path

import numpy as np
import pytest
from dashboard_client import DashboardClient
from rtde_io import RTDEIOInterface
from rtde_receive import RTDEReceiveInterface
from scipy.spatial.transform import Rotation
from universal_robots_clients import dashboard_client as lines
from universal_robots_clients import rtde_client as registers

from app.robot_interface.controller.robot_words import SERIAL, VERSION
from app.robot_interface.controller.rtde_fields import CONSTANTS
from app.served_robot import ServedRobot
from tests.sim.arms import UR5E

HOME = [0.0, -1.2, 1.5, -1.87, -1.57, 0.0]
TOOL, LOAD = (
    {"mass": 0.5, "com": [0.0, 0.0, 0.03]},
    {"mass": 2.0, "com": [0.0, 0.01, 0.05], "inertia": [0.01, 0.01, 0.02, 0, 0, 0]},
)
INERTIA = [0.01 + 65e-5 + 20e-5, 0.01 + 65e-5 + 16e-5, 0.02 + 10e-5 + 4e-5, 0.0, 0.0, -8e-5]
"""About the centre of both: of the load, of the tool as a cylinder, and 0.4 kg that are 1 cm and 2 cm away (parallel axes)."""
TCP, MASS, GRAVITY = [0.0, 0.0, 0.12], 2.5, 9.81
SETUP = {
    "seed": 3,
    "mismatch": "nominal",
    "tool": {**TOOL, "name": "probe", "tcp": TCP, "length": 0.12, "radius": 0.02},
    "payload_true": LOAD,
    "payload_configured": LOAD,
    "settings": {"activation.period": 0.2, "sequence.period": 0.5},
}
NM_PER_A = np.array(UR5E.motors.gear) * np.array(UR5E.motors.torque_constant)
RUNNING, IDLE, POWER_OFF = 7, 5, 3  # robot modes
PROGRAM_RUNNING = 2  # of the bits of the robot's status
LOCAL = "please switch robot to Remote Control mode and reconnect to port 29999"
NO_SUCH = "no-such-program.urp"


def until(done: Callable[[], object], seconds: float = 20.0) -> None:
    end = time.monotonic() + seconds
    while not done():
        assert time.monotonic() < end, "not in time"
        time.sleep(0.005)


def becomes(read: Callable[[], object], expected: object, tolerance: float = 1e-9, seconds: float = 20.0) -> None:
    """Wait until what is read is what is expected; what it is in the end stands in the failure."""
    wanted = pytest.approx(expected, abs=tolerance) if isinstance(expected, float | list) else expected
    end = time.monotonic() + seconds
    while (value := read()) != wanted and time.monotonic() < end:
        time.sleep(0.005)
    assert value == wanted
    assert type(value) is (list if isinstance(expected, list) else type(expected))


class Cell:
    """The robot, and clients that stay connected. The robot gives its inputs to one client at a time, so writers take turns."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.robot = ServedRobot(folder, SETUP)
        self.robot.start()
        self.receive = RTDEReceiveInterface(self.robot.host, 500.0)
        self.dashboard = DashboardClient(self.robot.host)
        self.dashboard.connect()
        self._io: RTDEIOInterface | None = None
        self._registers: registers.Client | None = None

    @property
    def io(self) -> RTDEIOInterface:
        if self._io is None:
            self.release()
            self._io = RTDEIOInterface(self.robot.host)
        return self._io

    @property
    def registers(self) -> registers.Client:
        if self._registers is None:
            self.release()
            self._registers = registers.connect(self.robot.host)
        return self._registers

    def release(self) -> None:
        """Let another writer have the inputs."""
        if self._io is not None:
            self._io.disconnect()
        if self._registers is not None:
            registers.disconnect(self._registers)
        self._io = self._registers = None

    def close(self) -> None:
        """Clients first: one that loses its robot ends its process when it is destroyed."""
        self.release()
        self.receive.disconnect()
        self.dashboard.disconnect()
        self.robot.stop()

    def begin(self) -> None:
        """Start over, at rest in remote control."""
        self.robot.begin(**SETUP)
        self.robot.remote(True)
        self.robot.wait_until(mode="REMOTE", robot_mode="RUNNING")

    def tidy(self) -> None:
        """As it was, for the next test."""
        state = self.robot.state()
        if [state[name] for name in ("mode", "safety_mode", "runtime_state")] != ["REMOTE", "NORMAL", "STOPPED"]:
            self.begin()

    def play(self, name: str = "wait.urp") -> None:
        self.dashboard.loadURP(name)
        self.dashboard.play()
        until(self.dashboard.running)

    def stop_protectively(self) -> None:
        """The payload falls off while somebody guides the arm."""
        self.robot.free_drive(30.0)
        self.robot.wait_until(mode="FREE_DRIVE")
        self.robot.change(kind="drop_payload")
        self.robot.wait_until(safety_mode="PROTECTIVE_STOP")
        self.robot.free_drive(0.0)


@pytest.fixture(scope="module")
def one_cell(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Cell]:
    made = Cell(tmp_path_factory.mktemp("robot"))
    made.begin()
    yield made
    made.close()


@pytest.fixture
def cell(one_cell: Cell) -> Iterator[Cell]:
    yield one_cell
    one_cell.tidy()


Check = Callable[[Cell], object]


def functions(client: type) -> set[str]:
    return {name for name in dir(client) if not name.startswith("_")}


def rows(table: dict[str, Check]) -> list[object]:
    """The checks of a table, those of several functions once."""
    names: dict[Check, list[str]] = {}
    for name, check in table.items():
        names.setdefault(check, []).append(name)
    return [pytest.param(check, id="+".join(of)) for check, of in names.items()]


# The arm as its Denavit-Hartenberg table and its masses say.


def frames(q: list[float]) -> list[np.ndarray]:
    """The DH frames of the base and of all links, (4, 4) in B."""
    poses = [np.eye(4)]
    for angle, a, d, alpha in zip(q, UR5E.chain.a, UR5E.chain.d, UR5E.chain.alpha, strict=True):
        c, s, ca, sa = math.cos(angle), math.sin(angle), math.cos(alpha), math.sin(alpha)
        poses.append(
            poses[-1] @ np.array([[c, -s * ca, s * sa, a * c], [s, c * ca, -c * sa, a * s], [0, sa, ca, d], [0, 0, 0, 1]])
        )
    return poses


def is_pose_of(pose: list[float], q: list[float]) -> None:
    """A pose is that of the TCP at the joint angles."""
    expected = frames(q)[-1] @ np.array([*TCP, 1.0])
    assert pose[:3] == pytest.approx(expected[:3], abs=0.001)
    turned = Rotation.from_matrix(frames(q)[-1][:3, :3]).inv() * Rotation.from_rotvec(pose[3:])
    assert turned.magnitude() < 0.002


def holding_moments(q: list[float]) -> np.ndarray:
    """Moments that hold the arm, the tool and the payload against gravity [N·m]."""
    poses = frames(q)
    bodies = [*zip(UR5E.masses.mass, UR5E.masses.com, poses[1:], strict=True)]
    bodies += [(body["mass"], body["com"], poses[-1]) for body in (TOOL, LOAD)]
    lifted = [(mass * GRAVITY, (pose @ [*com, 1.0])[:3]) for mass, com, pose in bodies]
    return np.array([
        sum(weight * pose[:3, 2] @ np.cross(at - pose[:3, 3], [0.0, 0.0, 1.0]) for weight, at in lifted[k:])
        for k, pose in enumerate(poses[:-1])
    ])  # fmt: skip


# What RTDEReceiveInterface tells.


def tells(name: str, expected: object, tolerance: float = 1e-9) -> Check:
    """A function of it comes to an answer."""
    return lambda cell: becomes(getattr(cell.receive, name), expected, tolerance)


def constant(name: str, field: str) -> Check:
    """What this arm does not have is answered as the table says."""
    stated = CONSTANTS[field]
    return tells(name, list(stated) if isinstance(stated, tuple) else stated)


def current_holds_the_arm(name: str) -> Check:
    def check(cell: Cell) -> None:
        moments = np.array(getattr(cell.receive, name)()) * NM_PER_A
        assert moments == pytest.approx(holding_moments(HOME), abs=6.0)  # friction holds, too

    return check


def modes(cell: Cell, read: Callable[[], object], off: object, idle: object, running: object) -> None:
    """What is read while the robot is switched off, on, and its brakes are released."""
    becomes(read, running)
    cell.dashboard.powerOff()
    becomes(read, off)
    cell.dashboard.powerOn()
    becomes(read, idle)
    until(lambda: cell.dashboard.brakeRelease() or read() == running)  # see test_brakes_open_soon_after_power_off


def program_states(cell: Cell, read: Callable[[], object], playing: object, paused: object, stopped: object) -> None:
    becomes(read, stopped)
    cell.play()
    becomes(read, playing)
    cell.dashboard.pause()
    becomes(read, paused)
    cell.dashboard.stop()
    becomes(read, stopped)


def safety_states(cell: Cell, read: Callable[[], object], answers: Mapping[str, object]) -> None:
    """What is read after each control. The pendant's reset counts once the arm has stood for 0.1 s."""
    for control, answer in answers.items():
        if control == "reset":
            until(partial(_reset, cell, read, answer))
        cell.robot.press(control)
        becomes(read, answer)


def _reset(cell: Cell, read: Callable[[], object], answer: object) -> bool:
    cell.robot.press("reset")
    return read() == answer


def moment(cell: Cell) -> None:
    """It is what the target current makes, and it holds the arm."""
    moments = cell.receive.getTargetMoment()
    assert moments == pytest.approx(np.array(cell.receive.getTargetCurrent()) * NM_PER_A, abs=1.0)
    assert moments == pytest.approx(holding_moments(HOME), abs=6.0)


def force(cell: Cell) -> None:
    """A push in W is felt at the TCP, in axes of the base."""
    read = cell.receive.getActualTCPForce
    becomes(read, ZERO, 1.0)
    before = read()
    cell.robot.push((0.0, 15.0, 0.0), 1.0)
    becomes(lambda: [now - then for now, then in zip(read(), before, strict=True)], [0.0, 15.0, 0.0, 0.0, 0.0, 0.0], 2.0)
    becomes(read, ZERO, 2.0)


def raw_wrench(cell: Cell) -> None:
    """All that hangs at the flange pulls along its z, which points down."""
    becomes(lambda: cell.receive.getFtRawWrench()[:3], [0.0, 0.0, MASS * GRAVITY], 2.0)
    becomes(lambda: cell.receive.getFtRawWrench()[3:], [0.0] * 3, 0.6)


def acceleration(cell: Cell) -> None:
    felt = frames(HOME)[-1][:3, :3].T @ [0.0, 0.0, GRAVITY]
    becomes(cell.receive.getActualToolAccelerometer, felt.tolist(), 0.5)


def inputs(cell: Cell, read: Callable[[], object], on: object, off: object) -> None:
    for high, answer in ((True, on), (False, off)):
        cell.robot.do({"do": "input", "at": 0.0, "input": 5, "high": high})
        becomes(read, answer)


def outputs(cell: Cell, read: Callable[[], object], on: object, off: object) -> None:
    for high, answer in ((True, on), (False, off)):
        assert cell.io.setConfigurableDigitalOut(2, high)
        becomes(read, answer)


def slid(cell: Cell, read: Callable[[], object], expected: float) -> None:
    """What is read when the speed slider is at half."""
    try:
        assert cell.io.setSpeedSlider(0.5)
        becomes(cell.receive.getTargetSpeedFraction, 0.5)
        becomes(read, expected)
    finally:
        cell.io.setSpeedSlider(1.0)
        becomes(cell.receive.getTargetSpeedFraction, 1.0)


def output_registers(cell: Cell, name: str, zero: float) -> None:
    """No program writes them; the client refuses those that it has not asked for."""
    assert repr([getattr(cell.receive, name)(number) for number in range(12, 20)]) == repr([zero] * 8)
    with pytest.raises(ValueError, match="supported range"):
        getattr(cell.receive, name)(24)


def timestamp(cell: Cell) -> None:
    """It counts ticks, as fast as the clock."""
    first, begin = cell.receive.getTimestamp(), time.monotonic()
    until(lambda: cell.receive.getTimestamp() > first + 0.2)
    passed = cell.receive.getTimestamp() - first
    assert passed == pytest.approx(time.monotonic() - begin, abs=0.05)
    assert passed / 0.002 == pytest.approx(round(passed / 0.002), abs=1e-6)


def periods(cell: Cell) -> None:
    begin = time.monotonic()
    for _ in range(25):
        cell.receive.waitPeriod(cell.receive.initPeriod())
    assert time.monotonic() - begin == pytest.approx(25 * 0.002, abs=0.04)


def connection(cell: Cell) -> None:
    other = RTDEReceiveInterface(cell.robot.host, 125.0, ["timestamp", "actual_q"])
    assert other.isConnected()
    other.disconnect()
    assert not other.isConnected()
    assert other.reconnect()
    assert other.isConnected()
    before = other.getTimestamp()
    until(lambda: other.getTimestamp() > before)
    assert other.getActualQ() == pytest.approx(HOME, abs=0.01)
    with pytest.raises(RuntimeError, match="robot_mode"):
        other.getRobotMode()
    other.disconnect()


def file_recording(cell: Cell) -> None:
    """The columns that were asked for, in the order of time. The client samples by its own clock: some packages twice."""
    path = cell.folder / "client.csv"
    assert cell.receive.startFileRecording(str(path), ["timestamp", "actual_q", "robot_mode"])
    before = cell.receive.getTimestamp()
    until(lambda: cell.receive.getTimestamp() > before + 1.0)
    assert cell.receive.stopFileRecording()
    with path.open(newline="") as file:
        lines = list(csv.DictReader(file))
    assert list(lines[0]) == ["timestamp", *(f"actual_q_{k}" for k in range(6)), "robot_mode"]
    times = [float(line["timestamp"]) for line in lines]
    assert times == sorted(times)
    assert len(set(times)) > 50
    assert [float(lines[-1][f"actual_q_{k}"]) for k in range(6)] == pytest.approx(HOME, abs=0.01)
    assert {line["robot_mode"] for line in lines} == {"7"}


ZERO = [0.0] * 6
EMERGENCY, SAFEGUARD = 1 << 6 | 1 << 7 | 1 << 10, 1 << 4 | 1 << 10
SAFETY = {"reduced_on": (2, 2), "reduced_off": (1, 1), "safeguard_open": (5, SAFEGUARD)}
SAFETY |= {"safeguard_closed": (5, SAFEGUARD), "reset": (1, 1)}
SAFETY |= {"emergency_stop": (7, EMERGENCY), "emergency_stop_released": (1, 1)}


def power(cell: Cell) -> None:
    def read() -> tuple[object, object]:
        return cell.receive.getRobotMode(), cell.receive.getJointMode()

    modes(cell, read, (POWER_OFF, [239] * 6), (IDLE, [255] * 6), (RUNNING, [253] * 6))


def program(cell: Cell) -> None:
    def read() -> tuple[int, int]:
        return cell.receive.getRuntimeState(), cell.receive.getRobotStatus()

    program_states(cell, read, (2, 0b11), (4, 0b01), (1, 0b01))


def safety(cell: Cell) -> None:
    safety_states(cell, lambda: (cell.receive.getSafetyMode(), cell.receive.getSafetyStatusBits()), SAFETY)


RECEIVE: dict[str, Check] = {
    "disconnect": connection,
    "getActualCurrent": current_holds_the_arm("getActualCurrent"),
    "getActualDigitalInputBits": lambda cell: inputs(cell, cell.receive.getActualDigitalInputBits, 1 << 5, 0),
    "getActualDigitalOutputBits": lambda cell: outputs(cell, cell.receive.getActualDigitalOutputBits, 1 << 10, 0),
    "getActualExecutionTime": constant("getActualExecutionTime", "actual_execution_time"),
    "getActualJointVoltage": constant("getActualJointVoltage", "actual_joint_voltage"),
    "getActualMainVoltage": constant("getActualMainVoltage", "actual_main_voltage"),
    "getActualMomentum": constant("getActualMomentum", "actual_momentum"),
    "getActualQ": tells("getActualQ", HOME, 0.01),
    "getActualQd": tells("getActualQd", ZERO, 0.01),
    "getActualRobotCurrent": constant("getActualRobotCurrent", "actual_robot_current"),
    "getActualRobotVoltage": constant("getActualRobotVoltage", "actual_robot_voltage"),
    "getActualTCPForce": force,
    "getActualTCPPose": lambda cell: is_pose_of(cell.receive.getActualTCPPose(), cell.receive.getActualQ()),
    "getActualTCPSpeed": tells("getActualTCPSpeed", ZERO, 0.01),
    "getActualToolAccelerometer": acceleration,
    "getDigitalInState": lambda cell: inputs(cell, lambda: cell.receive.getDigitalInState(5), True, False),
    "getDigitalOutState": lambda cell: outputs(cell, lambda: cell.receive.getDigitalOutState(10), True, False),
    "getFtRawWrench": raw_wrench,
    "getJointControlOutput": constant("getJointControlOutput", "joint_control_output"),
    "getJointMode": power,
    "getJointTemperatures": lambda cell: (
        cell.robot.change(kind="temperature", celsius=33.0),
        becomes(cell.receive.getJointTemperatures, [33.0] * 6, 0.5),
    ),
    "getOutputDoubleRegister": partial(output_registers, name="getOutputDoubleRegister", zero=0.0),
    "getOutputIntRegister": partial(output_registers, name="getOutputIntRegister", zero=0),
    "getPayload": tells("getPayload", MASS),
    "getPayloadCog": tells("getPayloadCog", [0.0, 2.0 * 0.01 / MASS, (0.5 * 0.03 + 2.0 * 0.05) / MASS]),
    "getPayloadInertia": tells("getPayloadInertia", INERTIA),
    "getRobotMode": power,
    "getRobotStatus": program,
    "getRuntimeState": program,
    "getSafetyMode": safety,
    "getSafetyStatusBits": safety,
    "getSpeedScaling": lambda cell: slid(cell, cell.receive.getSpeedScaling, 1.0),
    "getSpeedScalingCombined": lambda cell: slid(cell, cell.receive.getSpeedScalingCombined, 0.5),
    "getStandardAnalogInput0": constant("getStandardAnalogInput0", "standard_analog_input0"),
    "getStandardAnalogInput1": constant("getStandardAnalogInput1", "standard_analog_input1"),
    "getStandardAnalogOutput0": lambda cell: analog(cell, "setAnalogOutputVoltage", 0, 2.5),
    "getStandardAnalogOutput1": lambda cell: analog(cell, "setAnalogOutputVoltage", 1, 2.5),
    "getTargetCurrent": current_holds_the_arm("getTargetCurrent"),
    "getTargetMoment": moment,
    "getTargetQ": tells("getTargetQ", HOME, 0.01),
    "getTargetQd": tells("getTargetQd", ZERO, 1e-4),
    "getTargetQdd": tells("getTargetQdd", ZERO, 1e-3),
    "getTargetSpeedFraction": lambda cell: slid(cell, cell.receive.getTargetSpeedFraction, 0.5),
    "getTargetTCPPose": lambda cell: is_pose_of(cell.receive.getTargetTCPPose(), cell.receive.getTargetQ()),
    "getTargetTCPSpeed": lambda cell: (
        becomes(cell.receive.getTargetQd, ZERO, 1e-6),
        becomes(cell.receive.getTargetTCPSpeed, ZERO, 1e-6, seconds=2.0),
    ),
    "getTimestamp": timestamp,
    "initPeriod": periods,
    "isConnected": connection,
    "isEmergencyStopped": lambda cell: safety_states(
        cell, cell.receive.isEmergencyStopped, {"emergency_stop": True, "emergency_stop_released": False}
    ),
    "isProtectiveStopped": lambda cell: (
        becomes(cell.receive.isProtectiveStopped, False),
        cell.stop_protectively(),
        becomes(cell.receive.isProtectiveStopped, True),
    ),
    "reconnect": connection,
    "startFileRecording": file_recording,
    "stopFileRecording": file_recording,
    "waitPeriod": periods,
}


# What RTDEIOInterface sets.


def analog(cell: Cell, name: str, number: int, expected: float, voltage: bool = True) -> None:
    """A quarter of the span is read back in volts or amperes, and the output's domain is told."""
    field = f"standard_analog_output{number}"
    read = (cell.receive.getStandardAnalogOutput0, cell.receive.getStandardAnalogOutput1)[number]
    try:
        assert getattr(cell.io, name)(number, 0.25)
        until(lambda: cell.robot.field(field) != 0.0)
        becomes(read, cell.robot.field(field))
        assert read() == pytest.approx(expected)
        assert cell.robot.field("analog_io_types") >> 2 + number & 1 == voltage
    finally:
        cell.io.setAnalogOutputVoltage(number, 0.0)
        until(lambda: cell.robot.field(field) == 0.0)


def digital(cell: Cell, name: str, first: int, count: int) -> None:
    """Each output is one bit, read back by the other client; a number beyond the last changes nothing."""
    for number in (0, count - 1):
        for high in (True, False):
            assert getattr(cell.io, name)(number, high) is True
            becomes(cell.receive.getActualDigitalOutputBits, high << first + number)
            assert cell.receive.getDigitalOutState(first + number) is high


def input_registers(cell: Cell, kind: str, value: float) -> None:
    """They arrive and are told again; numbers outside the client's range are refused by it."""
    name = f"setInput{kind.title()}Register"
    for number in (18, 22):
        for sent in (value, type(value)(0)):
            assert getattr(cell.io, name)(number, sent) is True
            becomes(lambda number=number: cell.robot.field(f"input_{kind}_register_{number}"), sent)
    with pytest.raises(ValueError, match="supported range"):
        getattr(cell.io, name)(23, value)


def slider(cell: Cell) -> None:
    for share, told in ((0.5, 0.5), (0.0, 0.0), (1.5, 1.0), (1.0, 1.0)):
        assert cell.io.setSpeedSlider(share) is True
        becomes(cell.receive.getTargetSpeedFraction, told)


def io_connection(cell: Cell) -> None:
    """Inputs belong to one client, and are free as soon as it leaves."""
    assert cell.io.isConnected()
    with pytest.raises(RuntimeError, match="already in use"):
        RTDEIOInterface(cell.robot.host)
    cell.io.disconnect()
    assert not cell.io.isConnected()
    upper = RTDEIOInterface(cell.robot.host, False, True)
    assert upper.setInputIntRegister(42, 7)
    becomes(partial(cell.robot.field, "input_int_register_42"), 7)
    upper.disconnect()
    assert cell.io.reconnect()
    assert cell.io.isConnected()
    digital(cell, "setStandardDigitalOut", 0, 8)


IO: dict[str, Check] = {
    "disconnect": io_connection,
    "isConnected": io_connection,
    "reconnect": io_connection,
    "setAnalogOutputCurrent": partial(analog, name="setAnalogOutputCurrent", number=1, expected=0.008, voltage=False),
    "setAnalogOutputVoltage": partial(analog, name="setAnalogOutputVoltage", number=0, expected=2.5),
    "setConfigurableDigitalOut": partial(digital, name="setConfigurableDigitalOut", first=8, count=8),
    "setInputDoubleRegister": partial(input_registers, kind="double", value=-2.5),
    "setInputIntRegister": partial(input_registers, kind="int", value=-7),
    "setSpeedSlider": slider,
    "setStandardDigitalOut": partial(digital, name="setStandardDigitalOut", first=0, count=8),
    "setToolDigitalOut": partial(digital, name="setToolDigitalOut", first=16, count=2),
}


# What DashboardClient asks and does.


def refused_without_a_program(cell: Cell, name: str) -> None:
    cell.begin()  # with no program loaded
    with pytest.raises(RuntimeError, match=f"Failed to execute: {name}"):
        getattr(cell.dashboard, name)()
    program_states(cell, cell.dashboard.running, True, False, False)


def loading(cell: Cell) -> None:
    cell.begin()
    assert cell.dashboard.getLoadedProgram() == "No program loaded"
    with pytest.raises(RuntimeError, match=f"File not found: {NO_SUCH}"):
        cell.dashboard.loadURP(NO_SUCH)
    cell.dashboard.loadURP("wait.urp")
    assert cell.dashboard.getLoadedProgram() == "Loaded program: /programs/wait.urp"


def saved(cell: Cell) -> None:
    """The client looks for `True` where a UR says `true`, so that it always says no."""
    cell.dashboard.loadURP("wait.urp")
    assert cell.dashboard.isProgramSaved() is False
    assert said(cell, "isProgramSaved") == "true wait.urp"


def said(cell: Cell, line: str) -> str:
    cell.dashboard.send(f"{line}\n")
    return cell.dashboard.receive()


def program_state(cell: Cell) -> None:
    cell.dashboard.loadURP("wait.urp")
    names = (f"{state} wait.urp" for state in ("PLAYING", "PAUSED", "STOPPED"))
    program_states(cell, cell.dashboard.programState, *names)


def named_safety(cell: Cell) -> None:
    names = {1: "NORMAL", 2: "REDUCED", 5: "SAFEGUARD_STOP", 7: "ROBOT_EMERGENCY_STOP"}
    told = {control: (f"Safetymode: {names[mode]}", f"Safetystatus: {names[mode]}") for control, (mode, _) in SAFETY.items()}
    safety_states(cell, lambda: (cell.dashboard.safetymode(), cell.dashboard.safetystatus()), told)


def popup(cell: Cell) -> None:
    cell.dashboard.popup("Refill the feeder")
    assert cell.robot.state()["popup"] == "Refill the feeder"
    cell.dashboard.closePopup()
    assert cell.robot.state()["popup"] == ""


def logged(cell: Cell) -> None:
    cell.dashboard.addToLog("shift begins")
    assert said(cell, "addToLog shift begins") == "Added log message"


def safety_restarted(cell: Cell) -> None:
    cell.dashboard.restartSafety()
    becomes(cell.receive.getRobotMode, POWER_OFF)
    becomes(cell.dashboard.safetymode, "Safetymode: NORMAL")


def unlocked(cell: Cell) -> None:
    """Five seconds after the stop, and not before."""
    cell.stop_protectively()
    begin = cell.receive.getTimestamp()
    with pytest.raises(RuntimeError, match="Cannot unlock protective stop until 5s after occurrence"):
        cell.dashboard.unlockProtectiveStop()
    until(lambda: cell.receive.getTimestamp() > begin + 5.0)
    cell.dashboard.unlockProtectiveStop()
    becomes(cell.receive.getSafetyMode, 1)
    becomes(cell.receive.getRobotMode, RUNNING)


def remote_control(cell: Cell) -> None:
    """Whoever came in local control may ask and not command until he comes again."""
    assert cell.dashboard.isInRemoteControl() is True
    cell.robot.remote(False)
    becomes(cell.dashboard.isInRemoteControl, False)
    early = DashboardClient(cell.robot.host)
    early.connect()
    cell.robot.remote(True)
    becomes(early.isInRemoteControl, True)
    with pytest.raises(RuntimeError, match=LOCAL):
        early.loadURP("wait.urp")
    early.disconnect()


def leaving(cell: Cell, name: str) -> None:
    """The connection ends, for this client alone."""
    other = DashboardClient(cell.robot.host)
    assert not other.isConnected()
    other.connect(2000)
    assert other.isConnected()
    assert other.robotmode() == "Robotmode: RUNNING"
    getattr(other, name)()
    with pytest.raises(RuntimeError):
        other.robotmode()
    other.disconnect()
    assert not other.isConnected()
    assert cell.dashboard.robotmode() == "Robotmode: RUNNING"
    assert cell.receive.getRobotMode() == RUNNING


def user_role(cell: Cell) -> None:
    """The client's module does not export its roles, and an e-Series has no such command."""
    with pytest.raises(TypeError, match="UserRole"):
        cell.dashboard.setUserRole("programmer")
    assert said(cell, "setUserRole programmer").startswith("could not understand")


def raw(cell: Cell) -> None:
    for line, answer in (
        ("set operational mode automatic", "Operational mode AUTOMATIC is set"),
        ("get operational mode", "AUTOMATIC"),
        ("clear operational mode", "No longer controlling the operational mode. Current operational mode: NONE"),
        ("make coffee", "could not understand: 'make coffee'"),
    ):
        assert said(cell, line) == answer


def switched(cell: Cell) -> None:
    modes(cell, cell.dashboard.robotmode, *(f"Robotmode: {mode}" for mode in ("POWER_OFF", "IDLE", "RUNNING")))


QUITTING = partial(leaving, name="quit")

DASHBOARD: dict[str, Check] = {
    "addToLog": logged,
    "brakeRelease": switched,
    "closePopup": popup,
    "closeSafetyPopup": lambda cell: becomes(cell.dashboard.closeSafetyPopup, None),
    "connect": QUITTING,
    "disconnect": partial(leaving, name="disconnect"),
    "getLoadedProgram": loading,
    "getRobotModel": lambda cell: becomes(cell.dashboard.getRobotModel, UR5E.name.upper().rstrip("E")),
    "getSerialNumber": lambda cell: becomes(cell.dashboard.getSerialNumber, SERIAL),
    "isConnected": QUITTING,
    "isInRemoteControl": remote_control,
    "isProgramSaved": saved,
    "loadURP": loading,
    "pause": partial(refused_without_a_program, name="pause"),
    "play": partial(refused_without_a_program, name="play"),
    "polyscopeVersion": lambda cell: becomes(cell.dashboard.polyscopeVersion, ".".join(map(str, VERSION))),
    "popup": popup,
    "powerOff": switched,
    "powerOn": switched,
    "programState": program_state,
    "quit": QUITTING,
    "receive": raw,
    "restartSafety": safety_restarted,
    "robotmode": switched,
    "running": lambda cell: program_states(cell, cell.dashboard.running, True, False, False),
    "safetymode": named_safety,
    "safetystatus": named_safety,
    "send": raw,
    "setUserRole": user_role,
    "shutdown": partial(leaving, name="shutdown"),
    "stop": partial(refused_without_a_program, name="stop"),
    "unlockProtectiveStop": unlocked,
}


# What universal-robots-clients does with the same interfaces.


def reads(name: str, same: str) -> Check:
    """It agrees with the function of ur-rtde that it stands on."""
    return lambda cell: becomes(
        lambda: getattr(registers, name)(cell.registers), getattr(cell.receive, same)(), 0.02 if "force" not in name else 1.0
    )


def read_register(cell: Cell, name: str, zero: float) -> None:
    """The module promises 42 to 46 and ur-rtde 1.6.5 gives 36 to 43."""
    assert repr(getattr(registers, name)(42, cell.registers)) == repr(zero)
    with pytest.raises(ValueError, match="supported range"):
        getattr(registers, name)(46, cell.registers)


def write_register(cell: Cell, kind: str, value: float) -> None:
    for number in (42, 46):
        getattr(registers, f"write_input_{kind}_register")(number, value, cell.registers)
        becomes(lambda number=number: cell.robot.field(f"input_{kind}_register_{number}"), value)


def slider_share(cell: Cell, name: str, whole: float) -> None:
    """Of the speed slider, written and read in the same unit."""
    try:
        getattr(registers, f"write_{name}")(whole / 4, cell.registers)
        becomes(lambda: getattr(registers, f"read_{name}")(cell.registers), whole / 4)
        becomes(cell.receive.getTargetSpeedFraction, 0.25)
    finally:
        registers.write_speed_slider_fraction(1.0, cell.registers)
        becomes(cell.receive.getTargetSpeedFraction, 1.0)


def scaled(cell: Cell, name: str, whole: float) -> None:
    try:
        registers.write_speed_slider_fraction(0.5, cell.registers)
        becomes(cell.receive.getTargetSpeedFraction, 0.5)
        becomes(lambda: registers.read_speed_slider_fraction(cell.registers), 0.5)
        becomes(lambda: getattr(registers, name)(cell.registers), whole / 2)
    finally:
        registers.write_speed_slider_fraction(1.0, cell.registers)
        becomes(cell.receive.getTargetSpeedFraction, 1.0)


def tool_output(cell: Cell) -> None:
    for high in (True, False):
        registers.write_tool_digital_output(1, high, cell.registers)
        becomes(lambda: registers.read_tool_digital_output(1, cell.registers), high)
        becomes(lambda: cell.receive.getDigitalOutState(17), high)


def lazily(cell: Cell) -> None:
    """Connected by the first question, and with the inputs released at the end."""
    cell.release()
    registers.configure(cell.robot.host)
    assert registers.is_connected()
    assert registers.read_robot_mode(registers.lazy(cell.robot.host)) == RUNNING
    registers.reconnect()
    registers.close_lazy_clients()
    assert cell.io.isConnected()


def stays_connected(cell: Cell) -> None:
    assert registers.is_connected(cell.registers)
    registers.disconnect(cell.registers)
    assert not registers.is_connected(cell.registers)
    registers.reconnect(cell.registers)
    assert registers.is_connected(cell.registers)


FRACTION = partial(slider_share, name="speed_slider_fraction", whole=1.0)
PERCENT = partial(slider_share, name="speed_slider_percent", whole=100.0)

REGISTERS: dict[str, Check] = {
    "close_lazy_clients": lazily,
    "configure": lazily,
    "connect": stays_connected,
    "disconnect": stays_connected,
    "is_connected": stays_connected,
    "is_emergency_stopped": lambda cell: safety_states(
        cell,
        lambda: registers.is_emergency_stopped(cell.registers),
        {"emergency_stop": True, "emergency_stop_released": False},
    ),
    "is_protective_stopped": reads("is_protective_stopped", "isProtectiveStopped"),
    "lazy": lazily,
    "read_actual_joint_positions": reads("read_actual_joint_positions", "getActualQ"),
    "read_actual_tcp_force": reads("read_actual_tcp_force", "getActualTCPForce"),
    "read_actual_tcp_pose": reads("read_actual_tcp_pose", "getActualTCPPose"),
    "read_actual_tcp_speed": reads("read_actual_tcp_speed", "getActualTCPSpeed"),
    "read_joint_temperatures": reads("read_joint_temperatures", "getJointTemperatures"),
    "read_output_double_register": partial(read_register, name="read_output_double_register", zero=0.0),
    "read_output_int_register": partial(read_register, name="read_output_int_register", zero=0),
    "read_robot_mode": lambda cell: modes(cell, lambda: registers.read_robot_mode(cell.registers), POWER_OFF, IDLE, RUNNING),
    "read_runtime_state": lambda cell: program_states(cell, lambda: registers.read_runtime_state(cell.registers), 2, 4, 1),
    "read_safety_mode": lambda cell: safety_states(
        cell, lambda: registers.read_safety_mode(cell.registers), {"reduced_on": 2, "reduced_off": 1}
    ),
    "read_speed_scaling": partial(scaled, name="read_speed_scaling", whole=1.0),
    "read_speed_scaling_percent": partial(scaled, name="read_speed_scaling_percent", whole=100.0),
    "read_speed_slider_fraction": FRACTION,
    "read_speed_slider_percent": PERCENT,
    "read_tool_digital_input": lambda cell: becomes(lambda: registers.read_tool_digital_input(1, cell.registers), False),
    "read_tool_digital_output": tool_output,
    "reconnect": stays_connected,
    "write_input_double_register": partial(write_register, kind="double", value=-2.5),
    "write_input_int_register": partial(write_register, kind="int", value=-7),
    "write_speed_slider_fraction": FRACTION,
    "write_speed_slider_percent": PERCENT,
    "write_tool_digital_output": tool_output,
}


def answers(cell: Cell) -> None:
    """Each function comes, says one line, and goes."""
    host = cell.robot.host
    assert lines.load_program(host, NO_SUCH) == f"File not found: {NO_SUCH}"
    assert lines.load_program(host, "wait.urp") == "Loading program: wait.urp"
    assert lines.play_program(host) == "Starting program"
    assert lines.get_program_state(host) == "PLAYING wait.urp"
    assert lines.pause_program(host) == "Pausing program"
    assert lines.get_program_state(host) == "PAUSED wait.urp"
    assert lines.stop_program(host) == "Stopped"
    assert lines.load_and_play_program(host, "wait.urp") == "Starting program"
    assert lines.send_command(host, "running") == "Program running: true"
    assert lines.stop_program(host) == "Stopped"
    assert lines.stop_program(host) == "Failed to execute: stop"


LINES: dict[str, Check] = dict.fromkeys(
    (
        "send_command",
        "load_program",
        "play_program",
        "load_and_play_program",
        "pause_program",
        "stop_program",
        "get_program_state",
    ),
    answers,
)


@pytest.mark.parametrize(
    ("table", "found"),
    [
        (RECEIVE, functions(RTDEReceiveInterface)),
        (IO, functions(RTDEIOInterface)),
        (DASHBOARD, functions(DashboardClient)),
        (REGISTERS, {name for name in registers.__all__ if name[0].islower()}),
        (LINES, set(lines.__all__)),
    ],
    ids=["receive", "io", "dashboard", "registers", "lines"],
)
def test_every_function_of_a_client_has_a_row(table: dict[str, Check], found: set[str]) -> None:
    assert set(table) == found


@pytest.mark.parametrize("check", rows(RECEIVE))
def test_rtde_receive(cell: Cell, check: Check) -> None:
    check(cell)


@pytest.mark.parametrize("check", rows(IO))
def test_rtde_io(cell: Cell, check: Check) -> None:
    check(cell)


@pytest.mark.parametrize("check", rows(DASHBOARD))
def test_dashboard(cell: Cell, check: Check) -> None:
    check(cell)


@pytest.mark.parametrize("check", rows(REGISTERS))
def test_universal_robots_clients_registers(cell: Cell, check: Check) -> None:
    check(cell)


def test_universal_robots_clients_dashboard(cell: Cell) -> None:
    answers(cell)


Sample = list[list[float]]


def sampled(read: RTDEReceiveInterface) -> tuple[float, Sample]:
    """Joints, their target, and the TCP, all of one frame: another may come while this one is read."""
    while True:
        time_then = read.getTimestamp()
        values = [read.getActualQ(), read.getActualQd(), read.getTargetQ(), read.getTargetQd(), read.getTargetQdd()]
        values += [read.getActualTCPPose()[:3], read.getActualTCPSpeed()[:3]]
        if read.getTimestamp() == time_then:
            return time_then, values


def neighbours(cell: Cell, duration: float, gap: float = 0.01) -> Iterator[tuple[float, Sample, Sample]]:
    """Pairs of samples (and the seconds between them) of a program's motion, of that duration together. Where the machine was
    late for longer than the gap there is no pair: between its ends nothing is known of the speeds."""
    read, patience = cell.receive, time.monotonic() + 60.0
    then: tuple[float, Sample] | None = None
    while duration > 0.0:
        assert time.monotonic() < patience, "too few samples in time"
        if not read.getRobotStatus() & PROGRAM_RUNNING:
            cell.play("wave.urp")
            until(lambda: abs(read.getTargetQd()[3]) > 0.0)
            then = None
        now = sampled(read)
        if then and 0.0 < now[0] - then[0] < gap:
            yield now[0] - then[0], then[1], now[1]
            duration -= now[0] - then[0]
        if not then or now[0] > then[0]:
            then = now
        time.sleep(0.0005)


def test_speeds_are_those_of_the_motion(cell: Cell) -> None:
    """What a joint, the target and the TCP have moved is the sum of the speeds that were told; both counted along the motion, so
    that a way back does not take away from the way there."""
    pairs = list(neighbours(cell, duration=0.3))
    dt = np.array([pair[0] for pair in pairs])[:, None]
    first, last = ([np.array(column) for column in zip(*samples, strict=True)] for samples in list(zip(*pairs, strict=True))[1:])
    for value, rate in ((0, 1), (2, 3), (3, 4), (5, 6)):
        step = dt * (first[rate] + last[rate]) / 2
        moved, summed = np.sum(np.sign(step) * (last[value] - first[value]), axis=0), np.abs(step).sum(axis=0)
        assert moved == pytest.approx(summed, abs=0.02 * summed.max() + 0.002)
        assert summed.max() > 0.01


def test_brakes_open_soon_after_power_off(cell: Cell) -> None:
    """A client that waits for each mode comes to RUNNING with one command each, as it does with a UR."""
    for _ in range(6):
        cell.dashboard.powerOff()
        becomes(cell.receive.getRobotMode, POWER_OFF)
        cell.dashboard.powerOn()
        becomes(cell.receive.getRobotMode, IDLE)
        time.sleep(0.05)
        cell.dashboard.brakeRelease()
        becomes(cell.receive.getRobotMode, RUNNING)
        time.sleep(0.05)
