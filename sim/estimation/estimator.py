"""From measurements to what the controller knows: speeds, accelerations, transmission torque, external wrench."""

import math

import numpy as np
from numpy.typing import NDArray

from pendant.all_settings import FrictionFrom, JointControl
from pendant.decision import EstimatorCommand
from pendant.tick.estimate import Estimate, WhoseForce
from pendant.tick.modes import TICK
from sim.arm.arm_file import Arm
from sim.arm.chain import Body
from sim.arm.joint_constants import JointConstants, ripple_torque
from sim.estimation.adaptive_friction import AdaptiveFriction
from sim.estimation.joint_tracking import (
    SPEED_BANDWIDTH,
    TORQUE_BANDWIDTH,
    angle_noise,
    deflection_rate,
    follow,
    joint_record,
    plan,
    tracking_gains,
)
from sim.estimation.link_hand import LinkHand, powers
from sim.estimation.momentum_observer import MomentumObserver
from sim.estimation.payload_fall import JointTorques, PayloadFall
from sim.estimation.torque_balance import NOT_TOLD, balance, missing_mass
from sim.estimation.transmission_torque import DEFLECTION, MOTOR, WAYS, TransmissionTorque
from sim.flange.external_wrench import ExternalWrench
from sim.flange.flange_forces import FlangeForces
from sim.motion.moves import Reference
from sim.rigid_body.dynamics import Dynamics
from sim.sensing.sensors import Sample

Array = NDArray[np.float64]

AT_FIRST = EstimatorCommand()
_DEFLECTION = FrictionFrom.DEFLECTION  # looked up in every tick
SENSORS = ("motor_encoder", "output_encoder", "current")
MOTOR_ANGLE, CURRENT = 0, 2
SURE = 4.0  # standard deviations of noise: one second in thirty has a tick beyond
BENDING_BANDWIDTH = 5.0  # of a deflection that replaces a lost angle [Hz]


