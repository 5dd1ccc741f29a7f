"""Tool and payload in the running robot: changed, and measured by an arm that turns its wrist by itself."""

from enum import StrEnum

import numpy as np

from pendant.all_settings import Settings
from pendant.equipment.payload_fit import LEAST
from pendant.events.event import Event, Kind
from pendant.inputs import Command, Inputs
from pendant.limits.validity import JOINTS_SENSED, WrenchMean, motion_ok, wrench_ok
from pendant.program.steps import JointMove
from pendant.robot.requests import Calls
from pendant.robot.robot_mode import Robot
from pendant.safety.robot_limits import SpeedLimits
from pendant.settings.schema import ticks
from pendant.tick.estimate import Estimate
from pendant.tick.modes import Mode, Phase, way_out
from pendant.tick.motion_status import MotionStatus
from pendant.tick.pose import from_rpy
from pendant.tooling.arm_shape import ArmShape
from pendant.tooling.tool_in_use import Tooling
from pendant.tooling.turn_watch import SLOW_ELBOW, SLOW_JOINT, SLOW_TOOL, TurnWatch
from pendant.tooling.wrist_postures import WANTED, best_first, candidates
from pendant.tooling.wrist_room import WRIST, Obstacle, WristRoom
from pendant.walls.containment import Containment

KEPT = 0.85
"""Share of the speeds that stop the wizard which it keeps within: what the measurement adds, and swinging, stays below them."""

SLOW = KEPT * SLOW_TOOL, KEPT * SLOW_ELBOW, KEPT * SLOW_JOINT  # of tool and elbow [m/s], and of a joint [rad/s]

GENTLE = 0.1
"""Share of a joint's acceleration with which the wrist is turned."""

SETTLING = ticks(0.3)
"""After a turn the arm stands for so long before it is measured."""

LOOKS = 25
"""Postures of a way that are looked at."""

TRIES = 3
"""Of a posture, which a hand may disturb."""


class WizardStage(StrEnum):
    """What the wizard does by itself."""

    NONE = ""
    SEEKING = "seeks the next posture"
    TURNING = "turns the wrist"
    SETTLING = "waits for the arm to stand"
    MEASURING = "measures"
    RETURNING = "turns the wrist back"


