"""The MuJoCo model of an arm in its world, built from the arm's file and the scenario."""

import copy
import logging
import threading
from dataclasses import dataclass

import msgspec
import mujoco
import numpy as np

from sim.arm.arm_file import Arm, ForceTorque
from sim.arm.chain import Body, chain, load_body, plate_body, tool_body
from sim.arm.frames import hulls, quaternion_from_matrix, rotation_from_rpy
from sim.arm.scenario import Fingers, Load, Scenario
from sim.gripping.finger_shape import FINGERS, finger_poses, finger_size, palm_length
from sim.plant.joint_friction import Friction
from sim.plant.objects import WRIST, add_carried, add_nowhere, add_object, pair_geoms, pair_own, pair_parts, parts_of

SUBSTEPS = 8
"""Physics steps a control tick: 0.25 ms. An explicit integrator needs less than 2 / w for the fastest series spring, w being its
frequency [rad/s]: 0.71 ms with a UR5e's wrist 3 and a light tool, as measured."""

PASSIVE = 16  # mjINPUT_NONE: an actuator without an input
WEIGHTLESS = 1e-9  # [kg] of the body that carries rotors: MuJoCo takes no zero
STRIBECK = 0.1  # [rad/s]; without effect, for breakaway and Coulomb torque are set alike, once a tick
BRISTLE_RATIO = 0.7
"""Damping of a stuck rotor on its bristles: without any, a stuck joint rings for seconds and creeps."""
SENSORS = ("force", "torque", "accelerometer_flange", "gyro_flange", "accelerometer_tool", "gyro_tool")
"""What MuJoCo measures at the flange, three values each. Forces: what the flange exerts on what it carries, in F."""

KEPT = 8
"""Compiled models that a process keeps: many sessions differ only in their seed."""

_compiled: dict[bytes, mujoco.MjModel] = {}
_keeping = threading.Lock()  # of what is kept: a page makes the next simulation ready while another runs

_TYPES = {
    "force": mujoco.mjtSensor.mjSENS_FORCE,
    "torque": mujoco.mjtSensor.mjSENS_TORQUE,
    "accelerometer": mujoco.mjtSensor.mjSENS_ACCELEROMETER,
    "gyro": mujoco.mjtSensor.mjSENS_GYRO,
}


@dataclass(frozen=True, slots=True)
class Step:
    """The physics step."""

    substeps: int = SUBSTEPS
    tick: float = 0.002  # [s]

    @property
    def length(self) -> float:
        """Of one physics step [s]."""
        return self.tick / self.substeps


def _log(text: str) -> None:
    """What MuJoCo warns of goes into the log: it would write a file of its own into the working folder."""
    logging.getLogger(__name__).debug(text)


mujoco.set_mju_user_warning(_log)


def model_of(arm: Arm, scenario: Scenario, step: Step) -> mujoco.MjModel:
    """The model that `build` describes, compiled; one that may be changed. The last `KEPT` are compiled once in a process.

    Raises:
        ValueError: MuJoCo cannot compile it.
    """
    # What the model does not depend on is left out of its name, and nothing else: a new field makes other models.
    alike = msgspec.structs.replace(scenario, seed=0, posture=None, payload_configured=Load(mass=0.0), tools=[], walls=[])
    name = msgspec.msgpack.encode((arm, alike, step), enc_hook=float)  # numbers of numpy are floats, too
    with _keeping:
        kept = _compiled.get(name)
    model = kept or build(arm, scenario, step).compile()
    with _keeping:
        _compiled.pop(name, None)
        _compiled[name] = model
        if len(_compiled) > KEPT:
            del _compiled[next(iter(_compiled))]  # the one that was not asked for the longest
    return copy.copy(model)


