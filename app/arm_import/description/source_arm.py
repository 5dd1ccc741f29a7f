"""An arm as its description has it, read by MuJoCo: chain, bodies, limits."""

import math
from dataclasses import dataclass
from itertools import pairwise
from xml.etree.ElementTree import Element

import mujoco
import numpy as np
from numpy.typing import NDArray

from app.arm_import.description.link_tree import ArmChain, TreeJoint, parsed_spec
from app.arm_import.description.plain_description import ROOT, plain_text, urdf_range
from app.arm_import.description.robot_xml import Description
from app.files.bad_input import ABSENT, BadInput
from sim.arm.chain import NOTHING, Body
from sim.arm.frames import matrix_from_quaternion, transform

Array = NDArray[np.float64]

LONGEST_LINK = 5.0
"""From one joint to the next [m]; what is longer is in millimetres."""


FARTHEST_END = 100.0
"""Of a joint's range, as in an arm file [rad]; what is farther is in degrees."""


@dataclass(frozen=True, slots=True)
class SourceJoint:
    """A joint of the chain; what the file does not say is None."""

    name: str
    axis: Array  # (3,) in its link's frame
    ends: tuple[float, float] | None  # smallest and largest angle [rad]
    speed: float | None  # [rad/s]
    torque: float | None  # [N·m]
    rotor: float | None  # inertia at the output [kg·m²]


@dataclass(frozen=True, slots=True)
class SourceArm:
    """Lists run base to flange. A link's frame is that of its description, put to its joint; all at q = 0."""

    name: str
    joints: list[SourceJoint]
    placements: Array  # (n + 1, 4, 4) of each link in the one before, of the flange in the last
    links: list[Body]  # in their frames
    tool: Body  # what hangs beyond the flange, in the flange's frame
    home: Array | None  # (n,) of a keyframe [rad]
    frames: dict[str, tuple[int, Array]]  # of each link of the description: index of the arm's link, -1 the base; pose in it


class MujocoReading:
    """A description as MuJoCo reads it. Raises BadInput: it cannot."""

    def __init__(self, arm: Description, chain: ArmChain) -> None:
        where = arm.files.file.name
        self.text = plain_text(arm, chain)
        try:
            self.model = mujoco.MjSpec.from_string(self.text).compile()
        except ValueError as error:
            raise BadInput(where, "", ABSENT, f"MuJoCo cannot read it: {' '.join(str(error).split())}") from None
        model = self.model
        model.opt.gravity[:] = [0.0, 0.0, -9.81]
        model.dof_armature[:] = 0.0
        model.body_gravcomp[:] = 0.0
        model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_CONTACT | mujoco.mjtDisableBit.mjDSBL_CONSTRAINT
        self.data = mujoco.MjData(model)
        self.at = np.array([model.joint(joint.name).qposadr[0] for joint in chain.joints])
        self.dofs = np.array([model.joint(joint.name).dofadr[0] for joint in chain.joints])
        self._flange, self._site = chain.flange, chain.flange not in chain.tree.parents

    def flange(self) -> Array:
        """Pose of the flange in the base (4, 4), after `look`."""
        at = self.data.site(self._flange) if self._site else self.data.body(self._flange)
        return transform(at.xmat.reshape(3, 3), at.xpos)

    def look(self, q: Array) -> tuple[Array, Array, Array]:
        """Flange (4, 4), gravity torques (n,) [N·m] and mass matrix (n, n) [kg·m²] at joint angles q (n,)."""
        self.data.qpos[self.at] = q
        mujoco.mj_forward(self.model, self.data)
        mass = np.zeros((self.model.nv, self.model.nv))
        mujoco.mj_fullM(self.model, self.data, mass)
        return self.flange(), self.data.qfrc_bias[self.dofs].copy(), mass[np.ix_(self.dofs, self.dofs)]


