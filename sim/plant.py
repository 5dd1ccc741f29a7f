"""The true arm in its world: MuJoCo state, advanced one control tick at a time. Everything here is truth."""

import math
from collections.abc import Sequence

import mujoco
import numpy as np
from numpy.typing import NDArray

from sim.arm import Arm
from sim.chain import load_body
from sim.frames import quaternion_from_matrix, rotation_from_rpy
from sim.friction import Friction
from sim.model import SENSORS, Step, build
from sim.objects import SNAP_REST, SNAP_SLIP, set_contact_stiffness
from sim.scenario import Load, Moving, Scenario, SnapFit, TwoFrictions
from sim.touch import Pull, Touch

Array = NDArray[np.float64]

HAND_STIFFNESS = 800.0  # of the virtual hand [N/m]
HAND_DAMPING = 40.0  # of the virtual hand [N·s/m]
WARMTH_TICKS = 50  # temperatures change over minutes: one update in 0.1 s
GRAVITY = 9.81


class Plant:
    """The arm, n joints, with its load and its world.

    Attributes (views into MuJoCo or arrays of its own, valid until the next `advance`):
        q, qd, theta, theta_d: true joint and motor angles and speeds (n,).
        flange: means over the last tick of what `sim.model.SENSORS` lists (18,).
        temperature: of the joints [°C] (n,).
        tau_J: true transmission torque at the tick's end (n,).
        friction_in: true friction torque limit of the input side in this tick (n,).
    """

    def __init__(self, arm: Arm, scenario: Scenario, step: Step | None = None, *, soft_sensor: bool = False) -> None:
        self.arm, self.scenario, self.step = arm, scenario, step or Step()
        self.model = build(arm, scenario, self.step, soft_sensor=soft_sensor).compile()
        self.data = mujoco.MjData(self.model)
        self._scratch = mujoco.MjData(self.model)
        self.friction = Friction(arm)
        model, joints = self.model, arm.chain.joints
        self._at_q = np.array([model.joint(f"q/{name}").qposadr[0] for name in joints])
        self._at_theta = np.array([model.joint(f"theta/{name}").qposadr[0] for name in joints])
        self._springs = np.array([model.tendon(f"spring/{name}").id for name in joints])
        self._slips = np.array([model.tendon(f"hysteresis/{name}").id for name in joints])
        self._slip_state = model.tendon_plasticadr[self._slips]
        self._rubs = np.array([model.actuator(f"friction/theta/{name}").id for name in joints])
        self._links = np.array([model.body(name).id for name in ("foot", *joints, "flange")])
        self._parts = {model.body(int(i)).name: int(i) for i in self._links}
        self._parts["tool"] = self._parts["flange"]
        self._payload = model.body("payload").id
        self._objects = np.array([model.body(f"object/{item.name}").id for item in scenario.world], dtype=int)
        self._history = self._history_indices()
        self._rows = np.empty(self._history.shape)
        self.flange = np.zeros(3 * len(SENSORS))
        self.temperature = np.full(arm.n, arm.frictions.temperature)
        self._ambient = arm.thermals.ambient
        self.tau_J = np.zeros(arm.n)
        self.friction_in = np.zeros(arm.n)
        self.touched: tuple[tuple[str, tuple[float, ...], tuple[float, ...], tuple[float, ...]], ...] = ()
        self.load = scenario.payload_true
        self.fallen: Array | None = None
        self._fall_speed = np.zeros(3)
        self._pushed: set[int] = set()
        self.tick = 0
        self._place(np.array(scenario.posture if scenario.posture is not None else arm.chain.home))

    @property
    def parts(self) -> tuple[str, ...]:
        """Names of the parts that can be touched."""
        return tuple(self._parts)

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
                data.qpos[at] = -data.qfrc_bias[self.model.jnt_dofadr[i]] / self.model.jnt_stiffness[i, 0]
            data.qpos[self._at_theta] = posture + self._deflection(data.qfrc_bias[self._at_q])
        data.plastic[self._slip_state] = data.ten_length[self._slips]
        self.q, self.theta = data.qpos[self._at_q], data.qpos[self._at_theta]
        self.qd, self.theta_d = data.qvel[self._at_q], data.qvel[self._at_theta]
        mujoco.mj_forward(self.model, data)
        self._read_tau()
        self.flange[:] = self.data.sensordata[self._sensor_order()]

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

    def _read_tau(self) -> None:
        length, speed = self.data.ten_length[self._springs], self.data.ten_velocity[self._springs]
        values = self.model
        stiffness = values.tendon_stiffness[self._springs]
        poly = values.tendon_stiffnesspoly[self._springs]
        main = stiffness * length + poly[:, 0] * length * np.abs(length) + poly[:, 1] * length**3
        slip = values.tendon_stiffness[self._slips] * (length - self.data.plastic[self._slip_state])
        self.tau_J = main + values.tendon_damping[self._springs] * speed + slip
