"""What a laboratory does to a running simulation: to the true arm and world, never to the controller's knowledge."""

from typing import Literal

import msgspec

from pendant.settings.bounds import Celsius, Extent, Factor, Force, Share, Signed, Speed
from sim.arm.scenario import Load, Vector


class TrueChange(msgspec.Struct, frozen=True, forbid_unknown_fields=True, kw_only=True, tag_field="kind"):
    """Base of all changes."""


class AttachPayload(TrueChange, tag="attach_payload", frozen=True, forbid_unknown_fields=True, kw_only=True):
    """The true payload becomes `load` (also to change it)."""

    load: Load


class DropPayload(TrueChange, tag="drop_payload", frozen=True, forbid_unknown_fields=True, kw_only=True):
    """The true payload falls off."""


class SensorFault(TrueChange, tag="sensor", frozen=True, forbid_unknown_fields=True, kw_only=True):
    """A sensor drifts, becomes noisier, or fails. `channel` None: all channels of the sensor."""

    sensor: Literal["motor_encoder", "output_encoder", "current", "force_torque", "accelerometer", "gyro"]
    channel: int | None = None
    offset: Signed = 0.0  # step, at once [sensor's unit]
    drift: Signed = 0.0  # [sensor's unit/s]
    noise_factor: Factor = 1.0
    outage: bool = False


class FrictionChange(TrueChange, tag="friction", frozen=True, forbid_unknown_fields=True, kw_only=True):
    """True friction of a joint (None: all), on both sides of its gear, is `factor` times that when new (wear, grease)."""

    joint: str | None = None
    factor: Factor


class Temperature(TrueChange, tag="temperature", frozen=True, forbid_unknown_fields=True, kw_only=True):
    """True temperature of a joint (None: all)."""

    joint: str | None = None
    celsius: Celsius


class MoveObject(TrueChange, tag="move_object", frozen=True, forbid_unknown_fields=True, kw_only=True):
    """A world object is put elsewhere."""

    name: str
    position: Vector


class DriveGripper(TrueChange, tag="gripper", frozen=True, forbid_unknown_fields=True, kw_only=True):
    """The gripper is driven, past everything that is wired to it. A cup that closes draws, and lets go when it opens; it has
    neither speed nor force to set.
    """

    command: Literal["close", "open", "stop"] | None = None
    opening: Extent | None = None  # distance of the fingers to go to [m]
    speed: Speed | None = None  # of one finger against the other, None: as before [m/s]
    force: Force | None = None  # of one finger, None: as before [N]
    speed_share: Share | None = None  # the same from the least, 0, to the most that the drive can, 1
    force_share: Share | None = None

    def __post_init__(self) -> None:
        """Check that it says one thing at most where the fingers are to go."""
        if self.command is not None and self.opening is not None:
            raise ValueError("a gripper wants either `command` or `opening`")
        if (self.speed is not None and self.speed_share is not None) or (self.force is not None and self.force_share is not None):
            raise ValueError("speed and force are given once each, as such or as a share")


AnyChange = AttachPayload | DropPayload | SensorFault | FrictionChange | Temperature | MoveObject | DriveGripper
