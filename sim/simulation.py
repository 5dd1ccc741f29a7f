"""One tick of all of it: sensors, estimator, supervisor, controller, plant, in this order and no other."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from pendant.all_settings import Settings
from pendant.decision import Decision, EstimatorCommand
from pendant.equipment.tools import Equipment, Tool
from pendant.guided.pull import PullWatch
from pendant.supervisor import Supervisor
from pendant.tick.estimate import Estimate
from pendant.tick.modes import Law
from pendant.tick.motion_status import NO_MOTION
from pendant.tick.pose import Pose
from pendant.tooling.tool_in_use import Fitting
from pendant.walls.definitions import AnyBorder
from sim.arm.arm_file import Arm
from sim.arm.chain import NOTHING, arm_shape, chain, load_body, plate_body, tool_body
from sim.arm.frames import rotation_from_rpy
from sim.arm.scenario import Load, Scenario, table
from sim.collisions.arm_watch import ArmWatch
from sim.control.controller import Controlled, Controller
from sim.control.feedback import following_limit
from sim.estimation.contact_sources import ContactSources
from sim.estimation.estimator import Estimator
from sim.exchange.desk import Wishes
from sim.exchange.scoring import Glance
from sim.exchange.snapshot import Snapshot
from sim.exchange.told_force import told_force
from sim.plant.changes import (
    AnyChange,
    AttachPayload,
    DriveGripper,
    DropPayload,
    FrictionChange,
    MoveObject,
    SensorFault,
    Temperature,
)
from sim.plant.model import Step
from sim.plant.true_arm import Plant
from sim.rigid_body.dynamics import Dynamics
from sim.sensing import calibration
from sim.sensing.sensor_drift import SensorDrift, sensor_spec
from sim.sensing.sensors import Sample, Sensors

Array = NDArray[np.float64]


def known_frames(scenario: Scenario) -> dict[str, Pose]:
    """Poses in B of the world and of its objects, as they are when the robot is set up: what walls can lie in (VW-2)."""
    R_BW = rotation_from_rpy(scenario.mounting).T
    frames = {"world": (np.zeros(3), np.eye(3))}
    frames |= {thing.name: (np.array(thing.position), rotation_from_rpy(thing.rpy)) for thing in scenario.world}
    poses: dict[str, Pose] = {}
    for name, (p, R) in frames.items():
        x, y, z = (R_BW @ p).tolist()
        a, b, c, d, e, f, g, h, i = (R_BW @ R).ravel().tolist()
        poses[name] = Pose((x, y, z), (a, b, c, d, e, f, g, h, i))
    return poses


class Simulation:
    """An arm, its world, its sensors and its controller. Same arguments and same wishes give the same ticks, bit for bit.

    Args:
        arm: the arm's numbers.
        scenario: mounting, tool, payload, world, seed.
        settings: the pendant's.
        step: the physics step.
    """

    def __init__(self, arm: Arm, scenario: Scenario, settings: Settings, step: Step | None = None) -> None:
        self.arm, self.scenario = arm, scenario
        errors, noise, walk = np.random.default_rng(scenario.seed).spawn(3)
        wrench, mismatch = arm.sensors.force_torque, scenario.mismatch
        if mismatch == "nominal":
            self.calibration, drifts = calibration.nominal(arm), None
        else:
            self.calibration = calibration.draw(arm, errors, 1.0 if mismatch == "on" else mismatch)
            drifts = None if wrench is None else wrench.drift
        drift = None if drifts is None else SensorDrift(drifts, self.calibration, walk)
        self.plant = Plant(arm, scenario, step)
        self.sensors = Sensors(arm, self.calibration, noise, drift)
        rigid, tools = chain(arm), tuple(table(scenario))
        used = tools[0]
        self.tcp, self.R_FT = np.array(used.tcp), rotation_from_rpy(used.rpy)
        self._plate = plate = plate_body(arm)
        fixed = Load(mass=plate.mass, com=plate.com.tolist())
        # What the controller takes to be beyond the flange, before a change and after it.
        self._before = self._after = plate + tool_body(used) + load_body(scenario.payload_configured)
        links = calibration.believed(rigid, self.calibration)
        self.dynamics = Dynamics(rigid, links, self._before, mounting=scenario.mounting, elbow=arm.chain.elbow)
        self.estimator = Estimator(arm, self.calibration, self.dynamics, self.tcp)
        self.estimator.set_load(self._before, load_body(scenario.payload_configured))
        self.contact_sources = ContactSources(self.dynamics, arm.chain.elbow, arm.sensors, self.estimator.momentum)
        self.supervisor = Supervisor(
            settings,
            arm.n,
            joints=tuple(arm.chain.joints),
            rated=tuple(arm.limits.torque),
            ranges=tuple(arm.limits.ends),
            speeds=tuple(arm.limits.speed),
            borders=tuple(scenario.walls),
            frames=known_frames(scenario),
            equipment=Equipment(tools, used, scenario.payload_configured, arm.payload, fixed),
            sensor=sensor_spec(arm),
            shape=arm_shape(arm),
        )
        # What passes from one tick to the next.
        self._command = EstimatorCommand(self.supervisor.fitting, use=settings.joint_control, contact=settings.contact)
        self.fitting, self._zeroed = self.supervisor.fitting, self._command.zero
        self._zero: Array | None = None  # until the sensor is zeroed
        self.controller = Controller(arm, self.calibration, self.dynamics, tcp=self.tcp, R_FT=self.R_FT)
        self.watch = ArmWatch(
            self.dynamics,
            self.estimator.momentum,
            arm,
            meter=self.controller.references.meter,
            following=following_limit(arm),
        )
        self._motor = np.array(arm.motors.torque_per_current)
        self._controlled = Controlled(self.dynamics.gravity(self.plant.q) / self._motor, NO_MOTION, None)
        self.sensors.read(self.plant, self._controlled.current)  # as it comes one tick late: what the first tick will know
        self.gripper = self.plant.gripper  # a device of the arm: its object-detected input is a measurement
        self._decision: Decision | None = None
        self._estimate: Estimate | None = None
        self._pulls = PullWatch()

    @property
    def tick_count(self) -> int:
        """Ticks done so far."""
        return self.plant.tick

    @property
    def settings(self) -> Settings:
        """The pendant's settings as they are now."""
        return self.supervisor.settings

    @property
    def tools(self) -> tuple[Tool, ...]:
        """The pendant's table of tools as it is now."""
        return self.supervisor.tools

    @property
    def walls(self) -> tuple[AnyBorder, ...]:
        """The pendant's walls and areas as they are now."""
        return self.supervisor.containment.borders

    @property
    def estimate(self) -> Estimate:
        """What the controller knew in the tick done last; its arrays change with the next.

        Raises:
            RuntimeError: no tick has been done yet.
        """
        if self._estimate is None:
            raise RuntimeError("an estimate needs at least one tick")
        return self._estimate

    def tick(self, wishes: Wishes) -> Decision:
        """One control tick; the only path that data takes (docs/architecture.md).

        Raises:
            KeyError: a touch names a part that does not exist.
        """
        for change in wishes.changes:
            self.apply(change)
        plant, estimator, command, before = self.plant, self.estimator, self._command, self._controlled
        self._prepare(command)
        sample = self.sensors.read(plant, before.current)
        if self._zero is not None:
            sample.wrench -= self._zero  # once: each sample arrives once
        estimate = self._know(sample, command, before)
        gripper, inputs = self.gripper, wishes.inputs
        if gripper is not None and gripper.detected_input is not None:
            inputs = replace(inputs, high=inputs.high | {gripper.detected_input})
        decision = self.supervisor.step(estimate, inputs, before.status)
        friction, stiffer = estimator.friction, estimator.transmission.stiffer
        self._controlled = now = self.controller.update(
            estimate, decision, estimator.jacobian, friction=friction, stiffer=stiffer, use=command.use
        )
        if gripper is not None:
            gripper.wired(_outputs(decision) if wishes.outputs is None else wishes.outputs)
        plant.advance(now.current * self._motor, wishes.touches, decision.law is _OFF)
        self._estimate, self._decision, self._command = estimate, decision, decision.estimator
        self._pulls.step(decision.pull)
        return decision

    def _prepare(self, command: EstimatorCommand) -> None:
        """Tool, payload and zero as they were decided: between two ticks, all at once."""
        if command.fitting is not None and command.fitting != self.fitting:
            self.fit(command.fitting)
        if command.zero != self._zeroed:
            self._zeroed, self._zero = command.zero, np.array(command.zero)
            self.contact_sources.set_zero(self._zero)
            self.watch.set_zero(self._zero)

    def _know(self, sample: Sample, command: EstimatorCommand, before: Controlled) -> Estimate:
        """All that the controller knows in this tick, put together from those who estimate it.

        Args:
            sample: this tick's measurements, of which the zero has been taken.
            command: of the last decision.
            before: what the controller did in the last tick.
        """
        estimator, answered, free = self.estimator, before.answered, command.bias is not None
        # Learned is from planned motion alone: an arm that is freed, or held and yet moves, is moved by a hand, and on a link no
        # sensor tells its force; what stops it may be one as well.
        learn = command.planned and not before.status.commanded
        estimate = estimator.update(sample, command, answered=answered, learn=learn)
        estimate.signals = self.contact_sources.read(sample, estimate, estimator.jacobian, command.contact, looks=command.looks)
        wanted = answered.q if answered is not None and estimator.started else None
        watched = self.watch.read(sample, estimate, wanted, free=free)
        estimate.clipped, estimate.link_force, estimate.following, estimate.motion = watched
        return estimate

    @property
    def current(self) -> Array:
        """Motor currents (n,) of the tick done last [A]."""
        return self._controlled.current

    def rest(self, seconds: float) -> None:
        """Let time pass without physics: nobody touches the arm, and nothing of it moves.

        The clocks, the zero of the flange sensor and the temperatures of the joints go on by their own models. All else stays as
        it is: what the controller holds and knows, the periods that run, the samples on their way.

        It is for an arm that is held: to one in free-drive all that a zero moved meanwhile is a step of its sensor.

        Args:
            seconds: whole seconds.

        Raises:
            ValueError: not whole, or negative.
        """
        if not float(seconds).is_integer() or seconds < 0:
            raise ValueError(f"a rest of {seconds:g} s: expected whole seconds, 0 or more")
        plant = self.plant
        before = plant.tick
        self.sensors.rest(before, int(seconds), plant.step.tick)
        plant.rest(int(seconds))
        self.estimator.tick += plant.tick - before

    def fit(self, fitting: Fitting) -> None:
        """Make this the tool and the payload that the controller believes in: between two ticks, all at once.

        Args:
            fitting: as the supervisor decided.
        """
        if fitting.number != self.fitting.number:
            self._before = self.dynamics.load
            self.estimator.transmission.forget()
            self.tcp[:], self.R_FT[:] = fitting.tool.tcp, rotation_from_rpy(fitting.tool.rpy)
            self._after = self._plate + tool_body(fitting.tool) + load_body(fitting.load)
        self.fitting = fitting
        body = self._after if fitting.share == 1.0 else self._before.blend(self._after, fitting.share)
        self.dynamics.set_load(body)
        self.estimator.set_load(body, load_body(fitting.load) if fitting.share == 1.0 else NOTHING)  # a ramp's is not there yet
        self.contact_sources.set_load(body)

    def apply(self, change: AnyChange) -> None:
        """Change the true arm or world, as a laboratory does.

        Raises:
            KeyError: the change names a joint or object that does not exist.
        """
        plant = self.plant
        if isinstance(change, AttachPayload):
            plant.payload.attach(change.load)
        elif isinstance(change, DropPayload):
            plant.drop()
        elif isinstance(change, SensorFault):
            self.sensors.fault(change)
        elif isinstance(change, FrictionChange):
            plant.wear(self._joints(change.joint), change.factor)
        elif isinstance(change, Temperature):
            plant.temperature[self._joints(change.joint)] = change.celsius
        elif isinstance(change, MoveObject):
            if plant.gripper is not None and plant.gripper.state.held == change.name:
                plant.gripper.drop()
            plant.world.place(change.name, change.position)
        elif isinstance(change, DriveGripper):
            if plant.gripper is None:
                raise KeyError("a gripper: the tool that is mounted has none")
            plant.gripper.order(change)

    def _joints(self, name: str | None) -> slice | int:
        if name is None:
            return slice(None)
        if name not in self.arm.chain.joints:
            raise KeyError(f"joint {name!r}: there are {', '.join(self.arm.chain.joints)}")
        return self.arm.chain.joints.index(name)

    def glance(self) -> Glance:
        """What scoring reads of the last tick, in place."""
        return Glance(self)  # one that is kept would keep what the simulation holds until Python looks for circles

    def snapshot(self) -> Snapshot:
        """What pictures and logs need of the last tick, copied.

        Raises:
            RuntimeError: no tick has been done yet.
        """
        if self._decision is None or self._estimate is None:
            raise RuntimeError("a snapshot needs at least one tick")
        plant = self.plant
        return Snapshot(
            plant.tick,
            self._decision,
            self._estimate.copy(),
            plant.poses(),
            plant.object_poses(),
            plant.payload.pose(),
            plant.payload.load.mass,
            self.fitting.mass,
            plant.hands.touched,
            self.controller.references.wanted(),
            plant.q.copy(),
            plant.sliding_friction(),
            plant.tau_J.copy(),
            plant.temperature.copy(),
            plant.touched,
            self.scenario,
            self._reference(),
            self.supervisor.containment.every_place(self.settings.walls),
            self._pulls.shown,
            told_force(self.arm, self._estimate, self._decision),
            None if plant.gripper is None else plant.gripper.state,
        )

    def _reference(self) -> Array | None:
        now = self.controller.references.now
        return None if now is None or self._decision is None or self._decision.law is Law.FREE else now.q.copy()


def _outputs(decision: Decision) -> int:
    """Digital outputs that the robot's program has on, as bits."""
    return sum(1 << number for number in decision.outputs) | (decision.tool_on << TOOL_OUTPUT)


TOOL_OUTPUT = 16
"""Bit of the tool's first digital output."""

_OFF = Law.OFF  # looked up in every tick
