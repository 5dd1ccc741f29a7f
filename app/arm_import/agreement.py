"""Whether MuJoCo, Pinocchio and the arm file that was written mean the same arm."""

import tempfile
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from app.arm_import.description.link_tree import ArmChain
from app.arm_import.description.robot_xml import Description
from app.arm_import.description.source_arm import MujocoReading
from app.files.bad_input import ABSENT, BadInput
from sim.arm.arm_file import Arm
from sim.arm.chain import Body, chain
from sim.arm.frames import transform
from sim.rigid_body.dynamics import Dynamics

Array = NDArray[np.float64]
Look = Callable[[Array], tuple[Array, Array, Array]]
"""Flange in the base (4, 4), gravity torques (n,) [N·m] and mass matrix (n, n) [kg·m²] at joint angles q (n,)."""

EQUAL = 1e-9
"""Difference that rounding may leave, relative to the largest value of its kind over all postures."""

KINDS = ("kinematics", "gravity", "mass matrix")


def pinocchio_reading(arm: Description, the_chain: ArmChain, text: str) -> Look:
    """The description as Pinocchio reads it. Raises BadInput: it cannot, or it finds other joints."""
    where = arm.files.file.name
    try:
        if arm.kind == "URDF":
            model = pin.buildModelFromXML(text)
        else:
            with tempfile.TemporaryDirectory() as folder:  # its parser of MJCF takes no text
                path = Path(folder) / "arm.xml"
                path.write_text(text, encoding="utf-8")
                model = pin.buildModelFromMJCF(str(path))
    except (ValueError, RuntimeError) as error:
        raise BadInput(where, "", ABSENT, f"Pinocchio cannot read it: {' '.join(str(error).split())[:300]}") from None
    found, wanted = list(model.names)[1:], [joint.name for joint in the_chain.joints]
    if sorted(found) != sorted(wanted):
        raise BadInput(where, "joints", ", ".join(found), f"Pinocchio drops or adds joints; MuJoCo reads {', '.join(wanted)}")
    if not model.existFrame(the_chain.flange):
        raise BadInput(where, "flange", the_chain.flange, "Pinocchio drops this frame: name a link")
    model.gravity = pin.Motion(np.array([0.0, 0.0, -9.81]), np.zeros(3))
    model.armature[:] = 0.0
    data, flange = model.createData(), model.getFrameId(the_chain.flange)
    places = np.array([model.joints[model.getJointId(name)].idx_v for name in wanted])
    if model.nq != model.nv:
        raise BadInput(where, "joints", model.nq, f"Pinocchio reads coordinates for {model.nv} joints that are no angles")

    def look(q: Array) -> tuple[Array, Array, Array]:
        own = np.zeros(model.nq)
        own[places] = q
        pin.framesForwardKinematics(model, data, own)
        pose = data.oMf[flange]
        mass = np.array(pin.crba(model, data, own))
        mass = np.triu(mass) + np.triu(mass, 1).T
        gravity = pin.computeGeneralizedGravity(model, data, own)
        return transform(pose.rotation, pose.translation), gravity[places], mass[np.ix_(places, places)]

    return look


def written_reading(arm: Arm, tool: Body) -> Look:
    """An arm file as the product's own controller reads it, with all that hangs beyond the flange."""
    rigid = chain(arm)
    model = Dynamics(rigid, rigid.links, tool, mounting=[0.0, 0.0, 0.0], elbow=arm.chain.elbow)

    def look(q: Array) -> tuple[Array, Array, Array]:
        p, R, _ = model.update(q)
        return transform(R, p), model.gravity(q), model.mass(q).copy()

    return look


def largest_differences(one: Look, other: Look, postures: Array) -> tuple[float, float, float]:
    """Largest differences over postures (m, n) of what `Look` gives, each relative to the largest value of its kind."""
    sizes, differences = np.zeros(3), np.zeros(3)
    for q in postures:
        for k, (a, b) in enumerate(zip(one(q), other(q), strict=True)):
            sizes[k] = max(sizes[k], np.abs(a).max())
            differences[k] = max(differences[k], np.abs(a - b).max())
    first, second, third = (differences / np.maximum(sizes, 1e-12)).tolist()
    return first, second, third


def drawn(ends: list[tuple[float, float]], number: int) -> Array:
    """Joint angles (number, n) within their ends, the same ones each time [rad]."""
    low, high = np.array(ends).T
    return np.random.default_rng(0).uniform(low, high, (number, len(ends)))


def check_parsers(arm: Description, reading: MujocoReading, other: Look, postures: Array) -> None:
    """Raise BadInput where MuJoCo and Pinocchio have read different arms, with what is known to lead to that."""
    found = largest_differences(reading.look, other, postures)
    for kind, difference in zip(KINDS, found, strict=True):
        if difference > EQUAL:
            allowed = f"MuJoCo and Pinocchio differ by {difference:.2g} of the largest value; {_suspects(arm)}"
            raise BadInput(arm.files.file.name, kind, ABSENT, allowed)


def _suspects(arm: Description) -> str:
    """What the two parsers are known to take differently, of what is in the file."""
    bare = [
        body.get("name", "") for body in arm.root.iter("body") if body.find("inertial") is None and body.find("geom") is not None
    ]
    if bare:
        return f"their masses come from shapes, give them an <inertial>: {', '.join(bare[:6])}"
    odd = sorted(
        {key for each in arm.root.findall("compiler") for key in each.attrib} - {"angle", "meshdir", "texturedir", "autolimits"}
    )
    return f"they may take these of <compiler> differently: {', '.join(odd)}" if odd else "nothing in the file is known for it"
