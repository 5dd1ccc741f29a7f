"""The safety inputs: emergency stop, safeguard, REDUCED, lost motor angles, and the reset after a stop (FD-1, RL-7)."""

from pendant.all_settings import Settings
from pendant.events.event import Event, Kind, Values
from pendant.inputs import Command
from pendant.limits.validity import JOINTS_SENSED, joints_ok, motion_ok
from pendant.robot.robot_mode import Robot
from pendant.safety.collision import Collisions
from pendant.safety.following import left_path
from pendant.safety.robot_limits import ArmRating, LimitWatch, RobotLimits
from pendant.settings.schema import ticks
from pendant.tick.estimate import Estimate
from pendant.tick.modes import Mode, Phase, Safety

BLIND, BLIND_MOVING = ticks(0.1), ticks(0.02)
"""A motor angle that is out for so long is lost: the arm is stopped, and its brakes hold it. A shorter gap is one of the bus.

An arm that stood keeps its torques and waits longer. One that moved has a joint that nothing controls, and what pushes turns it.
"""


class SafetyInputs:
    """Their levels, and what they do to the robot."""

    __slots__ = ("_beyond", "_blind", "_collisions", "_input", "_joints", "_limits", "_robot", "_safeguard", "_stood")

    def __init__(self, robot: Robot, rating: ArmRating) -> None:
        """
        Args:
            robot: that they act on.
            rating: what its joints are made for; their names are used in events.
        """
        self._robot, self._joints = robot, rating.names
        self._limits = LimitWatch(rating)
        self._collisions = Collisions(rating.names)
        self._safeguard = False  # it is open
        self._input = False  # level of the input of REDUCED
        self._beyond = ""  # name of the area beyond which REDUCED holds
        self._blind = 0  # ticks for which some motor angle has been out
        self._stood = False  # the arm did, when all motor angles were last there

    def limits(self, settings: Settings) -> RobotLimits | None:
        """The robot's limits that hold, None where they are switched off."""
        return self._limits.limits(settings.robot_limits)

    def step(
        self, estimate: Estimate, commands: tuple[Command, ...], settings: Settings, events: list[Event], *, held: bool
    ) -> None:
        """The commands of a tick; `held`: the free-drive button is."""
        self._take_levels(estimate.tick, commands, settings, events)
        stop = Command.EMERGENCY_STOP in commands
        if stop:
            if self._robot.safety is not Safety.EMERGENCY_STOP:
                event = Event(Kind.EMERGENCY_STOP, estimate.tick, {"mode": self._robot.mode})
                self._robot.happen(event, settings, events)
        elif Command.EMERGENCY_STOP_RELEASED in commands and self._robot.safety is Safety.EMERGENCY_STOP:
            self._robot.safety = Safety.SAFEGUARD_STOP if self._safeguard else self._resting
            events.append(Event(Kind.EMERGENCY_STOP_RELEASED, estimate.tick))
        if Command.PROTECTIVE_STOP in commands and self._robot.safety < Safety.PROTECTIVE_STOP:
            event = Event(Kind.PROTECTIVE_STOP, estimate.tick, {"mode": self._robot.mode})
            self._robot.happen(event, settings, events)
        if Command.POWER_OFF in commands and not self._robot.stopping.off:
            self._robot.happen(Event(Kind.POWERED_OFF, estimate.tick, {"mode": self._robot.mode}), settings, events)
        if Command.RESET in commands:
            self._reset(estimate, settings, events, stop=stop, held=held)

    def watch(self, estimate: Estimate, settings: Settings, events: list[Event], *, asked: bool, beyond: str) -> None:
        """Every tick: REDUCED beyond an area that triggers it, and the stop of an arm that should not go on.

        It is stopped where a motor angle is lost, it does not follow, hits something, or exceeds a limit of the robot.

        Args:
            estimate: of this tick.
            settings: as they are now.
            events: of this tick; more are added.
            asked: a program asked for contact.
            beyond: name of the area that triggers REDUCED because a part of the arm is beyond it, "" for none.
        """
        if beyond != self._beyond:
            self._beyond = beyond
            self._reduce(estimate.tick, settings, events)
        unseen = [joint for sensor, joint in estimate.lost if sensor == "motor_encoder"] if estimate.lost else []
        self._blind = self._blind + 1 if unseen else 0
        if not unseen:
            self._stood = self._robot.static
        if self._blind == (BLIND if self._stood else BLIND_MOVING):
            event = Event(Kind.MOTOR_ANGLE_LOST, estimate.tick, {"joint": self._joints[unseen[0]]})
            self._robot.happen(event, settings, events)
        robot = self._robot
        hit = None
        guided = robot.mode is _FREE_DRIVE or robot.free.phase is _SEQUENCE
        if robot.mode is _STOP or guided:
            self._collisions.rest()
        else:
            forces = self._limits.forces(settings.robot_limits)
            presses = robot.move is None or asked
            hit = self._collisions.step(estimate, settings.collision, moves=not presses, most=forces)
        if robot.mode is _STOP:
            self._limits.rest(settings.robot_limits)
            return
        stop = hit or self._left_path(estimate, settings)
        if stop is None and not robot.braking:  # an arm that has left free-drive is braked as a stop would brake it
            stop = self._limits.step(estimate, settings.robot_limits, moves=robot.move is not None and not guided)
            if stop is not None and not motion_ok(estimate):
                return  # lost sensors are told by themselves
        if stop is not None:
            robot.happen(stop, settings, events)

    def _left_path(self, estimate: Estimate, settings: Settings) -> Event | None:
        """The event of an arm that does not follow, with what holds it."""
        collisions = self._collisions
        return left_path(estimate, settings.following, self._joints, lambda: collisions.holding(estimate, settings.collision))

    @property
    def _resting(self) -> Safety:
        """The safety mode where nothing has stopped the robot."""
        return Safety.REDUCED if self._limits.reduced else Safety.NORMAL

    def _take_levels(self, tick: int, commands: tuple[Command, ...], settings: Settings, events: list[Event]) -> None:
        """Safeguard and REDUCED: open and REDUCED win over their opposites in the same tick."""
        robot = self._robot
        if Command.SAFEGUARD_OPEN in commands:
            if not self._safeguard:
                self._safeguard = True
                robot.happen(Event(Kind.SAFEGUARD_STOP, tick, {"mode": robot.mode}), settings, events)
        elif Command.SAFEGUARD_CLOSED in commands and self._safeguard:
            self._safeguard = False
            events.append(Event(Kind.SAFEGUARD_CLOSED, tick))
        if Command.REDUCED_ON in commands:
            self._input = True
        elif Command.REDUCED_OFF in commands:
            self._input = False
        self._reduce(tick, settings, events)

    def _reduce(self, tick: int, settings: Settings, events: list[Event]) -> None:
        """REDUCED while the input asks for it or a part is beyond an area that triggers it."""
        robot, limits = self._robot, settings.robot_limits
        if self._limits.switch(self._input or bool(self._beyond), limits):
            if self._limits.reduced:
                speeds = self._limits.reduced_limits(limits).speeds
                cause = "the input" if self._input else f"area {self._beyond}"
                values: Values = {"cause": cause, "tcp": speeds.tcp, "elbow": speeds.elbow, "joint_speed": max(speeds.joints)}
                events.append(Event(Kind.REDUCED_ON, tick, values))
            else:
                events.append(Event(Kind.REDUCED_OFF, tick))
        if robot.safety <= Safety.REDUCED:
            robot.safety = self._resting

    def _reset(self, estimate: Estimate, settings: Settings, events: list[Event], *, stop: bool, held: bool) -> None:
        robot = self._robot
        if stop:
            robot.refuse(Command.RESET, estimate, "the emergency stop was pressed at the same time", events)
        elif robot.mode is not Mode.STOP:
            robot.refuse(Command.RESET, estimate, "nothing to reset", events)
        elif held:
            events.append(Event(Kind.RESET_REFUSED_SIGNAL, estimate.tick))
        elif self._safeguard:
            events.append(Event(Kind.RESET_REFUSED_SAFEGUARD, estimate.tick))
        elif not joints_ok(estimate):
            events.append(Event(Kind.RESET_REFUSED_SENSORS, estimate.tick, {"sensor": JOINTS_SENSED}))
        elif not robot.static:
            events.append(Event(Kind.RESET_REFUSED_MOVING, estimate.tick, robot.still.moves(self._joints, settings.static)))
        else:
            robot.reset(self._resting)
            events.append(Event(Kind.RESET, estimate.tick))


_STOP, _FREE_DRIVE, _SEQUENCE = Mode.STOP, Mode.FREE_DRIVE, Phase.SEQUENCE  # looked up in every tick
