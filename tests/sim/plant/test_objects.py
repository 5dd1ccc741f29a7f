"""World objects: true stiffness in N/m, impacts, friction, snap, motion, and the signs of force and acceleration."""

import mujoco
import numpy as np
import pytest
from msgspec.structs import replace

from sim.arm.arm_file import Capsule
from sim.arm.chain import Body, chain, plate_body, tool_body
from sim.arm.scenario import AnyObject, BoxObject, Moving, Pad, Plane, Scenario, SnapFit, ToolModel, TwoFrictions
from sim.plant.model import Step
from sim.plant.objects import DAMPING_RATIO, DEPTH, SKIN
from sim.plant.touch import Push
from sim.plant.true_arm import Plant
from sim.rigid_body.dynamics import Dynamics
from tests.sim.arms import UR5E

TIP = 0.25  # length of the probe [m]: so long that nothing but its end ever touches
PROBE = ToolModel(name="probe", mass=0.3, com=[0.0, 0.0, 0.1], tcp=[0.0, 0.0, TIP], length=TIP, radius=0.02)
SIZE = [0.4, 0.4, 0.3]
LOW = [0.0, -0.6, 1.5, -2.47, -1.57, 0.0]  # the probe points down, its end is below the robot's foot


def tip_of_home() -> np.ndarray:
    """Where the probe's end is in posture LOW, in W; the probe points down there."""
    plant = Plant(UR5E, Scenario(posture=LOW, tool=PROBE))
    flange = plant.poses()[-1]
    R = plant.data.xmat[plant.model.body("flange").id].reshape(3, 3)
    assert R[2, 2] < -0.99, "the flange points at the floor"
    return flange[:3] + TIP * R[:, 2]


def below(gap: float, kind: type, **values: object) -> AnyObject:
    """An object whose top is `gap` below the probe's end."""
    tip = tip_of_home()
    top = [tip[0], tip[1], tip[2] - gap]
    if kind is Plane:
        return Plane(name="thing", position=top, **values)
    return kind(name="thing", position=[top[0], top[1], top[2] - SIZE[2] / 2], size=SIZE, **values)


def normal_contact(plant: Plant) -> tuple[float, float]:
    """True normal force [N] and penetration [m]; zeros without contact."""
    force, depth, six = 0.0, 0.0, np.empty(6)
    for k in range(plant.data.ncon):
        mujoco.mj_contactForce(plant.model, plant.data, k, six)
        force += six[0]
        depth = max(depth, -plant.data.contact[k].dist)
    return force, depth


def pressed(item: AnyObject, forces: tuple[float, ...]) -> list[tuple[float, float]]:
    """(force, penetration) once the contact bears each of `forces`, the probe driven down ever deeper by stiff motors."""
    plant = Plant(UR5E, Scenario(posture=LOW, tool=PROBE, world=[item]))
    rigid, rotor = chain(UR5E), np.array(UR5E.motors.rotor_inertia)
    dynamics = Dynamics(rigid, rigid.links, plate_body(UR5E) + tool_body(PROBE), mounting=[0.0] * 3, elbow=2)
    target, force, found = plant.theta.copy(), 0.0, []
    for wanted in forces:
        for _ in range(1500):
            jacobian = dynamics.update(plant.q)[2]
            rate = np.clip((wanted - force) * 4.0 / min(item.stiffness, 2e4), -0.1, 0.1)  # the arm itself is a spring
            target += 0.002 * np.linalg.lstsq(jacobian, [0.0, 0.0, -rate, 0.0, 0.0, 0.0], rcond=None)[0]
            plant.advance(dynamics.gravity(plant.q) + rotor * (2e4 * (target - plant.theta) - 200.0 * plant.theta_d))
            force, depth = normal_contact(plant)
            if abs(force - wanted) < 0.02 * wanted and np.abs(plant.qd).max() < 1e-3:
                break
        found.append((force, depth))
    return found


OBJECTS = [
    (Plane, {"stiffness": 2e5}),
    (BoxObject, {"stiffness": 2e5}),
    (BoxObject, {"stiffness": 1e4}),
    (Pad, {}),
    (TwoFrictions, {"stiffness": 5e4}),
    (SnapFit, {"stiffness": 1e5, "force": 30.0}),
    (Moving, {"stiffness": 1e5, "amplitude": [0.0, 0.0, 0.0]}),
]


