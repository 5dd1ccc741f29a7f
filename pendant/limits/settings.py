"""The settings of limits: what each stage of free-drive allows, and what resists motion before (FD-25)."""

from typing import Annotated

from pendant.settings.schema import Limit, Section
from pendant.settings.schema import limit as _limit
from pendant.settings.schema import number as _number
from pendant.settings.schema import switch as _switch


class EndLimit(Limit, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """A limit while free-drive lasts, with its reaction."""

    stop: Annotated[bool, _switch("FD-18", "beyond is STOP")] = False


class ActivationLimits(Section, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """What the freed arm must not do in the activation sequence."""

    flange_displacement: Annotated[Limit, _limit(0.0005, 0.01, "m", "FD-9", text="way of the flange")] = Limit(max=0.002)
    flange_speed: Annotated[Limit, _limit(0.002, 0.1, "m/s", "FD-9", text="speed of the flange")] = Limit(max=0.02)
    flange_acceleration: Annotated[Limit, _limit(0.5, 20.0, "m/s²", "FD-9", text="acceleration of the flange")] = Limit(max=1.5)
    joint_displacement: Annotated[Limit, _limit(0.0005, 0.1, "rad", "FD-9", text="way of a joint")] = Limit(max=0.01, on=False)
    joint_speed: Annotated[Limit, _limit(0.01, 0.5, "rad/s", "FD-9", text="speed of a joint")] = Limit(max=0.05)
    joint_acceleration: Annotated[Limit, _limit(0.5, 50.0, "rad/s²", "FD-9", text="acceleration of a joint")] = Limit(
        max=5.0, on=False
    )
    motor_torque: Annotated[Limit, _limit(0.01, 1.0, "of rated", "FD-9", text="torque of a motor")] = Limit(max=0.9, on=False)
    joint_torque: Annotated[Limit, _limit(0.01, 1.0, "of rated", "FD-9", text="external torque of a joint")] = Limit(max=0.04)
    payload_force: Annotated[Limit, _limit(1.0, 50.0, "N", "FD-9", text="force as of a wrong payload")] = Limit(max=5.8)
    payload_torque: Annotated[Limit, _limit(0.1, 10.0, "N·m", "FD-9", text="torque as of a wrong payload")] = Limit(max=1.5)
    user_force: Annotated[Limit, _limit(1.0, 50.0, "N", "FD-9", text="force that is none of a payload")] = Limit(max=12.0)
    user_torque: Annotated[Limit, _limit(0.1, 10.0, "N·m", "FD-9", text="torque that is none of a payload")] = Limit(max=1.5)
    load_share: Annotated[float, _number(0.0, 1.0, "", "FD-9", text="joint torque limits rise by this share of its load")] = 0.25


class MaintainLimits(Section, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """What counts as moving the arm by hand. Forces and torques are changes since the period began."""

    user_force: Annotated[Limit, _limit(1.0, 100.0, "N", "FD-13", text="change of the user's force")] = Limit(max=8.0)
    user_torque: Annotated[Limit, _limit(0.1, 20.0, "N·m", "FD-13", text="change of the user's torque")] = Limit(max=1.5)
    joint_torque: Annotated[Limit, _limit(0.5, 100.0, "N·m", "FD-13", text="change of a joint's external torque")] = Limit(
        max=8.0
    )
    joint_speed: Annotated[Limit, _limit(0.005, 1.0, "rad/s", "FD-13", text="speed of a joint")] = Limit(max=0.05)
    flange_speed: Annotated[Limit, _limit(0.002, 1.0, "m/s", "FD-13", text="speed of the flange")] = Limit(max=0.02)
    flange_acceleration: Annotated[Limit, _limit(0.5, 20.0, "m/s²", "FD-13", text="acceleration of the flange")] = Limit(max=1.5)
    flange_displacement: Annotated[Limit, _limit(0.001, 0.5, "m", "FD-13", text="way of the flange in the period")] = Limit(
        max=0.01
    )
    load_share: Annotated[
        float, _number(0.0, 1.0, "", "FD-13", text="force and joint torque limits rise by this share of the load")
    ] = 0.0


class OperationLimits(Section, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """What ends free-drive while it lasts."""

    tcp_speed: Annotated[EndLimit, _limit(0.05, 5.0, "m/s", "FD-18", text="speed of the tool centre point")] = EndLimit(max=1.5)
    elbow_speed: Annotated[EndLimit, _limit(0.05, 5.0, "m/s", "FD-18", text="speed of the elbow")] = EndLimit(max=1.5)
    joint_speed: Annotated[EndLimit, _limit(0.1, 6.0, "rad/s", "FD-18", text="speed of a joint")] = EndLimit(max=3.0)
    flange_acceleration: Annotated[EndLimit, _limit(1.0, 78.0, "m/s²", "FD-18", text="acceleration of the flange")] = EndLimit(
        max=40.0, stop=True
    )
    joint_torque: Annotated[EndLimit, _limit(0.01, 2.0, "of rated", "FD-18", text="external torque of a joint")] = EndLimit(
        max=0.8, time=0.05, stop=True
    )
    user_force: Annotated[EndLimit, _limit(5.0, 100.0, "N", "FD-18", text="the user's force")] = EndLimit(max=90.0, time=0.1)
    flange_displacement: Annotated[EndLimit, _limit(0.005, 2.0, "m", "FD-18", text="way of the flange since entry")] = EndLimit(
        max=0.5, on=False
    )


class LimitSettings(Section, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """Every limit: parameter x stage (FD-25)."""

    activation: ActivationLimits = ActivationLimits()
    maintain: MaintainLimits = MaintainLimits()
    operation: OperationLimits = OperationLimits()


class Soft(Section, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """Resistance in free-drive before the operation limits on speed."""

    on: Annotated[bool, _switch("FD-12b", "motion is resisted before a limit on its speed")] = True
    onset: Annotated[float, _number(0.1, 0.9, "", "FD-12b", text="share of a limit from which on motion is resisted")] = 0.5
    force: Annotated[float, _number(10.0, 300.0, "N", "FD-12b", text="resistance of tool and elbow at their limits")] = 120.0
    torque: Annotated[float, _number(0.05, 1.0, "of rated", "FD-12b", text="resistance of a joint at its limit")] = 0.7
    payload: Annotated[bool, _switch("FD-12b", "the limits fall with the configured payload and tool")] = True
    payload_share: Annotated[float, _number(0.0, 0.5, "1/kg", "FD-12b", text="a limit is divided by 1 plus this for each kg")] = (
        0.05
    )
    drift: Annotated[bool, _switch("FD-12b", "the limits fall for what moves on about the same way")] = True
    drift_time: Annotated[float, _number(0.2, 30.0, "s", "FD-12b", text="for so long it may")] = 2.0
    drift_share: Annotated[float, _number(0.1, 1.0, "", "FD-12b", text="share of the limits that is left then")] = 0.5
    acceleration: Annotated[bool, _switch("FD-12b", "way and time that are allowed fall with acceleration")] = False
    acceleration_share: Annotated[
        float, _number(0.0, 2.0, "s²/m", "FD-12b", text="they are divided by 1 plus this for each m/s²")
    ] = 0.25
    pushed: Annotated[bool, _switch("FD-12b", "limits fall with the user's force, angular ones with torque")] = False
    force_share: Annotated[
        float, _number(0.0, 0.2, "1/N", "FD-12b", text="a limit is divided by 1 plus this for each newton")
    ] = 0.02
    torque_share: Annotated[
        float, _number(0.0, 2.0, "1/(N·m)", "FD-12b", text="an angular one by 1 plus this for each newton metre")
    ] = 0.1
    vertical: Annotated[bool, _switch("FD-12b", "the limits of motion are tighter along gravity")] = False
    vertical_share: Annotated[float, _number(0.1, 1.0, "", "FD-12b", text="share of the limits that is left along it")] = 0.5
    hard: Annotated[bool, _switch("FD-12b", "all this lowers the limits that end free-drive, too")] = False


class AxisSettings(Section, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """Freedom of the tool in free-drive, axis by axis, and what singularities do to it."""

    on: Annotated[bool, _switch("FD-4", "axes can be locked", locked=False)] = True
    x: Annotated[bool, _switch("FD-4", "the tool is free along x", locked=False)] = True
    y: Annotated[bool, _switch("FD-4", "the tool is free along y", locked=False)] = True
    z: Annotated[bool, _switch("FD-4", "the tool is free along z", locked=False)] = True
    rx: Annotated[bool, _switch("FD-4", "the tool is free about x", locked=False)] = True
    ry: Annotated[bool, _switch("FD-4", "the tool is free about y", locked=False)] = True
    rz: Annotated[bool, _switch("FD-4", "the tool is free about z", locked=False)] = True
    tool: Annotated[bool, _switch("FD-4", "the axes are the tool's when they are locked", locked=False)] = False
    roll: Annotated[float, _number(-3.15, 3.15, "rad", "FD-4", text="of the axes in the base, about its x", locked=False)] = 0.0
    pitch: Annotated[float, _number(-3.15, 3.15, "rad", "FD-4", text="of the axes in the base, about its y", locked=False)] = 0.0
    yaw: Annotated[float, _number(-3.15, 3.15, "rad", "FD-4", text="of the axes in the base, about its z", locked=False)] = 0.0
    resistance: Annotated[bool, _switch("FD-4", "with a lock, motion towards a singularity is resisted")] = True
    near: Annotated[float, _number(0.011, 0.1, "m", "FD-4", text="near a singularity: smallest singular value below this")] = 0.04
    too_near: Annotated[float, _number(0.001, 0.01, "m", "FD-4", text="too near: with all of the resistance")] = 0.01


class JointLimits(Section, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """Zones before the joint limits in free-drive."""

    on: Annotated[bool, _switch("FD-4", "a joint is resisted before its range ends")] = True
    damping_zone: Annotated[float, _number(0.01, 0.5, "rad", "FD-4", text="where it is damped, before the stiff zone")] = 0.1
    stiff_zone: Annotated[float, _number(0.01, 0.3, "rad", "FD-4", text="up to the limit, where a spring holds it back")] = 0.05
    damping: Annotated[float, _number(0.05, 0.4, "s/rad", "FD-4", text="at the stiff zone, of rated torque at 1 rad/s")] = 0.25


class Static(Section, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """When the arm counts as standing still."""

    speed: Annotated[float, _number(0.001, 0.1, "rad/s", "static", text="every joint is slower than this")] = 0.01
    time: Annotated[float, _number(0.02, 2.0, "s", "static", text="for this long")] = 0.1
