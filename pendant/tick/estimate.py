"""What the controller knows in one tick: measured or derived from measurement, never the truth."""

import math
from copy import copy
from dataclasses import dataclass, field, fields
from enum import IntEnum
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from pendant.tick.source_signal import ContactSignals

Array = NDArray[np.float64]


def _no_joints() -> Array:
    return np.zeros(0)


def _nowhere() -> Array:
    return np.zeros(6)


GRAVITY = 9.81
"""[m/s²]"""


class FollowingError(NamedTuple):
    """Distance of the measured arm from the reference of the time of the measurement (RL-1)."""

    joint: int = 0  # the joint with the largest share of its limit
    angle: float = 0.0  # of that joint [rad]
    limit: float = math.inf  # of that joint [rad]
    share: float = 0.0  # angle / limit
    tool: float = 0.0  # at the tool centre point [m]


ON_PATH = FollowingError()
"""The arm is where it should be, or nothing says where that is."""


class LinkForce(NamedTuple):
    """The least force on a link that explains the external torques beyond the model's possible error (RL-3)."""

    joint: int = -1  # the last joint that feels the force: it moves the link
    force: float = 0.0  # [N]
    torque: float = 0.0  # of the joint that needs this force [N·m]
    twisted: int = 0  # the joint that needs this force
    parts: tuple[float, float, float] = (0.0, 0.0, 0.0)  # probability that it acts on elbow, forearm, wrist; all 0: unknown


NO_LINK_FORCE = LinkForce()
"""Nothing touches a link, as far as the joints feel."""


class MotionMeasures(NamedTuple):
    """What the robot's limits bound, beside speeds and angles (RL-4)."""

    momentum: float = 0.0  # of links and payload, the size of the linear one [kg·m/s]
    power: float = 0.0  # mechanical work a second on the object that the tool touches; 0 if the object drives the arm [W]
    stopping_time: float = 0.0  # until the arm rests, if it were stopped now [s]
    stopping_distance: float = 0.0  # of tool or elbow until then [m]


STANDS = MotionMeasures()


class JointsFeel(IntEnum):
    """What explains the change of the external torques since free-drive began."""

    NOTHING = 0  # the change is within the joints' possible error
    FALL = 1  # a payload that fell, within that error
    HAND = 2  # neither explains it


_NO_FORCE = np.zeros(3)
_NO_FORCE.flags.writeable = False  # all estimates share it


class WhoseForce(NamedTuple):
    """What moves the free arm, as the flange sensor and the joints tell; outside free-drive nothing is known."""

    lost_odds: float = -math.inf  # log of the odds that the payload is gone, not a hand that changed [nats]
    lost_share: float = 0.0  # of the payload that is gone then
    step_odds: float = -math.inf  # log of the odds that the flange sensor stepped, not a hand [nats]
    step_force: float = 0.0  # size of the step then [N]
    payload_fell: bool = False  # by the joints, without a valid flange sensor
    joints_feel: JointsFeel = JointsFeel.NOTHING  # without a valid flange sensor
    tau_hand: Array = _no_joints()  # (n,) by a hand (on a link, if wrench_valid) [N·m]
    tau_certain: Array = _no_joints()  # (n,) the part of tau_hand that is certainly a hand's now [N·m]
    powers: tuple[float, float, float] = (0.0, 0.0, 0.0)  # of tau_hand, tau_certain, friction [W]
    energy: float = 0.0  # kinetic, of links and rotors [J]
    F_link: Array = _NO_FORCE  # (3,) force on the flange that explains tau_hand best, in B, with a valid flange sensor [N]
    F_touch: Array = _NO_FORCE  # (3,) such a force for a touch of the standing arm [N]

    def copy(self) -> "WhoseForce":
        """The same values in arrays of their own."""
        torques = {"tau_hand": self.tau_hand.copy(), "tau_certain": self.tau_certain.copy()}
        return self._replace(**torques, F_link=self.F_link.copy(), F_touch=self.F_touch.copy())


NOT_ASKED = WhoseForce()