@pytest.mark.parametrize(("kind", "values"), OBJECTS, ids=lambda value: getattr(value, "__name__", ""))
def test_secant_stiffness_is_the_files_value(kind: type, values: dict) -> None:
    item = below(0.0002, kind, **values)
    for wanted, (force, depth) in zip((5.0, 20.0, 100.0), pressed(item, (5.0, 20.0, 100.0)), strict=True):
        assert force == pytest.approx(wanted, rel=0.1), "the press must reach the force"
        assert force / depth == pytest.approx(item.stiffness, rel=0.05), f"at {wanted} N"


def impact(stiffness: float, explicit: bool, substeps: int = 8) -> np.ndarray:
    """Contact force a physics step [N] over 5 ms from onset, the flange coming down at 0.25 m/s.

    With `explicit` MuJoCo's contact is off and a penalty spring, written out here, acts on the probe's end instead.
    """
    item = below(-1e-9, Plane, stiffness=stiffness)
    step = Step(substeps)
    plant = Plant(UR5E, Scenario(posture=LOW, tool=PROBE, world=[item]), step)
    model, data = plant.model, plant.data
    dofs = np.array([model.joint(f"q/{name}").dofadr[0] for name in UR5E.chain.joints])
    thetas = np.array([model.joint(f"theta/{name}").dofadr[0] for name in UR5E.chain.joints])
    rigid = chain(UR5E)
    dynamics = Dynamics(rigid, rigid.links, plate_body(UR5E) + tool_body(PROBE), mounting=[0.0] * 3, elbow=2)
    jacobian = dynamics.update(plant.q)[2]
    speed = np.linalg.lstsq(jacobian, [0.0, 0.0, -0.25, 0.0, 0.0, 0.0], rcond=None)[0]
    data.qvel[dofs] = data.qvel[thetas] = speed
    data.qfrc_applied[thetas] = data.qfrc_bias[dofs]
    if explicit:
        model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_CONTACT
    body, surface = model.body("flange").id, item.position[2]
    forces = []
    for _ in range(round(0.005 / step.length)):
        if explicit:
            mujoco.mj_kinematics(model, data)
            mujoco.mj_comPos(model, data)
            mujoco.mj_comVel(model, data)
            point = data.xpos[body] + data.xmat[body].reshape(3, 3) @ [0.0, 0.0, TIP]
            depth = max(0.0, surface - point[2])
            sink = -plant.hands.velocity(body, point)[2]
            force = stiffness * depth + 2.0 * DAMPING_RATIO * stiffness**0.5 * sink if depth > 0.0 else 0.0
            data.xfrc_applied[body, 2] = force
            data.xfrc_applied[body, 3:] = np.cross(point - data.xipos[body], [0.0, 0.0, force])
        mujoco.mj_step(model, data)
        forces.append(force if explicit else normal_contact(plant)[0])
    return np.array(forces)


@pytest.mark.parametrize("stiffness", [2e5, 1e4, 1e3])
def test_first_5_ms_of_an_impact_are_those_of_a_penalty_spring(stiffness: float) -> None:
    real, reference = impact(stiffness, explicit=False), impact(stiffness, explicit=True)
    assert reference.max() > 0.9 * stiffness * 0.25 * 0.0025, "a real impact"
    assert np.abs(real - reference).max() < 0.1 * reference.max()


def onset(substeps: int) -> float:
    """Time [s] at which the contact force of an approach at 0.1 m/s passes 10 N, interpolated."""
    item = below(0.003, BoxObject, stiffness=5e4)
    plant = Plant(UR5E, Scenario(posture=LOW, tool=PROBE, world=[item]), Step(substeps))
    model, data = plant.model, plant.data
    dofs = np.array([model.joint(f"q/{name}").dofadr[0] for name in UR5E.chain.joints])
    thetas = np.array([model.joint(f"theta/{name}").dofadr[0] for name in UR5E.chain.joints])
    rigid = chain(UR5E)
    jacobian = Dynamics(rigid, rigid.links, plate_body(UR5E), mounting=[0.0] * 3, elbow=2).update(plant.q)[2]
    data.qvel[dofs] = data.qvel[thetas] = np.linalg.lstsq(jacobian, [0.0, 0.0, -0.1, 0.0, 0.0, 0.0], rcond=None)[0]
    rotor, wanted = np.array(UR5E.motors.rotor_inertia), data.qvel[thetas].copy()
    base, before = data.qfrc_bias[dofs].copy(), 0.0
    for k in range(200):
        plant.advance(base + 200.0 * rotor * (wanted - plant.theta_d))
        force = normal_contact(plant)[0]
        if force >= 10.0:
            return 0.002 * (k + (10.0 - before) / (force - before))
        before = force
    raise AssertionError("no contact")