class Equipping:
    """Steers `Tooling` by what the robot does.

    Args:
        tooling: of tool and payload.
        robot: that carries them.
        mean: of F_user.
        calls: that feel the user's hand.
        containment: what must know how the tool is turned, and knows the walls.
        shape: of the arm; None: nothing is known of it, and the wizard turns nothing by itself.
    """

    NOT_STATE = ("_shape", "_room")  # the one never changes, the other follows from the state where it is made

    def __init__(
        self, tooling: Tooling, robot: Robot, mean: WrenchMean, calls: Calls, *, containment: Containment, shape: ArmShape | None
    ) -> None:
        self._tooling, self._robot, self._mean, self._calls, self._containment = tooling, robot, mean, calls, containment
        self._shape = shape
        self._room: WristRoom | None = None
        self._stage = WizardStage.NONE
        self._begin = np.zeros(0)  # posture in which it began (n,) [rad]
        self._seen = np.zeros((0, 0))  # postures to try, the best first (m, n) [rad]
        self._next = 0  # of them
        self._near: Obstacle | None = None  # the first that was in the way of the last search
        self._watch = TurnWatch()
        self._left = 0  # ticks to settle
        self._tries = 0
        self._turn_tool()

    @property
    def moving(self) -> bool:
        """The wizard moves the arm."""
        return self._robot.turn is not None

    def limits(self, usual: SpeedLimits | None) -> SpeedLimits | None:
        """What the control law keeps the arm within: what it usually does, and less while the wizard moves it."""
        if not self.moving:
            return usual
        tool, elbow, joint = SLOW
        if usual is None:
            return SpeedLimits(tool, elbow, (joint,) * self._begin.size)
        joints = tuple([min(joint, most) for most in usual.joints])
        return usual._replace(tcp=min(tool, usual.tcp), elbow=min(elbow, usual.elbow), joints=joints)

    def step(
        self,
        estimate: Estimate,
        inputs: Inputs,
        settings: Settings,
        events: list[Event],
        *,
        status: MotionStatus,
        mode: Mode,
    ) -> None:
        """One tick.

        Args:
            estimate: of this tick.
            inputs: of this tick.
            settings: as they are now.
            events: of this tick; more are added.
            status: what the control law did in the last tick.
            mode: that says whether tool and payload may be changed.
        """
        robot, tooling = self._robot, self._tooling
        told = tooling.step(estimate, inputs, settings.tools, mode=mode, phase=robot.free.phase, still=robot.static)
        events += told
        if tooling.changing:
            self._calls.relearn()
            robot.free.forget()
            self._turn_tool()
        if self._stage:
            reason = self._against(estimate, inputs)
            if reason:
                self._stop(reason, estimate.tick, events)
            else:
                self._go_on(estimate, settings, told, events, status=status)
        elif inputs.commands and Command.WIZARD_RUN in inputs.commands:
            self._ask(estimate, settings, inputs, events)

    def _turn_tool(self) -> None:
        """Who needs to know how the tool centre point is turned in the flange."""
        self._containment.R_FT = self._robot.sequencer.R_FT = from_rpy(*self._tooling.fitting.tool.rpy)

    def _ask(self, estimate: Estimate, settings: Settings, inputs: Inputs, events: list[Event]) -> None:
        """Somebody wants the payload to be measured."""
        robot, tooling = self._robot, self._tooling
        reason = self._against(estimate, inputs)
        if not reason:
            if self._shape is None or len(self._shape.names) < WRIST + 1:
                reason = "nothing is known of the arm's shape"
            elif tooling.changing:
                reason = "the payload is being changed"
            elif not robot.static:
                reason = "the arm moves"
        if reason or self._shape is None:
            events.append(Event(Kind.WIZARD_REFUSED, estimate.tick, {"reason": reason}))
            return
        walls = tuple([(border, place) for border, place in self._containment.every_place(settings.walls) if border.keeps])
        self._begin = estimate.q.copy()
        self._room = WristRoom(self._shape, self._begin, tooling.fitting.tool, settings.tools, borders=walls)
        self._watch.begin(estimate, self._mean.mean()[:3])
        tooling.wizard.clear()
        tooling.busy = True
        events.append(Event(Kind.WIZARD_STARTED, estimate.tick))
        self._settle()

    def _against(self, estimate: Estimate, inputs: Inputs) -> str:
        """Why the arm must not turn its wrist by itself now, or ""."""
        robot = self._robot
        if robot.mode not in (Mode.NORMAL, Mode.TEACH):
            return way_out(robot.mode)
        if Command.WIZARD_CLEAR in inputs.commands:
            return "as asked"
        if robot.free.phase is not Phase.OFF:
            return "free-drive is being tried"
        if inputs.jog is not None or robot.jog is not None:
            return "the arm is jogged"
        if not robot.enabled:
            return f"enabling device {robot.grip}: hold it in its middle position"
        if not motion_ok(estimate):
            return f"check {JOINTS_SENSED}"
        if not wrench_ok(estimate):
            return "the flange force sensor is not valid"
        return self._watch.step(estimate, self._mean.mean()[:3]) if self._stage else ""

    def _go_on(
        self, estimate: Estimate, settings: Settings, told: list[Event], events: list[Event], *, status: MotionStatus
    ) -> None:
        """One tick in which nothing is against it."""
        robot, wizard = self._robot, self._tooling.wizard
        if robot.turn is not None:
            if status.refused:
                self._stop(status.refused, estimate.tick, events)
            elif status.done == robot.turn.id:
                self._arrive(estimate, events)
        elif self._stage is WizardStage.SEEKING:
            self._seek(estimate, events)
        elif self._stage is WizardStage.SETTLING:
            self._left -= robot.static
            if self._left == 0:
                self._become(WizardStage.MEASURING)
                events += wizard.begin(estimate, ticks(settings.tools.measure), "")
        elif wizard.left == 0:
            refused = [str(event.values["reason"]) for event in told if event.kind is Kind.POSTURE_REFUSED]
            if not refused:
                self._measured(estimate)
            elif self._tries == TRIES:
                self._stop(refused[0], estimate.tick, events)
            else:
                self._settle(self._tries)

    def _measured(self, estimate: Estimate) -> None:
        """Another posture is measured: look for the next, or go back."""
        assert self._shape is not None
        measured, self._near, self._next = self._tooling.wizard.measured, None, 0
        self._seen = np.zeros((0, self._begin.size))
        if len(measured) < WANTED:
            self._seen = best_first(self._shape, candidates(self._begin), estimate.q, estimate.g_B, measured=measured)
        self._become(WizardStage.SEEKING)

    def _seek(self, estimate: Estimate, events: list[Event]) -> None:
        """One posture a tick, for a way takes a part of a tick to look at; without one the wizard is done."""
        if self._next < len(self._seen):
            posture = self._seen[self._next]
            self._next += 1
            self._try(estimate, posture, WizardStage.TURNING)
        elif len(self._tooling.wizard.measured) >= LEAST:
            self._try(estimate, self._begin, WizardStage.RETURNING)
            if self._stage is WizardStage.SEEKING and self._near is not None:
                self._stop(f"no room on the way back: {self._near.what} is too near", estimate.tick, events)
        else:
            why = f"room for {len(self._tooling.wizard.measured)} of {LEAST} postures"
            near = "" if self._near is None else f", {self._near.what} is too near"
            self._stop(f"{why}{near}; move the arm away", estimate.tick, events)

    def _try(self, estimate: Estimate, posture: np.ndarray, stage: WizardStage) -> None:
        """Turn to a posture if there is room on the way to it, and from it to where it began."""
        assert self._room is not None
        shares = np.linspace(0.0, 1.0, LOOKS)[:, None]
        there, back = estimate.q + shares * (posture - estimate.q), posture + shares * (self._begin - posture)
        near = self._room.obstacle(there) or self._room.obstacle(back)
        if near is not None:
            self._near = self._near or near
            return
        self._robot.turn = JointMove(id=self._robot.number(), q=tuple(posture.tolist()), acceleration=GENTLE)
        self._become(stage)

    def _arrive(self, estimate: Estimate, events: list[Event]) -> None:
        self._robot.turn = None
        self._robot.braking = True
        if self._stage is WizardStage.TURNING:
            self._settle()
            return
        self._end()
        events.append(Event(Kind.WIZARD_FINISHED, estimate.tick, {"postures": self._tooling.wizard.progress.postures}))

    def _settle(self, tries: int = 0) -> None:
        self._left, self._tries = SETTLING, tries + 1
        self._become(WizardStage.SETTLING)

    def _become(self, stage: WizardStage) -> None:
        self._stage = stage
        self._tooling.wizard.say(stage.value)

    def _stop(self, reason: str, tick: int, events: list[Event]) -> None:
        """The arm comes to rest where it is; what is measured is kept."""
        if self._robot.turn is not None:
            self._robot.turn, self._robot.braking = None, True
        self._end()
        events.append(Event(Kind.WIZARD_STOPPED, tick, {"reason": reason}))

    def _end(self) -> None:
        self._become(WizardStage.NONE)
        self._room = None
        self._tooling.busy = False
