"""From what a description says and the rules estimate to an arm file."""

import math
import re
from collections.abc import Mapping
from typing import NamedTuple

import numpy as np
from msgspec.structs import replace
from numpy.typing import NDArray

from app.arm_import.description.link_tree import FEWEST
from app.arm_import.description.source_arm import SourceArm
from app.arm_import.hull_capsules import Rod
from app.arm_import.ratings import POSTURES, Ratings, elbow_of, ratings, reach_of, weights
from app.arm_import.size_rules import DRIVES, Drive, drive_of, estimates
from sim.arm.arm_file import Arm, ArmLimits, Capsule, ChainParameters, Inertias, LinkOrigin, Masses, Sourced
from sim.arm.chain import chain
from sim.arm.frames import inertia_numbers, joint_frames, matrix_from_quaternion, quaternion_from_matrix

Array = NDArray[np.float64]

TURN = 2.0 * math.pi
"""Each way, of a joint without ends [rad]."""

MOST_SPEED, MOST_TORQUE = 100.0, 1e5
"""What an arm file can say [rad/s], [N·m]; files write more where they mean that there is no limit."""


class Completed(NamedTuple):
    """An arm with all numbers."""

    arm: Arm
    rated: Ratings
    drive: Drive
    assumed: list[str]  # fields that rules have made
    told: list[str]  # rules of limits and ratings, a line each


def completed(source: SourceArm, name: str, where: str, *, drive: Drive | None, given: Mapping[str, object]) -> Completed:
    """The arm of a description, completed by rules; without shapes, its posture in the middle of all ranges.

    Args:
        source: the arm of the description.
        name: of the new arm.
        where: the file's name.
        drive: kind of its drives; None: by size.
        given: measured values, in the form of an arm file: rules are scaled from its torques and payload.

    Raises:
        BadInput: with its torques the arm cannot hold itself.
    """
    n, told, assumed = len(source.joints), [], []
    ends = [joint.ends or (-TURN, TURN) for joint in source.joints]
    if any(joint.ends is None for joint in source.joints):
        told.append("limits.position: two turns, one each way, where the file has no ends")
        assumed.append("limits.position")
    bare = _arm(source, name, where, ends=ends)
    low, high = np.array(ends).T
    postures = np.random.default_rng(0).uniform(low, high, (POSTURES, n))
    frames = np.array([joint_frames(bare, q) for q in postures])
    stretched = float(np.linalg.norm(source.placements[:, :3, 3], axis=1).sum())
    reach = min(max(float(f"{reach_of(frames):.3g}"), 0.05, 0.26 * stretched), stretched)
    said = [None if joint.torque is None or joint.torque > MOST_TORQUE else joint.torque for joint in source.joints]
    payload, torques = _known(given, n)
    if torques is not None:
        said = list(torques)
    rated = ratings(said, payload, weights(chain(bare), postures), where=where)
    kind = drive or drive_of(rated.torque)
    rules = DRIVES[kind]
    told += rated.told
    assumed += ["payload"] * (payload is None)
    assumed += ["limits.torque"] * (not rated.believed or None in said)
    speeds = [
        None if joint.speed is None or joint.speed > MOST_SPEED or not rated.believed else joint.speed for joint in source.joints
    ]
    if None in speeds:
        told.append(f"limits.speed: {rules.speed:g} rad/s of {rules.title}")
        assumed.append("limits.speed")
    told.append(f"drives: {rules.title}; below, T is a joint's rated torque")
    told.append(f"limits.acceleration: {rules.acceleration} rad/s²")
    assumed.append("limits.acceleration")
    estimated = estimates(rated.torque, [joint.rotor for joint in source.joints], kind)
    arm = replace(
        bare,
        reach=reach,
        payload=rated.payload,
        limits=replace(
            bare.limits,
            speed=[rules.speed if each is None else each for each in speeds],
            acceleration=rules.acceleration(np.array(rated.torque)),
            torque=rated.torque,
            assumed=[each.removeprefix("limits.") for each in assumed if each.startswith("limits.")],
        ),
        **estimated._asdict(),
    )
    told += [
        f"{name}: {getattr(estimated, name).source.partition(': ')[2]}"
        for name in ("motors", "transmissions", "frictions", "thermals")
    ]
    if not all(joint.rotor for joint in source.joints):
        assumed.append("motors.rotor_inertia")
    return Completed(arm, rated, kind, assumed, told)