def test_half_the_step_leaves_contact_onset_as_it_is() -> None:
    assert onset(8) == pytest.approx(onset(16), rel=0.02)


def test_contact_force_and_acceleration_are_opposite_with_the_arms_effective_mass() -> None:
    """CD-0, docs/explanation/contact.md: ratio = - effective mass of the arm behind the sensor; springs decouple the rotors."""
    rigid = chain(UR5E)
    touching, free = (approach([below(0.001, BoxObject, stiffness=2e4)]), approach([]))
    normal = np.array([0.0, 0.0, 1.0, 0.0, 0.0, 0.0])
    links = Dynamics(rigid, rigid.links, Body(0.0, np.zeros(3), np.zeros((3, 3))), mounting=[0.0] * 3, elbow=2)
    jacobian = links.update(np.array(LOW))[2].copy()
    mass, push = links.mass(np.array(LOW)), jacobian.T @ normal
    wrists = np.diag([0.0, 0.0, 0.0, *UR5E.motors.rotor_inertia[3:]])
    least, most = (1.0 / (push @ np.linalg.solve(inertia, push)) for inertia in (mass, mass + wrists))
    start = next(k for k, (force, _, _) in enumerate(touching) if force > 0.0)
    ratios = []
    for k in (start, start + 1, start + 2):
        _, flange, R = touching[k]
        # The same motion without the object: what differs is what the contact did.
        change = flange - free[k][1]
        change_f, change_a = change[:3], change[6:9]
        assert change_f @ change_a < -0.3 * np.linalg.norm(change_f) * np.linalg.norm(change_a), "opposite directions (CD-0)"
        ratios.append((R @ change_f)[2] / (R @ change_a)[2])
    assert most > 1.3 * least, "the bounds must tell something"
    assert least < -ratios[0] < most, "in the tick of the onset the links, and of the rotors the wrists' at most"
    assert ratios[2] < ratios[0], "then the wrists' rotors join"


def approach(world: list[AnyObject]) -> list[tuple[float, np.ndarray, np.ndarray]]:
    """Contact force, what the flange measures, and its orientation, tick by tick, coming down at 0.25 m/s for 20 ms."""
    plant = Plant(UR5E, Scenario(posture=LOW, tool=PROBE, world=world))
    dofs = np.array([plant.model.joint(f"q/{name}").dofadr[0] for name in UR5E.chain.joints])
    thetas = np.array([plant.model.joint(f"theta/{name}").dofadr[0] for name in UR5E.chain.joints])
    rigid = chain(UR5E)
    jacobian = Dynamics(rigid, rigid.links, plate_body(UR5E), mounting=[0.0] * 3, elbow=2).update(plant.q)[2]
    speed = np.linalg.lstsq(jacobian, [0.0, 0.0, -0.25, 0.0, 0.0, 0.0], rcond=None)[0]
    plant.data.qvel[dofs] = plant.data.qvel[thetas] = speed
    torque, rows = plant.data.qfrc_bias[dofs].copy(), []
    for _ in range(10):
        plant.advance(torque)
        R = plant.data.xmat[plant.model.body("flange").id].reshape(3, 3).copy()
        rows.append((normal_contact(plant)[0], plant.flange.copy(), R))
    return rows


def test_a_surface_with_two_frictions_holds_more_beyond_its_seam() -> None:
    item = below(0.0, TwoFrictions, stiffness=5e4, friction=0.2, friction_beyond=0.8)
    plant = Plant(UR5E, Scenario(posture=LOW, tool=PROBE, world=[item]))
    pair = plant.model.pair("shape/tool thing").id
    plant.advance(np.zeros(6))
    here = plant.model.pair_friction[pair, 0]
    plant.world.place("thing", [item.position[0] - 0.1, *item.position[1:]])
    plant.advance(np.zeros(6))
    plant.advance(np.zeros(6))
    assert {here, plant.model.pair_friction[pair, 0]} <= {0.2, 0.8}
    assert plant.model.pair_friction[pair, 0] == 0.8