def build(arm: Arm, scenario: Scenario, step: Step) -> mujoco.MjSpec:
    """The model of `arm` as `scenario` puts it up.

    A joint is two: the rotor `theta/<joint>`, alone in the world with the reflected inertia, and the hinge of the link
    `q/<joint>` in the chain; a fixed tendon theta - q is the transmission (Spong's model: the same equations as a rotor in
    the chain, with a mass matrix of two blocks). A rotor is an inertia and an angle, which MuJoCo gets as the armature and
    the coordinate of a slide: three of them share a massless body, as their axes are orthogonal, and nothing turns. Beyond
    the last link sits the flange sensor: three stiff slides carry the body `flange`, on which tool and payload are welded.

    Args:
        arm: the arm's numbers.
        scenario: mounting, tool, payload and world.
        step: the physics step.
    """
    spec = mujoco.MjSpec()
    spec.compiler.degree = False
    spec.option.timestep = step.length
    spec.option.integrator = mujoco.mjtIntegrator.mjINT_IMPLICITFAST
    spec.option.cone = mujoco.mjtCone.mjCONE_ELLIPTIC
    # MuJoCo would put a state that is not finite back to its beginning, in silence.
    spec.option.disableflags |= mujoco.mjtDisableBit.mjDSBL_AUTORESET
    rigid, friction = chain(arm), Friction(arm)

    base = spec.worldbody.add_body(name="foot", quat=quaternion_from_matrix(rotation_from_rpy(scenario.mounting)))
    carriers = [spec.worldbody.add_body(name=f"rotors/{k}") for k in range(0, arm.n, 3)]
    for carrier in carriers:
        _set_body(carrier, Body(WEIGHTLESS, np.zeros(3), np.eye(3)))
    parent = base
    for i, name in enumerate(arm.chain.joints):
        link = parent.add_body(name=name, pos=rigid.p[i], quat=quaternion_from_matrix(rigid.R[i]))
        _set_body(link, rigid.links[i])
        link.add_joint(name=f"q/{name}", type=mujoco.mjtJoint.mjJNT_HINGE, axis=[0, 0, 1])
        _add_rotor(carriers[i // 3], arm, i)
        _add_transmission(spec, arm, i)
        _add_friction(spec, arm, friction, i)
        parent = link
    parent.add_site(name="flange", pos=rigid.p_flange, quat=quaternion_from_matrix(rigid.R_flange))
    flange = parent.add_body(name="flange", pos=rigid.p_flange, quat=quaternion_from_matrix(rigid.R_flange))
    plate = plate_body(arm)
    _set_body(flange, plate)
    sensor = arm.sensors.force_torque
    if sensor is not None:
        _add_sensor_springs(flange, sensor, scenario.soft_sensor)
    flange.add_site(name="tool")
    tool = flange.add_body(name="tool")
    _set_body(tool, tool_body(scenario.tool))
    payload = flange.add_body(name="payload")
    _set_body(payload, load_body(scenario.payload_true))
    for name, site in (("flange", "flange"), ("tool", "tool")):
        for kind in ("accelerometer", "gyro"):
            _add_sensor(spec, f"{kind}_{name}", _TYPES[kind], site=site, step=step)
    for kind in ("force", "torque"):
        _add_sensor(spec, kind, _TYPES[kind], site="tool", step=step)

    if scenario.world or scenario.self_contact:
        _add_shapes(spec, arm, scenario)
    for item in scenario.world:
        add_object(spec, item)
    if parts_of(scenario.world):
        add_nowhere(spec)
    for part in parts_of(scenario.world):
        add_carried(payload, part)
    pair_geoms(spec, arm.chain.joints[0], scenario.world)
    pair_parts(spec, scenario.world)
    if scenario.self_contact:
        pair_own(spec, ("foot", *arm.chain.joints[:-WRIST]))
    return spec


def _set_body(body: mujoco.MjsBody, values: Body) -> None:
    body.explicitinertial = True
    body.mass = values.mass
    body.ipos = values.com
    body.fullinertia = values.inertia[[0, 1, 2, 0, 0, 1], [0, 1, 2, 1, 2, 2]] if values.mass else [np.nan] * 6
    if not values.mass:
        body.inertia = [0.0, 0.0, 0.0]


def _add_rotor(carrier: mujoco.MjsBody, arm: Arm, i: int) -> None:
    name, axis = f"theta/{arm.chain.joints[i]}", np.eye(3)[i % 3]
    carrier.add_joint(name=name, type=mujoco.mjtJoint.mjJNT_SLIDE, axis=axis, armature=arm.motors.rotor_inertia[i])


def _add_transmission(spec: mujoco.MjSpec, arm: Arm, i: int) -> None:
    name, values = arm.chain.joints[i], arm.transmissions
    main = spec.add_tendon(name=f"spring/{name}", springlength=[0, 0])
    main.stiffness = [values.stiffness[i], 0.0, values.stiffening[i]]
    main.damping[0] = values.damping[i]
    slip = spec.add_tendon(name=f"hysteresis/{name}", springlength=[0, 0], springyield=values.hysteresis_yield[i])
    slip.stiffness[0] = values.hysteresis_stiffness[i]
    for tendon in (main, slip):
        tendon.wrap_joint(f"theta/{name}", 1)
        tendon.wrap_joint(f"q/{name}", -1)


def _add_friction(spec: mujoco.MjSpec, arm: Arm, friction: Friction, i: int) -> None:
    name = arm.chain.joints[i]
    sides = (
        (f"theta/{name}", friction.breakaway[i], arm.motors.ripple[i], 0.0, BRISTLE_RATIO),
        (f"q/{name}", friction.output_coulomb[i], 0.0, friction.output_viscous[i], 0.0),
    )
    bristle = arm.frictions.presliding[i] / arm.frictions.breakaway[i]
    for joint, coulomb, ripple, viscous, ratio in sides:
        stiffness = bristle * coulomb
        actuator = spec.add_actuator(name=f"friction/{joint}", target=joint, trntype=mujoco.mjtTrn.mjTRN_JOINT)
        actuator.set_to_dcmotor(
            [0, 0],
            1.0,
            cogging=[ripple, 2.0 * arm.motors.gear[i], 0.0],
            lugre=[stiffness, 2.0 * ratio * (stiffness * arm.motors.rotor_inertia[i]) ** 0.5, coulomb, coulomb, STRIBECK],
            ctrlspec=PASSIVE,
        )
        actuator.damping[0] = viscous


def _add_sensor_springs(flange: mujoco.MjsBody, sensor: ForceTorque, soft: bool) -> None:
    stiffness = sensor.stiffness_soft if soft else sensor.stiffness
    # Critical damping is taken with 1 kg beyond the sensor: a light tool.
    damping = 2.0 * sensor.damping_ratio * stiffness**0.5
    for axis, name in zip(np.eye(3), "xyz", strict=True):
        slide = flange.add_joint(name=f"sensor/{name}", type=mujoco.mjtJoint.mjJNT_SLIDE, axis=axis)
        slide.stiffness[0] = stiffness
        slide.damping[0] = damping


def _add_sensor(spec: mujoco.MjSpec, name: str, kind: mujoco.mjtSensor, *, site: str, step: Step) -> None:
    sensor = spec.add_sensor(name=name, type=kind, objtype=mujoco.mjtObj.mjOBJ_SITE, objname=site)
    sensor.nsample = step.substeps  # MuJoCo keeps every substep of a tick: the tick's mean costs no Python in between


def _add_shapes(spec: mujoco.MjSpec, arm: Arm, scenario: Scenario) -> None:
    """Collision shapes, only ever used in explicit pairs with world objects."""
    for k, shape in enumerate(hulls(arm)):
        body = spec.body("foot" if shape.link < 0 else arm.chain.joints[shape.link])
        geom = body.add_geom(name=f"shape/{k}", type=mujoco.mjtGeom.mjGEOM_CAPSULE, contype=0, conaffinity=0)
        if shape.start == shape.end:  # MuJoCo knows no capsule of that length
            geom.type, geom.pos = mujoco.mjtGeom.mjGEOM_SPHERE, shape.start
        else:
            geom.fromto = [*shape.start, *shape.end]
        geom.size[0] = shape.radius
        geom.mass = 0
    tool = scenario.tool
    length = 0.0 if tool is None else palm_length(tool)
    if tool is not None and length > 2 * tool.radius:
        geom = spec.body("flange").add_geom(name="shape/tool", type=mujoco.mjtGeom.mjGEOM_CAPSULE, contype=0, conaffinity=0)
        geom.fromto = [0, 0, tool.radius, 0, 0, length - tool.radius]
        geom.size[0] = tool.radius
    else:
        geom = spec.body("flange").add_geom(name="shape/tool", type=mujoco.mjtGeom.mjGEOM_SPHERE, contype=0, conaffinity=0)
        geom.pos = [0, 0, -0.0315]
        geom.size[0] = 0.0315
    geom.mass = 0
    if tool is not None and isinstance(tool.gripper, Fingers):
        for name, pose in zip(FINGERS, finger_poses(tool, tool.gripper, tool.gripper.stroke), strict=True):
            geom = spec.body("flange").add_geom(name=name, type=mujoco.mjtGeom.mjGEOM_BOX, contype=0, conaffinity=0)
            geom.pos, geom.quat = pose[:3], pose[3:]
            geom.size = finger_size(tool.gripper) / 2.0
            geom.mass = 0
