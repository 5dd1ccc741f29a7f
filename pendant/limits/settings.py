"""The settings of limits: what each stage of free-drive allows, and what resists motion before (FD-25)."""

from typing import Annotated

from pendant.settings.schema import Limit, Section
from pendant.settings.schema import choice as _choice
from pendant.settings.schema import limit as _limit
from pendant.settings.schema import number as _number
from pendant.settings.schema import switch as _switch
from pendant.tick.words import Word


class LimitReaction(Word):
    """What follows when a limit is exceeded while free-drive lasts (FD-18)."""

    LEAVE = "leave"
    STOP = "stop"


class LockFrame(Word):
    """Whose axes are locked (FD-4)."""

    BASE = "base"
    TOOL = "tool"  # as it stands when they are locked


class EndLimit(Limit, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """A limit while free-drive lasts, with its reaction."""

    reaction: Annotated[LimitReaction, _choice("FD-18", "what follows when it is exceeded")] = LimitReaction.LEAVE


class ActivationLimits(Section, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """What the freed arm must not do in the activation sequence."""

    BASIC = ("flange_displacement", "payload_force")

    flange_displacement: Annotated[Limit, _limit(0.0005, 0.01, "m", "FD-9", text="displacement of the flange")] = Limit(max=0.002)
    flange_speed: Annotated[Limit, _limit(0.002, 0.1, "m/s", "FD-9", text="speed of the flange")] = Limit(max=0.02)
    flange_acceleration: Annotated[Limit, _limit(0.5, 20.0, "m/s²", "FD-9", text="acceleration of the flange")] = Limit(max=1.5)
    joint_displacement: Annotated[Limit, _limit(0.0005, 0.1, "rad", "FD-9", text="displacement of a joint")] = Limit(
        max=0.01, on=False
    )
    joint_speed: Annotated[Limit, _limit(0.01, 0.5, "rad/s", "FD-9", text="speed of a joint")] = Limit(max=0.05)
    joint_acceleration: Annotated[Limit, _limit(0.5, 50.0, "rad/s²", "FD-9", text="acceleration of a joint")] = Limit(
        max=5.0, on=False
    )
    motor_torque: Annotated[Limit, _limit(0.01, 1.0, "of rated", "FD-9", text="torque of a motor")] = Limit(max=0.9, on=False)
    motor_current: Annotated[Limit, _limit(0.01, 1.0, "of largest", "FD-9", text="current of a motor, as measured")] = Limit(
        max=0.9, on=False
    )
    joint_torque: Annotated[Limit, _limit(0.01, 1.0, "of rated", "FD-9", text="external torque of a joint")] = Limit(max=0.04)
    payload_force: Annotated[Limit, _limit(1.0, 50.0, "N", "FD-9", text="force as a wrong payload would cause it")] = Limit(
        max=6.2
    )
    payload_torque: Annotated[Limit, _limit(0.1, 10.0, "N·m", "FD-9", text="torque as a wrong payload would cause it")] = Limit(
        max=1.5
    )
    payload_error: Annotated[
        Limit,
        _limit(0.1, 5.0, "kg", "FD-9", text="error of the payload's mass, by other postures or joints"),
    ] = Limit(max=0.3)
    user_force: Annotated[Limit, _limit(1.0, 50.0, "N", "FD-9", text="force that no payload would cause")] = Limit(max=12.0)
    user_torque: Annotated[Limit, _limit(0.1, 10.0, "N·m", "FD-9", text="torque that no payload would cause")] = Limit(max=1.5)
    load_share: Annotated[
        float, _number(0.0, 1.0, "", "FD-9", text="joint-torque limits rise by this share of the joint's load")
    ] = 0.25


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
    flange_displacement: Annotated[
        Limit, _limit(0.001, 0.5, "m", "FD-13", text="displacement of the flange since the period began")
    ] = Limit(max=0.01)
    load_share: Annotated[
        float, _number(0.0, 1.0, "", "FD-13", text="limits of force and joint torque rise by this share of the load")
    ] = 0.0


class OperationLimits(Section, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """What ends free-drive while it lasts."""

    BASIC = ("tcp_speed", "elbow_speed", "joint_speed", "user_force")

    tcp_speed: Annotated[EndLimit, _limit(0.05, 5.0, "m/s", "FD-18", text="speed of the tool centre point")] = EndLimit(max=1.5)
    elbow_speed: Annotated[EndLimit, _limit(0.05, 5.0, "m/s", "FD-18", text="speed of the elbow")] = EndLimit(max=1.5)
    joint_speed: Annotated[EndLimit, _limit(0.1, 6.0, "rad/s", "FD-18", text="speed of a joint")] = EndLimit(max=3.0)
    flange_acceleration: Annotated[EndLimit, _limit(1.0, 78.0, "m/s²", "FD-18", text="acceleration of the flange")] = EndLimit(
        max=40.0, reaction=LimitReaction.STOP
    )
    joint_torque: Annotated[EndLimit, _limit(0.01, 2.0, "of rated", "FD-18", text="external torque of a joint")] = EndLimit(
        max=0.8, time=0.05, reaction=LimitReaction.STOP
    )
    user_force: Annotated[EndLimit, _limit(5.0, 100.0, "N", "FD-18", text="the user's force")] = EndLimit(max=90.0, time=0.1)
    flange_displacement: Annotated[EndLimit, _limit(0.005, 2.0, "m", "FD-18", text="displacement of the flange since entry")] = (
        EndLimit(max=0.5, on=False)
    )


class LimitSettings(Section, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """Every limit: parameter x stage (FD-25)."""

    activation: ActivationLimits = ActivationLimits()
    maintain: MaintainLimits = MaintainLimits()
    operation: OperationLimits = OperationLimits()


class Soft(Section, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """Resistance in free-drive before the operation limits on speed."""

    BASIC = ("on",)

    on: Annotated[bool, _switch("FD-12b", "motion is resisted before it reaches a limit of speed")] = True
    onset: Annotated[float, _number(0.1, 0.9, "", "FD-12b", text="share of a limit from which on motion is resisted")] = 0.5
    force: Annotated[
        float, _number(10.0, 300.0, "N", "FD-12b", text="resisting force on tool and elbow at their limits of speed")
    ] = 120.0
    torque: Annotated[
        float, _number(0.05, 1.0, "of rated", "FD-12b", text="resisting torque on a joint at its limit of speed")
    ] = 0.7
    payload: Annotated[bool, _switch("FD-12b", "limits of speed decrease with the configured payload and tool")] = True
    payload_share: Annotated[
        float, _number(0.0, 0.5, "1/kg", "FD-12b", text="a limit is divided by 1 plus this for each kilogram")
    ] = 0.05
    drift: Annotated[bool, _switch("FD-12b", "limits of speed decrease while the arm moves on in one direction")] = True
    drift_time: Annotated[
        float, _number(0.2, 30.0, "s", "FD-12b", text="time of motion in one direction after which they decrease")
    ] = 2.0
    drift_share: Annotated[float, _number(0.1, 1.0, "", "FD-12b", text="share of the limits that is left after that")] = 0.5
    acceleration: Annotated[
        bool, _switch("FD-12b", "limits of displacement and their allowed times decrease with acceleration")
    ] = False
    acceleration_share: Annotated[
        float, _number(0.0, 2.0, "s²/m", "FD-12b", text="these limits are divided by 1 plus this for each m/s²")
    ] = 0.25
    pushed: Annotated[bool, _switch("FD-12b", "limits of speed decrease with the user's force, angular ones with the torque")] = (
        False
    )
    force_share: Annotated[
        float, _number(0.0, 0.2, "1/N", "FD-12b", text="a limit is divided by 1 plus this for each newton")
    ] = 0.02
    torque_share: Annotated[
        float, _number(0.0, 2.0, "1/(N·m)", "FD-12b", text="an angular limit is divided by 1 plus this for each newton metre")
    ] = 0.1
    vertical: Annotated[bool, _switch("FD-12b", "limits of motion are smaller along gravity")] = False
    vertical_share: Annotated[float, _number(0.1, 1.0, "", "FD-12b", text="share of the limits that is left along gravity")] = 0.5
    hard: Annotated[bool, _switch("FD-12b", "the limits that end free-drive decrease in the same way")] = False


class AxisSettings(Section, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """Freedom of the tool in free-drive, axis by axis, and what singularities do to it."""

    BASIC = ("on", "x", "y", "z", "rx", "ry", "rz", "frame")

    on: Annotated[bool, _switch("FD-4", "axes of the tool can be locked in free-drive", locked=False)] = True
    x: Annotated[bool, _switch("FD-4", "the tool is free along x", locked=False)] = True
    y: Annotated[bool, _switch("FD-4", "the tool is free along y", locked=False)] = True
    z: Annotated[bool, _switch("FD-4", "the tool is free along z", locked=False)] = True
    rx: Annotated[bool, _switch("FD-4", "the tool is free about x", locked=False)] = True
    ry: Annotated[bool, _switch("FD-4", "the tool is free about y", locked=False)] = True
    rz: Annotated[bool, _switch("FD-4", "the tool is free about z", locked=False)] = True
    frame: Annotated[LockFrame, _choice("FD-4", "the frame whose axes can be locked", locked=False)] = LockFrame.BASE
    roll: Annotated[
        float, _number(-3.15, 3.15, "rad", "FD-4", text="turn of the locked axes about x of the base", locked=False)
    ] = 0.0
    pitch: Annotated[
        float, _number(-3.15, 3.15, "rad", "FD-4", text="turn of the locked axes about y of the base", locked=False)
    ] = 0.0
    yaw: Annotated[
        float, _number(-3.15, 3.15, "rad", "FD-4", text="turn of the locked axes about z of the base", locked=False)
    ] = 0.0
    resistance: Annotated[bool, _switch("FD-4", "while an axis is locked, motion towards a singularity is resisted")] = True
    near: Annotated[
        float, _number(0.011, 0.1, "m", "FD-4", text="smallest singular value below which motion to a singularity is resisted")
    ] = 0.04
    too_near: Annotated[
        float, _number(0.001, 0.01, "m", "FD-4", text="smallest singular value below which the resistance is full")
    ] = 0.01


class JointSettings(Section, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """Freedom of the joints in free-drive, one by one. An arm with fewer joints has no use for the others."""

    BASIC = ("on",)

    on: Annotated[bool, _switch("FD-4", "joints can be locked in free-drive", locked=False)] = True
    j1: Annotated[bool, _switch("FD-4", "joint 1, counted from the base, is free", locked=False)] = True
    j2: Annotated[bool, _switch("FD-4", "joint 2, counted from the base, is free", locked=False)] = True
    j3: Annotated[bool, _switch("FD-4", "joint 3, counted from the base, is free", locked=False)] = True
    j4: Annotated[bool, _switch("FD-4", "joint 4, counted from the base, is free", locked=False)] = True
    j5: Annotated[bool, _switch("FD-4", "joint 5, counted from the base, is free", locked=False)] = True
    j6: Annotated[bool, _switch("FD-4", "joint 6, counted from the base, is free", locked=False)] = True
    j7: Annotated[bool, _switch("FD-4", "joint 7, counted from the base, is free", locked=False)] = True
    j8: Annotated[bool, _switch("FD-4", "joint 8, counted from the base, is free", locked=False)] = True
    j9: Annotated[bool, _switch("FD-4", "joint 9, counted from the base, is free", locked=False)] = True
    j10: Annotated[bool, _switch("FD-4", "joint 10, counted from the base, is free", locked=False)] = True
    j11: Annotated[bool, _switch("FD-4", "joint 11, counted from the base, is free", locked=False)] = True
    j12: Annotated[bool, _switch("FD-4", "joint 12, counted from the base, is free", locked=False)] = True


class JointLimits(Section, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """Zones before the joint limits in free-drive."""

    BASIC = ("on",)

    on: Annotated[bool, _switch("FD-4", "a joint is resisted before the end of its range")] = True
    damping_zone: Annotated[
        float, _number(0.01, 0.5, "rad", "FD-4", text="width of the zone, before the stiff one, in which a joint is damped")
    ] = 0.1
    stiff_zone: Annotated[
        float, _number(0.01, 0.3, "rad", "FD-4", text="width of the zone before the end in which a spring holds a joint back")
    ] = 0.05
    damping: Annotated[
        float, _number(0.05, 0.4, "s/rad", "FD-4", text="damping where the stiff zone begins, in rated torques at 1 rad/s")
    ] = 0.25


class Static(Section, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """When the arm counts as standing still."""

    speed: Annotated[
        float, _number(0.001, 0.1, "rad/s", "static", text="the arm stands still while every joint is slower than this")
    ] = 0.01
    time: Annotated[float, _number(0.02, 2.0, "s", "static", text="time for which every joint must be that slow")] = 0.1