def test_a_snap_fit_breaks_at_its_force_and_gives_way_by_its_travel() -> None:
    item = below(0.0002, SnapFit, stiffness=1e5, force=30.0, travel=0.004)
    plant = Plant(UR5E, Scenario(posture=LOW, tool=PROBE, world=[item]))
    dofs = np.array([plant.model.joint(f"q/{name}").dofadr[0] for name in UR5E.chain.joints])
    base = plant.data.qfrc_bias[dofs].copy()
    slide = plant.model.joint("snap/thing").qposadr[0]
    peak, broke_at, push = 0.0, None, 0.0
    for _ in range(2000):
        push += 0.05
        plant.advance(base, (Push("flange", (0.0, 0.0, 0.0), (0.0, 0.0, -push)),))
        force = normal_contact(plant)[0]
        if broke_at is None:
            peak = max(peak, force)
            if plant.data.qpos[slide] > 1e-4:
                broke_at = peak
        if plant.data.qpos[slide] > 0.0039 and force > 40.0:
            break
    assert broke_at == pytest.approx(30.0, rel=0.1)
    assert plant.data.qpos[slide] == pytest.approx(0.004, abs=1e-4)
    assert force > 40.0, "at the end of its travel it resists again"


@pytest.mark.parametrize("rest", [0.0, 0.2, 0.5, 1.0])
def test_a_snap_fit_resists_with_its_rest_while_it_gives_way(rest: float) -> None:
    item = below(0.1, SnapFit, force=30.0, travel=0.004, rest=rest)
    plant = Plant(UR5E, Scenario(posture=LOW, tool=PROBE, world=[item]))
    slide = plant.model.joint("snap/thing")
    for at, share in ((0.0, 1.0), (0.002, rest)):
        plant.data.qpos[slide.qposadr[0]] = at
        plant.world.advance()
        assert plant.model.dof_frictionloss[slide.dofadr[0]] == pytest.approx(share * 30.0)


def test_a_moving_object_follows_its_sine() -> None:
    size, sway = [0.1] * 3, [0.0, 0.2, 0.0]
    item = Moving(name="cart", position=[1.0, 1.0, 1.0], rpy=[0.0, 0.0, 1.0], size=size, amplitude=sway, period=2.0)
    plant = Plant(UR5E, Scenario(world=[item]))
    for k in range(600):
        plant.advance(np.zeros(6))
        time = 0.002 * (k + 1)
        expected = np.array([1.0, 1.0 + 0.2 * np.sin(np.pi * time), 1.0])
        mujoco.mj_kinematics(plant.model, plant.data)
        assert np.allclose(plant.object_poses()[0, :3], expected, atol=1e-4)


def test_the_tool_touches_the_arms_own_links_where_that_is_asked_for() -> None:
    """CD-2: foot, shoulder, upper arm and forearm, as stiff as a housing; as shipped, and without a world, nothing collides."""
    assert Plant(UR5E, Scenario(tool=PROBE)).model.npair == 0
    model = Plant(UR5E, Scenario(tool=PROBE, self_contact=True, world=[below(0.1, Pad)])).model
    own = [k for k in range(model.npair) if model.pair(k).name.startswith("itself ")]
    links = {model.body(model.geom_bodyid[model.pair_geom2[k]]).name for k in own}
    links |= {model.body(model.geom_bodyid[model.pair_geom1[k]]).name for k in own}
    assert links == {"foot", "base", "shoulder", "elbow", "flange"}
    for k in own:
        bodies = model.geom_bodyid[[model.pair_geom1[k], model.pair_geom2[k]]]
        assert model.pair_solref[k, 0] == pytest.approx(-SKIN * model.body_invweight0[bodies, 0].sum() * (1 - DEPTH))


def test_an_arm_that_begins_inside_itself_says_so() -> None:
    """The probe is turned towards the upper arm, in whose plane it lies."""
    found = set[str]()
    for angle in np.linspace(-6.0, 0.0, 25):
        try:
            Plant(UR5E, Scenario(posture=[0.0, -1.2, 2.2, angle, -1.57, 0.0], tool=PROBE, self_contact=True))
            found.add("")
        except ValueError as error:
            found.add(str(error).partition(" mm ")[2])
    assert found == {"", "inside itself"}


def test_a_shape_may_be_a_ball() -> None:
    """Of wrist 3, whose capsule MuJoCo would refuse at no length: it meets what a table is put against."""
    arm = replace(UR5E, shapes=[Capsule(link=5, start=[0.0, 0.0, 0.1], end=[0.0, 0.0, 0.1], radius=0.05)])
    plant = Plant(arm, Scenario(posture=LOW, world=[Plane(name="floor", position=[0.0, 0.0, -1.0])]))
    geom = plant.model.geom("shape/0")
    assert geom.type[0] == mujoco.mjtGeom.mjGEOM_SPHERE
    assert geom.size[0] == 0.05
    assert geom.pos.tolist() == pytest.approx([0.0, 0.0, 0.1])
