"""The true arm in its world: MuJoCo state, advanced one control tick at a time. Everything here is truth."""

import math
from collections.abc import Sequence

import mujoco
import numpy as np
from numpy.typing import NDArray

from sim.arm.arm_file import Arm
from sim.arm.scenario import Scenario
from sim.plant.applied_touches import Hands
from sim.plant.attached_payload import Payload
from sim.plant.held_part import HeldParts
from sim.plant.joint_friction import Friction
from sim.plant.joint_state import LEAST_RUBBING, drive, finish, gather, plant_record, poses, sliding
from sim.plant.model import SENSORS, Step, model_of
from sim.plant.objects import set_contact_stiffness
from sim.plant.touch import Touch
from sim.plant.true_gripper import TrueGripper
from sim.plant.world import World

Array = NDArray[np.float64]

WARMTH_TICKS = 50  # temperatures change over minutes: one update in 0.1 s
BRAKE_STIFFNESS = 50.0  # of a closed brake, times that of the joint's bristles: a disc against rolling seals
TOOL_MOTION = slice(12, 18)  # where `flange` has acceleration and angular velocity of the tool
LUGRE_STIFFNESS, LUGRE_DAMPING = 5, 6  # where an actuator's dynamics parameters have the bristles'


class Plant:
    """The arm, n joints, with its load and its world.

    Attributes (views into MuJoCo or arrays of its own, valid until the next `advance`):
        q, qd, theta, theta_d: true joint and motor angles and speeds (n,).
        flange: means over the last tick of what `sim.plant.model.SENSORS` lists (18,).
        temperature: of the joints [°C] (n,).
        tau_J: true transmission torque at the tick's end (n,).
        friction_in: true friction torque limit of the input side in this tick (n,).
    """

    def __init__(self, arm: Arm, scenario: Scenario, step: Step | None = None) -> None:
        self.arm, self.scenario, self.step = arm, scenario, step or Step()
        self.model = model_of(arm, scenario, self.step)
        self.data = mujoco.MjData(self.model)
        self.friction = Friction(arm)
        model, data, joints = self.model, self.data, arm.chain.joints
        self._at_q = np.array([model.joint(f"q/{name}").qposadr[0] for name in joints])
        self._at_theta = np.array([model.joint(f"theta/{name}").qposadr[0] for name in joints])
        self._springs = np.array([model.tendon(f"spring/{name}").id for name in joints])
        self._slips = np.array([model.tendon(f"hysteresis/{name}").id for name in joints])
        self._slip_state = model.tendon_plasticadr[self._slips]
        self._dof_q = np.array([model.joint(f"q/{name}").dofadr[0] for name in joints])
        self._dof_theta = np.array([model.joint(f"theta/{name}").dofadr[0] for name in joints])
        values = arm.transmissions
        self.record = plant_record(arm.n, self.step.substeps, 3 * len(SENSORS))
        own = self.record[0]
        own["stiffness"], own["stiffening"], own["damping"] = values.stiffness, values.stiffening, values.damping
        own["slip_stiffness"] = values.hysteresis_stiffness
        own["at_q"], own["at_theta"], own["dof_q"], own["dof_theta"] = self._at_q, self._at_theta, self._dof_q, self._dof_theta
        own["spring"], own["slip"], own["slip_state"] = self._springs, self._slips, self._slip_state
        # A brake that its own motor could turn would not hold what the motor held.
        self._brakes, self._braked = np.array(arm.motors.torque_per_current) * arm.motors.current, False
        self._held, self._heat = own["held"], own["heat"]
        self._rubs = np.array([model.actuator(f"friction/theta/{name}").id for name in joints])
        self._rubs_outside = np.array([model.actuator(f"friction/q/{name}").id for name in joints])
        self._links = np.array([model.body(name).id for name in ("foot", *joints, "flange")])
        self._parts = {model.body(int(i)).name: int(i) for i in self._links}
        self._parts["tool"] = self._parts["flange"]
        self.world = World(model, data, scenario.world, self.step.tick)
        self.payload = Payload(model, data, scenario.payload_true, scenario.world)
        own["rubs"], own["kept"] = self._rubs, self._history_indices()
        self.flange, self.temperature, self.friction_in = own["flange"], own["temperature"], own["friction_in"]
        self.temperature[:] = arm.frictions.temperature
        self.ambient = arm.thermals.ambient
        self.q, self.theta, self.qd, self.theta_d, self.tau_J = (own[k] for k in ("q", "theta", "qd", "theta_d", "tau_J"))
        # MuJoCo's own arrays: asking for one costs as much as a kernel.
        self._state = (data.qpos, data.qvel, data.ten_length, data.ten_velocity, data.plastic, data.history)
        self._driven = (model.actuator_biasprm, data.qfrc_applied)
        self.frames = (data.xpos, data.xquat)  # (b, 3), (b, 4) of MuJoCo's bodies in W, as they are now
        self.flange_body = self._parts["flange"]  # MuJoCo's number of the tool-side face of the flange sensor
        self.payload_body = model.body("payload").id  # of what is carried
        self.hands = Hands(model, data, self._parts)
        self._held_parts = HeldParts(model, data, scenario.world, self.payload, flange=self.flange_body)
        self.gripper = self._gripper()
        self._arm_geoms = np.array([model.geom(i).name.startswith(("shape/", "carried/")) for i in range(model.ngeom)])
        self.tick = 0
        self._place(np.array(scenario.posture if scenario.posture is not None else arm.chain.home))

    def _gripper(self) -> TrueGripper | None:
        tool = self.scenario.tool
        if tool is None or tool.gripper is None:
            return None
        flange = self.flange_body
        return TrueGripper(
            self.model,
            self.data,
            tool,
            self._held_parts,
            flange=flange,
            velocity=lambda point: self.hands.velocity(flange, point),
            span=self.step.tick,
        )

    @property
    def parts(self) -> tuple[str, ...]:
        """Names of the parts that can be touched."""
        return tuple(self._parts)

    @property
    def link_bodies(self) -> tuple[int, ...]:
        """MuJoCo's numbers of foot, links and flange."""
        return tuple(self._links.tolist())

    def body_of(self, part: str) -> int:
        """MuJoCo's number of a part that can be touched."""
        return self._parts[part]

    def _place(self, posture: Array) -> None:
        """Put the arm at rest in `posture` (n,), the springs loaded by gravity, the friction relaxed."""
        set_contact_stiffness(self.model, self.scenario.world)
        mujoco.mj_resetData(self.model, self.data)
        data = self.data
        data.qpos[self._at_q] = posture
        data.qpos[self._at_theta] = posture
        # A few rounds: gravity torque at the posture bends the springs, the sensor's too, which moves the load a little.
        slides = [i for i in range(self.model.njnt) if self.model.joint(i).name.startswith("sensor/")]
        for _ in range(4):
            mujoco.mj_forward(self.model, data)
            for i in slides:
                at = self.model.jnt_qposadr[i]
                data.qpos[at] = -data.qfrc_bias[self.model.jnt_dofadr[i]] / self.model.jnt_stiffness[i]
            data.qpos[self._at_theta] = posture + self._deflection(data.qfrc_bias[self._dof_q])
        mujoco.mj_forward(self.model, data)
        # The hysteresis springs start relaxed: both ends of their slack range sit at the present deflection.
        data.plastic[self._slip_state] = data.plastic[self._slip_state + 1] = data.ten_length[self._slips]
        mujoco.mj_forward(self.model, data)
        self._read()
        self.flange[:] = self.data.sensordata[self._sensor_order()]
        why = self.world.overlap()
        if why:
            raise ValueError(why)

    def _deflection(self, torque: Array) -> Array:
        """Deflection (n,) of the main springs under `torque` (n,), by Newton's method."""
        linear = np.array(self.arm.transmissions.stiffness)
        cubic = np.array(self.arm.transmissions.stiffening)
        x = torque / linear
        for _ in range(6):
            x -= (linear * x + cubic * x**3 - torque) / (linear + 3 * cubic * x**2)
        return x

    def _sensor_order(self) -> NDArray[np.intp]:
        at = [self.model.sensor(name).adr[0] for name in SENSORS]
        return np.array([a + k for a in at for k in range(3)])

    def _history_indices(self) -> NDArray[np.intp]:
        """Where MuJoCo keeps each substep's values: per sensor [user, cursor, times (k), values (k x 3)]. (k, 18)."""
        k = self.step.substeps
        rows = np.empty((k, 3 * len(SENSORS)), dtype=np.intp)
        for j, name in enumerate(SENSORS):
            start = self.model.sensor_historyadr[self.model.sensor(name).id] + 2 + k
            rows[:, 3 * j : 3 * j + 3] = start + np.arange(3 * k).reshape(k, 3)
        return rows

    def advance(self, motor_torque: Array, touches: Sequence[Touch] = (), braked: bool = False) -> None:
        """Advance by one control tick.

        Args:
            motor_torque: true motor torque referred to the output (n,) [N·m], constant over the tick.
            touches: what hands do to parts during the tick.
            braked: the brakes hold every joint, with what its motor can give at most.

        Raises:
            KeyError: a touch names a part that does not exist; `parts` has those that do.
            FloatingPointError: the state is not finite any more, or a joint faster than anything is.
        """
        self.hands.apply(touches)
        if self.scenario.world:
            self.world.advance()
        if braked is not self._braked:
            self._brake(braked)
        drive(self.record, self.friction.record, self._driven, motor_torque)
        mujoco.mj_step(self.model, self.data, nstep=self.step.substeps)
        if not finish(self.record, self._state):
            raise FloatingPointError(f"the physics diverged after {self.tick * self.step.tick:.3f} s")
        self.tick += 1
        if self.tick % WARMTH_TICKS == 0:
            self._warm()
        if self.gripper is not None:
            self.gripper.step(self.flange[TOOL_MOTION])
        if self.payload.falling:
            self.payload.fall(self.step.tick)

    def wear(self, joints: slice | int, factor: float) -> None:
        """The true friction of some joints, on both sides, becomes `factor` times what it is when new (wear, grease)."""
        self.friction.wear(joints, factor)
        model, at = self.model, self._rubs_outside
        model.actuator_biasprm[at, 3] = model.actuator_biasprm[at, 4] = np.maximum(self.friction.output_coulomb, LEAST_RUBBING)
        model.actuator_damping[at] = self.friction.output_viscous

    def _brake(self, braked: bool) -> None:
        """Close or open the brakes: closed, the rotors sit on far stiffer bristles, which take over the torque of the soft ones.

        Opened, no more than the joints' own friction is left of it.
        """
        factor = BRAKE_STIFFNESS if braked else 1.0 / BRAKE_STIFFNESS
        values, at = self.model.actuator_dynprm, self.model.actuator_actadr[self._rubs]
        held = values[self._rubs, LUGRE_STIFFNESS] * self.data.act[at]
        if not braked:
            own = self.friction_in - self._held
            held = np.clip(held, -own, own)
        values[self._rubs, LUGRE_STIFFNESS] *= factor
        values[self._rubs, LUGRE_DAMPING] *= math.sqrt(factor)
        self.data.act[at] = held / values[self._rubs, LUGRE_STIFFNESS]
        self._braked = braked
        self._held[:] = self._brakes if braked else 0.0

    def _warm(self) -> None:
        """First-order warming of each joint by its own friction loss."""
        thermals = self.arm.thermals
        span = WARMTH_TICKS * self.step.tick
        loss = self._heat / WARMTH_TICKS
        outflow = (self.temperature - self.ambient) / np.array(thermals.resistance)
        self.temperature[:] = self.temperature + span * (loss - outflow) / np.array(thermals.capacity)
        self._heat[:] = 0.0

    def rest(self, seconds: int) -> None:
        """Let time pass without physics: the clocks go on, and the joints cool as those do in which nothing rubs.

        An object that moves by itself is next where it would be by then.
        """
        thermals = self.arm.thermals
        cooled = np.exp(-seconds / (np.array(thermals.resistance) * np.array(thermals.capacity)))
        self.temperature[:] = self.ambient + (self.temperature - self.ambient) * cooled
        self.data.time += seconds
        self.tick += round(seconds / self.step.tick)

    def drop(self) -> None:
        """Let the payload fall, and what the gripper holds: they leave with the flange's velocity."""
        if self.gripper is not None:
            self.gripper.drop()
        self.payload.drop(lambda point: self.hands.velocity(self.flange_body, point))

    @property
    def touched(self) -> bool:
        """A hand or an object touches the arm, or what it carries."""
        if self.hands.touched or not self.data.ncon:
            return bool(self.hands.touched)
        return not self._held_parts.parts or bool(self._arm_geoms[self.data.contact.geom].any())

    def sliding_friction(self) -> Array:
        """True friction (n,) of both sides at the present speeds, with their signs [N·m].

        The sign of a speed is blurred over some mrad/s: a joint at rest slides neither way.
        """
        return sliding(self.record, self.friction.record)

    def poses(self) -> Array:
        """Poses (n + 2, 7) in W of foot, links and flange: position [m], quaternion wxyz."""
        return poses(*self.frames, self._links)

    def object_poses(self) -> Array:
        """Poses (m, 7) in W of the world objects."""
        found = poses(*self.frames, self.world.bodies)
        if self._held_parts.held is not None:
            self._held_parts.place(found, self.scenario.world.index(self._held_parts.held))
        return found

    def _read(self) -> None:
        """Gather the state at the tick's end, and the true transmission torque."""
        gather(self.record, self._state)
