"""Settings of the activation signals (FD-5, FD-6): a section for each source."""

from typing import Annotated

from pendant.settings.schema import Section
from pendant.settings.schema import choice as _choice
from pendant.settings.schema import count as _count
from pendant.settings.schema import number as _number
from pendant.settings.schema import switch as _switch
from pendant.tick.words import Word


class PushDirection(Word):
    """How a push lies to its axis (FD-6)."""

    ALONG = "along"
    ACROSS = "across"


class PushFrame(Word):
    """Whose axes a push's axis is given in (FD-6)."""

    BASE = "base"
    FLANGE = "flange"  # it turns with the flange


class PushSettings(Section, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """(c) The user pushes at the flange."""

    BASIC = ("on", "threshold")

    on: Annotated[bool, _switch("FD-5", "a push at the flange is an activation signal")] = False
    threshold: Annotated[
        float, _number(5.0, 50.0, "N", "FD-5", text="a push changes the force at the flange by more than this")
    ] = 15.0
    force_limit: Annotated[
        float, _number(10.0, 200.0, "N", "FD-6", text="a change of force by more than this is not taken for a push")
    ] = 80.0
    torque_limit: Annotated[
        float, _number(0.2, 20.0, "N·m", "FD-6", text="a push has no more torque than this about the sensor's origin")
    ] = 2.5
    torque_period: Annotated[
        float, _number(0.0, 5.0, "s", "FD-6", text="time for which the torque must have been within its limit")
    ] = 0.0
    angle: Annotated[
        float, _number(0.0, 90.0, "°", "FD-6", text="largest angle between push and axis, or plane across the axis")
    ] = 30.0
    direction: Annotated[PushDirection, _choice("FD-6", "a push lies along the axis, or across it")] = PushDirection.ALONG
    x: Annotated[float, _number(-1.0, 1.0, "", "FD-6", text="x component of the axis of a push")] = 0.0
    y: Annotated[float, _number(-1.0, 1.0, "", "FD-6", text="y component of the axis of a push")] = 0.0
    z: Annotated[
        float, _number(-1.0, 1.0, "", "FD-6", text="z component of the axis of a push; without an axis any direction counts")
    ] = 0.0
    frame: Annotated[PushFrame, _choice("FD-6", "the frame in which the axis of a push is given")] = PushFrame.BASE
    off_axis: Annotated[float, _number(1.0, 200.0, "N", "FD-6", text="a push has no more force across its axis than this")] = 30.0
    radius: Annotated[
        float, _number(0.0, 1.0, "m", "FD-6", text="the push's line passes the place within this distance; 0: any place")
    ] = 0.0
    place_x: Annotated[float, _number(-1.0, 1.0, "m", "FD-6", text="x of the place of a push, in axes of the flange")] = 0.0
    place_y: Annotated[float, _number(-1.0, 1.0, "m", "FD-6", text="y of the place of a push, in axes of the flange")] = 0.0
    place_z: Annotated[float, _number(-1.0, 1.0, "m", "FD-6", text="z of the place of a push, in axes of the flange")] = 0.0
    reported: Annotated[bool, _switch("FD-6a", "every push is reported as an event, in every mode")] = False
    pauses: Annotated[bool, _switch("FD-6a", "a reported push pauses a running program")] = False
    resumes: Annotated[bool, _switch("FD-6a", "a reported push resumes a paused program")] = False
    stops: Annotated[bool, _switch("FD-6a", "a reported push stops a program")] = False


class Twist(Section, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """(d) The user twists the flange."""

    BASIC = ("on", "threshold")

    on: Annotated[bool, _switch("FD-5", "a twist at the flange is an activation signal")] = False
    threshold: Annotated[
        float, _number(0.5, 20.0, "N·m", "FD-5", text="a twist changes the torque at the flange by more than this")
    ] = 3.0
    force_limit: Annotated[float, _number(1.0, 50.0, "N", "FD-5", text="a twist has no more force than this")] = 10.0


class JointPush(Section, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """(e) A push that the joints feel, without the flange's sensor."""

    BASIC = ("on", "threshold")

    on: Annotated[bool, _switch("FD-5", "a push felt by the joints is an activation signal")] = False
    threshold: Annotated[
        float, _number(1.0, 100.0, "N·m", "FD-5", text="a push changes the external torque of a joint by more than this")
    ] = 6.0
    first: Annotated[int, _count(1, 12, "FD-5", text="first joint that is watched for pushes, counted from the base")] = 1
    last: Annotated[int, _count(1, 12, "FD-5", text="last joint that is watched for pushes")] = 6


class PushPattern(Section, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """(f) Short pushes in a row, such as push, release, push."""

    BASIC = ("on",)

    on: Annotated[bool, _switch("FD-5", "short pushes in a row are an activation signal")] = False
    count: Annotated[int, _count(2, 5, "FD-5", text="number of pushes in a row")] = 2
    shortest: Annotated[
        float, _number(0.02, 1.0, "s", "FD-5", text="shortest duration of a push in a row, and of the gap between two")
    ] = 0.08
    longest: Annotated[
        float, _number(0.05, 2.0, "s", "FD-5", text="longest duration of a push in a row, and of the gap between two")
    ] = 0.28


class PressedControl(Word):
    """What is pressed in a pattern (FD-5f)."""

    BUTTON = "button"
    INPUT = "input"  # the digital input that is an activation signal


class PressPattern(Section, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """(f) Short presses of the button, or pulses of the digital input, in a row."""

    BASIC = ("on",)

    on: Annotated[bool, _switch("FD-5", "short presses in a row are an activation signal")] = False
    of: Annotated[PressedControl, _choice("FD-5", "what is pressed in a row")] = PressedControl.BUTTON
    count: Annotated[int, _count(2, 5, "FD-5", text="number of presses in a row")] = 3
    shortest: Annotated[
        float, _number(0.02, 1.0, "s", "FD-5", text="shortest duration of a press in a row, and of the gap between two")
    ] = 0.06
    longest: Annotated[
        float, _number(0.05, 2.0, "s", "FD-5", text="longest duration of a press in a row, and of the gap between two")
    ] = 0.4


class Turn(Section, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """(g) A joint is turned by hand against its hold."""

    BASIC = ("on",)

    on: Annotated[bool, _switch("FD-5", "a joint turned against its hold is an activation signal")] = False
    joint: Annotated[int, _count(1, 12, "FD-5", text="number of the joint that is turned, counted from the base")] = 6
    angle: Annotated[float, _number(0.0005, 0.5, "rad", "FD-5", text="the joint is turned by more than this")] = 0.005


class PostureSignalUse(Section, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """(g) Joints are turned by hand against their hold: all at once, a posture; or one after the other, a series of them."""

    BASIC = ("on",)

    on: Annotated[bool, _switch("FD-5", "a posture, or a series of them, reached by hand is an activation signal")] = False
    together: Annotated[bool, _switch("FD-5", "the joints are turned at once: a posture; otherwise in a row: a series")] = False
    count: Annotated[int, _count(1, 3, "FD-5", text="number of joints that are turned")] = 2
    joint_1: Annotated[int, _count(1, 12, "FD-5", text="number of the first joint that is turned")] = 6
    angle_1: Annotated[float, _number(-0.5, 0.5, "rad", "FD-5", text="the first joint is turned beyond this, to its side")] = (
        0.005
    )
    joint_2: Annotated[int, _count(1, 12, "FD-5", text="number of the second joint that is turned")] = 5
    angle_2: Annotated[float, _number(-0.5, 0.5, "rad", "FD-5", text="the second joint is turned beyond this, to its side")] = (
        0.005
    )
    joint_3: Annotated[int, _count(1, 12, "FD-5", text="number of the third joint that is turned")] = 6
    angle_3: Annotated[float, _number(-0.5, 0.5, "rad", "FD-5", text="the third joint is turned beyond this, to its side")] = (
        0.005
    )
    within: Annotated[float, _number(0.1, 10.0, "s", "FD-5", text="each joint is turned within this time of the one before")] = (
        3.0
    )

    @property
    def asked(self) -> tuple[tuple[int, float], ...]:
        """Joints, counted from 0, and the angles that they are turned beyond [rad]."""
        every = ((self.joint_1, self.angle_1), (self.joint_2, self.angle_2), (self.joint_3, self.angle_3))
        return tuple((joint - 1, angle) for joint, angle in every[: self.count])


class ForceStep(Section, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """(h) The force changes at once, and nothing explains it."""

    BASIC = ("on",)

    on: Annotated[bool, _switch("FD-5", "a step of the force that nothing explains is an activation signal")] = False
    threshold: Annotated[float, _number(5.0, 50.0, "N", "FD-5", text="the force steps by more than this")] = 10.0
    rise: Annotated[float, _number(0.01, 0.5, "s", "FD-5", text="the force steps within this time")] = 0.1
    quiet: Annotated[
        float, _number(0.1, 5.0, "s", "FD-5", text="time without commanded motion or payload change before the step")
    ] = 0.5


class TapSettings(Section, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """(i) A tap that the flange's accelerometer feels."""

    BASIC = ("on",)

    on: Annotated[bool, _switch("FD-5", "a tap at the flange is an activation signal")] = False
    threshold: Annotated[
        float, _number(1.0, 70.0, "m/s²", "FD-5", text="a tap accelerates the flange by more than this, gravity aside")
    ] = 6.0
    longest: Annotated[float, _number(0.01, 0.5, "s", "FD-5", text="a tap lasts no longer than this")] = 0.1


class SignalSettings(Section, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """Every source of an activation signal."""

    BASIC = ("button", "digital")

    button: Annotated[bool, _switch("FD-5", "the pendant's button is an activation signal")] = True
    digital: Annotated[bool, _switch("FD-5", "a digital input is an activation signal")] = False
    digital_input: Annotated[int, _count(0, 7, "FD-5", text="number of the digital input that is an activation signal")] = 0
    leaving: Annotated[bool, _switch("FD-17", "a digital input that rises ends free-drive")] = False
    leaving_input: Annotated[int, _count(0, 7, "FD-17", text="number of the digital input that ends free-drive")] = 1
    push: PushSettings = PushSettings()
    twist: Twist = Twist()
    joints: JointPush = JointPush()
    pattern: PushPattern = PushPattern()
    presses: PressPattern = PressPattern()
    turn: Turn = Turn()
    posture: PostureSignalUse = PostureSignalUse()
    force_step: ForceStep = ForceStep()
    tap: TapSettings = TapSettings()


class LetGo(Section, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """A hand that gave the signal must be off the arm before the activation sequence."""

    BASIC = ("on",)

    on: Annotated[bool, _switch("FD-8a", "a hand that gave the signal must leave the arm before the check")] = True
    force: Annotated[
        float, _number(0.5, 10.0, "N", "FD-8a", text="the hand is off when the force has changed by less than this")
    ] = 3.0
    time: Annotated[float, _number(0.0, 1.0, "s", "FD-8a", text="time for which the hand must be off")] = 0.1
    within: Annotated[
        float, _number(0.2, 10.0, "s", "FD-8a", text="free-drive is refused when the hand is still on after this time")
    ] = 2.0


class ConfirmedBy(Word):
    """What confirms the signal (FD-8)."""

    ANY = "any"
    OTHER = "other"  # another source than the signal's
    BUTTON = "button"
    PUSH = "push"
    TWIST = "twist"
    JOINTS = "joints"  # a push that the joints feel
    PATTERN = "pattern"
    TURN = "turn"
    POSTURE = "posture"


class ConfirmedWhen(Word):
    """When the confirmation is asked for (FD-8)."""

    BEFORE = "before"  # the activation sequence
    WITHIN = "within"  # it: the arm is free already, so that the button or an input confirms


class Handshake(Section, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """A second signal that confirms the first."""

    BASIC = ("on", "by", "window")

    on: Annotated[bool, _switch("FD-8", "a second signal must confirm the first")] = False
    by: Annotated[ConfirmedBy, _choice("FD-8", "what confirms; one that is chosen here does no more ask for free-drive")] = (
        ConfirmedBy.ANY
    )
    when: Annotated[ConfirmedWhen, _choice("FD-8", "whether the robot asks before the activation sequence, or within it")] = (
        ConfirmedWhen.BEFORE
    )
    delay: Annotated[float, _number(0.0, 5.0, "s", "FD-8", text="time from the signal until the robot asks")] = 0.0
    feedback: Annotated[
        float, _number(0.0, 5.0, "s", "FD-8", text="time for which the robot asks to confirm; signals do not count in it")
    ] = 0.5
    window: Annotated[float, _number(1.0, 10.0, "s", "FD-8", text="the confirmation must begin within this time")] = 3.0
    hold: Annotated[float, _number(0.0, 1.0, "s", "FD-8", text="the confirmation must last for this time")] = 0.2
