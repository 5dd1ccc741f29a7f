"""Settings of the activation signals (FD-5, FD-6): a section for each source."""

from typing import Annotated

from pendant.settings.schema import Section, number, switch


class PushSettings(Section, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """(c) The user pushes at the flange."""

    on: Annotated[bool, switch("FD-5", "a push at the flange is an activation signal")] = False
    threshold: Annotated[float, number(5.0, 50.0, "N", "FD-5", text="a push changes the force by more than this")] = 15.0
    force_limit: Annotated[float, number(10.0, 200.0, "N", "FD-6", text="a larger force is no push")] = 80.0
    torque_limit: Annotated[float, number(0.2, 20.0, "N·m", "FD-6", text="more torque about the sensor's origin is no push")] = (
        2.5
    )
    torque_period: Annotated[float, number(0.0, 5.0, "s", "FD-6", text="the torque must have been within it for so long")] = 0.0
    angle: Annotated[float, number(0.0, 90.0, "°", "FD-6", text="largest angle to the axis, or to the band")] = 30.0
    band: Annotated[bool, switch("FD-6", "pushes across the axis, instead of along it")] = False
    x: Annotated[float, number(-1.0, 1.0, "", "FD-6", text="axis, x component")] = 0.0
    y: Annotated[float, number(-1.0, 1.0, "", "FD-6", text="axis, y component")] = 0.0
    z: Annotated[float, number(-1.0, 1.0, "", "FD-6", text="axis, z component; no axis: any direction")] = 0.0
    flange_axes: Annotated[bool, switch("FD-6", "the axis turns with the flange; otherwise base axes")] = False
    off_axis: Annotated[float, number(1.0, 200.0, "N", "FD-6", text="more force across the axis is no push")] = 30.0
    radius: Annotated[float, number(0.0, 1.0, "m", "FD-6", text="its line passes the place within this; 0: anywhere")] = 0.0
    place_x: Annotated[float, number(-1.0, 1.0, "m", "FD-6", text="place in the flange's axes, x")] = 0.0
    place_y: Annotated[float, number(-1.0, 1.0, "m", "FD-6", text="place in the flange's axes, y")] = 0.0
    place_z: Annotated[float, number(-1.0, 1.0, "m", "FD-6", text="place in the flange's axes, z")] = 0.0
    told: Annotated[bool, switch("FD-6a", "every push is an event, in every mode")] = False
    pauses: Annotated[bool, switch("FD-6a", "a push that is told pauses a running program")] = False
    resumes: Annotated[bool, switch("FD-6a", "a push that is told resumes a paused program")] = False
    stops: Annotated[bool, switch("FD-6a", "a push that is told stops a program")] = False


class Twist(Section, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """(d) The user twists the flange."""

    on: Annotated[bool, switch("FD-5", "a twist at the flange is an activation signal")] = False
    threshold: Annotated[float, number(0.5, 20.0, "N·m", "FD-5", text="a twist changes the torque by more than this")] = 3.0
    force_limit: Annotated[float, number(1.0, 50.0, "N", "FD-5", text="more force is no twist")] = 10.0


class JointPush(Section, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """(e) A push that the joints feel, without the flange's sensor."""

    on: Annotated[bool, switch("FD-5", "a push felt by the joints is an activation signal")] = False
    threshold: Annotated[float, number(1.0, 100.0, "N·m", "FD-5", text="change of a joint's external torque")] = 6.0
    first: Annotated[float, number(1.0, 12.0, "", "FD-5", text="first joint that is asked, counted from the base")] = 1.0
    last: Annotated[float, number(1.0, 12.0, "", "FD-5", text="last joint that is asked")] = 6.0


class PushPattern(Section, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """(f) Short pushes in a row, such as push, release, push."""

    on: Annotated[bool, switch("FD-5", "short pushes in a row are an activation signal")] = False
    count: Annotated[float, number(2.0, 5.0, "", "FD-5", text="pushes")] = 2.0
    shortest: Annotated[float, number(0.02, 1.0, "s", "FD-5", text="shortest push, shortest gap")] = 0.08
    longest: Annotated[float, number(0.05, 2.0, "s", "FD-5", text="longest push, longest gap")] = 0.28


class Turn(Section, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """(g) A joint is turned by hand against its hold."""

    on: Annotated[bool, switch("FD-5", "a joint turned against its hold is an activation signal")] = False
    joint: Annotated[float, number(1.0, 12.0, "", "FD-5", text="which joint, counted from the base")] = 6.0
    angle: Annotated[float, number(0.0005, 0.5, "rad", "FD-5", text="turned by more than this")] = 0.005


class ForceStep(Section, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """(h) The force changes at once, and nothing explains it."""

    on: Annotated[bool, switch("FD-5", "an unexplained step of the force is an activation signal")] = False
    threshold: Annotated[float, number(5.0, 50.0, "N", "FD-5", text="change of the force")] = 10.0
    rise: Annotated[float, number(0.01, 0.5, "s", "FD-5", text="within this time")] = 0.1
    quiet: Annotated[float, number(0.1, 5.0, "s", "FD-5", text="no commanded motion or payload change for so long")] = 0.5


class TapSettings(Section, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """(i) A tap that the flange's accelerometer feels."""

    on: Annotated[bool, switch("FD-5", "a tap at the flange is an activation signal")] = False
    threshold: Annotated[float, number(1.0, 70.0, "m/s²", "FD-5", text="acceleration beyond gravity")] = 6.0
    longest: Annotated[float, number(0.01, 0.5, "s", "FD-5", text="what lasts longer is no tap")] = 0.1


class SignalSettings(Section, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """Every source of an activation signal."""

    button: Annotated[bool, switch("FD-5", "the pendant's button is an activation signal")] = True
    digital: Annotated[bool, switch("FD-5", "a digital input is an activation signal")] = False
    digital_input: Annotated[float, number(0.0, 7.0, "", "FD-5", text="which digital input")] = 0.0
    leaving: Annotated[bool, switch("FD-17", "a digital input that rises leaves free-drive")] = False
    leaving_input: Annotated[float, number(0.0, 7.0, "", "FD-17", text="which digital input")] = 1.0
    push: PushSettings = PushSettings()
    twist: Twist = Twist()
    joints: JointPush = JointPush()
    pattern: PushPattern = PushPattern()
    turn: Turn = Turn()
    force_step: ForceStep = ForceStep()
    tap: TapSettings = TapSettings()


class LetGo(Section, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """A hand that gave the signal must be off the arm before the activation sequence."""

    on: Annotated[bool, switch("FD-8a", "a hand that gave the signal must leave the arm first")] = True
    force: Annotated[float, number(0.5, 10.0, "N", "FD-8a", text="off: the change of the force is below this")] = 3.0
    time: Annotated[float, number(0.0, 1.0, "s", "FD-8a", text="for so long")] = 0.1
    within: Annotated[float, number(0.2, 10.0, "s", "FD-8a", text="refused when the hand is still on after so long")] = 2.0


class Handshake(Section, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """A second signal that confirms the first."""

    on: Annotated[bool, switch("FD-8", "a signal must be confirmed")] = False
    feedback: Annotated[float, number(0.0, 5.0, "s", "FD-8", text="how long the robot asks for it; signals do not count")] = 0.5
    window: Annotated[float, number(1.0, 10.0, "s", "FD-8", text="the confirmation begins within this time")] = 3.0
    hold: Annotated[float, number(0.0, 1.0, "s", "FD-8", text="and lasts for so long")] = 0.2
