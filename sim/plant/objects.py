"""World objects in MuJoCo, each with its true stiffness in N/m."""

from collections.abc import Sequence

import mujoco
import numpy as np

from sim.arm.frames import quaternion_from_matrix, rotation_from_rpy
from sim.arm.scenario import AnyObject, AnyPart, FreeBox, FreeCylinder, Moving, Plane, SnapFit, TwoFrictions

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
LIES = (0.004, 1.0)
"""Time constant [s] and damping ratio of what lies on something: it sinks in by some µm, and does not ring."""

FIRM = (0.95, 0.99, 1e-3, 0.5, 2.0)  # constraint impedance of what lies on something
NOWHERE = ("nowhere/0", "nowhere/1")
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
    if isinstance(item, FreeBox | FreeCylinder):
        _shape(geom, item)
        geom.mass = item.mass
        body.add_freejoint(name=f"free/{item.name}")
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


def _shape(geom: mujoco.MjsGeom, part: AnyPart) -> None:
    if isinstance(part, FreeBox):
        geom.type = mujoco.mjtGeom.mjGEOM_BOX
        geom.size = np.array(part.size) / 2.0
    else:
        geom.type = mujoco.mjtGeom.mjGEOM_CYLINDER
        geom.size = [part.radius, part.height / 2.0, 0.0]


def parts_of(world: Sequence[AnyObject]) -> list[AnyPart]:
    """The objects that lie about freely."""
    return [item for item in world if isinstance(item, FreeBox | FreeCylinder)]


def add_nowhere(spec: mujoco.MjSpec) -> None:
    """Add two balls that never meet anything: what pairs of shapes are pointed at that are out of use."""
    for k, name in enumerate(NOWHERE):
        spec.worldbody.add_geom(
            name=name,
            type=mujoco.mjtGeom.mjGEOM_SPHERE,
            size=[0.001, 0.0, 0.0],
            pos=[0.0, 0.0, 1000.0 * (k + 1)],
            contype=0,
            conaffinity=0,
        )


def add_carried(payload: mujoco.MjsBody, part: AnyPart) -> None:
    """Add the geom `carried/<name>` to the payload: the part's shape while it is held (sim.plant.held_part)."""
    geom = payload.add_geom(name=f"carried/{part.name}", contype=0, conaffinity=0)
    _shape(geom, part)
    geom.mass = 0


def pair_parts(spec: mujoco.MjSpec, world: Sequence[AnyObject]) -> None:
    """Pair free parts, as they lie and as they are carried, with everything else in the world."""
    parts = parts_of(world)
    for item in world:
        for part in parts:
            if part is item:
                continue
            if not (item in parts and world.index(item) < world.index(part)):  # two free parts once
                pair = _add_pair(
                    spec,
                    f"object/{part.name} {item.name}",
                    (f"object/{part.name}", f"object/{item.name}"),
                    min(part.friction, item.friction),
                )
                pair.solref, pair.solimp = LIES, FIRM
            carried = (f"carried/{part.name}", f"object/{item.name}")
            _add_pair(spec, f"carried/{part.name} {item.name}", carried, min(part.friction, item.friction))


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


def _add_pair(spec: mujoco.MjSpec, name: str, names: tuple[str, str], friction: float) -> mujoco.MjsPair:
    pair = spec.add_pair(name=name, geomname1=names[0], geomname2=names[1])
    pair.condim = 3
    pair.friction = [friction, friction, 0.0, 0.0, 0.0]
    pair.solimp = [DEPTH, DEPTH, 1e-3, 0.5, 2]
    return pair


def set_contact_stiffness(model: mujoco.MjModel, world: Sequence[AnyObject]) -> None:
    """Give each pair the stiffness of its object, for the inverse inertias that the compiled `model` holds.

    With impedance d and inverse weight A, solref = (-K·A·(1-d), -c·A·(1-d)) makes a spring of K [N/m] with a damper of c
    [N·s/m]: MuJoCo regularises by R = A(1-d)/d and aims at -(c·v + K·r)·R. To be called again when a payload changes A.
    """
    for k in range(model.npair):
        if model.pair_solimp[k, 0] != DEPTH:
            continue  # of a part and what it lies on
        item = _object(model, k, world)
        stiffness = SKIN if item is None else item.stiffness
        bodies = model.geom_bodyid[[model.pair_geom1[k], model.pair_geom2[k]]]
        weight = model.body_invweight0[bodies, 0].sum()
        if weight == 0.0:
            continue  # out of use (sim.plant.held_part)
        damping = 2.0 * DAMPING_RATIO * stiffness**0.5
        model.pair_solref[k] = -stiffness * weight * (1 - DEPTH), -damping * weight * (1 - DEPTH)
        if isinstance(item, TwoFrictions):
            model.pair_solreffriction[k] = 0.0, -RUB * weight * (1 - DEPTH)


def _object(model: mujoco.MjModel, pair: int, world: Sequence[AnyObject]) -> AnyObject | None:
    """The object of a pair; None for one of the arm with itself."""
    geoms = (int(model.pair_geom1[pair]), int(model.pair_geom2[pair]))  # the compiler orders them by type
    names = {model.geom(geom).name for geom in geoms}
    return next((item for item in world if f"object/{item.name}" in names), None)
