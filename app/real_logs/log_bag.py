"""Bags of ROS 2 in MCAP: what `sensor_msgs/JointState` and `WrenchStamped` say of an arm."""

from pathlib import Path

import numpy as np
from mcap.exceptions import McapError
from mcap.reader import make_reader
from mcap_ros2.decoder import DecoderFactory
from numpy.typing import NDArray

from app.files.bad_input import ABSENT, BadInput
from app.real_logs.joint_log import counted
from sim.arm.arm_file import Arm

Array = NDArray[np.float64]

JOINT_STATE = ("sensor_msgs/msg/JointState", "sensor_msgs/JointState")
WRENCH = ("geometry_msgs/msg/WrenchStamped", "geometry_msgs/WrenchStamped")

UR_NAMES = {"shoulder_pan": "base", "shoulder_lift": "shoulder"}
"""UR's ROS description names two joints otherwise than UR's manual does."""


def read_bag(path: Path, arm: Arm, effort: str) -> tuple[dict[str, Array], list[str]]:
    """Columns of each quantity (k, width) of a bag, and what was mended, a sentence each.

    Args:
        path: of the file.
        arm: the arm; the names of its joints stand in the names of the bag's.
        effort: what the effort of a JointState is, "torque" or "current".

    Raises:
        BadInput: it is damaged, or has no JointState of this arm, in one line.
    """
    times, rows, forces, told = list[float](), list[list[float]](), list[list[float]](), list[str]()
    force_times, partial = list[float](), 0
    order: list[int] | None = None
    try:
        with path.open("rb") as file:
            reader = make_reader(file, decoder_factories=[DecoderFactory()])
            topics = [c.topic for c in _channels(reader, JOINT_STATE)]
            if not topics:
                raise BadInput(path.name, "", ABSENT, "has no topic of sensor_msgs/JointState, and is no recording of ours")
            if len(topics) > 1:
                told.append(f"{topics[0]} is read, and {', '.join(topics[1:])} not")
            wrenches = [c.topic for c in _channels(reader, WRENCH)][:1]
            for _, channel, _, message in reader.iter_decoded_messages(topics=topics[:1] + wrenches):
                stamp = message.header.stamp.sec + 1e-9 * message.header.stamp.nanosec
                if channel.topic in wrenches:
                    f, m = message.wrench.force, message.wrench.torque
                    force_times.append(stamp)
                    forces.append([f.x, f.y, f.z, m.x, m.y, m.z])
                    continue
                if order is None or len(message.name) != len(message.position):
                    order = _order(list(message.name), arm, path.name)
                if min(len(message.position), len(message.velocity), len(message.effort)) <= max(order):
                    partial += 1
                    continue
                times.append(stamp)
                rows.append([each[k] for each in (message.position, message.velocity, message.effort) for k in order])
    except (McapError, OSError, ValueError) as error:
        raise BadInput(path.name, "", ABSENT, f"is a damaged bag: {' '.join(str(error).split())[:100]}") from None
    if not rows:
        why = "without angle, speed and effort of all joints" if partial else "empty"
        raise BadInput(path.name, "sensor_msgs/JointState", ABSENT, f"all messages are {why}; expected angles, speeds, efforts")
    if partial:
        told.append(f"{counted(partial, 'message')} without all joints left out")
    told.append(f"effort is taken as {effort} [{'N·m' if effort == 'torque' else 'A'}]")
    table, n = np.array(rows), arm.n
    out = {"t": np.array(times)[:, None], "q": table[:, :n], "qd": table[:, n : 2 * n], effort: table[:, 2 * n :]}
    if forces:
        at = np.searchsorted(force_times, times, side="right") - 1  # the last one that was known
        wrench = np.array(forces)[np.maximum(at, 0)]
        wrench[at < 0] = np.nan
        out["wrench"] = wrench
    return out, told


def _channels(reader, schemas: tuple[str, ...]) -> list:
    summary = reader.get_summary()
    if summary is None:
        raise ValueError("it has no end; `mcap recover` mends it")
    of = {number: schema.name for number, schema in summary.schemas.items()}
    return sorted((c for c in summary.channels.values() if of.get(c.schema_id) in schemas), key=lambda c: c.topic)


def _order(names: list[str], arm: Arm, where: str) -> list[int]:
    """Where each joint of the arm stands in a message: its name is part of the message's, and of one of them alone."""
    ours = [UR_NAMES.get(name.removesuffix("_joint"), name) for name in names]
    places = []
    for joint in arm.chain.joints:
        found = [k for k, name in enumerate(ours) if joint == name] or [k for k, name in enumerate(ours) if _plain(name, joint)]
        if len(found) != 1:
            raise BadInput(where, "name", ", ".join(names), f"expected one joint of {', '.join(arm.chain.joints)} in each name")
        places.append(found[0])
    return places


def _plain(name: str, joint: str) -> bool:
    """Whether a name is a joint's with something before it or after it, such as left_wrist_1_joint."""
    for theirs, ours in UR_NAMES.items():
        name = name.replace(theirs, ours)
    return joint in name