def _known(given: Mapping[str, object], n: int) -> tuple[float | None, list[float] | None]:
    """Payload [kg] and rated torques [N·m] of measured values; None: not given, or not valid (refused later)."""
    payload, limits = given.get("payload"), given.get("limits")
    torques = limits.get("torque") if isinstance(limits, dict) else None
    known = float(payload) if isinstance(payload, int | float) and 0.0 < payload < 1000.0 else None
    if (
        not isinstance(torques, list)
        or len(torques) != n
        or not all(isinstance(each, int | float) and each > 0.0 for each in torques)
    ):
        return known, None
    return known, [float(each) for each in torques]


def _arm(source: SourceArm, name: str, where: str, *, ends: list[tuple[float, float]]) -> Arm:
    """The arm with placeholders of size 1 where rules come."""
    n, text = len(source.joints), f"{where}, as MuJoCo and Pinocchio read it alike."
    lengths = np.linalg.norm(source.placements[:, :3, 3], axis=1)
    some = estimates([1.0] * n, [None] * n, "harmonic")
    return Arm(
        name=name,
        title=" ".join(source.name.split())[:60] or name,
        reach=1.0,
        payload=1.0,
        rating=Sourced(
            status="assumed", source="By the rules of import: reach from the second joint to the last; payload from torques."
        ),
        chain=ChainParameters(
            status="official",
            source=f"{text} The default posture and the elbow are chosen by the import.",
            assumed=["elbow", "home"],
            joints=[joint.name for joint in source.joints],
            elbow=min(elbow_of(lengths), n - 1) if n > FEWEST else 1,
            home=[(low + high) / 2.0 for low, high in ends],
            origins=[_origin(pose, joint.axis) for pose, joint in zip(source.placements[:-1], source.joints, strict=True)],
            flange=_origin(source.placements[-1], None),
        ),
        masses=Masses(
            status="official",
            source=text,
            mass=[link.mass for link in source.links],
            com=[link.com.tolist() for link in source.links],
        ),
        inertias=Inertias(status="official", source=text, tensor=[inertia_numbers(link.inertia) for link in source.links]),
        limits=ArmLimits(
            status="official",
            source=text,
            position=[[low, high] for low, high in ends],
            speed=[1.0] * n,
            acceleration=[1.0] * n,
            torque=[1.0] * n,
        ),
        shapes=[],
        **some._asdict(),
    )


def _origin(pose: Array, axis: Array | None) -> LinkOrigin:
    quaternion = quaternion_from_matrix(pose[:3, :3]).tolist()
    turns = None if quaternion == [1.0, 0.0, 0.0, 0.0] else quaternion
    return LinkOrigin(xyz=pose[:3, 3].tolist(), quaternion=turns, axis=None if axis is None else axis.tolist())


def with_shapes(arm: Arm, rods: Mapping[int, list[Rod]]) -> Arm:
    """With collision shapes, given by link in the frame that the file has for it. Those of the last link end at the flange."""
    shapes: list[Capsule] = []
    flange = arm.chain.flange
    for k, own in sorted(rods.items()):
        for start, end, radius in own:
            back = np.zeros(3)
            if k == arm.n - 1 and flange is not None:
                out = matrix_from_quaternion(flange.quaternion or [1.0, 0.0, 0.0, 0.0])[:, 2]
                beyond = max(float(out @ (point - np.array(flange.xyz))) for point in (start, end)) + radius
                back = -max(0.0, beyond) * out
            shapes.append(
                Capsule(
                    link=k,
                    start=np.round(start + back, 4).tolist(),
                    end=np.round(end + back, 4).tolist(),
                    radius=math.ceil(radius * 1e4) / 1e4,
                )
            )
    return replace(arm, shapes=shapes)


def usual_name(source: SourceArm) -> str:
    """A name from that of the description: small letters, digits and hyphens."""
    return re.sub(r"[^a-z0-9]+", "-", source.name.lower()).strip("-")[:40] or "arm"
