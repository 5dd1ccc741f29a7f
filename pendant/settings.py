"""The one settings schema: every period and limit with default, range, unit, requirement and a line of text."""

import hashlib
from typing import Annotated, Any, get_args, get_origin, get_type_hints

import msgspec
from msgspec import Meta

from pendant.haptics import HapticUse
from pendant.schema import Limit, Row, Section, SettingError, Value, ticks
from pendant.schema import limit as _limit
from pendant.schema import number as _number
from pendant.schema import switch as _switch
from pendant.signal_settings import Handshake, LetGo, Signals

__all__ = [
    "Limit",
    "Row",
    "Section",
    "SettingError",
    "Settings",
    "Value",
    "apply",
    "describe",
    "digest",
    "find",
    "ticks",
    "value_of",
]


class Operation(Limit, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """A limit while free-drive lasts, with its reaction."""

    stop: Annotated[bool, _switch("FD-18", "beyond is STOP")] = False


class Activation(Section, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """From the signal to entry."""

    period: Annotated[float, _number(0.0, 15.0, "s", "FD-7", "how long the signal must be present without a break")] = 1.0
    sum_presences: Annotated[bool, _switch("FD-7", "presences add up; a gap up to 1 s does not begin afresh")] = False


class SequenceDynamic(Section, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """What lowers the limits of the activation sequence, by the shares of `Soft`."""

    acceleration: Annotated[bool, _switch("FD-12b", "its displacements and allowed times fall with acceleration")] = False
    payload: Annotated[bool, _switch("FD-12b", "its speeds and accelerations fall with the payload")] = False
    drift: Annotated[bool, _switch("FD-12b", "its speeds fall for what creeps on about the same way")] = False
    pushed: Annotated[bool, _switch("FD-12b", "its speeds, accelerations fall with the user's force, torque")] = False
    vertical: Annotated[bool, _switch("FD-12b", "its ways, speeds and accelerations are less along gravity")] = False


class Sequence(Section, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """The activation sequence, in which the arm is freed to see whether it stays."""

    on: Annotated[bool, _switch("FD-24", "free-drive begins with an activation sequence")] = True
    period: Annotated[float, _number(0.0, 5.0, "s", "FD-9", "how long the freed arm must stay within limits")] = 1.0
    stored: Annotated[bool, _switch("FD-9", "it is also compared with its state of some time ago")] = False
    age: Annotated[float, _number(0.5, 15.0, "s", "FD-9", "how old the state is that it is compared with")] = 2.0
    amplified: Annotated[bool, _switch("FD-9", "the user's force is amplified in it already")] = False
    protective_stop: Annotated[bool, _switch("FD-10", "a limit exceeded in it is a protective stop")] = False
    compensate: Annotated[bool, _switch("FD-10", "beyond a limit the arm is balanced till it stands, then held")] = False
    dynamic: SequenceDynamic = SequenceDynamic()


class Origins(Section, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """Modes from which free-drive can be entered."""

    normal: Annotated[bool, _switch("FD-1", "free-drive can be entered from NORMAL")] = False
    teach: Annotated[bool, _switch("FD-1", "free-drive can be entered from TEACH")] = True
    run: Annotated[bool, _switch("FD-1", "free-drive can be entered from RUN, which it pauses")] = False


class FreeDrive(Section, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """Free-drive itself."""

    allowed_from: Origins = Origins()
    period: Annotated[float, _number(0.5, 30.0, "s", "FD-14", "leave when nobody moves it for this long", locked=False)] = 3.0
    restart_period: Annotated[
        float, _number(0.5, 30.0, "s", "FD-15", "leave when a guided arm stands still for this long", locked=False)
    ] = 3.0
    restart_at_manipulation: Annotated[bool, _switch("FD-15", "the restart period begins with each manipulation")] = False
    restart_after_force: Annotated[bool, _switch("FD-15", "it begins when the hand's force ends, moving or not")] = False
    anew: Annotated[bool, _switch("FD-16", "a signal begins the running period anew")] = True
    longest: Annotated[float, _number(0.5, 30.0, "s", "FD-16", "longest that the two periods may be")] = 30.0
    maintained: Annotated[bool, _switch("FD-24", "free-drive ends when nobody moves the arm for its periods")] = True
    remainders: Annotated[bool, _switch("FD-20", "what is left of every period is published")] = True
    way_back: Annotated[bool, _switch("FD-22", "the way back to the posture at activation is told")] = True
    cool_down: Annotated[float, _number(0.0, 30.0, "s", "FD-12c", "pause after a refusal or a leaving")] = 2.0
    gain: Annotated[float, _number(0.0, 3.0, "", "FD-3", "factor on the user's force")] = 1.0
    force_cap: Annotated[float, _number(5.0, 100.0, "N", "FD-3", "largest user force that is amplified")] = 50.0


class Hold(Section, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """Held controls."""

    silence: Annotated[float, _number(0.1, 1.0, "s", "FD-23", "a held control silent for longer counts as released")] = 0.5


class Enabling(Section, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """The three-position enabling device."""

    on: Annotated[bool, _switch("FD-23", "motion needs the enabling device in its middle position")] = False


class ReducedLimits(Section, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """Safety mode REDUCED."""

    on: Annotated[bool, _switch("FD-1", "REDUCED slows the arm down, and stops a faster one")] = True
    tcp_speed: Annotated[float, _number(0.05, 0.25, "m/s", "FD-1", "speed of the tool centre point in REDUCED")] = 0.25
    elbow_speed: Annotated[float, _number(0.05, 0.25, "m/s", "FD-1", "speed of the elbow in REDUCED")] = 0.25
    joint_speed: Annotated[float, _number(0.1, 3.0, "rad/s", "FD-1", "speed of a joint in REDUCED")] = 1.0
    transition: Annotated[float, _number(0.1, 1.0, "s", "FD-1", "time to slow down in when REDUCED begins")] = 0.5


class ButtonUse(Section, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """The free-drive button."""

    short_press: Annotated[float, _number(0.1, 2.0, "s", "FD-8a", "a press shorter than this leaves free-drive")] = 0.4
    hold_to_run: Annotated[bool, _switch("FD-8a", "letting go of the button leaves free-drive")] = False


class ActivationLimits(Section, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """What the freed arm must not do in the activation sequence."""

    flange_displacement: Annotated[Limit, _limit(0.0005, 0.01, "m", "FD-9", "way of the flange")] = Limit(max=0.002)
    flange_speed: Annotated[Limit, _limit(0.002, 0.1, "m/s", "FD-9", "speed of the flange")] = Limit(max=0.02)
    flange_acceleration: Annotated[Limit, _limit(0.5, 20.0, "m/s²", "FD-9", "acceleration of the flange")] = Limit(max=1.5)
    joint_displacement: Annotated[Limit, _limit(0.0005, 0.1, "rad", "FD-9", "way of a joint")] = Limit(max=0.01, on=False)
    joint_speed: Annotated[Limit, _limit(0.01, 0.5, "rad/s", "FD-9", "speed of a joint")] = Limit(max=0.05)
    joint_acceleration: Annotated[Limit, _limit(0.5, 50.0, "rad/s²", "FD-9", "acceleration of a joint")] = Limit(
        max=5.0, on=False
    )
    motor_torque: Annotated[Limit, _limit(0.01, 1.0, "of rated", "FD-9", "torque of a motor")] = Limit(max=0.9, on=False)
    joint_torque: Annotated[Limit, _limit(0.01, 1.0, "of rated", "FD-9", "external torque of a joint")] = Limit(max=0.04)
    payload_force: Annotated[Limit, _limit(1.0, 50.0, "N", "FD-9", "force as of a wrong payload")] = Limit(max=5.3)
    payload_torque: Annotated[Limit, _limit(0.1, 10.0, "N·m", "FD-9", "torque as of a wrong payload")] = Limit(max=1.5)
    user_force: Annotated[Limit, _limit(1.0, 50.0, "N", "FD-9", "force that is none of a payload")] = Limit(max=12.0)
    user_torque: Annotated[Limit, _limit(0.1, 10.0, "N·m", "FD-9", "torque that is none of a payload")] = Limit(max=1.5)
    load_share: Annotated[float, _number(0.0, 1.0, "", "FD-9", "joint torque limits rise by this share of its load")] = 0.25


class MaintainLimits(Section, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """What counts as moving the arm by hand. Forces and torques are changes since the period began."""

    user_force: Annotated[Limit, _limit(1.0, 100.0, "N", "FD-13", "change of the user's force")] = Limit(max=8.0)
    user_torque: Annotated[Limit, _limit(0.1, 20.0, "N·m", "FD-13", "change of the user's torque")] = Limit(max=1.5)
    joint_torque: Annotated[Limit, _limit(0.5, 100.0, "N·m", "FD-13", "change of a joint's external torque")] = Limit(max=8.0)
    joint_speed: Annotated[Limit, _limit(0.005, 1.0, "rad/s", "FD-13", "speed of a joint")] = Limit(max=0.05)
    flange_speed: Annotated[Limit, _limit(0.002, 1.0, "m/s", "FD-13", "speed of the flange")] = Limit(max=0.02)
    flange_acceleration: Annotated[Limit, _limit(0.5, 20.0, "m/s²", "FD-13", "acceleration of the flange")] = Limit(max=1.5)
    flange_displacement: Annotated[Limit, _limit(0.001, 0.5, "m", "FD-13", "way of the flange in the period")] = Limit(max=0.01)
    load_share: Annotated[
        float, _number(0.0, 1.0, "", "FD-13", "force and joint torque limits rise by this share of the load")
    ] = 0.0


class OperationLimits(Section, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """What ends free-drive while it lasts."""

    tcp_speed: Annotated[Operation, _limit(0.05, 5.0, "m/s", "FD-18", "speed of the tool centre point")] = Operation(max=1.5)
    elbow_speed: Annotated[Operation, _limit(0.05, 5.0, "m/s", "FD-18", "speed of the elbow")] = Operation(max=1.5)
    joint_speed: Annotated[Operation, _limit(0.1, 6.0, "rad/s", "FD-18", "speed of a joint")] = Operation(max=3.0)
    flange_acceleration: Annotated[Operation, _limit(1.0, 78.0, "m/s²", "FD-18", "acceleration of the flange")] = Operation(
        max=40.0, stop=True
    )
    joint_torque: Annotated[Operation, _limit(0.01, 2.0, "of rated", "FD-18", "external torque of a joint")] = Operation(
        max=0.8, time=0.05, stop=True
    )
    user_force: Annotated[Operation, _limit(5.0, 100.0, "N", "FD-18", "the user's force")] = Operation(max=90.0, time=0.1)
    flange_displacement: Annotated[Operation, _limit(0.005, 2.0, "m", "FD-18", "way of the flange since entry")] = Operation(
        max=0.5, on=False
    )


class Limits(Section, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """Every limit: parameter x stage (FD-25)."""

    activation: ActivationLimits = ActivationLimits()
    maintain: MaintainLimits = MaintainLimits()
    operation: OperationLimits = OperationLimits()


class Soft(Section, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """Resistance in free-drive before the operation limits on speed."""

    on: Annotated[bool, _switch("FD-12b", "motion is resisted before a limit on its speed")] = True
    onset: Annotated[float, _number(0.1, 0.9, "", "FD-12b", "share of a limit from which on motion is resisted")] = 0.5
    force: Annotated[float, _number(10.0, 300.0, "N", "FD-12b", "resistance of tool and elbow at their limits")] = 120.0
    torque: Annotated[float, _number(0.05, 1.0, "of rated", "FD-12b", "resistance of a joint at its limit")] = 0.7
    payload: Annotated[bool, _switch("FD-12b", "the limits fall with the configured payload and tool")] = True
    payload_share: Annotated[float, _number(0.0, 0.5, "1/kg", "FD-12b", "a limit is divided by 1 plus this for each kg")] = 0.05
    drift: Annotated[bool, _switch("FD-12b", "the limits fall for what moves on about the same way")] = True
    drift_time: Annotated[float, _number(0.2, 30.0, "s", "FD-12b", "for so long it may")] = 2.0
    drift_share: Annotated[float, _number(0.1, 1.0, "", "FD-12b", "share of the limits that is left then")] = 0.5
    acceleration: Annotated[bool, _switch("FD-12b", "way and time that are allowed fall with acceleration")] = False
    acceleration_share: Annotated[float, _number(0.0, 2.0, "s²/m", "FD-12b", "they are divided by 1 plus this for each m/s²")] = (
        0.25
    )
    pushed: Annotated[bool, _switch("FD-12b", "limits fall with the user's force, angular ones with torque")] = False
    force_share: Annotated[float, _number(0.0, 0.2, "1/N", "FD-12b", "a limit is divided by 1 plus this for each newton")] = 0.02
    torque_share: Annotated[
        float, _number(0.0, 2.0, "1/(N·m)", "FD-12b", "an angular one by 1 plus this for each newton metre")
    ] = 0.1
    vertical: Annotated[bool, _switch("FD-12b", "the limits of motion are tighter along gravity")] = False
    vertical_share: Annotated[float, _number(0.1, 1.0, "", "FD-12b", "share of the limits that is left along it")] = 0.5
    hard: Annotated[bool, _switch("FD-12b", "all this lowers the limits that end free-drive, too")] = False


class Axes(Section, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """Freedom of the tool in free-drive, axis by axis, and what singularities do to it."""

    on: Annotated[bool, _switch("FD-4", "axes can be locked", locked=False)] = True
    x: Annotated[bool, _switch("FD-4", "the tool is free along x", locked=False)] = True
    y: Annotated[bool, _switch("FD-4", "the tool is free along y", locked=False)] = True
    z: Annotated[bool, _switch("FD-4", "the tool is free along z", locked=False)] = True
    rx: Annotated[bool, _switch("FD-4", "the tool is free about x", locked=False)] = True
    ry: Annotated[bool, _switch("FD-4", "the tool is free about y", locked=False)] = True
    rz: Annotated[bool, _switch("FD-4", "the tool is free about z", locked=False)] = True
    tool: Annotated[bool, _switch("FD-4", "the axes are the tool's when they are locked", locked=False)] = False
    roll: Annotated[float, _number(-3.15, 3.15, "rad", "FD-4", "of the axes in the base, about its x", locked=False)] = 0.0
    pitch: Annotated[float, _number(-3.15, 3.15, "rad", "FD-4", "of the axes in the base, about its y", locked=False)] = 0.0
    yaw: Annotated[float, _number(-3.15, 3.15, "rad", "FD-4", "of the axes in the base, about its z", locked=False)] = 0.0
    resistance: Annotated[bool, _switch("FD-4", "with a lock, motion towards a singularity is resisted")] = True
    near: Annotated[float, _number(0.011, 0.1, "m", "FD-4", "near a singularity: smallest singular value below this")] = 0.04
    too_near: Annotated[float, _number(0.001, 0.01, "m", "FD-4", "too near: with all of the resistance")] = 0.01


class JointLimits(Section, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """Zones before the joint limits in free-drive."""

    on: Annotated[bool, _switch("FD-4", "a joint is resisted before its range ends")] = True
    damping_zone: Annotated[float, _number(0.01, 0.5, "rad", "FD-4", "where it is damped, before the stiff zone")] = 0.1
    stiff_zone: Annotated[float, _number(0.01, 0.3, "rad", "FD-4", "up to the limit, where a spring holds it back")] = 0.05
    damping: Annotated[float, _number(0.05, 0.4, "s/rad", "FD-4", "at the stiff zone, of rated torque at 1 rad/s")] = 0.25


class Static(Section, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """When the arm counts as standing still."""

    speed: Annotated[float, _number(0.001, 0.1, "rad/s", "static", "every joint is slower than this")] = 0.01
    time: Annotated[float, _number(0.02, 2.0, "s", "static", "for this long")] = 0.1


class JointControl(Section, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """Which terms make the motor torque, and which ways lead to the transmission torque."""

    feed_forward: Annotated[bool, _switch("AF-4", "inertia and speed of a motion are fed forward")] = True
    friction: Annotated[bool, _switch("AF-7", "the friction estimate helps motor and hand")] = True
    adaptive: Annotated[bool, _switch("AF-2", "friction is learned while the robot works")] = True
    torque_feedback: Annotated[bool, _switch("AF-5", "the transmission-torque error is corrected")] = True
    theta: Annotated[bool, _switch("AF-5", "the motor angle's error is corrected")] = True
    theta_speed: Annotated[bool, _switch("AF-5", "the motor speed's error is corrected")] = True
    theta_acceleration: Annotated[bool, _switch("AF-5", "the motor acceleration's error is corrected")] = False
    q: Annotated[bool, _switch("AF-5", "the output angle's error is integrated")] = True
    q_speed: Annotated[bool, _switch("AF-5", "the output speed's error is corrected")] = False
    q_acceleration: Annotated[bool, _switch("AF-5", "the output acceleration's error is corrected")] = False
    motor_torque: Annotated[bool, _switch("AF-5", "the motor torque's error is corrected")] = False
    tcp_pose: Annotated[bool, _switch("AF-5", "the tool centre point's error is corrected")] = False
    tcp_speed: Annotated[bool, _switch("AF-5", "the error of its speed is corrected")] = False
    from_dynamics: Annotated[bool, _switch("AF-3", "transmission torque from output angle and model")] = True
    from_deflection: Annotated[bool, _switch("AF-3", "transmission torque from both angles")] = True
    from_motor: Annotated[bool, _switch("AF-3", "transmission torque from the motor angle and torque")] = True


class ContactUse(Section, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """Detection of a change in contact."""

    on: Annotated[bool, _switch("CD-1", "a change in contact is detected and logged, in every mode", locked=False)] = False
    tool: Annotated[bool, _switch("CD-2", "from the flange force and the acceleration on its tool side")] = True
    flange: Annotated[bool, _switch("CD-2", "from the flange force and the acceleration on its arm side")] = False
    links: Annotated[bool, _switch("CD-2", "on elbow and forearm, from the joints and the model")] = True
    opposite: Annotated[bool, _switch("CD-0", "every rule but clamping asks for opposite directions")] = True
    instant: Annotated[bool, _switch("CD-3", "rule: force and acceleration of now")] = True
    difference: Annotated[bool, _switch("CD-4", "rule: differences of samples")] = True
    ratio: Annotated[bool, _switch("CD-5", "rule: ratio of force and acceleration differences")] = True
    ratio_of_values: Annotated[bool, _switch("CD-5", "the ratio rule looks at force and acceleration of now, too")] = True
    statistical: Annotated[bool, _switch("CD-6", "rule: differences against the buffer's mean")] = True
    slow: Annotated[bool, _switch("CD-7", "rule: differences of means, clamping")] = True
    all_rules: Annotated[bool, _switch("CD-10", "every rule that is on must see it, instead of any")] = False
    sensitivity: Annotated[float, _number(0.25, 4.0, "", "CD-12", "from clear contacts only to gentle touch", locked=False)] = 1.0
    hard_count: Annotated[float, _number(1.0, 10.0, "", "CD-9", "confirmations of the first three rules")] = 2.0
    soft_count: Annotated[float, _number(3.0, 10.0, "", "CD-9", "confirmations of the statistical rule")] = 4.0
    slow_count: Annotated[float, _number(5.0, 50.0, "", "CD-9", "confirmations of the slow rule")] = 20.0
    misses: Annotated[float, _number(0.0, 10.0, "", "CD-9", "ticks among the confirming ones that may not; 0: in a row")] = 0.0
    look_back: Annotated[bool, _switch("CD-14", "the pose at contact is that of the first suspicious sample")] = True
    retrospective: Annotated[bool, _switch("CD-9", "a clear difference is confirmed on older samples at once")] = True
    clear_limit: Annotated[float, _number(4.0, 20.0, "", "CD-9", "clear difference: deviations of the contact force")] = 6.0
    clear_acceleration: Annotated[float, _number(0.2, 10.0, "m/s²", "CD-9", "clear difference: acceleration")] = 1.0
    angle: Annotated[float, _number(0.0, 0.95, "", "CD-0", "minus the cosine beyond which directions are opposite")] = 0.3
    force_noise: Annotated[float, _number(0.02, 2.0, "N", "CD-0", "noise of the flange force, each axis")] = 0.15
    acceleration_noise: Annotated[float, _number(0.01, 2.0, "m/s²", "CD-0", "noise of the acceleration, each axis")] = 0.1
    link_force_noise: Annotated[float, _number(0.1, 50.0, "N", "CD-2", "noise of the force on a link")] = 3.0
    link_acceleration_noise: Annotated[float, _number(0.02, 5.0, "m/s²", "CD-2", "noise of a link's acceleration")] = 0.2
    link_force: Annotated[float, _number(1.0, 200.0, "N", "CD-2", "slow rule: force on a link")] = 60.0
    link_margin: Annotated[float, _number(0.0, 100.0, "kg", "CD-11", "force on a link that a wrong model may explain")] = 20.0
    noise_limit: Annotated[float, _number(1.0, 6.0, "", "CD-0", "differences within so many deviations are noise")] = 3.0
    hard_limit: Annotated[float, _number(2.0, 20.0, "", "CD-4", "difference rule: deviations of force, acceleration")] = 4.0
    hard_payload: Annotated[float, _number(0.0, 5.0, "N/kg", "CD-11", "difference rule: force more for each kg carried")] = 0.9
    ratio_share: Annotated[float, _number(0.05, 1.0, "", "CD-5", "ratio's threshold, a share of the payload")] = 0.5
    ratio_acceleration: Annotated[float, _number(0.2, 10.0, "m/s²", "CD-5", "ratio rule: least acceleration difference")] = 1.0
    value_force: Annotated[float, _number(1.0, 50.0, "N", "CD-3", "instant rule: force")] = 8.0
    value_acceleration: Annotated[float, _number(0.1, 20.0, "m/s²", "CD-3", "instant rule: acceleration")] = 3.0
    confidence: Annotated[float, _number(2.0, 10.0, "", "CD-6", "statistical rule: standard errors of a mean")] = 3.6
    slow_force: Annotated[float, _number(0.2, 20.0, "N", "CD-7", "slow rule: force")] = 0.7
    slow_payload: Annotated[float, _number(0.0, 5.0, "N/kg", "CD-11", "slow rule: force more for each kg carried")] = 0.1
    clamping_ratio: Annotated[float, _number(1.0, 50.0, "kg", "CD-7", "force over acceleration, beyond is clamping")] = 4.0
    payload_error: Annotated[float, _number(0.0, 1.0, "", "CD-11", "share by which the payload may be wrong")] = 0.25
    speed_share: Annotated[float, _number(0.0, 2.0, "s/m", "CD-11", "thresholds rise with the speed")] = 0.0
    free_drive_factor: Annotated[float, _number(1.0, 10.0, "", "CD-11", "thresholds in FREE_DRIVE, times")] = 3.0


class Walls(Section, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """Virtual walls: those of the session, and the tether, a sphere round the flange that follows the user's hand."""

    on: Annotated[bool, _switch("FD-24", "walls and areas hold")] = True
    anew: Annotated[bool, _switch("VW-3", "walls are anchored anew as their policies say")] = True
    sizes: Annotated[bool, _switch("VW-8", "sizes follow posture or payload, or the smallest holds")] = True
    resistance: Annotated[bool, _switch("VW-7", "walls resist before they are reached")] = True
    tether: Annotated[bool, _switch("VW-4", "a sphere round the flange follows the hand")] = True
    activation_radius: Annotated[float, _number(0.001, 0.1, "m", "VW-6", "of the tether in the activation sequence")] = 0.005
    operation_radius: Annotated[float, _number(0.005, 1.0, "m", "VW-6", "of the tether in free-drive; the arm stops at it")] = (
        0.03
    )
    band: Annotated[float, _number(0.0, 0.5, "m", "VW-7", "before the tether, where it resists")] = 0.005
    averaging: Annotated[float, _number(0.02, 10.0, "s", "VW-4", "the tether lies round the flange's mean place")] = 0.02
    safety_period: Annotated[float, _number(0.1, 10.0, "s", "VW-3", "the tether follows a hand that was felt so long ago")] = 1.0
    push_back: Annotated[float, _number(2.0, 50.0, "N", "VW-5", "smallest force that the tether takes for a hand's")] = 2.0
    leave: Annotated[bool, _switch("VW-6", "beyond the tether, free-drive is left")] = False
    stop: Annotated[bool, _switch("VW-6", "beyond the tether is STOP")] = False


class Unexplained(Section, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """Motion that nobody causes, and payloads that drop or change, are STOP."""

    motion: Annotated[bool, _switch("FD-19", "motion in free-drive that nobody causes is STOP")] = True
    payload: Annotated[bool, _switch("FD-19", "a payload that drops or changes in free-drive is STOP")] = True
    speed: Annotated[float, _number(0.005, 0.25, "m/s", "FD-19", "of the flange, from which on it counts as moving")] = 0.02
    time: Annotated[float, _number(0.02, 2.0, "s", "FD-19", "that it may move alone")] = 0.3
    force: Annotated[float, _number(0.5, 20.0, "N", "FD-19", "a smaller force is nobody's")] = 1.5
    sensor: Annotated[bool, _switch("FD-19", "a flange sensor that drifts or steps drives no arm")] = True


class ToolUse(Section, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """How tool and payload are changed and measured."""

    ramp: Annotated[float, _number(0.0, 10.0, "s", "tools", "time to go over to another payload in", locked=False)] = 1.0
    measure: Annotated[float, _number(0.1, 5.0, "s", "tools", "time to measure a posture for", locked=False)] = 0.5


class Settings(Section, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """All settings. Every field has its default; `Settings()` is what ships."""

    signals: Signals = Signals()
    activation: Activation = Activation()
    handshake: Handshake = Handshake()
    let_go: LetGo = LetGo()
    sequence: Sequence = Sequence()
    free_drive: FreeDrive = FreeDrive()
    hold: Hold = Hold()
    button: ButtonUse = ButtonUse()
    enabling: Enabling = Enabling()
    reduced: ReducedLimits = ReducedLimits()
    limits: Limits = Limits()
    unexplained: Unexplained = Unexplained()
    soft: Soft = Soft()
    axes: Axes = Axes()
    joint_limits: JointLimits = JointLimits()
    walls: Walls = Walls()
    haptics: HapticUse = HapticUse()
    static: Static = Static()
    tools: ToolUse = ToolUse()
    joint_control: JointControl = JointControl()
    contact: ContactUse = ContactUse()


def _rows(section: type[Section], prefix: str) -> list[Row]:
    rows: list[Row] = []
    hints = get_type_hints(section, include_extras=True)
    for field in msgspec.structs.fields(section):
        hint = hints[field.name]
        if hint is float:  # the value of a limit: its range is said where the limit is
            continue
        if get_origin(hint) is not Annotated:
            rows += _rows(hint, f"{prefix}{field.name}.")
            continue
        meta: Meta = get_args(hint)[1]
        extra: dict[str, Any] = meta.extra or {}
        if isinstance(field.default, Limit):
            rows += _limit_rows(prefix + field.name, field.default, meta.description or "", extra)
            continue
        low, high = (None, None) if meta.ge is None else (float(meta.ge), float(meta.le or 0.0))
        text = meta.description or ""
        rows.append(Row(prefix + field.name, field.default, low, high, extra["unit"], extra["id"], text, extra["locked"]))
    return rows


def _limit_rows(name: str, default: Limit, text: str, extra: dict[str, Any]) -> list[Row]:
    """The rows of one limit: its value and what all limits have."""
    first = Row(f"{name}.max", default.max, extra["low"], extra["high"], extra["unit"], extra["id"], text, True)
    rows = [first]
    for row in _rows(type(default), f"{name}."):
        rows.append(row._replace(default=getattr(default, row.name.rpartition(".")[2]), text=f"{text}: {row.text}"))
    return rows


_ROWS = {row.name: row for row in _rows(Settings, "")}


def describe() -> list[Row]:
    """Every setting, in the order of the schema."""
    return list(_ROWS.values())


def find(name: str) -> Row:
    """The row of a dotted name.

    Raises:
        SettingError: there is no such setting.
    """
    row = _ROWS.get(name)
    if row is None:
        raise SettingError(name, None, "one of " + ", ".join(_ROWS))
    return row


def value_of(settings: Settings, name: str) -> Value:
    """The value of a dotted name. Raises SettingError when there is no such setting."""
    find(name)
    value: Any = settings
    for part in name.split("."):
        value = getattr(value, part)
    return value


def _checked(row: Row, value: object) -> Value:
    if row.low is None or row.high is None:
        if not isinstance(value, bool):
            raise SettingError(row.name, value, "true or false")
        return value
    unit = f" {row.unit}" if row.unit else ""
    allowed = f"a number from {row.low:g} to {row.high:g}{unit}"
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        raise SettingError(row.name, value, allowed)
    if not row.low <= value <= row.high:  # NaN is in no range
        raise SettingError(row.name, value, allowed)
    return float(value)


def _replaced(section: Any, path: list[str], value: Value) -> Any:
    new = value if len(path) == 1 else _replaced(getattr(section, path[0]), path[1:], value)
    return msgspec.structs.replace(section, **{path[0]: new})


def apply(settings: Settings, changes: dict[str, Any]) -> Settings:
    """Settings with the changes, given by dotted name; all of them or none.

    Raises:
        SettingError: a name that does not exist, or a value of the wrong type, out of range or not finite.
    """
    for name, value in changes.items():
        settings = _replaced(settings, name.split("."), _checked(find(name), value))
    return settings


def digest(settings: Settings) -> str:
    """Short hash of all values: 8 hexadecimal digits, equal for equal settings."""
    return _hashed(settings, list(_ROWS.values()))


def limits_checksum(settings: Settings) -> str:
    """Short hash of everything that is locked while the arm moves: 8 hexadecimal digits, equal for equal limits."""
    return _hashed(settings, [row for row in _ROWS.values() if row.locked])


def _hashed(settings: Settings, rows: list[Row]) -> str:
    lines = "\n".join(f"{row.name}={value_of(settings, row.name)!r}" for row in rows)
    return hashlib.sha256(lines.encode()).hexdigest()[:8]