def source_arm(arm: Description, chain: ArmChain, reading: MujocoReading) -> SourceArm:
    """The arm that MuJoCo has read.

    Raises:
        BadInput: its numbers are none of an arm: a link without mass, lengths in millimetres.
    """
    model, data, where = reading.model, reading.data, arm.files.file.name
    reading.look(np.zeros(len(chain.joints)))
    spec = parsed_spec(arm) if arm.kind == "MJCF" else None
    joints = [_joint(joint, model, spec) for joint in chain.joints]
    for joint in joints:
        low, high = joint.ends or (-1.0, 1.0)
        if not -FARTHEST_END <= low < high <= FARTHEST_END:
            allowed = f"expected the smallest angle, then the largest, within ±{FARTHEST_END:g} rad"
            raise BadInput(where, f"limits of {joint.name}", f"{low:g} .. {high:g}", allowed)
    frames = [np.eye(4)]
    for joint in chain.joints:
        own = model.joint(joint.name)
        body = int(own.bodyid[0])
        R = data.xmat[body].reshape(3, 3)
        frames.append(transform(R, data.xpos[body] + R @ own.pos))
    frames.append(reading.flange())
    placements: Array = np.array([np.linalg.solve(before, after) for before, after in pairwise(frames)], dtype=np.float64)
    _check_lengths(placements, [*(joint.name for joint in joints), "flange"], where)
    links, tool, places = _bodies(chain, reading, frames)
    for joint, link in zip(joints, links, strict=True):
        if link.mass < 1e-3 or not np.linalg.eigvalsh(link.inertia).min() > 0.0:
            raise BadInput(where, f"link of {joint.name}", f"{link.mass:g} kg", "expected a mass and an inertia of what it moves")
    name = arm.root.get("name" if arm.kind == "URDF" else "model") or arm.files.file.stem
    return SourceArm(name, joints, placements, links, tool, None if spec is None else _home(arm, chain, spec), places)


def _check_lengths(placements: Array, names: list[str], where: str) -> None:
    lengths = np.linalg.norm(placements[:, :3, 3], axis=1)
    for name, length in zip(names, lengths, strict=True):
        if not length <= LONGEST_LINK:
            allowed = f"expected metres, and less than {LONGEST_LINK:g} from one joint to the next; is it in millimetres?"
            raise BadInput(where, f"origin of {name}", f"{length:g} m", allowed)
    if lengths.sum() < 0.05:
        raise BadInput(where, "chain", f"{lengths.sum():g} m", "expected an arm of at least 5 cm, in metres")


def _bodies(
    chain: ArmChain, reading: MujocoReading, frames: list[Array]
) -> tuple[list[Body], Body, dict[str, tuple[int, Array]]]:
    """The links in their frames, the tool in the flange's, and where each body of the description is."""
    model, data, tree = reading.model, reading.data, chain.tree
    links, tool = [NOTHING] * len(chain.joints), NOTHING
    places: dict[str, tuple[int, Array]] = {tree.root: (-1, np.eye(4))}
    index = {link: k for k, link in enumerate(chain.links)}
    for body in range(1, model.nbody):
        name = model.body(body).name
        if name in chain.aside or name == ROOT:
            continue
        on = name
        while on not in index and on != tree.root:
            on = tree.parents[on]
        k = index.get(on, -1)
        beyond = name in chain.beyond
        holder = np.linalg.inv(frames[-1] if beyond else frames[k + 1])
        pose = holder @ transform(data.xmat[body].reshape(3, 3), data.xpos[body])
        places[name] = len(chain.joints) if beyond else k, pose
        mass = float(model.body_mass[body])
        if k < 0 or mass == 0.0:
            continue
        R = pose[:3, :3] @ matrix_from_quaternion(model.body_iquat[body])
        com = (pose @ [*model.body_ipos[body], 1.0])[:3]
        piece = Body(mass, com, R @ np.diag(model.body_inertia[body]) @ R.T)
        if beyond:
            tool += piece
        else:
            links[k] += piece
    return links, tool, places


