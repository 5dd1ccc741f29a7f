"""Every source of an activation signal, one tick at a time: what is present, and whether a hand gives it (FD-5)."""

import math
from typing import NamedTuple

from pendant.limits.parameters import beyond_gravity
from pendant.settings.schema import ticks
from pendant.signals.contact_free_baseline import Untouched
from pendant.signals.gestures import PatternSignal, PostureSignal, StepSignal, TapSignal, TurnSignal
from pendant.signals.joint_push import JointPushSignal
from pendant.signals.push_signal import PushSignal, TwistSignal
from pendant.signals.settings import LetGo, SignalSettings
from pendant.tick.estimate import Estimate
from pendant.tick.pose import flat

ANOTHER_POSTURE = 0.05
"""A joint that has moved by more, while the arm was not held, makes the untouched state another [rad]; of the joints also when
it came back, for what is known of the gears' errors has changed on the way."""

LEVER = 5.0
"""A torque at the flange is as good a sign of a hand as the force on a lever of 0.2 m [1/m]."""

TOLD_AFTER = ticks(0.1)
"""A push is told when it has lasted so long (FD-6a)."""


class Presence(NamedTuple):
    """The activation signal of one tick."""

    source: str = ""  # "button", "digital input", "push", ...; "": there is none
    by_hand: bool = False  # a hand on the arm gives it
    whole: bool = False  # it has been given completely: nothing has to stay present


NONE = Presence()
BUTTON = Presence("button")
DIGITAL = Presence("digital input")
PRESSES = Presence("presses in a row", whole=True)
POSTURE = Presence("posture", by_hand=True)
SERIES = Presence("series of postures", by_hand=True, whole=True)
REMOTE_CONTROLLER = Presence("remote controller")
"""The program on the other side of the network asks for free-drive."""

PROGRAM = Presence("program", whole=True)
"""A step of a program asks for the arm to be guided by hand (CD-15)."""


