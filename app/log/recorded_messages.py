"""The messages of a recording that are JSON, as types: what is read is checked against them."""

from typing import Annotated, Any, Literal

import msgspec
from msgspec import Meta

from pendant.tick.modes import Mode, Phase

Triple = Annotated[list[float], Meta(min_length=3, max_length=3)]
Tick = Annotated[int, Meta(ge=0)]


class TouchMessage(msgspec.Struct, frozen=True, kw_only=True):
    """What a hand does; in W."""

    part: str
    point: Triple  # [m]
    force: Triple  # [N]
    torque: Triple  # [N·m]


class UserMessage(msgspec.Struct, frozen=True, kw_only=True):
    """What free-drive takes for the user's force, in axes of B."""

    force: Triple  # [N]
    at: Triple  # where it is drawn, in F [m]
    covariance: Annotated[list[Triple], Meta(min_length=3, max_length=3)] | None  # [N²]; None: the joints tell the force


class PeriodMessage(msgspec.Struct, frozen=True, kw_only=True):
    """What is left of a period."""

    name: str
    ticks: Tick
    total: Tick


class GripperMessage(msgspec.Struct, frozen=True, kw_only=True):
    """The gripper as its own electronics tell; see `sim.gripping.finger_drive.GripperState`."""

    closing: bool
    moving: bool
    held: str
    met: bool
    opening: float  # [m]
    wanted: float  # [m]
    stroke: float  # [m]
    force: float  # [N]
    taken: float


class PendantMessage(msgspec.Struct, frozen=True, kw_only=True):
    """/pendant, 60 times a second."""

    tick: Tick
    mode: Mode
    safety: Literal["NORMAL", "REDUCED", "SAFEGUARD_STOP", "PROTECTIVE_STOP", "EMERGENCY_STOP"]
    phase: Phase
    periods: list[PeriodMessage]
    touches: list[TouchMessage]
    user: UserMessage | None = None  # recordings lack it that were made before it came
    gripper: GripperMessage | None = None  # of the tool that is mounted; recordings lack it that were made before it came


class Position(msgspec.Struct, frozen=True):
    """[m]."""

    x: float
    y: float
    z: float


class Rotation(msgspec.Struct, frozen=True):
    """A quaternion."""

    x: float
    y: float
    z: float
    w: float


class TransformMessage(msgspec.Struct, frozen=True, kw_only=True):
    """The pose of a frame in W."""

    child_frame_id: str
    translation: Position
    rotation: Rotation


class FramesMessage(msgspec.Struct, frozen=True, kw_only=True):
    """/tf, with each message of /pendant."""

    transforms: list[TransformMessage]

    def poses(self) -> dict[str, list[float]]:
        """Poses by name: position [m], quaternion wxyz."""
        found: dict[str, list[float]] = {}
        for each in self.transforms:
            p, r = each.translation, each.rotation
            found[each.child_frame_id] = [p.x, p.y, p.z, r.w, r.x, r.y, r.z]
        return found


class SettingsMessage(msgspec.Struct, frozen=True, kw_only=True):
    """/settings, whenever they change."""

    tick: Tick
    values: dict[str, Any]