def _joint(of_chain: TreeJoint, model: mujoco.MjModel, spec: mujoco.MjSpec | None) -> SourceJoint:
    """A joint of the chain; `spec` of MJCF, None for URDF."""
    own = model.joint(of_chain.name)
    axis, element = np.array(own.axis), of_chain.element
    if spec is None:
        limit = element.find("limit")
        said = {} if limit is None else limit.attrib
        torque, speed = (_positive(said.get(key)) for key in ("effort", "velocity"))
        return SourceJoint(of_chain.name, axis, urdf_range(element), speed, torque, None)
    joint = spec.joint(of_chain.name)
    ends = (float(own.range[0]), float(own.range[1])) if model.jnt_limited[own.id] else None
    rotor = _positive(joint.armature)
    return SourceJoint(joint.name, axis, ends, None, _mjcf_torque(spec, joint), rotor)


def _positive(value: object) -> float | None:
    try:
        number = float(value)  # type: ignore[arg-type]
    except (TypeError, ValueError):
        return None
    return number if math.isfinite(number) and number > 0.0 else None


def _mjcf_torque(spec: mujoco.MjSpec, joint: mujoco.MjsJoint) -> float | None:
    """What a joint can bear: of its range of actuator forces and of its actuators' the smallest that is given."""
    ranges = [joint.actfrcrange] if joint.actfrcrange[0] < joint.actfrcrange[1] else []
    for actuator in spec.actuators:
        if actuator.trntype in (mujoco.mjtTrn.mjTRN_JOINT, mujoco.mjtTrn.mjTRN_JOINTINPARENT) and actuator.target == joint.name:
            gear = abs(float(actuator.gear[0]))
            if actuator.forcerange[0] < actuator.forcerange[1]:
                ranges.append(gear * np.array(actuator.forcerange))
            elif _is_motor(actuator) and actuator.ctrlrange[0] < actuator.ctrlrange[1]:
                ranges.append(gear * float(actuator.gainprm[0]) * np.array(actuator.ctrlrange))
    return _positive(min(min(-float(low), float(high)) for low, high in ranges)) if ranges else None


def _is_motor(actuator: mujoco.MjsActuator) -> bool:
    return actuator.gaintype == mujoco.mjtGain.mjGAIN_FIXED and actuator.biastype == mujoco.mjtBias.mjBIAS_NONE


def _home(arm: Description, chain: ArmChain, spec: mujoco.MjSpec) -> Array | None:
    """The joint angles of a keyframe: of that called home, else of the first that has the arm in it."""
    keys = [key for section in arm.root.findall("keyframe") for key in section.findall("key") if key.get("qpos")]
    keys.sort(key=lambda key: key.get("name") != "home")
    if not keys:
        return None
    where = _qpos_places(arm, spec)
    values = [float(word) for word in keys[0].get("qpos", "").split()]
    places = [where.get(joint.name, len(values)) for joint in chain.joints]
    return np.array([values[place] for place in places]) if max(places) < len(values) else None


def _qpos_places(arm: Description, spec: mujoco.MjSpec) -> dict[str, int]:
    """Where each joint of MJCF has its first number in qpos: joints in the order of their bodies."""
    sizes = {"FREE": 7, "BALL": 4}
    types = {joint.name: str(joint.type).rpartition("mjJNT_")[2] for joint in spec.joints}
    found: dict[str, int] = {}
    place = 0

    def count(element: Element) -> None:
        nonlocal place
        for child in element:
            if child.tag in ("joint", "freejoint"):
                found[child.get("name", "")] = place
                place += 7 if child.tag == "freejoint" else sizes.get(types.get(child.get("name", ""), ""), 1)
            elif child.tag in ("body", "frame"):
                count(child)

    for world in arm.root.findall("worldbody"):
        count(world)
    return found