@dataclass(slots=True)
class Estimate:
    """The estimator's result for one tick, n joints. Arrays are owned by the estimator and valid until its next update.

    Frames as in docs/reference/conventions.md: W world, B base, F flange. Wrenches are (6,): force [N], then torque [N·m].
    """

    tick: int
    joints_valid: bool  # both encoders and the motor currents are present, fresh and finite
    wrench_valid: bool  # the flange force/torque sensor is present, fresh and finite
    acceleration_valid: bool  # the flange accelerometer is present, fresh and finite
    q: Array  # (n,) output angle [rad]
    qd: Array  # (n,) output speed [rad/s]
    qdd: Array  # (n,) output acceleration [rad/s²]
    theta: Array  # (n,) motor angle referred to the output [rad]
    theta_d: Array  # (n,) motor speed referred to the output [rad/s]
    tau_m: Array  # (n,) motor torque referred to the output, from the current [N·m]
    tau_J: Array  # (n,) transmission torque, fused from the ways in use (AF-3) [N·m]
    tau_ext: Array  # (n,) external torque, from the joints alone: rigid model minus transmission torque [N·m]
    w_sensor: Array  # (6,) wrench that the flange exerts on what it carries, in F at the flange origin
    F_user: Array  # (6,) the user's wrench on the flange: -(w_sensor - w_expected), axes of B, at the flange origin
    a_F: Array  # (3,) specific force at the flange accelerometer, in F [m/s²]
    p_BF: Array  # (3,) flange position [m]
    R_BF: Array  # (3, 3) flange orientation
    v_F: Array  # (6,) flange velocity: linear [m/s], then angular [rad/s], axes of B, at the flange origin
    v_tcp: float  # speed of the tool centre point [m/s]
    v_elbow: float  # speed of the elbow [m/s]
    following: FollowingError = ON_PATH  # of the arm against its reference
    link_force: LinkForce = NO_LINK_FORCE  # without a valid flange sensor also on tool and payload
    motion: MotionMeasures = STANDS
    clipped: bool = False  # the flange sensor's force is at the end of its range
    g_B: Array = field(default_factory=lambda: np.array([0.0, 0.0, -GRAVITY]))  # (3,) gravity in B, by the mounting [m/s²]
    theta_dd: Array = field(default_factory=_no_joints)  # (n,) motor acceleration referred to the output [rad/s²]
    friction: Array = field(default_factory=_no_joints)  # (n,) friction of both sides, with the sign of the speed [N·m]
    friction_deviation: Array = field(default_factory=_no_joints)  # (n,) its standard deviation [N·m]
    tau_ways: Array = field(default_factory=_no_joints)  # (3, n) transmission torque each way (AF-3) [N·m]
    degraded: bool = False  # not `joints_valid`, but each joint has its motor angle; the rest is estimated (AF-2, AF-3)
    lost: tuple[tuple[str, int], ...] = ()  # joint sensors that failed: name, joint
    touched: bool = False  # the joints feel a contact, so nothing is learned
    signals: ContactSignals = field(
        default_factory=ContactSignals
    )  # for the contact detectors, as pendant.contact.contact_monitor says
    tcp: Array = field(default_factory=_nowhere)  # (6,) tool centre point: position [m], then velocity [m/s], axes of B
    elbow: Array = field(default_factory=_nowhere)  # (6,) elbow: the same
    F_joints: Array = field(default_factory=lambda: np.zeros(3))  # (3,) force on the flange that explains tau_ext best, in B [N]
    whose: WhoseForce = NOT_ASKED
    a_felt: Array = field(default_factory=lambda: np.zeros(3))  # (3,) acceleration of the flange, in B [m/s²]
    current: Array = field(default_factory=_no_joints)  # (n,) measured motor current, as a share of the largest that it may have
    load_mass: float = 0.0  # configured: payload and tool [kg]
    missing_mass: tuple[float, float] = (0.0, math.inf)  # payload beyond the configured one, its deviation; without sensor [kg]
    tau_blur: tuple[float, ...] = ()  # (n,) largest error of tau_ext by the output encoders; (): unknown [N·m]

    def copy(self) -> "Estimate":
        """The same values in arrays of their own, which no later update changes."""
        twin = copy(self)
        for each in fields(self):
            value = getattr(self, each.name)
            if isinstance(value, np.ndarray):
                setattr(twin, each.name, value.copy())
        twin.whose = self.whose.copy()
        return twin