class Sources:
    """All sources, and what they share: the untouched state of wrench and joints."""

    __slots__ = (
        "_held_at",
        "_joints",
        "_moved",
        "_off",
        "_pattern",
        "_posture",
        "_push",
        "_quiet",
        "_step",
        "_tap",
        "_told",
        "_turn",
        "_twist",
        "_wrench",
    )

    def __init__(self, n: int) -> None:
        """`n` joints."""
        self._wrench = Untouched((1.0, 1.0, 1.0, LEVER, LEVER, LEVER), 3.0, 0.015)
        self._joints = JointPushSignal(n)
        self._push = PushSignal()
        self._twist = TwistSignal()
        self._pattern = PatternSignal()
        self._step = StepSignal()
        self._tap = TapSignal()
        self._turn = TurnSignal()
        self._posture = PostureSignal()
        self._held_at: list[float] = []  # joint angles when the arm was last held [rad]
        self._moved = False  # since then a program has moved the arm, or it has been in another posture
        self._quiet = 0  # ticks for which it has been held
        self._off = 0  # ticks for which no hand is felt
        self._told = 0  # ticks of the push, for FD-6a

    def refresh(self, use: SignalSettings) -> None:
        """The settings are new: what a source felt that is off is over, and it begins afresh when it is on again."""
        pushing, by_wrench = _asked(use)
        if not by_wrench:
            self._wrench.restart()
        if not pushing:
            self._push = PushSignal()
        if not use.twist.on:
            self._twist = TwistSignal()
        if not use.pattern.on:
            self._pattern = PatternSignal()
        if not use.force_step.on:
            self._step = StepSignal()
        if not use.joints.on:
            self._joints.restart()
        if not use.turn.on:
            self._turn = TurnSignal()
        if not use.posture.on:
            self._posture = PostureSignal()
        if not use.tap.on:
            self._tap = TapSignal()
        if not (by_wrench or use.joints.on or use.turn.on or use.posture.on or use.tap.on):
            self._held_at, self._quiet = [], 0  # nobody looks at postures and motions meanwhile

    def step(
        self, estimate: Estimate, use: SignalSettings, *, wrench_ok: bool, joints_ok: bool, holding: bool, running: bool
    ) -> Presence:
        """One tick: the first source that is on and present, pendant and inputs aside.

        Args:
            estimate: of this tick.
            use: settings.
            wrench_ok: the user's wrench is valid and finite.
            joints_ok: the joint values are valid and finite.
            holding: the arm is held in its posture; only then is a change a hand's for sure.
            running: a program runs.
        """
        self._quiet = self._quiet + 1 if holding else 0
        if joints_ok:
            self._settle(estimate, holding, running)
        found = NONE
        pushing, by_wrench = _asked(use)
        if not (pushing and wrench_ok):
            self._told = 0
        if by_wrench:
            if wrench_ok:
                found = self._by_wrench(estimate, pushing, use)
            else:
                self._lose()
        if use.joints.on:
            if not joints_ok:
                self._joints.restart()
            elif self._joints.step(estimate.tau_ext.tolist(), use.joints) and not found.source:
                found = Presence("push felt by joints", by_hand=True)
        if joints_ok:
            turned = self._by_angles(estimate, use, holding)
            found = found if found.source else turned
        if use.tap.on and estimate.acceleration_valid:
            acceleration = beyond_gravity(estimate)
            if math.isfinite(acceleration) and self._tap.step(acceleration, use.tap) and not found.source:
                found = Presence("tap", by_hand=True, whole=True)
        return found if holding else NONE

    def pushed(self) -> tuple[float, float, float] | None:
        """The force of a push that is to be told in this tick (FD-6a), axes of B [N]."""
        if self._told != TOLD_AFTER:
            return None
        x, y, z = self._wrench.change[:3]
        return x, y, z

    def hand_off(self, use: LetGo, wrench_ok: bool) -> bool:
        """No hand has been felt for as long as it takes (FD-8a). One tick, while that is asked."""
        touched = self._joints.touched or self._turn.present or self._posture.touched
        if wrench_ok and not touched:
            x, y, z, tx, ty, tz = self._wrench.change
            torque = math.sqrt(tx * tx + ty * ty + tz * tz)
            touched = max(math.sqrt(x * x + y * y + z * z), LEVER * torque) >= use.force
        self._off = 0 if touched else self._off + 1
        return self._off > ticks(use.time)

    @property
    def touched(self) -> bool:
        """A hand was felt when `hand_off` was asked last, be it less than a signal."""
        return self._off == 0

    def force(self) -> float:
        """Change of the force at the flange [N]."""
        x, y, z = self._wrench.change[:3]
        return math.sqrt(x * x + y * y + z * z)

    def _settle(self, estimate: Estimate, holding: bool, running: bool) -> None:
        """After a motion, learn the untouched state of the new posture; of the joints also where it is the old one."""
        if not holding:
            self._moved = self._moved or running or self._elsewhere(estimate)
        elif self._quiet == 1 or not self._held_at:
            elsewhere = self._elsewhere(estimate)
            if elsewhere:
                self._wrench.restart()
            if elsewhere or self._moved:
                self._joints.restart()
            self._held_at, self._moved = estimate.q.tolist(), False

    def _elsewhere(self, estimate: Estimate) -> bool:
        """The posture is not that in which the arm was last held."""
        then = self._held_at
        return not then or max(map(abs, map(float.__sub__, estimate.q.tolist(), then))) > ANOTHER_POSTURE

    def relearn(self) -> None:
        """Learn the untouched state afresh."""
        self._lose()
        self._joints.restart()

    def _lose(self) -> None:
        """What was felt at the flange is over: its sensor is not valid, or the load is another."""
        self._wrench.restart()
        self._push.present = self._twist.present = self._step.present = False

    def _by_angles(self, estimate: Estimate, use: SignalSettings, holding: bool) -> Presence:
        """What joints say that are turned against their hold."""
        found = NONE
        if use.posture.on and self._posture.step(estimate.q.tolist(), holding, use.posture):
            found = POSTURE if use.posture.together else SERIES
        if use.turn.on and use.turn.joint <= len(self._held_at):
            angle = float(estimate.q[use.turn.joint - 1])
            if self._turn.step(angle, holding, use.turn):
                found = Presence("turned joint", by_hand=True)
        return found

    def _by_wrench(self, estimate: Estimate, pushing: bool, use: SignalSettings) -> Presence:
        change = self._wrench.step(estimate.F_user.tolist())
        found = NONE
        if pushing:
            present = self._push.step(change, flat(estimate.R_BF), use.push)
            self._told = min(self._told + 1, TOLD_AFTER + 1) if present and use.push.reported else 0
            if present and use.push.on:
                found = Presence("push", by_hand=True)
            if use.pattern.on and self._pattern.step(present, use.pattern):
                found = Presence("pushes in a row", by_hand=True, whole=True)
        if use.twist.on and self._twist.step(change, use.twist) and not found.source:
            found = Presence("twist", by_hand=True)
        if use.force_step.on and self._step.step(self.force(), self._quiet, use.force_step) and not found.source:
            found = Presence("force step", by_hand=True)
        return found


def _asked(use: SignalSettings) -> tuple[bool, bool]:
    """Whether pushes are looked for, and whether anything is that the flange sensor feels."""
    pushing = use.push.on or use.push.reported or use.pattern.on
    return pushing, pushing or use.twist.on or use.force_step.on
