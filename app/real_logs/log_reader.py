"""Logs as people have them, read: CSV of RTDE recorders, tables without a header, bags of ROS 2, our own recordings."""

from pathlib import Path

import numpy as np

from app.files.bad_input import ABSENT, BadInput
from app.log.layout import WORDS
from app.log_reading.reader import Log, read
from app.real_logs.joint_log import JointLog
from app.real_logs.log_bag import read_bag
from app.real_logs.log_mending import mend
from app.real_logs.log_table import read_table
from app.session.timeline_checks import Prepared, applied
from pendant.all_settings import Settings
from pendant.tick.modes import Phase
from sim.arm.arm_file import Arm

EFFORTS = "torque", "current"
"""What the effort of a bag's JointState may be: UR's driver gives currents."""


def read_log(path: Path, arm: Arm, *, columns: str | None = None, effort: str = "torque") -> JointLog:
    """A log of an arm from a file.

    Args:
        path: of the file: a table as text, a bag of ROS 2 in MCAP, or a recording of ours.
        arm: the arm that it is of.
        columns: what the columns of a table without a header are, as `--columns`.
        effort: what the effort of a JointState is, "torque" or "current".

    Raises:
        BadInput: it cannot be used, in one line.
    """
    if not path.is_file():
        raise BadInput(str(path), "", ABSENT, "is no file; expected a log of an arm")
    if path.suffix == ".db3":
        raise BadInput(path.name, "", ABSENT, "is a bag in SQLite; `ros2 bag convert` makes MCAP of it")
    if effort not in EFFORTS:
        raise BadInput("--effort", "", effort, f"expected {' or '.join(EFFORTS)}")
    if path.suffix != ".mcap":
        found, table, told = read_table(path, columns, arm.n)
        for what, factor in found.factors.items():
            table[what] *= factor
        return mend(path.name, table, arm, told, given=frozenset(found.factors))
    try:
        recording = read(path)
    except BadInput:
        values, told = read_bag(path, arm, effort)
        return mend(path.name, values, arm, told)
    return _of_recording(path.name, recording, arm)


def believed(path: Path, prepared: Prepared, *, chosen: bool) -> Prepared:
    """What the controller is to believe in: of a recording of ours its own arm, tool, payload and settings, else `prepared`.

    Args:
        path: of the log.
        prepared: what the command asks for.
        chosen: the user asked for it, so that a recording's own does not count.
    """
    if chosen or path.suffix != ".mcap" or not path.is_file():
        return prepared
    try:
        recording = read(path)
    except BadInput:
        return prepared
    settings = applied(Settings(), recording.settings[0][1], path.name, "settings") if recording.settings else Settings()
    return Prepared(recording.arm, recording.scenario, settings, None, path.name)


def _of_recording(name: str, recording: Log, arm: Arm) -> JointLog:
    """A recording of ours: what its controller knew, and nothing of the truth."""
    if recording.arm.n != arm.n:
        raise BadInput(name, "robot", recording.arm.name, f"has {recording.arm.n} joints, the {arm.name} {arm.n}")
    state = recording.state
    columns = {"t": recording.t[:, None], "q": state["q"], "qd": state["qd"], "torque": state["tau_m"]}
    columns |= {"wrench": state["w_sensor"], "theta": state["theta"]}
    columns["guided"] = (state["phase"] != WORDS["phase"].index(Phase.OFF.value))[:, None]
    return mend(name, {what: np.asarray(each, dtype=np.float64) for what, each in columns.items()}, arm, [])
