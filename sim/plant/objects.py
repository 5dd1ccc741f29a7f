"""World objects in MuJoCo, each with its true stiffness in N/m."""

from collections.abc import Sequence

import mujoco
import numpy as np

from sim.arm.frames import quaternion_from_matrix, rotation_from_rpy
from sim.arm.scenario import AnyObject, Moving, Plane, SnapFit, TwoFrictions

DEPTH = 0.02
"""Constraint impedance d of every contact. A small d makes the contact an explicit spring: its force is K·r within 2 % also in
a transient, measured from 1e3 to 2e5 N/m; d = 0.9 is right statically and far too soft in an impact."""

DAMPING_RATIO = 0.03  # of a contact against 1 kg: real surfaces ring little, and a perfect spring would ring for ever
RUB = 500.0
"""Friction of a plate of two frictions per speed of sliding, up to Coulomb's [N·s/m]: from some cm/s on the whole of it is there.
Without this it is the normal damping, 4 N·s/m on a soft plate, as it is on the other objects."""
SNAP_SLIP = 5e-5  # travel at which a snap-fit has let go [m]
SNAP_MASS = 0.2  # of the part that gives way [kg]
SKIN = 1e5  # stiffness of the arm's housings, where the tool touches them [N/m]
SKIN_FRICTION = 0.3
WRIST = 3
"""Joints before the flange whose links the tool never touches: it is mounted on them."""
HEAVY = 1e6  # mass of a moving object, that no arm pushes aside [kg]


def add_object(spec: mujoco.MjSpec, item: AnyObject) -> None:
    """Add the body and geom `object/<name>` of `item`."""
    turn = quaternion_from_matrix(rotation_from_rpy(item.rpy))
    body = spec.worldbody.add_body(name=f"object/{item.name}", pos=item.position, quat=turn)
    geom = body.add_geom(name=f"object/{item.name}", contype=0, conaffinity=0)
    if isinstance(item, Plane):
        geom.type = mujoco.mjtGeom.mjGEOM_PLANE
        geom.size = [0, 0, 0.05]
        return
    geom.type = mujoco.mjtGeom.mjGEOM_BOX
    geom.size = np.array(item.size) / 2.0
    if isinstance(item, SnapFit):
        geom.mass = SNAP_MASS
        slide = body.add_joint(name=f"snap/{item.name}", type=mujoco.mjtJoint.mjJNT_SLIDE, axis=[0, 0, -1])
        slide.limited = mujoco.mjtLimited.mjLIMITED_TRUE
        slide.range = [0.0, item.travel]
        slide.frictionloss = item.force
        # As default a stuck joint creeps by mm/s (facts 3.3); so it creeps by some µm/s.
        slide.solimp_friction = [0.9999, 0.9999, 1e-3, 0.5, 2]
        slide.solref_friction = [2.0 * spec.option.timestep, 1.0]
        slide.solref_limit = [0.001, 1.0]  # as stiff as the step allows: at the end of its travel it is a wall
        slide.solimp_limit = [0.99, 0.99, 1e-3, 0.5, 2]
        body.gravcomp = 1.0
    if isinstance(item, Moving):
        geom.mass = HEAVY
        body.gravcomp = 1.0
        for axis, name in zip(np.eye(3), "xyz", strict=True):
            body.add_joint(name=f"move/{item.name}/{name}", type=mujoco.mjtJoint.mjJNT_SLIDE, axis=axis)


def pair_geoms(spec: mujoco.MjSpec, first_link: str, world: Sequence[AnyObject]) -> None:
    """Pair every shape of the arm that can move with every object; nothing else ever collides."""
    fixed = ("foot", first_link)  # the first link only turns about its own axis: it comes near nothing that the foot does not
    shapes = [geom for geom in spec.geoms if geom.name.startswith("shape/") and geom.parent.name not in fixed]
    for item in world:
        for shape in shapes:
            _add_pair(spec, f"{shape.name} {item.name}", (shape.name, f"object/{item.name}"), item.friction)


def pair_own(spec: mujoco.MjSpec, links: Sequence[str]) -> None:
    """Pair the tool with the shapes of these links: the arm may touch itself (CD-2)."""
    for geom in [geom for geom in spec.geoms if geom.name.startswith("shape/") and geom.parent.name in links]:
        _add_pair(spec, f"itself {geom.name}", ("shape/tool", geom.name), SKIN_FRICTION)


def _add_pair(spec: mujoco.MjSpec, name: str, names: tuple[str, str], friction: float) -> None:
    pair = spec.add_pair(name=name, geomname1=names[0], geomname2=names[1])
    pair.condim = 3
    pair.friction = [friction, friction, 0.0, 0.0, 0.0]
    pair.solimp = [DEPTH, DEPTH, 1e-3, 0.5, 2]


def set_contact_stiffness(model: mujoco.MjModel, world: Sequence[AnyObject]) -> None:
    """Give each pair the stiffness of its object, for the inverse inertias that the compiled `model` holds.

    With impedance d and inverse weight A, solref = (-K·A·(1-d), -c·A·(1-d)) makes a spring of K [N/m] with a damper of c
    [N·s/m]: MuJoCo regularises by R = A(1-d)/d and aims at -(c·v + K·r)·R. To be called again when a payload changes A.
    """
    for k in range(model.npair):
        item = _object(model, k, world)
        stiffness = SKIN if item is None else item.stiffness
        bodies = model.geom_bodyid[[model.pair_geom1[k], model.pair_geom2[k]]]
        weight = model.body_invweight0[bodies, 0].sum()
        damping = 2.0 * DAMPING_RATIO * stiffness**0.5
        model.pair_solref[k] = -stiffness * weight * (1 - DEPTH), -damping * weight * (1 - DEPTH)
        if isinstance(item, TwoFrictions):
            model.pair_solreffriction[k] = 0.0, -RUB * weight * (1 - DEPTH)


def _object(model: mujoco.MjModel, pair: int, world: Sequence[AnyObject]) -> AnyObject | None:
    """The object of a pair; None for one of the arm with itself."""
    geoms = (int(model.pair_geom1[pair]), int(model.pair_geom2[pair]))  # the compiler orders them by type
    names = {model.geom(geom).name for geom in geoms}
    return next((item for item in world if f"object/{item.name}" in names), None)
