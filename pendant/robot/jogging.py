"""Jogging in TEACH and NORMAL: the arm moves while a button is held, and comes to rest when that is let go or silent."""

from msgspec.structs import replace

from pendant.all_settings import Settings
from pendant.events.event import Event, Kind, Values
from pendant.inputs import Inputs
from pendant.limits.validity import JOINTS_SENSED, motion_ok
from pendant.program.jog_move import Jogged, JogPlace, unfit
from pendant.robot.robot_mode import Robot
from pendant.settings.schema import ticks
from pendant.signals.keep_alive import KeepAlive
from pendant.tick.estimate import Estimate
from pendant.tick.modes import Mode, Phase, way_out
from pendant.tick.motion_status import MotionStatus

JOGGED_IN = frozenset({Mode.NORMAL, Mode.TEACH})


class Jogging:
    """One press of a jog button at a time: what ends it needs a new press."""

    __slots__ = ("_asked", "_held", "_n", "_robot", "_spent", "_start")

    def __init__(self, robot: Robot, n_joints: int) -> None:
        self._robot, self._n = robot, n_joints
        self._held = KeepAlive()
        self._asked: Jogged | None = None  # of the press that lasts
        self._spent = False  # this press has ended, and has to be let go first
        self._start: JogPlace | None = None  # where the arm began to be jogged

    def step(
        self,
        estimate: Estimate,
        inputs: Inputs,
        settings: Settings,
        events: list[Event],
        *,
        status: MotionStatus,
        changing: bool,
    ) -> None:
        """One tick.

        Args:
            estimate: of this tick.
            inputs: of this tick.
            settings: as they are now.
            events: of this tick; more are added.
            status: what the control law did in the last tick.
            changing: the configured payload is being changed.
        """
        held, wish = self._held, inputs.jog
        if not held.held and wish is None:
            return
        pressed = not held.held
        silence = ticks(settings.hold.silence)
        silent = held.step(wish is not None, inputs.jog_released, silence)
        if not held.held:
            self._end("no word from the button" if silent else "let go", estimate, events)
            self._asked, self._spent = None, False
            return
        if wish is not None and wish != self._asked:
            if not pressed:
                self._end("another button", estimate, events)
            self._asked, self._spent = wish, False
        if self._spent:
            return
        against = self._against(estimate, changing)
        if self._robot.jog is not None:
            done = status.done == self._robot.jog.id
            reason = "done" if done else status.refused or against
            if reason:
                self._end(reason, estimate, events)
                self._spent = True
        elif against:
            assert self._asked is not None
            self._spent = True
            events.append(Event(Kind.JOG_REFUSED, estimate.tick, {"what": self._asked.what, "reason": against}))
        elif self._robot.static:  # else it still comes to rest from what was before
            self._begin(estimate, events)

    def _begin(self, estimate: Estimate, events: list[Event]) -> None:
        assert self._asked is not None
        self._robot.jog, self._start = replace(self._asked, id=self._robot.number()), JogPlace.of(estimate)
        events.append(Event(Kind.JOG_STARTED, estimate.tick, {"what": self._asked.what}))

    def _end(self, reason: str, estimate: Estimate, events: list[Event]) -> None:
        """The arm comes to rest, if it was jogged."""
        move, start = self._robot.jog, self._start
        self._robot.jog = self._start = None
        if move is not None and start is not None:
            self._robot.braking = True
            values: Values = {"what": move.what, "moved": move.moved(start, JogPlace.of(estimate)), "reason": reason}
            events.append(Event(Kind.JOG_ENDED, estimate.tick, values))

    def _against(self, estimate: Estimate, changing: bool) -> str:
        """Why the arm must not be jogged now, or ""."""
        robot, asked = self._robot, self._asked
        assert asked is not None
        if robot.mode not in JOGGED_IN:
            return way_out(robot.mode)
        if robot.free.phase is not Phase.OFF:
            return "free-drive is being tried"
        if not robot.enabled:
            return f"enabling device {robot.grip}: hold it in its middle position"
        if not motion_ok(estimate):
            return f"check {JOINTS_SENSED}"
        if changing:
            return "the payload is being changed"
        return unfit(asked, self._n) or ""