class Estimator:
    """The controller's view of the arm, n joints, in B.

    Args:
        arm: the arm's numbers.
        constants: the joint constants that the controller uses.
        dynamics: the controller's rigid model, which holds the configured payload.
        tcp: tool centre point in F (3,) [m].
    """

    def __init__(self, arm: Arm, constants: JointConstants, dynamics: Dynamics, tcp: Array) -> None:
        n, motors, spring = arm.n, arm.motors, arm.transmissions
        self._dynamics, self._tcp = dynamics, tcp
        stiffness = np.array(spring.stiffness) * constants.stiffness
        slip_stiffness = np.array(spring.hysteresis_stiffness) * constants.stiffness
        torque_constant = np.array(motors.torque_per_current) * constants.motor_constant
        stiffening = np.array(spring.stiffening) * constants.stiffness
        self._record = joint_record(n)
        own = self._own = self._record[0]
        own["most"] = motors.current
        own["torque_constant"], own["stiffness"], own["stiffening"] = torque_constant, stiffness, stiffening
        own["damping"], own["slip_stiffness"], own["slip_yield"] = spring.damping, slip_stiffness, spring.hysteresis_yield
        own["rotor"] = np.array(motors.rotor_inertia) * constants.rotor_inertia
        self.friction = AdaptiveFriction(arm)
        self.transmission = TransmissionTorque(arm, dynamics.mass(np.array(arm.chain.home)).diagonal())
        self._use: JointControl | None = None
        self._ways = np.ones((len(WAYS), n), dtype=bool)
        self._stiction, self._deflection = own["stiction"], own["deflection"]
        self._by_deflection = np.zeros(n, dtype=bool)  # joints whose friction comes from the deflection
        self._torques = self._record, self.friction.record, self.transmission.record
        self._relaxed = False  # at first the hysteresis spring is taken for relaxed
        own["gains"] = tracking_gains(SPEED_BANDWIDTH), tracking_gains(TORQUE_BANDWIDTH)
        self._theta, self._q, self.tau_m, self._current = own["theta"], own["q"], own["tau_m"], own["current"]
        self._spin = self._record["spin"]
        self._compliance = 1.0 / (stiffness + slip_stiffness)
        self._able = np.ones((3, n), dtype=bool)  # motor angle, output angle, current
        self._lost: tuple[tuple[str, int], ...] = ()
        self._smooth_bending = 1.0 - math.exp(-2.0 * math.pi * BENDING_BANDWIDTH * TICK)
        encoders = arm.sensors.encoders
        self._settling = -math.expm1(-deflection_rate(encoders) * TICK)  # share of a deflection a tick; 0: of fine encoders
        self._settled: Array | None = None  # deflection in that low-pass (n,) [rad]
        left = self._settling / (2.0 - self._settling) if self._settling else 1.0  # of the noise's variance in a deflection
        noise = SURE * math.sqrt(left) * angle_noise(encoders) / self._compliance
        self._blur = tuple((ripple_torque(arm) + noise).tolist())
        self._bending = np.zeros(n)  # torque that bends the spring of a joint with a lost angle [N·m]
        self._bend = np.zeros(n)  # its deflection that the believed stiffness does not explain [rad]
        self.started, self._free = False, False  # `_free`: free-drive was on in the last tick
        self._wanted: Reference | None = None  # in the last tick
        self.q, self.jacobian = np.zeros(n), dynamics.recursion.jacobian
        self.forces = FlangeForces(dynamics)
        self.whose_force = ExternalWrench(arm, self.forces)
        self.momentum = MomentumObserver(arm, dynamics)
        joints = JointTorques(self.momentum, self.transmission, self._deflection)
        self.fall = PayloadFall(arm, dynamics.recursion, joints, self.whose_force)
        self.link_hand = LinkHand(arm, dynamics.recursion, self.momentum)
        self._bears = self.transmission.record, dynamics.recursion.record, self.whose_force.record, self._ways
        self._known: Estimate | None = None
        self.tick = 0

    def set_load(self, load: Body, payload: Body) -> None:
        """Take `load` (in F) as everything beyond the flange; the `payload`, a part of the load, may get lost."""
        self.forces.set_load(load)
        self.whose_force.set_load(load, payload)

    def update(
        self,
        sample: Sample,
        command: EstimatorCommand = AT_FIRST,
        *,
        answered: Reference | None = None,
        learn: bool = True,
    ) -> Estimate:
        """Take the measurements of one tick.

        If joint measurements are not valid, the last good estimate stays, marked as invalid.

        Args:
            sample: this tick's measurements.
            command: of the last decision; its tool, payload and zero are in the models and in the sample.
            answered: motion that was wanted at the time of the measurement, or None. With a motion the filters follow the
                deviation from it, so they do not lag behind a planned acceleration.
            learn: False while a hand may move the arm: friction stays as known, and the gears are not compared with the rigid
                model.
        """
        dynamics, bias, unsure = self._dynamics, command.bias, command.unsure
        self.tick += 1
        theta, q = self._theta, self._q
        angles = (sample.theta, sample.q, sample.current) if sample.joints_valid else self._made_up(sample)
        if angles is not None:
            if self._settling:
                angles = self._through_motor(*angles)
            if self._lost and sample.joints_valid:
                self._back(sample)
            if not self.started:
                # Also after an outage: the distance that the arm moved meanwhile must not count as speed.
                theta[:], q[:] = 0.0, 0.0
                theta[0], q[0] = angles[0], angles[1]
                self._wanted = None
            if not self._relaxed:
                self._relaxed, self._own["rest"] = True, angles[0] - angles[1]
            if answered is not None and self._wanted is not None and answered.q is not self._wanted.q:
                plan(self._record, tuple(self._wanted), tuple(answered))
            self._wanted = answered
            follow(self._record, angles)
            self.q = angles[1].copy()  # a law may hold on to it
        self.started = angles is not None
        rigid = dynamics.recursion
        v_tcp, v_elbow = rigid.run(self.q, q, self._tcp)
        sensed = sample.wrench_valid and math.isfinite(unsure)  # valid and used
        self._observe(sample, sensed, self._estimate_torques(sample, command.use, learn) and learn)
        self.forces.update(sample, self.q, q, self.transmission.external)
        known, valid = self._known, sample.joints_valid
        if known is None:
            self._known = known = self._all(sample)
        known.tick = self.tick
        known.joints_valid, known.wrench_valid, known.acceleration_valid = valid, sample.wrench_valid, sample.acceleration_valid
        known.q, known.w_sensor, known.a_F = self.q, sample.wrench, sample.acceleration_flange
        known.v_tcp, known.v_elbow = v_tcp, v_elbow
        known.degraded = not valid and self.started and bool(self._able[MOTOR_ANGLE].all())
        known.lost, known.touched = self._lost, self.transmission.contact
        known.missing_mass = NOT_TOLD if sample.wrench_valid else missing_mass(*self._bears)
        known.load_mass = dynamics.load.mass
        if bias is not None or self._free:
            self._free = bias is not None
            self._ask_whose(known, bias if sensed else None, unsure)
        return known

    def _ask_whose(self, known: Estimate, bias: tuple[float, ...] | None, unsure: float) -> None:
        """Whose force it is: in free-drive, and in the tick after it, which ends what is told; `bias` None: no valid sensor."""
        odds = self.whose_force.update(bias, unsure, accelerations=known.acceleration_valid)
        energy = self._dynamics.recursion.energy.item() + self._spin.item()
        fell, feel = self.fall.update(self.q, free=self._free, sensed=bias is not None)
        link, qd = self.link_hand, self._q[1]
        if bias is None:
            link.forget()
            hand, certain = self.fall.torque, self.fall.certain
        else:
            link.update(bias, qd, self._ways[DEFLECTION])
            hand, certain = link.torque, link.certain
        done = powers(qd, hand, certain, known.friction)
        known.whose = WhoseForce(*odds, fell, feel, hand, certain, done, energy, link.force, link.touch)

    def _all(self, sample: Sample) -> Estimate:
        """The estimate that every tick renews: most of it are arrays that are written in place."""
        rigid, transmission, friction, theta, q = self._dynamics.recursion, self.transmission, self.friction, self._theta, self._q
        return Estimate(
            tick=self.tick,
            joints_valid=False,
            wrench_valid=False,
            acceleration_valid=False,
            q=self.q,
            qd=q[1],
            qdd=q[2],
            theta=theta[0],
            theta_d=theta[1],
            tau_m=self.tau_m,
            tau_J=transmission.fused,
            tau_ext=transmission.external,
            w_sensor=sample.wrench,
            F_user=self.forces.F_user,
            a_F=sample.acceleration_flange,
            a_felt=self.forces.a_felt,
            p_BF=rigid.p,
            R_BF=rigid.R,
            v_F=rigid.v_F,
            v_tcp=0.0,
            v_elbow=0.0,
            g_B=self._dynamics.gravity_B,
            theta_dd=theta[2],
            friction=friction.total,
            friction_deviation=friction.deviation,
            tau_ways=transmission.ways,
            tcp=rigid.tcp,
            elbow=rigid.elbow,
            F_joints=self.forces.F_joints,
            whose=WhoseForce(tau_hand=np.zeros_like(self.q), tau_certain=np.zeros_like(self.q)),
            current=self._current,
            tau_blur=self._blur,
        )

    def _observe(self, sample: Sample, sensed: bool, learn: bool) -> None:
        """External torques by the momentum; `sensed`: the flange sensor is used."""
        friction, motor = self.friction, self.transmission.ways[MOTOR]
        gears = (self._deflection, motor, friction.total, friction.deviation, self._stiction, self._ways)
        driven = (self.q, *gears, sample.wrench)
        self.momentum.update(driven, with_sensor=sensed, valid=sample.joints_valid, learn=learn)

    def _estimate_torques(self, sample: Sample, use: JointControl, learn: bool) -> bool:
        """Friction and transmission torque. Returns whether any joint moves."""
        if use is not self._use:
            self._use = use
            both, motor_known = self._able[0] & self._able[1], self._able[0] & self._able[2]
            deflection, motor_side = use.from_deflection & both, use.from_motor & motor_known
            # A joint uses the rigid model if it can no longer use any of the ways that `use` asks for.
            lost = ~(deflection | motor_side) & (use.from_deflection or use.from_motor)
            self._ways[:] = [use.from_dynamics | ~both | lost, deflection, motor_side]
            self._by_deflection[:] = both & motor_known & (use.from_deflection and use.friction_from is _DEFLECTION)
        known, adapts = (self._ways, self._able, self._by_deflection), learn and self.started and use.adaptive
        moving: bool = balance(self._torques, (self._dynamics.recursion.torque, sample.temperature), known, (learn, adapts))
        if self._lost:  # a way without a value takes the fused value, so that it does not seem to contradict the others
            np.copyto(self.transmission.ways, self.transmission.fused, where=~self._ways)
        return moving

    def _made_up(self, sample: Sample) -> tuple[Array, Array, Array] | None:
        """Angles and currents if some are lost: each angle from the other, through the spring; None if a joint has neither."""
        able = np.isfinite(np.stack([sample.theta, sample.q, sample.current]))
        if not (able[0] | able[1]).all():
            self._lost = _names(able)
            return None
        fused = self.transmission.fused
        if not (able == self._able).all():
            self._bending = fused.copy()
            bent = self._theta[0] - self._q[0] if self.started else np.zeros_like(fused)
            fresh = (self._able[0] & self._able[1]) & self.started
            # The part of the deflection that the stiffness does not explain now is kept, so that no angle jumps.
            self._bend = np.where(fresh, bent - self._compliance * fused, self._bend)
            self._able, self._lost, self._use = able, _names(able), None
        # Slowly, because the torque itself is computed from these angles.
        self._bending += self._smooth_bending * (fused - self._bending)
        deflection = self._bend + self._compliance * self._bending
        theta = np.where(able[0], sample.theta, sample.q + deflection)
        q = np.where(able[1], sample.q, sample.theta - deflection)
        spent = (fused + (1.0 - self.friction.output_share) * self.friction.total) / self._own["torque_constant"]
        return theta, q, np.where(able[2], sample.current, spent)

    def _through_motor(self, theta: Array, q: Array, current: Array) -> tuple[Array, Array, Array]:
        """With output angles that are the motors', less a deflection that is taken slowly: see `deflection_rate`."""
        bent = theta - q
        before = bent if self._settled is None or not self.started else self._settled
        self._settled = before + self._settling * (bent - before)
        return theta, theta - self._settled, current

    def _back(self, sample: Sample) -> None:
        """All sensors work again: replaced angles jump to the measured ones, and this makes no speed."""
        self._theta[0], self._q[0] = sample.theta, sample.q
        self._able, self._lost, self._use = np.ones_like(self._able), (), None


def _names(able: NDArray[np.bool_]) -> tuple[tuple[str, int], ...]:
    return tuple((SENSORS[k], int(i)) for k, i in zip(*np.nonzero(~able), strict=True))
